//! Light that a final gather finds, where it is known.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};

use super::enclosures::furnace_radiance;
use super::{at_least, at_most, largest};
use crate::bake::{Progress, RunSettings, thread_pool};
use crate::frame::{Image, compare};
use crate::reference::{GlossyBounces, ReferencePart, ReferenceSettings, trace};
use crate::relight::{Component, Effort, FrameSettings, Quality, RenderError, Renderer};
use crate::scene::sample_scenes::{
    Facing, SampleMesh, constant_sky, cube_room, hollow_sphere, point_light, room_with_blocks,
    scene_of_files,
};
use crate::scene::{Bounces, Scene};
use crate::simd::Level;

/// A plane under a constant sky: all rays escape.
const OPEN: f64 = 1e-5;
/// Mean of a picture of a furnace, and its worst pixel: all rays bring the same, and
/// constant light is kept by the operator.
const FURNACE: [f64; 2] = [1e-4, 1e-3];
/// Mean of a picture inside a sphere of 1,200 flat triangles.
const SPHERE_MEAN: f64 = 5e-3;
/// Its worst pixel: noise of 256 rays on light that falls to a tenth, 3.4 %.
const SPHERE_WORST: f64 = 0.05;
/// Means of 8 x 8 pixels against those of standard quality, on a coarse mesh.
const LIKE_STANDARD: f64 = 0.03;
/// The same, mean of the picture.
const LIKE_STANDARD_MEAN: f64 = 0.01;
/// Mean of a picture against 512 paths a pixel, whose own noise is some 0.5 %.
const LEANING: f64 = 0.02;
/// Largest |direct + indirect - global| of a channel, W/(m2 sr).
const SUM: f64 = 1e-5;

fn settings(scene: &Scene, component: Component) -> FrameSettings {
    FrameSettings {
        component,
        quality: Quality::Gather,
        ..FrameSettings::of_scene(scene)
    }
}

/// Frames of some components by one bake.
fn gathered<const N: usize>(scene: &Scene, components: [Component; N]) -> [Image; N] {
    let mut renderer = Renderer::new(scene.clone(), None);
    components.map(|component| {
        let frame = renderer.frame(&settings(scene, component), &RunSettings::silent());
        frame.expect("the scene has a frame").image
    })
}

fn lit_room() -> Scene {
    let mut scene = room_with_blocks(false, 0.25, 128);
    scene.lights = vec![
        point_light(DVec3::new(0.2, 0.7, 0.5), 2.0),
        constant_sky(0.3),
    ];
    scene.camera.size = [48, 32];
    scene
}

#[test]
fn gathering_under_a_constant_sky_brings_pi_l() {
    let mut mesh = SampleMesh::default();
    let corners = [DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 1.0, 2.0)];
    mesh.box_sides(corners, Facing::Inward, &[(1, false)], 0);
    let mut scene = mesh.scene(&[0.5], 0.5, 128);
    scene.lights = vec![constant_sky(2.0), constant_sky(1.0)];
    scene.camera.position = DVec3::new(0.1, 1.0, 0.2);
    scene.camera.target = DVec3::ZERO;
    for bounces in [0, 2] {
        scene.render.bounces = Bounces::Count(bounces);
        let [image] = gathered(&scene, [Component::Irradiance]);
        let offs = image.pixels().iter();
        let offs = offs.map(|p| (f64::from(p.x) / (3.0 * PI) - 1.0).abs());
        at_most("gather of a sky, worst pixel", largest(offs), OPEN);
    }
}

