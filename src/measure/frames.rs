//! How long relighting takes while a light moves.

use std::f64::consts::TAU;
use std::time::Instant;

use glam::DVec3;
use thiserror::Error;

use super::MeasureError;
use crate::bake::RunSettings;
use crate::maths::functions::{cos, sin};
use crate::relight::{Frame, FrameSettings, RenderError, Renderer};
use crate::scene::{LightKind, Scene};
use crate::simd::Level;

/// Radius of the light's circle, share of the scene's extent.
const RADIUS: f64 = 0.05;
/// What of a frame belongs to no stage.
const OTHER: &str = "other";

/// No light of the scene has a place from which it could move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error(
    "the scene has no local light that could move; \
     add a [[light]] of kind \"point\", \"spot\" or \"area\" to the scene file"
)]
pub struct NoLocalLight;

/// The circle on which a scene's first local light (point, spot or rectangle)
/// moves: about its place, in the plane perpendicular to the camera's `up`, with
/// a radius of 5 % of the scene's extent.
#[derive(Debug, Clone, PartialEq)]
pub struct LightCircle {
    /// Index in the scene's lights.
    light: usize,
    /// The light as the scene has it.
    at_rest: LightKind,
    /// From the centre to where the circle starts (the camera's right) and to a
    /// quarter of the way round, file units.
    axes: [DVec3; 2],
}

impl LightCircle {
    /// The circle of a scene's first local light.
    ///
    /// # Errors
    /// If there is none.
    pub fn of(scene: &Scene) -> Result<Self, NoLocalLight> {
        let is_local = |kind: &LightKind| place(&mut kind.clone()).is_some();
        let light = scene
            .lights
            .iter()
            .position(|light| is_local(&light.kind))
            .ok_or(NoLocalLight)?;
        let radius = RADIUS * scene.placement().extent;
        let camera = &scene.camera;
        let up = camera.up.normalize();
        // A camera that looks along its `up` has been refused.
        let right = (camera.target - camera.position).cross(up).normalize();
        Ok(Self {
            light,
            at_rest: scene.lights[light].kind.clone(),
            axes: [right * radius, up.cross(right) * radius],
        })
    }

    /// Index of the light in the scene's lights.
    pub fn light(&self) -> usize {
        self.light
    }

    /// How far from its place the light is in frame `frame` of `frames`, which
    /// go round once; file units.
    pub fn offset(&self, frame: u32, frames: u32) -> DVec3 {
        let angle = TAU * f64::from(frame) / f64::from(frames.max(1));
        self.axes[0] * cos(angle) + self.axes[1] * sin(angle)
    }

    /// The light as it is in frame `frame` of `frames`.
    pub fn moved(&self, frame: u32, frames: u32) -> LightKind {
        let mut kind = self.at_rest.clone();
        if let Some(place) = place(&mut kind) {
            *place += self.offset(frame, frames);
        }
        kind
    }
}

/// Where a light is, if it is local.
fn place(kind: &mut LightKind) -> Option<&mut DVec3> {
    match kind {
        LightKind::Point(light) => Some(&mut light.position),
        LightKind::Spot(light) => Some(&mut light.position),
        LightKind::Area(light) => Some(&mut light.corner),
        LightKind::Directional(_) | LightKind::Environment(_) => None,
    }
}

/// How a figure is spread over the frames: 5th percentile, median and 95th
/// percentile, interpolated between the two nearest frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// 5th percentile.
    pub low: f64,
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub high: f64,
}

impl Spread {
    /// Of at least one value.
    fn of(mut values: Vec<f64>) -> Self {
        assert!(!values.is_empty(), "a spread is that of some values");
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * (values.len() - 1) as f64;
            let below = place.floor() as usize;
            let above = (below + 1).min(values.len() - 1);
            values[below] + (values[above] - values[below]) * (place - below as f64)
        };
        Self {
            low: at(0.05),
            median: at(0.5),
            high: at(0.95),
        }
    }
}

/// How long a stage takes in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageTimes {
    /// Name of the stage; "other" is what belongs to none.
    pub stage: &'static str,
    /// Milliseconds.
    pub time_ms: Spread,
}

/// How long frames take.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTimes {
    /// Name of the light that moved.
    pub light: String,
    /// Frames that count.
    pub frames: u32,
    /// Threads that drew them.
    pub threads: usize,
    /// Widest instructions in use.
    pub level: Level,
    /// By stage, in the order in which they run.
    pub stages: Vec<StageTimes>,
    /// Milliseconds a frame by the clock. Medians of stages need not sum to it.
    pub total_ms: Spread,
}

