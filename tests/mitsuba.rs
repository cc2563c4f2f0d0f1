//! relume against Mitsuba 3: a renderer that shares no code with it.
//!
//! relume's own path tracer shares scene, lights and shading with the renderer,
//! so a common fault (a factor of pi, a colour space, a side) passes between
//! them. Here `mitsuba/reference.py` reads the scene file itself. Run it with
//! `cargo test --release --test mitsuba -- --ignored --nocapture`; the
//! environment variable `RELUME_PYTHON` names a Python that has the wheels `mitsuba` and
//! `numpy`.
//!
//! `RELUME_EXTRA_SCENES` names more scene files, separated as in `PATH`, that are
//! compared and held to the same limits. Mirrors and glass count as diffuse with
//! their `Kd` in the reference. Two differences are intended and no fault:
//! bounced light passes through the rectangles of `kind = "area"`, and where a
//! thin wall has shading normals far from its own, Mitsuba lets light from
//! behind the wall reach its front.

#[path = "mitsuba/scenes.rs"]
mod scenes;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Environment variable with the Python to use instead of `python3`.
const PYTHON: &str = "RELUME_PYTHON";
/// Environment variable with scene files to compare besides the usual ones.
const EXTRA_SCENES: &str = "RELUME_EXTRA_SCENES";
/// Scenes of the repository with all kinds of local light, open and closed, flat
/// and curved.
const SCENES: [&str; 4] = ["cornell", "window", "statues", "plank"];
/// Large enough for every feature of the scenes, small enough for minutes.
const SIZE: &str = "160x120";
/// Paths a pixel of the reference. Two seeds of 128 paths differ in the mean by
/// 0.15 % on the plank (two lights, of which a path takes one at random) and by
/// at most 0.06 % on the other scenes; 512 paths keep the noise of the mean
/// below 0.1 %, far from the limits of the bias.
const PATHS_A_PIXEL: &str = "512";
/// Most relative difference of the mean of direct light, which relume computes
/// exactly at every sample: what remains is the anti-aliasing of shadow edges.
/// A wrong factor, exponent or falloff is larger than a per cent.
const DIRECT_BIAS: f64 = 0.003;
/// Most relative difference of the mean after four bounces: the compressed
/// transfer keeps constant light exactly and other light within its error, of
/// which the mean is a small part. One lost bounce is at least 2 %.
const GLOBAL_BIAS: f64 = 0.01;
/// Most relative error of direct light's means over blocks of 8 x 8 pixels. The
/// bias does not see a picture that is mirrored (0.48 to 0.87 on these scenes)
/// or moved by one pixel (0.035 to 0.056), a texture that is flipped (0.51) or
/// not decoded from sRGB (0.51), a sky that is turned by one column of 64 (0.19);
/// the reference's own noise is 0.006.
const DIRECT_BLOCK_ERROR: f64 = 0.02;
/// The same after four bounces: what a bake promises for indirect light.
const GLOBAL_BLOCK_ERROR: f64 = 0.05;
/// The same two of a final gather, which has no error of vertices left in what
/// pixels receive last, only in what its rays read.
const GATHER_BIAS: f64 = 0.005;
const GATHER_BLOCK_ERROR: f64 = 0.015;

/// A scene, its bounces, and the frames that are compared with one reference.
struct Case {
    name: String,
    scene: PathBuf,
    bounces: u32,
    candidates: Vec<Candidate>,
}

/// A quality of frames and its limits.
struct Candidate {
    quality: &'static str,
    most_bias: f64,
    most_block_error: f64,
}

#[test]
#[ignore = "needs the mitsuba wheel of PyPI and minutes of rendering"]
fn relume_agrees_with_mitsuba() {
    // Who asks for the comparison must not be told that it agrees without one.
    assert!(
        mitsuba_is_installed(),
        "`import mitsuba, numpy` fails: install both (`pip install mitsuba numpy`), or set \
         RELUME_PYTHON to a Python that has them"
    );
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let of_repository = SCENES.map(|name| (name.to_owned(), scene_path(name)));
    let written = scenes::write_all(folder.path());
    let written = written
        .into_iter()
        .map(|(name, scene)| (name.to_owned(), scene));
    let faults: Vec<String> = of_repository
        .into_iter()
        .chain(written)
        .chain(extra_scenes())
        .flat_map(|(name, scene)| cases(&name, &scene))
        .flat_map(|case| faults_of(&case, folder.path()))
        .collect();
    assert!(faults.is_empty(), "differs from Mitsuba: {faults:#?}");
}

