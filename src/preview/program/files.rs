//! The scene's files: saved, written beside, read again.

use std::path::{Path, PathBuf};

use super::prompt::Prompt;
use super::{Effect, Program};
use crate::preview::worker::Errand;
use crate::scene::{Saved, Scene, SceneError, save_file};

/// Most pictures of one scene in a folder.
const MOST_PICTURES: u32 = 10_000;

impl Program {
    /// The files that the scene is made of.
    pub(super) fn watched(&self) -> Vec<PathBuf> {
        let named = self.scene.files.iter().cloned();
        std::iter::once(self.file.path.clone())
            .chain(named)
            .collect()
    }

    /// Writes what was edited into the scene file, or asks.
    pub(super) fn save(&mut self) -> Vec<Effect> {
        if !self.hands.is_unsaved() {
            self.status.say("there is nothing to save");
            return Vec::new();
        }
        self.write_scene(true)
    }

    pub(super) fn overwrite(&mut self) -> Vec<Effect> {
        self.write_scene(false)
    }

    fn write_scene(&mut self, asks: bool) -> Vec<Effect> {
        let file = &self.file;
        let edited = self
            .hands
            .saved_bytes(&file.bytes, &file.path, &file.overrides);
        let bytes = match edited {
            Ok(bytes) => bytes,
            Err(error) => return self.fails(error.to_string()),
        };
        let known = asks.then_some(file.bytes.as_slice());
        match save_file(&file.path, known, &bytes) {
            Ok(Saved::Written) => {
                self.file.bytes = bytes;
                self.scene_is_saved();
                self.status.file_error = None;
                self.status
                    .say(format!("saved {}", self.file.path.display()));
                vec![Effect::Watch(self.watched())]
            }
            Ok(Saved::ChangedMeanwhile) => {
                self.prompt = Some(Prompt::Overwrite);
                Vec::new()
            }
            Err(error) => self.fails(format!("cannot write {}: {error}", file.path.display())),
        }
    }

    /// The scene of the file is what was edited.
    fn scene_is_saved(&mut self) {
        self.hands.mark_saved();
        let document = self.hands.document();
        self.scene.lights = document.lights();
        for (material, albedo) in self.scene.materials.iter_mut().zip(&document.albedos) {
            material.albedo = *albedo;
        }
        self.scene.camera = document.camera;
        self.scene.render = document.render.clone();
    }

    /// Files have changed: they are read again, unless that would cost edits.
    pub(super) fn files_changed(&mut self) -> Vec<Effect> {
        if self.hands.is_unsaved() {
            self.prompt = Some(Prompt::Reload);
            return Vec::new();
        }
        vec![Effect::Load]
    }

    /// The files were read again: the new scene is shown, or what is wrong with it.
    pub(super) fn loaded(
        &mut self,
        bytes: Vec<u8>,
        scene: Result<Box<Scene>, SceneError>,
    ) -> Vec<Effect> {
        let scene = match scene {
            Ok(scene) => *scene,
            Err(error) => {
                self.status.file_error = Some(format!("{error}; the last scene is shown"));
                return Vec::new();
            }
        };
        let is_same_mesh = is_same_mesh(&scene, &self.scene);
        self.status.file_error = None;
        self.status.say(reloaded(&scene));
        self.hands.reload(&scene);
        self.file.bytes = bytes;
        self.scene = scene;
        let mut effects = vec![Effect::Watch(self.watched())];
        if !is_same_mesh {
            effects.push(self.prepare());
        }
        effects.push(self.show_anew());
        effects
    }

    /// Writes the frame at the scene's size into a file that is not there yet.
    pub(super) fn write_png(&mut self) -> Vec<Effect> {
        if self.status.baking.is_some() {
            self.status
                .say("the bake is not ready; its light would be missing");
            return Vec::new();
        }
        let stem = self
            .file
            .path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy();
        let names = (1..MOST_PICTURES).map(|number| PathBuf::from(format!("{stem}-{number}.png")));
        let Some(path) = names.into_iter().find(|path| !path.exists()) else {
            return self.fails(format!("there are {MOST_PICTURES} pictures of {stem} here"));
        };
        let size = self.hands.document().camera.size;
        self.status.say(format!("drawing {}", path.display()));
        let wish = Box::new(self.wish());
        vec![Effect::Send(Errand::Write { wish, size, path })]
    }
}

/// Whether the bake and the surface of one scene serve another.
fn is_same_mesh(new: &Scene, old: &Scene) -> bool {
    let names =
        |scene: &Scene| -> Vec<String> { scene.materials.iter().map(|m| m.name.clone()).collect() };
    new.mesh == old.mesh
        && new.bake == old.bake
        && new.texture_filter == old.texture_filter
        && names(new) == names(old)
}

fn reloaded(scene: &Scene) -> String {
    match scene.warnings.as_slice() {
        [] => "read again".to_owned(),
        [first, ..] => format!("read again; {first}"),
    }
}

/// Reads a scene file and all that it names.
pub(crate) fn load(
    path: &Path,
    overrides: &[crate::scene::Override],
) -> (Vec<u8>, Result<Box<Scene>, SceneError>) {
    match std::fs::read(path) {
        Ok(bytes) => {
            let scene = Scene::load_bytes(&bytes, path, overrides).map(Box::new);
            (bytes, scene)
        }
        // The reader of scenes says it in its own words.
        Err(_) => (Vec::new(), Scene::load(path, overrides).map(Box::new)),
    }
}
