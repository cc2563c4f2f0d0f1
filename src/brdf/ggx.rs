//! The GGX lobe: Cook and Torrance's f_s = D F G / (4 (n.v) (n.l)) with the
//! distribution of Trowbridge and Reitz and Smith's height-correlated masking
//! (Walter et al. 2007; Heitz, "Understanding the Masking-Shadowing Function",
//! 2014).

use glam::Vec3;

use super::Parts;
use crate::maths::functions::{cos_f32, sin_f32};
use crate::maths::order::Order;
use crate::maths::sampling::tangents;

/// Least cosine of a viewer: seen edge-on the lobe has no limit.
const LEAST_COSINE: f32 = 1e-4;

/// The lobe of a roughness, one for all colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ggx {
    /// Roughness of the microfacets' slopes, squared: alpha^2.
    alpha2: f32,
    alpha: f32,
}

/// The frame in which a lobe is known: z is the normal, x the azimuth of the
/// viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ViewedFrame {
    /// World's axes x, y, z, orthonormal.
    pub(crate) axes: [Vec3; 3],
    /// Cosine between the normal and the viewer, above 0.
    pub(crate) cosine: f32,
}

impl ViewedFrame {
    /// The frame of a unit normal and a unit direction to the viewer; a viewer
    /// behind the surface counts as one at its horizon.
    pub(crate) fn of(normal: Vec3, to_eye: Vec3) -> Self {
        let cosine = normal.dot(to_eye);
        let across = to_eye - normal * cosine;
        let x = match across.length_squared() {
            // From straight above any azimuth will do.
            small if small < 1e-12 => tangents(normal).0,
            _ => across.normalize(),
        };
        Self {
            axes: [x, normal.cross(x), normal],
            cosine: cosine.at_least(LEAST_COSINE).at_most(1.0),
        }
    }

    /// The viewer in the frame.
    fn viewer(&self) -> Vec3 {
        viewer_at(self.cosine)
    }

    /// World direction of one in the frame.
    pub(crate) fn world(&self, direction: Vec3) -> Vec3 {
        let [x, y, z] = self.axes;
        x * direction.x + y * direction.y + z * direction.z
    }

    /// The same, the other way.
    pub(crate) fn local(&self, direction: Vec3) -> Vec3 {
        let [x, y, z] = self.axes;
        Vec3::new(direction.dot(x), direction.dot(y), direction.dot(z))
    }
}

/// Unit vector to a viewer at azimuth 0.
pub(super) fn viewer_at(cosine: f32) -> Vec3 {
    Vec3::new((1.0 - cosine * cosine).at_least(0.0).sqrt(), 0.0, cosine)
}

impl Ggx {
    /// The lobe of a perceptual roughness of at least
    /// [`LEAST_ROUGHNESS`](super::LEAST_ROUGHNESS).
    pub(crate) fn of_roughness(roughness: f32) -> Self {
        let alpha = roughness * roughness;
        Self {
            alpha2: alpha * alpha,
            alpha,
        }
    }

    /// f_s (1/sr, without the cosine) for a light in a direction of the world;
    /// zero for one below the normal's plane.
    pub(crate) fn value(&self, frame: &ViewedFrame, to_light: Vec3) -> Parts {
        let light = frame.local(to_light);
        if light.z <= 0.0 {
            return Parts::default();
        }
        let viewer = frame.viewer();
        let half = (viewer + light).normalize();
        let masked = self.distribution(half.z) * self.visibility(viewer.z, light.z);
        Parts::split(masked, viewer.dot(half))
    }

    /// D(h), 1/sr, of the cosine between normal and half vector. Written so that
    /// the peak keeps its digits: 1 - cos^2 + alpha^2 cos^2.
    fn distribution(&self, cosine: f32) -> f32 {
        let cosine2 = cosine * cosine;
        let d = (1.0 - cosine2).at_least(0.0) + self.alpha2 * cosine2;
        self.alpha2 / (std::f32::consts::PI * d * d)
    }

    /// G / (4 (n.v) (n.l)).
    fn visibility(&self, view: f32, light: f32) -> f32 {
        let root = |c: f32| (self.alpha2 + (1.0 - self.alpha2) * c * c).sqrt();
        0.5 / (view * root(light) + light * root(view))
    }

    /// G1 of a cosine: the share of microfacets that face a direction and that
    /// it sees.
    fn seen_share(&self, cosine: f32) -> f32 {
        let root = (self.alpha2 + (1.0 - self.alpha2) * cosine * cosine).sqrt();
        2.0 * cosine / (cosine + root)
    }

    /// A direction to a light in the frame, drawn by the microfacets that the
    /// viewer sees (Dupuy and Benyoub, "Sampling Visible GGX Normals with
    /// Spherical Caps", 2023), with f_s cos / density. `None` where the facet
    /// reflects below the surface.
    pub(crate) fn sample(&self, view_cosine: f32, u: [f32; 2]) -> Option<(Vec3, Parts)> {
        let viewer = viewer_at(view_cosine);
        let half = self.visible_normal(viewer, u);
        let view_dot_half = viewer.dot(half);
        let light = half * (2.0 * view_dot_half) - viewer;
        if light.z <= 0.0 {
            return None;
        }
        let g2 = 4.0 * viewer.z * light.z * self.visibility(viewer.z, light.z);
        let weight = g2 / self.seen_share(viewer.z);
        Some((light, Parts::split(weight, view_dot_half)))
    }

