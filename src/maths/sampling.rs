//! Warps from the unit square and cube to directions and surface points.

use glam::Vec3;

use super::functions::{cos_f32, sin_f32};
use crate::maths::order::Order;

/// Two unit vectors that form a right-handed frame with the unit normal
/// (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017).
pub(crate) fn tangents(normal: Vec3) -> (Vec3, Vec3) {
    let sign = if normal.z < 0.0 { -1.0_f32 } else { 1.0 };
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    (
        Vec3::new(
            1.0 + sign * normal.x * normal.x * a,
            sign * b,
            -sign * normal.x,
        ),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    )
}

/// Direction about `normal` with density cos/pi (1/sr), from two uniforms
/// (Malley's method: a uniform point of the disk, lifted to the hemisphere).
pub(crate) fn cosine_direction(normal: Vec3, u: [f32; 2]) -> Vec3 {
    let radius = u[0].sqrt();
    let angle = std::f32::consts::TAU * u[1];
    let height = (1.0 - u[0]).at_least(0.0).sqrt();
    let (t, b) = tangents(normal);
    t * (radius * cos_f32(angle)) + b * (radius * sin_f32(angle)) + normal * height
}

/// Direction uniform over the cone of directions about a unit axis whose angle
/// has a cosine of at least `cos_radius`, from two uniforms.
pub(crate) fn cone_direction(axis: Vec3, cos_radius: f32, u: [f32; 2]) -> Vec3 {
    let height = 1.0 - u[0] * (1.0 - cos_radius);
    let radius = (1.0 - height * height).at_least(0.0).sqrt();
    let angle = std::f32::consts::TAU * u[1];
    let (t, b) = tangents(axis);
    t * (radius * cos_f32(angle)) + b * (radius * sin_f32(angle)) + axis * height
}

/// Direction uniform over the sphere, from two uniforms.
pub(crate) fn sphere_direction(u: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u[0];
    let radius = (1.0 - z * z).at_least(0.0).sqrt();
    let angle = std::f32::consts::TAU * u[1];
    Vec3::new(radius * cos_f32(angle), radius * sin_f32(angle), z)
}

/// Mirrors a direction at the plane of a unit normal if it points below it.
///
/// About a tilted shading normal some directions lead through the flat
/// triangle; nothing arrives from there. Mirrored, they keep the energy: a
/// row of the transfer still sums to 1, a path goes on.
pub(crate) fn mirrored_above(direction: Vec3, flat_normal: Vec3) -> Vec3 {
    let height = direction.dot(flat_normal);
    if height < 0.0 {
        direction - flat_normal * (2.0 * height)
    } else {
        direction
    }
}

/// Density (1/sr) of directions drawn by [`cosine_direction`] about `normal` and
/// then [`mirrored_above`] the plane of `flat_normal`, both unit vectors.
pub(crate) fn mirrored_cosine_density(normal: Vec3, flat_normal: Vec3, direction: Vec3) -> f32 {
    let height = direction.dot(flat_normal);
    if height <= 0.0 {
        return 0.0;
    }
    let mirrored = direction - flat_normal * (2.0 * height);
    let cosine = |d: Vec3| {
        let c = d.dot(normal);
        if c > 0.0 { c } else { 0.0 }
    };
    (cosine(direction) + cosine(mirrored)) * std::f32::consts::FRAC_1_PI
}

/// Index of the interval of a running sum that holds `u` x total.
pub(crate) fn pick(cumulative: &[f32], u: f32) -> usize {
    let total = cumulative.last().copied().unwrap_or(0.0);
    cumulative
        .partition_point(|&c| c <= u * total)
        .min(cumulative.len().saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::sobol::ScrambledSobol;

    #[test]
    fn tangents_are_orthonormal() {
        for v in [
            Vec3::Z,
            -Vec3::Z,
            Vec3::X,
            Vec3::new(0.6, 0.0, -0.8),
            Vec3::new(-0.36, 0.48, 0.8),
        ] {
            let (t, b) = tangents(v);
            assert!(
                t.dot(b).abs() < 1e-6 && t.dot(v).abs() < 1e-6 && (t.cross(b) - v).length() < 1e-6
            );
        }
    }

    #[test]
    fn cosine_directions_have_mean_height_two_thirds() {
        let set = ScrambledSobol::new(3, 2);
        let n = Vec3::new(0.0, 0.6, 0.8);
        let mean = (0..4096)
            .map(|i| f64::from(cosine_direction(n, set.point2(i)).dot(n)))
            .sum::<f64>()
            / 4096.0;
        assert!((mean - 2.0 / 3.0).abs() < 1e-3, "{mean}");
    }
}
