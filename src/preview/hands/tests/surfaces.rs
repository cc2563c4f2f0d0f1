//! What kind of surface a material is, and how rough.

use glam::Vec3;

use super::*;
use crate::scene::Reflection;

const PLASTIC: &str = r#"
[camera]
position = [0.0, 1.0, 6.8]
target = [0.0, 1.0, 0.0]
vfov = 19.5
size = [64, 48]
[[material]]
name = "red" # to the left
brdf = "plastic" # like a toy
"#;

fn reflection(room: &Room) -> Reflection {
    let Selection::Surface(index) = room.hands.selection() else {
        panic!("no surface is selected")
    };
    room.hands.document().reflections[index]
}

/// A room with the red wall selected.
fn red(text: &str) -> Room {
    let mut room = Room::of(text);
    room.keys("]");
    while room.hands.selected_name() != Some("red") {
        room.keys("]");
    }
    room
}

#[test]
fn a_surface_becomes_the_next_kind_and_the_one_before() {
    let mut room = red(LIGHTS);
    let matte = reflection(&room);
    let mut said = Vec::new();
    for _ in 0..5 {
        let outcome = room.keys("}");
        assert!(outcome.changed.reflections && !outcome.changed.lights);
        said.push(outcome.message.unwrap());
    }
    let kinds = [
        "satin",
        "plastic",
        "brushed metal",
        "polished metal",
        "matte",
    ];
    for (said, kind) in said.iter().zip(kinds) {
        assert!(said.starts_with(&format!("red: {kind}, ")), "{said}");
    }
    assert_eq!(reflection(&room), matte);
    assert!(!room.hands.is_unsaved());
    let said = room.keys("{").message.unwrap();
    assert_eq!(
        said,
        "red: polished metal, specular 0.6300 0.0650 0.0500, roughness 0.200"
    );
    // Each is a step of undo.
    room.keys("u u");
    assert_eq!(reflection(&room).roughness, 0.2);
    assert_eq!(
        room.keys("Esc }").message.unwrap(),
        "no surface is selected; ] selects one"
    );
}

#[test]
fn roughness_goes_in_steps_that_are_undone_as_one() {
    let mut room = red(LIGHTS);
    let message = room.keys(">").message.unwrap();
    assert!(message.contains("no gloss"), "{message}");
    room.keys("} > > alt+<");
    assert_eq!(reflection(&room).roughness, 0.645);
    room.keys("u u");
    assert_eq!(reflection(&room).roughness, 0.55);
    room.keys("U U < < < < < < < < < < < < < <");
    assert_eq!(reflection(&room).roughness, 0.05);
    let text = room.save();
    let saved = "name = \"red\"\nspecular = [0.04, 0.04, 0.04]\nroughness = 0.05\n";
    assert!(text.contains(saved), "{text}");
}

#[test]
fn the_colour_of_a_metal_is_its_specular_one() {
    let mut room = red(LIGHTS);
    let albedo = reflection(&room).albedo;
    room.keys("{ I");
    let metal = reflection(&room);
    assert_eq!(metal.albedo, Vec3::ZERO);
    assert!(metal.specular.x < albedo.x && metal.specular.x > 0.5);
    room.keys("}");
    assert_eq!(reflection(&room).albedo, metal.specular);
}

#[test]
fn a_brdf_of_the_file_gives_way_to_what_was_edited() {
    let mut room = red(PLASTIC);
    assert_eq!(reflection(&room).roughness, 0.3);
    room.keys(">");
    let text = room.save();
    let rougher = "brdf = \"plastic\" # like a toy\nroughness = 0.35\n";
    assert!(text.contains(rougher), "{text}");
    room.keys("}");
    let text = room.save();
    let metal = "name = \"red\" # to the left\nalbedo = [0.0, 0.0, 0.0] # like a toy\n\
                 roughness = 0.5\nspecular = [0.63, 0.065, 0.05]\n";
    assert!(text.contains(metal), "{text}");
}

#[test]
fn other_files_change_what_was_not_edited() {
    let mut room = red(LIGHTS);
    room.keys("} i");
    let edited = reflection(&room);
    let mut scene = room.scene.clone();
    for material in &mut scene.materials {
        material.albedo = Vec3::splat(0.125);
        material.specular = Vec3::splat(0.25);
        material.roughness = Some(0.75);
    }
    room.hands.refresh(&scene);
    assert_eq!(reflection(&room), edited);
    room.keys("]");
    assert_eq!(reflection(&room).specular, Vec3::splat(0.25));
    assert_eq!(reflection(&room).roughness, 0.75);
    room.keys("u u");
    assert_eq!(
        room.hands.document().reflections,
        Reflection::of_all(&scene.materials)
    );
    assert!(!room.hands.is_unsaved());
}
