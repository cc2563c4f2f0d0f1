//! `relume golden check` and `bless`: every outcome, and what reports say of it.

mod suite;

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{relume, run, succeed};
use suite::{MESH, Suite, failed_cases, scene_text};

#[test]
fn one_changed_light_is_one_failure() {
    let suite = Suite::of(&["a", "b", "c"]);
    let (_, report) = suite.check(0);
    assert_eq!(report["passed"], 3, "{report}");
    assert!(failed_cases(&suite.report_file("junit.xml")).is_empty());
    assert!(suite.report_file("report.html").contains("scenes/b.toml"));

    suite.write("scenes/b.toml", &scene_text("1.3"));
    let (finished, report) = suite.check(1);
    assert_eq!(report["failed"], 1, "{report}");
    let result = &report["results"][1];
    assert_eq!(result["scene"], "scenes/b.toml");
    assert_eq!(result["golden"], "golden/scenes/b.png");
    assert_eq!(
        result["comparison"]["failed_limits"][0],
        "max_channel_difference"
    );
    let metadata = &result["comparison"]["metadata_differences"];
    assert!(
        metadata.to_string().contains("relume:scene.lights"),
        "{metadata}"
    );
    let pictures = result["pictures"].as_array().unwrap();
    for word in ["expected", "actual", "strip", "heat-map"] {
        let path = format!("pictures/1-scenes-b-{word}.png");
        assert!(pictures.contains(&Value::from(path.as_str())), "{result}");
        relume::read_image(&suite.at("golden-report").join(path)).unwrap();
    }
    let failed = [("scenes/b.toml".to_owned(), "differs".to_owned())];
    assert_eq!(failed_cases(&suite.report_file("junit.xml")), failed);
    let page = suite.report_file("report.html");
    assert!(page.contains("data:image/png;base64,") && page.contains("failure-1-scenes-b"));
    assert!(finished.stderr.is_empty(), "{finished:#?}");

    let text = run(&mut suite.command("check", &["scenes"]));
    assert_eq!(text.exit_code, Some(1), "{text:#?}");
    assert!(text.stdout.contains("differs  scenes/b.toml"), "{text:#?}");
    assert!(
        text.stdout.contains("relume golden bless scenes/b.toml"),
        "{text:#?}"
    );

    // What was looked at and is right again leaves no picture behind.
    suite.write("scenes/b.toml", &scene_text("1.0"));
    suite.check(0);
    assert_eq!(
        fs::read_dir(suite.at("golden-report/pictures"))
            .unwrap()
            .count(),
        0
    );
}

#[test]
fn bless_touches_what_failed_and_nothing_else() {
    let suite = Suite::of(&["a", "b"]);
    let golden = |name: &str| suite.at(&format!("golden/scenes/{name}.png"));
    let bytes = |name: &str| fs::read(golden(name)).unwrap();
    let (a, b) = (bytes("a"), bytes("b"));
    let modified = |name: &str| fs::metadata(golden(name)).unwrap().modified().unwrap();
    let a_before = modified("a");
    suite.write("scenes/b.toml", &scene_text("1.3"));
    suite.write("scenes/c.toml", &scene_text("1.3"));
    let report = succeed(&mut suite.command("bless", &["--json"])).json();
    assert_eq!(report["unchanged"], 1, "{report}");
    assert_eq!(report["blessed"][0]["golden"], "golden/scenes/b.png");
    assert_eq!(report["blessed"][0]["was"], "differs");
    assert_eq!(report["blessed"][1]["was"], "missing");
    assert_eq!(
        modified("a"),
        a_before,
        "a golden that passes is not written"
    );
    assert_eq!(bytes("a"), a);
    assert_ne!(bytes("b"), b);
    assert_eq!(
        bytes("b"),
        bytes("c"),
        "the same scene gives the same bytes"
    );
    suite.check(0);
}

