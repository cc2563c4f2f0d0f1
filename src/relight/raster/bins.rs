//! Which triangles may be seen in which tile.

use rayon::prelude::*;

use super::screen::{Corner, Screen};
use super::{NEAR, RasterMesh};

/// Pixels across a tile; one bit each in a `u32`.
pub(super) const TILE_WIDTH: usize = 32;
/// Pixels down a tile. Less than across: the rows of tiles are what threads
/// share out, so there should be many.
pub(super) const TILE_HEIGHT: usize = 16;

/// Triangles that a thread bins at a time.
const CHUNK: usize = 2048;

/// Bounds are widened by this, pixels: far more than the rounding of the
/// divisions, far less than what would cost time.
const BOUNDS_MARGIN: f64 = 1e-3;

/// A rectangle of pixels of the picture; the ends are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PixelBounds {
    pub(super) x: [usize; 2],
    pub(super) y: [usize; 2],
}

/// A rectangle of pixels of a tile; the ends are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct TileBounds {
    x: [u8; 2],
    y: [u8; 2],
}

impl TileBounds {
    fn new(bounds: &PixelBounds, tile_x: usize, tile_y: usize) -> Self {
        let inside = |ends: [usize; 2], start: usize, length: usize| {
            let last = (ends[1] - start).min(length - 1);
            [ends[0].saturating_sub(start) as u8, last as u8]
        };
        Self {
            x: inside(bounds.x, tile_x * TILE_WIDTH, TILE_WIDTH),
            y: inside(bounds.y, tile_y * TILE_HEIGHT, TILE_HEIGHT),
        }
    }

    /// First and last column.
    pub(super) fn columns(&self) -> [usize; 2] {
        self.x.map(usize::from)
    }

    /// The rows.
    pub(super) fn rows(&self) -> std::ops::RangeInclusive<usize> {
        usize::from(self.y[0])..=usize::from(self.y[1])
    }

    /// The middle in pixels of the tile, and the distances from there to the
    /// outermost pixel centres across and down.
    pub(super) fn middle_and_reach(&self) -> [f64; 4] {
        let middle = |ends: [u8; 2]| 0.5 * (f64::from(ends[0]) + f64::from(ends[1]) + 1.0);
        let reach = |ends: [u8; 2]| 0.5 * (f64::from(ends[1]) - f64::from(ends[0]));
        [middle(self.x), middle(self.y), reach(self.x), reach(self.y)]
    }
}

/// What of a pixel a triangle must touch to be binned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Touch {
    /// The centre.
    Center,
    /// Any place in its square.
    Square,
}

/// A triangle in a tile.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Entry {
    pub(super) triangle: u32,
    /// Where in the tile it may be seen.
    pub(super) bounds: TileBounds,
}

