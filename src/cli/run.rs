//! From arguments to a running job: scene, threads, cache folder, progress.

use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};

use indicatif::{ProgressBar, ProgressStyle};
use relume::{Override, Progress, RunSettings, Scene, ThreadPool};

use super::args::{Run, SceneArguments};
use super::error::CliError;
use super::golden::printable;
use super::signals;

/// A bar on a terminal, silence elsewhere; stops the job when a signal arrives.
pub(super) struct Bar {
    /// What the job is part of.
    job: String,
    /// Of the stage; hidden before the first. Each has its own, so that nothing of
    /// the one before is seen or counted.
    bar: RwLock<ProgressBar>,
}

impl Bar {
    pub(super) fn new() -> Self {
        Self::of_job("")
    }

    /// A bar that says before each stage what it is part of.
    pub(super) fn of_job(name: &str) -> Self {
        Self {
            job: name.to_owned(),
            bar: RwLock::new(ProgressBar::hidden()),
        }
    }

    /// Takes the bar away before anything else is printed.
    pub(super) fn clear(&self) {
        let bar = self.bar.read().unwrap_or_else(PoisonError::into_inner);
        bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn stage(&self, name: &'static str, total: u64) {
        let style =
            ProgressStyle::with_template("{prefix}{msg:>16} [{bar:40}] {percent:>3}% {eta}")
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("=> ");
        let next = ProgressBar::new(total)
            .with_prefix(self.job.clone())
            .with_message(name)
            .with_style(style);
        let mut bar = self.bar.write().unwrap_or_else(PoisonError::into_inner);
        bar.finish_and_clear();
        next.tick();
        *bar = next;
    }

    fn advance(&self, steps: u64) {
        // Threads do not wait for one another here.
        let bar = self.bar.read().unwrap_or_else(PoisonError::into_inner);
        bar.inc(steps);
    }

    fn cancelled(&self) -> bool {
        signals::exit_code().is_some()
    }
}

/// Runs a job with the arguments' threads, instructions and progress.
pub(super) fn with_run<T: Send>(
    arguments: &Run,
    job: impl FnOnce(&RunSettings) -> Result<T, CliError> + Send,
) -> Result<T, CliError> {
    run_job(arguments, Bar::new(), job)
}

/// [`with_run`] with a bar of the caller's.
pub(super) fn run_job<T: Send>(
    arguments: &Run,
    bar: Bar,
    job: impl FnOnce(&RunSettings) -> Result<T, CliError> + Send,
) -> Result<T, CliError> {
    signals::listen();
    let pool = thread_pool(arguments)?;
    let result = pool.install(|| {
        job(&RunSettings {
            level: arguments.simd,
            progress: &bar,
        })
    });
    bar.clear();
    result
}

/// The threads that the arguments ask for.
pub(super) fn thread_pool(arguments: &Run) -> Result<ThreadPool, CliError> {
    let threads = arguments.threads.map_or(0, usize::from);
    relume::thread_pool(threads).map_err(|error| {
        CliError::Usage(format!(
            "cannot start {threads} threads: {error}; ask for fewer"
        ))
    })
}

/// What the command line changes of a scene.
pub(super) fn overrides(arguments: &SceneArguments) -> Result<Vec<Override>, CliError> {
    let error = arguments.error.map(|error| format!("bake.error={error:?}"));
    let all = arguments.overrides.iter().chain(&error);
    Ok(all
        .map(|text| Override::parse(text))
        .collect::<Result<Vec<_>, _>>()?)
}

/// Reads the scene with the command line's changes and says its warnings.
pub(super) fn load_scene(arguments: &SceneArguments) -> Result<Scene, CliError> {
    let mut scene = Scene::load(&arguments.path, &overrides(arguments)?)?;
    warn(std::mem::take(&mut scene.warnings));
    Ok(scene)
}

/// Says warnings on standard error. Names in them come from whoever wrote the
/// scene: they command neither the terminal nor a CI runner.
#[allow(clippy::print_stderr, reason = "the one place where warnings are said")]
pub(super) fn warn(warnings: Vec<String>) {
    for warning in warnings {
        eprintln!("warning: {}", printable(&warning));
    }
}

/// Says lines on standard error, as they are.
#[allow(
    clippy::print_stderr,
    reason = "the one place where a command speaks to whoever runs it"
)]
pub(super) fn say(lines: &[String]) {
    for line in lines {
        eprintln!("{line}");
    }
}

/// The folder for bakes; `None`: no cache.
pub(super) fn cache_folder(arguments: &Run) -> Option<PathBuf> {
    if arguments.no_cache {
        return None;
    }
    arguments
        .cache_dir
        .clone()
        .or_else(|| dirs::cache_dir().map(|folder| folder.join("relume")))
}
