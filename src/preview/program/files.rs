//! The scene's files: saved, written beside, read again.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::prompt::Prompt;
use super::{BakeState, Effect, Program, QuitsAfter};
use crate::preview::message::Loaded;
use crate::preview::watch::{Watched, just_written};
use crate::preview::worker::Errand;
use crate::scene::{EditedFile, Override, Saved, Scene, save_file};

/// What is added to the scene file's name for changes that were not saved: an
/// ending that no scene has.
const UNSAVED: &str = ".unsaved";
/// Most pictures of one scene in a folder.
const MOST_PICTURES: u32 = 10_000;

impl Program {
    /// The files that the scene is made of, as they were at a time.
    pub(super) fn watched(&self, known_at: SystemTime) -> Watched {
        self.watched_with(&self.scene.files, known_at)
    }

    fn watched_with(&self, named: &[PathBuf], known_at: SystemTime) -> Watched {
        let scene = std::iter::once(&self.file.path);
        Watched {
            files: scene.chain(named).cloned().collect(),
            known_at,
        }
    }

    /// The files read again; `is_answered`: also if that costs edits.
    pub(super) fn load(&mut self, is_answered: bool) -> Effect {
        self.loads += 1;
        self.is_loading = true;
        self.load_is_answered = is_answered;
        Effect::Load(self.loads)
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
            .saved_file(&file.bytes, &file.path, &file.overrides);
        let EditedFile { bytes, overrides } = match edited {
            Ok(edited) => edited,
            Err(error) => return self.fails(error.to_string()),
        };
        let known = asks.then_some(file.bytes.as_slice());
        match save_file(&file.path, known, &bytes) {
            Ok(Saved::Written) => {
                self.file.bytes = bytes;
                self.file.overrides = overrides;
                self.scene_is_saved();
                self.status.file_error = None;
                self.status
                    .say(format!("saved {}", self.file.path.display()));
                let mut effects = vec![Effect::Watch(self.watched(just_written()))];
                if self.is_loading {
                    // What is being read is what the file held before.
                    effects.push(self.load(false));
                }
                if self.quits_after.take().is_some() {
                    effects.extend(self.quit());
                }
                effects
            }
            Ok(Saved::ChangedMeanwhile) => {
                self.prompt = Some(Prompt::Overwrite);
                Vec::new()
            }
            Err(error) => self.fails(format!("cannot write {}: {error}", file.path.display())),
        }
    }

    /// Puts changes that were not saved into a file beside the scene's; gives its
    /// path, if there are any and it could be written.
    pub(crate) fn rescue(&self) -> Option<PathBuf> {
        if !self.hands.is_unsaved() {
            return None;
        }
        let file = &self.file;
        let edited = self
            .hands
            .saved_file(&file.bytes, &file.path, &file.overrides)
            .ok()?;
        let mut name = file.path.clone().into_os_string();
        name.push(UNSAVED);
        let path = PathBuf::from(name);
        save_file(&path, None, &edited.bytes).ok().map(|_| path)
    }

    /// The scene of the file is what was edited.
    fn scene_is_saved(&mut self) {
        self.hands.mark_saved();
        let document = self.hands.document();
        self.scene.lights = document.lights();
        let materials = self.scene.materials.iter_mut();
        for (material, reflection) in materials.zip(&document.reflections) {
            reflection.apply(material);
        }
        self.scene.camera = document.camera;
        self.scene.render = document.render.clone();
    }

    /// Files have changed: they are read again.
    pub(super) fn files_changed(&mut self) -> Vec<Effect> {
        if self.prompt.is_some() {
            // One question at a time.
            self.files_wait = true;
            return Vec::new();
        }
        vec![self.load(false)]
    }

    /// The files were read again: the new scene is shown, or what is wrong with it.
    pub(super) fn loaded(&mut self, loaded: Loaded) -> Vec<Effect> {
        self.is_loading = false;
        let watched = Effect::Watch(self.watched_with(&loaded.files, loaded.at));
        // A mesh and its materials lie under what was edited; only the scene file
        // says of the same things something else.
        let is_same_file = loaded.bytes == self.file.bytes;
        let costs_edits = self.hands.is_unsaved() && !is_same_file;
        let scene = match loaded.scene {
            Ok(_) if costs_edits && !self.load_is_answered => {
                self.prompt = Some(Prompt::Reload);
                return vec![watched];
            }
            Ok(scene) => *scene,
            Err(error) => {
                self.status.file_error = Some(format!("{error}; the last scene is shown"));
                return vec![watched];
            }
        };
        let is_same_mesh = is_same_mesh(&scene, &self.scene);
        self.status.file_error = None;
        self.status.say(reloaded(&scene));
        match is_same_file {
            true => self.hands.refresh(&scene),
            false => self.hands.reload(&scene),
        }
        self.file.bytes = loaded.bytes;
        self.extent = scene.placement().extent;
        self.scene = scene;
        let mut effects = vec![watched];
        if !is_same_mesh {
            effects.push(self.prepare(false));
        }
        effects.extend(self.show_anew());
        effects
    }

    /// Writes the frame at the scene's size into a file that is not there yet.
    pub(super) fn write_png(&mut self) -> Vec<Effect> {
        if self.bake == BakeState::OnItsWay {
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
        let is_free = |path: &PathBuf| !path.exists() && !self.writing.contains(path);
        let Some(path) = names.into_iter().find(is_free) else {
            return self.fails(format!("there are {MOST_PICTURES} pictures of {stem} here"));
        };
        let size = self.hands.document().camera.size;
        self.status.say(format!("drawing {}", path.display()));
        self.writing.push(path.clone());
        let wish = Box::new(self.wish());
        vec![Effect::Send(Errand::Write { wish, size, path })]
    }
}

impl Program {
    /// A picture is in its file, or not.
    pub(super) fn wrote(&mut self, path: &Path, written: Result<String, String>) -> Vec<Effect> {
        self.writing.retain(|it| it != path);
        let is_written = written.is_ok();
        self.status.wrote(path, written);
        if self.quits_after == Some(QuitsAfter::Writing) {
            self.quits_after = None;
            if is_written {
                return self.quit();
            }
        }
        Vec::new()
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
pub(crate) fn load(path: &Path, overrides: &[Override]) -> Loaded {
    let at = SystemTime::now();
    let (bytes, (files, scene)) = match std::fs::read(path) {
        Ok(bytes) => {
            let loaded = Scene::load_bytes(&bytes, path, overrides);
            (bytes, loaded)
        }
        // The reader of scenes says it in its own words.
        Err(_) => (Vec::new(), (Vec::new(), Scene::load(path, overrides))),
    };
    Loaded {
        at,
        bytes,
        files,
        scene: scene.map(Box::new),
    }
}
