//! A paved courtyard with an arcade, open to the sky.

use glam::{DVec2, DVec3};

use super::body::{Body, Shape};
use super::cells::{Grid, QuadCollector, cuboid, solid};
use super::extrusion::extruded;
use super::model::{MapKind, Material, Model};
use super::pictures;
use super::statues::vase;

/// The courtyard, metres: from the left wall to the right one, and from the
/// arcade's front to the edge of the paving behind the camera.
const LEFT: f64 = -4.0;
const RIGHT: f64 = 4.0;
const ARCADE_FRONT: f64 = -1.6;
const STEPS_FRONT: f64 = ARCADE_FRONT + 1.25;
const GALLERY_BACK: f64 = -4.0;
const NEAR: f64 = 7.0;
/// Height of the gallery's floor: two steps.
const GALLERY_FLOOR: f64 = 0.32;
/// Heights above the gallery's floor: where arches spring, and the roof.
const SPRINGING: f64 = 1.75;
const ROOF: f64 = 3.1;
/// Underside of the roof above the paving.
const ROOF_Y: f64 = GALLERY_FLOOR + ROOF - 2.0 * SUNK;
const ARCH_COUNT: usize = 3;
const PIER_WIDTH: f64 = 0.5;
/// How deep bodies lie in their neighbours, metres: no light gap, and no
/// coplanar faces.
const SUNK: f64 = 0.012;
/// The lantern's pane.
const PANE_X: f64 = -4.15;
/// Chords of an arch.
const CHORDS: usize = 12;

/// All bodies are closed, but for the ground and the lantern's pane.
pub(crate) fn model() -> Model {
    let bodies = vec![
        ground(),
        steps(),
        arcade().moved(0.0, GALLERY_FLOOR - SUNK, 0.0),
        cuboid(
            "roof",
            "plaster",
            [LEFT - SUNK, ROOF_Y, GALLERY_BACK - 0.4],
            [RIGHT + SUNK, ROOF_Y + 0.14, ARCADE_FRONT + 0.15],
        ),
        cuboid(
            "back_wall",
            "ochre",
            [LEFT - SUNK, 0.0, GALLERY_BACK - 0.3],
            [RIGHT + SUNK, ROOF_Y + SUNK, GALLERY_BACK],
        ),
        left_wall(),
        right_wall(),
        bench().moved(LEFT + 0.55, 0.0, 1.3),
        cuboid(
            "lantern",
            "iron",
            [-4.32, 1.36, -0.82],
            [PANE_X - 0.002, 1.64, -0.58],
        ),
        pane(),
        vase::turned_on_a_lathe("urn", "clay", [32, 60]).moved(2.35, GALLERY_FLOOR - SUNK, -1.15),
    ];
    let materials = vec![
        Material::plain("plaster", [0.72, 0.68, 0.6]),
        Material::plain("ochre", [0.7, 0.45, 0.2]),
        Material::plain("stone", [0.6, 0.57, 0.5]),
        Material::plain("wood", [0.36, 0.21, 0.11]),
        Material::plain("iron", [0.05, 0.05, 0.055]),
        Material::plain("clay", [0.5, 0.22, 0.11]),
        Material::mapped("paving", MapKind::Albedo, "paving.png", 2.4),
        Material::mapped("bricks", MapKind::Albedo, "bricks.png", 1.0),
        Material {
            albedo: [0.1, 0.08, 0.05],
            emission: [9.0, 4.6, 1.5],
            ..Material::mapped("pane", MapKind::Emission, "pane.png", 0.2)
        },
    ];
    Model {
        pictures: vec![
            pictures::paving(),
            pictures::bricks(),
            pictures::pane(),
            pictures::evening_sky(),
        ],
        ..Model::new(
            "courtyard",
            "A paved courtyard with an arcade, open to the sky",
            materials,
            bodies,
        )
    }
}

/// The paving, one sheet under everything, cut where the steps and the walls
/// stand on it: light on its open part is told from the dark below them.
fn ground() -> Body {
    let grid = Grid([
        &[LEFT - 1.0, LEFT, RIGHT, RIGHT + 1.0],
        &[0.0, 1.0],
        &[GALLERY_BACK - 0.6, STEPS_FRONT, NEAR],
    ]);
    let mut quads = QuadCollector::default();
    for (i, k) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
        quads.add("paving", grid.side([i, 0, k], 1, false), false);
    }
    let seen_from = DVec3::Y;
    quads.body("ground", Shape::Open { seen_from }, &grid)
}

