//! Lambert's formula: the form factor from a point to a polygon as a sum over
//! the polygon's edges (Lambert, "Photometria", 1760; in the form of Schröder
//! and Hanrahan, "On the Form Factor between Two Polygons", SIGGRAPH 1993,
//! equation 3; Arvo, "Analytic Methods for Simulated Light Transport", 1995).
//!
//! E / (pi L) = 1/(2 pi) sum over edges of angle x (unit normal of the plane
//! through the point and the edge) . n, for a polygon above the horizon of n;
//! what is below is cut off first.

use crate::maths::order::Order;
use glam::DVec3;

/// A quadrilateral cut by one plane has at most five corners.
pub(super) const MOST_CORNERS: usize = 5;

/// Coefficients 1 to 10 of the powers of u = t^2 in atan(t)/t on 0 <= t <= 1;
/// coefficient 0 is 1. Interpolates at Chebyshev nodes; error below 1.4e-9,
/// and towards 0 for small angles, where the sum over edges cancels. One term
/// less is six times worse, one more gains nothing that single precision shows.
const ATAN: [f64; 10] = [
    -0.333_333_330_810_732_5,
    0.199_999_493_211_418_88,
    -0.142_840_037_947_335_3,
    0.110_882_616_287_351_59,
    -0.089_318_267_773_813_15,
    0.070_319_142_500_299_66,
    -0.048_960_514_027_090_66,
    0.026_305_001_110_062_374,
    -0.009_144_629_760_592_394,
    0.001_488_691_939_304_759_3,
];

/// Form factor from the origin, with unit normal `n`, to a polygon whose
/// corners run counter-clockwise seen from the origin; 0 to 1.
pub(super) fn form_factor<const N: usize>(corners: [DVec3; N], n: DVec3) -> f64 {
    let heights = corners.map(|corner| n.dot(corner));
    let above = heights.iter().filter(|&&height| height > 0.0).count();
    let sum = if above == N {
        edge_sum(&corners, n)
    } else if above == 0 {
        0.0
    } else {
        let (clipped, count) = above_horizon(&corners, &heights);
        edge_sum(&clipped[..count], n)
    };
    let factor = sum * (-0.5 / std::f64::consts::PI);
    if factor > 0.0 {
        factor.at_most(1.0)
    } else {
        0.0
    }
}

/// The part of a convex polygon with positive heights, and its corner count
/// (Sutherland and Hodgman, "Reentrant Polygon Clipping", CACM 1974).
pub(super) fn above_horizon(corners: &[DVec3], heights: &[f64]) -> ([DVec3; MOST_CORNERS], usize) {
    let mut clipped = [DVec3::ZERO; MOST_CORNERS];
    let mut count = 0;
    let mut keep = |corner: DVec3| {
        if count < MOST_CORNERS {
            clipped[count] = corner;
            count += 1;
        }
    };
    for (index, (&corner, &height)) in corners.iter().zip(heights).enumerate() {
        let next = (index + 1) % corners.len();
        if height > 0.0 {
            keep(corner);
        }
        if (height > 0.0) != (heights[next] > 0.0) {
            let share = height / (height - heights[next]);
            keep(corner + (corners[next] - corner) * share);
        }
    }
    (clipped, count)
}

/// Sum over the edges of angle x (unit normal of the edge's plane) . n.
fn edge_sum(corners: &[DVec3], n: DVec3) -> f64 {
    let mut sum = 0.0;
    let mut from = corners[corners.len() - 1];
    for &to in corners {
        // The edge instead of its end: no cancellation when it is short.
        let cross = from.cross(to - from);
        sum += n.dot(cross) * angle_over_sine(cross.length_squared(), from.dot(to));
        from = to;
    }
    sum
}

/// Angle between two vectors over the length of their cross product, from that
/// length's square and their dot product; 0 where the length is 0 with the
/// origin on the line between them.
fn angle_over_sine(squared_cross: f64, dot: f64) -> f64 {
    let lengths = (squared_cross + dot * dot).sqrt();
    // tan(angle/2) = |cross| / (lengths + dot), of the angle or its supplement.
    let inverse = 1.0 / (lengths + dot.abs());
    let squared_tangent = squared_cross * inverse * inverse;
    if dot > 0.0 {
        return 2.0 * inverse * atan_over_tangent(squared_tangent);
    }
    if squared_cross == 0.0 {
        return 0.0;
    }
    let sine = squared_cross.sqrt();
    (std::f64::consts::PI - 2.0 * sine * inverse * atan_over_tangent(squared_tangent)) / sine
}

/// atan(t)/t for u = t^2 in 0 to 1, by Estrin's scheme: half the latency of Horner's.
fn atan_over_tangent(u: f64) -> f64 {
    let u2 = u * u;
    let u4 = u2 * u2;
    let pair = |low: usize| ATAN[low] + ATAN[low + 1] * u;
    let low = pair(0) + pair(2) * u2;
    let high = pair(4) + pair(6) * u2;
    1.0 + u * (low + u4 * (high + u4 * pair(8)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::functions::{acos, sin};

    #[test]
    fn angles_are_those_of_the_library() {
        /// The polynomial's error, relative to the angle, and that of `acos`.
        const ERROR: f64 = 3e-9;
        for step in 1..1000 {
            let cosine = 1.0 - f64::from(step) / 500.0;
            let angle = acos(cosine);
            let sine = sin(angle);
            let ratio = angle_over_sine(sine * sine, cosine) * sine / angle;
            assert!((ratio - 1.0).abs() < ERROR, "{angle}: {ratio}");
        }
    }

    #[test]
    fn angles_without_a_sine_are_finite() {
        assert_eq!(angle_over_sine(0.0, 4.0), 0.25);
        assert_eq!(angle_over_sine(0.0, -4.0), 0.0);
        assert_eq!(angle_over_sine(0.0, 0.0), 0.0);
    }
}
