//! The scene file alone.

use std::path::Path;

use glam::{DVec3, Vec3};

use super::{Document, Images};
use crate::scene::files::{Finder, Memory};
use crate::scene::{
    Bounces, LightKind, Normals, Override, PixelLimit, Radiance, SceneError, Tone, sample_images,
};
use crate::texture::TextureFilter;

const HEAD: &str = "mesh = \"a.obj\"\n[camera]\nposition = [0, 1, 5]\ntarget = [0, 1, 0]\n\
                    vfov = 40\nsize = [64, 48]\n";

fn parse(text: &str, overrides: &[&str]) -> Result<Document, SceneError> {
    let overrides: Result<Vec<_>, _> = overrides.iter().map(|o| Override::parse(o)).collect();
    let files = Memory::of(&[("dir/a/sky.HDR", sample_images::HDR)]);
    let finder = Finder::new(&files);
    let images = Images::new(&finder);
    Document::parse(text, Path::new("dir/s.toml"), &overrides?, &images)
}

/// The document of [`HEAD`] with more lines below.
fn with(more: &str) -> Result<Document, SceneError> {
    parse(&format!("{HEAD}{more}"), &[])
}

/// Asserts that an error starts with a place and holds every text.
#[track_caller]
fn assert_error(result: Result<Document, SceneError>, place: &str, texts: &[&str]) {
    let error = result.expect_err("not allowed");
    assert!(!error.is_io());
    let message = error.to_string();
    assert!(message.starts_with(&format!("{place}: ")), "{message}");
    for text in texts {
        assert!(message.contains(text), "{text:?} is not in: {message}");
    }
}

fn light(keys: &str) -> Result<LightKind, SceneError> {
    let document = with(&format!("[[light]]\nname = \"l\"\n{keys}\n"))?;
    Ok(document.lights[0].kind.clone())
}

#[test]
fn defaults() {
    let document = with("").unwrap();
    assert_eq!(document.mesh, Path::new("dir/a.obj"));
    assert_eq!(document.normals, Normals::File);
    assert_eq!(document.texture_filter, TextureFilter::Bilinear);
    assert_eq!(document.camera.up, DVec3::Y);
    assert_eq!(document.camera.size, [64, 48]);
    assert_eq!(document.render.bounces, Bounces::Count(4));
    assert_eq!(document.render.tone, Tone::Srgb);
    assert_eq!(document.render.light_samples, 16);
    assert_eq!(document.bake.rays, None);
    assert_eq!(document.golden.max_differing_pixels, None);
    assert!(document.lights.is_empty() && document.warnings.is_empty());
}

#[test]
fn unknown_keys_have_a_place_and_a_suggestion() {
    assert_error(
        parse("mehs = \"a.obj\"", &[]),
        "dir/s.toml:1:1",
        &["`mehs`", "\"a.obj\"", "the nearest is `mesh`"],
    );
    assert_error(
        with("  fov = 3\n"),
        "dir/s.toml:7:3",
        &["`fov` (= 3)", "[camera]", "`vfov`"],
    );
    assert_error(
        with("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nintensty = [1, 1, 1]\n"),
        "dir/s.toml:10:1",
        &["light \"light1\" (point)", "the nearest is `intensity`"],
    );
    assert_error(
        with("[[light]]\nkind = \"pont\"\n"),
        "dir/s.toml:8:8",
        &["\"pont\"", "the nearest is `point`", "`environment`"],
    );
    assert_error(
        with("[render]\ntone = \"aces\"\n"),
        "dir/s.toml:8:8",
        &["`filmic`"],
    );
    assert_error(
        with("[light]\nkind = \"point\"\n"),
        "dir/s.toml:7:1",
        &["[[light]]"],
    );
}

#[test]
fn missing_keys_name_the_table() {
    assert_error(parse("", &[]), "dir/s.toml:1", &["lacks the key `mesh`"]);
    assert_error(parse("mesh = \"a\"", &[]), "dir/s.toml:1", &["[camera]"]);
    assert_error(
        with("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n"),
        "dir/s.toml:7:1",
        &["lacks the key `intensity`", "W/sr"],
    );
}

