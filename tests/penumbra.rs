//! Soft shadows against the path tracer, where a mean over the whole picture
//! would not show a fault: in the penumbra alone.

use glam::Vec3;
use relume::reference::{GlossyBounces, ReferencePart, ReferenceSettings, trace};
use relume::{Bounces, Component, FrameSettings, Image, Override, Renderer, RunSettings, Scene};

/// Blocks of pixels darker than this share of the brightest lie in a penumbra, in
/// the scene below.
const DIM: f32 = 0.2;
/// Light in these, relative to the path tracer's. Its own noise is 1 %; shadow
/// rays that ended behind the lamp left half of the light.
const TOLERANCE: f32 = 0.04;

fn brightness(image: &Image) -> Vec<f32> {
    let blocks = image.block_means(8);
    blocks.pixels().iter().map(|p| p.dot(Vec3::ONE)).collect()
}

/// Light of the dim blocks, in all.
fn dim_light(values: &[f32], traced: &[f32]) -> f32 {
    // The lamp itself is far brighter than what it lights.
    let mut sorted = traced.to_vec();
    sorted.sort_by(f32::total_cmp);
    let bright = sorted[sorted.len() * 9 / 10];
    let dim = traced.iter().map(|t| *t > 0.0 && *t < DIM * bright);
    values
        .iter()
        .zip(dim)
        .filter(|(_, dim)| *dim)
        .map(|(v, _)| v)
        .sum()
}

#[test]
fn penumbras_are_as_bright_as_traced_ones() {
    for light in ["panel", "emitting blocks"] {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell/panel.toml");
        let mut keys = vec!["camera.size=[160,120]"];
        if light == "emitting blocks" {
            keys.extend([
                "light.panel.radiance=[0,0,0]",
                "material.red.emission=[1,1,1]",
            ]);
        }
        let overrides: Vec<Override> = keys
            .into_iter()
            .map(|text| Override::parse(text).expect("the override is valid"))
            .collect();
        let scene = Scene::load(path.as_ref(), &overrides).expect("the scene can be loaded");
        let run = RunSettings::silent();
        let traced = trace(
            &scene,
            &ReferenceSettings {
                camera: scene.camera,
                bounces: Bounces::Count(0),
                samples: 64,
                seed: 1,
                part: ReferencePart::Global,
                glossy: GlossyBounces::All,
            },
            &run,
        );
        let traced = brightness(&traced.expect("nobody stops it").image);
        let settings = FrameSettings {
            component: Component::Direct,
            ..FrameSettings::of_scene(&scene)
        };
        let frame = Renderer::new(scene, None).frame(&settings, &run);
        let drawn = brightness(&frame.expect("a frame is drawn").image);
        let wanted = dim_light(&traced, &traced);
        assert!(wanted > 0.0, "{light}: there is no penumbra");
        let off = dim_light(&drawn, &traced) / wanted - 1.0;
        assert!(
            off.abs() <= TOLERANCE,
            "{light}: penumbras are {off:+.3} off"
        );
    }
}
