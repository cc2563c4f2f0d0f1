//! One digest and one bake file for every number of threads, every level of
//! instructions, a warm and a cold cache, and two builds.

mod program;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use program::{
    Finished, SMALL_BAKE, only_bake, relume, render_box, render_box_command, scene, succeed,
    temporary_folder,
};

/// Levels that `--simd` takes on every processor of the architecture.
const LEVELS: &[&str] = if cfg!(target_arch = "x86_64") {
    &["scalar", "sse2", "auto"]
} else {
    &["scalar", "auto"]
};
const THREADS: [&str; 4] = ["1", "2", "3", "8"];

/// The digest that a render reports, and whether its bake was stored already.
fn digest_and_cache(finished: &Finished) -> [String; 2] {
    let report = finished.json();
    ["digest", "cache"].map(|key| report[key].as_str().unwrap_or_default().to_owned())
}

/// Renders with a new cache, then from that cache; the two digests must agree.
/// Returns the digest and the bytes of the bake.
fn cold_and_warm(arguments: &[&str]) -> (String, Vec<u8>) {
    let folder = temporary_folder();
    let [cold, miss] = digest_and_cache(&render_box(folder.path(), arguments));
    let [warm, hit] = digest_and_cache(&render_box(folder.path(), arguments));
    assert_eq!([miss, hit], ["miss", "hit"], "{arguments:?}");
    assert_eq!(
        cold, warm,
        "{arguments:?}: the stored bake is the one that was made"
    );
    let bake = fs::read(only_bake(&folder.path().join("cache"))).expect("the bake can be read");
    (cold, bake)
}

#[test]
fn threads_instructions_and_cache_change_no_bit() {
    let (digest, bake) = cold_and_warm(&["--threads", "1", "--simd", "scalar"]);
    for threads in THREADS {
        for simd in LEVELS {
            let (other_digest, other_bake) = cold_and_warm(&["--threads", threads, "--simd", simd]);
            let run = format!("--threads {threads} --simd {simd}");
            assert_eq!(other_digest, digest, "{run}: another picture");
            assert!(other_bake == bake, "{run}: another bake");
        }
    }
}

/// METIS is outside the promise of equal bits, but within one machine and with
/// nobody else drawing random numbers it repeats itself.
#[test]
fn the_published_scheme_has_one_digest_too() {
    let run =
        |threads, simd| cold_and_warm(&["--scheme", "paper", "--threads", threads, "--simd", simd]);
    let (digest, bake) = run("1", "scalar");
    for (threads, simd) in [("3", "auto"), ("2", "scalar"), ("1", "auto")] {
        let other = run(threads, simd);
        assert_eq!(
            other.0, digest,
            "--threads {threads} --simd {simd}: another picture"
        );
        assert!(
            other.1 == bake,
            "--threads {threads} --simd {simd}: another bake"
        );
    }
}

/// Sky, a map's sun, textures and a lamp with an emission map: what the box
/// has none of.
#[test]
fn every_kind_of_light_has_one_digest() {
    let evening = scene("courtyard").with_file_name("evening.toml");
    let render = |threads: &str, simd: &str| {
        let folder = temporary_folder();
        let mut command = relume(&["render"]);
        command.arg(&evening);
        command.arg("-o").arg(folder.path().join("frame.png"));
        command.arg("--cache-dir").arg(folder.path().join("cache"));
        command.args(["--set", "bake.max_edge=2", "--set", "bake.rays=64"]);
        command.args(["--size", "64x48", "--json"]);
        command.args(["--threads", threads, "--simd", simd]);
        let digest = digest_and_cache(&succeed(&mut command))[0].clone();
        let bake = fs::read(only_bake(&folder.path().join("cache"))).expect("there is a bake");
        (digest, bake)
    };
    let one = render("1", "scalar");
    for (threads, simd) in [("3", "auto"), ("2", "scalar"), ("1", "auto")] {
        let other = render(threads, simd);
        assert_eq!(
            other.0, one.0,
            "--threads {threads} --simd {simd}: another picture"
        );
        assert!(
            other.1 == one.1,
            "--threads {threads} --simd {simd}: another bake"
        );
    }
}

#[test]
fn a_bake_of_one_run_serves_every_other() {
    let folder = temporary_folder();
    let made = ["--threads", "3", "--simd", "auto"];
    let [digest, _] = digest_and_cache(&render_box(folder.path(), &made));
    for simd in LEVELS {
        let finished = render_box(folder.path(), &["--threads", "1", "--simd", simd]);
        let wanted = [digest.clone(), "hit".to_owned()];
        assert_eq!(
            digest_and_cache(&finished),
            wanted,
            "--simd {simd} with a stored bake"
        );
    }
}

