//! Three statues on pedestals in a hall: about 35,000 vertices, the size of
//! the scenes that the method was published with.

mod bust;
mod knot;
pub(crate) mod vase;

use super::body::Body;
use super::cells::{Grid, cuboid};
use super::model::{Material, Model};
use super::room::{Room, Wall};

const MATERIALS: [Material; 7] = [
    Material::plain("floor", [0.55, 0.52, 0.48]),
    Material::plain("plaster", [0.72, 0.71, 0.69]),
    Material::plain("vermilion", [0.66, 0.13, 0.07]),
    Material::plain("azure", [0.1, 0.3, 0.62]),
    Material::plain("stone", [0.6, 0.58, 0.54]),
    Material::plain("marble", [0.8, 0.78, 0.74]),
    Material::plain("ochre", [0.74, 0.45, 0.12]),
];

/// Height of the pedestals, metres.
const PEDESTAL: f64 = 0.8;
/// How deep a statue's base lies in its pedestal, metres: no light gap, and no
/// coplanar faces.
const SUNK: f64 = 0.012;

/// The hall, 4.2 m wide, open to the front and above.
pub(crate) fn model() -> Model {
    let hall = Room {
        name: "hall",
        grid: Grid([&[-2.1, 2.1], &[0.0, 3.0], &[-1.5, 2.1]]),
        walls: &[
            (Wall::Floor, "floor"),
            (Wall::Back, "plaster"),
            (Wall::Left, "vermilion"),
            (Wall::Right, "azure"),
        ],
        holes: &[],
    };
    let statue = |body: Body, angle_deg: f64, x: f64, z: f64| {
        body.turned(angle_deg)
            .standing_at(PEDESTAL - SUNK)
            .moved(x, 0.0, z)
    };
    let bodies = vec![
        hall.build(),
        pedestal("pedestal_left", 12.0).moved(-1.25, 0.0, -0.2),
        pedestal("pedestal_middle", 0.0).moved(0.0, 0.0, -0.6),
        pedestal("pedestal_right", -12.0).moved(1.25, 0.0, -0.2),
        statue(vase::body(), 0.0, -1.25, -0.2),
        statue(bust::body(), 12.0, 0.0, -0.6),
        statue(knot::body(), -18.0, 1.25, -0.2),
    ];
    Model::new(
        "statues",
        "Three statues in a hall",
        MATERIALS.to_vec(),
        bodies,
    )
}

fn pedestal(name: &'static str, angle_deg: f64) -> Body {
    cuboid(name, "stone", [-0.32, 0.0, -0.32], [0.32, PEDESTAL, 0.32]).turned(angle_deg)
}

/// `count` angles that divide the circle, radians.
fn circle(count: usize) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |k| k as f64 / count as f64 * (2.0 * std::f64::consts::PI))
}
