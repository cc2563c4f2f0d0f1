//! Spot light: a point light inside a cone, full inside `beam`, falling
//! linearly with the angle to 0 at `cutoff`.

use std::ops::Bound::{Excluded, Included};

use glam::{DVec3, Vec3};

use super::LightSample;
use super::point::{PlacedPoint, placed_intensity};
use crate::maths::functions::acos_f32;
use crate::scene::file::fields::{Fields, unit};
use crate::scene::{Placement, SceneError};

/// Keys besides `name` and `kind`.
pub(super) const KEYS: &[&str] = &[
    "position",
    "target",
    "direction",
    "intensity",
    "cutoff",
    "beam",
];

/// Half angle of the cone where the file gives none, degrees.
pub(in crate::scene) const DEFAULT_CUTOFF_DEG: f64 = 30.0;

/// Share of the cutoff that the beam takes where the file gives no beam.
const DEFAULT_BEAM_SHARE: f64 = 0.75;

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
    pub(super) source: PlacedPoint,
    axis: Vec3,
    cutoff_rad: f32,
    beam_rad: f32,
}

impl Spot {
    pub(super) fn read(fields: &mut Fields) -> Result<Self, SceneError> {
        let position = fields.require("position", "[x, y, z]")?.vector()?;
        let direction = axis(fields, position)?;
        let intensity = fields.require("intensity", "[r, g, b], W/sr")?.light()?;
        let cutoff_deg = fields
            .take("cutoff")
            .map_or(Ok(DEFAULT_CUTOFF_DEG), |item| {
                item.number(
                    (Excluded(0.0), Included(90.0)),
                    "above 0 and at most 90 (degrees, half angle)",
                )
            })?;
        let beam_deg = fields
            .take("beam")
            .map_or(Ok(DEFAULT_BEAM_SHARE * cutoff_deg), |item| {
                item.number(
                    0.0..=cutoff_deg,
                    &format!("from 0 to `cutoff`, {cutoff_deg} (degrees, half angle)"),
                )
            })?;
        Ok(Self {
            position,
            direction: direction.as_vec3(),
            intensity,
            cutoff_deg: cutoff_deg as f32,
            beam_deg: beam_deg as f32,
        })
    }

    pub(super) fn place(&self, placement: &Placement) -> PlacedSpot {
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

/// Unit direction of travel, from `direction` or `target`.
fn axis(fields: &mut Fields, position: DVec3) -> Result<DVec3, SceneError> {
    let item = fields.one_of("target", "direction")?;
    if item.key() == "direction" {
        return item.direction();
    }
    unit(item.vector()? - position)
        .ok_or_else(|| item.error("another point than the light's position"))
}

/// Radians of degrees, rounded once.
fn radians(deg: f32) -> f32 {
    (f64::from(deg) * (std::f64::consts::PI / 180.0)) as f32
}

impl PlacedSpot {
    pub(super) fn unit(position: Vec3, axis: Vec3, cutoff_deg: f32) -> Self {
        Self {
            source: PlacedPoint {
                position,
                intensity: Vec3::ONE,
            },
            axis,
            cutoff_rad: radians(cutoff_deg),
            beam_rad: radians(0.5 * cutoff_deg),
        }
    }

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
