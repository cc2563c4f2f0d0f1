//! Bodies of one outline all along: quads in the plane of x and y, extruded
//! along z.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::body::{Body, Face, Shape};

/// The solid between two planes of z. The quads run counter-clockwise seen from
/// high z, and neighbours share whole edges.
pub(crate) fn extruded(
    name: &'static str,
    material: &'static str,
    quads: &[[DVec2; 4]],
    [low_z, high_z]: [f64; 2],
) -> Body {
    let mut outline: Vec<DVec2> = Vec::new();
    let mut index_of = |point: DVec2| {
        let known = outline.iter().position(|&other| other == point);
        known.unwrap_or_else(|| {
            outline.push(point);
            outline.len() - 1
        })
    };
    let fronts: Vec<[usize; 4]> = quads.iter().map(|quad| quad.map(&mut index_of)).collect();

    // Positions of the front plane come first, then those of the back plane.
    let count = outline.len();
    let mut faces = Vec::new();
    for [a, b, c, d] in &fronts {
        faces.push(vec![*a, *b, *c, *d]);
        faces.push([d, c, b, a].map(|corner| corner + count).to_vec());
    }
    for [from, to] in border(&fronts) {
        faces.push(vec![to, from, from + count, to + count]);
    }
    let plane = |z: f64| outline.iter().map(move |point| point.extend(z));
    let positions: Vec<DVec3> = plane(high_z).chain(plane(low_z)).collect();
    Body {
        name,
        shape: Shape::Solid,
        positions,
        normals: None,
        faces: faces
            .into_iter()
            .map(|corners| Face { material, corners })
            .collect(),
    }
}

/// Edges that belong to one quad alone, in its direction.
fn border(quads: &[[usize; 4]]) -> Vec<[usize; 2]> {
    let edges: BTreeSet<[usize; 2]> = quads
        .iter()
        .flat_map(|quad| (0..4).map(|k| [quad[k], quad[(k + 1) % 4]]))
        .collect();
    let is_single = |&[from, to]: &[usize; 2]| !edges.contains(&[to, from]);
    edges.iter().copied().filter(is_single).collect()
}
