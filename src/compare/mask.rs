//! Where a difference is allowed.

use crate::frame::LoadedImage;

/// A grey image of the size of the compared ones. Its level at a pixel (0 to
/// 255) is the difference of a channel that is allowed there, in 8-bit levels;
/// beside linear values a level is 1/255. Where a limit on channels allows more,
/// the limit counts. A white pixel (255) is ignored: it counts for nothing, in
/// no figure, whatever it holds. Any other level allows no NaN and no infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    size: [u32; 2],
    levels: Vec<f32>,
}

/// The image is no mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MaskError {
    /// Linear values are no levels.
    #[error("a mask holds levels of grey; give a PNG")]
    Linear,
    /// Colours say nothing about a difference.
    #[error("the pixel in column {x} of row {y} (from 0) is not grey; a mask has no colours")]
    Coloured {
        /// Column of the pixel.
        x: u32,
        /// Row of the pixel, from the top.
        y: u32,
    },
}

/// Level of a pixel that is ignored.
const IGNORED: f32 = 255.0;

impl Mask {
    /// Takes the levels of an image that is grey everywhere (in a file with
    /// colour channels, where they are equal); alpha has no meaning.
    ///
    /// # Errors
    /// If the image holds linear values or a colour.
    pub fn of_image(image: &LoadedImage) -> Result<Self, MaskError> {
        let LoadedImage::Levels(levels) = image else {
            return Err(MaskError::Linear);
        };
        let is_coloured = |rgb: &glam::Vec3| rgb.x != rgb.y || rgb.y != rgb.z;
        if let Some(index) = levels.pixels().iter().position(is_coloured) {
            let width = levels.width() as usize;
            return Err(MaskError::Coloured {
                x: (index % width) as u32,
                y: (index / width) as u32,
            });
        }
        Ok(Self {
            size: [levels.width(), levels.height()],
            levels: levels.pixels().iter().map(|grey| grey.x).collect(),
        })
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Whether a pixel, by its number from the top left, counts for nothing.
    pub fn ignores(&self, index: usize) -> bool {
        self.levels
            .get(index)
            .is_some_and(|&level| level >= IGNORED)
    }

    /// Levels of 255 that are allowed at a pixel.
    pub(super) fn allowance(&self, index: usize) -> f64 {
        self.levels.get(index).copied().map_or(0.0, f64::from)
    }
}
