//! The laboratory's bakes: variants by the knobs of [`super::knobs`], of some
//! partitions of a scene.

use rayon::prelude::*;

use super::basis::Basis;
use super::compress::{Budget, Compressor, Scratch};
use super::excitation::Excitation;
use super::graph::VertexGraph;
use super::knobs::{self, Share};
use super::low_rank::{self, Task};
use super::neighbours::vertex_graph;
use super::operator::{receiver_groups, threshold_of, vertices_of};
use super::partition::Partition;
use super::places::Places;
use super::rows::{GroupRows, Rows};
use super::stats::BakeStats;
use super::transfer::{self, Sampling, sample_group, vertex_rays};
use super::{
    Bake, BakeError, BakeSettings, Importance, Operator, RunSettings, Study, own_partition,
    spectral_basis,
};
use crate::scene::Scene;
use crate::surface::{Detail, KeptArrivals, Surface};

/// What parts get functions by.
pub(super) fn shares(places: &Places, parts: &Partition, areas: &[f64]) -> Vec<f64> {
    let bounced = || -> Vec<f64> {
        let masses = places.masses();
        let of = |p: usize| parts.members(p).iter().map(|&v| f64::from(masses[v as usize]));
        (0..parts.part_count()).map(|p| of(p).sum()).collect()
    };
    let sizes = || (0..parts.part_count()).map(|p| parts.members(p).len() as f64);
    let roots = |shares: Vec<f64>| -> Vec<f64> {
        shares.iter().zip(sizes()).map(|(a, n)| (a * n).sqrt()).collect()
    };
    match knobs::now().share {
        Share::Area => areas.to_vec(),
        Share::Vertices => sizes().collect(),
        Share::RootOfBoth => roots(areas.to_vec()),
        Share::Bounce => bounced(),
        Share::RootOfBounce => roots(bounced()),
    }
}

/// Areas of the vertices, in the mean 1, not below a hundredth.
pub(super) fn areas(surface: &Surface) -> Vec<f32> {
    let areas = surface.vertices.areas();
    let mean = areas.iter().map(|&a| f64::from(a)).sum::<f64>() / areas.len() as f64;
    areas
        .iter()
        .map(|&a| (f64::from(a) / mean) as f32)
        .map(|a| if a > 0.01 { a } else { 0.01 })
        .collect()
}

/// Weights of a mass-weighted eigenproblem (costs are weights x 1000) and masses;
/// none for the plain combinatorial one.
pub(super) fn weights(surface: &Surface, graph: &VertexGraph) -> (VertexGraph, Vec<f64>) {
    let kind = knobs::now().laplacian;
    let count = surface.vertices.len() as u32;
    if kind == knobs::Operator::Combinatorial {
        return (VertexGraph::from_edges(count, &[]).expect("no edges"), Vec::new());
    }
    let masses = areas(surface).iter().map(|&a| f64::from(a)).collect();
    let mut found = std::collections::BTreeMap::<(u32, u32), f64>::new();
    for vertex in 0..count {
        for &other in graph.neighbours(vertex) {
            if vertex < other {
                found.insert((vertex, other), 0.0);
            }
        }
    }
    if kind == knobs::Operator::CombinatorialArea {
        found.values_mut().for_each(|w| *w = 1.0);
    } else {
        let positions = surface.vertices.positions();
        for triangle in 0..surface.mesh.triangles.len() as u32 {
            for front in [true, false] {
                let corners = surface.vertices.of_triangle(triangle, front);
                for k in 0..3 {
                    let [a, b, c] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                    let Some(weight) = found.get_mut(&(a.min(b), a.max(b))) else {
                        continue;
                    };
                    if c == crate::surface::NONE {
                        continue;
                    }
                    let at = |v: u32| positions[v as usize].as_dvec3();
                    let (u, v) = (at(a) - at(c), at(b) - at(c));
                    let sine = u.cross(v).length();
                    if sine > 0.0 {
                        *weight += 0.5 * u.dot(v) / sine;
                    }
                }
            }
        }
    }
    let edges: Vec<(u32, u32, u32)> = found
        .iter()
        .map(|(&(a, b), &w)| (a, b, (w * 1000.0).clamp(20.0, 20_000.0) as u32))
        .collect();
    let weighted = VertexGraph::from_edges(count, &edges).expect("edges of the graph");
    (weighted, masses)
}

fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    let fields: Vec<&str> = text[text.rfind(')').expect("a name")..].split(' ').collect();
    let number = |at: usize| fields[at].parse::<f64>().expect("a number");
    (number(12) + number(13)) / 100.0
}

/// Rays of a vertex's row.
pub(super) fn rays_of(surface: &Surface, rays: u32, vertex: u32) -> u32 {
    let knobs = knobs::now();
    if knobs.rays_power == 0.0 {
        return rays;
    }
    let relative = RELATIVE.read().expect("no panic");
    let _ = surface;
    let share = relative.get(vertex as usize).copied().unwrap_or(1.0);
    (((f64::from(rays) * share / 128.0).round() as u32) * 128).max(128)
}

static RELATIVE: std::sync::RwLock<Vec<f64>> = std::sync::RwLock::new(Vec::new());

/// Rays of each vertex over the mean, by the knobs.
fn set_relative_rays(surface: &Surface) {
    let knobs = knobs::now();
    let areas = surface.vertices.areas();
    let raw: Vec<f64> = areas
        .iter()
        .map(|&a| crate::maths::functions::exp(knobs.rays_power * crate::maths::functions::ln(f64::from(a).max(1e-30))))
        .collect();
    let mut scale = raw.len() as f64 / raw.iter().sum::<f64>();
    for _ in 0..20 {
        let sum: f64 = raw.iter().map(|r| (r * scale).clamp(0.125, knobs.rays_most)).sum();
        scale *= raw.len() as f64 / sum;
    }
    *RELATIVE.write().expect("no panic") = raw
        .iter()
        .map(|r| (r * scale).clamp(0.125, knobs.rays_most))
        .collect();
}

/// The surface of a scene with back sides, and the vertices of some partitions
/// spread over it, whose rows' rays are kept. Returns seconds a ray too.
pub(crate) fn prepare(
    scene: &Scene,
    pilots: usize,
    rays: u32,
    run: &RunSettings,
) -> (Surface, Vec<bool>, Vec<u8>, Vec<u32>, f64) {
    let mut surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
    let backs = surface.visible_backs(run.level);
    surface.add_backs(&backs);
    let open = surface.open_points(run.level);
    surface.vertices.set_open_points(open.clone());
    let parts = own_partition(&vertex_graph(&surface), 600);
    let count = parts.part_count();
    let pilots = pilots.min(count);
    let mut vertices: Vec<u32> = (0..pilots)
        .flat_map(|i| parts.members((2 * i + 1) * count / (2 * pilots)).to_vec())
        .collect();
    vertices.sort_unstable();
    let start = cpu_seconds();
    let lists: Vec<KeptArrivals> = vertices
        .par_chunks(32)
        .map(|list| {
            let all = list.iter().flat_map(|&vertex| {
                vertex_rays(&surface, run.level, [transfer::SEED, vertex], rays)
            });
            KeptArrivals::new(rays, all.map(|(_, (_, hit))| hit))
        })
        .collect();
    let seconds = (cpu_seconds() - start) / (vertices.len() as f64 * f64::from(rays));
    let kept = KeptArrivals::concat(rays, lists).of_some(&vertices, surface.vertices.len());
    surface.kept_arrivals = Some(kept);
    (surface, backs, open, vertices, seconds)
}

/// A basis with what it is worth.
pub(crate) struct LabBasis {
    basis: Basis,
    importance: Importance,
}

impl LabBasis {
    pub(crate) fn basis(&self) -> &Basis {
        &self.basis
    }
}

impl<'a> Study<'a> {
    pub(crate) fn in_laboratory(
        surface: &'a Surface,
        backs: Vec<bool>,
        open_points: Vec<u8>,
        run: &RunSettings,
    ) -> Result<Self, BakeError> {
        let places = Places::of(surface, run.level);
        let mut priors = Vec::new();
        super::prior::for_each(&places, run, |brightness| priors.push(brightness.to_vec()))
            .ok_or(BakeError::Cancelled)?;
        Ok(Self {
            surface,
            places,
            backs,
            open_points,
            priors,
        })
    }

