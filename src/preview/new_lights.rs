//! Lights that are added: what they are at first, and what they are called.

use glam::DVec3;

use super::colour::{digits, tidy as tidy_colour};
use super::document::EditedLight;
use super::steps::{direction, tidy};
use crate::maths::functions::exp2;
use crate::maths::order::Order;
use crate::scene::{
    Area, Camera, Directional, Environment, Light, LightKind, Point, Radiance, Spot,
};

/// Light that a new lamp gives, so that it shows: irradiance in half an extent, W/m2.
const NEW_IRRADIANCE: f64 = 4.0;
/// A new light stands so far before the target, extents.
const NEW_DISTANCE: f64 = 0.2;
/// Sides of a new rectangle, extents.
const NEW_SIDE: f64 = 0.2;

/// Kinds that can be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NewKind {
    Point,
    Spot,
    Directional,
    Area,
    Environment,
}

/// A light where the camera looks, so bright that it shows at this exposure.
pub(crate) fn new_light(
    kind: NewKind,
    name: String,
    camera: &Camera,
    extent: f64,
    exposure: f32,
) -> Light {
    let view = camera.target - camera.position;
    let forward = view.normalize();
    let right = forward.cross(camera.up).normalize();
    let down = forward.cross(right);
    let reach = view.length().at_most(extent) * NEW_DISTANCE;
    let place = tidy(camera.target - forward * reach, extent);
    let irradiance = NEW_IRRADIANCE * exp2(-f64::from(exposure));
    let grey = |value: f64| {
        let bounded = value.at_most(1e29).at_least(1e-30);
        tidy_colour(DVec3::splat(digits(bounded, 3)))
    };
    let intensity = grey(irradiance * 0.25 * extent * extent);
    let side = extent * NEW_SIDE;
    let kind = match kind {
        NewKind::Point => LightKind::Point(Point {
            position: place,
            intensity,
        }),
        NewKind::Spot => LightKind::Spot(Spot {
            position: place,
            direction: direction(forward),
            intensity,
            cutoff_deg: 30.0,
            beam_deg: 22.5,
        }),
        NewKind::Directional => LightKind::Directional(Directional {
            direction: direction(forward + down),
            irradiance: grey(irradiance),
        }),
        NewKind::Area => {
            // Looks the way the camera does.
            let (edge_u, edge_v) = (tidy(right * side, extent), tidy(down * side, extent));
            LightKind::Area(Area {
                corner: tidy(place - (edge_u + edge_v) * 0.5, extent),
                edge_u,
                edge_v,
                radiance: grey(irradiance * 0.25 / (NEW_SIDE * NEW_SIDE)),
            })
        }
        NewKind::Environment => LightKind::Environment(Environment {
            radiance: Radiance::Constant(grey(irradiance * 0.25)),
            scale: 1.0,
            rotation_deg: 0.0,
        }),
    };
    Light { name, kind }
}

impl NewKind {
    /// The name that a light of the kind begins with.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Directional => "sun",
            Self::Area => "panel",
            Self::Environment => "sky",
        }
    }
}

/// The name, or the name with the first number behind it that no light has.
pub(crate) fn free_name(wanted: &str, lights: &[EditedLight]) -> String {
    let is_free = |name: &str| lights.iter().all(|it| it.light.name != name);
    let stem = match wanted.rsplit_once(' ') {
        Some((stem, number)) if number.parse::<u32>().is_ok() && !stem.is_empty() => stem,
        _ => wanted,
    };
    if is_free(wanted) {
        return wanted.to_owned();
    }
    let mut number = 2_u64;
    loop {
        let name = format!("{stem} {number}");
        if is_free(&name) {
            return name;
        }
        number += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::sample_view;
    use super::*;

    #[test]
    fn names_are_free() {
        let light = |name: &str| {
            let (_, camera) = sample_view();
            EditedLight::new(new_light(
                NewKind::Point,
                name.to_owned(),
                &camera,
                1.0,
                0.0,
            ))
        };
        let lights = ["lamp", "lamp 2", "7"].map(light);
        assert_eq!(free_name("lamp", &lights), "lamp 3");
        assert_eq!(free_name("lamp 2", &lights), "lamp 3");
        assert_eq!(free_name("7", &lights), "7 2");
        assert_eq!(free_name("new", &lights), "new");
    }
}
