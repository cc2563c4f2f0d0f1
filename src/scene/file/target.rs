//! What `--set` and `[[animate]]` point at: a path such as
//! `light.lamp.position`, and how a value is grafted onto the tree there.

use super::fields::{key_error, suggestion};
use super::tree::{Node, Table, Value};
use crate::scene::SceneError;
use crate::scene::place::Place;

/// Sections with keys of their own.
const SECTIONS: [&str; 4] = ["camera", "render", "bake", "golden"];

/// Lists of named entries.
const LISTS: [&str; 2] = ["light", "material"];

/// Keys of the file outside every section.
const TOP_LEVEL: [&str; 3] = ["mesh", "normals", "texture_filter"];

/// Keys of a light that exclude each other: setting one drops the other,
/// since an override cannot take a key away.
const ALTERNATIVES: [[&str; 2]; 2] = [["target", "direction"], ["radiance", "map"]];

/// A path to a key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Target {
    /// `KEY`.
    TopLevel { key: String },
    /// `SECTION.KEY`.
    Section { section: String, key: String },
    /// `LIST.NAME.KEY`; the name may hold dots and quotes around it.
    Named {
        list: String,
        name: String,
        key: String,
    },
}

impl Target {
    /// Parses a path; the error says what is wrong with it.
    pub(crate) fn parse(path: &str) -> Result<Self, String> {
        let Some((first, rest)) = path.split_once('.') else {
            return Self::top_level(path);
        };
        if SECTIONS.contains(&first) {
            return Ok(Self::Section {
                section: first.to_owned(),
                key: rest.to_owned(),
            });
        }
        if !LISTS.contains(&first) {
            let known = SECTIONS.iter().chain(&LISTS).copied();
            return Err(format!(
                "unknown section `{first}`; {}",
                suggestion(first, known)
            ));
        }
        match rest.rsplit_once('.') {
            Some((name, key)) if !name.is_empty() && !key.is_empty() => Ok(Self::Named {
                list: first.to_owned(),
                name: unquoted(name).to_owned(),
                key: key.to_owned(),
            }),
            _ => Err(format!("must be {first}.NAME.KEY")),
        }
    }

    /// The light that the path leads to, if it leads to one.
    pub(crate) fn light_name(&self) -> Option<&str> {
        match self {
            Self::Named { list, name, .. } if list == "light" => Some(name),
            _ => None,
        }
    }

    fn top_level(key: &str) -> Result<Self, String> {
        if TOP_LEVEL.contains(&key) {
            return Ok(Self::TopLevel {
                key: key.to_owned(),
            });
        }
        if SECTIONS.contains(&key) || LISTS.contains(&key) {
            return Err(format!(
                "`{key}` is not a key but holds keys; write {key}.KEY"
            ));
        }
        let known = TOP_LEVEL.iter().chain(&SECTIONS).chain(&LISTS).copied();
        Err(format!("unknown key `{key}`; {}", suggestion(key, known)))
    }
}

impl Table {
    /// Sets what `target` points at. An entry of `[[material]]` is made where
    /// it is absent; a light must exist.
    ///
    /// # Errors
    /// A light that does not exist, at the place of the value.
    pub(crate) fn graft(&mut self, target: &Target, node: Node) -> Result<(), SceneError> {
        match target {
            Target::TopLevel { key } => self.set(key, node),
            Target::Section { section, key } => {
                if self.get(section).is_none() {
                    self.set(section, Node::empty_table(node.place.clone()));
                }
                // A section that is no table is refused when it is read.
                if let Some(Value::Table(table)) = self.get_mut(section).map(|n| &mut n.value) {
                    table.set(key, node);
                }
            }
            Target::Named { list, name, key } if list == "light" => {
                let light = self.light_mut(name, &node.place)?;
                for [a, b] in ALTERNATIVES {
                    if key == a {
                        light.remove(b);
                    } else if key == b {
                        light.remove(a);
                    }
                }
                light.set(key, node);
            }
            Target::Named { name, key, .. } => {
                if let Some(material) = self.material_mut(name, &node.place) {
                    material.set(key, node);
                }
            }
        }
        Ok(())
    }

    fn light_mut(&mut self, name: &str, place: &Place) -> Result<&mut Table, SceneError> {
        let nodes = self.list_mut("light");
        let names: Vec<String> = nodes.iter().enumerate().map(light_name).collect();
        match names.iter().position(|known| known == name) {
            Some(index) => match &mut nodes[index].value {
                Value::Table(table) => Ok(table),
                _ => Err(key_error(
                    place,
                    format!("light {name:?} is not a table in the scene file"),
                )),
            },
            None => Err(key_error(
                place,
                format!(
                    "no light is called {name:?}; {}",
                    suggestion(name, names.iter().map(String::as_str))
                ),
            )),
        }
    }

    /// `None` only where `material` is no list, which reading refuses.
    fn material_mut(&mut self, name: &str, place: &Place) -> Option<&mut Table> {
        if self.get("material").is_none() {
            self.set("material", Node::empty_array(place.clone()));
        }
        let Some(Value::Array(nodes)) = self.get_mut("material").map(|n| &mut n.value) else {
            return None;
        };
        let index = nodes
            .iter()
            .position(|node| string_key(node, "name") == Some(name))
            .unwrap_or_else(|| {
                nodes.push(new_material(name, place));
                nodes.len() - 1
            });
        match &mut nodes[index].value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    fn list_mut(&mut self, key: &str) -> &mut [Node] {
        match self.get_mut(key).map(|node| &mut node.value) {
            Some(Value::Array(nodes)) => nodes,
            _ => &mut [],
        }
    }
}

/// The name of a light: its own, or light1, light2, ... by position.
fn light_name((index, node): (usize, &Node)) -> String {
    string_key(node, "name").map_or_else(|| default_light_name(index), str::to_owned)
}

/// The name of a light that has none.
pub(crate) fn default_light_name(index: usize) -> String {
    format!("light{}", index + 1)
}

fn string_key<'a>(node: &'a Node, key: &str) -> Option<&'a str> {
    let Value::Table(table) = &node.value else {
        return None;
    };
    match &table.get(key)?.value {
        Value::String(string) => Some(string),
        _ => None,
    }
}

fn new_material(name: &str, place: &Place) -> Node {
    let mut node = Node::empty_table(place.clone());
    if let Value::Table(table) = &mut node.value {
        let name = Node {
            value: Value::String(name.to_owned()),
            place: place.clone(),
            written: format!("{name:?}"),
        };
        table.set("name", name);
    }
    node
}

/// Without the quotes of a TOML key that holds dots.
fn unquoted(name: &str) -> &str {
    let inside = |quote| name.strip_prefix(quote)?.strip_suffix(quote);
    inside('"').or_else(|| inside('\'')).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_may_hold_dots() {
        let named = |name: &str| Target::Named {
            list: "material".into(),
            name: name.into(),
            key: "albedo".into(),
        };
        assert_eq!(
            Target::parse("material.Material.001.albedo"),
            Ok(named("Material.001"))
        );
        assert_eq!(Target::parse("material.\"a.b\".albedo"), Ok(named("a.b")));
    }

    #[test]
    fn unknown_paths_name_the_nearest() {
        let error = |path| Target::parse(path).unwrap_err();
        assert!(error("lihgt.lamp.position").contains("the nearest is `light`"));
        assert!(error("normal").contains("the nearest is `normals`"));
        assert!(error("camera").contains("camera.KEY"));
        assert!(error("light.lamp").contains("light.NAME.KEY"));
        assert!(error("").contains("unknown key"));
    }
}
