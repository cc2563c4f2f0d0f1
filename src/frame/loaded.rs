//! The values of an image, and what they mean.

use super::{Image, decode_levels};

/// What an image file holds.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadedImage {
    /// sRGB levels 0 to 255; 16-bit levels are divided by 257.
    Levels(Image),
    /// Linear values.
    Linear(Image),
}

impl LoadedImage {
    /// The values as they stand in the file: levels or linear.
    pub fn values(&self) -> &Image {
        match self {
            Self::Levels(image) | Self::Linear(image) => image,
        }
    }

    /// Linear values in any case: levels are decoded from sRGB.
    pub fn to_linear(&self) -> Image {
        match self {
            Self::Levels(levels) => decode_levels(levels),
            Self::Linear(image) => image.clone(),
        }
    }
}
