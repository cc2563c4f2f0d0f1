//! How finely the mesh is cut: the longest edge that stays whole.

use super::mesh::LightingMesh;
use super::vertices::{Joints, LightingVertices, join};
use crate::maths::order::Order;
use crate::scene::{BakeKeys, Placement, Scene};

/// Default longest edge, share of the scene's longest side.
const DEFAULT_EDGE: f64 = 1.0 / 40.0;
/// Default edges shrink until there are this many lighting vertices.
const LEAST_VERTICES: usize = 4_000;
/// Tessellation makes no more vertices than this unless the user says so.
const MOST_VERTICES: usize = 500_000;
/// Pieces that are certainly too many, for each vertex that is allowed.
const PIECES_PER_VERTEX: f64 = 8.0;
/// Nothing in a placed scene is longer, placed units.
const LONGEST_EDGE: f32 = 4.0;
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
    let finest = finest_edge(scene, placement, most);
    let mut edge =
        f64::at_least(wanted * placement.scale, finest).at_most(f64::from(LONGEST_EDGE)) as f32;
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

/// Placed edges below this length would certainly make several times `most`
/// vertices: a bound before anything is cut, from the areas and the longest
/// edges of the triangles.
fn finest_edge(scene: &Scene, placement: &Placement, most: usize) -> f64 {
    let pieces = (most as f64) * PIECES_PER_VERTEX;
    let (mut area, mut length) = (0.0, 0.0);
    for triangle in &scene.mesh.triangles {
        let [a, b, c] = triangle
            .corners
            .map(|i| scene.mesh.positions[i as usize] * placement.scale);
        area += 0.5 * (b - a).cross(c - a).length();
        length += (b - a)
            .length()
            .at_least((c - b).length())
            .at_least((a - c).length());
    }
    // A piece with no edge above e has at most 0.433 e^2 of area.
    (area / (0.433 * pieces)).sqrt().at_least(length / pieces)
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
