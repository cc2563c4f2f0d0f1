//! The same bits for every number of threads and every level of instructions,
//! where `tests/digests` has no table of them: the published scheme, components,
//! the path tracer, and a bake that another run has made.

mod program;

use std::fs;

use program::{
    Finished, SMALL_BAKE, only_bake, render_box, render_box_command, scene, succeed,
    temporary_folder,
};

/// Levels that `--simd` takes on every processor of the architecture.
const LEVELS: &[&str] = if cfg!(target_arch = "x86_64") {
    &["scalar", "sse2", "auto"]
} else {
    &["scalar", "auto"]
};

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
