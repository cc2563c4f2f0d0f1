//! The main figures of a report.

use super::frame_errors::Compared;
use super::methods;
use super::run::{Measured, Vertices};
use super::statistics::over_lights;
use super::tables;
use super::vertices::test_lights;
use crate::bake::{LightErrors, Scheme};
use crate::relight::Quality;

/// Main figures of a report. Errors are relative (0.01 is one per cent); `None`
/// was not measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MainFigures {
    /// Lighting vertices.
    pub vertices: usize,
    /// Vertices that were compared.
    pub receivers: Option<usize>,
    /// By scheme.
    pub schemes: Vec<SchemeFigures>,
    /// What the bake states of itself, by some of the receivers under other lights; one
    /// bounce on white.
    pub stated: Option<LightErrors>,
    /// Noise of the truth at the vertices, mean over lights, one bounce and four.
    pub truth_noise: Option<[f64; 2]>,
    /// (bytes a vertex, error of the published scheme over that of relume's own within
    /// so many), one bounce; only where the sweep reaches.
    pub ratios_at_equal_bytes: Vec<(f64, f64)>,
    /// Rays a vertex in these ratios, of relume's own scheme and of the published one.
    pub rays_of_ratios: Option<[u32; 2]>,
    /// Of the frame against the path tracer.
    pub images: Vec<ImageFigures>,
    /// (roughness, relRMSE of the glossy component, its bias); none without glossy
    /// materials.
    pub glossy: Vec<(f32, f64, f64)>,
    /// Seconds of the bake by the clock.
    pub bake_seconds: f64,
    /// Threads that it ran on.
    pub threads: usize,
    /// Seconds of the whole report by the clock.
    pub seconds: f64,
    /// Variants of the method that were tried when it was chosen, itself included.
    pub variants_tried: usize,
}

/// One scheme at the defaults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SchemeFigures {
    /// Which.
    pub scheme: Scheme,
    /// Bytes of the operator.
    pub bytes_per_vertex: f64,
    /// After one bounce on white.
    pub one_bounce: LightErrors,
    /// After four bounces on the scene's grey.
    pub four_bounces: LightErrors,
    /// Milliseconds of four bounces.
    pub relight_ms: f64,
}

/// One component of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageFigures {
    /// Name of the component.
    pub component: &'static str,
    /// Where the frame has its indirect light from.
    pub quality: Quality,
    /// relRMSE of pixels and of blocks without the reference's noise.
    pub relative_rmse: [f64; 2],
    /// The reference's noise, of pixels and of blocks.
    pub noise: [f64; 2],
    /// Of the image's sum.
    pub bias: f64,
    /// FLIP: mean and 95th percentile.
    pub flip: [f64; 2],
    /// FLIP between the halves of the reference, mean.
    pub flip_of_halves: f64,
    /// Milliseconds of one thread for a frame.
    pub frame_ms: f64,
    /// Seconds of one thread that the path tracer needs for the same error, of
    /// pixels and of blocks.
    pub path_seconds: [f64; 2],
    /// The same over the frame's time.
    pub ratios: [f64; 2],
    /// Frames after which the bake has paid; `None`: never.
    pub break_even_frames: [Option<f64>; 2],
}

impl ImageFigures {
    /// The component, and the quality where it is not as always.
    pub fn name(&self) -> String {
        named(self.component, self.quality)
    }

    /// The error of pixels (0) or blocks (1), in words where the reference's noise
    /// hides it.
    pub fn error_text(&self, which: usize) -> String {
        let [error, noise] = [self.relative_rmse[which], self.noise[which]].map(|it| it * 100.0);
        match error == 0.0 && noise > 0.0 {
            true => format!("below the noise of {noise:.2} %"),
            false => format!("{error:.2} %"),
        }
    }

    /// [`Self::ratios`] to two digits, which is what clocks are worth.
    pub fn ratio_text(&self, which: usize) -> String {
        match self.ratios[which] {
            ratio if !ratio.is_finite() => "unknown".to_owned(),
            ratio if ratio < 0.95 => format!("{ratio:.2}"),
            ratio if ratio < 9.5 => format!("{ratio:.1}"),
            ratio => {
                let mut unit = 1.0;
                while ratio / unit >= 99.5 {
                    unit *= 10.0;
                }
                format!("{:.0}", (ratio / unit).round() * unit)
            }
        }
    }
}

