//! The second backend: obvhs's own traversal of its compressed tree, with the
//! same bits as the first. It checks the first one, and it is the yardstick of
//! its speed.
//!
//! obvhs tests boxes with roundings of its own, ignores what is nearer than
//! 1e-4, and takes 1.2e-7 for smaller direction components. So it only chooses
//! which triangles are tested: it is given boxes padded further, and a ray that
//! begins a little before ours, with a direction of length about 1.
#![allow(
    clippy::disallowed_types,
    reason = "obvhs takes Vec3A; only its choice of triangles depends on it, no hit does"
)]

use super::{Hit, Ray, RayTree};
use crate::simd::ray::RaySetup;
use crate::simd::triangle::{Best, Interval, hits};
use glam::Vec3A;
use obvhs::ray::RayHit;

/// How far before our origin obvhs's ray begins: beyond its minimum of 1e-4.
const BACKSTEP: f64 = 1e-3;

/// Added to a distance at which obvhs may stop looking; covers the roundings of
/// its distances, which are at most 6 here.
const DISTANCE_SLACK: f64 = 1e-5;

/// Distances of obvhs's ray: (t x length) + backstep.
struct Scale {
    length: f64,
}

impl Scale {
    /// A distance that is certainly beyond `t`.
    fn beyond(&self, t: f32) -> f32 {
        let distance = f64::from(t) * self.length + BACKSTEP + DISTANCE_SLACK;
        (distance * (1.0 + 1e-6)) as f32
    }
}

fn obvhs_ray(ray: &RaySetup, direction: glam::Vec3) -> (obvhs::ray::Ray, Scale) {
    let direction = direction.as_dvec3();
    let length = direction.length();
    let unit = direction / length;
    let origin = ray.origin().as_dvec3() - unit * BACKSTEP;
    let scale = Scale { length };
    let far = scale.beyond(ray.t_max());
    // Adding 0 turns -0 into 0: obvhs takes the sign of the inverse from the
    // sign bit and the order of the planes from a comparison with 0.
    let cast = |v: glam::DVec3| Vec3A::from(v.as_vec3()) + 0.0;
    (
        obvhs::ray::Ray::new(cast(origin), cast(unit), 0.0, far),
        scale,
    )
}

impl RayTree {
    /// [`RayTree::closest`] through obvhs's traversal.
    pub(crate) fn closest_obvhs(&self, ray: &Ray) -> Option<Hit> {
        let setup = RaySetup::new(ray);
        let (obvhs_ray, scale) = obvhs_ray(&setup, ray.direction);
        let mut best = Best::none(&setup);
        let (corners, indices) = (self.wide.corners(), self.wide.indices());
        let mut ignored = RayHit::none();
        self.compressed
            .ray_traverse(obvhs_ray, &mut ignored, |_, triangle| {
                let improved =
                    Interval::of_triangle(&setup, &corners[triangle]).is_some_and(|interval| {
                        best.offer(&setup, &corners[triangle], interval, || indices[triangle])
                    });
                if improved {
                    scale.beyond(best.t())
                } else {
                    f32::INFINITY
                }
            });
        best.hit(&setup)
    }

    /// [`RayTree::occluded`] through obvhs's traversal.
    pub(crate) fn occluded_obvhs(&self, ray: &Ray) -> bool {
        let setup = RaySetup::new(ray);
        let (obvhs_ray, _) = obvhs_ray(&setup, ray.direction);
        let corners = self.wide.corners();
        // A miss is an infinite distance, which is not below any end of a ray.
        !self.compressed.ray_traverse_miss(obvhs_ray, |_, triangle| {
            let hit = Interval::of_triangle(&setup, &corners[triangle])
                .is_some_and(|interval| hits(&setup, &corners[triangle], interval));
            if hit { 0.0 } else { f32::INFINITY }
        })
    }
}
