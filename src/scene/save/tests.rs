//! Byte by byte: what an edit leaves of a scene file, and what it writes.

mod entries;
mod many_lights;
mod materials;
mod overrides;

use std::path::Path;

use glam::{DVec3, Vec3};

use super::*;
use crate::scene::files::Memory;
use crate::scene::{Bounces, LightKind, Point, Scene, Spot, Tone};

const MESH: &[u8] =
    b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl floor\nf 1 2 3\nusemtl wall\nf 3 2 1\n";
const MATERIALS: &[u8] = b"newmtl floor\nKd 0.5 0.5 0.5\nnewmtl wall\nKd 0.25 0.25 0.25\n";

const SCENE: &str = r#"# A room.
mesh = "m.obj"   # beside this file

[camera] # where we stand
position = [ 0, 1.0, 6.8 ]  # the eye
target = [0.0, 1.0, 0.0]
vfov = 39.3

size = [64, 48]

# The lamp hangs
# from the ceiling.
[[light]]
name = "lamp" # its name
kind = "point"
position = [
    0.0, # x
    1.5, # y, under the ceiling
    0.3,
]   # all of it
intensity = [3.3, 2.9, 2.3]
# brighter = [10, 10, 10]

# A spot without a name.
[[light]]
  kind = "spot"
  position = [0.0, 2.0, 0.0]
  target = [0.0, 0.0, 0.0]  # the floor
  intensity = [1, 1, 1]
# The sky comes last.
[[light]]
name = "Глобус \"ü\""
kind = "environment"
radiance = [0.1, 0.1, 0.1]

# What frames are like.
[render]
bounces = 4 # four
"#;

fn files() -> Memory {
    Memory::of(&[("m.obj", MESH), ("m.mtl", MATERIALS)])
}

fn load(bytes: &[u8], overrides: &[Override]) -> Scene {
    Scene::load_with(bytes, Path::new("s.toml"), overrides, &files()).unwrap()
}

/// What of a scene is saved, with the lists that it is made of.
struct Parts(Scene, Vec<String>, Vec<Reflection>);

impl Parts {
    fn of(scene: &Scene) -> Self {
        let names = scene.materials.iter().map(|m| m.name.clone()).collect();
        Self(scene.clone(), names, Reflection::of_all(&scene.materials))
    }

    fn edited(&self) -> Edited<'_> {
        Edited {
            lights: &self.0.lights,
            material_names: &self.1,
            reflections: &self.2,
            camera: &self.0.camera,
            render: &self.0.render,
        }
    }
}

fn save_with(text: &str, sets: &[&str], edit: impl Fn(&mut Scene)) -> Result<String, SaveError> {
    save_under(text, sets, edit).map(|(text, _)| text)
}

/// Edits a text under overrides; gives the new one and the overrides that still
/// hold, under which it is read as exactly the edited scene.
fn save_under(
    text: &str,
    sets: &[&str],
    edit: impl Fn(&mut Scene),
) -> Result<(String, Vec<Override>), SaveError> {
    let overrides: Vec<Override> = sets.iter().map(|s| Override::parse(s).unwrap()).collect();
    let loaded = load(text.as_bytes(), &overrides);
    let mut scene = loaded.clone();
    edit(&mut scene);
    let path = Path::new("s.toml");
    let file = edited_file_with(
        text.as_bytes(),
        path,
        &overrides,
        Parts::of(&loaded).edited(),
        Parts::of(&scene).edited(),
        &files(),
    )?;
    let read = load(&file.bytes, &file.overrides);
    assert_eq!(read.lights, scene.lights);
    assert_eq!(read.materials, scene.materials);
    assert_eq!((read.camera, &read.render), (scene.camera, &scene.render));
    Ok((String::from_utf8(file.bytes).unwrap(), file.overrides))
}

/// Edits a text; the new one is read as exactly the edited scene.
fn save(text: &str, edit: impl Fn(&mut Scene)) -> String {
    let new = save_with(text, &[], &edit).unwrap();
    let mut expected = load(text.as_bytes(), &[]);
    edit(&mut expected);
    let read = load(new.as_bytes(), &[]);
    assert_eq!(read.lights, expected.lights, "{new}");
    assert_eq!(read.materials, expected.materials, "{new}");
    assert_eq!(read.camera, expected.camera, "{new}");
    assert_eq!(read.render, expected.render, "{new}");
    new
}

fn point(light: &mut Light) -> &mut Point {
    match &mut light.kind {
        LightKind::Point(point) => point,
        other => panic!("{other:?} is no point light"),
    }
}

fn spot(light: &mut Light) -> &mut Spot {
    match &mut light.kind {
        LightKind::Spot(spot) => spot,
        other => panic!("{other:?} is no spot"),
    }
}

fn lamp(name: &str) -> Light {
    Light {
        name: name.to_owned(),
        kind: LightKind::Point(Point {
            position: DVec3::new(0.1, 1.0, 0.0),
            intensity: Vec3::splat(2.5),
        }),
    }
}

/// The text with pieces replaced, each of which stands in it once.
fn with(text: &str, pieces: &[[&str; 2]]) -> String {
    let mut text = text.to_owned();
    for [old, new] in pieces {
        assert_eq!(text.matches(old).count(), 1, "{old:?}");
        text = text.replacen(old, new, 1);
    }
    text
}

