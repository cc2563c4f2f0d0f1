//! Solids made of boxes: the cells of a rectangular grid that are filled.
//! One body without inner faces, however many cells it has.

use glam::DVec3;

use super::body::{Body, Face, Shape};

/// Coordinates of a grid's planes along x, y and z, ascending.
pub(crate) struct Grid<'a>(pub(crate) [&'a [f64]; 3]);

impl Grid<'_> {
    /// Cells along an axis.
    pub(crate) fn cell_count(&self, axis: usize) -> usize {
        self.0[axis].len() - 1
    }

    /// The four grid corners of a cell's low or high side along an axis,
    /// counter-clockwise seen from the axis' positive end.
    pub(crate) fn side(&self, cell: [usize; 3], axis: usize, high: bool) -> [[usize; 3]; 4] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
            let mut corner = cell;
            corner[axis] += usize::from(high);
            corner[u] += du;
            corner[v] += dv;
            corner
        })
    }

    fn position(&self, [i, j, k]: [usize; 3]) -> DVec3 {
        DVec3::new(self.0[0][i], self.0[1][j], self.0[2][k])
    }
}

/// Collects quads between grid corners, sharing equal corners.
#[derive(Default)]
pub(crate) struct QuadCollector {
    corners: Vec<[usize; 3]>,
    faces: Vec<Face>,
}

impl QuadCollector {
    /// Adds a quad; `flipped` turns its front to the other side.
    pub(crate) fn add(&mut self, material: &'static str, quad: [[usize; 3]; 4], flipped: bool) {
        let mut corners: Vec<usize> = quad.map(|corner| self.index(corner)).to_vec();
        if flipped {
            corners.reverse();
        }
        self.faces.push(Face { material, corners });
    }

    fn index(&mut self, corner: [usize; 3]) -> usize {
        let known = self.corners.iter().position(|&other| other == corner);
        known.unwrap_or_else(|| {
            self.corners.push(corner);
            self.corners.len() - 1
        })
    }

    /// The body of all quads.
    pub(crate) fn body(self, name: &'static str, shape: Shape, grid: &Grid) -> Body {
        Body {
            name,
            shape,
            positions: self.corners.iter().map(|&c| grid.position(c)).collect(),
            normals: None,
            faces: self.faces,
        }
    }
}

/// The surface of the filled cells, fronts outward. Filled cells must not
/// touch along an edge alone.
pub(crate) fn solid(
    name: &'static str,
    material: &'static str,
    grid: &Grid,
    filled: impl Fn([usize; 3]) -> bool,
) -> Body {
    let mut quads = QuadCollector::default();
    let counts = [0, 1, 2].map(|axis| grid.cell_count(axis));
    for cell in cells_of(counts).filter(|&cell| filled(cell)) {
        for axis in 0..3 {
            for high in [false, true] {
                let beyond = neighbour(cell, axis, high, counts);
                if !beyond.is_some_and(&filled) {
                    quads.add(material, grid.side(cell, axis, high), !high);
                }
            }
        }
    }
    quads.body(name, Shape::Solid, grid)
}

/// A box between two corners, fronts outward.
pub(crate) fn cuboid(
    name: &'static str,
    material: &'static str,
    low: [f64; 3],
    high: [f64; 3],
) -> Body {
    let [x, y, z] = [0, 1, 2].map(|axis| [low[axis], high[axis]]);
    solid(name, material, &Grid([&x, &y, &z]), |_| true)
}

/// All cells, x slowest.
fn cells_of([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])))
}

fn neighbour(
    mut cell: [usize; 3],
    axis: usize,
    high: bool,
    counts: [usize; 3],
) -> Option<[usize; 3]> {
    cell[axis] = if high {
        cell[axis] + 1
    } else {
        cell[axis].checked_sub(1)?
    };
    (cell[axis] < counts[axis]).then_some(cell)
}
