//! OpenEXR: linear float RGB out and in.

use std::io::Cursor;

use glam::Vec3;
use image::codecs::openexr::{OpenExrDecoder, OpenExrEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder};

use super::{CodecError, Format, LoadedImage, Picture};
use crate::frame::Image;

pub(super) const FORMAT: Format = Format {
    extension: "exr",
    encode,
    decode,
};

fn encode(frame: Picture<'_>) -> Result<Vec<u8>, CodecError> {
    let image = frame.linear;
    // The encoder takes values as bytes in the machine's own order.
    let values: Vec<u8> = image
        .pixels()
        .iter()
        .flat_map(|pixel| pixel.to_array())
        .flat_map(f32::to_ne_bytes)
        .collect();
    let mut bytes = Cursor::new(Vec::new());
    OpenExrEncoder::new(&mut bytes).write_image(
        &values,
        image.width(),
        image.height(),
        ExtendedColorType::Rgb32F,
    )?;
    Ok(bytes.into_inner())
}

/// Half floats become floats, alpha is ignored.
fn decode(bytes: &[u8]) -> Result<LoadedImage, CodecError> {
    let decoder = OpenExrDecoder::with_alpha_preference(Cursor::new(bytes), Some(false))?;
    let (width, height) = decoder.dimensions();
    let values = DynamicImage::from_decoder(decoder)?.into_rgb32f();
    let pixels = values.pixels().map(|rgb| Vec3::from(rgb.0)).collect();
    Ok(LoadedImage::Linear(Image::new(width, height, pixels)?))
}
