//! Rooms: the inner sides of a box, cut along one grid so that neighbouring
//! walls share all their edges.

use glam::DVec3;

use super::body::{Body, Shape};
use super::cells::{Grid, QuadCollector};

/// A side of a room.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wall {
    /// Low x.
    Left,
    /// High x.
    Right,
    /// Low y.
    Floor,
    /// High y.
    Ceiling,
    /// Low z.
    Back,
    /// High z.
    Front,
}

impl Wall {
    const fn axis(self) -> usize {
        match self {
            Self::Left | Self::Right => 0,
            Self::Floor | Self::Ceiling => 1,
            Self::Back | Self::Front => 2,
        }
    }

    const fn is_high(self) -> bool {
        matches!(self, Self::Right | Self::Ceiling | Self::Front)
    }
}

/// A room with the walls that it has.
pub(crate) struct Room<'a> {
    /// Name in the file.
    pub(crate) name: &'static str,
    /// Cuts of all walls; the first and last planes are the walls themselves.
    pub(crate) grid: Grid<'a>,
    /// The walls and their MTL names; a wall that is not named is open.
    pub(crate) walls: &'a [(Wall, &'static str)],
    /// Holes: a wall, and the cell beside the hole.
    pub(crate) holes: &'a [(Wall, [usize; 3])],
}

impl Room<'_> {
    /// The walls, fronts inward.
    pub(crate) fn build(&self) -> Body {
        let mut quads = QuadCollector::default();
        for &(wall, material) in self.walls {
            for cell in self.cells_along(wall) {
                if !self.holes.contains(&(wall, cell)) {
                    let side = self.grid.side(cell, wall.axis(), wall.is_high());
                    quads.add(material, side, wall.is_high());
                }
            }
        }
        let seen_from = self.center();
        quads.body(self.name, Shape::Open { seen_from }, &self.grid)
    }

    /// Cells that touch a wall.
    fn cells_along(&self, wall: Wall) -> Vec<[usize; 3]> {
        let axis = wall.axis();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut cells = Vec::new();
        for i in 0..self.grid.cell_count(u) {
            for j in 0..self.grid.cell_count(v) {
                let mut cell = [0; 3];
                cell[axis] = if wall.is_high() {
                    self.grid.cell_count(axis) - 1
                } else {
                    0
                };
                cell[u] = i;
                cell[v] = j;
                cells.push(cell);
            }
        }
        cells
    }

    fn center(&self) -> DVec3 {
        let middle = |planes: &[f64]| (planes[0] + planes[planes.len() - 1]) * 0.5;
        DVec3::from_array(self.grid.0.map(middle))
    }
}
