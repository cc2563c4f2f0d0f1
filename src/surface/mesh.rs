//! The lighting mesh: pieces of the file's triangles with welded corners, and
//! what lies on the two sides of every edge.

use std::collections::{HashMap, HashSet};

use glam::{DVec2, Vec2, Vec3};

use super::contacts::Cuts;
use super::tessellate::{PieceCorner, halve, tessellate, tessellate_piece};
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
    /// Edges on which something stands, by the indices of their ends, ascending:
    /// the vertices on them are different ones for each side.
    pub(crate) contacts: Vec<[u32; 2]>,
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

/// A triangle of the file, placed.
struct Source {
    normals: Option<[Vec3; 3]>,
    texture_coordinates: Option<[DVec2; 3]>,
    /// Unit; zero for a triangle without area.
    flat_normal: Vec3,
    material: u32,
}

impl Source {
    fn of(scene: &Scene, triangle: &MeshTriangle, corners: [Vec3; 3]) -> Self {
        Self {
            normals: source_normals(scene, triangle),
            texture_coordinates: source_texture_coordinates(scene, triangle),
            flat_normal: area_normal(corners).normalize_or_zero(),
            material: triangle.material,
        }
    }
}

/// The lighting mesh as it grows by pieces of triangles.
struct Pieces {
    mesh: LightingMesh,
    welder: Welder,
    is_textured: bool,
}

impl Pieces {
    /// Adds a piece. A thin piece beside a contact has its source's flat normal,
    /// since its own is that of its corners' rounding.
    fn add(&mut self, source: &Source, piece: [PieceCorner; 3], flat_normal: Option<Vec3>) {
        let corners = piece.map(|c| self.welder.weld(c.position));
        let area_normal = area_normal(piece.map(|c| c.position));
        let length = area_normal.length();
        if length <= 0.0
            || corners[0] == corners[1]
            || corners[1] == corners[2]
            || corners[2] == corners[0]
            || flat_normal.is_some_and(|normal| normal.dot(area_normal) <= 0.0)
        {
            self.mesh.dropped += 1;
            return;
        }
        let flat_normal = flat_normal.unwrap_or(area_normal / length);
        if self.is_textured {
            let at = |uv: [DVec2; 3]| piece.map(|c| weighted(uv, c.source_barycentrics));
            let uv = source.texture_coordinates.map(at);
            self.mesh.texture_coordinates.push(uv);
        }
        self.mesh.triangles.push(SurfaceTriangle {
            corners,
            normals: piece.map(|c| match source.normals {
                Some(n) => interpolated(n, c.source_barycentrics, flat_normal),
                None => flat_normal,
            }),
            flat_normal,
            area: 0.5 * length,
            material: source.material,
        });
    }

    /// Notes the edges on which something stands.
    fn add_contacts(&mut self, cuts: &Cuts, max_edge: f32) {
        for &[from, to] in &cuts.contacts {
            let mut last = from;
            let mut add = |next: PieceCorner| {
                let [a, b] = [last, next].map(|c| self.welder.weld(c.position));
                self.mesh.contacts.push([a.min(b), a.max(b)]);
                last = next;
            };
            halve(from, to, max_edge, &mut add);
            add(to);
        }
        self.mesh.contacts.sort_unstable();
        self.mesh.contacts.dedup();
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
        let mut mesh = Self::default();
        let (triangles, corners) = mesh.distinct_triangles(scene, &placed);
        let cuts = Cuts::of(&corners, max_edge);
        let mut pieces = Pieces {
            mesh,
            welder: Welder::default(),
            is_textured: has_textures(scene),
        };
        for (index, triangle) in triangles.into_iter().enumerate() {
            let corners = corners[index];
            let source = Source::of(scene, triangle, corners);
            match cuts.pieces(index as u32) {
                None => tessellate(corners, max_edge, &mut |piece| {
                    pieces.add(&source, piece, None);
                }),
                Some(parts) => parts.iter().for_each(|&part| {
                    tessellate_piece(part, max_edge, &mut |piece| {
                        pieces.add(&source, piece, Some(source.flat_normal));
                    });
                }),
            }
        }
        pieces.add_contacts(&cuts, max_edge);
        pieces.mesh.positions = pieces.welder.positions;
        pieces.mesh
    }

    /// The triangles of the scene with their placed corners, the first of those
    /// that have the same; counts the others.
    fn distinct_triangles<'s>(
        &mut self,
        scene: &'s Scene,
        placed: &[Vec3],
    ) -> (Vec<&'s MeshTriangle>, Vec<[Vec3; 3]>) {
        let mut seen = HashSet::new();
        let mut distinct = (Vec::new(), Vec::new());
        for triangle in &scene.mesh.triangles {
            let corners = triangle.corners.map(|c| placed[c as usize]);
            if seen.insert(same_corners(corners)) {
                distinct.0.push(triangle);
                distinct.1.push(corners);
            } else {
                self.duplicates += 1;
            }
        }
        distinct
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
