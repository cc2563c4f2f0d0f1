//! What the rasterizer draws: the lighting mesh, and the rectangles of area
//! lights behind it in the list.

use glam::Vec3;

use super::raster::{Fragment, MeshEdge, NONE, RasterMesh};
use crate::scene::PlacedRectangle;
use crate::surface::Surface;

/// Triangles of the mesh and of rectangles.
pub(crate) struct Geometry {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    patches: Vec<u32>,
    edges: Vec<MeshEdge>,
    mesh_triangles: usize,
}

impl Geometry {
    pub(crate) fn new(surface: &Surface, rectangles: &[PlacedRectangle]) -> Self {
        let mesh = &surface.mesh;
        let mut geometry = Self {
            positions: mesh.positions.clone(),
            triangles: mesh.triangles.iter().map(|t| t.corners).collect(),
            patches: surface.patches.clone(),
            edges: surface.edges.clone(),
            mesh_triangles: mesh.triangles.len(),
        };
        rectangles.iter().for_each(|r| geometry.add(r));
        geometry
    }

    /// Adds a rectangle as two triangles; its patch is named by the first.
    fn add(&mut self, rectangle: &PlacedRectangle) {
        let corner = self.positions.len() as u32;
        let first = self.triangles.len() as u32;
        let (base, u, v) = (rectangle.corner, rectangle.edge_u, rectangle.edge_v);
        let corners = [base, base + u, base + u + v, base + v];
        self.positions.extend(corners.map(|c| c.as_vec3()));
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| corner + k);
        self.triangles.extend([[a, b, c], [a, c, d]]);
        self.patches.extend([first, first]);
        let border = |corners, triangle| MeshEdge {
            corners,
            triangles: [triangle, NONE],
            crease: true,
        };
        self.edges.extend([
            border([a, b], first),
            border([b, c], first),
            border([c, d], first + 1),
            border([a, d], first + 1),
        ]);
    }

    /// As the rasterizer takes it.
    pub(crate) fn mesh(&self) -> RasterMesh<'_> {
        RasterMesh {
            positions: &self.positions,
            triangles: &self.triangles,
            patches: &self.patches,
            edges: &self.edges,
        }
    }

    /// Number of the rectangle that a fragment shows, if it shows one.
    pub(crate) fn rectangle_of(&self, fragment: &Fragment) -> Option<usize> {
        let beyond = (fragment.triangle as usize).checked_sub(self.mesh_triangles)?;
        fragment.is_covered().then_some(beyond / 2)
    }
}
