//! How far two images of one size are apart, in numbers.

use super::{ComparedImage, pixels::PixelDifferences};
use crate::frame::{
    Difference, FlipMap, Image, LoadedImage, PIXELS_PER_DEGREE, compare, flip, hdr_flip,
};

/// Side of the blocks over which noise and edges are averaged out, pixels.
const BLOCK: u32 = 8;

/// All figures of a comparison. They are of the pixels that no mask ignores;
/// where one of them is infinite or not a number, all that is no count and not
/// of FLIP is infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Pixels of the image.
    pub pixels: u64,
    /// Pixels that the mask ignores.
    pub ignored_pixels: u64,
    /// Largest difference of a channel, alpha included: levels or linear values.
    pub max_channel_difference: f64,
    /// Largest difference of alpha; `None`: neither image has it.
    pub max_alpha_difference: Option<f64>,
    /// Pixels with a channel that is not equal.
    pub differing_pixels: u64,
    /// Pixels with a channel that is infinite or not a number in either image.
    pub non_finite_pixels: u64,
    /// Root of the mean square difference of a colour channel, levels or linear
    /// values.
    pub rmse: f64,
    /// sqrt(sum of squared differences / sum of squared reference values), of
    /// linear light.
    pub relative_rmse: f64,
    /// (sum of the candidate - sum of the reference) / sum of the reference, of
    /// linear light.
    pub bias: f64,
    /// `relative_rmse` of means over squares of 8 x 8 pixels.
    pub relative_rmse_8x8: f64,
    /// Which FLIP the others are of.
    pub flip_measure: FlipMeasure,
    /// Mean of FLIP.
    pub flip_mean: f64,
    /// FLIP that half of the pixels do not exceed.
    pub flip_median: f64,
    /// FLIP that 95 % of the pixels do not exceed.
    pub flip_p95: f64,
    /// FLIP that 99 % of the pixels do not exceed.
    pub flip_p99: f64,
    /// Largest FLIP.
    pub flip_max: f64,
}

/// A variant of FLIP.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlipMeasure {
    /// Of levels, as a screen shows them.
    Ldr,
    /// Of linear values, over all exposures that show something.
    Hdr,
}

impl FlipMeasure {
    /// The name in the papers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ldr => "LDR-FLIP",
            Self::Hdr => "HDR-FLIP",
        }
    }
}

/// A figure as reports have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Figure {
    /// A number of pixels.
    Count(u64),
    /// Any other number; infinite where it has no value.
    Number(f64),
}

impl Figures {
    /// Share of the compared pixels that differ, 0 to 1.
    pub fn differing_share(&self) -> f64 {
        self.differing_pixels as f64 / (self.pixels - self.ignored_pixels) as f64
    }

    /// All figures by their keys in reports.
    pub fn entries(&self) -> Vec<(&'static str, Figure)> {
        let counts = [
            ("pixels", self.pixels),
            ("ignored_pixels", self.ignored_pixels),
            ("differing_pixels", self.differing_pixels),
            ("non_finite_pixels", self.non_finite_pixels),
        ];
        let numbers = [
            ("differing_share", self.differing_share()),
            ("max_channel_difference", self.max_channel_difference),
            ("rmse", self.rmse),
            ("relative_rmse", self.relative_rmse),
            ("bias", self.bias),
            ("relative_rmse_8x8", self.relative_rmse_8x8),
            ("flip_mean", self.flip_mean),
            ("flip_median", self.flip_median),
            ("flip_p95", self.flip_p95),
            ("flip_p99", self.flip_p99),
            ("flip_max", self.flip_max),
        ];
        let counts = counts.map(|(key, count)| (key, Figure::Count(count)));
        let numbers = numbers.map(|(key, number)| (key, Figure::Number(number)));
        let alpha = self.max_alpha_difference.map(Figure::Number);
        let alpha = alpha.map(|figure| ("max_alpha_difference", figure));
        counts.into_iter().chain(numbers).chain(alpha).collect()
    }

    /// The figures as lines for a person.
    pub fn text(&self) -> String {
        let percent = |share: f64| format!("{:.3} %", share * 100.0);
        let mut text = format!(
            "{} of {} pixels differ ({}), by {} at most; RMSE {:.5}\n\
             linear light: relRMSE {}, over 8 x 8 pixels {}, bias {:+.3} %\n\
             {}: mean {:.5}, median {:.5}, 95th percentile {:.5}, 99th {:.5}, max {:.5}",
            self.differing_pixels,
            self.pixels - self.ignored_pixels,
            percent(self.differing_share()),
            self.max_channel_difference,
            self.rmse,
            percent(self.relative_rmse),
            percent(self.relative_rmse_8x8),
            self.bias * 100.0,
            self.flip_measure.name(),
            self.flip_mean,
            self.flip_median,
            self.flip_p95,
            self.flip_p99,
            self.flip_max,
        );
        if let Some(alpha) = self.max_alpha_difference.filter(|&alpha| alpha > 0.0) {
            text.push_str(&format!("\nalpha differs by {alpha} at most"));
        }
        if self.non_finite_pixels > 0 {
            let count = self.non_finite_pixels;
            text.push_str(&format!(
                "\n{count} pixels are infinite or not a number, which equals nothing"
            ));
        }
        if self.ignored_pixels > 0 {
            text.push_str(&format!(
                "\nthe mask ignores {} pixels",
                self.ignored_pixels
            ));
        }
        text
    }
}

