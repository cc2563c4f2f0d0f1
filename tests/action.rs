//! The steps of the GitHub Action (`.github/action/`), run as a runner runs them.
#![cfg(unix)]

mod program;

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use program::{SMALL_BAKE, SMALL_FRAME, only_bake, relume, run, scene, succeed, temporary_folder};

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

/// A check that fails keeps the program that was built for it, and its bakes.
#[test]
fn what_was_made_is_saved_whatever_the_check_says() {
    let yaml = fs::read_to_string(action().join("action.yml")).expect("the action is there");
    let word = |line: &str| {
        let (_, what) = line
            .split_once("uses: ")
            .or(line.split_once("steps.sh\" "))?;
        Some(what.trim_end_matches('\'').to_owned())
    };
    let order: Vec<String> = yaml.lines().filter_map(word).collect();
    let [restore, save] = ["actions/cache/restore@v4", "actions/cache/save@v4"];
    let upload = "actions/upload-artifact@v4";
    let expected = [
        "keys", restore, "build", save, restore, "check", save, upload,
    ];
    assert_eq!(order, expected);
    let (_, after_check) = yaml.split_once("steps.sh\" check").expect("it checks");
    let conditions = after_check.lines().filter(|line| line.contains("if: "));
    assert_eq!(
        conditions
            .map(|line| line.contains("!cancelled()") || line.contains("always()"))
            .collect::<Vec<_>>(),
        [true, true],
        "saved and uploaded"
    );
    for name in ["program", "bakes"] {
        let key = format!("key: ${{{{ steps.{name}.outputs.cache-primary-key }}}}");
        assert!(yaml.contains(&key), "{name} is saved under its own key");
    }
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

#[test]
fn a_check_passes_its_paths_and_its_exit_code_on() {
    let folder = temporary_folder();
    box_with_golden(folder.path());
    let check = || {
        let mut check = step("check", folder.path());
        run(check.env("PATHS", "cornell.toml").env("REPORT", "report"))
    };
    let fine = check();
    assert_eq!(fine.exit_code, Some(0), "{fine:?}");
    assert!(fine.stdout.contains("1 scene, all pass"), "{fine:?}");
    assert!(folder.path().join("report/summary.json").exists());
    only_bake(&folder.path().join("runner/relume/bakes"));
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
    let failed = check();
    assert_eq!(failed.exit_code, Some(1), "{failed:?}");
}

#[test]
fn an_unknown_step_says_what_there_is() {
    let finished = run(&mut step("bless", temporary_folder().path()));
    assert_eq!(finished.exit_code, Some(2), "{finished:?}");
    assert!(finished.stderr.contains("steps.sh check"), "{finished:?}");
}
