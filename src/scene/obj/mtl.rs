//! Materials: finds the MTL files of an OBJ file, checks their statements with
//! line numbers, and writes one text for tobj, which would stop (or panic) at
//! colours of one or two numbers and take options for part of a file name.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};

use super::ReadFile;
use super::defects::{Defect, Defects};
use super::lines::{Statement, normalized, number, statements};
use crate::scene::file::fields::LARGEST;
use crate::scene::maps::{MapStatement, MaterialMaps};
use crate::scene::place::Place;
use crate::scene::text::lenient_text;
use crate::scene::{Material, SceneError};

/// Options of texture statements and the most words that follow each.
const MAP_OPTIONS: [(&str, usize); 15] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
    ("-opaque", 0),
];

/// Options whose words are numbers, of which some may be left out.
const NUMBER_OPTIONS: [&str; 3] = ["-o", "-s", "-t"];

/// The materials of all MTL files that an OBJ file names.
#[derive(Debug, Default)]
pub(super) struct Libraries {
    text: String,
    notes: Vec<Note>,
}

/// What tobj does not keep of a material.
#[derive(Debug)]
struct Note {
    name: String,
    place: Place,
    /// Folder of the MTL file, where its texture paths start.
    folder: PathBuf,
}

impl Libraries {
    /// Reads every MTL file that a normalised OBJ text names.
    ///
    /// # Errors
    /// MTL files that are no text. One that cannot be read is a warning.
    pub(super) fn read(
        text: &str,
        path: &Path,
        read: ReadFile<'_>,
        defects: &mut Defects,
    ) -> Result<Self, SceneError> {
        let mut libraries = Self::default();
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut done: Vec<PathBuf> = Vec::new();
        for statement in statements(text).filter(|s| s.keyword == "mtllib") {
            for (library, bytes) in files(statement.rest, folder, read) {
                if done.contains(&library) {
                    continue;
                }
                match bytes {
                    Ok(bytes) => {
                        let text = lenient_text(&bytes, &library)?;
                        libraries.add(&normalized(&text), &library, defects);
                    }
                    Err(error) => {
                        let file = library.display();
                        let text = format!("cannot read the material file {file} ({error})");
                        defects.warn(path, statement.line, &text);
                    }
                }
                done.push(library);
            }
        }
        Ok(libraries)
    }

    /// Whether a material of this name is defined.
    pub(super) fn knows(&self, name: &str) -> bool {
        self.notes.iter().any(|note| note.name == name)
    }

    /// The text for tobj.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Where the materials are defined.
    pub(super) fn places(&self) -> Vec<Place> {
        self.notes.iter().map(|note| note.place.clone()).collect()
    }

    /// The materials that tobj made of [`Self::text`].
    pub(super) fn materials(
        &self,
        parsed: &[tobj::Material],
    ) -> (Vec<Material>, Vec<MaterialMaps>) {
        let both = parsed.iter().zip(&self.notes);
        both.map(|(material, note)| converted(material, note))
            .unzip()
    }

    fn add(&mut self, text: &str, path: &Path, defects: &mut Defects) {
        let folder = path.parent().unwrap_or(Path::new(""));
        // Statements above the first material, and those of a material that is
        // not taken, belong to nothing.
        let mut is_open = false;
        for statement in statements(text) {
            if statement.keyword.eq_ignore_ascii_case("newmtl") {
                let name = statement.rest;
                is_open = !name.is_empty() && !self.knows(name);
                if is_open {
                    writeln!(self.text, "newmtl {name}").expect("a string takes any text");
                    self.notes.push(Note {
                        name: name.to_owned(),
                        place: Place::of_line(path, statement.line),
                        folder: folder.to_owned(),
                    });
                } else if name.is_empty() {
                    defects.add(Defect::NamelessMaterial, path, statement.line);
                } else {
                    defects.add(Defect::RepeatedMaterial, path, statement.line);
                }
            } else if is_open {
                self.property(&statement, path, defects);
            }
        }
    }

    /// Writes a statement inside a material, checked and clamped.
    fn property(&mut self, statement: &Statement<'_>, path: &Path, defects: &mut Defects) {
        let mut add = |defect| defects.add(defect, path, statement.line);
        let keyword = statement.keyword.to_ascii_lowercase();
        let line = match keyword.as_str() {
            "kd" => colour(statement, 1.0, &mut add).map(|[r, g, b]| format!("Kd {r} {g} {b}")),
            "ks" => colour(statement, 1.0, &mut add).map(|[r, g, b]| format!("Ks {r} {g} {b}")),
            "ke" => colour(statement, LARGEST, &mut add).map(|[r, g, b]| format!("Ke {r} {g} {b}")),
            "ns" => scalar(statement, LARGEST, &mut add).map(|x| format!("Ns {x}")),
            "pr" => scalar(statement, 1.0, &mut add).map(|x| format!("Pr {x}")),
            "pm" => scalar(statement, 1.0, &mut add).map(|x| format!("Pm {x}")),
            "map_kd" => map_path(statement.rest, &mut add).map(|file| format!("map_Kd {file}")),
            "map_ke" => map_path(statement.rest, &mut add).map(|file| format!("map_Ke {file}")),
            _ => None,
        };
        if let Some(line) = line {
            self.text.push_str(&line);
            self.text.push('\n');
        }
    }
}

type Files = Vec<(PathBuf, std::io::Result<Vec<u8>>)>;

