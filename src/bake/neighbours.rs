//! Which lighting vertices are neighbours on the surface.

use super::graph::VertexGraph;
use crate::surface::{NONE, Surface};

/// Cost of an edge of mean length between vertices of equal normals.
const MEAN_EDGE_COST: f32 = 64.0;

/// Vertices of one triangle and side are neighbours; an edge costs its length
/// times a factor for the angle between the normals.
pub(super) fn vertex_graph(surface: &Surface) -> VertexGraph {
    let positions = surface.vertices.positions();
    let normals = surface.vertices.normals();
    let mut pairs = Vec::new();
    for triangle in 0..surface.mesh.triangles.len() as u32 {
        for front in [true, false] {
            let corners = surface.vertices.of_triangle(triangle, front);
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if a != NONE && b != NONE && a != b {
                    pairs.push((a.min(b), a.max(b)));
                }
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let length = |a: u32, b: u32| (positions[a as usize] - positions[b as usize]).length();
    let total: f64 = pairs.iter().map(|&(a, b)| f64::from(length(a, b))).sum();
    let mean = (total / pairs.len().max(1) as f64) as f32;
    let edges = pairs.into_iter().map(|(a, b)| {
        let cost = (length(a, b) / mean * MEAN_EDGE_COST).clamp(1.0, 1e6) as u32;
        (
            a,
            b,
            cost * angle_class(normals[a as usize].dot(normals[b as usize])),
        )
    });
    let edges: Vec<(u32, u32, u32)> = edges.collect();
    VertexGraph::from_edges(surface.vertices.len() as u32, &edges)
        .expect("triangles name vertices that exist")
}

/// 1, 2 or 4 for normals within 5 degrees, within 15, or farther apart.
fn angle_class(cosine: f32) -> u32 {
    if cosine > 0.9962 {
        1
    } else if cosine > 0.9659 {
        2
    } else {
        4
    }
}
