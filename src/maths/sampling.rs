//! Warps from the unit square and cube to directions and surface points.

use glam::Vec3;

use super::functions::{cos_f32, sin_f32};

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
    let height = (1.0 - u[0]).max(0.0).sqrt();
    let (t, b) = tangents(normal);
    t * (radius * cos_f32(angle)) + b * (radius * sin_f32(angle)) + normal * height
}

/// Direction uniform over the sphere, from two uniforms.
pub(crate) fn sphere_direction(u: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u[0];
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let angle = std::f32::consts::TAU * u[1];
    Vec3::new(radius * cos_f32(angle), radius * sin_f32(angle), z)
}

/// Barycentric coordinates with density proportional to the first one, i.e.
/// Dirichlet(2, 1, 1): three uniforms are sorted, the gaps g0..g3 between them
/// and the ends give (g0 + g1, g2, g3).
pub(crate) fn hat_barycentrics(u: [f32; 3]) -> [f32; 3] {
    let [mut a, mut b, mut c] = u;
    if b < a {
        (a, b) = (b, a);
    }
    if c < b {
        (b, c) = (c, b);
    }
    if b < a {
        (a, b) = (b, a);
    }
    debug_assert!(a <= b && b <= c, "three numbers sorted by three exchanges");
    [b, c - b, 1.0 - c]
}

/// Barycentric coordinates uniform over the triangle, from two uniforms.
pub(crate) fn uniform_barycentrics(u: [f32; 2]) -> [f32; 3] {
    let root = u[0].sqrt();
    [1.0 - root, root * (1.0 - u[1]), root * u[1]]
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
    fn hat_density_has_the_first_moment_of_dirichlet_2_1_1() {
        let set = ScrambledSobol::new(3, 1);
        let mut mean = [0.0_f64; 3];
        for i in 0..4096 {
            let p = set.point(i);
            let l = hat_barycentrics([p[0], p[1], p[2]]);
            assert!((l[0] + l[1] + l[2] - 1.0).abs() < 1e-6);
            for k in 0..3 {
                mean[k] += f64::from(l[k]) / 4096.0;
            }
        }
        assert!(
            (mean[0] - 0.5).abs() < 2e-3 && (mean[1] - 0.25).abs() < 2e-3,
            "{mean:?}"
        );
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
