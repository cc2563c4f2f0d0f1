//! What a bake will be like, before it is made: counts and bytes by the rules of
//! the bake itself from a survey of its rays, seconds from a short run of its
//! most expensive stage.

use std::time::Instant;

use super::compress::Budget;
use super::function_shares::{functions_by_share, root_shares};
use super::neighbours::vertex_graph;
use super::operator::PILOT_GROUPS;
use super::pilot::{GroupView, SurveyJob, seconds_a_row};
use super::scheme::{Partitioner, Scheme};
use super::sky;
use super::slices::{self, Slices};
use super::transfer::GROUP;
use super::{Bake, BakeError, BakeSettings, RunSettings, low_rank};
use crate::maths::cube_cells::CELL_COUNT;
use crate::maths::order::Order;
use crate::surface::Surface;

/// Rays that find the back sides, in all; more only in meshes of more than
/// 100,000 fronts.
const MOST_SIDE_RAYS: usize = 400_000;

/// What a bake will be like, or is where it is in the cache already.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeForecast {
    /// How the transfer is stored.
    pub scheme: Scheme,
    /// What cuts the mesh into partitions.
    pub partitioner: Partitioner,
    /// Whether the bake exists: all figures are its own, and nothing is to do.
    pub cached: bool,
    /// Lighting vertices, both sides.
    pub vertices: usize,
    /// Those on back sides.
    pub back_vertices: usize,
    /// Whether the back sides were found as the bake finds them; otherwise by
    /// fewer rays, so that all counts are about right.
    pub sides_are_exact: bool,
    /// Rays a vertex.
    pub rays: u32,
    /// Share of all rays that escape, 0 to 1.
    pub escaped_share: f64,
    /// Whether so much escapes that the bake holds the light of the sky.
    pub has_sky: bool,
    /// Partitions of the basis.
    pub partitions: usize,
    /// Basis functions in all.
    pub functions: usize,
    /// Entries a vertex in the mean, near field included.
    pub coefficients_per_vertex: f64,
    /// Bytes of the bake's file.
    pub bytes: usize,
    /// Bytes of the compressed rows.
    pub row_bytes: usize,
    /// Bytes of the rows of the sky.
    pub sky_bytes: usize,
    /// Vertices of glossy materials.
    pub glossy_vertices: usize,
    /// Bytes of their slices.
    pub slice_bytes: usize,
    /// Bytes of the folded bounces, where the albedo is fixed; else 0.
    pub folded_bytes: usize,
    /// Most memory that the program takes while it bakes or loads the bake,
    /// bytes, without the scene's images.
    pub peak_bytes: usize,
    /// Seconds on the threads of the current pool, if the machine stays as
    /// busy as it is; 0 where there is nothing to do.
    pub seconds: f64,
}

/// Forecasts the bake of a surface, whose back sides do not exist yet, and do
/// not afterwards; `folds` if all bounces are to be folded.
///
/// # Errors
/// When cancelled.
pub(crate) fn forecast(
    surface: &mut Surface,
    settings: &BakeSettings,
    folds: bool,
    run: &RunSettings,
) -> Result<BakeForecast, BakeError> {
    run.progress.stage("pilot", 1);
    let start = Instant::now();
    let (backs, times_as_many) = surface.about_visible_backs(run.level, MOST_SIDE_RAYS);
    let seconds_of_backs = start.elapsed().as_secs_f64() * times_as_many;
    let fronts = surface.vertices.clone();
    surface.add_backs(&backs);
    let mut forecast = with_sides(surface, settings, folds, run);
    surface.vertices = fronts;
    if run.progress.cancelled() {
        return Err(BakeError::Cancelled);
    }
    forecast.sides_are_exact = times_as_many == 1.0;
    forecast.seconds += seconds_of_backs;
    Ok(forecast)
}

/// Forecasts the folding of a bake that exists, of a surface with its back sides.
///
/// # Errors
/// When cancelled.
pub(crate) fn forecast_of_folding(
    surface: &Surface,
    (bake, file_bytes): (&Bake, usize),
    run: &RunSettings,
) -> Result<BakeForecast, BakeError> {
    run.progress.stage("pilot", 1);
    let rays = bake.stats().rays;
    let seconds_a_ray = seconds_a_row(surface, rays, run) / f64::from(rays.max(1));
    if run.progress.cancelled() {
        return Err(BakeError::Cancelled);
    }
    let mut forecast = BakeForecast {
        cached: false,
        ..BakeForecast::of(bake, file_bytes)
    };
    forecast.add_folding(seconds_a_ray);
    Ok(forecast)
}

