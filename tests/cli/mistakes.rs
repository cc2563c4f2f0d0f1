//! Mistakes that people make: the exit code, and words that say what is wrong,
//! where, and what to do.

use std::fs;
use std::path::Path;

use crate::program::{Finished, SMALL_BAKE, files_in, relume, run, scene, temporary_folder};

/// Exit code of wrong usage and of scenes that cannot be understood.
const USAGE: i32 = 2;
/// Exit code of files that cannot be read or written.
const FILE: i32 = 3;

/// Renders the box with more arguments and expects a refusal with these words,
/// quickly and without a trace in the folder.
fn refused(arguments: &[&str], exit_code: i32, words: &[&str]) {
    let folder = temporary_folder();
    let mut command = relume(&["render"]);
    command
        .arg(scene("cornell"))
        .arg("-o")
        .arg(folder.path().join("frame.png"));
    let finished = run(command.args(arguments).current_dir(folder.path()));
    let asked = arguments.join(" ");
    assert_eq!(
        finished.exit_code,
        Some(exit_code),
        "{asked}: {finished:#?}"
    );
    assert_eq!(finished.stdout, "", "{asked}: nothing on standard output");
    let says_error = finished.stderr.starts_with("error: ");
    assert!(says_error, "{asked} is said to be an error: {finished:#?}");
    for word in words {
        let said = finished.stderr.contains(word);
        assert!(said, "{asked}: nothing says {word:?}: {finished:#?}");
    }
    let left = files_in(folder.path());
    assert!(left.is_empty(), "{asked} leaves {left:?}");
}

#[test]
fn wrong_values_on_the_command_line() {
    refused(
        &["--component", "globl"],
        USAGE,
        &["globl", "global", "irradiance"],
    );
    let numbers = ["basis:0", "basis:3.0"];
    refused(&["--component", "basis:low"], USAGE, &numbers);
    refused(&["--component", "basis"], USAGE, &numbers);
    let qualities = ["gathr", "standard and gather"];
    refused(&["--quality", "gathr"], USAGE, &qualities);
    refused(&["--size", "320"], USAGE, &["320", "WxH", "320x240"]);
    refused(&["--size", "0x30"], USAGE, &["0x30", "1 to 16384"]);
    refused(&["--size", "20000x30"], USAGE, &["16384"]);
    refused(&["--bounces", "-1"], USAGE, &["-1", "from 0", "all"]);
    refused(&["--bounces", "4000000000"], USAGE, &["from 0 to 10000"]);
    refused(&["--simd", "avx9"], USAGE, &["avx9", "scalar", "auto"]);
    refused(&["--threads", "0"], USAGE, &["--threads", "1..=1024"]);
    refused(&["--wiht"], USAGE, &["--wiht"]);
    for error in ["nan", "x", "2%", "-1", "0", "1", "2"] {
        let quoted = format!("'{error}'");
        let words = [&*quoted, "above 0 and below 1", "such as 0.02"];
        refused(&["--error", error], USAGE, &words);
    }
    refused(
        &["--no-cache", "--cache-dir", "x"],
        USAGE,
        &["--no-cache", "--cache-dir"],
    );
}

#[test]
fn functions_that_the_basis_does_not_have() {
    let small = |component: &'static str| {
        let mut arguments = SMALL_BAKE.to_vec();
        arguments.extend(["--no-cache", "--component", component]);
        arguments
    };
    refused(
        &small("basis:100000"),
        USAGE,
        &["basis:100000", "functions in", "partitions", "from 0 to"],
    );
    refused(
        &small("basis:100000.0"),
        USAGE,
        &["basis:100000.0", "partitions, numbered from 0 to"],
    );
    refused(
        &small("basis:0.100000"),
        USAGE,
        &["partition 0 of", "numbers from 0 to", "functions in all"],
    );
}

