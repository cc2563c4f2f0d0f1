//! What a bake and a frame cost, on the statues: ignored by default, since time
//! on a shared machine is no pass or fail. Run it as
//! `cargo test --release --test timing -- --ignored --nocapture`.
#![allow(clippy::print_stdout, reason = "its figures are for reading")]

use std::path::Path;
use std::time::Instant;

use relume::{Bounces, Frame, FrameSettings, LightKind, Override, Renderer, RunSettings, Scene};

/// The statues alone have 34,600 front vertices, and as many backs again where
/// they sink into their pedestals; this keeps the hall small beside them.
const MAX_EDGE: &str = "bake.max_edge=3.0";
/// Frames whose median is told.
const FRAMES: usize = 15;
/// What a frame with one moved light may take, ms: twice what it takes on an
/// idle machine of two cores, so that only a real fault fails.
const FRAME_LIMIT_MS: f64 = 240.0;
/// What the bake may take, seconds.
const BAKE_LIMIT_S: f64 = 60.0;

#[test]
#[ignore = "bakes for half a minute; its figures are for reading"]
fn statues_bake_and_relight() {
    let overrides = [Override::parse(MAX_EDGE).unwrap()];
    let scene = Scene::load(Path::new("scenes/statues/statues.toml"), &overrides).unwrap();
    let mut settings = FrameSettings::of_scene(&scene);
    settings.bounces = Bounces::Count(3);
    settings.camera.size = [640, 480];
    let run = RunSettings::silent();
    let mut renderer = Renderer::new(scene, None);
    let start = Instant::now();
    renderer.bake(&run).unwrap();
    println!(
        "{} vertices, bake {:.1} s",
        renderer.figures().vertices,
        start.elapsed().as_secs_f64()
    );
    assert!(
        start.elapsed().as_secs_f64() < BAKE_LIMIT_S,
        "the bake took {:.0} s",
        start.elapsed().as_secs_f64()
    );
    let first = renderer.frame(&settings, &run).unwrap();
    println!("first frame: {:.0} ms", first.stages.total_ms());
    let mut frames: Vec<Frame> = (0..FRAMES)
        .map(|step| {
            renderer.relight(|lights, _| {
                if let LightKind::Point(lamp) = &mut lights[0].kind {
                    lamp.position.x -= 0.02 * (step + 1) as f64;
                }
            });
            renderer.frame(&settings, &run).unwrap()
        })
        .collect();
    assert!(
        frames.iter().all(|f| f.computed_lights == 1),
        "every frame moves the one light"
    );
    frames.sort_by(|a, b| a.stages.total_ms().total_cmp(&b.stages.total_ms()));
    let median = &frames[FRAMES / 2].stages;
    for (stage, time_ms) in median.times_ms() {
        println!("{stage:>20}: {time_ms:6.1} ms");
    }
    println!(
        "one moved light, 3 bounces, 640 x 480: {:.1} ms (median)",
        median.total_ms()
    );
    assert!(
        median.total_ms() < FRAME_LIMIT_MS,
        "a frame took {:.0} ms",
        median.total_ms()
    );
}
