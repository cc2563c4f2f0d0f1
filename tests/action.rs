//! The steps of the GitHub Action (`.github/action/`), run as a runner runs them.
#![cfg(unix)]

mod program;

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use program::{Finished, SMALL_BAKE, SMALL_FRAME, relume, run, scene, succeed, temporary_folder};

fn action() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(".github/action")
}

/// A step in a folder, with the files of the caches beside it.
fn step(name: &str, folder: &Path) -> Command {
    let mut command = Command::new("bash");
    command
        .arg(action().join("steps.sh"))
        .arg(name)
        .current_dir(folder)
        .env("RUNNER_TEMP", folder.join("runner"))
        .env_remove("GITHUB_OUTPUT")
        .env_remove("GITHUB_ACTIONS")
        .env("RELUME", env!("CARGO_BIN_EXE_relume"));
    command
}

/// A small box, its golden beside it.
fn box_with_golden(folder: &Path) {
    for name in ["cornell.toml", "cornell.obj", "cornell.mtl"] {
        let from = scene("cornell").with_file_name(name);
        fs::copy(from, folder.join(name)).expect("the scene can be copied");
    }
    let file = folder.join("cornell.toml");
    let text = fs::read_to_string(&file).expect("the scene is text");
    // The scene's own golden is drawn otherwise.
    let (text, _) = text.split_once("\n[golden]").expect("it has a golden");
    let text = text.replace("size = [640, 480]", "size = [40, 30]");
    let keys: Vec<&str> = SMALL_BAKE
        .into_iter()
        .filter_map(|word| word.strip_prefix("bake."))
        .collect();
    fs::write(&file, format!("{text}\n[bake]\n{}\n", keys.join("\n"))).expect("written");
    let mut command = relume(&["render", "--no-cache", "-o"]);
    let golden = folder.join("cornell.golden.png");
    succeed(command.arg(golden).arg(&file).args(SMALL_FRAME));
}

/// Lets a step take this as the program.
fn write_script(path: &Path, text: &str) {
    fs::write(path, format!("#!/bin/sh\n{text}\n")).expect("the script can be written");
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("it can be run");
}

/// A key of what `keys` says.
fn key(folder: &Path, paths: &str, name: &str) -> String {
    let finished = succeed(step("keys", folder).env("PATHS", paths));
    let line = finished.stdout.lines().find_map(|line| {
        let (key, value) = line.split_once('=')?;
        (key == name).then(|| value.to_owned())
    });
    line.unwrap_or_else(|| panic!("{name} is missing: {finished:?}"))
}

#[test]
fn caches_are_named_by_the_content_of_scenes() {
    let [one, other] = [(); 2].map(|()| temporary_folder());
    for folder in [&one, &other] {
        box_with_golden(folder.path());
    }
    let scenes = |folder: &tempfile::TempDir| key(folder.path(), ".", "scenes");
    let before = scenes(&one);
    assert_eq!(before.len(), 32, "{before}");
    assert_eq!(before, scenes(&other), "the same scenes in another folder");
    fs::write(one.path().join("notes.txt"), "x").expect("written");
    assert_eq!(before, scenes(&one), "what is no scene does not count");
    fs::write(one.path().join("cornell.mtl"), "newmtl x").expect("written");
    assert_ne!(before, scenes(&one), "a material counts");
    let program = |folder: &tempfile::TempDir| key(folder.path(), ".", "program");
    assert_eq!(program(&one), program(&other), "relume is the same");
    let of_file = key(other.path(), "./cornell.toml", "scenes");
    assert_eq!(of_file, before, "a file stands for its folder");
}

