//! One fragment a pixel, at its centre.

use rayon::prelude::*;

use super::bins::{Bins, Entry, TILE_HEIGHT, TILE_WIDTH, Touch};
use super::screen::{Corner, Screen};
use super::triangle::{Nearest, TriangleSetup};
use super::{Fragment, RasterMesh};
use crate::scene::PlacedCamera;

/// Samples that a loop takes at once: a whole number of registers whatever
/// their width, and not many more than a small triangle is wide.
const LANES: usize = 4;

/// One fragment a pixel, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CenterBuffer {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) fragments: Vec<Fragment>,
}

/// What the camera sees at the centre of every pixel.
pub(crate) fn rasterize(camera: &PlacedCamera, mesh: &RasterMesh) -> CenterBuffer {
    let screen = Screen::new(camera);
    let corners = screen.project_all(mesh.positions);
    let bins = Bins::new(&screen, &corners, mesh, Touch::Center);
    let width = camera.width as usize;
    let mut fragments = vec![Fragment::EMPTY; width * camera.height as usize];
    fragments
        .par_chunks_mut(width * TILE_HEIGHT)
        .enumerate()
        .for_each_init(Tile::new, |tile, (tile_y, rows)| {
            for tile_x in 0..bins.tiles_across() {
                tile.place(&screen, tile_x, tile_y);
                tile.draw(bins.tile(tile_x, tile_y), &corners, mesh);
                tile.resolve(tile_x, rows, width);
            }
        });
    CenterBuffer {
        width: camera.width,
        height: camera.height,
        fragments,
    }
}

const EMPTY_ROWS: [[Nearest<LANES>; TILE_WIDTH / LANES]; TILE_HEIGHT] =
    [[Nearest::EMPTY; TILE_WIDTH / LANES]; TILE_HEIGHT];

/// A tile being drawn.
struct Tile {
    /// Centred coordinates of the first pixel's centre.
    left: f64,
    top: f64,
    /// The nearest surface at each pixel; owners are one more than the index
    /// in `drawn`.
    rows: [[Nearest<LANES>; TILE_WIDTH / LANES]; TILE_HEIGHT],
    /// The tile's triangles that draw something.
    drawn: Vec<(u32, TriangleSetup)>,
}

impl Tile {
    fn new() -> Self {
        Self {
            left: 0.0,
            top: 0.0,
            rows: EMPTY_ROWS,
            drawn: Vec::new(),
        }
    }

    /// Makes this an empty tile at the given place.
    fn place(&mut self, screen: &Screen, tile_x: usize, tile_y: usize) {
        self.left = (tile_x * TILE_WIDTH) as f64 + 0.5 - screen.half_width;
        self.top = (tile_y * TILE_HEIGHT) as f64 + 0.5 - screen.half_height;
        self.rows = EMPTY_ROWS;
        self.drawn.clear();
    }

    fn draw(&mut self, entries: &[Entry], corners: &[Corner], mesh: &RasterMesh) {
        for entry in entries {
            let triangle = mesh.triangles[entry.triangle as usize];
            let corners = triangle.map(|corner| corners[corner as usize]);
            let Some(setup) = TriangleSetup::new(corners) else {
                continue;
            };
            let [x, y, reach_x, reach_y] = entry.bounds.middle_and_reach();
            let (x, y) = (self.left - 0.5 + x, self.top - 0.5 + y);
            // Half a pixel more than needed, against rounding.
            if setup.misses(x, y, reach_x + 0.5, reach_y + 0.5) {
                continue;
            }
            self.drawn.push((entry.triangle, setup));
            let owner = self.drawn.len() as u64;
            for row in entry.bounds.rows() {
                self.draw_row(&setup, owner, row, entry.bounds.columns());
            }
        }
    }

    /// Draws one row of a triangle, in whole groups of [`LANES`] pixels.
    fn draw_row(&mut self, setup: &TriangleSetup, owner: u64, row: usize, columns: [usize; 2]) {
        let ys = [self.top + row as f64; LANES];
        for group in columns[0] / LANES..=columns[1] / LANES {
            let first = self.left + (group * LANES) as f64;
            let mut xs = [first; LANES];
            for (lane, x) in xs.iter_mut().enumerate() {
                *x += lane as f64;
            }
            let inverse_depths = setup.inverse_depths_inside(&xs, &ys);
            self.rows[row][group].draw(owner, &inverse_depths);
        }
    }

    /// Fragments of the tile's pixels, into the rows of the picture.
    fn resolve(&self, tile_x: usize, rows: &mut [Fragment], width: usize) {
        let left = tile_x * TILE_WIDTH;
        for (y, row) in rows.chunks_mut(width).enumerate() {
            let end = width.min(left + TILE_WIDTH);
            for (x, fragment) in row[left..end].iter_mut().enumerate() {
                let owner = self.rows[y][x / LANES].owners[x % LANES];
                if owner > 0 {
                    let (triangle, setup) = &self.drawn[owner as usize - 1];
                    let (x, y) = (self.left + x as f64, self.top + y as f64);
                    *fragment = setup.fragment(*triangle, x, y);
                }
            }
        }
    }
}

/// What the camera sees at centred coordinates (x, y), by asking every
/// triangle: the definition that the tiles are tested against.
#[cfg(test)]
pub(super) fn fragment_by_brute_force(
    setups: &[Option<TriangleSetup>],
    x: f64,
    y: f64,
) -> Fragment {
    let mut nearest = 0.0;
    let mut fragment = Fragment::EMPTY;
    for (triangle, setup) in setups.iter().enumerate() {
        let Some(setup) = setup else { continue };
        let inverse_depth = setup.inverse_depth_inside(x, y);
        if inverse_depth > nearest {
            nearest = inverse_depth;
            fragment = setup.fragment(triangle as u32, x, y);
        }
    }
    fragment
}
