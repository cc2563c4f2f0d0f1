//! Colour maps of materials.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;
use glam::Vec3;

use super::TextureError;
use super::footprint::{Footprint, Grid, Texels};
use super::image_file::{self, LINEAR_FROM_LEVEL, Pixels};
use super::pyramid::{Level, coarser_levels, strip_area};

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

    /// Bytes in memory, smaller copies included.
    pub fn bytes(&self) -> usize {
        let finest = match &self.finest {
            Finest::Levels(encoded) => size_of_val(encoded.levels.as_slice()),
            Finest::Linear(values) => size_of_val(values.as_slice()),
        };
        let coarser = self.coarser.iter().map(Level::bytes);
        finest + coarser.sum::<usize>()
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
        match filter {
            TextureFilter::Bilinear => grid.bilinear(at.middle),
            TextureFilter::Nearest => grid.nearest(at.middle),
        }
    }

    fn mean_of<T: Texels>(&self, texels: &T, over: &Footprint, filter: TextureFilter) -> Vec3 {
        let grid = self.finest_grid(texels);
        let within_texels = match filter {
            TextureFilter::Bilinear => grid.magnified_mean(over),
            TextureFilter::Nearest => grid.only_texel(over),
        };
        if let Some(mean) = within_texels {
            return mean;
        }
        let choice = over.choice(grid.size);
        let mean_at = |octave: i32| match (octave, filter) {
            (..0, TextureFilter::Bilinear) => grid.divided_mean(over, octave),
            (..=0, _) => grid.covered_mean(over),
            (1.., _) => self.coarse_mean_of(&grid, over, octave),
        };
        let mean = mean_at(choice.octave);
        // All octaves below are one level to the nearest filter.
        let is_last_step = filter == TextureFilter::Nearest && choice.octave < 0;
        if choice.next_share == 0.0 || is_last_step {
            return mean;
        }
        mean + (mean_at(choice.octave + 1) - mean) * choice.next_share
    }

    fn coarse_mean_of<T: Texels>(&self, finest: &Grid<T>, over: &Footprint, octave: i32) -> Vec3 {
        let index = (octave as usize).min(self.texture.coarser.len());
        let Some(level) = index.checked_sub(1).map(|i| &self.texture.coarser[i]) else {
            return finest.covered_mean(over);
        };
        let grid = Grid {
            size: level.size,
            texels: &level.texels,
            clamp: self.clamp,
        };
        grid.covered_mean(over)
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
