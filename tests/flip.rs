//! FLIP against the package of its authors, `flip-evaluator` of PyPI.
//!
//! The means that the package gives for small pairs of images are kept in
//! `flip/pairs.rs` and compared always. To compare whole error maps with the
//! package itself, run
//! `cargo test --release --test flip -- --ignored --nocapture`; the environment
//! variable `RELUME_PYTHON` names a Python that has `flip-evaluator` and `numpy`.

#[path = "flip/pairs.rs"]
mod pairs;

use std::path::Path;
use std::process::Command;

use pairs::{Kind, Pair};
use relume::{FlipMap, Image, flip, hdr_flip};

/// Environment variable with the Python to use instead of `python3`.
const PYTHON: &str = "RELUME_PYTHON";
/// Most difference of a mean: three digits of a number up to 1, which the
/// rounding of the package's single precision (6e-5 measured on black and white,
/// where it sums 6912 nearly equal errors; 8e-6 elsewhere) leaves whole.
const MEAN_TOLERANCE: f64 = 5e-4;
/// Most difference of the error of one pixel. 4.5e-5 are measured, from the
/// package's single precision; sensitivity filters that are cut one pixel
/// earlier differ by up to 6.6e-3.
const MAP_TOLERANCE: f64 = 2e-4;
/// Most difference of an exposure, which the package has in single precision.
const EXPOSURE_TOLERANCE: f64 = 1e-5;

#[test]
fn means_are_those_of_the_package() {
    for pair in pairs::all() {
        let mean = evaluate(&pair).0.mean();
        let name = pair.name;
        let expected = pair.expected_mean;
        assert!(
            (mean - expected).abs() <= MEAN_TOLERANCE,
            "{:?} {name}: {mean} instead of {expected}",
            pair.kind
        );
    }
}

#[test]
#[ignore = "needs the flip-evaluator wheel of PyPI"]
fn maps_are_those_of_the_package() {
    // Who asks for the comparison must not be told that it agrees without one.
    assert!(
        package_is_installed(),
        "`import flip_evaluator, numpy` fails: install both (`pip install flip-evaluator numpy`), \
         or set RELUME_PYTHON to a Python that has them"
    );
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    report("pair: mean, the package's mean, difference, largest and mean difference of a pixel");
    let pairs = pairs::all();
    let faults: Vec<String> = pairs
        .iter()
        .filter_map(|pair| compare(pair, folder.path()).err())
        .collect();
    assert!(faults.is_empty(), "differs from the package: {faults:#?}");
}

/// Our errors, and for HDR the exposures as start, stop and count.
fn evaluate(pair: &Pair) -> (FlipMap, Option<[f64; 3]>) {
    let (reference, candidate) = (&pair.reference, &pair.candidate);
    match pair.kind {
        Kind::Ldr => {
            let map = flip(reference, candidate, pair.pixels_per_degree);
            (map.expect("the sizes agree"), None)
        }
        Kind::Hdr => {
            let found = hdr_flip(reference, candidate, pair.pixels_per_degree);
            let found = found.expect("the sizes agree");
            let count = f64::from(found.exposure_count);
            let exposures = [found.start_exposure, found.stop_exposure, count];
            (found.map, Some(exposures))
        }
    }
}

/// Compares our map with the package's and says what it found.
fn compare(pair: &Pair, folder: &Path) -> Result<(), String> {
    let (map, exposures) = evaluate(pair);
    let (result, errors) = run_package(pair, folder);
    let differences: Vec<f64> = map
        .values()
        .iter()
        .zip(&errors)
        .map(|(&ours, &theirs)| f64::from((ours - theirs).abs()))
        .collect();
    let largest = differences
        .iter()
        .copied()
        .max_by(f64::total_cmp)
        .unwrap_or(0.0);
    let mean_of_differences = differences.iter().sum::<f64>() / differences.len() as f64;
    let number = |key: &str| result[key].as_f64().unwrap_or(f64::NAN);
    let (ours, theirs) = (map.mean(), number("mean"));
    let text = format!(
        "{:?} {}: {ours:.6} {theirs:.6} {:+.1e} {largest:.1e} {mean_of_differences:.1e}",
        pair.kind,
        pair.name,
        ours - theirs,
    );
    report(&text);
    let keys = ["startExposure", "stopExposure", "numExposures"];
    let same_exposures = exposures.is_none_or(|exposures| {
        let pairs = exposures.iter().zip(keys);
        pairs
            .into_iter()
            .all(|(ours, key)| (ours - number(key)).abs() <= EXPOSURE_TOLERANCE)
    });
    let same_maps = errors.len() == map.values().len() && largest <= MAP_TOLERANCE;
    let same_means = (ours - theirs).abs() <= MEAN_TOLERANCE;
    let kept_mean = (pair.expected_mean - theirs).abs() <= MEAN_TOLERANCE;
    if same_maps && same_means && kept_mean && same_exposures {
        return Ok(());
    }
    Err(format!("{text}; exposures {exposures:?}, {result}"))
}

/// What the package says, and its errors row by row.
fn run_package(pair: &Pair, folder: &Path) -> (serde_json::Value, Vec<f32>) {
    let path = |name: &str| folder.join(name);
    write_values(&path("reference"), &pair.reference);
    write_values(&path("candidate"), &pair.candidate);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/flip/package.py");
    let kind = match pair.kind {
        Kind::Ldr => "LDR",
        Kind::Hdr => "HDR",
    };
    let mut command = python();
    command
        .arg("-B")
        .arg(script)
        .arg(kind)
        .arg(pair.reference.width().to_string())
        .arg(pair.reference.height().to_string())
        .arg(pair.pixels_per_degree.to_string())
        .args([path("reference"), path("candidate"), path("map")]);
    let output = command.output().expect("the Python starts");
    assert!(
        output.status.success(),
        "{}: {}",
        pair.name,
        String::from_utf8_lossy(&output.stderr)
    );
    let result = serde_json::from_slice(&output.stdout).expect("the script prints JSON");
    let bytes = std::fs::read(path("map")).expect("the script writes the map");
    let (values, _) = bytes.as_chunks::<4>();
    let values = values.iter().map(|&value| f32::from_le_bytes(value));
    (result, values.collect())
}

fn write_values(path: &Path, image: &Image) {
    let values = image.pixels().iter().flat_map(|pixel| pixel.to_array());
    let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    std::fs::write(path, bytes).expect("the image can be written");
}

fn python() -> Command {
    Command::new(std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into()))
}

fn package_is_installed() -> bool {
    python()
        .args(["-c", "import flip_evaluator, numpy"])
        .output()
        .is_ok_and(|output| output.status.success())
}

/// Tells whoever runs the test with `--nocapture`.
#[allow(
    clippy::print_stderr,
    reason = "the measured differences are the result of this test"
)]
fn report(text: &str) {
    eprintln!("{text}");
}
