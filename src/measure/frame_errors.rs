//! Frames against the path tracer: how wrong they are, and how long the path
//! tracer takes to be no more wrong.

use std::time::Instant;

use rayon::ThreadPoolBuilder;

use super::MeasureError;
use super::statistics::{median, root_of_difference};
use crate::bake::RunSettings;
use crate::frame::{Difference, FlipMap, Image, PIXELS_PER_DEGREE, compare, flip};
use crate::reference::{GlossyBounces, ReferencePart, ReferenceSettings, trace};
use crate::relight::{Component, FrameSettings, Quality, RenderError, Renderer, develop};
use crate::scene::{Bounces, Light, LightKind, Radiance, Scene};

/// Seeds of the two halves of the reference.
const SEEDS: [u32; 2] = [0x4e90_0006, 0x4e90_0007];
/// Sample counts at which the path tracer's own error is measured, and their seed.
pub(super) const TRIED_SAMPLES: [u32; 3] = [4, 16, 32];
const TRIED_SEED: u32 = 0x4e90_0008;
/// Side of the blocks whose means are compared too, pixels.
pub(super) const BLOCK: u32 = 8;
/// Frames that are timed on one thread; the median counts.
pub(super) const TIMED_FRAMES: u32 = 5;
/// Qualities that are compared, and how many frames of each are timed: one gather
/// takes seconds, and differs less from the next one.
const QUALITIES: [(Quality, u32); 2] = [(Quality::Standard, TIMED_FRAMES), (Quality::Gather, 1)];
/// Each timed frame has its lights this much brighter, so that no light is kept.
const BRIGHTER: f32 = 1.0 + 1.0 / 1024.0;

/// Components that are compared.
pub(super) const COMPARED: [Component; 2] = [Component::Global, Component::Indirect];

/// Relative root mean square error of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rms {
    /// As it was found, against a reference that has noise.
    pub(super) found: f64,
    /// Standard error of the reference, from its halves.
    pub(super) noise: f64,
}

impl Rms {
    /// Without the reference's noise.
    pub(super) fn corrected(self) -> f64 {
        root_of_difference(self.found, self.noise)
    }
}

/// How a path tracer gets there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AtEqualError {
    /// Error x sqrt(paths a pixel), mean over [`TRIED_SAMPLES`].
    pub(super) error_of_one: f64,
    /// (paths a pixel, error without the reference's noise).
    pub(super) tried: Vec<(f64, f64)>,
    /// Paths a pixel for the frame's error; not a whole number.
    pub(super) samples: f64,
    /// Seconds of one thread.
    pub(super) seconds: f64,
}

/// One component against the reference.
pub(super) struct Compared {
    pub(super) component: Component,
    pub(super) quality: Quality,
    pub(super) frame: Image,
    pub(super) reference: Image,
    /// By pixels, and by means of blocks.
    pub(super) rms: [Rms; 2],
    pub(super) bias: f64,
    pub(super) bias_noise: f64,
    pub(super) flip: FlipMap,
    /// Mean between the halves of the reference, which differ by twice its noise.
    pub(super) flip_of_halves: f64,
    /// For pixels and for blocks.
    pub(super) paths: [AtEqualError; 2],
    /// Seconds of one thread for a path a pixel.
    pub(super) seconds_a_sample: f64,
    /// Milliseconds of one thread for a frame whose lights all changed.
    pub(super) frame_ms: f64,
}

impl Compared {
    /// Processor time of the path tracer over that of a frame, at equal error by
    /// pixels and by blocks.
    pub(super) fn ratios(&self) -> [f64; 2] {
        [0, 1].map(|which| self.paths[which].seconds * 1e3 / self.frame_ms)
    }

    /// Frames from which the bake has paid, `bake_seconds` of processor time.
    pub(super) fn break_even(&self, which: usize, bake_seconds: f64) -> Option<f64> {
        let saved = self.paths[which].seconds - self.frame_ms / 1e3;
        (saved > 0.0 && saved.is_finite()).then(|| (bake_seconds / saved).ceil())
    }
}

