//! `relume diff` on pairs of files of every kind: exit codes, and figures beside
//! those of another implementation (numpy and the authors' FLIP package).
//!
//! The figures of the other implementation are kept in `pairs/expected.rs` and
//! compared always. To run it again,
//! `cargo test --test pairs -- --ignored --nocapture`, which prints them in that
//! file's form; the environment variable `RELUME_PYTHON` names a Python that has
//! `flip-evaluator` and `numpy`.

#[path = "pairs/cases.rs"]
mod cases;
#[path = "pairs/expected.rs"]
mod expected;
#[path = "pairs/files.rs"]
mod files;
#[allow(
    dead_code,
    reason = "pairs of another test, of which the formulas are used"
)]
#[path = "flip/pairs.rs"]
mod formulas;
mod program;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use cases::Case;
use expected::EXPECTED;
use files::Side;
use program::{Finished, relume, run, temporary_folder};

/// Environment variable with the Python to use instead of `python3`.
const PYTHON: &str = "RELUME_PYTHON";
/// Figures that are compared, in the order of `EXPECTED`.
const KEYS: [&str; 12] = [
    "differing_pixels",
    "non_finite_pixels",
    "max_channel_difference",
    "rmse",
    "relative_rmse",
    "bias",
    "relative_rmse_8x8",
    "flip_mean",
    "flip_median",
    "flip_p95",
    "flip_p99",
    "flip_max",
];
/// Most relative difference of a figure: three digits. 6e-5 are measured, and
/// 2e-5 on means of FLIP; colours are decoded to single precision here.
const TOLERANCE: f64 = 5e-4;
/// Most difference of FLIP at a pixel, where the package has single precision;
/// as in `flip.rs`. 8e-6 are measured on these percentiles.
const FLIP_TOLERANCE: f64 = 2e-4;

/// A case with its files in a folder.
struct Written {
    reference: PathBuf,
    candidate: PathBuf,
    mask: Option<PathBuf>,
}

impl Written {
    fn new(case: &Case, folder: &Path) -> Self {
        let write = |name: &str, side: &Side| {
            let path = folder.join(name).with_extension(side.extension);
            fs::write(&path, &side.bytes).expect("an image can be written");
            path
        };
        Self {
            reference: write("reference", &case.reference),
            candidate: write("candidate", &case.candidate),
            mask: case.mask.as_ref().map(|mask| write("mask", mask)),
        }
    }

    fn diff(&self, arguments: &[&str]) -> Finished {
        let mut command = relume(&["diff"]);
        command.arg(&self.reference).arg(&self.candidate);
        if let Some(mask) = &self.mask {
            command.arg("--mask").arg(mask);
        }
        run(command.args(arguments))
    }
}

#[test]
fn exit_codes_are_those_of_the_design() {
    for case in cases::all() {
        let folder = temporary_folder();
        let finished = Written::new(&case, folder.path()).diff(&[]);
        let name = case.name;
        assert_eq!(
            finished.exit_code,
            Some(case.exit_code),
            "{name}: {finished:#?}"
        );
        if case.exit_code >= 2 {
            assert!(finished.stdout.is_empty(), "{name}: {finished:#?}");
            assert!(
                finished.stderr.starts_with("error: "),
                "{name}: {finished:#?}"
            );
        }
    }
}

#[test]
fn figures_are_those_of_the_other_implementation() {
    let cases = cases::all();
    let compared = cases.iter().filter(|case| has_figures(case));
    let names: Vec<&str> = compared.clone().map(|case| case.name).collect();
    let kept: Vec<&str> = EXPECTED.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, kept, "run the ignored test and keep what it prints");
    for (case, (_, expected)) in compared.zip(&EXPECTED) {
        let report = report_of(case);
        let faults = faults(&report, |index| finite(expected[index]));
        assert!(faults.is_empty(), "{}: {faults:#?}", case.name);
    }
}

#[test]
#[ignore = "needs numpy and the flip-evaluator wheel of PyPI"]
fn the_other_implementation_still_says_so() {
    let mut all_faults = Vec::new();
    let mut largest = [0.0; 3];
    for case in cases::all().iter().filter(|case| has_figures(case)) {
        let theirs = other_implementation(case);
        let values = KEYS.map(|key| theirs[key].as_f64());
        let numbers = values.map(|value| value.unwrap_or(f64::NAN));
        print_line(&format!("    ({:?}, {numbers:?}),", case.name));
        let report = report_of(case);
        largest = larger_of(largest, apart(&report, &values));
        let found = faults(&report, |index| values[index]);
        all_faults.extend(found.iter().map(|fault| format!("{}: {fault}", case.name)));
    }
    print_line(&format!(
        "most apart: {:.1e} of a figure, {:.1e} of a mean of FLIP, {:.1e} at a percentile of it",
        largest[0], largest[1], largest[2]
    ));
    assert!(all_faults.is_empty(), "{all_faults:#?}");
}

