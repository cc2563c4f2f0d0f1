//! What the scene file says of its golden image.

use std::path::PathBuf;

/// `[golden]`: how far a frame may be from its golden image, not at all by
/// default, and with what the frame for it is drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GoldenKeys {
    /// Largest difference of a channel: 8-bit levels for PNG, linear values
    /// for EXR.
    pub max_channel_difference: Option<f64>,
    /// Most pixels that may differ by more than that.
    pub max_differing_pixels: Option<PixelLimit>,
    /// Largest mean FLIP error, 0 to 1.
    pub max_flip: Option<f64>,
    /// Image of levels that are allowed a pixel, resolved against the scene
    /// file's folder.
    pub mask: Option<PathBuf>,
    /// What the golden's frame changes of the scene, each as `--set` has it: a
    /// smaller picture, a cheaper bake.
    pub set: Vec<String>,
}

/// A number of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PixelLimit {
    /// So many.
    Count(u32),
    /// A share of the picture, 0 to 1.
    Share(f64),
}
