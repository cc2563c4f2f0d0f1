//! Glossy surfaces: what a furnace leaves of them, and what 16 slices show.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::{at_least, at_most, frame_of, frames_of, largest};
use crate::bake::RunSettings;
use crate::brdf::{Gloss, GlossyMaterials, ViewedFrame};
use crate::frame::Image;
use crate::maths::order::Order;
use crate::maths::sampling::sphere_direction;
use crate::reference::{GlossyBounces, ReferencePart, ReferenceSettings, trace};
use crate::relight::glossy_light::KeptGlossyLight;
use crate::relight::{Component, FrameSettings, Renderer};
use crate::scene::sample_scenes::{
    BOX_SIDES, Facing, SampleMesh, constant_sky, cube_room, point_light,
};
use crate::scene::{Bounces, Light, LightKind, PlacedLights, Placement, Scene};
use crate::simd::Level;

/// Pixels of a ball that a furnace should hide: all of a diffuse one, those of glossy
/// ones in the mean.
const FURNACE: f64 = 0.01;
/// The worst pixel of a glossy ball, at its outline: corners of a triangle have other
/// normals than its middle, and a sharp lobe seen flatly is very sensitive to that.
const OUTLINE: f64 = 0.12;
/// What slices bring of constant light over what the table says, in the mean over
/// vertices and views: eight bits.
const CONSTANT: f64 = 0.01;
/// What a lobe leaves of constant light at the middle of a pixel: the table's own
/// steps. By a round normal it would be off by 0.017.
const SHOWN: f64 = 1e-3;
/// A turned scene has other rays and other partitions: 3.1 % of the picture at 1,024
/// rays a vertex, edges of half a metre.
const TURNED: f64 = 0.04;
/// Blocks of 8 x 8 pixels of broad lobes (roughness 0.8) against paths: what 16
/// terms leave of the lobe, and the noise of both.
const AGAINST_PATHS: f64 = 0.06;
/// The same blocks of a lamp's image in a floor, direct light: 0.3 % is measured, the
/// noise of 256 paths a pixel and of the lamp's points.
const LAMP_AGAINST_PATHS: f64 = 0.01;

/// A ball of radius 1 and nothing else.
fn ball(albedo: f32, gloss: Option<(Vec3, f32)>) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.sphere(1.0, 8, Facing::Outward);
    // Constant light has no noise of rays.
    let mut scene = mesh.scene(&[albedo], 0.5, 256);
    with_gloss(&mut scene, 0, gloss);
    scene.camera.position = DVec3::new(0.5, 1.0, 4.0);
    scene.camera.target = DVec3::ZERO;
    scene.camera.vfov_deg = 35.0;
    scene
}

fn with_gloss(scene: &mut Scene, material: usize, gloss: Option<(Vec3, f32)>) {
    if let Some((specular, roughness)) = gloss {
        scene.materials[material].specular = specular;
        scene.materials[material].roughness = Some(roughness);
    }
}

#[test]
fn a_white_ball_in_a_white_sky_cannot_be_seen() {
    let dielectric = Vec3::splat(0.04);
    for gloss in [
        None,
        Some((dielectric, 0.3)),
        Some((dielectric, 0.7)),
        Some((Vec3::ONE, 0.4)),
        Some((Vec3::ONE, 0.9)),
    ] {
        let mut scene = ball(1.0, gloss);
        scene.lights = vec![constant_sky(1.0)];
        let image = frame_of(&scene, Component::Global);
        let off = image.pixels().iter().flat_map(|p| p.to_array());
        let off = off.map(|value| f64::from((value - 1.0).abs()));
        let limit = if gloss.is_none() { FURNACE } else { OUTLINE };
        at_most(
            &format!("white ball, {gloss:?}"),
            largest(off.clone()),
            limit,
        );
        let mean = off.sum::<f64>() / (3.0 * 4096.0);
        at_most(&format!("white ball, {gloss:?}, mean"), mean, FURNACE);
    }
}

