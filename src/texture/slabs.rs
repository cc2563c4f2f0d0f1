//! Means of an image over footprints of many cells.
//!
//! A parallelogram is the intersection of two slabs. How much of a cell a slab
//! covers is, across the slab, a box run over by the cell: a trapezoid. A cell
//! counts by the product of the two, which is exact for upright rectangles and
//! differs at the corners of others. Nothing is sampled, so weights change
//! continuously with the parallelogram.

use glam::Vec2;
use glam::Vec3;

use super::grid::{Grid, Region, Texels, floor};

/// A parallelogram flatter than this share of its longer side is widened to
/// it: a line has no slab.
const THINNEST: f32 = 1.0 / 64.0;
/// Cells whose weights are computed together.
const LANES: usize = 8;

/// One pair of parallel edges.
#[derive(Clone, Copy)]
struct Slab {
    /// How the place between the edges (-0.5..0.5) changes by cell.
    gradient: Vec2,
    /// Where a cell's weight has fallen to 0.
    reach: f32,
    /// Largest weight.
    most: f32,
    /// In a row: how the middle of the covered interval changes by row, and
    /// half its length; unlimited where the slab lies along the row.
    slope: f32,
    half: f32,
}

impl Slab {
    /// `blur` is the width (cells) of the box that a cell stands for.
    fn new(gradient: Vec2, blur: f32, reach_x: f32) -> Self {
        let ramp = blur * gradient.length();
        let reach = 0.5 + 0.5 * ramp;
        let is_limit = gradient.x.abs() * reach_x > 1e-3;
        let (slope, half) = if is_limit {
            (-gradient.y / gradient.x, reach / gradient.x.abs())
        } else {
            (0.0, f32::INFINITY)
        };
        Self {
            gradient,
            reach,
            most: if ramp < 1.0 { ramp } else { 1.0 },
            slope,
            half,
        }
    }

    #[inline]
    fn weight(&self, along: f32) -> f32 {
        let left = self.reach - along.abs();
        let left = if left > 0.0 { left } else { 0.0 };
        if left < self.most { left } else { self.most }
    }
}

/// Mean over the region of an image whose texels are boxes `blur` wide.
pub(super) fn mean<T: Texels>(grid: &Grid<'_, T>, region: &Region, blur: f32) -> Vec3 {
    let [a, b] = widened(region.edges);
    let area = a.perp_dot(b);
    let gradients = [Vec2::new(b.y, -b.x) / area, Vec2::new(-a.y, a.x) / area];
    let reach = [0, 1].map(|i| 0.5 + 0.5 * blur * gradients[i].length());
    let extent = a.abs() * reach[0] + b.abs() * reach[1];
    let slabs = gradients.map(|gradient| Slab::new(gradient, blur, extent.x));
    // Places of cells are those of their centres.
    let middle = region.middle - 0.5;
    let first_row = floor(middle.y - extent.y) + 1;
    let last_row = floor(middle.y + extent.y);
    let mut sum = Vec3::ZERO;
    let mut total = [0.0; LANES];
    for row in first_row..=last_row {
        let y = row as f32 - middle.y;
        let [mut left, mut right] = [-extent.x, extent.x];
        for slab in &slabs {
            let center = slab.slope * y;
            left = left.max(center - slab.half);
            right = right.min(center + slab.half);
        }
        let first = floor(middle.x + left) + 1;
        let last = floor(middle.x + right);
        let start = grid.row_start(row + region.cell[1]);
        let across = slabs.map(|slab| slab.gradient.y * y);
        let mut column = first;
        while column <= last {
            let x = column as f32 - middle.x;
            let mut weights = [0.0; LANES];
            for lane in 0..LANES {
                let x = x + lane as f32;
                let [along_a, along_b] = [0, 1].map(|i| slabs[i].gradient.x * x + across[i]);
                weights[lane] = slabs[0].weight(along_a) * slabs[1].weight(along_b);
                total[lane] += weights[lane];
            }
            let count = LANES.min((last - column + 1) as usize);
            sum += grid.row_sum(start, column + region.cell[0], &weights[..count]);
            column += LANES as i32;
        }
    }
    sum / total.iter().sum::<f32>()
}

fn widened([mut a, mut b]: [Vec2; 2]) -> [Vec2; 2] {
    let longest = a.length_squared().max(b.length_squared());
    if a.perp_dot(b).abs() < THINNEST * longest {
        if a.length_squared() >= b.length_squared() {
            b += a.perp() * THINNEST;
        } else {
            a -= b.perp() * THINNEST;
        }
    }
    [a, b]
}
