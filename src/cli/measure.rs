//! `relume measure`: how fast frames are, and how wrong.

use std::path::Path;

use relume::measure::{FrameTimes, LightCircle, MainFigures, ReportSettings, Spread, time_frames};
use relume::{Bounces, FrameSettings, OutputError, Renderer, Scheme, SimdLevel, write_folder};
use serde_json::{Map, Value, json};

use super::args::Measure;
use super::error::CliError;
use super::info::{announce_bake, announce_report};
use super::render::apply_frame;
use super::report::{Report, errors, rounded, stage_key};
use super::run::{cache_folder, load_scene, warn, with_run};

/// Size of a report's frames, where nothing else is asked for.
const REPORT_SIZE: [u32; 2] = [320, 240];

pub(super) fn execute(arguments: &Measure) -> Result<Report, CliError> {
    match (&arguments.output, arguments.frames) {
        (None, None) => Err(CliError::Usage(
            "measure needs -o DIR, the folder for its report, or --frames N, the number of \
             frames to time"
                .to_owned(),
        )),
        (None, Some(frames)) => timed(arguments, frames),
        (Some(_), _) if arguments.scene.scheme == Scheme::Paper => Err(CliError::Usage(
            "a report measures both schemes; --scheme is for --frames alone".to_owned(),
        )),
        (Some(folder), None) => measured(arguments, folder),
        (Some(folder), Some(frames)) => {
            check_report_folder(folder)?;
            let timed = timed(arguments, frames)?;
            let mut report = measured(arguments, folder)?;
            report.json["frames"] = timed.json;
            report.text = format!("{}\n\n{}", timed.text, report.text);
            Ok(report)
        }
    }
}

/// Refuses before minutes of work what cannot become a folder, and one that nothing
/// can be written to.
fn check_report_folder(folder: &Path) -> Result<(), CliError> {
    let made = std::fs::create_dir_all(folder);
    let written = made.and_then(|()| tempfile::tempfile_in(folder));
    written.map(drop).map_err(|source| {
        CliError::Output(OutputError::Write {
            path: folder.to_owned(),
            source,
        })
    })
}

fn measured(arguments: &Measure, folder: &Path) -> Result<Report, CliError> {
    let mut scene = load_scene(&arguments.scene)?;
    check_report_folder(folder)?;
    scene.camera.size = REPORT_SIZE;
    apply_frame(&mut scene, &arguments.frame);
    let stem = arguments.scene.path.file_stem();
    let settings = ReportSettings {
        name: stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
        frame: FrameSettings::of_scene(&scene),
        samples: arguments.spp,
    };
    announce_report(&scene, &settings, &arguments.scene.run)?;
    let measured = with_run(&arguments.scene.run, |run| {
        Ok(relume::measure::report(scene, &settings, run)?)
    })?;
    warn(measured.warnings);
    write_folder(folder, &measured.files)?;
    Ok(Report {
        json: main_figures(&measured.figures),
        text: format!(
            "{}\n{}",
            summary(&measured.figures),
            folder.join("report.html").display()
        ),
        exit_code: 0,
    })
}

