//! Means of an image over footprints of few texels.
//!
//! The footprint is cut into equal parts, and each is taken as the upright box
//! with the same second moments along the axes. The mean of the image over a
//! box is exact: a product of a row's and a column's shares.

use glam::Vec2;
use glam::Vec3;

use super::TextureFilter;
use super::grid::{Grid, Region, Sum, Texels, floor};

/// Shares of three texels from the first on.
type Shares = (i32, [f32; 3]);

/// Mean over the region as one box.
#[inline]
pub(super) fn whole_mean<T: Texels>(
    grid: &Grid<'_, T>,
    region: &Region,
    filter: TextureFilter,
) -> Vec3 {
    let mut sum = Sum::default();
    let widths = box_widths(region.edges);
    add_box(&mut sum, grid, region.cell, region.middle, widths, filter);
    sum.colour()
}

/// Mean over the region in `counts` parts along its edges.
pub(super) fn mean<T: Texels>(
    grid: &Grid<'_, T>,
    region: &Region,
    counts: [i32; 2],
    filter: TextureFilter,
) -> Vec3 {
    let [a, b] = [0, 1].map(|i| region.edges[i] / counts[i] as f32);
    let widths = box_widths([a, b]);
    let first = region.middle - (region.edges[0] - a) * 0.5 - (region.edges[1] - b) * 0.5;
    let mut sum = Sum::default();
    for j in 0..counts[1] {
        let row = first + b * j as f32;
        for i in 0..counts[0] {
            let place = row + a * i as f32;
            add_box(&mut sum, grid, region.cell, place, widths, filter);
        }
    }
    sum.mean()
}

/// Sides of the upright box with the second moments of a parallelogram.
#[inline]
fn box_widths([a, b]: [Vec2; 2]) -> Vec2 {
    Vec2::new(
        (a.x * a.x + b.x * b.x).sqrt(),
        (a.y * a.y + b.y * b.y).sqrt(),
    )
}

#[inline]
fn add_box<T: Texels>(
    sum: &mut Sum,
    grid: &Grid<'_, T>,
    cell: [i32; 2],
    place: Vec2,
    widths: Vec2,
    filter: TextureFilter,
) {
    let [(column, column_shares), (row, row_shares)] = match filter {
        TextureFilter::Bilinear => [0, 1].map(|axis| bilinear_shares(place[axis], widths[axis])),
        TextureFilter::Nearest => [0, 1].map(|axis| nearest_shares(place[axis], widths[axis])),
    };
    let [column, row] = [column + cell[0], row + cell[1]];
    let [left, middle, right] = column_shares;
    for (i, share) in row_shares.into_iter().enumerate() {
        if i == 2 && share == 0.0 {
            return;
        }
        let at = [column, row + i as i32];
        // The last texel of three is rarely reached.
        if right == 0.0 {
            grid.add_row(sum, at, [left * share, middle * share]);
        } else {
            grid.add_row(sum, at, [left * share, middle * share, right * share]);
        }
    }
}

/// Shares in the mean of the linear interpolation over `width` about `place`
/// (texels; at most one wide).
#[inline]
fn bilinear_shares(place: f32, width: f32) -> Shares {
    // Counted from the centre of texel 0.
    let from_center = place - 0.5;
    let start = floor(from_center - 0.5 * width);
    let middle = from_center - start as f32;
    let beyond = middle + 0.5 * width - 1.0;
    if beyond <= 0.0 || width == 0.0 {
        return (start, [1.0 - middle, middle, 0.0]);
    }
    // The box reaches over the middle texel's centre: `before` lies left of it.
    let before = width - beyond;
    let half = 0.5 / width;
    let [left, right] = [before * before * half, beyond * beyond * half];
    (start, [left, 1.0 - left - right, right])
}

/// Shares in the mean of uniform texels over `width` about `place` (texels; at
/// most one wide).
#[inline]
fn nearest_shares(place: f32, width: f32) -> Shares {
    let start = floor(place - 0.5 * width);
    let beyond = place + 0.5 * width - (start as f32 + 1.0);
    let next = if beyond > 0.0 { beyond / width } else { 0.0 };
    (start, [1.0 - next, next, 0.0])
}
