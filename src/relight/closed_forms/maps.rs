//! Maps of the sky: brightness, rotation, scale, and the sun in them.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{Baked, at_most, frame_of, frames_of, largest};
use crate::maths::functions::{cos, sin};
use crate::maths::order::Order;
use crate::relight::Component;
use crate::scene::sample_scenes::{
    BOX_SIDES, Facing, SampleMesh, constant_sky, cube_room, directional_light, mapped_sky,
    room_with_blocks, sky_light,
};
use crate::scene::{Bounces, Environment, Scene};

/// A map of 1 everywhere against a constant 1: rounding of the cells' means.
const UNIFORM: f64 = 1e-3;
/// A quarter of the sky, share of pi L: texels of 5.6 degrees are blended at its
/// borders, and a thing that sees half the sky keeps 48 coefficients of it.
const QUARTER: f64 = 0.03;
/// Scale is a factor: rounding.
const LINEAR: f64 = 1e-6;
/// Pixels in which the shadow of a map's sun and that of parallel light may
/// differ: the sun's is soft over a tenth of the shadow's length, 1.3 degrees.
const PENUMBRA_SHARE: f64 = 0.1;
/// Relative difference of a pixel that counts as such.
const SAME_PIXEL: f64 = 0.01;
/// Mean of the pictures of both.
const SUN_MEAN: f64 = 5e-3;

/// Size of the maps but the sun's.
const SIZE: [u32; 2] = [64, 32];

#[test]
fn a_uniform_map_is_a_constant_sky() {
    let mut scene = room_with_blocks(false, 0.5, 128);
    scene.lights = vec![constant_sky(1.0)];
    let components = [Component::Global, Component::Irradiance];
    let constant = frames_of(&scene, components);
    scene.lights = vec![sky_light(mapped_sky("uniform", SIZE, |_, _| 1.0))];
    let mapped = frames_of(&scene, components);
    for (index, component) in components.into_iter().enumerate() {
        let (constant, mapped) = (&constant[index], &mapped[index]);
        let pairs = constant.pixels().iter().zip(mapped.pixels());
        let off = |(a, b): (&Vec3, &Vec3)| f64::from((a.x - b.x).abs()) / f64::from(a.x);
        let sum = constant.pixels().iter().map(|p| p.x).sum::<f32>();
        assert!(sum > 100.0, "{component:?}: the picture is dark");
        at_most(
            &format!("uniform map, {component:?}, worst pixel"),
            largest(pairs.map(off)),
            UNIFORM,
        );
    }
}

/// Mean irradiance of the faces of a cube in the open under a sky, by the normal
/// of the face.
fn on_faces(cube: &Baked, sky: Environment) -> impl Fn(Vec3) -> f64 {
    let irradiance = cube.sky(&[sky_light(sky)]);
    move |normal| {
        let face = |&v: &usize| cube.normal(v).dot(normal) > 0.9;
        let vertices: Vec<usize> = cube.fronts().filter(face).collect();
        let sum: f64 = vertices.iter().map(|&v| f64::from(irradiance[v].x)).sum();
        sum / vertices.len() as f64
    }
}

fn cube_in_the_open() -> Baked {
    let mut mesh = SampleMesh::default();
    mesh.box_sides([DVec3::ZERO, DVec3::ONE], Facing::Outward, &BOX_SIDES, 0);
    Baked::new(&mesh.scene(&[0.5], 0.5, 1024))
}

/// Irradiance on a wall whose normal is `apart` radians beside the middle of a
/// bright quarter of the sky of radiance 1: the quarter's part before the wall.
fn beside_quarter(apart: f64) -> f64 {
    let quarter = PI / 4.0;
    let (from, to) = (
        f64::at_least(-quarter, apart - PI / 2.0),
        f64::at_most(quarter, apart + PI / 2.0),
    );
    if from >= to {
        return 0.0;
    }
    // Over the polar angle: the integral of sin^2.
    PI / 2.0 * (sin(to - apart) - sin(from - apart))
}

/// Bright where u is in an eighth to three eighths: about +x without a rotation.
fn bright_quarter() -> Environment {
    let lit = SIZE[0] / 8..3 * SIZE[0] / 8;
    mapped_sky("quarter", SIZE, |column, _| {
        f32::from(u8::from(lit.contains(&column)))
    })
}

/// Angle u of the walls' normals, in turns.
const WALLS: [(&str, Vec3, f64); 4] = [
    ("-z", Vec3::NEG_Z, 0.0),
    ("+x", Vec3::X, 0.25),
    ("+z", Vec3::Z, 0.5),
    ("-x", Vec3::NEG_X, 0.75),
];

#[test]
fn a_map_is_turned_by_its_rotation() {
    let cube = cube_in_the_open();
    for rotation_deg in [0.0_f32, 90.0, 180.0, 270.0, -90.0, 30.0] {
        let sky = Environment {
            rotation_deg,
            ..bright_quarter()
        };
        let found = on_faces(&cube, sky);
        // Where u + rotation is a quarter.
        let bright_u = 0.25 - f64::from(rotation_deg) / 360.0;
        for (name, normal, u) in WALLS {
            let turns = u - bright_u;
            let apart = (turns - turns.round()) * 2.0 * PI;
            let wanted = beside_quarter(apart);
            let off = (found(normal) - wanted).abs() / PI;
            let what = format!("sky turned by {rotation_deg}, wall {name} ({wanted:.3})");
            at_most(&what, off, QUARTER);
        }
        let up = (found(Vec3::Y) - PI / 4.0).abs() / PI;
        at_most(&format!("sky turned by {rotation_deg}, top"), up, QUARTER);
    }
}

