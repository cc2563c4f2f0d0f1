//! A picture of the screen in a file.

use std::path::Path;

use super::PreviewError;
use super::painter::enlarged;
use super::program::Program;
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
        let side = LEAST_WIDTH.div_ceil(picture.width());
        let size = [picture.width(), picture.height()].map(|pixels| pixels * side);
        encode_png(&enlarged(&picture, size))?
    };
    Ok(write_file(path, &bytes)?)
}
