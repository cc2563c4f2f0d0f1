//! From a wish to pictures of it, each sharper than the last.
//!
//! ```text
//! wish changes ─► draft, coarse if need be ─► draft of every pixel ─► full frame ─► finer pixels
//! ```
//! The full frame is what `render` writes at that size, to the bit. Finer pixels
//! are for terminals that show pictures.

use std::sync::Arc;
use std::time::Instant;

use crate::bake::RunSettings;
use crate::frame::EncodedImage;
use crate::relight::{Effort, FrameSettings, RenderError, Renderer, SeenSurfaces, Stages};
use crate::scene::{Light, Material, Tone};

/// A draft whose pixels alone take longer gets larger ones, milliseconds: half
/// of a thirtieth of a second, the other half of which is the vertices'.
const SLOW_PIXELS_MS: f64 = 16.0;
/// A draft whose pixels take less gets smaller ones: four times as many must not
/// be slow again.
const QUICK_PIXELS_MS: f64 = SLOW_PIXELS_MS / 5.0;
/// Most pixels of the picture along the side of a draft's.
const COARSEST: u32 = 8;
/// Shadow rays a pixel to a light that is no point, in a draft.
const LIGHT_SAMPLES_OF_A_DRAFT: u32 = 4;
/// Stages of a frame that a draft's pixels have no share in.
const VERTEX_STAGES: [&str; 5] = [
    "lights",
    "sky",
    "direct at vertices",
    "colours at vertices",
    "bounces",
];

/// What is to be seen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wish {
    pub(crate) lights: Vec<Light>,
    /// Every material of the scene.
    pub(crate) materials: Vec<Material>,
    /// The full frame; its size is that of the picture in cells.
    pub(crate) frame: FrameSettings,
    /// EV.
    pub(crate) exposure: f32,
    pub(crate) tone: Tone,
    /// Size of the picture once it rests, where the terminal shows pictures.
    pub(crate) fine_size: Option<[u32; 2]>,
}

/// How sharp a picture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sharpness {
    /// One point for so many pixels of the picture either way.
    Draft(u32),
    /// What `render` writes at this size.
    Full,
    /// The same at the size for terminals that show pictures.
    Fine,
}

/// A picture.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) levels: EncodedImage,
    pub(crate) sharpness: Sharpness,
    pub(crate) stages: Stages,
    pub(crate) clamped_pixels: u64,
    /// Whether bounced light is missing, for want of a bake.
    pub(crate) lacks_bake: bool,
    /// Whether bounces were carried out one by one, since a fixed albedo is
    /// another now.
    pub(crate) lacks_folding: bool,
    /// A material whose bounced gloss is missing: it had no lobe when the bake was
    /// made.
    pub(crate) lacks_slices_of: Option<String>,
    /// What the pixels show.
    pub(crate) seen: Arc<SeenSurfaces>,
}

/// Draws what is wished for.
pub(crate) struct Painter {
    renderer: Renderer,
    /// The last wish and how sharp its picture is.
    drawn: Option<(Wish, Sharpness)>,
    /// Pixels of the picture along the side of a draft's.
    coarseness: u32,
}

impl Painter {
    pub(crate) fn new(renderer: Renderer) -> Self {
        Self {
            renderer,
            drawn: None,
            coarseness: 1,
        }
    }

    /// The scene as it was lit last.
    pub(crate) fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// How sharp the next picture of a wish will be; `None`: the last one is as
    /// sharp as it gets.
    pub(crate) fn next_step(&self, wish: &Wish) -> Option<Sharpness> {
        match &self.drawn {
            Some((drawn, sharpness)) if drawn == wish => match sharpness {
                Sharpness::Draft(1) => Some(Sharpness::Full),
                Sharpness::Draft(_) => Some(Sharpness::Draft(1)),
                Sharpness::Full => wish.fine_size.map(|_| Sharpness::Fine),
                Sharpness::Fine => None,
            },
            _ => Some(Sharpness::Draft(self.coarseness)),
        }
    }

