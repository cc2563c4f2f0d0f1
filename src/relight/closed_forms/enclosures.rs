//! Closed rooms: what goes round and round and cannot get out.

use std::f64::consts::PI;
use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use super::{Baked, Deviation, at_most, largest};
use crate::maths::functions::{acos, pow};
use crate::scene::Bounces;
use crate::scene::sample_scenes::{cube_room, hollow_sphere, point_light, room_with_blocks};

/// Furnace: constant light is exact by construction (constant response), so
/// all that may remain is a ray that slips through a seam and single precision
/// summed over 1 / (1 - rho) = 100 bounces.
const FURNACE: f64 = 1e-3;
/// One emitting face: sampling noise of one row and its compression; the
/// sources of error of any bounce, on a step of brightness along an edge. 1.5 % is
/// measured (root mean square, opposite).
pub(super) const ONE_FACE: f64 = 0.03;
/// All that one face sends arrives: the bias that compression leaves in a sum
/// over a room; 5e-4 is measured.
const CAUGHT: f64 = 2e-3;
/// The hollow sphere and the cube: noise and compression after averaging over
/// bounces. 0.6 % is measured in the sphere, 0.3 % in the cube.
pub(super) const ENCLOSED_LIGHT: f64 = 0.02;

/// 10 m, 17 vertices along an edge, with the diagonals' midpoints.
pub(super) static CUBE: LazyLock<Baked> = LazyLock::new(|| Baked::new(&cube_room(10.0, 0.9, 1024)));
/// 1 m, 4,842 vertices.
pub(super) static SPHERE: LazyLock<Baked> =
    LazyLock::new(|| Baked::new(&hollow_sphere(1.0, 22, 1024)));

/// Le (1 + rho + ... + rho^n), or its limit.
pub(super) fn furnace_radiance(albedo: f64, bounces: Bounces) -> f64 {
    match bounces {
        Bounces::Count(n) => (1.0 - pow(albedo, f64::from(n) + 1.0)) / (1.0 - albedo),
        Bounces::All => 1.0 / (1.0 - albedo),
    }
}

fn furnace_error(room: &Baked, albedo: f32, bounces: Bounces) -> f64 {
    let source = vec![Vec3::splat(PI as f32); room.vertex_count()];
    let irradiance = room.solve(&source, albedo, bounces);
    let wanted = furnace_radiance(f64::from(albedo), bounces);
    let off = |v: usize| {
        let radiance = 1.0 + f64::from(albedo) * f64::from(irradiance[v].x) / PI;
        (radiance / wanted - 1.0).abs()
    };
    largest(room.fronts().map(off))
}

#[test]
fn a_furnace_glows_evenly() {
    let blocks = Baked::new(&room_with_blocks(true, 0.15, 256));
    for (name, room) in [("cube", &*CUBE), ("sphere", &*SPHERE), ("blocks", &blocks)] {
        for albedo in [0.0, 0.5, 0.9, 0.99] {
            for bounces in [1, 8].map(Bounces::Count) {
                let what = format!("furnace, {name}, albedo {albedo}, {bounces:?}");
                at_most(&what, furnace_error(room, albedo, bounces), FURNACE);
            }
            let what = format!("furnace, {name}, albedo {albedo}, all bounces");
            at_most(&what, furnace_error(room, albedo, Bounces::All), FURNACE);
        }
    }
}

/// Irradiance over radiosity at a point that a square of side 2 `half`, around
/// the x axis at x = -`half`, sends (Lambert's formula; the whole square must
/// be above the horizon).
pub(super) fn form_factor_of_face(point: DVec3, normal: DVec3, half: f64) -> f64 {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    let to = corners.map(|(y, z)| (DVec3::new(-half, y, z) - point).normalize());
    let edges = (0..4).map(|k| (to[k], to[(k + 1) % 4]));
    let sum: f64 = edges
        .map(|(a, b)| {
            let axis = a.cross(b).normalize_or_zero();
            acos(a.dot(b)) * axis.dot(normal)
        })
        .sum();
    sum.abs() / (2.0 * PI)
}

