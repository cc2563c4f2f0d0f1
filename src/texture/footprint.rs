//! Means of an image over a parallelogram.
//!
//! The image is read at the level whose cells are small against the
//! parallelogram, and each cell counts by the area that is covered
//! ([`coverage`](super::coverage)): but for the cells along the border, which
//! are taken as uniform, the mean is exact. A magnified bilinear image is piecewise
//! bilinear, so cells that are whole fractions of a texel have their middle's
//! value as mean, and the same sum serves. Near the end of an octave two levels
//! are blended, so the mean is continuous in place, shape and size.

use glam::Vec2;
use glam::Vec3;

use super::coverage::{MAX_COLUMNS, corners, visit_rows};

/// Cells that a parallelogram touches at most on average; it touches at least
/// a quarter. 32 doubles the error, 192 the time (see `error_and_time`).
const CELLS: f32 = 96.0;
/// Where in an octave of cell sizes (1..2) blending with the next one begins.
/// A shorter zone turns a change of level into a visible step, a longer one
/// costs time.
const BLEND_FROM: f32 = 1.8;
/// Finest cells are texels / 2^4: what is smaller goes by [`Grid::box_mean`].
const FINEST_OCTAVE: i32 = -4;
/// A magnified footprint below this extent (texels) spans at most three texels
/// along each axis.
const BOX_EXTENT: f32 = 0.75;
/// Largest covariance (texels squared) of the two axes of a footprint that is
/// replaced by an upright box. At most 2 x this, the mixed difference of a
/// checkerboard, is the error.
const BOX_COVARIANCE: f32 = 0.004;

/// Most texels along an axis of a footprint in parts of texels.
const MAX_TEXELS: usize = MAX_COLUMNS / 2 + 4;

/// Texels and what lies beyond them.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a, T> {
    /// Width and height.
    pub(super) size: [usize; 2],
    pub(super) texels: &'a T,
    /// Whether the border goes on instead of a repetition.
    pub(super) clamp: bool,
}

/// Colours by index, row by row.
pub(super) trait Texels {
    fn texel(&self, index: usize) -> Vec3;
}

/// A place and two edges in texture coordinates, rows counted downwards from
/// the top: reduced so that casts to cells do not overflow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    /// 0..1, or near it where the border goes on.
    pub(super) middle: [f64; 2],
    pub(super) along_x: Vec2,
    pub(super) along_y: Vec2,
}

/// The level to read and, if there is to be one, the weight of the next.
pub(super) struct Choice {
    /// log2 of a cell's width over a texel's; below 0 for parts of a texel.
    pub(super) octave: i32,
    /// Share of the next octave.
    pub(super) next_share: f32,
}

impl Footprint {
    /// Edges in cells of an image of `size` cells.
    fn edges(&self, size: [usize; 2]) -> [Vec2; 2] {
        let cells = Vec2::new(size[0] as f32, size[1] as f32);
        [self.along_x * cells, self.along_y * cells]
    }

    /// The octave in which about [`CELLS`] cells are touched: A / s^2 + E / s + 1
    /// for area A, sum of the extents E and cell width s.
    pub(super) fn choice(&self, size: [usize; 2]) -> Choice {
        let [a, b] = self.edges(size);
        let area = a.perp_dot(b).abs();
        let extent = a.abs().element_sum() + b.abs().element_sum();
        let root = (extent * extent + 4.0 * area * (CELLS - 1.0)).sqrt();
        let width = (extent + root) / (2.0 * (CELLS - 1.0));
        if width.is_nan() || width < f32::MIN_POSITIVE {
            return Choice {
                octave: FINEST_OCTAVE,
                next_share: 0.0,
            };
        }
        // The float's own exponent and mantissa.
        let below = (width.to_bits() >> 23) as i32 - 127;
        let within = f32::from_bits(width.to_bits() & 0x7f_ffff | 0x3f80_0000);
        let next_share = ((within - BLEND_FROM) / (2.0 - BLEND_FROM)).max(0.0);
        Choice {
            octave: below + 1,
            next_share,
        }
    }
}

