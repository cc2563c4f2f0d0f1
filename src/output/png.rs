//! PNG: 8-bit levels out, 8- or 16-bit levels in.

use std::io::Cursor;

use glam::Vec3;
use image::codecs::png::{PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, Limits};

use super::{CodecError, Format, LoadedImage, Picture};
use crate::frame::{EncodedImage, Image};

/// 16-bit levels a level of 8 bits: 65,535 / 255.
const SIXTEEN_BIT_LEVELS: f32 = 257.0;

pub(super) const FORMAT: Format = Format {
    extension: "png",
    encode,
    decode,
};

fn encode(frame: Picture<'_>) -> Result<Vec<u8>, CodecError> {
    encode_levels(frame.encoded)
}

pub(super) fn encode_levels(image: &EncodedImage) -> Result<Vec<u8>, CodecError> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(
        image.bytes(),
        image.width(),
        image.height(),
        ExtendedColorType::Rgb8,
    )?;
    Ok(bytes)
}

/// The largest frame that a camera may have; a header that asks for more is
/// refused before memory is.
fn size_limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_image_width = Some(16_384);
    limits.max_image_height = Some(16_384);
    limits
}

/// Grey becomes RGB, alpha is ignored.
fn decode(bytes: &[u8]) -> Result<LoadedImage, CodecError> {
    let mut decoder = PngDecoder::new(Cursor::new(bytes))?;
    decoder.set_limits(size_limits())?;
    let sixteen_bits = decoder.color_type().bytes_per_pixel()
        == 2 * u16::from(decoder.color_type().channel_count()) as u8;
    let (width, height) = decoder.dimensions();
    let image = DynamicImage::from_decoder(decoder)?;
    let pixels = if sixteen_bits {
        let levels = image.into_rgb16();
        let level = |level: u16| f32::from(level) / SIXTEEN_BIT_LEVELS;
        levels
            .pixels()
            .map(|rgb| Vec3::from(rgb.0.map(level)))
            .collect()
    } else {
        let levels = image.into_rgb8();
        levels
            .pixels()
            .map(|rgb| Vec3::from(rgb.0.map(f32::from)))
            .collect()
    };
    Ok(LoadedImage::Levels(Image::new(width, height, pixels)?))
}
