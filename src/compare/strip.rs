//! `expected | difference | actual`, side by side.

use super::{
    ComparedImage, Mask,
    pixels::{PixelDifference, PixelDifferences},
};
use crate::frame::{Development, EncodedImage, LoadedImage};
use crate::maths::order::Order;
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
/// The difference is that of the shown levels by channel, the picture's largest
/// as white, and any difference of the files as dark grey at least; alpha is grey
/// on top; violet is what is infinite or not a number, dark blue what the mask
/// ignores. Linear values are shown through the filmic curve, both sides under
/// the exposure that makes the reference's mean middle grey. Of images of two
/// sizes, the difference stays empty.
pub fn strip(
    reference: &ComparedImage,
    candidate: &ComparedImage,
    mask: Option<&Mask>,
) -> EncodedImage {
    let [expected, actual] = shown(reference, candidate).map(|levels| levels.bytes().to_vec());
    let [width, height] = reference.size();
    let same_size = reference.size() == candidate.size();
    let mask = mask.filter(|mask| mask.size() == reference.size());
    let difference = if same_size {
        let differences = PixelDifferences::of(reference, candidate, mask);
        difference(&differences, &expected, &actual)
    } else {
        BACKGROUND.repeat(width as usize * height as usize)
    };
    side_by_side([
        (reference.size(), &expected),
        (reference.size(), &difference),
        (candidate.size(), &actual),
    ])
}

/// The levels of both images as a screen shows them; linear values as in
/// [`strip`].
pub(crate) fn shown(reference: &ComparedImage, candidate: &ComparedImage) -> [EncodedImage; 2] {
    let gain = gain_of(reference.pixels());
    [reference, candidate].map(|image| levels_of(image.pixels(), gain))
}

fn levels_of(pixels: &LoadedImage, gain: f32) -> EncodedImage {
    match pixels {
        LoadedImage::Levels(levels) => Development::Plain.develop(&levels.map(|rgb| rgb / 255.0)),
        LoadedImage::Linear(image) => Development::Radiance {
            exposure: 0.0,
            tone: Tone::Filmic,
        }
        .develop(&image.map(|rgb| rgb * gain)),
    }
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

/// Levels of the difference of two images of one size, from the levels that are
/// shown of them.
fn difference(differences: &PixelDifferences, expected: &[u8], actual: &[u8]) -> Vec<u8> {
    let (expected, _) = expected.as_chunks::<3>();
    let (actual, _) = actual.as_chunks::<3>();
    let apart: Vec<[u8; 3]> = expected
        .iter()
        .zip(actual)
        .map(|(a, b)| std::array::from_fn(|channel| a[channel].abs_diff(b[channel])))
        .collect();
    let counted = apart.iter().zip(&differences.pixels);
    let counted = counted.filter(|(_, pixel)| !pixel.ignored && pixel.largest.is_finite());
    let largest = counted.flat_map(|(apart, _)| *apart).fold(1, u8::max);
    let pixels = differences.pixels.iter().zip(&apart);
    pixels
        .flat_map(|(pixel, apart)| colour(pixel, *apart, largest, differences.opaque))
        .collect()
}

/// The colour of one pixel's difference of shown levels, in a picture whose
/// largest is `largest`.
fn colour(pixel: &PixelDifference, apart: [u8; 3], largest: u8, opaque: f64) -> [u8; 3] {
    if pixel.ignored {
        return IGNORED;
    }
    if pixel.largest.is_infinite() {
        return NOT_FINITE;
    }
    let level = |share: f64| LEAST_LEVEL + (255.0 - LEAST_LEVEL) * share.at_most(1.0);
    let least = if pixel.alpha > 0.0 {
        level(pixel.alpha / opaque) as u8
    } else if pixel.largest > 0.0 && apart == [0; 3] {
        // Too small to show, and still a difference.
        LEAST_LEVEL as u8
    } else {
        0
    };
    apart.map(|apart| match apart {
        0 => least,
        _ => (level(f64::from(apart) / f64::from(largest)) as u8).max(least),
    })
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
