//! The rooms of `src/` stand in the order of the flow, and a room imports only
//! from rooms above it; dependencies and `unsafe` stay in the rooms that own
//! them. Read from the sources themselves.

#[path = "rooms/source.rs"]
mod source;

use std::fs;
use std::path::{Path, PathBuf};

use source::{Named, paths, test_files};

/// Rooms by stage of the flow. The binary comes after all of them and sees only
/// the public API.
const ROOMS: [&str; 16] = [
    "simd",
    "maths",
    "brdf",
    "texture",
    "scene",
    "frame",
    "compare",
    "report",
    "surface",
    "bake",
    "relight",
    "reference",
    "output",
    "golden",
    "measure",
    "preview",
];
/// The binary: `src/main.rs` and `src/cli/`.
const BINARY: &str = "cli";
/// Dependencies, each with the only rooms that name it.
const OWNED: [(&str, &[&str]); 18] = [
    ("obvhs", &["surface"]),
    ("spade", &["surface"]),
    ("tobj", &["scene"]),
    ("toml", &["scene"]),
    ("toml_edit", &["scene"]),
    ("crossterm", &["output", "preview"]),
    ("image", &["texture", "output"]),
    ("exr", &["texture", "output"]),
    ("png", &["output"]),
    ("tiny_skia", &["output"]),
    ("clap", &[BINARY]),
    ("indicatif", &[BINARY]),
    ("libm", &["maths"]),
    ("metis", &["bake"]),
    ("maud", &["report"]),
    ("base64", &["report", "output"]),
    ("rustix", &["preview"]),
    ("signal_hook", &["preview", BINARY]),
];
/// The only room with `unsafe`.
const UNSAFE_ROOM: &str = "simd";

/// A file of `src/`.
struct File {
    /// Where it is, relative to `src/`, with `/` between the folders.
    path: String,
    text: String,
}

impl File {
    /// First folder, or the file's own stem; `main.rs` belongs to the binary.
    fn room(&self) -> &str {
        match self.path.split(['/', '.']).next() {
            Some("main") | None => BINARY,
            Some(first) => first,
        }
    }

    /// Modules between the crate and the file's items: 1 for `bake/mod.rs`.
    fn depth(&self) -> usize {
        let folders = self.path.matches('/').count();
        let is_folder_itself = ["mod.rs", "lib.rs", "main.rs"]
            .iter()
            .any(|name| self.path.ends_with(name));
        folders + usize::from(!is_folder_itself)
    }

    /// What the file does that its room may not, one sentence each.
    fn faults(&self, exists_in_tests_alone: bool) -> Vec<String> {
        let named = paths(&self.text);
        let mut faults: Vec<String> = named
            .iter()
            .filter_map(|named| {
                self.wrong_import(named, exists_in_tests_alone)
                    .or_else(|| self.wrong_dependency(named))
                    .or_else(|| self.wrong_unsafe(named))
                    .map(|fault| format!("src/{}:{}: {fault}", self.path, named.line))
            })
            .collect();
        // A group of imports names its room once a leaf.
        faults.dedup();
        faults
    }

    /// Tests may borrow from rooms below, shipped code may not.
    fn wrong_import(&self, named: &Named, exists_in_tests_alone: bool) -> Option<String> {
        let room = self.room();
        let target = target(named, self.depth())?;
        let is_test = exists_in_tests_alone || named.in_tests;
        if room == "lib" || target == room || (is_test && room != BINARY) {
            return None;
        }
        if room == BINARY {
            let problem = format!("the binary names crate::{target}; it sees only the public API");
            return Some(problem);
        }
        let position = |name: &str| ROOMS.iter().position(|&known| known == name);
        match (position(room), position(target)) {
            (None, _) => Some(format!("{room} is no room of the order {ROOMS:?}")),
            (_, None) => Some(format!("crate::{target} is no room of the order {ROOMS:?}")),
            (Some(here), Some(there)) if there > here => {
                Some(format!("{room} imports from {target}, which stands below"))
            }
            _ => None,
        }
    }

    fn wrong_dependency(&self, named: &Named) -> Option<String> {
        let first = named.segments.first()?;
        let is_path = named.segments.len() > 1;
        let &(name, owners) = OWNED
            .iter()
            .find(|(name, _)| is_path && *name == first.trim_start_matches("r#"))?;
        let fault = format!("{name} is named outside {}", owners.join(" and "));
        (!owners.contains(&self.room())).then_some(fault)
    }

    fn wrong_unsafe(&self, named: &Named) -> Option<String> {
        let is_unsafe = named.segments == ["unsafe"] && self.room() != UNSAFE_ROOM;
        is_unsafe.then(|| format!("unsafe outside {UNSAFE_ROOM}"))
    }
}

/// The room that a path leads to from a file at this depth: the word behind
/// `crate::`, or behind as many `super::` as lead out of the room.
fn target(named: &Named, file_depth: usize) -> Option<&str> {
    let words: Vec<&str> = named.segments.iter().map(String::as_str).collect();
    let ups = words.iter().take_while(|&&word| word == "super").count();
    match words.as_slice() {
        ["crate", room, ..] => Some(room),
        _ if ups > 0 && ups >= file_depth + named.depth => words.get(ups).copied(),
        _ => None,
    }
}

/// All files of `src/`, in the order of their paths.
fn files() -> Vec<File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    collect(&root, &mut found);
    found.sort();
    found
        .into_iter()
        .map(|path| {
            let inside = path.strip_prefix(&root).expect("the file lies in src");
            File {
                path: inside.to_string_lossy().replace('\\', "/"),
                text: fs::read_to_string(&path).expect("a source file is text"),
            }
        })
        .collect()
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of src can be listed") {
        let path = entry.expect("a folder's entry can be read").path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Files and folders that some file declares as `#[cfg(test)] mod`, without `.rs`.
