//! What all schemes share: groups of receivers, and the rows of the sky.

use rayon::prelude::*;

use super::basis::Basis;
use super::compress::{Budget, Compressor, Scratch};
use super::rows::{GroupRows, Rows};
use super::sky::{self, Sky};
use super::stats::{GroupStats, escaped_past_something};
use super::transfer::{self, GROUP, GroupTransfer, Sampling, sample_group};
use crate::simd::Level;

/// Groups that the thresholds are chosen from, spread evenly over the scene.
pub(super) const PILOT_GROUPS: usize = 256;

/// Compresses what groups see of the sky.
pub(super) struct SkyRows<'a> {
    groups: &'a [(u32, u32)],
    basis: Basis,
    sigma: Vec<f32>,
    constant: Vec<f32>,
    /// Score below which a function is dropped from a group.
    threshold: f32,
}

impl<'a> SkyRows<'a> {
    /// Keeps every function.
    pub(super) fn unlimited(groups: &'a [(u32, u32)]) -> Self {
        let (cells, level) = (sky::basis(), Level::Scalar);
        Self {
            groups,
            sigma: sky::sigma(&cells, level),
            constant: cells.constant(level),
            basis: cells,
            threshold: 0.0,
        }
    }

    /// Finds the threshold that keeps the budget in the mean of pilot groups.
    /// Returns too what else is asked of these: of the vertices of each and their
    /// transfer.
    pub(super) fn new<T: Send>(
        basis: &Basis,
        sampling: Sampling,
        groups: &'a [(u32, u32)],
        ask: impl Fn(&[u32], &GroupTransfer) -> T + Sync,
    ) -> (Self, Vec<T>) {
        let mut sky = Self::unlimited(groups);
        let scratch = || sky.scratch();
        let (scores, answers): (Vec<Vec<f32>>, Vec<T>) = of_pilots(
            basis,
            sampling,
            groups,
            PILOT_GROUPS,
            scratch,
            |scratch, vertices, rows| {
                let scores = sky.compressor().scores(&sky::transfer_of(rows), scratch);
                (scores, ask(vertices, rows))
            },
        )
        .into_iter()
        .unzip();
        let budget = sky.compressor().budget.basis * scores.len();
        sky.threshold = threshold_of(scores.concat(), budget);
        (sky, answers)
    }

    fn compressor(&self) -> Compressor<'_> {
        Compressor {
            basis: &self.basis,
            sigma: &self.sigma,
            constant: &self.constant,
            budget: Budget::of(sky::COEFFICIENTS),
        }
    }

    /// One worker's memory.
    pub(super) fn scratch(&self) -> Scratch {
        Scratch::new(&self.basis)
    }

    /// The rows of a sampled group.
    pub(super) fn compress(&self, group: &GroupTransfer, scratch: &mut Scratch) -> GroupRows {
        let of_sky = sky::transfer_of(group);
        self.compressor().compress(&of_sky, self.threshold, scratch)
    }

    /// The sky of all groups, in their order; `None` in a closed scene.
    pub(super) fn finish(&self, stats: &[GroupStats], rows: &[GroupRows]) -> Option<Sky> {
        sky::is_open(escaped_past_something(stats)).then(|| {
            let (senders, functions) = (self.basis.slot_count(), self.basis.function_count());
            let rows = Rows::join(senders, functions, self.groups.to_vec(), rows);
            Sky::new(self.basis.clone(), rows)
        })
    }
}

/// Samples about `count` groups, spread evenly over some, and asks something of
/// the vertices and the transfer of each.
pub(super) fn of_pilots<S: Send, T: Send>(
    basis: &Basis,
    sampling: Sampling,
    groups: &[(u32, u32)],
    count: usize,
    scratch: impl Fn() -> S + Sync + Send,
    ask: impl Fn(&mut S, &[u32], &GroupTransfer) -> T + Sync + Send,
) -> Vec<T> {
    let stride = groups.len().div_ceil(count).max(1);
    // By vertices, not slots: an order that does not depend on how partitions are
    // numbered, and nor do the thresholds then.
    let mut groups = groups.to_vec();
    groups.sort_unstable_by_key(|&group| vertices_of(basis, group)[0]);
    let chosen = groups.into_iter().skip(stride / 2).step_by(stride);
    let chosen: Vec<(u32, u32)> = chosen.collect();
    chosen
        .par_iter()
        .map_init(
            || (transfer::Scratch::new(basis.slot_count()), scratch()),
            |(transfer, scratch), &group| {
                let vertices = vertices_of(basis, group);
                let sampled = sample_group(&sampling, vertices, transfer);
                ask(scratch, vertices, &sampled)
            },
        )
        .collect()
}

/// The score of the last one that `budget` pays for.
pub(super) fn threshold_of(mut scores: Vec<f32>, budget: usize) -> f32 {
    if scores.len() <= budget || budget == 0 {
        return 0.0;
    }
    let (_, threshold, _) = scores.select_nth_unstable_by(budget - 1, |a, b| b.total_cmp(a));
    *threshold
}

/// Runs of up to eight slots of one partition: (first slot, count).
pub(super) fn receiver_groups(basis: &Basis) -> Vec<(u32, u32)> {
    let mut groups = Vec::new();
    for part in 0..basis.part_count() as u32 {
        let slots = basis.slot_range(part);
        for first in slots.clone().step_by(GROUP) {
            groups.push((first as u32, (slots.end - first).min(GROUP) as u32));
        }
    }
    groups
}

/// Vertices of a run of slots.
pub(super) fn vertices_of(basis: &Basis, (first, count): (u32, u32)) -> &[u32] {
    &basis.vertex_of_slot()[first as usize..(first + count) as usize]
}
