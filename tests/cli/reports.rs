//! What the commands print: one JSON object or lines for a person on standard
//! output, warnings on standard error, and no progress where no terminal is.

use serde_json::Value;

use crate::program::{
    SMALL_BAKE, SMALL_FRAME, relume, render_box_command, scene, succeed, temporary_folder,
};

/// Keys that programs rely on.
const RENDER_KEYS: [&str; 10] = [
    "digest",
    "size",
    "vertices",
    "triangles",
    "partitions",
    "functions",
    "coefficients_per_vertex",
    "bake_bytes",
    "cache",
    "ms",
];

fn assert_keys(object: &Value, keys: &[&str]) {
    for key in keys {
        assert!(object.get(key).is_some(), "no {key:?} in {object}");
    }
}

#[test]
fn a_gather_is_named_and_timed() {
    let folder = temporary_folder();
    let arguments = ["--json", "--quality", "gather"];
    let mut command = render_box_command(folder.path(), "frame.png", &arguments);
    let object = succeed(&mut command).json();
    assert_eq!(object["quality"], "gather", "{object}");
    assert!(object["ms"]["gather"].as_f64() > Some(0.0), "{object}");
    let file = std::fs::read(folder.path().join("frame.png")).expect("the frame is there");
    let text = String::from_utf8_lossy(&file);
    assert!(text.contains("relume:quality\0gather"), "no such chunk");

    let mut command = render_box_command(folder.path(), "frame.png", &["--json"]);
    let object = succeed(&mut command).json();
    assert_eq!(object["quality"], "standard", "{object}");
    assert_eq!(object["ms"].get("gather"), None, "{object}");
}

#[test]
fn render_prints_one_object_with_the_contracts_keys() {
    let folder = temporary_folder();
    let finished = succeed(&mut render_box_command(
        folder.path(),
        "frame.png",
        &["--json"],
    ));
    assert_eq!(
        finished.stderr, "",
        "no terminal, no progress and no warning"
    );
    assert_eq!(
        finished.stdout.lines().count(),
        1,
        "one line: {finished:#?}"
    );
    let object = finished.json();
    assert_keys(&object, &RENDER_KEYS);
    assert_eq!(object["size"], serde_json::json!([40, 30]), "{object}");
    assert_eq!(object["cache"], "miss", "{object}");
    let digest = object["digest"].as_str().unwrap_or_default();
    let is_hex = digest.len() == 32 && digest.bytes().all(|b| b.is_ascii_hexdigit());
    assert!(is_hex, "a digest of 32 hexadecimal digits: {object}");
    for key in [
        "vertices",
        "triangles",
        "partitions",
        "functions",
        "bake_bytes",
    ] {
        assert!(object[key].as_u64() > Some(0), "{key} is a count: {object}");
    }
    let stages = object["ms"].as_object().expect("`ms` is an object");
    let time = |value: &Value| value.as_f64().expect("a time is a number");
    let sum: f64 = stages
        .iter()
        .filter(|(k, _)| *k != "total")
        .map(|(_, v)| time(v))
        .sum();
    let total = time(&stages["total"]);
    // Each stage is rounded to a microsecond.
    let rounding = 1e-3 * stages.len() as f64;
    assert!(
        (sum - total).abs() <= rounding,
        "the stages sum to {sum}, not to {total}"
    );
}

#[test]
fn the_bakes_size_is_the_files() {
    let folder = temporary_folder();
    let report = crate::program::render_box(folder.path(), &[]).json();
    let bake = crate::program::only_bake(&folder.path().join("cache"));
    let bytes = std::fs::metadata(bake).expect("the bake exists").len();
    assert_eq!(report["bake_bytes"].as_u64(), Some(bytes), "{report}");
}

#[test]
fn a_person_reads_lines_and_hears_no_progress() {
    let folder = temporary_folder();
    let finished = succeed(&mut render_box_command(folder.path(), "frame.png", &[]));
    assert_eq!(
        finished.stderr, "",
        "no terminal, no progress and no warning"
    );
    for word in ["frame.png: 40 x 30", "vertices", "digest"] {
        assert!(
            finished.stdout.contains(word),
            "nothing says {word:?}: {finished:#?}"
        );
    }
}

/// `relume measure` of the small box.
fn measure(arguments: &[&str]) -> std::process::Command {
    let mut command = relume(&["measure"]);
    command.arg(scene("cornell")).args(SMALL_BAKE);
    command.args(SMALL_FRAME).arg("--no-cache").args(arguments);
    command
}

