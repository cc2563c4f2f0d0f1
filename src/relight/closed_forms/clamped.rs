//! A truncated basis rings: bounced light below zero exists at the vertices, and
//! must not reach a pixel unsaid.

use glam::{DVec3, Vec3};

use super::{Baked, largest};
use crate::bake::RunSettings;
use crate::relight::{Component, FrameSettings, Renderer};
use crate::scene::sample_scenes::{cube_room, spot_facing_down};
use crate::scene::{Bounces, Scene};
use crate::simd::Level;
use crate::surface::Ray;

/// A closed cube with few and coarse functions, and a narrow spot on its floor
/// beside a wall: no light of one bounce reaches the floor, but the functions
/// that the floor shares with the wall do not end at the edge.
fn ringing_room() -> Scene {
    let mut scene = cube_room(2.0, 0.15, 64);
    scene.bake.functions = Some(60);
    scene.lights = vec![spot_facing_down(
        DVec3::new(0.8, -0.5, 0.1),
        5.0,
        [10.0, 20.0],
    )];
    scene.render.bounces = Bounces::Count(1);
    scene
}

/// Interpolated values at the centres of the pixels, row by row, as rays find
/// them and not the rasterizer.
fn at_pixels(scene: &Scene, room: &Baked, values: &[Vec3]) -> Vec<f32> {
    let camera = scene.camera.place(&room.surface.placement);
    let [width, height] = scene.camera.size;
    let at = |pixel: u32| {
        let (x, y) = (f64::from(pixel % width), f64::from(pixel / width));
        let ray = Ray {
            origin: camera.eye.as_vec3(),
            direction: camera.direction(x + 0.5, y + 0.5).normalize(),
            t_max: f32::INFINITY,
        };
        let hit = room.surface.rays.closest(Level::detect(), &ray);
        let hit = hit.expect("a closed room is seen everywhere");
        let corners = room.surface.vertices.of_triangle(hit.triangle, true);
        let weighted = corners.iter().zip(hit.barycentrics);
        weighted
            .map(|(&v, weight)| values[v as usize].x * weight)
            .sum()
    };
    (0..width * height).map(at).collect()
}

#[test]
fn light_below_zero_reaches_no_pixel_and_is_counted() {
    let scene = ringing_room();
    let room = Baked::new(&scene);
    let indirect = room.indirect(&scene.lights, 0.5, Bounces::Count(1));
    let values = at_pixels(&scene, &room, &indirect);
    let mut settings = FrameSettings::of_scene(&scene);
    let mut renderer = Renderer::new(scene, None);
    let mut show = |component| {
        settings.component = component;
        let frame = renderer.frame(&settings, &RunSettings::silent());
        frame.expect("the scene has a frame")
    };
    // A mean of several surfaces has a normal that is none of a cube's.
    let normals = show(Component::Normal).image;
    let is_mixed = |n: &Vec3| n.abs().max_element() < 0.999_9;
    let mixed = normals.pixels().iter().filter(|n| is_mixed(n)).count() as u64;
    let below = values.iter().zip(normals.pixels());
    let below = below.filter(|(e, n)| **e < 0.0 && !is_mixed(n)).count() as u64;
    assert!(below > 50, "{below} pixels are below zero before clamping");
    for component in [
        Component::Indirect,
        Component::Irradiance,
        Component::Global,
    ] {
        let frame = show(component);
        let pixels = frame.image.pixels();
        let negative = pixels.iter().filter(|p| p.min_element() < 0.0).count();
        assert_eq!(negative, 0, "{component:?}: pixels below zero");
        let brightest = largest(pixels.iter().map(|p| f64::from(p.x)));
        assert!(brightest > 0.0, "{component:?}: the picture is black");
        let clamped = frame.clamped_pixels;
        assert!(
            (below..=below + mixed).contains(&clamped),
            "{component:?}: {clamped} pixels counted, {below} are below zero and {mixed} show an edge"
        );
    }
}
