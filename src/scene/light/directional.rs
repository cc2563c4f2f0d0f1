//! Directional light: parallel rays, such as the sun's.

use glam::Vec3;

use super::LightSample;
use crate::scene::SceneError;
use crate::scene::file::fields::Fields;

/// Keys besides `name` and `kind`.
pub(super) const KEYS: &[&str] = &["direction", "irradiance"];

/// `kind = "directional"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directional {
    /// Unit direction of travel.
    pub direction: Vec3,
    /// W/m2 on a plane that faces the light.
    pub irradiance: Vec3,
}

/// A directional light; placement does not change it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedDirectional(Directional);

impl Directional {
    pub(super) fn read(fields: &mut Fields) -> Result<Self, SceneError> {
        let direction = fields.require("direction", "the direction of travel")?;
        let irradiance = fields.require("irradiance", "[r, g, b], W/m2")?;
        Ok(Self {
            direction: direction.direction()?.as_vec3(),
            irradiance: irradiance.light()?,
        })
    }

    pub(super) fn place(&self) -> PlacedDirectional {
        PlacedDirectional(*self)
    }
}

impl PlacedDirectional {
    pub(super) fn sample(&self) -> LightSample {
        LightSample {
            direction: -self.0.direction,
            distance: f32::INFINITY,
            irradiance: self.0.irradiance,
        }
    }
}
