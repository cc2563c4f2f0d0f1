//! `relume bake`: the precomputation alone.

use relume::Renderer;
use serde_json::json;

use super::args::Bake;
use super::error::CliError;
use super::info::announce_bake;
use super::report::{Report, add_figures, figures_text, stage_times};
use super::run::{cache_folder, load_scene, warn, with_run};

pub(super) fn execute(arguments: &Bake) -> Result<Report, CliError> {
    let scene = load_scene(&arguments.scene)?;
    let folder = cache_folder(&arguments.scene.run);
    let mut renderer = with_run(&arguments.scene.run, |_| {
        let scheme = arguments.scene.scheme;
        Ok(Renderer::with_scheme(scene, folder.as_deref(), scheme))
    })?;
    warn(renderer.take_warnings());
    announce_bake(&mut renderer, &arguments.scene.run)?;
    with_run(&arguments.scene.run, |run| Ok(renderer.bake(run)?))?;
    warn(renderer.take_warnings());
    let figures = renderer.figures();
    let mut json = json!({});
    add_figures(&mut json, &figures);
    json["ms"] = stage_times(&[renderer.preparation()]);
    let text = format!(
        "{}\n{:.2} s",
        figures_text(&figures),
        renderer.preparation().total_ms() / 1e3
    );
    Ok(Report {
        json,
        text,
        exit_code: 0,
    })
}