#[test]
fn nothing_edited_is_nothing_changed() {
    for text in [
        SCENE.to_owned(),
        SCENE.replace('\n', "\r\n"),
        format!("{MARK}{SCENE}"),
    ] {
        assert_eq!(save(&text, |_| ()), text);
    }
}

#[test]
fn only_numbers_that_changed_are_touched() {
    let new = save(SCENE, |scene| {
        scene.camera.position.y = 1.25;
        point(&mut scene.lights[0]).position.y = 1.75;
        point(&mut scene.lights[0]).intensity = Vec3::new(3.3, 0.1, 1e-7);
        scene.render.bounces = Bounces::All;
    });
    let expected = with(
        SCENE,
        &[
            ["[ 0, 1.0, 6.8 ]", "[ 0, 1.25, 6.8 ]"],
            ["    1.5, #", "    1.75, #"],
            ["[3.3, 2.9, 2.3]", "[3.3, 0.1, 1e-7]"],
            ["bounces = 4 #", "bounces = \"all\" #"],
        ],
    );
    assert_eq!(new, expected);
}

#[test]
fn line_ends_marks_and_a_missing_last_line_end_stay() {
    let edit = |scene: &mut Scene| {
        point(&mut scene.lights[0]).position.y = 1.75;
        scene.render.exposure = 0.5;
        scene.lights.push(lamp("new"));
        scene.materials[1].albedo = Vec3::splat(0.3);
    };
    let plain = save(SCENE, edit);
    let windows = save(&SCENE.replace('\n', "\r\n"), edit);
    assert_eq!(windows, plain.replace('\n', "\r\n"));
    let marked = save(&format!("{MARK}{SCENE}"), edit);
    assert_eq!(marked, format!("{MARK}{plain}"));
    let open = save(SCENE.trim_end(), edit);
    assert_eq!(open, plain.trim_end());
}

#[test]
fn keys_entries_and_sections_are_added_behind_what_is_there() {
    let new = save(SCENE, |scene| {
        scene.lights.push(lamp("new \"one\""));
        scene.render.exposure = -1.0;
        scene.render.tone = Tone::Filmic;
        scene.materials[1].albedo = Vec3::new(0.3, 0.2, 1.0);
        spot(&mut scene.lights[1]).cutoff_deg = 25.0;
    });
    let expected = with(
        SCENE,
        &[
            [
                "intensity = [1, 1, 1]\n",
                "intensity = [1, 1, 1]\n  cutoff = 25.0\n  beam = 22.5\n",
            ],
            [
                "radiance = [0.1, 0.1, 0.1]\n",
                "radiance = [0.1, 0.1, 0.1]\n\n[[light]]\nname = 'new \"one\"'\nkind = \"point\"\n\
                 position = [0.1, 1.0, 0.0]\nintensity = [2.5, 2.5, 2.5]\n",
            ],
            [
                "bounces = 4 # four\n",
                "bounces = 4 # four\nexposure = -1.0\ntone = \"filmic\"\n\n[[material]]\n\
                 name = \"wall\"\nalbedo = [0.3, 0.2, 1.0]\n",
            ],
        ],
    );
    assert_eq!(new, expected);
}

#[test]
fn a_section_that_is_missing_is_added() {
    let text = SCENE.split("\n# What frames").next().unwrap();
    let new = save(text, |scene| scene.render.bounces = Bounces::Count(2));
    assert_eq!(new, format!("{text}\n[render]\nbounces = 2\n"));
}

#[test]
fn a_moved_spot_keeps_its_target_key_and_its_direction() {
    let new = save(SCENE, |scene| {
        spot(&mut scene.lights[1]).position = DVec3::new(0.5, 2.0, 0.0);
    });
    let expected = with(
        SCENE,
        &[
            ["[0.0, 2.0, 0.0]", "[0.5, 2.0, 0.0]"],
            [
                "[0.0, 0.0, 0.0]  # the floor",
                "[0.5, 0.0, 0.0]  # the floor",
            ],
        ],
    );
    assert_eq!(new, expected);
    let turned = DVec3::new(0.3, -0.8, 0.1).normalize().as_vec3();
    save(SCENE, |scene| spot(&mut scene.lights[1]).direction = turned);
}

#[test]
fn what_the_reader_would_refuse_is_not_given_out() {
    let animated = format!(
        "{SCENE}\n[[animate]]\ntarget = \"light.light2.beam\"\nframes = [0, 1]\nvalues = [1, 20]\n"
    );
    let error = save_with(&animated, &[], |scene| {
        let spot = spot(&mut scene.lights[1]);
        (spot.cutoff_deg, spot.beam_deg) = (10.0, 5.0);
    });
    assert!(matches!(error, Err(SaveError::Refused(_))), "{error:?}");
    let loaded = load(SCENE.as_bytes(), &[]);
    let other = SCENE.replace("[[light]]\n  kind", "# [[light]]\n  kind");
    let parts = Parts::of(&loaded);
    let changes = Changes::between(parts.edited(), parts.edited());
    let error = changes.apply(&mut Editor::new(&other), &[]).unwrap_err();
    assert!(matches!(error, SaveError::NotTheText(_)), "{error}");
}
