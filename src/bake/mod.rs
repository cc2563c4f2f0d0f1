//! The precomputation: how diffuse light travels from vertex to vertex, on a
//! spectral basis of the mesh (Wang, Zhu and Humphreys, EGSR 2007).
//!
//! Comes in: a [`Surface`]. Goes out: [`Bake`], the basis and the compressed
//! rows of the operator T~. No light and no camera is known here, so one bake
//! serves all of them; albedo is not in it either, unless bounces are folded.
//!
//! partition -> basis S -> sampled transfer T and sky X -> compressed rows -> bake file
//!                                      with fixed albedo: all bounces in one -^
//!
//! Two schemes ([`Scheme`]) differ in the partitions and in how rows are
//! compressed: relume's own, and the published one in `paper`.

mod arrangement;
mod audit;
mod basis;
mod budget;
mod cache;
mod compress;
mod dense;
mod eigen;
mod energy;
mod excitation;
mod file;
mod footprint;
mod forecast;
mod function_shares;
mod graph;
mod inertia;
mod key;
mod laplacian;
mod low_rank;
mod neighbours;
mod operator;
mod paper;
mod partition;
mod pilot;
mod places;
mod prior;
#[cfg(test)]
mod progress_tests;
mod projection;
mod receivers;
#[cfg(test)]
mod response_tests;
mod rows;
mod run;
#[cfg(test)]
mod sample_graphs;
mod scheme;
mod settings;
mod sky;
#[cfg(test)]
mod sky_tests;
mod slices;
mod stats;
mod study;
mod subspace;
mod test_lights;
mod transfer;
mod window;

use glam::Vec3;
use rayon::prelude::*;
use thiserror::Error;

use basis::BasisError;
use budget::settings_for_error;
use excitation::Excitation;
use function_shares::{functions_by_share, root_shares};
use graph::VertexGraph;
use low_rank::{FoldTask, Folded, Task};
use neighbours::vertex_graph;
use partition::{Partition, PartitionSettings, partition};
use places::Places;
use rows::Rows;
use sky::Sky;
pub(crate) use slices::Slices;

pub use audit::{ErrorParts, LightErrors};
pub(crate) use basis::Basis;
pub(crate) use cache::{AlbedoOf, Baked, CacheOutcome, load_or_bake, load_stored, store_folded};
pub use forecast::BakeForecast;
pub(crate) use forecast::{forecast, forecast_of_folding};
pub(crate) use key::BakeKey;
pub(crate) use pilot::escaped_share_of_fronts;
pub(crate) use receivers::relative_error;
pub use run::{Progress, RunSettings, Silent, ThreadPool, ThreadPoolError, thread_pool};
pub(crate) use scheme::Operator;
pub use scheme::{Partitioner, Scheme};
pub(crate) use settings::RAYS as DEFAULT_RAYS;
pub use settings::{BakeSettings, FreeKeys};
pub(crate) use sky::OPEN_SHARE;
pub use stats::BakeStats;
pub(crate) use study::{Study, StudyLight, VertexFields};
pub(crate) use test_lights::{LIGHTS, TestKind};

use crate::maths::spherical_harmonics::HARMONICS;
use crate::simd::Level;
use crate::simd::rows::GroupSums;
use crate::surface::Surface;

/// Seeds of all lights that a bake is chosen or measured by.
#[cfg(test)]
pub(crate) fn light_seeds() -> Vec<u32> {
    let [choosing, reporting] = prior::SEEDS;
    let others = [budget::SEED, choosing, reporting];
    [&audit::LIGHT_SEEDS[..], &others].concat()
}

/// Seeds of the rays of a bake's rows and views, and of truths that it is chosen or
/// measured by.
#[cfg(test)]
pub(crate) fn ray_seeds() -> Vec<u32> {
    let of_rows = [transfer::SEED, places::SEED];
    [of_rows, audit::TRUE_SEEDS, budget::TRUE_SEEDS].concat()
}

/// Constants that the table of methods chose, by the names of its knobs.
#[cfg(test)]
pub(crate) fn chosen_by() -> [(&'static str, f64); 3] {
    [
        ("near share", low_rank::NEAR_SHARE),
        ("threshold of functions in V", low_rank::FUNCTION_THRESHOLD),
        (
            "noise counts",
            f64::from((low_rank::NOISE_COUNTS * 100.0).round()) / 100.0,
        ),
    ]
}

/// Groups of eight receivers that one task of [`apply_rows`] takes.
const GROUPS_PER_TASK: usize = 32;

/// The precomputed operator of a scene.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bake {
    /// Which front vertices have a back side.
    backs: Vec<bool>,
    /// Which points of each vertex's area are in the open, a bit each.
    open_points: Vec<u8>,
    basis: Basis,
    operator: Operator,
    /// Light from the sky; `None` in a scene that is closed.
    sky: Option<Sky>,
    /// The final glossy bounce; `None` where no material is glossy.
    slices: Option<Slices>,
    /// All bounces under one albedo, where it is fixed and they have a limit.
    folded: Option<Box<Folded>>,
    stats: BakeStats,
}

