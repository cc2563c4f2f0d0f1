//! What a person does, and what comes of it.

mod sequences;

use std::fs;
use std::path::PathBuf;

use super::*;
use crate::preview::input::{Action, Button, Held, Mouse};
use crate::preview::view::sample_view;
use crate::scene::{Bounces, LightKind};

/// Lights of every kind, some without names, one of them animated.
const LIGHTS: &str = r#"
[camera]
position = [0.0, 1.0, 6.8]
target = [0.0, 1.0, 0.0]
vfov = 19.5
size = [640, 480]
[[light]]
name = "lamp" # hangs
kind = "point"
position = [0.0, 1.5, 0.3]
intensity = [3.3, 2.9, 2.3]
[[light]]
kind = "spot"
position = [0.3, 1.9, 0.0]
target = [0.0, 0.0, 0.0]
intensity = [3, 3, 3]
[[light]]
kind = "directional"
direction = [0.3, -1, -0.2]
irradiance = [1, 1, 1]
[[light]]
kind = "area"
corner = [-0.2, 1.9, -0.2]
edge_u = [0.4, 0, 0]
edge_v = [0, 0, 0.4]
radiance = [5, 5, 5]
[[light]]
name = "heaven"
kind = "environment"
radiance = [0.1, 0.1, 0.1]
rotation = -30
[[animate]]
target = "light.lamp.position"
frames = [0, 1]
values = [[0, 1, 0], [0, 1.5, 0]]
"#;

