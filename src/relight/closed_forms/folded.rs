//! All bounces folded into one operator: the light that bounces one by one have.

use std::f64::consts::PI;
use std::sync::Mutex;

use glam::{DVec3, Vec3};

use super::enclosures::{ENCLOSED_LIGHT, SPHERE};
use super::operator::{LINEAR, assert_linear, unlike_fields};
use super::{Baked, Deviation, at_least, at_most};
use crate::bake::{Bake, Progress, RunSettings, Silent};
use crate::relight::bounces::{BounceError, Transport};
use crate::relight::{FrameSettings, RenderError, Renderer};
use crate::scene::sample_scenes::{point_light, room_with_blocks};
use crate::scene::{Bounces, Scene};
use crate::simd::Level;

/// Of folded bounces against bounces one by one: 0.5 % may be left out with small
/// components, steps of eight bits are as much, and a light near a wall has more
/// that the basis cannot express than those that components are chosen by.
const FOLDED: f64 = 0.01;

/// The bake with its bounces folded under an albedo a vertex.
fn folded(baked: &Baked, albedo: &[Vec3]) -> Bake {
    folded_at(baked, albedo, Level::detect())
}

fn folded_at(baked: &Baked, albedo: &[Vec3], level: Level) -> Bake {
    let mut bake = baked.bake.clone();
    let progress: &dyn Progress = &Silent;
    let run = RunSettings { level, progress };
    bake.fold(&baked.surface, albedo, &run)
        .expect("nobody stops it");
    bake
}

/// Red and bright on one side, green on the other, and nearly no blue.
fn colours(baked: &Baked) -> Vec<Vec3> {
    let of = |v: usize| match baked.position(v).x > 0.0 {
        true => Vec3::new(0.8, 0.4, 0.1),
        false => Vec3::new(0.5, 0.7, 0.1),
    };
    (0..baked.vertex_count()).map(of).collect()
}

fn lit_room(closed: bool) -> Scene {
    let mut scene = room_with_blocks(closed, 0.3, 128);
    scene.lights = vec![point_light(DVec3::new(0.2, 0.6, 0.5), 2.0)];
    scene.render.bounces = Bounces::All;
    scene.camera.size = [32, 24];
    scene
}

#[test]
fn folded_bounces_are_those_one_by_one_in_every_channel() {
    let scene = lit_room(false);
    let baked = Baked::new(&scene);
    let albedo = colours(&baked);
    let bake = folded(&baked, &albedo);
    let direct = baked.direct(&scene.lights);
    let source: Vec<Vec3> = direct
        .iter()
        .zip(&albedo)
        .map(|(e, rho)| *e * *rho)
        .collect();
    let transport = Transport {
        bake: &bake,
        level: Level::detect(),
    };
    let one_by_one = transport
        .solve(&source, &albedo, Bounces::All)
        .unwrap()
        .irradiance;
    let at_once = transport.solve_folded(&source, &albedo);
    let at_once = at_once.expect("they are folded").irradiance;
    for channel in 0..3 {
        let found = Deviation::of((0..baked.vertex_count()).map(|v| {
            let [found, wanted] = [&at_once, &one_by_one].map(|field| field[v][channel]);
            (baked.area(v), f64::from(found), f64::from(wanted))
        }));
        at_most(
            &format!("folded, channel {channel}, rms"),
            found.rms,
            FOLDED,
        );
    }
    let sum = |channel: usize| -> f64 { at_once.iter().map(|e| f64::from(e[channel])).sum() };
    at_least("red over blue", sum(0) / sum(2), 3.0);
    let stated = bake.stats().folding.expect("an error is stated");
    at_most("stated error of folding", stated.mean, FOLDED);
}

/// Nothing is extrapolated here: single precision alone remains.
#[test]
fn folded_bounces_are_linear() {
    let baked = Baked::new(&lit_room(false));
    let albedo = colours(&baked);
    let bake = folded(&baked, &albedo);
    let transport = Transport {
        bake: &bake,
        level: Level::detect(),
    };
    assert_linear("folded", unlike_fields(&baked), LINEAR, |field| {
        let solved = transport.solve_folded(field, &albedo);
        solved.expect("they are folded").irradiance
    });
}

#[test]
fn a_folded_sphere_is_lit_evenly() {
    let albedo = 0.8_f32;
    let everywhere = vec![Vec3::splat(albedo); SPHERE.vertex_count()];
    let bake = folded(&SPHERE, &everywhere);
    let light = point_light(DVec3::new(0.1, 0.2, -0.4), 3.0);
    let source: Vec<Vec3> = SPHERE
        .direct(&[light])
        .iter()
        .map(|&e| e * albedo)
        .collect();
    let transport = Transport {
        bake: &bake,
        level: Level::detect(),
    };
    let folded = transport.solve_folded(&source, &everywhere);
    let irradiance = folded.expect("they are folded").irradiance;
    let scale = SPHERE.surface.placement.scale;
    let area = SPHERE.fronts().map(|v| SPHERE.area(v)).sum::<f64>() / (scale * scale);
    // rho / (1 - rho) times the flux over the area.
    let rho = f64::from(albedo);
    let wanted = rho / (1.0 - rho) * 12.0 * PI / area;
    let found = Deviation::of(
        SPHERE
            .fronts()
            .map(|v| (SPHERE.area(v), f64::from(irradiance[v].x), wanted)),
    );
    at_most("folded sphere, rms", found.rms, ENCLOSED_LIGHT);
}