    pub(crate) fn lab_basis(
        &self,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<LabBasis, BakeError> {
        let basis = spectral_basis(&self.places, settings, run)?;
        // Three priors at once.
        let mut squares = Excitation::new(&basis);
        for brightness in &self.priors {
            squares.add(&basis, run.level, brightness);
        }
        let importance = Importance {
            sigma: squares.sigma(self.priors.len()),
        };
        Ok(LabBasis { basis, importance })
    }

    /// A bake of the partitions that hold `receivers`.
    pub(crate) fn lab_bake(
        &self,
        prepared: &LabBasis,
        settings: &BakeSettings,
        receivers: &[u32],
        run: &RunSettings,
    ) -> Result<(Bake, usize), BakeError> {
        let LabBasis { basis, importance } = prepared;
        if knobs::now().rays_power != 0.0 {
            set_relative_rays(self.surface);
        }
        let mut is_wanted = vec![false; basis.part_count()];
        for &vertex in receivers {
            let (part, _) = basis.row(basis.slot_of_vertex()[vertex as usize]);
            is_wanted[part as usize] = true;
        }
        let task = Task {
            surface: self.surface,
            settings,
            run,
            basis,
            importance,
        };
        let operator = if knobs::now().sparse {
            Operator::Sparse(sparse(task, &is_wanted))
        } else {
            Operator::LowRank(Box::new(low_rank::pilot_rows(task, &is_wanted)?))
        };
        let wanted: usize = (0..basis.part_count() as u32)
            .filter(|&p| is_wanted[p as usize])
            .map(|p| basis.slot_range(p).len())
            .sum();
        let bake = Bake {
            backs: self.backs.clone(),
            open_points: self.open_points.clone(),
            basis: basis.clone(),
            operator,
            sky: None,
            stats: BakeStats::default(),
        };
        Ok((bake, wanted))
    }
}

/// Sparse lists shared by eight, near field and functions.
fn sparse(task: Task, is_wanted: &[bool]) -> Rows {
    let basis = task.basis;
    let groups = receiver_groups(basis);
    let sampling = Sampling {
        surface: task.surface,
        level: task.run.level,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: task.settings.rays,
    };
    let near = (f64::from(task.settings.coefficients) * knobs::now().near_share).round() as usize;
    let constant = basis.constant(task.run.level);
    let compressor = Compressor {
        basis,
        sigma: &task.importance.sigma,
        constant: &constant,
        budget: Budget {
            near,
            basis: task.settings.coefficients as usize - near,
        },
    };
    let wanted: Vec<(u32, u32)> = groups
        .iter()
        .copied()
        .filter(|&(first, _)| is_wanted[basis.row(first).0 as usize])
        .collect();
    let stride = wanted.len().div_ceil(256).max(1);
    let pilots: Vec<_> = wanted.iter().skip(stride / 2).step_by(stride).collect();
    let memory = || (transfer::Scratch::new(basis.slot_count()), Scratch::new(basis));
    let scores: Vec<Vec<f32>> = pilots
        .par_iter()
        .map_init(memory, |(rays, scratch), group| {
            let rows = sample_group(&sampling, vertices_of(basis, **group), rays);
            compressor.scores(&rows, scratch)
        })
        .collect();
    let threshold = threshold_of(scores.concat(), compressor.budget.basis * pilots.len());
    let rows: Vec<GroupRows> = groups
        .par_iter()
        .with_min_len(8)
        .map_init(memory, |(rays, scratch), &group| {
            if !is_wanted[basis.row(group.0).0 as usize] {
                return GroupRows::default();
            }
            let rows = sample_group(&sampling, vertices_of(basis, group), rays);
            compressor.compress(&rows, threshold, scratch)
        })
        .collect();
    Rows::join(basis.slot_count(), basis.function_count(), groups, &rows)
}