#[test]
fn scale_is_a_factor() {
    let cube = cube_in_the_open();
    let once = on_faces(&cube, bright_quarter());
    let sky = Environment {
        scale: 2.5,
        ..bright_quarter()
    };
    let scaled = on_faces(&cube, sky);
    for (name, normal, _) in WALLS {
        let off = (scaled(normal) - 2.5 * once(normal)).abs();
        at_most(&format!("sky x 2.5, wall {name}"), off, LINEAR * PI);
    }
}

#[test]
fn a_closed_room_sees_no_sky() {
    let mut scene = cube_room(2.0, 0.5, 64);
    scene.lights = vec![sky_light(bright_quarter()), constant_sky(1.0)];
    let image = frame_of(&scene, Component::Global);
    let lit = image.pixels().iter().filter(|p| **p != Vec3::ZERO).count();
    assert_eq!(lit, 0, "pixels lit by a sky that is shut out");
}

/// Size of the sun's map, the first texel of its 2 x 2, and what they hold above
/// the sky of 1.
const SUN_SIZE: [u32; 2] = [512, 256];
const SUN_TEXEL: [u32; 2] = [400, 64];
const SUN_EXCESS: f32 = 8191.0;

/// A floor with a block on it, seen from above.
fn floor_with_block() -> Scene {
    let mut mesh = SampleMesh::default();
    let floor = [DVec3::new(-1.0, 0.0, -1.0), DVec3::ONE];
    mesh.box_sides(floor, Facing::Inward, &[(1, false)], 0);
    let block = [DVec3::new(-0.2, 0.05, -0.2), DVec3::new(0.2, 0.35, 0.2)];
    mesh.box_sides(block, Facing::Outward, &BOX_SIDES, 0);
    let mut scene = mesh.scene(&[0.7], 0.25, 128);
    scene.camera.position = DVec3::new(0.3, 1.6, 0.9);
    scene.camera.target = DVec3::ZERO;
    scene.camera.vfov_deg = 50.0;
    scene.render.bounces = Bounces::Count(0);
    scene
}

/// Direction to the sun, and its irradiance on a plane that faces it.
fn sun() -> (Vec3, f64) {
    let [width, height] = SUN_SIZE.map(f64::from);
    let turn = f64::from(SUN_TEXEL[0] + 1) / width * 2.0 * PI;
    let row = |down: u32| f64::from(SUN_TEXEL[1] + down) / height * PI;
    let polar = row(1);
    let direction = DVec3::new(sin(polar) * sin(turn), cos(polar), -sin(polar) * cos(turn));
    let solid_angle = 2.0 * (2.0 * PI / width) * (cos(row(0)) - cos(row(2)));
    (direction.as_vec3(), solid_angle * f64::from(SUN_EXCESS))
}

#[test]
fn a_sun_in_a_map_casts_the_shadow_of_parallel_light() {
    let mut mapped = floor_with_block();
    let sky = mapped_sky("sun", SUN_SIZE, |column, row| {
        let in_sun = (0..2).contains(&column.wrapping_sub(SUN_TEXEL[0]))
            && (0..2).contains(&row.wrapping_sub(SUN_TEXEL[1]));
        if in_sun { SUN_EXCESS + 1.0 } else { 1.0 }
    });
    mapped.lights = vec![sky_light(sky)];
    let (direction, irradiance) = sun();
    let mut parallel = floor_with_block();
    parallel.lights = vec![
        directional_light(-direction, irradiance as f32),
        constant_sky(1.0),
    ];
    let [of_map, of_parallel] =
        [&mapped, &parallel].map(|scene| frame_of(scene, Component::Irradiance));
    let off = |(a, b): (&Vec3, &Vec3)| f64::from((a.x - b.x).abs()) > SAME_PIXEL * f64::from(b.x);
    let pairs = of_map.pixels().iter().zip(of_parallel.pixels());
    let count = pairs.clone().count() as f64;
    let differing = pairs.clone().filter(|&pair| off(pair)).count() as f64;
    // A tenth and more of the picture lies in the shadow.
    let lit = irradiance * f64::from(direction.y);
    let dark = |p: &&Vec3| f64::from(p.x) < 0.5 * lit;
    let shadow = of_parallel.pixels().iter().filter(dark).count() as f64;
    assert!(shadow / count > 0.05, "{shadow} pixels are in the shadow");
    at_most(
        "sun of a map, share of pixels unlike parallel light",
        differing / count,
        PENUMBRA_SHARE,
    );
    let [a, b] = [&of_map, &of_parallel]
        .map(|image| image.pixels().iter().map(|p| f64::from(p.x)).sum::<f64>());
    at_most("sun of a map, mean", (a / b - 1.0).abs(), SUN_MEAN);
}