#[test]
fn linear_values_are_the_same_bits_too() {
    let folder = temporary_folder();
    let digest = |arguments: &[&str]| {
        let mut command = render_box_command(folder.path(), "frame.exr", arguments);
        digest_and_cache(&succeed(command.arg("--json")))[0].clone()
    };
    for component in ["global", "irradiance", "depth"] {
        let scalar = digest(&[
            "--component",
            component,
            "--simd",
            "scalar",
            "--threads",
            "1",
        ]);
        let wide = digest(&["--component", component, "--threads", "3"]);
        assert_eq!(scalar, wide, "{component} as an EXR");
    }
}

#[test]
fn a_reference_is_the_same_bits_too() {
    let folder = temporary_folder();
    let digest = |arguments: &[&str]| {
        let mut command = program::relume(&["reference", "--json", "--spp", "4"]);
        command
            .arg(scene("cornell"))
            .args(["--size", "32x24", "--set", "bake.max_edge=0.5", "-o"])
            .arg(folder.path().join("reference.exr"));
        digest_and_cache(&succeed(command.args(arguments)))[0].clone()
    };
    let scalar = digest(&["--simd", "scalar", "--threads", "1"]);
    assert_eq!(
        scalar,
        digest(&["--threads", "3"]),
        "paths traced otherwise"
    );
}

/// `[bake]` keys with which the box has some 300 vertices, so that a program
/// without optimisation bakes it in seconds.
const TINY_BAKE: [&str; 4] = ["--set", "bake.max_edge=0.9", "--set", "bake.rays=64"];

/// Builds the program without optimisation, dependencies too.
fn unoptimised_program(target: &Path) -> PathBuf {
    let built = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["build", "--offline", "--bin", "relume"])
        .args(["--config", "profile.dev.opt-level=0"])
        .args(["--config", "profile.dev.package.\"*\".opt-level=0"])
        .arg("--target-dir")
        .arg(target)
        .output()
        .expect("cargo can be run");
    let words = String::from_utf8_lossy(&built.stderr);
    assert!(
        built.status.success(),
        "the build without optimisation fails: {words}"
    );
    let name = format!("relume{}", std::env::consts::EXE_SUFFIX);
    target.join("debug").join(name)
}

/// Digest, number of vertices and bytes of the bake of a tiny box.
fn tiny_box(program: &Path, folder: &Path) -> (String, u64, Vec<u8>) {
    let cache = folder.join("cache");
    let mut command = Command::new(program);
    command
        .arg("render")
        .arg(scene("cornell"))
        .args(["--json", "--size", "40x30", "-o"])
        .arg(folder.join("frame.exr"))
        .args(TINY_BAKE)
        .arg("--cache-dir")
        .arg(&cache);
    let finished = succeed(&mut command);
    let vertices = finished.json()["vertices"].as_u64().unwrap_or_default();
    let bake = fs::read(only_bake(&cache)).expect("the bake can be read");
    (digest_and_cache(&finished)[0].clone(), vertices, bake)
}

#[test]
#[ignore = "builds the program and its dependencies anew, which takes minutes"]
fn a_build_without_optimisation_gives_the_same_bits() {
    let [build, first, second] = [(); 3].map(|()| temporary_folder());
    let unoptimised = unoptimised_program(build.path());
    let program = Path::new(env!("CARGO_BIN_EXE_relume"));
    let (digest, vertices, bake) = tiny_box(program, first.path());
    let (other_digest, _, other_bake) = tiny_box(&unoptimised, second.path());
    assert!(
        (250..450).contains(&vertices),
        "a scene of some 300 vertices: {vertices}"
    );
    assert_eq!(other_digest, digest, "another picture without optimisation");
    assert!(other_bake == bake, "another bake without optimisation");
}

#[test]
fn the_small_box_is_small_and_not_trivial() {
    let folder = temporary_folder();
    let report = render_box(folder.path(), &[]).json();
    let number = |key: &str| report[key].as_u64().unwrap_or_default();
    assert!(
        (500..2_000).contains(&number("vertices")) && number("partitions") > 1,
        "{SMALL_BAKE:?} leaves a scene of several partitions: {report}"
    );
}
