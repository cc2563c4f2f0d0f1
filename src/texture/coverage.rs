//! How much of each cell of a unit grid a parallelogram covers, exactly.
//!
//! Rows of cells are visited one by one. An edge that crosses a row adds the
//! signed area to its right, cell by cell, to a buffer of differences; the
//! running sum of the buffer is the covered area of each cell (the way that
//! font rasterizers draw outlines: R. Levien, "Inside the fastest font renderer
//! in the world", 2016). Since nothing is sampled, the areas change
//! continuously with the parallelogram.

use glam::Vec2;

/// Most columns that a parallelogram may span.
pub(super) const MAX_COLUMNS: usize = 256;
/// A parallelogram flatter than this share of its longer side is widened to
/// it: a line has no area to compare. A 64th of a cell and of the width of
/// what is averaged is not seen.
const THINNEST: f32 = 1.0 / 64.0;

/// Corners in order around the parallelogram about `middle`.
pub(super) fn corners(middle: Vec2, along_x: Vec2, along_y: Vec2) -> [Vec2; 4] {
    let [mut a, mut b] = [along_x * 0.5, along_y * 0.5];
    let longest = a.length_squared().max(b.length_squared());
    if a.perp_dot(b).abs() < THINNEST * longest {
        if a.length_squared() >= b.length_squared() {
            b += a.perp() * THINNEST;
        } else {
            a -= b.perp() * THINNEST;
        }
    }
    [
        middle - a - b,
        middle + a - b,
        middle + a + b,
        middle - a + b,
    ]
}

/// Calls `visit(row, column, areas)` for every row of cells that the outline
/// touches, with the covered areas from `column` on; all have the sign of the
/// outline's sense.
pub(super) fn visit_rows(outline: [Vec2; 4], mut visit: impl FnMut(i32, i32, &[f32])) {
    let edges: [Edge; 4] = std::array::from_fn(|i| Edge::new(outline[i], outline[(i + 1) % 4]));
    let lowest = outline.iter().fold(f32::INFINITY, |y, p| y.min(p.y));
    let highest = outline.iter().fold(f32::NEG_INFINITY, |y, p| y.max(p.y));
    let mut buffer = [0.0; MAX_COLUMNS + 4];
    for row in lowest.floor() as i32..=highest.floor() as i32 {
        let mut pieces = [Piece::default(); 4];
        let mut count = 0;
        let [mut left, mut right] = [f32::INFINITY, f32::NEG_INFINITY];
        for edge in &edges {
            if let Some(piece) = edge.within(row as f32) {
                left = left.min(piece.left);
                right = right.max(piece.right);
                pieces[count] = piece;
                count += 1;
            }
        }
        if count == 0 {
            continue;
        }
        let column = left.floor();
        let width = ((right - column) as usize + 1).min(MAX_COLUMNS);
        let areas = &mut buffer[..width + 1];
        areas.fill(0.0);
        for piece in &pieces[..count] {
            piece.add_to(areas, column);
        }
        let mut area = 0.0;
        for cell in areas.iter_mut() {
            area += *cell;
            *cell = area;
        }
        visit(row, column as i32, &areas[..width]);
    }
}

/// An edge from its upper end (smaller y) to its lower one.
struct Edge {
    from: Vec2,
    to: Vec2,
    /// Columns a row.
    slope: f32,
    /// -1 where the outline runs the other way.
    sense: f32,
}

impl Edge {
    fn new(a: Vec2, b: Vec2) -> Self {
        let (from, to, sense) = if a.y <= b.y {
            (a, b, 1.0)
        } else {
            (b, a, -1.0)
        };
        let slope = (to.x - from.x) / (to.y - from.y);
        Self {
            from,
            to,
            slope,
            sense,
        }
    }

    /// The part between `row` and the next one; none of a horizontal edge.
    fn within(&self, row: f32) -> Option<Piece> {
        let upper = if self.from.y > row { self.from.y } else { row };
        let lower = if self.to.y < row + 1.0 {
            self.to.y
        } else {
            row + 1.0
        };
        if lower <= upper {
            return None;
        }
        let (least, most) = if self.from.x <= self.to.x {
            (self.from.x, self.to.x)
        } else {
            (self.to.x, self.from.x)
        };
        let x = |y: f32| (self.from.x + (y - self.from.y) * self.slope).clamp(least, most);
        let (a, b) = (x(upper), x(lower));
        let (left, right) = if a <= b { (a, b) } else { (b, a) };
        Some(Piece {
            left,
            right,
            height: self.sense * (lower - upper),
        })
    }
}

/// The part of an edge inside a row.
#[derive(Clone, Copy, Default)]
struct Piece {
    left: f32,
    right: f32,
    /// Signed by the outline's sense.
    height: f32,
}

impl Piece {
    /// Adds the differences of the area to the piece's right, `column` being
    /// the first cell.
    fn add_to(&self, differences: &mut [f32], column: f32) {
        let [left, right] = [self.left - column, self.right - column];
        let last = differences.len() - 2;
        let [first_cell, last_cell] = [left, right].map(|x| (x as usize).min(last));
        if first_cell == last_cell {
            let inset = 0.5 * (left + right) - first_cell as f32;
            differences[first_cell] += self.height * (1.0 - inset);
            differences[first_cell + 1] += self.height * inset;
            return;
        }
        let height_a_column = self.height / (right - left);
        let mut x = left;
        for cell in first_cell..=last_cell {
            let end = if cell == last_cell {
                right
            } else {
                (cell + 1) as f32
            };
            let height = (end - x) * height_a_column;
            let inset = 0.5 * (x + end) - cell as f32;
            differences[cell] += height * (1.0 - inset);
            differences[cell + 1] += height * inset;
            x = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_those_of_a_dense_grid_of_points() {
        /// Points along a side of a cell.
        const POINTS: i32 = 64;
        /// A border crosses at most about two rows of points a cell.
        const GRID_ERROR: f32 = 2.0 / POINTS as f32;
        for [a, b] in [
            [Vec2::new(3.2, 0.7), Vec2::new(-0.4, 1.9)],
            [Vec2::new(2.0, 0.0), Vec2::new(0.0, 3.0)],
            [Vec2::new(0.3, 0.1), Vec2::new(0.1, -0.2)],
            [Vec2::new(5.0, 4.0), Vec2::new(0.5, -0.1)],
        ] {
            let middle = Vec2::new(0.3, -0.6);
            let mut total = 0.0;
            visit_rows(corners(middle, a, b), |row, column, areas| {
                for (i, area) in areas.iter().enumerate() {
                    let corner = Vec2::new((column + i as i32) as f32, row as f32);
                    let inside = |k: i32| {
                        let step = Vec2::new((k % POINTS) as f32, (k / POINTS) as f32);
                        let d = corner + (step + 0.5) / POINTS as f32 - middle;
                        let whole = a.perp_dot(b);
                        (d.perp_dot(b) / whole).abs() < 0.5 && (a.perp_dot(d) / whole).abs() < 0.5
                    };
                    let count = (0..POINTS * POINTS).filter(|&k| inside(k)).count();
                    let wanted = count as f32 / (POINTS * POINTS) as f32;
                    assert!((area.abs() - wanted).abs() < GRID_ERROR, "{area} {wanted}");
                    total += area;
                }
            });
            assert!((total.abs() - a.perp_dot(b).abs()).abs() < 1e-4);
        }
    }
}
