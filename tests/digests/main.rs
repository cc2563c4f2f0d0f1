//! One digest for each frame and each bake, whatever drew it: the table
//! `golden/digests.txt` against threads, levels of instructions, a cold and a warm
//! cache, and, through `.ci/same-bits`, other builds and processors.
//!
//! `RELUME_UPDATE_DIGESTS=1 cargo test --test digests -- --include-ignored` writes
//! the table anew and fails, so that it cannot pass unnoticed. That a picture is
//! right is the business of `tests/golden.rs`; here it only has to be the same.

#[path = "../program/mod.rs"]
mod program;
mod program_under_test;
mod table;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use program_under_test::{Mesh, PROGRAM, Run, runs, takes};

/// Point light in a closed box; and a rectangle.
const CORNELL: Mesh = Mesh {
    folder: "cornell",
    max_edge: "0.5",
    frames: &[("cornell", "cornell"), ("cornell-panel", "panel")],
    every_run_bakes: false,
};
/// The box with some 300 vertices, for a program without optimisation.
const TINY: Mesh = Mesh {
    folder: "cornell",
    max_edge: "0.9",
    frames: &[("tiny", "cornell")],
    every_run_bakes: true,
};
/// A lamp in a room; and sun and sky through a small opening.
const WINDOW: Mesh = Mesh {
    folder: "window",
    max_edge: "0.5",
    frames: &[("window", "window"), ("window-day", "day")],
    every_run_bakes: false,
};
/// Two sides of one sheet.
const SHEET: Mesh = Mesh {
    folder: "sheet",
    max_edge: "0.5",
    frames: &[("sheet", "sheet")],
    every_run_bakes: false,
};
/// A spot and parallel light, in the open.
const PLANK: Mesh = Mesh {
    folder: "plank",
    max_edge: "0.5",
    frames: &[("plank", "plank")],
    every_run_bakes: false,
};
const SPHERE: Mesh = Mesh {
    folder: "sphere",
    max_edge: "0.8",
    frames: &[("sphere", "sphere")],
    every_run_bakes: false,
};
/// Textures, an emission map, the sun and a constant sky; and a map of the sky
/// with a sun of its own.
const COURTYARD: Mesh = Mesh {
    folder: "courtyard",
    max_edge: "2",
    frames: &[("courtyard", "courtyard"), ("courtyard-evening", "evening")],
    every_run_bakes: false,
};
/// Lobes and slices, a point light and a rectangle.
const GLOSSY: Mesh = Mesh {
    folder: "glossy",
    max_edge: "0.6",
    frames: &[("glossy", "glossy")],
    every_run_bakes: false,
};
/// The size that the method was published with.
const STATUES: Mesh = Mesh {
    folder: "statues",
    max_edge: "2",
    frames: &[("statues", "statues")],
    every_run_bakes: false,
};
const MESHES: [&Mesh; 9] = [
    &CORNELL, &TINY, &WINDOW, &SHEET, &PLANK, &SPHERE, &COURTYARD, &GLOSSY, &STATUES,
];

#[test]
fn cornell() {
    check(&CORNELL);
}

#[test]
fn tiny() {
    check(&TINY);
}

#[test]
fn window() {
    check(&WINDOW);
}

#[test]
fn sheet() {
    check(&SHEET);
}

#[test]
fn plank() {
    check(&PLANK);
}

#[test]
fn sphere() {
    check(&SPHERE);
}

#[test]
fn courtyard() {
    check(&COURTYARD);
}

#[test]
fn glossy() {
    check(&GLOSSY);
}

#[test]
#[ignore = "some 58,000 vertices: a minute a run"]
fn statues() {
    check(&STATUES);
}

/// Draws the mesh's frames in every run and compares them with the table.
fn check(mesh: &Mesh) {
    let runs = runs(mesh);
    let first_folder = program::temporary_folder();
    if std::env::var_os(table::UPDATE).is_some_and(|value| value == "1") {
        let found = mesh.rows(&runs[0], first_folder.path());
        table::write(&found);
        panic!("written anew, look at the difference: {found:#?}");
    }
    let expected = table::rows();
    let compare = |run: &Run, folder: &Path| {
        for (name, found) in mesh.rows(run, folder) {
            assert_eq!(
                Some(&found),
                expected.get(&name),
                "{name} {:?}: other bits (left) than golden/digests.txt has (right); if they are \
                 meant to be, {}=1 writes them",
                run.arguments,
                table::UPDATE
            );
        }
    };
    for (index, run) in runs.iter().enumerate() {
        if run.bakes && index > 0 {
            compare(run, program::temporary_folder().path());
        } else {
            compare(run, first_folder.path());
        }
    }
}

#[test]
fn every_scene_is_in_the_table() {
    let frames = MESHES
        .iter()
        .flat_map(|mesh| mesh.frames.iter().map(move |f| (mesh, f)));
    let drawn: BTreeSet<_> = frames
        .map(|(mesh, (_, file))| format!("{}/{file}.toml", mesh.folder))
        .collect();
    assert_eq!(drawn, scene_files(), "frames of this test, and scene files");
    let names = MESHES
        .iter()
        .flat_map(|mesh| mesh.frames)
        .map(|(name, _)| (*name).to_owned());
    let rows = table::rows();
    assert_eq!(
        names.collect::<BTreeSet<_>>(),
        rows.keys().cloned().collect(),
        "frames of this test, and lines of the table"
    );
    let pictures: BTreeSet<_> = rows.values().map(|row| &row.linear).collect();
    assert_eq!(pictures.len(), rows.len(), "no two frames are alike");
}

/// Scene files as folder and file, with `/` between.
fn scene_files() -> BTreeSet<String> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let below = |folder: &Path| -> Vec<_> {
        let entries = fs::read_dir(folder).into_iter().flatten();
        entries
            .map(|entry| entry.expect("a folder's entry").path())
            .collect()
    };
    let files = below(&scenes).into_iter().flat_map(|folder| below(&folder));
    files
        .filter(|file| file.extension().is_some_and(|e| e == "toml"))
        .map(|file| {
            let inside = file.strip_prefix(&scenes).expect("a file of scenes");
            inside.to_string_lossy().replace('\\', "/")
        })
        .collect()
}

/// Otherwise a level that is lost would never be missed.
#[test]
fn every_level_of_this_processor_is_compared() {
    assert!(takes("scalar"), "every processor has the scalar level");
    if std::env::var_os(PROGRAM).is_some() {
        return;
    }
    #[cfg(target_arch = "x86_64")]
    for (level, is_here) in [
        ("sse2", true),
        ("avx2", std::arch::is_x86_feature_detected!("avx2")),
    ] {
        assert_eq!(takes(level), is_here, "{level}");
    }
}