/// The files that a `mtllib` statement names: one whose name may hold spaces,
/// or else several separated by spaces.
fn files(names: &str, folder: &Path, read: ReadFile<'_>) -> Files {
    let open = |name: &str| {
        let path = folder.join(native(name));
        let bytes = read(&path);
        (path, bytes)
    };
    let (whole, bytes) = open(names);
    let is_missing = matches!(&bytes, Err(e) if e.kind() == std::io::ErrorKind::NotFound);
    if !is_missing || !names.contains(char::is_whitespace) {
        return vec![(whole, bytes)];
    }
    let several: Files = names.split_whitespace().map(open).collect();
    if several.iter().any(|(_, bytes)| bytes.is_ok()) {
        several
    } else {
        vec![(whole, bytes)]
    }
}

/// A path with the separators that every system knows.
fn native(path: &str) -> String {
    path.replace('\\', "/")
}

/// A colour clamped to 0..`most`, or `None` where the default is to be used.
fn colour(statement: &Statement<'_>, most: f64, add: &mut dyn FnMut(Defect)) -> Option<[f64; 3]> {
    let mut words = statement.words();
    if matches!(words.clone().next(), Some("spectral" | "xyz")) {
        add(Defect::ColourForm);
        return None;
    }
    let first = words.next();
    // A single number stands for all three.
    let rgb = match (words.next(), words.next()) {
        (None, _) => [first, first, first],
        (second, third) => [first, second, third],
    };
    let finite = |word: Option<&str>| number(word?).filter(|x| x.abs() <= LARGEST);
    let [Some(r), Some(g), Some(b)] = rgb.map(finite) else {
        add(Defect::ColourNumber);
        return None;
    };
    Some(clamped([r, g, b], most, add))
}

fn scalar(statement: &Statement<'_>, most: f64, add: &mut dyn FnMut(Defect)) -> Option<f64> {
    let word = statement.words().next();
    match word.and_then(number).filter(|x| x.abs() <= LARGEST) {
        Some(value) => Some(clamped([value], most, add)[0]),
        None => {
            add(Defect::ColourNumber);
            None
        }
    }
}

fn clamped<const N: usize>(values: [f64; N], most: f64, add: &mut dyn FnMut(Defect)) -> [f64; N] {
    if values.iter().any(|&x| x < 0.0) {
        add(Defect::Negative);
    }
    if values.iter().any(|&x| x > most) {
        add(Defect::ColourAboveOne);
    }
    values.map(|x| x.clamp(0.0, most))
}

/// The file name of a texture statement, which may hold spaces, without the
/// options before it.
fn map_path(rest: &str, add: &mut dyn FnMut(Defect)) -> Option<String> {
    let mut name = rest;
    while let Some(after) = without_option(name) {
        name = after;
    }
    if name.is_empty() {
        add(Defect::MapPath);
        return None;
    }
    Some(native(name))
}

/// What follows the option that a text starts with, if it starts with one.
fn without_option(text: &str) -> Option<&str> {
    let (option, mut rest) = split_word(text);
    let (name, most) = MAP_OPTIONS.iter().find(|(name, _)| *name == option)?;
    let only_numbers = NUMBER_OPTIONS.contains(name);
    for _ in 0..*most {
        let (word, after) = split_word(rest);
        // The last word is the file, even where it looks like a number.
        if only_numbers && (number(word).is_none() || after.is_empty()) {
            break;
        }
        rest = after;
    }
    Some(rest)
}

fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

/// A material of tobj in our terms; texture paths start at the note's folder.
fn converted(material: &tobj::Material, note: &Note) -> (Material, MaterialMaps) {
    let rgb = |colour: [f64; 3]| DVec3::from_array(colour).as_vec3();
    let unknown = |key: &str| material.unknown_param.get(key);
    let parameter = |key: &str| unknown(key).and_then(|text| text.parse::<f64>().ok());
    let albedo_map = material.diffuse_texture.as_ref();
    let emission_map = unknown("map_Ke");
    // Exporters write black beside a map, meaning the map alone.
    let or_black = |colour: Option<Vec3>| colour.filter(|&colour| colour != Vec3::ZERO);
    let mut albedo = material.diffuse.map(rgb);
    if albedo_map.is_some() {
        albedo = or_black(albedo);
    }
    let emission = or_black(material.emissive.map(rgb));
    let statement = |file: &String, colour: Option<Vec3>| MapStatement {
        path: note.folder.join(file),
        place: note.place.clone(),
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        clamp: false,
        stands_alone: colour.is_none(),
    };
    let maps = MaterialMaps {
        albedo: albedo_map.map(|file| statement(file, albedo)),
        emission: emission_map.map(|file| statement(file, emission)),
    };
    let specular = material.specular.map_or(Vec3::ZERO, rgb);
    let material = Material {
        name: material.name.clone(),
        albedo: albedo.unwrap_or(Material::unnamed().albedo),
        emission: emission.unwrap_or(Vec3::ZERO),
        albedo_map: None,
        emission_map: None,
        specular,
        roughness: parameter("Pr")
            .or_else(|| material.shininess.map(roughness_from_exponent))
            .map(|roughness| roughness as f32),
    };
    (material, maps)
}

/// Beckmann roughness of a Phong exponent (Walter et al. 2007, "Microfacet
/// Models for Refraction through Rough Surfaces", section 5.2): the exponent
/// is 2 / roughness^2 - 2.
fn roughness_from_exponent(exponent: f64) -> f64 {
    (2.0 / (exponent + 2.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_no_part_of_a_file_name() {
        let name = |text| map_path(text, &mut |_| {});
        assert_eq!(name("texture 01.png").as_deref(), Some("texture 01.png"));
        assert_eq!(name("-s 1 1 1 -o 0.1 a b.png").as_deref(), Some("a b.png"));
        assert_eq!(name("-clamp on a\\b.png").as_deref(), Some("a/b.png"));
        assert_eq!(name("-s 1 1 7").as_deref(), Some("7"));
        assert_eq!(name("-type sphere"), None);
        assert_eq!(name("-mm 0 1 -x.png").as_deref(), Some("-x.png"));
    }
}
