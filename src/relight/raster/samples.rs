//! Sixteen fragments for each of some pixels.

use rayon::prelude::*;

use super::bins::{Bins, Entry, TILE_HEIGHT, TILE_WIDTH, Touch};
use super::screen::{Corner, Screen};
use super::triangle::{Nearest, TriangleSetup};
use super::{Fragment, NONE, RasterMesh};
use crate::scene::PlacedCamera;

/// Samples a pixel.
pub(super) const SAMPLE_COUNT: usize = 16;

/// Columns and rows, of 16 each, of the samples in a pixel: a (0,4,2)-net in
/// base 2, so that every column, row, quarter and so on holds one. Of 200,000
/// Owen scramblings of the Sobol net it has the largest distance between
/// samples (sqrt 10 sixteenths, across the pixel's borders too; the plain net
/// has sqrt 2) and then the largest mean distance to the nearest.
const SAMPLE_CELLS: [[u8; 2]; SAMPLE_COUNT] = [
    [13, 11],
    [7, 1],
    [9, 4],
    [2, 14],
    [14, 3],
    [4, 9],
    [10, 12],
    [1, 6],
    [12, 7],
    [6, 13],
    [8, 8],
    [3, 2],
    [15, 15],
    [5, 5],
    [11, 0],
    [0, 10],
];

/// Places of the samples in a pixel, 0 to 1, row 0 on top; their mean is 0.5.
pub(crate) const SAMPLE_OFFSETS: [[f32; 2]; SAMPLE_COUNT] = sample_offsets();

const fn sample_offsets() -> [[f32; 2]; SAMPLE_COUNT] {
    let mut offsets = [[0.0; 2]; SAMPLE_COUNT];
    let mut k = 0;
    while k < SAMPLE_COUNT {
        let [column, row] = SAMPLE_CELLS[k];
        offsets[k] = [
            (column as f32 + 0.5) / SAMPLE_COUNT as f32,
            (row as f32 + 0.5) / SAMPLE_COUNT as f32,
        ];
        k += 1;
    }
    offsets
}

/// Fragments of the pixels that were asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SampleBuffer {
    /// For every pixel its place in `samples`, or [`NONE`].
    pub(crate) index: Vec<u32>,
    /// Sixteen fragments a pixel, pixels row by row, samples in the order of
    /// [`SAMPLE_OFFSETS`].
    pub(crate) samples: Vec<[Fragment; SAMPLE_COUNT]>,
}

impl SampleBuffer {
    /// The samples of a pixel (row * width + column), if it was asked for.
    pub(crate) fn pixel(&self, pixel: usize) -> Option<&[Fragment; SAMPLE_COUNT]> {
        self.samples.get(self.index[pixel] as usize)
    }
}

/// What the camera sees at the 16 samples of each pixel that is set in
/// `pixels` (one flag a pixel, row by row).
pub(crate) fn rasterize_samples(
    camera: &PlacedCamera,
    mesh: &RasterMesh,
    pixels: &[bool],
) -> SampleBuffer {
    let screen = Screen::new(camera);
    let corners = screen.project_all(mesh.positions);
    let bins = Bins::new(&screen, &corners, mesh, Touch::Square);
    let width = camera.width as usize;
    let (index, count) = compact_index(pixels);
    let mut samples = vec![[Fragment::EMPTY; SAMPLE_COUNT]; count];
    bands(pixels, &index, width, &mut samples)
        .into_par_iter()
        .enumerate()
        .for_each_init(Tile::new, |tile, (tile_y, mut band)| {
            for tile_x in 0..bins.tiles_across() {
                if tile.place(&screen, band.pixels, width, tile_x, tile_y) {
                    tile.draw(bins.tile(tile_x, tile_y), &corners, mesh);
                    tile.resolve(&mut band, width, tile_x);
                }
            }
        });
    SampleBuffer { index, samples }
}

/// Numbers the set pixels, and counts them.
fn compact_index(pixels: &[bool]) -> (Vec<u32>, usize) {
    let mut count = 0;
    let index = pixels
        .iter()
        .map(|&is_set| {
            count += u32::from(is_set);
            if is_set { count - 1 } else { NONE }
        })
        .collect();
    (index, count as usize)
}

/// The pixels of a row of tiles and the storage of their samples.
struct Band<'a> {
    /// Flags of the pixels.
    pixels: &'a [bool],
    /// Numbers of the pixels, see [`SampleBuffer::index`].
    index: &'a [u32],
    /// Number of the first pixel that has samples here.
    first: usize,
    samples: &'a mut [[Fragment; SAMPLE_COUNT]],
}

/// Cuts the storage into what the rows of tiles fill.
fn bands<'a>(
    pixels: &'a [bool],
    index: &'a [u32],
    width: usize,
    mut samples: &'a mut [[Fragment; SAMPLE_COUNT]],
) -> Vec<Band<'a>> {
    let mut bands = Vec::new();
    let mut first = 0;
    let size = width * TILE_HEIGHT;
    for (pixels, index) in pixels.chunks(size).zip(index.chunks(size)) {
        let count = pixels.iter().filter(|&&is_set| is_set).count();
        let (own, rest) = samples.split_at_mut(count);
        bands.push(Band {
            pixels,
            index,
            first,
            samples: own,
        });
        first += count;
        samples = rest;
    }
    bands
}

