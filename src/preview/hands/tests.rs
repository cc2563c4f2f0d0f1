//! What a person does, and what comes of it.

mod drags;
mod files;
mod sequences;
mod surfaces;

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
        let new = self.hands.saved_file(&bytes, &self.path, &[]);
        let new = new.unwrap_or_else(|error| panic!("{error}: {:?}", self.hands.document()));
        let new = new.bytes;
        fs::write(&self.path, &new).unwrap();
        let scene = Scene::load(&self.path, &[]).unwrap();
        let read = Document::of_scene(&scene, Component::Global);
        assert!(!read.saves_as_other(self.hands.document()));
        assert_eq!(read.reflections, self.hands.document().reflections);
        self.scene = scene;
        self.hands.mark_saved();
        String::from_utf8(new).unwrap()
    }
}

#[test]
fn arrows_move_the_selected_light_in_steps_of_the_scene() {
    let mut room = Room::new();
    assert_eq!(
        room.keys("Tab").message.as_deref(),
        Some("point at 0.00 1.50 0.30, 3.30 2.90 2.30")
    );
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
