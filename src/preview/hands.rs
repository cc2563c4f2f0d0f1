//! The hands: what a person does, turned into edits that can be undone, and into
//! requests to the program around them.

mod files;
mod mouse;
#[cfg(test)]
mod tests;

use std::time::Duration;

use glam::{DVec2, DVec3, Vec3};

use super::command::{Command, Request};
use super::document::{Changed, Document, UNNAMED, reflection_summary, summary};
use super::drag::Drag;
use super::edits::{self, Context};
use super::history::History;
use super::input::{Code, Input, Key};
use super::keys::{Meaning, continuations, meaning};
use super::marks::{Mark, marks, with_marks};
use super::view::View;
use crate::frame::EncodedImage;
use crate::relight::Component;
use crate::scene::{Camera, Scene};
use files::pinned;

/// What is selected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Selection {
    #[default]
    Nothing,
    /// A light, by its number.
    Light(usize),
    /// A material, by its number.
    Surface(usize),
}

/// What is seen at a place of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seen {
    /// Number of the material.
    pub(crate) material: usize,
    /// Scene units.
    pub(crate) point: DVec3,
}

/// Tells what is seen at pixel coordinates of the picture; `None` for the sky.
pub(crate) type Sight<'a> = &'a dyn Fn(DVec2) -> Option<Seen>;

/// What came of an input.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Outcome {
    pub(crate) changed: Changed,
    pub(crate) request: Option<Request>,
    /// For the status line.
    pub(crate) message: Option<String>,
}

/// What makes changes one step of undo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Gesture {
    Burst(Command, Selection),
    /// The how manieth gesture it is: never the same as another.
    Single(u64),
    /// The scene's files were read again.
    Reload,
}

/// A state to return to.
type State = (Document, Selection);

/// A scene in someone's hands.
pub(crate) struct Hands {
    document: Document,
    selection: Selection,
    history: History<State, Gesture>,
    gestures: u64,
    drag: Option<Drag>,
    /// A key that another one must follow.
    first_key: Option<Key>,
    clicked: Option<DVec3>,
    hides_marks: bool,
    /// As it was loaded or saved last.
    saved: Document,
    home: Camera,
    material_names: Vec<String>,
    /// Which of the materials emit.
    emits: Vec<bool>,
    pinned: Vec<String>,
}

impl Hands {
    /// Hands on a scene as it was loaded.
    pub(crate) fn new(scene: &Scene, component: Component) -> Self {
        let document = Document::of_scene(scene, component);
        Self {
            saved: document.clone(),
            document,
            selection: Selection::Nothing,
            history: History::default(),
            gestures: 0,
            drag: None,
            first_key: None,
            clicked: None,
            hides_marks: false,
            home: scene.camera,
            material_names: scene.materials.iter().map(|m| m.name.clone()).collect(),
            emits: emits(scene),
            pinned: pinned(scene),
        }
    }

    /// The scene as it is now.
    pub(crate) fn document(&self) -> &Document {
        &self.document
    }

    #[cfg(test)]
    pub(crate) fn selection(&self) -> Selection {
        self.selection
    }

    /// What is selected, for the status line.
    pub(crate) fn selected_name(&self) -> Option<&str> {
        match self.selection {
            Selection::Nothing => None,
            Selection::Light(index) => Some(&self.document.lights.get(index)?.light.name),
            Selection::Surface(index) => match self.material_names.get(index)?.as_str() {
                "" => Some(UNNAMED),
                name => Some(name),
            },
        }
    }

    /// Whether there is something to save.
    pub(crate) fn is_unsaved(&self) -> bool {
        self.document.saves_as_other(&self.saved)
    }

    /// The picture with the marks of the lights over it.
    pub(crate) fn with_marks(&self, picture: &EncodedImage, view: &View) -> EncodedImage {
        if self.hides_marks {
            return picture.clone();
        }
        with_marks(picture, &self.marks(view), self.selected_light())
    }

    /// Does what an input means. `now` is the time since any fixed moment.
    pub(crate) fn take(
        &mut self,
        input: Input,
        view: &View,
        sight: Sight<'_>,
        now: Duration,
    ) -> Outcome {
        match input {
            Input::Key(key) => self.key(key, view, now),
            Input::Mouse(mouse) => self.mouse(mouse, view, sight, now),
            Input::Resize { .. } => {
                self.drag = None;
                Outcome::default()
            }
        }
    }

    fn key(&mut self, key: Key, view: &View, now: Duration) -> Outcome {
        let first = self.first_key.take();
        if first.is_some() && key.code == Code::Esc {
            return said(String::new());
        }
        match meaning(first, key) {
            Meaning::Command(command, steps) => self.command(command, steps, view, now),
            Meaning::Begins => {
                self.first_key = Some(key);
                said(continuations(key))
            }
            Meaning::Nothing => said(match first {
                Some(first) => format!("{} {} is no key; ? shows all", first.name(), key.name()),
                None => format!("{} is no key; ? shows all", key.name()),
            }),
        }
    }

