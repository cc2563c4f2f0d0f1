//! FLIP: the difference that an observer sees when two images alternate on a
//! screen, from 0 (none) to 1 (as far apart as green and blue).
//!
//! Comes in: two images of one size. Goes out: an error a pixel.
//!
//! * LDR-FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild,
//!   "FLIP: A Difference Evaluator for Alternating Images" (2020).
//! * HDR-FLIP: Andersson, Nilsson, Shirley, Akenine-Möller, "Visualizing Errors
//!   in Rendered High Dynamic Range Images" (2021).
//!
//! The way of a pixel: display colour → opponent colours (`colour`) → contrast
//! sensitivity and feature filters (`filters`) → one error out of colour and
//! features (`errors`); `bands` runs it over the rows, `exposures` chooses how
//! an HDR image is shown. All of it is in double precision, which is not
//! slower where the elementary functions weigh as much as the filters.
//!
//! What is not finite is never equal: a pixel with such a channel in either
//! image has the error 1, and so has every pixel whose filters reach it.

mod bands;
mod colour;
mod errors;
mod exposures;
mod filters;

use super::metrics::check_sizes;
use super::{Image, SizeMismatch};
use crate::maths::order::Order;
use bands::{Display, error_map};
use exposures::Exposures;
use filters::Filters;

/// Pixels per degree of visual angle of the papers' observer: a screen of 3840
/// pixels and 0.7 m across, seen from 0.7 m. It is
/// distance x (pixels / width) x (pi / 180).
pub const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * (std::f64::consts::PI / 180.0);

/// Pixels per degree that are evaluated; outside, the nearest of the two counts.
/// Below 1 a pixel is wider than the filters, above 1000 (a pixel of a tenth of
/// what an eye resolves) they are hundreds of pixels wide.
const PIXELS_PER_DEGREE_RANGE: [f64; 2] = [1.0, 1000.0];

/// Errors by pixel, 0 to 1, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub struct FlipMap {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

/// HDR-FLIP: the errors, and the exposures at which they were looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct HdrFlip {
    /// The largest error of a pixel over all exposures.
    pub map: FlipMap,
    /// Lowest exposure, EV (stops).
    pub start_exposure: f64,
    /// Highest exposure, EV (stops).
    pub stop_exposure: f64,
    /// Number of exposures from start to stop, evenly spaced; at least 2.
    pub exposure_count: u32,
}

impl FlipMap {
    /// Width, pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height, pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All errors, row by row from the top.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Mean error, the papers' number for a whole image.
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.values.iter().map(|&error| f64::from(error)).sum();
        sum / self.values.len() as f64
    }

    /// The error that `percent` of the pixels (0 to 100) do not exceed. Every
    /// pixel counts once (the papers also weight pixels by their errors, which
    /// this does not), and between two pixels it is linear.
    pub fn percentile(&self, percent: f64) -> f64 {
        let mut sorted = self.values.clone();
        sorted.sort_by(f32::total_cmp);
        let last = sorted.len() - 1;
        let place = percent.clamp(0.0, 100.0) / 100.0 * last as f64;
        let below = place.floor() as usize;
        let above = (below + 1).min(last);
        let (low, high) = (f64::from(sorted[below]), f64::from(sorted[above]));
        low + (place - place.floor()) * (high - low)
    }

    /// Largest error.
    pub fn max(&self) -> f64 {
        f64::from(self.values.iter().copied().fold(0.0, f32::at_least))
    }
}

/// LDR-FLIP of two images of sRGB levels 0 to 255, whole or not, as
/// [`LoadedImage::Levels`](crate::LoadedImage::Levels) and
/// [`EncodedImage::levels`](crate::EncodedImage::levels) hold them.
///
/// `pixels_per_degree` says how large a pixel is to the observer
/// ([`PIXELS_PER_DEGREE`] for the papers' one); 1 to 1000, others count as the
/// nearest of these.
///
/// # Errors
/// If the sizes differ.
pub fn flip(
    reference: &Image,
    candidate: &Image,
    pixels_per_degree: f64,
) -> Result<FlipMap, SizeMismatch> {
    check_sizes(reference, candidate)?;
    let filters = filters_for(pixels_per_degree);
    let values = error_map(reference, candidate, &filters, &[Display::Levels]);
    Ok(map_of(reference, values))
}

/// HDR-FLIP of two images of linear radiance: the largest LDR-FLIP of a pixel
/// over the exposures at which the reference shows something, through the ACES
/// tone curve. Channels below 0 count as 0.
///
/// `pixels_per_degree` as for [`flip`].
///
/// # Errors
/// If the sizes differ.
pub fn hdr_flip(
    reference: &Image,
    candidate: &Image,
    pixels_per_degree: f64,
) -> Result<HdrFlip, SizeMismatch> {
    check_sizes(reference, candidate)?;
    let filters = filters_for(pixels_per_degree);
    let exposures = Exposures::of(reference);
    let displays: Vec<Display> = exposures
        .gains()
        .into_iter()
        .map(|gain| Display::Exposed { gain })
        .collect();
    let values = error_map(reference, candidate, &filters, &displays);
    Ok(HdrFlip {
        map: map_of(reference, values),
        start_exposure: exposures.start,
        stop_exposure: exposures.stop,
        exposure_count: exposures.count,
    })
}

fn filters_for(pixels_per_degree: f64) -> Filters {
    let [least, most] = PIXELS_PER_DEGREE_RANGE;
    // `max` takes the other operand where one is not a number; `clamp` does not.
    Filters::new(pixels_per_degree.at_least(least).at_most(most))
}

fn map_of(image: &Image, values: Vec<f32>) -> FlipMap {
    FlipMap {
        width: image.width(),
        height: image.height(),
        values,
    }
}

#[cfg(test)]
mod tests;
