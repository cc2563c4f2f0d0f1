//! One side of a comparison.

use crate::frame::{
    EncodedImage, Image, ImageSizeError, LoadedImage, Metadata, MetadataDifference,
};

/// An image with all that a comparison looks at: what a file holds, or a
/// picture in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedImage {
    pixels: LoadedImage,
    /// One value a pixel.
    alpha: Option<Vec<f32>>,
    metadata: Metadata,
}

impl ComparedImage {
    /// An opaque image without metadata.
    pub fn new(pixels: LoadedImage) -> Self {
        Self {
            pixels,
            alpha: None,
            metadata: Metadata::default(),
        }
    }

    /// The levels of a picture, as its PNG has them.
    pub fn of_levels(picture: &EncodedImage) -> Self {
        Self::new(LoadedImage::Levels(picture.levels()))
    }

    /// Linear values, as an EXR has them.
    pub fn of_linear(image: Image) -> Self {
        Self::new(LoadedImage::Linear(image))
    }

    /// The image with an alpha a pixel, row by row from the top, in the unit of
    /// its colours: opaque is 255 beside levels, 1 beside linear values.
    ///
    /// # Errors
    /// If there are not as many as pixels.
    pub fn with_alpha(self, alpha: Vec<f32>) -> Result<Self, ImageSizeError> {
        let [width, height] = self.size();
        if alpha.len() != self.pixels.values().pixels().len() {
            return Err(ImageSizeError {
                width,
                height,
                pixel_count: alpha.len(),
            });
        }
        Ok(Self {
            alpha: Some(alpha),
            ..self
        })
    }

    /// The image with what its file says of it.
    #[must_use]
    pub fn with_metadata(self, metadata: Metadata) -> Self {
        Self { metadata, ..self }
    }

    /// Colours: levels or linear values.
    pub fn pixels(&self) -> &LoadedImage {
        &self.pixels
    }

    /// The colours alone.
    pub fn into_pixels(self) -> LoadedImage {
        self.pixels
    }

    /// Alpha by pixel, where the image has one.
    pub fn alpha(&self) -> Option<&[f32]> {
        self.alpha.as_deref()
    }

    /// What the file says of how the image was made.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// In what a candidate says of itself otherwise than this reference; nothing
    /// where one of them says nothing, as files of other programs do.
    pub fn metadata_differences(&self, candidate: &Self) -> Vec<MetadataDifference> {
        if self.metadata.is_empty() || candidate.metadata.is_empty() {
            return Vec::new();
        }
        self.metadata.differences(&candidate.metadata)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        let values = self.pixels.values();
        [values.width(), values.height()]
    }

    /// Alpha of a pixel; an image without is opaque.
    pub(super) fn alpha_at(&self, index: usize) -> f32 {
        self.alpha
            .as_ref()
            .map_or(self.white(), |alpha| alpha[index])
    }

    /// The value of white, and of what is opaque.
    pub(super) fn white(&self) -> f32 {
        match self.pixels {
            LoadedImage::Levels(_) => 255.0,
            LoadedImage::Linear(_) => 1.0,
        }
    }
}
