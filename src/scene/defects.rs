//! Counts what is wrong with a file: one warning a kind, at the first place.

use std::path::Path;

use super::place::Place;

/// What can be wrong with a mesh or its materials without being an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Defect {
    TooFewCorners,
    Index,
    NotFinite,
    ZeroArea,
    Normal,
    TextureCoordinate,
    FreeForm,
    Library,
    UnknownMaterial,
    RepeatedMaterial,
    NamelessMaterial,
    ColourForm,
    ColourNumber,
    ColourAboveOne,
    Negative,
    MapPath,
    MapOption,
    MissingAlbedoMap,
    MissingEmissionMap,
    NoTextureCoordinates,
    MapOfMetal,
}

impl Defect {
    /// What is wrong, or only what is done about it where the rest needs names.
    pub(crate) fn text(self) -> &'static str {
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
            Self::Library => "materials that only it defines are drawn in grey of albedo 0.8",
            Self::UnknownMaterial => "grey of albedo 0.8 is used",
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
            Self::MapOption => "an option of a texture is not obeyed (only -s, -o and -clamp are)",
            Self::MissingAlbedoMap => "its material is drawn with its Kd alone",
            Self::MissingEmissionMap => "its material emits its Ke alone",
            Self::NoTextureCoordinates => "drawn without texture",
            Self::MapOfMetal => "no map tints a lobe; it reflects Kd or `specular` alone",
        }
    }
}

/// The defects found so far, in the order of their first appearance.
#[derive(Debug, Default)]
pub(crate) struct Defects {
    counted: Vec<Counted>,
}

/// A kind of defect: the sentence about its first appearance, and how many
/// there are.
#[derive(Debug)]
struct Counted {
    defect: Defect,
    first: String,
    count: usize,
}

impl Defects {
    /// Counts a defect whose text says it all.
    pub(crate) fn add(&mut self, defect: Defect, path: &Path, line: usize) {
        self.count(defect, || {
            format!("{}: {}", Place::of_line(path, line), defect.text())
        });
    }

    /// Counts a defect; the first one gets a text of its own.
    pub(crate) fn add_text(&mut self, defect: Defect, place: &Place, text: &str) {
        self.count(defect, || format!("{place}: {text}"));
    }

    /// Counts a defect at a place.
    pub(crate) fn add_at(&mut self, defect: Defect, place: &Place) {
        self.count(defect, || format!("{place}: {}", defect.text()));
    }

    fn count(&mut self, defect: Defect, sentence: impl FnOnce() -> String) {
        match self.counted.iter_mut().find(|known| known.defect == defect) {
            Some(known) => known.count += 1,
            None => self.counted.push(Counted {
                defect,
                first: sentence(),
                count: 1,
            }),
        }
    }

    /// One sentence a kind.
    pub(crate) fn into_warnings(self) -> Vec<String> {
        let sentences = self.counted.into_iter();
        sentences
            .map(|Counted { first, count, .. }| match count {
                1 => first,
                _ => format!("{first} ({count} in all, the first one here)"),
            })
            .collect()
    }
}
