//! What came of a scene, in words.

use super::{CheckError, FrameFault};
use crate::compare::Judgement;
use crate::frame::MetadataDifference;

/// What came of a scene.
#[derive(Debug)]
pub enum Verdict {
    /// As near to the golden as its limits ask.
    Passes(Judgement),
    /// Not so near.
    Differs {
        /// How far.
        judgement: Judgement,
        /// In what the golden's file says of itself otherwise than the frame.
        metadata: Vec<MetadataDifference>,
    },
    /// There is no golden.
    Missing,
    /// The frame is wrong by itself.
    Faulty(FrameFault),
    /// The golden cannot be read or compared with.
    Golden(CheckError),
    /// There is no frame.
    Scene(CheckError),
}

impl Verdict {
    /// The word that stands for the verdict in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Passes(_) => "passes",
            Self::Differs { .. } => "differs",
            Self::Missing => "missing",
            Self::Faulty(fault) => fault.name(),
            Self::Golden(_) => "golden-unusable",
            Self::Scene(_) => "scene-unusable",
        }
    }

    /// What is wrong and what to do, one sentence each; empty: nothing is.
    pub fn problems(&self) -> Vec<String> {
        match self {
            Self::Passes(_) => Vec::new(),
            Self::Differs { judgement, .. } => judgement.failures(),
            Self::Missing => vec!["there is no golden; look at the frame and bless it".to_owned()],
            Self::Faulty(fault) => vec![fault.to_string()],
            Self::Golden(error) | Self::Scene(error) => vec![error.with_causes()],
        }
    }

    /// Whether the frame may take the golden's place.
    pub(super) fn can_be_blessed(&self) -> bool {
        match self {
            Self::Differs { .. } | Self::Missing => true,
            // A mistake with the mask is not the golden's.
            Self::Golden(error) => error.is_of_golden(),
            Self::Passes(_) | Self::Faulty(_) | Self::Scene(_) => false,
        }
    }

    /// Whether nothing could be compared, in contrast to a comparison that failed.
    pub fn is_error(&self) -> bool {
        matches!(self, Self::Golden(_) | Self::Scene(_))
    }
}
