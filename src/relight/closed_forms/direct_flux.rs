//! Half of a small light's flux falls on a wide plane, however near the light
//! is. The plane's vertices sample that, by eight points each or, close to the light,
//! by pieces of their triangles. (A spot narrower than the points are apart is still
//! only sampled.)

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{at_most, largest, update};
use crate::maths::functions::acos;
use crate::relight::kept::KeptDirect;
use crate::scene::PlacedLights;
use crate::scene::Scene;
use crate::scene::sample_scenes::{Facing, SampleMesh, point_light};
use crate::surface::{Detail, Surface};

const HALF: f64 = 2.0;
const EDGE: f64 = 0.125;
/// Heights of the light in edges.
const HEIGHTS: [f64; 8] = [8.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.05, 0.01];
/// From so many edges on a light is far: irradiance is smooth over a vertex's area.
const FAR: f64 = 2.0;
/// Error under a far light, worst of its places: eight points a vertex leave 0.13 %.
const OF_FAR: f64 = 0.003;
/// The same under a near one, whose spot of light is no wider than a vertex's area:
/// the pieces of triangles leave 0.7 to 1.3 %.
const OF_NEAR: f64 = 0.02;

fn plane() -> Scene {
    let mut mesh = SampleMesh::default();
    let corners = [DVec3::new(-HALF, 0.0, -HALF), DVec3::new(HALF, 1.0, HALF)];
    mesh.box_sides(corners, Facing::Inward, &[(1, false)], 0);
    mesh.scene(&[0.5], EDGE, 64)
}

/// Flux on the square under a light of 1 W/sr at (x, height, z): its solid
/// angle, by the angles of its four corner rectangles.
fn flux_on_plane(light: DVec3) -> f64 {
    let corner = |a: f64, b: f64| {
        let h = light.y;
        let sine = a * b / ((a * a + h * h).sqrt() * (b * b + h * h).sqrt());
        PI / 2.0 - acos(sine)
    };
    let mut sum = 0.0;
    for a in [HALF - light.x, HALF + light.x] {
        for b in [HALF - light.z, HALF + light.z] {
            sum += corner(a, b);
        }
    }
    sum
}

#[test]
fn a_wide_plane_catches_half_the_flux() {
    let scene = plane();
    let surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
    let scale = surface.placement.scale;
    for height in HEIGHTS {
        let mut errors = Vec::new();
        // Sixteen places within one cell: over corners, edges and triangles.
        for place in 0..16 {
            let (i, j) = (f64::from(place % 4), f64::from(place / 4));
            let light = DVec3::new(0.031 * i + 0.003, height * EDGE, 0.031 * j + 0.001);
            let placed = PlacedLights::of_file(&[point_light(light, 1.0)], &surface.placement);
            let mut kept = KeptDirect::default();
            update(&mut kept, &surface, &placed);
            let (irradiance, _): (&[Vec3], _) = kept.sum(surface.vertices.len());
            let areas = surface.vertices.areas();
            let caught: f64 = irradiance
                .iter()
                .zip(areas)
                .map(|(e, &a)| f64::from(e.x) * f64::from(a))
                .sum();
            errors.push(caught / (scale * scale) / flux_on_plane(light) - 1.0);
        }
        let mean = errors.iter().map(|e| e.abs()).sum::<f64>() / 16.0;
        let worst = largest(errors.iter().map(|e| e.abs()));
        let what = format!("flux on a plane, light {height} edges high, mean {mean:.4}, worst");
        let limit = if height >= FAR { OF_FAR } else { OF_NEAR };
        at_most(&what, worst, limit);
    }
}