/// Lists of triangles by tile, each in ascending order.
pub(super) struct Bins {
    tiles_across: usize,
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

impl Bins {
    /// Bins all triangles of the mesh.
    pub(super) fn new(
        screen: &Screen,
        corners: &[Corner],
        mesh: &RasterMesh,
        touch: Touch,
    ) -> Self {
        let window = Window::new(screen);
        let tiles_across = window.width.div_ceil(TILE_WIDTH);
        let tile_count = tiles_across * window.height.div_ceil(TILE_HEIGHT);
        let chunks: Vec<Vec<(u32, Entry)>> = mesh
            .triangles
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, triangles)| {
                let mut pairs = Vec::with_capacity(2 * triangles.len());
                for (offset, triangle) in triangles.iter().enumerate() {
                    let corners = triangle.map(|corner| corners[corner as usize]);
                    if let Some(bounds) = window.bounds(&corners, touch) {
                        push_tiles(&mut pairs, &bounds, tiles_across, chunk * CHUNK + offset);
                    }
                }
                pairs
            })
            .collect();
        Self::from_pairs(tiles_across, tile_count, &chunks)
    }

    /// Counting sort by tile, which keeps the order of the triangles.
    fn from_pairs(tiles_across: usize, tile_count: usize, chunks: &[Vec<(u32, Entry)>]) -> Self {
        let mut starts = vec![0_u32; tile_count + 1];
        for (tile, _) in chunks.iter().flatten() {
            starts[*tile as usize + 1] += 1;
        }
        for tile in 0..tile_count {
            starts[tile + 1] += starts[tile];
        }
        let mut entries = vec![Entry::default(); starts[tile_count] as usize];
        let mut next = starts.clone();
        for (tile, entry) in chunks.iter().flatten() {
            let place = &mut next[*tile as usize];
            entries[*place as usize] = *entry;
            *place += 1;
        }
        Self {
            tiles_across,
            starts,
            entries,
        }
    }

    /// The triangles of a tile, in ascending order.
    pub(super) fn tile(&self, tile_x: usize, tile_y: usize) -> &[Entry] {
        let tile = tile_y * self.tiles_across + tile_x;
        &self.entries[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    pub(super) fn tiles_across(&self) -> usize {
        self.tiles_across
    }
}

fn push_tiles(
    pairs: &mut Vec<(u32, Entry)>,
    bounds: &PixelBounds,
    tiles_across: usize,
    triangle: usize,
) {
    for tile_y in bounds.y[0] / TILE_HEIGHT..=bounds.y[1] / TILE_HEIGHT {
        for tile_x in bounds.x[0] / TILE_WIDTH..=bounds.x[1] / TILE_WIDTH {
            let entry = Entry {
                triangle: triangle as u32,
                bounds: TileBounds::new(bounds, tile_x, tile_y),
            };
            pairs.push(((tile_y * tiles_across + tile_x) as u32, entry));
        }
    }
}

/// The picture's rectangle on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    half_width: f64,
    half_height: f64,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Window {
    pub(super) fn new(screen: &Screen) -> Self {
        Self {
            half_width: screen.half_width,
            half_height: screen.half_height,
            width: (2.0 * screen.half_width) as usize,
            height: (2.0 * screen.half_height) as usize,
        }
    }

    /// Pixels in which the triangle may be seen: the bounds of the part of it
    /// beyond the near plane. `None` if there are none.
    pub(super) fn bounds(&self, corners: &[Corner; 3], touch: Touch) -> Option<PixelBounds> {
        let span = Span::of_visible_part(corners);
        let reach = match touch {
            Touch::Center => BOUNDS_MARGIN,
            Touch::Square => 0.5 + BOUNDS_MARGIN,
        };
        Some(PixelBounds {
            x: pixels(span.x, reach, self.half_width)?,
            y: pixels(span.y, reach, self.half_height)?,
        })
    }
}

/// First and last pixel of the picture whose centre is within `reach` of the
/// range of centred coordinates.
fn pixels(range: [f64; 2], reach: f64, half: f64) -> Option<[usize; 2]> {
    let first = (range[0] - reach + half - 0.5).ceil();
    let last = (range[1] + reach + half - 0.5).floor();
    let first = if first > 0.0 { first } else { 0.0 };
    let end = 2.0 * half - 1.0;
    let last = if last < end { last } else { end };
    (first <= last).then_some([first as usize, last as usize])
}

/// Bounds in centred pixel coordinates.
struct Span {
    x: [f64; 2],
    y: [f64; 2],
}

impl Span {
    const EMPTY: Self = Self {
        x: [f64::INFINITY, f64::NEG_INFINITY],
        y: [f64::INFINITY, f64::NEG_INFINITY],
    };

    fn of_visible_part(corners: &[Corner; 3]) -> Self {
        let mut span = Self::EMPTY;
        for (k, corner) in corners.iter().enumerate() {
            let next = &corners[(k + 1) % 3];
            if corner.w > NEAR {
                span.include(corner);
            }
            if (corner.w > NEAR) != (next.w > NEAR) {
                span.include(&corner.at_near_plane(next));
            }
        }
        span
    }

    fn include(&mut self, corner: &Corner) {
        let scale = 1.0 / corner.w;
        widen(&mut self.x, corner.x * scale);
        widen(&mut self.y, corner.y * scale);
    }
}

fn widen(range: &mut [f64; 2], value: f64) {
    if value < range[0] {
        range[0] = value;
    }
    if value > range[1] {
        range[1] = value;
    }
}
