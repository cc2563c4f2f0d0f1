//! The sky through small windows: more rays for vertices that see little of it,
//! aimed at the cells of the sky that were found open.
//!
//! The estimate stays without bias. The first halves of a group's rays say which
//! cells (and their neighbours) are open; those are sampled afresh, cell by
//! cell. What the second half finds in all other cells counts as it is. Rays of
//! a first batch say how many each cell gets in a second one, and then count no
//! longer.

use glam::Vec3;

use super::transfer::Sampling;
use crate::maths::cube_cells::{CELL_COUNT, direction_in_cell, neighbours};
use crate::maths::hash::hash3;
use crate::maths::sobol::ScrambledSobol;
use crate::surface::SurfacePoint;

/// Shares of escaping rays of a group between which a row's rays do not find the
/// sky well by themselves: at 30 % of 1024 rays the sky is known to 1 %, and
/// below two of a group's 8192 rays there is nothing to aim at. (With a limit of
/// one ray in a thousand, the far wall of a room with a small window was
/// mottled.)
const SMALL_SHARE: std::ops::RangeInclusive<f64> = 0.0002..=0.3;
/// Standard error under a constant sky that is good enough, relative.
const GOOD_ENOUGH: f64 = 0.03;
/// Most rays, times those of a row, pilot rays and first batch included.
const MOST_BATCHES: u32 = 16;
/// Blocks of a row's rays whose counts are compared.
const BLOCKS: u32 = 16;
/// Share of the second batch that is spread evenly, so that a cell in which the
/// first batch found nothing by chance is looked into again.
const EVEN_SHARE: f64 = 0.3;
/// A scrambled set has so many points.
const POINTS_PER_SET: u32 = 1 << 16;
/// Seeds of the aimed rays of the first and of the second batch.
const SEEDS: [u32; 2] = [0x5c11, 0x5c12];

/// A ray of a row that escaped: its number and its cell.
pub(super) type Escape = (u32, u16);

/// Whether a row's own rays tell too little of the sky.
pub(super) fn needs_aim(rays: u32, escapes: &[Escape]) -> bool {
    escapes.is_empty() || relative_error(rays, escapes) > GOOD_ENOUGH
}

/// Standard error of the number of escapes, relative, by the spread between
/// blocks of a row's rays. A block of a low-discrepancy set is spread out itself,
/// so this is less than chance would make it and still not too little.
fn relative_error(rays: u32, escapes: &[Escape]) -> f64 {
    let mut counts = [0.0_f64; BLOCKS as usize];
    for &(index, _) in escapes {
        counts[(u64::from(index) * u64::from(BLOCKS) / u64::from(rays)) as usize] += 1.0;
    }
    let mean = counts.iter().sum::<f64>() / f64::from(BLOCKS);
    let squares: f64 = counts.iter().map(|c| (c - mean) * (c - mean)).sum();
    let variance_of_mean = squares / f64::from(BLOCKS * (BLOCKS - 1));
    variance_of_mean.sqrt() / mean
}

/// The cells of the sky in which a group of neighbours should look, ascending.
pub(super) struct Window {
    cells: Vec<u16>,
    /// Rays of a row whose escapes chose the cells.
    half: u32,
}

impl Window {
    /// The window of a group from the escapes of its rows; `in_the_open` of all
    /// rays count. `None` where the group sees so much of the sky, or so little,
    /// that its own rays will do.
    pub(super) fn of(rays: u32, escapes: &[Vec<Escape>], in_the_open: u32) -> Option<Self> {
        let escaped: usize = escapes.iter().map(Vec::len).sum();
        let share = escaped as f64 / f64::from(in_the_open.max(1));
        let half = rays / 2;
        SMALL_SHARE.contains(&share).then(|| Self {
            cells: open_cells(escapes, half),
            half,
        })
    }

    /// Shares of a vertex's rays that escape into each cell (cell, share),
    /// better than its row's own rays tell. Shares count all rays, those too
    /// that met the inside of a body.
    pub(super) fn aimed_shares(
        &self,
        sampling: &Sampling,
        vertex: u32,
        escapes: &[Escape],
    ) -> Vec<(u32, f32)> {
        let cells = &self.cells;
        let even = (sampling.rays as usize).div_ceil(cells.len().max(1)) as u32;
        let first = Batch::trace(sampling, vertex, cells, SEEDS[0], |_| even);
        let batch = match first.wanted_rays() {
            None => first,
            Some(wanted) => {
                let most = f64::from(sampling.rays) * f64::from(MOST_BATCHES - 2);
                let counts = first.allotted(wanted.min(most).max(f64::from(sampling.rays)));
                Batch::trace(sampling, vertex, cells, SEEDS[1], |k| counts[k])
            }
        };
        let found = cells.iter().zip(&batch.cells);
        let mut shares: Vec<(u32, f32)> = found
            .map(|(&cell, found)| (u32::from(cell), found.mean() as f32))
            .collect();
        let elsewhere = escapes
            .iter()
            .filter(|(index, cell)| *index >= self.half && cells.binary_search(cell).is_err());
        let weight = 1.0 / (sampling.rays - self.half) as f32;
        shares.extend(elsewhere.map(|&(_, cell)| (u32::from(cell), weight)));
        shares
    }
}

