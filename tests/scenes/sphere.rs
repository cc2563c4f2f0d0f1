//! A sphere seen from inside.

use std::collections::BTreeMap;

use glam::DVec3;

use super::body::{Body, Face, Shape};
use super::model::{Material, Model};

/// Times that every triangle of the icosahedron is cut into four.
const SUBDIVISIONS: usize = 4;

/// The sphere of radius 1 around the origin, fronts inward.
pub(crate) fn model() -> Model {
    let (positions, triangles) = icosphere(SUBDIVISIONS);
    let face = |[a, b, c]: [usize; 3]| Face {
        material: "grey",
        corners: vec![a, c, b],
    };
    let sphere = Body {
        name: "sphere",
        shape: Shape::Hollow,
        normals: Some(positions.iter().map(|&position| -position).collect()),
        positions,
        faces: triangles.into_iter().map(face).collect(),
    };
    let materials = vec![Material::plain("grey", [0.5, 0.5, 0.5])];
    Model::new(
        "sphere",
        "A sphere seen from inside",
        materials,
        vec![sphere],
    )
}

/// Positions and triangles, fronts outward, on the unit sphere: an icosahedron
/// whose triangles are cut into four so many times.
pub(crate) fn icosphere(subdivisions: usize) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let mut positions = icosahedron_corners();
    let mut triangles = ICOSAHEDRON.to_vec();
    for _ in 0..subdivisions {
        triangles = subdivide(&mut positions, &triangles);
    }
    (positions, triangles)
}

/// Corners on the unit sphere: three golden rectangles.
fn icosahedron_corners() -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for axis in 0..3 {
        for (short, long) in [
            (-1.0, -golden),
            (1.0, -golden),
            (-1.0, golden),
            (1.0, golden),
        ] {
            let mut corner = [0.0; 3];
            corner[axis] = short;
            corner[(axis + 1) % 3] = long;
            corners.push(DVec3::from_array(corner).normalize());
        }
    }
    corners
}

/// Cuts each triangle into four at the middles of its edges.
fn subdivide(positions: &mut Vec<DVec3>, triangles: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: usize, b: usize| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a] + positions[b]).normalize());
            positions.len() - 1
        })
    };
    let mut smaller = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        smaller.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    smaller
}

/// Its triangles, fronts outward.
const ICOSAHEDRON: [[usize; 3]; 20] = [
    [0, 4, 1],
    [0, 1, 6],
    [0, 8, 4],
    [0, 6, 9],
    [0, 9, 8],
    [1, 4, 10],
    [1, 11, 6],
    [1, 10, 11],
    [2, 3, 5],
    [2, 7, 3],
    [2, 5, 8],
    [2, 9, 7],
    [2, 8, 9],
    [3, 10, 5],
    [3, 7, 11],
    [3, 11, 10],
    [4, 8, 5],
    [4, 5, 10],
    [6, 7, 9],
    [6, 11, 7],
];