impl<T: Texels> Grid<'_, T> {
    fn wrapped(&self, cell: i32, axis: usize) -> usize {
        let count = self.size[axis] as i32;
        let inside = if self.clamp {
            cell.clamp(0, count - 1)
        } else if cell >= 0 && cell < count {
            cell
        } else {
            cell.rem_euclid(count)
        };
        inside as usize
    }

    /// The texel of a column and row.
    fn at(&self, column: i32, row: i32) -> Vec3 {
        let row = self.wrapped(row, 1);
        self.texels
            .texel(row * self.size[0] + self.wrapped(column, 0))
    }

    fn place(&self, middle: [f64; 2]) -> [f64; 2] {
        [
            middle[0] * self.size[0] as f64,
            middle[1] * self.size[1] as f64,
        ]
    }

    /// The texel that holds a place.
    pub(super) fn nearest(&self, middle: [f64; 2]) -> Vec3 {
        let [x, y] = self.place(middle);
        self.at(x.floor() as i32, y.floor() as i32)
    }

    /// Linear between the four nearest texel centres.
    pub(super) fn bilinear(&self, middle: [f64; 2]) -> Vec3 {
        self.box_mean(middle, Vec2::ZERO)
    }

    /// Mean of the bilinear image over an upright box of at most a texel.
    fn box_mean(&self, middle: [f64; 2], widths: Vec2) -> Vec3 {
        let [x, y] = self.place(middle);
        let (column, column_shares) = box_shares(x, widths.x);
        let (row, row_shares) = box_shares(y, widths.y);
        let columns = [column, column + 1, column + 2].map(|c| self.wrapped(c, 0));
        let mut mean = Vec3::ZERO;
        for (i, row_share) in row_shares.into_iter().enumerate() {
            if row_share == 0.0 {
                continue;
            }
            let start = self.wrapped(row + i as i32, 1) * self.size[0];
            let mut sum = self.texels.texel(start + columns[0]) * column_shares[0]
                + self.texels.texel(start + columns[1]) * column_shares[1];
            if column_shares[2] != 0.0 {
                sum += self.texels.texel(start + columns[2]) * column_shares[2];
            }
            mean += sum * row_share;
        }
        mean
    }

    /// The mean of the bilinear image where the footprint is small enough for
    /// an upright box with its second moments.
    pub(super) fn magnified_mean(&self, footprint: &Footprint) -> Option<Vec3> {
        let [a, b] = footprint.edges(self.size);
        let extent = a.abs() + b.abs();
        let covariance = (a.x * a.y + b.x * b.y) / 12.0;
        let fits = extent.max_element() < BOX_EXTENT && covariance.abs() < BOX_COVARIANCE;
        fits.then(|| {
            let widths = Vec2::new(
                (a.x * a.x + b.x * b.x).sqrt(),
                (a.y * a.y + b.y * b.y).sqrt(),
            );
            self.box_mean(footprint.middle, widths)
        })
    }

    /// The texel that holds the whole footprint.
    pub(super) fn only_texel(&self, footprint: &Footprint) -> Option<Vec3> {
        let [a, b] = footprint.edges(self.size);
        let [x, y] = self.place(footprint.middle);
        let half = (a.abs() + b.abs()) * 0.5;
        let inside = |place: f64, half: f32| {
            let part = (place - place.floor()) as f32;
            part >= half && part + half <= 1.0
        };
        let is_inside = inside(x, half.x) && inside(y, half.y);
        is_inside.then(|| self.at(x.floor() as i32, y.floor() as i32))
    }

    /// The mean over the footprint, every texel taken as uniform.
    pub(super) fn covered_mean(&self, footprint: &Footprint) -> Vec3 {
        let Some(outline) = Outline::new(footprint, self.size) else {
            return self.coarse_mean(footprint);
        };
        let mut sum = Vec3::ZERO;
        let mut area = 0.0;
        visit_rows(outline.corners, |row, column, areas| {
            let start = self.wrapped(row + outline.cell[1], 1) * self.size[0];
            sum += self.row_sum(start, column + outline.cell[0], areas);
            area += areas.iter().sum::<f32>();
        });
        sum / area
    }

    /// Sum of the texels from `column` on of the row that starts at index
    /// `start`, each times its weight.
    fn row_sum(&self, start: usize, column: i32, weights: &[f32]) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let mut x = self.wrapped(column, 0);
        for (i, &weight) in weights.iter().enumerate() {
            sum += self.texels.texel(start + x) * weight;
            x = if self.clamp {
                self.wrapped(column + i as i32 + 1, 0)
            } else if x + 1 == self.size[0] {
                0
            } else {
                x + 1
            };
        }
        sum
    }

    /// The mean of the bilinear image over the footprint, in cells of a part
    /// of a texel: 2^-`octave` of them along each axis.
    pub(super) fn divided_mean(&self, footprint: &Footprint, octave: i32) -> Vec3 {
        let parts = 1_i32 << (-octave).clamp(1, -FINEST_OCTAVE);
        let size = self.size.map(|n| n * parts as usize);
        let Some(outline) = Outline::new(footprint, size) else {
            return self.coarse_mean(footprint);
        };
        let mut texel_rows = TexelRows::new(parts);
        let mut sum = Vec3::ZERO;
        let mut area = 0.0;
        visit_rows(outline.corners, |row, column, areas| {
            let (texel_row, lower_share) = texel_rows.below(row + outline.cell[1]);
            if texel_rows.row != texel_row {
                sum += texel_rows.take(self, texel_row);
            }
            area += texel_rows.add(column + outline.cell[0], areas, lower_share);
        });
        (sum + texel_rows.take(self, 0)) / area
    }

    /// The mean of 8 x 8 texels spread over a footprint too large for cells:
    /// many repetitions of an image, or far beyond its border.
    fn coarse_mean(&self, footprint: &Footprint) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for i in 0..64 {
            let [a, b] = [i % 8, i / 8].map(|k| (k as f32 - 3.5) / 8.0);
            let step = footprint.along_x * a + footprint.along_y * b;
            let place = [
                footprint.middle[0] + f64::from(step.x),
                footprint.middle[1] + f64::from(step.y),
            ];
            let inside = if self.clamp {
                place.map(|x| x.clamp(0.0, 1.0))
            } else {
                place.map(|x| x - x.floor())
            };
            sum += self.nearest(inside);
        }
        sum / 64.0
    }
}

