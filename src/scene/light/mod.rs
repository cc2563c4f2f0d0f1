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

use super::file::fields::Fields;
use super::images::Sources;
use super::{Placement, SceneError};

/// How a kind is read from its table and the files that it names.
type Reader = fn(&mut Fields, &Sources<'_>) -> Result<LightKind, SceneError>;

/// The kinds of the scene file: name, keys besides `name` and `kind`, reader.
const KINDS: [(&str, (&[&str], Reader)); 5] = [
    (
        "point",
        (point::KEYS, |fields, _| {
            Point::read(fields).map(LightKind::Point)
        }),
    ),
    (
        "spot",
        (spot::KEYS, |fields, _| {
            Spot::read(fields).map(LightKind::Spot)
        }),
    ),
    (
        "directional",
        (directional::KEYS, |fields, _| {
            Directional::read(fields).map(LightKind::Directional)
        }),
    ),
    (
        "area",
        (area::KEYS, |fields, _| {
            Area::read(fields).map(LightKind::Area)
        }),
    ),
    (
        "environment",
        (environment::KEYS, |fields, sources| {
            Environment::read(fields, sources).map(LightKind::Environment)
        }),
    ),
];

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
    /// Reads a light whose `name` has been taken from the table already.
    pub(super) fn read(
        name: String,
        mut fields: Fields,
        sources: &Sources<'_>,
    ) -> Result<Self, SceneError> {
        fields.rename(format!("light {name:?}"));
        let kind_item = fields.require("kind", "point, spot, directional, area or environment")?;
        let (keys, read) = kind_item.choice(&KINDS)?;
        let kind_name = kind_item.string()?;
        if kind_item.place().is_override() {
            // Then the keys in the file are right, and the kind is at fault.
            let place = kind_item.place();
            fields.rename(format!("light {name:?} ({kind_name}, by {place})"));
            fields.move_to(place.clone());
        } else {
            fields.rename(format!("light {name:?} ({kind_name})"));
        }
        let allowed: Vec<&str> = ["name", "kind"].iter().chain(keys).copied().collect();
        fields.allow(&allowed)?;
        Ok(Self {
            name,
            kind: read(&mut fields, sources)?,
        })
    }

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
    /// A point light of unit intensity (W/sr in placed units) at a placed position.
    pub(crate) fn unit_point(position: Vec3) -> Self {
        Self::Point(point::PlacedPoint {
            position,
            intensity: Vec3::ONE,
        })
    }

    /// A spot of unit intensity at a placed position, full inside half its
    /// half angle.
    pub(crate) fn unit_spot(position: Vec3, axis: Vec3, cutoff_deg: f32) -> Self {
        Self::Spot(spot::PlacedSpot::unit(position, axis, cutoff_deg))
    }

    /// A directional light of unit irradiance; `direction` of travel is a unit vector.
    pub(crate) fn unit_directional(direction: Vec3) -> Self {
        Self::Directional(
            Directional {
                direction,
                irradiance: Vec3::ONE,
            }
            .place(),
        )
    }

    /// What arrives at `point` (placed units) if nothing is in the way.
    pub(crate) fn sample(&self, point: Vec3) -> LightSample {
        match self {
            Self::Point(light) => light.sample(point),
            Self::Spot(light) => light.sample(point),
            Self::Directional(light) => light.sample(),
        }
    }

    /// Whether the light has edges of its own; see [`Self::edge_between`].
    pub(crate) fn has_edges(&self) -> bool {
        matches!(self, Self::Spot(_))
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