    /// Density (1/sr) of the directions of [`Self::sample`].
    pub(crate) fn density(&self, frame: &ViewedFrame, to_light: Vec3) -> f32 {
        let light = frame.local(to_light);
        if light.z <= 0.0 {
            return 0.0;
        }
        let viewer = frame.viewer();
        let half = (viewer + light).normalize();
        self.seen_share(viewer.z) * self.distribution(half.z) / (4.0 * viewer.z)
    }

    fn visible_normal(&self, viewer: Vec3, u: [f32; 2]) -> Vec3 {
        let stretched = |v: Vec3| Vec3::new(v.x * self.alpha, v.y * self.alpha, v.z).normalize();
        let standing = stretched(viewer);
        let z = (1.0 - u[0]) * (1.0 + standing.z) - standing.z;
        let radius = (1.0 - z * z).at_least(0.0).sqrt();
        let angle = std::f32::consts::TAU * u[1];
        let cap = Vec3::new(radius * cos_f32(angle), radius * sin_f32(angle), z);
        let half = cap + standing;
        // Opposite to the viewer, at the rim, there is no half vector.
        if half.z <= 0.0 {
            return Vec3::Z;
        }
        stretched(half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::sampling::sphere_direction;

    const ROUGHNESSES: [f32; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

    /// Midpoints of the sphere's directions.
    fn directions(count: u32) -> impl Iterator<Item = Vec3> {
        (0..count * count).map(move |i| {
            let at = |k: u32| (k as f32 + 0.5) / count as f32;
            sphere_direction([at(i / count), at(i % count)])
        })
    }

    #[test]
    fn the_lobe_is_reciprocal() {
        let ggx = Ggx::of_roughness(0.5);
        let (a, b) = (
            Vec3::new(0.3, 0.2, 0.7).normalize(),
            Vec3::new(-0.6, 0.5, 0.4).normalize(),
        );
        let there = ggx.value(&ViewedFrame::of(Vec3::Z, a), b);
        let back = ggx.value(&ViewedFrame::of(Vec3::Z, b), a);
        assert!((there.coloured / back.coloured - 1.0).abs() < 1e-5);
        assert!((there.white - back.white).abs() < 1e-5 * there.coloured);
    }

    #[test]
    fn densities_are_one_in_all_but_for_facets_below_the_horizon() {
        for roughness in ROUGHNESSES {
            let ggx = Ggx::of_roughness(roughness);
            for cosine in [0.15, 0.5, 0.95] {
                let frame = ViewedFrame::of(Vec3::Z, viewer_at(cosine));
                let count = 1200;
                let sum: f64 = directions(count)
                    .map(|d| f64::from(ggx.density(&frame, d)))
                    .sum();
                let whole = sum * 4.0 * std::f64::consts::PI / f64::from(count * count);
                let drawn = 500;
                let is_above = |i: &u32| {
                    let at = |k: u32| (k as f32 + 0.5) / drawn as f32;
                    ggx.sample(cosine, [at(i / drawn), at(i % drawn)]).is_some()
                };
                let above = (0..drawn * drawn).filter(is_above).count();
                let above = above as f64 / f64::from(drawn * drawn);
                assert!(
                    (whole - above).abs() < 2e-3,
                    "roughness {roughness}, cosine {cosine}: {whole} {above}"
                );
            }
        }
    }

    #[test]
    fn drawn_directions_have_the_mean_of_the_integral() {
        for roughness in ROUGHNESSES {
            let ggx = Ggx::of_roughness(roughness);
            for cosine in [0.15, 0.5, 0.95] {
                let frame = ViewedFrame::of(Vec3::Z, viewer_at(cosine));
                let count = 1200;
                let sum: f64 = directions(count)
                    .map(|d| f64::from(ggx.value(&frame, d).coloured * d.z))
                    .sum();
                let whole = sum * 4.0 * std::f64::consts::PI / f64::from(count * count);
                let drawn = 500;
                let weight = |i: u32| {
                    let at = |k: u32| (k as f32 + 0.5) / drawn as f32;
                    let sample = ggx.sample(cosine, [at(i / drawn), at(i % drawn)]);
                    sample.map_or(0.0, |(_, parts)| f64::from(parts.coloured))
                };
                let mean = (0..drawn * drawn).map(weight).sum::<f64>() / f64::from(drawn * drawn);
                assert!(
                    (whole - mean).abs() < 2e-3,
                    "roughness {roughness}, cosine {cosine}: {whole} {mean}"
                );
            }
        }
    }

    #[test]
    fn a_viewer_behind_or_above_has_a_frame() {
        for eye in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, -0.8)] {
            let frame = ViewedFrame::of(Vec3::Z, eye);
            assert!(frame.cosine > 0.0 && frame.axes.iter().all(|a| a.is_normalized()));
            let value = Ggx::of_roughness(0.3).value(&frame, Vec3::new(0.0, 0.6, 0.8));
            assert!(value.coloured.is_finite());
        }
    }
}
