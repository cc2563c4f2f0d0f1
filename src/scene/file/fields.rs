//! Takes keys out of a table one by one, with checks of type and range whose
//! errors name the place, the key, the value and what is allowed.

use std::ops::{RangeBounds, RangeInclusive};

use glam::{DVec3, Vec3};

use super::tree::{Node, Table, Value};
use crate::scene::SceneError;
use crate::scene::place::Place;

/// Largest magnitude of a number in a scene: what lies beyond is as good as
/// infinite in single precision once it has been squared or multiplied.
pub(crate) const LARGEST: f64 = 1e30;

/// Names that an error lists before it says "..." .
const MOST_LISTED: usize = 16;

/// A table whose keys are taken out one by one.
#[derive(Debug)]
pub(crate) struct Fields {
    /// What errors call it, such as `[camera]` or `light "lamp"`.
    what: String,
    place: Place,
    table: Table,
}

/// A key that was taken out, with its value.
#[derive(Debug)]
pub(crate) struct Item {
    key: &'static str,
    what: String,
    node: Node,
}

impl Fields {
    /// The keys of a table node.
    ///
    /// # Errors
    /// A node that is no table.
    pub(crate) fn new(what: impl Into<String>, node: Node) -> Result<Self, SceneError> {
        let what = what.into();
        match node.value {
            Value::Table(table) => Ok(Self {
                what,
                place: node.place,
                table,
            }),
            _ => Err(key_error(
                &node.place,
                format!("{what} is {}; it must be a table of keys", node.written),
            )),
        }
    }

    /// The keys of the whole file.
    pub(crate) fn of_document(table: Table, place: Place) -> Self {
        Self {
            what: "the scene file".to_owned(),
            place,
            table,
        }
    }

    /// Where the table starts.
    pub(crate) fn place(&self) -> &Place {
        &self.place
    }

    /// Names the table more precisely from here on.
    pub(crate) fn rename(&mut self, what: String) {
        self.what = what;
    }

    /// Lets errors about the table as a whole point elsewhere from here on.
    pub(crate) fn move_to(&mut self, place: Place) {
        self.place = place;
    }

    /// Refuses every key that is still there and not in `allowed`.
    pub(crate) fn allow(&self, allowed: &[&str]) -> Result<(), SceneError> {
        let unknown = |key: &&super::tree::Entry| !allowed.contains(&key.key.as_str());
        match self.table.entries.iter().find(unknown) {
            None => Ok(()),
            Some(entry) => Err(key_error(
                &entry.place,
                format!(
                    "unknown key `{}` (= {}) in {}; {}",
                    entry.key,
                    entry.node.written,
                    self.what,
                    suggestion(&entry.key, allowed.iter().copied())
                ),
            )),
        }
    }

    /// Takes a key that may be absent.
    pub(crate) fn take(&mut self, key: &'static str) -> Option<Item> {
        let index = self.table.entries.iter().position(|e| e.key == key)?;
        Some(Item {
            key,
            what: self.what.clone(),
            node: self.table.entries.remove(index).node,
        })
    }

    /// Takes a key that must be there; `meaning` says what it wants.
    pub(crate) fn require(&mut self, key: &'static str, meaning: &str) -> Result<Item, SceneError> {
        let item = self.take(key);
        item.ok_or_else(|| self.error(format!("lacks the key `{key}` ({meaning})")))
    }

    /// Takes whichever of two keys is there.
    ///
    /// # Errors
    /// Both or none.
    pub(crate) fn one_of(
        &mut self,
        first: &'static str,
        second: &'static str,
    ) -> Result<Item, SceneError> {
        match (self.take(first), self.take(second)) {
            (Some(item), None) | (None, Some(item)) => Ok(item),
            (None, None) => Err(self.error(format!("needs `{first}` or `{second}`"))),
            (Some(_), Some(item)) => Err(key_error(
                &item.node.place,
                format!(
                    "{} has both `{first}` and `{second}` (= {}); keep exactly one of them",
                    self.what, item.node.written
                ),
            )),
        }
    }

    /// An error about the table as a whole.
    pub(crate) fn error(&self, message: impl AsRef<str>) -> SceneError {
        key_error(&self.place, format!("{} {}", self.what, message.as_ref()))
    }
}

