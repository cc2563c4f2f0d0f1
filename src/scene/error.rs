//! What can go wrong between a path and a [`super::Scene`].

use std::path::PathBuf;

use crate::texture::TextureError;

/// Why a scene could not be loaded. The text says where (file, line and
/// column, or the `--set` argument), what, and what is allowed there.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A file that the scene needs could not be read.
    #[error("{place}cannot read {}; check that the file exists and is readable", .path.display())]
    Read {
        /// Who asks for the file, with a colon and a space after it; empty
        /// where the user named it on the command line.
        place: String,
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A file is not text, or the scene file is not TOML.
    #[error("{place}: {message}")]
    Syntax {
        /// File, line and column.
        place: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// A key, kind, name or value of the scene file or of `--set` is not
    /// allowed.
    #[error("{place}: {message}")]
    Key {
        /// File, line and column, or the `--set` argument.
        place: String,
        /// What is wrong, what is allowed, and the nearest valid name.
        message: String,
    },
    /// A statement of the OBJ file cannot be understood, or the file holds no
    /// triangle.
    #[error("{place}: {message}")]
    Mesh {
        /// File and line.
        place: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// An image file is there but cannot be used.
    #[error("{place}: {source}")]
    Image {
        /// What asks for the file: file and line.
        place: String,
        /// The file and what is wrong with it.
        source: TextureError,
    },
}

impl SceneError {
    /// Whether a file could not be read or is no image (exit code 3), in
    /// contrast to a scene that cannot be understood (exit code 2).
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Read { .. } | Self::Image { .. })
    }
}
