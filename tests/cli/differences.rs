//! `relume diff`: what counts as equal, and what it says of the rest.

use std::fs;
use std::path::{Path, PathBuf};

use relume::{read_compared, read_image};

use crate::program::{Finished, relume, render_box_command, run, succeed, temporary_folder};

/// A small frame of direct light under a name; needs no bake.
fn frame(folder: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    let arguments = [&["--no-cache", "--bounces", "0"], arguments].concat();
    succeed(&mut render_box_command(folder, name, &arguments));
    folder.join(name)
}

fn diff(reference: &Path, candidate: &Path, arguments: &[&str]) -> Finished {
    let mut command = relume(&["diff"]);
    run(command.arg(reference).arg(candidate).args(arguments))
}

#[test]
fn equal_images_pass_and_others_do_not() {
    let folder = temporary_folder();
    let brighter = ["--set", "light.lamp.intensity=[3.4,2.9,2.3]"];
    for kind in ["png", "exr"] {
        let named = |name: &str| format!("{name}.{kind}");
        let reference = frame(folder.path(), &named("reference"), &[]);
        let again = frame(folder.path(), &named("again"), &[]);
        let other = frame(folder.path(), &named("other"), &brighter);
        let same = diff(&reference, &again, &[]);
        assert_eq!(same.exit_code, Some(0), "{kind}: {same:#?}");
        assert!(same.stdout.starts_with("same"), "{kind}: {same:#?}");
        let measure = if kind == "png" {
            "LDR-FLIP: mean 0.00000"
        } else {
            "HDR-FLIP: mean 0.00000"
        };
        assert!(same.stdout.contains(measure), "{kind}: {same:#?}");
        let different = diff(&reference, &other, &["--json"]);
        assert_eq!(different.exit_code, Some(1), "{kind}: {different:#?}");
        let report = different.json();
        assert_eq!(report["passes"], false, "{report}");
        let bias = report["bias"].as_f64().unwrap_or_default();
        assert!(
            (0.001..0.03).contains(&bias),
            "more light is a bias above 0: {report}"
        );
        let flip = ["flip_mean", "flip_median", "flip_p95", "flip_max"]
            .map(|key| report[key].as_f64().unwrap_or(f64::NAN));
        let [mean, median, percentile_95, max] = flip;
        assert!(0.0 < mean && mean < max && max < 0.2, "{report}");
        assert!(median <= percentile_95 && percentile_95 <= max, "{report}");
    }
}

#[test]
fn limits_let_pass_exactly_what_they_say() {
    let folder = temporary_folder();
    let reference = frame(folder.path(), "reference.png", &[]);
    let brighter = ["--set", "light.lamp.intensity=[3.6,2.9,2.3]"];
    let other = frame(folder.path(), "other.png", &brighter);
    let report = diff(&reference, &other, &["--json"]).json();
    let number = |key: &str| report[key].as_u64().unwrap_or_default();
    let differing = number("differing_pixels");
    let most = report["max_channel_difference"]
        .as_f64()
        .unwrap_or_default();
    assert!(differing > 1 && most > 1.0, "the pictures differ: {report}");
    assert!(differing < number("pixels"), "but not everywhere: {report}");
    let cases = [
        ("--max-channel-difference", most.to_string(), 0),
        ("--max-channel-difference", (most - 0.5).to_string(), 1),
        ("--max-differing-pixels", differing.to_string(), 0),
        ("--max-differing-pixels", (differing - 1).to_string(), 1),
        ("--max-differing-pixels", "100%".to_owned(), 0),
        ("--max-differing-pixels", "0.05%".to_owned(), 1),
    ];
    for (limit, value, exit_code) in cases {
        let finished = diff(&reference, &other, &[limit, &value]);
        assert_eq!(
            finished.exit_code,
            Some(exit_code),
            "{limit} {value}: {finished:#?}"
        );
    }
    for (limit, value) in [
        ("--max-channel-difference", "-1"),
        ("--max-differing-pixels", "-1"),
        ("--max-differing-pixels", "many"),
    ] {
        let finished = diff(&reference, &other, &[limit, value]);
        assert_eq!(
            finished.exit_code,
            Some(2),
            "{limit} {value}: {finished:#?}"
        );
    }
}

