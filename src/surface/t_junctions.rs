//! T-junctions of the input: a corner in the middle of somebody else's edge.
//! They are left as they are (rays may slip through a crack of rounding width)
//! and reported.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

use super::mesh::{LightingMesh, NONE};
use super::vertices::MeshEdge;
use crate::maths::order::Order;
use crate::scene::Placement;

/// A corner closer than this to an edge lies on it, placed units.
const ON_EDGE: f32 = 2e-6;
/// Cells a unit length of the grid that finds corners near an edge.
const CELLS: f32 = 64.0;

/// One sentence with the number of T-junctions and the first place, if any.
pub(super) fn report(
    mesh: &LightingMesh,
    edges: &[MeshEdge],
    placement: &Placement,
) -> Option<String> {
    let found = find(mesh, edges);
    let first = placement.file_from_placed(*found.first()?);
    Some(format!(
        "{} T-junctions in the mesh (a corner inside another face's edge), the first at ({:.6}, {:.6}, {:.6}); light may leak there",
        found.len(),
        first.x,
        first.y,
        first.z
    ))
}

/// Positions of corners inside border edges, in the order of the corners. Those that
/// cuts along contacts have made are none: what touches there is not joined.
fn find(mesh: &LightingMesh, edges: &[MeshEdge]) -> Vec<Vec3> {
    let borders: Vec<[u32; 2]> = edges
        .iter()
        .filter(|e| e.triangles[1] == NONE)
        .map(|e| e.corners)
        .collect();
    let mut corners: Vec<u32> = borders.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let mut of_contacts: Vec<u32> = mesh.contacts.iter().flatten().copied().collect();
    of_contacts.sort_unstable();
    corners.retain(|corner| of_contacts.binary_search(corner).is_err());
    let mut grid: HashMap<IVec3, Vec<u32>> = HashMap::new();
    for &corner in &corners {
        grid.entry(cell(mesh.positions[corner as usize]))
            .or_default()
            .push(corner);
    }
    let mut found: Vec<u32> = Vec::new();
    for edge in &borders {
        let [a, b] = edge.map(|c| mesh.positions[c as usize]);
        for cell in cells_along(a, b) {
            let near = grid.get(&cell).into_iter().flatten();
            found.extend(
                near.filter(|&&c| !edge.contains(&c) && lies_on(mesh.positions[c as usize], a, b)),
            );
        }
    }
    found.sort_unstable();
    found.dedup();
    found.iter().map(|&c| mesh.positions[c as usize]).collect()
}

/// Cells that an edge passes, in its direction. Steps of a quarter of a cell
/// may cut a corner; a T-junction missed there is one less in a count.
fn cells_along(a: Vec3, b: Vec3) -> Vec<IVec3> {
    let steps = ((b - a).length() * CELLS * 4.0).ceil().at_least(1.0);
    let at = |step: u32| cell(a + (b - a) * (step as f32 / steps));
    let mut cells: Vec<IVec3> = (0..=steps as u32).map(at).collect();
    cells.dedup();
    cells
}

fn cell(position: Vec3) -> IVec3 {
    (position * CELLS).floor().as_ivec3()
}

fn lies_on(point: Vec3, a: Vec3, b: Vec3) -> bool {
    let (along, to_point) = (b - a, point - a);
    let share = to_point.dot(along) / along.length_squared();
    share > 0.0 && share < 1.0 && (to_point - along * share).length() < ON_EDGE
}
