//! Counts what is wrong with a file: one warning a kind, at the first place.

use std::path::Path;

use crate::scene::place::Place;

/// What can be wrong with a mesh without being an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Defect {
    TooFewCorners,
    Index,
    NotFinite,
    ZeroArea,
    Normal,
    TextureCoordinate,
    FreeForm,
    UnknownMaterial,
    RepeatedMaterial,
    NamelessMaterial,
    ColourForm,
    ColourNumber,
    ColourAboveOne,
    Negative,
    MapPath,
}

impl Defect {
    fn text(self) -> &'static str {
        match self {
            Self::TooFewCorners => "dropped a face with fewer than three corners",
            Self::Index => "dropped a face with a corner index of 0 or beyond the vertices",
            Self::NotFinite => "dropped a face with a corner that is NaN, infinite or beyond 1e30",
            Self::ZeroArea => "dropped a triangle of zero area",
            Self::Normal => {
                "a face has a normal that is missing, zero or not finite; it is drawn flat"
            }
            Self::TextureCoordinate => {
                "a face has a texture coordinate that is missing or not finite; \
                 it is drawn without texture"
            }
            Self::FreeForm => "free-form curves and surfaces are left out; export polygons",
            Self::UnknownMaterial => {
                "usemtl names a material that no MTL file defines; grey of albedo 0.8 is used"
            }
            Self::RepeatedMaterial => "a material is defined again; its first definition is used",
            Self::NamelessMaterial => "newmtl without a name; its statements are left out",
            Self::ColourForm => {
                "a colour given as a spectrum or as xyz is not understood; its default is used"
            }
            Self::ColourNumber => {
                "a value is missing, not a number or not finite; its default is used"
            }
            Self::ColourAboveOne => "a reflectance above 1 is clamped to 1",
            Self::Negative => "a negative value is clamped to 0",
            Self::MapPath => "a texture has no file name; it is left out",
        }
    }
}

/// The defects found so far, in the order of their first appearance.
#[derive(Debug, Default)]
pub(super) struct Defects {
    counted: Vec<(Defect, Place, usize)>,
    others: Vec<String>,
}

impl Defects {
    /// Counts a defect.
    pub(super) fn add(&mut self, defect: Defect, path: &Path, line: usize) {
        match self.counted.iter_mut().find(|(known, ..)| *known == defect) {
            Some((_, _, count)) => *count += 1,
            None => self.counted.push((defect, Place::of_line(path, line), 1)),
        }
    }

    /// A warning with a text of its own.
    pub(super) fn warn(&mut self, path: &Path, line: usize, text: &str) {
        self.others
            .push(format!("{}: {text}", Place::of_line(path, line)));
    }

    /// One sentence a kind.
    pub(super) fn into_warnings(self) -> Vec<String> {
        let counted = self.counted.into_iter();
        let sentences = counted.map(|(defect, place, count)| match count {
            1 => format!("{place}: {}", defect.text()),
            _ => format!(
                "{place}: {} ({count} in all, the first one here)",
                defect.text()
            ),
        });
        self.others.into_iter().chain(sentences).collect()
    }
}
