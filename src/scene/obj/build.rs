//! The mesh from what tobj has parsed.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::clean::{Cleaned, FaceNote};
use crate::maths::order::Order;
use crate::scene::defects::{Defect, Defects};
use crate::scene::file::fields::unit;
use crate::scene::{Mesh, MeshTriangle, SceneError};

/// Height of a triangle, in units of the rounding of its coordinates, below
/// which its corners are collinear as far as double precision can tell. The
/// cross product of exact coordinates is wrong by about 4 of these.
const COLLINEAR_ULPS: f64 = 8.0;

/// Joins the models of tobj, one a material change, into one mesh. Triangles
/// without a material get index `unnamed`.
///
/// # Errors
/// A file without a triangle.
pub(super) fn mesh(
    models: &[tobj::Model],
    cleaned: &Cleaned,
    path: &Path,
    unnamed: usize,
    defects: &mut Defects,
) -> Result<Mesh, SceneError> {
    let mut mesh = Mesh::default();
    let mut notes = cleaned.faces.iter();
    for model in models {
        append(&mut mesh, &model.mesh, unnamed, &mut notes, &mut |line| {
            defects.add(Defect::ZeroArea, path, line);
        });
    }
    if mesh.triangles.is_empty() {
        return Err(SceneError::Mesh {
            place: path.display().to_string(),
            message: no_triangle(cleaned, defects),
        });
    }
    Ok(mesh)
}

fn no_triangle(cleaned: &Cleaned, defects: &mut Defects) -> String {
    let found = match cleaned.faces.len() {
        0 => "the file holds no face that can be drawn".to_owned(),
        count => format!("none of the {count} faces has an area"),
    };
    let reasons = std::mem::take(defects).into_warnings();
    let advice = "a scene needs at least one triangle (`f` statements with three corners or more)";
    if reasons.is_empty() {
        format!("{found}; {advice}")
    } else {
        format!("{found}; {advice}. {}", reasons.join("; "))
    }
}

/// Appends the triangles of a model; `notes` are those of its faces onwards.
fn append<'a>(
    mesh: &mut Mesh,
    model: &tobj::Mesh,
    unnamed: usize,
    notes: &mut impl Iterator<Item = &'a FaceNote>,
    dropped: &mut dyn FnMut(usize),
) {
    let base = Base {
        position: mesh.positions.len() as u32,
        normal: mesh.normals.len() as u32,
        texture_coordinate: mesh.texture_coordinates.len() as u32,
    };
    mesh.positions.extend(triples(&model.positions));
    // Those that are not usable were replaced by zeros and no face has them.
    mesh.normals
        .extend(triples(&model.normals).map(|normal| unit(normal).unwrap_or(DVec3::Z)));
    mesh.texture_coordinates.extend(
        model
            .texcoords
            .chunks_exact(2)
            .map(|uv| DVec2::new(uv[0], uv[1])),
    );
    let material = model.material_id.unwrap_or(unnamed) as u32;
    let mut start = 0;
    while start < model.indices.len() {
        let Some(note) = notes.next() else {
            break;
        };
        for _ in 0..note.corner_count - 2 {
            let triangle = base.triangle(model, start, note, material);
            if is_degenerate(triangle.corners.map(|c| mesh.positions[c as usize])) {
                dropped(note.line);
            } else {
                mesh.triangles.push(triangle);
            }
            start += 3;
        }
    }
}

/// Where the vertices of a model start in the mesh.
struct Base {
    position: u32,
    normal: u32,
    texture_coordinate: u32,
}

impl Base {
    fn triangle(
        &self,
        model: &tobj::Mesh,
        start: usize,
        note: &FaceNote,
        material: u32,
    ) -> MeshTriangle {
        let at = |indices: &[u32], base: u32| [0, 1, 2].map(|k| base + indices[start + k]);
        MeshTriangle {
            corners: at(&model.indices, self.position),
            normals: note
                .has_normals
                .then(|| at(&model.normal_indices, self.normal)),
            texture_coordinates: note
                .has_texture_coordinates
                .then(|| at(&model.texcoord_indices, self.texture_coordinate)),
            material,
        }
    }
}

fn triples(numbers: &[f64]) -> impl Iterator<Item = DVec3> {
    numbers.chunks_exact(3).map(DVec3::from_slice)
}

/// Whether three corners are equal or on a line, as far as their coordinates
/// are exact.
pub(super) fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let size = (b - a)
        .abs()
        .max((c - a).abs())
        .max((c - b).abs())
        .max_element();
    if size == 0.0 {
        return true;
    }
    // Relative to the size, so that squares neither vanish nor overflow.
    let [u, v] = [(b - a) / size, (c - a) / size];
    let coordinate = a.abs().max(b.abs()).max(c.abs()).max_element();
    let rounding = f64::EPSILON * (coordinate / size).at_least(1.0);
    u.cross(v).length() <= COLLINEAR_ULPS * rounding
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collinear_corners_are_degenerate_at_any_scale() {
        let step = DVec3::new(0.1, 0.2, 0.3);
        for scale in [1e-200, 1.0, 1e29] {
            let on_a_line = [1.0, 3.0, 7.0].map(|t| step * t * scale);
            assert!(is_degenerate(on_a_line), "scale {scale}");
            let triangle = [DVec3::ZERO, DVec3::X * scale, DVec3::Y * scale * 1e-9];
            assert!(!is_degenerate(triangle), "scale {scale}");
        }
        let far = DVec3::splat(14_678.0);
        assert!(!is_degenerate([far, far + DVec3::X, far + DVec3::Y * 1e-6]));
        assert!(is_degenerate([far, far, far + DVec3::Y]));
    }
}
