//! Means of an image over footprints of many cells.
//!
//! A parallelogram is the intersection of two slabs. How much of a cell a slab
//! covers is, across the slab, a box run over by the cell: a trapezoid. A cell
//! counts by the product of the two, which is exact for upright rectangles and
//! differs at the corners of others. Nothing is sampled, so weights change
//! continuously with the parallelogram.

use glam::Vec2;
use glam::Vec3;

use super::grid::{Grid, Region, Sum, Texels, floor};
use crate::maths::order::Order;

/// A parallelogram flatter than this share of its longer side is widened to
/// it: a line has no slab. Less than a cell, since a side has at most 48.
const THINNEST: f32 = 1.0 / 64.0;
/// Cells whose weights are computed together; 8 take a fifth longer.
const LANES: usize = 4;

/// One pair of parallel edges.
#[derive(Clone, Copy)]
struct Slab {
    /// How the place between the edges (-0.5..0.5) changes by cell.
    gradient: Vec2,
    /// Where a cell's weight has fallen to 0.
    reach: f32,
    /// Largest weight.
    most: f32,
}

/// The interval of each row that a slab covers.
#[derive(Clone, Copy)]
struct Lines {
    /// How its middle changes by row.
    slope: f32,
    /// Half its length.
    half: f32,
}

impl Lines {
    #[inline]
    fn interval(&self, y: f32) -> [f32; 2] {
        let middle = self.slope * y;
        [middle - self.half, middle + self.half]
    }
}

impl Slab {
    /// `blur` is the width (cells) of the box that a cell stands for.
    #[inline]
    fn new(gradient: Vec2, blur: f32) -> Self {
        let ramp = blur * gradient.length();
        Self {
            gradient,
            reach: 0.5 + 0.5 * ramp,
            most: lesser(ramp, 1.0),
        }
    }

    /// The intervals of rows that reach `extent_x` to both sides; a slab that
    /// lies along the rows does not limit them.
    #[inline]
    fn lines(&self, extent_x: f32) -> Lines {
        if self.gradient.x.abs() * extent_x < 1e-3 {
            return Lines {
                slope: 0.0,
                half: extent_x,
            };
        }
        let per_column = 1.0 / self.gradient.x;
        Lines {
            slope: -self.gradient.y * per_column,
            half: self.reach * per_column.abs(),
        }
    }

    #[inline]
    fn weight(&self, along: f32) -> f32 {
        lesser(greater(self.reach - along.abs(), 0.0), self.most)
    }
}

/// Mean over the region of an image whose texels are boxes `blur` wide.
pub(super) fn mean<T: Texels>(grid: &Grid<'_, T>, region: &Region, blur: f32) -> Vec3 {
    // Lines of cells run along the longer extent: there are fewer of them.
    let extent = region.edges[0].abs() + region.edges[1].abs();
    if extent.y > extent.x {
        mean_by_rows(&grid.turned(), &region.turned(), blur)
    } else {
        mean_by_rows(grid, region, blur)
    }
}

fn mean_by_rows<T: Texels>(grid: &Grid<'_, T>, region: &Region, blur: f32) -> Vec3 {
    let [a, b] = widened(region.edges);
    let per_area = 1.0 / a.perp_dot(b);
    let slab_a = Slab::new(Vec2::new(b.y, -b.x) * per_area, blur);
    let slab_b = Slab::new(Vec2::new(-a.y, a.x) * per_area, blur);
    let extent = a.abs() * slab_a.reach + b.abs() * slab_b.reach;
    let lines = [slab_a.lines(extent.x), slab_b.lines(extent.x)];
    // Places of cells are those of their centres.
    let middle = region.middle - 0.5;
    let mut sum = Sum::default();
    for row in floor(middle.y - extent.y) + 1..=floor(middle.y + extent.y) {
        let y = row as f32 - middle.y;
        let [left_a, right_a] = lines[0].interval(y);
        let [left_b, right_b] = lines[1].interval(y);
        let left = greater(greater(left_a, left_b), -extent.x);
        let right = lesser(lesser(right_a, right_b), extent.x);
        let last = floor(middle.x + right);
        let mut first = floor(middle.x + left) + 1;
        let across_a = slab_a.gradient.y * y;
        let across_b = slab_b.gradient.y * y;
        while first <= last {
            let x = first as f32 - middle.x;
            let mut weights = [0.0; LANES];
            for lane in 0..LANES {
                let x = x + lane as f32;
                weights[lane] = slab_a.weight(slab_a.gradient.x * x + across_a)
                    * slab_b.weight(slab_b.gradient.x * x + across_b);
            }
            let at = [first + region.cell[0], row + region.cell[1]];
            grid.add_row(&mut sum, at, weights);
            first += LANES as i32;
        }
    }
    sum.mean()
}

/// The standard methods also look for NaN.
#[inline]
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

fn widened([mut a, mut b]: [Vec2; 2]) -> [Vec2; 2] {
    let longest = a.length_squared().at_least(b.length_squared());
    if a.perp_dot(b).abs() < THINNEST * longest {
        if a.length_squared() >= b.length_squared() {
            b += a.perp() * THINNEST;
        } else {
            a -= b.perp() * THINNEST;
        }
    }
    [a, b]
}
