//! Materials: finds the MTL files of an OBJ file, checks their statements with
//! line numbers, and writes one text for tobj, which would stop (or panic) at
//! colours of one or two numbers. Textures go past it, since it keeps neither
//! their options nor their places.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use super::lines::{Statement, normalized, number, statements};
use super::texture_statement;
use crate::brdf::{DIELECTRIC, roughness_of_exponent};
use crate::scene::defects::{Defect, Defects};
use crate::scene::file::fields::LARGEST;
use crate::scene::file::shortened;
use crate::scene::files::{Finder, ReadFile};
use crate::scene::maps::{MapStatement, MaterialMaps};
use crate::scene::place::Place;
use crate::scene::text::lenient_text;
use crate::scene::{Material, SceneError};

/// The materials of all MTL files that an OBJ file names.
#[derive(Debug, Default)]
pub(super) struct Libraries {
    text: String,
    notes: Vec<Note>,
    /// Index into the notes by name.
    index_of: BTreeMap<String, usize>,
    is_any_named: bool,
}

/// What tobj does not keep of a material.
#[derive(Debug)]
struct Note {
    place: Place,
    maps: MaterialMaps,
}

impl Libraries {
    /// Reads every MTL file that a normalised OBJ text names.
    ///
    /// # Errors
    /// MTL files that are no text. One that cannot be read is a warning.
    pub(super) fn read(
        text: &str,
        path: &Path,
        finder: &Finder<'_>,
        defects: &mut Defects,
    ) -> Result<Self, SceneError> {
        let mut libraries = Self::default();
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut done: BTreeSet<PathBuf> = BTreeSet::new();
        for statement in statements(text).filter(|s| s.keyword == "mtllib") {
            libraries.is_any_named = true;
            for (library, bytes) in files(&statement, folder, finder) {
                if !done.insert(library.clone()) {
                    continue;
                }
                match bytes {
                    Ok(bytes) => {
                        let text = lenient_text(&bytes, &library)?;
                        libraries.add(&normalized(&text), &library, defects);
                    }
                    Err(error) => {
                        let text = format!(
                            "cannot read the material file {} ({error}); {}",
                            library.display(),
                            Defect::Library.text()
                        );
                        let place = Place::of_line(path, statement.line);
                        defects.add_text(Defect::Library, &place, &text);
                    }
                }
            }
        }
        Ok(libraries)
    }

