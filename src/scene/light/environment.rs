//! Environment: light from infinitely far away.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;

use super::sun::PlacedSun;
use crate::maths::cube_cells::CELL_COUNT;
use crate::maths::functions::{cos, sin};
use crate::scene::SceneError;
use crate::scene::file::fields::{Fields, Item, LARGEST};
use crate::scene::images::Sources;
use crate::texture::EnvironmentMap;

/// Keys besides `name` and `kind`.
pub(super) const KEYS: &[&str] = &["radiance", "map", "scale", "rotation"];

/// Endings of the image formats that hold radiance.
const MAP_FORMATS: [&str; 2] = ["exr", "hdr"];

/// `kind = "environment"`.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Where the radiance comes from.
    pub radiance: Radiance,
    /// Factor on a map's values.
    pub scale: f32,
    /// Rotation about up, degrees, below a turn.
    pub rotation_deg: f32,
}

/// Radiance of an environment.
#[derive(Debug, Clone, PartialEq)]
pub enum Radiance {
    /// The same in every direction, W/(m2 sr).
    Constant(Vec3),
    /// A latitude-longitude image.
    Map(Arc<EnvironmentMap>),
}

impl Environment {
    /// Reads and decodes the map too, if there is one.
    pub(super) fn read(fields: &mut Fields, sources: &Sources<'_>) -> Result<Self, SceneError> {
        let source = fields.one_of("radiance", "map")?;
        let radiance = if source.key() == "map" {
            let path = map_path(&source, sources)?;
            Radiance::Map(sources.images.environment(&path, source.place())?)
        } else {
            Radiance::Constant(source.light()?)
        };
        let scale = fields
            .take("scale")
            .map_or(Ok(1.0), |item| item.number(0.0..=LARGEST, "from 0 to 1e30"))?;
        let rotation_deg = fields.take("rotation").map_or(Ok(0.0), |item| {
            item.number(-LARGEST..=LARGEST, "from -1e30 to 1e30 (degrees)")
        })?;
        Ok(Self {
            radiance,
            scale: scale as f32,
            // Whole turns would take the digits of single precision.
            rotation_deg: (rotation_deg % 360.0) as f32,
        })
    }
}

/// An environment ready to be asked for radiance. It is infinitely far away, so
/// placing changes no length in it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlacedEnvironment {
    radiance: Radiance,
    scale: f32,
    /// Cosine and sine of the rotation.
    turn: [f32; 2],
}

impl Environment {
    pub(super) fn place(&self) -> PlacedEnvironment {
        let angle = f64::from(self.rotation_deg) % 360.0 * (std::f64::consts::PI / 180.0);
        PlacedEnvironment {
            radiance: self.radiance.clone(),
            scale: self.scale,
            turn: [cos(angle) as f32, sin(angle) as f32],
        }
    }
}

impl PlacedEnvironment {
    /// Radiance from a unit direction, W/(m2 sr), mean over a cone
    /// `spread_rad` wide.
    pub(crate) fn radiance(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        match &self.radiance {
            Radiance::Constant(radiance) => bounded(*radiance * self.scale),
            Radiance::Map(map) => {
                let radiance = map.radiance(self.map_from_world(direction), spread_rad);
                bounded(radiance * self.scale)
            }
        }
    }

    /// The same without the sun of a map, which is a light of its own.
    pub(crate) fn radiance_without_sun(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        match &self.radiance {
            Radiance::Constant(_) => self.radiance(direction, spread_rad),
            Radiance::Map(map) => {
                let direction = self.map_from_world(direction);
                bounded(map.radiance_without_sun(direction, spread_rad) * self.scale)
            }
        }
    }

    /// H_m of the cells of the sky: pi x the mean radiance of each, W/m2. The
    /// sun of a map is left out; it is a light of its own.
    pub(crate) fn cells(&self) -> Vec<Vec3> {
        let means = match &self.radiance {
            Radiance::Constant(radiance) => vec![*radiance; CELL_COUNT],
            Radiance::Map(map) => map.cell_means(|direction| self.map_from_world(direction)),
        };
        let irradiance = |mean| bounded(mean * self.scale) * std::f32::consts::PI;
        means.into_iter().map(irradiance).collect()
    }

    /// The sun of a map, if it has one.
    pub(crate) fn sun(&self) -> Option<PlacedSun> {
        let Radiance::Map(map) = &self.radiance else {
            return None;
        };
        let sun = map.sun()?;
        Some(PlacedSun {
            direction: self.world_from_map(sun.direction),
            irradiance: bounded(sun.irradiance * self.scale),
            radius_rad: sun.radius_rad,
        })
    }

    /// A direction with density proportional to brightness and its density
    /// (1/sr), from two uniforms; `None` for a sky without a map, whose
    /// brightness is the same everywhere.
    pub(crate) fn sample(&self, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let Radiance::Map(map) = &self.radiance else {
            return None;
        };
        let (direction, density) = map.sample(u);
        Some((self.world_from_map(direction), density))
    }

    /// Density (1/sr) with which [`Self::sample`] gives a direction; 0 without
    /// a map.
    pub(crate) fn density(&self, direction: Vec3) -> f32 {
        match &self.radiance {
            Radiance::Constant(_) => 0.0,
            Radiance::Map(map) => map.density(self.map_from_world(direction)),
        }
    }

    /// The rotation adds to u = atan2(d.x, -d.z) / 2 pi.
    fn map_from_world(&self, d: Vec3) -> Vec3 {
        let [cos, sin] = self.turn;
        Vec3::new(d.x * cos - d.z * sin, d.y, d.z * cos + d.x * sin)
    }

    fn world_from_map(&self, d: Vec3) -> Vec3 {
        let [cos, sin] = self.turn;
        Vec3::new(d.x * cos + d.z * sin, d.y, d.z * cos - d.x * sin)
    }
}

/// Radiance is bounded like any other number of the scene file, also where a
/// factor multiplies it: infinity times black would be no colour.
fn bounded(radiance: Vec3) -> Vec3 {
    radiance.min(Vec3::splat(LARGEST as f32))
}

fn map_path(item: &Item, sources: &Sources<'_>) -> Result<PathBuf, SceneError> {
    let path = sources.folder.join(item.name()?);
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    if MAP_FORMATS.iter().any(|format| ending == *format) {
        Ok(path)
    } else {
        Err(item.error("the path of an .exr or .hdr file"))
    }
}
