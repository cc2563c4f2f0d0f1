//! Spot light: a point light inside a cone, full inside `beam`, falling
//! linearly with the angle to 0 at `cutoff`.

use glam::{DVec3, Vec3};

use super::LightSample;
use super::point::{PlacedPoint, placed_intensity};
use crate::maths::functions::acos_f32;
use crate::scene::Placement;

/// `kind = "spot"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// File units.
    pub position: DVec3,
    /// Unit axis of the cone, in the direction of travel.
    pub direction: Vec3,
    /// Radiant intensity inside the beam, W/sr.
    pub intensity: Vec3,
    /// Half angle beyond which there is no light, degrees.
    pub cutoff_deg: f32,
    /// Half angle of full intensity, degrees, at most `cutoff_deg`.
    pub beam_deg: f32,
}

/// A spot in placed units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedSpot {
    source: PlacedPoint,
    axis: Vec3,
    cutoff_rad: f32,
    beam_rad: f32,
}

impl Spot {
    pub(super) fn place(&self, placement: &Placement) -> PlacedSpot {
        let radians = |deg: f32| (f64::from(deg) * (std::f64::consts::PI / 180.0)) as f32;
        PlacedSpot {
            source: PlacedPoint {
                position: placement.placed_from_file(self.position),
                intensity: placed_intensity(self.intensity, placement),
            },
            axis: self.direction,
            cutoff_rad: radians(self.cutoff_deg),
            beam_rad: radians(self.beam_deg),
        }
    }
}

impl PlacedSpot {
    pub(super) fn sample(&self, point: Vec3) -> LightSample {
        let mut sample = self.source.sample(point);
        sample.irradiance *= self.falloff(self.angle(-sample.direction));
        sample
    }

    /// Angle from the axis of a unit direction of travel, radians.
    fn angle(&self, travel: Vec3) -> f32 {
        acos_f32(travel.dot(self.axis))
    }

    /// Share of the full intensity at an angle from the axis.
    fn falloff(&self, angle_rad: f32) -> f32 {
        if angle_rad <= self.beam_rad {
            1.0
        } else if angle_rad >= self.cutoff_rad {
            0.0
        } else {
            (self.cutoff_rad - angle_rad) / (self.cutoff_rad - self.beam_rad)
        }
    }

    /// Whether the rim of the cone or of the beam lies between the two points.
    pub(super) fn edge_between(&self, a: Vec3, b: Vec3) -> bool {
        let [a, b] = [a, b].map(|p| self.angle((p - self.source.position).normalize_or_zero()));
        [self.beam_rad, self.cutoff_rad]
            .iter()
            .any(|&rim| (a < rim) != (b < rim))
    }
}