impl FrameTimes {
    /// Frames a second of the median frame.
    pub fn frames_per_second(&self) -> f64 {
        1e3 / self.total_ms.median
    }
}

/// Times frames of a renderer while its first local light moves on its
/// [`LightCircle`], round once. What depends on that light is computed anew in
/// every frame; what does not (the bake, other lights, maps at vertices) is
/// kept, and has been made by a first frame that does not count, with the light
/// at its own place. The light is there again afterwards.
///
/// A frame is what [`Renderer::frame`] does: levels and files are no part of
/// it. At least one frame is drawn.
///
/// # Errors
/// If there is no such light, or no frame.
pub fn time_frames(
    renderer: &mut Renderer,
    settings: &FrameSettings,
    frames: u32,
    run: &RunSettings,
) -> Result<FrameTimes, MeasureError> {
    let mut all = Vec::new();
    let circle = LightCircle::of(renderer.scene())?;
    let drawn = draw_frames(
        renderer,
        &circle,
        settings,
        frames,
        run,
        &mut |frame, ms| {
            all.push((frame.stages.times_ms().to_vec(), ms));
        },
    );
    put(renderer, &circle, circle.at_rest.clone());
    drawn?;
    let stage_names = all[0].0.iter().map(|(stage, _)| *stage);
    let stages = stage_names.enumerate().map(|(index, stage)| StageTimes {
        stage,
        time_ms: Spread::of(all.iter().map(|(stages, _)| stages[index].1).collect()),
    });
    let others = all.iter().map(|(stages, total_ms)| {
        let staged: f64 = stages.iter().map(|(_, ms)| ms).sum();
        total_ms - staged
    });
    let other = StageTimes {
        stage: OTHER,
        time_ms: Spread::of(others.collect()),
    };
    Ok(FrameTimes {
        light: renderer.scene().lights[circle.light].name.clone(),
        frames: all.len() as u32,
        #[allow(
            clippy::disallowed_methods,
            reason = "said in the report, used nowhere"
        )]
        threads: rayon::current_num_threads(),
        level: run.level.available(),
        stages: stages.chain([other]).collect(),
        total_ms: Spread::of(all.iter().map(|(_, ms)| *ms).collect()),
    })
}

/// Draws a frame that does not count and then `frames` that do; hands on each
/// of these with its milliseconds.
fn draw_frames(
    renderer: &mut Renderer,
    circle: &LightCircle,
    settings: &FrameSettings,
    frames: u32,
    run: &RunSettings,
    see: &mut dyn FnMut(&Frame, f64),
) -> Result<(), RenderError> {
    put(renderer, circle, circle.at_rest.clone());
    renderer.frame(settings, run)?;
    let frames = frames.max(1);
    run.progress.stage("frames", u64::from(frames));
    for number in 0..frames {
        let moved = circle.moved(number, frames);
        let start = Instant::now();
        put(renderer, circle, moved);
        let frame = renderer.frame(settings, run)?;
        let time_ms = start.elapsed().as_secs_f64() * 1e3;
        see(&frame, time_ms);
        run.progress.advance(1);
    }
    Ok(())
}

