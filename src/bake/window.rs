//! The sky through small windows: more rays for vertices that see little of it,
//! aimed at the cells of the sky that were found open.
//!
//! The estimate stays without bias. The first halves of the rays of a group of
//! rows say which cells (and those around them) are open to it; those are sampled
//! afresh, cell by cell. What the second half of a row's rays finds in all other
//! cells counts as it is. Rays of a first batch say how many each cell gets in a
//! second one, and then count no longer; only where the first batch will do does
//! the choice depend on what is kept, which two rooms show as less than 0.2 %.
//!
//! A row's own first half is too few: of 512 rays none finds a window of 0.3 %
//! in a fifth of the rows, and the mean noise of all was 40 %.

use super::transfer::Sampling;
use crate::maths::cube_cells::{CELL_COUNT, direction_in_cell, neighbours};
use crate::maths::hash::hash3;
use crate::maths::order::Order;
use crate::maths::sampling::mirrored_cosine_density;
use crate::maths::sobol::ScrambledSobol;

/// Share of escaping rays up to which a row's rays do not find the sky well by
/// themselves: at 30 % of 1024 rays the sky is known to 1 %.
const SMALL_SHARE: f64 = 0.3;
/// Share below which the sky gives no light worth a second batch, such as that
/// of a crack; half of one in a thousand, so that a first batch seldom takes
/// that for less.
const TINY_SHARE: f64 = 5e-4;
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

/// Whether a row's own rays tell too little of the sky, `share` of which escape.
pub(super) fn needs_aim(sampling: &Sampling, escapes: &[Escape], share: f64) -> bool {
    share <= SMALL_SHARE && relative_error(sampling.rays, escapes) > GOOD_ENOUGH
}

/// Standard error of the number of escapes, relative, by the spread between
/// blocks of a row's rays. A block of a low-discrepancy set is spread out itself,
/// so this is less than chance would make it and still not too little. Infinite
/// without an escape.
fn relative_error(rays: u32, escapes: &[Escape]) -> f64 {
    if escapes.is_empty() {
        return f64::INFINITY;
    }
    let mut counts = [0.0_f64; BLOCKS as usize];
    for &(index, _) in escapes {
        counts[(u64::from(index) * u64::from(BLOCKS) / u64::from(rays)) as usize] += 1.0;
    }
    let mean = counts.iter().sum::<f64>() / f64::from(BLOCKS);
    let squares: f64 = counts.iter().map(|c| (c - mean) * (c - mean)).sum();
    let variance_of_mean = squares / f64::from(BLOCKS * (BLOCKS - 1));
    variance_of_mean.sqrt() / mean
}

/// Shares of a vertex's rays that escape into each cell (cell, share), better
/// than its row's own rays tell, by rays aimed at `cells` ([`open_cells`] of its
/// group). Shares count all rays, those too that met the inside of a body.
pub(super) fn aimed_shares(
    sampling: &Sampling,
    vertex: u32,
    escapes: &[Escape],
    cells: &[u16],
) -> Vec<(u32, f32)> {
    let half = sampling.rays / 2;
    let even = (sampling.rays as usize).div_ceil(cells.len().max(1)) as u32;
    let first = Batch::trace(sampling, vertex, cells, SEEDS[0], |_| even);
    let batch = match first.wanted_rays() {
        None => first,
        Some(wanted) => {
            let most = f64::from(sampling.rays) * f64::from(MOST_BATCHES - 2);
            let counts = first.allotted(wanted.at_most(most).at_least(f64::from(sampling.rays)));
            Batch::trace(sampling, vertex, cells, SEEDS[1], |k| counts[k])
        }
    };
    let mut shares: Vec<(u32, f32)> = cells
        .iter()
        .zip(&batch.cells)
        .map(|(&cell, found)| (u32::from(cell), found.mean() as f32))
        .collect();
    let elsewhere = escapes
        .iter()
        .filter(|(index, cell)| *index >= half && cells.binary_search(cell).is_err());
    let weight = 1.0 / (sampling.rays - half) as f32;
    shares.extend(elsewhere.map(|&(_, cell)| (u32::from(cell), weight)));
    shares
}

/// The cells that the first halves of a group's rays found open, with those up
/// to two steps away, ascending; `escapes` by row. (Rows of a coarse group see a
/// window more than a cell apart: in a coarse room with a window of 0.1 to 0.2 %,
/// 26 % of noise with one step and 10 % with two.)
pub(super) fn open_cells(rays: u32, escapes: &[Vec<Escape>]) -> Vec<u16> {
    let mut is_open = [false; CELL_COUNT];
    let all = escapes.iter().flatten();
    for &(_, cell) in all.filter(|(index, _)| *index < rays / 2) {
        for beside in neighbours(usize::from(cell)) {
            is_open[beside] = true;
            // The cell itself is among these.
            for other in neighbours(beside) {
                is_open[other] = true;
            }
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
            .at_least(0.0)
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
    /// sum down to [`GOOD_ENOUGH`]; `None` if these were enough, or what they
    /// found is too little to go on.
    fn wanted_rays(&self) -> Option<f64> {
        let total: f64 = self.cells.iter().map(Found::mean).sum();
        let variance: f64 = self
            .cells
            .iter()
            .map(|c| c.deviation() * c.deviation() / f64::from(c.count.max(1)))
            .sum();
        let goal = GOOD_ENOUGH * total;
        if total < TINY_SHARE || variance <= goal * goal {
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
    let density = mirrored_cosine_density(from.normal, from.flat_normal, direction);
    if density <= 0.0 {
        return 0.0;
    }
    match surface.arrival(sampling.level, &from, direction) {
        None => f64::from(density) * f64::from(solid_angle),
        Some(_) => 0.0,
    }
}
