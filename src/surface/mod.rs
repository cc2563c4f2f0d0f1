//! The scene as light sees it: a lighting mesh, the vertices that carry
//! radiosity and irradiance, and the tree that answers rays.
//!
//! Comes in: [`crate::scene::Scene`]. Goes out: [`Surface`], in placed units
//! (see [`crate::scene::Placement`]). Everything here depends on geometry
//! alone, except [`direct`], which asks what one light does to one point.

mod close;
mod contacts;
mod detail;
pub(crate) mod direct;
mod forest;
mod kept;
pub(crate) mod maps;
mod mesh;
mod rays;
mod shrunken;
mod sides;
mod t_junctions;
mod tessellate;
mod vertices;

pub(crate) use detail::Detail;
pub(crate) use kept::KeptArrivals;
pub(crate) use mesh::{LightingMesh, NONE};
pub(crate) use rays::{Ray, RayTree, offset_origin};
pub(crate) use vertices::{LightingVertices, MeshEdge, SurfacePoint};

use glam::Vec3;

use crate::scene::{Placement, Scene};
use crate::simd::Level;

/// The lighting mesh with its vertices and rays.
pub(crate) struct Surface {
    pub(crate) placement: Placement,
    pub(crate) mesh: LightingMesh,
    pub(crate) vertices: LightingVertices,
    /// Smooth patch of each triangle.
    pub(crate) patches: Vec<u32>,
    pub(crate) edges: Vec<MeshEdge>,
    pub(crate) rays: RayTree,
    /// Whether each material has a glossy lobe.
    pub(crate) glossy_materials: Vec<bool>,
    /// Arrivals of the transfer's rays, where a study has traced them: rows are
    /// then sampled from these, without a sky.
    pub(crate) kept_arrivals: Option<KeptArrivals>,
    /// Longest edge that was left whole, file units.
    pub(crate) max_edge: f64,
    /// What the user should know about the mesh.
    pub(crate) warnings: Vec<String>,
}

/// Where a ray arrived.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arrival {
    pub(crate) triangle: u32,
    pub(crate) barycentrics: [f32; 3],
    /// Whether it arrived on the front.
    pub(crate) front: bool,
}

impl Surface {
    /// Places, tessellates and joins the mesh. Only front sides have vertices
    /// so far; [`Self::add_backs`] completes them.
    pub(crate) fn fronts(scene: &Scene, detail: &Detail) -> Self {
        let placement = scene.placement();
        let (mesh, joints, vertices, max_edge) = detail::build(scene, &placement, detail);
        let corners: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.corners).collect();
        let rays = RayTree::build(&mesh.positions, &corners);
        let mut warnings = Vec::new();
        if mesh.dropped > 0 {
            warnings.push(format!(
                "{} triangles have no area in single precision and are left out",
                mesh.dropped
            ));
        }
        if mesh.duplicates > 0 {
            warnings.push(format!(
                "{} triangles have the corners of an earlier one and are left out",
                mesh.duplicates
            ));
        }
        warnings.extend(t_junctions::report(&mesh, &joints.edges, &placement));
        Self {
            placement,
            mesh,
            vertices,
            patches: joints.patches,
            edges: joints.edges,
            rays,
            glossy_materials: scene
                .materials
                .iter()
                .map(|m| m.gloss().is_some())
                .collect(),
            kept_arrivals: None,
            max_edge: f64::from(max_edge) / placement.scale,
            warnings,
        }
    }

    /// Whether a vertex's material has a glossy lobe.
    pub(crate) fn is_glossy(&self, vertex: u32) -> bool {
        let material = self.vertices.materials()[vertex as usize];
        self.glossy_materials[material as usize]
    }

    /// The surface of a scene's own detail, with its backs.
    #[cfg(test)]
    pub(crate) fn both_sides(scene: &Scene) -> Self {
        let mut surface = Self::fronts(scene, &Detail::of_keys(&scene.bake));
        surface.add_backs(&surface.visible_backs(Level::detect()));
        surface
    }

    /// Marks the front vertices whose back can be seen or lit.
    pub(crate) fn visible_backs(&self, level: Level) -> Vec<bool> {
        sides::visible_backs(self, level)
    }

    /// The same by about `most_rays` rays in all, and how many times as many
    /// [`Self::visible_backs`] traces: 1 where the answer is its answer.
    pub(crate) fn about_visible_backs(&self, level: Level, most_rays: usize) -> (Vec<bool>, f64) {
        sides::about_visible_backs(self, level, most_rays)
    }

    /// Per vertex of both sides, the points of its area that are not inside a
    /// closed body, a bit each.
    pub(crate) fn open_points(&self, level: Level) -> Vec<u8> {
        sides::open_points(self, level)
    }

    /// Gives the marked front vertices a back side.
    pub(crate) fn add_backs(&mut self, wanted: &[bool]) {
        self.vertices.add_backs(wanted);
    }

    /// The point of a vertex's area for two uniforms.
    pub(crate) fn sample_point(&self, vertex: usize, u: [f32; 2]) -> SurfacePoint {
        self.vertices.sample_point(&self.mesh, vertex, u)
    }

    /// A point of a triangle, seen from one side.
    pub(crate) fn point(&self, triangle: u32, barycentrics: [f32; 3], front: bool) -> SurfacePoint {
        vertices::surface_point(&self.mesh, triangle, barycentrics, front)
    }

    /// Where light that leaves `from` in a direction (unit) arrives; `None`: it
    /// escapes.
    pub(crate) fn arrival(
        &self,
        level: Level,
        from: &SurfacePoint,
        direction: Vec3,
    ) -> Option<Arrival> {
        arrive(&self.mesh, &self.rays, level, from, direction)
    }
}

fn arrive(
    mesh: &LightingMesh,
    rays: &RayTree,
    level: Level,
    from: &SurfacePoint,
    direction: Vec3,
) -> Option<Arrival> {
    let origin = offset_origin(from.position, from.flat_normal, direction);
    let hit = rays.closest(
        level,
        &Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        },
    )?;
    let front = mesh.triangles[hit.triangle as usize]
        .flat_normal
        .dot(direction)
        < 0.0;
    Some(Arrival {
        triangle: hit.triangle,
        barycentrics: hit.barycentrics,
        front,
    })
}