    /// The next picture of a wish; `None` if there is no sharper one, or if the
    /// wish is for another scene than this one.
    ///
    /// # Errors
    /// As [`Renderer::frame_so_far`].
    pub(crate) fn next(
        &mut self,
        wish: &Wish,
        run: &RunSettings,
    ) -> Result<Option<Drawn>, RenderError> {
        let Some(step) = self.next_step(wish) else {
            return Ok(None);
        };
        if wish.materials.len() != self.renderer.scene().materials.len() {
            return Ok(None);
        }
        self.light(wish);
        let started = Instant::now();
        let settings = settings(wish, step);
        let frame = self.renderer.frame_so_far(&settings, run)?;
        let levels = frame.develop(wish.exposure, wish.tone);
        let all_ms = started.elapsed().as_secs_f64() * 1e3;
        if let Sharpness::Draft(coarseness) = step {
            self.adapt(coarseness, all_ms, &frame.stages);
        }
        self.drawn = Some((wish.clone(), step));
        let size = match step {
            Sharpness::Draft(_) => wish.frame.camera.size,
            Sharpness::Full | Sharpness::Fine => settings.camera.size,
        };
        Ok(Some(Drawn {
            levels: enlarged(&levels, size),
            sharpness: step,
            stages: frame.stages,
            clamped_pixels: frame.clamped_pixels,
            lacks_bake: !self.renderer.has_bake() && self.renderer.needs_bake(&settings),
            lacks_folding: self.renderer.needs_folding(&settings),
            lacks_slices_of: self.renderer.lacks_slices_of(&settings).map(str::to_owned),
            seen: Arc::new(self.renderer.seen()),
        }))
    }

    /// Draws no more of a wish that cannot be drawn.
    pub(crate) fn give_up(&mut self, wish: &Wish) {
        self.drawn = Some((wish.clone(), Sharpness::Fine));
    }

    /// Gives the scene the lights and materials of a wish.
    fn light(&mut self, wish: &Wish) {
        self.renderer.relight(|lights, materials| {
            lights.clone_from(&wish.lights);
            materials.clone_from(&wish.materials);
        });
    }

    /// Whether a wish needs a bake that there is not yet.
    pub(crate) fn lacks_bake(&mut self, wish: &Wish) -> bool {
        self.light(wish);
        self.renderer.needs_bake(&wish.frame)
    }

    /// Whether that is for its albedo alone.
    pub(crate) fn lacks_folding(&mut self, wish: &Wish) -> bool {
        self.light(wish);
        self.renderer.needs_folding(&wish.frame)
    }

    /// A material of a wish whose bounced gloss the bake does not have.
    pub(crate) fn lacks_slices_of(&mut self, wish: &Wish) -> Option<&str> {
        self.light(wish);
        self.renderer.lacks_slices_of(&wish.frame)
    }

    /// A frame of a wish at another size, as `render` draws it.
    ///
    /// # Errors
    /// As [`Renderer::frame_so_far`].
    pub(crate) fn whole_frame(
        &mut self,
        wish: &Wish,
        size: [u32; 2],
        run: &RunSettings,
    ) -> Result<crate::relight::Frame, RenderError> {
        self.light(wish);
        let settings = of_size(wish.frame, size);
        self.renderer.frame_so_far(&settings, run)
    }

    /// Chooses larger or smaller pixels for the next draft.
    fn adapt(&mut self, coarseness: u32, all_ms: f64, stages: &Stages) {
        let vertices = stages.times_ms().iter();
        let vertices_ms: f64 = vertices
            .filter(|(stage, _)| VERTEX_STAGES.contains(stage))
            .map(|(_, ms)| ms)
            .sum();
        let pixels_ms = all_ms - vertices_ms;
        if pixels_ms > SLOW_PIXELS_MS && coarseness < COARSEST {
            self.coarseness = 2 * coarseness;
        } else if pixels_ms < QUICK_PIXELS_MS && coarseness > 1 {
            self.coarseness = coarseness / 2;
        }
    }
}

fn settings(wish: &Wish, step: Sharpness) -> FrameSettings {
    match step {
        Sharpness::Draft(coarseness) => {
            let size = wish.frame.camera.size.map(|side| side.div_ceil(coarseness));
            let few = wish.frame.light_samples.min(LIGHT_SAMPLES_OF_A_DRAFT);
            FrameSettings {
                effort: Effort::Draft,
                light_samples: few,
                ..of_size(wish.frame, size)
            }
        }
        Sharpness::Full => wish.frame,
        Sharpness::Fine => of_size(wish.frame, wish.fine_size.unwrap_or(wish.frame.camera.size)),
    }
}

fn of_size(mut frame: FrameSettings, size: [u32; 2]) -> FrameSettings {
    frame.camera.size = size;
    frame
}

