//! The triangles of the file, before any tessellation.

use glam::{DVec2, DVec3, Vec3};

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

impl Mesh {
    /// Lowest and highest corner of the box around all triangles; positions
    /// that no triangle uses do not count. Zeros for a mesh without triangles.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = self.triangles.iter().flat_map(|t| t.corners);
        let mut positions = corners.map(|corner| self.positions[corner as usize]);
        let Some(first) = positions.next() else {
            return (DVec3::ZERO, DVec3::ZERO);
        };
        let (mut lower, mut upper) = (first, first);
        for position in positions {
            for axis in 0..3 {
                // Written out, since min and max of two zeros differ between
                // machines.
                if position[axis] < lower[axis] {
                    lower[axis] = position[axis];
                }
                if position[axis] > upper[axis] {
                    upper[axis] = position[axis];
                }
            }
        }
        (lower, upper)
    }
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

/// Placed corners whatever their order: equal for triangles of which only the
/// first can be seen.
pub(crate) fn same_corners(corners: [Vec3; 3]) -> [[u32; 3]; 3] {
    // Adding zero turns -0 into +0.
    let mut bits = corners.map(|c| (c + Vec3::ZERO).to_array().map(f32::to_bits));
    bits.sort_unstable();
    bits
}
