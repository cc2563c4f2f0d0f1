//! The difference of every pixel, before limits.

use glam::Vec3;

use super::{ComparedImage, Mask};
use crate::frame::Image;

/// How far the pixels of two images of one size are apart.
pub(super) struct PixelDifferences {
    pub(super) pixels: Vec<PixelDifference>,
    /// Pixels that are not ignored.
    pub(super) compared: u64,
    /// The value of opaque alpha.
    pub(super) opaque: f64,
    /// Whether either image has alpha.
    pub(super) has_alpha: bool,
}

/// The difference of one pixel, in the unit of the values.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelDifference {
    /// Largest difference of a channel, alpha included; infinite if a value is
    /// infinite or not a number.
    pub(super) largest: f64,
    /// Difference of alpha alone.
    pub(super) alpha: f64,
    /// Difference that the mask allows here.
    pub(super) allowance: f64,
    /// Whether the mask takes the pixel out of everything.
    pub(super) ignored: bool,
}

impl PixelDifference {
    /// Whether the pixel differs by more than the mask allows, and than a limit.
    fn is_beyond(&self, limit: f64) -> bool {
        let is_finite = self.largest.is_finite();
        let exceeds = self.largest > limit && self.largest > self.allowance;
        !self.ignored && (!is_finite || exceeds)
    }

    /// Whether the mask lets the pixel pass whatever the limits are.
    fn is_excused(&self) -> bool {
        self.ignored || (self.largest.is_finite() && self.largest <= self.allowance)
    }
}

impl PixelDifferences {
    pub(super) fn of(
        reference: &ComparedImage,
        candidate: &ComparedImage,
        mask: Option<&Mask>,
    ) -> Self {
        let opaque = f64::from(reference.white());
        let level = opaque / 255.0;
        let has_alpha = reference.alpha().is_some() || candidate.alpha().is_some();
        let colours = reference.pixels().values().pixels().iter();
        let colours = colours.zip(candidate.pixels().values().pixels());
        let pixels: Vec<PixelDifference> = colours
            .enumerate()
            .map(|(index, (&expected, &actual))| {
                let alpha = if has_alpha {
                    apart(reference.alpha_at(index), candidate.alpha_at(index))
                } else {
                    0.0
                };
                PixelDifference {
                    largest: largest(expected, actual, alpha),
                    alpha,
                    allowance: mask.map_or(0.0, |mask| mask.allowance(index) * level),
                    ignored: mask.is_some_and(|mask| mask.ignores(index)),
                }
            })
            .collect();
        let compared = pixels.iter().filter(|pixel| !pixel.ignored).count() as u64;
        Self {
            pixels,
            compared,
            opaque,
            has_alpha,
        }
    }

    /// Pixels that count.
    pub(super) fn counted(&self) -> impl Iterator<Item = &PixelDifference> {
        self.pixels.iter().filter(|pixel| !pixel.ignored)
    }

    /// Pixels that differ by more than `limit` and than the mask allows.
    pub(super) fn beyond(&self, limit: f64) -> u64 {
        let pixels = self.pixels.iter();
        pixels.filter(|pixel| pixel.is_beyond(limit)).count() as u64
    }

    /// The smallest limit on channels that no pixel exceeds; infinite where
    /// there is none.
    pub(super) fn largest_beyond_mask(&self) -> f64 {
        let beyond = self.pixels.iter().filter(|pixel| pixel.is_beyond(0.0));
        beyond.fold(0.0, |largest, pixel| larger(largest, pixel.largest))
    }

    /// Pixels whose alpha differs by more than the mask allows.
    pub(super) fn differing_alphas(&self) -> u64 {
        let beyond = |pixel: &&PixelDifference| pixel.alpha > pixel.allowance;
        self.counted().filter(beyond).count() as u64
    }

    /// An image in which ignored pixels are black, so that they add nothing to
    /// any sum.
    pub(super) fn without_ignored(&self, image: &Image) -> Image {
        let mut counted = image.clone();
        for (value, pixel) in counted.pixels_mut().iter_mut().zip(&self.pixels) {
            if pixel.ignored {
                *value = Vec3::ZERO;
            }
        }
        counted
    }

    /// Both images without the differences that the mask allows: there both show
    /// the reference, so that filters which reach farther than a pixel carry
    /// nothing of them to their neighbours.
    pub(super) fn without_excused(&self, reference: &Image, candidate: &Image) -> [Image; 2] {
        let [mut expected, mut actual] = [reference.clone(), candidate.clone()];
        let both = expected.pixels_mut().iter_mut().zip(actual.pixels_mut());
        for ((expected, actual), pixel) in both.zip(&self.pixels) {
            if pixel.is_excused() {
                if !expected.is_finite() {
                    *expected = Vec3::ZERO;
                }
                *actual = *expected;
            }
        }
        [expected, actual]
    }
}

fn largest(expected: Vec3, actual: Vec3, alpha: f64) -> f64 {
    let channels = expected.to_array().into_iter().zip(actual.to_array());
    channels.fold(alpha, |most, (a, b)| larger(most, apart(a, b)))
}

/// |a - b|; infinite where one of them is infinite or not a number.
fn apart(a: f32, b: f32) -> f64 {
    if a.is_finite() && b.is_finite() {
        (f64::from(a) - f64::from(b)).abs()
    } else {
        f64::INFINITY
    }
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}