impl BakeForecast {
    /// The figures of a bake that exists.
    pub(crate) fn of(bake: &Bake, file_bytes: usize) -> Self {
        let vertices = bake.basis().slot_count();
        Self {
            scheme: bake.stats().scheme,
            partitioner: bake.stats().partitioner,
            cached: true,
            vertices,
            back_vertices: vertices - bake.backs().len(),
            sides_are_exact: true,
            rays: bake.stats().rays,
            escaped_share: bake.stats().escaped_share,
            has_sky: bake.sky.is_some(),
            partitions: bake.basis().part_count(),
            functions: bake.basis().function_count(),
            coefficients_per_vertex: bake.operator().coefficients_per_vertex(),
            bytes: file_bytes,
            row_bytes: bake.operator().bytes(),
            sky_bytes: bake.sky_bytes(),
            glossy_vertices: bake.slices().map_or(0, Slices::vertex_count),
            slice_bytes: bake.slices().map_or(0, Slices::bytes),
            folded_bytes: bake.folded_bytes(),
            peak_bytes: peak_bytes(vertices, file_bytes, LOADING_COPIES),
            seconds: 0.0,
        }
    }
}

/// Bytes of folded bounces a vertex.
const FOLDED_BYTES_A_VERTEX: f64 = 125.0;
/// Time of one endless solution for each vertex, in rays of the transfer.
const RAYS_OF_SOLUTION: f64 = 3.0;

impl BakeForecast {
    /// Adds what folding all bounces costs.
    fn add_folding(&mut self, seconds_a_ray: f64) {
        self.folded_bytes = (self.vertices as f64 * FOLDED_BYTES_A_VERTEX) as usize;
        self.bytes += self.folded_bytes;
        self.peak_bytes += low_rank::folding_bytes(self.partitions, self.functions);
        let solutions = low_rank::solutions_to_fold(self.functions) as f64;
        self.seconds += seconds_a_ray * RAYS_OF_SOLUTION * solutions * self.vertices as f64;
    }
}

/// Memory of the program itself and of a vertex (its share of the mesh and the
/// ray tree), and copies of the bake's bytes that are in memory at the worst
/// moment: rows group by group, joined rows whose lists have grown, and the
/// file. Measured on two threads, most resident memory in MB against this:
/// cornell 88/94, window 93/98, statues 156/147, spot_cow 46/42 (and 6 of
/// images), bunny_room 204/199.
const PROGRAM_BYTES: usize = 10_000_000;
const BYTES_A_VERTEX: usize = 550;
const BAKING_COPIES: f64 = 4.5;
/// The same where the bake is read: the file and the bake.
const LOADING_COPIES: f64 = 2.0;

fn peak_bytes(vertices: usize, file_bytes: usize, copies: f64) -> usize {
    PROGRAM_BYTES + vertices * BYTES_A_VERTEX + (file_bytes as f64 * copies) as usize
}

/// Times of stages for each vertex, in rays of the transfer. Measured in
/// cornell, statues and spot_cow: 15, 20 and 30; 109, 113 and 248 (where three
/// of four rays of the transfer escape and are cheap); 36, 28 and 34.
const RAYS_OF_BASIS: f64 = 20.0;
const RAYS_OF_PRIOR_LIGHTS: f64 = 130.0;
const RAYS_OF_ENERGY: f64 = 33.0;
/// Points of a vertex's area times the rays of each that tell whether it is in
/// the open.
const RAYS_OF_OPEN_POINTS: f64 = 32.0;

/// The pieces that vertices fall into, as far as they matter here.
struct Pieces {
    component_of: Vec<u32>,
    /// Vertices, parts and functions of each component.
    sizes: Vec<usize>,
    parts: Vec<usize>,
    functions: Vec<usize>,
    /// Receivers, about as the bake groups them.
    groups: Vec<Vec<u32>>,
}

