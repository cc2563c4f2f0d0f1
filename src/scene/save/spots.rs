//! Keys of a spot that depend on each other: its cone, and what it looks at.

use glam::DVec3;

use super::editor::Editor;
use super::in_force::InForce;
use super::layout::Place;
use super::values::{Keys, Value};
use super::{SaveError, numbers};
use crate::scene::Spot;
use crate::scene::light::DEFAULT_CUTOFF_DEG;

/// The keys that aim a spot, of which it has one.
const AIMS: [&str; 2] = ["target", "direction"];

/// A spot's entry while it is written.
pub(super) struct Written<'a> {
    pub(super) editor: &'a mut Editor,
    pub(super) in_force: &'a mut InForce,
    pub(super) place: Place,
    /// The light's.
    pub(super) name: &'a str,
    /// What is to be written: the keys that were edited, and those that follow.
    pub(super) keys: &'a mut Keys,
}

impl Written<'_> {
    /// The beam is a share of the cutoff where the file gives none, and at most the
    /// cutoff: an angle that did not change is written too where the file, with the
    /// one that did, would be read as another cone or refused.
    pub(super) fn complete_cone(&mut self, spot: &Spot) -> Result<(), SaveError> {
        let [cutoff, beam] = [spot.cutoff_deg, spot.beam_deg];
        match ["cutoff", "beam"].map(|key| self.changes(key)) {
            [true, false] => {
                let is_given = self.in_force.given(self.name, &["beam"]).is_some();
                let in_file = self.editor.number(self.place, "beam")?;
                if in_file.map_or(!is_given, |in_file| in_file > f64::from(cutoff)) {
                    self.also("beam", Value::Single(beam));
                }
            }
            [false, true] => {
                let in_file = self.editor.number(self.place, "cutoff")?;
                if in_file.unwrap_or(DEFAULT_CUTOFF_DEG) < f64::from(beam) {
                    self.also("cutoff", Value::Single(cutoff));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Lets the entry aim the spot as it was edited. A spot that was moved still
    /// looks in its direction, so a target moves with it; its distance is the one
    /// that the file has.
    pub(super) fn aim(&mut self, spot: &Spot) -> Result<(), SaveError> {
        let entry = self.editor.entry(self.place)?;
        let has_target = entry.is_some_and(|entry| entry.key("target").is_some());
        let is_by_target = match self.in_force.given(self.name, &AIMS) {
            Some(key) => key == "target",
            None => has_target,
        };
        let is_aimed = self.changes("direction") || (self.changes("position") && is_by_target);
        if !is_aimed {
            return Ok(());
        }
        self.keys.retain(|(key, _)| *key != "direction");
        for key in AIMS {
            self.in_force.settle_entry("light", self.name, key);
        }
        if !has_target {
            self.also("direction", Value::Direction(spot.direction));
            return Ok(());
        }
        match self.target(spot)? {
            Some(target) => self.editor.set(self.place, "target", &target.into()),
            None => {
                let direction = numbers::direction(spot.direction).into();
                self.editor.rename(self.place, AIMS, &direction)
            }
        }
    }

    /// What the spot looks at; `None` where only a direction says it: digits do not
    /// suffice, or an override still holds the spot at a place that is not the
    /// file's.
    fn target(&self, spot: &Spot) -> Result<Option<[String; 3]>, SaveError> {
        if self.in_force.given(self.name, &["position"]).is_some() {
            return Ok(None);
        }
        let position = self.editor.numbers(self.place, "position")?;
        let target = self.editor.numbers(self.place, "target")?;
        let distance = match (position.as_slice(), target.as_slice()) {
            (&[x, y, z], &[u, v, w]) => DVec3::new(u - x, v - y, w - z).length(),
            _ => 1.0,
        };
        Ok(numbers::target(spot.position, spot.direction, distance))
    }

    fn changes(&self, name: &str) -> bool {
        self.keys.iter().any(|(key, _)| *key == name)
    }

    fn also(&mut self, key: &'static str, value: Value) {
        self.in_force.settle_entry("light", self.name, key);
        self.keys.push((key, value));
    }
}