#[test]
fn a_ci_does_not_bless_unless_it_is_told() {
    let suite = Suite::of(&[]);
    suite.write("scenes/a.toml", &scene_text("1.0"));
    let refused = run(suite.command("bless", &[]).env("CI", "true"));
    assert_eq!(refused.exit_code, Some(2), "{refused:#?}");
    assert!(refused.stderr.contains("--in-ci"), "{refused:#?}");
    assert!(!suite.at("golden/scenes/a.png").exists());
    let told = succeed(suite.command("bless", &["--in-ci"]).env("CI", "true"));
    assert!(
        told.stdout.contains("golden/scenes/a.png (was: missing)"),
        "{told:#?}"
    );
}

#[test]
fn whatever_is_wrong_with_one_scene_the_others_are_checked() {
    let suite = Suite::of(&["black", "good", "large", "unreadable"]);
    suite.write(
        "scenes/black.toml",
        &scene_text("0.0").replace("1.0, 1.0]", "0.0, 0.0]"),
    );
    suite.write("scenes/missing.toml", &scene_text("1.0"));
    suite.write("scenes/broken.toml", &scene_text("bright"));
    suite.write("golden/scenes/unreadable.png", "no image");
    fs::copy(
        suite.at("golden/scenes/good.png"),
        suite.at("golden/scenes/gone.png"),
    )
    .unwrap();
    let large = scene_text("1.0").replace("[16, 12]", "[20, 12]");
    suite.write("scenes/large.toml", &large);
    let (finished, report) = suite.check(3);
    let verdicts = Suite::verdicts(&report);
    let expected = [
        ("black", "black"),
        ("broken", "scene-unusable"),
        ("good", "passes"),
        ("large", "differs"),
        ("missing", "missing"),
        ("unreadable", "golden-unusable"),
    ];
    let expected = expected.map(|(name, it)| (format!("scenes/{name}.toml"), it.to_owned()));
    assert_eq!(verdicts, expected);
    assert_eq!(report["goldens_without_scene"][0], "golden/scenes/gone.png");
    assert!(
        finished
            .stderr
            .contains("golden/scenes/gone.png: a golden without"),
        "{finished:#?}"
    );
    let broken = report["results"][1]["problems"][0].as_str().unwrap();
    assert!(broken.contains("scenes/broken.toml:"), "{broken}");
    assert_eq!(
        report["results"][3]["comparison"]["failed_limits"][0],
        "size"
    );
    let junit = suite.report_file("junit.xml");
    assert_eq!(failed_cases(&junit).len(), 5);
    assert!(junit.contains("golden/scenes/gone.png"), "{junit}");

    // A frame that is black and a scene that is broken are never blessed.
    let blessed = run(&mut suite.command("bless", &["--json"]));
    assert_eq!(blessed.exit_code, Some(2), "{blessed:#?}");
    let blessed = blessed.json();
    assert_eq!(blessed["blessed"].as_array().unwrap().len(), 3, "{blessed}");
    assert_eq!(blessed["refused"].as_array().unwrap().len(), 2, "{blessed}");
    let (_, report) = suite.check(2);
    assert_eq!(report["failed"], 2, "{report}");
}

#[test]
fn a_black_frame_fails_even_if_its_golden_is_black() {
    let suite = Suite::of(&["a"]);
    let black = scene_text("0.0").replace("1.0, 1.0]", "0.0, 0.0]");
    suite.write("scenes/a.toml", &black);
    let golden = suite.at("golden/scenes/a.png");
    let mut render = relume(&["render", "--no-cache", "-o"]);
    succeed(render.arg(&golden).arg(suite.at("scenes/a.toml")));
    let (_, report) = suite.check(1);
    assert_eq!(report["results"][0]["verdict"], "black", "{report}");
    // Only the floor is in the picture, and it glows.
    suite.write(
        "scenes/a.toml",
        &black.replace("vfov = 40.0", "vfov = 10.0"),
    );
    suite.write(
        "scenes/floor.mtl",
        "newmtl glow\nKd 0 0 0\nKe 0.5 0.5 0.5\n",
    );
    let mesh = MESH.replace("o floor", "mtllib floor.mtl\nusemtl glow");
    suite.write("scenes/floor.obj", &mesh);
    let (_, report) = suite.check(1);
    assert_eq!(report["results"][0]["verdict"], "constant", "{report}");
}

