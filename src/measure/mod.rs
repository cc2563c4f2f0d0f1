//! What relume is measured by: how long its frames take.
//!
//! Comes in: a [`crate::Renderer`] and what its frames show. Goes out: figures.
//! Nothing is read, written or printed here.

mod frames;

pub use frames::{
    FrameTimes, LightCircle, MeasureError, NoLocalLight, Spread, StageTimes, time_frames,
};
