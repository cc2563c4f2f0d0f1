//! Edits of one light: where it is, where it looks, how wide it is.

use glam::{DVec3, Vec3};

use super::colour::digits;
use super::document::{position, set_position};
use super::steps::{direction, nearest_axis, rotated, step, tidy};
use crate::maths::order::Order;
use crate::scene::{Area, Camera, LightKind};

/// Half angles of a cone that steps keep to, degrees.
const CUTOFFS_DEG: [f32; 2] = [1.0, 90.0];
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
    if let LightKind::Directional(light) = kind {
        // The sun goes where its mark is to go: it stands before or beyond the target.
        let view = camera.target - camera.position;
        let is_before = light.direction.as_dvec3().dot(view) > 0.0;
        turn(kind, if is_before { -right } else { right }, camera);
        return tilt(kind, -up, camera);
    }
    let Some(old) = position(kind) else {
        return turn(kind, right, camera);
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
        // What the rotation adds to u moves the map to the left.
        let turned = f64::from(light.rotation_deg) - 5.0 * steps;
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

#[cfg(test)]
mod tests {
    use super::super::marks::arrow_start;
    use super::super::new_lights::{NewKind, new_light};
    use super::super::view::sample_view;
    use super::*;
    use crate::scene::Directional;

    fn seen(light: &LightKind) -> glam::DVec2 {
        let (view, camera) = sample_view();
        let LightKind::Directional(light) = light else {
            panic!("{light:?} is no sun")
        };
        view.eye(&camera).project(arrow_start(light, &camera)).px
    }

    #[test]
    fn a_sun_goes_where_its_arrow_says_before_and_beyond_the_target() {
        let (_, camera) = sample_view();
        for z in [-0.5, 0.5] {
            let mut sun = LightKind::Directional(Directional {
                direction: direction(DVec3::new(0.1, -1.0, z)),
                irradiance: Vec3::ONE,
            });
            for (way, moves) in [
                (Way::Right, [1.0, 0.0]),
                (Way::Left, [-1.0, 0.0]),
                (Way::Up, [0.0, -1.0]),
                (Way::Down, [0.0, 1.0]),
            ] {
                let before = seen(&sun);
                nudge(&mut sun, way, 1.0, &camera, 2.0);
                let by = seen(&sun) - before;
                assert!(by.dot(moves.into()) > 0.0, "{z} {way:?}: {by}");
            }
        }
    }

    #[test]
    fn a_spot_and_a_rectangle_look_at_what_they_are_aimed_at() {
        let (_, camera) = sample_view();
        let target = DVec3::new(0.3, 0.2, -0.4);
        for kind in [NewKind::Spot, NewKind::Area] {
            let mut light = new_light(kind, "x".to_owned(), &camera, 2.0, 0.0).kind;
            let from = position(&light).unwrap();
            turn(&mut light, 7.0, &camera);
            tilt(&mut light, 30.0, &camera);
            let up = axis(&light).unwrap();
            assert!(
                (up - DVec3::Y).length() < 1e-5,
                "no further than straight up: {up}"
            );
            aim(&mut light, target, &camera);
            let looks = axis(&light).unwrap();
            assert!(
                looks.dot((target - from).normalize()) > 1.0 - 1e-9,
                "{kind:?}"
            );
            assert!((position(&light).unwrap() - from).length() < 1e-6);
        }
    }

    #[test]
    fn cones_stay_cones() {
        let (_, camera) = sample_view();
        let mut light = new_light(NewKind::Spot, "x".to_owned(), &camera, 2.0, 0.0).kind;
        open(&mut light, -100.0);
        open_beam(&mut light, 100.0);
        let LightKind::Spot(spot) = light else {
            panic!()
        };
        assert_eq!([spot.cutoff_deg, spot.beam_deg], [1.0, 1.0]);
    }
}