#[test]
fn limits_mask_and_keys_of_the_scene_file_count() {
    let suite = Suite::of(&["a"]);
    let with = |keys: &str| {
        suite.write(
            "scenes/a.toml",
            &format!("{}[golden]\n{keys}\n", scene_text("1.3")),
        )
    };
    with("max_channel_difference = 255");
    let (_, report) = suite.check(0);
    assert_eq!(report["results"][0]["verdict"], "passes");
    assert_ne!(report["results"][0]["comparison"]["differing_pixels"], 0);
    with("set = [\"light.lamp.intensity=[1, 1, 1]\"]");
    suite.check(0);
    with("mask = \"absent.png\"");
    let (_, report) = suite.check(3);
    assert_eq!(
        report["results"][0]["verdict"], "golden-unusable",
        "{report}"
    );
    let blessed = run(&mut suite.command("bless", &[]));
    assert_eq!(
        blessed.exit_code,
        Some(3),
        "a golden in the place would not help: {blessed:#?}"
    );
    with("set = [\"light.lamp.intensity\"]");
    let (_, report) = suite.check(2);
    let problem = report["results"][0]["problems"][0].as_str().unwrap();
    assert!(
        problem.contains("scenes/a.toml:") && problem.contains("PATH=VALUE"),
        "{problem}"
    );
}

#[test]
fn the_command_line_changes_all_scenes() {
    let suite = Suite::of(&[]);
    suite.write("scenes/a.toml", &scene_text("1.0"));
    let smaller = ["--size", "8x6", "--set", "render.exposure=1"];
    succeed(&mut suite.command("bless", &smaller));
    let golden = relume::read_compared(&suite.at("golden/scenes/a.png")).unwrap();
    assert_eq!(golden.size(), [8, 6]);
    succeed(&mut suite.command("check", &smaller));
    let other = run(&mut suite.command("check", &["--size", "8x6"]));
    assert_eq!(other.exit_code, Some(1), "{other:#?}");
    assert!(
        other.stdout.contains("bless scenes/a.toml --size 8x6"),
        "{other:#?}"
    );
}

#[test]
fn linear_goldens_and_goldens_beside_their_scenes_count() {
    let suite = Suite::of(&[]);
    suite.write("scenes/a.toml", &scene_text("1.0"));
    fs::remove_dir(suite.at("golden")).unwrap();
    succeed(&mut suite.command("bless", &["--format", "exr"]));
    assert!(suite.at("scenes/a.golden.exr").exists());
    suite.check(0);
    suite.write("scenes/a.toml", &scene_text("1.3"));
    let (_, report) = suite.check(1);
    let pictures = report["results"][0]["pictures"].to_string();
    assert!(pictures.contains("1-scenes-a-actual.exr"), "{pictures}");
    succeed(&mut suite.command("bless", &[]));
    suite.check(0);
    fs::copy(
        suite.at("golden-report/report.html"),
        suite.at("scenes/a.golden.png"),
    )
    .unwrap();
    let (_, report) = suite.check(2);
    assert!(report.to_string().contains("several goldens"), "{report}");
}