/// Compares frames of a renderer, whose lights stay as they are.
pub(super) fn against_paths(
    renderer: &mut Renderer,
    frame: &FrameSettings,
    samples: u32,
    run: &RunSettings,
) -> Result<Vec<Compared>, MeasureError> {
    let references = references(renderer.scene(), frame, samples, run)?;
    let mut compared = Vec::new();
    for (component, halves) in COMPARED.into_iter().zip(references) {
        let truth = Truth::of(halves);
        let of_component = FrameSettings {
            component,
            ..*frame
        };
        let tried = tried(renderer.scene(), &of_component, &truth, run)?;
        for (quality, timed_frames) in QUALITIES {
            let settings = FrameSettings {
                quality,
                ..of_component
            };
            run.progress.stage("frames", u64::from(timed_frames));
            let image = renderer.frame(&settings, run)?.image;
            let frame_ms = frame_ms(renderer, &settings, timed_frames, run)?;
            let scene = renderer.scene();
            compared.push(one(scene, &settings, (image, frame_ms), &truth, &tried));
        }
    }
    Ok(compared)
}

/// Two halves for each of [`COMPARED`]. Direct light is traced by itself.
fn references(
    scene: &Scene,
    frame: &FrameSettings,
    samples: u32,
    run: &RunSettings,
) -> Result<[[Image; 2]; 2], MeasureError> {
    let images_of = |seed: u32| -> Result<[Image; 2], MeasureError> {
        let all = half(frame, samples, seed);
        let indirect = ReferenceSettings {
            part: ReferencePart::Indirect,
            ..all
        };
        let indirect = traced(scene, &indirect, run)?;
        if scene.materials.iter().any(|it| it.gloss().is_some()) {
            // Lobes reflect light of any bounce: there is no sum of two parts.
            return Ok([traced(scene, &all, run)?, indirect]);
        }
        let direct = ReferenceSettings {
            bounces: Bounces::Count(0),
            ..all
        };
        let direct = traced(scene, &direct, run)?;
        Ok([joined(&direct, &indirect, |a, b| a + b), indirect])
    };
    let [first, second] = SEEDS;
    let [[global_a, indirect_a], [global_b, indirect_b]] = [images_of(first)?, images_of(second)?];
    Ok([[global_a, global_b], [indirect_a, indirect_b]])
}

/// How one of the two halves of a frame's reference is traced, of all light.
pub(super) fn half(frame: &FrameSettings, samples: u32, seed: u32) -> ReferenceSettings {
    ReferenceSettings {
        camera: frame.camera,
        bounces: frame.bounces,
        samples: (samples / 2).max(2),
        seed,
        part: ReferencePart::Global,
        glossy: GlossyBounces::All,
    }
}

pub(super) fn traced(
    scene: &Scene,
    settings: &ReferenceSettings,
    run: &RunSettings,
) -> Result<Image, MeasureError> {
    let found = trace(scene, settings, run).ok_or(RenderError::Cancelled)?;
    Ok(found.image)
}

/// The reference of two halves.
pub(super) fn mean(a: &Image, b: &Image) -> Image {
    joined(a, b, |a, b| (a + b) * 0.5)
}

fn joined(a: &Image, b: &Image, join: impl Fn(glam::Vec3, glam::Vec3) -> glam::Vec3) -> Image {
    let pairs = a.pixels().iter().zip(b.pixels());
    let pixels = pairs.map(|(a, b)| join(*a, *b)).collect();
    Image::new(a.width(), a.height(), pixels).expect("as many pixels as before")
}

/// The reference of one component.
struct Truth {
    halves: [Image; 2],
    /// Their mean.
    reference: Image,
    /// Its standard error, by pixels and by means of blocks.
    noise: [f64; 2],
}

impl Truth {
    fn of(halves: [Image; 2]) -> Self {
        let reference = mean(&halves[0], &halves[1]);
        let noise = |side| difference(&reference, &halves[0], side).relative_rmse;
        Self {
            noise: [1, BLOCK].map(noise),
            reference,
            halves,
        }
    }
}