fn main_figures(figures: &MainFigures) -> Value {
    let schemes = figures.schemes.iter().map(|it| {
        let object = json!({
            "partitioner": it.scheme.partitioner().name(),
            "bytes_per_vertex": it.bytes_per_vertex,
            "one_bounce": errors(&it.one_bounce),
            "four_bounces": errors(&it.four_bounces),
            "relight_ms": rounded(it.relight_ms),
        });
        (it.scheme.name().to_owned(), object)
    });
    let ratios = figures.ratios_at_equal_bytes.iter();
    let ratios = ratios.map(|(bytes, ratio)| {
        let rays = figures.rays_of_ratios;
        json!({ "bytes_per_vertex": bytes, "ratio": ratio, "rays": rays })
    });
    let images = figures.images.iter().map(|it| {
        let of = |which: usize| {
            json!({
                "relative_rmse": it.relative_rmse[which],
                "is_below_noise": it.relative_rmse[which] == 0.0 && it.noise[which] > 0.0,
                "noise": it.noise[which],
                "path_seconds": it.path_seconds[which],
                "ratio": it.ratios[which],
                "break_even_frames": it.break_even_frames[which],
            })
        };
        let object = json!({
            "pixels": of(0),
            "blocks": of(1),
            "bias": it.bias,
            "flip": { "mean": it.flip[0], "p95": it.flip[1], "halves": it.flip_of_halves },
            "frame_ms": rounded(it.frame_ms),
        });
        (it.name().replace(", ", "_"), object)
    });
    let glossy = figures.glossy.iter();
    let glossy = glossy.map(|&(roughness, error, bias)| {
        json!({ "roughness": roughness, "relative_rmse": error, "bias": bias })
    });
    json!({
        "vertices": figures.vertices,
        "receivers": figures.receivers,
        "schemes": Value::Object(schemes.collect()),
        "stated": figures.stated.as_ref().map(errors),
        "noise_of_truth": figures.truth_noise,
        "paper_over_relume": ratios.collect::<Vec<_>>(),
        "images": Value::Object(images.collect()),
        "glossy": glossy.collect::<Vec<_>>(),
        "bake_seconds": figures.bake_seconds,
        "threads": figures.threads,
        "seconds": figures.seconds,
        "variants_tried": figures.variants_tried,
    })
}

fn summary(figures: &MainFigures) -> String {
    let mut lines = vec![format!(
        "{} vertices; {:.0} s, of which the bake {:.1} s",
        figures.vertices, figures.seconds, figures.bake_seconds
    )];
    for it in &figures.schemes {
        lines.push(format!(
            "{:<8} {:>4.0} bytes a vertex: error {:.2} % (95th percentile {:.2} %), four bounces \
             {:.2} % ({:.2} %) in {:.2} ms",
            it.scheme.name(),
            it.bytes_per_vertex,
            it.one_bounce.mean * 100.0,
            it.one_bounce.p95 * 100.0,
            it.four_bounces.mean * 100.0,
            it.four_bounces.p95 * 100.0,
            it.relight_ms,
        ));
    }
    let rays = figures
        .rays_of_ratios
        .map_or(String::new(), |[relume, paper]| {
            format!(" (by {relume} rays a vertex, paper by {paper})")
        });
    for (bytes, ratio) in &figures.ratios_at_equal_bytes {
        lines.push(format!(
            "within {bytes:.0} bytes a vertex, paper's error is {ratio:.2} times relume's{rays}"
        ));
    }
    for it in &figures.images {
        let [pixels, blocks] = [0, 1].map(|which| it.error_text(which));
        let [times, times_of_blocks] = [0, 1].map(|which| it.ratio_text(which));
        lines.push(format!(
            "{:<16} FLIP {:.4}, relRMSE {pixels} (8 x 8: {blocks}), frame {:.1} ms of one thread; \
             time of paths to the same error / frame: {times} (8 x 8: {times_of_blocks})",
            it.name(),
            it.flip[0],
            it.frame_ms,
        ));
    }
    for (roughness, error, bias) in &figures.glossy {
        lines.push(format!(
            "slices at roughness {roughness:.1}: relRMSE {:.1} %, bias {:+.1} %",
            error * 100.0,
            bias * 100.0
        ));
    }
    lines.join("\n")
}

/// Times frames alone.
fn timed(arguments: &Measure, frames: u32) -> Result<Report, CliError> {
    let mut scene = load_scene(&arguments.scene)?;
    apply_frame(&mut scene, &arguments.frame);
    // Before the bake, which may take minutes.
    LightCircle::of(&scene)?;
    let settings = FrameSettings::of_scene(&scene);
    let run = &arguments.scene.run;
    let folder = cache_folder(run);
    let scheme = arguments.scene.scheme;
    let mut renderer = with_run(run, |_| {
        Ok(Renderer::with_scheme(scene, folder.as_deref(), scheme))
    })?;
    warn(renderer.take_warnings());
    if renderer.needs_bake(&settings) {
        announce_bake(&mut renderer, run)?;
    }
    let times = with_run(run, |run| {
        Ok(time_frames(&mut renderer, &settings, frames, run)?)
    })?;
    warn(renderer.take_warnings());
    let vertices = renderer.figures().vertices;
    let mut json = object(&times, &settings, vertices);
    json["scheme"] = json!(scheme.name());
    Ok(Report {
        json,
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
