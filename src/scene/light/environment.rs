//! Environment: light from infinitely far away.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;

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

fn map_path(item: &Item, sources: &Sources<'_>) -> Result<PathBuf, SceneError> {
    let path = sources.folder.join(item.name()?);
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    if MAP_FORMATS.iter().any(|format| ending == *format) {
        Ok(path)
    } else {
        Err(item.error("the path of an .exr or .hdr file"))
    }
}
