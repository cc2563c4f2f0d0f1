//! A plank that leans against a wall.

use super::cells::{Grid, cuboid};
use super::model::{Material, Model};
use super::room::{Room, Wall};

const MATERIALS: [Material; 3] = [
    Material::plain("floor", [0.42, 0.4, 0.38]),
    Material::plain("wall", [0.66, 0.67, 0.7]),
    Material::plain("wood", [0.55, 0.27, 0.1]),
];

/// Length and thickness of the plank, metres.
const LENGTH: f64 = 2.0;
const THICKNESS: f64 = 0.04;
/// The wall's z.
const WALL: f64 = -1.0;
/// Upward and towards the wall along the plank: 3, 4 and 5 make a right angle.
const RISE: f64 = 0.8;
const RUN: f64 = 0.6;

/// Floor, wall and plank.
pub(crate) fn model() -> Model {
    let room = Room {
        name: "room",
        grid: Grid([&[-3.4, 2.4], &[0.0, 2.6], &[WALL, 2.0]]),
        walls: &[(Wall::Floor, "floor"), (Wall::Back, "wall")],
        holes: &[],
    };
    Model::new(
        "plank",
        "A plank that leans against a wall",
        MATERIALS.to_vec(),
        vec![room.build(), plank()],
    )
}

/// The plank touches the floor with its lower back edge and the wall with its
/// upper back edge.
fn plank() -> super::body::Body {
    let mut plank = cuboid(
        "plank",
        "wood",
        [-0.16, 0.0, 0.0],
        [0.16, LENGTH, THICKNESS],
    );
    for position in &mut plank.positions {
        let (along, out) = (position.y, position.z);
        position.y = RISE * along + RUN * out;
        position.z = WALL + RUN * LENGTH - RUN * along + RISE * out;
    }
    plank
}
