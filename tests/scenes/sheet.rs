//! Two rooms side by side with a sheet of no thickness between them.

use glam::DVec3;

use super::body::{Body, Face, Shape};
use super::cells::{Grid, cuboid};
use super::model::{Material, Model};
use super::room::{Room, Wall};

/// The halves have materials of their own, so that no program that joins equal
/// positions of one material can join them.
const MATERIALS: [Material; 7] = [
    Material::plain("lit_white", [0.7, 0.7, 0.7]),
    Material::plain("lit_orange", [0.75, 0.32, 0.07]),
    Material::plain("lit_blue", [0.12, 0.28, 0.6]),
    Material::plain("dark_white", [0.7, 0.7, 0.7]),
    Material::plain("dark_orange", [0.75, 0.32, 0.07]),
    Material::plain("dark_blue", [0.12, 0.28, 0.6]),
    Material::plain("sheet", [0.6, 0.6, 0.6]),
];

const HEIGHT: f64 = 2.0;
/// Between each half and the sheet, metres: nothing touches it, and no point of
/// a half lies so near that a shadow ray could start beyond the sheet.
const GAP: f64 = 0.001;
/// By how much the sheet reaches out of the rooms, metres. Light that leaves
/// the lit half through the gap passes the sheet's border on its way out, and
/// never comes back.
const OVERLAP: f64 = 0.05;

/// The lit half (low x), the dark half and the sheet.
pub(crate) fn model() -> Model {
    let lit = half(
        "lit_room",
        [-1.6, -GAP],
        Wall::Left,
        ["lit_white", "lit_orange"],
    );
    let dark = half(
        "dark_room",
        [GAP, 1.6],
        Wall::Right,
        ["dark_white", "dark_orange"],
    );
    let bodies = vec![
        lit,
        dark,
        cube("lit_cube", "lit_blue").moved(-0.85, 0.0, -0.35),
        cube("dark_cube", "dark_blue").moved(0.85, 0.0, -0.35),
        sheet(),
    ];
    Model::new(
        "sheet",
        "A sheet between two rooms",
        MATERIALS.to_vec(),
        bodies,
    )
}

/// A room without the wall towards the sheet and without a front.
fn half(name: &'static str, x: [f64; 2], side: Wall, [white, orange]: [&'static str; 2]) -> Body {
    Room {
        name,
        grid: Grid([&x, &[0.0, HEIGHT], &[-1.2, 1.2]]),
        walls: &[
            (Wall::Floor, white),
            (Wall::Ceiling, white),
            (Wall::Back, white),
            (side, orange),
        ],
        holes: &[],
    }
    .build()
}

fn cube(name: &'static str, material: &'static str) -> Body {
    cuboid(name, material, [-0.28, 0.0, -0.28], [0.28, 0.56, 0.28]).turned(25.0)
}

/// The sheet at x = 0; its front faces the lit half.
fn sheet() -> Body {
    let (low, high) = (-OVERLAP, HEIGHT + OVERLAP);
    let (back, front) = (-1.2 - OVERLAP, 1.2 + OVERLAP);
    let corner = |y, z| DVec3::new(0.0, y, z);
    Body {
        name: "sheet",
        shape: Shape::Open {
            seen_from: DVec3::new(-1.0, 1.0, 0.0),
        },
        positions: vec![
            corner(low, back),
            corner(low, front),
            corner(high, front),
            corner(high, back),
        ],
        normals: None,
        faces: vec![Face {
            material: "sheet",
            corners: vec![0, 1, 2, 3],
        }],
    }
}
