//! The triangles of the file, before any tessellation.

use glam::{DVec2, DVec3};

/// Triangle soup with shared corners, units of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Corner positions. Equal positions may appear more than once.
    pub positions: Vec<DVec3>,
    /// Unit shading normals that triangles refer to.
    pub normals: Vec<DVec3>,
    /// Texture coordinates that triangles refer to (v = 0 at the bottom).
    pub texture_coordinates: Vec<DVec2>,
    /// Triangles, polygons split as a fan from the first corner.
    pub triangles: Vec<MeshTriangle>,
}

/// One triangle: counter-clockwise seen from its front.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshTriangle {
    /// Indices into [`Mesh::positions`].
    pub corners: [u32; 3],
    /// Indices into [`Mesh::normals`]; `None`: flat.
    pub normals: Option<[u32; 3]>,
    /// Indices into [`Mesh::texture_coordinates`].
    pub texture_coordinates: Option<[u32; 3]>,
    /// Index into [`super::Scene::materials`].
    pub material: u32,
}
