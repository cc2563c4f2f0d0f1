//! What reaches the program: one queue for hands, pictures and files.

use std::path::PathBuf;

use super::input::Input;
use super::painter::Drawn;
use super::screen::Notice;
use crate::relight::Renderer;
use crate::scene::{Scene, SceneError};

/// Something happened.
pub(crate) enum Message {
    /// A key, the mouse, or another size of the terminal.
    Input(Input),
    /// A picture of the wish of that number.
    Drawn { number: u64, drawn: Box<Drawn> },
    /// There is no picture.
    NotDrawn(String),
    /// A frame was written (digest), or not (why).
    Wrote {
        path: PathBuf,
        written: Result<String, String>,
    },
    /// The scene of that number can be drawn; its bake may follow.
    Prepared {
        number: u64,
        renderer: Box<Renderer>,
    },
    /// There is no bake.
    NotPrepared { number: u64, error: String },
    /// A bake goes on: its stage and the share of it that is done.
    Baking { stage: &'static str, share: f64 },
    /// Files of the scene were changed by someone else.
    FilesChanged,
    /// Something happens to the terminal.
    Terminal(Notice),
    /// The scene was read again.
    Loaded {
        bytes: Vec<u8>,
        scene: Result<Box<Scene>, SceneError>,
    },
}
