//! `expected | difference | actual`, side by side.

use glam::Vec3;

use super::{
    ComparedImage, Mask,
    pixels::{PixelDifference, PixelDifferences},
};
use crate::frame::{Development, EncodedImage, LoadedImage};
use crate::scene::Tone;

/// Between the panels, and where a panel is smaller than its neighbours.
const BACKGROUND: [u8; 3] = [96, 96, 96];
/// A pixel that is infinite or not a number in either image.
const NOT_FINITE: [u8; 3] = [255, 0, 255];
/// A pixel that the mask ignores.
const IGNORED: [u8; 3] = [40, 44, 64];
/// Width of the gaps between panels, pixels.
const GAP: u32 = 4;
/// Darkest level of a channel that differs, so that one level in a picture of
/// large differences is still seen.
const LEAST_LEVEL: f64 = 56.0;
/// Mean of the shown colours of a linear image: middle grey of photography.
const MIDDLE_GREY: f64 = 0.18;

/// One picture of the reference, the difference and the candidate, left to
/// right at their own size.
///
/// The difference is |candidate - reference| by channel, the largest of the
/// picture shown as white, alpha as grey on top; violet is what is infinite or
/// not a number, dark blue what the mask ignores. Linear values are shown through
/// the filmic curve, both sides under the exposure that makes the reference's
/// mean middle grey. Of images of two sizes, the difference stays empty.
pub fn strip(
    reference: &ComparedImage,
    candidate: &ComparedImage,
    mask: Option<&Mask>,
) -> EncodedImage {
    let gain = gain_of(reference.pixels());
    let [expected, actual] = [reference, candidate].map(|image| shown(image.pixels(), gain));
    let [width, height] = reference.size();
    let same_size = reference.size() == candidate.size();
    let mask = mask.filter(|mask| mask.size() == reference.size());
    let difference = if same_size {
        difference(reference, candidate, mask)
    } else {
        BACKGROUND.repeat(width as usize * height as usize)
    };
    side_by_side([
        (reference.size(), &expected),
        (reference.size(), &difference),
        (candidate.size(), &actual),
    ])
}

/// Levels of an image as a screen shows them.
fn shown(pixels: &LoadedImage, gain: f32) -> Vec<u8> {
    let levels = match pixels {
        LoadedImage::Levels(levels) => Development::Plain.develop(&levels.map(|rgb| rgb / 255.0)),
        LoadedImage::Linear(image) => Development::Radiance {
            exposure: 0.0,
            tone: Tone::Filmic,
        }
        .develop(&image.map(|rgb| rgb * gain)),
    };
    levels.bytes().to_vec()
}

/// What brings the mean of the reference's lit, finite values to middle grey.
fn gain_of(pixels: &LoadedImage) -> f32 {
    let values = pixels.values().pixels().iter().flat_map(|p| p.to_array());
    let lit = values.filter(|value| value.is_finite() && *value > 0.0);
    let (sum, count) = lit.fold((0.0, 0), |(sum, count), value| {
        (sum + f64::from(value), count + 1)
    });
    if count == 0 {
        return 1.0;
    }
    (MIDDLE_GREY * f64::from(count) / sum) as f32
}

fn difference(
    reference: &ComparedImage,
    candidate: &ComparedImage,
    mask: Option<&Mask>,
) -> Vec<u8> {
    let differences = PixelDifferences::of(reference, candidate, mask);
    let finite = differences.counted().map(|pixel| pixel.largest);
    let largest = finite
        .filter(|largest| largest.is_finite())
        .fold(0.0, f64::max);
    let level = |apart: f64| {
        if apart > 0.0 {
            (LEAST_LEVEL + (255.0 - LEAST_LEVEL) * apart / largest).min(255.0) as u8
        } else {
            0
        }
    };
    let expected = reference.pixels().values().pixels().iter();
    let both = expected.zip(candidate.pixels().values().pixels());
    let pixels = differences.pixels.iter().zip(both);
    let colour = |pixel: &PixelDifference, expected: Vec3, actual: Vec3| {
        if pixel.ignored {
            return IGNORED;
        }
        if pixel.largest.is_infinite() {
            return NOT_FINITE;
        }
        let channels = (actual.as_dvec3() - expected.as_dvec3()).abs().to_array();
        channels.map(|channel| level(channel).max(level(pixel.alpha)))
    };
    pixels
        .flat_map(|(pixel, (&expected, &actual))| colour(pixel, expected, actual))
        .collect()
}

/// Panels of a size and their levels, aligned at the top.
fn side_by_side(panels: [([u32; 2], &Vec<u8>); 3]) -> EncodedImage {
    let width = panels.iter().map(|(size, _)| size[0]).sum::<u32>() + 2 * GAP;
    let height = panels.iter().map(|(size, _)| size[1]).fold(0, u32::max);
    let mut bytes = Vec::with_capacity(3 * width as usize * height as usize);
    for y in 0..height as usize {
        for (index, ([panel_width, panel_height], levels)) in panels.iter().enumerate() {
            if index > 0 {
                bytes.extend(BACKGROUND.repeat(GAP as usize));
            }
            let row = 3 * *panel_width as usize;
            if y < *panel_height as usize {
                bytes.extend_from_slice(&levels[y * row..(y + 1) * row]);
            } else {
                bytes.extend(BACKGROUND.repeat(*panel_width as usize));
            }
        }
    }
    EncodedImage::of_bytes(width, height, bytes).expect("every row has the panels' width")
}
