//! A box with coloured sides and two blocks, after the Cornell box.

use super::body::Body;
use super::cells::{Grid, cuboid};
use super::model::{Material, Model};
use super::room::{Room, Wall};

/// Measured reflectances of the Cornell box, as linear RGB.
const MATERIALS: [Material; 3] = [
    Material::plain("white", [0.725, 0.71, 0.68]),
    Material::plain("red", [0.63, 0.065, 0.05]),
    Material::plain("green", [0.14, 0.45, 0.091]),
];

/// The box, 2 m wide, open towards +z.
pub(crate) fn model() -> Model {
    let room = Room {
        name: "room",
        grid: Grid([&[-1.0, 1.0], &[0.0, 2.0], &[-1.0, 1.0]]),
        walls: &[
            (Wall::Floor, "white"),
            (Wall::Ceiling, "white"),
            (Wall::Back, "white"),
            (Wall::Left, "red"),
            (Wall::Right, "green"),
        ],
        holes: &[],
    };
    let bodies = vec![
        room.build(),
        block("short_block", 0.58, 0.6)
            .turned(-17.0)
            .moved(0.34, 0.0, 0.36),
        block("tall_block", 0.58, 1.2)
            .turned(17.0)
            .moved(-0.35, 0.0, -0.3),
    ];
    Model::new(
        "cornell",
        "A box with coloured sides",
        MATERIALS.to_vec(),
        bodies,
    )
}

/// A square block on the floor around the vertical axis.
fn block(name: &'static str, width: f64, height: f64) -> Body {
    let half = 0.5 * width;
    cuboid(name, "white", [-half, 0.0, -half], [half, height, half])
}