#[test]
fn gathering_in_a_furnace_finds_its_series() {
    let albedo = 0.5;
    for bounces in [Bounces::Count(1), Bounces::Count(3), Bounces::All] {
        let mut scene = cube_room(2.0, 0.25, 512);
        scene.materials[0].albedo = Vec3::splat(albedo);
        scene.materials[0].emission = Vec3::ONE;
        scene.render.bounces = bounces;
        scene.camera.size = [32, 32];
        let [image] = gathered(&scene, [Component::Global]);
        // Emission and direct light are two terms of the series.
        let terms = match bounces {
            Bounces::Count(count) => Bounces::Count(count + 1),
            Bounces::All => Bounces::All,
        };
        let wanted = furnace_radiance(f64::from(albedo), terms);
        let ratios = image.pixels().iter().map(|p| f64::from(p.x) / wanted);
        let mean = ratios.clone().sum::<f64>() / image.pixels().len() as f64;
        let worst = largest(ratios.map(|r| (r - 1.0).abs()));
        let what = format!("gather in a furnace, {bounces:?}");
        at_most(&format!("{what}, mean"), (mean - 1.0).abs(), FURNACE[0]);
        at_most(&format!("{what}, worst pixel"), worst, FURNACE[1]);
    }
}

fn area(scene: &Scene) -> f64 {
    let triangles = scene.mesh.triangles.iter();
    let areas = triangles.map(|triangle| {
        let [a, b, c] = triangle.corners.map(|i| scene.mesh.positions[i as usize]);
        0.5 * (b - a).cross(c - a).length()
    });
    areas.sum()
}

/// Whatever stands inside a sphere, a bounce spreads its light evenly.
#[test]
fn gathering_in_a_sphere_finds_even_light() {
    let mut scene = hollow_sphere(1.0, 8, 512);
    scene.lights = vec![point_light(DVec3::new(0.1, 0.2, -0.4), 3.0)];
    scene.camera.size = [32, 32];
    // A polyhedron of this many faces is smaller than its sphere.
    let area = area(&scene);
    for count in [1, 3] {
        scene.render.bounces = Bounces::Count(count);
        let [image] = gathered(&scene, [Component::Indirect]);
        let series = furnace_radiance(0.5, Bounces::Count(count)) - 1.0;
        // Radiance: albedo / pi x irradiance.
        let wanted = 0.5 / PI * series * 12.0 * PI / area;
        let ratios = image.pixels().iter().map(|p| f64::from(p.x) / wanted);
        let mean = ratios.clone().sum::<f64>() / image.pixels().len() as f64;
        let worst = largest(ratios.map(|r| (r - 1.0).abs()));
        let what = format!("gather in a sphere, {count} bounces, mean {mean:.4}");
        at_most(&what, (mean - 1.0).abs(), SPHERE_MEAN);
        at_most(&format!("{what}, worst pixel"), worst, SPHERE_WORST);
    }
}

#[test]
fn a_gather_is_like_a_standard_frame_in_the_mean() {
    let scene = lit_room();
    let mut renderer = Renderer::new(scene.clone(), None);
    let run = RunSettings::silent();
    let gather = settings(&scene, Component::Irradiance);
    let standard = FrameSettings {
        quality: Quality::Standard,
        ..gather
    };
    let [standard, gather] = [standard, gather].map(|it| renderer.frame(&it, &run).unwrap().image);
    let found = compare(&standard.block_means(8), &gather.block_means(8)).unwrap();
    at_most(
        "gather against vertices, blocks",
        found.relative_rmse,
        LIKE_STANDARD,
    );
    at_most(
        "gather against vertices, mean",
        found.bias.abs(),
        LIKE_STANDARD_MEAN,
    );
    let pixels = compare(&standard, &gather).unwrap().relative_rmse;
    at_least("gather against vertices, pixels", pixels, 1e-3);
}

#[test]
fn gathered_light_adds_up() {
    let components = [Component::Direct, Component::Indirect, Component::Global];
    let [direct, indirect, global] = gathered(&lit_room(), components);
    let parts = direct.pixels().iter().zip(indirect.pixels());
    let gaps = parts.zip(global.pixels());
    let gaps = gaps.map(|((d, i), g)| f64::from((*d + *i - *g).abs().max_element()));
    at_most("gather, direct + indirect - global", largest(gaps), SUM);
    let brightest = |image: &Image| largest(image.pixels().iter().map(|p| f64::from(p.x)));
    at_least("gather, direct", brightest(&direct), 0.1);
    at_least("gather, indirect", brightest(&indirect), 0.01);
}

/// The room with a sky, and surfaces with lobes.
fn glossy_room() -> Scene {
    let mut scene = lit_room();
    for material in &mut scene.materials {
        material.specular = Vec3::splat(0.5);
        material.roughness = Some(0.4);
    }
    scene
}

