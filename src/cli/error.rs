//! What can go wrong in a command, and its exit code.

use std::error::Error;

use relume::golden::{FindError, PageError};
use relume::measure::{MeasureError, NoLocalLight};
use relume::preview::PreviewError;
use relume::{BakeError, JudgeError, OutputError, RenderError, SceneError};
use thiserror::Error;

use super::golden::printable;
use super::signals;

/// Why a command failed.
#[derive(Debug, Error)]
pub(super) enum CliError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error(transparent)]
    Bake(#[from] BakeError),
    #[error(transparent)]
    NoLocalLight(#[from] NoLocalLight),
    #[error(transparent)]
    Measure(MeasureError),
    #[error(transparent)]
    Judge(#[from] JudgeError),
    #[error(transparent)]
    Find(#[from] FindError),
    #[error(transparent)]
    Page(PageError),
    #[error(transparent)]
    Preview(PreviewError),
    #[error("standard output could not be written; the files were")]
    StandardOutput(#[source] std::io::Error),
    #[error("{0}")]
    Usage(String),
    #[error("stopped; nothing was written")]
    Stopped,
}

impl From<PageError> for CliError {
    fn from(error: PageError) -> Self {
        match error {
            PageError::Output(error) => error.into(),
            error @ PageError::Report(_) => Self::Page(error),
        }
    }
}

impl From<PreviewError> for CliError {
    fn from(error: PreviewError) -> Self {
        match error {
            PreviewError::Scene(error) => error.into(),
            PreviewError::Bake(error) => error.into(),
            PreviewError::Output(error) => error.into(),
            PreviewError::Stopped => Self::Stopped,
            error => Self::Preview(error),
        }
    }
}

impl From<MeasureError> for CliError {
    fn from(error: MeasureError) -> Self {
        match error {
            MeasureError::NoLocalLight(error) => error.into(),
            MeasureError::Render(error) => error.into(),
            MeasureError::Bake(error) => error.into(),
            MeasureError::Output(error) => error.into(),
            error @ (MeasureError::Report(_) | MeasureError::Threads(_)) => Self::Measure(error),
        }
    }
}

impl CliError {
    pub(super) fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(error) if error.is_io() => 3,
            Self::Output(OutputError::UnknownFormat(_)) => 2,
            Self::Preview(PreviewError::Script { .. }) => 3,
            Self::Output(_) | Self::Find(_) | Self::StandardOutput(_) => 3,
            Self::Stopped
            | Self::Render(RenderError::Cancelled)
            | Self::Bake(BakeError::Cancelled)
            | Self::Render(RenderError::Bake(BakeError::Cancelled)) => {
                signals::exit_code().unwrap_or(1)
            }
            Self::Scene(_)
            | Self::Render(_)
            | Self::Bake(_)
            | Self::NoLocalLight(_)
            | Self::Judge(_)
            | Self::Measure(_)
            | Self::Page(_)
            | Self::Preview(_)
            | Self::Usage(_) => 2,
        }
    }

    /// The chain of causes on standard error, once.
    #[allow(
        clippy::print_stderr,
        reason = "the one place where the program says what went wrong"
    )]
    pub(super) fn print(&self) {
        let mut text = format!("error: {self}");
        let mut cause = self.source();
        while let Some(error) = cause {
            let part = error.to_string();
            if !text.ends_with(&part) {
                text.push_str(": ");
                text.push_str(&part);
            }
            cause = error.source();
        }
        for line in text.lines() {
            eprintln!("{}", printable(line));
        }
    }
}
