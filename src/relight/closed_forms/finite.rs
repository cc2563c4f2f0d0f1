//! Lights in places and of sizes that mean nothing sensible: every value of a
//! frame is still finite and not negative.

use glam::{DVec3, Vec3};

use super::{at_least, at_most};
use crate::bake::RunSettings;
use crate::maths::order::Order;
use crate::relight::{COMPONENTS, Component, FrameSettings, Renderer};
use crate::scene::sample_scenes::{
    BOX_SIDES, Facing, SampleMesh, area_light, constant_sky, directional_light, lamp_facing_down,
    point_light, room_with_blocks, spot_facing_down,
};
use crate::scene::{Light, Scene};

/// Small frames in every component of light.
fn settings(scene: &Scene) -> FrameSettings {
    let mut settings = FrameSettings::of_scene(scene);
    settings.camera.size = [24, 16];
    settings
}

/// Values of the frames of a renderer, each of which has to be a number.
fn brightest(what: &str, renderer: &mut Renderer, settings: &FrameSettings) -> f32 {
    let mut brightest = 0.0_f32;
    for (name, component) in COMPONENTS {
        if component == Component::Normal {
            continue;
        }
        let settings = FrameSettings {
            component,
            ..*settings
        };
        let image = renderer
            .frame(&settings, &RunSettings::silent())
            .unwrap()
            .image;
        for (index, pixel) in image.pixels().iter().enumerate() {
            let fits = |v: &f32| v.is_finite() && *v >= 0.0;
            assert!(
                pixel.to_array().iter().all(fits),
                "{what}, {name}: pixel {index} is {pixel}"
            );
        }
        if component == Component::Global {
            brightest = image
                .pixels()
                .iter()
                .fold(brightest, |b, p| b.at_least(p.x));
        }
    }
    brightest
}

/// The brightest pixel of a frame that is lit is brighter, 0.067 or more with lights of
/// 1 W/sr or 1 W/m2 in a room of 2 m, and any other darker: 1e-12 of the sliver, else 0.
const LIT: f64 = 1e-3;

/// Lights by what is odd about them, and whether they light anything.
fn odd_lights() -> Vec<(&'static str, Vec<Light>, bool)> {
    let square = [DVec3::X, DVec3::Z];
    let floor = DVec3::new(-0.5, -1.0, -0.5);
    let one = |light: Light| vec![light];
    let middle = DVec3::new(0.7, 0.4, 0.2);
    vec![
        ("no light", vec![], false),
        (
            "point light on a wall",
            one(point_light(DVec3::new(-1.0, 0.3, 0.2), 1.0)),
            true,
        ),
        (
            "point light on the floor",
            one(point_light(DVec3::new(0.25, -1.0, 0.5), 1.0)),
            true,
        ),
        (
            "point light in a corner",
            one(point_light(DVec3::NEG_ONE, 1.0)),
            true,
        ),
        (
            "point light without light",
            one(point_light(middle, 0.0)),
            false,
        ),
        (
            "tiny spot",
            one(spot_facing_down(middle, 1.0, [0.0, 1e-3])),
            false,
        ),
        (
            "spot without falloff",
            one(spot_facing_down(middle, 1.0, [20.0, 20.0])),
            true,
        ),
        (
            "spot of 90 degrees",
            one(spot_facing_down(middle, 1.0, [90.0, 90.0])),
            true,
        ),
        (
            "spot in the floor",
            one(spot_facing_down(
                DVec3::new(0.2, -1.0, 0.2),
                1.0,
                [45.0, 90.0],
            )),
            false,
        ),
        (
            "parallel to the floor",
            one(directional_light(Vec3::X, 1.0)),
            false,
        ),
        (
            "into the room",
            one(directional_light(Vec3::NEG_Z, 1.0)),
            true,
        ),
        // u x v looks down, v x u up.
        (
            "rectangle in the floor, facing down",
            one(area_light(floor, square, 1.0)),
            false,
        ),
        (
            "rectangle in the floor, facing up",
            one(area_light(floor, [square[1], square[0]], 1.0)),
            true,
        ),
        (
            "rectangle wider than the floor",
            one(area_light(
                floor * 9.0 + DVec3::Y * 8.0,
                square.map(|e| e * 9.0),
                1.0,
            )),
            false,
        ),
        (
            "rectangle without light",
            one(lamp_facing_down(
                DVec3::ZERO,
                DVec3::new(0.5, 0.0, 0.5),
                0.0,
            )),
            false,
        ),
        (
            "sliver of a rectangle",
            one(area_light(DVec3::ZERO, [DVec3::X, DVec3::Z * 1e-12], 1.0)),
            false,
        ),
        ("sky without light", one(constant_sky(0.0)), false),
    ]
}

#[test]
fn odd_lights_give_finite_frames() {
    let scene = room_with_blocks(false, 0.4, 64);
    let settings = settings(&scene);
    let mut renderer = Renderer::new(scene, None);
    for (what, lights, lit) in odd_lights() {
        renderer.relight(|list, _| *list = lights);
        let brightest = f64::from(brightest(what, &mut renderer, &settings));
        let figure = format!("{what}, brightest pixel");
        if lit {
            at_least(&figure, brightest, LIT);
        } else {
            at_most(&figure, brightest, LIT);
        }
    }
}

#[test]
fn an_eye_on_a_rectangle_sees_finite_frames() {
    let mut scene = room_with_blocks(false, 0.4, 64);
    let (lower, upper) = (DVec3::new(-0.5, 0.8, -0.5), DVec3::new(0.5, 0.8, 0.5));
    scene.lights = vec![lamp_facing_down(lower, upper, 1.0)];
    let mut settings = settings(&scene);
    let mut renderer = Renderer::new(scene, None);
    let eyes = [DVec3::new(0.1, 0.8, 0.2), lower, upper];
    let targets = [DVec3::new(0.1, -1.0, 0.3), DVec3::new(0.9, 0.8, -0.7)];
    for (eye, target) in eyes.into_iter().flat_map(|e| targets.map(|t| (e, t))) {
        settings.camera.position = eye;
        settings.camera.target = target;
        brightest(&format!("eye at {eye}"), &mut renderer, &settings);
    }
}

#[test]
fn emitters_that_touch_walls_give_finite_frames() {
    let mut mesh = SampleMesh::default();
    mesh.box_sides([DVec3::NEG_ONE, DVec3::ONE], Facing::Inward, &BOX_SIDES, 0);
    // On edge at a wall, within the ceiling, and through the floor.
    let at_wall = [DVec3::new(-1.0, 0.0, -0.5), DVec3::new(-0.5, 0.5, 0.0)];
    mesh.box_sides(at_wall, Facing::Outward, &[(1, false)], 1);
    let in_ceiling = [DVec3::new(-0.2, 1.0, -0.2), DVec3::new(0.2, 1.5, 0.2)];
    mesh.box_sides(in_ceiling, Facing::Outward, &[(1, false)], 1);
    let through_floor = [DVec3::new(0.3, -1.5, 0.3), DVec3::new(0.6, -0.5, 0.6)];
    mesh.box_sides(through_floor, Facing::Outward, &[(2, false)], 1);
    let mut scene = mesh.scene(&[0.7, 0.0], 0.4, 64);
    scene.materials[1].emission = Vec3::ONE;
    scene.camera.position = DVec3::new(0.1, -0.6, 0.9);
    let settings = settings(&scene);
    let brightest = brightest("emitters", &mut Renderer::new(scene, None), &settings);
    assert!(brightest > 0.5, "the lamps are in the picture: {brightest}");
}