/// The cells that the first rays found open, with their neighbours, ascending.
fn open_cells(escapes: &[Vec<Escape>], half: u32) -> Vec<u16> {
    let mut is_open = [false; CELL_COUNT];
    for &(_, cell) in escapes.iter().flatten().filter(|(index, _)| *index < half) {
        is_open[usize::from(cell)] = true;
        for other in neighbours(usize::from(cell)) {
            is_open[other] = true;
        }
    }
    (0..CELL_COUNT as u16)
        .filter(|&cell| is_open[usize::from(cell)])
        .collect()
}

/// What aimed rays found in one cell.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    count: u32,
    sum: f64,
    squares: f64,
}

impl Found {
    fn mean(&self) -> f64 {
        self.sum / f64::from(self.count.max(1))
    }

    /// Standard deviation of one ray's share.
    fn deviation(&self) -> f64 {
        let mean = self.mean();
        (self.squares / f64::from(self.count.max(1)) - mean * mean)
            .max(0.0)
            .sqrt()
    }
}

/// One round of aimed rays.
struct Batch {
    cells: Vec<Found>,
}

impl Batch {
    fn trace(
        sampling: &Sampling,
        vertex: u32,
        cells: &[u16],
        seed: u32,
        rays_of: impl Fn(usize) -> u32,
    ) -> Self {
        let trace_cell = |(k, &cell): (usize, &u16)| {
            let points = ScrambledSobol::new(hash3(seed, vertex, u32::from(cell)), vertex);
            let mut found = Found::default();
            for index in 0..rays_of(k).min(POINTS_PER_SET) {
                let u = points.point(index);
                let share = aimed_share(sampling, vertex, cell, u);
                found.count += 1;
                found.sum += share;
                found.squares += share * share;
            }
            found
        };
        Self {
            cells: cells.iter().enumerate().map(trace_cell).collect(),
        }
    }

    /// Rays, spread by deviation, that would bring the standard error of the
    /// sum down to [`GOOD_ENOUGH`]; `None` if these were enough.
    fn wanted_rays(&self) -> Option<f64> {
        let total: f64 = self.cells.iter().map(Found::mean).sum();
        let variance: f64 = self
            .cells
            .iter()
            .map(|c| c.deviation() * c.deviation() / f64::from(c.count.max(1)))
            .sum();
        let goal = GOOD_ENOUGH * total;
        if total == 0.0 || variance <= goal * goal {
            return None;
        }
        let deviations: f64 = self.cells.iter().map(Found::deviation).sum();
        Some(deviations * deviations / (goal * goal))
    }

    /// `total` rays spread over the cells by deviation.
    fn allotted(&self, total: f64) -> Vec<u32> {
        let deviations: f64 = self.cells.iter().map(Found::deviation).sum();
        let even = EVEN_SHARE / self.cells.len() as f64;
        self.cells
            .iter()
            .map(|c| {
                let share = even + (1.0 - EVEN_SHARE) * c.deviation() / deviations;
                (total * share).ceil() as u32
            })
            .collect()
    }
}

/// Share of a vertex's rays that one aimed ray stands for: its density among
/// the row's directions over its own, zero if something is in the way.
fn aimed_share(sampling: &Sampling, vertex: u32, cell: u16, u: [f32; 4]) -> f64 {
    let surface = sampling.surface;
    let from = surface.sample_point(vertex as usize, [u[0], u[1]]);
    let (direction, solid_angle) = direction_in_cell(usize::from(cell), [u[2], u[3]]);
    let density = row_density(&from, direction);
    if density <= 0.0 {
        return 0.0;
    }
    match surface.arrival(sampling.level, &from, direction) {
        None => f64::from(density) * f64::from(solid_angle),
        Some(_) => 0.0,
    }
}

/// Density (1/sr) of the row's directions, cosine-weighted about the shading
/// normal and mirrored above the flat triangle.
fn row_density(from: &SurfacePoint, direction: Vec3) -> f32 {
    let height = direction.dot(from.flat_normal);
    if height <= 0.0 {
        return 0.0;
    }
    let mirrored = direction - from.flat_normal * (2.0 * height);
    let cosine = |d: Vec3| {
        let c = d.dot(from.normal);
        if c > 0.0 { c } else { 0.0 }
    };
    (cosine(direction) + cosine(mirrored)) * std::f32::consts::FRAC_1_PI
}