/// A footprint in cells, counted from the one that holds its middle.
struct Outline {
    corners: [Vec2; 4],
    cell: [i32; 2],
}

impl Outline {
    /// None if it spans too many cells.
    fn new(footprint: &Footprint, size: [usize; 2]) -> Option<Self> {
        let [a, b] = footprint.edges(size);
        let extent = (a.abs() + b.abs()).max_element();
        // A line is widened, which can add a little; NaN is too large as well.
        if extent.is_nan() || extent > 0.9 * MAX_COLUMNS as f32 {
            return None;
        }
        let place = [0, 1].map(|axis| footprint.middle[axis] * size[axis] as f64);
        let cell = place.map(f64::floor);
        let middle = Vec2::new((place[0] - cell[0]) as f32, (place[1] - cell[1]) as f32);
        Some(Self {
            corners: corners(middle, a, b),
            cell: cell.map(|c| c as i32),
        })
    }
}

/// Weights of the texels of two neighbouring rows, gathered from rows of parts.
struct TexelRows {
    /// Parts of a texel along an axis.
    parts: i32,
    /// The upper row.
    row: i32,
    /// First and last column with a weight.
    first: i32,
    last: i32,
    upper: [f32; MAX_TEXELS],
    lower: [f32; MAX_TEXELS],
}

