//! The program as a person or another program runs it: arguments in; exit code
//! and texts out. And the small variants of the repository's scenes, whose
//! bakes take a tenth of a second.

#![allow(dead_code, reason = "each test crate uses its own part of this")]

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// `[bake]` keys with which the box of `scenes/cornell` has about 700 vertices
/// and bakes in a tenth of a second.
pub(crate) const SMALL_BAKE: [&str; 4] = ["--set", "bake.max_edge=0.5", "--set", "bake.rays=64"];
/// A frame that is drawn in milliseconds.
pub(crate) const SMALL_FRAME: [&str; 2] = ["--size", "40x30"];

/// The scene file of a scene of the repository.
pub(crate) fn scene(name: &str) -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    scenes.join(name).join(format!("{name}.toml"))
}

/// A folder that goes away with the test.
pub(crate) fn temporary_folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder can be made")
}

/// The program with arguments, not started yet.
pub(crate) fn relume(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_relume"));
    command.args(arguments);
    command
}

/// What the program did.
#[derive(Debug)]
pub(crate) struct Finished {
    /// `None`: a signal ended it.
    pub(crate) exit_code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Finished {
    pub(crate) fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("the program prints UTF-8");
        Self {
            exit_code: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// The one JSON object on standard output.
    pub(crate) fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("not one JSON value ({error}): {self:#?}"));
        assert!(value.is_object(), "the value is an object: {self:#?}");
        value
    }
}

/// Runs the program to its end.
pub(crate) fn run(command: &mut Command) -> Finished {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?} does not start: {error}"));
    Finished::of(output)
}

/// Runs the program, which must succeed.
pub(crate) fn succeed(command: &mut Command) -> Finished {
    let finished = run(command);
    assert_eq!(finished.exit_code, Some(0), "{command:?}: {finished:#?}");
    finished
}

/// `relume render` of a small box to a file in `folder`, where its cache is too.
pub(crate) fn render_box(folder: &Path, arguments: &[&str]) -> Finished {
    succeed(render_box_command(folder, "frame.png", arguments).arg("--json"))
}

/// The same, not started yet, with a name for the picture.
pub(crate) fn render_box_command(folder: &Path, picture: &str, arguments: &[&str]) -> Command {
    let mut command = relume(&["render"]);
    command
        .arg(scene("cornell"))
        .arg("-o")
        .arg(folder.join(picture))
        .args(SMALL_BAKE)
        .args(SMALL_FRAME)
        .args(arguments);
    if !arguments.contains(&"--cache-dir") && !arguments.contains(&"--no-cache") {
        command.arg("--cache-dir").arg(folder.join("cache"));
    }
    command
}

/// The only bake in a folder of bakes.
pub(crate) fn only_bake(cache: &Path) -> PathBuf {
    let mut files = files_in(cache);
    assert_eq!(files.len(), 1, "one bake and nothing else: {files:?}");
    let file = files.remove(0);
    assert_eq!(file.extension(), Some(OsStr::new("bake")), "{file:?}");
    file
}

/// Everything in a folder, in order; nothing where there is no folder.
pub(crate) fn files_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a folder's entry can be read").path())
        .collect();
    files.sort();
    files
}
