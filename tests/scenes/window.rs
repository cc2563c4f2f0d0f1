//! A furnished room with one small window.

use super::body::Body;
use super::cells::{Grid, cuboid, solid};
use super::model::{Material, Model};
use super::room::{Room, Wall};

const MATERIALS: [Material; 8] = [
    Material::plain("plaster", [0.75, 0.73, 0.68]),
    Material::plain("ochre", [0.72, 0.42, 0.12]),
    Material::plain("boards", [0.42, 0.27, 0.16]),
    Material::plain("oak", [0.5, 0.31, 0.16]),
    Material::plain("frame", [0.78, 0.78, 0.76]),
    Material::plain("teal", [0.07, 0.34, 0.36]),
    Material::plain("brick", [0.56, 0.14, 0.09]),
    Material::plain("linen", [0.7, 0.66, 0.56]),
];

/// The window: height above the floor and depth, metres.
const WINDOW_Y: [f64; 2] = [1.1, 1.7];
const WINDOW_Z: [f64; 2] = [-1.2, -0.4];

/// The room, 4 m by 2.6 m by 5 m, and what stands in it.
pub(crate) fn model() -> Model {
    let bodies = vec![
        walls(),
        window_frame(),
        table().moved(-0.35, 0.0, -0.75),
        chair("chair_right").turned(-80.0).moved(0.72, 0.0, -0.6),
        chair("chair_front").turned(-160.0).moved(-0.55, 0.0, 0.32),
        cuboid("chest", "teal", [0.75, 0.0, -2.45], [1.75, 0.82, -1.95]),
        cuboid("crate", "brick", [-0.17, 0.0, -0.17], [0.17, 0.34, 0.17])
            .turned(32.0)
            .moved(1.1, 0.82, -2.2),
        bed(),
        cuboid("jar", "brick", [-0.08, 0.0, -0.08], [0.08, 0.2, 0.08])
            .turned(20.0)
            .moved(-0.7, 0.75, -0.85),
    ];
    Model::new(
        "window",
        "A furnished room with one small window",
        MATERIALS.to_vec(),
        bodies,
    )
}

/// All walls are cut where the window is: no T-junctions.
fn walls() -> Body {
    Room {
        name: "room",
        grid: Grid([
            &[-2.0, 2.0],
            &[0.0, WINDOW_Y[0], WINDOW_Y[1], 2.6],
            &[-2.5, WINDOW_Z[0], WINDOW_Z[1], 2.5],
        ]),
        walls: &[
            (Wall::Floor, "boards"),
            (Wall::Ceiling, "plaster"),
            (Wall::Left, "plaster"),
            (Wall::Right, "plaster"),
            (Wall::Back, "ochre"),
            (Wall::Front, "plaster"),
        ],
        holes: &[(Wall::Left, [0, 1, 1])],
    }
    .build()
}

/// A frame with a cross, inside the hole and a little into the room.
fn window_frame() -> Body {
    let across = |[low, high]: [f64; 2], rim: f64, bar: f64| {
        let middle = 0.5 * (low + high);
        let (bar_low, bar_high) = (middle - 0.5 * bar, middle + 0.5 * bar);
        [low, low + rim, bar_low, bar_high, high - rim, high]
    };
    let y = across(WINDOW_Y, 0.05, 0.03);
    let z = across(WINDOW_Z, 0.05, 0.03);
    let is_pane = |index: usize| index % 2 == 1;
    solid(
        "window_frame",
        "frame",
        &Grid([&[-2.0, -1.95], &y, &z]),
        |[_, j, k]| !(is_pane(j) && is_pane(k)),
    )
}

/// A table top on four legs, centred.
fn table() -> Body {
    let x = [-0.6, -0.53, 0.53, 0.6];
    let z = [-0.42, -0.35, 0.35, 0.42];
    solid(
        "table",
        "oak",
        &Grid([&x, &[0.0, 0.71, 0.75], &z]),
        |[i, j, k]| j == 1 || (i != 1 && k != 1),
    )
}

/// A chair whose back is towards -z before it is turned.
fn chair(name: &'static str) -> Body {
    let x = [-0.2, -0.155, 0.155, 0.2];
    let z = [-0.2, -0.155, 0.155, 0.2];
    let y = [0.0, 0.42, 0.46, 0.62, 0.86];
    solid(name, "oak", &Grid([&x, &y, &z]), |[i, j, k]| match j {
        0 => i != 1 && k != 1,
        1 => true,
        2 => k == 0 && i != 1,
        _ => k == 0,
    })
}

/// A bed along the right wall, with a pillow's end.
fn bed() -> Body {
    let y = [0.0, 0.42, 0.55];
    let z = [-1.3, -0.85, 0.7];
    solid(
        "bed",
        "linen",
        &Grid([&[1.05, 1.95], &y, &z]),
        |[_, j, k]| j == 0 || k == 0,
    )
}