/// 16 coefficients of what arrives at a vertex by direction, RGB, W/m2.
type SlicedLight = [[f32; 3]; HARMONICS];

/// Which functions matter.
struct Importance {
    /// sigma_k: RMS over prior lights of the light's coefficient.
    sigma: Vec<f32>,
}

impl Importance {
    fn of(places: &Places, run: &RunSettings, basis: &Basis) -> Result<Self, BakeError> {
        let mut excitation = Excitation::new(basis);
        let take = |brightness: &[f32]| excitation.add(basis, run.level, brightness);
        let light_count = prior::for_each(places, run, take).ok_or(BakeError::Cancelled)?;
        Ok(Self {
            sigma: excitation.sigma(light_count),
        })
    }
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
        let places = Places::of(surface, run.level);
        let settings = &settings_for_error(surface, &places, settings, run)?;
        let basis = spectral_basis(&places, settings, run)?;
        let has_gloss = surface.glossy_materials.contains(&true);
        let importance = match settings.scheme {
            Scheme::Paper if !has_gloss => Importance { sigma: Vec::new() },
            _ => Importance::of(&places, run, &basis)?,
        };
        let (operator, sky, stats) = match settings.scheme {
            Scheme::Relume => {
                let (rows, sky, stats) = low_rank::sampled_rows(Task {
                    surface,
                    settings,
                    run,
                    basis: &basis,
                    importance: &importance,
                })?;
                (Operator::LowRank(Box::new(rows)), sky, stats)
            }
            Scheme::Paper => {
                let (rows, sky, stats) = paper::sampled_rows(surface, settings, run, &basis)?;
                (Operator::Paper(rows), sky, stats)
            }
        };
        let slices = match has_gloss {
            false => None,
            true => slices::sampled_slices(slices::Task {
                surface,
                rays: settings.rays,
                run,
                basis: &basis,
                importance: &importance,
                sky: &sky::basis(),
            })?,
        };
        let mut bake = Self {
            backs,
            open_points,
            basis,
            operator,
            sky,
            slices,
            folded: None,
            stats,
        };
        run.progress.stage("energy", 1);
        bake.stats.largest_eigenvalue = energy::largest_eigenvalue(&bake, run.level);
        let ratios = energy::energy_ratios(&bake, surface, &places, run.level);
        (bake.stats.energy_mean, bake.stats.energy_worst) = (ratios.mean, ratios.worst);
        bake.stats.errors = audit::stated(&bake, &places, settings, run)?;
        Ok(bake)
    }

    /// Gives a surface the back sides that the bake was made of.
    pub(crate) fn add_sides_to(&self, surface: &mut Surface) {
        surface.add_backs(&self.backs);
        surface.vertices.set_open_points(self.open_points.clone());
    }

    /// E = T~ B, irradiance from radiosity, both in slots, W/m2.
    pub(crate) fn apply(&self, level: Level, radiosity: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.operator.apply(level, &self.basis, radiosity)
    }

    /// Folds all bounces under an albedo a vertex (or makes it anew); nothing is
    /// folded where they have no limit, nor in the published scheme.
    pub(crate) fn fold(
        &mut self,
        surface: &Surface,
        albedo: &[Vec3],
        run: &RunSettings,
    ) -> Result<(), BakeError> {
        let Operator::LowRank(operator) = &self.operator else {
            return Ok(());
        };
        let vertices = self.basis.vertex_of_slot().iter();
        let albedo: Vec<[f32; 3]> = vertices.map(|&v| albedo[v as usize].to_array()).collect();
        let task = FoldTask {
            operator,
            basis: &self.basis,
            places: &Places::of(surface, run.level),
            albedo: &albedo,
            run,
        };
        self.folded = task.fold()?.map(Box::new);
        self.stats.folding = self.folded.as_ref().map(|folded| folded.errors);
        Ok(())
    }

    /// Irradiance of all bounces in slots, W/m2, from the radiosity before any,
    /// where they are folded: under the albedo that [`Self::fold`] was given.
    pub(crate) fn all_bounces(
        &self,
        level: Level,
        source: &[[f32; 3]],
        albedo: &[[f32; 3]],
    ) -> Option<Vec<[f32; 3]>> {
        let (Operator::LowRank(near), Some(folded)) = (&self.operator, &self.folded) else {
            return None;
        };
        Some(folded.all_bounces(level, (&self.basis, near), (source, albedo)))
    }

    /// Bytes of the folded bounces; 0 without.
    pub(crate) fn folded_bytes(&self) -> usize {
        self.folded.as_ref().map_or(0, |folded| folded.bytes())
    }

    /// Irradiance of the sky in slots, W/m2, from H_m of every cell (pi x its
    /// mean radiance). `unhidden` gives it for a vertex that nothing hides the
    /// sky from.
    pub(crate) fn sky_irradiance(
        &self,
        level: Level,
        cells: &[[f32; 3]],
        unhidden: impl Fn(u32) -> [f32; 3],
    ) -> Vec<[f32; 3]> {
        let mut irradiance = match &self.sky {
            Some(sky) => sky.apply(level, cells),
            None => vec![[0.0; 3]; self.basis.slot_count()],
        };
        for slot in self.operator.without_senders().into_iter().flatten() {
            let vertex = self.basis.vertex_of_slot()[slot];
            if self.open_points[vertex as usize] != 0 {
                irradiance[slot] = unhidden(vertex);
            }
        }
        irradiance
    }

    /// The final glossy bounce; `None` where no material is glossy.
    pub(crate) fn slices(&self) -> Option<&Slices> {
        self.slices.as_ref()
    }

    /// What arrives at the glossy vertices by direction: their slots, and 16
    /// coefficients each, W/m2, from the radiosity of all slots and H_m of the sky's
    /// cells (empty without a sky), W/m2.
    pub(crate) fn glossy_light(
        &self,
        level: Level,
        radiosity: &[[f32; 3]],
        cells: &[[f32; 3]],
    ) -> Option<(&[u32], Vec<SlicedLight>)> {
        let slices = self.slices.as_ref()?;
        let light = slices.apply(level, &self.basis, radiosity, cells);
        Some((&slices.receivers, light))
    }

    /// Bytes of the sky's rows; 0 in a closed scene.
    pub(crate) fn sky_bytes(&self) -> usize {
        self.sky.as_ref().map_or(0, |sky| sky.rows().bytes())
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

    /// The compressed transfer; [`Self::apply`] applies it.
    pub(crate) fn operator(&self) -> &Operator {
        &self.operator
    }

    /// What the bake says of itself.
    pub(crate) fn stats(&self) -> &BakeStats {
        &self.stats
    }
}

