//! `relume measure`: how fast frames are.

use relume::measure::{FrameTimes, LightCircle, Spread, time_frames};
use relume::{Bounces, FrameSettings, Renderer, SimdLevel};
use serde_json::{Map, Value, json};

use super::args::Measure;
use super::error::CliError;
use super::info::announce_bake;
use super::render::apply_frame;
use super::report::{Report, rounded, stage_key};
use super::run::{cache_folder, load_scene, warn, with_run};

pub(super) fn execute(arguments: &Measure) -> Result<Report, CliError> {
    let Some(frames) = arguments.frames else {
        return Err(CliError::Usage(
            "measure needs --frames N: the number of frames to time".to_owned(),
        ));
    };
    let mut scene = load_scene(&arguments.scene)?;
    apply_frame(&mut scene, &arguments.frame);
    // Before the bake, which may take minutes.
    LightCircle::of(&scene)?;
    let settings = FrameSettings::of_scene(&scene);
    let run = &arguments.scene.run;
    let folder = cache_folder(run);
    let mut renderer = with_run(run, |_| Ok(Renderer::new(scene, folder.as_deref())))?;
    warn(renderer.take_warnings());
    if renderer.needs_bake(&settings) {
        announce_bake(&mut renderer, run)?;
    }
    let times = with_run(run, |run| {
        Ok(time_frames(&mut renderer, &settings, frames, run)?)
    })?;
    warn(renderer.take_warnings());
    let vertices = renderer.figures().vertices;
    Ok(Report {
        json: object(&times, &settings, vertices),
        text: text(&times, &settings, vertices),
        exit_code: 0,
    })
}

fn object(times: &FrameTimes, settings: &FrameSettings, vertices: usize) -> Value {
    let by_stage = |figure: fn(&Spread) -> f64| {
        let mut object = Map::new();
        for stage in &times.stages {
            object.insert(stage_key(stage.stage), rounded(figure(&stage.time_ms)));
        }
        object.insert("total".to_owned(), rounded(figure(&times.total_ms)));
        Value::Object(object)
    };
    json!({
        "frames": times.frames,
        "frames_per_second": rounded(times.frames_per_second()),
        "ms": by_stage(|spread| spread.median),
        "ms_5th_percentile": by_stage(|spread| spread.low),
        "ms_95th_percentile": by_stage(|spread| spread.high),
        "light": times.light,
        "vertices": vertices,
        "size": settings.camera.size,
        "bounces": match settings.bounces {
            Bounces::Count(count) => json!(count),
            Bounces::All => json!("all"),
        },
        "threads": times.threads,
        "simd": simd_name(times.level),
    })
}

fn simd_name(level: SimdLevel) -> &'static str {
    match level {
        SimdLevel::Scalar => "scalar",
        SimdLevel::Sse2 => "sse2",
        SimdLevel::Avx2 => "avx2",
    }
}

fn text(times: &FrameTimes, settings: &FrameSettings, vertices: usize) -> String {
    let [width, height] = settings.camera.size;
    let bounces = match settings.bounces {
        Bounces::Count(1) => "1 bounce".to_owned(),
        Bounces::Count(count) => format!("{count} bounces"),
        Bounces::All => "all bounces".to_owned(),
    };
    let threads = match times.threads {
        1 => "1 thread".to_owned(),
        threads => format!("{threads} threads"),
    };
    let mut text = format!(
        "{} frames of {width} x {height}, {bounces}, {vertices} vertices; {threads}, {}; \
         {} moves\n\n{:<20} {:>9} {:>9} {:>9}\n",
        times.frames,
        simd_name(times.level),
        times.light,
        "ms",
        "median",
        "5th %",
        "95th %",
    );
    let stages = times.stages.iter().map(|s| (s.stage, s.time_ms));
    for (stage, spread) in stages.chain([("total", times.total_ms)]) {
        text.push_str(&format!(
            "{stage:<20} {:>9.2} {:>9.2} {:>9.2}\n",
            spread.median, spread.low, spread.high
        ));
    }
    text.push_str(&format!(
        "\n{:.1} frames a second",
        times.frames_per_second()
    ));
    text
}
