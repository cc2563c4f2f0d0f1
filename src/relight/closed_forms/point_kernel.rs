//! What a furnace alone cannot see: the kernel of points that radiosity is often
//! first written with, cos cos / (pi r^2) times the sender's area. It loses
//! light where faces meet; divided by the sum of its row it passes any furnace
//! and sends light to the wrong places. The figures of `enclosures` must tell.

use std::f64::consts::PI;

use super::enclosures::{CUBE, ONE_FACE, form_factor_of_face};
use super::{Deviation, at_least, at_most};
use crate::maths::order::Order;

/// What is left of a row where faces meet, against its limit on a fine mesh.
const HALF_ROW: f64 = 0.02;

/// The kernel's rows on the cube of 17 vertices an edge, row-major.
fn point_kernel() -> Vec<f64> {
    let scale = CUBE.surface.placement.scale;
    let places: Vec<_> = CUBE
        .fronts()
        .map(|v| {
            let area = CUBE.area(v) / (scale * scale);
            (CUBE.position(v), CUBE.normal(v).as_dvec3(), area)
        })
        .collect();
    let mut rows = Vec::with_capacity(places.len() * places.len());
    for (here, normal, _) in &places {
        rows.extend(places.iter().map(|(there, other, area)| {
            let between = *there - *here;
            let cosines = between.dot(*normal).at_least(0.0) * (-between.dot(*other)).at_least(0.0);
            let square = between.length_squared();
            if cosines > 0.0 {
                cosines / (PI * square * square) * area
            } else {
                0.0
            }
        }));
    }
    rows
}

/// How many of a cube's edges a vertex lies on, beyond its face's plane.
fn edges_at(vertex: usize) -> usize {
    let place = (CUBE.position(vertex).abs() / 5.0).to_array();
    place.into_iter().filter(|&x| x > 0.999).count() - 1
}

#[test]
fn a_furnace_passes_a_wrong_kernel_that_one_face_betrays() {
    let count = CUBE.fronts().len();
    let rows = point_kernel();
    let sums: Vec<f64> = rows
        .chunks_exact(count)
        .map(|row| row.iter().sum())
        .collect();
    // The two faces at an edge do not see each other's vertices there, nor
    // their own plane: half the hemisphere is left, a quarter in a corner.
    for (name, edges, wanted) in [("an edge", 1, 0.5), ("a corner", 2, 0.25)] {
        let chosen = (0..count).filter(|&v| edges_at(v) == edges);
        let found = Deviation::of(chosen.map(|v| (1.0, sums[v], wanted)));
        let what = format!("point kernel, row at {name}, off {wanted} by");
        at_most(&what, found.mean.abs(), HALF_ROW);
    }
    // Divided by its sum a row is 1: what a furnace sees.
    let emits = |v: usize| CUBE.normal(v).x > 0.9;
    let form_factor = |v: usize| -> f64 {
        let row = rows[v * count..(v + 1) * count].iter().enumerate();
        let sent: f64 = row.filter(|(j, _)| emits(*j)).map(|(_, t)| t).sum();
        sent / sums[v]
    };
    for (name, facing) in [("opposite", -1.0), ("adjacent", 0.0)] {
        let on_face = (0..count).filter(|&v| (CUBE.normal(v).x - facing).abs() < 0.1);
        let found = Deviation::of(on_face.map(|v| {
            let at = |point, normal| form_factor_of_face(point, normal, 5.0);
            (CUBE.area(v), form_factor(v), CUBE.area_mean(v, at))
        }));
        let what = format!(
            "renormalised point kernel, one face emits, {name}, mean {:+.4}, worst {:.4}, rms",
            found.mean, found.worst
        );
        at_least(&what, found.rms, 5.0 * ONE_FACE);
    }
}
