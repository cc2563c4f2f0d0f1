//! Colour maps of materials.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;
use glam::Vec3;

use super::TextureError;
use super::grid::{Footprint, Grid, Region, Texel, Texels, floor, floor_f64};
use super::image_file::{self, LINEAR_FROM_LEVEL, Pixels};
use super::pyramid::{coarser_levels, strip_area};
use super::{parts, slabs};
use crate::maths::order::Order;

/// A bilinear footprint below this extent (texels) is one box, if it is not
/// askew: a box reaches over three texels along each axis at most.
const BOX_EXTENT: f32 = 0.75;
/// Largest covariance (texels squared) of the two axes of a footprint that is
/// read as one box. At most 2 x this, the mixed difference of a checkerboard,
/// is the error.
const BOX_COVARIANCE: f32 = 0.004;
/// Side of the parts (texels) for the nearest filter. 0.3 makes twice as many
/// of them; with 0.5 a footprint of 0.3 x 1.2 on a checker of texels errs by
/// 5.4 % instead of 2.6 %.
const NEAREST_SIDE: f32 = 0.45;
/// A footprint is read in parts up to the first number of them, by cells from
/// the second on, and between as a mix. With 15 and 18 a footprint of 16 parts
/// takes 0.4 to 0.6 us, with 11 and 14 by cells 0.2 at errors up to 1.2 %; a
/// nearest one of 0.3 x 4.8, 11 parts, errs by 3.6 % by cells.
const PARTS: [f32; 2] = [11.0, 14.0];
/// Largest width of a cell, over that of a square footprint; for one k times as
/// long it is the fourth root of k times as much. With 0.25 the error at 11
/// texels, 1:4, is 1.9 % instead of 0.3 %; at 24 texels, square, only 0.15 would
/// bring it below 1.5 %, at twice the time of most others.
const WIDTH_SHARE: f32 = 0.2;
/// Least width of a cell over the footprint's length: it bounds the time of long
/// ones. With 1/48 the atlas at 8 texels, 1:16, errs by 0.9 % instead of 2.2 %
/// and takes 0.9 us instead of 0.5.
const LENGTH_SHARE: f32 = 1.0 / 32.0;
/// Where in an octave of cell widths (1..2) blending with the next level
/// begins: a wider zone reads both levels more often, a narrower one turns their
/// difference of 1 to 2 % into a step.
const BLEND_FROM: f32 = 1.75;

/// How a texture is read between texel centres.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TextureFilter {
    /// Linear between the four nearest texels.
    #[default]
    Bilinear,
    /// The texel that holds the point.
    Nearest,
}

/// A decoded image with its smaller copies.
#[derive(Debug, Clone)]
pub struct Texture {
    path: PathBuf,
    /// Of the file's bytes: equal maps hold equal pixels.
    digest: [u8; 32],
    size: [u32; 2],
    finest: Finest,
    /// Level 1 and coarser.
    coarser: Vec<Coarser>,
}

/// Level 0, as it was in the file.
#[derive(Debug, Clone)]
enum Finest {
    Levels(Encoded),
    Linear(Vec<Vec3>),
}

/// sRGB levels, read through the table of their linear values.
#[derive(Debug, Clone)]
struct Encoded {
    levels: Vec<[u8; 3]>,
    linear: &'static [f32; 256],
}

impl Texels for Encoded {
    #[inline]
    fn texel(&self, index: usize) -> Texel {
        let [x, y, z] = self.levels[index].map(|level| self.linear[usize::from(level)]);
        [x, y, z, 1.0]
    }
}

impl Texels for Vec<Vec3> {
    #[inline]
    fn texel(&self, index: usize) -> Texel {
        let Vec3 { x, y, z } = self[index];
        [x, y, z, 1.0]
    }
}

impl Texels for Vec<Texel> {
    #[inline]
    fn texel(&self, index: usize) -> Texel {
        self[index]
    }
}

fn colour_of([x, y, z, _]: Texel) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A smaller copy.
#[derive(Debug, Clone)]
struct Coarser {
    size: [usize; 2],
    texels: Vec<Texel>,
}

impl Coarser {
    fn bytes(&self) -> usize {
        size_of_val(self.texels.as_slice())
    }
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && self.digest == other.digest
    }
}

impl Texture {
    /// Decodes the bytes of the file at `path`.
    pub(crate) fn decode(bytes: &[u8], path: &Path) -> Result<Self, TextureError> {
        let file = image_file::decode(bytes, path)?;
        Ok(Self {
            digest: *blake3::hash(bytes).as_bytes(),
            ..Self::new(path, file.size, file.pixels)
        })
    }

