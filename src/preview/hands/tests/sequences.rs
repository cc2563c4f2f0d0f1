//! Long random sequences of keys and drags.

use super::*;
use crate::maths::hash::mix;
use crate::preview::keys::ROWS;

const ROUNDS: u32 = 90;
const INPUTS: u32 = 60;

/// Scene files of other layouts than [`LIGHTS`].
const IN_BRACES: &str = r#"
camera = { position = [0.0, 1.0, 6.8], target = [0.0, 1.0, 0.0], vfov = 19.5, size = [640, 480] }
light = [{ kind = "point", position = [0.0, 1.5, 0.3], intensity = [3.3, 2.9, 2.3] }, { kind = "spot", position = [0.3, 1.9, 0.0], target = [0, 0, 0], intensity = [3, 3, 3], cutoff = 20 }]
render = {}
material = []"#;
const BY_LINES: &str = r#"
camera.position = [
  0.0, # x
  1.0, 6.8 ]
camera.target = [0.0, 1.0, 0.0]
camera.vfov = 19.5
camera.size = [640, 480]
render.bounces = 3 # three
light = [ # all of them
  # The lamp.
  { kind = "point", position = [0.0, 1.5, 0.3], intensity = [3.3, 2.9, 2.3] }, # lamp
  # The spot.
  { name = "s", kind = "spot", position = [0.3, 1.9, 0.0], direction = [0, -1, 0], intensity = [3, 3, 3] },

  { kind = "directional", direction = [0.3, -1, -0.2], irradiance = [1, 1, 1] }
  # no more
]
[[material]]
name = "white" # painted
albedo = [0.7, 0.7, 0.7]
"#;

/// Numbers that look random, the same each time.
struct Random(u32);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 += 1;
        mix(self.0) as usize % count.max(1)
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    fn cell(&mut self) -> [u16; 2] {
        [self.below(44) as u16, self.below(18) as u16]
    }
}

/// Drags a mark, or what is beside it, to two places.
fn drag(room: &mut Room, random: &mut Random) {
    let button = random.of(&[Button::Left, Button::Middle, Button::Right]);
    let held = Held {
        alt: random.below(2) == 0,
        ..Held::NONE
    };
    let lights = room.hands.document().lights.len();
    let from = match lights {
        0 => random.cell(),
        count => {
            let light = random.below(count);
            room.cell_of(light)
        }
    };
    let cells = [from, random.cell(), random.cell()];
    room.drag(button, held, &cells);
}

/// Presses a key of the table, once or again and again, to its limits.
fn press(room: &mut Room, random: &mut Random) {
    let all = ROWS.iter().flat_map(|row| row.keys.iter().map(|it| it.0));
    let keys: Vec<&str> = all.collect();
    let keys = random.of(&keys);
    let held = random.of(&["", "shift+", "alt+", "ctrl+"]);
    for _ in 0..random.of(&[1, 1, 1, 2, 40]) {
        for part in keys.split(' ') {
            let is_whole = part.contains('+') || keys.contains(' ');
            let held = if is_whole { "" } else { held };
            room.keys(&format!("{held}{part}"));
        }
        // Few lights are reached often.
        if room.hands.document().lights.len() > 12 {
            room.keys("Delete");
        }
    }
}

/// What the reader of the scene file refuses cannot be made by hand.
#[test]
fn whatever_hands_do_can_be_saved_and_read_back() {
    let layouts = [LIGHTS, &LIGHTS.replace('\n', "\r\n"), IN_BRACES, BY_LINES];
    let mut room = Room::new();
    let mut random = Random(0);
    let mut texts = Vec::new();
    for _ in 0..ROUNDS {
        for _ in 0..INPUTS {
            match random.below(8) {
                0 => drag(&mut room, &mut random),
                1 => drop(room.keys("Tab")),
                2 => drop(room.keys("]")),
                _ => press(&mut room, &mut random),
            }
            assert!(room.hands.document().is_valid());
        }
        texts.push(room.save());
        let drawn = room.hands.marks(&room.view);
        assert_eq!(drawn.len(), room.hands.document().lights.len());
        assert!(drawn.iter().all(|mark| mark.px.is_finite()));
        // Only so many sequences begin far out.
        if random.below(3) == 0 {
            room = Room::of(random.of(&layouts));
        }
    }
    let others = texts.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert_eq!(others + 1, texts.len(), "every sequence changed the scene");
    for part in [
        "[[material]]",
        "kind = \"spot\"",
        "direction = ",
        "exposure = ",
        "bounces = ",
    ] {
        let count = texts.iter().filter(|text| text.contains(part)).count();
        assert!(count > 5, "{part:?} stands in {count} files");
    }
}
