//! A truncated basis rings: bounced light, light of a sky and light by lobes below
//! zero exist at the vertices, and must not reach a pixel unsaid.

use glam::{DVec3, Vec3};

use super::sky::patchy_sky;
use super::{Baked, largest};
use crate::bake::RunSettings;
use crate::brdf::{GlossyMaterials, ViewedFrame};
use crate::frame::Image;
use crate::relight::glossy_light::KeptGlossyLight;
use crate::relight::{Component, Frame, FrameSettings, Quality, Renderer};
use crate::scene::sample_scenes::{cube_room, room_with_window, spot_facing_down};
use crate::scene::{Bounces, PlacedLights, Scene};
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

/// A room with a small window, through which a patch of the sky shines on the floor
/// and on the wall behind it.
fn room_with_ringing_sky() -> Scene {
    let mut scene = room_with_window(0.3, false, 0.15, 64);
    scene.bake.functions = Some(60);
    scene.lights = vec![patchy_sky("patch", &[([54, 40], 50.0)])];
    scene.render.bounces = Bounces::Count(1);
    scene
}

/// The same scene with lobes on all surfaces, sharp enough to ring.
fn glossy(mut scene: Scene) -> Scene {
    for material in &mut scene.materials {
        material.specular = Vec3::splat(0.8);
        material.roughness = Some(0.3);
    }
    scene
}

/// Interpolated values at the centres of the pixels, row by row, as rays find
/// them and not the rasterizer; 0 where nothing is seen.
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
        let Some(hit) = room.surface.rays.closest(Level::detect(), &ray) else {
            return 0.0;
        };
        let corners = room.surface.vertices.of_triangle(hit.triangle, true);
        let weighted = corners.iter().zip(hit.barycentrics);
        weighted
            .map(|(&v, weight)| values[v as usize].x * weight)
            .sum()
    };
    (0..width * height).map(at).collect()
}

fn show(renderer: &mut Renderer, component: Component, quality: Quality) -> Frame {
    let settings = FrameSettings {
        component,
        quality,
        ..FrameSettings::of_scene(renderer.scene())
    };
    let frame = renderer.frame(&settings, &RunSettings::silent());
    frame.expect("the scene has a frame")
}

/// Insists that no pixel is below zero, and some are above.
fn assert_not_negative(frame: &Frame) {
    let (component, pixels) = (frame.component, frame.image.pixels());
    let negative = pixels.iter().filter(|p| p.min_element() < 0.0).count();
    assert_eq!(negative, 0, "{component}: pixels below zero");
    let brightest = largest(pixels.iter().map(|p| f64::from(p.x)));
    assert!(brightest > 0.0, "{component}: the picture is black");
}

/// Whether a pixel shows more than one surface: a mean of several has a normal that
/// is none of a cube's. One that shows none at all has none.
fn is_mixed(normal: Vec3) -> bool {
    normal != Vec3::ZERO && normal.abs().max_element() < 0.999_9
}

/// Pixels of one surface where a value is below zero, and pixels of several, of which
/// it is not known.
fn below_and_mixed(values: &[f32], normals: &Image) -> [u64; 2] {
    let pixels = normals.pixels();
    let mixed = pixels.iter().filter(|n| is_mixed(**n)).count() as u64;
    let below = values.iter().zip(pixels);
    let below = below.filter(|(e, n)| **e < 0.0 && !is_mixed(**n)).count() as u64;
    [below, mixed]
}

#[test]
fn light_below_zero_reaches_no_pixel_and_is_counted() {
    let scene = ringing_room();
    let room = Baked::new(&scene);
    let indirect = room.indirect(&scene.lights, 0.5, Bounces::Count(1));
    let values = at_pixels(&scene, &room, &indirect);
    let mut renderer = Renderer::new(scene, None);
    let normals = show(&mut renderer, Component::Normal, Quality::Standard).image;
    let [below, mixed] = below_and_mixed(&values, &normals);
    assert!(below > 50, "{below} pixels are below zero before clamping");
    for component in [
        Component::Indirect,
        Component::Irradiance,
        Component::Global,
    ] {
        let frame = show(&mut renderer, component, Quality::Standard);
        assert_not_negative(&frame);
        let clamped = frame.clamped_pixels;
        assert!(
            (below..=below + mixed).contains(&clamped),
            "{component}: {clamped} pixels counted, {below} are below zero and {mixed} show an edge"
        );
    }
}