#[test]
fn wrong_keys_and_values_of_set() {
    refused(
        &["--set", "light.lmp.intensity=[1,1,1]"],
        USAGE,
        &["--set light.lmp.intensity", "lmp", "nearest is `lamp`"],
    );
    refused(
        &["--set", "bake.ray=64"],
        USAGE,
        &["--set bake.ray", "nearest is `rays`"],
    );
    refused(
        &["--set", "material.white.albedo=[1.5,0,0]"],
        USAGE,
        &["albedo", "1.5"],
    );
    refused(
        &["--set", "render.bounces"],
        USAGE,
        &["render.bounces", "="],
    );
}

#[test]
fn outputs_are_checked_before_anything_is_computed() {
    refused(&["-o", "frame.gif"], USAGE, &["frame.gif", ".png or .exr"]);
    let missing = Path::new("no such folder").join("frame.png");
    let missing = missing.to_str().expect("the name is UTF-8");
    refused(
        &["-o", missing],
        FILE,
        &[missing, "check that the folder exists"],
    );
}

#[test]
fn a_command_that_lacks_something_says_what() {
    let path = scene("cornell");
    let path = path.to_str().expect("the repository's path is UTF-8");
    for (arguments, word) in [
        (vec!["render", path], "--output"),
        (vec!["render", "-o", "frame.png"], "<SCENE>"),
        (vec!["rendr", path], "render"),
        (vec!["diff", "a.png"], "<CANDIDATE>"),
        (vec![], "Usage"),
    ] {
        let finished = run(&mut relume(&arguments));
        assert_eq!(
            finished.exit_code,
            Some(USAGE),
            "{arguments:?}: {finished:#?}"
        );
        let said = finished.stderr.contains(word);
        assert!(said, "{arguments:?}: nothing says {word:?}: {finished:#?}");
    }
}

#[test]
fn measuring_needs_frames_and_a_light_that_can_move() {
    let path = scene("cornell");
    let path = path.to_str().expect("the repository's path is UTF-8");
    let without = run(&mut relume(&["measure", path]));
    assert_ends(&without, USAGE, &["error: ", "-o DIR", "--frames N"]);
    let none = run(&mut relume(&["measure", path, "--frames", "0"]));
    assert_ends(&none, USAGE, &["--frames", "1..=100000"]);
    let day = scene("window").with_file_name("day.toml");
    let far = run(relume(&["measure", "--frames", "2", "--no-cache"]).arg(day));
    let words = ["error: ", "no local light", "[[light]]", "point"];
    assert_ends(&far, USAGE, &words);
    assert_eq!(far.stderr.matches("no local light").count(), 1, "{far:#?}");
}

/// Expects a refusal of a scene file with this text.
fn scene_refused(text: &str, exit_code: i32, words: &[&str]) {
    let folder = temporary_folder();
    let path = folder.path().join("made.toml");
    fs::write(&path, text).expect("the scene can be written");
    let mut command = relume(&["render"]);
    command.arg(&path).arg("--no-cache").arg("-o");
    let finished = run(command.arg(folder.path().join("frame.png")));
    assert_eq!(finished.exit_code, Some(exit_code), "{text}: {finished:#?}");
    for word in words {
        let said = finished.stderr.contains(word);
        assert!(said, "{text}: nothing says {word:?}: {finished:#?}");
    }
}

const CAMERA: &str =
    "[camera]\nposition = [0, 1, 6]\ntarget = [0, 1, 0]\nvfov = 20\nsize = [16, 12]\n";

#[test]
fn faults_of_a_scene_file_name_file_and_line() {
    let mesh = "mesh = \"missing.obj\"\n";
    scene_refused(
        &format!("{mesh}colour = 1\n{CAMERA}"),
        USAGE,
        &["made.toml:2:1", "unknown key `colour`"],
    );
    scene_refused(
        &format!("{mesh}normls = \"flat\"\n{CAMERA}"),
        USAGE,
        &["made.toml:2:1", "nearest is `normals`"],
    );
    scene_refused(
        &format!("{mesh}{CAMERA}[[light]]\nkind = \"pont\"\n"),
        USAGE,
        &["made.toml:8", "pont", "`point`"],
    );
    scene_refused(mesh, USAGE, &["made.toml", "[camera]"]);
    scene_refused("mesh = ", USAGE, &["made.toml:1"]);
    let unreadable = format!("{mesh}{CAMERA}");
    scene_refused(&unreadable, FILE, &["made.toml:1", "missing.obj"]);
}

