//! A metal ball and a lacquered block in a room with coloured sides.

use super::body::{Body, Face, Shape};
use super::cells::{Grid, cuboid};
use super::model::{Material, Model};
use super::room::{Room, Wall};
use super::sphere::icosphere;

/// The ball's and the block's lobes are in the scene files.
const MATERIALS: [Material; 5] = [
    Material::plain("white", [0.72, 0.71, 0.69]),
    Material::plain("red", [0.63, 0.07, 0.05]),
    Material::plain("blue", [0.08, 0.2, 0.55]),
    Material::plain("ball", [0.8, 0.6, 0.4]),
    Material::plain("block", [0.3, 0.32, 0.1]),
];
/// Times that every triangle of the ball's icosahedron is cut into four.
const SUBDIVISIONS: usize = 4;
/// Metres.
const RADIUS: f64 = 0.5;

/// The room, 2.4 m wide, open towards +z.
pub(crate) fn model() -> Model {
    let room = Room {
        name: "room",
        grid: Grid([&[-1.2, 1.2], &[0.0, 2.0], &[-1.0, 1.4]]),
        walls: &[
            (Wall::Floor, "white"),
            (Wall::Ceiling, "white"),
            (Wall::Back, "white"),
            (Wall::Left, "red"),
            (Wall::Right, "blue"),
        ],
        holes: &[],
    };
    let block = cuboid("block", "block", [-0.22, 0.0, -0.22], [0.22, 0.5, 0.22]);
    Model::new(
        "glossy",
        "A metal ball and a lacquered block",
        MATERIALS.to_vec(),
        vec![
            room.build(),
            ball(),
            block.turned(25.0).moved(0.62, 0.0, 0.55),
        ],
    )
}

/// A finger above the floor.
fn ball() -> Body {
    let (directions, triangles) = icosphere(SUBDIVISIONS);
    let face = |[a, b, c]: [usize; 3]| Face {
        material: "ball",
        corners: vec![a, b, c],
    };
    let ball = Body {
        name: "ball",
        shape: Shape::Solid,
        positions: directions.iter().map(|&d| d * RADIUS).collect(),
        normals: Some(directions),
        faces: triangles.into_iter().map(face).collect(),
    };
    ball.moved(-0.3, RADIUS + 0.02, -0.1)
}
