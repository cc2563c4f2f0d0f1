//! Where the pieces of a scene file stand in its text.

use std::ops::Range;

use toml_edit::{Array, Document, InlineTable, Item, Table, Value};

use super::SaveError;

/// Sections and lists that are edited.
const SECTIONS: [&str; 2] = ["camera", "render"];
const LISTS: [&str; 2] = ["light", "material"];

/// A table of the file that holds keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// `[camera]`, `[render]`.
    Section(&'static str),
    /// The entry of a list, by its number.
    Entry(&'static str, usize),
}

/// How a table is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Form {
    /// Below a header in brackets, which stands here.
    Header(Range<usize>),
    /// In braces, from one to the other.
    Inline(Range<usize>),
    /// As keys with dots: `camera.vfov = 40`.
    Dotted,
}

/// A table with its keys in the order of the text.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) form: Form,
    pub(super) keys: Vec<Key>,
}

/// A key with its value.
#[derive(Debug, Clone)]
pub(super) struct Key {
    pub(super) name: String,
    pub(super) key: Range<usize>,
    pub(super) value: Range<usize>,
    /// Of a list: its elements.
    pub(super) elements: Vec<Range<usize>>,
    /// Of a string: what it says.
    pub(super) string: Option<String>,
}

/// A list of tables.
#[derive(Debug, Clone)]
pub(super) enum List {
    /// The file has none.
    Absent,
    /// As tables with headers.
    Headers(Vec<Entry>),
    /// As tables in braces, inside of brackets that stand here.
    Inline(Vec<Entry>, Range<usize>),
}

impl List {
    pub(super) fn entries(&self) -> &[Entry] {
        match self {
            Self::Absent => &[],
            Self::Headers(entries) | Self::Inline(entries, _) => entries,
        }
    }
}

impl Entry {
    pub(super) fn key(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// Where its last key, or its header, ends.
    pub(super) fn end(&self) -> usize {
        match (&self.form, self.keys.last()) {
            (Form::Inline(range), _) => range.end,
            (_, Some(key)) => key.value.end,
            (Form::Header(range), None) => range.end,
            (Form::Dotted, None) => 0,
        }
    }
}

/// A scene file's text, parsed: what of it can be edited.
pub(super) struct Layout {
    sections: Vec<(&'static str, Entry)>,
    lists: Vec<(&'static str, List)>,
}

impl Layout {
    pub(super) fn of(text: &str) -> Result<Self, SaveError> {
        let parsed = Document::parse(text.to_owned());
        let document = parsed.map_err(|error| {
            let message = format!("the scene file is no TOML any more ({})", error.message());
            SaveError::NotTheText(message)
        })?;
        let section = |name| Some((name, entry_of(document.get(name)?)?));
        Ok(Self {
            sections: SECTIONS.into_iter().filter_map(section).collect(),
            lists: LISTS.map(|name| (name, list_of(document.get(name)))).into(),
        })
    }

    /// The table at a place; `None` where the file has none.
    pub(super) fn entry(&self, place: Place) -> Option<&Entry> {
        match place {
            Place::Section(name) => {
                let mut sections = self.sections.iter();
                sections
                    .find(|section| section.0 == name)
                    .map(|(_, entry)| entry)
            }
            Place::Entry(list, index) => self.list(list).entries().get(index),
        }
    }

    pub(super) fn list(&self, name: &str) -> &List {
        let mut lists = self.lists.iter();
        lists
            .find(|list| list.0 == name)
            .map_or(&List::Absent, |(_, list)| list)
    }
}

fn list_of(item: Option<&Item>) -> List {
    match item {
        Some(Item::ArrayOfTables(tables)) => {
            List::Headers(tables.iter().filter_map(header_entry).collect())
        }
        Some(Item::Value(Value::Array(array))) => {
            let tables = array.iter().filter_map(Value::as_inline_table);
            let span = array.span().unwrap_or_default();
            List::Inline(tables.filter_map(inline_entry).collect(), span)
        }
        _ => List::Absent,
    }
}

fn entry_of(item: &Item) -> Option<Entry> {
    match item {
        Item::Table(table) if table.is_dotted() => Some(Entry {
            form: Form::Dotted,
            keys: keys_of(table),
        }),
        Item::Table(table) => header_entry(table),
        Item::Value(Value::InlineTable(table)) => inline_entry(table),
        _ => None,
    }
}

fn header_entry(table: &Table) -> Option<Entry> {
    Some(Entry {
        form: Form::Header(table.span()?),
        keys: keys_of(table),
    })
}

fn keys_of(table: &Table) -> Vec<Key> {
    let keys = table.iter().filter_map(|(name, item)| {
        let span = table.key(name)?.span()?;
        key_of(name, span, item.as_value()?)
    });
    in_order(keys.collect())
}

fn inline_entry(table: &InlineTable) -> Option<Entry> {
    let keys = table.iter().filter_map(|(name, value)| {
        let span = table.key(name)?.span()?;
        key_of(name, span, value)
    });
    Some(Entry {
        form: Form::Inline(table.span()?),
        keys: in_order(keys.collect()),
    })
}

fn key_of(name: &str, key: Range<usize>, value: &Value) -> Option<Key> {
    let elements = value.as_array().map(element_spans).unwrap_or_default();
    Some(Key {
        name: name.to_owned(),
        key,
        value: value.span()?,
        elements,
        string: value.as_str().map(str::to_owned),
    })
}

fn element_spans(array: &Array) -> Vec<Range<usize>> {
    array.iter().filter_map(Value::span).collect()
}

fn in_order(mut keys: Vec<Key>) -> Vec<Key> {
    keys.sort_by_key(|key| key.key.start);
    keys
}