#[test]
fn what_an_observer_sees_is_limited_alone_or_beside_levels() {
    let folder = temporary_folder();
    let reference = frame(folder.path(), "reference.png", &[]);
    let brighter = ["--set", "light.lamp.intensity=[3.6,2.9,2.3]"];
    let other = frame(folder.path(), "other.png", &brighter);
    let report = diff(&reference, &other, &["--json"]).json();
    let mean = report["flip_mean"].as_f64().unwrap_or_default();
    assert!(mean > 0.0, "the pictures differ: {report}");
    let (enough, too_little) = (mean.to_string(), (0.9 * mean).to_string());
    let cases: [(&[&str], _); 9] = [
        (&["--max-flip", &enough], 0),
        (&["--max-flip", &too_little], 1),
        (&["--max-flip", "0"], 1),
        (
            &["--max-flip", &enough, "--max-channel-difference", "255"],
            0,
        ),
        (
            &["--max-flip", &too_little, "--max-channel-difference", "255"],
            1,
        ),
        (&["--max-flip", &enough, "--max-channel-difference", "0"], 1),
        (
            &["--max-flip", &too_little, "--max-differing-pixels", "100%"],
            1,
        ),
        (&["--max-flip", &enough, "--max-differing-pixels", "0"], 1),
        (&["--max-flip", "-1"], 2),
    ];
    for (limits, exit_code) in cases {
        let finished = diff(&reference, &other, limits);
        assert_eq!(
            finished.exit_code,
            Some(exit_code),
            "{limits:?}: {finished:#?}"
        );
    }
    let finished = diff(&reference, &reference, &["--max-flip", "0"]);
    assert_eq!(finished.exit_code, Some(0), "{finished:#?}");
    let of_threads = |count| diff(&reference, &other, &["--json", "--threads", count]).stdout;
    assert_eq!(of_threads("1"), of_threads("3"));
}

#[test]
fn images_of_unequal_size_are_different_and_it_is_said() {
    let folder = temporary_folder();
    let reference = frame(folder.path(), "reference.png", &[]);
    let small = frame(
        folder.path(),
        "small.png",
        &["--set", "camera.size=[20,10]"],
    );
    let report = diff(&reference, &small, &["--json"]).json();
    assert_eq!(
        report["passes"], true,
        "--size wins over the scene: {report}"
    );

    let mut command = render_box_command(folder.path(), "small.exr", &["--no-cache"]);
    let output = folder.path().join("small.png");
    fs::remove_file(&small).expect("the picture can be removed");
    let arguments: Vec<_> = command.get_args().map(ToOwned::to_owned).collect();
    command = relume(&[]);
    let replaced = arguments.into_iter().map(|argument| {
        if argument == "40x30" {
            "20x10".into()
        } else {
            argument
        }
    });
    succeed(command.args(replaced).arg("-o").arg(output));
    let finished = diff(&reference, &small, &[]);
    assert_eq!(finished.exit_code, Some(1), "{finished:#?}");
    for words in ["40 x 30", "20 x 10"] {
        assert!(
            finished.stdout.contains(words),
            "nothing says {words}: {finished:#?}"
        );
    }
    let finished = diff(&reference, &small, &["--json"]);
    assert_eq!(finished.exit_code, Some(1), "{finished:#?}");
    assert_eq!(finished.json()["passes"], false, "{finished:#?}");
}

#[test]
fn levels_and_linear_values_are_not_compared() {
    let folder = temporary_folder();
    let levels = frame(folder.path(), "frame.png", &[]);
    let linear = frame(folder.path(), "frame.exr", &[]);
    let finished = diff(&levels, &linear, &[]);
    assert_eq!(finished.exit_code, Some(2), "{finished:#?}");
    for word in ["PNG", "EXR", "two of a kind"] {
        assert!(
            finished.stderr.contains(word),
            "nothing says {word}: {finished:#?}"
        );
    }
}

#[test]
fn files_that_are_no_images_are_file_errors() {
    let folder = temporary_folder();
    let whole = frame(folder.path(), "whole.png", &[]);
    let cut = folder.path().join("cut.png");
    let bytes = fs::read(&whole).expect("the picture can be read");
    fs::write(&cut, &bytes[..bytes.len() / 2]).expect("half of it can be written");
    for (candidate, word) in [
        (cut, "whole"),
        (folder.path().join("missing.png"), "missing.png"),
    ] {
        let finished = diff(&whole, &candidate, &[]);
        assert_eq!(finished.exit_code, Some(3), "{candidate:?}: {finished:#?}");
        assert!(
            finished.stderr.contains(word),
            "nothing says {word}: {finished:#?}"
        );
    }
}

#[test]
fn pictures_of_a_difference_are_written() {
    let folder = temporary_folder();
    let brighter = ["--set", "light.lamp.intensity=[3.6,2.9,2.3]"];
    for kind in ["png", "exr"] {
        let reference = frame(folder.path(), &format!("reference.{kind}"), &[]);
        let other = frame(folder.path(), &format!("other.{kind}"), &brighter);
        let strip = folder.path().join(format!("strip-{kind}.png"));
        let heat_map = folder.path().join(format!("heat-{kind}.PNG"));
        let mut command = relume(&["diff"]);
        command.arg(&reference).arg(&other);
        command.arg("--strip").arg(&strip);
        command.arg("--heatmap").arg(&heat_map);
        let finished = run(&mut command);
        assert_eq!(finished.exit_code, Some(1), "{finished:#?}");
        let strip = read_image(&strip).expect("the strip can be read");
        let size = [strip.values().width(), strip.values().height()];
        assert_eq!(size, [3 * 40 + 2 * 4, 30], "three panels and two gaps");
        let heat_map = read_image(&heat_map).expect("the heat map can be read");
        assert_eq!(heat_map.values().width(), 7 * 40, "at least 256 wide");
    }
    let reference = folder.path().join("reference.png");
    let finished = diff(&reference, &reference, &["--strip", "strip.exr"]);
    assert_eq!(finished.exit_code, Some(2), "{finished:#?}");
    assert!(finished.stderr.contains("use .png"), "{finished:#?}");
    let before = fs::read(&reference).expect("the picture can be read");
    let own = reference.to_str().expect("the path is text");
    let finished = diff(&reference, &reference, &["--strip", own]);
    assert_eq!(finished.exit_code, Some(2), "{finished:#?}");
    let after = fs::read(&reference).expect("the picture can be read");
    assert!(before == after, "what is compared is not written over");
    let finished = diff(&reference, &reference, &["--strip", "no/folder/x.png"]);
    assert_eq!(finished.exit_code, Some(3), "{finished:#?}");
}

