//! Point light: E = I cos / r^2.

use glam::{DVec3, Vec3};

use super::LightSample;
use crate::scene::file::fields::Fields;
use crate::scene::{Placement, SceneError};

/// Keys besides `name` and `kind`.
pub(super) const KEYS: &[&str] = &["position", "intensity"];

/// `kind = "point"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// File units.
    pub position: DVec3,
    /// Radiant intensity, W/sr, in every direction.
    pub intensity: Vec3,
}

/// A point light in placed units; its intensity is scaled with the area unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedPoint {
    pub(super) position: Vec3,
    pub(super) intensity: Vec3,
}

impl Point {
    pub(super) fn read(fields: &mut Fields) -> Result<Self, SceneError> {
        Ok(Self {
            position: fields.require("position", "[x, y, z]")?.vector()?,
            intensity: fields.require("intensity", "[r, g, b], W/sr")?.light()?,
        })
    }

    pub(super) fn place(&self, placement: &Placement) -> PlacedPoint {
        PlacedPoint {
            position: placement.placed_from_file(self.position),
            intensity: placed_intensity(self.intensity, placement),
        }
    }
}

/// W/sr so that intensity / distance^2 is W/m2 with distances in placed units.
pub(super) fn placed_intensity(intensity: Vec3, placement: &Placement) -> Vec3 {
    (intensity.as_dvec3() * (placement.scale * placement.scale)).as_vec3()
}

impl PlacedPoint {
    pub(super) fn sample(&self, point: Vec3) -> LightSample {
        let to_light = self.position - point;
        let squared = to_light.length_squared();
        if squared == 0.0 {
            return LightSample {
                direction: Vec3::Y,
                distance: 0.0,
                irradiance: Vec3::ZERO,
            };
        }
        let distance = squared.sqrt();
        LightSample {
            direction: to_light / distance,
            distance,
            irradiance: self.intensity / squared,
        }
    }
}
