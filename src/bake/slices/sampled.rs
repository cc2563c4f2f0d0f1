//! The rays of a vertex, sorted by where they arrive, with 16 weights each.

use crate::bake::transfer::row_rays;
use crate::maths::cube_cells::{CELL_COUNT, cell_of};
use crate::maths::sobol::ScrambledSobol;
use crate::maths::spherical_harmonics::{Coefficients, HARMONICS, harmonics};
use crate::simd::Level;
use crate::surface::Surface;

/// Seed of the points whose normals are averaged.
const SEED: u32 = 0x511c;

/// T^k_ij and X^k_im of one vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SliceTransfer {
    /// (sender, its weight by slice), ascending by sender; senders are slots.
    pub(super) entries: Vec<(u32, Coefficients)>,
    /// (cell of the sky, its weight by slice), ascending by cell.
    pub(super) sky: Vec<(u32, Coefficients)>,
    /// What arrives of light that is 1 everywhere, whatever is in the way.
    of_light_everywhere: [f64; HARMONICS],
}

impl SliceTransfer {
    /// What arrives of light that is 1 on all surfaces, and of a sky that is: as
    /// sampled, but that their sum is known. The noise of the sum is divided as the
    /// rays were.
    pub(super) fn of_constant_light(&self) -> [[f64; HARMONICS]; 2] {
        let mut sums = [[0.0; HARMONICS]; 2];
        for (sums, entries) in sums.iter_mut().zip([&self.entries, &self.sky]) {
            for (_, weights) in entries {
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    *sum += f64::from(*weight);
                }
            }
        }
        let all = sums[0][0] + sums[1][0];
        if all <= 0.0 {
            // Wholly inside a body: nothing arrives.
            return sums;
        }
        let arrived = sums[0][0] / all;
        for k in 0..HARMONICS {
            let noise = self.of_light_everywhere[k] - sums[0][k] - sums[1][k];
            sums[0][k] += noise * arrived;
            sums[1][k] += noise * (1.0 - arrived);
        }
        sums
    }
}

/// One worker's memory.
pub(super) struct Scratch {
    senders: Dense,
    cells: Dense,
}

impl Scratch {
    pub(super) fn new(slot_count: usize) -> Self {
        Self {
            senders: Dense::new(slot_count),
            cells: Dense::new(CELL_COUNT),
        }
    }
}

/// Dense rows that remember where they are not empty.
struct Dense {
    values: Vec<Coefficients>,
    is_touched: Vec<bool>,
    touched: Vec<u32>,
}

impl Dense {
    fn new(length: usize) -> Self {
        Self {
            values: vec![[0.0; HARMONICS]; length],
            is_touched: vec![false; length],
            touched: Vec::new(),
        }
    }

    fn add(&mut self, index: u32, weight: f32, harmonics: &Coefficients) {
        let place = index as usize;
        if !std::mem::replace(&mut self.is_touched[place], true) {
            self.touched.push(index);
        }
        for (slot, h) in self.values[place].iter_mut().zip(harmonics) {
            *slot += weight * h;
        }
    }

    /// Takes the entries out, scaled, ascending, and leaves all empty.
    fn drain(&mut self, scale: f32) -> Vec<(u32, Coefficients)> {
        self.touched.sort_unstable();
        let (values, is_touched) = (&mut self.values, &mut self.is_touched);
        self.touched
            .drain(..)
            .map(|index| {
                is_touched[index as usize] = false;
                let values = std::mem::take(&mut values[index as usize]);
                (index, values.map(|value| value * scale))
            })
            .collect()
    }
}

/// Which vertex, by how many rays.
#[derive(Clone, Copy)]
pub(super) struct Sampling<'a> {
    pub(super) surface: &'a Surface,
    pub(super) level: Level,
    pub(super) slot_of_vertex: &'a [u32],
    pub(super) rays: u32,
}

/// Samples the slices of a vertex. Rays that arrive inside of a body do not count,
/// as in T.
pub(super) fn sample(sampling: &Sampling, vertex: u32, scratch: &mut Scratch) -> SliceTransfer {
    let surface = sampling.surface;
    let mut inside = 0;
    for (_, (direction, hit)) in row_rays(surface, sampling.level, vertex, sampling.rays) {
        let h = harmonics(direction);
        let Some(hit) = hit else {
            scratch.cells.add(cell_of(direction) as u32, 1.0, &h);
            continue;
        };
        let Some(met) = surface.vertices.met(&hit) else {
            inside += 1;
            continue;
        };
        for (sender, weight) in met {
            let slot = sampling.slot_of_vertex[sender as usize];
            scratch.senders.add(slot, weight, &h);
        }
    }
    let scale = 1.0 / (sampling.rays - inside).max(1) as f32;
    SliceTransfer {
        entries: scratch.senders.drain(scale),
        sky: scratch.cells.drain(scale),
        of_light_everywhere: of_light_everywhere(surface, vertex),
    }
}

/// Int h_k(w) (n.w)+ dw / pi = a_l h_k(n) with a = 1, 2/3, 1/4, 0 (Ramamoorthi and
/// Hanrahan, "An Efficient Representation for Irradiance Environment Maps", 2001),
/// averaged over the normals of a vertex's area: without the noise of rays, whatever
/// is in the way.
fn of_light_everywhere(surface: &Surface, vertex: u32) -> [f64; HARMONICS] {
    const POINTS: u32 = 32;
    let points = ScrambledSobol::new(SEED, vertex);
    let mut sums = [0.0; HARMONICS];
    for index in 0..POINTS {
        let point = surface.sample_point(vertex as usize, points.point2(index));
        for (k, h) in harmonics(point.normal).into_iter().enumerate() {
            let share = match k {
                0 => 1.0,
                1..4 => 2.0 / 3.0,
                4..9 => 0.25,
                _ => 0.0,
            };
            sums[k] += share * f64::from(h) / f64::from(POINTS);
        }
    }
    sums
}
