//! The pictures of the small scenes, compared with `golden/` to the bit.
//!
//! A golden says that a picture is as it was, and a number beside it that the
//! picture was right: its mean, and its error against paths traced in the test.
//! `RELUME_UPDATE_GOLDEN=1 cargo test --test golden -- --nocapture` writes the
//! goldens anew, measures each against `relume reference`, prints the table for
//! the commit's message, and fails, so that it cannot pass unnoticed.

mod program;

use std::fs;
use std::path::{Path, PathBuf};

use glam::Vec3;
use program::{relume, scene, succeed, temporary_folder};
use relume::reference::{ReferenceSettings, trace};
use relume::{
    Component, EncodedImage, Frame, FrameSettings, Image, LoadedImage, Override, Picture, Renderer,
    RunSettings, Scene, Tone, compare, develop, read_image, write_picture,
};

/// Environment variable that makes the test write the goldens.
const UPDATE: &str = "RELUME_UPDATE_GOLDEN";
/// Large enough for every feature of the scenes, small enough for a repository.
const SIZE: &str = "160x120";
/// Rays a vertex: all pictures together take seconds. The errors below are of
/// these reduced bakes; a bake with the default keys is several times closer.
const RAYS: &str = "bake.rays=128";
/// Side of the blocks over which noise and edges are averaged out, pixels.
const BLOCK: u32 = 8;
/// Paths a pixel that a test traces. On the box they leave 11 % of noise a pixel,
/// thus 1.3 % a block of 64 pixels, and less on the other scenes; the bits of the
/// paths are as fixed as the picture's, so no run is unlucky.
const PATHS: u32 = 16;
/// Paths a pixel of the table for the commit: 0.3 % of noise a block.
const PATHS_OF_TABLE: &str = "256";

/// A scene with its reduced bake and what is known of its picture.
struct Case {
    /// Folder and name of the scene file.
    folder: &'static str,
    name: &'static str,
    /// Longest edge of the reduced bake, scene units.
    max_edge: &'static str,
    /// Mean of all channels of all pixels, W/(m2 sr): the measured mean with
    /// 3 % to either side, far more than a change of sampling moves it and less
    /// than one lost bounce.
    mean: [f64; 2],
    /// Largest relative error of block means against the paths that the test
    /// traces: measured 0.019, 0.012, 0.021, 0.005, 0.004, 0.010, 0.019, 0.029 and
    /// 0.050 in the order below, the paths' own noise included, and half as much
    /// again, so that another sampling passes. A picture without its indirect light
    /// is off by 0.11 (the plank, where most light is direct) to 0.49 (the window).
    block_error: f64,
}

const CORNELL: Case = Case {
    folder: "cornell",
    name: "cornell",
    max_edge: "bake.max_edge=0.2",
    mean: [0.285, 0.302],
    block_error: 0.03,
};
const WINDOW: Case = Case {
    folder: "window",
    name: "window",
    max_edge: "bake.max_edge=0.25",
    mean: [0.261, 0.277],
    block_error: 0.02,
};
const SHEET: Case = Case {
    folder: "sheet",
    name: "sheet",
    max_edge: "bake.max_edge=0.2",
    mean: [0.125, 0.133],
    block_error: 0.03,
};
const PLANK: Case = Case {
    folder: "plank",
    name: "plank",
    max_edge: "bake.max_edge=0.2",
    mean: [0.2075, 0.2204],
    block_error: 0.01,
};
const SPHERE: Case = Case {
    folder: "sphere",
    name: "sphere",
    max_edge: "bake.max_edge=0.4",
    mean: [0.458, 0.486],
    block_error: 0.007,
};

const PANEL: Case = Case {
    folder: "cornell",
    name: "panel",
    max_edge: "bake.max_edge=0.2",
    mean: [0.2082, 0.2210],
    block_error: 0.015,
};
const DAY: Case = Case {
    folder: "window",
    name: "day",
    max_edge: "bake.max_edge=0.25",
    mean: [0.0490, 0.0520],
    block_error: 0.03,
};
const COURTYARD: Case = Case {
    folder: "courtyard",
    name: "courtyard",
    max_edge: "bake.max_edge=0.9",
    mean: [0.3233, 0.3433],
    block_error: 0.045,
};
const EVENING: Case = Case {
    folder: "courtyard",
    name: "evening",
    max_edge: "bake.max_edge=0.9",
    mean: [0.1770, 0.1879],
    block_error: 0.075,
};

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

/// Draws the scene and checks its numbers, then its golden.
fn check(case: &Case) -> Image {
    let scene = case.scene();
    let (exposure, tone) = (scene.render.exposure, scene.render.tone);
    let traced = traced(&scene);
    let frame = drawn(scene);
    let levels = frame.develop(exposure, tone);
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        let picture = Picture {
            linear: &frame.image,
            encoded: &levels,
        };
        make_folder_of(&case.golden());
        write_picture(&case.golden(), picture).expect("the golden can be written");
        panic!(
            "written anew, look at it: {}\n{}",
            case.golden().display(),
            case.table_row()
        );
    }
    case.check_numbers(&frame.image, &traced);
    case.check_golden(&levels);
    frame.image
}

/// The scene's frame, without a cache.
fn drawn(scene: Scene) -> Frame {
    let settings = FrameSettings::of_scene(&scene);
    Renderer::new(scene, None)
        .frame(&settings, &RunSettings::silent())
        .expect("the scene can be drawn")
}

