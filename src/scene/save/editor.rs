//! Changes one key of a scene file's text at a time and leaves the rest as it is.

use std::cell::RefCell;
use std::ops::Range;

use super::SaveError;
use super::layout::{Entry, Form, Key, Layout, List, Place};

/// A value as it is to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Written {
    Plain(String),
    /// A list of numbers.
    List(Vec<String>),
}

impl Written {
    pub(super) fn text(&self) -> String {
        match self {
            Self::Plain(text) => text.clone(),
            Self::List(numbers) => format!("[{}]", numbers.join(", ")),
        }
    }
}

impl<const N: usize> From<[String; N]> for Written {
    fn from(numbers: [String; N]) -> Self {
        Self::List(numbers.into())
    }
}

/// A text under change. It is parsed anew where a change may have moved what is
/// asked for, and not for each light: edits of 500 of them take 1 to 7 ms.
pub(super) struct Editor {
    text: String,
    /// Line ends, as the first line has them.
    newline: &'static str,
    parsed: RefCell<Option<Parsed>>,
    #[cfg(test)]
    pub(super) parse_count: std::cell::Cell<usize>,
}

/// A text as it was parsed.
struct Parsed {
    layout: Layout,
    /// Where the first change since then begins: what ends before is as it was.
    /// `None` without a change.
    changed_from: Option<usize>,
}

impl Editor {
    pub(super) fn new(text: &str) -> Self {
        let first_line = text.split_inclusive('\n').next().unwrap_or("");
        Self {
            text: text.to_owned(),
            newline: if first_line.ends_with("\r\n") {
                "\r\n"
            } else {
                "\n"
            },
            parsed: RefCell::default(),
            #[cfg(test)]
            parse_count: std::cell::Cell::default(),
        }
    }

    pub(super) fn into_text(self) -> String {
        self.text
    }

    pub(super) fn text(&self) -> &str {
        &self.text
    }

