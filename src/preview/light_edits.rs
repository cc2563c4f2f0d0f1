//! Edits of one light: where it is, where it looks, how wide it is; and new ones.

use glam::{DVec3, Vec3};

use super::colour::{digits, tidy as tidy_colour};
use super::document::{EditedLight, position, set_position};
use super::steps::{direction, nearest_axis, rotated, step, tidy};
use crate::maths::functions::exp2;
use crate::maths::order::Order;
use crate::scene::{
    Area, Camera, Directional, Environment, Light, LightKind, Point, Radiance, Spot,
};

/// Half angles of a cone that steps keep to, degrees.
const CUTOFFS_DEG: [f32; 2] = [1.0, 90.0];
/// Light that a new lamp gives, so that it shows: irradiance in half an extent, W/m2.
const NEW_IRRADIANCE: f64 = 4.0;
/// A new light stands so far before the target, extents.
const NEW_DISTANCE: f64 = 0.2;
/// Sides of a new rectangle, extents.
const NEW_SIDE: f64 = 0.2;

/// Which way a light or the camera goes, as the picture shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    Left,
    Right,
    Up,
    Down,
    Away,
    Closer,
}

/// Kinds that can be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NewKind {
    Point,
    Spot,
    Directional,
    Area,
    Environment,
}

impl Way {
    /// To the right, up and away: -1, 0 or 1 each.
    pub(crate) fn signs(self) -> [f64; 3] {
        match self {
            Self::Left => [-1.0, 0.0, 0.0],
            Self::Right => [1.0, 0.0, 0.0],
            Self::Up => [0.0, 1.0, 0.0],
            Self::Down => [0.0, -1.0, 0.0],
            Self::Away => [0.0, 0.0, 1.0],
            Self::Closer => [0.0, 0.0, -1.0],
        }
    }
}

/// Moves a light by steps along the world axis that is nearest to a way of the
/// picture. Light from infinitely far away turns instead.
pub(crate) fn nudge(kind: &mut LightKind, way: Way, steps: f64, camera: &Camera, extent: f64) {
    let [right, up, away] = way.signs().map(|sign| sign * steps);
    let Some(old) = position(kind) else {
        turn(kind, right, camera);
        return tilt(kind, up, camera);
    };
    let [x, y, z] = camera_axes(camera);
    let by = (x * right + y * up + z * away) * step(extent);
    place(kind, old + by, extent);
}

/// Moves a light to a place, with short coordinates.
pub(crate) fn place(kind: &mut LightKind, place: DVec3, extent: f64) {
    set_position(kind, place);
    match kind {
        LightKind::Point(light) => light.position = tidy(light.position, extent),
        LightKind::Spot(light) => light.position = tidy(light.position, extent),
        LightKind::Area(light) => light.corner = tidy(light.corner, extent),
        LightKind::Directional(_) | LightKind::Environment(_) => {}
    }
}

