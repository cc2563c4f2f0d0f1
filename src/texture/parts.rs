//! Means of an image over footprints of few texels.
//!
//! The footprint is cut into equal parts, and each is taken as the upright box
//! with the same second moments along the axes. The mean of the image over a
//! box is exact: a product of a row's and a column's shares.

use glam::Vec2;
use glam::Vec3;

use super::TextureFilter;
use super::grid::{Grid, Region, Texels, floor};

/// Shares of three texels from the first on.
type Shares = (i32, [f32; 3]);

/// Mean over the region in `counts` parts along its edges.
pub(super) fn mean<T: Texels>(
    grid: &Grid<'_, T>,
    region: &Region,
    counts: [i32; 2],
    filter: TextureFilter,
) -> Vec3 {
    match filter {
        TextureFilter::Bilinear => mean_by(grid, region, counts, bilinear_shares),
        TextureFilter::Nearest => mean_by(grid, region, counts, nearest_shares),
    }
}

#[inline]
fn mean_by<T: Texels>(
    grid: &Grid<'_, T>,
    region: &Region,
    counts: [i32; 2],
    shares: impl Fn(f32, f32) -> Shares,
) -> Vec3 {
    let [a, b] = [0, 1].map(|i| region.edges[i] / counts[i] as f32);
    let widths = Vec2::new(
        (a.x * a.x + b.x * b.x).sqrt(),
        (a.y * a.y + b.y * b.y).sqrt(),
    );
    let first = region.middle - (region.edges[0] - a) * 0.5 - (region.edges[1] - b) * 0.5;
    let mut mean = Vec3::ZERO;
    for j in 0..counts[1] {
        let row = first + b * j as f32;
        for i in 0..counts[0] {
            let place = row + a * i as f32;
            mean += box_mean(
                grid,
                region.cell,
                shares(place.x, widths.x),
                shares(place.y, widths.y),
            );
        }
    }
    mean / (counts[0] * counts[1]) as f32
}

#[inline]
fn box_mean<T: Texels>(
    grid: &Grid<'_, T>,
    cell: [i32; 2],
    (column, column_shares): Shares,
    (row, row_shares): Shares,
) -> Vec3 {
    // The last texel of three is rarely reached.
    let width = if column_shares[2] != 0.0 { 3 } else { 2 };
    let height = if row_shares[2] != 0.0 { 3 } else { 2 };
    let [column, row] = [column + cell[0], row + cell[1]];
    let mut mean = Vec3::ZERO;
    for i in 0..height {
        let start = grid.row_start(row + i as i32);
        mean += grid.row_sum(start, column, &column_shares[..width]) * row_shares[i];
    }
    mean
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
    if beyond <= 0.0 || width == 0.0 {
        return (start, [1.0, 0.0, 0.0]);
    }
    let next = beyond / width;
    (start, [1.0 - next, next, 0.0])
}
