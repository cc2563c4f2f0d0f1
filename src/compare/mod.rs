//! How far a picture is from the one it should be, and whether that is near
//! enough.
//!
//! Comes in: a reference and a candidate as [`ComparedImage`]s, [`Limits`], and
//! maybe a [`Mask`]. Goes out: a [`Judgement`] with every figure, the limits
//! that failed and the limits that would have passed; and a picture of both
//! sides with their difference between them ([`strip`]). No file is read or
//! written here.
//!
//! What counts as a difference:
//!
//! * Pixels are compared as they are decoded: sRGB levels 0 to 255 of a PNG
//!   (16-bit levels / 257), linear values of an EXR.
//! * Alpha is compared where either image has it; an image without is opaque.
//!   It counts as a fourth channel of the largest difference and of differing
//!   pixels. RMSE, bias and FLIP are of colours alone, as they are stored.
//! * Infinity and NaN are equal to nothing, not even to themselves.
//! * Another size is a difference, and the only one that is told then.
//! * A pixel that the mask ignores counts for nothing, in no figure.

mod figures;
mod heat;
mod limits;
mod mask;
mod passing;
mod pixels;
mod strip;
mod subject;
#[cfg(test)]
mod tests;

pub use figures::{Figure, Figures, FlipMeasure};
pub use heat::HeatScale;
pub use limits::{Failure, Limits};
pub use mask::{Mask, MaskError};
pub use passing::PassingLimits;
pub(crate) use strip::shown;
pub use strip::strip;
pub use subject::ComparedImage;

use crate::frame::{FlipMap, LoadedImage, SizeMismatch};
use pixels::PixelDifferences;

/// Images, limits and mask do not go together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum JudgeError {
    /// Levels against linear values.
    #[error(
        "a PNG and an EXR hold different things (levels, linear values); compare two of a kind"
    )]
    Kinds,
    /// The mask belongs to other images.
    #[error(
        "the mask has {} x {} pixels and the images {} x {}; make one of the images' size",
        mask[0], mask[1], images[0], images[1]
    )]
    MaskSize {
        /// Width and height of the mask, pixels.
        mask: [u32; 2],
        /// Width and height of the images, pixels.
        images: [u32; 2],
    },
    /// A check that sees no pixel would always pass.
    #[error("the mask is white everywhere and leaves no pixel to compare; darken it somewhere")]
    NothingLeft,
}

/// What came of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// The sizes differ, which no limit allows.
    OfOtherSize(SizeMismatch),
    /// All figures.
    Measured(Box<Measured>),
}

/// The figures of two images of one size, and what the limits say to them.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// How far the images are apart.
    pub figures: Figures,
    /// The limits that do not hold; empty: the candidate passes.
    pub failures: Vec<Failure>,
    /// The smallest limits that would let it pass.
    pub passing: PassingLimits,
    /// FLIP by pixel; what the mask allows or ignores is taken out before.
    pub flip_map: FlipMap,
}

impl Judgement {
    /// Whether the candidate is as near to the reference as the limits ask.
    pub fn passes(&self) -> bool {
        match self {
            Self::OfOtherSize(_) => false,
            Self::Measured(measured) => measured.failures.is_empty(),
        }
    }

    /// Whether no pixel differs that counts.
    pub fn is_equal(&self) -> bool {
        self.measured()
            .is_some_and(|measured| measured.figures.differing_pixels == 0)
    }

    /// The figures, if the sizes agree.
    pub fn measured(&self) -> Option<&Measured> {
        match self {
            Self::OfOtherSize(_) => None,
            Self::Measured(measured) => Some(measured),
        }
    }

    /// What does not hold, one sentence each; empty: the candidate passes.
    pub fn failures(&self) -> Vec<String> {
        match self {
            Self::OfOtherSize(mismatch) => vec![mismatch.to_string()],
            Self::Measured(measured) => measured.failures.iter().map(Failure::to_string).collect(),
        }
    }
}

/// Compares `candidate` with `reference` and judges the difference by `limits`
/// (see [`Limits`] for how they combine) and `mask`.
///
/// # Errors
/// If one image has levels and the other linear values, or the mask has another
/// size than the images or ignores all of them.
pub fn judge(
    reference: &ComparedImage,
    candidate: &ComparedImage,
    limits: &Limits,
    mask: Option<&Mask>,
) -> Result<Judgement, JudgeError> {
    let levels = |image: &ComparedImage| matches!(image.pixels(), LoadedImage::Levels(_));
    if levels(reference) != levels(candidate) {
        return Err(JudgeError::Kinds);
    }
    let (size, candidate_size) = (reference.size(), candidate.size());
    if size != candidate_size {
        return Ok(Judgement::OfOtherSize(SizeMismatch {
            reference: size,
            candidate: candidate_size,
        }));
    }
    if let Some(mask) = mask.filter(|mask| mask.size() != size) {
        return Err(JudgeError::MaskSize {
            mask: mask.size(),
            images: size,
        });
    }
    let differences = PixelDifferences::of(reference, candidate, mask);
    if differences.compared == 0 {
        return Err(JudgeError::NothingLeft);
    }
    let (figures, flip_map) = figures::measure(reference, candidate, &differences);
    let beyond = differences.beyond(limits.channel_limit());
    Ok(Judgement::Measured(Box::new(Measured {
        failures: limits.failures(&figures, &differences, beyond),
        passing: PassingLimits::of(limits, &figures, &differences, beyond),
        figures,
        flip_map,
    })))
}