    fn new(path: &Path, size: [u32; 2], pixels: Pixels) -> Self {
        let texels = size.map(|n| n as usize);
        let finest = match pixels {
            Pixels::Levels(levels) => Finest::Levels(Encoded {
                levels,
                linear: &LINEAR_FROM_LEVEL,
            }),
            Pixels::Linear(values) => Finest::Linear(values),
        };
        let coarser = match &finest {
            Finest::Levels(encoded) => {
                coarser_levels(texels, |i| colour_of(encoded.texel(i)), strip_area)
            }
            Finest::Linear(values) => coarser_levels(texels, |i| values[i], strip_area),
        };
        let padded = |Vec3 { x, y, z }: &Vec3| [*x, *y, *z, 1.0];
        let coarser = coarser
            .into_iter()
            .map(|level| Coarser {
                size: level.size,
                texels: level.texels.iter().map(padded).collect(),
            })
            .collect();
        Self {
            path: path.to_owned(),
            digest: [0; 32],
            size,
            finest,
            coarser,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Hash of the file's bytes: equal maps hold equal pixels.
    pub(crate) fn digest(&self) -> &[u8; 32] {
        &self.digest
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Whether a value is above 1, as in an image of radiance.
    pub(crate) fn exceeds_one(&self) -> bool {
        match &self.finest {
            Finest::Levels(_) => false,
            Finest::Linear(values) => values.iter().any(|v| v.max_element() > 1.0),
        }
    }

    /// The same with values above 1 taken for 1.
    pub(crate) fn clamped_to_one(&self) -> Self {
        let values = match &self.finest {
            Finest::Levels(_) => return self.clone(),
            Finest::Linear(values) => values.iter().map(|v| v.min(Vec3::ONE)).collect(),
        };
        let mut digest = self.digest;
        digest[0] ^= 1;
        Self {
            digest,
            ..Self::new(&self.path, self.size, Pixels::Linear(values))
        }
    }

    /// Bytes in memory, smaller copies included.
    pub fn bytes(&self) -> usize {
        let finest = match &self.finest {
            Finest::Levels(encoded) => size_of_val(encoded.levels.as_slice()),
            Finest::Linear(values) => size_of_val(values.as_slice()),
        };
        let coarser = self.coarser.iter().map(Coarser::bytes);
        finest + coarser.sum::<usize>()
    }

    /// Mean colour, linear.
    pub(crate) fn mean_color(&self) -> Vec3 {
        match (self.coarser.last(), &self.finest) {
            (Some(level), _) => colour_of(level.texels[0]),
            (None, Finest::Levels(encoded)) => colour_of(encoded.texel(0)),
            (None, Finest::Linear(values)) => values[0],
        }
    }
}

/// A texture as a material uses it.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureMap {
    /// The image.
    pub texture: Arc<Texture>,
    /// Factor on texture coordinates (`-s`).
    pub scale: Vec2,
    /// Added to texture coordinates after scaling (`-o`).
    pub offset: Vec2,
    /// Whether the image's border goes on beyond it instead of its repetition
    /// (`-clamp on`).
    pub clamp: bool,
}

impl TextureMap {
    /// Mean colour over the parallelogram `uv + a along_x + b along_y`, a and b
    /// in -0.5..0.5, texture coordinates of the mesh; v = 0 is the bottom row.
    /// The mean colour of the image for what is not finite.
    pub(crate) fn mean(
        &self,
        uv: Vec2,
        along_x: Vec2,
        along_y: Vec2,
        filter: TextureFilter,
    ) -> Vec3 {
        let Some(footprint) = self.footprint(uv, along_x, along_y) else {
            return self.texture.mean_color();
        };
        match &self.texture.finest {
            Finest::Levels(encoded) => self.mean_of(encoded, &footprint, filter),
            Finest::Linear(values) => self.mean_of(values, &footprint, filter),
        }
    }

    /// Colour at a point, of the image alone: what [`Self::mean`] averages.
    #[cfg(test)]
    pub(crate) fn point(&self, uv: Vec2, filter: TextureFilter) -> Vec3 {
        let Some(footprint) = self.footprint(uv, Vec2::ZERO, Vec2::ZERO) else {
            return self.texture.mean_color();
        };
        match &self.texture.finest {
            Finest::Levels(encoded) => self.point_of(encoded, &footprint, filter),
            Finest::Linear(values) => self.point_of(values, &footprint, filter),
        }
    }

    fn finest_grid<'a, T: Texels>(&self, texels: &'a T) -> Grid<'a, T> {
        let size = self.texture.size.map(|n| n as usize);
        Grid::new(size, texels, self.clamp)
    }

    #[cfg(test)]
    fn point_of<T: Texels>(&self, texels: &T, at: &Footprint, filter: TextureFilter) -> Vec3 {
        let grid = self.finest_grid(texels);
        parts::whole_mean(&grid, &at.among(grid.size), filter)
    }

    fn mean_of<T: Texels>(&self, texels: &T, over: &Footprint, filter: TextureFilter) -> Vec3 {
        let grid = self.finest_grid(texels);
        let region = over.among(grid.size);
        if is_one_box(&region, filter) {
            return parts::whole_mean(&grid, &region, filter);
        }
        let [wide, high] = part_counts(&region, filter);
        let cells_share = (wide * high - PARTS[0]) / (PARTS[1] - PARTS[0]);
        if cells_share >= 1.0 {
            return self.mean_of_cells(&grid, over, &region, filter);
        }
        let counts = [wide, high].map(|count| floor(count + 0.5));
        let mean = parts::mean(&grid, &region, counts, filter);
        if cells_share <= 0.0 {
            return mean;
        }
        mean + (self.mean_of_cells(&grid, over, &region, filter) - mean) * cells_share
    }

