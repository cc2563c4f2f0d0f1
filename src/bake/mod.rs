//! The precomputation: how diffuse light travels from vertex to vertex, on a
//! spectral basis of the mesh (Wang, Zhu and Humphreys, EGSR 2007).
//!
//! Comes in: a [`Surface`]. Goes out: [`Bake`], the basis and the compressed
//! rows of the operator T~. No light and no camera is known here, so one bake
//! serves all of them; albedo is not in it either.
//!
//! partition -> basis S -> sampled transfer T -> compressed rows -> bake file

mod basis;
mod cache;
mod compress;
mod dense;
mod eigen;
mod energy;
mod excitation;
mod file;
mod function_shares;
mod graph;
mod inertia;
mod key;
mod laplacian;
mod neighbours;
mod partition;
mod prior;
#[cfg(test)]
mod response_tests;
mod rows;
mod run;
#[cfg(test)]
mod sample_graphs;
mod settings;
mod stats;
mod subspace;
mod transfer;

use rayon::prelude::*;
use thiserror::Error;

use basis::{Basis, BasisError};
use compress::{Budget, Compressor};
use excitation::Excitation;
use function_shares::functions_by_area;
use neighbours::vertex_graph;
use partition::{PartitionSettings, partition};
use rows::{GroupRows, Rows};
use transfer::{GROUP, Sampling, sample_group};

pub(crate) use cache::{CacheOutcome, load_or_bake};
pub use run::{Progress, RunSettings, Silent};
pub use settings::BakeSettings;
pub use stats::BakeStats;

use crate::simd::Level;
use crate::surface::Surface;

/// Groups that the threshold is chosen from, spread evenly over the scene.
const PILOT_GROUPS: usize = 256;
/// Groups of eight receivers that one task of [`Bake::apply`] takes.
const GROUPS_PER_TASK: usize = 32;
/// The precomputed operator of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bake {
    /// Which front vertices have a back side.
    backs: Vec<bool>,
    /// Which points of each vertex's area are in the open, a bit each.
    open_points: Vec<u8>,
    basis: Basis,
    rows: Rows,
    stats: BakeStats,
}

/// Why there is no bake.
#[derive(Debug, Error)]
pub enum BakeError {
    /// The job was stopped.
    #[error("the bake was stopped; nothing was written")]
    Cancelled,
    /// A partition's eigenvectors were not found.
    #[error("the spectral basis could not be computed: {0}")]
    Basis(String),
}