/// Rows times a value a sender and a value a function: what arrives at every
/// receiver, in slots.
fn apply_rows(
    level: Level,
    rows: &Rows,
    senders: &[[f32; 3]],
    functions: &[[f32; 3]],
) -> Vec<[f32; 3]> {
    let groups: Vec<_> = (0..rows.group_count())
        .into_par_iter()
        .with_min_len(GROUPS_PER_TASK)
        .map(|group| rows.gather(level, group, senders, functions))
        .collect();
    joined(rows, &groups)
}

/// Whether these are 1 / sigma of so many functions; 0 where sigma is.
fn are_scales(scales: &[f32], function_count: usize) -> bool {
    let is_scale = |scale: &f32| scale.is_finite() && *scale >= 0.0;
    scales.len() == function_count && scales.iter().all(is_scale)
}

/// The sums of all groups, a value a receiver.
fn joined(rows: &Rows, groups: &[GroupSums]) -> Vec<[f32; 3]> {
    let mut values = Vec::new();
    for (group, sums) in groups.iter().enumerate() {
        let (_, count) = rows.receivers(group);
        values.extend((0..count).map(|lane| [sums[0][lane], sums[1][lane], sums[2][lane]]));
    }
    values
}

/// Partitions the vertices and finds each partition's lowest eigenvectors; those
/// of relume's own scheme are made orthonormal under the masses of [`Places`].
fn spectral_basis(
    places: &Places,
    settings: &BakeSettings,
    run: &RunSettings,
) -> Result<Basis, BakeError> {
    let surface = places.surface();
    let graph = match settings.scheme {
        Scheme::Relume => vertex_graph(surface).without(|a, b| places.see_apart(a, b)),
        Scheme::Paper => vertex_graph(surface),
    };
    let part_size = settings.part_size(surface.vertices.len());
    let parts = match settings.scheme {
        Scheme::Relume => own_partition(&graph, part_size),
        Scheme::Paper => paper::partition(&graph, part_size)?,
    };
    let sizes: Vec<usize> = (0..parts.part_count())
        .map(|p| parts.members(p).len())
        .collect();
    let total = settings.function_count(surface.vertices.len());
    let counts = match settings.scheme {
        Scheme::Relume => {
            let masses = places.masses();
            let mass_of = |v: &u32| f64::from(masses[*v as usize]);
            let handed_on: Vec<f64> = (0..parts.part_count())
                .map(|p| parts.members(p).iter().map(mass_of).sum())
                .collect();
            functions_by_share(&root_shares(&handed_on, &sizes), &sizes, total)
        }
        Scheme::Paper => paper::equal_functions(&sizes, total),
    };
    run.progress.stage("spectral basis", sizes.len() as u64);
    let basis = Basis::build(
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
    })?;
    Ok(match settings.scheme {
        Scheme::Relume => basis.under_masses(&places.masses()),
        Scheme::Paper => basis,
    })
}

/// Partitions by relume's own partitioner, every vertex alike.
fn own_partition(graph: &VertexGraph, vertices_per_part: u32) -> Partition {
    let settings = PartitionSettings {
        vertices_per_part,
        ..PartitionSettings::default()
    };
    partition(graph, &vec![1; graph.vertex_count()], settings)
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
    run.proceed()?;
    surface.vertices.set_open_points(open_points.clone());
    Bake::compute(surface, backs, open_points, settings, run)
}
