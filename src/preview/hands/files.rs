//! The scene's file below the hands: saved, or changed by someone else.

use std::path::Path;
use std::time::Duration;

use super::Hands;
use crate::preview::command::Command;
use crate::preview::document::Document;
use crate::preview::history::History;
use crate::scene::{Edited, Light, Override, SaveError, Scene, edited_bytes};

impl Hands {
    /// What is now is what the file holds.
    pub(crate) fn mark_saved(&mut self) {
        self.saved = self.document.clone();
    }

    /// The bytes of the scene file with what was edited since it was loaded or
    /// saved last, when it held `bytes`; `overrides` as it was loaded with. Mute and
    /// solo are not saved.
    ///
    /// # Errors
    /// As [`edited_bytes`].
    pub(crate) fn saved_bytes(
        &self,
        bytes: &[u8],
        path: &Path,
        overrides: &[Override],
    ) -> Result<Vec<u8>, SaveError> {
        let lights = [&self.saved, &self.document].map(Document::lights);
        let loaded = self.as_saved(&self.saved, &lights[0]);
        let edited = self.as_saved(&self.document, &lights[1]);
        edited_bytes(bytes, path, overrides, loaded, edited)
    }

    fn as_saved<'a>(&'a self, document: &'a Document, lights: &'a [Light]) -> Edited<'a> {
        Edited {
            lights,
            material_names: &self.material_names,
            albedos: &document.albedos,
            camera: &document.camera,
            render: &document.render,
        }
    }

    /// Takes over a scene whose files were changed by someone else. Lights that
    /// were muted or soloed still are, and undo returns to what was before unless
    /// the materials are others.
    pub(crate) fn reload(&mut self, scene: &Scene) {
        let mut document = Document::of_scene(scene, self.document.component);
        for edited in &mut document.lights {
            let mut known = self.document.lights.iter();
            if let Some(known) = known.find(|known| known.light.name == edited.light.name) {
                (edited.is_muted, edited.is_soloed) = (known.is_muted, known.is_soloed);
            }
        }
        let names: Vec<String> = scene.materials.iter().map(|m| m.name.clone()).collect();
        if names == self.material_names {
            self.record(Command::ResetView, Duration::ZERO, true);
        } else {
            self.history = History::default();
            self.material_names = names;
        }
        self.saved = document.clone();
        self.document = document;
        self.home = scene.camera;
        self.pinned = pinned(scene);
        self.drag = None;
        self.clamp_selection();
    }
}

/// Lights that `[[animate]]` or `set` of `[golden]` point at: without them the file
/// would be refused.
pub(super) fn pinned(scene: &Scene) -> Vec<String> {
    let animated = scene
        .animations
        .iter()
        .map(|animation| animation.target.as_str());
    let golden = scene.golden.set.iter().map(String::as_str);
    let targets = animated
        .map(|target| format!("{target}=0"))
        .chain(golden.map(str::to_owned));
    let named = targets.filter_map(|text| {
        let set = Override::parse(&text).ok()?;
        set.light_name().map(str::to_owned)
    });
    named.collect()
}
