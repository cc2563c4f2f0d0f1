//! The lighting mesh: pieces of the file's triangles with welded corners, and
//! what lies on the two sides of every edge.

use std::collections::{HashMap, HashSet};

use glam::{DVec2, Vec2, Vec3};

use super::tessellate::tessellate;
use crate::scene::{MeshTriangle, Placement, Scene, same_corners};

/// No triangle, or no vertex.
pub(crate) const NONE: u32 = u32::MAX;

/// One triangle of the lighting mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfaceTriangle {
    /// Indices into [`LightingMesh::positions`], counter-clockwise from the front.
    pub(crate) corners: [u32; 3],
    /// Unit shading normals at the corners, front side.
    pub(crate) normals: [Vec3; 3],
    /// Unit normal of the flat triangle, front side.
    pub(crate) flat_normal: Vec3,
    /// Area, placed units squared.
    pub(crate) area: f32,
    /// Index of the material.
    pub(crate) material: u32,
}

/// Triangles whose corners at equal positions are one and the same.
#[derive(Debug, Clone, Default)]
pub(crate) struct LightingMesh {
    /// Placed units; no two are equal.
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<SurfaceTriangle>,
    /// Texture coordinates of the corners of each triangle; empty in a scene
    /// that shows no texture.
    pub(crate) texture_coordinates: Vec<Option<[Vec2; 3]>>,
    /// Triangles dropped because they have no area in single precision.
    pub(crate) dropped: usize,
    /// Triangles dropped because an earlier one has the same corners: of two
    /// hits at one distance the first triangle's counts, so they are never seen.
    pub(crate) duplicates: usize,
}

/// One triangle's use of an undirected edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct EdgeSide {
    /// Corner positions, ascending.
    pub(crate) corners: [u32; 2],
    pub(crate) triangle: u32,
    /// Which corner of the triangle the edge starts at.
    pub(crate) first: u8,
}

/// Gives equal positions equal indices, in order of first appearance.
#[derive(Default)]
struct Welder {
    index_of: HashMap<[u32; 3], u32>,
    positions: Vec<Vec3>,
}

impl Welder {
    fn weld(&mut self, position: Vec3) -> u32 {
        // Adding zero turns -0 into +0, so that both weld.
        let position = position + Vec3::ZERO;
        let next = self.positions.len() as u32;
        let index = *self
            .index_of
            .entry(position.to_array().map(f32::to_bits))
            .or_insert(next);
        if index == next {
            self.positions.push(position);
        }
        index
    }
}

impl LightingMesh {
    /// Places and tessellates the scene's mesh; edges longer than `max_edge`
    /// (placed units) are cut.
    pub(crate) fn build(scene: &Scene, placement: &Placement, max_edge: f32) -> Self {
        let placed: Vec<Vec3> = scene
            .mesh
            .positions
            .iter()
            .map(|&p| placement.placed_from_file(p))
            .collect();
        let mut welder = Welder::default();
        let mut mesh = Self::default();
        let mut seen = HashSet::new();
        let is_textured = has_textures(scene);
        for triangle in &scene.mesh.triangles {
            let corners = triangle.corners.map(|c| placed[c as usize]);
            if !seen.insert(same_corners(corners)) {
                mesh.duplicates += 1;
                continue;
            }
            let normals = source_normals(scene, triangle);
            let uv = source_texture_coordinates(scene, triangle).filter(|_| is_textured);
            tessellate(corners, max_edge, &mut |piece| {
                let corners = piece.map(|c| welder.weld(c.position));
                let area_normal = area_normal(piece.map(|c| c.position));
                let length = area_normal.length();
                if length <= 0.0
                    || corners[0] == corners[1]
                    || corners[1] == corners[2]
                    || corners[2] == corners[0]
                {
                    mesh.dropped += 1;
                    return;
                }
                let flat_normal = area_normal / length;
                if is_textured {
                    let at = |uv: [DVec2; 3]| piece.map(|c| weighted(uv, c.source_barycentrics));
                    mesh.texture_coordinates.push(uv.map(at));
                }
                mesh.triangles.push(SurfaceTriangle {
                    corners,
                    normals: piece.map(|c| match normals {
                        Some(n) => interpolated(n, c.source_barycentrics, flat_normal),
                        None => flat_normal,
                    }),
                    flat_normal,
                    area: 0.5 * length,
                    material: triangle.material,
                });
            });
        }
        mesh.positions = welder.positions;
        mesh
    }

    /// Texture coordinates of a triangle's corners, where it has them and the
    /// scene shows textures.
    pub(crate) fn texture_coordinates_of(&self, triangle: u32) -> Option<[Vec2; 3]> {
        *self.texture_coordinates.get(triangle as usize)?
    }

    /// Corner positions of a triangle.
    pub(crate) fn corner_positions(&self, triangle: &SurfaceTriangle) -> [Vec3; 3] {
        triangle.corners.map(|c| self.positions[c as usize])
    }

    /// The uses of all edges, sorted: an edge is a run of equal `corners`.
    pub(crate) fn edge_sides(&self) -> Vec<EdgeSide> {
        let mut sides = Vec::with_capacity(self.triangles.len() * 3);
        for (t, triangle) in self.triangles.iter().enumerate() {
            for first in 0..3_u8 {
                let [a, b] = triangle.edge(first);
                sides.push(EdgeSide {
                    corners: [a.min(b), a.max(b)],
                    triangle: t as u32,
                    first,
                });
            }
        }
        sides.sort_unstable();
        sides
    }
}

impl SurfaceTriangle {
    /// The edge that starts at a corner, in the triangle's direction.
    pub(crate) fn edge(&self, first: u8) -> [u32; 2] {
        let k = usize::from(first);
        [self.corners[k], self.corners[(k + 1) % 3]]
    }
}

/// Normal of a flat triangle, of twice its area's length. Summed in double
/// precision: thin pieces of a big wall keep the wall's direction.
fn area_normal(p: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = p.map(|v| v.as_dvec3());
    (b - a).cross(c - a).as_vec3()
}

fn source_normals(scene: &Scene, triangle: &MeshTriangle) -> Option<[Vec3; 3]> {
    triangle
        .normals
        .map(|n| n.map(|i| scene.mesh.normals[i as usize].as_vec3()))
}

/// Whether a triangle shows a texture.
fn has_textures(scene: &Scene) -> bool {
    scene.mesh.triangles.iter().any(|triangle| {
        let material = &scene.materials[triangle.material as usize];
        triangle.texture_coordinates.is_some()
            && (material.albedo_map.is_some() || material.emission_map.is_some())
    })
}

/// Texture coordinates of a triangle of the file.
fn source_texture_coordinates(scene: &Scene, triangle: &MeshTriangle) -> Option<[DVec2; 3]> {
    let indices = triangle.texture_coordinates?;
    Some(indices.map(|i| scene.mesh.texture_coordinates[i as usize]))
}

fn weighted(uv: [DVec2; 3], barycentrics: Vec3) -> Vec2 {
    let [a, b, c] = barycentrics.as_dvec3().to_array();
    (uv[0] * a + uv[1] * b + uv[2] * c).as_vec2()
}

/// The unit normal at barycentric coordinates, or `fallback` where the three
/// cancel.
pub(crate) fn interpolated(normals: [Vec3; 3], barycentrics: Vec3, fallback: Vec3) -> Vec3 {
    let sum =
        normals[0] * barycentrics.x + normals[1] * barycentrics.y + normals[2] * barycentrics.z;
    let length = sum.length();
    if length > 1e-6 {
        sum / length
    } else {
        fallback
    }
}
