//! What can go wrong between a scene and a verdict.

use std::fmt;
use std::path::PathBuf;

use super::FrameFault;
use crate::compare::{JudgeError, MaskError};
use crate::output::OutputError;
use crate::relight::RenderError;
use crate::scene::SceneError;

/// Why a scene could not be drawn or held against its golden.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// The scene cannot be read or understood.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There is no frame of it.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The golden cannot be read or written.
    #[error(transparent)]
    Golden(#[from] OutputError),
    /// The mask cannot be read.
    #[error("the mask {source}")]
    MaskFile {
        /// The file and what is wrong with it.
        source: OutputError,
    },
    /// The mask is none.
    #[error("{}: {source}", path.display())]
    Mask {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: MaskError,
    },
    /// Golden, frame and mask do not go together.
    #[error(transparent)]
    Judge(#[from] JudgeError),
    /// Nobody can tell which golden counts.
    #[error("the scene has several goldens ({}); keep one of them", listed(.0))]
    Several(Vec<PathBuf>),
}

fn listed(paths: &[PathBuf]) -> String {
    let texts: Vec<String> = paths.iter().map(|it| it.display().to_string()).collect();
    texts.join(", ")
}

impl CheckError {
    /// Whether a file could not be read, in contrast to one that says what makes
    /// no sense.
    pub fn is_io(&self) -> bool {
        match self {
            Self::Scene(error) => error.is_io(),
            Self::Golden(_) | Self::MaskFile { .. } => true,
            Self::Render(_) | Self::Mask { .. } | Self::Judge(_) | Self::Several(_) => false,
        }
    }
}

/// Why a test fails. Printed with `{:?}`, as a test's `Result` is, it reads as
/// with `{}`.
#[derive(thiserror::Error)]
pub enum GoldenError {
    /// There is no golden.
    #[error(
        "{} is missing; look at {}, and run again with {variable}=1 if it is right",
        golden.display(), actual.display(), variable = super::BLESS_VARIABLE
    )]
    Missing {
        /// Where it has to be.
        golden: PathBuf,
        /// The frame that would become it.
        actual: PathBuf,
    },
    /// The frame differs by more than the limits allow.
    #[error(
        "the frame is not {}: {}; it would pass with {}; look at {}, and run again with \
         {variable}=1 if it is right",
        golden.display(), failures.join("; "), passing, strip.display(),
        variable = super::BLESS_VARIABLE
    )]
    Differs {
        /// The golden.
        golden: PathBuf,
        /// One sentence for each limit that does not hold.
        failures: Vec<String>,
        /// Limits that would have held.
        passing: String,
        /// Expected, difference and actual, side by side.
        strip: PathBuf,
    },
    /// The golden was written, as the environment asks for; the test fails all
    /// the same, so that it does not pass unseen.
    #[error(
        "{} was written; look at it, and run again without {variable}",
        golden.display(), variable = super::BLESS_VARIABLE
    )]
    Blessed {
        /// The golden.
        golden: PathBuf,
    },
    /// The frame can be no golden's equal.
    #[error("{}: {fault}", golden.display())]
    Faulty {
        /// The golden.
        golden: PathBuf,
        /// What is wrong with the frame.
        fault: FrameFault,
    },
    /// Scene, golden or mask could not be used, or a picture not be written.
    #[error(transparent)]
    Check(#[from] CheckError),
}

impl CheckError {
    /// The error with its causes, as one text.
    pub fn with_causes(&self) -> String {
        let mut text = self.to_string();
        let mut cause = std::error::Error::source(self);
        while let Some(error) = cause {
            let part = error.to_string();
            if !text.ends_with(&part) {
                text = format!("{text}: {part}");
            }
            cause = error.source();
        }
        text
    }

    /// Whether another golden in the place of this one would help.
    pub(super) fn is_of_golden(&self) -> bool {
        matches!(self, Self::Golden(_))
    }
}

impl fmt::Debug for GoldenError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Check(error) => formatter.write_str(&error.with_causes()),
            _ => write!(formatter, "{self}"),
        }
    }
}