/// The glowing front of the lantern, 0.2 m wide: one picture fills it.
fn pane() -> Body {
    let grid = Grid([&[PANE_X, 0.0], &[1.4, 1.6], &[-0.8, -0.6]]);
    let mut quads = QuadCollector::default();
    quads.add("pane", grid.side([0; 3], 0, false), false);
    let seen_from = DVec3::new(0.0, 1.5, -0.7);
    quads.body("pane", Shape::Open { seen_from }, &grid)
}

/// Two steps along the arcade; the upper one is the gallery's floor.
fn steps() -> Body {
    solid(
        "steps",
        "stone",
        &Grid([
            &[LEFT - SUNK, RIGHT + SUNK],
            &[0.0, 0.5 * GALLERY_FLOOR, GALLERY_FLOOR],
            &[GALLERY_BACK - SUNK, ARCADE_FRONT + 0.9, STEPS_FRONT],
        ]),
        |[_, j, k]| j == 0 || k == 0,
    )
}

/// Piers and round arches.
fn arcade() -> Body {
    let (left, right) = (LEFT - SUNK, RIGHT + SUNK);
    let bay = (right - left - PIER_WIDTH) / ARCH_COUNT as f64;
    let radius = 0.5 * (bay - PIER_WIDTH);
    let column = |from: DVec2, to: DVec2| {
        let above = |point: DVec2| DVec2::new(point.x, ROOF);
        [from, to, above(to), above(from)]
    };
    let mut quads = Vec::new();
    for pier in 0..=ARCH_COUNT {
        let x = [0.0, PIER_WIDTH].map(|across| left + bay * pier as f64 + across);
        let [foot, capital] = [0.0, SPRINGING].map(|y| x.map(|x| DVec2::new(x, y)));
        quads.push([foot[0], foot[1], capital[1], capital[0]]);
        quads.push(column(capital[0], capital[1]));
        if pier == ARCH_COUNT {
            break;
        }
        // The arch's ends are the piers' corners to the bit.
        let next = DVec2::new(left + bay * (pier + 1) as f64, SPRINGING);
        let mut points = vec![capital[1]];
        points.extend((1..CHORDS).map(|chord| {
            let angle = std::f64::consts::PI * chord as f64 / CHORDS as f64;
            let middle = 0.5 * (capital[1] + next);
            middle + DVec2::new(-libm::cos(angle), libm::sin(angle)) * radius
        }));
        points.push(next);
        quads.extend(points.windows(2).map(|pair| column(pair[0], pair[1])));
    }
    extruded(
        "arcade",
        "plaster",
        &quads,
        [ARCADE_FRONT - 0.4, ARCADE_FRONT],
    )
}

/// A brick wall with a niche for the lantern, higher beside the gallery.
fn left_wall() -> Body {
    solid(
        "left_wall",
        "bricks",
        &Grid([
            &[LEFT - 0.6, LEFT - 0.4, LEFT],
            &[0.0, 1.37, 1.95, 2.9, ROOF_Y + SUNK],
            &[GALLERY_BACK - 0.3, ARCADE_FRONT, -1.0, -0.4, NEAR],
        ]),
        |[i, j, k]| match (j, k) {
            (1, 2) => i == 0,
            (3, _) => k == 0,
            _ => true,
        },
    )
}

/// A wall that is low enough beside the courtyard to let the evening sun in.
fn right_wall() -> Body {
    solid(
        "right_wall",
        "bricks",
        &Grid([
            &[RIGHT, RIGHT + 0.4],
            &[0.0, 1.3, ROOF_Y + SUNK],
            &[GALLERY_BACK - 0.3, ARCADE_FRONT, NEAR],
        ]),
        |[_, j, k]| j == 0 || k == 0,
    )
}

/// A plank on two blocks, along the left wall.
fn bench() -> Body {
    let z = [-0.9, -0.7, -0.45, 0.45, 0.7, 0.9];
    solid(
        "bench",
        "wood",
        &Grid([&[-0.2, 0.2], &[0.0, 0.38, 0.45], &z]),
        |[_, j, k]| j == 1 || k == 1 || k == 3,
    )
}
