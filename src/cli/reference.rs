//! `relume reference`: path-traced truth.

use relume::reference::{GlossyBounces, ReferencePart, ReferenceSettings, trace};
use relume::{
    Bounces, Component, Metadata, Picture, PictureMetadata, Scene, Stages, bounces_text,
    describe_levels, describe_scene, develop, write_described,
};
use serde_json::json;

use super::args::Reference;
use super::error::CliError;
use super::render::{apply_frame, check_outputs, digest, warn_of_black};
use super::report::{Report, stage_times};
use super::run::{load_scene, with_run};

pub(super) fn execute(arguments: &Reference) -> Result<Report, CliError> {
    check_outputs(&arguments.view)?;
    let mut scene = load_scene(&arguments.scene)?;
    apply_frame(&mut scene, &arguments.view.frame);
    warn_of_black(
        &scene,
        match arguments.component.as_str() {
            "glossy" => Component::Glossy,
            _ => Component::Global,
        },
    );
    let direct_alone = arguments.component == "direct";
    let settings = ReferenceSettings {
        camera: scene.camera,
        bounces: if direct_alone {
            Bounces::Count(0)
        } else {
            scene.render.bounces
        },
        samples: arguments.spp,
        seed: arguments.seed,
        part: match arguments.component.as_str() {
            "indirect" => ReferencePart::Indirect,
            "glossy" => ReferencePart::Glossy,
            _ => ReferencePart::Global,
        },
        glossy: arguments.glossy_bounces,
    };
    let mut stages = Stages::default();
    let traced = with_run(&arguments.scene.run, |run| {
        stages
            .time("trace", || trace(&scene, &settings, run))
            .ok_or(CliError::Stopped)
    })?;
    let levels = develop(
        &traced.image,
        Component::Global,
        scene.render.exposure,
        scene.render.tone,
    );
    let picture = Picture {
        linear: &traced.image,
        encoded: &levels,
    };
    let linear = describe(&scene, arguments, &settings);
    let (exposure, tone) = (scene.render.exposure, scene.render.tone);
    let metadata = PictureMetadata {
        encoded: describe_levels(&linear, Component::Global, exposure, tone),
        linear,
    };
    for path in &arguments.view.output {
        write_described(path, picture, &metadata)?;
    }
    let json = json!({
        "digest": digest(&arguments.view, &picture),
        "size": scene.camera.size,
        "spp": arguments.spp,
        "seed": arguments.seed,
        "noise": traced.noise,
        "noise_of_mean": traced.noise_of_mean,
        "ms": stage_times(&[&stages]),
    });
    let text = format!(
        "{} paths a pixel in {:.1} s; noise {:.2} % of the picture, {:.3} % of its mean",
        arguments.spp,
        stages.total_ms() / 1e3,
        traced.noise * 100.0,
        traced.noise_of_mean * 100.0
    );
    Ok(Report {
        json,
        text,
        exit_code: 0,
    })
}

/// What determines the traced values.
fn describe(scene: &Scene, arguments: &Reference, settings: &ReferenceSettings) -> Metadata {
    let mut metadata = describe_scene(scene, &settings.camera);
    metadata.set_own("component", arguments.component.as_str());
    metadata.set_own("bounces", bounces_text(settings.bounces));
    if settings.glossy == GlossyBounces::Final {
        metadata.set_own("glossy_bounces", "final");
    }
    metadata.set_own("paths", settings.samples.to_string());
    metadata.set_own("seed", settings.seed.to_string());
    metadata
}