    /// The defined material that a `usemtl` statement means; a comment may
    /// follow its name.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn named<'a>(&self, name: &'a str) -> Result<&'a str, String> {
        let before_comment = name.split(" #").next().unwrap_or(name).trim_end();
        let mut names = [name, before_comment].into_iter();
        if let Some(known) = names.find(|name| self.index_of.contains_key(*name)) {
            return Ok(known);
        }
        let reason = if self.is_any_named {
            "which no MTL file defines"
        } else {
            "but the file names no MTL file (mtllib)"
        };
        Err(format!("usemtl names {:?}, {reason}", shortened(name)))
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
        // Statements above the first material, and those of a material that is
        // not taken, belong to nothing.
        let mut is_open = false;
        for statement in statements(text) {
            if statement.keyword.eq_ignore_ascii_case("newmtl") {
                let name = statement.rest;
                is_open = !name.is_empty() && !self.index_of.contains_key(name);
                if is_open {
                    writeln!(self.text, "newmtl {name}").expect("a string takes any text");
                    self.index_of.insert(name.to_owned(), self.notes.len());
                    self.notes.push(Note {
                        place: Place::of_line(path, statement.line),
                        maps: MaterialMaps::default(),
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
            "map_kd" | "map_ke" => {
                let map = map_statement(statement, path, &mut add);
                let note = self.notes.last_mut().expect("a material is open");
                if keyword == "map_kd" {
                    note.maps.albedo = map;
                } else {
                    note.maps.emission = map;
                }
                None
            }
            _ => None,
        };
        if let Some(line) = line {
            self.text.push_str(&line);
            self.text.push('\n');
        }
    }
}

/// The files that a `mtllib` statement names: one whose name may hold spaces,
/// or else several separated by spaces.
fn files(statement: &Statement<'_>, folder: &Path, finder: &Finder<'_>) -> Vec<ReadFile> {
    let whole = finder.read_named(folder, statement.rest);
    if whole.1.is_ok() || !statement.rest.contains(char::is_whitespace) {
        return vec![whole];
    }
    let words = statement.words();
    let several: Vec<ReadFile> = words.map(|name| finder.read_named(folder, name)).collect();
    if several.iter().any(|(_, bytes)| bytes.is_ok()) {
        several
    } else {
        vec![whole]
    }
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

/// A map of a material, before the colour beside it is known.
fn map_statement(
    statement: &Statement<'_>,
    path: &Path,
    add: &mut dyn FnMut(Defect),
) -> Option<MapStatement> {
    let texture = texture_statement::parse(statement.rest, add)?;
    Some(MapStatement {
        name: texture.name.to_owned(),
        folder: path.parent().unwrap_or(Path::new("")).to_owned(),
        place: Place::of_line(path, statement.line),
        scale: texture.scale,
        offset: texture.offset,
        clamp: texture.clamp,
        stands_alone: false,
        is_of_metal: false,
    })
}

/// A material of tobj in our terms. Its colours are those that it has without
/// the maps.
fn converted(material: &tobj::Material, note: &Note) -> (Material, MaterialMaps) {
    let rgb = |colour: [f64; 3]| DVec3::from_array(colour).as_vec3();
    let unknown = |key: &str| material.unknown_param.get(key);
    let parameter = |key: &str| unknown(key).and_then(|text| text.parse::<f64>().ok());
    let mut maps = note.maps.clone();
    let mut albedo = material.diffuse.map(rgb);
    let mut emission = material.emissive.map(rgb);
    for (map, colour) in [
        (&mut maps.albedo, &mut albedo),
        (&mut maps.emission, &mut emission),
    ] {
        if let Some(map) = map {
            *colour = colour.filter(|&colour| colour != Vec3::ZERO);
            map.stands_alone = colour.is_none();
        }
    }
    let gloss = MtlGloss {
        ks: material.specular.map(rgb),
        ns: material.shininess,
        pr: parameter("Pr"),
        pm: parameter("Pm"),
    };
    let stands_alone = maps.albedo.as_ref().is_some_and(|map| map.stands_alone);
    let base = albedo.unwrap_or(match stands_alone {
        true => Vec3::ONE,
        false => Material::unnamed().albedo,
    });
    if let Some(map) = &mut maps.albedo {
        map.is_of_metal = gloss.metalness() > 0.0;
    }
    let diffuse_share = 1.0 - gloss.metalness();
    if diffuse_share < 1.0 {
        // What the map is multiplied by is said here.
        maps.albedo
            .iter_mut()
            .for_each(|map| map.stands_alone = false);
        albedo = Some(base * diffuse_share);
    }
    let material = Material {
        name: material.name.clone(),
        albedo: albedo.unwrap_or(Material::unnamed().albedo),
        emission: emission.unwrap_or(Vec3::ZERO),
        albedo_map: None,
        emission_map: None,
        specular: gloss.specular(base),
        roughness: gloss.roughness(),
    };
    (material, maps)
}

/// What MTL says of a lobe: `Pr` and `Pm` (roughness and metalness, as glTF has
/// them) win over `Ks` and `Ns`.
struct MtlGloss {
    ks: Option<Vec3>,
    ns: Option<f64>,
    pr: Option<f64>,
    pm: Option<f64>,
}

impl MtlGloss {
    fn metalness(&self) -> f32 {
        self.pm.unwrap_or(0.0) as f32
    }

    /// Specular colour of a material whose colour is `base`. `Pr` alone leaves
    /// `Ks` what it is.
    fn specular(&self, base: Vec3) -> Vec3 {
        let dielectric = Vec3::splat(DIELECTRIC);
        match (self.pm, self.ks) {
            (Some(metalness), _) => dielectric.lerp(base, metalness as f32),
            (None, Some(ks)) => ks,
            (None, None) if self.pr.is_some() => dielectric,
            (None, None) => Vec3::ZERO,
        }
    }

    fn roughness(&self) -> Option<f32> {
        let of_exponent = || self.ns.map(roughness_of_exponent);
        let roughness = self.pr.or_else(of_exponent);
        roughness.map(|roughness| roughness as f32)
    }
}