#[test]
fn camera_ranges() {
    let camera = |key: &str, value: &str| parse(HEAD, &[&format!("camera.{key}={value}")]);
    for (key, value) in [
        ("vfov", "0"),
        ("vfov", "180"),
        ("vfov", "nan"),
        ("vfov", "\"40\""),
        ("size", "[0, 10]"),
        ("size", "[16385, 10]"),
        ("size", "[10.5, 10]"),
        ("size", "[10]"),
        ("position", "[0, 1]"),
        ("position", "[0, inf, 1]"),
        ("position", "[0, 1e31, 1]"),
        ("target", "[0, 1, 5]"),
        ("up", "[0, 0, 0]"),
    ] {
        let place = format!("--set camera.{key}");
        assert_error(camera(key, value), &place, &[&format!("`{key}`"), value]);
    }
    assert_error(
        camera("up", "[0, 0, -3]"),
        "--set camera.up",
        &["`up`", "is [0, 0, -3]", "parallel"],
    );
    assert_error(
        camera("target", "[0, 9, 5]"),
        "dir/s.toml:2:1",
        &["needs a key `up`", "parallel"],
    );
    assert_eq!(
        camera("size", "[16384, 1]").unwrap().camera.size,
        [16384, 1]
    );
    assert_eq!(camera("vfov", "179.9").unwrap().camera.vfov_deg, 179.9);
}

#[test]
fn point_and_directional_lights() {
    let LightKind::Point(point) =
        light("kind = \"point\"\nposition = [1, 2, 3]\nintensity = [1, 0, 2.5]").unwrap()
    else {
        panic!("a point light")
    };
    assert_eq!(point.position, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(point.intensity, Vec3::new(1.0, 0.0, 2.5));
    let LightKind::Directional(sun) =
        light("kind = \"directional\"\ndirection = [0, -3e-200, 4e-200]\nirradiance = [1, 1, 1]")
            .unwrap()
    else {
        panic!("a directional light")
    };
    assert_eq!(sun.direction, Vec3::new(0.0, -0.6, 0.8));
    assert_error(
        light("kind = \"directional\"\ndirection = [0, 0, 0]\nirradiance = [1, 1, 1]")
            .and_then(|_| with("")),
        "dir/s.toml:10:13",
        &["`direction`", "[0, 0, 0]"],
    );
    assert_error(
        light("kind = \"point\"\nposition = [1, 2, 3]\nintensity = [1, -1, 1]")
            .and_then(|_| with("")),
        "dir/s.toml:11:13",
        &["light \"l\" (point)", "[1, -1, 1]", "from 0"],
    );
}

#[test]
fn spot_lights() {
    let spot = |keys: &str| {
        light(&format!(
            "kind = \"spot\"\nposition = [0, 2, 0]\nintensity = [1, 1, 1]\n{keys}"
        ))
    };
    let LightKind::Spot(default) = spot("target = [0, 0, 0]").unwrap() else {
        panic!("a spot light")
    };
    assert_eq!(default.direction, -Vec3::Y);
    assert_eq!((default.cutoff_deg, default.beam_deg), (30.0, 22.5));
    let LightKind::Spot(wide) = spot("direction = [2, 0, 0]\ncutoff = 90\nbeam = 90").unwrap()
    else {
        panic!("a spot light")
    };
    assert_eq!(
        (wide.direction, wide.cutoff_deg, wide.beam_deg),
        (Vec3::X, 90.0, 90.0)
    );
    for (keys, text) in [
        ("", "needs `target` or `direction`"),
        ("target = [0, 0, 0]\ndirection = [0, 1, 0]", "exactly one"),
        ("target = [0, 2, 0]", "another point"),
        ("target = [0, 0, 0]\ncutoff = 0", "above 0"),
        ("target = [0, 0, 0]\ncutoff = 91", "at most 90"),
        (
            "target = [0, 0, 0]\ncutoff = 20\nbeam = 21",
            "from 0 to `cutoff`, 20",
        ),
        ("target = [0, 0, 0]\nradius = 2", "unknown key `radius`"),
    ] {
        let message = spot(keys).unwrap_err().to_string();
        assert!(message.contains(text), "{message}");
    }
}

#[test]
fn area_and_environment_lights() {
    let area = "kind = \"area\"\ncorner = [0, 0, 0]\nradiance = [1, 1, 1]\nedge_u = [1, 0, 0]\n";
    assert!(light(&format!("{area}edge_v = [0, 0, 1]")).is_ok());
    let flat = light(&format!("{area}edge_v = [2, 0, 0]")).unwrap_err();
    assert!(flat.to_string().contains("spans an area"), "{flat}");
    let sky = |keys: &str| light(&format!("kind = \"environment\"\n{keys}"));
    let LightKind::Environment(map) =
        sky("map = \"a/sky.HDR\"\nscale = 2\nrotation = -90").unwrap()
    else {
        panic!("an environment")
    };
    let Radiance::Map(image) = map.radiance else {
        panic!("a map")
    };
    assert_eq!(image.path(), Path::new("dir/a/sky.HDR"));
    let LightKind::Environment(far) = sky("radiance = [1, 1, 1]\nrotation = 1e9").unwrap() else {
        panic!("an environment")
    };
    assert_eq!(far.rotation_deg, 280.0, "whole turns are dropped exactly");
    let missing = sky("map = \"b.hdr\"").unwrap_err();
    assert!(missing.is_io());
    assert!(
        missing
            .to_string()
            .starts_with("dir/s.toml:10:7: cannot read dir/b.hdr"),
        "{missing}"
    );
    assert_eq!((map.scale, map.rotation_deg), (2.0, -90.0));
    assert!(
        sky("map = \"sky.png\"")
            .unwrap_err()
            .to_string()
            .contains(".exr or .hdr")
    );
    assert!(sky("map = \"sky.exr\"\nradiance = [1, 1, 1]").is_err());
    assert!(sky("").is_err());
    assert!(sky("radiance = [1, 1, 1]\nscale = -1").is_err());
}

#[test]
fn a_kind_given_by_set_is_blamed_for_what_it_lacks() {
    let lamp = "[[light]]\nname = \"lamp\"\nkind = \"point\"\nposition = [0, 1, 0]\n\
                intensity = [1, 1, 1]\n";
    let set = |kind: &str| {
        let kind = format!("light.lamp.kind={kind}");
        parse(&format!("{HEAD}{lamp}"), &[&kind])
    };
    let by_set = "by --set light.lamp.kind";
    assert_error(set("spot"), "--set light.lamp.kind", &[by_set, "`target`"]);
    assert_error(set("area"), "dir/s.toml:10:1", &[by_set, "`position`"]);
}

#[test]
fn light_names() {
    let point = "kind = \"point\"\nposition = [0, 0, 0]\nintensity = [1, 1, 1]\n";
    let document = with(&format!(
        "[[light]]\n{point}[[light]]\nname = \"a\"\n{point}[[light]]\n{point}"
    ))
    .unwrap();
    let names: Vec<_> = document.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["light1", "a", "light3"]);
    assert_error(
        with(&format!(
            "[[light]]\nname = \"light2\"\n{point}[[light]]\n{point}"
        )),
        "dir/s.toml:12:1",
        &["\"light2\""],
    );
    assert_error(
        with(&format!(
            "[[light]]\nname = \"a\"\n{point}[[light]]\nname = \"a\"\n{point}"
        )),
        "dir/s.toml:13:8",
        &["\"a\""],
    );
    assert_error(
        with(&format!("[[light]]\nname = \"\"\n{point}")),
        "dir/s.toml:8:8",
        &["not empty"],
    );
}

