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
mod layout;
mod lists;
mod numbers;
#[cfg(test)]
mod tests;
mod values;

use std::path::Path;

use glam::Vec3;

use super::file::Document;
use super::files::{Disk, Files, Finder};
use super::images::Images;
use super::text::strict_text;
use super::{Camera, Light, Override, RenderKeys, SceneError};
use changes::Changes;
use editor::Editor;

pub(crate) use file::{Saved, save_file};

/// Byte order mark of UTF-8.
const MARK: &str = "\u{feff}";

/// What of a scene can be edited and saved, before or after: its lights, the albedos of its
/// materials, its camera and its `[render]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edited<'a> {
    /// Lights that were loaded, in their order, and new ones behind them.
    pub(crate) lights: &'a [Light],
    /// Names of the materials of the scene.
    pub(crate) material_names: &'a [String],
    /// One of each material.
    pub(crate) albedos: &'a [Vec3],
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

/// The bytes of a scene file with what was edited: what was given by overrides
/// when it was loaded is not written unless it was edited. `path` is what
/// errors call it, and where relative paths start.
///
/// The new text is read once more before it is given out: reading it with the
/// same overrides gives exactly the edited values, bit for bit.
///
/// # Errors
/// If the bytes are no longer those that were loaded, or what would be written
/// is refused by the reader (a key frame of `[[animate]]` may contradict an
/// edited value).
pub(crate) fn edited_bytes(
    bytes: &[u8],
    path: &Path,
    overrides: &[Override],
    loaded: Edited<'_>,
    edited: Edited<'_>,
) -> Result<Vec<u8>, SaveError> {
    edited_bytes_with(bytes, path, overrides, loaded, edited, &Disk)
}

fn edited_bytes_with(
    bytes: &[u8],
    path: &Path,
    overrides: &[Override],
    loaded: Edited<'_>,
    edited: Edited<'_>,
    files: &dyn Files,
) -> Result<Vec<u8>, SaveError> {
    let text = strict_text(bytes, path)?;
    let new_text = edited_text(text, loaded, edited)?;
    if new_text == text {
        return Ok(bytes.to_vec());
    }
    let finder = Finder::new(files);
    let images = Images::new(&finder);
    let read = Document::parse(&new_text, path, &still_meant(overrides, edited), &images)?;
    check(&read, edited, overrides.is_empty())?;
    let mark = if bytes.starts_with(MARK.as_bytes()) {
        MARK
    } else {
        ""
    };
    Ok(format!("{mark}{new_text}").into_bytes())
}

/// Overrides but for those of lights that are gone.
fn still_meant(overrides: &[Override], edited: Edited<'_>) -> Vec<Override> {
    let exists = |name: &str| edited.lights.iter().any(|light| light.name == name);
    let meant = overrides
        .iter()
        .filter(|set| set.light_name().is_none_or(exists));
    meant.cloned().collect()
}

/// With overrides a value that was both overridden and edited reads as the
/// override says, so that only without them everything is compared.
fn check(read: &Document, edited: Edited<'_>, is_whole: bool) -> Result<(), SaveError> {
    if !is_whole {
        return Ok(());
    }
    let lights_differ = read.lights.len() != edited.lights.len()
        || read.lights.iter().zip(edited.lights).any(|(read, edited)| {
            read.name != edited.name || values::differ(&read.kind, &edited.kind)
        });
    for (what, differs) in [
        ("a light", lights_differ),
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

/// The text of a scene file (without a byte order mark) with what was edited.
fn edited_text(text: &str, loaded: Edited<'_>, edited: Edited<'_>) -> Result<String, SaveError> {
    let mut editor = Editor::new(text);
    let changes = Changes::between(loaded, edited);
    changes.apply(&mut editor)?;
    Ok(editor.into_text())
}
