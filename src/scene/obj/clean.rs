//! First pass over an OBJ text: checks every statement and writes a text with
//! absolute indices and finite numbers only, vertices before faces.
//!
//! tobj stops at the first statement that it cannot take and does not say
//! where, splits a mesh at every `o` and `g`, and invents normals for corners
//! that have none; none of this happens with the text made here.

use std::fmt::Write;
use std::num::IntErrorKind;
use std::path::Path;

use glam::DVec3;

use super::lines::{Statement, number, statements};
use super::mtl::Libraries;
use crate::scene::defects::{Defect, Defects};
use crate::scene::file::fields::{LARGEST, unit};
use crate::scene::file::shortened;
use crate::scene::place::Place;
use crate::scene::{Normals, SceneError};

/// A name that no material can have, since control characters are refused.
const NO_MATERIAL: &str = "\u{1}";

/// A text that tobj takes, and what it does not tell about its faces.
#[derive(Debug)]
pub(super) struct Cleaned {
    pub(super) text: String,
    /// The faces in their order.
    pub(super) faces: Vec<FaceNote>,
}

/// What is known of a face beside its corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaceNote {
    pub(super) line: usize,
    pub(super) corner_count: usize,
    pub(super) has_normals: bool,
    pub(super) has_texture_coordinates: bool,
}

/// Which vertex statements hold numbers that can be used, by index from 0.
#[derive(Debug, Default)]
struct Usable {
    positions: Vec<bool>,
    texture_coordinates: Vec<bool>,
    normals: Vec<bool>,
}

/// Numbers of vertex statements above a line: what negative indices count from.
#[derive(Debug, Clone, Copy, Default)]
struct Above {
    positions: usize,
    texture_coordinates: usize,
    normals: usize,
}

/// Indices of a face, counted from 1; `None`: not given for all corners, or
/// not usable.
struct Face {
    positions: Vec<usize>,
    texture_coordinates: Option<Vec<usize>>,
    normals: Option<Vec<usize>>,
}

/// Cleans a normalised OBJ text.
///
/// # Errors
/// A vertex or face statement that cannot be understood.
pub(super) fn clean(
    text: &str,
    path: &Path,
    normals: Normals,
    libraries: &Libraries,
    defects: &mut Defects,
) -> Result<Cleaned, SceneError> {
    let mut cleaner = Cleaner {
        path,
        reads_normals: normals == Normals::File,
        libraries,
        defects,
        text: "mtllib all\n".to_owned(),
        usable: Usable::default(),
        faces: Vec::new(),
    };
    for statement in statements(text) {
        cleaner.vertex(&statement)?;
    }
    let mut above = Above::default();
    for statement in statements(text) {
        cleaner.face_or_material(&statement, &mut above)?;
    }
    Ok(Cleaned {
        text: cleaner.text,
        faces: cleaner.faces,
    })
}

struct Cleaner<'a> {
    path: &'a Path,
    reads_normals: bool,
    libraries: &'a Libraries,
    defects: &'a mut Defects,
    text: String,
    usable: Usable,
    faces: Vec<FaceNote>,
}

