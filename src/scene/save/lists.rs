//! Takes entries out of a scene file's lists and puts new ones behind the last.

use std::ops::Range;

use super::SaveError;
use super::editor::Editor;
use super::layout::{Entry, Form, List};

impl Editor {
    /// Takes an entry out of a list, with the comments that are its own: those on
    /// its lines, those directly above it, and those directly below its last key
    /// where an empty line follows them.
    pub(super) fn remove_entry(&mut self, list: &str, index: usize) -> Result<(), SaveError> {
        let found = self.list(list)?;
        let Some(entry) = found.entries().get(index) else {
            return Ok(());
        };
        let range = match &entry.form {
            Form::Header(header) => self.block_to_remove(header.start, entry.end()),
            Form::Inline(span) => self.element_to_remove(found.entries(), index, span),
            Form::Dotted => return Ok(()),
        };
        self.replace(range, "");
        Ok(())
    }

    /// Puts an entry with these keys behind the last one of a list; the file gets
    /// a list where it has none.
    pub(super) fn append_entry(
        &mut self,
        list: &str,
        keys: &[(&str, String)],
    ) -> Result<(), SaveError> {
        let count = self.list(list)?.entries().len();
        self.insert_entry(list, count, keys)
    }

    /// Puts an entry with these keys into a list, where it is the entry of this
    /// number from then on.
    pub(super) fn insert_entry(
        &mut self,
        list: &str,
        index: usize,
        keys: &[(&str, String)],
    ) -> Result<(), SaveError> {
        let keys = keys.iter().map(|(name, value)| format!("{name} = {value}"));
        let keys: Vec<String> = keys.collect();
        match self.list(list)? {
            List::Inline(entries, span) => {
                self.insert_element(
                    &entries,
                    index,
                    &span,
                    &format!("{{ {} }}", keys.join(", ")),
                );
            }
            found => {
                let mut lines = vec![format!("[[{list}]]")];
                lines.extend(keys);
                self.insert_block(found.entries(), index, &lines);
            }
        }
        Ok(())
    }

    fn insert_block(&mut self, entries: &[Entry], index: usize, lines: &[String]) {
        let before = index.checked_sub(1).and_then(|before| entries.get(before));
        if let (None, Some(first)) = (before, entries.first())
            && let Form::Header(header) = &first.form
        {
            let start = self.comments_above(self.line_start(header.start));
            let newline = self.newline();
            let block = lines.join(newline) + newline + newline;
            return self.replace_at(start, &block);
        }
        let end = match before {
            Some(entry) => self.trimmed_end(self.block_end(entry.end())),
            None => self.text().trim_end().len(),
        };
        self.append_block(end, lines);
        self.part_from_next(end, lines);
    }

    /// Puts an empty line behind a block that was appended at a place, where what
    /// follows it would touch it.
    fn part_from_next(&mut self, end: usize, lines: &[String]) {
        let length: usize = lines
            .iter()
            .map(|line| line.len() + self.newline().len())
            .sum();
        let block_end = end + length + self.newline().len();
        let next = self.next_line(block_end.min(self.text().len()));
        if next < self.text().len() && !self.line(next).trim().is_empty() {
            self.replace_at(next, self.newline());
        }
    }

    /// Lines of a block with a header, and the empty lines that follow it; at the
    /// end of the file those that come before it.
    fn block_to_remove(&self, header: usize, end: usize) -> Range<usize> {
        let start = self.comments_above(self.line_start(header));
        let end = self.block_end(end);
        let text = self.text();
        let mut next = end;
        while next < text.len() && self.line(next).trim().is_empty() {
            next = self.next_line(next);
        }
        if next < text.len() {
            return start..next;
        }
        let before = text[..start].trim_end().len();
        // The file ends as it did: with a line end, or without.
        let last_line_end = if text.ends_with('\n') {
            self.newline().len()
        } else {
            0
        };
        before..text.len() - last_line_end
    }

