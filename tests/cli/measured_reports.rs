//! `relume measure -o DIR`: a whole report of a small box, and mistakes.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{Finished, SMALL_BAKE, relume, run, scene, succeed, temporary_folder};

/// Errors of a sane bake of 560 vertices by 64 rays: measured 0.18 for both
/// schemes; noise alone is 0.17.
const MOST_ERROR: f64 = 0.4;
/// relRMSE of its frame without the reference's noise: measured 0.05 and 0.11.
const MOST_IMAGE_ERROR: f64 = 0.3;

fn measure(folder: &Path, arguments: &[&str]) -> std::process::Command {
    let mut command = relume(&["measure"]);
    command.arg(scene("cornell")).args(SMALL_BAKE);
    command.args(["--size", "40x30", "--spp", "8", "-o"]);
    command.arg(folder).args(arguments);
    command
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
fn a_report_has_both_schemes_and_sane_figures() {
    let folder = temporary_folder();
    let report = folder.path().join("new/report");
    let finished = succeed(&mut measure(&report, &["--json", "--frames", "2"]));
    let object = finished.json();
    for scheme in ["relume", "paper"] {
        let figures = &object["schemes"][scheme];
        for bounces in ["one_bounce", "four_bounces"] {
            let errors = ["mean", "p95", "worst"].map(|key| number(&figures[bounces][key]));
            let [mean, p95, worst] = errors;
            let is_sane = 0.0 < mean && mean < MOST_ERROR && mean < p95 && p95 <= worst;
            assert!(is_sane, "{scheme}, {bounces}: {errors:?}");
            assert!(
                number(&figures[bounces]["signed"]).abs() < mean,
                "{figures}"
            );
        }
        let lights = &figures["one_bounce"]["lights"];
        assert!((32.0..=64.0).contains(&number(lights)), "{figures}");
        assert!(number(&figures["bytes_per_vertex"]) > 10.0, "{figures}");
        assert!(number(&figures["relight_ms"]) > 0.0, "{figures}");
        let of_paper = scheme == "paper" && cfg!(feature = "metis");
        let partitioner = if of_paper { "metis" } else { "relume" };
        assert_eq!(figures["partitioner"], partitioner);
    }
    assert_eq!(object["receivers"], object["vertices"], "all of so few");
    assert!(number(&object["noise_of_truth"][0]) > 0.0, "{object}");
    assert!(
        number(&object["frames"]["frames_per_second"]) > 0.0,
        "both were asked for"
    );
    for component in ["global", "indirect", "global_gather", "indirect_gather"] {
        let image = &object["images"][component];
        let error = number(&image["pixels"]["relative_rmse"]);
        assert!(
            (0.0..MOST_IMAGE_ERROR).contains(&error),
            "{component}: {image}"
        );
        let flip = ["mean", "p95", "halves"].map(|key| number(&image["flip"][key]));
        let is_sane = flip.iter().all(|error| (1e-3..0.6).contains(error));
        assert!(is_sane, "{component}: {flip:?}");
        assert!(number(&image["frame_ms"]) > 0.0, "{image}");
        for means in ["pixels", "blocks"] {
            let noise = number(&image[means]["noise"]);
            assert!((1e-3..1.0).contains(&noise), "{component}: {image}");
        }
    }
    assert_eq!(object["frames"]["scheme"], "relume");
    report_is_whole(&report);
    errors_have_parts(&report, &object);
}

fn report_is_whole(report: &Path) {
    let text = fs::read_to_string(report.join("report.json")).expect("the report's figures");
    serde_json::from_str::<Value>(&text).expect("the report's figures are JSON");
    for file in [
        "report.html",
        "plots/error-against-functions.svg",
        "plots/error-against-bytes.svg",
        "plots/error-against-milliseconds.svg",
        "plots/error-against-bake-seconds.svg",
        "plots/error-against-rays.svg",
        "pictures/global-against-reference-flip.png",
        "pictures/partitions.png",
        "pictures/function-0.png",
        "pictures/approximated-direct.png",
        "tables/vertices-against-paths.csv",
        "tables/extreme-lights.csv",
        "tables/vertex-errors-by-contact.csv",
        "tables/equal-bytes.csv",
        "tables/time-at-equal-error.csv",
    ] {
        let bytes = fs::read(report.join(file)).unwrap_or_default();
        assert!(bytes.len() > 60, "{file}: {} bytes", bytes.len());
        if file.ends_with(".csv") {
            let table = String::from_utf8(bytes).expect("a table is text");
            has_rows_of_numbers(file, &table);
        }
    }
    for sweep in ["functions", "coefficients", "rays"] {
        let path = report.join(format!("tables/sweep-{sweep}.csv"));
        let table = fs::read_to_string(path).expect("the table of a sweep");
        for scheme in ["relume", "paper"] {
            let of_scheme = table.lines().filter(|line| line.starts_with(scheme));
            assert!(of_scheme.count() >= 4, "{sweep}: {table}");
        }
        let defaults = table.lines().filter(|line| line.ends_with("default"));
        assert_eq!(defaults.count(), 2, "{sweep}: one a scheme: {table}");
    }
}

/// Numbers below the head, in two rows at least (a light that brings nothing has none),
/// and no infinite one.
fn has_rows_of_numbers(file: &str, table: &str) {
    let (_, rows) = table.split_once('\n').expect("a head");
    let numbers_of = |row: &str| -> Vec<f64> {
        let cells = row.split(',').map(str::parse::<f64>);
        cells.filter_map(Result::ok).collect()
    };
    let rows: Vec<Vec<f64>> = rows.lines().map(numbers_of).collect();
    let with_numbers = rows.iter().filter(|row| !row.is_empty()).count();
    assert!(with_numbers >= 2, "{file}: {table}");
    let is_finite = rows.iter().flatten().all(|number| number.is_finite());
    assert!(is_finite, "{file}: {table}");
}

/// The three sources of the error: noise of 64 rays is as large as all of it, and a
/// full basis has no part in it.
fn errors_have_parts(report: &Path, object: &Value) {
    let table = fs::read_to_string(report.join("tables/error-parts.csv")).expect("the parts");
    for scheme in ["relume", "paper"] {
        let mean = |part: &str| {
            let line = table.lines().find_map(|line| {
                let cells = line.strip_prefix(scheme)?.strip_prefix(',')?;
                cells.strip_prefix(part)?.strip_prefix(',')
            });
            let cell = line.and_then(|line| line.split(',').next());
            let mean = cell.and_then(|cell| cell.parse::<f64>().ok());
            mean.unwrap_or_else(|| panic!("{scheme}, {part}: {table}")) / 100.0
        };
        let total = number(&object["schemes"][scheme]["one_bounce"]["mean"]);
        assert!((mean("total") - total).abs() < 1e-4, "{scheme}: {table}");
        let noise = mean("noise of the sampled rows");
        assert!((0.1..0.3).contains(&noise), "{scheme}: {table}");
        let compression = mean("compression");
        assert!((1e-3..MOST_ERROR).contains(&compression), "{table}");
        // The published scheme has more functions than there are vertices.
        let basis = if scheme == "paper" {
            0.0..1e-5
        } else {
            1e-3..MOST_ERROR
        };
        assert!(basis.contains(&mean("basis")), "{scheme}: {table}");
    }
}

#[test]
fn frames_of_the_published_scheme_are_timed_and_a_report_has_both_anyway() {
    let timed = &["measure", "--frames", "1", "--json", "--scheme", "paper"];
    let mut command = relume(timed);
    command.arg(scene("cornell")).args(SMALL_BAKE);
    let object = succeed(command.args(["--size", "20x15"])).json();
    assert_eq!(object["scheme"], "paper");
    let folder = temporary_folder();
    let refused = run(&mut measure(folder.path(), &["--scheme", "paper"]));
    assert_eq!(refused.exit_code, Some(2), "{refused:#?}");
    assert!(refused.stderr.contains("both schemes"), "{refused:#?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_nothing_can_be_written_to_is_refused_before_any_work() {
    // There, not even the administrator makes files.
    let finished = run(&mut measure(Path::new("/proc/self"), &[]));
    assert_eq!(finished.exit_code, Some(3), "{finished:#?}");
    assert!(
        finished.stderr.contains("could not be written"),
        "{finished:#?}"
    );
}

#[test]
fn a_folder_that_is_a_file_is_refused_before_any_work() {
    let folder = temporary_folder();
    let file = folder.path().join("taken");
    fs::write(&file, "not a folder").expect("a file can be written");
    for more in [&[][..], &["--frames", "2"]] {
        let finished = run(&mut measure(&file, more));
        assert_eq!(finished.exit_code, Some(3), "{finished:#?}");
        for word in ["error: ", "taken", "could not be written"] {
            assert!(finished.stderr.contains(word), "{word:?}: {finished:#?}");
        }
    }
    let kept = fs::read_to_string(&file).expect("the file is still there");
    assert_eq!(kept, "not a folder");
}

/// The report of the box without its lamp.
fn measure_in_the_dark(folder: &Path, arguments: &[&str]) -> Finished {
    let source = scene("cornell");
    let text = fs::read_to_string(&source).expect("the box");
    let (head, _) = text.split_once("[[light]]").expect("the box has one light");
    for name in ["cornell.obj", "cornell.mtl"] {
        let from = source.with_file_name(name);
        fs::copy(from, folder.join(name)).expect("a file of the box");
    }
    let dark = folder.join("dark.toml");
    fs::write(&dark, head).expect("a scene can be written");
    let mut command = relume(&["measure"]);
    command.arg(&dark).args(SMALL_BAKE).args(arguments);
    command.args(["--size", "20x15", "--json", "-o"]);
    succeed(command.arg(folder.join("report")))
}

#[test]
fn a_scene_without_light_has_a_report_that_says_so() {
    let folder = temporary_folder();
    let finished = measure_in_the_dark(folder.path(), &[]);
    assert!(finished.stderr.contains("no light"), "{finished:#?}");
    let object = finished.json();
    assert_eq!(object["images"], serde_json::json!({}), "{object}");
    assert!(number(&object["schemes"]["relume"]["one_bounce"]["mean"]) > 0.0);
}

#[test]
fn sweeps_by_fewer_rays_than_the_defaults_say_so() {
    let folder = temporary_folder();
    let many = ["--set", "bake.rays=6400"];
    let object = measure_in_the_dark(folder.path(), &many).json();
    let ratios = object["paper_over_relume"].as_array().expect("a list");
    assert!(!ratios.is_empty(), "{object}");
    for ratio in ratios {
        assert_eq!(ratio["rays"], serde_json::json!([6144, 6144]), "{ratio}");
    }
    let report = folder.path().join("report");
    let page = fs::read_to_string(report.join("report.html")).expect("the report");
    assert!(page.contains("swept by 6144 rays a vertex, fewer than"));
    let rays_of = |sweep: &str| -> Vec<String> {
        let path = report.join(format!("tables/sweep-{sweep}.csv"));
        let table = fs::read_to_string(path).expect("the table of a sweep");
        let defaults = table.lines().filter(|line| line.ends_with("default"));
        let rays = defaults.map(|line| line.split(',').nth(3).expect("rays").to_owned());
        rays.collect()
    };
    assert_eq!(rays_of("coefficients"), ["6144"; 2]);
    assert_eq!(rays_of("rays"), ["6400"; 2]);
}
