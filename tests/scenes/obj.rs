//! OBJ and MTL text.

use std::fmt::Write as _;

use glam::DVec3;

use super::body::Body;
use super::model::{Model, POSITION_DECIMALS, round_to};

/// Decimals of a printed normal: 0.003 degrees.
const NORMAL_DECIMALS: usize = 4;

/// The OBJ file.
pub(crate) fn mesh_text(model: &Model) -> String {
    let Model { name, title, .. } = model;
    let mut text = format!(
        "# {title}\n# Metres, Y up. Written by tests/scenes.rs; do not edit.\nmtllib {name}.mtl\n"
    );
    let mut first_position = 1;
    let mut first_normal = 1;
    for body in &model.bodies {
        push_body(&mut text, body, first_position, first_normal);
        first_position += body.positions.len();
        first_normal += body.normals.as_ref().map_or(0, Vec::len);
    }
    text
}

/// The MTL file.
pub(crate) fn material_text(model: &Model) -> String {
    let mut text = String::from("# Written by tests/scenes.rs; do not edit.\n");
    for (name, [red, green, blue]) in &model.materials {
        push_line(&mut text, format_args!("newmtl {name}"));
        push_line(&mut text, format_args!("Kd {red} {green} {blue}"));
    }
    text
}

fn push_body(text: &mut String, body: &Body, first_position: usize, first_normal: usize) {
    push_line(text, format_args!("o {}", body.name));
    for &position in &body.positions {
        push_vector(text, "v", position, POSITION_DECIMALS);
    }
    for &normal in body.normals.iter().flatten() {
        push_vector(text, "vn", normal, NORMAL_DECIMALS);
    }
    let mut material = "";
    for face in &body.faces {
        if face.material != material {
            material = face.material;
            push_line(text, format_args!("usemtl {material}"));
        }
        text.push('f');
        for corner in &face.corners {
            let position = first_position + corner;
            let _ = match body.normals {
                Some(_) => write!(text, " {position}//{}", first_normal + corner),
                None => write!(text, " {position}"),
            };
        }
        text.push('\n');
    }
}

fn push_vector(text: &mut String, keyword: &str, vector: DVec3, decimals: usize) {
    let [x, y, z] = vector.to_array().map(|value| round_to(value, decimals));
    push_line(
        text,
        format_args!("{keyword} {x:.decimals$} {y:.decimals$} {z:.decimals$}"),
    );
}

/// Writing to a string cannot fail.
fn push_line(text: &mut String, line: std::fmt::Arguments) {
    let _ = writeln!(text, "{line}");
}