/// World axes nearest to the camera's right, up and forward; each another one.
fn camera_axes(camera: &Camera) -> [DVec3; 3] {
    let forward = (camera.target - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    let x = nearest_axis(right, DVec3::ZERO);
    let y = nearest_axis(right.cross(forward), x);
    [x, y, nearest_axis(forward, x + y)]
}

/// Turns where a light looks about the camera's up: by steps of 5 degrees, to the
/// right as seen from above for positive ones.
pub(crate) fn turn(kind: &mut LightKind, steps: f64, camera: &Camera) {
    let up = camera.up.normalize();
    look(kind, |axis| rotated(axis, up, -5.0 * steps));
    if let LightKind::Environment(light) = kind {
        let turned = f64::from(light.rotation_deg) + 5.0 * steps;
        light.rotation_deg = digits(turned.rem_euclid(360.0), 7) as f32 % 360.0;
    }
}

/// Tilts where a light looks: upward by steps of 5 degrees, as far as straight up
/// or down.
pub(crate) fn tilt(kind: &mut LightKind, steps: f64, camera: &Camera) {
    let up = camera.up.normalize();
    let right = (camera.target - camera.position).cross(up).normalize();
    let Some(axis) = axis(kind) else {
        return;
    };
    let side = axis.cross(up);
    // Straight up or down, the picture's right is as good as any.
    let side = if side.length() > 1e-6 {
        side.normalize()
    } else {
        right
    };
    let upward = crate::maths::functions::acos(axis.dot(up).clamp(-1.0, 1.0))
        * (180.0 / std::f64::consts::PI);
    let angle = (5.0 * steps).clamp(upward - 180.0, upward);
    look(kind, |vector| rotated(vector, side, angle));
}

/// Lets a light look at a point; parallel light travels the way the camera looks.
pub(crate) fn aim(kind: &mut LightKind, target: DVec3, camera: &Camera) {
    let from = position(kind).unwrap_or(camera.position);
    let wanted = (target - from).normalize_or_zero();
    let Some(old) = axis(kind).filter(|_| wanted != DVec3::ZERO) else {
        return;
    };
    let across = old.cross(wanted);
    let (sine, cosine) = (across.length(), old.dot(wanted));
    if sine < 1e-9 {
        if cosine < 0.0 {
            let side = old.any_orthonormal_vector();
            look(kind, |vector| rotated(vector, side, 180.0));
        }
        return;
    }
    let around = across / sine;
    // Of the rotation that takes one direction into the other.
    look(kind, |v| {
        v * cosine + around.cross(v) * sine + around * (around.dot(v) * (1.0 - cosine))
    });
}

/// Gives parallel light a direction of travel.
pub(crate) fn set_direction(kind: &mut LightKind, new: DVec3) {
    if let LightKind::Directional(light) = kind {
        light.direction = direction(new);
    }
}

/// Where a light looks, unit length.
fn axis(kind: &LightKind) -> Option<DVec3> {
    match kind {
        LightKind::Spot(light) => Some(light.direction.as_dvec3().normalize()),
        LightKind::Directional(light) => Some(light.direction.as_dvec3().normalize()),
        LightKind::Area(light) => Some(
            light
                .edge_u
                .normalize()
                .cross(light.edge_v.normalize())
                .normalize(),
        ),
        LightKind::Point(_) | LightKind::Environment(_) => None,
    }
}

/// Turns what a light has of directions, in place.
fn look(kind: &mut LightKind, turned: impl Fn(DVec3) -> DVec3) {
    match kind {
        LightKind::Spot(light) => light.direction = direction(turned(light.direction.as_dvec3())),
        LightKind::Directional(light) => {
            light.direction = direction(turned(light.direction.as_dvec3()));
        }
        LightKind::Area(light) => reshape(light, turned),
        LightKind::Point(_) | LightKind::Environment(_) => {}
    }
}

/// Changes the edges of a rectangle about its middle.
fn reshape(light: &mut Area, new: impl Fn(DVec3) -> DVec3) {
    let middle = light.corner + (light.edge_u + light.edge_v) * 0.5;
    let size = light.edge_u.length().at_least(light.edge_v.length());
    light.edge_u = tidy(new(light.edge_u), size);
    light.edge_v = tidy(new(light.edge_v), size);
    light.corner = tidy(middle - (light.edge_u + light.edge_v) * 0.5, size);
}

/// Opens the cone of a spot by steps of 2 degrees, or makes a rectangle larger.
/// `false` for lights that have neither.
pub(crate) fn open(kind: &mut LightKind, steps: f64) -> bool {
    match kind {
        LightKind::Spot(light) => {
            let [least, most] = CUTOFFS_DEG;
            let share = light.beam_deg / light.cutoff_deg;
            let wanted = digits(f64::from(light.cutoff_deg) + 2.0 * steps, 6) as f32;
            light.cutoff_deg = wanted.clamp(least.at_most(light.cutoff_deg), most);
            let beam = digits(f64::from(light.cutoff_deg * share), 6) as f32;
            light.beam_deg = beam.clamp(0.0, light.cutoff_deg);
            true
        }
        LightKind::Area(light) => {
            let factor = super::colour::factor(1.1, steps);
            reshape(light, |edge| edge * factor);
            true
        }
        _ => false,
    }
}

/// Opens the beam of a spot inside of its cone by steps of 2 degrees, or makes a
/// rectangle longer along its second edge. `false` for lights that have neither.
pub(crate) fn open_beam(kind: &mut LightKind, steps: f64) -> bool {
    match kind {
        LightKind::Spot(light) => {
            let wanted = digits(f64::from(light.beam_deg) + 2.0 * steps, 6) as f32;
            light.beam_deg = wanted.clamp(0.0, light.cutoff_deg);
            true
        }
        LightKind::Area(light) => {
            let (factor, second) = (super::colour::factor(1.1, steps), light.edge_v);
            reshape(
                light,
                |edge| if edge == second { edge * factor } else { edge },
            );
            true
        }
        _ => false,
    }
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

/// What of a light a message says after an edit of its place or shape.
pub(crate) fn described(kind: &LightKind) -> String {
    let vector = |v: DVec3| format!("{:.4} {:.4} {:.4}", v.x, v.y, v.z);
    let toward = |v: Vec3| format!("toward {:.3} {:.3} {:.3}", v.x, v.y, v.z);
    match kind {
        LightKind::Point(light) => format!("at {}", vector(light.position)),
        LightKind::Spot(light) => format!(
            "at {}, {}, cutoff {:.1}, beam {:.1}",
            vector(light.position),
            toward(light.direction),
            light.cutoff_deg,
            light.beam_deg
        ),
        LightKind::Directional(light) => toward(light.direction),
        LightKind::Area(light) => format!(
            "corner {}, {:.4} x {:.4}",
            vector(light.corner),
            light.edge_u.length(),
            light.edge_v.length()
        ),
        LightKind::Environment(light) => format!("rotation {:.1}", light.rotation_deg),
    }
}
