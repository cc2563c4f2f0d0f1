//! PNG: 8-bit levels out, levels of any depth in; metadata as text chunks.

use std::io::Cursor;

use glam::Vec3;
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, Limits};
use png::text_metadata::TEXtChunk;
use png::{BitDepth, ColorType, Compression, Decoder, Encoder, Filter};

use super::{CodecError, Format, MOST_SIDE, Picture, PictureMetadata};
use crate::compare::ComparedImage;
use crate::frame::{EncodedImage, Image, LoadedImage, Metadata};

/// 16-bit levels a level of 8 bits: 65,535 / 255.
const SIXTEEN_BIT_LEVELS: f32 = 257.0;
/// The standard's keyword for [`Metadata::SOFTWARE`].
const SOFTWARE_KEYWORD: &str = "Software";

pub(super) const FORMAT: Format = Format {
    extension: "png",
    encode,
    decode,
};

fn encode(frame: Picture<'_>, metadata: &PictureMetadata) -> Result<Vec<u8>, CodecError> {
    encode_levels(frame.encoded, &metadata.encoded)
}

pub(super) fn encode_levels(
    image: &EncodedImage,
    metadata: &Metadata,
) -> Result<Vec<u8>, CodecError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    for (name, value) in metadata.entries() {
        let keyword = match name {
            Metadata::SOFTWARE => SOFTWARE_KEYWORD,
            _ => name,
        };
        encoder.add_text_chunk(keyword.to_owned(), value.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.bytes())?;
    writer.finish()?;
    Ok(bytes)
}

fn size_limits() -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_image_width = Some(MOST_SIDE);
    limits.max_image_height = Some(MOST_SIDE);
    limits
}

/// Grey and palettes become RGB.
fn decode(bytes: &[u8]) -> Result<ComparedImage, CodecError> {
    let mut decoder = PngDecoder::new(Cursor::new(bytes))?;
    decoder.set_limits(size_limits())?;
    let color = decoder.color_type();
    let is_deep = color.bytes_per_pixel() > color.channel_count();
    let (width, height) = decoder.dimensions();
    let image = DynamicImage::from_decoder(decoder)?;
    if !is_whole(bytes) {
        return Err("the file ends before its last chunk".into());
    }
    let pixels: Vec<[f32; 4]> = if is_deep {
        let level = |level: u16| f32::from(level) / SIXTEEN_BIT_LEVELS;
        let levels = image.into_rgba16();
        levels.pixels().map(|rgba| rgba.0.map(level)).collect()
    } else {
        let levels = image.into_rgba8();
        levels.pixels().map(|rgba| rgba.0.map(f32::from)).collect()
    };
    let colours = pixels.iter().map(|&[r, g, b, _]| Vec3::new(r, g, b));
    let colours = Image::new(width, height, colours.collect())?;
    let image = ComparedImage::new(LoadedImage::Levels(colours)).with_metadata(metadata(bytes)?);
    if color.has_alpha() {
        return Ok(image.with_alpha(pixels.iter().map(|rgba| rgba[3]).collect())?);
    }
    Ok(image)
}

/// Whether the chunks go on to the last one: the decoder is content once it has
/// all pixels, and would not see that their checksum is cut off.
fn is_whole(bytes: &[u8]) -> bool {
    /// Signature of the format.
    const START: usize = 8;
    /// Length, name and checksum of a chunk.
    const AROUND: usize = 12;
    let mut rest = bytes.get(START..).unwrap_or_default();
    while let Some((length, chunk)) = rest.split_first_chunk::<4>() {
        let is_last = chunk.starts_with(b"IEND");
        // A length near 2^32 does not fit where an address has 32 bits.
        let end = AROUND.checked_add(u32::from_be_bytes(*length) as usize);
        let Some(next) = end.and_then(|end| rest.get(end..)) else {
            return false;
        };
        if is_last {
            return true;
        }
        rest = next;
    }
    false
}

/// relume's own text chunks, before the pixels; those of other programs, which
/// like to hold times, say nothing of a frame.
fn metadata(bytes: &[u8]) -> Result<Metadata, CodecError> {
    let reader = Decoder::new(Cursor::new(bytes)).read_info()?;
    let mut metadata = Metadata::default();
    for TEXtChunk { keyword, text } in &reader.info().uncompressed_latin1_text {
        if keyword == SOFTWARE_KEYWORD {
            metadata.set(Metadata::SOFTWARE, text.as_str());
        } else if keyword.starts_with(Metadata::PREFIX) {
            metadata.set(keyword, text.as_str());
        }
    }
    Ok(metadata)
}
