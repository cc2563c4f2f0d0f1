//! Lights. One file a kind: the keys it has, and the irradiance it gives.
//! A new kind is one file here, one line in each table below and in
//! [`placed`], which says what of it lights, stands in the way and is seen.

mod area;
mod directional;
mod emitters;
mod environment;
mod placed;
mod point;
mod polygon;
mod spot;
mod sun;

use std::sync::Arc;

use glam::Vec3;

pub use area::Area;
pub(crate) use area::PlacedRectangle;
pub use directional::Directional;
pub(crate) use emitters::{Emitters, LightCut};
pub(crate) use environment::PlacedEnvironment;
pub use environment::{Environment, Radiance};
pub(crate) use placed::PlacedLights;
pub use point::Point;
pub(crate) use polygon::Polygon;
pub(in crate::scene) use spot::DEFAULT_CUTOFF_DEG;
pub use spot::Spot;
pub(crate) use sun::PlacedSun;

use super::SceneError;
use super::file::fields::Fields;
use super::images::Sources;
use crate::maths::order::Order;

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
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PlacedLight {
    Point(point::PlacedPoint),
    Spot(spot::PlacedSpot),
    Directional(directional::PlacedDirectional),
    /// Surfaces that emit: one rectangle, or all emitting triangles of the mesh.
    Surfaces(Arc<Emitters>),
    /// The sun of an environment map.
    Sun(sun::PlacedSun),
}

/// What a light would send to a point on a plane if nothing were in the way.
pub(crate) enum Incident<'a> {
    /// From one direction: one shadow ray tells all.
    Sharp {
        /// Irradiance on the plane, W/m2.
        open: Vec3,
        sample: LightSample,
    },
    /// From surfaces that emit.
    Surfaces {
        emitters: &'a Emitters,
        cut: LightCut,
    },
    /// From a disc of the sky.
    Disc {
        /// Irradiance on the plane, W/m2.
        open: Vec3,
        sun: sun::PlacedSun,
    },
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

    /// What arrives at a point (placed units) on a plane of unit `normal` if
    /// nothing is in the way.
    pub(crate) fn incident(&self, point: Vec3, normal: Vec3) -> Incident<'_> {
        let sample = match self {
            Self::Point(light) => light.sample(point),
            Self::Spot(light) => light.sample(point),
            Self::Directional(light) => light.sample(),
            Self::Surfaces(emitters) => {
                return Incident::Surfaces {
                    emitters,
                    cut: emitters.cut(point, normal),
                };
            }
            Self::Sun(sun) => {
                return Incident::Disc {
                    open: sun.unoccluded(normal),
                    sun: *sun,
                };
            }
        };
        Incident::Sharp {
            open: sample.irradiance_on(normal),
            sample,
        }
    }

    /// Whether each point is lit from one direction.
    pub(crate) fn is_sharp(&self) -> bool {
        !matches!(self, Self::Surfaces(_) | Self::Sun(_))
    }

    /// Where the light is, placed units, if it is a point there.
    pub(crate) fn place(&self) -> Option<Vec3> {
        match self {
            Self::Point(light) => Some(light.position),
            Self::Spot(light) => Some(light.source.position),
            Self::Directional(_) | Self::Surfaces(_) | Self::Sun(_) => None,
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
            Self::Point(_) | Self::Directional(_) | Self::Surfaces(_) | Self::Sun(_) => false,
        }
    }
}

impl LightSample {
    /// The way to the same point of the light from another point close by; what
    /// it brings stays as it was. (With the same direction and distance, rays
    /// from points nearer to a lamp of the mesh would end behind it.)
    pub(crate) fn seen_from(&self, from: Vec3, point: Vec3) -> Self {
        if from == point || self.distance == f32::INFINITY {
            return *self;
        }
        let to_light = from + self.direction * self.distance - point;
        let distance = to_light.length();
        Self {
            direction: to_light / distance.at_least(f32::MIN_POSITIVE),
            distance,
            irradiance: self.irradiance,
        }
    }

    /// Irradiance on a plane of unit `normal`, W/m2: zero from behind it.
    pub(crate) fn irradiance_on(&self, normal: Vec3) -> Vec3 {
        let cosine = self.direction.dot(normal);
        if cosine > 0.0 {
            self.irradiance * cosine
        } else {
            Vec3::ZERO
        }
    }
}

impl Incident<'_> {
    /// Irradiance on the plane if nothing is in the way, W/m2.
    pub(crate) fn open(&self) -> Vec3 {
        match self {
            Self::Sharp { open, .. } | Self::Disc { open, .. } => *open,
            Self::Surfaces { cut, .. } => cut.open(),
        }
    }

    /// Whether all of it comes from one direction, so that every
    /// [`Self::sample`] is the same.
    pub(crate) fn is_sharp(&self) -> bool {
        matches!(self, Self::Sharp { .. })
    }

    /// One direction that light comes from, for two uniforms. The mean of
    /// [`LightSample::irradiance_on`] the plane over them is [`Self::open`].
    /// `None` where the direction gives nothing.
    pub(crate) fn sample(&self, u: [f32; 2]) -> Option<LightSample> {
        match self {
            Self::Sharp { sample, .. } => Some(*sample),
            Self::Surfaces { emitters, cut } => cut.sample(emitters, u),
            Self::Disc { sun, .. } => Some(sun.sample(u)),
        }
    }
}
