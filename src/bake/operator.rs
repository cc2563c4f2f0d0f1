//! The rows of all receivers: sampled group by group and compressed at once, so
//! that no matrix of all vertices ever exists.

use rayon::prelude::*;

use super::basis::Basis;
use super::compress::{self, Budget, Compressor};
use super::rows::{GroupRows, Rows};
use super::sky::{self, Sky};
use super::stats::{BakeStats, GroupStats, escaped_past_something};
use super::transfer::{self, GROUP, GroupTransfer, Sampling, sample_group};
use super::{BakeError, BakeSettings, Importance, RunSettings};
use crate::surface::Surface;

/// Groups that the thresholds are chosen from, spread evenly over the scene.
pub(super) const PILOT_GROUPS: usize = 256;

/// Samples and compresses all rows: of the surfaces, and of the sky where the
/// scene is open.
pub(super) fn sampled_rows(
    surface: &Surface,
    settings: &BakeSettings,
    run: &RunSettings,
    basis: &Basis,
    importance: &Importance,
) -> Result<(Rows, Option<Sky>, BakeStats), BakeError> {
    let sampling = Sampling {
        surface,
        level: run.level,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: settings.rays,
    };
    let constant = basis.constant(run.level);
    let compressor = Compressor {
        basis,
        sigma: &importance.sigma,
        witnesses: Some(&importance.witnesses),
        constant: &constant,
        budget: Budget::of(settings.coefficients),
    };
    let sky_basis = sky::basis();
    let (sky_sigma, sky_constant) = (
        sky::sigma(&sky_basis, run.level),
        sky_basis.constant(run.level),
    );
    let sky_compressor = Compressor {
        basis: &sky_basis,
        sigma: &sky_sigma,
        witnesses: None,
        constant: &sky_constant,
        budget: Budget::of(sky::COEFFICIENTS),
    };
    let groups = receiver_groups(basis);
    let job = Job {
        sampling,
        surfaces: compressor,
        sky: sky_compressor,
        groups: &groups,
    };
    let thresholds = job.pilot_thresholds();
    if run.progress.cancelled() {
        return Err(BakeError::Cancelled);
    }
    run.progress.stage("transfer", groups.len() as u64);
    let found = job.compress_all(thresholds, run)?;

    let stats: Vec<GroupStats> = found.iter().map(|f| f.stats).collect();
    let is_open = sky::is_open(escaped_past_something(&stats));
    let stats = BakeStats::of(&stats, settings, thresholds[0]);
    let (rows, sky_rows): (Vec<GroupRows>, Vec<GroupRows>) =
        found.into_iter().map(|f| (f.rows, f.sky)).unzip();
    let sky = is_open.then(|| {
        Sky::new(
            sky_basis.clone(),
            Rows::join(
                sky_basis.slot_count(),
                sky_basis.function_count(),
                groups.clone(),
                &sky_rows,
            ),
        )
    });
    let rows = Rows::join(basis.slot_count(), basis.function_count(), groups, &rows);
    rows.check(basis.slot_count())
        .expect("rows that were just made fit each other");
    Ok((rows, sky, stats))
}

/// What sampling and compressing need.
struct Job<'a> {
    sampling: Sampling<'a>,
    surfaces: Compressor<'a>,
    sky: Compressor<'a>,
    groups: &'a [(u32, u32)],
}

/// One group, sampled and compressed.
struct FoundGroup {
    rows: GroupRows,
    sky: GroupRows,
    stats: GroupStats,
}

/// One worker's memory.
struct Scratch {
    transfer: transfer::Scratch,
    surfaces: compress::Scratch,
    sky: compress::Scratch,
}

impl Job<'_> {
    fn scratch(&self) -> Scratch {
        Scratch {
            transfer: transfer::Scratch::new(self.surfaces.basis.slot_count()),
            surfaces: compress::Scratch::new(self.surfaces.basis),
            sky: compress::Scratch::new(self.sky.basis),
        }
    }

    fn sample(&self, group: (u32, u32), scratch: &mut Scratch) -> GroupTransfer {
        let receivers = vertices_of(self.surfaces.basis, group);
        sample_group(&self.sampling, receivers, &mut scratch.transfer)
    }

    fn compress_all(
        &self,
        [threshold, sky_threshold]: [f32; 2],
        run: &RunSettings,
    ) -> Result<Vec<FoundGroup>, BakeError> {
        self.groups
            .par_iter()
            .map_init(
                || self.scratch(),
                |scratch, &group| {
                    if run.progress.cancelled() {
                        return Err(BakeError::Cancelled);
                    }
                    let transfer = self.sample(group, scratch);
                    let rows = self
                        .surfaces
                        .compress(&transfer, threshold, &mut scratch.surfaces);
                    let of_sky = sky::transfer_of(&transfer);
                    let sky = self.sky.compress(&of_sky, sky_threshold, &mut scratch.sky);
                    run.progress.advance(1);
                    Ok(FoundGroup {
                        rows,
                        sky,
                        stats: GroupStats::of(&transfer, group.1 as usize),
                    })
                },
            )
            .collect()
    }

    /// The scores below which a function is dropped from a group, so that pilot
    /// groups keep the budget in the mean: of surfaces and of the sky.
    fn pilot_thresholds(&self) -> [f32; 2] {
        let pilots = pilot_groups(self.groups);
        let scores: Vec<[Vec<f32>; 2]> = pilots
            .par_iter()
            .map_init(
                || self.scratch(),
                |scratch, &group| {
                    let transfer = self.sample(group, scratch);
                    [
                        self.surfaces.scores(&transfer, &mut scratch.surfaces),
                        self.sky
                            .scores(&sky::transfer_of(&transfer), &mut scratch.sky),
                    ]
                },
            )
            .collect();
        let threshold = |kind: usize, budget: usize| {
            let all = scores.iter().flat_map(|s| s[kind].iter().copied());
            threshold_of(all.collect(), budget * scores.len())
        };
        [
            threshold(0, self.surfaces.budget.basis),
            threshold(1, self.sky.budget.basis),
        ]
    }
}

/// The groups that thresholds are chosen from.
pub(super) fn pilot_groups(groups: &[(u32, u32)]) -> Vec<(u32, u32)> {
    let stride = groups.len().div_ceil(PILOT_GROUPS).max(1);
    let chosen = groups.iter().copied().skip(stride / 2).step_by(stride);
    chosen.collect()
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