#[test]
fn measured_frames_have_medians_by_stage() {
    let asked = ["--frames", "3", "--bounces", "2", "--threads", "2"];
    let finished = succeed(measure(&asked).args(["--simd", "scalar", "--json"]));
    assert_eq!(finished.stderr, "", "no terminal, no progress");
    let object = finished.json();
    assert_eq!(object["frames"], 3, "{object}");
    assert_eq!(object["size"], serde_json::json!([40, 30]), "{object}");
    assert_eq!(object["bounces"], 2, "{object}");
    assert_eq!(object["threads"], 2, "{object}");
    assert_eq!(object["simd"], "scalar", "{object}");
    assert_eq!(object["light"], "lamp", "{object}");
    assert!(object["vertices"].as_u64() > Some(500), "{object}");
    let stages = [
        "direct_at_vertices",
        "bounces",
        "light_at_pixels",
        "shade",
        "total",
    ];
    for figures in ["ms", "ms_5th_percentile", "ms_95th_percentile"] {
        assert_keys(&object[figures], &stages);
    }
    let number = |value: &Value| value.as_f64().expect("a number");
    let rate = number(&object["frames_per_second"]) * number(&object["ms"]["total"]);
    // Both are rounded to a thousandth.
    assert!((rate - 1e3).abs() < 10.0, "{rate} ms a second: {object}");
    let [low, high] =
        ["ms_5th_percentile", "ms_95th_percentile"].map(|p| number(&object[p]["total"]));
    let median = number(&object["ms"]["total"]);
    assert!(low <= median && median <= high, "{object}");
}

#[test]
fn a_person_reads_a_table_of_times() {
    let finished = succeed(&mut measure(&["--frames", "2", "--bounces", "all"]));
    for word in [
        "all bounces",
        "median",
        "5th %",
        "95th %",
        "shade",
        "total",
        "frames a second",
    ] {
        let said = finished.stdout.contains(word);
        assert!(said, "nothing says {word:?}: {finished:#?}");
    }
}

#[test]
fn the_other_commands_print_one_object_too() {
    let folder = temporary_folder();
    let path = folder.path().join("frame.exr");
    let path = path.to_str().expect("a temporary path is UTF-8");
    let scene = scene("cornell");
    let scene = scene.to_str().expect("the repository's path is UTF-8");
    let small = ["--set", "bake.max_edge=0.5", "--json"];
    let reference = [
        "reference",
        scene,
        "-o",
        path,
        "--spp",
        "2",
        "--size",
        "16x12",
    ];
    let traced = succeed(relume(&reference).args(small));
    assert_eq!(traced.stderr, "", "no terminal, no progress");
    assert_keys(&traced.json(), &["digest", "size", "spp", "noise", "ms"]);

    let cache = folder.path().join("cache");
    let mut bake = relume(&["bake", scene, "--set", "bake.rays=16"]);
    let baked = succeed(bake.args(small).arg("--cache-dir").arg(cache));
    assert_eq!(baked.stderr, "", "no terminal, no progress");
    assert_keys(&baked.json(), &["vertices", "bake_bytes", "cache", "ms"]);
    assert_eq!(baked.json()["cache"], "miss", "{baked:#?}");

    let compared = succeed(&mut relume(&["diff", path, path, "--json"]));
    let keys = [
        "passes",
        "max_channel_difference",
        "differing_pixels",
        "relative_rmse_8x8",
        "bias",
    ];
    assert_keys(&compared.json(), &keys);
}

#[test]
fn pixels_below_zero_are_reported() {
    let folder = temporary_folder();
    // A lamp just above the floor beside a wall excites functions that both
    // share, far above what the floor gets of it in one bounce.
    let ringing = [
        "--set",
        "render.bounces=1",
        "--set",
        "bake.functions=80",
        "--set",
        "light.lamp.position=[0.0,0.05,-0.9]",
    ];
    let render = |arguments: &[&str]| {
        let mut command = render_box_command(folder.path(), "frame.png", arguments);
        succeed(&mut command)
    };
    let json = render(&[&ringing[..], &["--json"]].concat()).json();
    let count = json["clamped_pixels"].as_u64().unwrap_or_default();
    assert!(count > 0, "no pixel was below zero: {json}");
    let sentence = "pixels had indirect light below zero";
    let told = render(&ringing).stdout;
    assert!(told.contains(&format!("{count} {sentence}")), "{told}");
    let quiet = render(&[]).stdout;
    assert!(!quiet.contains(sentence), "{quiet}");
    let json = render(&["--json"]).json();
    assert_eq!(json["clamped_pixels"].as_u64(), Some(0), "{json}");
}
