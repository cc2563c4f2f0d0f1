//! A bust: elliptic slices from base to crown, with features pushed out of
//! and into them.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use super::circle;
use crate::generator::body::Body;
use crate::generator::profile::{bell, spline};
use crate::generator::rings::between_poles;

const RINGS: usize = 96;
const AROUND: usize = 120;

/// Height, half width, half depth and shift to the front of the slices.
const SLICES: [[f64; 4]; 24] = [
    [0.0, 0.06, 0.05, 0.0],
    [0.0, 0.135, 0.115, 0.0],
    [0.012, 0.145, 0.125, 0.0],
    [0.05, 0.135, 0.115, 0.0],
    [0.085, 0.085, 0.075, 0.0],
    [0.13, 0.1, 0.085, 0.0],
    [0.19, 0.2, 0.13, 0.0],
    [0.27, 0.285, 0.15, 0.0],
    [0.36, 0.315, 0.15, 0.0],
    [0.425, 0.27, 0.13, -0.005],
    [0.465, 0.165, 0.105, -0.01],
    [0.5, 0.1, 0.088, -0.01],
    [0.545, 0.082, 0.083, -0.005],
    [0.585, 0.086, 0.09, 0.005],
    [0.615, 0.098, 0.118, 0.03],
    [0.65, 0.113, 0.135, 0.032],
    [0.69, 0.121, 0.146, 0.03],
    [0.735, 0.127, 0.154, 0.025],
    [0.785, 0.131, 0.16, 0.02],
    [0.835, 0.128, 0.156, 0.014],
    [0.88, 0.114, 0.138, 0.01],
    [0.915, 0.086, 0.102, 0.008],
    [0.935, 0.05, 0.06, 0.008],
    [0.941, 0.025, 0.03, 0.008],
];

/// A swelling: angle from the front and height of its centre, its widths, and
/// how far it pushes outward. Radians and metres.
struct Feature {
    angle: f64,
    height: f64,
    half_angle: f64,
    half_height: f64,
    push: f64,
}

const fn feature(angle: f64, height: f64, half_angle: f64, half_height: f64, push: f64) -> Feature {
    Feature {
        angle,
        height,
        half_angle,
        half_height,
        push,
    }
}

const FEATURES: [Feature; 16] = [
    // Nose, tip and bridge.
    feature(0.0, 0.698, 0.12, 0.016, 0.03),
    feature(0.0, 0.73, 0.09, 0.026, 0.018),
    // Brow, eye sockets and eyes.
    feature(0.0, 0.775, 0.5, 0.012, 0.01),
    feature(-0.33, 0.748, 0.16, 0.016, -0.017),
    feature(0.33, 0.748, 0.16, 0.016, -0.017),
    feature(-0.32, 0.747, 0.075, 0.008, 0.009),
    feature(0.32, 0.747, 0.075, 0.008, 0.009),
    // Lips and chin.
    feature(0.0, 0.664, 0.17, 0.006, 0.009),
    feature(0.0, 0.646, 0.14, 0.006, 0.008),
    feature(0.0, 0.655, 0.2, 0.003, -0.005),
    feature(0.0, 0.618, 0.2, 0.014, 0.012),
    // Cheekbones.
    feature(-0.65, 0.715, 0.2, 0.02, 0.006),
    feature(0.65, 0.715, 0.2, 0.02, 0.006),
    // Ears.
    feature(-1.6, 0.725, 0.11, 0.025, 0.018),
    feature(1.6, 0.725, 0.11, 0.025, 0.018),
    // Collar.
    feature(0.0, 0.42, 0.5, 0.03, 0.012),
];

/// The bust around the vertical axis, looking towards +z.
pub(super) fn body() -> Body {
    let slices: Vec<DVec4> = SLICES.iter().map(|&slice| slice.into()).collect();
    let rings: Vec<Vec<DVec3>> = spline(&slices, RINGS).into_iter().map(ring).collect();
    let poles = [DVec3::ZERO, DVec3::new(0.0, 0.943, 0.008)];
    between_poles("bust", "marble", poles, &rings)
}

fn ring(slice: DVec4) -> Vec<DVec3> {
    let [height, half_width, half_depth, shift] = slice.to_array();
    circle(AROUND)
        .map(|angle| {
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            let push = relief(angle, height);
            let across = half_width * sin + push * sin;
            let ahead = half_depth * cos + push * cos + shift;
            DVec3::new(across, height, ahead)
        })
        .collect()
}

/// How far the surface is pushed outward at an angle from the front.
fn relief(angle: f64, height: f64) -> f64 {
    let signed = if angle > PI { angle - 2.0 * PI } else { angle };
    let features: f64 = FEATURES
        .iter()
        .map(|f| {
            f.push
                * bell((signed - f.angle) / f.half_angle)
                * bell((height - f.height) / f.half_height)
        })
        .sum();
    features + hair(signed, height)
}

/// Waves of hair on the crown and the back of the head.
fn hair(angle: f64, height: f64) -> f64 {
    let hairline = 0.835 - 0.1 * (1.0 - bell(0.9 * (angle.abs() - 0.2).clamp(0.0, f64::INFINITY)));
    let cover = smooth_step((height - hairline) / 0.02) * smooth_step((0.93 - height) / 0.03);
    let waves = 0.004 * libm::sin(14.0 * angle + 5.0 * libm::sin(22.0 * height));
    cover * (0.008 + waves)
}

/// 0 below 0, 1 above 1, smooth between.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