#[test]
fn render_bake_and_golden() {
    let document = with(
        "[render]\nbounces = \"all\"\nexposure = -2\ntone = \"filmic\"\nlight_samples = 4\n\
         [bake]\nmax_edge = 0.5\nvertices = 100\nrays = 64\nfunctions = 32\ncoefficients = 8\n\
         [golden]\nmax_channel_difference = 2\nmax_differing_pixels = \"0.5 %\"\nmax_flip = 0.1\nmask = \"m.png\"\n\
         set = [\"bake.rays=9\", \"render.tone=srgb\"]\n",
    )
    .unwrap();
    assert_eq!(document.render.bounces, Bounces::All);
    assert_eq!(document.render.exposure, -2.0);
    assert_eq!(document.bake.vertices, Some(100));
    assert_eq!(document.bake.max_edge, Some(0.5));
    assert_eq!(
        document.golden.max_differing_pixels,
        Some(PixelLimit::Share(0.005))
    );
    assert_eq!(
        document.golden.mask.as_deref(),
        Some(Path::new("dir/m.png"))
    );
    assert_eq!(document.golden.set, ["bake.rays=9", "render.tone=srgb"]);
    for (line, text) in [
        ("[render]\nbounces = -1", "0 to 10000, or \"all\""),
        ("[render]\nbounces = \"most\"", "or \"all\""),
        ("[render]\nexposure = inf", "`exposure`"),
        ("[render]\nlight_samples = 0", "from 1"),
        ("[bake]\nerror = 0", "above 0"),
        ("[bake]\nmax_edge = 0", "above 0"),
        ("[bake]\nrays = 99999999999999999999", "whole number"),
        ("[bake]\nfixed_albedo = 1", "true or false"),
        ("[golden]\nmax_differing_pixels = \"101%\"", "share"),
        ("[golden]\nmax_flip = 2", "from 0 to 1"),
        ("[golden]\nset = [\"bake.rays\"]", "must be PATH=VALUE"),
        ("[golden]\nset = [3]", "must be a string"),
        ("render = 3", "unknown key `render`"),
        (
            "[[material]]\nname = \"a\"\nalbedo = [0, 0, 1.01]",
            "from 0 to 1",
        ),
        ("[[material]]\nalbedo = [0, 0, 1]", "lacks the key `name`"),
        (
            "[[material]]\nname = \"a\"\n[[material]]\nname = \"a\"",
            "second",
        ),
    ] {
        let message = with(line).unwrap_err().to_string();
        assert!(message.contains(text), "{message}");
    }
}

