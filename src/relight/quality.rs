//! How the light that does not come straight from a lamp is read at pixels.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// Where pixels have their indirect light and the sky's direct light from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// Interpolated from the lighting vertices: for pictures in motion.
    #[default]
    Standard,
    /// Gathered by rays of the pixel's own, which read the vertices where they
    /// arrive: for still pictures, in seconds. A draft ([`crate::Effort::Draft`])
    /// is standard all the same.
    Gather,
}

/// The name of a quality means none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("qualities are standard and gather")]
pub struct QualityError;

impl Quality {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Gather => "gather",
        }
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Quality {
    type Err = QualityError;

    fn from_str(name: &str) -> Result<Self, QualityError> {
        let known = [Self::Standard, Self::Gather];
        let found = known.into_iter().find(|quality| quality.name() == name);
        found.ok_or(QualityError)
    }
}
