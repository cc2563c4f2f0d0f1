//! What has no light is exactly black in pictures, by either quality.

use glam::{DVec3, Vec3};

use super::contacts::{lamp, rooms_apart};
use super::sides::{one_sheet, two_sheets};
use crate::bake::RunSettings;
use crate::relight::{Component, FrameSettings, Quality, Renderer};
use crate::scene::sample_scenes::{
    constant_sky, directional_light, lamp_facing_down, mapped_sky, point_light, room_with_blocks,
    sky_light, spot_facing_down,
};
use crate::scene::{Bounces, Light, Scene};

/// All that shows light.
const LIGHT: [Component; 5] = [
    Component::Global,
    Component::Direct,
    Component::Indirect,
    Component::Irradiance,
    Component::Glossy,
];
/// Both qualities.
const QUALITIES: [Quality; 2] = [Quality::Standard, Quality::Gather];

/// Pixels of a frame that are not exactly black.
fn lit_pixels(renderer: &mut Renderer, component: Component, quality: Quality) -> usize {
    let settings = FrameSettings {
        component,
        quality,
        ..FrameSettings::of_scene(renderer.scene())
    };
    let frame = renderer.frame(&settings, &RunSettings::silent());
    let image = frame.expect("the scene has a frame").image;
    image.pixels().iter().filter(|&&p| p != Vec3::ZERO).count()
}

/// Insists that all that shows light is black.
fn assert_black(what: &str, renderer: &mut Renderer, components: &[Component]) {
    for quality in QUALITIES {
        for &component in components {
            let lit = lit_pixels(renderer, component, quality);
            assert_eq!(lit, 0, "{what}, {component}, {quality}: pixels with light");
        }
    }
}

/// Insists that everything shows light.
fn assert_lit(what: &str, renderer: &mut Renderer, components: &[Component]) {
    for quality in QUALITIES {
        for &component in components {
            let lit = lit_pixels(renderer, component, quality);
            assert!(lit > 50, "{what}, {component}, {quality}: {lit} pixels lit");
        }
    }
}

/// An open room with blocks, one of whose materials has a lobe.
fn glossy_room() -> Scene {
    let mut scene = room_with_blocks(false, 0.4, 64);
    scene.materials[0].specular = Vec3::splat(0.5);
    scene.materials[0].roughness = Some(0.4);
    scene.camera.size = [24, 16];
    scene.render.bounces = Bounces::Count(2);
    scene
}

/// A light of each kind, as bright as asked for.
fn of_each_kind(brightness: f32) -> [(&'static str, Light); 6] {
    let lamp = [DVec3::new(-0.3, 0.7, -0.1), DVec3::new(0.3, 0.7, 0.4)];
    let place = DVec3::new(0.2, 0.6, 0.5);
    let half_lit = move |column, _| if column < 32 { brightness } else { 0.0 };
    [
        ("point", point_light(place, brightness)),
        ("spot", spot_facing_down(place, brightness, [30.0, 50.0])),
        (
            "parallel",
            directional_light(Vec3::new(0.2, -0.3, -1.0), brightness),
        ),
        ("rectangle", lamp_facing_down(lamp[0], lamp[1], brightness)),
        ("sky", constant_sky(brightness)),
        ("map", sky_light(mapped_sky("half", [64, 32], half_lit))),
    ]
}

#[test]
fn lights_of_no_brightness_leave_pictures_black() {
    let mut renderer = Renderer::new(glossy_room(), None);
    assert_black("no light", &mut renderer, &LIGHT);
    for (kind, light) in of_each_kind(0.0) {
        renderer.relight(|lights, _| *lights = vec![light]);
        assert_black(kind, &mut renderer, &LIGHT);
    }
    let all = of_each_kind(0.0).map(|(_, light)| light);
    renderer.relight(|lights, _| *lights = all.to_vec());
    assert_black("one of each kind", &mut renderer, &LIGHT);
}

#[test]
fn a_light_that_is_switched_off_leaves_nothing() {
    let mut renderer = Renderer::new(glossy_room(), None);
    for ((kind, on), (_, off)) in of_each_kind(5.0).into_iter().zip(of_each_kind(0.0)) {
        renderer.relight(|lights, _| *lights = vec![on.clone()]);
        assert_lit(kind, &mut renderer, &LIGHT);
        renderer.relight(|lights, _| *lights = vec![off]);
        assert_black(kind, &mut renderer, &LIGHT);
        renderer.relight(|lights, _| *lights = vec![on]);
        assert_lit(kind, &mut renderer, &LIGHT[..1]);
        renderer.relight(|lights, _| lights.clear());
        assert_black(&format!("{kind}, removed"), &mut renderer, &LIGHT);
    }
}

#[test]
fn an_emitter_that_is_switched_off_leaves_nothing() {
    let mut renderer = Renderer::new(glossy_room(), None);
    renderer.relight(|_, materials| materials[1].emission = Vec3::ONE);
    assert_lit("emitter", &mut renderer, &LIGHT);
    renderer.relight(|_, materials| materials[1].emission = Vec3::ZERO);
    assert_black("emitter", &mut renderer, &LIGHT);
}

/// What shows light of surfaces without a lobe.
const DIFFUSE: [Component; 4] = [
    Component::Global,
    Component::Direct,
    Component::Indirect,
    Component::Irradiance,
];

/// A scene seen from a place, in a small picture.
fn seen_from(mut scene: Scene, eye: DVec3, target: DVec3) -> Renderer {
    scene.camera.position = eye;
    scene.camera.target = target;
    scene.camera.size = [32, 24];
    scene.render.bounces = Bounces::Count(3);
    Renderer::new(scene, None)
}

#[test]
fn a_room_beside_a_lit_one_is_black_in_pictures() {
    // A wall of 1 mm, and two walls in one plane.
    for thickness in [1e-3, 0.0] {
        let mut scene = rooms_apart(thickness);
        scene.bake.rays = Some(64);
        scene.lights = lamp().to_vec();
        for (what, side) in [("lit room", -1.0), ("dark room", 1.0)] {
            // From its far end, so that the wall between the rooms is in the middle.
            let eye = DVec3::new(1.8 * side, 0.1, 0.2);
            let mut renderer = seen_from(scene.clone(), eye, DVec3::ZERO);
            let what = format!("{what}, wall of {thickness} m");
            if side < 0.0 {
                assert_lit(&what, &mut renderer, &DIFFUSE);
            } else {
                assert_black(&what, &mut renderer, &DIFFUSE);
            }
        }
    }
}

#[test]
fn the_back_of_a_lit_sheet_is_black_in_pictures() {
    for (name, scene) in [("one sheet", one_sheet()), ("two sheets", two_sheets())] {
        let mut scene = scene;
        scene.lights = vec![point_light(DVec3::new(0.2, 0.3, 0.1), 1.0)];
        scene.camera.vfov_deg = 30.0;
        let below = DVec3::new(0.0, -3.0, 0.01);
        let mut renderer = seen_from(scene.clone(), below, DVec3::new(0.0, -0.5, 0.0));
        assert_black(&format!("{name} from behind"), &mut renderer, &DIFFUSE);
        let within = DVec3::new(0.0, 0.45, 0.01);
        let mut renderer = seen_from(scene, within, DVec3::new(0.0, -0.5, 0.0));
        let what = format!("{name} from before");
        assert_lit(&what, &mut renderer, &[Component::Direct]);
    }
}