#[test]
fn masks_that_do_not_fit_are_wrong_usage() {
    let folder = temporary_folder();
    let reference = frame(folder.path(), "reference.png", &[]);
    let linear = frame(folder.path(), "linear.exr", &[]);
    let depth = ["--component", "depth"];
    let grey = frame(folder.path(), "grey.png", &depth);
    let masked = |mask: &Path| diff(&reference, &reference, &["--mask", &mask.to_string_lossy()]);
    assert_eq!(masked(&grey).exit_code, Some(0), "depth is grey");
    for (mask, exit_code, words) in [
        (&reference, 2, "is not grey"),
        (&linear, 2, "give a PNG"),
        (&folder.path().join("missing.png"), 3, "missing.png"),
    ] {
        let finished = masked(mask);
        assert_eq!(finished.exit_code, Some(exit_code), "{finished:#?}");
        assert!(finished.stderr.contains(words), "{finished:#?}");
    }
}

#[test]
fn files_say_what_made_them_and_a_mismatch_says_what_differs() {
    let folder = temporary_folder();
    let brighter = ["--set", "light.lamp.intensity=[3.6,2.9,2.3]"];
    for kind in ["png", "exr"] {
        let named = |name: &str| format!("{name}.{kind}");
        let reference = frame(folder.path(), &named("reference"), &[]);
        let again = frame(folder.path(), &named("again"), &["--threads", "1"]);
        let other = frame(folder.path(), &named("other"), &brighter);
        let bytes = |path: &Path| fs::read(path).expect("a frame can be read");
        assert!(bytes(&reference) == bytes(&again), "{kind}: other bytes");

        let finished = diff(&reference, &other, &[]);
        for words in ["(reference | candidate)", "relume:scene.lights: "] {
            assert!(finished.stdout.contains(words), "{words}: {finished:#?}");
        }
        let report = diff(&reference, &other, &["--json"]).json();
        let differences = report["metadata_differences"].as_array().cloned();
        let differences = differences.unwrap_or_default();
        let names: Vec<_> = differences.iter().map(|d| d["name"].as_str()).collect();
        assert_eq!(names, [Some("relume:scene"), Some("relume:scene.lights")]);
        assert_ne!(differences[1]["reference"], differences[1]["candidate"]);
        let same = diff(&reference, &again, &["--json"]).json();
        assert_eq!(same["metadata_differences"], serde_json::json!([]));
    }
    let file = folder.path().join("reference.png");
    let loaded = read_compared(&file).expect("the frame can be read");
    let metadata = loaded.metadata();
    for (name, value) in [
        ("software", concat!("relume ", env!("CARGO_PKG_VERSION"))),
        ("relume:size", "40x30"),
        ("relume:bounces", "0"),
        ("relume:component", "global"),
        ("relume:tone", "srgb"),
    ] {
        assert_eq!(metadata.get(name), Some(value), "{name}");
    }
    let linear = read_compared(&folder.path().join("reference.exr"));
    let linear = linear.expect("the frame can be read");
    assert_eq!(linear.metadata().get("relume:tone"), None);
}

#[test]
fn a_bake_is_part_of_what_a_file_says() {
    let folder = temporary_folder();
    let bounced = |name: &str| {
        succeed(&mut render_box_command(
            folder.path(),
            name,
            &["--bounces", "1"],
        ));
        folder.path().join(name)
    };
    let (cold, warm) = (bounced("cold.png"), bounced("warm.png"));
    let bytes = |path: &Path| fs::read(path).expect("a frame can be read");
    assert!(
        bytes(&cold) == bytes(&warm),
        "a warm cache gives other bytes"
    );
    let loaded = read_compared(&cold).expect("the frame can be read");
    let metadata = loaded.metadata();
    assert_eq!(metadata.get("relume:bake.rays"), Some("64"));
    assert_eq!(metadata.get("relume:bake.scheme"), Some("relume"));
    for name in ["functions", "coefficients", "vertices"] {
        let value = metadata.get(&format!("relume:bake.{name}"));
        let number = value.and_then(|value| value.parse::<f64>().ok());
        assert!(
            number.is_some_and(|number| number > 1.0),
            "{name}: {value:?}"
        );
    }
}
