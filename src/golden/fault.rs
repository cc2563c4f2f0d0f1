//! Frames that test nothing, or that no comparison can judge.

use glam::Vec3;

use crate::frame::Image;

/// What is wrong with a frame by itself: it fails whatever its golden holds, and
/// never becomes a golden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FrameFault {
    /// Pixels that are infinite or not a number.
    #[error("the frame has pixels that are infinite or not a number: {pixels}")]
    NotFinite {
        /// Their number.
        pixels: u64,
    },
    /// No pixel is above 0.
    #[error("the frame is black everywhere; no light reaches what the camera sees")]
    Black,
    /// All pixels are equal.
    #[error("every pixel of the frame is the same; a golden of it would test nothing")]
    Constant,
}

impl FrameFault {
    /// The word that stands for it in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } => "not-finite",
            Self::Black => "black",
            Self::Constant => "constant",
        }
    }

    /// What is wrong with linear values, or with levels taken as numbers.
    pub(super) fn of(values: &Image) -> Option<Self> {
        let pixels = values.pixels();
        let not_finite = pixels.iter().filter(|pixel| !pixel.is_finite()).count();
        if not_finite > 0 {
            return Some(Self::NotFinite {
                pixels: not_finite as u64,
            });
        }
        if pixels.iter().all(|pixel| pixel.cmple(Vec3::ZERO).all()) {
            return Some(Self::Black);
        }
        let is_constant = pixels.iter().all(|pixel| *pixel == pixels[0]);
        is_constant.then_some(Self::Constant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_told_apart() {
        let image = |pixels: [Vec3; 2]| Image::new(2, 1, pixels.to_vec()).unwrap();
        let grey = Vec3::splat(0.5);
        let nan = Vec3::new(0.0, f32::NAN, 0.0);
        for (pixels, fault) in [
            ([grey, Vec3::ONE], None),
            ([grey, grey], Some(FrameFault::Constant)),
            ([Vec3::ZERO, -grey], Some(FrameFault::Black)),
            ([Vec3::ZERO, grey], None),
            ([nan, grey], Some(FrameFault::NotFinite { pixels: 1 })),
            (
                [nan, Vec3::splat(f32::INFINITY)],
                Some(FrameFault::NotFinite { pixels: 2 }),
            ),
        ] {
            assert_eq!(FrameFault::of(&image(pixels)), fault, "{pixels:?}");
        }
    }
}