/// A picture with every pixel repeated to fill a size, which may be up to a pixel
/// less than a multiple of its own.
pub(super) fn enlarged(levels: &EncodedImage, [width, height]: [u32; 2]) -> EncodedImage {
    if [levels.width(), levels.height()] == [width, height] {
        return levels.clone();
    }
    let (own_width, own_height) = (levels.width(), levels.height());
    let [across, down] = [width.div_ceil(own_width), height.div_ceil(own_height)];
    let (pixels, _) = levels.bytes().as_chunks::<3>();
    let mut bytes = Vec::with_capacity(3 * width as usize * height as usize);
    for y in 0..height {
        let row = &pixels[(y / down * own_width) as usize..];
        for x in 0..width {
            bytes.extend_from_slice(&row[(x / across) as usize]);
        }
    }
    EncodedImage::of_bytes(width, height, bytes).expect("three bytes a pixel were written")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::sample_scenes::{point_light, room_with_blocks};
    use crate::scene::{LightKind, Scene};
    use glam::DVec3;

    fn room() -> Scene {
        let mut scene = room_with_blocks(false, 0.5, 64);
        scene.lights = vec![point_light(DVec3::new(0.2, 0.7, 0.5), 2.0)];
        scene
    }

    fn wish(scene: &Scene) -> Wish {
        let mut frame = FrameSettings::of_scene(scene);
        frame.camera.size = [37, 22];
        Wish {
            lights: scene.lights.clone(),
            materials: scene.materials.clone(),
            frame,
            exposure: 0.5,
            tone: Tone::Filmic,
            fine_size: Some([74, 44]),
        }
    }

    #[test]
    fn a_picture_at_rest_is_that_of_a_fresh_renderer() {
        let (mut scene, run) = (room(), RunSettings::silent());
        let mut renderer = Renderer::new(scene.clone(), None);
        renderer.bake(&run).unwrap();
        let mut painter = Painter::new(renderer);
        for step in 0..3 {
            if let LightKind::Point(lamp) = &mut scene.lights[0].kind {
                lamp.position.x -= 0.1 * f64::from(step);
            }
            let wish = wish(&scene);
            let mut seen = Vec::new();
            while let Some(drawn) = painter.next(&wish, &run).unwrap() {
                seen.push(drawn.sharpness);
                let settings = settings(&wish, drawn.sharpness);
                if !matches!(drawn.sharpness, Sharpness::Draft(_)) {
                    let mut fresh = Renderer::new(scene.clone(), None);
                    let frame = fresh.frame(&settings, &run).unwrap();
                    assert_eq!(drawn.levels, frame.develop(0.5, Tone::Filmic));
                    assert!(!drawn.lacks_bake);
                }
                assert_eq!(drawn.seen.size, settings.camera.size);
            }
            assert_eq!(seen[0], Sharpness::Draft(painter.coarseness.max(1)));
            assert_eq!(seen[seen.len() - 2..], [Sharpness::Full, Sharpness::Fine]);
            assert!(painter.next_step(&wish).is_none());
        }
    }

    #[test]
    fn without_a_bake_there_is_direct_light() {
        let scene = room();
        let mut painter = Painter::new(Renderer::new(scene.clone(), None));
        let wish = wish(&scene);
        let drawn = painter
            .next(&wish, &RunSettings::silent())
            .unwrap()
            .unwrap();
        assert!(drawn.lacks_bake);
        assert!(drawn.levels.bytes().iter().any(|&level| level > 0));
    }

    #[test]
    fn slow_pixels_become_larger_and_quick_ones_smaller() {
        let mut painter = Painter::new(Renderer::new(room(), None));
        let stages = Stages::default();
        for (ms, coarseness) in [
            (20.0, 2),
            (20.0, 4),
            (20.0, 8),
            (99.0, 8),
            (10.0, 8),
            (3.0, 4),
        ] {
            painter.adapt(painter.coarseness, ms, &stages);
            assert_eq!(painter.coarseness, coarseness, "{ms} ms");
        }
        let (wide, small) = ([5, 3], [[9, 0, 0], [0, 9, 0], [0, 0, 9]]);
        let levels = EncodedImage::of_bytes(3, 1, small.concat()).unwrap();
        let large = enlarged(&levels, wide);
        assert_eq!(
            large.bytes()[..15],
            [9, 0, 0, 9, 0, 0, 0, 9, 0, 0, 9, 0, 0, 0, 9]
        );
        assert_eq!(large.bytes()[..15], large.bytes()[30..]);
    }
}