    fn command(&mut self, command: Command, steps: f64, view: &View, now: Duration) -> Outcome {
        match command {
            Command::Ask(request) => Outcome {
                request: Some(request),
                ..Outcome::default()
            },
            Command::SelectLight(by) => {
                let next = next(self.selected_light(), by, self.document.lights.len());
                self.select(
                    next.map_or(Selection::Nothing, Selection::Light),
                    "no light",
                )
            }
            Command::SelectSurface(by) => {
                let now = match self.selection {
                    Selection::Surface(index) => Some(index),
                    _ => None,
                };
                let next = next(now, by, self.material_names.len());
                self.select(
                    next.map_or(Selection::Nothing, Selection::Surface),
                    "no surface",
                )
            }
            Command::Deselect => self.select(Selection::Nothing, ""),
            Command::Undo | Command::Redo => self.travel(command),
            Command::Marks => {
                self.hides_marks = !self.hides_marks;
                marks_changed(if self.hides_marks {
                    "marks hidden"
                } else {
                    "marks shown"
                })
            }
            command => self.edit(command, steps, view, now),
        }
    }

    fn edit(&mut self, command: Command, steps: f64, view: &View, now: Duration) -> Outcome {
        let context = Context {
            home: &self.home,
            extent: view.extent,
            material_names: &self.material_names,
            pinned: &self.pinned,
            clicked: self.clicked,
        };
        let (mut document, mut selection) = (self.document.clone(), self.selection);
        match edits::apply(command, steps, &mut document, &mut selection, &context) {
            Err(reason) => said(reason),
            Ok(_) if !document.is_valid() => said("that is as far as it goes".to_owned()),
            Ok(message) => {
                // What is dragged meanwhile goes on from here.
                self.drag = None;
                let is_other = document.differs(&self.document);
                if is_other {
                    self.record(command, now, !command.is_part_of_a_burst());
                }
                let mut changed = Changed::between(&self.document, &document);
                changed.marks |= selection != self.selection;
                self.document = document;
                self.selection = selection;
                Outcome {
                    changed,
                    message: Some(message),
                    request: None,
                }
            }
        }
    }

    /// Keeps the state before a change.
    fn record(&mut self, command: Command, now: Duration, is_single: bool) {
        let gesture = if is_single {
            self.gestures += 1;
            Gesture::Single(self.gestures)
        } else {
            Gesture::Burst(command, self.selection)
        };
        self.history
            .record((self.document.clone(), self.selection), gesture, now);
    }

    fn travel(&mut self, command: Command) -> Outcome {
        self.drag = None;
        let present = (self.document.clone(), self.selection);
        let (found, nothing, done) = match command {
            Command::Redo => (self.history.redo(present), "nothing to redo", "redone"),
            _ => (self.history.undo(present), "nothing to undo", "undone"),
        };
        let Some((document, selection)) = found else {
            return said(nothing.to_owned());
        };
        let changed = Changed {
            marks: true,
            ..Changed::between(&self.document, &document)
        };
        self.document = document;
        self.selection = selection;
        self.clamp_selection();
        Outcome {
            changed,
            message: Some(done.to_owned()),
            request: None,
        }
    }

    fn select(&mut self, selection: Selection, nothing: &str) -> Outcome {
        let is_other = selection != self.selection;
        self.selection = selection;
        self.history.end_gesture();
        let message = self
            .selected_summary()
            .unwrap_or_else(|| nothing.to_owned());
        Outcome {
            changed: Changed {
                marks: is_other,
                ..Changed::default()
            },
            message: Some(message),
            request: None,
        }
    }

    /// What is selected in figures.
    fn selected_summary(&self) -> Option<String> {
        match self.selection {
            Selection::Nothing => None,
            Selection::Light(index) => Some(summary(&self.document.lights.get(index)?.light.kind)),
            Selection::Surface(index) => {
                let reflection = self.document.reflections.get(index)?;
                let emits = self.emits.get(index).copied().unwrap_or(false);
                let emission = if emits { "; it emits, by its MTL" } else { "" };
                let summary = reflection_summary(reflection, 2);
                Some(format!("{summary}{emission}"))
            }
        }
    }

    fn marks(&self, view: &View) -> Vec<Mark> {
        marks(&self.document.lights, &self.document.camera, view)
    }

    fn selected_light(&self) -> Option<usize> {
        match self.selection {
            Selection::Light(index) => Some(index),
            _ => None,
        }
    }

    fn clamp_selection(&mut self) {
        let exists = match self.selection {
            Selection::Nothing => true,
            Selection::Light(index) => index < self.document.lights.len(),
            Selection::Surface(index) => index < self.material_names.len(),
        };
        if !exists {
            self.selection = Selection::Nothing;
        }
    }
}

/// Which of a scene's materials emit.
fn emits(scene: &Scene) -> Vec<bool> {
    let materials = scene.materials.iter();
    materials.map(|it| it.emission != Vec3::ZERO).collect()
}

/// The number after or before one in a ring; the first or last where there is none.
fn next(now: Option<usize>, by: i8, count: usize) -> Option<usize> {
    let last = count.checked_sub(1)?;
    Some(match (now, by > 0) {
        (None, true) => 0,
        (None, false) => last,
        (Some(now), true) => (now + 1) % count,
        (Some(now), false) => now.checked_sub(1).unwrap_or(last),
    })
}

fn said(message: String) -> Outcome {
    Outcome {
        message: Some(message),
        ..Outcome::default()
    }
}

fn marks_changed(message: &str) -> Outcome {
    Outcome {
        changed: Changed {
            marks: true,
            ..Changed::default()
        },
        message: Some(message.to_owned()),
        request: None,
    }
}