impl Pieces {
    /// Parts of a component count as equal in vertices and area.
    fn of(surface: &Surface, settings: &BakeSettings) -> Self {
        let vertex_count = surface.vertices.len();
        let components = match settings.scheme.partitioner() {
            Partitioner::Relume => vertex_graph(surface).connected_components(),
            // The parts of METIS hold small components together.
            Partitioner::Metis => vec![(0..vertex_count as u32).collect()],
        };
        let mut component_of = vec![0; vertex_count];
        for (index, members) in components.iter().enumerate() {
            for &vertex in members {
                component_of[vertex as usize] = index as u32;
            }
        }
        let per_part = settings.part_size(vertex_count).max(1) as usize;
        let parts_of = |size: usize| ((size + per_part / 2) / per_part).clamp(1, size.max(1));
        let parts: Vec<usize> = components.iter().map(|c| parts_of(c.len())).collect();
        let (mut part_areas, mut part_sizes) = (Vec::new(), Vec::new());
        for (members, &parts) in components.iter().zip(&parts) {
            let areas = members
                .iter()
                .map(|&v| surface.vertices.areas()[v as usize]);
            let area: f64 = areas.map(f64::from).sum();
            part_areas.extend(std::iter::repeat_n(area / parts as f64, parts));
            part_sizes.extend(std::iter::repeat_n(members.len() / parts, parts));
        }
        let total = settings.function_count(vertex_count);
        // What a part hands on is not known here; its area stands for it.
        let shares = match settings.scheme {
            Scheme::Relume => root_shares(&part_areas, &part_sizes),
            Scheme::Paper => vec![1.0; part_sizes.len()],
        };
        let of_parts = functions_by_share(&shares, &part_sizes, total);
        let mut rest = of_parts.as_slice();
        let mut functions = Vec::new();
        for &parts in &parts {
            let (own, others) = rest.split_at(parts);
            functions.push(own.iter().map(|&count| count as usize).sum());
            rest = others;
        }
        Self {
            component_of,
            sizes: components.iter().map(Vec::len).collect(),
            parts,
            functions,
            groups: components
                .iter()
                .flat_map(|members| members.chunks(GROUP).map(<[u32]>::to_vec))
                .collect(),
        }
    }

    /// Groups of all parts: the last of each may be shorter.
    fn group_count(&self) -> usize {
        let of_component =
            |(&size, &parts): (&usize, &usize)| parts * (size / parts).div_ceil(GROUP);
        self.sizes.iter().zip(&self.parts).map(of_component).sum()
    }

    /// Values of all functions: those of a part at its vertices.
    fn value_count(&self) -> usize {
        let of_component = |i: usize| self.sizes[i] * self.functions[i] / self.parts[i];
        (0..self.sizes.len()).map(of_component).sum()
    }
}

/// Entries of a group's lists, in the mean.
#[derive(Debug, Clone, Copy)]
struct Entries {
    near: f64,
    basis: f64,
}

impl Entries {
    /// A group whose rays met so many senders, of which those with functions.
    fn of_group(budget: Budget, senders: f64, functions: f64) -> Self {
        let near = senders.at_most(budget.near as f64);
        let is_spending = senders > near;
        let most = if is_spending {
            budget.basis as f64
        } else {
            0.0
        };
        Self {
            near,
            basis: most.at_most(functions),
        }
    }

    fn mean(of_groups: impl ExactSizeIterator<Item = Self>) -> Self {
        let count = of_groups.len().max(1) as f64;
        let (near, basis) = of_groups.fold((0.0, 0.0), |(near, basis), entries| {
            (near + entries.near, basis + entries.basis)
        });
        Self {
            near: near / count,
            basis: basis / count,
        }
    }

    /// Bytes of rows, as [`super::rows::Rows::bytes`] counts them.
    fn row_bytes(self, groups: usize, senders: usize, functions: usize) -> usize {
        let index = |table: usize| if table <= 1 << 16 { 2.0 } else { 4.0 };
        let near = self.near * (index(senders) + GROUP as f64);
        let basis = self.basis * (index(functions) + GROUP as f64);
        ((near + basis) * groups as f64) as usize + groups * (2 * GROUP * 4 + 3 * 4)
    }

