//! A trefoil knot of a twisted, four-lobed tube.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::circle;
use crate::generator::body::Body;
use crate::generator::rings::tube;

/// Points along the knot and around the tube.
const ALONG: usize = 288;
const AROUND: usize = 40;
/// Radii of the torus that carries the knot, and of the tube, metres.
const MAJOR: f64 = 0.32;
const MINOR: f64 = 0.135;
const TUBE: f64 = 0.075;
/// Depth of the lobes as a share of the tube's radius, and the quarter turns
/// that they make along the knot.
const LOBE_DEPTH: f64 = 0.16;
const QUARTER_TURNS: f64 = 14.0;

/// The knot, upright in the plane z = 0.
pub(super) fn body() -> Body {
    let rings: Vec<Vec<DVec3>> = circle(ALONG).map(ring).collect();
    tube("knot", "ochre", &rings)
}

/// Cross-section at parameter t of the knot.
fn ring(t: f64) -> Vec<DVec3> {
    let frame = Frame::at(t);
    circle(AROUND)
        .map(|angle| {
            let lobe = libm::cos(4.0 * angle + QUARTER_TURNS * t);
            let radius = TUBE * (1.0 + LOBE_DEPTH * lobe);
            frame.center
                + (frame.outward * libm::cos(angle) + frame.aside * libm::sin(angle)) * radius
        })
        .collect()
}

/// A point of the knot with two unit vectors across it;
/// outward x aside = forward.
struct Frame {
    center: DVec3,
    outward: DVec3,
    aside: DVec3,
}

impl Frame {
    /// The knot winds twice around the axis of the torus and three times
    /// around its tube. `outward` is the normal of the torus, so the frame
    /// closes by itself.
    fn at(t: f64) -> Self {
        let (around, inner) = (2.0 * t + FRAC_PI_2, 3.0 * t);
        let radial = DVec3::new(libm::cos(around), libm::sin(around), 0.0);
        let onward = DVec3::new(-radial.y, radial.x, 0.0);
        let (sin, cos) = (libm::sin(inner), libm::cos(inner));
        let outward = radial * cos + DVec3::Z * sin;
        let climb = DVec3::Z * cos - radial * sin;
        let forward = onward * (2.0 * (MAJOR + MINOR * cos)) + climb * (3.0 * MINOR);
        Self {
            center: radial * MAJOR + outward * MINOR,
            outward,
            aside: forward.normalize().cross(outward),
        }
    }
}
