//! The interactive terminal program: a scene is lit by hand in a terminal.
//!
//! ```text
//! terminal ─► input ─┐                        ┌─► worker: painter ─► pictures ─┐
//! script ──► input ──┴─► program ─► effects ──┼─► prepare: surface, bake ──────┼─► messages
//!                         │  ▲                └─► watch: files that change ────┘      │
//!                         │  └─────────────────────────────────────────────────────────┘
//!                         └─► cells ─► screen ─► terminal
//! ```
//!
//! What a person does comes in as [`input`]; [`keys`] says which [`command`] it is,
//! and [`hands`] turns that into [`edits`] of a [`document`], which can all be undone
//! ([`history`]). The [`program`] is pure; a terminal ([`interactive`]) and a script
//! ([`scripted`]) drive it. Pictures are drawn by a thread ([`worker`]), so that no
//! input waits for one, and written by another ([`screen`]).

mod ask;
mod camera_moves;
mod colour;
mod command;
mod document;
mod drag;
mod edits;
mod hands;
mod history;
mod input;
mod interactive;
mod keys;
mod light_edits;
mod marks;
mod message;
mod new_lights;
mod painter;
mod panel;
mod prepare;
mod program;
mod screen;
mod script;
mod scripted;
mod shapes;
mod shot;
mod status;
mod steps;
mod view;
mod watch;
mod worker;
mod write_frame;

use std::path::PathBuf;

pub use crate::output::terminal::{Colours, Protocol, UnknownProtocol};
pub use ask::{ColourChoice, ProtocolChoice, UnknownChoice};
pub use interactive::{Ended, run_in_terminal};
pub use prepare::Preparation;
pub use scripted::{ScriptReport, run_script};

use crate::bake::BakeError;
use crate::output::OutputError;
use crate::scene::{Override, SceneError};
use screen::ScreenError;
use script::ScriptError;

/// What is opened, and how.
#[derive(Debug, Clone)]
pub struct PreviewSettings {
    /// The scene file.
    pub scene: PathBuf,
    /// What the command line changes of it.
    pub overrides: Vec<Override>,
    /// How the scene is made ready.
    pub preparation: Preparation,
    /// Colours of cells.
    pub colours: ColourChoice,
    /// Protocol for pixels.
    pub protocol: ProtocolChoice,
}

/// Why there is no preview.
#[derive(Debug, thiserror::Error)]
pub enum PreviewError {
    /// The scene cannot be shown.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There is no terminal, or it cannot be set up.
    #[error("{0}")]
    Terminal(String),
    /// The script cannot be read.
    #[error("cannot read the script {path}")]
    Script {
        /// The script's file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The script cannot be understood: file, line and what is allowed.
    #[error("{0}")]
    ScriptLine(String),
    /// The bake of a script's scene failed.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// A picture cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A script asks for a picture before there is one.
    #[error("there is no picture yet; put a frame, or `rest`, before `shot`")]
    NoPicture,
    /// The script was stopped.
    #[error("stopped")]
    Stopped,
    /// The system starts no threads.
    #[error("cannot start a thread")]
    Threads(#[from] std::io::Error),
}

impl From<ScreenError> for PreviewError {
    fn from(error: ScreenError) -> Self {
        match error {
            ScreenError::NoTerminal(_) | ScreenError::Dumb(_) => Self::Terminal(error.to_string()),
            ScreenError::Setup(source) => {
                Self::Terminal(format!("the terminal could not be set up: {source}"))
            }
        }
    }
}

impl From<ScriptError> for PreviewError {
    fn from(error: ScriptError) -> Self {
        Self::ScriptLine(error.to_string())
    }
}