impl Item {
    /// The name of the key.
    pub(crate) fn key(&self) -> &'static str {
        self.key
    }

    /// Where the value stands.
    pub(crate) fn place(&self) -> &Place {
        &self.node.place
    }

    /// The value itself.
    pub(crate) fn into_node(self) -> Node {
        self.node
    }

    /// An error that repeats the value; `allowed` completes "it must be".
    pub(crate) fn error(&self, allowed: &str) -> SceneError {
        let Self { key, what, node } = self;
        key_error(
            &node.place,
            format!(
                "`{key}` of {what} is {}; it must be {allowed}",
                node.written
            ),
        )
    }

    /// A number in a range.
    pub(crate) fn number(
        &self,
        range: impl RangeBounds<f64>,
        allowed: &str,
    ) -> Result<f64, SceneError> {
        number_of(&self.node)
            .filter(|x| x.is_finite() && range.contains(x))
            .ok_or_else(|| self.error(&format!("a number {allowed}")))
    }

    /// A whole number in a range.
    pub(crate) fn count(&self, range: RangeInclusive<u32>) -> Result<u32, SceneError> {
        let count = match self.node.value {
            Value::Integer(integer) => u32::try_from(integer).ok(),
            _ => None,
        };
        count.filter(|n| range.contains(n)).ok_or_else(|| {
            self.error(&format!(
                "a whole number from {} to {}",
                range.start(),
                range.end()
            ))
        })
    }

    /// Three numbers: a place or a direction.
    pub(crate) fn vector(&self) -> Result<DVec3, SceneError> {
        self.triple(-LARGEST..=LARGEST)
            .map(DVec3::from_array)
            .ok_or_else(|| self.error("three numbers [x, y, z] of magnitude 1e30 at most"))
    }

    /// A direction of any length, as a unit vector.
    pub(crate) fn direction(&self) -> Result<DVec3, SceneError> {
        unit(self.vector()?).ok_or_else(|| self.error("a direction that is not [0, 0, 0]"))
    }

    /// Radiometric RGB: three numbers of which none is negative.
    pub(crate) fn light(&self) -> Result<Vec3, SceneError> {
        self.triple(0.0..=LARGEST)
            .map(|rgb| DVec3::from_array(rgb).as_vec3())
            .ok_or_else(|| self.error("three numbers [r, g, b] from 0 to 1e30"))
    }

    /// A reflectance: three numbers from 0 to 1.
    pub(crate) fn reflectance(&self) -> Result<Vec3, SceneError> {
        self.triple(0.0..=1.0)
            .map(|rgb| DVec3::from_array(rgb).as_vec3())
            .ok_or_else(|| self.error("three numbers [r, g, b] from 0 to 1"))
    }

    /// A string.
    pub(crate) fn string(&self) -> Result<&str, SceneError> {
        match &self.node.value {
            Value::String(string) => Ok(string),
            _ => Err(self.error("a string in quotes")),
        }
    }

    /// A string that is not empty.
    pub(crate) fn name(&self) -> Result<&str, SceneError> {
        self.string()
            .ok()
            .filter(|name| !name.is_empty())
            .ok_or_else(|| self.error("a string that is not empty"))
    }

    /// One of a table of names.
    pub(crate) fn choice<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T, SceneError> {
        let names = || choices.iter().map(|(name, _)| *name);
        let Value::String(string) = &self.node.value else {
            return Err(self.error(&format!("one of {}", listed(names()))));
        };
        match choices.iter().find(|(name, _)| name == string) {
            Some((_, choice)) => Ok(*choice),
            None => Err(key_error(
                &self.node.place,
                format!(
                    "`{}` of {} is {}; {}",
                    self.key,
                    self.what,
                    self.node.written,
                    suggestion(string, names())
                ),
            )),
        }
    }

    /// true or false.
    pub(crate) fn flag(&self) -> Result<bool, SceneError> {
        match self.node.value {
            Value::Boolean(flag) => Ok(flag),
            _ => Err(self.error("true or false")),
        }
    }

    /// A list, each entry with its own place.
    pub(crate) fn list(&self) -> Result<&[Node], SceneError> {
        match &self.node.value {
            Value::Array(nodes) => Ok(nodes),
            _ => Err(self.error("a list in brackets")),
        }
    }

    fn triple(&self, range: RangeInclusive<f64>) -> Option<[f64; 3]> {
        let Value::Array(nodes) = &self.node.value else {
            return None;
        };
        let [x, y, z] = nodes.as_slice() else {
            return None;
        };
        let in_range = |node| number_of(node).filter(|x| range.contains(x));
        Some([in_range(x)?, in_range(y)?, in_range(z)?])
    }
}

/// A number, whether written as an integer or not.
pub(crate) fn number_of(node: &Node) -> Option<f64> {
    match node.value {
        Value::Integer(integer) => Some(integer as f64),
        Value::Float(float) => Some(float),
        _ => None,
    }
}

/// A unit vector, or `None` for a vector of length zero. Divides by the
/// largest component first, so that no square is lost to underflow.
pub(crate) fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if largest > 0.0 && largest.is_finite() {
        let scaled = vector / largest;
        Some(scaled / scaled.length())
    } else {
        None
    }
}

/// An error about a key.
pub(crate) fn key_error(place: &Place, message: String) -> SceneError {
    SceneError::Key {
        place: place.to_string(),
        message,
    }
}

/// "the nearest is `x`, allowed are `x`, `y`".
pub(crate) fn suggestion<'a>(
    name: &str,
    candidates: impl Iterator<Item = &'a str> + Clone,
) -> String {
    // Long names would take quadratic time and are no misspelling anyway.
    let lower: String = name.to_lowercase().chars().take(100).collect();
    let distance =
        |candidate: &&str| strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
    match candidates.clone().min_by_key(distance) {
        None => "there is none to choose from".to_owned(),
        Some(nearest) => format!(
            "the nearest is `{nearest}`, allowed are {}",
            listed(candidates)
        ),
    }
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut quoted: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    if quoted.len() > MOST_LISTED {
        quoted.truncate(MOST_LISTED);
        quoted.push("...".to_owned());
    }
    quoted.join(", ")
}
