//! The final glossy bounce by 16 slices against paths, roughness by roughness.

use super::MeasureError;
use super::frame_errors::{blocks, half, mean, traced};
use super::statistics::root_of_difference;
use crate::bake::RunSettings;
use crate::frame::{Image, compare};
use crate::reference::{GlossyBounces, ReferencePart, ReferenceSettings};
use crate::relight::{Component, FrameSettings, Quality, Renderer};

/// Roughnesses that all glossy materials are given in turn.
pub(super) const ROUGHNESSES: [f32; 8] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0];
/// Pixels of the longer side of these frames: there are eight of them.
pub(super) const LONGER_SIDE: u32 = 160;
/// Paths a pixel at most, in two halves.
pub(super) const MOST_SAMPLES: u32 = 256;
/// Side of the blocks whose means are compared.
pub(super) const BLOCK: u32 = 8;
const SEEDS: [u32; 2] = [0x6105, 0x6106];

/// One roughness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GlossyError {
    pub(super) roughness: f32,
    /// relRMSE of blocks without the reference's noise.
    pub(super) relative_rmse: f64,
    /// The reference's noise of the same.
    pub(super) noise: f64,
    /// Mean over the reference's mean, less 1; infinite where that is black and the
    /// frame is not.
    pub(super) bias: f64,
}

/// Errors of the component `glossy` against a reference whose last bounce is glossy
/// and the others diffuse, as the renderer has it; of scenes with glossy materials.
/// The renderer's materials are what they were afterwards.
pub(super) fn by_roughness(
    renderer: &mut Renderer,
    frame: &FrameSettings,
    samples: u32,
    run: &RunSettings,
) -> Result<Vec<GlossyError>, MeasureError> {
    let materials = renderer.scene().materials.clone();
    if materials.iter().all(|it| it.gloss().is_none()) {
        return Ok(Vec::new());
    }
    let mut frame = FrameSettings {
        component: Component::Glossy,
        quality: Quality::Standard,
        ..*frame
    };
    let longer = frame.camera.size[0].max(frame.camera.size[1]);
    let shrunk = |side: u32| (side * LONGER_SIDE / longer).clamp(1, side);
    frame.camera.size = frame.camera.size.map(shrunk);
    let errors = of_each(renderer, &frame, samples.min(MOST_SAMPLES), run);
    renderer.relight(|_, all| *all = materials);
    errors
}

fn of_each(
    renderer: &mut Renderer,
    frame: &FrameSettings,
    samples: u32,
    run: &RunSettings,
) -> Result<Vec<GlossyError>, MeasureError> {
    let mut errors = Vec::new();
    for roughness in ROUGHNESSES {
        renderer.relight(|_, all| {
            let glossy = all.iter_mut().filter(|it| it.gloss().is_some());
            glossy.for_each(|it| it.roughness = Some(roughness));
        });
        let found = one(renderer, frame, samples, run)?;
        errors.push(GlossyError { roughness, ..found });
    }
    Ok(errors)
}

fn one(
    renderer: &mut Renderer,
    frame: &FrameSettings,
    samples: u32,
    run: &RunSettings,
) -> Result<GlossyError, MeasureError> {
    let image = blocks(&renderer.frame(frame, run)?.image, BLOCK);
    let mut halves = Vec::new();
    for seed in SEEDS {
        let settings = ReferenceSettings {
            part: ReferencePart::Glossy,
            glossy: GlossyBounces::Final,
            ..half(frame, samples, seed)
        };
        halves.push(blocks(&traced(renderer.scene(), &settings, run)?, BLOCK));
    }
    let reference = mean(&halves[0], &halves[1]);
    let of = |a: &Image, b: &Image| {
        let found = compare(a, b);
        found.expect("all frames have one size")
    };
    // Half the difference of the halves is the noise of their mean.
    let noise = of(&reference, &halves[0]).relative_rmse;
    let found = of(&reference, &image);
    Ok(GlossyError {
        roughness: 0.0,
        relative_rmse: root_of_difference(found.relative_rmse, noise),
        noise,
        bias: found.bias,
    })
}
