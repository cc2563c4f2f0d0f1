//! Decodes image files: bytes in, rows of linear or sRGB-encoded texels out.
//!
//! The name's extension promises a format; other content is an error, so that
//! a mislabelled file is found where it is. Every decoder here gives the same
//! bits on every machine: JPEG is decoded without vector code
//! ([`jpeg`](super::jpeg)), and EXR files with the lossy DWA compression, whose
//! decoder picks a transform by processor, are refused ([`exr_file`]).

use std::io::Cursor;
use std::path::Path;
use std::sync::LazyLock;

use glam::Vec3;
use image::codecs::bmp::BmpDecoder;
use image::codecs::hdr::HdrDecoder;
use image::codecs::openexr::OpenExrDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::tga::TgaDecoder;
use image::{DynamicImage, ImageDecoder, ImageResult, Limits};

use super::{TextureError, exr_file, jpeg};
use crate::maths::functions::linear_from_srgb;

/// Most pixels along a side.
const MAX_SIDE: u32 = 16_384;
/// Most pixels in all.
const MAX_PIXELS: u64 = 1 << 27;
/// What infinity becomes: far above any light, and its sums over 2^27 texels
/// and products with other such values of a camera stay finite.
pub(super) const MAX_RADIANCE: f32 = 1e30;
/// Bytes that a PNG's chunks other than its pixels may take.
const MAX_CHUNK_BYTES: u64 = 64 << 20;

/// A decoded image, row 0 on top.
#[derive(Debug)]
pub(super) struct ImageFile {
    /// Width and height.
    pub(super) size: [u32; 2],
    pub(super) pixels: Pixels,
}

/// Colours of an image, row by row.
#[derive(Debug)]
pub(super) enum Pixels {
    /// sRGB levels.
    Levels(Vec<[u8; 3]>),
    /// Linear values, finite and not negative.
    Linear(Vec<Vec3>),
}

impl Pixels {
    /// Every pixel as a linear value.
    pub(super) fn into_linear(self) -> Vec<Vec3> {
        match self {
            Self::Levels(levels) => levels.into_iter().map(linear_from_levels).collect(),
            Self::Linear(values) => values,
        }
    }
}

/// Image formats, by what they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Jpeg,
    Tga,
    Bmp,
    Exr,
    Hdr,
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Tga => "TGA",
            Self::Bmp => "BMP",
            Self::Exr => "OpenEXR",
            Self::Hdr => "Radiance HDR",
        }
    }

    fn of_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "png" => Some(Self::Png),
            "jpg" | "jpeg" | "jpe" | "jfif" => Some(Self::Jpeg),
            "tga" => Some(Self::Tga),
            "bmp" | "dib" => Some(Self::Bmp),
            "exr" => Some(Self::Exr),
            "hdr" | "rgbe" | "pic" => Some(Self::Hdr),
            _ => None,
        }
    }

    /// By the first bytes; a TGA has no mark of its own.
    fn of_content(bytes: &[u8]) -> Option<Self> {
        const MARKS: [(&[u8], Format); 6] = [
            (b"\x89PNG\r\n\x1a\n", Format::Png),
            (b"\xff\xd8\xff", Format::Jpeg),
            (b"BM", Format::Bmp),
            (b"\x76\x2f\x31\x01", Format::Exr),
            (b"#?RADIANCE", Format::Hdr),
            (b"#?RGBE", Format::Hdr),
        ];
        let found = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark));
        found.map(|&(_, format)| format)
    }
}

/// Why bytes are no image.
#[derive(Debug)]
pub(super) enum Fault {
    /// What is wrong and what to do.
    Content(String),
    /// What the decoder says of data that it cannot read.
    Broken(String),
    /// Width and height above the limits.
    Size(u64, u64),
}

impl From<image::ImageError> for Fault {
    fn from(error: image::ImageError) -> Self {
        Self::Broken(error.to_string())
    }
}

/// Decodes the bytes of the file at `path`.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<ImageFile, TextureError> {
    let format = format_of(bytes, path).map_err(|reason| TextureError::Decode {
        path: path.to_owned(),
        reason,
    })?;
    decode_as(format, bytes).map_err(|fault| error_of(fault, format, path))
}

/// Decodes the bytes of the file at `path`, which holds radiance: OpenEXR or
/// Radiance HDR.
pub(super) fn decode_radiance(bytes: &[u8], path: &Path) -> Result<ImageFile, TextureError> {
    let refusal = |reason| TextureError::Decode {
        path: path.to_owned(),
        reason,
    };
    let format = format_of(bytes, path).map_err(refusal)?;
    if !matches!(format, Format::Exr | Format::Hdr) {
        return Err(refusal(format!(
            "a {} file holds colours up to white and no radiance; give an OpenEXR or Radiance HDR \
             file",
            format.name()
        )));
    }
    decode_as(format, bytes).map_err(|fault| error_of(fault, format, path))
}

