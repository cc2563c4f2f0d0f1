//! JPEG without vector code.
//!
//! The decoder's AVX2 and Neon transforms, upsamplers and colour conversions
//! are picked at run time and do not all round like the plain ones. No option
//! refuses them: the decoder takes AVX2 if either of two flags is set, and
//! `set_use_unsafe` clears only one. So the crates are built without the
//! features that hold that code and that ask the processor, and a test sees
//! whether another dependency has brought them back.

use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;

use super::image_file::{Fault, ImageFile, Pixels, check_size};

impl From<DecodeErrors> for Fault {
    fn from(error: DecodeErrors) -> Self {
        Self::Broken(format!("{error:?}"))
    }
}

fn options() -> DecoderOptions {
    // The strict mode refuses stray bytes between segments, which other programs
    // skip. A JPEG's size has 16 bits, so the limit is ours to check.
    DecoderOptions::new_safe()
        .set_use_unsafe(false)
        .set_strict_mode(false)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
}

/// Whether an end of image follows the last start of a scan. What is missing of
/// a file cut short would be filled up in grey.
fn is_complete(bytes: &[u8]) -> bool {
    let last = |mark: [u8; 2]| bytes.windows(2).rposition(|pair| pair == mark);
    last([0xff, 0xd9]) > last([0xff, 0xda])
}

/// Decodes a grey or colour JPEG.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageFile, Fault> {
    if !is_complete(bytes) {
        return Err(Fault::Broken("no end of the image".to_owned()));
    }
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options());
    decoder.decode_headers()?;
    let (width, height) = decoder
        .dimensions()
        .ok_or_else(|| Fault::Broken("no size".to_owned()))?;
    check_size(width as u64, height as u64)?;
    let is_grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
    let wanted = if is_grey {
        ColorSpace::Luma
    } else {
        ColorSpace::RGB
    };
    decoder.set_options(options().jpeg_set_out_colorspace(wanted));
    let decoded = decoder.decode()?;
    let levels: Vec<[u8; 3]> = if is_grey {
        decoded.iter().map(|&level| [level; 3]).collect()
    } else {
        bytemuck::try_cast_vec(decoded).map_err(|_| Fault::Broken("odd length".to_owned()))?
    };
    if levels.len() != width * height {
        return Err(Fault::Broken("pixels are missing".to_owned()));
    }
    Ok(ImageFile {
        size: [width as u32, height as u32],
        pixels: Pixels::Levels(levels),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_vector_code_is_taken() {
        assert!(!options().use_avx2());
    }
}
