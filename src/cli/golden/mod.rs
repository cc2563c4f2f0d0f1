//! `relume golden check` and `relume golden bless`: scenes and their goldens.

mod arguments;
mod bless;
mod check;
mod github;
mod summary;

use std::path::Path;

use relume::golden::{Checked, DrawSettings, FindError, GoldenScene, Suite, Verdict, find};
use relume::{Override, SceneError};

use super::error::CliError;
use super::report::Report;
use super::run::{Bar, cache_folder, run_job, warn};
use super::signals;
pub(super) use arguments::Golden;
use arguments::SuiteArguments;
pub(super) use github::printable;

pub(super) fn execute(arguments: &Golden) -> Result<Report, CliError> {
    match arguments {
        Golden::Check(arguments) => check::execute(arguments),
        Golden::Bless(arguments) => bless::execute(arguments),
    }
}

/// The scenes of a suite, of which there must be one.
fn suite(arguments: &SuiteArguments) -> Result<Suite, CliError> {
    let suite = find(&arguments.paths).map_err(|error| FindError {
        // It may be one that was found below those that were given.
        path: printable(&text_of(&error.path)).into(),
        ..error
    })?;
    if suite.scenes.is_empty() {
        let paths = arguments.paths.iter().map(|it| printable(&text_of(it)));
        return Err(CliError::Usage(format!(
            "there is no scene below {}; a scene is a .toml file that sets `mesh`",
            paths.collect::<Vec<_>>().join(" and ")
        )));
    }
    Ok(suite)
}

/// Draws and judges every scene, in their order.
fn check_all(
    scenes: Vec<GoldenScene>,
    arguments: &SuiteArguments,
) -> Result<Vec<Checked>, CliError> {
    let overrides = overrides(arguments)?;
    let folder = cache_folder(&arguments.run);
    let settings = DrawSettings {
        overrides: &overrides,
        cache_folder: folder.as_deref(),
    };
    let count = scenes.len();
    let mut checked = Vec::with_capacity(count);
    for (index, scene) in scenes.into_iter().enumerate() {
        let name = scene.scene().display().to_string();
        let bar = Bar::of_job(&format!("{}/{count} {} ", index + 1, printable(&name)));
        let mut one = run_job(&arguments.run, bar, |run| {
            scene.check(&settings, run).map_err(|_| CliError::Stopped)
        })?;
        if signals::exit_code().is_some() {
            return Err(CliError::Stopped);
        }
        let warnings = std::mem::take(&mut one.warnings);
        warn(warnings.iter().map(|it| format!("{name}: {it}")).collect());
        one.warnings = warnings;
        checked.push(one);
    }
    Ok(checked)
}

fn overrides(arguments: &SuiteArguments) -> Result<Vec<Override>, SceneError> {
    let size = arguments
        .size
        .map(|size| format!("camera.size={:?}", size.0));
    let texts = arguments.overrides.iter().chain(&size);
    texts.map(|text| Override::parse(text)).collect()
}

/// The exit code of one scene; that of all is the highest.
fn exit_code(verdict: &Verdict) -> u8 {
    match verdict {
        Verdict::Passes(_) => 0,
        Verdict::Differs { .. } | Verdict::Missing | Verdict::Faulty(_) => 1,
        Verdict::Golden(error) | Verdict::Scene(error) => 2 + u8::from(error.is_io()),
    }
}

fn text_of(path: &Path) -> String {
    path.display().to_string()
}

/// "1 scene", "2 scenes".
fn counted(count: usize, what: &str) -> String {
    let end = if count == 1 { "" } else { "s" };
    format!("{count} {what}{end}")
}
