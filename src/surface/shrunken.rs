//! The mesh with every connected surface drawn in a little behind its front, so
//! that bodies that touch do not.
//!
//! A box on a floor has its bottom in the floor's plane. A ray from inside the
//! box meets the bottom's back and the floor's front at one distance, and the
//! lower index counts: often the floor, as if the box were open.

use std::collections::HashMap;

use glam::Vec3;

use super::forest::Forest;
use super::mesh::{LightingMesh, NONE};
use super::rays::RayTree;
use super::{Arrival, Surface, SurfacePoint, arrive};
use crate::simd::Level;

/// How far corners are drawn in, placed units: five times the offset of a
/// ray's origin, and a fifth of the gap that two planes 1e-4 apart leave.
const DRAWN_IN: f32 = 2e-5;

/// A mesh of bodies that do not touch, with the triangles of the surface.
pub(super) struct Shrunken {
    mesh: LightingMesh,
    rays: RayTree,
}

impl Shrunken {
    pub(super) fn of(surface: &Surface) -> Self {
        let mut mesh = surface.mesh.clone();
        mesh.positions.clear();
        let mut index_of = HashMap::new();
        let mut backwards: Vec<Vec3> = Vec::new();
        let components = components(surface);
        for (triangle, component) in mesh.triangles.iter_mut().zip(components) {
            for corner in &mut triangle.corners {
                let next = mesh.positions.len() as u32;
                let index = *index_of.entry((component, *corner)).or_insert(next);
                if index == next {
                    mesh.positions
                        .push(surface.mesh.positions[*corner as usize]);
                    backwards.push(Vec3::ZERO);
                }
                backwards[index as usize] -= triangle.flat_normal * triangle.area;
                *corner = index;
            }
        }
        for (position, backwards) in mesh.positions.iter_mut().zip(backwards) {
            *position += backwards.normalize_or_zero() * DRAWN_IN;
        }
        let corners: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.corners).collect();
        let rays = RayTree::build(&mesh.positions, &corners);
        Self { mesh, rays }
    }

    /// The point of a front vertex's area for two uniforms.
    pub(super) fn sample_point(
        &self,
        surface: &Surface,
        vertex: usize,
        u: [f32; 2],
    ) -> SurfacePoint {
        surface.vertices.sample_point(&self.mesh, vertex, u)
    }

    /// Where light that leaves a point in a direction arrives.
    pub(super) fn arrival(
        &self,
        level: Level,
        from: &SurfacePoint,
        direction: Vec3,
    ) -> Option<Arrival> {
        arrive(&self.mesh, &self.rays, level, from, direction)
    }
}

/// The connected surface of each triangle.
fn components(surface: &Surface) -> Vec<u32> {
    let mut forest = Forest::new(surface.mesh.triangles.len());
    for edge in surface
        .edges
        .iter()
        .filter(|edge| edge.triangles[1] != NONE)
    {
        forest.join(edge.triangles[0], edge.triangles[1]);
    }
    (0..surface.mesh.triangles.len() as u32)
        .map(|triangle| forest.root(triangle))
        .collect()
}