fn in_tests_alone(files: &[File]) -> Vec<String> {
    let declared = files.iter().flat_map(|parent| {
        let folder = match parent.path.strip_suffix("mod.rs") {
            Some(folder) => folder.to_owned(),
            None => format!("{}/", parent.path.trim_end_matches(".rs")),
        };
        let names = test_files(&parent.text);
        names.into_iter().map(move |name| format!("{folder}{name}"))
    });
    declared.collect()
}

#[test]
fn rooms_import_only_from_above() {
    let files = files();
    for room in ROOMS {
        assert!(
            files.iter().any(|file| file.room() == room),
            "there is no file in src/{room}: the order of this test is out of date"
        );
    }
    let tests = in_tests_alone(&files);
    let is_test = |file: &File| {
        tests.iter().any(|stem| {
            let rest = file.path.strip_prefix(stem.as_str());
            rest.is_some_and(|rest| rest == ".rs" || rest.starts_with('/'))
        })
    };
    let faults: Vec<String> = files
        .iter()
        .flat_map(|file| file.faults(is_test(file)))
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Faults of a file that would stand at a path.
fn faults(path: &str, text: &str) -> Vec<String> {
    let file = File {
        path: path.to_owned(),
        text: text.to_owned(),
    };
    file.faults(false)
}

#[test]
fn imports_from_below_are_found() {
    for text in [
        "use crate::relight::Frame;",
        "use crate::{frame::Image, relight::{self, Frame}};",
        "pub(crate) use crate::{\n    maths::hash,\n    relight::Frame,\n};",
        "fn f() { crate::relight::draw(); }",
        "fn f() -> Vec<crate::relight::Frame> { vec![] }",
        "use super::super::relight::Frame;",
        "mod inner { use super::super::super::relight::Frame; }",
        "use crate::nowhere::Thing;",
    ] {
        let found = faults("bake/rows.rs", text);
        assert_eq!(found.len(), 1, "{text:?} gives {found:?}");
    }
    let found = faults("bake/mod.rs", "use super::relight::Frame;");
    assert_eq!(found.len(), 1, "a room's mod.rs: {found:?}");
    let found = faults("elsewhere/mod.rs", "use crate::bake::Bake;");
    assert_eq!(found.len(), 1, "a room that is not in the order: {found:?}");
}

#[test]
fn imports_from_above_and_words_without_meaning_pass() {
    for text in [
        "use crate::surface::{Surface, direct};",
        "use crate::{maths::hash, simd::Level as Width};",
        "// use crate::relight::Frame;\n/* crate::relight /* nested */ crate::output */",
        "//! crate::relight::Frame\nfn f() { let text = \"crate::relight::Frame \\\" unsafe\"; }",
        "fn f() { let text = r#\"crate::relight \" obvhs::Bvh2\"#; let c = '\"'; let d = '\\''; }",
        "fn f<'a>(x: &'a str) -> &'a str { x } // 'crate::relight",
        "use super::graph::VertexGraph;",
        "use self::image::Image;\nmod image;",
        "use crate::frame::{image::Image};",
        "#[cfg(test)]\nmod tests { use crate::relight::Frame; }",
        "fn f(toml: &str, image: usize) -> usize { toml.len() + image }",
    ] {
        let found = faults("bake/rows.rs", text);
        assert!(found.is_empty(), "{text:?} gives {found:?}");
    }
}

#[test]
fn code_behind_a_test_module_is_judged_again() {
    let text = "#[cfg(test)]\nmod tests { fn f() { { } } }\nuse crate::relight::Frame;";
    assert_eq!(
        faults("bake/rows.rs", text),
        ["src/bake/rows.rs:3: bake imports from relight, which stands below"],
        "the module of tests ends at its brace"
    );
}

#[test]
fn dependencies_and_unsafe_stay_where_they_belong() {
    for (text, owner) in [
        ("use obvhs::cwbvh::CwBvh;", "surface/rays.rs"),
        ("fn f(m: &tobj::Mesh) {}", "scene/obj/mod.rs"),
        ("use toml::{Spanned, de};", "scene/file/tree.rs"),
        ("use image::codecs::png::PngDecoder;", "output/png.rs"),
        ("use ::image::DynamicImage;", "output/png.rs"),
        ("use clap::Parser;", "cli/args.rs"),
        ("use {indicatif::ProgressBar};", "cli/run.rs"),
        ("fn f() { libm::sin(1.0); }", "maths/functions.rs"),
        ("fn f() { unsafe { g() } }", "simd/lanes.rs"),
    ] {
        let found = faults(owner, text);
        assert!(found.is_empty(), "{text:?} in {owner} gives {found:?}");
        let found = faults("relight/shade.rs", text);
        assert_eq!(found.len(), 1, "{text:?} in relight gives {found:?}");
    }
}

#[test]
fn the_binary_sees_only_the_public_api() {
    for path in ["main.rs", "cli/render.rs"] {
        let found = faults(path, "use relume::Scene;\nuse crate::cli::error::CliError;");
        assert!(found.is_empty(), "{path}: {found:?}");
        let found = faults(path, "use crate::scene::Scene;");
        assert_eq!(found.len(), 1, "{path}: {found:?}");
    }
    assert!(
        faults("lib.rs", "pub use crate::relight::Frame;").is_empty(),
        "lib.rs names every room"
    );
}

#[test]
fn files_of_tests_are_found_by_their_declaration() {
    let text = "mod rows;\n#[cfg(test)]\n#[path = \"x\"]\nmod tests;\n#[cfg(test)]\nmod inline {}";
    assert_eq!(test_files(text), ["tests"], "only one is a file of tests");
}
