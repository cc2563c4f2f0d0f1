//! Image files, pictures that only people look at, and what a terminal is sent to
//! show one. The only room that names `png` and `tiny_skia`.
//!
//! Comes in: a frame as linear radiance and as levels, or a path. Goes out: a
//! file that is either whole or absent, or what a file holds. The format is
//! chosen by the extension; a new one is a file here and a line in [`FORMATS`].
//! Bytes for terminals are made in [`terminal`].

mod exr;
mod file;
mod glyphs;
mod heat_map;
mod png;
mod strokes;
pub(crate) mod terminal;

use std::path::{Component, Path, PathBuf};

use crate::compare::ComparedImage;
use crate::frame::{EncodedImage, Image, LoadedImage, Metadata};
use crate::report::ReportFile;
use file::write_whole;

pub use heat_map::heat_map;
pub(crate) use strokes::{Line, with_lines};

/// One frame in both of its forms; a format takes the one it holds.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Radiance (or another linear quantity), not exposed.
    pub linear: &'a Image,
    /// Levels after exposure and tone curve.
    pub encoded: &'a EncodedImage,
}

/// What a file says of how its picture was made; a format takes the one that
/// belongs to the form it holds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PictureMetadata {
    /// Of linear values.
    pub linear: Metadata,
    /// Of levels.
    pub encoded: Metadata,
}

/// Why an image was not written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The extension names no format.
    #[error("{}: the extension chooses the image format; use .png or .exr", .0.display())]
    UnknownFormat(PathBuf),
    /// The file was not written; what stood there before still does.
    #[error(
        "{}: could not be written; check that the folder exists, is writable and has space",
        path.display()
    )]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file was not read.
    #[error("{}: could not be read; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The pixels do not fit the format.
    #[error("{}: the image could not be encoded; try the other of .png and .exr", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// What the encoder said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The levels do not fit into a PNG file.
    #[error("the picture could not be encoded as PNG; make it smaller")]
    EncodePng(#[source] CodecError),
    /// A file of a folder would stand somewhere else.
    #[error("{}: leads out of the folder it is written to; use a path below it", .0.display())]
    OutsideFolder(PathBuf),
    /// The bytes are not an image of this format.
    #[error(
        "{}: not a readable image of its extension's format; \
         check that the file is whole and is what its name says",
        path.display()
    )]
    Decode {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// Failure of an encoder or decoder, before the path is known.
type CodecError = Box<dyn std::error::Error + Send + Sync>;

/// Most pixels along a side of an image that is read: as many as a camera may
/// have. A header that asks for more is refused before memory is.
const MOST_SIDE: u32 = 16_384;

/// One file format.
struct Format {
    /// Extension in lower case, without the dot.
    extension: &'static str,
    encode: fn(Picture<'_>, &PictureMetadata) -> Result<Vec<u8>, CodecError>,
    decode: fn(&[u8]) -> Result<ComparedImage, CodecError>,
}

/// All formats.
const FORMATS: [Format; 2] = [png::FORMAT, exr::FORMAT];

/// Checks, before any work is done, that `path` names a format.
///
/// # Errors
/// [`OutputError::UnknownFormat`].
pub fn check_format(path: &Path) -> Result<(), OutputError> {
    format_of(path).map(|_| ())
}

/// Writes a frame in the format of the path's extension, without metadata. A
/// reader of `path` sees the old file or the new one, never a part.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub fn write_picture(path: &Path, frame: Picture<'_>) -> Result<(), OutputError> {
    write_described(path, frame, &PictureMetadata::default())
}

/// [`write_picture`] with metadata: text chunks of a PNG, attributes of an EXR.
/// Equal pixels and metadata are equal bytes.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub fn write_described(
    path: &Path,
    frame: Picture<'_>,
    metadata: &PictureMetadata,
) -> Result<(), OutputError> {
    let bytes = (format_of(path)?.encode)(frame, metadata);
    write_bytes(path, bytes)
}

/// The bytes that [`write_described`] would write to `path`.
///
/// # Errors
/// If the extension is unknown or the picture does not fit the format.
pub fn encode_described(
    path: &Path,
    frame: Picture<'_>,
    metadata: &PictureMetadata,
) -> Result<Vec<u8>, OutputError> {
    let encode = format_of(path)?.encode;
    encode(frame, metadata).map_err(|source| OutputError::Encode {
        path: path.to_owned(),
        source,
    })
}

/// Writes levels as a PNG, whatever the path's extension.
///
/// # Errors
/// If the file cannot be written.
pub fn write_png(path: &Path, image: &EncodedImage) -> Result<(), OutputError> {
    write_bytes(path, png::encode_levels(image, &Metadata::default()))
}

fn write_bytes(path: &Path, encoded: Result<Vec<u8>, CodecError>) -> Result<(), OutputError> {
    let bytes = encoded.map_err(|source| OutputError::Encode {
        path: path.to_owned(),
        source,
    })?;
    write_whole(path, &bytes).map_err(|source| OutputError::Write {
        path: path.to_owned(),
        source,
    })
}

/// Reads the colours of an image in the format of the path's extension.
///
/// # Errors
/// If the extension is unknown or the file is missing, cut or another format.
pub fn read_image(path: &Path) -> Result<LoadedImage, OutputError> {
    read_compared(path).map(ComparedImage::into_pixels)
}

/// Reads all that a comparison looks at: colours, alpha and metadata.
///
/// # Errors
/// As [`read_image`].
pub fn read_compared(path: &Path) -> Result<ComparedImage, OutputError> {
    let format = format_of(path)?;
    let bytes = std::fs::read(path).map_err(|source| OutputError::Read {
        path: path.to_owned(),
        source,
    })?;
    (format.decode)(&bytes).map_err(|source| OutputError::Decode {
        path: path.to_owned(),
        source,
    })
}

/// The bytes of a PNG file with these levels.
///
/// # Errors
/// [`OutputError::EncodePng`] if PNG cannot hold the image.
pub fn encode_png(image: &EncodedImage) -> Result<Vec<u8>, OutputError> {
    png::encode_levels(image, &Metadata::default()).map_err(OutputError::EncodePng)
}

/// Writes files below a folder, which is made if it is missing, in their order.
/// Each is whole or absent at any time; other files in the folder stay.
///
/// # Errors
/// If a path leads out of the folder, or a folder or file cannot be written;
/// files before that one are then there.
pub fn write_folder(folder: &Path, files: &[ReportFile]) -> Result<(), OutputError> {
    for file in files {
        let path = folder.join(&file.path);
        let is_inside = Path::new(&file.path)
            .components()
            .all(|part| matches!(part, Component::Normal(_)));
        if !is_inside {
            return Err(OutputError::OutsideFolder(path));
        }
        write_file(&path, &file.bytes)?;
    }
    Ok(())
}

/// Writes a file, whole or not at all, into a folder that is made if it is
/// missing.
///
/// # Errors
/// If the folder or the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let folder = path.parent().filter(|it| !it.as_os_str().is_empty());
    folder
        .map_or(Ok(()), std::fs::create_dir_all)
        .and_then(|()| write_whole(path, bytes))
        .map_err(|source| OutputError::Write {
            path: path.to_owned(),
            source,
        })
}

fn format_of(path: &Path) -> Result<&'static Format, OutputError> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension
        .map(str::to_ascii_lowercase)
        .and_then(|extension| FORMATS.iter().find(|format| format.extension == extension))
        .ok_or_else(|| OutputError::UnknownFormat(path.to_owned()))
}

#[cfg(test)]
mod tests;
