//! Writes an edited scene back into the text it came from.
//!
//! Comes in: the bytes of the scene file, the scene as it was when the file held
//! them, and as it is now. Goes out: new bytes in which only the values that
//! differ between the two are other; comments, order, line ends and layout stay,
//! because pieces of the text are replaced instead of the text being written
//! anew. `toml_edit` says where the pieces are ([`layout`]).

mod changes;
mod editor;
mod file;
mod in_force;
mod layout;
mod lists;
mod materials;
mod numbers;
mod spots;
#[cfg(test)]
mod tests;
mod values;

use std::path::Path;

use super::file::Document;
use super::files::{Disk, Files, Finder};
use super::images::Images;
use super::text::strict_text;
use super::{Camera, Light, Override, Reflection, RenderKeys, SceneError};
use changes::Changes;
use editor::Editor;
use values::reflection_keys;

pub(crate) use file::{Saved, save_file};

/// Byte order mark of UTF-8.
const MARK: &str = "\u{feff}";

/// What of a scene can be edited and saved, before or after: its lights, how its
/// materials reflect, its camera and its `[render]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edited<'a> {
    /// Lights that were loaded, in their order, and new ones behind them.
    pub(crate) lights: &'a [Light],
    /// Names of the materials of the scene.
    pub(crate) material_names: &'a [String],
    /// One of each material.
    pub(crate) reflections: &'a [Reflection],
    pub(crate) camera: &'a Camera,
    pub(crate) render: &'a RenderKeys,
}

/// Why an edited scene was not put into its file's text.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SaveError {
    /// The text is not what the scene was loaded from.
    #[error("{0}; reload the scene, or save it under another name")]
    NotTheText(String),
    /// The text that was made would not be read as the edited scene.
    #[error("the edited scene file would not be understood; nothing was written")]
    Refused(#[from] SceneError),
    /// The text that was made would be read as something else.
    #[error("{0} would be read back with other values; nothing was written")]
    OtherValues(&'static str),
}

/// What a scene file is to hold, and how it is read from then on.
#[derive(Debug)]
pub(crate) struct EditedFile {
    pub(crate) bytes: Vec<u8>,
    /// Those of the overrides that still hold: none of a key that the bytes give as
    /// it was edited, and none of a light that is gone.
    pub(crate) overrides: Vec<Override>,
}

/// A scene file with what was edited: what was given by overrides when it was
/// loaded is not written unless it was edited. `path` is what errors call it, and
/// where relative paths start.
///
/// The new text is read once more before it is given out: reading it with the
/// overrides that still hold gives exactly the edited values, bit for bit.
///
/// # Errors
/// If the bytes are no longer those that were loaded, or what would be written
/// is refused by the reader (a key frame of `[[animate]]` may contradict an
/// edited value).
pub(crate) fn edited_file(
    bytes: &[u8],
    path: &Path,
    overrides: &[Override],
    loaded: Edited<'_>,
    edited: Edited<'_>,
) -> Result<EditedFile, SaveError> {
    edited_file_with(bytes, path, overrides, loaded, edited, &Disk)
}

fn edited_file_with(
    bytes: &[u8],
    path: &Path,
    overrides: &[Override],
    loaded: Edited<'_>,
    edited: Edited<'_>,
    files: &dyn Files,
) -> Result<EditedFile, SaveError> {
    let text = strict_text(bytes, path)?;
    let mut editor = Editor::new(text);
    let overrides = Changes::between(loaded, edited).apply(&mut editor, overrides)?;
    let new_text = editor.into_text();
    if new_text == text {
        let bytes = bytes.to_vec();
        return Ok(EditedFile { bytes, overrides });
    }
    let finder = Finder::new(files);
    let images = Images::new(&finder);
    let read = Document::parse(&new_text, path, &overrides, &images)?;
    check(&read, loaded, edited)?;
    let mark = if bytes.starts_with(MARK.as_bytes()) {
        MARK
    } else {
        ""
    };
    let bytes = format!("{mark}{new_text}").into_bytes();
    Ok(EditedFile { bytes, overrides })
}

/// Whatever was edited is read back, and so is all that an override gave and still
/// gives.
fn check(read: &Document, loaded: Edited<'_>, edited: Edited<'_>) -> Result<(), SaveError> {
    let lights_differ = read.lights.len() != edited.lights.len()
        || read.lights.iter().zip(edited.lights).any(|(read, edited)| {
            read.name != edited.name || values::differ(&read.kind, &edited.kind)
        });
    for (what, differs) in [
        ("a light", lights_differ),
        ("a material", materials_differ(read, loaded, edited)),
        (
            "the camera",
            values::cameras_differ(&read.camera, edited.camera),
        ),
        ("[render]", read.render != *edited.render),
    ] {
        if differs {
            return Err(SaveError::OtherValues(what));
        }
    }
    Ok(())
}

/// What no `[[material]]` gives is of MTL, so it must be as it was loaded; and so
/// must be what a `brdf` makes of it, which stays only where neither was edited.
fn materials_differ(read: &Document, loaded: Edited<'_>, edited: Edited<'_>) -> bool {
    let names = edited.material_names;
    let is_first = |index: &usize| !names[..*index].contains(&names[*index]);
    (0..names.len()).filter(is_first).any(|index| {
        let mut entries = read.materials.iter();
        let entry = entries.find(|entry| entry.name == names[index]);
        let [mut read, edited] = [loaded, edited].map(|it| it.reflections[index]);
        if let Some(entry) = entry {
            let albedo = entry.albedo.filter(|_| entry.brdf.is_none());
            read.albedo = albedo.unwrap_or(read.albedo);
            read.specular = entry.specular.unwrap_or(read.specular);
            read.roughness = entry.roughness.unwrap_or(read.roughness);
        }
        !values::changed(reflection_keys(read), reflection_keys(edited)).is_empty()
    })
}
