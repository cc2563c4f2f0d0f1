//! Directions in cells: a cube map of 6 x 8 x 8.
//!
//! A direction d lies on the face of its largest component. On a face, s and t
//! in -1..1 are the other two components over the largest, and a cell is a
//! square of an eighth of the face's width.

use std::sync::LazyLock;

use glam::Vec3;

/// Cells along an edge of the cube.
pub(crate) const CELLS_ALONG: usize = 8;
/// Cells in all.
pub(crate) const CELL_COUNT: usize = 6 * CELLS_ALONG * CELLS_ALONG;

/// The axis and the two others of each pair of faces.
const AXES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// Cell of a direction (any length above 0).
pub(crate) fn cell_of(direction: Vec3) -> usize {
    let d = direction.to_array();
    let size = d.map(f32::abs);
    let axis = if size[0] >= size[1] && size[0] >= size[2] {
        0
    } else if size[1] >= size[2] {
        1
    } else {
        2
    };
    let [major, s, t] = AXES[axis];
    let face = 2 * axis + usize::from(d[major] < 0.0);
    let column = |x: f32| {
        let place = (x / size[major] + 1.0) * (0.5 * CELLS_ALONG as f32);
        (place as usize).min(CELLS_ALONG - 1)
    };
    (face * CELLS_ALONG + column(d[t])) * CELLS_ALONG + column(d[s])
}

/// Unit direction at a place (u, v in 0..1) of a cell, and how much solid angle
/// (sr) a unit of u x v covers there.
pub(crate) fn direction_in_cell(cell: usize, [u, v]: [f32; 2]) -> (Vec3, f32) {
    let [column, row] = [cell % CELLS_ALONG, cell / CELLS_ALONG % CELLS_ALONG];
    let face = cell / (CELLS_ALONG * CELLS_ALONG);
    let width = 2.0 / CELLS_ALONG as f32;
    let s = (column as f32 + u) * width - 1.0;
    let t = (row as f32 + v) * width - 1.0;
    let [major, along_s, along_t] = AXES[face / 2];
    let mut d = [0.0; 3];
    d[major] = if face % 2 == 1 { -1.0 } else { 1.0 };
    d[along_s] = s;
    d[along_t] = t;
    let squared = 1.0 + s * s + t * t;
    let length = squared.sqrt();
    (
        Vec3::from_array(d) / length,
        width * width / (squared * length),
    )
}

/// The cells that share an edge with a cell, across the cube's edges too,
/// ascending.
pub(crate) fn neighbours(cell: usize) -> [usize; 4] {
    NEIGHBOURS[cell]
}

/// The neighbours of all cells: a bake asks millions of times.
static NEIGHBOURS: LazyLock<[[usize; 4]; CELL_COUNT]> =
    LazyLock::new(|| std::array::from_fn(found_neighbours));

fn found_neighbours(cell: usize) -> [usize; 4] {
    // A step of a tenth of a cell over the middle of an edge.
    let beside = |cell: usize, u: f32, v: f32| cell_of(direction_in_cell(cell, [u, v]).0);
    let mut found =
        [(-0.1, 0.5), (1.1, 0.5), (0.5, -0.1), (0.5, 1.1)].map(|(u, v)| beside(cell, u, v));
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_in_their_cells_and_cells_cover_the_sphere() {
        let mut total = 0.0;
        for cell in 0..CELL_COUNT {
            for (u, v) in [(0.02, 0.03), (0.5, 0.5), (0.97, 0.6)] {
                let (direction, _) = direction_in_cell(cell, [u, v]);
                assert_eq!(cell_of(direction), cell);
                assert_eq!(cell_of(direction * 3.0), cell);
            }
            for i in 0..16 {
                for j in 0..16 {
                    let at = [(i as f32 + 0.5) / 16.0, (j as f32 + 0.5) / 16.0];
                    total += f64::from(direction_in_cell(cell, at).1) / 256.0;
                }
            }
        }
        let sphere = 4.0 * std::f64::consts::PI;
        assert!((total / sphere - 1.0).abs() < 1e-4, "{total}");
    }

    #[test]
    fn neighbours_are_mutual() {
        for cell in 0..CELL_COUNT {
            for other in neighbours(cell) {
                assert_ne!(cell, other);
                assert!(neighbours(other).contains(&cell), "{cell} {other}");
            }
        }
    }
}
