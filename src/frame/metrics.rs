//! How far two images are apart.

use glam::Vec3;

use super::Image;

/// Difference of a candidate from a reference, in the unit of the values.
///
/// Where a value of either image is infinite or not a number, the pixel counts
/// as different, even from its equal, and all the measures but the counts are
/// infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Largest |candidate - reference| of a channel.
    pub max_channel: f64,
    /// Pixels with a channel that is not equal.
    pub differing_pixels: u64,
    /// Pixels with a channel that is infinite or not a number in either image.
    pub non_finite_pixels: u64,
    /// Root of the mean square difference of a channel.
    pub rmse: f64,
    /// sqrt(sum of squared differences / sum of squared reference values).
    pub relative_rmse: f64,
    /// (sum of the candidate - sum of the reference) / sum of the reference.
    pub bias: f64,
}

/// The images have different sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the reference has {} x {} pixels and the candidate {} x {}; only images of one size compare",
    reference[0], reference[1], candidate[0], candidate[1]
)]
pub struct SizeMismatch {
    /// Width and height of the reference, pixels.
    pub reference: [u32; 2],
    /// Width and height of the candidate, pixels.
    pub candidate: [u32; 2],
}

/// Compares `candidate` with `reference`.
///
/// # Errors
/// If their sizes differ.
pub fn compare(reference: &Image, candidate: &Image) -> Result<Difference, SizeMismatch> {
    check_sizes(reference, candidate)?;
    let mut sums = Sums::default();
    for (&expected, &actual) in reference.pixels().iter().zip(candidate.pixels()) {
        sums.add(expected, actual);
    }
    Ok(sums.difference(reference.pixels().len()))
}

/// Largest difference of a channel; infinite if a value is infinite or not a
/// number.
pub(crate) fn largest_channel_difference(expected: Vec3, actual: Vec3) -> f32 {
    if !expected.is_finite() || !actual.is_finite() {
        return f32::INFINITY;
    }
    crate::scene::max_component((actual - expected).abs())
}

pub(super) fn check_sizes(reference: &Image, candidate: &Image) -> Result<(), SizeMismatch> {
    let size = |image: &Image| [image.width(), image.height()];
    if size(reference) == size(candidate) {
        return Ok(());
    }
    Err(SizeMismatch {
        reference: size(reference),
        candidate: size(candidate),
    })
}

/// Running sums, in the order of the pixels.
#[derive(Default)]
struct Sums {
    max_channel: f64,
    differing_pixels: u64,
    non_finite_pixels: u64,
    squared_difference: f64,
    squared_reference: f64,
    reference: f64,
    candidate: f64,
}

impl Sums {
    fn add(&mut self, expected: Vec3, actual: Vec3) {
        let largest = f64::from(largest_channel_difference(expected, actual));
        self.differing_pixels += u64::from(largest > 0.0);
        if largest.is_infinite() && !(expected.is_finite() && actual.is_finite()) {
            self.non_finite_pixels += 1;
            return;
        }
        let (expected, actual) = (expected.as_dvec3(), actual.as_dvec3());
        let difference = actual - expected;
        let largest = difference.abs().max_element();
        if largest > self.max_channel {
            self.max_channel = largest;
        }
        self.squared_difference += difference.length_squared();
        self.squared_reference += expected.length_squared();
        self.reference += expected.element_sum();
        self.candidate += actual.element_sum();
    }

    fn difference(self, pixel_count: usize) -> Difference {
        let measure = |value: f64| {
            if self.non_finite_pixels > 0 {
                f64::INFINITY
            } else {
                value
            }
        };
        let mean_square = self.squared_difference / (3.0 * pixel_count as f64);
        let relative_square = ratio(self.squared_difference, self.squared_reference);
        Difference {
            max_channel: measure(self.max_channel),
            differing_pixels: self.differing_pixels,
            non_finite_pixels: self.non_finite_pixels,
            rmse: measure(mean_square.sqrt()),
            relative_rmse: measure(relative_square.sqrt()),
            bias: measure(ratio(self.candidate - self.reference, self.reference)),
        }
    }
}

/// Quotient in which nothing divided by nothing is nothing: two black images
/// are equal.
fn ratio(numerator: f64, denominator: f64) -> f64 {
    if numerator == 0.0 {
        0.0
    } else {
        numerator / denominator
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: &[[f32; 3]]) -> Image {
        let pixels = values.iter().copied().map(Vec3::from_array).collect();
        Image::new(values.len() as u32, 1, pixels).unwrap()
    }

    #[test]
    fn measures_have_their_closed_forms() {
        let reference = image(&[[1.0, 2.0, 2.0], [4.0, 0.0, 0.0]]);
        let candidate = image(&[[1.0, 2.0, 2.0], [1.0, 0.0, 0.0]]);
        let difference = compare(&reference, &candidate).unwrap();
        assert_eq!(difference.max_channel, 3.0);
        assert_eq!(difference.differing_pixels, 1);
        assert_eq!(difference.non_finite_pixels, 0);
        assert_eq!(difference.rmse, (9.0_f64 / 6.0).sqrt());
        assert_eq!(difference.relative_rmse, 3.0 / 5.0);
        assert_eq!(difference.bias, -3.0 / 9.0);
    }

    #[test]
    fn equal_images_differ_by_nothing_even_if_black() {
        let black = image(&[[0.0; 3], [0.0; 3]]);
        let difference = compare(&black, &black).unwrap();
        assert_eq!(difference.relative_rmse, 0.0);
        assert_eq!(difference.bias, 0.0);
        assert_eq!(difference.differing_pixels, 0);
    }

    #[test]
    fn what_is_not_finite_is_never_equal() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let strange = image(&[[0.5; 3], [0.5, value, 0.5]]);
            let difference = compare(&strange, &strange).unwrap();
            assert_eq!(difference.differing_pixels, 1);
            assert_eq!(difference.non_finite_pixels, 1);
            assert_eq!(difference.max_channel, f64::INFINITY);
            assert_eq!(difference.rmse, f64::INFINITY);
        }
    }

    #[test]
    fn sizes_must_agree() {
        let error = compare(&image(&[[0.0; 3]]), &image(&[[0.0; 3]; 2])).unwrap_err();
        assert_eq!(error.reference, [1, 1]);
        assert_eq!(error.candidate, [2, 1]);
    }
}