impl TexelRows {
    fn new(parts: i32) -> Self {
        Self {
            parts,
            row: i32::MIN,
            first: 0,
            last: -1,
            upper: [0.0; MAX_TEXELS],
            lower: [0.0; MAX_TEXELS],
        }
    }

    /// The texel whose centre is at or before the middle of a part, and the
    /// share of the next one there.
    fn below(&self, part: i32) -> (i32, f32) {
        let half = self.parts / 2;
        let texel = (part - half).div_euclid(self.parts);
        let within = (part - half).rem_euclid(self.parts) as f32;
        (texel, (within + 0.5) / self.parts as f32)
    }

    /// Adds a row of parts; returns its sum.
    fn add(&mut self, column: i32, areas: &[f32], lower_share: f32) -> f32 {
        let (mut texel, mut right_share) = self.below(column);
        let last = self.below(column + areas.len() as i32 - 1).0 + 1;
        if self.last < self.first {
            self.first = texel;
            self.last = texel - 1;
        }
        self.reach(texel, last);
        let step = 1.0 / self.parts as f32;
        let mut total = 0.0;
        for &area in areas {
            let at = (texel - self.first) as usize;
            let right = area * right_share;
            let left = area - right;
            self.upper[at] += left - left * lower_share;
            self.upper[at + 1] += right - right * lower_share;
            self.lower[at] += left * lower_share;
            self.lower[at + 1] += right * lower_share;
            total += area;
            right_share += step;
            if right_share >= 1.0 {
                right_share -= 1.0;
                texel += 1;
            }
        }
        total
    }

    /// Makes room for the columns `first..=last`.
    fn reach(&mut self, first: i32, last: i32) {
        if first < self.first {
            let by = (self.first - first) as usize;
            let count = (self.last + 1 - self.first) as usize;
            for row in [&mut self.upper, &mut self.lower] {
                row.copy_within(..count, by);
                row[..by].fill(0.0);
            }
            self.first = first;
        }
        if last > self.last {
            let [from, to] = [self.last + 1, last + 1].map(|c| (c - self.first) as usize);
            self.upper[from..to].fill(0.0);
            self.lower[from..to].fill(0.0);
            self.last = last;
        }
    }

    /// The weighted sum of what was gathered; the next rows start at `row`.
    fn take<T: Texels>(&mut self, grid: &Grid<'_, T>, row: i32) -> Vec3 {
        let count = (self.last + 1 - self.first) as usize;
        let mut sum = Vec3::ZERO;
        for (row, weights) in [
            (self.row, &self.upper),
            (self.row.wrapping_add(1), &self.lower),
        ] {
            if count > 0 {
                let start = grid.wrapped(row, 1) * grid.size[0];
                sum += grid.row_sum(start, self.first, &weights[..count]);
            }
        }
        self.row = row;
        self.first = 0;
        self.last = -1;
        sum
    }
}

/// Shares of three texels from the first on in the mean of the linear
/// interpolation over `width` about `place` (texels; at most one wide).
fn box_shares(place: f64, width: f32) -> (i32, [f32; 3]) {
    // Counted from the centre of texel 0.
    let from_center = place - 0.5;
    let start = (from_center - 0.5 * f64::from(width)).floor();
    let middle = (from_center - start) as f32;
    let beyond = middle + 0.5 * width - 1.0;
    if beyond <= 0.0 || width == 0.0 {
        return (start as i32, [1.0 - middle, middle, 0.0]);
    }
    // The box reaches over the middle texel's centre: `before` lies left of it.
    let before = width - beyond;
    let left = 0.5 * before * (before / width);
    let right = 0.5 * beyond * (beyond / width);
    (start as i32, [left, 1.0 - left - right, right])
}
