//! The scene's file below the hands: saved, or changed by someone else.

use std::path::Path;
use std::time::Duration;

use super::{Gesture, Hands, Selection, emits};
use crate::preview::document::Document;
use crate::scene::{
    Edited, EditedFile, Light, Override, Reflection, SaveError, Scene, edited_file,
};

impl Hands {
    /// What is now is what the file holds.
    pub(crate) fn mark_saved(&mut self) {
        self.saved = self.document.clone();
    }

    /// The scene file with what was edited since it was loaded or saved last, when
    /// it held `bytes`; `overrides` as they held then. Mute and solo are not saved.
    ///
    /// # Errors
    /// As [`edited_file`].
    pub(crate) fn saved_file(
        &self,
        bytes: &[u8],
        path: &Path,
        overrides: &[Override],
    ) -> Result<EditedFile, SaveError> {
        let lights = [&self.saved, &self.document].map(Document::lights);
        let loaded = self.as_saved(&self.saved, &lights[0]);
        let edited = self.as_saved(&self.document, &lights[1]);
        edited_file(bytes, path, overrides, loaded, edited)
    }

    fn as_saved<'a>(&'a self, document: &'a Document, lights: &'a [Light]) -> Edited<'a> {
        Edited {
            lights,
            material_names: &self.material_names,
            reflections: &document.reflections,
            camera: &document.camera,
            render: &document.render,
        }
    }

    /// Takes over a scene whose files were changed by someone else. Lights that
    /// were muted or soloed still are, and undo returns to what was before; of
    /// materials that have come since then it leaves the reflection alone.
    pub(crate) fn reload(&mut self, scene: &Scene) {
        let mut document = Document::of_scene(scene, self.document.component);
        for edited in &mut document.lights {
            let mut known = self.document.lights.iter();
            if let Some(known) = known.find(|known| known.light.name == edited.light.name) {
                (edited.is_muted, edited.is_soloed) = (known.is_muted, known.is_soloed);
            }
        }
        self.history.record(
            (self.document.clone(), self.selection),
            Gesture::Reload,
            Duration::ZERO,
        );
        self.history.end_gesture();
        let names: Vec<String> = scene.materials.iter().map(|m| m.name.clone()).collect();
        if names != self.material_names {
            self.rename_materials(names, &document.reflections);
        }
        self.saved = document.clone();
        self.document = document;
        self.home = scene.camera;
        self.pinned = pinned(scene);
        self.emits = emits(scene);
        self.drag = None;
        self.clamp_selection();
    }

    /// Takes over a scene of which other files than the scene file were changed: a
    /// mesh or its materials. What was edited stays, and what can be undone.
    pub(crate) fn refresh(&mut self, scene: &Scene) {
        let names: Vec<String> = scene.materials.iter().map(|m| m.name.clone()).collect();
        let origins = origins(&self.material_names, &names);
        let saved = std::mem::take(&mut self.saved.reflections);
        let fresh = Reflection::of_all(&scene.materials);
        let rebased = |document: &Document| -> Vec<Reflection> {
            let pairs = origins.iter().zip(&fresh);
            let of_origin = |origin: usize, fresh: Reflection| {
                let edited = document.reflections.get(origin)?;
                Some(edited.rebased(*saved.get(origin)?, fresh))
            };
            pairs
                .map(|(origin, fresh)| {
                    let known = origin.and_then(|origin| of_origin(origin, *fresh));
                    known.unwrap_or(*fresh)
                })
                .collect()
        };
        self.history.for_each(|(document, selection)| {
            document.reflections = rebased(document);
            *selection = carried(*selection, &origins);
        });
        self.document.reflections = rebased(&self.document);
        self.selection = carried(self.selection, &origins);
        self.saved.reflections = fresh;
        self.material_names = names;
        self.emits = emits(scene);
        self.drag = None;
    }

    /// Materials of other names, or in another order, and how they reflect: all that
    /// can be undone, and what is selected, is of them from now on.
    fn rename_materials(&mut self, names: Vec<String>, reflections: &[Reflection]) {
        let old = std::mem::replace(&mut self.material_names, names);
        let origins = origins(&old, &self.material_names);
        self.history.for_each(|(document, selection)| {
            let known = |origin: &Option<usize>| document.reflections.get((*origin)?).copied();
            let pairs = origins.iter().zip(reflections);
            document.reflections = pairs
                .map(|(origin, new)| known(origin).unwrap_or(*new))
                .collect();
            *selection = carried(*selection, &origins);
        });
        self.selection = carried(self.selection, &origins);
    }
}

/// What is selected, once materials have come from others.
fn carried(selection: Selection, origins: &[Option<usize>]) -> Selection {
    let Selection::Surface(index) = selection else {
        return selection;
    };
    let new = origins.iter().position(|origin| *origin == Some(index));
    new.map_or(Selection::Nothing, Selection::Surface)
}

/// Of each material the old one of its name. A second one of a name reflects like
/// the first.
fn origins(old: &[String], new: &[String]) -> Vec<Option<usize>> {
    let count_before = |names: &[String], index: usize| {
        names[..index]
            .iter()
            .filter(|it| **it == names[index])
            .count()
    };
    let of_name = |index: usize| {
        let same = || (0..old.len()).filter(|&known| old[known] == new[index]);
        same()
            .nth(count_before(new, index))
            .or_else(|| same().next())
    };
    (0..new.len()).map(of_name).collect()
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
