//! What a difference may be, and which limits do not hold.

use std::fmt;

use super::{Figures, pixels::PixelDifferences};
use crate::scene::{GoldenKeys, PixelLimit};

/// Limits on a difference; all absent by default, and then the images must be
/// equal. This is how they combine:
///
/// * The limits on channels and on pixels are one: no more than
///   `max_differing_pixels` pixels may have a channel that differs by more than
///   `max_channel_difference` (at a pixel where a mask allows more, by more than
///   that). Where one of the two is given, the other is 0.
/// * `max_flip` limits the mean of FLIP. Beside one of the others, both must
///   hold. Alone, it is the only limit on finite colours, which may then differ
///   in any way that an observer does not see; but no pixel may be infinite or
///   not a number, and alpha, which FLIP does not look at, must be equal.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Limits {
    /// Largest difference of a channel: 8-bit levels for PNG, linear values for
    /// EXR.
    pub max_channel_difference: Option<f64>,
    /// Most pixels that may differ by more than that; a share is one of the
    /// pixels that no mask ignores.
    pub max_differing_pixels: Option<PixelLimit>,
    /// Largest mean FLIP, 0 to 1.
    pub max_flip: Option<f64>,
}

/// A limit that does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Failure {
    /// Too many pixels differ by too much.
    Pixels {
        /// Pixels beyond the limit on channels.
        beyond: u64,
        /// Pixels that may be.
        allowed: u64,
        /// The limit on channels.
        channel_limit: f64,
    },
    /// An observer sees too much of a difference.
    Flip {
        /// Mean FLIP.
        mean: f64,
        /// Its limit.
        limit: f64,
    },
    /// Pixels that are infinite or not a number, where FLIP is the only limit.
    NotFinite {
        /// Their number.
        pixels: u64,
    },
    /// Pixels whose alpha differs, where FLIP is the only limit.
    Alpha {
        /// Their number.
        pixels: u64,
    },
}

impl Failure {
    /// The limit's name, as it is a key of reports.
    pub fn limit(&self) -> &'static str {
        match self {
            Self::Pixels { allowed: 0, .. } => "max_channel_difference",
            Self::Pixels { .. } => "max_differing_pixels",
            Self::Flip { .. } => "max_flip",
            Self::NotFinite { .. } => "non_finite_pixels",
            Self::Alpha { .. } => "alpha",
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pixels {
                beyond,
                allowed,
                channel_limit,
            } => write!(
                f,
                "{} in a channel by more than {channel_limit}, and {allowed} may",
                counted(*beyond, "differs", "differ")
            ),
            Self::Flip { mean, limit } => {
                write!(f, "the mean of FLIP is {mean:.6}, and may be {limit}")
            }
            Self::NotFinite { pixels } => write!(
                f,
                "{} infinite or not a number, which a limit on FLIP alone does not allow",
                counted(*pixels, "is", "are")
            ),
            Self::Alpha { pixels } => write!(
                f,
                "{} in alpha, which a limit on FLIP alone does not allow",
                counted(*pixels, "differs", "differ")
            ),
        }
    }
}

/// "1 pixel differs", "2 pixels differ".
fn counted(count: u64, one: &str, many: &str) -> String {
    match count {
        1 => format!("1 pixel {one}"),
        _ => format!("{count} pixels {many}"),
    }
}

impl Limits {
    /// The limits of a scene's `[golden]`: those of its keys that are given, 0 or
    /// not.
    pub fn of_keys(keys: &GoldenKeys) -> Self {
        Self {
            max_channel_difference: keys.max_channel_difference,
            max_differing_pixels: keys.max_differing_pixels,
            max_flip: keys.max_flip,
        }
    }

    /// The difference of a channel that any pixel may have.
    pub(super) fn channel_limit(&self) -> f64 {
        self.max_channel_difference.unwrap_or(0.0)
    }

    /// Whether FLIP is the only limit.
    fn flip_alone(&self) -> bool {
        self.max_flip.is_some()
            && self.max_channel_difference.is_none()
            && self.max_differing_pixels.is_none()
    }

    /// Pixels of so many that may be beyond the limit on channels.
    fn allowed_pixels(&self, compared: u64) -> u64 {
        match self.max_differing_pixels {
            None => 0,
            Some(PixelLimit::Count(count)) => u64::from(count),
            Some(PixelLimit::Share(share)) => (share * compared as f64).floor() as u64,
        }
    }

    /// What does not hold; `beyond` pixels are beyond the limit on channels.
    pub(super) fn failures(
        &self,
        figures: &Figures,
        differences: &PixelDifferences,
        beyond: u64,
    ) -> Vec<Failure> {
        let mut failures = Vec::new();
        if self.flip_alone() {
            let (pixels, alphas) = (figures.non_finite_pixels, differences.differing_alphas());
            failures.extend((pixels > 0).then_some(Failure::NotFinite { pixels }));
            failures.extend((alphas > 0).then_some(Failure::Alpha { pixels: alphas }));
        } else {
            let allowed = self.allowed_pixels(differences.compared);
            let channel_limit = self.channel_limit();
            failures.extend((beyond > allowed).then_some(Failure::Pixels {
                beyond,
                allowed,
                channel_limit,
            }));
        }
        let mean = figures.flip_mean;
        let flip_limit = self.max_flip.filter(|&limit| mean > limit);
        failures.extend(flip_limit.map(|limit| Failure::Flip { mean, limit }));
        failures
    }
}
