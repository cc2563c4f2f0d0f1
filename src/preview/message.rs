//! What reaches the program: one queue for hands, pictures and files.

use std::path::PathBuf;
use std::time::SystemTime;

use super::input::Input;
use super::painter::Drawn;
use super::screen::Notice;
use crate::relight::Renderer;
use crate::scene::{Scene, SceneError};

/// What reading a scene gave.
pub(crate) struct Loaded {
    /// When it was begun.
    pub(crate) at: SystemTime,
    /// What the scene file held.
    pub(crate) bytes: Vec<u8>,
    /// The files besides it that were read, or are named and not there.
    pub(crate) files: Vec<PathBuf>,
    pub(crate) scene: Result<Box<Scene>, SceneError>,
}

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
    /// The bake of the scene of that number goes on: its stage and the share of it
    /// that is done.
    Baking {
        number: u64,
        stage: &'static str,
        share: f64,
    },
    /// Files of the scene were changed by someone else.
    FilesChanged,
    /// Something happens to the terminal.
    Terminal(Notice),
    /// The scene was read again, for the how manieth time.
    Loaded { number: u64, loaded: Loaded },
}
