//! The program whose digests are taken: the one built beside the tests, or what
//! `RELUME_PROGRAM` names, such as `qemu-x86_64 -cpu Nehalem target/x/relume`.

use std::path::Path;
use std::process::Command;

use crate::program::{only_bake, run, scene, succeed};
use crate::table::Row;

/// Environment variable with the program and what runs it, split at spaces.
pub(crate) const PROGRAM: &str = "RELUME_PROGRAM";
/// Environment variable: `one` run with everything at its default, for emulators;
/// with `all`, each of the runs makes the bake too, which takes minutes.
const RUNS: &str = "RELUME_DIGEST_RUNS";

const THREADS: [&str; 4] = ["1", "2", "3", "8"];
const LEVELS: [&str; 3] = ["scalar", "sse2", "avx2"];
/// Large enough for every light of a scene to reach some pixels.
const SIZE: &str = "64x48";
const RAYS: &str = "bake.rays=64";

/// A mesh in a reduced bake, and the scenes that are drawn from it.
pub(crate) struct Mesh {
    /// Name of the folder in `scenes/`.
    pub(crate) folder: &'static str,
    /// Longest edge of the reduced bake, scene units.
    pub(crate) max_edge: &'static str,
    /// Frames: the name in the table, and the scene's file without `.toml`.
    pub(crate) frames: &'static [(&'static str, &'static str)],
    /// Otherwise each level makes it with another number of threads.
    pub(crate) every_run_bakes: bool,
}

/// Threads and instructions of a run.
pub(crate) struct Run {
    pub(crate) arguments: Vec<&'static str>,
    /// Whether it makes the bake, or takes that of the first run.
    pub(crate) bakes: bool,
}

/// Every level that the program takes with every number of threads.
pub(crate) fn runs(mesh: &Mesh) -> Vec<Run> {
    let every_run_bakes = match std::env::var(RUNS).as_deref() {
        Ok("one") => {
            return vec![Run {
                arguments: vec![],
                bakes: true,
            }];
        }
        Ok("all") => true,
        Ok("") | Err(_) => mesh.every_run_bakes,
        Ok(other) => panic!("{RUNS} is one or all: {other:?}"),
    };
    let levels = LEVELS.into_iter().filter(|level| takes(level));
    let of_level = |(place, level)| {
        THREADS
            .into_iter()
            .enumerate()
            .map(move |(index, threads)| Run {
                arguments: vec!["--threads", threads, "--simd", level],
                bakes: every_run_bakes || index == place,
            })
    };
    levels.enumerate().flat_map(of_level).collect()
}

/// Whether the program takes a level here.
pub(crate) fn takes(level: &str) -> bool {
    let finished =
        run(program(&["render", "x.toml", "-o", "x.png", "--simd", level]).arg("--help"));
    assert!(
        finished.exit_code == Some(0) || finished.stderr.contains("this processor has no"),
        "{level} is taken, or refused for the processor: {finished:#?}"
    );
    finished.exit_code == Some(0)
}

fn program(arguments: &[&str]) -> Command {
    let words = std::env::var(PROGRAM).unwrap_or_default();
    let mut words = words.split_whitespace();
    let mut command = match words.next() {
        Some(first) => Command::new(first),
        None => Command::new(env!("CARGO_BIN_EXE_relume")),
    };
    command.args(words).args(arguments);
    command
}

impl Mesh {
    /// Every frame from the bake in a folder, which the first frame makes where
    /// the run bakes.
    pub(crate) fn rows(&self, run: &Run, folder: &Path) -> Vec<(String, Row)> {
        let mut expected_cache = if run.bakes { "miss" } else { "hit" };
        let mut draw = |file: &str, picture: &str| {
            let report = succeed(&mut self.render(folder, file, picture, run)).json();
            let text = |key: &str| report[key].as_str().unwrap_or_default().to_owned();
            let arguments = &run.arguments;
            assert_eq!(text("cache"), expected_cache, "{file} {arguments:?}");
            expected_cache = "hit";
            text("digest")
        };
        let drawn: Vec<[String; 2]> = (self.frames.iter())
            .map(|(_, file)| ["frame.exr", "frame.png"].map(|picture| draw(file, picture)))
            .collect();
        let bake = std::fs::read(only_bake(&folder.join("cache"))).expect("there is a bake");
        let bake = blake3::hash(&bake).to_hex()[..32].to_owned();
        let frames = self.frames.iter().zip(drawn);
        frames
            .map(|((name, _), [linear, levels])| {
                let bake = bake.clone();
                let row = Row {
                    linear,
                    levels,
                    bake,
                };
                ((*name).to_owned(), row)
            })
            .collect()
    }

    fn render(&self, folder: &Path, file: &str, picture: &str, run: &Run) -> Command {
        let mut command = program(&["render", "--json", "--size", SIZE, "--set", RAYS]);
        command
            .args(["--set", &format!("bake.max_edge={}", self.max_edge)])
            .arg(scene(self.folder).with_file_name(format!("{file}.toml")))
            .arg("-o")
            .arg(folder.join(picture))
            .arg("--cache-dir")
            .arg(folder.join("cache"))
            .args(&run.arguments);
        command
    }
}