#[test]
fn one_emitting_face_lights_the_others_as_form_factors_say() {
    let (half, cell) = (5.0, 0.625);
    let emits = |v: usize| CUBE.normal(v).x > 0.9 && v < CUBE.fronts().end;
    let source: Vec<Vec3> = (0..CUBE.vertex_count())
        .map(|v| Vec3::splat(f32::from(u8::from(emits(v)))))
        .collect();
    let irradiance = CUBE.apply(&source);
    let value = |v: usize| f64::from(irradiance[v].x);
    // Patch to patch: two parallel and two perpendicular unit squares.
    for (name, facing, wanted) in [("opposite", -1.0, 0.199_82), ("adjacent", 0.0, 0.200_04)] {
        let on_face = |&v: &usize| (CUBE.normal(v).x - facing).abs() < 0.1;
        let mean = Deviation::of(
            CUBE.fronts()
                .filter(on_face)
                .map(|v| (CUBE.area(v), value(v), wanted)),
        )
        .mean;
        at_most(
            &format!("one face emits, {name} patch"),
            mean.abs(),
            ONE_FACE,
        );
        // Vertices, by the mean of their areas. Those beside the emitting face
        // stand apart: they see a step of brightness within one edge.
        let is_beside = |v: usize| CUBE.position(v).x + half < 1.01 * cell;
        for (which, beside) in [("away from the edge", false), ("on the edge", true)] {
            let chosen: Vec<usize> = CUBE
                .fronts()
                .filter(|v| on_face(v) && is_beside(*v) == beside)
                .collect();
            if chosen.is_empty() {
                continue;
            }
            let at_vertices = Deviation::of(chosen.into_iter().map(|v| {
                let at = |point, normal| form_factor_of_face(point, normal, half);
                (CUBE.area(v), value(v), CUBE.area_mean(v, at))
            }));
            let what = format!(
                "one face emits, {name} vertices {which}, mean {:+.4}, worst {:.4}, rms",
                at_vertices.mean, at_vertices.worst
            );
            at_most(&what, at_vertices.rms, ONE_FACE);
        }
    }
    // 4 x 0.20004 + 0.19982 = 1: what the face sends arrives, and nowhere else.
    let arrived: f64 = CUBE.fronts().map(|v| CUBE.area(v) * value(v)).sum();
    let sent: f64 = CUBE
        .fronts()
        .filter(|&v| emits(v))
        .map(|v| CUBE.area(v))
        .sum();
    at_most(
        "one face emits, what does not arrive",
        (arrived / sent - 1.0).abs(),
        CAUGHT,
    );
    let itself = CUBE.fronts().filter(|&v| emits(v)).map(|v| value(v).abs());
    at_most("one face emits, light on itself", largest(itself), 0.0);
}

/// Luminance of the cube of 10 m with 50,000 cd in its centre and albedo 2/3:
/// a place by the absolute coordinates of a face, in units of 5 m.
const CUBE_LUMINANCE: [(&str, [f64; 2], f64); 3] = [
    ("face centre", [0.0, 0.0], 892.8),
    ("half way to an edge", [0.0, 0.5], 768.8),
    ("half way to a corner", [0.5, 0.5], 686.8),
];

#[test]
fn a_cube_with_a_lamp_in_its_centre_has_the_published_luminance() {
    let (intensity, albedo) = (50_000.0, 2.0_f32 / 3.0);
    let lights = [point_light(DVec3::ZERO, intensity)];
    let irradiance = CUBE.indirect(&lights, albedo, Bounces::All);
    let direct = CUBE.direct(&lights);
    let luminance = |e: f64| e * f64::from(albedo) / PI;
    let mean = Deviation::of(CUBE.fronts().map(|v| {
        let e = f64::from(irradiance[v].x + direct[v].x);
        (CUBE.area(v), luminance(e), 2000.0 / 3.0)
    }));
    at_most("cube with a lamp, mean", mean.mean.abs(), ENCLOSED_LIGHT);
    for (name, place, wanted) in CUBE_LUMINANCE {
        let mut offs = Vec::new();
        for v in CUBE.fronts() {
            let (point, normal) = (CUBE.position(v) / 5.0, CUBE.normal(v).as_dvec3());
            let mut along: Vec<f64> = (0..3)
                .filter(|&k| normal[k].abs() < 0.5)
                .map(|k| point[k].abs())
                .collect();
            along.sort_by(f64::total_cmp);
            if (along[0] - place[0]).abs() + (along[1] - place[1]).abs() < 1e-4 {
                // Direct light of the point itself, not of the vertex's area.
                let to_light = -CUBE.position(v);
                let cosine = to_light.normalize().dot(normal);
                let at_point = f64::from(intensity) * cosine / to_light.length_squared();
                offs.push(luminance(at_point + f64::from(irradiance[v].x)) / wanted - 1.0);
            }
        }
        assert!(offs.len() >= 6, "{name}: {} vertices", offs.len());
        let worst = largest(offs.iter().map(|off| off.abs()));
        let mean = offs.iter().sum::<f64>() / offs.len() as f64;
        at_most(
            &format!(
                "cube with a lamp, {name}s, mean {mean:+.4}, worst of {}",
                offs.len()
            ),
            worst,
            ENCLOSED_LIGHT,
        );
    }
}
