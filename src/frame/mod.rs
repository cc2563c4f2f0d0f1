//! Frames as values: the linear RGB [`Image`], its way to 8-bit levels
//! (exposure, tone curve, sRGB), the comparison of two images (by value, and by
//! what an observer sees of it), and digests.
//!
//! Comes in: linear radiance. Goes out: levels, differences, hex strings.
//! No file is read or written here.

mod digest;
mod flip;
mod image;
mod loaded;
mod metadata;
mod metrics;
mod tone;

pub use self::flip::{FlipMap, HdrFlip, PIXELS_PER_DEGREE, flip, hdr_flip};
pub use self::image::{Image, ImageSizeError};
pub use self::loaded::LoadedImage;
pub use self::metadata::{Metadata, MetadataDifference};
pub use self::metrics::{Difference, SizeMismatch, compare};
pub use self::tone::EncodedImage;
pub(crate) use self::tone::{Development, decode_levels};
