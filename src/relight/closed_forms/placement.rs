//! The same room far away, tiny and huge is the same picture.

use glam::{DVec3, Vec3};

use super::{at_most, largest};
use crate::bake::RunSettings;
use crate::frame::Image;
use crate::relight::{FrameSettings, Renderer};
use crate::scene::sample_scenes::{point_light, room_with_blocks};
use crate::scene::{LightKind, Scene};

/// Means of 8 x 8 pixels: another placed size has other rounding, other rays
/// and other partitions, which leaves noise, not bias: at 1,024 rays the worst block
/// is 1.1 % off.
const SAME_PICTURE: f64 = 0.01;

/// The scene scaled about the origin, then moved; lights keep the picture's
/// brightness.
fn moved(mut scene: Scene, scale: f64, offset: DVec3) -> Scene {
    let place = |p: &mut DVec3| *p = *p * scale + offset;
    scene.mesh.positions.iter_mut().for_each(place);
    place(&mut scene.camera.position);
    place(&mut scene.camera.target);
    scene.bake.max_edge = scene.bake.max_edge.map(|edge| edge * scale);
    for light in &mut scene.lights {
        if let LightKind::Point(point) = &mut light.kind {
            place(&mut point.position);
            point.intensity *= (scale * scale) as f32;
        }
    }
    scene
}

fn picture(scene: Scene) -> Image {
    let settings = FrameSettings::of_scene(&scene);
    let mut renderer = Renderer::new(scene, None);
    renderer
        .frame(&settings, &RunSettings::silent())
        .unwrap()
        .image
}

/// Means over blocks of 8 x 8 pixels.
fn block_means(image: &Image) -> Vec<Vec3> {
    let blocks = |size: u32| 0..size / 8;
    let mut means = Vec::new();
    for row in blocks(image.height()) {
        for column in blocks(image.width()) {
            let pixels = (0..64).map(|k| image.pixel(column * 8 + k % 8, row * 8 + k / 8).unwrap());
            means.push(pixels.sum::<Vec3>() / 64.0);
        }
    }
    means
}

#[test]
fn a_room_looks_the_same_anywhere_and_at_any_size() {
    let mut scene = room_with_blocks(true, 0.15, 2048);
    scene.lights = vec![point_light(DVec3::new(0.2, 0.7, 0.5), 2.0)];
    let home = block_means(&picture(scene.clone()));
    let mean = home.iter().map(|p| p.x).sum::<f32>() / home.len() as f32;
    assert!(mean > 0.05, "the picture is dark: {mean}");
    let away = |distance: f64| DVec3::new(distance, -distance, distance);
    for (name, scale, offset) in [
        ("1e3 away", 1.0, away(1e3)),
        ("1e5 away", 1.0, away(1e5)),
        ("1e6 away", 1.0, away(1e6)),
        ("a thousandth", 1e-3, DVec3::ZERO),
        ("a thousand times and 1e6 away", 1e3, away(1e6)),
    ] {
        let there = block_means(&picture(moved(scene.clone(), scale, offset)));
        let off = |(a, b): (&Vec3, &Vec3)| f64::from((a.x - b.x).abs() / a.x);
        let worst = largest(home.iter().zip(&there).map(off));
        at_most(
            &format!("room {name}, worst of {} blocks", home.len()),
            worst,
            SAME_PICTURE,
        );
    }
}