    /// Start of the line behind a block whose last key ends at `end`, with the
    /// comments directly below it that an empty line parts from what follows.
    fn block_end(&self, end: usize) -> usize {
        let after_keys = self.next_line(end);
        let mut next = after_keys;
        while next < self.text().len() && is_comment(self.line(next)) {
            next = self.next_line(next);
        }
        let is_parted = next == self.text().len() || self.line(next).trim().is_empty();
        if is_parted { next } else { after_keys }
    }

    /// Start of the comments directly above a line.
    fn comments_above(&self, line_start: usize) -> usize {
        let mut start = line_start;
        while start > 0 {
            let above = self.line_start(start - 1);
            if !is_comment(self.line(above)) {
                break;
            }
            start = above;
        }
        start
    }

    /// The line that begins at a place.
    fn line(&self, start: usize) -> &str {
        &self.text()[start..self.line_end(start)]
    }

    /// Before the line end that stands before a place.
    fn trimmed_end(&self, place: usize) -> usize {
        self.text()[..place].trim_end_matches(['\r', '\n']).len()
    }

    /// An element in braces: its lines where it has them for itself, else itself
    /// and the comma that parts it from a neighbour.
    fn element_to_remove(
        &self,
        entries: &[Entry],
        index: usize,
        span: &Range<usize>,
    ) -> Range<usize> {
        let text = self.text();
        let after_comma = self.after_comma(span.end);
        let line_start = self.line_start(span.start);
        // The comma may stand on another line.
        let rest = text.get(after_comma.unwrap_or(span.end)..self.line_end(span.end));
        let is_alone = text[line_start..span.start].trim().is_empty()
            && rest.is_some_and(|rest| rest.trim().is_empty() || is_comment(rest));
        if is_alone {
            return self.comments_above(line_start)..self.next_line(span.end);
        }
        let is_last = index + 1 == entries.len();
        if !is_last && let Some(after) = after_comma {
            let spaces = text[after..].len() - text[after..].trim_start_matches([' ', '\t']).len();
            return span.start..after + spaces;
        }
        let lead = text[..span.start].trim_end_matches([' ', '\t', ',']).len();
        let end = if index == 0 {
            after_comma.unwrap_or(span.end)
        } else {
            span.end
        };
        if index == 0 {
            span.start..end
        } else {
            lead..end
        }
    }

    /// Behind the comma that follows a place with nothing but space between.
    fn after_comma(&self, place: usize) -> Option<usize> {
        let rest = &self.text()[place..];
        let spaces = rest.len() - rest.trim_start().len();
        rest[spaces..]
            .starts_with(',')
            .then_some(place + spaces + 1)
    }

    fn insert_element(&mut self, entries: &[Entry], index: usize, list: &Range<usize>, new: &str) {
        let span = |entry: &Entry| match &entry.form {
            Form::Inline(span) => span.clone(),
            _ => list.clone(),
        };
        let before = index.checked_sub(1).and_then(|before| entries.get(before));
        let Some(neighbour) = before.or(entries.first()).map(span) else {
            return self.replace_at(list.end - 1, new);
        };
        let line_start = self.line_start(neighbour.start);
        let lead = self.text()[line_start..neighbour.start].to_owned();
        let has_own_line = lead.trim().is_empty();
        let newline = self.newline();
        match (before.is_some(), has_own_line) {
            (false, false) => self.replace_at(neighbour.start, &format!("{new}, ")),
            (false, true) => {
                let start = self.comments_above(line_start);
                self.replace_at(start, &format!("{lead}{new},{newline}"));
            }
            (true, false) => self.replace_at(neighbour.end, &format!(", {new}")),
            // Behind the comma and the comment of the one before.
            (true, true) => match self.after_comma(neighbour.end) {
                Some(comma) => {
                    let end = self.end_of_element_line(comma, list);
                    self.replace_at(end, &format!("{newline}{lead}{new},"));
                }
                None => {
                    let end = self.end_of_element_line(neighbour.end, list);
                    self.replace_at(end, &format!("{newline}{lead}{new}"));
                    self.replace_at(neighbour.end, ",");
                }
            },
        }
    }

    /// End of the line of an element, before the list's bracket if that is there.
    fn end_of_element_line(&self, place: usize, list: &Range<usize>) -> usize {
        let end = self.line_end(place);
        if end < list.end { end } else { place }
    }
}

fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with('#')
}