/// The scenes of [`EXTRA_SCENES`], named by their paths.
fn extra_scenes() -> Vec<(String, PathBuf)> {
    let paths = std::env::var_os(EXTRA_SCENES).unwrap_or_default();
    std::env::split_paths(&paths)
        .filter(|path| !path.as_os_str().is_empty())
        .map(|path| (path.display().to_string(), path))
        .collect()
}

/// Direct light, then four bounces.
fn cases(name: &str, scene: &Path) -> [Case; 2] {
    let case = |bounces, candidates| Case {
        name: format!("{name} with {bounces} bounces"),
        scene: scene.to_owned(),
        bounces,
        candidates,
    };
    let candidate = |quality, most_bias, most_block_error| Candidate {
        quality,
        most_bias,
        most_block_error,
    };
    let direct = candidate("standard", DIRECT_BIAS, DIRECT_BLOCK_ERROR);
    let global = candidate("standard", GLOBAL_BIAS, GLOBAL_BLOCK_ERROR);
    let gather = candidate("gather", GATHER_BIAS, GATHER_BLOCK_ERROR);
    [case(0, vec![direct]), case(4, vec![global, gather])]
}

/// Renders the reference and its candidates; says which differ too much.
fn faults_of(case: &Case, folder: &Path) -> Vec<String> {
    let reference = folder.join("reference.exr");
    render_with_mitsuba(case, &reference);
    let compared = case.candidates.iter().map(|candidate| {
        let frame = folder.join("candidate.exr");
        render_with_relume(case, candidate, folder, &frame);
        let difference = difference(&frame, &reference);
        let told = format!("{}, {}: {difference}", case.name, candidate.quality);
        report(&told);
        (!agrees(candidate, &difference)).then_some(told)
    });
    compared.flatten().collect()
}

/// Whether a difference is within the limits, and the picture not black.
fn agrees(candidate: &Candidate, difference: &Value) -> bool {
    let number = |key: &str| difference[key].as_f64().unwrap_or(f64::NAN);
    number("reference_mean") > 0.0
        && number("bias").abs() <= candidate.most_bias
        && number("block_rel_rmse") <= candidate.most_block_error
}

fn scene_path(name: &str) -> PathBuf {
    repository()
        .join("scenes")
        .join(name)
        .join(format!("{name}.toml"))
}

fn render_with_mitsuba(case: &Case, output: &Path) {
    run(script()
        .arg(&case.scene)
        .arg("-o")
        .arg(output)
        .args(["--size", SIZE, "--spp", PATHS_A_PIXEL])
        .args(["--bounces", &case.bounces.to_string()]));
}

/// The cache is the folder's own, so the frames of a scene share one bake.
fn render_with_relume(case: &Case, candidate: &Candidate, folder: &Path, output: &Path) {
    run(Command::new(env!("CARGO_BIN_EXE_relume"))
        .arg("render")
        .arg(&case.scene)
        .arg("-o")
        .arg(output)
        .arg("--cache-dir")
        .arg(folder.join("cache"))
        .args(["--size", SIZE, "--quality", candidate.quality])
        .args(["--bounces", &case.bounces.to_string()]));
}

/// What the script says about two images.
fn difference(candidate: &Path, reference: &Path) -> Value {
    let output = run(script().arg("--compare").arg(candidate).arg(reference));
    serde_json::from_slice(&output.stdout).expect("the script prints one JSON object")
}

fn script() -> Command {
    let mut command = python();
    // Without -B Python leaves a folder of compiled files beside the script.
    command
        .arg("-B")
        .arg(repository().join("tests/mitsuba/reference.py"));
    command
}

fn python() -> Command {
    Command::new(std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into()))
}

fn mitsuba_is_installed() -> bool {
    python()
        .args(["-c", "import mitsuba, numpy"])
        .output()
        .is_ok_and(|output| output.status.success())
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Runs a program that must succeed.
fn run(command: &mut Command) -> Output {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?} does not start: {error}"));
    assert!(
        output.status.success(),
        "{command:?} fails: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Tells whoever runs the test with `--nocapture`.
#[allow(
    clippy::print_stderr,
    reason = "the measured differences are the result of this test"
)]
fn report(text: &str) {
    eprintln!("{text}");
}
