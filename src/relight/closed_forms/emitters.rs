//! Surfaces that emit: enclosed, exchanged for rectangles, and very many.

use std::time::Instant;

use glam::{DVec3, Vec3};

use super::{at_most, frame_of, frames_of, largest};
use crate::frame::{Image, compare};
use crate::relight::Component;
use crate::scene::sample_scenes::{BOX_SIDES, Facing, SampleMesh, cube_room, lamp_facing_down};
use crate::scene::{Bounces, Scene};

/// Furnace, mean of the picture: direct light is a closed form, and constant
/// light is kept by the operator; shadow rays along edges are left.
const FURNACE_MEAN: f64 = 5e-3;
/// Furnace, worst pixel.
const FURNACE_WORST: f64 = 0.02;
/// A lamp of triangles against a rectangle, means of 8 x 8 pixels of the whole
/// picture.
const EXCHANGED: f64 = 0.01;
/// The same of indirect light alone. The transfer does not know a rectangle: the
/// mesh's black lamp takes 0.16 % of the light of every bounce, 0.5 % of their
/// sum, and another mesh has other noise.
const EXCHANGED_INDIRECT: f64 = 0.015;
/// Ten thousand emitters against one of their power, means of 8 x 8 pixels:
/// tiles 1/70 apart are a smooth ceiling to points half a metre away.
const MANY: f64 = 0.01;
/// Seconds that a frame of ten thousand emitters may take on a busy machine.
const MANY_SECONDS: f64 = 20.0;

#[test]
fn a_furnace_of_emitting_walls_is_le_over_1_minus_rho() {
    for albedo in [0.5_f32, 0.9] {
        let mut scene = cube_room(2.0, 0.25, 512);
        scene.materials[0].albedo = Vec3::splat(albedo);
        scene.materials[0].emission = Vec3::ONE;
        scene.render.bounces = Bounces::All;
        scene.camera.size = [48, 48];
        let image = frame_of(&scene, Component::Global);
        let wanted = 1.0 / (1.0 - f64::from(albedo));
        let ratios = image.pixels().iter().map(|p| f64::from(p.x) / wanted);
        let mean = ratios.clone().sum::<f64>() / image.pixels().len() as f64;
        let worst = largest(ratios.map(|r| (r - 1.0).abs()));
        let what = format!("furnace of emitters, albedo {albedo}");
        at_most(
            &format!("{what}, mean {mean:.5}, off by"),
            (mean - 1.0).abs(),
            FURNACE_MEAN,
        );
        at_most(&format!("{what}, worst pixel"), worst, FURNACE_WORST);
    }
}

/// Corners of the lamp below the ceiling.
const LAMP: [DVec3; 2] = [DVec3::new(-0.1, 0.99, -0.1), DVec3::new(0.1, 0.99, 0.1)];
const LAMP_RADIANCE: f32 = 40.0;

/// A closed room with a block and, if asked for, a lamp of the mesh.
fn box_room(has_lamp: bool) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.box_sides([DVec3::NEG_ONE, DVec3::ONE], Facing::Inward, &BOX_SIDES, 0);
    let block = [DVec3::new(-0.6, -0.9, -0.5), DVec3::new(-0.1, 0.1, 0.0)];
    mesh.box_sides(block, Facing::Outward, &BOX_SIDES, 1);
    if has_lamp {
        let [lower, upper] = LAMP;
        let corners = [lower, DVec3::new(upper.x, upper.y, upper.z)];
        // The low side of a box that faces outward looks down.
        mesh.box_sides(corners, Facing::Outward, &[(1, false)], 2);
    }
    let mut scene = mesh.scene(&[0.7, 0.5, 0.0], 0.2, 512);
    scene.materials[2].emission = Vec3::splat(LAMP_RADIANCE);
    scene.camera.position = DVec3::new(0.3, 0.1, 0.95);
    scene.camera.target = DVec3::new(0.0, 0.0, -1.0);
    scene
}

/// Difference of block means, relative L2, and of the pictures' means.
fn difference(reference: &Image, candidate: &Image) -> [f64; 2] {
    let found = compare(&reference.block_means(8), &candidate.block_means(8)).unwrap();
    [found.relative_rmse, found.bias]
}

#[test]
fn a_rectangle_stands_for_an_emitter_of_its_shape() {
    let emitter = box_room(true);
    let mut rectangle = box_room(false);
    rectangle.lights = vec![lamp_facing_down(LAMP[0], LAMP[1], LAMP_RADIANCE)];
    let components = [Component::Direct, Component::Indirect, Component::Global];
    let limits = [EXCHANGED, EXCHANGED_INDIRECT, EXCHANGED];
    let [of_emitter, of_rectangle] =
        [&emitter, &rectangle].map(|scene| frames_of(scene, components));
    for (index, (component, limit)) in components.into_iter().zip(limits).enumerate() {
        let (of_emitter, of_rectangle) = (&of_emitter[index], &of_rectangle[index]);
        let mean = of_emitter.pixels().iter().map(|p| p.x).sum::<f32>() / 4096.0;
        assert!(mean > 0.02, "{component:?}: the picture is dark, {mean}");
        let [error, bias] = difference(of_emitter, of_rectangle);
        let what = format!("rectangle for an emitter, {component:?}, bias {bias:+.4}, relRMSE");
        at_most(&what, error, limit);
    }
}

/// Tiles along a side of the ceiling: two triangles each.
const TILES: u32 = 71;

/// A floor with a block under a ceiling of 2 m whose tiles emit on their lower
/// sides: `tiles` a side, each of a share of the width that is its own.
fn under_ceiling(tiles: u32, share: f64) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.box_sides(
        [DVec3::NEG_ONE, DVec3::ONE],
        Facing::Inward,
        &[(1, false)],
        0,
    );
    let block = [DVec3::new(-0.3, -0.9, -0.4), DVec3::new(0.2, 0.0, 0.1)];
    mesh.box_sides(block, Facing::Outward, &BOX_SIDES, 0);
    let width = 2.0 / f64::from(tiles);
    for (i, j) in (0..tiles * tiles).map(|k| (f64::from(k % tiles), f64::from(k / tiles))) {
        let middle = DVec3::new(i + 0.5, 0.0, j + 0.5) * width - DVec3::new(1.0, -1.0, 1.0);
        let half = DVec3::new(0.5, 0.0, 0.5) * (width * share);
        let corners = [middle - half, middle + half];
        mesh.box_sides(corners, Facing::Outward, &[(1, false)], 1);
    }
    let mut scene = mesh.scene(&[0.7, 0.0], 0.25, 64);
    scene.materials[1].emission = Vec3::splat((1.0 / (share * share)) as f32);
    scene.render.bounces = Bounces::Count(0);
    scene.camera.size = [64, 48];
    scene.camera.position = DVec3::new(0.4, 0.3, 1.6);
    scene.camera.target = DVec3::new(0.0, -0.9, 0.0);
    scene.camera.vfov_deg = 50.0;
    scene
}

#[test]
fn ten_thousand_emitters_light_like_one_of_their_power() {
    let one = frame_of(&under_ceiling(1, 1.0), Component::Irradiance);
    for share in [1.0, 0.5] {
        let scene = under_ceiling(TILES, share);
        let start = Instant::now();
        let many = frame_of(&scene, Component::Irradiance);
        let seconds = start.elapsed().as_secs_f64();
        let [error, bias] = difference(&one, &many);
        let what = format!("{} emitters, bias {bias:+.4}, relRMSE", 2 * TILES * TILES);
        at_most(&what, error, MANY);
        at_most("seconds of their frame", seconds, MANY_SECONDS);
    }
}