#[test]
fn keys_go_where_a_runner_reads_them() {
    let folder = temporary_folder();
    let output = folder.path().join("output");
    let finished = succeed(step("keys", folder.path()).env("GITHUB_OUTPUT", &output));
    assert_eq!(finished.stdout, "");
    let text = fs::read_to_string(output).expect("the keys are there");
    let names: Vec<&str> = text.lines().filter_map(|l| l.split('=').next()).collect();
    let expected = ["program", "scenes", "program-folder", "bakes-folder"];
    assert_eq!(names, expected);
    let yaml = fs::read_to_string(action().join("action.yml")).expect("the action is there");
    for name in expected {
        let used = format!("steps.keys.outputs.{name} }}}}");
        assert!(yaml.contains(&used), "{name} is used");
    }
}

#[test]
fn the_action_does_nothing_beside_the_script() {
    let yaml = fs::read_to_string(action().join("action.yml")).expect("the action is there");
    let steps: Vec<&str> = yaml
        .lines()
        .filter_map(|line| line.split_once("run: ").map(|(_, what)| what))
        .collect();
    let expected =
        ["keys", "build", "check"].map(|name| format!("'\"$GITHUB_ACTION_PATH/steps.sh\" {name}'"));
    assert_eq!(steps, expected);
}

#[test]
fn a_program_is_built_once_from_the_actions_own_checkout() {
    let folder = temporary_folder();
    let cargo = folder.path().join("cargo");
    let log = folder.path().join("log");
    write_script(
        &cargo,
        &format!(
            "echo \"$@\" >>{log}\nmkdir -p runner/relume/build/release\n\
             cp {cargo} runner/relume/build/release/relume",
            log = log.display(),
            cargo = cargo.display()
        ),
    );
    for _ in 0..2 {
        let mut build = step("build", folder.path());
        succeed(build.env("CARGO", &cargo).env_remove("RELUME"));
    }
    let calls = fs::read_to_string(log).expect("cargo was called");
    assert_eq!(
        calls.lines().count(),
        1,
        "the second time it is there: {calls}"
    );
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    assert!(
        calls.contains(&format!("--manifest-path {}", manifest.display())),
        "{calls}"
    );
    assert!(folder.path().join("runner/relume/release/relume").exists());
}

/// `check` with the program's own command, or with a script in its place where
/// the program has none: what arrives there, and what comes back.
#[test]
fn a_check_passes_its_paths_and_its_exit_code_on() {
    let folder = temporary_folder();
    box_with_golden(folder.path());
    let check = |program: &Path| -> Finished {
        let mut check = step("check", folder.path());
        check.env("PATHS", "cornell.toml").env("REPORT", "report");
        run(check.env("RELUME", program))
    };
    let stub = folder.path().join("stub");
    let real = Path::new(env!("CARGO_BIN_EXE_relume"));
    let is_there = run(&mut relume(&["golden", "check", "--help"])).exit_code == Some(0);
    write_script(
        &stub,
        "echo \"$@\"\ngrep -q '3.3, 2.9, 2.3' cornell.toml || exit 1\n\
         mkdir -p report && echo {} >report/summary.json",
    );
    let program = if is_there { real } else { &stub };
    let fine = check(program);
    assert_eq!(fine.exit_code, Some(0), "{fine:?}");
    assert!(folder.path().join("report/summary.json").exists());
    if !is_there {
        let bakes = folder.path().join("runner/relume/bakes");
        let expected = format!(
            "golden check cornell.toml -o report --cache-dir {}",
            bakes.display()
        );
        assert_eq!(fine.stdout.trim(), expected);
    }
    let file = folder.path().join("cornell.toml");
    let text = fs::read_to_string(&file).expect("the scene is text");
    let intensity = text
        .lines()
        .find(|l| l.starts_with("intensity"))
        .expect("a lamp");
    fs::write(
        &file,
        text.replace(intensity, "intensity = [1.0, 1.0, 1.0]"),
    )
    .expect("written");
    let failed = check(program);
    assert_eq!(failed.exit_code, Some(1), "{failed:?}");
}

#[test]
fn an_unknown_step_says_what_there_is() {
    let finished = run(&mut step("bless", temporary_folder().path()));
    assert_eq!(finished.exit_code, Some(2), "{finished:?}");
    assert!(finished.stderr.contains("steps.sh check"), "{finished:?}");
}