fn one(
    scene: &Scene,
    settings: &FrameSettings,
    (frame, frame_ms): (Image, f64),
    Truth {
        halves,
        reference,
        noise,
    }: &Truth,
    tried: &Tried,
) -> Compared {
    let rms = [(1, noise[0]), (BLOCK, noise[1])].map(|(side, noise)| Rms {
        found: difference(reference, &frame, side).relative_rmse,
        noise,
    });
    let whole = difference(reference, &frame, 1);
    let flip_between = |a: &Image, b: &Image| {
        let levels = [a, b].map(|image| {
            let render = &scene.render;
            develop(image, settings.component, render.exposure, render.tone).levels()
        });
        flip(&levels[0], &levels[1], PIXELS_PER_DEGREE).expect("images of one size")
    };
    let flip = flip_between(reference, &frame);
    let flip_of_halves = flip_between(&halves[0], &halves[1]).mean();
    Compared {
        component: settings.component,
        quality: settings.quality,
        bias: whole.bias,
        bias_noise: difference(reference, &halves[0], 1).bias.abs(),
        flip,
        flip_of_halves,
        paths: [0, 1].map(|which| tried.at_equal_error(which, rms[which].corrected())),
        seconds_a_sample: tried.seconds_a_sample,
        rms,
        frame,
        reference: reference.clone(),
        frame_ms,
    }
}

/// The difference of the means of blocks of so many pixels a side.
fn difference(reference: &Image, candidate: &Image, side: u32) -> Difference {
    compare(&blocks(reference, side), &blocks(candidate, side)).expect("images of one size")
}

/// Means of blocks; those at the right and at the bottom may be smaller.
pub(super) fn blocks(image: &Image, side: u32) -> Image {
    let (width, height) = (image.width(), image.height());
    let mean = |x0: u32, y0: u32| {
        let (mut sum, mut count) = (glam::DVec3::ZERO, 0.0);
        for y in y0..(y0 + side).min(height) {
            for x in x0..(x0 + side).min(width) {
                sum += image.pixels()[(y * width + x) as usize].as_dvec3();
                count += 1.0;
            }
        }
        (sum / count).as_vec3()
    };
    let (across, down) = (width.div_ceil(side), height.div_ceil(side));
    let pixels = (0..down).flat_map(|y| (0..across).map(move |x| (x * side, y * side)));
    let pixels = pixels.map(|(x, y)| mean(x, y)).collect();
    Image::new(across, down, pixels).expect("a pixel a block")
}

/// The path tracer at few samples.
struct Tried {
    /// (paths, error), for pixels and for blocks.
    errors: [Vec<(f64, f64)>; 2],
    seconds_a_sample: f64,
}

impl Tried {
    fn at_equal_error(&self, which: usize, error: f64) -> AtEqualError {
        let tried = self.errors[which].clone();
        let variances = tried.iter().map(|(samples, error)| error * error * samples);
        let error_of_one = (variances.sum::<f64>() / tried.len() as f64).sqrt();
        let ratio = error_of_one / error;
        let samples = ratio * ratio;
        AtEqualError {
            error_of_one,
            tried,
            samples,
            seconds: samples * self.seconds_a_sample,
        }
    }
}

/// Traces few paths on one thread. The error of each picture is taken against
/// the reference, whose noise is taken off.
fn tried(
    scene: &Scene,
    settings: &FrameSettings,
    truth: &Truth,
    run: &RunSettings,
) -> Result<Tried, MeasureError> {
    let mut errors = [Vec::new(), Vec::new()];
    let mut times = Vec::new();
    for samples in TRIED_SAMPLES {
        let tracing = ReferenceSettings {
            camera: settings.camera,
            bounces: settings.bounces,
            samples,
            seed: TRIED_SEED ^ samples,
            part: match settings.component {
                Component::Global => ReferencePart::Global,
                _ => ReferencePart::Indirect,
            },
            glossy: GlossyBounces::All,
        };
        let start = Instant::now();
        let image = on_one_thread(|| traced(scene, &tracing, run))??;
        times.push((f64::from(samples), start.elapsed().as_secs_f64()));
        for (which, side) in [1, BLOCK].into_iter().enumerate() {
            let found = difference(&truth.reference, &image, side).relative_rmse;
            let own = root_of_difference(found, truth.noise[which]);
            errors[which].push((f64::from(samples), own));
        }
    }
    Ok(Tried {
        errors,
        seconds_a_sample: seconds_a_sample(&times),
    })
}

