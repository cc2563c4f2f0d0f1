//! What is kept from frame to frame never shows: incremental frames have the
//! bits of fresh ones.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec3};

use super::{Baked, update};
use crate::bake::{Progress, RunSettings};
use crate::relight::kept::KeptDirect;
use crate::relight::{Effort, FrameSettings, Renderer};
use crate::scene::PlacedLights;
use crate::scene::sample_scenes::{point_light, room_with_blocks};
use crate::scene::{Light, LightKind, Scene};

fn lit_room() -> Scene {
    let mut scene = room_with_blocks(false, 0.25, 128);
    scene.lights = vec![
        point_light(DVec3::new(0.2, 0.7, 0.5), 2.0),
        point_light(DVec3::new(-0.6, -0.1, 0.4), 0.3),
    ];
    scene.camera.size = [48, 32];
    scene
}

fn move_light(light: &mut Light, by: DVec3) {
    match &mut light.kind {
        LightKind::Point(point) => point.position += by,
        other => panic!("{other:?} is no point light"),
    }
}

fn put_light(light: &mut Light, place: DVec3) {
    match &mut light.kind {
        LightKind::Point(point) => point.position = place,
        other => panic!("{other:?} is no point light"),
    }
}

fn bits(values: &[Vec3]) -> Vec<[u32; 3]> {
    values
        .iter()
        .map(|v| v.to_array().map(f32::to_bits))
        .collect()
}

#[test]
fn kept_direct_light_has_the_bits_of_fresh_light() {
    let mut scene = lit_room();
    let room = Baked::new(&scene);
    let mut kept = KeptDirect::default();
    for step in 0..=20 {
        let lights = PlacedLights::of_file(&scene.lights, &room.surface.placement);
        let computed = update(&mut kept, &room.surface, &lights);
        assert_eq!(
            computed,
            if step == 0 { 2 } else { 1 },
            "lights computed in step {step}"
        );
        let (incremental, _) = kept.sum(room.vertex_count());
        assert_eq!(
            bits(incremental),
            bits(&room.direct(&scene.lights)),
            "step {step}"
        );
        let there = if step < 10 { 0.0625 } else { -0.0625 };
        move_light(&mut scene.lights[0], DVec3::new(there, 0.0, -there));
    }
}

#[test]
fn a_frame_after_many_moves_has_the_bits_of_the_first() {
    let scene = lit_room();
    let settings = FrameSettings::of_scene(&scene);
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(scene, None);
    let first = renderer.frame(&settings, &run).unwrap().image;
    for step in 0..20 {
        let there = if step < 10 { 0.0625 } else { -0.0625 };
        renderer.relight(|lights, _| move_light(&mut lights[0], DVec3::new(there, 0.0, 0.0)));
        let moved = renderer.frame(&settings, &run).unwrap().image;
        assert_eq!(moved == first, step == 19, "step {step}");
    }
}

/// Moves of one light before the frame is compared with a fresh one.
const MOVES: u32 = 10_000;

#[test]
fn ten_thousand_moves_leave_no_trace() {
    let mut scene = room_with_blocks(false, 1.0, 32);
    scene.lights = lit_room().lights;
    scene.camera.size = [8, 6];
    let settings = FrameSettings::of_scene(&scene);
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(scene, None);
    let first = renderer.frame(&settings, &run).unwrap().image;
    let mut changed = 0;
    let mut last = first.clone();
    for step in 1..=MOVES {
        // Places that do not repeat, in walls and blocks too, for either light
        // in turn.
        let place = DVec3::new(
            f64::from(step % 97) / 48.0,
            f64::from(step % 89) / 44.0,
            f64::from(step % 83) / 41.0,
        );
        renderer.relight(|lights, _| put_light(&mut lights[(step % 2) as usize], place - 1.0));
        let image = renderer.frame(&settings, &run).unwrap().image;
        changed += u32::from(image != last);
        last = image;
    }
    assert!(
        changed > MOVES / 2,
        "{changed} of {MOVES} moves changed the frame"
    );
    let moved = renderer.scene().clone();
    let fresh = Renderer::new(moved, None).frame(&settings, &run).unwrap();
    assert_eq!(last, fresh.image, "not the bits of a fresh frame");
    assert!(last != first, "the lights have moved");
}