#[test]
fn overrides_replace_keys() {
    let lamp = format!(
        "{HEAD}[[light]]\nkind = \"spot\"\nposition = [0, 2, 0]\ntarget = [0, 0, 0]\nintensity = [1, 1, 1]\n"
    );
    let sets = [
        "light.light1.direction=[1, 0, 0]",
        "camera.vfov=50",
        "render.bounces=all",
        "normals=smooth",
        "bake.rays=128",
        "camera.vfov=60",
    ];
    let document = parse(&lamp, &sets).unwrap();
    let LightKind::Spot(spot) = &document.lights[0].kind else {
        panic!("a spot light")
    };
    assert_eq!(spot.direction, Vec3::X, "the target gave way");
    assert_eq!(document.camera.vfov_deg, 60.0, "the last one counts");
    assert_eq!(document.render.bounces, Bounces::All);
    assert_eq!(document.normals, Normals::Smooth);
    assert_eq!(document.bake.rays, Some(128));
    for (set, place, text) in [
        (
            "light.light2.cutoff=3",
            "--set light.light2.cutoff",
            "the nearest is `light1`",
        ),
        (
            "light.light1.foo=3",
            "--set light.light1.foo",
            "unknown key `foo`",
        ),
        ("camera.fov=3", "--set camera.fov", "the nearest is `vfov`"),
        (
            "light.light1.cutoff=[3]",
            "--set light.light1.cutoff",
            "is [3]",
        ),
        ("normals=smoth", "--set normals", "the nearest is `smooth`"),
        (
            "material.a.albedo=[2, 0, 0]",
            "--set material.a.albedo",
            "from 0 to 1",
        ),
    ] {
        assert_error(parse(&lamp, &[set]), place, &[text]);
    }
    assert_error(
        parse(HEAD, &["light.lamp.cutoff=3"]),
        "--set light.lamp.cutoff",
        &["there is none"],
    );
}

#[test]
fn animations_obey_the_rules_of_their_key() {
    let point =
        "[[light]]\nname = \"p\"\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = [1, 1, 1]\n";
    let animate = |target: &str, frames: &str, values: &str| {
        with(&format!(
            "{point}[[animate]]\ntarget = \"{target}\"\nframes = {frames}\nvalues = {values}\n"
        ))
    };
    let document = animate("camera.vfov", "[0, 10]", "[30, 40.5]").unwrap();
    assert_eq!(document.animations[0].values, [[30.0], [40.5]]);
    for (target, frames, values, place, text) in [
        (
            "light.q.position",
            "[0]",
            "[[0, 0, 0]]",
            "15:11",
            "the nearest is `p`",
        ),
        ("light.p.foo", "[0]", "[1]", "15:11", "unknown key `foo`"),
        (
            "light.p.intensity",
            "[0, 1]",
            "[[1, 1, 1], [1, 1, -1]]",
            "15:22",
            "from 0",
        ),
        (
            "light.p.position",
            "[0, 1]",
            "[[1, 1, 1], [1, 1]]",
            "15:10",
            "equally long",
        ),
        (
            "light.p.position",
            "[0, 1]",
            "[[1, 1, 1]]",
            "15:10",
            "2 values",
        ),
        (
            "light.p.position",
            "[1, 1]",
            "[[1, 1, 1], [0, 0, 0]]",
            "14:10",
            "above the one before",
        ),
        (
            "light.p.position",
            "[]",
            "[]",
            "14:10",
            "above the one before",
        ),
        ("light.p.kind", "[0]", "[1]", "13:10", "no quantity"),
        (
            "camera.size",
            "[0]",
            "[[1, 1]]",
            "13:10",
            "same in all frames",
        ),
        ("bake.rays", "[0]", "[1]", "13:10", "only keys of"),
        (
            "lihgt.p.position",
            "[0]",
            "[1]",
            "13:10",
            "the nearest is `light`",
        ),
    ] {
        assert_error(
            animate(target, frames, values),
            &format!("dir/s.toml:{place}"),
            &[text],
        );
    }
}
