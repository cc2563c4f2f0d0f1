//! Components of a frame, and that they add up.

use std::path::Path;

use glam::Vec3;
use relume::{Image, read_image};

use crate::program::{relume, render_box, render_box_command, scene, succeed, temporary_folder};

/// Largest |direct + indirect - global| of a channel, W/(m2 sr): the contract's
/// number. The sums differ in the order of their roundings alone, which leaves
/// some 1e-7 on radiances of about 1.
const SUM_TOLERANCE: f32 = 1e-5;
/// A normal is the mean over a pixel, so it is at most of length 1.
const ROUNDING: f32 = 1e-5;

/// The constant is in every partition's basis, so means over the vertices stay;
/// the camera sees vertices with other weights, and what is negative is shown
/// as zero. With edges of 0.2 m the mean is off by 0.004, of 0.5 m (four to a
/// wall) by 0.16.
const MEAN_KEPT: f64 = 0.02;

/// A component of the small box, as linear values.
fn component(folder: &Path, name: &str, arguments: &[&str]) -> Image {
    let picture = format!("{name}.exr");
    let arguments = [&["--component", name], arguments].concat();
    succeed(&mut render_box_command(folder, &picture, &arguments));
    let loaded = read_image(&folder.join(picture)).expect("the frame can be read");
    loaded.values().clone()
}

fn largest(image: &Image) -> f32 {
    image.pixels().iter().fold(0.0, |largest, p| {
        assert!(p.is_finite(), "a pixel is {p}");
        p.max_element().clamp(largest, f32::INFINITY)
    })
}

/// Largest |direct + indirect - global| of a channel.
fn largest_gap(folder: &Path, arguments: &[&str]) -> f32 {
    let [direct, indirect, global] =
        ["direct", "indirect", "global"].map(|name| component(folder, name, arguments));
    for (name, image) in [("direct", &direct), ("indirect", &indirect)] {
        assert!(largest(image) > 0.01, "{name} is black with {arguments:?}");
    }
    let parts = direct.pixels().iter().zip(indirect.pixels());
    parts
        .zip(global.pixels())
        .map(|((&d, &i), &g)| (d + i - g).abs())
        .fold(0.0, |largest, gap| {
            assert!(gap.is_finite(), "a gap is {gap}");
            gap.max_element().clamp(largest, f32::INFINITY)
        })
}

#[test]
fn they_add_up_with_lamps_textures_and_sky() {
    let folder = temporary_folder();
    let evening = scene("courtyard").with_file_name("evening.toml");
    let cache = folder.path().join("cache");
    let part = |name: &str| {
        let path = folder.path().join(format!("{name}.exr"));
        let mut command = relume(&["render"]);
        command.arg(&evening).arg("-o").arg(&path);
        command.arg("--cache-dir").arg(&cache);
        command.args(["--set", "bake.max_edge=2", "--set", "bake.rays=64"]);
        command.args(["--size", "64x48", "--component", name]);
        succeed(&mut command);
        let loaded = read_image(&path).expect("the frame can be read");
        loaded.values().clone()
    };
    let [direct, indirect, global] = ["direct", "indirect", "global"].map(part);
    assert!(largest(&direct) > 1.0, "the lantern is not seen");
    assert!(largest(&indirect) > 0.01, "no light bounces");
    let scale = largest(&global);
    for ((d, i), g) in direct
        .pixels()
        .iter()
        .zip(indirect.pixels())
        .zip(global.pixels())
    {
        let gap = (*d + *i - *g).abs().max_element();
        assert!(
            gap <= SUM_TOLERANCE * scale.clamp(1.0, f32::INFINITY),
            "the sum is off by {gap}"
        );
    }
}

#[test]
fn direct_and_indirect_add_up_to_global() {
    let folder = temporary_folder();
    for arguments in [
        &["--bounces", "1"][..],
        &["--bounces", "4"],
        &["--bounces", "all"],
        &["--set", "light.lamp.intensity=[0.9,0,0.1]"],
        &["--quality", "gather"],
    ] {
        let gap = largest_gap(folder.path(), arguments);
        assert!(
            gap <= SUM_TOLERANCE,
            "the sum is off by {gap} with {arguments:?}"
        );
    }
}

#[test]
fn without_bounces_there_is_direct_light_alone() {
    let folder = temporary_folder();
    let none = ["--bounces", "0"];
    let indirect = component(folder.path(), "indirect", &none);
    assert_eq!(largest(&indirect), 0.0, "no bounce, no indirect light");
    let [direct, global] = ["direct", "global"].map(|name| component(folder.path(), name, &none));
    assert_eq!(direct, global, "global is direct light bit for bit");
    let cache = folder.path().join("cache");
    assert!(!cache.exists(), "a frame without bounces needs no bake");
}

