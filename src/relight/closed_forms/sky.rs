//! A constant sky: over a plane, and through the open top of a box. And skies of
//! small bright patches, whose light adds up.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::area::{parallel_corner, perpendicular_corner};
use super::{Baked, Deviation, at_least, at_most, frame_of, largest};
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::relight::Component;
use crate::scene::sample_scenes::{
    BoxSide, Facing, SampleMesh, constant_sky, mapped_sky, room_with_window, sky_light,
};
use crate::scene::{Bounces, Light, PlacedLights, Scene};

/// All rays escape; the response to a constant sky is kept to 1e-6.
const OPEN: f64 = 1e-5;
/// Mean over a side of the box: sampling noise averages out.
const CLOSED_FORM: f64 = 5e-3;
/// Noise of one vertex: 1,024 low-discrepancy rays, of which a seventh to a half
/// escape.
const VERTEX: f64 = 0.025;
/// Light of skies together against the sum of each one's: single precision, share
/// of the largest value.
const LINEAR: f64 = 1e-5;
/// How far below zero the rings of a bright patch go at least, share of the largest
/// value: a clamp of that much would be a hundred times what linearity is held to.
const RINGS: f64 = 1e-3;
/// Points of a vertex's area in the mean that a vertex should have.
const MANY_POINTS: u32 = 64;
/// Radiance of the sky.
const RADIANCE: f32 = 3.0;

/// Sides of a box without a top.
const WITHOUT_TOP: [BoxSide; 5] = [(0, false), (0, true), (1, false), (2, false), (2, true)];

fn plane() -> Scene {
    let mut mesh = SampleMesh::default();
    let corners = [DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 1.0, 2.0)];
    mesh.box_sides(corners, Facing::Inward, &[(1, false)], 0);
    let mut scene = mesh.scene(&[0.5], 0.5, 128);
    scene.lights = vec![constant_sky(RADIANCE)];
    scene.camera.position = DVec3::new(0.1, 1.0, 0.2);
    scene.camera.target = DVec3::ZERO;
    scene.camera.vfov_deg = 60.0;
    scene
}

#[test]
fn a_plane_under_a_constant_sky_receives_pi_l() {
    let scene = plane();
    let wanted = PI * f64::from(RADIANCE);
    let at_vertices = Baked::new(&scene).sky(&scene.lights);
    assert!(!at_vertices.is_empty(), "a plane is open");
    let offs = at_vertices
        .iter()
        .map(|e| (f64::from(e.x) / wanted - 1.0).abs());
    at_most("sky over a plane, worst vertex", largest(offs), OPEN);
    for bounces in [0, 2] {
        let mut scene = scene.clone();
        scene.render.bounces = Bounces::Count(bounces);
        let image = frame_of(&scene, Component::Irradiance);
        let offs = image
            .pixels()
            .iter()
            .map(|p| (f64::from(p.x) / wanted - 1.0).abs());
        let what = format!("sky over a plane, {bounces} bounces, worst pixel");
        at_most(&what, largest(offs), OPEN);
    }
}

/// Form factor from a point of the box of 2 m around the origin to its open top.
fn share_of_sky(point: DVec3, normal: DVec3) -> f64 {
    let above = (1.0 - point.y).at_least(1e-9);
    let reach =
        |axis: usize| [1.0 - point[axis], 1.0 + point[axis]].map(|d| d.at_least(0.0) / above);
    let [along_x, along_z] = [reach(0), reach(2)];
    if normal.y > 0.9 {
        let corners = along_x.map(|a| along_z.map(|b| parallel_corner(a, b)));
        return corners.as_flattened().iter().sum();
    }
    let beside = if normal.x.abs() > 0.9 {
        along_z
    } else {
        along_x
    };
    beside
        .map(|b| perpendicular_corner(2.0 / above, b))
        .iter()
        .sum()
}

