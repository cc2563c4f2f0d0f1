//! How finely the mesh is cut: the longest edge that stays whole.

use super::mesh::LightingMesh;
use super::vertices::{Joints, LightingVertices, join};
use crate::scene::{BakeKeys, Placement, Scene};

/// Default longest edge, share of the scene's longest side.
const DEFAULT_EDGE: f64 = 1.0 / 40.0;
/// Default edges shrink until there are this many lighting vertices.
const LEAST_VERTICES: usize = 4_000;
/// Tessellation makes no more vertices than this unless the user says so.
const MOST_VERTICES: usize = 500_000;
/// Factor between two edge lengths that are tried: half the area of a triangle.
const STEP: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// Tries either way; twenty steps are a factor of 1,000 in length.
const MOST_STEPS: usize = 20;

/// What the user asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Detail {
    /// Longest edge left whole, file units.
    max_edge: Option<f64>,
    /// Most lighting vertices (front sides) that tessellation may make.
    most_vertices: Option<usize>,
}

impl Detail {
    /// The detail that `[bake]` asks for.
    pub(crate) fn of_keys(keys: &BakeKeys) -> Self {
        Self {
            max_edge: keys.max_edge,
            most_vertices: keys.vertices.map(|v| v as usize),
        }
    }
}

/// The mesh, how it hangs together, its front vertices, and the longest edge
/// left whole in placed units.
pub(super) fn build(
    scene: &Scene,
    placement: &Placement,
    detail: &Detail,
) -> (LightingMesh, Joints, LightingVertices, f32) {
    let most = detail.most_vertices.unwrap_or(MOST_VERTICES);
    let wanted = detail.max_edge.unwrap_or(DEFAULT_EDGE * placement.extent);
    let mut edge = (wanted * placement.scale) as f32;
    let mut built = cut(scene, placement, edge);
    if detail.max_edge.is_none() {
        for _ in 0..MOST_STEPS {
            if built.2.len() >= LEAST_VERTICES.min(most) {
                break;
            }
            let finer = cut(scene, placement, edge * STEP);
            if finer.2.len() > most {
                break;
            }
            edge *= STEP;
            built = finer;
        }
    }
    // Finer than allowed: cut less, but never coarsen what the file has.
    for _ in 0..MOST_STEPS {
        if built.2.len() <= most || built.0.triangles.len() <= scene.mesh.triangles.len() {
            break;
        }
        edge /= STEP;
        built = cut(scene, placement, edge);
    }
    (built.0, built.1, built.2, edge)
}

fn cut(
    scene: &Scene,
    placement: &Placement,
    edge: f32,
) -> (LightingMesh, Joints, LightingVertices) {
    let mesh = LightingMesh::build(scene, placement, edge);
    let joints = join(&mesh);
    let vertices = LightingVertices::fronts(&mesh, &joints);
    (mesh, joints, vertices)
}
