//! The sun of an environment map: a disc of the sky small enough to be a light
//! with shadow rays of its own.

use glam::Vec3;

use super::LightSample;
use crate::maths::functions::cos;
use crate::maths::order::Order;
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
    /// Irradiance on a plane of unit `normal`, W/m2, as of its middle: a disc cut
    /// by the horizon is there or not, all of it.
    pub(super) fn unoccluded(&self, normal: Vec3) -> Vec3 {
        self.irradiance * self.direction.dot(normal).at_least(0.0)
    }

    /// Whether a unit direction leads to the disc or the blur of its border: of
    /// a sun of one texel that reaches to twice its radius.
    pub(crate) fn contains(&self, direction: Vec3) -> bool {
        direction.dot(self.direction) >= cos(2.0 * f64::from(self.radius_rad)) as f32
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