#[test]
fn light_of_a_sky_below_zero_reaches_no_pixel_and_is_counted() {
    let scene = room_with_ringing_sky();
    let room = Baked::new(&scene);
    let values = at_pixels(&scene, &room, &room.sky(&scene.lights));
    let mut renderer = Renderer::new(scene, None);
    let normals = show(&mut renderer, Component::Normal, Quality::Standard).image;
    let [below, mixed] = below_and_mixed(&values, &normals);
    assert!(below > 50, "{below} pixels are below zero before clamping");
    let direct = show(&mut renderer, Component::Direct, Quality::Standard);
    assert_not_negative(&direct);
    let clamped = direct.clamped_pixels;
    assert!(
        (below..=below + mixed).contains(&clamped),
        "{clamped} pixels counted, {below} are below zero and {mixed} show an edge"
    );
    // Bounced light rings too, elsewhere.
    for component in [Component::Irradiance, Component::Global] {
        let frame = show(&mut renderer, component, Quality::Standard);
        assert_not_negative(&frame);
        let clamped = frame.clamped_pixels;
        assert!(clamped >= below, "{component}: {clamped} pixels counted");
    }
}

/// How many vertices would send light below zero to the eye by their lobes, of a sky
/// alone.
fn lobes_below_zero(renderer: &Renderer) -> usize {
    let (scene, (surface, bake)) = (renderer.scene(), renderer.transfer());
    let skies = PlacedLights::of_file(&scene.lights, &surface.placement).skies;
    let bake = bake.expect("a frame was made");
    let light = KeptGlossyLight::default().of(bake, Level::detect(), None, &skies);
    let materials = GlossyMaterials::of_all(scene.materials.iter().map(|it| it.gloss()));
    let glossy = materials.of(0).expect("the material has a lobe");
    let eye = scene.camera.place(&surface.placement).eye.as_vec3();
    let sent = (0..surface.vertices.front_count() as u32).filter_map(|vertex| {
        let [normal, position] = [
            surface.vertices.normals()[vertex as usize],
            surface.vertices.positions()[vertex as usize],
        ];
        let to_eye = (eye - position).normalize();
        let light = light.at([vertex; 3], [1.0, 0.0, 0.0])?;
        let is_seen = to_eye.dot(normal) > 0.0;
        is_seen.then(|| glossy.reflected(&ViewedFrame::of(normal, to_eye), &light))
    });
    sent.filter(|radiance| radiance.min_element() < 0.0).count()
}

/// Without a bounce lobes alone can be below zero in this component.
#[test]
fn light_of_lobes_below_zero_reaches_no_pixel_and_is_counted() {
    let mut scene = glossy(room_with_ringing_sky());
    scene.render.bounces = Bounces::Count(0);
    let mut renderer = Renderer::new(scene, None);
    let by_lobes = show(&mut renderer, Component::Glossy, Quality::Standard);
    let below = lobes_below_zero(&renderer);
    assert!(below > 20, "{below} vertices are below zero");
    assert_not_negative(&by_lobes);
    let counted = by_lobes.clamped_pixels;
    assert!(counted > 50, "{counted} pixels counted");
    let global = show(&mut renderer, Component::Global, Quality::Standard);
    assert_not_negative(&global);
    let counted_in_all = global.clamped_pixels;
    assert!(
        counted_in_all >= counted,
        "{counted_in_all} pixels counted in all light, {counted} by lobes"
    );
}

/// Vertices whose light a gather of two bounces reads below zero.
fn read_below_zero(scene: &Scene) -> usize {
    let room = Baked::new(scene);
    let sky = room.sky(&scene.lights);
    let of_sky = |v: usize| sky.get(v).copied().unwrap_or(Vec3::ZERO);
    let direct = room.direct(&scene.lights).into_iter().enumerate();
    let direct: Vec<Vec3> = direct.map(|(v, e)| e + of_sky(v)).collect();
    let source: Vec<Vec3> = direct.iter().map(|&e| e * 0.5).collect();
    let bounced = room.solve(&source, 0.5, Bounces::Count(1));
    let read = direct.iter().zip(&bounced).map(|(d, b)| *d + *b);
    read.filter(|e| e.min_element() < 0.0).count()
}

#[test]
fn no_gathered_pixel_is_below_zero() {
    for (name, scene) in [("spot", ringing_room()), ("sky", room_with_ringing_sky())] {
        let mut scene = scene;
        scene.camera.size = [40, 30];
        scene.render.bounces = Bounces::Count(2);
        let below = read_below_zero(&scene);
        assert!(below > 0, "{name}: no vertex is below zero");
        let mut renderer = Renderer::new(glossy(scene), None);
        for component in [
            Component::Global,
            Component::Direct,
            Component::Indirect,
            Component::Irradiance,
            Component::Glossy,
        ] {
            let frame = show(&mut renderer, component, Quality::Gather);
            assert_not_negative(&frame);
            // Lobes alone look narrowly enough to gather little but what rings.
            let clamped = frame.clamped_pixels;
            let may_ring = component == Component::Glossy;
            assert!(!may_ring || clamped > 0, "{name}: nothing was clamped");
        }
    }
}