#[test]
fn every_level_folds_to_the_same_bits() {
    let baked = Baked::new(&lit_room(false));
    let albedo = colours(&baked);
    let scalar = folded_at(&baked, &albedo, Level::Scalar);
    assert!(scalar.folded_bytes() > 0);
    for level in [Level::Sse2, Level::Avx2] {
        assert!(folded_at(&baked, &albedo, level) == scalar, "{level:?}");
    }
}

#[test]
fn an_edited_albedo_needs_a_bake() {
    let mut scene = lit_room(false);
    scene.bake.fixed_albedo = true;
    let (settings, run) = (FrameSettings::of_scene(&scene), RunSettings::silent());
    let mut renderer = Renderer::new(scene.clone(), None);
    assert!(renderer.needs_bake(&settings), "there is none yet");
    let first = renderer.frame(&settings, &run).unwrap();
    assert!(!renderer.needs_bake(&settings));
    let darker = |_: &mut Vec<crate::scene::Light>, materials: &mut Vec<crate::scene::Material>| {
        materials[0].albedo = Vec3::new(0.2, 0.3, 0.4);
    };
    renderer.relight(darker);
    assert!(renderer.needs_folding(&settings) && renderer.needs_bake(&settings));
    let counted = FrameSettings {
        bounces: Bounces::Count(2),
        ..settings
    };
    assert!(
        !renderer.needs_bake(&counted),
        "it is for all bounces alone"
    );
    // Meanwhile bounces are carried out one by one.
    let meanwhile = renderer.frame_so_far(&settings, &run).unwrap();
    let mut free = scene.clone();
    free.bake.fixed_albedo = false;
    let mut free = Renderer::new(free, None);
    free.relight(darker);
    let one_by_one = free.frame(&settings, &run).unwrap();
    assert_eq!(meanwhile.image, one_by_one.image);
    // And a frame folds anew, as a fresh scene does.
    let again = renderer.frame(&settings, &run).unwrap();
    assert!(!renderer.needs_bake(&settings));
    let mut fresh = scene;
    darker(&mut Vec::new(), &mut fresh.materials);
    let fresh = Renderer::new(fresh, None).frame(&settings, &run).unwrap();
    assert_eq!(again.image, fresh.image);
    assert_ne!(again.image, first.image);
    assert_ne!(
        again.image, meanwhile.image,
        "folding shows in the last digits"
    );
}

#[test]
fn endless_light_is_not_folded_and_is_an_error_still() {
    let mut scene = lit_room(true);
    scene.bake.fixed_albedo = true;
    for material in &mut scene.materials {
        material.albedo = Vec3::ONE;
    }
    let settings = FrameSettings::of_scene(&scene);
    let mut renderer = Renderer::new(scene, None);
    let frame = renderer.frame(&settings, &RunSettings::silent());
    let diverges = matches!(
        frame,
        Err(RenderError::Bounces(BounceError::Diverges { .. }))
    );
    assert!(diverges, "a closed room of albedo 1");
    assert!(!renderer.needs_bake(&settings), "another bake is no help");
}

/// Names of the stages of a job.
#[derive(Default)]
struct StageNames(Mutex<Vec<&'static str>>);

impl Progress for StageNames {
    fn stage(&self, name: &'static str, _: u64) {
        self.0.lock().unwrap().push(name);
    }

    fn advance(&self, _: u64) {}

    fn cancelled(&self) -> bool {
        false
    }
}

#[test]
fn a_stored_bake_without_folded_bounces_is_folded_and_stored_with_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = lit_room(false);
    let silent = RunSettings::silent();
    let mut free = Renderer::new(scene.clone(), Some(folder.path()));
    free.bake(&silent).unwrap();
    scene.bake.fixed_albedo = true;
    let settings = FrameSettings::of_scene(&scene);
    let renderer = || Renderer::new(scene.clone(), Some(folder.path()));
    let mut fixed = renderer();
    let bake = fixed.outlook(&silent).unwrap().bake;
    assert!(!bake.cached && bake.folded_bytes > 0 && bake.seconds > 0.0);
    assert_eq!(bake.row_bytes, free.figures().bake.unwrap().row_bytes);
    assert!(!fixed.load_bake() && fixed.has_bake() && fixed.needs_folding(&settings));
    let names = StageNames::default();
    let told = RunSettings {
        progress: &names,
        ..RunSettings::silent()
    };
    fixed.bake(&told).unwrap();
    assert_eq!(
        *names.0.lock().unwrap(),
        [
            "prior lights",
            "folding bounces",
            "test lights",
            "test skies",
            "error of folding"
        ]
    );
    let figures = fixed.figures().bake.unwrap();
    assert!(!figures.cached && figures.folded_bytes > 0);
    let picture = fixed.frame(&settings, &silent).unwrap().image;
    let fresh = Renderer::new(scene.clone(), None).frame(&settings, &silent);
    assert!(picture == fresh.unwrap().image, "it is another picture");
    // From now on it is there, to the byte.
    let mut again = renderer();
    assert!(again.load_bake() && !again.needs_bake(&settings));
    let stored = again.figures().bake.unwrap();
    assert!(stored.cached && stored.bytes == figures.bytes);
    assert!(again.outlook(&silent).unwrap().bake.cached);
    assert!(again.frame(&settings, &silent).unwrap().image == picture);
}
