//! Lights. One file a kind: the keys it has, and the irradiance it gives.
//! A new kind is one file here and one line in each table below.

mod area;
mod directional;
mod environment;
mod point;
mod spot;

use glam::Vec3;

pub use area::Area;
pub use directional::Directional;
pub use environment::{Environment, Radiance};
pub use point::Point;
pub use spot::Spot;

use super::Placement;

/// A named light.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// `name` of the file, or light1, light2, ...
    pub name: String,
    /// What it is.
    pub kind: LightKind,
}

/// The kinds of light, units of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum LightKind {
    /// `kind = "point"`.
    Point(Point),
    /// `kind = "spot"`.
    Spot(Spot),
    /// `kind = "directional"`.
    Directional(Directional),
    /// `kind = "area"`.
    Area(Area),
    /// `kind = "environment"`.
    Environment(Environment),
}

/// A light in placed units: what illuminates a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PlacedLight {
    Point(point::PlacedPoint),
    Spot(spot::PlacedSpot),
    Directional(directional::PlacedDirectional),
}

/// What one light sends to one point, before visibility and the cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LightSample {
    /// Unit direction from the point to the light.
    pub(crate) direction: Vec3,
    /// Distance to the light, placed units; infinite for directional light.
    pub(crate) distance: f32,
    /// Irradiance on a plane that faces the light, W/m2.
    pub(crate) irradiance: Vec3,
}

impl Light {
    /// The light in placed units, or `None` for a kind that is not rendered yet.
    pub(crate) fn place(&self, placement: &Placement) -> Option<PlacedLight> {
        match &self.kind {
            LightKind::Point(light) => Some(PlacedLight::Point(light.place(placement))),
            LightKind::Spot(light) => Some(PlacedLight::Spot(light.place(placement))),
            LightKind::Directional(light) => Some(PlacedLight::Directional(light.place())),
            LightKind::Area(_) | LightKind::Environment(_) => None,
        }
    }
}

impl PlacedLight {
    /// What arrives at `point` (placed units) if nothing is in the way.
    pub(crate) fn sample(&self, point: Vec3) -> LightSample {
        match self {
            Self::Point(light) => light.sample(point),
            Self::Spot(light) => light.sample(point),
            Self::Directional(light) => light.sample(),
        }
    }

    /// Whether the light has an edge of its own between the two points, such
    /// as the rim of a spot's cone: there a pixel takes more than one sample.
    pub(crate) fn edge_between(&self, a: Vec3, b: Vec3) -> bool {
        match self {
            Self::Spot(light) => light.edge_between(a, b),
            Self::Point(_) | Self::Directional(_) => false,
        }
    }
}
