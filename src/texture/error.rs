//! Why a file is no map.

use std::path::PathBuf;

/// Why a file cannot be used as a map.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    /// The bytes are not an image of the format that the name promises.
    #[error("{}: {reason}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// More pixels than are allowed.
    #[error("{}: {reason}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// How large it is, and the limit.
        reason: String,
    },
}
