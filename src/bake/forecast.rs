//! What a bake will be like, before it is made: counts and bytes by the rules of
//! the bake itself from a survey of its rays, seconds from a short run of its
//! most expensive stage.

mod entries;
mod pieces;

use std::time::Instant;

use super::audit::size_of_audit;
use super::operator::PILOT_GROUPS;
use super::pilot::{SurveyJob, seconds_a_row};
use super::scheme::{Partitioner, Scheme};
use super::sky;
use super::slices::{self, Slices};
use super::transfer::GROUP;
use super::{Bake, BakeError, BakeSettings, RunSettings, low_rank};
use crate::maths::cube_cells::CELL_COUNT;
use crate::surface::Surface;
use entries::{paper_bytes, sky_entries, surface_entries};
use pieces::Pieces;

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
    run.proceed()?;
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
    run.proceed()?;
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
            peak_bytes: peak_bytes(vertices, BYTES_A_VERTEX, file_bytes as f64 * LOADING_COPIES),
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
        self.bytes -= self.folded_bytes;
        self.folded_bytes = (self.vertices as f64 * FOLDED_BYTES_A_VERTEX) as usize;
        self.bytes += self.folded_bytes;
        self.peak_bytes += low_rank::folding_bytes(self.partitions, self.functions);
        let solutions = low_rank::solutions_to_fold(self.functions) as f64;
        self.seconds += seconds_a_ray * RAYS_OF_SOLUTION * solutions * self.vertices as f64;
    }
}

/// Memory of the program itself and of a vertex (its share of the mesh and the
/// ray tree), and copies of the bake's bytes that are in memory where it is read: the file
/// and the bake.
const PROGRAM_BYTES: usize = 10_000_000;
const BYTES_A_VERTEX: usize = 550;
const LOADING_COPIES: f64 = 2.0;
/// A vertex and copies where the bake is made: factors of all partitions and light of all
/// test lights, and at the worst moment rows group by group, joined rows whose lists have
/// grown, and the file. Most resident memory in MB against this, by the defaults on two
/// threads (more of them were not tried): sheet 154/173, cornell 194/218, window 246/250,
/// statues 328/332.
const BAKING_BYTES_A_VERTEX: usize = 2750;
const BAKING_COPIES: f64 = 4.5;

fn peak_bytes(vertices: usize, bytes_a_vertex: usize, copies_of_file: f64) -> usize {
    PROGRAM_BYTES + vertices * bytes_a_vertex + copies_of_file as usize
}

/// Times of stages for each vertex, in rays of the transfer. Measured in
/// cornell, statues and spot_cow: 15, 20 and 30; 109, 113 and 248 (where three
/// of four rays of the transfer escape and are cheap); 36, 28 and 34.
const RAYS_OF_BASIS: f64 = 20.0;
const RAYS_OF_PRIOR_LIGHTS: f64 = 130.0;
const RAYS_OF_ENERGY: f64 = 33.0;
/// Lights that the error is stated by take as long as prior lights: 4.7 s beside 4.5 in
/// cornell.
const RAYS_OF_TEST_LIGHTS: f64 = 135.0;
/// Time of a ray that finds what arrives of all test lights, in rays of the transfer.
const RAYS_OF_TRUE_RAY: f64 = 0.4;
/// The rows of a vertex made low-rank factors, in rays of the transfer: in cornell, sheet
/// and window 630 to 1,500 by 64 to 1,536 rays. Seconds foretold and taken on one machine, a
/// slow one: cornell 27/31 by 64 rays, 72/72 by 1,536, 159/147 by 6,144; window 32/39 by 64,
/// 102/139 by 1,536; sheet 21/21 by 64, 118/99 by 6,144. By 1,000 what is foretold by the
/// defaults would be a fourth too much.
const RAYS_OF_COMPRESSION: f64 = 700.0;
/// Points of a vertex's area times the rays of each that tell whether it is in
/// the open.
const RAYS_OF_OPEN_POINTS: f64 = 32.0;

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
    // The pilot groups of the sky and what the error is stated by are sampled again.
    let (audited, all_true_rays) = size_of_audit(vertices, settings.rays);
    let again = (PILOT_GROUPS * GROUP).min(vertices) + audited;
    let rows = vertices + glossy_vertices + again;
    // Who chooses coefficients by |c| alone needs no prior lights and has no factors.
    let of_scheme = match settings.scheme {
        Scheme::Relume => RAYS_OF_PRIOR_LIGHTS + RAYS_OF_COMPRESSION,
        Scheme::Paper => 0.0,
    };
    let rays_a_vertex =
        RAYS_OF_OPEN_POINTS + RAYS_OF_BASIS + of_scheme + RAYS_OF_ENERGY + RAYS_OF_TEST_LIGHTS;
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
        peak_bytes: peak_bytes(
            vertices,
            BAKING_BYTES_A_VERTEX,
            bytes as f64 * BAKING_COPIES,
        ),
        seconds: seconds_a_row * rows as f64
            + survey.seconds_a_ray * RAYS_OF_TRUE_RAY * all_true_rays as f64
            + survey.seconds_a_ray * rays_a_vertex * vertices as f64,
    };
    if folds {
        forecast.add_folding(survey.seconds_a_ray);
    }
    forecast
}