/// All figures, and FLIP by pixel.
pub(super) fn measure(
    reference: &ComparedImage,
    candidate: &ComparedImage,
    differences: &PixelDifferences,
) -> (Figures, FlipMap) {
    let [expected, actual] =
        [reference, candidate].map(|image| counted_pixels(image.pixels(), differences));
    let values = compared(expected.values(), actual.values());
    let [expected, actual] = [&expected, &actual].map(LoadedImage::to_linear);
    let linear = compared(&expected, &actual);
    let blocks = compared(&expected.block_means(BLOCK), &actual.block_means(BLOCK));
    let (flip_measure, flip_map) = flip_of(reference, candidate, differences);
    let flip = Flips::of(&flip_map, differences);
    let pixels = differences.pixels.len() as u64;
    let counted = |is: fn(f64) -> bool| {
        let pixels = differences.counted();
        pixels.filter(|pixel| is(pixel.largest)).count() as u64
    };
    let most = |most: f64, x: f64| if x > most { x } else { most };
    let largest = differences.counted().map(|pixel| pixel.largest);
    let alphas = differences.counted().map(|pixel| pixel.alpha);
    let figures = Figures {
        pixels,
        ignored_pixels: pixels - differences.compared,
        max_channel_difference: largest.fold(0.0, most),
        max_alpha_difference: differences.has_alpha.then(|| alphas.fold(0.0, most)),
        differing_pixels: counted(|largest| largest > 0.0),
        non_finite_pixels: counted(f64::is_infinite),
        // Of the pixels that count, not of all.
        rmse: values.rmse * (pixels as f64 / differences.compared as f64).sqrt(),
        relative_rmse: linear.relative_rmse,
        bias: linear.bias,
        relative_rmse_8x8: blocks.relative_rmse,
        flip_measure,
        flip_mean: flip.mean(),
        flip_median: flip.percentile(50.0),
        flip_p95: flip.percentile(95.0),
        flip_p99: flip.percentile(99.0),
        flip_max: flip.percentile(100.0),
    };
    (figures, flip_map)
}

fn counted_pixels(pixels: &LoadedImage, differences: &PixelDifferences) -> LoadedImage {
    match pixels {
        LoadedImage::Levels(image) => LoadedImage::Levels(differences.without_ignored(image)),
        LoadedImage::Linear(image) => LoadedImage::Linear(differences.without_ignored(image)),
    }
}

fn compared(expected: &Image, actual: &Image) -> Difference {
    compare(expected, actual).expect("the sizes were found equal")
}

fn flip_of(
    reference: &ComparedImage,
    candidate: &ComparedImage,
    differences: &PixelDifferences,
) -> (FlipMeasure, FlipMap) {
    let (expected, actual) = (reference.pixels().values(), candidate.pixels().values());
    let [expected, actual] = differences.without_excused(expected, actual);
    let (measure, map) = match reference.pixels() {
        LoadedImage::Levels(_) => {
            let map = flip(&expected, &actual, PIXELS_PER_DEGREE);
            (FlipMeasure::Ldr, map)
        }
        LoadedImage::Linear(_) => {
            let found = hdr_flip(&expected, &actual, PIXELS_PER_DEGREE);
            (FlipMeasure::Hdr, found.map(|found| found.map))
        }
    };
    (measure, map.expect("the sizes were found equal"))
}

/// FLIP of the pixels that count: at least one.
struct Flips {
    /// Row by row.
    errors: Vec<f32>,
    sorted: Vec<f32>,
}

impl Flips {
    fn of(map: &FlipMap, differences: &PixelDifferences) -> Self {
        let errors = map.values().iter().zip(&differences.pixels);
        let errors = errors.filter(|(_, pixel)| !pixel.ignored);
        let errors: Vec<f32> = errors.map(|(&error, _)| error).collect();
        let mut sorted = errors.clone();
        sorted.sort_by(f32::total_cmp);
        Self { errors, sorted }
    }

    fn mean(&self) -> f64 {
        let sum: f64 = self.errors.iter().map(|&error| f64::from(error)).sum();
        sum / self.errors.len() as f64
    }

    /// As [`FlipMap::percentile`].
    fn percentile(&self, percent: f64) -> f64 {
        let last = self.sorted.len() - 1;
        let place = percent / 100.0 * last as f64;
        let below = place.floor() as usize;
        let [low, high] = [below, (below + 1).min(last)].map(|index| f64::from(self.sorted[index]));
        low + (place - place.floor()) * (high - low)
    }
}
