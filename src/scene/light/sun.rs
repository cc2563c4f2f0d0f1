//! The sun of an environment map: a disc of the sky small enough to be a light
//! with shadow rays of its own.

use glam::Vec3;

use super::LightSample;
use crate::maths::functions::cos;
use crate::maths::sampling::cone_direction;

/// A bright disc infinitely far away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedSun {
    /// Unit direction to its middle.
    pub(super) direction: Vec3,
    /// Irradiance on a plane that faces it, W/m2.
    pub(super) irradiance: Vec3,
    /// Angular radius, radians.
    pub(super) radius_rad: f32,
}

impl PlacedSun {
    /// Irradiance on a plane of unit `normal`, W/m2, as of its middle.
    pub(super) fn unoccluded(&self, normal: Vec3) -> Vec3 {
        self.irradiance * self.direction.dot(normal).max(0.0)
    }

    /// A direction uniform over the disc.
    pub(super) fn sample(&self, u: [f32; 2]) -> LightSample {
        let cos_radius = cos(f64::from(self.radius_rad)) as f32;
        LightSample {
            direction: cone_direction(self.direction, cos_radius, u),
            distance: f32::INFINITY,
            irradiance: self.irradiance,
        }
    }
}