    pub(super) fn newline(&self) -> &'static str {
        self.newline
    }

    /// The table at a place; `None` where the text has none.
    pub(super) fn entry(&self, place: Place) -> Result<Option<Entry>, SaveError> {
        // A new last key stands behind the comment of the one before.
        let is_unmoved = |entry: &Option<Entry>, changed_from: usize| {
            entry.as_ref().is_some_and(|entry| {
                entry.end() < changed_from && self.line_end(entry.end()) < changed_from
            })
        };
        self.found(|layout| layout.entry(place).cloned(), is_unmoved)
    }

    pub(super) fn list(&self, name: &str) -> Result<List, SaveError> {
        self.found(|layout| layout.list(name).clone(), |_, _| false)
    }

    /// Something of the layout: of the one that is known, if that has not changed
    /// or this is unmoved by what changed.
    fn found<T>(
        &self,
        find: impl Fn(&Layout) -> T,
        is_unmoved: impl Fn(&T, usize) -> bool,
    ) -> Result<T, SaveError> {
        let mut parsed = self.parsed.borrow_mut();
        if let Some(known) = parsed.as_ref() {
            let found = find(&known.layout);
            if known
                .changed_from
                .is_none_or(|from| is_unmoved(&found, from))
            {
                return Ok(found);
            }
        }
        #[cfg(test)]
        self.parse_count.set(self.parse_count.get() + 1);
        let layout = Layout::of(&self.text)?;
        let found = find(&layout);
        let changed_from = None;
        *parsed = Some(Parsed {
            layout,
            changed_from,
        });
        Ok(found)
    }

    /// From here on the text is not what was parsed.
    fn changes_from(&mut self, start: usize) {
        if let Some(parsed) = self.parsed.get_mut() {
            let known = parsed.changed_from.unwrap_or(usize::MAX);
            parsed.changed_from = Some(known.min(start));
        }
    }

    /// The number that a key has in the text.
    pub(super) fn number(&self, place: Place, name: &str) -> Result<Option<f64>, SaveError> {
        let key = self
            .entry(place)?
            .and_then(|entry| entry.key(name).cloned());
        Ok(key.and_then(|key| number(&self.text[key.value])))
    }

    /// The numbers of the list that a key has in the text.
    pub(super) fn numbers(&self, place: Place, name: &str) -> Result<Vec<f64>, SaveError> {
        let key = self
            .entry(place)?
            .and_then(|entry| entry.key(name).cloned());
        let elements = key.map_or(Vec::new(), |key| key.elements).into_iter();
        Ok(elements
            .filter_map(|range| number(&self.text[range]))
            .collect())
    }

    pub(super) fn replace(&mut self, range: Range<usize>, new: &str) {
        self.changes_from(range.start);
        self.text.replace_range(range, new);
    }

    /// Gives a key a value, in place where it is there already.
    pub(super) fn set(
        &mut self,
        place: Place,
        name: &str,
        value: &Written,
    ) -> Result<(), SaveError> {
        match self.entry(place)? {
            Some(entry) => match entry.key(name) {
                Some(key) => self.overwrite(key, value),
                None => self.insert(&entry, name, &value.text()),
            },
            None => {
                let Place::Section(section) = place else {
                    return Err(SaveError::NotTheText(
                        "an entry that was edited is no longer in the scene file".to_owned(),
                    ));
                };
                let lines = [format!("[{section}]"), format!("{name} = {}", value.text())];
                self.append_block(self.text.trim_end().len(), &lines);
            }
        }
        Ok(())
    }

    /// Gives a key another name, and a value that the new name wants.
    pub(super) fn rename(
        &mut self,
        place: Place,
        [old, new]: [&str; 2],
        value: &Written,
    ) -> Result<(), SaveError> {
        if let Some(key) = self.entry(place)?.and_then(|entry| entry.key(old).cloned()) {
            self.overwrite(&key, value);
            self.replace(key.key, new);
        }
        Ok(())
    }

    /// Takes a key out, with the rest of its line.
    pub(super) fn remove(&mut self, place: Place, name: &str) -> Result<(), SaveError> {
        let Some(entry) = self.entry(place)? else {
            return Ok(());
        };
        let Some(index) = entry.keys.iter().position(|key| key.name == name) else {
            return Ok(());
        };
        let key = &entry.keys[index];
        let range = match entry.form {
            Form::Header(_) | Form::Dotted => {
                self.line_start(key.key.start)..self.next_line(key.value.end)
            }
            Form::Inline(_) => match (index.checked_sub(1), entry.keys.get(index + 1)) {
                (_, Some(next)) => key.key.start..next.key.start,
                (Some(before), None) => entry.keys[before].value.end..key.value.end,
                (None, None) => key.key.start..key.value.end,
            },
        };
        self.replace(range, "");
        Ok(())
    }

    /// Replaces a value. Of a list only the numbers that change are touched, so
    /// that its lines and the comments between them stay.
    fn overwrite(&mut self, key: &Key, value: &Written) {
        if let Written::List(numbers) = value
            && numbers.len() == key.elements.len()
        {
            for (range, number) in key.elements.iter().zip(numbers).rev() {
                if !reads_as(&self.text[range.clone()], number) {
                    self.replace(range.clone(), number);
                }
            }
            return;
        }
        let text = value.text();
        if !reads_as(&self.text[key.value.clone()], &text) {
            self.replace(key.value.clone(), &text);
        }
    }

    /// Adds a key behind the last one of a table.
    fn insert(&mut self, entry: &Entry, name: &str, value: &str) {
        match (&entry.form, entry.keys.last()) {
            (Form::Inline(_), Some(last)) => {
                self.replace_at(last.value.end, &format!(", {name} = {value}"));
            }
            (Form::Inline(range), None) => {
                self.replace_at(range.start + 1, &format!(" {name} = {value} "));
            }
            (_, last) => {
                // A dotted key repeats what stands before its last part.
                let lead = last.map_or(String::new(), |last| {
                    let start = self.line_start(last.key.start);
                    self.text[start..last.key.start].to_owned()
                });
                let line = format!("{}{lead}{name} = {value}", self.newline);
                self.replace_at(self.line_end(entry.end()), &line);
            }
        }
    }

    /// Adds a key below the header of a table, or as [`Self::set`] does.
    pub(super) fn set_first(
        &mut self,
        place: Place,
        name: &str,
        value: &str,
    ) -> Result<(), SaveError> {
        match self.entry(place)? {
            Some(Entry {
                form: Form::Header(header),
                keys,
            }) => {
                let indent = keys.first().map_or(String::new(), |first| {
                    let start = self.line_start(first.key.start);
                    self.text[start..first.key.start].to_owned()
                });
                let line = format!("{}{indent}{name} = {value}", self.newline);
                self.replace_at(self.line_end(header.end), &line);
                Ok(())
            }
            _ => self.set(place, name, &Written::Plain(value.to_owned())),
        }
    }

    /// Adds lines as a block of their own, with an empty line before them,
    /// behind the line that ends at `end`.
    pub(super) fn append_block(&mut self, end: usize, lines: &[String]) {
        let mut block = String::new();
        if end > 0 {
            block.push_str(self.newline);
        }
        for (index, line) in lines.iter().enumerate() {
            if index > 0 || end > 0 {
                block.push_str(self.newline);
            }
            block.push_str(line);
        }
        self.replace_at(end, &block);
    }

    pub(super) fn replace_at(&mut self, place: usize, new: &str) {
        self.changes_from(place);
        self.text.insert_str(place, new);
    }

    /// Start of the line that a place is in.
    pub(super) fn line_start(&self, place: usize) -> usize {
        self.text[..place].rfind('\n').map_or(0, |end| end + 1)
    }

    /// End of the line that a place is in, before its line end.
    pub(super) fn line_end(&self, place: usize) -> usize {
        let end = self.text[place..].find('\n').map(|end| place + end);
        match end {
            Some(end) if self.text[..end].ends_with('\r') && end > place => end - 1,
            Some(end) => end,
            None => self.text.len(),
        }
    }

    /// Start of the line behind the one that a place is in.
    pub(super) fn next_line(&self, place: usize) -> usize {
        let end = self.text[place..].find('\n');
        end.map_or(self.text.len(), |end| place + end + 1)
    }
}

/// Whether a number in the text is the new one already, however it is written.
fn reads_as(old: &str, new: &str) -> bool {
    let bits = |text: &str| number(text).map(f64::to_bits);
    bits(old).is_some() && bits(old) == bits(new)
}

/// A decimal number of TOML.
fn number(text: &str) -> Option<f64> {
    text.replace('_', "").parse().ok()
}
