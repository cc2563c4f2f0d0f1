//! Texels by column and row, and footprints among them.

use glam::Vec2;
use glam::Vec3;

/// Texels and what lies beyond them.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a, T> {
    /// Width and height.
    pub(super) size: [usize; 2],
    /// How far the index moves from a texel to the next one along each axis.
    strides: [usize; 2],
    pub(super) texels: &'a T,
    /// Whether the border goes on instead of a repetition.
    pub(super) clamp: bool,
}

/// A colour and 1, so that a sum of weighted texels holds the sum of weights;
/// four lanes are loaded, multiplied and added at once.
pub(super) type Texel = [f32; 4];

/// Colours by index, row by row.
pub(super) trait Texels {
    fn texel(&self, index: usize) -> Texel;
}

/// A sum of weighted texels.
#[derive(Clone, Copy, Default)]
pub(super) struct Sum([f32; 4]);

impl Sum {
    #[inline]
    pub(super) fn add(&mut self, texel: Texel, weight: f32) {
        for lane in 0..4 {
            self.0[lane] += texel[lane] * weight;
        }
    }

    /// The weighted mean.
    #[inline]
    pub(super) fn mean(self) -> Vec3 {
        let [x, y, z, weight] = self.0;
        Vec3::new(x, y, z) / weight
    }

    /// The sum where all weights are known to make 1.
    #[inline]
    pub(super) fn colour(self) -> Vec3 {
        let [x, y, z, _] = self.0;
        Vec3::new(x, y, z)
    }
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

impl Region {
    /// The region with columns for rows.
    pub(super) fn turned(&self) -> Self {
        let turned = |v: Vec2| Vec2::new(v.y, v.x);
        Self {
            cell: [self.cell[1], self.cell[0]],
            middle: turned(self.middle),
            edges: self.edges.map(turned),
        }
    }
}

impl Footprint {
    /// The footprint in an image of `size` cells.
    pub(super) fn among(&self, size: [usize; 2]) -> Region {
        let cells = size.map(|n| n as i32 as f32);
        let place = [0, 1].map(|axis| self.middle[axis] * f64::from(cells[axis]));
        let below = place.map(floor_f64);
        let within = [0, 1].map(|axis| (place[axis] - below[axis]) as f32);
        let cells = Vec2::from_array(cells);
        Region {
            cell: below.map(|x| x as i32),
            middle: Vec2::from_array(within),
            edges: [self.along_x * cells, self.along_y * cells],
        }
    }
}

impl<'a, T: Texels> Grid<'a, T> {
    /// An image of `size`, row by row.
    pub(super) fn new(size: [usize; 2], texels: &'a T, clamp: bool) -> Self {
        Self {
            size,
            strides: [1, size[0]],
            texels,
            clamp,
        }
    }

    /// The image with columns for rows.
    pub(super) fn turned(&self) -> Self {
        Self {
            size: [self.size[1], self.size[0]],
            strides: [self.strides[1], self.strides[0]],
            ..*self
        }
    }

    /// The column (axis 0) or row (axis 1) of the image for any number.
    #[inline]
    fn wrapped(&self, cell: i32, axis: usize) -> usize {
        let count = self.size[axis];
        // Below 0 it is large as well.
        if (cell as u32 as usize) < count {
            return cell as usize;
        }
        let count = count as i32;
        let inside = if self.clamp {
            cell.clamp(0, count - 1)
        } else {
            cell.rem_euclid(count)
        };
        inside as usize
    }

    /// Adds weights times the texels of a row from a column on.
    #[inline]
    pub(super) fn add_row<const COUNT: usize>(
        &self,
        sum: &mut Sum,
        [column, row]: [i32; 2],
        weights: [f32; COUNT],
    ) {
        let [stride, row_stride] = self.strides;
        let start = self.wrapped(row, 1) * row_stride;
        let mut part = Sum::default();
        if (column as u32 as usize) + COUNT <= self.size[0] {
            let first = start + column as usize * stride;
            for (i, weight) in weights.into_iter().enumerate() {
                part.add(self.texels.texel(first + i * stride), weight);
            }
        } else {
            let mut inside = self.wrapped(column, 0);
            for (i, weight) in weights.into_iter().enumerate() {
                part.add(self.texels.texel(start + inside * stride), weight);
                let goes_on = self.clamp && column.wrapping_add(i as i32) < 0;
                inside += usize::from(!goes_on);
                if inside == self.size[0] {
                    inside = if self.clamp { inside - 1 } else { 0 };
                }
            }
        }
        sum.add(part.0, 1.0);
    }
}

/// Largest whole number at or below a number of cells, or the one below where
/// they are equal; the number, below 2^22, is rounded by adding what leaves no
/// room for a fraction. The standard method is a call where the target has no
/// instruction for it, which all x86-64 has not.
#[inline]
pub(super) fn floor(x: f32) -> i32 {
    const NO_FRACTION: f32 = 12_582_912.0;
    let rounded = (x - 0.5) + NO_FRACTION;
    rounded.to_bits().wrapping_sub(NO_FRACTION.to_bits()) as i32
}

/// The same in double precision, below 2^51.
#[inline]
pub(super) fn floor_f64(x: f64) -> f64 {
    const NO_FRACTION: f64 = 6_755_399_441_055_744.0;
    ((x - 0.5) + NO_FRACTION) - NO_FRACTION
}