#[test]
fn every_component_shows_what_it_is_called() {
    let folder = temporary_folder();
    let see = |name| component(folder.path(), name, &[]);
    let (albedo, normal, depth) = (see("albedo"), see("normal"), see("depth"));
    let (irradiance, global) = (see("irradiance"), see("global"));
    assert!(
        albedo
            .pixels()
            .iter()
            .all(|a| a.min_element() >= 0.0 && a.max_element() <= 1.0),
        "albedos lie between 0 and 1"
    );
    assert!(largest(&albedo) > 0.5, "the box has white walls");
    assert!(
        normal.pixels().iter().all(|n| n.length() <= 1.0 + ROUNDING),
        "normals are no longer than 1"
    );
    let is_in_the_box = |d: &Vec3| (5.7..7.9).contains(&d.x);
    assert!(
        depth
            .pixels()
            .iter()
            .all(|d| *d == Vec3::ZERO || is_in_the_box(d)),
        "depths are of one surface, not a mean with nothing"
    );
    let middle = depth.pixel(20, 8).expect("the picture has this pixel");
    assert!(
        (middle.x - 7.8).abs() < 1e-3 && middle.x == middle.y && middle.y == middle.z,
        "the back wall above the blocks is 7.8 away along the view: {middle}"
    );
    let pairs = irradiance.pixels().iter().zip(global.pixels());
    let brighter = pairs
        .filter(|&(e, l)| e.element_sum() > l.element_sum())
        .count();
    let lit = global
        .pixels()
        .iter()
        .filter(|l| l.element_sum() > 0.0)
        .count();
    assert_eq!(brighter, lit, "E > rho E / pi wherever there is light");
    assert!(
        lit > 600,
        "light is almost everywhere: {lit} of 1200 pixels"
    );
}

#[test]
fn the_basis_is_shown_in_colours_that_no_exposure_changes() {
    let folder = temporary_folder();
    let exposed = ["--set", "render.exposure=3.0"];
    for name in ["partitions", "basis:0", "basis:0.0"] {
        let picture = format!("{}.png", name.replace(':', "-"));
        let levels = |arguments: &[&str]| {
            let arguments = [&["--component", name], arguments].concat();
            succeed(&mut render_box_command(folder.path(), &picture, &arguments));
            let loaded = read_image(&folder.path().join(&picture));
            loaded.expect("the frame can be read").values().clone()
        };
        let plain = levels(&[]);
        assert_eq!(plain, levels(&exposed), "{name} is not light");
        let coloured = plain.pixels().iter().filter(|p| p.x != p.z).count();
        let few = if name == "partitions" { 600 } else { 1 };
        assert!(
            coloured >= few,
            "{name}: {coloured} of 1200 pixels have a colour"
        );
        let seen = plain.pixels().iter().filter(|p| p.max_element() > 0.0);
        assert!(seen.count() > 800, "{name} shows the room");
    }
    let [first, second] = ["basis:0", "basis:0.0"].map(|name| {
        let picture = folder
            .path()
            .join(format!("{}.png", name.replace(':', "-")));
        read_image(&picture).expect("the frame is still there")
    });
    assert_eq!(
        first, second,
        "function 0 of all is function 0 of partition 0"
    );
}

#[test]
fn approximated_direct_light_is_like_direct_light() {
    let folder = temporary_folder();
    let finer = ["--bounces", "0", "--set", "bake.max_edge=0.2"];
    let see = |name| component(folder.path(), name, &finer);
    let (approximated, direct) = (see("approximated-direct"), see("direct"));
    let mean = |image: &Image| {
        let sum: f64 = image
            .pixels()
            .iter()
            .map(|p| f64::from(p.element_sum()))
            .sum();
        sum / 3.0 / image.pixels().len() as f64
    };
    let ratio = mean(&approximated) / mean(&direct);
    assert!(
        (ratio - 1.0).abs() < MEAN_KEPT,
        "the basis keeps the mean of direct light: {ratio}"
    );
    assert_ne!(approximated, direct, "the basis holds no sharp shadow");
}

#[test]
fn sizes_and_several_outputs() {
    let folder = temporary_folder();
    let second = folder.path().join("second.exr");
    let second_name = second.to_str().expect("a temporary path is UTF-8");
    let report = render_box(folder.path(), &["-o", second_name]).json();
    let linear = read_image(&second).expect("the second output can be read");
    let levels = read_image(&folder.path().join("frame.png")).expect("the first too");
    for image in [linear.values(), levels.values()] {
        assert_eq!((image.width(), image.height()), (40, 30), "{report}");
    }
    let exr_first = relume(&["render", "--json", "--no-cache", "--bounces", "0"])
        .arg(scene("cornell"))
        .args(["--size", "8x8", "-o", second_name])
        .output()
        .expect("the program starts");
    assert!(exr_first.status.success(), "{exr_first:?}");
    let image = read_image(&second).expect("the file was replaced");
    assert_eq!(
        image.values().width(),
        8,
        "the new frame replaced the old one"
    );
    let report = crate::program::Finished::of(exr_first).json();
    assert_eq!(
        report["digest"].as_str(),
        Some(image.values().digest().as_str()),
        "the digest is that of the file's pixels: {report}"
    );
}
