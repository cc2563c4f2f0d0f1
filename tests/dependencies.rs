//! Dependencies that choose their code by the processor: which there are, and why
//! no bake and no frame depends on the choice.
//!
//! A dependency that is new, or begins to ask what the processor can do, is found
//! here and has to be looked at: does a number that it rounds reach a pixel?

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Words of a source that asks what the processor can do.
const ASKING: [&str; 4] = ["_feature_detected!", "cpuid", "cpufeatures", "getauxval"];

/// Packages that ask, and why they may.
const MAY_ASK: [(&str, &str); 22] = [
    ("base64", "bytes into letters, in reports"),
    (
        "blake3",
        "a hash; and its feature `pure` leaves it one path",
    ),
    ("constant_time_eq", "compares bytes, for blake3"),
    ("cpufeatures", "asks for others"),
    ("crc32fast", "a checksum"),
    ("exr", "only to decode DWA, which is refused in scenes"),
    ("getrandom", "names of temporary files"),
    ("half", "half floats become floats, which is exact"),
    ("lebe", "the order of bytes"),
    ("libc", "declares the system's functions"),
    (
        "libm",
        "for what is rounded once: square root, fused multiply-add, floor",
    ),
    ("memchr", "finds bytes"),
    ("moxcms", "colour profiles, which are not applied"),
    (
        "obvhs",
        "in a comment; and only the shape of a tree is taken from it",
    ),
    ("portable-atomic", "counters of a progress bar"),
    ("pulp", "serves exr's DWA"),
    ("pxfm", "serves moxcms"),
    ("raw-cpuid", "serves pulp"),
    ("rustix", "declares the system's functions"),
    ("simd-adler32", "a checksum"),
    ("zune-core", "only with its feature `std`, which is off"),
    (
        "zlib-rs",
        "packs pixels for PNG: a file's bytes may differ, its pixels do not",
    ),
];

/// Features that bring other bits, and must be off whoever asks for them.
const OFF: [(&str, &[&str]); 5] = [
    // Transforms of JPEG that round differently by processor.
    (
        "zune-jpeg",
        &["x86", "neon", "std", "default", "portable_simd"],
    ),
    ("zune-core", &["std"]),
    // A second decoder of JPEG, with zune-jpeg's defaults.
    ("image", &["jpeg", "default", "default-formats"]),
    ("glam", &["fast-math", "libm", "core-simd"]),
    ("blake3", &["std", "rayon", "neon"]),
];

/// What cargo knows of the packages that the program is built from here.
struct Packages {
    metadata: Value,
}

impl Packages {
    fn read() -> Self {
        let cargo = |arguments: &[&str]| {
            let output = Command::new(env!("CARGO"))
                .current_dir(env!("CARGO_MANIFEST_DIR"))
                .args(arguments)
                .output()
                .expect("cargo can be run");
            let words = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "cargo {arguments:?}: {words}");
            String::from_utf8(output.stdout).expect("cargo prints UTF-8")
        };
        let version = cargo(&["-vV"]);
        let host = version.lines().find_map(|line| line.strip_prefix("host: "));
        let host = host.expect("cargo says what machine it is for");
        let text = cargo(&[
            "metadata",
            "--format-version=1",
            "--locked",
            "--offline",
            "--filter-platform",
            host,
        ]);
        Self {
            metadata: serde_json::from_str(&text).expect("cargo prints JSON"),
        }
    }

    fn nodes(&self) -> &[Value] {
        list(&self.metadata["resolve"]["nodes"])
    }

    /// Ids of relume's dependencies and theirs, without those of tests and builds.
    fn in_the_program(&self) -> BTreeSet<&str> {
        let nodes: BTreeMap<&str, &Value> = self
            .nodes()
            .iter()
            .map(|node| (text(&node["id"]), node))
            .collect();
        let mut waiting = vec![text(&self.metadata["resolve"]["root"])];
        let mut found = BTreeSet::new();
        while let Some(id) = waiting.pop() {
            if found.insert(id) {
                let dependencies = list(&nodes[id]["deps"]).iter();
                let is_normal =
                    |d: &&Value| list(&d["dep_kinds"]).iter().any(|k| k["kind"].is_null());
                waiting.extend(dependencies.filter(is_normal).map(|d| text(&d["pkg"])));
            }
        }
        found
    }
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Whether a source below a folder has one of the words.
fn asks(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else {
        return false;
    };
    let mut paths = entries.map(|entry| entry.expect("a folder's entry").path());
    paths.any(|path| {
        if path.is_dir() {
            return asks(&path);
        }
        path.extension().is_some_and(|extension| extension == "rs")
            && fs::read(&path).is_ok_and(|bytes| {
                let source = String::from_utf8_lossy(&bytes);
                ASKING.iter().any(|word| source.contains(word))
            })
    })
}

#[test]
fn dependencies_that_choose_by_processor_are_known() {
    let packages = Packages::read();
    let inside = packages.in_the_program();
    let all = list(&packages.metadata["packages"]).iter();
    let others = all.filter(|p| inside.contains(text(&p["id"])) && text(&p["name"]) != "relume");
    let (mut count, mut unknown) = (0, Vec::new());
    for package in others {
        count += 1;
        let manifest = Path::new(text(&package["manifest_path"]));
        let name = text(&package["name"]);
        let is_known = MAY_ASK.iter().any(|(known, _)| *known == name);
        if !is_known && asks(&manifest.with_file_name("src")) {
            unknown.push(name);
        }
    }
    assert!(count > 50, "the program has dependencies: {count}");
    assert!(
        unknown.is_empty(),
        "{unknown:?} ask what the processor can do; if no bit of a bake or a frame depends on the \
         answer, say so in this test"
    );
}

#[test]
fn the_search_finds_who_asks() {
    let packages = Packages::read();
    let folder_of = |name: &str| {
        let mut all = list(&packages.metadata["packages"]).iter();
        let package = all.find(|p| text(&p["name"]) == name)?;
        Some(Path::new(text(&package["manifest_path"])).with_file_name("src"))
    };
    assert!(folder_of("memchr").is_some_and(|folder| asks(&folder)));
    assert!(folder_of("strsim").is_some_and(|folder| !asks(&folder)));
}

#[test]
fn features_that_bring_other_bits_are_off() {
    let packages = Packages::read();
    let inside = packages.in_the_program();
    for (name, features) in OFF {
        let mut nodes = packages
            .nodes()
            .iter()
            .filter(|node| inside.contains(text(&node["id"])));
        let is_of_name = |node: &&Value| text(&node["id"]).contains(&format!("#{name}@"));
        let node = nodes.find(is_of_name);
        let node = node.unwrap_or_else(|| panic!("{name} is a dependency no longer"));
        let on: Vec<&str> = list(&node["features"]).iter().map(text).collect();
        let wrong: Vec<_> = features.iter().filter(|f| on.contains(f)).collect();
        assert!(wrong.is_empty(), "{name} is built with {wrong:?}");
    }
}
