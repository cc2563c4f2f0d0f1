//! OBJ and MTL text.

use std::fmt::Write as _;

use glam::{DVec2, DVec3};

use super::body::{Body, Face};
use super::model::{Map, MapKind, Model, POSITION_DECIMALS, round_to};

/// Decimals of a printed normal: 0.003 degrees.
const NORMAL_DECIMALS: usize = 4;

/// Decimals of printed texture coordinates: a hundredth of a pixel.
const TEXTURE_DECIMALS: usize = 4;

/// The OBJ file.
pub(crate) fn mesh_text(model: &Model) -> String {
    let Model { name, title, .. } = model;
    let mut text = format!(
        "# {title}\n# Metres, Y up. Written by tests/scenes.rs; do not edit.\nmtllib {name}.mtl\n"
    );
    let mut next = Numbers {
        position: 1,
        normal: 1,
        texture: 1,
    };
    for body in &model.bodies {
        push_body(&mut text, model, body, &mut next);
        next.position += body.positions.len();
        next.normal += body.normals.as_ref().map_or(0, Vec::len);
    }
    text
}

/// The MTL file.
pub(crate) fn material_text(model: &Model) -> String {
    let mut text = String::from("# Written by tests/scenes.rs; do not edit.\n");
    for material in &model.materials {
        let [red, green, blue] = material.albedo;
        push_line(&mut text, format_args!("newmtl {}", material.name));
        push_line(&mut text, format_args!("Kd {red} {green} {blue}"));
        if material.emission != [0.0; 3] {
            let [red, green, blue] = material.emission;
            push_line(&mut text, format_args!("Ke {red} {green} {blue}"));
        }
        if let Some(Map { kind, file, .. }) = material.map {
            let keyword = match kind {
                MapKind::Albedo => "map_Kd",
                MapKind::Emission => "map_Ke",
            };
            push_line(&mut text, format_args!("{keyword} {file}"));
        }
    }
    text
}

/// Numbers that the next position, normal and texture coordinates have in the
/// file.
struct Numbers {
    position: usize,
    normal: usize,
    texture: usize,
}

fn push_body(text: &mut String, model: &Model, body: &Body, next: &mut Numbers) {
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
        let map = model.map_of(material);
        for place in map.iter().flat_map(|map| places(body, face, map)) {
            let [u, v] = place
                .to_array()
                .map(|value| round_to(value, TEXTURE_DECIMALS));
            push_line(
                text,
                format_args!("vt {u:.TEXTURE_DECIMALS$} {v:.TEXTURE_DECIMALS$}"),
            );
        }
        text.push('f');
        for (k, corner) in face.corners.iter().enumerate() {
            let position = next.position + corner;
            let normal = next.normal + corner;
            let texture = next.texture + k;
            let _ = match (map.is_some(), body.normals.is_some()) {
                (true, true) => write!(text, " {position}/{texture}/{normal}"),
                (true, false) => write!(text, " {position}/{texture}"),
                (false, true) => write!(text, " {position}//{normal}"),
                (false, false) => write!(text, " {position}"),
            };
        }
        text.push('\n');
        if map.is_some() {
            next.texture += face.corners.len();
        }
    }
}

/// Texture coordinates of a face's corners: the picture lies upright on walls,
/// and with its top towards -z on floors.
fn places(body: &Body, face: &Face, map: &Map) -> Vec<DVec2> {
    let corners = &face.corners;
    let normal = body.doubled_area([corners[0], corners[1], corners[2]]);
    let place = |position: DVec3| {
        let DVec3 { x, y, z } = position;
        match normal.abs().to_array() {
            [a, b, c] if a >= b && a >= c => DVec2::new(-z * normal.x.signum(), y),
            [_, b, c] if b >= c => DVec2::new(x, -z),
            _ => DVec2::new(x * normal.z.signum(), y),
        }
    };
    let corners = corners.iter().map(|&corner| body.positions[corner]);
    corners.map(|corner| place(corner) / map.period).collect()
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
