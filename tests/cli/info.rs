//! `relume info`: what it says of a scene before anything is baked, and how true
//! that is.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use crate::program::{
    Finished, SMALL_BAKE, files_in, relume, run, scene, succeed, temporary_folder,
};

/// How far forecast bytes may be from those of a bake of some hundred vertices,
/// whose parts are small and of unequal functions; larger ones are within 15 %.
const BYTES_WITHIN: f64 = 0.25;

/// Corners of a cube of side 2, and its faces seen from inside.
const CUBE: &str = "\
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 1 4 8 5\nf 2 6 7 3\n";
/// The face that closes it.
const LID: &str = "f 4 3 7 8\n";

/// Writes a scene of `mesh` with a point light and an environment.
fn write_scene(folder: &Path, mesh: &str) -> PathBuf {
    let path = folder.join("box.toml");
    fs::write(folder.join("box.obj"), mesh).expect("the mesh is written");
    let text = r#"mesh = "box.obj"
[camera]
position = [0.0, 0.0, 0.9]
target = [0.0, 0.0, 0.0]
vfov = 60.0
size = [64, 48]
[[light]]
kind = "point"
position = [0.0, 0.5, 0.0]
intensity = [1.0, 1.0, 1.0]
[[light]]
kind = "environment"
radiance = [0.2, 0.3, 0.5]
[render]
bounces = "all"
[bake]
max_edge = 0.25
rays = 64
"#;
    fs::write(&path, text).expect("the scene is written");
    path
}

fn info(scene: &Path, cache: &Path, arguments: &[&str]) -> Command {
    let mut command = relume(&["info"]);
    command.arg(scene).args(arguments);
    command.arg("--cache-dir").arg(cache);
    command
}

fn report(scene: &Path, cache: &Path, arguments: &[&str]) -> Value {
    succeed(info(scene, cache, arguments).arg("--json")).json()
}

fn number(report: &Value, key: &str) -> f64 {
    let value = report[key].as_f64();
    value.unwrap_or_else(|| panic!("{key} is no number: {report}"))
}

#[test]
fn a_closed_room_has_no_sky() {
    let folder = temporary_folder();
    let scene = write_scene(folder.path(), &[CUBE, LID].concat());
    let cache = folder.path().join("cache");
    let report = report(&scene, &cache, &[]);
    assert_eq!(report["sky"], "absent", "{report}");
    assert_eq!(report["escaped_share_of_fronts"], 0.0, "{report}");
    // All rays of the backs, which are half of the vertices.
    assert_eq!(report["escaped_share"], 0.5, "{report}");
    assert_eq!(report["bounces"], "all", "{report}");
    assert_eq!(report["size"], json!([64, 48]), "{report}");
    let said = succeed(&mut info(&scene, &cache, &[])).stdout;
    assert!(
        said.contains("the environment lights only its outside"),
        "{said}"
    );
}

#[test]
fn an_open_scene_has_a_sky() {
    let folder = temporary_folder();
    let scene = write_scene(folder.path(), CUBE);
    let cache = folder.path().join("cache");
    let report = report(&scene, &cache, &[]);
    assert_eq!(report["sky"], "present", "{report}");
    let of_fronts = number(&report, "escaped_share_of_fronts");
    // A floor sees a sixth to a fifth of its light through the missing lid.
    assert!((0.05..0.4).contains(&of_fronts), "{report}");
    let escaped = number(&report, "escaped_share");
    // Backs see nothing but the open.
    assert!((0.3..0.9).contains(&escaped), "{report}");
    assert!(number(&report, "sky_bytes") > 0.0, "{report}");
    let vertices = number(&report, "vertices");
    let sides = number(&report, "front_vertices") + number(&report, "back_vertices");
    assert_eq!(vertices, sides, "{report}");
    assert_eq!(report["sides_are_exact"], true, "{report}");
    assert_eq!(report["file_triangles"], 10, "{report}");
    let lights = &report["lights"];
    assert_eq!(lights["point"], 1, "{report}");
    assert_eq!(lights["environment"], 1, "{report}");
    assert_eq!(lights["area"], 0, "{report}");
    assert_eq!(report["shadow_rays_a_pixel"], 1, "{report}");
    assert_eq!(report["glossy_vertices"], 0, "{report}");
    assert!(
        !cache.exists(),
        "nothing is written: {:?}",
        files_in(&cache)
    );
}

