//! How a bake stores the transfer: in relume's own way or as it was published,
//! and what the rest of the program asks of either.

use std::ops::Range;

use super::basis::Basis;
use super::low_rank::LowRank;
use super::paper::PaperRows;
use crate::simd::Level;

/// How a bake cuts up the mesh and stores the transfer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Scheme {
    /// relume's own: a near field, a low-rank product for the rest, functions
    /// by what they hand on, and constant light kept.
    #[default]
    Relume,
    /// As it was published (Wang, Zhu and Humphreys, EGSR 2007): a list of
    /// basis coefficients a vertex with one step for all. A yardstick.
    Paper,
}

impl Scheme {
    /// All schemes.
    pub const ALL: [Self; 2] = [Self::Relume, Self::Paper];

    /// The name that the command line and reports use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relume => "relume",
            Self::Paper => "paper",
        }
    }

    /// Its number in keys and files.
    pub(super) fn tag(self) -> u8 {
        self as u8
    }

    /// Which partitioner cuts up the mesh, as this program was built.
    pub fn partitioner(self) -> Partitioner {
        match self {
            Self::Paper if cfg!(feature = "metis") => Partitioner::Metis,
            _ => Partitioner::Relume,
        }
    }

    /// What the user should know of the scheme in this build.
    pub(crate) fn warning(self) -> Option<String> {
        let is_replaced = self == Self::Paper && self.partitioner() != Partitioner::Metis;
        is_replaced.then(|| {
            "the published scheme partitions by METIS, and this program was built without it: \
             relume's own partitioner takes its place; build with `--features metis` for METIS"
                .to_owned()
        })
    }
}

/// What cuts the mesh into partitions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Partitioner {
    /// relume's own, the same bits everywhere.
    #[default]
    Relume,
    /// METIS 5, k-way.
    Metis,
}

impl Partitioner {
    /// All partitioners.
    pub const ALL: [Self; 2] = [Self::Relume, Self::Metis];

    /// The name that reports use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relume => "relume",
            Self::Metis => "metis",
        }
    }

    /// Its number in keys and files.
    pub(super) fn tag(self) -> u8 {
        self as u8
    }
}

/// The compressed transfer operator T~ of a bake.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Operator {
    /// A near field, and a low-rank product for the rest.
    LowRank(Box<LowRank>),
    /// A list a receiver, as published.
    Paper(PaperRows),
}

impl Operator {
    /// E = T~ B in slots: irradiance from radiosity, W/m2.
    pub(super) fn apply(
        &self,
        level: Level,
        basis: &Basis,
        radiosity: &[[f32; 3]],
    ) -> Vec<[f32; 3]> {
        match self {
            Self::LowRank(rows) => rows.apply(level, basis, radiosity),
            Self::Paper(rows) => rows.apply(level, basis, radiosity),
        }
    }

    /// Slots of the receivers that see nothing but the sky, or nothing at all.
    pub(super) fn without_senders(&self) -> Vec<Range<usize>> {
        match self {
            Self::LowRank(operator) => {
                let rows = &operator.rows;
                (0..rows.group_count())
                    .filter(|&group| rows.is_empty(group))
                    .map(|group| {
                        let (first, count) = rows.receivers(group);
                        first..first + count
                    })
                    .collect()
            }
            Self::Paper(rows) => rows.without_senders(),
        }
    }

    /// Senders (slots, ascending) of the near field of the group that begins with
    /// a slot.
    pub(super) fn near_of(&self, first_slot: u32) -> Vec<u32> {
        match self {
            Self::LowRank(rows) => rows.near_of(first_slot),
            Self::Paper(_) => Vec::new(),
        }
    }

    /// Bytes of the operator, all lists and steps.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::LowRank(rows) => rows.bytes(),
            Self::Paper(rows) => rows.bytes(),
        }
    }

    /// Entries a vertex in the mean, near field included.
    pub(crate) fn coefficients_per_vertex(&self) -> f64 {
        match self {
            Self::LowRank(rows) => rows.coefficients_per_vertex(),
            Self::Paper(rows) => rows.coefficients_per_vertex(),
        }
    }
}