/// A faceted ball: its faces have normals of their own, and its vertices round ones.
#[test]
fn a_lobe_takes_light_by_the_normal_that_is_shown() {
    let mut scene = ball(1.0, Some((Vec3::splat(0.04), 0.3)));
    scene.lights = vec![constant_sky(1.0)];
    let [direct, normals] = frames_of(&scene, [Component::Direct, Component::Normal]);
    let gloss = scene.materials[0].gloss();
    let materials = GlossyMaterials::of_all([gloss].into_iter());
    let left = |cosine: f32| 1.0 - materials.of(0).unwrap().albedo(cosine).x;
    let as_it_is = Placement {
        center: DVec3::ZERO,
        scale: 1.0,
        extent: 1.0,
    };
    let camera = scene.camera.place(&as_it_is);
    let (mut off, mut off_if_round, mut seen) = (Vec::new(), Vec::new(), 0.0);
    for (pixel, (direct, normal)) in direct.pixels().iter().zip(normals.pixels()).enumerate() {
        let [x, y] = [pixel % 64, pixel / 64].map(|at| at as f64 + 0.5);
        let ray = camera.direction(x, y).normalize();
        // Not where a pixel shows two faces, nor at the outline, where all changes within
        // a pixel.
        let cosine = -normal.dot(ray);
        if (normal.length() - 1.0).abs() > 1e-5 || cosine < 0.25 {
            continue;
        }
        let (eye, ray) = (camera.eye, ray.as_dvec3());
        let middle = eye.dot(ray);
        let half_chord = (1.0 - eye.length_squared() + middle * middle).at_least(0.0);
        let round = -(eye + ray * (-middle - half_chord.sqrt())).dot(ray);
        off.push(f64::from((direct.x - left(cosine)).abs()));
        off_if_round.push(f64::from((direct.x - left(round as f32)).abs()));
        seen += 1.0;
    }
    at_least("pixels of one face", seen, 300.0);
    at_most("light left by the shown normal", largest(off), SHOWN);
    at_least("and by a round one", largest(off_if_round), 10.0 * SHOWN);
}

#[test]
fn slices_bring_the_tabulated_albedo_of_constant_light() {
    let mut scene = cube_room(2.0, 0.4, 1024);
    with_gloss(&mut scene, 0, Some((Vec3::ONE, 0.6)));
    let mut renderer = Renderer::new(scene.clone(), None);
    renderer.bake(&RunSettings::silent()).unwrap();
    let (surface, bake) = renderer.transfer();
    let bake = bake.unwrap();
    let outgoing = vec![[1.0; 3]; bake.basis().slot_count()].into();
    let light = KeptGlossyLight::default().of(bake, Level::detect(), Some(outgoing), &[]);
    for roughness in [0.2, 0.4, 0.6, 1.0] {
        let gloss = Gloss::of(Vec3::ONE, roughness);
        let materials = GlossyMaterials::of_all([gloss].into_iter());
        let glossy = materials.of(0).unwrap();
        let mut sum = 0.0;
        let vertices = surface.vertices.front_count() as u32;
        for vertex in 0..vertices {
            let normal = surface.vertices.normals()[vertex as usize];
            let about = sphere_direction([0.3, vertex as f32 / vertices as f32]);
            let to_eye = (normal * 1.2 + about).normalize();
            let frame = ViewedFrame::of(normal, to_eye);
            let light = light.at([vertex; 3], [1.0, 0.0, 0.0]).unwrap();
            // Radiosity 1 is a radiance of 1/pi.
            let returned = glossy.reflected(&frame, &light).x * std::f32::consts::PI;
            sum += f64::from((returned / glossy.albedo(frame.cosine).x - 1.0).abs());
        }
        let what = format!("constant light by slices, roughness {roughness}");
        at_most(&what, sum / f64::from(vertices), CONSTANT);
    }
}

/// A glossy ball in a room with a lamp, and one wall that is black.
fn room_with_ball(roughness: f32) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.sphere(1.0, 10, Facing::Outward);
    let corners = [DVec3::splat(-2.5), DVec3::splat(2.5)];
    mesh.box_sides(corners, Facing::Inward, &BOX_SIDES[..5], 1);
    mesh.box_sides(corners, Facing::Inward, &BOX_SIDES[5..], 2);
    let mut scene = mesh.scene(&[0.0, 0.7, 0.05], 0.5, 2048);
    with_gloss(&mut scene, 0, Some((Vec3::new(0.9, 0.7, 0.4), roughness)));
    scene.lights = vec![point_light(DVec3::new(1.2, 2.0, 0.4), 5.0)];
    scene.camera.position = DVec3::new(0.8, 1.2, 2.4);
    scene.camera.target = DVec3::ZERO;
    scene.camera.vfov_deg = 45.0;
    scene.render.bounces = Bounces::Count(2);
    scene
}