/// What a path a pixel takes, from (paths, seconds) of growing pictures: the
/// last less the first, so that preparing the scene does not count; the last
/// alone where clocks are too coarse for that.
fn seconds_a_sample(times: &[(f64, f64)]) -> f64 {
    let (first, last) = (times[0], times[times.len() - 1]);
    if last.1 > first.1 {
        (last.1 - first.1) / (last.0 - first.0)
    } else {
        last.1 / last.0
    }
}

fn on_one_thread<T: Send>(job: impl FnOnce() -> T + Send) -> Result<T, MeasureError> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| MeasureError::Threads(error.to_string()))?;
    Ok(pool.install(job))
}

/// Milliseconds of one thread for a frame in which every light, of the mesh too, is
/// another than in the frame before; the lights are put back.
fn frame_ms(
    renderer: &mut Renderer,
    settings: &FrameSettings,
    timed_frames: u32,
    run: &RunSettings,
) -> Result<f64, MeasureError> {
    let scene = renderer.scene();
    let before = (scene.lights.clone(), scene.materials.clone());
    let times = on_one_thread(|| -> Result<Vec<f64>, RenderError> {
        if timed_frames > 1 {
            renderer.frame(settings, run)?;
        }
        let mut times = Vec::new();
        for _ in 0..timed_frames {
            let start = Instant::now();
            renderer.relight(|lights, materials| {
                lights.iter_mut().for_each(brighten);
                materials.iter_mut().for_each(|it| it.emission *= BRIGHTER);
            });
            renderer.frame(settings, run)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
            run.progress.advance(1);
        }
        Ok(times)
    });
    renderer.relight(|lights, materials| (*lights, *materials) = before);
    Ok(median(times??))
}

fn brighten(light: &mut Light) {
    match &mut light.kind {
        LightKind::Point(light) => light.intensity *= BRIGHTER,
        LightKind::Spot(light) => light.intensity *= BRIGHTER,
        LightKind::Directional(light) => light.irradiance *= BRIGHTER,
        LightKind::Area(light) => light.radiance *= BRIGHTER,
        LightKind::Environment(light) => match &mut light.radiance {
            Radiance::Constant(radiance) => *radiance *= BRIGHTER,
            Radiance::Map(_) => light.scale *= BRIGHTER,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn image(width: u32, values: &[f32]) -> Image {
        let pixels = values.iter().map(|&v| Vec3::splat(v)).collect();
        Image::new(width, values.len() as u32 / width, pixels).unwrap()
    }

    #[test]
    fn blocks_are_means_and_may_be_cut_off() {
        let found = blocks(&image(3, &[1.0, 3.0, 5.0, 5.0, 7.0, 9.0]), 2);
        assert_eq!(found, image(2, &[4.0, 7.0]));
    }

    #[test]
    fn noise_in_blocks_is_less_and_a_bias_is_not() {
        let reference = image(8, &[1.0; 64]);
        let noisy: Vec<f32> = (0..64)
            .map(|i| if (i + i / 8) % 2 == 0 { 1.1 } else { 0.9 })
            .collect();
        let noisy = image(8, &noisy);
        assert!(difference(&reference, &noisy, 1).relative_rmse > 0.09);
        assert!(difference(&reference, &noisy, BLOCK).relative_rmse < 1e-6);
        let biased = image(8, &[1.1; 64]);
        let bias = difference(&reference, &biased, BLOCK);
        assert!((bias.relative_rmse - 0.1).abs() < 1e-6 && (bias.bias - 0.1).abs() < 1e-6);
    }

    #[test]
    fn preparation_does_not_count_as_paths() {
        assert_eq!(
            seconds_a_sample(&[(4.0, 3.0), (16.0, 6.0), (32.0, 10.0)]),
            0.25
        );
        assert_eq!(seconds_a_sample(&[(4.0, 3.0), (32.0, 3.0)]), 3.0 / 32.0);
    }

    #[test]
    fn a_path_tracer_needs_four_times_the_paths_for_half_the_error() {
        let tried = Tried {
            errors: [vec![(4.0, 0.5), (16.0, 0.25)], vec![(4.0, 0.05)]],
            seconds_a_sample: 2.0,
        };
        let found = tried.at_equal_error(0, 0.125);
        assert_eq!(
            (found.error_of_one, found.samples, found.seconds),
            (1.0, 64.0, 128.0)
        );
        assert_eq!(tried.at_equal_error(1, 0.05).samples, 4.0);
    }
}
