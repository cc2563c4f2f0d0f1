//! Curved bodies: rings of points, each joined to the next.

use glam::DVec3;

use super::body::{Body, Face, Shape};

/// A closed body from its first pole over rings of equal length to its last
/// pole. Seen along the way from pole to pole the rings run clockwise: outward
/// x along the ring = backward.
pub(crate) fn between_poles(
    name: &'static str,
    material: &'static str,
    poles: [DVec3; 2],
    rings: &[Vec<DVec3>],
) -> Body {
    let count = rings[0].len();
    let last = rings.len() - 1;
    let mut positions: Vec<DVec3> = rings.concat();
    let [first_pole, last_pole] = [positions.len(), positions.len() + 1];
    positions.extend(poles);

    let mut faces = Vec::new();
    for k in 0..count {
        let next = (k + 1) % count;
        faces.push(vec![first_pole, next, k]);
        faces.push(vec![last_pole, last * count + k, last * count + next]);
    }
    for ring in 0..last {
        join(
            &positions,
            [ring * count, (ring + 1) * count],
            count,
            &mut faces,
        );
    }
    smooth_solid(name, material, positions, faces)
}

/// A closed tube: the last ring is joined to the first.
pub(crate) fn tube(name: &'static str, material: &'static str, rings: &[Vec<DVec3>]) -> Body {
    let count = rings[0].len();
    let positions = rings.concat();
    let mut faces = Vec::new();
    for ring in 0..rings.len() {
        let next = (ring + 1) % rings.len();
        join(&positions, [ring * count, next * count], count, &mut faces);
    }
    smooth_solid(name, material, positions, faces)
}

/// Quads between two rings, given by the indices of their first points.
fn join(positions: &[DVec3], starts: [usize; 2], count: usize, faces: &mut Vec<Vec<usize>>) {
    let [lower, upper] = starts;
    for k in 0..count {
        let next = (k + 1) % count;
        let quad = [lower + k, lower + next, upper + next, upper + k];
        faces.push(cut_along_short_diagonal(positions, quad));
    }
}

/// The quad, begun at the corner from which the fan cuts the shorter diagonal.
fn cut_along_short_diagonal(positions: &[DVec3], mut quad: [usize; 4]) -> Vec<usize> {
    let [a, b, c, d] = quad.map(|corner| positions[corner]);
    if b.distance_squared(d) < a.distance_squared(c) {
        quad.rotate_left(1);
    }
    quad.to_vec()
}

fn smooth_solid(
    name: &'static str,
    material: &'static str,
    positions: Vec<DVec3>,
    faces: Vec<Vec<usize>>,
) -> Body {
    let faces = faces
        .into_iter()
        .map(|corners| Face { material, corners })
        .collect();
    Body {
        name,
        shape: Shape::Solid,
        positions,
        normals: None,
        faces,
    }
    .smoothed()
}