    /// Bytes of a near field and a product, as [`super::low_rank::LowRank::bytes`]
    /// counts them.
    fn low_rank_bytes(
        self,
        groups: usize,
        senders: usize,
        functions: usize,
        parts: usize,
    ) -> usize {
        // The components of a group are a run: its functions have no numbers.
        let rows = Self { basis: 0.0, ..self }.row_bytes(groups, senders, functions)
            + (self.basis * GROUP as f64 * groups as f64) as usize
            + groups * 4;
        let component_groups = self.basis * parts as f64 / GROUP as f64;
        let lists = Self {
            near: 0.0,
            basis: functions as f64 * LISTED_SHARE,
        };
        rows + functions * 4 + lists.row_bytes(component_groups.ceil() as usize, 0, functions)
    }
}

/// Share of all functions that a group of components lists: 0.05 in the window's
/// room, 0.06 in the statues' hall, 0.08 in cornell, 0.12 in the sheet's room. (Bytes
/// of rows are then 1.11, 1.02, 0.94 and 0.84 of those of default bakes.)
const LISTED_SHARE: f64 = 0.06;

/// Share of the components paid for that stand out of the noise of so many rays: 0.55
/// in a small room at 64, all of them in the larger scenes from 128 on.
fn components_kept(rays: u32) -> f64 {
    1.0 - 0.4 * (64.0 / f64::from(rays)).at_most(1.0)
}

/// Bytes of the published table, as [`super::paper::PaperRows::bytes`] counts
/// them, of so many coefficients a vertex.
fn paper_bytes(coefficients: f64, vertices: usize, functions: usize) -> usize {
    let entry = if functions <= 1 << 16 { 3.0 } else { 5.0 };
    (coefficients * entry * vertices as f64) as usize + vertices * 5 + 8
}

/// Bytes of a file that do not grow with the bake: header, figures, and lengths
/// of lists.
const FILE_FRAME_BYTES: usize = 350;
/// Bytes of a group that are in the file only: its receivers.
const RECEIVER_BYTES: usize = 8;

/// Bytes of the masses under which relume's own basis is orthonormal.
fn mass_bytes(scheme: Scheme, vertices: usize) -> usize {
    match scheme {
        Scheme::Relume => 4 * vertices,
        Scheme::Paper => 0,
    }
}

