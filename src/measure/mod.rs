//! What relume is measured by: how long its frames take, and how wrong they are
//! for it.
//!
//! Comes in: a [`crate::Renderer`] or a [`crate::Scene`], and what its frames
//! show. Goes out: figures, and a [`crate::report::Report`] of them. Nothing is
//! read, written or printed here.
//!
//! | chapter | what is measured |
//! |---|---|
//! | `vertices` | indirect light at the vertices against many independent rays |
//! | `paths` | the same at some vertices against the path tracer |
//! | `sweeps` | error against functions, coefficients, bytes, rays, milliseconds |
//! | `frame_errors` | frames against the path tracer, and its time at equal error |
//! | `glossy` | the final glossy bounce by slices against paths, by roughness |
//! | `methods` | variants of the method that were tried, recorded |
//! | `pictures` | frame beside reference, partitions, functions, components |
//!
//! Errors are those of both schemes in one run. The lights, the truth and the
//! reference have seeds that no bake uses, to choose by or to state its error.

mod contacts;
mod figures;
mod frame_errors;
mod frames;
mod glossy;
mod methods;
mod paths;
mod pictures;
mod report;
mod run;
mod statistics;
mod sweeps;
mod tables;
mod vertices;

use thiserror::Error;

use crate::bake::BakeError;
use crate::output::OutputError;
use crate::relight::RenderError;
use crate::report::ReportError;

pub use figures::MainFigures;
pub use frames::{FrameTimes, LightCircle, NoLocalLight, Spread, StageTimes, time_frames};
pub use report::{MeasuredReport, report};
pub use run::{ReportSettings, report_seconds};

/// Why something was not measured.
#[derive(Debug, Error)]
pub enum MeasureError {
    /// There is nothing to move.
    #[error(transparent)]
    NoLocalLight(#[from] NoLocalLight),
    /// A frame was not drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// There is no bake.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// A picture cannot be encoded.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The report does not fit together.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The system cannot start a thread.
    #[error("cannot start a thread to measure on: {0}; end other programs and try again")]
    Threads(String),
}
