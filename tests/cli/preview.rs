//! `relume preview` by scripts, and where there is no terminal.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

use crate::program::{Finished, SMALL_BAKE, relume, run, scene, succeed, temporary_folder};

/// A copy of the Cornell box in a folder of its own.
struct Session {
    folder: tempfile::TempDir,
}

impl Session {
    fn new() -> Self {
        let folder = temporary_folder();
        let from = scene("cornell");
        let from = from.parent().expect("a scene lies in a folder");
        for name in ["cornell.toml", "cornell.obj", "cornell.mtl"] {
            fs::copy(from.join(name), folder.path().join(name)).expect("the scene is copied");
        }
        Self { folder }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = relume(arguments);
        command.args(SMALL_BAKE).args(["--cache-dir", "cache"]);
        command.current_dir(self.folder.path());
        command
    }

    fn play(&self, script: &str) -> Finished {
        fs::write(self.at("a.script"), script).expect("the script is written");
        run(&mut self.command(&["preview", "cornell.toml", "--script", "a.script", "--json"]))
    }

    fn played(&self, script: &str) -> Value {
        let finished = self.play(script);
        assert_eq!(finished.exit_code, Some(0), "{finished:#?}");
        finished.json()
    }

    /// Digest of the scene file's frame by `render`.
    fn rendered(&self, more: &[&str]) -> Value {
        let mut command = self.command(&["render", "cornell.toml", "-o", "r.png", "--json"]);
        succeed(command.args(more)).json()["digest"].clone()
    }
}

/// A lamp dragged, made brighter, its colour changed, an albedo too, and saved.
const EDITS: &str = "0 resize 60 21\n0 rest\n0 key Tab\n1 key Left\n2 key shift+Left\n\
    3 key i\n4 key t\n5 key ]\n6 key I\n7 key ctrl+s\n8 key P\n";

#[test]
fn the_last_full_frame_is_what_render_writes_of_the_saved_scene() {
    let session = Session::new();
    let before = session.rendered(&["--size", "60x40"]);
    let report = session.played(EDITS);
    assert_eq!(report["unsaved"], false, "{report}");
    assert_eq!(report["size"], serde_json::json!([60, 40]));
    let saved = session.rendered(&["--size", "60x40"]);
    assert_eq!(report["digest"], saved);
    assert_ne!(before, saved, "the lamp has moved");
    // And the whole frame at the scene's own size.
    let written = &report["written"][0];
    assert_eq!(written["path"], "cornell-1.png");
    assert_eq!(written["digest"], session.rendered(&[]));
    let frame = relume::read_image(&session.at("cornell-1.png")).expect("it is a picture");
    drop(frame);
    let old = fs::read_to_string(scene("cornell")).expect("the scene can be read");
    let new = fs::read_to_string(session.at("cornell.toml")).expect("the scene can be read");
    let comments = |text: &str| -> Vec<String> {
        let lines = text.lines().filter_map(|line| line.split_once('#'));
        lines.map(|(_, comment)| comment.to_owned()).collect()
    };
    assert_eq!(comments(&old), comments(&new), "comments stay");
}

#[test]
fn surfaces_of_another_kind_are_saved_and_drawn_as_render_does() {
    let session = Session::new();
    let before = session.rendered(&["--size", "60x40"]);
    // White is satin and rougher.
    let report =
        session.played("0 resize 60 21\n0 rest\n0 key ]\n1 key }\n2 key >\n3 rest\n4 key ctrl+s\n");
    assert_eq!(report["unsaved"], false, "{report}");
    let saved = session.rendered(&["--size", "60x40"]);
    assert_eq!(report["digest"], saved);
    assert_ne!(before, saved);
    let text = fs::read_to_string(session.at("cornell.toml")).expect("the scene can be read");
    let end = "[[material]]\nname = \"white\"\nspecular = [0.04, 0.04, 0.04]\nroughness = 0.6\n";
    assert!(text.ends_with(end), "{text}");
}

