//! Closest hits and occlusion over a list of triangles.
//!
//! The only place that names obvhs, which builds the tree and traverses it in
//! the second backend. In come corners and triangles in coordinates of at most
//! 1, out go hits.
//!
//! # A hit is a function of the triangle list alone
//!
//! *Definition.* A ray hits a triangle where it is inside the triangle's padded
//! box (slab test, conservative: [`RaySetup`]) and the watertight test accepts
//! it ([`crate::simd`], `triangle.rs`); t is clamped to the interval \[entry,
//! exit\] of the ray in that box, and 0 < t < t_max. Of all hits the smallest t
//! wins, of equal ones the lowest index. Neither depends on other triangles, so
//! testing every triangle in any order gives one answer: the brute force.
//!
//! *No tree changes it.* A node's box is the exact minimum and maximum over the
//! padded boxes below it, so it contains them as numbers. Subtraction and
//! multiplication round monotonically, minimum and maximum are monotone, hence
//! entry(node) <= entry(triangle) and exit(triangle) <= exit(node), to the bit.
//! For the winner entry <= t <= exit and 0 < t < t_max, so at each of its
//! ancestors entry(node) <= t <= exit(node): the ancestor is entered, and it is
//! not cut off by a best hit so far, t_best >= t, since only entry(node) >
//! t_best is cut off (strictly: an equal t with a lower index still wins).
//! Therefore the winner is always tested, whatever the tree's shape, width and
//! order, and for the shadow query any hit is found whenever there is one.
//!
//! obvhs quantises boxes and tests them with other roundings. Its tree is built
//! over boxes padded further, it only chooses which triangles are offered, and
//! the definition above decides in its closures (`rays/second.rs`).

mod build;
#[cfg(test)]
mod scenes;
#[cfg(test)]
mod second;
#[cfg(test)]
mod speed;
#[cfg(test)]
mod tests;

pub(crate) use crate::simd::{Hit, Ray};
use crate::simd::{Level, WideTree};
use glam::Vec3;

/// A tree over triangles: the closest hit and occlusion of rays.
#[derive(Debug)]
pub(crate) struct RayTree {
    wide: WideTree,
    /// The same tree as obvhs made it. Its `primitive_indices` are `wide`'s.
    #[cfg(test)]
    compressed: obvhs::cwbvh::CwBvh,
}

impl RayTree {
    /// Builds the tree over `triangles`, indices into `positions` of
    /// |coordinate| <= 1. The same list gives the same tree. A list may be empty.
    pub(crate) fn build(positions: &[Vec3], triangles: &[[u32; 3]]) -> RayTree {
        build::build(positions, triangles)
    }

    /// The nearest hit of a ray.
    pub(crate) fn closest(&self, level: Level, ray: &Ray) -> Option<Hit> {
        let mut found = [None];
        self.closest_many(level, std::slice::from_ref(ray), &mut found);
        found[0]
    }

    /// Whether the ray hits anything.
    pub(crate) fn occluded(&self, level: Level, ray: &Ray) -> bool {
        let mut found = [false];
        self.occluded_many(level, std::slice::from_ref(ray), &mut found);
        found[0]
    }

    /// The nearest hits of many rays, `hits[i]` that of `rays[i]`. Enters the
    /// instruction set once, so it is the form for all but stray rays.
    pub(crate) fn closest_many(&self, level: Level, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.wide.closest_many(level, rays, hits);
    }

    /// Whether rays hit anything, `occluded[i]` for `rays[i]`.
    pub(crate) fn occluded_many(&self, level: Level, rays: &[Ray], occluded: &mut [bool]) {
        self.wide.occluded_many(level, rays, occluded);
    }
}

/// Distance by which [`offset_origin`] moves a point. From below: a point from
/// barycentrics is off its plane by up to 2e-7, corners seen from it by up to
/// 6e-7 in the triangle test. Of two million rays, half of them within 0.01 of
/// parallel to their plane, 4126 hit it at an offset of 1e-7, 332 at 2e-7, 43 at
/// 3e-7, one at 5e-7 and none from 1e-6 on. From above: light leaks past
/// contacts that are thinner, and shadows start that late; 4e-6 is a thousandth
/// of a pixel of a 640 pixel wide image of the whole scene.
const ORIGIN_OFFSET: f32 = 4e-6;

/// Moves a point of a triangle off it, to the side of `toward` (a direction or
/// a vector to the goal; `flat_normal` is the triangle's unit normal), so that a
/// ray from there hits neither the triangle nor its coplanar neighbours.
pub(crate) fn offset_origin(point: Vec3, flat_normal: Vec3, toward: Vec3) -> Vec3 {
    let offset = if flat_normal.dot(toward) < 0.0 {
        -ORIGIN_OFFSET
    } else {
        ORIGIN_OFFSET
    };
    point + flat_normal * offset
}