fn format_of(bytes: &[u8], path: &Path) -> Result<Format, String> {
    const KNOWN: &str = "known are PNG, JPEG, TGA, BMP, OpenEXR and Radiance HDR";
    if bytes.is_empty() {
        return Err("the file is empty; export it again".to_owned());
    }
    match (Format::of_extension(path), Format::of_content(bytes)) {
        (Some(promised), Some(found)) if promised == found => Ok(found),
        // "BM" is too short a mark to speak against a name: a TGA may start so.
        (Some(Format::Tga), None | Some(Format::Bmp)) => Ok(Format::Tga),
        (None, Some(found)) => Ok(found),
        (Some(promised), Some(found)) => Err(format!(
            "the name promises {}, but the content looks like {}; rename or convert it",
            promised.name(),
            found.name()
        )),
        (Some(promised), None) => Err(format!(
            "the name promises {}, but the content is not; {KNOWN}",
            promised.name()
        )),
        (None, None) => Err(format!("looks like no image; {KNOWN}")),
    }
}

fn error_of(fault: Fault, format: Format, path: &Path) -> TextureError {
    let path = path.to_owned();
    let name = format.name();
    match fault {
        Fault::Content(reason) => TextureError::Decode { path, reason },
        Fault::Broken(detail) => TextureError::Decode {
            path,
            reason: format!(
                "looks like {name}, but is broken or cut short ({detail}); export it again"
            ),
        },
        Fault::Size(width, height) => TextureError::TooLarge {
            path,
            reason: format!(
                "{width} x {height} pixels; at most {MAX_SIDE} a side and {MAX_PIXELS} in all \
                 are read, so scale it down"
            ),
        },
    }
}

fn decode_as(format: Format, bytes: &[u8]) -> Result<ImageFile, Fault> {
    let reader = Cursor::new(bytes);
    match format {
        Format::Png => {
            let mut limits = Limits::no_limits();
            limits.max_alloc = Some(MAX_CHUNK_BYTES);
            read(PngDecoder::with_limits(reader, limits))
        }
        Format::Jpeg => jpeg::decode(bytes),
        Format::Tga => read(TgaDecoder::new(reader)),
        Format::Bmp => read(BmpDecoder::new(reader)),
        Format::Exr => {
            if exr_file::check(bytes)? == exr_file::Channels::Luminance {
                return exr_file::read_luminance(bytes);
            }
            read(OpenExrDecoder::with_alpha_preference(reader, Some(false)))
        }
        Format::Hdr => read(HdrDecoder::new(reader)),
    }
}

/// Whether an image of this size is read at all.
pub(super) fn check_size(width: u64, height: u64) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        let reason =
            format!("an image of {width} x {height} pixels has no colours; export it again");
        return Err(Fault::Content(reason));
    }
    let side = u64::from(MAX_SIDE);
    if width > side || height > side || width * height > MAX_PIXELS {
        return Err(Fault::Size(width, height));
    }
    Ok(())
}

fn read<D: ImageDecoder>(decoder: ImageResult<D>) -> Result<ImageFile, Fault> {
    let decoder = decoder?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    let image = DynamicImage::from_decoder(decoder)?;
    let size = [image.width(), image.height()];
    let bytes_a_channel = image.color().bytes_per_pixel() / image.color().channel_count();
    let pixels = match bytes_a_channel {
        1 => Pixels::Levels(bytemuck::cast_vec(image.into_rgb8().into_raw())),
        2 => {
            let encoded = image.into_rgb16();
            Pixels::Linear(encoded.pixels().map(|p| linear_from_16_bits(p.0)).collect())
        }
        _ => {
            let values = image.into_rgb32f();
            let defined = |p: &image::Rgb<f32>| Vec3::from_array(p.0.map(defined_radiance));
            Pixels::Linear(values.pixels().map(defined).collect())
        }
    };
    Ok(ImageFile { size, pixels })
}

/// A radiance that can be computed with: 0 for what is negative or not a
/// number, [`MAX_RADIANCE`] for what is above.
pub(super) fn defined_radiance(x: f32) -> f32 {
    if x > MAX_RADIANCE {
        MAX_RADIANCE
    } else if x > 0.0 {
        x
    } else {
        0.0
    }
}

/// Linear value of every sRGB level.
pub(super) static LINEAR_FROM_LEVEL: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|level| linear_from_srgb(level as f64 / 255.0) as f32));

static LINEAR_FROM_16_BITS: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let linear = |level: u32| linear_from_srgb(f64::from(level) / 65_535.0) as f32;
    (0..=65_535).map(linear).collect()
});

fn linear_from_levels(levels: [u8; 3]) -> Vec3 {
    let table = &*LINEAR_FROM_LEVEL;
    Vec3::from_array(levels.map(|level| table[usize::from(level)]))
}

fn linear_from_16_bits(levels: [u16; 3]) -> Vec3 {
    let table = &*LINEAR_FROM_16_BITS;
    Vec3::from_array(levels.map(|level| table[usize::from(level)]))
}

#[cfg(test)]
mod tests;
