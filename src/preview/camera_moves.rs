//! Orbit, pan, dolly and walk: a camera as it is after a move.

use glam::{DVec2, DVec3};

use super::steps::{rotated, tidy};
use crate::scene::Camera;

/// Least angle between the view and up after an orbit, degrees.
const LEAST_ANGLE_DEG: f64 = 3.0;
/// Distances between eye and target that a dolly keeps to, extents.
const DISTANCES: [f64; 2] = [1e-3, 1e3];

/// Around the target: to the right and up, degrees.
pub(crate) fn orbit(camera: &Camera, [right_deg, up_deg]: [f64; 2], extent: f64) -> Camera {
    let up = camera.up.normalize();
    let offset = rotated(camera.position - camera.target, up, right_deg);
    let side = up.cross(offset).normalize();
    let upward = angle_deg(offset, up);
    let allowed = (upward - 180.0 + LEAST_ANGLE_DEG)..=(upward - LEAST_ANGLE_DEG);
    // A camera that looks along up already may only turn away from that.
    let tilt = if allowed.contains(&0.0) {
        up_deg.clamp(*allowed.start(), *allowed.end())
    } else {
        let back = if upward < 90.0 {
            -LEAST_ANGLE_DEG
        } else {
            LEAST_ANGLE_DEG
        };
        if (up_deg < 0.0) == (back < 0.0) {
            up_deg
        } else {
            0.0
        }
    };
    let offset = rotated(offset, side, -tilt);
    Camera {
        position: tidy(camera.target + offset, extent),
        ..*camera
    }
}

/// Angle between a vector and a unit vector, degrees.
fn angle_deg(vector: DVec3, unit: DVec3) -> f64 {
    let cosine = vector.normalize_or_zero().dot(unit).clamp(-1.0, 1.0);
    crate::maths::functions::acos(cosine) * (180.0 / std::f64::consts::PI)
}

/// Eye and target together, across the view: to the right and down, scene units.
pub(crate) fn pan(camera: &Camera, by: DVec2, extent: f64) -> Camera {
    let forward = (camera.target - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    moved(camera, right * by.x + forward.cross(right) * by.y, extent)
}

/// Eye and target together: to the right, up (of the world) and forward (level
/// with the ground), scene units.
pub(crate) fn walk(camera: &Camera, [right, up, forward]: [f64; 3], extent: f64) -> Camera {
    let view = (camera.target - camera.position).normalize();
    let above = camera.up.normalize();
    let side = view.cross(above).normalize();
    let ahead = above.cross(side);
    moved(camera, side * right + above * up + ahead * forward, extent)
}

/// The eye toward the target (a factor below 1) or away from it.
pub(crate) fn dolly(camera: &Camera, factor: f64, extent: f64) -> Camera {
    let offset = camera.position - camera.target;
    let distance = offset.length();
    let [least, most] = DISTANCES.map(|share| share * extent);
    let wanted = if factor < 1.0 {
        crate::maths::order::Order::at_least(distance * factor, least)
    } else {
        crate::maths::order::Order::at_most(distance * factor, most)
    };
    let is_beyond = (factor < 1.0) == (wanted > distance);
    if is_beyond {
        return *camera;
    }
    Camera {
        position: tidy(camera.target + offset * (wanted / distance), extent),
        ..*camera
    }
}

/// The eye turned so that a point is in the middle.
pub(crate) fn look_at(camera: &Camera, target: DVec3, extent: f64) -> Camera {
    Camera {
        target: tidy(target, extent),
        ..*camera
    }
}

fn moved(camera: &Camera, by: DVec3, extent: f64) -> Camera {
    Camera {
        position: tidy(camera.position + by, extent),
        target: tidy(camera.target + by, extent),
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::sample_view;
    use super::*;

    #[test]
    fn an_orbit_keeps_its_distance_and_stops_at_the_poles() {
        let (_, camera) = sample_view();
        let right = orbit(&camera, [90.0, 0.0], 2.0);
        assert_eq!(right.position, DVec3::new(6.8, 1.0, 0.0));
        let above = orbit(&camera, [0.0, 30.0], 2.0);
        assert!(
            above.position.y > 4.0 && above.position.z > 5.0,
            "{above:?}"
        );
        let pole = orbit(&camera, [0.0, 500.0], 2.0);
        let again = orbit(&pole, [0.0, 500.0], 2.0);
        let angle = angle_deg(again.position - again.target, DVec3::Y);
        assert!((angle - LEAST_ANGLE_DEG).abs() < 1e-3, "{angle}");
        let down = orbit(&pole, [0.0, -10.0], 2.0);
        assert!(angle_deg(down.position - down.target, DVec3::Y) > 12.0);
    }

    #[test]
    fn walking_is_level_and_a_dolly_stops_before_the_target() {
        let (_, camera) = sample_view();
        let tilted = orbit(&camera, [0.0, 40.0], 2.0);
        let walked = walk(&tilted, [0.0, 0.0, 1.0], 2.0);
        assert_eq!(walked.position.y, tilted.position.y);
        assert!((walked.position.z - tilted.position.z + 1.0).abs() < 1e-6);
        let near = dolly(&camera, 1e-9, 2.0);
        assert_eq!(near.position.z, 2e-3);
        assert_eq!(dolly(&near, 0.5, 2.0), near);
        assert!(dolly(&near, 2.0, 2.0).position.z > near.position.z);
        let panned = pan(&camera, DVec2::new(0.5, 0.25), 2.0);
        assert_eq!(panned.target, DVec3::new(0.5, 0.75, 0.0));
    }
}
