//! The project's own scenes against their goldens, to the bit, and against what
//! is known of their light.
//!
//! A golden says that a picture is as it was, and a number beside it that the
//! picture was right: its mean, and its error against paths traced in the test.
//! `relume golden bless scenes` writes the goldens anew; so does
//! `RELUME_BLESS=1 cargo test --test golden`, which fails then. The numbers for
//! the commit's message are printed by
//! `cargo test --test golden -- --ignored --nocapture`.

mod program;

use std::path::{Path, PathBuf};

use glam::Vec3;
use program::{relume, scene, succeed, temporary_folder};
use relume::golden::{DrawSettings, Drawn, find};
use relume::reference::{GlossyBounces, ReferencePart, ReferenceSettings, trace};
use relume::{Image, RunSettings, Scene, compare};

/// Side of the blocks over which noise and edges are averaged out, pixels.
const BLOCK: u32 = 8;
/// Paths a pixel that a test traces. On the box they leave 11 % of noise a pixel,
/// thus 1.3 % a block of 64 pixels, and less on the other scenes; the bits of the
/// paths are as fixed as the picture's, so no run is unlucky.
const PATHS: u32 = 16;
/// Paths a pixel of the table for the commit: 0.3 % of noise a block.
const PATHS_OF_TABLE: &str = "256";

/// A scene and what is known of the picture with which its golden is drawn: of
/// the reduced bake that its `[golden]` sets, which takes part of a second; a
/// bake with the default keys is several times closer.
struct Case {
    /// Folder and name of the scene file.
    folder: &'static str,
    name: &'static str,
    /// Mean of all channels of all pixels, W/(m2 sr): the measured mean with
    /// 3 % to either side, far more than a change of sampling moves it and less
    /// than one lost bounce.
    mean: [f64; 2],
    /// Largest relative error of block means against the paths that the test
    /// traces: measured 0.019, 0.012, 0.021, 0.005, 0.004, 0.010, 0.019, 0.029,
    /// 0.050, 0.013 and 0.004 in the order below, the paths' own noise included,
    /// and half as much again, so that another sampling passes. A picture without
    /// its indirect light is off by 0.11 (the plank, where most light is direct)
    /// to 0.49 (the window).
    block_error: f64,
}

const CORNELL: Case = Case {
    folder: "cornell",
    name: "cornell",
    mean: [0.285, 0.302],
    block_error: 0.03,
};
const WINDOW: Case = Case {
    folder: "window",
    name: "window",
    mean: [0.261, 0.277],
    block_error: 0.02,
};
const SHEET: Case = Case {
    folder: "sheet",
    name: "sheet",
    mean: [0.125, 0.133],
    block_error: 0.03,
};
const PLANK: Case = Case {
    folder: "plank",
    name: "plank",
    mean: [0.2075, 0.2204],
    block_error: 0.01,
};
const SPHERE: Case = Case {
    folder: "sphere",
    name: "sphere",
    mean: [0.458, 0.486],
    block_error: 0.007,
};
const PANEL: Case = Case {
    folder: "cornell",
    name: "panel",
    mean: [0.2082, 0.2210],
    block_error: 0.015,
};
const DAY: Case = Case {
    folder: "window",
    name: "day",
    mean: [0.0490, 0.0520],
    block_error: 0.03,
};
const COURTYARD: Case = Case {
    folder: "courtyard",
    name: "courtyard",
    mean: [0.3233, 0.3433],
    block_error: 0.045,
};
const EVENING: Case = Case {
    folder: "courtyard",
    name: "evening",
    mean: [0.1770, 0.1879],
    block_error: 0.075,
};
/// Lobes: those of the paths reflect at all bounces.
const GLOSSY: Case = Case {
    folder: "glossy",
    name: "glossy",
    mean: [0.308, 0.327],
    block_error: 0.02,
};
/// Direct light alone.
const STATUES: Case = Case {
    folder: "statues",
    name: "statues",
    mean: [0.2019, 0.2144],
    block_error: 0.007,
};
const CASES: [&Case; 11] = [
    &CORNELL, &WINDOW, &SHEET, &PLANK, &SPHERE, &PANEL, &DAY, &COURTYARD, &EVENING, &GLOSSY,
    &STATUES,
];

#[test]
fn cornell() {
    check(&CORNELL);
}

#[test]
fn window() {
    check(&WINDOW);
}