/// The same scene, turned by a quarter about the vertical axis.
fn turned(scene: &Scene) -> Scene {
    let turn = |p: DVec3| DVec3::new(p.z, p.y, -p.x);
    let mut scene = scene.clone();
    scene.mesh.positions.iter_mut().for_each(|p| *p = turn(*p));
    scene.camera.position = turn(scene.camera.position);
    scene.camera.target = turn(scene.camera.target);
    for light in &mut scene.lights {
        if let LightKind::Point(point) = &mut light.kind {
            point.position = turn(point.position);
        }
    }
    scene
}

/// Root of the mean square of differences over that of `wanted`.
fn difference(image: &Image, wanted: &Image) -> f64 {
    let pairs = image.pixels().iter().zip(wanted.pixels());
    let squares = |v: Vec3| f64::from(v.length_squared());
    let off: f64 = pairs.map(|(a, b)| squares(*a - *b)).sum();
    let all: f64 = wanted.pixels().iter().map(|p| squares(*p)).sum();
    (off / all).sqrt()
}

#[test]
fn turning_the_scene_turns_the_picture() {
    let scene = room_with_ball(0.6);
    for component in [Component::Glossy, Component::Direct] {
        let here = frame_of(&scene, component);
        let there = frame_of(&turned(&scene), component);
        let mean = here.pixels().iter().map(|p| f64::from(p.x)).sum::<f64>() / 4096.0;
        at_least(&format!("mean of {component}"), mean, 0.01);
        let what = format!("turned scene, {component}");
        at_most(&what, difference(&there, &here), TURNED);
    }
}

#[test]
fn all_light_is_direct_indirect_and_glossy() {
    let mut scene = room_with_ball(0.5);
    scene.materials[1].specular = Vec3::splat(0.04);
    scene.materials[1].roughness = Some(0.4);
    let [global, direct, indirect, glossy] = frames_of(
        &scene,
        [
            Component::Global,
            Component::Direct,
            Component::Indirect,
            Component::Glossy,
        ],
    );
    let sums = (0..global.pixels().len()).map(|i| {
        let sum = direct.pixels()[i] + indirect.pixels()[i] + glossy.pixels()[i];
        let off = (sum - global.pixels()[i]).abs().max_element();
        f64::from(off / global.pixels()[i].max_element().at_least(1e-3))
    });
    at_most("sum of the parts", largest(sums), 1e-5);
}

#[test]
fn a_lobe_is_switched_without_a_bake() {
    let mut scene = room_with_ball(0.5);
    scene.bake.rays = Some(128);
    let run = RunSettings::silent();
    let settings = FrameSettings::of_scene(&scene);
    let mut renderer = Renderer::new(scene.clone(), None);
    let first = renderer.frame(&settings, &run).unwrap().image;
    for (specular, roughness) in [(Vec3::splat(0.04), 0.3), (Vec3::new(0.9, 0.2, 0.1), 0.8)] {
        renderer.relight(|_, materials| {
            materials[0].specular = specular;
            materials[0].roughness = Some(roughness);
        });
        let mut other = scene.clone();
        with_gloss(&mut other, 0, Some((specular, roughness)));
        let fresh = Renderer::new(other, None).frame(&settings, &run).unwrap();
        let switched = renderer.frame(&settings, &run).unwrap().image;
        assert_eq!(switched, fresh.image);
        assert_ne!(switched, first, "nothing has changed");
    }
}

