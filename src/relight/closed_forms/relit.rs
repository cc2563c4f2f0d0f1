//! Lamps and materials changed from frame to frame: the bits of a fresh frame,
//! and no bake.

use glam::{DVec3, Vec3};

use crate::bake::RunSettings;
use crate::relight::{FrameSettings, Renderer};
use crate::scene::sample_scenes::{
    Facing, SampleMesh, constant_sky, lamp_facing_down, point_light, room_with_blocks,
};
use crate::scene::{LightKind, Scene};

/// An open room with a lamp of triangles under its ceiling, a point light, a
/// rectangle in that light's way and a sky.
fn lit_room() -> Scene {
    let room = room_with_blocks(false, 0.5, 32);
    let mut mesh = SampleMesh::default();
    let lamp = [DVec3::new(-0.3, 0.9, -0.3), DVec3::new(0.1, 0.95, 0.1)];
    mesh.box_sides(lamp, Facing::Outward, &[(1, false)], 2);
    let lamp = mesh.scene(&[0.0, 0.0, 0.2], 0.5, 32);
    let mut scene = room;
    let first = scene.mesh.positions.len() as u32;
    scene.mesh.positions.extend(&lamp.mesh.positions);
    scene
        .mesh
        .triangles
        .extend(lamp.mesh.triangles.iter().map(|t| {
            let mut moved = *t;
            moved.corners = t.corners.map(|corner| corner + first);
            moved
        }));
    scene.materials.push(lamp.materials[2].clone());
    scene.materials[2].emission = Vec3::new(3.0, 2.0, 1.0);
    scene.lights = vec![
        point_light(DVec3::new(0.3, 0.7, 0.5), 2.0),
        lamp_facing_down(DVec3::new(0.1, 0.3, 0.3), DVec3::new(0.5, 0.3, 0.7), 4.0),
        constant_sky(0.2),
    ];
    scene.camera.size = [32, 24];
    scene
}

/// A frame of a scene that was `before` and became `after` in a renderer that
/// lived on has the bits of a fresh one; so does the frame after turning back.
/// Returns how many lights the change computed.
fn change_is_exact(what: &str, before: &Scene, after: &Scene) -> usize {
    let settings = FrameSettings::of_scene(before);
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(before.clone(), None);
    let first = renderer.frame(&settings, &run).unwrap();
    let preparation = renderer.preparation().clone();
    let mut show = |scene: &Scene| {
        renderer.relight(|lights, materials| {
            lights.clone_from(&scene.lights);
            materials.clone_from(&scene.materials);
        });
        renderer.frame(&settings, &run).unwrap()
    };
    let changed = show(after);
    let back = show(before);
    assert_eq!(
        *renderer.preparation(),
        preparation,
        "{what}: a bake was made"
    );
    let fresh = Renderer::new(after.clone(), None)
        .frame(&settings, &run)
        .unwrap();
    assert!(
        changed.image == fresh.image,
        "{what}: not the bits of a fresh frame"
    );
    assert!(changed.image != first.image, "{what}: nothing changed");
    assert!(
        back.image == first.image,
        "{what}: not the bits of the first frame"
    );
    changed.computed_lights
}

#[test]
fn a_new_albedo_needs_no_bake_and_no_light() {
    let before = lit_room();
    let mut after = before.clone();
    after.materials[0].albedo = Vec3::new(0.9, 0.3, 0.1);
    after.materials[2].albedo = Vec3::splat(0.7);
    let computed = change_is_exact("albedo", &before, &after);
    assert_eq!(computed, 0, "lights computed for an albedo");
}

#[test]
fn a_new_emission_lights_anew_without_a_bake() {
    let before = lit_room();
    let mut after = before.clone();
    after.materials[2].emission = Vec3::new(1.0, 5.0, 2.0);
    let computed = change_is_exact("emission", &before, &after);
    assert_eq!(computed, 1, "lights computed for the emitters");
    // A material that emitted nothing, and one that stops.
    after.materials[1].emission = Vec3::ONE;
    assert_eq!(change_is_exact("a block that glows", &before, &after), 1);
    after.materials[1].emission = Vec3::ZERO;
    after.materials[2].emission = Vec3::ZERO;
    assert_eq!(change_is_exact("emission off", &before, &after), 0);
}

#[test]
fn a_rectangle_that_moves_takes_its_shadow_along() {
    let before = lit_room();
    let mut after = before.clone();
    let LightKind::Area(rectangle) = &mut after.lights[1].kind else {
        panic!("the second light is the rectangle")
    };
    rectangle.corner.x -= 0.5;
    let computed = change_is_exact("a moved rectangle", &before, &after);
    assert_eq!(computed, 3, "it may be in the way of all");
    let mut gone = before.clone();
    gone.lights.remove(1);
    change_is_exact("a rectangle taken away", &before, &gone);
}

#[test]
fn a_new_sky_needs_no_bake_and_no_light() {
    let before = lit_room();
    let mut after = before.clone();
    after.lights[2] = constant_sky(0.7);
    let computed = change_is_exact("sky", &before, &after);
    assert_eq!(computed, 0, "lights computed for a sky");
    after.lights.truncate(2);
    change_is_exact("no sky", &before, &after);
}