/// The samples of one pixel being drawn; owners are one more than the index in
/// [`Tile::drawn`].
type PixelSamples = Nearest<SAMPLE_COUNT>;

/// A tile being drawn.
struct Tile {
    /// Centred coordinates of the first pixel's upper left corner.
    left: f64,
    top: f64,
    /// Bit x of word y: the pixel was asked for.
    masks: [u32; TILE_HEIGHT],
    /// Place in `pixels` of the first such pixel of each row.
    row_starts: [usize; TILE_HEIGHT],
    /// The pixels that were asked for, row by row.
    pixels: Vec<PixelSamples>,
    /// The tile's triangles that draw something.
    drawn: Vec<(u32, TriangleSetup)>,
}

impl Tile {
    fn new() -> Self {
        Self {
            left: 0.0,
            top: 0.0,
            masks: [0; TILE_HEIGHT],
            row_starts: [0; TILE_HEIGHT],
            pixels: Vec::new(),
            drawn: Vec::new(),
        }
    }

    /// Makes this an empty tile at the given place; false if no pixel of it
    /// was asked for. `pixels` are the flags of the row of tiles.
    fn place(
        &mut self,
        screen: &Screen,
        pixels: &[bool],
        width: usize,
        tile_x: usize,
        tile_y: usize,
    ) -> bool {
        self.left = (tile_x * TILE_WIDTH) as f64 - screen.half_width;
        self.top = (tile_y * TILE_HEIGHT) as f64 - screen.half_height;
        self.masks = [0; TILE_HEIGHT];
        self.drawn.clear();
        let left = tile_x * TILE_WIDTH;
        let end = width.min(left + TILE_WIDTH);
        let mut count = 0;
        for (y, row) in pixels.chunks(width).enumerate() {
            for (x, &is_set) in row[left..end].iter().enumerate() {
                self.masks[y] |= u32::from(is_set) << x;
            }
            self.row_starts[y] = count;
            count += self.masks[y].count_ones() as usize;
        }
        self.pixels.clear();
        self.pixels.resize(count, PixelSamples::EMPTY);
        count > 0
    }

    fn draw(&mut self, entries: &[Entry], corners: &[Corner], mesh: &RasterMesh) {
        for entry in entries {
            let [first, last] = entry.bounds.columns();
            let columns = (u32::MAX << first) & (u32::MAX >> (TILE_WIDTH - 1 - last));
            if entry
                .bounds
                .rows()
                .all(|row| self.masks[row] & columns == 0)
            {
                continue;
            }
            let triangle = mesh.triangles[entry.triangle as usize];
            let corners = triangle.map(|corner| corners[corner as usize]);
            if let Some(setup) = TriangleSetup::new(corners) {
                self.drawn.push((entry.triangle, setup));
                for row in entry.bounds.rows() {
                    self.draw_row(&setup, row, columns);
                }
            }
        }
    }

    /// Draws the pixels of a row that are among the columns set in a mask.
    fn draw_row(&mut self, setup: &TriangleSetup, row: usize, columns: u32) {
        let owner = self.drawn.len() as u64;
        let mask = self.masks[row];
        let mut rest = mask & columns;
        while rest != 0 {
            let column = rest.trailing_zeros();
            rest &= rest - 1;
            let before = mask & ((1 << column) - 1);
            let place = self.row_starts[row] + before.count_ones() as usize;
            let (x, y) = (self.left + f64::from(column), self.top + row as f64);
            // The samples reach 15/32 from the centre, so half a pixel is
            // safe against rounding.
            if !setup.misses(x + 0.5, y + 0.5, 0.5, 0.5) {
                draw_pixel(setup, owner, x, y, &mut self.pixels[place]);
            }
        }
    }

    /// Fragments of the tile's pixels.
    fn resolve(&self, band: &mut Band, width: usize, tile_x: usize) {
        let mut pixels = self.pixels.iter();
        for (y, mask) in self.masks.iter().enumerate() {
            let mut rest = *mask;
            while rest != 0 {
                let x = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let Some(pixel) = pixels.next() else { return };
                let number = band.index[y * width + tile_x * TILE_WIDTH + x] as usize;
                let (x, y) = (self.left + x as f64, self.top + y as f64);
                self.resolve_pixel(pixel, x, y, &mut band.samples[number - band.first]);
            }
        }
    }

    fn resolve_pixel(
        &self,
        pixel: &PixelSamples,
        x: f64,
        y: f64,
        fragments: &mut [Fragment; SAMPLE_COUNT],
    ) {
        for ((fragment, &owner), offset) in
            fragments.iter_mut().zip(&pixel.owners).zip(&SAMPLE_OFFSETS)
        {
            if owner > 0 {
                let (triangle, setup) = &self.drawn[owner as usize - 1];
                let (x, y) = (x + f64::from(offset[0]), y + f64::from(offset[1]));
                *fragment = setup.fragment(*triangle, x, y);
            }
        }
    }
}

/// Tests the samples of the pixel whose upper left corner is (x, y).
fn draw_pixel(setup: &TriangleSetup, owner: u64, x: f64, y: f64, pixel: &mut PixelSamples) {
    let xs = SAMPLE_OFFSETS.map(|offset| x + f64::from(offset[0]));
    let ys = SAMPLE_OFFSETS.map(|offset| y + f64::from(offset[1]));
    pixel.draw(owner, &setup.inverse_depths_inside(&xs, &ys));
}
