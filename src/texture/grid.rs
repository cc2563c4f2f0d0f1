//! Texels by column and row, and footprints among them.

use glam::Vec2;
use glam::Vec3;

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

/// A parallelogram among cells of one unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    /// Column and row of the cell that holds the middle.
    pub(super) cell: [i32; 2],
    /// The middle, counted from that cell's corner: 0..1.
    pub(super) middle: Vec2,
    /// Two edges.
    pub(super) edges: [Vec2; 2],
}

impl Footprint {
    /// The footprint in an image of `size` cells.
    pub(super) fn among(&self, size: [usize; 2]) -> Region {
        let cells = size.map(|n| n as i32 as f32);
        let place = [0, 1].map(|axis| self.middle[axis] * f64::from(cells[axis]));
        let cell = place.map(|x| {
            let cut = x as i32;
            cut.saturating_sub(i32::from(f64::from(cut) > x))
        });
        let within = [0, 1].map(|axis| (place[axis] - f64::from(cell[axis])) as f32);
        let cells = Vec2::from_array(cells);
        Region {
            cell,
            middle: Vec2::from_array(within),
            edges: [self.along_x * cells, self.along_y * cells],
        }
    }
}

impl<T: Texels> Grid<'_, T> {
    /// Index of a column or row inside the image.
    #[inline]
    pub(super) fn wrapped(&self, cell: i32, axis: usize) -> usize {
        let count = self.size[axis] as i32;
        if cell >= 0 && cell < count {
            cell as usize
        } else {
            self.beyond(cell, count)
        }
    }

    #[cold]
    fn beyond(&self, cell: i32, count: i32) -> usize {
        let inside = if self.clamp {
            cell.clamp(0, count - 1)
        } else {
            cell.rem_euclid(count)
        };
        inside as usize
    }

    /// Index of the first texel of a row.
    #[inline]
    pub(super) fn row_start(&self, row: i32) -> usize {
        self.wrapped(row, 1) * self.size[0]
    }

    /// Sum of the texels from `column` on of the row that starts at index
    /// `start`, each times its weight.
    #[inline]
    pub(super) fn row_sum(&self, start: usize, column: i32, weights: &[f32]) -> Vec3 {
        let mut sum = Vec3::ZERO;
        if column >= 0 && column as usize + weights.len() <= self.size[0] {
            let first = start + column as usize;
            for (i, &weight) in weights.iter().enumerate() {
                sum += self.texels.texel(first + i) * weight;
            }
        } else {
            for (x, &weight) in (column..).zip(weights) {
                sum += self.texels.texel(start + self.wrapped(x, 0)) * weight;
            }
        }
        sum
    }
}

/// Largest whole number at or below a number of cells (below 2^31). The
/// standard method is a call where the target has no instruction for it, which
/// all x86-64 has not.
#[inline]
pub(super) fn floor(x: f32) -> i32 {
    let cut = x as i32;
    cut.saturating_sub(i32::from(cut as f32 > x))
}