/// Forecast of a scene, and what its bake was.
fn forecast_and_bake(scene: &Path, folder: &Path, arguments: &[&str]) -> [Value; 2] {
    let cache = folder.join("cache");
    let forecast = report(scene, &cache, arguments);
    assert_eq!(forecast["cache"], "miss", "{forecast}");
    assert!(
        !cache.exists(),
        "nothing is written: {:?}",
        files_in(&cache)
    );
    let mut bake = relume(&["bake", "--json"]);
    bake.arg(scene)
        .args(arguments)
        .arg("--cache-dir")
        .arg(&cache);
    [forecast, succeed(&mut bake).json()]
}

fn assert_forecast([forecast, bake]: &[Value; 2]) {
    for key in [
        "vertices",
        "back_vertices",
        "triangles",
        "max_edge",
        "partitions",
    ] {
        assert_eq!(forecast[key], bake[key], "{key}: {forecast} and {bake}");
    }
    for key in ["bake_bytes", "row_bytes"] {
        let ratio = number(forecast, key) / number(bake, key);
        let is_close = (ratio - 1.0).abs() < BYTES_WITHIN;
        assert!(
            is_close,
            "{key} is {ratio} of the bake's: {forecast} and {bake}"
        );
    }
    let escaped = number(forecast, "escaped_share") - number(&bake["bake"], "escaped_share");
    assert!(escaped.abs() < 0.01, "{forecast} and {bake}");
    assert!(number(forecast, "bake_seconds") > 0.0, "{forecast}");
    assert!(
        number(forecast, "peak_bytes") > number(bake, "bake_bytes"),
        "{forecast}"
    );
}

#[test]
fn a_forecast_comes_true() {
    let folder = temporary_folder();
    assert_forecast(&forecast_and_bake(
        &scene("cornell"),
        folder.path(),
        &SMALL_BAKE,
    ));
    let folder = temporary_folder();
    let closed = write_scene(folder.path(), &[CUBE, LID].concat());
    assert_forecast(&forecast_and_bake(&closed, folder.path(), &[]));
}

#[test]
fn a_stored_bake_is_told_as_it_is() {
    let folder = temporary_folder();
    let open = write_scene(folder.path(), CUBE);
    let [_, bake] = forecast_and_bake(&open, folder.path(), &[]);
    let cache = folder.path().join("cache");
    let files = files_in(&cache);
    let found = report(&open, &cache, &[]);
    assert_eq!(found["cache"], "hit", "{found}");
    assert_eq!(found["bake_seconds"], 0.0, "{found}");
    for key in [
        "vertices",
        "partitions",
        "functions",
        "coefficients_per_vertex",
        "bake_bytes",
        "row_bytes",
    ] {
        assert_eq!(found[key], bake[key], "{key}: {found} and {bake}");
    }
    assert_eq!(files_in(&cache), files, "nothing is written");
    let said = succeed(&mut info(&open, &cache, &[])).stdout;
    assert!(
        said.contains("cached") && said.contains("nothing to do"),
        "{said}"
    );
    let other = report(&open, &cache, &["--set", "bake.rays=32"]);
    assert_eq!(other["cache"], "miss", "{other}");
    assert_eq!(other["rays"], 32, "{other}");
}

#[test]
fn counts_are_the_same_each_time() {
    let folder = temporary_folder();
    let open = write_scene(folder.path(), CUBE);
    let without_times = |threads: &str| {
        let command = &mut relume(&["info", "--no-cache", "--json", "--threads", threads]);
        let mut report = succeed(command.arg(&open)).json();
        report["bake_seconds"] = Value::Null;
        report
    };
    assert_eq!(without_times("1"), without_times("3"));
}

#[test]
fn mistakes_are_those_of_the_other_commands() {
    let failed = |arguments: &[&str]| -> Finished { run(relume(&["info"]).args(arguments)) };
    let missing = failed(&["nowhere.toml"]);
    assert_eq!(missing.exit_code, Some(3), "{missing:#?}");
    let cornell = scene("cornell");
    let cornell = cornell.to_str().expect("the repository's path is UTF-8");
    let wrong = failed(&[cornell, "--set", "light.lamp.colour=[1,1,1]"]);
    assert_eq!(wrong.exit_code, Some(2), "{wrong:#?}");
    assert_eq!(wrong.stdout, "", "nothing is reported: {wrong:#?}");
}