impl Bake {
    /// Bakes a surface whose back sides exist.
    fn compute(
        surface: &Surface,
        backs: Vec<bool>,
        open_points: Vec<u8>,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<Self, BakeError> {
        let basis = spectral_basis(surface, settings, run)?;
        let mut sigma = Excitation::new(&basis);
        let add = |brightness: &[f32]| sigma.add(&basis, run.level, brightness);
        let light_count = prior::for_each(surface, run, add).ok_or(BakeError::Cancelled)?;
        let sigma = sigma.sigma(light_count);
        let (rows, stats) = compressed_rows(surface, settings, run, &basis, &sigma)?;
        let mut bake = Self {
            backs,
            open_points,
            basis,
            rows,
            stats,
        };
        run.progress.stage("energy", 1);
        bake.stats.largest_eigenvalue = energy::largest_eigenvalue(&bake, run.level);
        let ratios = energy::energy_ratios(&bake, surface, run.level);
        (bake.stats.energy_mean, bake.stats.energy_worst) = (ratios.mean, ratios.worst);
        Ok(bake)
    }

    /// E = T~ B, irradiance from radiosity, both in slots, W/m2.
    pub(crate) fn apply(&self, level: Level, radiosity: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let light = self.basis.project_rgb(level, radiosity);
        let groups: Vec<_> = (0..self.rows.group_count())
            .into_par_iter()
            .with_min_len(GROUPS_PER_TASK)
            .map(|group| self.rows.gather(level, group, radiosity, &light))
            .collect();
        let mut irradiance = Vec::with_capacity(radiosity.len());
        for (group, sums) in groups.iter().enumerate() {
            let (_, count) = self.rows.receivers(group);
            irradiance.extend((0..count).map(|lane| [sums[0][lane], sums[1][lane], sums[2][lane]]));
        }
        irradiance
    }

    /// Which front vertices have a back side.
    pub(crate) fn backs(&self) -> &[bool] {
        &self.backs
    }

    /// Which points of each vertex's area are in the open, a bit each.
    pub(crate) fn open_points(&self) -> &[u8] {
        &self.open_points
    }

    /// The basis; its slots are the order in which the rows work.
    pub(crate) fn basis(&self) -> &Basis {
        &self.basis
    }

    /// The compressed rows; [`Self::apply`] applies them.
    pub(crate) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// What the bake says of itself.
    pub(crate) fn stats(&self) -> &BakeStats {
        &self.stats
    }
}

/// Partitions the vertices and finds each partition's lowest eigenvectors.
fn spectral_basis(
    surface: &Surface,
    settings: &BakeSettings,
    run: &RunSettings,
) -> Result<Basis, BakeError> {
    let graph = vertex_graph(surface);
    let weights = vec![1; surface.vertices.len()];
    let parts = partition(
        &graph,
        &weights,
        PartitionSettings {
            vertices_per_part: settings.vertices_per_part,
            ..PartitionSettings::default()
        },
    );
    let area_of = |v: &u32| f64::from(surface.vertices.areas()[*v as usize]);
    let areas: Vec<f64> = (0..parts.part_count())
        .map(|p| parts.members(p).iter().map(area_of).sum())
        .collect();
    let sizes: Vec<usize> = (0..parts.part_count())
        .map(|p| parts.members(p).len())
        .collect();
    let counts = functions_by_area(
        &areas,
        &sizes,
        settings.function_count(surface.vertices.len()),
    );
    run.progress.stage("spectral basis", sizes.len() as u64);
    Basis::build(
        &graph,
        &parts,
        &counts,
        &|| run.progress.advance(1),
        &|| run.progress.cancelled(),
    )
    .map_err(|error| match error {
        BasisError::Cancelled => BakeError::Cancelled,
        BasisError::Part { part, source } => {
            BakeError::Basis(format!("partition {part}: {source}"))
        }
    })
}

/// Samples and compresses all rows.
fn compressed_rows(
    surface: &Surface,
    settings: &BakeSettings,
    run: &RunSettings,
    basis: &Basis,
    sigma: &[f32],
) -> Result<(Rows, BakeStats), BakeError> {
    let constant = basis.constant(run.level);
    let budget = Budget::of(settings.coefficients);
    let compressor = Compressor {
        basis,
        sigma,
        constant: &constant,
        budget,
    };
    let sampling = Sampling {
        surface,
        level: run.level,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: settings.rays,
    };
    let groups = receiver_groups(basis);
    let threshold = pilot_threshold(&sampling, &compressor, &groups);

    if run.progress.cancelled() {
        return Err(BakeError::Cancelled);
    }
    run.progress.stage("transfer", groups.len() as u64);
    let sampled: Vec<(GroupRows, stats::GroupStats)> = groups
        .par_iter()
        .map_init(
            || {
                (
                    transfer::Scratch::new(basis.slot_count()),
                    compress::Scratch::new(basis),
                )
            },
            |(sample, compress), &group| {
                if run.progress.cancelled() {
                    return Err(BakeError::Cancelled);
                }
                let transfer = sample_group(&sampling, vertices_of(basis, group), sample);
                let rows = compressor.compress(&transfer, threshold, compress);
                run.progress.advance(1);
                Ok((rows, stats::GroupStats::of(&transfer, group.1 as usize)))
            },
        )
        .collect::<Result<_, _>>()?;
    let (rows, group_stats): (Vec<GroupRows>, Vec<stats::GroupStats>) = sampled.into_iter().unzip();
    let rows = Rows::join(basis.slot_count(), basis.function_count(), groups, &rows);
    rows.check()
        .expect("rows that were just made fit each other");
    Ok((rows, BakeStats::of(&group_stats, settings, threshold)))
}

/// Runs of up to eight slots of one partition: (first slot, count).
fn receiver_groups(basis: &Basis) -> Vec<(u32, u32)> {
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
fn vertices_of(basis: &Basis, (first, count): (u32, u32)) -> &[u32] {
    &basis.vertex_of_slot()[first as usize..(first + count) as usize]
}

/// The score below which a function is dropped from a group, so that pilot
/// groups keep the budget in the mean.
fn pilot_threshold(sampling: &Sampling, compressor: &Compressor, groups: &[(u32, u32)]) -> f32 {
    let stride = groups.len().div_ceil(PILOT_GROUPS).max(1);
    let pilots: Vec<(u32, u32)> = groups
        .iter()
        .copied()
        .skip(stride / 2)
        .step_by(stride)
        .collect();
    let basis = compressor.basis;
    let mut scores: Vec<f32> = pilots
        .par_iter()
        .map_init(
            || {
                (
                    transfer::Scratch::new(basis.slot_count()),
                    compress::Scratch::new(basis),
                )
            },
            |(sample, compress), &group| {
                compressor.scores(
                    &sample_group(sampling, vertices_of(basis, group), sample),
                    compress,
                )
            },
        )
        .flatten_iter()
        .collect();
    let budget = compressor.budget.basis * pilots.len();
    if scores.len() <= budget || budget == 0 {
        return 0.0;
    }
    let (_, threshold, _) = scores.select_nth_unstable_by(budget - 1, |a, b| b.total_cmp(a));
    *threshold
}

/// The whole bake of a surface without a cache: back sides, then the operator.
fn bake(
    surface: &mut Surface,
    settings: &BakeSettings,
    run: &RunSettings,
) -> Result<Bake, BakeError> {
    run.progress.stage("back sides", 1);
    let backs = surface.visible_backs(run.level);
    surface.add_backs(&backs);
    let open_points = surface.open_points(run.level);
    if run.progress.cancelled() {
        return Err(BakeError::Cancelled);
    }
    surface.vertices.set_open_points(open_points.clone());
    Bake::compute(surface, backs, open_points, settings, run)
}
