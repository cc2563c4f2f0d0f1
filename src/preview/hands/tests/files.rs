//! What is saved, and what is read again.

use glam::Vec3;

use super::*;

#[test]
fn a_reload_keeps_what_is_muted_and_can_be_undone() {
    let mut room = Room::new();
    room.keys("Tab Tab m Right");
    let mut scene = room.scene.clone();
    scene.lights.remove(0);
    room.hands.reload(&scene);
    let lights = &room.hands.document().lights;
    assert_eq!((lights.len(), lights[0].is_muted), (4, true));
    assert!(!room.hands.is_unsaved());
    room.keys("u");
    assert_eq!(room.hands.document().lights.len(), 5);
    assert!(room.hands.is_unsaved());
}

#[test]
fn a_sky_with_a_map_keeps_its_map() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/courtyard/evening.toml");
    let scene = Scene::load(path.as_ref(), &[]).unwrap();
    let sky = scene.lights.iter().position(|light| {
        matches!(&light.kind, LightKind::Environment(sky) if matches!(sky.radiance, crate::scene::Radiance::Map(_)))
    });
    let mut room = Room::new();
    room.hands = Hands::new(&scene, Component::Global);
    let bytes = fs::read(path).unwrap();
    let unchanged = room.hands.saved_file(&bytes, path.as_ref(), &[]);
    assert_eq!(unchanged.unwrap().bytes, bytes);
    for _ in 0..=sky.unwrap() {
        room.keys("Tab");
    }
    for key in ["t", "c", "g", "n n"] {
        let outcome = room.keys(key);
        assert!(
            !outcome.changed.any() && outcome.message.unwrap().contains("map"),
            "{key}"
        );
    }
    assert!(room.keys("i").changed.lights);
    assert!(room.keys("x").changed.lights);
    let new = room.hands.saved_file(&bytes, path.as_ref(), &[]).unwrap();
    let [new, old] = [&new.bytes, &bytes].map(|bytes| String::from_utf8(bytes.clone()).unwrap());
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let kept = lines(&old)
        .iter()
        .filter(|line| lines(&new).contains(line))
        .count();
    assert!(
        kept >= lines(&old).len() - 2 && new.contains("map = "),
        "{new}"
    );
}

/// The albedo that a material has now.
fn albedo(room: &Room, name: &str) -> Vec3 {
    let mut names = room.hands.material_names.iter();
    let index = names.position(|known| known == name).unwrap();
    room.hands.document().reflections[index].albedo
}

#[test]
fn a_reload_with_other_materials_is_undone_by_their_names() {
    let mut room = Room::new();
    room.hands.selection = Selection::Surface(1);
    room.keys("I Tab i");
    room.hands.selection = Selection::Surface(1);
    let lights = room.hands.document().lights();
    let names: Vec<String> = room
        .scene
        .materials
        .iter()
        .map(|m| m.name.clone())
        .collect();
    let darker = albedo(&room, &names[1]);
    let mut scene = room.scene.clone();
    scene.materials.reverse();
    let last = scene.materials.len() - 1;
    scene.materials[last].name = "another".to_owned();
    scene.materials[last].albedo = Vec3::splat(0.125);
    room.hands.reload(&scene);
    assert_eq!(albedo(&room, &names[1]), room.scene.materials[1].albedo);
    assert_eq!(room.hands.selected_name(), Some(names[1].as_str()));
    assert_eq!(room.keys("u").message.as_deref(), Some("undone"));
    assert_eq!(room.hands.document().lights(), lights);
    assert_eq!(albedo(&room, &names[1]), darker);
    assert_eq!(albedo(&room, "another"), Vec3::splat(0.125));
    assert_eq!(
        room.hands.document().reflections.len(),
        scene.materials.len()
    );
    room.keys("u u");
    assert_eq!(albedo(&room, &names[1]), room.scene.materials[1].albedo);
}