struct Room {
    hands: Hands,
    scene: Scene,
    view: View,
    now: Duration,
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Room {
    fn new() -> Self {
        Self::of(LIGHTS)
    }

    /// A room of a scene file without its mesh.
    fn of(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell/cornell.obj");
        let path = folder.path().join("room.toml");
        fs::write(&path, format!("mesh = '{mesh}'\n{text}")).unwrap();
        let scene = Scene::load(&path, &[]).unwrap();
        Self {
            hands: Hands::new(&scene, Component::Global),
            view: sample_view().0,
            now: Duration::ZERO,
            scene,
            path,
            _folder: folder,
        }
    }

    /// Types keys, by their names with spaces between.
    fn keys(&mut self, names: &str) -> Outcome {
        let mut outcome = Outcome::default();
        for name in names.split(' ') {
            let key = Key::parse(name).unwrap();
            outcome = self.take(Input::Key(key));
        }
        outcome
    }

    fn take(&mut self, input: Input) -> Outcome {
        self.now += Duration::from_millis(100);
        let seen = |px: DVec2| {
            let point = DVec3::new(0.5, 0.5, 0.5);
            (px.x > 20.0).then_some(Seen { material: 1, point })
        };
        self.hands.take(input, &self.view, &seen, self.now)
    }

    fn mouse(&mut self, action: Action, cell: [u16; 2], held: Held) -> Outcome {
        self.take(Input::Mouse(Mouse {
            action,
            column: cell[0],
            row: cell[1],
            held,
        }))
    }

    fn drag(&mut self, button: Button, held: Held, cells: &[[u16; 2]]) {
        self.mouse(Action::Press(button), cells[0], held);
        for cell in cells {
            self.mouse(Action::Drag(button), *cell, held);
        }
        self.mouse(Action::Release(button), cells[cells.len() - 1], held);
    }

    /// Cell of a light's mark.
    fn cell_of(&self, index: usize) -> [u16; 2] {
        let px = self.hands.marks(&self.view)[index].px / self.view.cell_px();
        [px.x as u16 + self.view.column, px.y as u16 + self.view.row]
    }

    fn light(&self, index: usize) -> &LightKind {
        &self.hands.document().lights[index].light.kind
    }

    fn position(&self, index: usize) -> DVec3 {
        crate::preview::document::position(self.light(index)).unwrap()
    }

    /// Saves, reads back and takes the new file as the one that was loaded.
    fn save(&mut self) -> String {
        let bytes = fs::read(&self.path).unwrap();
        let new = self.hands.saved_bytes(&bytes, &self.path, &[]);
        let new = new.unwrap_or_else(|error| panic!("{error}: {:?}", self.hands.document()));
        fs::write(&self.path, &new).unwrap();
        let scene = Scene::load(&self.path, &[]).unwrap();
        let read = Document::of_scene(&scene, Component::Global);
        assert!(!read.saves_as_other(self.hands.document()));
        assert_eq!(read.albedos, self.hands.document().albedos);
        self.scene = scene;
        self.hands.mark_saved();
        String::from_utf8(new).unwrap()
    }
}

#[test]
fn arrows_move_the_selected_light_in_steps_of_the_scene() {
    let mut room = Room::new();
    assert_eq!(room.keys("Tab").message.as_deref(), Some("lamp"));
    let outcome = room.keys("Right");
    assert!(
        outcome.changed.lights && !outcome.changed.camera,
        "{outcome:?}"
    );
    assert_eq!(room.position(0), DVec3::new(0.05, 1.5, 0.3));
    room.keys("shift+Up alt+PgUp");
    assert_eq!(room.position(0), DVec3::new(0.05, 2.0, 0.295));
    room.keys("Esc Left");
    assert_eq!(room.position(0).x, 0.05);
    assert!(
        room.hands.document().camera.position.x < -0.1,
        "orbits instead"
    );
}

#[test]
fn undo_takes_bursts_and_drags_back_as_a_whole() {
    let mut room = Room::new();
    room.keys("Tab Right Right Right");
    let moved = room.position(0);
    let cell = room.cell_of(0);
    room.drag(
        Button::Left,
        Held::NONE,
        &[cell, [cell[0] + 3, cell[1]], [cell[0] + 5, cell[1] + 2]],
    );
    let dragged = room.position(0);
    room.keys("i i m Esc u");
    assert!(!room.hands.document().lights[0].is_muted);
    assert_eq!(
        room.hands.selection(),
        Selection::Light(0),
        "what was undone is selected"
    );
    room.keys("u");
    assert_eq!(room.position(0), dragged);
    room.keys("u");
    assert_eq!(room.position(0), moved);
    room.keys("u");
    assert_eq!(room.position(0), DVec3::new(0.0, 1.5, 0.3));
    assert!(!room.hands.is_unsaved());
    assert_eq!(room.keys("u").message.as_deref(), Some("nothing to undo"));
    room.keys("U ctrl+r");
    assert_eq!(room.position(0), dragged);
    assert!(room.hands.is_unsaved());
}

#[test]
fn a_dragged_light_stays_under_the_pointer_and_at_its_depth() {
    for (index, held) in [(0, Held::NONE), (1, Held::NONE), (3, Held::NONE)] {
        let mut room = Room::new();
        let eye = room.view.eye(&room.hands.document().camera);
        let before = eye.project(room.position(index));
        let [column, row] = room.cell_of(index);
        room.drag(Button::Left, held, &[[column, row], [column - 4, row + 3]]);
        let after = eye.project(room.position(index));
        assert!((after.depth - before.depth).abs() < 1e-6, "{index}");
        let by = after.px - before.px;
        assert!(
            (by - DVec2::new(-4.0, 6.0)).length() < 1e-4,
            "{index}: {by}"
        );
    }
}

#[test]
fn ctrl_alt_shift_and_the_right_button_drag_along_the_view() {
    let alt = Held {
        alt: true,
        ..Held::NONE
    };
    for (button, held) in [(Button::Right, Held::NONE), (Button::Left, alt)] {
        let mut room = Room::new();
        let eye = room.view.eye(&room.hands.document().camera);
        let before = eye.project(room.position(0));
        let [column, row] = room.cell_of(0);
        room.drag(button, held, &[[column, row], [column, row - 2]]);
        let after = eye.project(room.position(0));
        assert!((after.px - before.px).length() < 1e-4);
        assert!(after.depth > before.depth * 1.2);
    }
}

#[test]
fn a_sun_follows_the_pointer_and_a_sky_turns() {
    let mut room = Room::new();
    let [column, row] = room.cell_of(2);
    let before = room.hands.marks(&room.view)[2].px;
    room.drag(
        Button::Left,
        Held::NONE,
        &[[column, row], [column + 3, row + 1]],
    );
    let by = room.hands.marks(&room.view)[2].px - before;
    assert!((by - DVec2::new(3.0, 2.0)).length() < 1e-3, "{by}");
    let [column, row] = room.cell_of(4);
    room.drag(
        Button::Left,
        Held::NONE,
        &[[column, row], [column - 4, row]],
    );
    let LightKind::Environment(sky) = room.light(4) else {
        panic!()
    };
    assert_eq!(sky.rotation_deg, 6.0, "36 degrees on from -30");
}

#[test]
fn clicks_select_marks_then_surfaces_and_drags_elsewhere_orbit() {
    let mut room = Room::new();
    let click = |room: &mut Room, cell| {
        room.mouse(Action::Press(Button::Left), cell, Held::NONE);
        room.mouse(Action::Release(Button::Left), cell, Held::NONE)
    };
    let cell = room.cell_of(0);
    click(&mut room, cell);
    assert_eq!(room.hands.selection(), Selection::Light(0));
    click(&mut room, [30, 13]);
    assert_eq!(room.hands.selection(), Selection::Surface(1));
    room.keys("I");
    let albedos = &room.hands.document().albedos;
    assert!(albedos[1].x < room.scene.materials[1].albedo.x);
    click(&mut room, [4, 14]);
    assert_eq!(room.hands.selection(), Selection::Nothing);
    let camera = room.hands.document().camera;
    room.drag(Button::Left, Held::NONE, &[[4, 14], [8, 14]]);
    let orbited = room.hands.document().camera;
    assert!(orbited.position != camera.position && orbited.target == camera.target);
    room.drag(Button::Middle, Held::NONE, &[[4, 14], [8, 14]]);
    assert!(room.hands.document().camera.target != camera.target);
    room.mouse(Action::ScrollUp, [8, 8], Held::NONE);
    room.keys("v");
    assert_eq!(room.hands.document().camera, camera);
    assert_eq!(
        room.mouse(Action::Press(Button::Left), [60, 14], Held::NONE),
        Outcome::default()
    );
}

#[test]
fn lights_are_added_duplicated_and_deleted_under_names_of_their_own() {
    let mut room = Room::new();
    for (keys, name) in [
        ("n p", "point"),
        ("n p", "point 2"),
        ("n n", "point 3"),
        ("n s", "spot"),
        ("n d", "sun"),
        ("n a", "panel"),
        ("n e", "sky"),
        ("ctrl+d", "sky 2"),
    ] {
        room.keys(keys);
        assert_eq!(room.hands.selected_name(), Some(name), "{keys}");
    }
    let outcome = room.keys("Esc Tab Delete");
    assert!(
        outcome.message.unwrap().contains("[[animate]]"),
        "an animated light stays"
    );
    room.keys("Tab Delete");
    assert_eq!(room.hands.selected_name(), Some("light3"));
    let text = room.save();
    assert!(
        text.contains("name = \"light3\"\nkind = \"directional\""),
        "{text}"
    );
    assert!(text.contains("name = \"lamp\" # hangs"), "{text}");
}

#[test]
fn mute_and_solo_choose_what_the_renderer_sees() {
    let mut room = Room::new();
    let shown = |room: &Room| -> Vec<String> {
        let lights = room.hands.document().shown_lights();
        lights.into_iter().map(|light| light.name).collect()
    };
    room.keys("Tab m");
    assert_eq!(shown(&room), ["light2", "light3", "light4", "heaven"]);
    room.keys("Tab M Tab M");
    assert_eq!(shown(&room), ["light2", "light3"]);
    room.keys("m");
    assert_eq!(shown(&room), ["light2"]);
    assert!(!room.hands.is_unsaved(), "neither is saved");
}

#[test]
fn keys_of_the_picture() {
    let mut room = Room::new();
    let outcome = room.keys("3");
    assert!(outcome.changed.component);
    assert_eq!(room.hands.document().component, Component::Indirect);
    room.keys("e e e");
    assert_eq!(room.hands.document().render.exposure, 1.0);
    room.keys("- -");
    assert_eq!(room.hands.document().render.bounces, Bounces::Count(2));
    room.keys("* + /");
    assert_eq!(room.hands.document().render.bounces, Bounces::All);
    assert_eq!(room.keys("ctrl+s").request, Some(Request::Save));
    assert_eq!(room.keys("P").request, Some(Request::WritePng));
    assert_eq!(room.keys("ctrl+z").request, Some(Request::Suspend));
    assert!(
        room.keys("n")
            .message
            .unwrap()
            .contains("p new point light")
    );
    assert_eq!(room.keys("Esc").request, None);
    assert!(room.keys("F9").message.unwrap().contains("F9 is no key"));
}

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
fn marks_are_drawn_over_the_picture_and_can_be_hidden() {
    let mut room = Room::new();
    let size = room.view.size_px;
    let picture = EncodedImage::of_bytes(size[0], size[1], vec![40; 3600]).unwrap();
    let plain = room.hands.with_marks(&picture, &room.view);
    let changed = |image: &EncodedImage| {
        let pairs = image.bytes().chunks(3).zip(picture.bytes().chunks(3));
        pairs.filter(|(a, b)| a != b).count()
    };
    assert!((60..700).contains(&changed(&plain)), "{}", changed(&plain));
    room.keys("Tab");
    assert!(
        room.hands.with_marks(&picture, &room.view) != plain,
        "the selected one shines"
    );
    room.keys("Space");
    assert_eq!(room.hands.with_marks(&picture, &room.view), picture);
}

#[test]
fn a_drag_that_begins_without_effect_is_undone_too() {
    let mut room = Room::new();
    let sky = room.cell_of(4);
    // Up and down turns no sky.
    let cells = [sky, [sky[0], sky[1] + 1], [sky[0] - 3, sky[1] + 1]];
    room.drag(Button::Left, Held::NONE, &cells);
    assert!(room.hands.is_unsaved());
    room.keys("u");
    assert!(!room.hands.is_unsaved());
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
    let unchanged = room.hands.saved_bytes(&bytes, path.as_ref(), &[]);
    assert_eq!(unchanged.unwrap(), bytes);
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
    let new = room.hands.saved_bytes(&bytes, path.as_ref(), &[]).unwrap();
    let [new, old] = [&new, &bytes].map(|bytes| String::from_utf8(bytes.clone()).unwrap());
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
