//! `relume render`: one frame.

use std::path::Path;

use relume::{
    Component, Frame, FrameSettings, OutputError, Picture, PictureMetadata, Renderer, Scene,
    check_format, describe_levels, write_described,
};
use serde_json::json;

use super::args::{FrameArguments, Render, ViewArguments};
use super::error::CliError;
use super::info::announce_bake;
use super::report::{Report, add_figures, figures_text, stage_times};
use super::run::{cache_folder, load_scene, warn, with_run};

pub(super) fn execute(arguments: &Render) -> Result<Report, CliError> {
    check_outputs(&arguments.view)?;
    let mut scene = load_scene(&arguments.scene)?;
    apply_frame(&mut scene, &arguments.view.frame);
    let (exposure, tone) = (scene.render.exposure, scene.render.tone);
    let settings = FrameSettings {
        component: arguments.component,
        quality: arguments.quality,
        ..FrameSettings::of_scene(&scene)
    };
    warn_of_black(&scene, arguments.component);
    let folder = cache_folder(&arguments.scene.run);

    let mut renderer = with_run(&arguments.scene.run, |_| {
        let scheme = arguments.scene.scheme;
        Ok(Renderer::with_scheme(scene, folder.as_deref(), scheme))
    })?;
    warn(renderer.take_warnings());
    if renderer.needs_bake(&settings) {
        announce_bake(&mut renderer, &arguments.scene.run)?;
    }
    let frame = with_run(&arguments.scene.run, |run| {
        Ok(renderer.frame(&settings, run)?)
    })?;
    warn(renderer.take_warnings());
    let levels = frame.develop(exposure, tone);
    let picture = Picture {
        linear: &frame.image,
        encoded: &levels,
    };
    let linear = renderer.describe(&settings);
    let metadata = PictureMetadata {
        encoded: describe_levels(&linear, settings.component, exposure, tone),
        linear,
    };
    for path in &arguments.view.output {
        write_described(path, picture, &metadata)?;
    }
    Ok(report(
        arguments,
        &renderer,
        &frame,
        &digest(&arguments.view, &picture),
    ))
}

/// Says why a frame will be black, if it is for what the scene lacks.
pub(super) fn warn_of_black(scene: &Scene, component: Component) {
    let has_gloss = scene.materials.iter().any(|it| it.gloss().is_some());
    if component.is_light() && !scene.has_light() {
        warn(vec![
            "the scene has no [[light]], and nothing of its mesh emits: the frame is black"
                .to_owned(),
        ]);
    } else if component == Component::Glossy && !has_gloss {
        warn(vec![
            "no material of the scene is glossy: the frame is black".to_owned(),
        ]);
    }
}

/// Refuses unknown formats and missing folders before a long job, not after it.
pub(super) fn check_outputs(view: &ViewArguments) -> Result<(), CliError> {
    view.output.iter().try_for_each(|path| {
        check_format(path)?;
        check_folder(path)?;
        Ok(())
    })
}

fn check_folder(path: &Path) -> Result<(), OutputError> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
    match folder.map(std::fs::metadata) {
        Some(Err(source)) => Err(OutputError::Write {
            path: path.to_owned(),
            source,
        }),
        _ => Ok(()),
    }
}

/// Size and bounces of the command line, where given.
pub(super) fn apply_frame(scene: &mut Scene, frame: &FrameArguments) {
    if let Some(size) = frame.size {
        scene.camera.size = size.0;
    }
    if let Some(bounces) = frame.bounces {
        scene.render.bounces = bounces;
    }
}

/// Digest of the pixels of the first file: levels of a PNG, values of an EXR.
pub(super) fn digest(view: &ViewArguments, picture: &Picture) -> String {
    let is_linear = view.output[0]
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    if is_linear {
        picture.linear.digest()
    } else {
        picture.encoded.digest()
    }
}

fn report(arguments: &Render, renderer: &Renderer, frame: &Frame, digest: &str) -> Report {
    let figures = renderer.figures();
    let size = [frame.image.width(), frame.image.height()];
    let quality = arguments.quality.name();
    let mut json = json!({ "digest": digest, "size": size, "quality": quality });
    add_figures(&mut json, &figures);
    json["clamped_pixels"] = json!(frame.clamped_pixels);
    json["gathered_rays"] = json!(frame.gathered_rays);
    json["ms"] = stage_times(&[renderer.preparation(), &frame.stages]);
    let mut text = String::new();
    for path in &arguments.view.output {
        text.push_str(&format!("{}: {} x {}\n", path.display(), size[0], size[1]));
    }
    text.push_str(&figures_text(&figures));
    if frame.clamped_pixels > 0 {
        let light = match arguments.component {
            Component::ApproximatedDirect => "approximated direct",
            _ => "indirect",
        };
        text.push_str(&format!(
            "\n{} pixels had {light} light below zero",
            frame.clamped_pixels
        ));
    }
    let seconds = (renderer.preparation().total_ms() + frame.stages.total_ms()) / 1e3;
    text.push_str(&format!(
        "\n{seconds:.2} s, of which the frame {:.0} ms; digest {digest}",
        frame.stages.total_ms()
    ));
    Report {
        json,
        text,
        exit_code: 0,
    }
}