/// The same picture by few paths.
fn traced(scene: &Scene) -> Image {
    let settings = ReferenceSettings {
        camera: scene.camera,
        bounces: scene.render.bounces,
        samples: PATHS,
        seed: 1,
        direct: true,
    };
    let reference = trace(scene, &settings, &RunSettings::silent());
    reference.expect("nobody stops the paths").image
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
    fn keys(&self) -> [&'static str; 2] {
        [self.max_edge, RAYS]
    }

    fn scene(&self) -> Scene {
        let set = |text: &str| Override::parse(text).expect("the override is valid");
        let mut overrides = self.keys().map(set).to_vec();
        let size = SIZE.replace('x', ",");
        overrides.push(set(&format!("camera.size=[{size}]")));
        Scene::load(&self.file(), &overrides).expect("the scene can be loaded")
    }

    fn file(&self) -> PathBuf {
        scene(self.folder).with_file_name(format!("{}.toml", self.name))
    }

    /// What the case is called in the golden's name and in messages.
    fn label(&self) -> String {
        if self.name == self.folder {
            self.name.to_owned()
        } else {
            format!("{}-{}", self.folder, self.name)
        }
    }

    fn golden(&self) -> PathBuf {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
        folder.join(format!("{}.png", self.label()))
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

    fn check_golden(&self, levels: &EncodedImage) {
        let golden = read_image(&self.golden()).unwrap_or_else(|error| {
            panic!("{error}; {UPDATE}=1 writes the golden");
        });
        let actual = linear_of_levels(levels);
        let expected = golden.to_linear();
        if expected.pixels() == actual.pixels() {
            return;
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let path = folder.join(format!("{}-expected-difference-actual.png", self.label()));
        match triptych(&golden, levels) {
            Err(mismatch) => panic!("{}: {mismatch}", self.label()),
            Ok((picture, most)) => {
                write_levels(&path, &picture);
                panic!(
                    "{}: the picture is not its golden, levels differ by up to {most}; look at {}",
                    self.label(),
                    path.display()
                );
            }
        }
    }

    /// The golden's error against many paths, as the commands measure it.
    fn table_row(&self) -> String {
        let folder = temporary_folder();
        let [truth, candidate] = ["truth.exr", "candidate.exr"].map(|n| folder.path().join(n));
        let keys = self.keys().map(|key| ["--set", key]).concat();
        let command = |name: &str, output: &Path| {
            let mut command = relume(&[name, "--size", SIZE]);
            command.arg(self.file()).args(&keys).arg("-o").arg(output);
            command
        };
        succeed(command("reference", &truth).args(["--spp", PATHS_OF_TABLE]));
        succeed(command("render", &candidate).arg("--no-cache"));
        let mut diff = relume(&["diff", "--json", "--max-differing-pixels", "100%"]);
        let report = succeed(diff.arg(&truth).arg(&candidate)).json();
        let percent = |key: &str| report[key].as_f64().unwrap_or(f64::NAN) * 100.0;
        format!(
            "{:14} relRMSE 8x8 {:.2} %, bias {:+.2} %",
            self.label(),
            percent("relative_rmse_8x8"),
            percent("bias")
        )
    }
}

/// Levels as the linear values that they stand for: equal if the levels are.
fn linear_of_levels(levels: &EncodedImage) -> Image {
    LoadedImage::Levels(image_of_levels(levels)).to_linear()
}

fn image_of_levels(levels: &EncodedImage) -> Image {
    let (triples, _) = levels.bytes().as_chunks::<3>();
    let pixels = triples.iter().map(|rgb| Vec3::from(rgb.map(f32::from)));
    Image::new(levels.width(), levels.height(), pixels.collect()).expect("levels fill their size")
}

/// Expected, difference (from grey, four times as large) and actual levels side
/// by side, and the largest difference.
fn triptych(golden: &LoadedImage, actual: &EncodedImage) -> Result<(Image, f64), String> {
    let (expected, actual) = (golden.values(), image_of_levels(actual));
    let difference = compare(expected, &actual).map_err(|mismatch| mismatch.to_string())?;
    let (width, height) = (expected.width() as usize, expected.height());
    let mut pixels = Vec::with_capacity(3 * expected.pixels().len());
    let rows = expected
        .pixels()
        .chunks(width)
        .zip(actual.pixels().chunks(width));
    for (left, right) in rows {
        pixels.extend_from_slice(left);
        let apart = |(a, b): (&Vec3, &Vec3)| {
            ((*b - *a) * 4.0 + 128.0).clamp(Vec3::ZERO, Vec3::splat(255.0))
        };
        pixels.extend(left.iter().zip(right).map(apart));
        pixels.extend_from_slice(right);
    }
    let picture = Image::new(3 * expected.width(), height, pixels).map_err(|e| e.to_string())?;
    Ok((picture, difference.max_channel))
}

fn make_folder_of(path: &Path) {
    let folder = path.parent().expect("a picture lies in a folder");
    fs::create_dir_all(folder).expect("the folder can be made");
}

/// Writes levels as they are: decoding and encoding keeps every level.
fn write_levels(path: &Path, levels: &Image) {
    make_folder_of(path);
    let linear = LoadedImage::Levels(levels.clone()).to_linear();
    let encoded = develop(&linear, Component::Albedo, 0.0, Tone::Srgb);
    let picture = Picture {
        linear: &linear,
        encoded: &encoded,
    };
    write_picture(path, picture).expect("the difference can be written");
}