#[test]
fn a_script_gives_the_same_pictures_every_time() {
    let session = Session::new();
    let script = "0 resize 60 21\n0 key Tab\n1 mouse press left 30 6\n2 mouse drag left 34 9\n\
        3 mouse drag left 20 12\n3 shot moving.png\n4 mouse release left 20 12\n5 rest\n\
        5 shot still.png\n5 shot still.txt\n6 key u\n7 rest\n7 shot undone.png\n";
    let read = |name: &str| fs::read(session.at(name)).expect("the picture was written");
    let first = session.played(script);
    let pictures = ["moving.png", "still.png", "still.txt", "undone.png"].map(read);
    let again = session.played(script);
    assert_eq!(first["digest"], again["digest"]);
    // The text has milliseconds in it.
    for (name, picture) in ["moving.png", "still.png", "", "undone.png"]
        .iter()
        .zip(&pictures)
    {
        assert!(name.is_empty() || read(name) == *picture, "{name}");
    }
    assert!(pictures[1] != pictures[3], "undone is not still");
    assert!(String::from_utf8_lossy(&pictures[2]).contains("sharp"));
}

#[test]
fn where_there_is_no_terminal_it_says_what_to_do() {
    let session = Session::new();
    let finished = run(&mut session.command(&["preview", "cornell.toml"]));
    assert_eq!(finished.exit_code, Some(2), "{finished:#?}");
    assert!(finished.stderr.contains("relume render"), "{finished:#?}");
    assert!(finished.stdout.is_empty(), "{finished:#?}");
    let finished = run(&mut session.command(&["preview", "absent.toml"]));
    assert_eq!(finished.exit_code, Some(3), "{finished:#?}");
    let finished = run(&mut session.command(&["preview", "cornell.toml", "--json"]));
    assert_eq!(finished.exit_code, Some(2), "{finished:#?}");
    assert!(finished.stderr.contains("--script"), "{finished:#?}");
}

#[test]
fn mistakes_in_scripts_are_told_with_their_line() {
    let session = Session::new();
    let mistake = |script: &str, code: i32, said: &str| {
        let finished = session.play(script);
        assert_eq!(finished.exit_code, Some(code), "{finished:#?}");
        assert!(finished.stderr.contains(said), "{finished:#?}");
    };
    mistake("0 key Tab\n1 jump\n", 2, "a.script:2");
    mistake("5 key Tab\n1 key Tab\n", 2, "a.script:2");
    mistake("0 key Hyper\n", 2, "a.script:1");
    let mut command = session.command(&["preview", "cornell.toml", "--script", "none.script"]);
    let finished = run(&mut command);
    assert_eq!(finished.exit_code, Some(3), "{finished:#?}");
    assert!(finished.stderr.contains("none.script"), "{finished:#?}");
}

#[test]
fn the_script_of_the_readme_plays() {
    let readme = include_str!("../../README.md");
    let start = readme.find("0 resize").expect("the README has a script");
    let script = readme[start..].split("```").next().expect("it ends");
    let session = Session::new();
    let report = session.played(script);
    assert_eq!(report["unsaved"], true, "the lamp has moved: {report}");
    assert!(session.at("moved.png").exists());
}

#[test]
fn what_fails_in_a_script_is_its_exit_code() {
    let session = Session::new();
    let mut permissions = fs::metadata(session.at("cornell.toml"))
        .expect("it is there")
        .permissions();
    permissions.set_readonly(true);
    fs::set_permissions(session.at("cornell.toml"), permissions).expect("it can be protected");
    let finished = session.play("0 key Tab\n1 key i\n2 key ctrl+s\n");
    assert_eq!(finished.exit_code, Some(3), "{finished:#?}");
    let report = finished.json();
    assert!(
        report["error"]
            .as_str()
            .is_some_and(|it| it.contains("cornell.toml")),
        "{report}"
    );
    assert_eq!(report["unsaved"], true);
}

#[test]
fn bounces_that_the_file_does_not_ask_for_are_baked_all_the_same() {
    let session = Session::new();
    let none = ["--set", "render.bounces=0"];
    let script = "0 resize 40 16\n0 rest\n0 key +\n0 key +\n1 rest\n";
    fs::write(session.at("a.script"), script).expect("the script is written");
    let mut command =
        session.command(&["preview", "cornell.toml", "--script", "a.script", "--json"]);
    let report = succeed(command.args(none)).json();
    let rendered = session.rendered(&["--bounces", "2", "--size", "40x30"]);
    assert_eq!(report["digest"], rendered, "{report}");
}
