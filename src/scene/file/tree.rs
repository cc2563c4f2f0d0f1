//! The TOML tree with the place of every key and value, so that an error found
//! long after parsing still points at what the user wrote. Overrides are
//! grafted onto it before anything is read.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::scene::SceneError;
use crate::scene::place::{LineIndex, Place};

/// Characters of a value that an error repeats.
const MOST_WRITTEN: usize = 60;

/// A value and where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) place: Place,
    /// The value as the user wrote it, on one line and shortened.
    pub(crate) written: String,
}

/// A TOML value; dates are kept only to be refused by their type.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    String(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Date,
    Array(Vec<Node>),
    Table(Table),
}

/// Keys and values in the order of the file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    pub(crate) entries: Vec<Entry>,
}

/// A key with its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    /// Place of the key.
    pub(crate) place: Place,
    pub(crate) node: Node,
}

impl Table {
    /// The value of a key.
    pub(crate) fn get(&self, key: &str) -> Option<&Node> {
        let entry = self.entries.iter().find(|entry| entry.key == key)?;
        Some(&entry.node)
    }

    /// The value of a key, for change.
    pub(crate) fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        let entry = self.entries.iter_mut().find(|entry| entry.key == key)?;
        Some(&mut entry.node)
    }

    /// Sets a key, which from then on stands where the value stands.
    pub(crate) fn set(&mut self, key: &str, node: Node) {
        self.remove(key);
        self.entries.push(Entry {
            key: key.to_owned(),
            place: node.place.clone(),
            node,
        });
    }

    /// Takes a key out.
    pub(crate) fn remove(&mut self, key: &str) {
        self.entries.retain(|entry| entry.key != key);
    }
}

impl Node {
    /// An empty table that stands at `place`.
    pub(crate) fn empty_table(place: Place) -> Self {
        Self {
            value: Value::Table(Table::default()),
            place,
            written: "{}".to_owned(),
        }
    }

    /// An empty list that stands at `place`.
    pub(crate) fn empty_array(place: Place) -> Self {
        Self {
            value: Value::Array(Vec::new()),
            place,
            written: "[]".to_owned(),
        }
    }
}

/// Parses a scene file; `path` is what errors call it.
///
/// # Errors
/// Text that is not TOML, with line and column.
pub(crate) fn parse_document(text: &str, path: &Path) -> Result<Table, SceneError> {
    let index = LineIndex::new(text, path);
    let table = DeTable::parse(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let is_mesh = path
            .extension()
            .is_some_and(|it| it.eq_ignore_ascii_case("obj"));
        SceneError::Syntax {
            place: index.place(offset).to_string(),
            message: if is_mesh {
                "a scene is a TOML file that names its mesh (mesh = \"room.obj\"); give the TOML file"
                    .to_owned()
            } else {
                format!("not valid TOML: {}", error.message())
            },
        }
    })?;
    Ok(table_from(text, table.get_ref(), &|offset| {
        index.place(offset)
    }))
}

/// Parses a single TOML value; the error is TOML's own message.
pub(crate) fn parse_value(text: &str, place: &Place) -> Result<Node, String> {
    let value = DeValue::parse(text).map_err(|error| error.message().to_owned())?;
    Ok(node_from(text, &value, &|_| place.clone()))
}

type PlaceOf<'a> = &'a dyn Fn(usize) -> Place;

fn table_from(text: &str, table: &DeTable<'_>, place_of: PlaceOf<'_>) -> Table {
    // TOML's map is sorted by key; the order of the file reads better.
    let mut spanned: Vec<_> = table.iter().collect();
    spanned.sort_by_key(|(key, _)| key.span().start);
    let entries = spanned.into_iter().map(|(key, value)| Entry {
        key: key.get_ref().to_string(),
        place: place_of(key.span().start),
        node: node_from(text, value, place_of),
    });
    Table {
        entries: entries.collect(),
    }
}

fn node_from(text: &str, value: &Spanned<DeValue<'_>>, place_of: PlaceOf<'_>) -> Node {
    let span = value.span();
    Node {
        place: place_of(span.start),
        written: shortened(text.get(span).unwrap_or("")),
        value: match value.get_ref() {
            DeValue::String(string) => Value::String(string.to_string()),
            // A number too large for 64 bits is out of every range as well.
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .map_or(Value::Float(f64::INFINITY), Value::Integer),
            DeValue::Float(float) => Value::Float(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(flag) => Value::Boolean(*flag),
            DeValue::Datetime(_) => Value::Date,
            DeValue::Array(array) => {
                let nodes = array.iter().map(|node| node_from(text, node, place_of));
                Value::Array(nodes.collect())
            }
            DeValue::Table(table) => Value::Table(table_from(text, table, place_of)),
        },
    }
}

/// On one line, at most [`MOST_WRITTEN`] characters.
pub(crate) fn shortened(text: &str) -> String {
    let mut line = String::new();
    for (count, word) in text.split_whitespace().enumerate() {
        if count > 0 {
            line.push(' ');
        }
        line.push_str(word);
        if line.chars().count() > MOST_WRITTEN {
            let kept: String = line.chars().take(MOST_WRITTEN).collect();
            return kept + "...";
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_tables_keys_and_values() {
        let text = "mesh = \"a.obj\"\n\n[camera]\nvfov = 40\n\n[[light]]\n  kind = 'point'\n";
        let table = parse_document(text, Path::new("s.toml")).unwrap();
        let Some(Value::Array(lights)) = table.get("light").map(|node| &node.value) else {
            panic!("a list of lights")
        };
        assert_eq!(lights[0].place.to_string(), "s.toml:6:1");
        let Value::Table(light) = &lights[0].value else {
            panic!("a light is a table")
        };
        assert_eq!(light.entries[0].place.to_string(), "s.toml:7:3");
        assert_eq!(light.entries[0].node.place.to_string(), "s.toml:7:10");
        let camera = table.get("camera").unwrap();
        assert_eq!(camera.place.to_string(), "s.toml:3:1");
    }

    #[test]
    fn bad_toml_has_a_place() {
        let error = parse_document("mesh = \"a\"\nvfov = = 3\n", Path::new("s.toml")).unwrap_err();
        assert!(error.to_string().starts_with("s.toml:2:8: "), "{error}");
    }

    #[test]
    fn numbers_of_every_notation() {
        let place = Place::Set { path: "x".into() };
        let value = |text: &str| parse_value(text, &place).unwrap().value;
        assert!(matches!(value("0x1f"), Value::Integer(31)));
        assert!(matches!(value("-1_000"), Value::Integer(-1000)));
        assert!(matches!(value("+2.5e1_0"), Value::Float(x) if x == 2.5e10));
        assert!(matches!(value("-inf"), Value::Float(x) if x == f64::NEG_INFINITY));
        assert!(matches!(value("nan"), Value::Float(x) if x.is_nan()));
        assert!(matches!(value("99999999999999999999"), Value::Float(_)));
    }
}