#[test]
fn rays_are_sent_for_what_is_shown_and_for_nothing_else() {
    use Component::{Albedo, Depth, Direct, Global, Glossy, Indirect, Irradiance, Normal};
    let (scene, run) = (glossy_room(), RunSettings::silent());
    let mut renderer = Renderer::new(scene.clone(), None);
    let mut sent = |component, bounces| {
        let settings = FrameSettings {
            bounces: Bounces::Count(bounces),
            ..settings(&scene, component)
        };
        renderer.frame(&settings, &run).unwrap().gathered_rays
    };
    let [about_normals, by_lobes] = [Indirect, Glossy].map(|it| sent(it, 1));
    let pixels = u64::from(scene.camera.size[0] * scene.camera.size[1]);
    assert!(about_normals > 0 && about_normals <= pixels * 256);
    // Those that facets send into the surface are not sent.
    assert!(by_lobes > 0 && by_lobes < about_normals);
    for (component, [bounced, by_sky]) in [
        (Global, [about_normals + by_lobes; 2]),
        (Irradiance, [about_normals; 2]),
        (Direct, [about_normals; 2]),
        (Indirect, [about_normals, 0]),
        (Glossy, [by_lobes; 2]),
        (Component::ApproximatedDirect, [0; 2]),
        (Component::Partitions, [0; 2]),
        (Albedo, [0; 2]),
        (Normal, [0; 2]),
        (Depth, [0; 2]),
    ] {
        assert_eq!(sent(component, 1), bounced, "{component}, a bounce");
        assert_eq!(sent(component, 0), by_sky, "{component}, the sky alone");
    }
}

#[test]
fn what_shows_nothing_gathered_has_the_bits_of_standard_quality() {
    let mut scene = glossy_room();
    scene.lights.truncate(1);
    let (mut renderer, run) = (Renderer::new(scene.clone(), None), RunSettings::silent());
    for component in [Component::Direct, Component::Albedo, Component::Normal] {
        let gather = settings(&scene, component);
        let standard = FrameSettings {
            quality: Quality::Standard,
            ..gather
        };
        let [gather, standard] = [gather, standard].map(|it| {
            let frame = renderer.frame(&it, &run).unwrap();
            (frame.image, frame.gathered_rays, renderer.describe(&it))
        });
        assert!(gather == standard && gather.1 == 0, "{component}");
    }
}

#[test]
fn what_lobes_gather_is_the_rest_of_global_light() {
    let [direct, indirect, glossy, global] = gathered(
        &glossy_room(),
        [
            Component::Direct,
            Component::Indirect,
            Component::Glossy,
            Component::Global,
        ],
    );
    let pixels = 0..global.pixels().len();
    let sums = pixels.map(|i| direct.pixels()[i] + indirect.pixels()[i] + glossy.pixels()[i]);
    let gaps = sums.zip(global.pixels());
    let gaps = gaps.map(|(sum, global)| f64::from((sum - *global).abs().max_element()));
    at_most("gather by lobes, sum of the parts", largest(gaps), SUM);
    let brightest = largest(glossy.pixels().iter().map(|p| f64::from(p.x)));
    at_least("gather by lobes, glossy", brightest, 0.01);
}

#[test]
fn gathers_have_the_same_bits_on_any_threads_and_level() {
    let scene = lit_room();
    let draw = |threads: usize, level: Level| {
        let pool = thread_pool(threads).unwrap();
        let run = RunSettings {
            level,
            ..RunSettings::silent()
        };
        pool.install(|| {
            let mut renderer = Renderer::new(scene.clone(), None);
            let frame = renderer.frame(&settings(&scene, Component::Global), &run);
            frame.unwrap().image
        })
    };
    let first = draw(1, Level::Scalar);
    for (threads, level) in [(1, Level::detect()), (3, Level::Sse2), (2, Level::Scalar)] {
        assert!(
            draw(threads, level.available()) == first,
            "{threads}, {level:?}"
        );
    }
}