#[cfg(unix)]
#[test]
fn hostile_names_break_no_report() {
    let name = "a <b> & \"c\" 'd' | `e`,%:f";
    let suite = Suite::of(&[name]);
    suite.write(&format!("scenes/{name}.toml"), &scene_text("1.3"));
    let job = suite.at("job.md");
    let mut command = suite.command("check", &["--json"]);
    command
        .env("GITHUB_ACTIONS", "true")
        .env("GITHUB_STEP_SUMMARY", &job);
    let finished = run(&mut command);
    assert_eq!(finished.exit_code, Some(1), "{finished:#?}");
    assert_eq!(finished.json()["failed"], 1);
    let annotation =
        "::error file=scenes/a <b> & \"c\" 'd' | `e`%2C%25%3Af.toml,title=golden image::";
    assert!(finished.stderr.contains(annotation), "{finished:#?}");
    let failed = failed_cases(&suite.report_file("junit.xml"));
    assert_eq!(
        failed,
        [(format!("scenes/{name}.toml"), "differs".to_owned())]
    );
    let page = suite.report_file("report.html");
    assert!(!page.contains("<b>") && page.contains("a &lt;b&gt; &amp; &quot;c&quot;"));
    let job = fs::read_to_string(job).unwrap();
    assert!(
        job.contains("0 of 1 pass") && job.contains("&#60;b&#62;"),
        "{job}"
    );
    assert!(!job.contains("| `e`"), "{job}");

    // A line that looks like a command of a workflow would be obeyed.
    let command = "::error::boo";
    let scene = scene_text("1.0");
    for (path, text) in [
        (format!("scenes/n\n{command}.toml"), scene.clone()),
        (format!("{command}.toml"), "mesh = 3".to_owned()),
        ("scenes/##[error]boo.toml".to_owned(), scene.clone()),
        (
            "scenes/key.toml".to_owned(),
            format!("\"a\\n{command}\" = 1\n{scene}"),
        ),
    ] {
        suite.write(&path, &text);
    }
    let stray = suite.at(&format!("golden/scenes/s\n{command}.png"));
    fs::copy(suite.at(&format!("golden/scenes/{name}.png")), stray).unwrap();
    assert_says_no_command(
        &mut suite.command("check", &[]),
        2,
        r"key `a\n::error::boo`",
    );
    assert_says_no_command(&mut suite.command("check", &[]), 2, r"bless $'scenes/\043");
    assert_says_no_command(
        &mut suite.command("bless", &[]),
        2,
        r"scenes/n\n::error::boo.png",
    );
    let absent = format!("l\n{command}");
    assert_says_no_command(
        &mut suite.command("check", &[&absent]),
        3,
        r"l\n::error::boo",
    );
    fs::create_dir(suite.at(&absent)).unwrap();
    assert_says_no_command(
        &mut suite.command("bless", &[&absent]),
        2,
        r"l\n::error::boo",
    );
}

/// Runs a command of which no line may be one of a workflow, but for the
/// annotations that `check` makes itself.
#[cfg(unix)]
fn assert_says_no_command(command: &mut std::process::Command, exit_code: i32, says: &str) {
    let finished = run(command.env("GITHUB_ACTIONS", "true"));
    assert_eq!(finished.exit_code, Some(exit_code), "{finished:#?}");
    let text = format!("{}\n{}", finished.stdout, finished.stderr);
    assert!(text.contains(says), "{says}: {finished:#?}");
    for line in text.split(['\n', '\r']).map(str::trim_start) {
        let is_annotation =
            line.starts_with("::error file=") || line.starts_with("::warning file=");
        let is_command = line.starts_with("::") || line.contains("##[");
        assert!(is_annotation || !is_command, "{line:?}: {finished:#?}");
    }
}

#[test]
fn mistakes_are_refused_before_any_work() {
    let suite = Suite::of(&["a"]);
    let refuse = |command: &str, arguments: &[&str], code: i32, text: &str| {
        let finished = run(&mut suite.command(command, arguments));
        assert_eq!(
            finished.exit_code,
            Some(code),
            "{arguments:?}: {finished:#?}"
        );
        assert!(
            finished.stderr.contains(text),
            "{arguments:?}: {finished:#?}"
        );
    };
    refuse("check", &["absent"], 3, "absent");
    refuse("check", &["golden"], 2, "no scene");
    refuse("check", &["-o", "golden/report"], 2, "among goldens");
    refuse("check", &["--set", "bake.rays"], 2, "PATH=VALUE");
    refuse("bless", &["--size", "8"], 2, "WxH");
    assert_eq!(folder_names(&suite.at("golden")), ["scenes"]);
}

fn folder_names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder can be listed");
    let names = entries.map(|it| {
        it.expect("its entry can be read")
            .file_name()
            .to_string_lossy()
            .into_owned()
    });
    names.collect()
}