impl Cleaner<'_> {
    fn vertex(&mut self, statement: &Statement<'_>) -> Result<(), SceneError> {
        match statement.keyword {
            "v" => {
                // What follows is a weight, which only curves use, or a colour.
                let xyz = self.numbers(statement, 3)?;
                let usable = self.write("v", &xyz);
                self.usable.positions.push(usable);
            }
            "vt" => {
                // One-dimensional textures leave v out.
                let u = self.numbers(statement, 1)?[0];
                let v = match statement.words().nth(1) {
                    None => 0.0,
                    Some(_) => self.numbers(statement, 2)?[1],
                };
                let usable = self.write("vt", &[u, v]);
                self.usable.texture_coordinates.push(usable);
            }
            "vn" if self.reads_normals => {
                let xyz = self.numbers(statement, 3)?;
                let usable =
                    self.write("vn", &xyz) && unit(DVec3::new(xyz[0], xyz[1], xyz[2])).is_some();
                self.usable.normals.push(usable);
            }
            _ => {}
        }
        Ok(())
    }

    /// The first `count` numbers of a statement.
    fn numbers(&self, statement: &Statement<'_>, count: usize) -> Result<Vec<f64>, SceneError> {
        let words = statement.words().take(count);
        let numbers: Option<Vec<f64>> = words.map(number).collect();
        numbers
            .filter(|numbers| numbers.len() == count)
            .ok_or_else(|| {
                let message = format!("it needs {count} numbers separated by spaces");
                self.error(statement, &message)
            })
    }

    /// Writes a vertex, or zeros in its place where it is not usable, so that
    /// the numbering stays. Returns whether it is usable.
    fn write(&mut self, keyword: &str, numbers: &[f64]) -> bool {
        let usable = numbers.iter().all(|x| x.abs() <= LARGEST);
        self.text.push_str(keyword);
        for number in numbers {
            let number = if usable { *number } else { 0.0 };
            write!(self.text, " {number:e}").expect("a string takes any text");
        }
        self.text.push('\n');
        usable
    }

    fn face_or_material(
        &mut self,
        statement: &Statement<'_>,
        above: &mut Above,
    ) -> Result<(), SceneError> {
        match statement.keyword {
            "v" => above.positions += 1,
            "vt" => above.texture_coordinates += 1,
            "vn" => above.normals += 1,
            // `fo` is what the first version of the format called a face.
            "f" | "fo" => self.face(statement, above)?,
            "usemtl" => self.use_material(statement),
            "curv" | "curv2" | "surf" => {
                self.defects
                    .add(Defect::FreeForm, self.path, statement.line);
            }
            _ => {}
        }
        Ok(())
    }

    fn use_material(&mut self, statement: &Statement<'_>) {
        let name = self.libraries.named(statement.rest).unwrap_or_else(|why| {
            let place = Place::of_line(self.path, statement.line);
            let text = format!("{why}; {}", Defect::UnknownMaterial.text());
            self.defects
                .add_text(Defect::UnknownMaterial, &place, &text);
            NO_MATERIAL
        });
        writeln!(self.text, "usemtl {name}").expect("a string takes any text");
    }

    fn face(&mut self, statement: &Statement<'_>, above: &Above) -> Result<(), SceneError> {
        let line = statement.line;
        let mut corners = Vec::new();
        let before_comment = statement.rest.split('#').next().unwrap_or_default();
        for word in before_comment.split_whitespace() {
            let corner = corner(word).ok_or_else(|| {
                let word = shortened(word);
                let message = format!("{word:?} is no corner such as 1, 1/1, 1//1 or 1/1/1");
                self.error(statement, &message)
            })?;
            corners.push(corner);
        }
        match self.checked(&corners, above, line) {
            Ok(face) => self.write_face(&face, line),
            Err(defect) => self.defects.add(defect, self.path, line),
        }
        Ok(())
    }

    /// Resolves the indices of a face, or says why it cannot be used.
    fn checked(
        &mut self,
        corners: &[[Option<i64>; 3]],
        above: &Above,
        line: usize,
    ) -> Result<Face, Defect> {
        if corners.len() < 3 {
            return Err(Defect::TooFewCorners);
        }
        let usable = &self.usable;
        let column = |part: usize, above: usize, usable: &[bool]| -> Option<Vec<usize>> {
            let resolve = |corner: &[Option<i64>; 3]| resolved(corner[part]?, above, usable.len());
            corners.iter().map(resolve).collect()
        };
        let all_usable =
            |indices: &Vec<usize>, usable: &[bool]| indices.iter().all(|&i| usable[i - 1]);

        let positions = column(0, above.positions, &usable.positions).ok_or(Defect::Index)?;
        if !all_usable(&positions, &usable.positions) {
            return Err(Defect::NotFinite);
        }
        let texture_coordinates = column(1, above.texture_coordinates, &usable.texture_coordinates)
            .filter(|indices| all_usable(indices, &usable.texture_coordinates));
        let normals = column(2, above.normals, &usable.normals)
            .filter(|indices| self.reads_normals && all_usable(indices, &usable.normals));

        // A part that all corners leave out is no defect.
        let given = |part: usize| corners.iter().all(|corner| corner[part].is_some());
        if given(1) && texture_coordinates.is_none() {
            self.defects.add(Defect::TextureCoordinate, self.path, line);
        }
        if given(2) && self.reads_normals && normals.is_none() {
            self.defects.add(Defect::Normal, self.path, line);
        }
        Ok(Face {
            positions,
            texture_coordinates,
            normals,
        })
    }

    fn write_face(&mut self, face: &Face, line: usize) {
        self.text.push('f');
        for (corner, position) in face.positions.iter().enumerate() {
            let texture_coordinate = face.texture_coordinates.as_ref().map(|all| all[corner]);
            let normal = face.normals.as_ref().map(|all| all[corner]);
            match (texture_coordinate, normal) {
                (None, None) => write!(self.text, " {position}"),
                (Some(t), None) => write!(self.text, " {position}/{t}"),
                (None, Some(n)) => write!(self.text, " {position}//{n}"),
                (Some(t), Some(n)) => write!(self.text, " {position}/{t}/{n}"),
            }
            .expect("a string takes any text");
        }
        self.text.push('\n');
        self.faces.push(FaceNote {
            line,
            corner_count: face.positions.len(),
            has_normals: face.normals.is_some(),
            has_texture_coordinates: face.texture_coordinates.is_some(),
        });
    }

    fn error(&self, statement: &Statement<'_>, message: &str) -> SceneError {
        let shown: String = statement.rest.chars().take(60).collect();
        SceneError::Mesh {
            place: Place::of_line(self.path, statement.line).to_string(),
            message: format!(
                "cannot understand `{} {shown}`: {message}",
                statement.keyword
            ),
        }
    }
}

/// Position, texture coordinate and normal of a corner as written.
fn corner(word: &str) -> Option<[Option<i64>; 3]> {
    let mut parts = [None; 3];
    for (part, text) in word.split('/').enumerate() {
        let slot = parts.get_mut(part)?;
        if !text.is_empty() {
            *slot = Some(index(text)?);
        }
    }
    parts[0].is_some().then_some(parts)
}

/// An index as written; one that is beyond 64 bits counts as out of range.
fn index(text: &str) -> Option<i64> {
    match text.parse::<i64>() {
        Ok(index) => Some(index),
        Err(error) => match error.kind() {
            IntErrorKind::PosOverflow | IntErrorKind::NegOverflow => Some(0),
            _ => None,
        },
    }
}

/// Index from 1 of what an index as written means; negative ones count back
/// from the statements above.
fn resolved(index: i64, above: usize, count: usize) -> Option<usize> {
    let absolute = if index < 0 {
        above.checked_sub(usize::try_from(index.unsigned_abs()).ok()?)? + 1
    } else {
        usize::try_from(index).ok()?
    };
    (1..=count).contains(&absolute).then_some(absolute)
}
