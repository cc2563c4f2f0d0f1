//! A picture of the screen in a file.

use std::path::Path;

use super::PreviewError;
use super::program::Program;
use crate::frame::EncodedImage;
use crate::output::{encode_png, write_file};

/// Least width of a picture's file, pixels: pixels of the screen are large, and
/// are repeated.
const LEAST_WIDTH: u32 = 640;

/// Writes what the screen shows: the picture with its marks as PNG, or all
/// characters as text.
pub(super) fn write_shot(path: &Path, program: &Program) -> Result<(), PreviewError> {
    let is_text = path.extension().is_some_and(|ending| ending == "txt");
    let bytes = if is_text {
        program.cells().lines().join("\n").into_bytes()
    } else {
        let picture = program.marked().ok_or(PreviewError::NoPicture)?;
        encode_png(&repeated(&picture))?
    };
    Ok(write_file(path, &bytes)?)
}

/// Every pixel as a square of so many that the picture has the least width.
fn repeated(picture: &EncodedImage) -> EncodedImage {
    let (width, height) = (picture.width(), picture.height());
    let side = LEAST_WIDTH.div_ceil(width);
    let (pixels, _) = picture.bytes().as_chunks::<3>();
    let mut bytes = Vec::with_capacity(pixels.len() * 3 * (side * side) as usize);
    for line in pixels.chunks_exact(width as usize) {
        let wide: Vec<u8> = line.iter().flat_map(|p| p.repeat(side as usize)).collect();
        bytes.extend(wide.repeat(side as usize));
    }
    EncodedImage::of_bytes(width * side, height * side, bytes)
        .expect("three bytes a pixel were written")
}
