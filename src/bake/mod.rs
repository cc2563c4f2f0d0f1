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
mod file;
mod function_shares;
mod graph;
mod inertia;
mod key;
mod laplacian;
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
use function_shares::functions_by_area;
use graph::VertexGraph;
use partition::{PartitionSettings, partition};
use rows::{GroupRows, Rows};
use transfer::{GROUP, Sampling, sample_group};

pub(crate) use cache::{CacheOutcome, load_or_bake};
pub use run::{Progress, RunSettings, Silent};
pub use settings::BakeSettings;
pub use stats::BakeStats;

use crate::simd::Level;
use crate::surface::{NONE, Surface};

/// Groups that the threshold is chosen from, spread evenly over the scene.
const PILOT_GROUPS: usize = 256;
/// Groups of eight receivers that one task of [`Bake::apply`] takes.
const GROUPS_PER_TASK: usize = 32;
/// Cost of an edge of mean length between vertices of equal normals.
const MEAN_EDGE_COST: f32 = 64.0;

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
        run.progress.stage("prior lights", 1);
        let light_count = prior::for_each(surface, run.level, |brightness| {
            sigma.add(&basis, run.level, brightness)
        });
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

/// Vertices of one triangle and side are neighbours; an edge costs its length
/// times a factor for the angle between the normals.
fn vertex_graph(surface: &Surface) -> VertexGraph {
    let positions = surface.vertices.positions();
    let normals = surface.vertices.normals();
    let mut pairs = Vec::new();
    for triangle in 0..surface.mesh.triangles.len() as u32 {
        for front in [true, false] {
            let corners = surface.vertices.of_triangle(triangle, front);
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if a != NONE && b != NONE && a != b {
                    pairs.push((a.min(b), a.max(b)));
                }
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let length = |a: u32, b: u32| (positions[a as usize] - positions[b as usize]).length();
    let total: f64 = pairs.iter().map(|&(a, b)| f64::from(length(a, b))).sum();
    let mean = (total / pairs.len().max(1) as f64) as f32;
    let edges = pairs.into_iter().map(|(a, b)| {
        let cost = (length(a, b) / mean * MEAN_EDGE_COST).clamp(1.0, 1e6) as u32;
        (
            a,
            b,
            cost * angle_class(normals[a as usize].dot(normals[b as usize])),
        )
    });
    let edges: Vec<(u32, u32, u32)> = edges.collect();
    VertexGraph::from_edges(surface.vertices.len() as u32, &edges)
        .expect("triangles name vertices that exist")
}

/// 1, 2 or 4 for normals within 5 degrees, within 15, or farther apart.
fn angle_class(cosine: f32) -> u32 {
    if cosine > 0.9962 {
        1
    } else if cosine > 0.9659 {
        2
    } else {
        4
    }
}

/// Sum over prior lights of the squared coefficient of each function.
struct Excitation {
    squares: Vec<f64>,
}

impl Excitation {
    /// sigma_k is at least this share of the mean sigma.
    const FLOOR: f64 = 0.05;

    fn new(basis: &Basis) -> Self {
        Self {
            squares: vec![0.0; basis.function_count()],
        }
    }

    fn add(&mut self, basis: &Basis, level: Level, brightness: &[f32]) {
        let in_slots: Vec<[f32; 3]> = basis
            .vertex_of_slot()
            .iter()
            .map(|&v| [brightness[v as usize], 0.0, 0.0])
            .collect();
        for (square, [c, ..]) in self
            .squares
            .iter_mut()
            .zip(basis.project_rgb(level, &in_slots))
        {
            *square += f64::from(c) * f64::from(c);
        }
    }

    fn sigma(self, light_count: usize) -> Vec<f32> {
        let sigma: Vec<f64> = self
            .squares
            .iter()
            .map(|s| (s / light_count as f64).sqrt())
            .collect();
        let mean = sigma.iter().sum::<f64>() / sigma.len().max(1) as f64;
        sigma.into_iter().map(|s| if s < mean * Self::FLOOR { mean * Self::FLOOR } else { s } as f32).collect()
    }
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
    surface.vertices.set_open_points(open_points.clone());
    Bake::compute(surface, backs, open_points, settings, run)
}