/// The forecast for a surface with back sides, without the time to find these.
fn with_sides(
    surface: &Surface,
    settings: &BakeSettings,
    folds: bool,
    run: &RunSettings,
) -> BakeForecast {
    let pieces = Pieces::of(surface, settings);
    let survey = SurveyJob {
        surface,
        level: run.level,
        groups: &pieces.groups,
        rays: settings.rays,
        component_of: &pieces.component_of,
        functions_of_component: &pieces.functions,
    }
    .survey();
    let views = &survey.groups;
    let receivers: usize = views.iter().map(|view| view.receivers).sum();
    let escaped = views.iter().map(|view| view.escaped).sum::<f64>();
    let escaped_share = escaped / receivers.max(1) as f64;
    let past = views.iter().filter(|view| view.most_senders > 0.0);
    let escaped_past = past.map(|view| view.escaped).sum::<f64>() / receivers.max(1) as f64;
    let has_sky = sky::is_open(escaped_past);

    let vertices = surface.vertices.len();
    let (groups, functions) = (pieces.group_count(), pieces.functions.iter().sum());
    let entries = surface_entries(views, settings);
    let row_bytes = match settings.scheme {
        Scheme::Relume => {
            let parts: usize = pieces.parts.iter().sum();
            entries.low_rank_bytes(groups, vertices, functions, parts)
        }
        Scheme::Paper => paper_bytes(entries.basis, vertices, functions),
    };
    let sky_bytes = if has_sky {
        sky_entries(views).row_bytes(groups, CELL_COUNT, sky::FUNCTIONS as usize)
    } else {
        0
    };
    let glossy_vertices = (0..vertices as u32)
        .filter(|&v| surface.is_glossy(v))
        .count();
    let slice_bytes = glossy_vertices * slices::BYTES_A_VERTEX;
    let shares_lists = settings.scheme == Scheme::Relume;
    let shared_tables = usize::from(shares_lists) + usize::from(has_sky);
    let bytes = FILE_FRAME_BYTES
        + surface.vertices.front_count()
        + vertices * (1 + 4)
        + mass_bytes(settings.scheme, vertices)
        + pieces.parts.iter().sum::<usize>() * 8
        + pieces.value_count() * 4
        + row_bytes
        + sky_bytes
        + slice_bytes
        + shared_tables * groups * RECEIVER_BYTES;

    let seconds_a_row = seconds_a_row(surface, settings.rays, run);
    // The pilot groups of the sky are sampled twice. Compressing a row takes a
    // few per cent of the time of sampling it, and is left out.
    let rows = vertices + glossy_vertices + vertices.min(PILOT_GROUPS * GROUP);
    // Who chooses coefficients by |c| alone needs no prior lights.
    let prior_lights = if shares_lists {
        RAYS_OF_PRIOR_LIGHTS
    } else {
        0.0
    };
    let rays_a_vertex = RAYS_OF_OPEN_POINTS + RAYS_OF_BASIS + prior_lights + RAYS_OF_ENERGY;
    let mut forecast = BakeForecast {
        scheme: settings.scheme,
        partitioner: settings.scheme.partitioner(),
        cached: false,
        vertices,
        back_vertices: vertices - surface.vertices.front_count(),
        sides_are_exact: true,
        rays: settings.rays,
        escaped_share,
        has_sky,
        partitions: pieces.parts.iter().sum(),
        functions,
        coefficients_per_vertex: entries.near + entries.basis,
        bytes,
        row_bytes,
        sky_bytes,
        glossy_vertices,
        slice_bytes,
        folded_bytes: 0,
        peak_bytes: peak_bytes(vertices, bytes, BAKING_COPIES),
        seconds: seconds_a_row * rows as f64
            + survey.seconds_a_ray * rays_a_vertex * vertices as f64,
    };
    if folds {
        forecast.add_folding(survey.seconds_a_ray);
    }
    forecast
}

fn surface_entries(views: &[GroupView], settings: &BakeSettings) -> Entries {
    if settings.scheme == Scheme::Paper {
        // The largest of every vertex: nobody leaves anything to others.
        let budget = Budget {
            near: 0,
            basis: settings.coefficients as usize,
        };
        let of_group =
            |view: &GroupView| Entries::of_group(budget, view.most_senders, view.functions as f64);
        return Entries::mean(views.iter().map(of_group));
    }
    let own = low_rank::Budget::of(settings.coefficients);
    let senders = views.iter().map(|view| view.most_senders).collect();
    let budget = Budget {
        near: evened(own.near, senders),
        basis: (own.rank as f64 * components_kept(settings.rays)) as usize,
    };
    let functions = |view: &GroupView| {
        let is_spending = view.most_senders > budget.near as f64;
        if is_spending {
            view.functions as f64
        } else {
            0.0
        }
    };
    let budget = Budget {
        basis: evened(budget.basis, views.iter().map(functions).collect()),
        ..budget
    };
    let of_group =
        |view: &GroupView| Entries::of_group(budget, view.most_senders, view.functions as f64);
    Entries::mean(views.iter().map(of_group))
}

/// What a group may spend when those that see little leave the others the rest:
/// `mean` is that over all groups. `wanted` of each.
fn evened(mean: usize, wanted: Vec<f64>) -> usize {
    let total = (mean * wanted.len()) as f64;
    let (mut low, mut high) = (mean, mean * wanted.len().max(1));
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        let spent: f64 = wanted.iter().map(|w| w.at_most(middle as f64)).sum();
        if spent <= total {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    low
}

fn sky_entries(views: &[GroupView]) -> Entries {
    let budget = Budget::of(sky::COEFFICIENTS);
    let of_group = |view: &GroupView| {
        let sees_only_sky = view.most_senders == 0.0;
        let cells = if sees_only_sky {
            0.0
        } else {
            view.most_cells.at_most(CELL_COUNT as f64)
        };
        Entries::of_group(budget, cells, f64::from(sky::FUNCTIONS))
    };
    Entries::mean(views.iter().map(of_group))
}