#[test]
fn qualities_leave_no_trace_in_one_another() {
    let scene = lit_room();
    let run = RunSettings::silent();
    let gather = settings(&scene, Component::Global);
    let standard = FrameSettings::of_scene(&scene);
    let draft = FrameSettings {
        effort: Effort::Draft,
        ..standard
    };
    let gathered_draft = FrameSettings {
        effort: Effort::Draft,
        ..gather
    };
    let mut renderer = Renderer::new(scene.clone(), None);
    let mut draw = |it: &FrameSettings| renderer.frame(it, &run).unwrap().image;
    let [first, second] = [standard, gather].map(|it| draw(&it));
    assert!(first != second, "a gather is not interpolated");
    assert!(draw(&draft) == draw(&gathered_draft), "a draft gathers");
    assert!(draw(&standard) == first && draw(&gather) == second);
    let fresh = Renderer::new(scene, None).frame(&gather, &run);
    assert!(fresh.unwrap().image == second);
}

/// Stops a job once its gather has begun.
#[derive(Default)]
struct StopsGather(AtomicU32);

impl Progress for StopsGather {
    fn stage(&self, name: &'static str, total: u64) {
        if name == "gather" {
            assert!(total > 1, "one step tells nothing");
            self.0.store(1, Ordering::Relaxed);
        }
    }

    fn advance(&self, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 0
    }
}

#[test]
fn a_gather_can_be_stopped() {
    let scene = lit_room();
    let mut renderer = Renderer::new(scene.clone(), None);
    let stops = StopsGather::default();
    let stopped = RunSettings {
        progress: &stops,
        ..RunSettings::silent()
    };
    let gather = settings(&scene, Component::Global);
    let found = renderer.frame(&gather, &stopped);
    assert!(matches!(found, Err(RenderError::Cancelled)));
    let [whole] = gathered(&scene, [Component::Global]);
    let again = renderer.frame(&gather, &RunSettings::silent());
    assert!(
        again.unwrap().image == whole,
        "what was stopped left a trace"
    );
}

/// A ceiling and a wall that share one smooth normal where they meet, and a lamp that
/// lights the ceiling alone, far from the wall.
const CORNER: &str = "v -2 2.6 -1.6
v 2 2.6 -1.6
v 2 2.6 2.2
v -2 2.6 2.2
v -2 0 -1.6
v 2 0 -1.6
f 1 2 3 4
f 5 6 2 1
";
const LAMP_BELOW_IT: &str = "mesh = \"corner.obj\"
normals = \"smooth\"
[camera]
position = [0, 1.5, 2.2]
target = [0, 2, -1.6]
vfov = 28
size = [32, 24]
[[light]]
kind = \"point\"
position = [-0.5, 2.3, 1.4]
intensity = [6, 6, 6]
[render]
bounces = 1
[bake]
max_edge = 0.25
rays = 64
";

/// Rays along the ceiling meet it from the other side of its leaning normals, where the
/// lamp is not. Vertices know one side only: with their light alone the wall is too
/// bright by a tenth.
#[test]
fn a_light_on_the_other_side_of_a_shading_normal_gives_nothing() {
    let files = [("corner.toml", LAMP_BELOW_IT), ("corner.obj", CORNER)];
    let scene = scene_of_files(&files.map(|(name, text)| (name, text.as_bytes())));
    let paths = ReferenceSettings {
        camera: scene.camera,
        bounces: scene.render.bounces,
        samples: 512,
        seed: 7,
        part: ReferencePart::Indirect,
        glossy: GlossyBounces::All,
    };
    let paths = trace(&scene, &paths, &RunSettings::silent()).unwrap().image;
    let [gather] = gathered(&scene, [Component::Indirect]);
    let bias = compare(&paths, &gather).unwrap().bias;
    at_most("gather, leaning normals", bias.abs(), LEANING);
    let standard = FrameSettings {
        component: Component::Indirect,
        ..FrameSettings::of_scene(&scene)
    };
    let standard = Renderer::new(scene, None).frame(&standard, &RunSettings::silent());
    let bias = compare(&paths, &standard.unwrap().image).unwrap().bias;
    at_least("vertices, leaning normals", bias, 0.05);
}