/// Edits of all kinds, of which each leaves something of the last frame to keep.
fn edit(scene: &mut Scene, step: u32) {
    let by = f64::from(step + 1) / 64.0;
    match step % 7 {
        0 | 4 => move_light(&mut scene.lights[(step % 2) as usize], DVec3::splat(by)),
        1 => scene.camera.position += DVec3::new(by, 0.0, 0.0),
        2 => scene.materials[0].albedo = Vec3::splat(0.3 + by as f32),
        3 => scene.lights.swap(0, 1),
        5 => scene.lights.push(scene.lights[0].clone()),
        _ => scene.lights.truncate(2),
    }
}

#[test]
fn drafts_and_edits_leave_no_trace_in_a_full_frame() {
    let mut scene = lit_room();
    scene.lights.push(Light {
        name: "panel".to_owned(),
        kind: LightKind::Area(crate::scene::Area {
            corner: DVec3::new(-0.2, 0.9, -0.2),
            edge_u: DVec3::new(0.4, 0.0, 0.0),
            edge_v: DVec3::new(0.0, 0.0, 0.4),
            radiance: Vec3::ONE,
        }),
    });
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(scene.clone(), None);
    for step in 0..14 {
        edit(&mut scene, step);
        let (lights, materials) = (scene.lights.clone(), scene.materials.clone());
        renderer.relight(|l, m| (*l, *m) = (lights, materials));
        let full = FrameSettings::of_scene(&scene);
        let draft = FrameSettings {
            effort: Effort::Draft,
            ..full
        };
        let drafted = renderer.frame(&draft, &run).unwrap().image;
        let image = renderer.frame(&full, &run).unwrap().image;
        let again = renderer.frame(&full, &run).unwrap();
        assert_eq!(again.computed_lights, 0, "step {step}");
        let fresh = Renderer::new(scene.clone(), None).frame(&full, &run);
        let fresh = fresh.unwrap().image;
        assert!(image == fresh && again.image == fresh, "step {step}");
        assert!(drafted != fresh, "step {step}: a draft has no smooth edges");
    }
}

#[test]
fn a_frame_that_was_stopped_leaves_no_trace() {
    let scene = lit_room();
    let settings = FrameSettings::of_scene(&scene);
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(scene, None);
    let first = renderer.frame(&settings, &run).unwrap().image;
    for questions in 0..12 {
        let stops = StopsAfter(AtomicU32::new(questions));
        let stopped = RunSettings {
            progress: &stops,
            ..RunSettings::silent()
        };
        renderer.relight(|lights, _| move_light(&mut lights[0], DVec3::new(0.125, 0.0, 0.0)));
        // Stopped sooner or later, or after all.
        let _ = renderer.frame(&settings, &stopped);
        renderer.relight(|lights, _| move_light(&mut lights[0], DVec3::new(-0.125, 0.0, 0.0)));
        let image = renderer.frame(&settings, &run).unwrap().image;
        assert!(image == first, "stopped at question {questions}");
    }
}

/// Lets a job ask so many times before it is stopped.
struct StopsAfter(AtomicU32);

impl Progress for StopsAfter {
    fn stage(&self, _: &'static str, _: u64) {}

    fn advance(&self, _: u64) {}

    fn cancelled(&self) -> bool {
        let left = |left: u32| left.checked_sub(1);
        self.0
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, left)
            .is_err()
    }
}

#[test]
fn an_edited_albedo_gives_the_frame_of_a_fresh_scene_without_a_bake() {
    let scene = lit_room();
    let mut edited = scene.clone();
    edited.materials[0].albedo = Vec3::new(0.9, 0.2, 0.05);
    let settings = FrameSettings::of_scene(&scene);
    let run = RunSettings::silent();

    let mut renderer = Renderer::new(scene, None);
    renderer.frame(&settings, &run).unwrap();
    let preparation = renderer.preparation().clone();
    renderer.relight(|_, materials| materials[0].albedo = edited.materials[0].albedo);
    let frame = renderer.frame(&settings, &run).unwrap();
    assert_eq!(*renderer.preparation(), preparation, "a new bake was made");
    assert_eq!(
        frame.computed_lights, 0,
        "direct light does not know albedo"
    );

    let fresh = Renderer::new(edited, None).frame(&settings, &run).unwrap();
    assert_eq!(
        frame.image, fresh.image,
        "the frame is not that of a fresh scene"
    );
}
