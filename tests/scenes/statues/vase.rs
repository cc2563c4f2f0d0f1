//! A vase with spiral flutes, turned on a lathe, hollow inside.

use glam::{DVec3, DVec4};

use super::circle;
use crate::generator::body::Body;
use crate::generator::profile::{bell, spline};
use crate::generator::rings::between_poles;

const RINGS: usize = 80;
const AROUND: usize = 144;
/// Number of flutes, their depth as a share of the radius, and their turn over
/// one metre of height, radians.
const FLUTES: f64 = 12.0;
const FLUTE_DEPTH: f64 = 0.075;
const FLUTE_TURN: f64 = 1.3;

/// Radius, height and share of the flutes along the outside, over the lip and
/// down the inside.
const PROFILE: [[f64; 3]; 22] = [
    [0.06, 0.0, 0.0],
    [0.15, 0.0, 0.0],
    [0.16, 0.012, 0.0],
    [0.15, 0.05, 0.0],
    [0.105, 0.1, 0.1],
    [0.12, 0.17, 0.5],
    [0.19, 0.28, 1.0],
    [0.255, 0.42, 1.0],
    [0.275, 0.54, 1.0],
    [0.25, 0.66, 1.0],
    [0.18, 0.77, 0.7],
    [0.115, 0.85, 0.2],
    [0.105, 0.92, 0.0],
    [0.14, 0.99, 0.0],
    [0.165, 1.01, 0.0],
    [0.16, 1.022, 0.0],
    [0.13, 1.0, 0.0],
    [0.085, 0.92, 0.0],
    [0.09, 0.84, 0.0],
    [0.2, 0.65, 0.0],
    [0.2, 0.45, 0.0],
    [0.06, 0.22, 0.0],
];

/// The vase around the vertical axis.
pub(super) fn body() -> Body {
    turned_on_a_lathe("vase", "marble", [RINGS, AROUND])
}

/// A vase of so many rings and points around.
pub(crate) fn turned_on_a_lathe(
    name: &'static str,
    material: &'static str,
    [rings, around]: [usize; 2],
) -> Body {
    let points: Vec<DVec4> = PROFILE
        .iter()
        .map(|&[radius, height, flutes]| DVec4::new(radius, height, flutes, 0.0))
        .collect();
    let rings: Vec<Vec<DVec3>> = spline(&points, rings)
        .into_iter()
        .map(|point| ring(point, around))
        .collect();
    let poles = [DVec3::ZERO, DVec3::new(0.0, 0.21, 0.0)];
    between_poles(name, material, poles, &rings)
}

fn ring(point: DVec4, around: usize) -> Vec<DVec3> {
    let (radius, height, flutes) = (point.x, point.y, point.z);
    circle(around)
        .map(|angle| {
            let across = libm::sin(0.5 * FLUTES * (angle + FLUTE_TURN * height));
            // Narrow ridges between wide hollows.
            let ridge = bell(2.2 * across) - 0.4;
            let radius = radius * (1.0 + FLUTE_DEPTH * flutes.clamp(0.0, f64::INFINITY) * ridge);
            DVec3::new(radius * libm::sin(angle), height, radius * libm::cos(angle))
        })
        .collect()
}