#[test]
fn slices_are_applied_for_what_is_shown_and_for_nothing_else() {
    let mut scene = room_with_ball(0.5);
    scene.bake.rays = Some(64);
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(scene.clone(), None);
    let mut applies = |bounces: u32, has_sky: bool, is_glossy: bool| {
        renderer.relight(|lights, materials| {
            lights.truncate(1);
            lights.extend(has_sky.then(|| constant_sky(0.5)));
            materials[0].specular = Vec3::splat(f32::from(u8::from(is_glossy)));
        });
        let settings = FrameSettings {
            bounces: Bounces::Count(bounces),
            ..FrameSettings::of_scene(&scene)
        };
        let frame = renderer.frame(&settings, &run).unwrap();
        let stages = frame.stages.times_ms().iter();
        stages.filter(|(stage, _)| *stage == "glossy light").count() == 1
    };
    assert!(applies(1, false, true), "bounced light");
    assert!(applies(0, true, true), "the sky");
    assert!(!applies(0, false, true), "no light");
    assert!(!applies(1, true, false), "no lobe");
}

#[test]
fn glossy_light_of_a_sky_alone_is_kept() {
    let mut scene = room_with_ball(0.5);
    scene.bake.rays = Some(64);
    let mut renderer = Renderer::new(scene, None);
    renderer.bake(&RunSettings::silent()).unwrap();
    let (surface, bake) = renderer.transfer();
    let skies = PlacedLights::of_file(&[constant_sky(0.5)], &surface.placement).skies;
    let mut kept = KeptGlossyLight::default();
    let mut light = |outgoing| kept.of(bake.unwrap(), Level::detect(), outgoing, &skies);
    let first = light(None);
    assert!(Arc::ptr_eq(&first, &light(None)));
    let outgoing = vec![[1.0; 3]; bake.unwrap().basis().slot_count()].into();
    assert!(!Arc::ptr_eq(&first, &light(Some(outgoing))), "bounces came");
    assert!(!Arc::ptr_eq(&first, &light(None)), "and went");
}

#[test]
fn broad_lobes_agree_with_paths() {
    let scene = room_with_ball(0.8);
    let slices = frame_of(&scene, Component::Glossy);
    let settings = ReferenceSettings {
        camera: scene.camera,
        bounces: scene.render.bounces,
        samples: 256,
        seed: 5,
        part: ReferencePart::Glossy,
        glossy: GlossyBounces::Final,
    };
    let paths = trace(&scene, &settings, &RunSettings::silent()).unwrap();
    let [a, b] = [&slices, &paths.image].map(|image| image.block_means(8));
    at_most(
        "slices of roughness 0.8 against paths",
        difference(&a, &b),
        AGAINST_PATHS,
    );
}

/// An emitter of the mesh reflected in a floor: all that a lobe brings of one light,
/// by points of the light in a frame and by both ways of drawing in the reference.
#[test]
fn lamps_in_a_glossy_floor_agree_with_paths() {
    let mut mesh = SampleMesh::default();
    let floor = [DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 2.0, 2.0)];
    mesh.box_sides(floor, Facing::Inward, &[(1, false)], 0);
    let lamp = [DVec3::new(-0.8, 1.0, -1.9), DVec3::new(0.8, 1.6, -1.8)];
    mesh.box_sides(lamp, Facing::Outward, &[(2, true)], 1);
    let mut scene = mesh.scene(&[0.3, 0.0], 0.5, 64);
    with_gloss(&mut scene, 0, Some((Vec3::splat(0.5), 0.35)));
    scene.materials[1].emission = Vec3::new(4.0, 3.0, 2.0);
    scene.lights = Vec::<Light>::new();
    scene.camera.position = DVec3::new(0.1, 0.9, 2.6);
    scene.camera.target = DVec3::new(0.0, 0.2, 0.0);
    scene.camera.vfov_deg = 50.0;
    scene.render.bounces = Bounces::Count(0);
    let frame = frame_of(&scene, Component::Direct);
    let settings = ReferenceSettings {
        camera: scene.camera,
        bounces: Bounces::Count(0),
        samples: 256,
        seed: 3,
        part: ReferencePart::Global,
        glossy: GlossyBounces::All,
    };
    let paths = trace(&scene, &settings, &RunSettings::silent()).unwrap();
    let [a, b] = [&frame, &paths.image].map(|image| image.block_means(8));
    at_most(
        "a lamp in a glossy floor against paths",
        difference(&a, &b),
        LAMP_AGAINST_PATHS,
    );
}
