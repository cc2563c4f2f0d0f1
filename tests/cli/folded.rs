//! `fixed_albedo`: what the program says and stores of folded bounces.

use std::fs;

use crate::program::{
    SMALL_BAKE, files_in, only_bake, relume, render_box, scene, succeed, temporary_folder,
};

const FIXED: [&str; 4] = ["--bounces", "all", "--set", "bake.fixed_albedo=true"];

#[test]
fn a_fixed_albedo_stores_a_second_bake_and_another_albedo_a_third() {
    let folder = temporary_folder();
    let cache = folder.path().join("cache");
    let free = render_box(folder.path(), &["--bounces", "all"]).json();
    let path = only_bake(&cache);
    let bytes = fs::read(&path).expect("the bake can be read");
    let fixed = render_box(folder.path(), &FIXED).json();
    assert_eq!(fixed["cache"], "miss", "{fixed}");
    assert_ne!(fixed["digest"], free["digest"], "other sums");
    let folded = fixed["folded_bytes"].as_u64().expect("bytes");
    let more = fixed["bake_bytes"].as_u64().expect("bytes") - bytes.len() as u64;
    assert!(folded > 0 && more >= folded, "{folded} of {more}");
    let error = fixed["bake"]["error_of_folding"]["mean"].as_f64();
    assert!(
        error.is_some_and(|error| error > 0.0 && error < 0.05),
        "{fixed}"
    );
    assert!(free.get("folded_bytes").is_none(), "{free}");
    let kept = fs::read(&path).expect("the bake can be read");
    assert!(bytes == kept, "a bake without the key keeps its bytes");

    let again = render_box(folder.path(), &FIXED).json();
    assert_eq!(again["cache"], "hit", "{again}");
    assert_eq!(again["digest"], fixed["digest"]);
    let mut edited = FIXED.to_vec();
    edited.extend(["--set", "material.white.albedo=[0.3, 0.3, 0.3]"]);
    let edited = render_box(folder.path(), &edited).json();
    assert_eq!(
        edited["cache"], "miss",
        "another albedo needs a bake: {edited}"
    );
    assert_eq!(files_in(&cache).len(), 3);
}

#[test]
fn damaged_folded_bounces_are_refused() {
    let folder = temporary_folder();
    let whole = render_box(folder.path(), &FIXED).json();
    let cache = folder.path().join("cache");
    let largest = files_in(&cache)
        .into_iter()
        .max_by_key(|path| fs::metadata(path).map_or(0, |it| it.len()))
        .expect("a bake");
    let mut bytes = fs::read(&largest).expect("the bake can be read");
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(&largest, bytes).expect("it can be written");
    let again = render_box(folder.path(), &FIXED);
    assert!(again.stderr.contains("baking anew"), "{again:#?}");
    assert_eq!(again.json()["digest"], whole["digest"]);
}

#[test]
fn forecasts_know_what_folding_costs() {
    let folder = temporary_folder();
    let forecast = |arguments: &[&str]| {
        let mut command = relume(&["info"]);
        command.arg(scene("cornell")).args(SMALL_BAKE);
        command.arg("--cache-dir").arg(folder.path());
        succeed(command.args(arguments).arg("--json")).json()
    };
    let (free, fixed) = (
        forecast(&[]),
        forecast(&["--set", "bake.fixed_albedo=true"]),
    );
    assert_eq!(free["folded_bytes"], 0, "{free}");
    let folded = fixed["folded_bytes"].as_u64().expect("bytes");
    let bytes = |report: &serde_json::Value| report["bake_bytes"].as_u64().expect("bytes");
    assert!(
        folded > 0 && bytes(&fixed) == bytes(&free) + folded,
        "{fixed}"
    );
}