#[test]
fn the_sky_looks_into_an_open_box() {
    let mut mesh = SampleMesh::default();
    mesh.box_sides(
        [DVec3::NEG_ONE, DVec3::ONE],
        Facing::Inward,
        &WITHOUT_TOP,
        0,
    );
    let room = Baked::new(&mesh.scene(&[0.5], 0.25, 1024));
    let irradiance = room.sky(&[constant_sky(RADIANCE)]);
    let wanted = |v: usize| {
        let points = ScrambledSobol::new(9, v as u32);
        let at = |k: u32| {
            let point = room.surface.sample_point(v, points.point2(k));
            let place = room.surface.placement.file_from_placed(point.position);
            share_of_sky(place, room.normal(v).as_dvec3())
        };
        (0..MANY_POINTS).map(at).sum::<f64>() / f64::from(MANY_POINTS) * PI * f64::from(RADIANCE)
    };
    for (name, up) in [("floor", 1.0), ("walls", 0.0)] {
        let on_side = |&v: &usize| (f64::from(room.normal(v).y) - up).abs() < 0.1;
        let found = Deviation::of(
            room.fronts()
                .filter(on_side)
                .map(|v| (room.area(v), f64::from(irradiance[v].x), wanted(v))),
        );
        let what = format!("sky into a box, {name}");
        at_most(&format!("{what}, mean"), found.mean.abs(), CLOSED_FORM);
        at_most(
            &format!("{what}, worst {:.4}, rms", found.worst),
            found.rms,
            VERTEX,
        );
    }
}

/// Columns and rows of a map of the sky, and texels along a side of a bright patch:
/// 11 degrees, as a cell of the sky. (One that is narrower, or has few texels, is a sun,
/// which is a light of its own.)
const MAP: [u32; 2] = [256, 128];
const PATCH: u32 = 8;

/// A dark sky with patches of some radiance, each from a column and a row on.
pub(super) fn patchy_sky(name: &str, patches: &[([u32; 2], f32)]) -> Light {
    let radiance = |column: u32, row: u32| {
        let is_in = |first: [u32; 2]| {
            let from_first = [column.wrapping_sub(first[0]), row.wrapping_sub(first[1])];
            from_first.iter().all(|texels| *texels < PATCH)
        };
        let here = patches.iter().filter(|(first, _)| is_in(*first));
        here.map(|(_, radiance)| radiance).sum()
    };
    sky_light(mapped_sky(name, MAP, radiance))
}

#[test]
fn light_of_skies_adds_up() {
    let room = Baked::new(&room_with_window(0.5, true, 0.25, 256));
    let [a, b] = [([52, 40], 20.0), ([68, 60], 30.0)];
    let [of_a, of_b] = [("a", a), ("b", b)].map(|(name, patch)| patchy_sky(name, &[patch]));
    let together = patchy_sky("both", &[a, b]);
    for light in [&of_a, &of_b, &together] {
        let placed = PlacedLights::of_file(std::slice::from_ref(light), &room.surface.placement);
        assert!(placed.suns().is_empty(), "a patch is taken for a sun");
    }
    let [alone_a, alone_b] = [&of_a, &of_b].map(|light| room.sky(std::slice::from_ref(light)));
    let apart: Vec<Vec3> = alone_a.iter().zip(&alone_b).map(|(a, b)| *a + *b).collect();
    let scale = largest(apart.iter().map(|e| f64::from(e.abs().max_element())));
    for (name, alone) in [("a", &alone_a), ("b", &alone_b)] {
        let below = largest(alone.iter().map(|e| f64::from((-*e).max_element())));
        let what = format!("light of sky {name} below zero, share of the largest");
        at_least(&what, below / scale, RINGS);
    }
    for (name, lights) in [("two skies", vec![of_a, of_b]), ("one map", vec![together])] {
        let offs = room.sky(&lights);
        assert_eq!(offs.len(), apart.len(), "{name}: vertices");
        let offs = offs.iter().zip(&apart);
        let offs = offs.map(|(e, sum)| f64::from((*e - *sum).abs().max_element()));
        at_most(
            &format!("{name} against the sum of both"),
            largest(offs) / scale,
            LINEAR,
        );
    }
}
