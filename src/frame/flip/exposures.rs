//! The exposures of HDR-FLIP, and how an exposed colour is shown.

use glam::{DVec3, Vec3};

use crate::frame::Image;
use crate::maths::functions::{exp2, log2};
use crate::maths::order::Order;

/// Luminance of the channels of linear Rec.709 RGB, with the digits that the
/// standard gives.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);
/// ACES as fitted by Narkowicz (2016), with its factor of 0.6 before the
/// curve: (n2 x² + n1 x) / (d2 x² + d1 x + d0).
const NUMERATOR: [f64; 2] = [2.51 * 0.36, 0.03 * 0.6];
const DENOMINATOR: [f64; 3] = [2.43 * 0.36, 0.59 * 0.6, 0.14];
/// Share of white to which the tone curve takes the largest luminance at the
/// lowest exposure, and the median luminance at the highest.
const SHOWN_AS: f64 = 0.85;
/// Luminances below this count as this. The paper's rule wants the logarithm of
/// the median, which is that of 0 where half of the image is black; the
/// package `flip-evaluator` takes the machine epsilon of single precision
/// there, and so does this. Where even the largest luminance is below it (a
/// black image, for which the package gives up), both exposures are the one
/// that belongs to this luminance, at which light in the candidate is an error
/// and none is not.
const DARKEST: f64 = f32::EPSILON as f64;

/// Exposures at which HDR images are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Exposures {
    /// Lowest, EV.
    pub(super) start: f64,
    /// Highest, EV.
    pub(super) stop: f64,
    /// How many there are from start to stop.
    pub(super) count: u32,
}

impl Exposures {
    /// From the luminances of the reference alone, so that candidates are
    /// comparable. Pixels that are not finite have no say.
    pub(super) fn of(reference: &Image) -> Self {
        let finite = reference.pixels().iter().filter(|pixel| pixel.is_finite());
        let mut luminances: Vec<f64> = finite
            .map(|pixel| LUMINANCE.dot(pixel.as_dvec3()))
            .collect();
        luminances.sort_unstable_by(f64::total_cmp);
        // Of an even number of pixels, the upper of the two in the middle.
        let of_rank = |rank: usize| {
            luminances
                .get(rank)
                .copied()
                .unwrap_or(0.0)
                .at_least(DARKEST)
        };
        let median = of_rank(luminances.len() / 2);
        let largest = of_rank(luminances.len().saturating_sub(1));
        let shown = value_shown_as(SHOWN_AS);
        let (start, stop) = (log2(shown / largest), log2(shown / median));
        Self {
            start,
            stop,
            // Steps of about one stop; at most 152 over the range of f32.
            count: ((stop - start).ceil() as u32).max(2),
        }
    }

    /// Factors of radiance, ascending, each once.
    pub(super) fn gains(self) -> Vec<f64> {
        let step = (self.stop - self.start) / f64::from(self.count - 1);
        let mut gains: Vec<f64> = (0..self.count)
            .map(|index| exp2(self.start + f64::from(index) * step))
            .collect();
        gains.dedup();
        gains
    }
}

/// What an exposed pixel looks like: linear RGB, 0 to 1. Channels below 0 are
/// no light and count as 0; the fitted curve would bring them back above 0.
pub(super) fn tone_mapped(pixel: Vec3, gain: f64) -> DVec3 {
    (pixel.as_dvec3() * gain).max(DVec3::ZERO).map(aces)
}

fn aces(x: f64) -> f64 {
    let numerator = x * (NUMERATOR[0] * x + NUMERATOR[1]);
    let denominator = x * (DENOMINATOR[0] * x + DENOMINATOR[1]) + DENOMINATOR[2];
    (numerator / denominator).at_most(1.0)
}

/// The value that the tone curve takes to `shown`, 0 to 1: the positive root of
/// a x² + b x + c = 0, with c < 0 < a.
fn value_shown_as(shown: f64) -> f64 {
    let a = NUMERATOR[0] - shown * DENOMINATOR[0];
    let b = NUMERATOR[1] - shown * DENOMINATOR[1];
    let c = -shown * DENOMINATOR[2];
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        let pixels = values.iter().copied().map(Vec3::splat).collect();
        Image::new(values.len() as u32, 1, pixels).unwrap()
    }

    #[test]
    fn the_root_is_where_the_curve_says() {
        assert!((aces(value_shown_as(0.85)) - 0.85).abs() < 1e-12);
        assert_eq!(aces(0.0), 0.0);
        assert_eq!(aces(1e60), 1.0);
    }

    /// Exposures that `flip-evaluator` 1.7 gives for these greys; it computes in
    /// single precision, whose steps at 24 are 2e-6.
    #[test]
    fn exposures_are_those_of_the_package() {
        const ITS_ROUNDING: f64 = 4e-6;
        for (values, start, stop, count) in [
            (
                &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0][..],
                -1.501_665_4,
                -0.916_702_8,
                2,
            ),
            (&[1.0, 2.0, 3.0, 4.0, 5.0], -1.238_630_9, -0.501_665_4, 2),
            (&[1e-4, 1e-4, 1e-4, 3.0], -0.501_665_4, 14.371_010, 15),
            (&[0.0, 0.0, 0.0, 5.0], -1.238_630_9, 24.083_298, 26),
            (&[2.0, 2.0], 0.083_297_2, 0.083_297_2, 2),
            (&[1e9, 1e9, 2e9], -29.814_056, -28.814_056, 2),
        ] {
            let exposures = Exposures::of(&grey(values));
            assert!((exposures.start - start).abs() < ITS_ROUNDING, "{values:?}");
            assert!((exposures.stop - stop).abs() < ITS_ROUNDING, "{values:?}");
            assert_eq!(exposures.count, count, "{values:?}");
        }
    }

    #[test]
    fn black_strange_and_extreme_references_have_finite_exposures() {
        for values in [
            &[0.0, 0.0][..],
            &[f32::NAN, f32::INFINITY],
            &[-1.0, -2.0],
            &[0.0, 0.0, f32::MAX],
            &[f32::MAX, f32::MAX],
            &[1e-30, 1e-20],
        ] {
            let exposures = Exposures::of(&grey(values));
            let gains = exposures.gains();
            assert!(exposures.start <= exposures.stop, "{exposures:?}");
            assert!((2..=152).contains(&exposures.count), "{exposures:?}");
            assert!(gains.iter().all(|gain| gain.is_finite() && *gain > 0.0));
        }
    }
}