#[test]
fn sheet() {
    let frame = check(&SHEET);
    let right = (112..160).flat_map(|x| (0..120).map(move |y| (x, y)));
    let light = right.filter_map(|(x, y)| frame.pixel(x, y));
    let lit = light.filter(|&l| l != Vec3::ZERO).count();
    assert_eq!(lit, 0, "no light comes through the sheet");
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
fn panel() {
    check(&PANEL);
}

#[test]
fn day() {
    check(&DAY);
}

#[test]
fn courtyard() {
    check(&COURTYARD);
}

#[test]
fn evening() {
    check(&EVENING);
}

#[test]
fn glossy() {
    check(&GLOSSY);
}

#[test]
fn statues() {
    check(&STATUES);
}

/// A scene that no case names would be compared by nothing but its golden.
#[test]
fn every_scene_has_a_golden_and_a_case() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let suite = find(&[scenes]).expect("the scenes can be listed");
    for scene in &suite.scenes {
        let file = scene.scene();
        assert!(scene.has_golden(), "{} has no golden", file.display());
        let is_known = CASES.iter().any(|case| case.file().ends_with(file));
        assert!(is_known, "{} has no case here", file.display());
    }
    assert_eq!(
        suite.without_scene,
        [] as [PathBuf; 0],
        "goldens without a scene"
    );
    assert_eq!(suite.scenes.len(), CASES.len(), "cases without a scene");
}

#[test]
#[ignore = "prints the table for a commit that blesses goldens; takes minutes"]
#[allow(clippy::print_stdout, reason = "the table is what this test is for")]
fn table_for_the_commit() {
    let rows: Vec<String> = CASES.iter().map(|case| case.table_row()).collect();
    println!("{}", rows.join("\n"));
}

/// Draws the scene and checks its numbers, then its golden.
fn check(case: &Case) -> Image {
    let run = RunSettings::silent();
    let drawn = Drawn::of(&case.file(), &DrawSettings::default(), &run);
    let drawn = drawn.expect("the scene can be drawn");
    case.check_numbers(&drawn.frame.image, &case.traced());
    let failures = Path::new(env!("CARGO_TARGET_TMPDIR"));
    if let Err(error) = drawn.check(&case.file(), failures) {
        panic!("{error:?}");
    }
    drawn.frame.image
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image
        .pixels()
        .iter()
        .map(|p| f64::from(p.element_sum()))
        .sum();
    sum / (3.0 * image.pixels().len() as f64)
}

impl Case {
    fn file(&self) -> PathBuf {
        scene(self.folder).with_file_name(format!("{}.toml", self.name))
    }

    fn label(&self) -> String {
        format!("{}/{}", self.folder, self.name)
    }

    fn scene(&self) -> Scene {
        Scene::load_for_golden(&self.file(), &[]).expect("the scene can be loaded")
    }

    /// The same picture by few paths.
    fn traced(&self) -> Image {
        let scene = self.scene();
        let settings = ReferenceSettings {
            camera: scene.camera,
            bounces: scene.render.bounces,
            samples: PATHS,
            seed: 1,
            part: ReferencePart::Global,
            glossy: GlossyBounces::All,
        };
        let reference = trace(&scene, &settings, &RunSettings::silent());
        reference.expect("nobody stops the paths").image
    }

    fn check_numbers(&self, image: &Image, traced: &Image) {
        let mean = mean(image);
        let blocks = compare(&traced.block_means(BLOCK), &image.block_means(BLOCK))
            .expect("both have the scene's size");
        let error = blocks.relative_rmse;
        let [least, most] = self.mean;
        assert!(
            (least..=most).contains(&mean) && error <= self.block_error,
            "{}: the mean is {mean:.5}, allowed are {least} to {most}; \
             blocks are off by {error:.4} of the traced picture, allowed are {}",
            self.label(),
            self.block_error
        );
    }

    /// The error of the golden's frame against many paths, as the commands
    /// measure it.
    fn table_row(&self) -> String {
        let folder = temporary_folder();
        let [truth, candidate] = ["truth.exr", "candidate.exr"].map(|n| folder.path().join(n));
        let keys = self.scene().golden.set;
        let command = |name: &str, output: &Path| {
            let mut command = relume(&[name]);
            command.arg(self.file()).arg("-o").arg(output);
            for key in &keys {
                command.args(["--set", key]);
            }
            command
        };
        succeed(command("reference", &truth).args(["--spp", PATHS_OF_TABLE]));
        succeed(command("render", &candidate).arg("--no-cache"));
        let mut diff = relume(&["diff", "--json", "--max-differing-pixels", "100%"]);
        let report = succeed(diff.arg(&truth).arg(&candidate)).json();
        let percent = |key: &str| report[key].as_f64().unwrap_or(f64::NAN) * 100.0;
        format!(
            "{:20} relRMSE 8x8 {:.2} %, bias {:+.2} %",
            self.label(),
            percent("relative_rmse_8x8"),
            percent("bias")
        )
    }
}