fn put(renderer: &mut Renderer, circle: &LightCircle, kind: LightKind) {
    renderer.relight(|lights, _| lights[circle.light].kind = kind);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Bounces;
    use crate::scene::sample_scenes::{
        constant_sky, directional_light, lamp_facing_down, point_light, room_with_blocks,
        spot_facing_down,
    };
    use glam::Vec3;

    /// Of lengths computed by a sine and a cosine in double precision.
    const ROUNDING: f64 = 1e-12;

    fn lit_room() -> Scene {
        let mut scene = room_with_blocks(false, 0.5, 32);
        scene.lights = vec![
            directional_light(Vec3::NEG_Y, 0.3),
            point_light(DVec3::new(0.2, 0.7, 0.5), 2.0),
            point_light(DVec3::new(-0.6, -0.1, 0.4), 0.3),
        ];
        scene.camera.size = [32, 24];
        scene
    }

    #[test]
    fn the_circle_lies_flat_about_the_first_local_light() {
        let mut scene = lit_room();
        scene.camera.up = DVec3::new(0.1, 2.0, -0.3);
        let circle = LightCircle::of(&scene).unwrap();
        assert_eq!(circle.light(), 1, "a directional light has no place");
        let radius = 0.05 * scene.placement().extent;
        let mut sum = DVec3::ZERO;
        for frame in 0..7 {
            let LightKind::Point(moved) = circle.moved(frame, 7) else {
                panic!("a point light stays one");
            };
            let offset = moved.position - DVec3::new(0.2, 0.7, 0.5);
            assert!((offset.length() - radius).abs() < ROUNDING, "{frame}");
            assert!(offset.dot(scene.camera.up).abs() < ROUNDING, "{frame}");
            sum += offset;
        }
        assert!(sum.length() < ROUNDING, "evenly round: {sum}");
        let view = scene.camera.target - scene.camera.position;
        let start = circle.offset(0, 7);
        assert!(start.dot(view).abs() < ROUNDING, "it starts at the right");
    }

    #[test]
    fn spots_and_rectangles_move_and_lights_from_afar_do_not() {
        let mut scene = lit_room();
        scene.lights = vec![constant_sky(1.0), directional_light(Vec3::NEG_Y, 1.0)];
        assert_eq!(LightCircle::of(&scene), Err(NoLocalLight));
        let text = NoLocalLight.to_string();
        assert!(text.contains("add a [[light]]"), "{text}");
        let place = DVec3::new(0.1, 0.5, 0.1);
        for light in [
            spot_facing_down(place, 1.0, [20.0, 30.0]),
            lamp_facing_down(place, place + 0.2, 1.0),
        ] {
            scene.lights[1] = light;
            let circle = LightCircle::of(&scene).unwrap();
            let (before, after) = match (&scene.lights[1].kind, circle.moved(1, 4)) {
                (LightKind::Spot(b), LightKind::Spot(a)) => (b.position, a.position),
                (LightKind::Area(b), LightKind::Area(a)) => (b.corner, a.corner),
                other => panic!("{other:?} changed its kind"),
            };
            let off = (after - before - circle.offset(1, 4)).length();
            assert!(off < ROUNDING, "moved by {off} too much");
        }
    }

    #[test]
    fn every_frame_is_another_and_computes_the_light_anew() {
        let scene = lit_room();
        let settings = FrameSettings::of_scene(&scene);
        let run = RunSettings::silent();
        let circle = LightCircle::of(&scene).unwrap();
        let mut renderer = Renderer::new(scene.clone(), None);
        for frames in [1, 4] {
            let mut images = Vec::new();
            let mut see = |frame: &Frame, ms: f64| {
                assert_eq!(frame.computed_lights, 1, "the light that moved, no other");
                assert!(ms >= frame.stages.total_ms(), "stages are in the frame");
                images.push(frame.image.clone());
            };
            draw_frames(&mut renderer, &circle, &settings, frames, &run, &mut see).unwrap();
            assert_eq!(images.len() as u32, frames);
            for later in &images[1..] {
                assert_ne!(*later, images[0], "the light moved");
            }
            let mut moved = scene.clone();
            moved.lights[1].kind = circle.moved(frames - 1, frames);
            let fresh = Renderer::new(moved, None).frame(&settings, &run).unwrap();
            assert_eq!(images.last(), Some(&fresh.image), "bits of a fresh frame");
        }
    }

    #[test]
    fn times_are_by_stage_and_the_light_is_put_back() {
        let scene = lit_room();
        let settings = FrameSettings {
            bounces: Bounces::Count(2),
            ..FrameSettings::of_scene(&scene)
        };
        let mut renderer = Renderer::new(scene.clone(), None);
        let times = time_frames(&mut renderer, &settings, 5, &RunSettings::silent()).unwrap();
        assert_eq!(renderer.scene().lights, scene.lights, "put back");
        assert_eq!((times.frames, times.light.as_str()), (5, "lamp"));
        let names: Vec<&str> = times.stages.iter().map(|s| s.stage).collect();
        // What the camera sees is kept: it stands still.
        for stage in [
            "direct at vertices",
            "bounces",
            "light at pixels",
            "shade",
            OTHER,
        ] {
            assert!(names.contains(&stage), "no {stage:?} in {names:?}");
        }
        for spread in times
            .stages
            .iter()
            .map(|s| s.time_ms)
            .chain([times.total_ms])
        {
            let in_order = spread.low <= spread.median && spread.median <= spread.high;
            assert!(spread.low >= 0.0 && in_order, "{spread:?}");
        }
        let rate = times.frames_per_second() * times.total_ms.median;
        assert!((rate - 1e3).abs() < 1e-9, "{rate} ms a second");
    }

    #[test]
    fn percentiles_lie_between_the_frames() {
        let spread = Spread::of((0..=20).rev().map(f64::from).collect());
        assert_eq!((spread.low, spread.median, spread.high), (1.0, 10.0, 19.0));
        let pair = Spread::of(vec![3.0, 1.0]);
        assert_eq!(pair.median, 2.0);
        let one = Spread::of(vec![7.0]);
        assert_eq!((one.low, one.high), (7.0, 7.0));
    }
}
