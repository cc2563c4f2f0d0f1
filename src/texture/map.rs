//! Colour maps of materials.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;
use glam::Vec3;

use super::TextureError;
use super::grid::{Footprint, Grid, Region, Texels, floor};
use super::image_file::{self, LINEAR_FROM_LEVEL, Pixels};
use super::pyramid::{Level, coarser_levels, strip_area};
use super::{parts, slabs};

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
    size: [u32; 2],
    finest: Finest,
    /// Level 1 and coarser.
    coarser: Vec<Level>,
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
    fn texel(&self, index: usize) -> Vec3 {
        Vec3::from_array(self.levels[index].map(|level| self.linear[usize::from(level)]))
    }
}

impl Texels for Vec<Vec3> {
    #[inline]
    fn texel(&self, index: usize) -> Vec3 {
        self[index]
    }
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && self.size == other.size
    }
}

impl Texture {
    /// Decodes the bytes of the file at `path`.
    pub(crate) fn decode(bytes: &[u8], path: &Path) -> Result<Self, TextureError> {
        let file = image_file::decode(bytes, path)?;
        Ok(Self::new(path, file.size, file.pixels))
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
            Finest::Levels(encoded) => coarser_levels(texels, |i| encoded.texel(i), strip_area),
            Finest::Linear(values) => coarser_levels(texels, |i| values[i], strip_area),
        };
        Self {
            path: path.to_owned(),
            size,
            finest,
            coarser,
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Mean colour, linear.
    pub(crate) fn mean_color(&self) -> Vec3 {
        match (self.coarser.last(), &self.finest) {
            (Some(level), _) => level.texels[0],
            (None, Finest::Levels(encoded)) => encoded.texel(0),
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
    pub(crate) fn point(&self, uv: Vec2, filter: TextureFilter) -> Vec3 {
        let Some(footprint) = self.footprint(uv, Vec2::ZERO, Vec2::ZERO) else {
            return self.texture.mean_color();
        };
        match &self.texture.finest {
            Finest::Levels(encoded) => self.point_of(encoded, &footprint, filter),
            Finest::Linear(values) => self.point_of(values, &footprint, filter),
        }
    }

    fn finest_grid<'a, T>(&self, texels: &'a T) -> Grid<'a, T> {
        Grid {
            size: self.texture.size.map(|n| n as usize),
            texels,
            clamp: self.clamp,
        }
    }

    fn point_of<T: Texels>(&self, texels: &T, at: &Footprint, filter: TextureFilter) -> Vec3 {
        let grid = self.finest_grid(texels);
        parts::mean(&grid, &at.among(grid.size), [1; 2], filter)
    }

    fn mean_of<T: Texels>(&self, texels: &T, over: &Footprint, filter: TextureFilter) -> Vec3 {
        let grid = self.finest_grid(texels);
        let region = over.among(grid.size);
        if is_magnified(&region, filter) {
            return parts::mean(&grid, &region, [1; 2], filter);
        }
        let lengths = region.edges.map(|edge| edge.length());
        let side = match filter {
            TextureFilter::Bilinear => BILINEAR_PART,
            TextureFilter::Nearest => NEAREST_PART,
        };
        let [wide, high] = lengths.map(|length| (length / side).max(1.0));
        let many = ((wide * high - PARTS[0]) / (PARTS[1] - PARTS[0])).max(0.0);
        if many < 1.0 {
            let counts = [wide, high].map(|count| floor(count + 0.5));
            let mean = parts::mean(&grid, &region, counts, filter);
            if many == 0.0 {
                return mean;
            }
            return mean + (self.mean_of_cells(&grid, over, &region, filter) - mean) * many;
        }
        self.mean_of_cells(&grid, over, &region, filter)
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
        // A bilinear texel is a box run over by another of its width.
        let blur = match filter {
            TextureFilter::Bilinear => [1.414_213_5, 1.118_034, 1.030_776_4, 1.0][level.min(3)],
            TextureFilter::Nearest => 1.0,
        };
        if level == 0 {
            return slabs::mean(finest, &over.among(finest.size), blur);
        }
        let Some(level) = self.texture.coarser.get(level - 1) else {
            return self.texture.mean_color();
        };
        if level.texels.len() == 1 {
            return level.texels[0];
        }
        let grid = Grid {
            size: level.size,
            texels: &level.texels,
            clamp: self.clamp,
        };
        slabs::mean(&grid, &over.among(grid.size), blur)
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

const BILINEAR_PART: f32 = 1.0;
const NEAREST_PART: f32 = 0.5;
const PARTS: [f32; 2] = [12.0, 16.0];
const WIDTH_SHARE: f32 = 0.3;
const LENGTH_SHARE: f32 = 1.0 / 48.0;
const BLEND_FROM: f32 = 1.6;
const BOX_EXTENT: f32 = 0.75;
const BOX_COVARIANCE: f32 = 0.004;
const POINT_EXTENT: f32 = 0.01;

fn is_magnified(region: &Region, filter: TextureFilter) -> bool {
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
            extent.max_element() < POINT_EXTENT
                || (inside(region.middle.x, half.x) && inside(region.middle.y, half.y))
        }
    }
}

/// The level for a region of texels, and the share of the next one.
fn level_for(region: &Region) -> (usize, f32) {
    let [a, b] = region.edges;
    let length = a.length_squared().max(b.length_squared()).sqrt();
    let area = a.perp_dot(b).abs();
    let width = area / length;
    let cell = (WIDTH_SHARE * (width * area.sqrt()).sqrt()).max(LENGTH_SHARE * length);
    if cell < 1.0 {
        return (0, 0.0);
    }
    // The float's own exponent and mantissa.
    let level = (cell.to_bits() >> 23) as usize - 127;
    let within = f32::from_bits(cell.to_bits() & 0x7f_ffff | 0x3f80_0000);
    (level, ((within - BLEND_FROM) / (2.0 - BLEND_FROM)).max(0.0))
}

/// What is left of a number above its largest whole part, 0..1.
fn fraction(x: f64) -> f64 {
    // The standard method is a call on x86-64; the cast holds here.
    if x.abs() < f64::from(i32::MAX) {
        let cut = f64::from(x as i32);
        let left = x - cut;
        return if left < 0.0 { left + 1.0 } else { left };
    }
    x - x.floor()
}

#[cfg(test)]
mod tests;