/// What a frame of a component is called, by its quality.
pub(super) fn named(component: &str, quality: Quality) -> String {
    match quality {
        Quality::Standard => component.to_owned(),
        Quality::Gather => format!("{component}, {quality}"),
    }
}

/// What matters most of what was measured.
pub(super) fn main_figures(measured: &Measured) -> MainFigures {
    let vertices = measured.vertices.as_ref();
    let schemes = vertices.iter().flat_map(|found| &found.schemes);
    let noise = |found: &Vertices| {
        let noise = found.truth.noise();
        noise.map(|by_light| over_lights(&test_lights(&by_light), |_| true).mean)
    };
    let sweeps = measured.sweeps.as_ref();
    let equal = sweeps
        .map(|sweeps| tables::at_equal_bytes(&sweeps.points, 0))
        .unwrap_or_default();
    let bake_seconds = measured.bake_seconds * measured.threads as f64;
    MainFigures {
        vertices: measured.figures.vertices,
        receivers: vertices.map(|found| found.truth.receivers.len()),
        schemes: schemes
            .map(|scheme| SchemeFigures {
                scheme: scheme.settings.scheme,
                bytes_per_vertex: scheme.point.bytes_per_vertex,
                one_bounce: scheme.errors.all(0),
                four_bounces: scheme.errors.all(1),
                relight_ms: scheme.point.relight_ms,
            })
            .collect(),
        stated: measured.figures.bake.map(|bake| bake.stats.errors.total),
        truth_noise: vertices.map(noise),
        ratios_at_equal_bytes: equal
            .into_iter()
            .filter_map(|(bytes, errors)| Some((bytes, tables::ratio(errors)?)))
            .collect(),
        rays_of_ratios: sweeps.map(|it| it.rays),
        images: measured
            .image
            .iter()
            .flatten()
            .map(|it| image_figures(it, bake_seconds))
            .collect(),
        glossy: measured
            .glossy
            .iter()
            .map(|it| (it.roughness, it.relative_rmse, it.bias))
            .collect(),
        bake_seconds: measured.bake_seconds,
        threads: measured.threads,
        seconds: measured
            .chapter_seconds
            .iter()
            .map(|(_, seconds)| seconds)
            .sum(),
        variants_tried: methods::tried(&methods::knobs()),
    }
}

fn image_figures(it: &Compared, bake_seconds: f64) -> ImageFigures {
    ImageFigures {
        component: it.component_name(),
        quality: it.quality,
        relative_rmse: it.rms.map(|rms| rms.corrected()),
        noise: it.rms.map(|rms| rms.noise),
        bias: it.bias,
        flip: [it.flip.mean(), it.flip.percentile(95.0)],
        flip_of_halves: it.flip_of_halves,
        frame_ms: it.frame_ms,
        path_seconds: [0, 1].map(|which| it.paths[which].seconds),
        ratios: it.ratios(),
        break_even_frames: [0, 1].map(|which| it.break_even(which, bake_seconds)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_noise_hides_is_no_error_of_zero() {
        let figures = |error, ratio| ImageFigures {
            component: "global",
            quality: Quality::Standard,
            relative_rmse: [error; 2],
            noise: [0.012; 2],
            bias: 0.0,
            flip: [0.0; 2],
            flip_of_halves: 0.0,
            frame_ms: 1.0,
            path_seconds: [1.0; 2],
            ratios: [ratio; 2],
            break_even_frames: [None; 2],
        };
        let hidden = figures(0.0, f64::INFINITY);
        assert_eq!(hidden.error_text(0), "below the noise of 1.20 %");
        assert_eq!(hidden.ratio_text(1), "unknown");
        assert_eq!(figures(0.0123, 1.0).error_text(1), "1.23 %");
        let texts = [0.44, 2.16, 9.6, 99.4, 99.6, 4_903.0].map(|it| figures(0.1, it).ratio_text(0));
        assert_eq!(texts, ["0.44", "2.2", "10", "99", "100", "4900"]);
    }
}
