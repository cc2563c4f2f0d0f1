//! Latitude-longitude maps of the sky.
//!
//! A map's coarser levels hold solid-angle means, so the integral over the
//! sphere is the same at each. `lookup` reads them, `sun` takes a small bright
//! source out, `sampling` draws directions by brightness.

use std::path::{Path, PathBuf};

use glam::Vec3;

use super::TextureError;
use super::image_file;
use crate::maths::cube_cells::{CELL_COUNT, direction_in_cell};
use lookup::Panorama;
use sampling::Distribution;

mod lookup;
mod sampling;
mod sun;

pub(crate) use sun::Sun;

/// Directions along each side of a cell of the sky in its mean.
const DIRECTIONS_ALONG: usize = 16;

/// Radiance from every direction of the sky.
#[derive(Debug, Clone)]
pub struct EnvironmentMap {
    path: PathBuf,
    /// Of the file's bytes: equal maps hold equal pixels.
    digest: [u8; 32],
    panorama: Panorama,
    /// The sun and the map without it.
    sun: Option<(Sun, Panorama)>,
    distribution: Distribution,
}

impl PartialEq for EnvironmentMap {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && self.digest == other.digest
    }
}

impl EnvironmentMap {
    /// Decodes the bytes of the file at `path`.
    pub(crate) fn decode(bytes: &[u8], path: &Path) -> Result<Self, TextureError> {
        let file = image_file::decode_radiance(bytes, path)?;
        let size = file.size.map(|n| n as usize);
        Ok(Self {
            digest: *blake3::hash(bytes).as_bytes(),
            ..Self::new(path, size, file.pixels.into_linear())
        })
    }

    fn new(path: &Path, size: [usize; 2], texels: Vec<Vec3>) -> Self {
        let panorama = Panorama::new(size, texels);
        let sun = sun::find(size, panorama.finest())
            .map(|(sun, without)| (sun, Panorama::new(size, without)));
        Self {
            path: path.to_owned(),
            digest: [0; 32],
            distribution: Distribution::new(&panorama),
            panorama,
            sun,
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
        self.panorama.size().map(|n| n as u32)
    }

    /// Bytes in memory of the map and its smaller copies, with and without its
    /// sun.
    pub fn bytes(&self) -> usize {
        let without_sun = self.sun.as_ref();
        self.panorama.bytes() + without_sun.map_or(0, |(_, panorama)| panorama.bytes())
    }

    /// Radiance from a unit direction of the map's frame (+Y up, u =
    /// atan2(d.x, -d.z) / 2 pi mod 1, v = acos(d.y) / pi, row 0 on top), mean
    /// over a cone `spread_rad` wide (0: a point).
    pub(crate) fn radiance(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        self.panorama.mean(direction, spread_rad)
    }

    /// The same without the sun.
    pub(crate) fn radiance_without_sun(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        let panorama = self.sun.as_ref().map_or(&self.panorama, |(_, rest)| rest);
        panorama.mean(direction, spread_rad)
    }

    /// The sun of the map, if it has one.
    pub(crate) fn sun(&self) -> Option<Sun> {
        self.sun.as_ref().map(|&(sun, _)| sun)
    }

    /// A direction with density proportional to brightness, from two uniforms,
    /// and its density (1/sr); the sun counts.
    pub(crate) fn sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        self.distribution.sample(u)
    }

    /// Density (1/sr) with which [`Self::sample`] gives a direction.
    pub(crate) fn density(&self, direction: Vec3) -> f32 {
        self.distribution.density(direction)
    }

    /// Solid-angle mean of the radiance without the sun over each cell of
    /// [`cube_cells`](crate::maths::cube_cells); `to_map` turns a direction of
    /// the world into the map's frame.
    pub(crate) fn cell_means(&self, to_map: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        let count = DIRECTIONS_ALONG * DIRECTIONS_ALONG;
        let mean = |cell: usize| {
            let mut sum = Vec3::ZERO;
            let mut solid_angle = 0.0;
            for i in 0..count {
                let place = [i % DIRECTIONS_ALONG, i / DIRECTIONS_ALONG]
                    .map(|k| (k as f32 + 0.5) / DIRECTIONS_ALONG as f32);
                let (direction, density) = direction_in_cell(cell, place);
                let spread = (density / count as f32).sqrt();
                sum += self.radiance_without_sun(to_map(direction), spread) * density;
                solid_angle += density;
            }
            sum / solid_angle
        };
        (0..CELL_COUNT).map(mean).collect()
    }
}

#[cfg(test)]
mod tests;