/// A triangle with texture coordinates, of a material of `made.mtl`.
const TRIANGLE: &str = "mtllib made.mtl\nusemtl wood\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\
                        vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

/// Renders [`TRIANGLE`] with this MTL and these lines of the scene file.
fn render_triangle(mtl: &str, scene: &str) -> Finished {
    let folder = temporary_folder();
    let write = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).expect("the file can be written");
    };
    write("made.obj", TRIANGLE);
    write("made.mtl", mtl);
    write(
        "made.toml",
        &format!("mesh = \"made.obj\"\n{CAMERA}[bake]\nrays = 16\nmax_edge = 0.2\n{scene}"),
    );
    let mut command = relume(&["render", "--no-cache", "--bounces", "0"]);
    command.arg(folder.path().join("made.toml"));
    run(command.arg("-o").arg(folder.path().join("frame.png")))
}

/// Asserts an exit code, and that standard error holds every word.
#[track_caller]
fn assert_ends(finished: &Finished, exit_code: i32, words: &[&str]) {
    assert_eq!(finished.exit_code, Some(exit_code), "{finished:#?}");
    for word in words {
        let said = finished.stderr.contains(word);
        assert!(said, "nothing says {word:?}: {finished:#?}");
    }
}

#[test]
fn a_mesh_is_no_scene() {
    let mesh = scene("cornell").with_extension("obj");
    let mut command = relume(&["render", "-o", "frame.png"]);
    let finished = run(command.arg(mesh));
    assert_ends(&finished, USAGE, &["cornell.obj:", "give the TOML file"]);
}

#[test]
fn images_that_are_missing_or_are_none() {
    let lost = render_triangle("newmtl wood\nmap_Kd lost.png\n", "");
    let words = ["warning: ", "made.mtl:2: ", "lost.png", "Kd alone"];
    assert_ends(&lost, 0, &words);
    let no_image = render_triangle("newmtl wood\nmap_Kd made.obj\n", "");
    assert_ends(&no_image, FILE, &["error: ", "made.mtl:2: ", "made.obj"]);
    let unused = render_triangle("newmtl wood\nnewmtl oak\nmap_Kd made.obj\n", "");
    assert_ends(&unused, 0, &[]);
    assert!(unused.stderr.contains("the frame is black"), "{unused:#?}");
    assert!(!unused.stderr.contains("made."), "{unused:#?}");
    let sky = |name: &str| {
        let light = format!("[[light]]\nkind = \"environment\"\nmap = \"{name}\"\n");
        render_triangle("newmtl wood\n", &light)
    };
    assert_ends(&sky("lost.hdr"), FILE, &["made.toml:12:7", "lost.hdr"]);
    assert_ends(&sky("made.obj"), USAGE, &["made.toml:12:7", ".exr or .hdr"]);
}

#[test]
fn a_missing_scene_is_a_file_error() {
    let finished = run(&mut relume(&["render", "nothing.toml", "-o", "frame.png"]));
    assert_eq!(finished.exit_code, Some(FILE), "{finished:#?}");
    let said = finished.stderr.contains("nothing.toml");
    assert!(said, "the missing file is named: {finished:#?}");
}

#[test]
fn an_error_is_one_line_said_once() {
    let finished = run(&mut relume(&["render", "nothing.toml", "-o", "frame.png"]));
    assert_eq!(finished.stderr.lines().count(), 1, "{finished:#?}");
    let says = finished.stderr.matches("os error").count();
    assert_eq!(says, 1, "the system's words stand once: {finished:#?}");
}

#[test]
fn help_and_version_are_no_errors() {
    for arguments in [["--help"], ["--version"], ["help"]] {
        let finished = run(&mut relume(&arguments));
        assert_eq!(finished.exit_code, Some(0), "{arguments:?}: {finished:#?}");
        assert!(
            finished.stdout.contains("relume"),
            "{arguments:?}: {finished:#?}"
        );
    }
}
