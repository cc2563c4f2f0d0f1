//! Light from the sky: one more partition, whose senders are the cells of the
//! sky (decision 14 of the design).
//!
//! X_im, the share of the rays of vertex i that escape into cell m, is
//! compressed like a row of the transfer: a near field of whole cells, smooth
//! functions over the cube of cells for the rest, and the response to a constant
//! sky kept. E_i = sum_m X_im H_m is direct light. Where nothing is in the way,
//! such as on the outside of a room's walls, no row is kept: the light follows
//! from the normal.

use super::basis::Basis;
use super::excitation::Excitation;
use super::graph::VertexGraph;
use super::partition::Partition;
use super::rows::Rows;
use super::transfer::{GROUP, GroupTransfer};
use crate::maths::cube_cells::{CELL_COUNT, direction_in_cell, neighbours};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::maths::sampling::sphere_direction;
use crate::simd::Level;

/// Functions over the 384 cells.
pub(super) const FUNCTIONS: u32 = 64;
/// Entries a vertex in the mean, whole cells included.
pub(super) const COEFFICIENTS: u32 = 48;
/// A scene is open if this share of all rays escapes: through cracks and
/// T-junctions of a closed one it is at most 1e-4 (the hard cases of geometry).
pub(crate) const OPEN_SHARE: f64 = 1e-4;
/// Prior skies: lobes of these powers of the cosine about so many directions
/// each. Wide lobes are bright halves of the sky, narrow ones clouds and the
/// glow about a sun (the sun itself is a light with shadow rays).
const LOBE_POWERS: [u32; 3] = [1, 6, 30];
const LOBES: u32 = 32;
/// Seed of the lobes' directions.
const SEED: u32 = 0x5b7;

/// Rows whose senders are the cells of the sky.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sky {
    basis: Basis,
    rows: Rows,
}

/// Whether so much of all rays escapes, from groups that see something else
/// too, that the sky is worth its rows.
pub(super) fn is_open(escaped_share: f64) -> bool {
    escaped_share > OPEN_SHARE
}

impl Sky {
    pub(super) fn new(basis: Basis, rows: Rows) -> Self {
        Self { basis, rows }
    }

    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Irradiance in slots, W/m2, from H_m of the cells.
    pub(super) fn apply(&self, level: Level, cells: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let functions = self.basis.project_rgb(level, cells);
        super::apply_rows(level, &self.rows, cells, &functions)
    }
}

/// The smooth functions over the cells: the lowest eigenvectors of the graph in
/// which cells that share an edge are neighbours.
pub(super) fn basis() -> Basis {
    let edges: Vec<(u32, u32, u32)> = (0..CELL_COUNT)
        .flat_map(|cell| neighbours(cell).map(|other| (cell as u32, other as u32, 1)))
        .collect();
    let graph = VertexGraph::from_edges(CELL_COUNT as u32, &edges)
        .expect("cells have other cells as neighbours");
    let whole = Partition::from_part_of(&[0; CELL_COUNT]);
    Basis::build(&graph, &whole, &[FUNCTIONS], &|| (), &|| false)
        .expect("the cells of the sky are always the same, and have a basis")
}

/// How strongly skies in general excite each function.
pub(super) fn sigma(basis: &Basis, level: Level) -> Vec<f32> {
    let mut excitation = Excitation::new(basis);
    let middle = |cell| direction_in_cell(cell, [0.5, 0.5]).0;
    for lobe in 0..LOBES {
        let axis = sphere_direction([uniform(SEED, lobe, 0), uniform(SEED, lobe, 1)]);
        for power in LOBE_POWERS {
            let brightness = |cell| {
                let cosine = middle(cell).dot(axis).at_least(0.0);
                (0..power).fold(1.0_f32, |product, _| product * cosine)
            };
            excitation.add(basis, level, &of_rms_1((0..CELL_COUNT).map(brightness)));
        }
    }
    excitation.add(basis, level, &[1.0; CELL_COUNT]);
    excitation.sigma(LOBES as usize * LOBE_POWERS.len() + 1)
}

fn of_rms_1(values: impl Iterator<Item = f32> + Clone) -> Vec<f32> {
    let squares: f64 = values.clone().map(|v| f64::from(v) * f64::from(v)).sum();
    let rms = (squares / CELL_COUNT as f64).sqrt();
    values.map(|v| (f64::from(v) / rms) as f32).collect()
}

/// The escapes of a group as a transfer whose senders are cells; of a group
/// that sees nothing but the sky, none: there is nothing to know.
pub(super) fn transfer_of(group: &GroupTransfer) -> GroupTransfer {
    if group.sees_only_sky() {
        return GroupTransfer::default();
    }
    let mut arrived = [0.0; GROUP];
    for (_, shares) in &group.sky {
        for lane in 0..GROUP {
            arrived[lane] += f64::from(shares[lane]);
        }
    }
    GroupTransfer {
        entries: group.sky.clone(),
        arrived,
        ..GroupTransfer::default()
    }
}