    fn mean_of_cells<T: Texels>(
        &self,
        finest: &Grid<T>,
        over: &Footprint,
        region: &Region,
        filter: TextureFilter,
    ) -> Vec3 {
        let (level, next_share) = level_for(region);
        let mean = self.level_mean(finest, over, level, filter);
        if next_share == 0.0 {
            return mean;
        }
        mean + (self.level_mean(finest, over, level + 1, filter) - mean) * next_share
    }

    fn level_mean<T: Texels>(
        &self,
        finest: &Grid<T>,
        over: &Footprint,
        level: usize,
        filter: TextureFilter,
    ) -> Vec3 {
        if level == 0 {
            let blur = match filter {
                // A bilinear texel is a box run over by another of its width.
                TextureFilter::Bilinear => std::f32::consts::SQRT_2,
                TextureFilter::Nearest => 1.0,
            };
            return slabs::mean(finest, &over.among(finest.size), blur);
        }
        let Some(level) = self.texture.coarser.get(level - 1) else {
            return self.texture.mean_color();
        };
        let grid = Grid::new(level.size, &level.texels, self.clamp);
        slabs::mean(&grid, &over.among(grid.size), 1.0)
    }

    /// A footprint of the mesh in the image; none if it is not finite.
    fn footprint(&self, uv: Vec2, along_x: Vec2, along_y: Vec2) -> Option<Footprint> {
        // Rows of the image are counted from the top.
        let down = Vec2::new(1.0, -1.0);
        let [along_x, along_y] = [along_x, along_y].map(|edge| edge * self.scale * down);
        let u = f64::from(uv.x) * f64::from(self.scale.x) + f64::from(self.offset.x);
        let v = f64::from(uv.y) * f64::from(self.scale.y) + f64::from(self.offset.y);
        let half = (along_x.abs() + along_y.abs()) * 0.5;
        if !(u.is_finite() && v.is_finite() && half.is_finite()) {
            return None;
        }
        let reduced = |x: f64, half: f32| {
            if self.clamp {
                // Farther out all is the border.
                let reach = f64::from(half) + 1.0;
                x.clamp(-reach, 1.0 + reach)
            } else {
                fraction(x)
            }
        };
        Some(Footprint {
            middle: [reduced(u, half.x), reduced(1.0 - v, half.y)],
            along_x,
            along_y,
        })
    }
}

/// Whether a region is read as one box.
fn is_one_box(region: &Region, filter: TextureFilter) -> bool {
    let [a, b] = region.edges;
    let extent = a.abs() + b.abs();
    match filter {
        TextureFilter::Bilinear => {
            let covariance = (a.x * a.y + b.x * b.y) / 12.0;
            extent.max_element() < BOX_EXTENT && covariance.abs() < BOX_COVARIANCE
        }
        TextureFilter::Nearest => {
            let half = extent * 0.5;
            let inside = |place: f32, half: f32| place >= half && place + half <= 1.0;
            inside(region.middle.x, half.x) && inside(region.middle.y, half.y)
        }
    }
}

/// How many parts a region has along its edges, with fractions.
fn part_counts(region: &Region, filter: TextureFilter) -> [f32; 2] {
    let lengths = region.edges.map(|edge| edge.length());
    let shorter = lengths[0].at_most(lengths[1]);
    // Square parts lose nothing as boxes; long ones do where they are askew.
    let side = match filter {
        TextureFilter::Bilinear => shorter.clamp(0.5, 1.0),
        TextureFilter::Nearest => NEAREST_SIDE,
    };
    lengths.map(|length| (length / side).at_least(1.0))
}

/// The level for a region of texels, and the share of the next one.
fn level_for(region: &Region) -> (usize, f32) {
    let [a, b] = region.edges;
    let length = a.length_squared().at_least(b.length_squared()).sqrt();
    let area = a.perp_dot(b).abs();
    let width = area / length;
    // The longer a region, the more its noise averages out.
    let largest = WIDTH_SHARE * (width * area.sqrt()).sqrt();
    let cell = largest.at_least(LENGTH_SHARE * length);
    if cell < 1.0 {
        return (0, 0.0);
    }
    // The float's own exponent and mantissa; of what is not finite, a level
    // beyond the last one.
    let level = (cell.to_bits() >> 23) as usize - 127;
    let within = f32::from_bits(cell.to_bits() & 0x7f_ffff | 0x3f80_0000);
    (
        level,
        ((within - BLEND_FROM) / (2.0 - BLEND_FROM)).at_least(0.0),
    )
}

/// What is left of a number above its largest whole part, 0..1.
fn fraction(x: f64) -> f64 {
    if x.abs() < f64::from(i32::MAX) {
        return x - floor_f64(x);
    }
    x - x.floor()
}

#[cfg(test)]
mod tests;