/// Largest differences from the other implementation: of figures that are not
/// of FLIP, relative; of its mean, relative; and of its percentiles.
fn apart(report: &Value, theirs: &[Option<f64>; 12]) -> [f64; 3] {
    let mut largest = [0.0; 3];
    for (key, theirs) in KEYS.iter().zip(theirs) {
        let (Some(ours), Some(theirs)) = (report[key].as_f64(), *theirs) else {
            continue;
        };
        let apart = (ours - theirs).abs();
        let mut found = [0.0; 3];
        match *key {
            "flip_mean" => found[1] = relative(apart, theirs),
            key if key.starts_with("flip") => found[2] = apart,
            _ => found[0] = relative(apart, theirs),
        }
        largest = larger_of(largest, found);
    }
    largest
}

/// A difference relative to a value; 0 of nothing from nothing.
fn relative(apart: f64, value: f64) -> f64 {
    if apart == 0.0 {
        0.0
    } else {
        apart / value.abs()
    }
}

fn larger_of(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|index| {
        if a[index] > b[index] {
            a[index]
        } else {
            b[index]
        }
    })
}

#[test]
fn the_limits_that_are_printed_pass() {
    for case in cases::all().iter().filter(|case| has_figures(case)) {
        let folder = temporary_folder();
        let written = Written::new(case, folder.path());
        let report = written.diff(&["--json"]).json();
        let options = report["passing_limits"]["options"].as_array();
        let options = options.unwrap_or_else(|| panic!("{}: {report}", case.name));
        assert!(!options.is_empty(), "{}: {report}", case.name);
        for option in options {
            let option = option.as_str().unwrap_or_default();
            let words: Vec<&str> = option.split(' ').collect();
            let finished = written.diff(&words);
            let name = case.name;
            assert_eq!(
                finished.exit_code,
                Some(0),
                "{name} {option}: {finished:#?}"
            );
        }
    }
}

/// Whether both files are images of one kind and size.
fn has_figures(case: &Case) -> bool {
    let (reference, candidate) = (&case.reference, &case.candidate);
    reference.size == candidate.size && reference.extension == candidate.extension
}

fn finite(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

fn report_of(case: &Case) -> Value {
    let folder = temporary_folder();
    Written::new(case, folder.path()).diff(&["--json"]).json()
}

/// Figures of a report that are not the expected ones; `None`: not finite, or
/// for FLIP, which the package has not then, anything.
fn faults(report: &Value, expected: impl Fn(usize) -> Option<f64>) -> Vec<String> {
    let has_flip = report["non_finite_pixels"] == 0;
    let keys = KEYS.iter().enumerate();
    keys.filter(|(_, key)| has_flip || !key.starts_with("flip"))
        .filter_map(|(index, key)| {
            let (ours, theirs) = (report[key].as_f64(), expected(index));
            let agree = match (ours, theirs) {
                (Some(ours), Some(theirs)) => {
                    let slack = if *key == "flip_mean" { 1e-5 } else { 0.0 };
                    let of_pixel = key.starts_with("flip") && *key != "flip_mean";
                    let least = if of_pixel { FLIP_TOLERANCE } else { slack };
                    (ours - theirs).abs() <= TOLERANCE * theirs.abs() + least
                }
                (ours, theirs) => ours == theirs,
            };
            (!agree).then(|| format!("{key} is {ours:?}, the other has {theirs:?}"))
        })
        .collect()
}

/// What the script says of a pair, from the values that its files were made of.
fn other_implementation(case: &Case) -> Value {
    let folder = temporary_folder();
    let write = |name: &str, values: Vec<f32>| {
        let path = folder.path().join(name);
        let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
        fs::write(&path, bytes).expect("values can be written");
        path
    };
    let [width, height] = case.reference.size.map(|side| side.to_string());
    let kind = if case.reference.extension == "png" {
        "LDR"
    } else {
        "HDR"
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pairs/measure.py");
    let mut command = Command::new(std::env::var(PYTHON).unwrap_or("python3".to_owned()));
    command.arg("-B").arg(script).args([kind, &width, &height]);
    command.arg(write("reference", case.reference.values.concat()));
    command.arg(write("candidate", case.candidate.values.concat()));
    match &case.mask {
        Some(mask) => {
            let greys = mask.values.iter().map(|rgba| rgba[0]);
            command.arg(write("mask", greys.collect()))
        }
        None => command.arg("-"),
    };
    let output = command.output().expect("the Python starts");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{}: {errors}", case.name);
    serde_json::from_slice(&output.stdout).expect("the script prints JSON")
}

/// Tells whoever runs the test with `--nocapture`.
#[allow(
    clippy::print_stderr,
    reason = "the figures of the other implementation are the result of this test"
)]
fn print_line(text: &str) {
    eprintln!("{text}");
}
