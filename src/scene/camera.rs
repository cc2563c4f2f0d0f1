//! The camera of the scene file.

use glam::{DVec3, Vec3};

use super::Placement;
use crate::maths::functions::tan;

/// A pinhole camera, units of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Eye.
    pub position: DVec3,
    /// Point in the middle of the picture.
    pub target: DVec3,
    /// Direction that is up in the picture; not parallel to the view.
    pub up: DVec3,
    /// Full vertical angle, degrees, between 0 and 180.
    pub vfov_deg: f64,
    /// Width and height, pixels, 1 to 16,384.
    pub size: [u32; 2],
}

/// The camera in placed units: an eye and three axes.
///
/// A direction through pixel coordinates (x, y) (row 0 on top, pixel centres
/// at +0.5) is `forward + right * (x - width/2) + down * (y - height/2)`;
/// `forward` is a unit vector, `right` and `down` are one pixel long at unit
/// distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedCamera {
    /// Eye, placed units (double precision: it may be far from the scene).
    pub(crate) eye: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) right: DVec3,
    pub(crate) down: DVec3,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Camera {
    /// The camera in placed units.
    pub(crate) fn place(&self, placement: &Placement) -> PlacedCamera {
        let forward = (self.target - self.position).normalize();
        let right = forward.cross(self.up).normalize();
        let down = forward.cross(right);
        let [width, height] = self.size;
        let half_height = tan(self.vfov_deg * (std::f64::consts::PI / 360.0));
        let pixel = 2.0 * half_height / f64::from(height);
        PlacedCamera {
            eye: (self.position - placement.center) * placement.scale,
            forward,
            right: right * pixel,
            down: down * pixel,
            width,
            height,
        }
    }
}

impl PlacedCamera {
    /// Unit direction from the eye through pixel coordinates (x, y).
    pub(crate) fn direction(&self, x: f64, y: f64) -> Vec3 {
        let across = x - 0.5 * f64::from(self.width);
        let along = y - 0.5 * f64::from(self.height);
        (self.forward + self.right * across + self.down * along)
            .normalize()
            .as_vec3()
    }
}
