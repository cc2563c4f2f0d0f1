//! What stands over and below the picture: status line, questions, help.

use super::input::{Code, Key};
use super::keys;
use super::status::Status;
use crate::output::terminal::Cells;

type Levels = [u8; 3];

const PAPER: Levels = [28, 28, 34];
const INK: Levels = [225, 225, 225];
const FAINT: Levels = [140, 140, 150];
const NAME: Levels = [255, 190, 0];
const WRONG: Levels = [255, 110, 100];
const QUESTION: Levels = [120, 215, 255];
/// Columns between the keys of the help and what they do.
const GAP: usize = 2;
/// Where so few columns are left beside the keys, what they do stands below them.
const NARROW: usize = 24;
/// Most rows of what is wrong with the scene's files.
const MOST_ERROR_ROWS: usize = 4;
/// Widest column of keys in the help.
const KEYS_WIDTH: usize = 20;

/// What the last row says below the help.
pub(crate) const HELP_KEYS: &str =
    "arrows, PgUp, PgDn scroll; any other key goes back to the picture";

/// What the last row shows.
pub(crate) enum Bottom<'a> {
    /// A question and its answers.
    Question(&'static str),
    Status {
        status: &'a Status,
        selected: Option<&'a str>,
        is_unsaved: bool,
    },
}

/// Draws the last row, if there is one beside the picture; and what is wrong with
/// the scene's files above it, until it is mended.
pub(crate) fn bottom(cells: &mut Cells, bottom: &Bottom) {
    if cells.rows() < 2 {
        return;
    }
    let row = cells.rows() - 1;
    fill(cells, row);
    if let Bottom::Status { status, .. } = bottom
        && let Some(error) = &status.file_error
    {
        let mut lines = wrapped(error, usize::from(cells.columns()));
        lines.truncate(MOST_ERROR_ROWS.min(usize::from(row)));
        let first = row - lines.len() as u16;
        for (row, line) in (first..).zip(&lines) {
            fill(cells, row);
            cells.text(0, row, line, WRONG, PAPER);
        }
    }
    match bottom {
        Bottom::Question(text) => cells.text(0, row, text, QUESTION, PAPER),
        Bottom::Status {
            status,
            selected,
            is_unsaved,
        } => {
            let star = if *is_unsaved { "*" } else { "" };
            let name = selected.map_or(star.to_owned(), |name| format!("{star}[{name}]"));
            let mut column = put(cells, 0, &name, NAME);
            if column > 0 {
                column += 1;
            }
            let ink = if status.is_failure() { WRONG } else { INK };
            column = put(cells, column, status.words(), ink);
            let figures = fitting(
                &status.figures(),
                cells.columns().saturating_sub(column + 2),
            );
            let width = figures.chars().count() as u16;
            put(cells, cells.columns() - width, &figures, FAINT);
        }
    }
}

/// As many figures, from the first on, as there are columns for.
fn fitting(figures: &[String], columns: u16) -> String {
    let mut text = String::new();
    for figure in figures {
        let gap = if text.is_empty() { "" } else { "  " };
        let longer = format!("{text}{gap}{figure}");
        if longer.chars().count() > usize::from(columns) {
            break;
        }
        text = longer;
    }
    text
}

/// Writes into the last row; returns the column behind.
fn put(cells: &mut Cells, column: u16, text: &str, ink: Levels) -> u16 {
    let row = cells.rows() - 1;
    cells.text(column, row, text, ink, PAPER);
    let width = u16::try_from(text.chars().count()).unwrap_or(u16::MAX);
    column.saturating_add(width).min(cells.columns())
}

fn fill(cells: &mut Cells, row: u16) {
    let blank = " ".repeat(usize::from(cells.columns()));
    cells.text(0, row, &blank, INK, PAPER);
}

/// Before the first picture: what is awaited.
pub(crate) fn waiting(cells: &mut Cells, status: &Status) {
    let text = status.figures().join("  ");
    let (columns, rows) = (cells.columns(), cells.rows());
    let width = u16::try_from(text.chars().count()).unwrap_or(u16::MAX);
    let column = columns.saturating_sub(width) / 2;
    cells.text(column, rows / 2, &text, FAINT, [0; 3]);
}

/// A line of the help as it is drawn.
struct HelpLine {
    keys: String,
    what: String,
    /// First column of `what`.
    column: u16,
    ink: Levels,
}

/// The help on a screen so wide: what is too long goes on in lines of its own.
fn help_lines(columns: u16) -> Vec<HelpLine> {
    let lines = keys::help();
    let widest = lines.iter().map(|(keys, _)| keys.chars().count()).max();
    let keys_width = widest.unwrap_or(0).min(KEYS_WIDTH);
    let mut drawn = Vec::new();
    for (keys, what) in lines {
        let (column, ink) = match keys.is_empty() {
            true => (1, NAME),
            false => (1 + keys.chars().count().max(keys_width) + GAP, FAINT),
        };
        let room = usize::from(columns).saturating_sub(column + 1);
        // Where the keys leave no room, what they do stands below them.
        let (column, below) = match room < NARROW {
            true => (1 + GAP, true),
            false => (column, false),
        };
        let mut keys = Some(keys);
        if below && let Some(keys) = keys.take() {
            drawn.push(HelpLine {
                keys,
                what: String::new(),
                column: 1,
                ink,
            });
        }
        for what in wrapped(what, usize::from(columns).saturating_sub(column + 1)) {
            drawn.push(HelpLine {
                keys: keys.take().unwrap_or_default(),
                what,
                column: column as u16,
                ink,
            });
        }
    }
    drawn
}

/// A text in lines of at most so many characters, cut between words where it can
/// be.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        let length = lines[last].chars().count();
        if length > 0 && length + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            if length > 0 {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        }
    }
    lines
}

/// The help over the picture, from its line `first` on.
pub(crate) fn help(cells: &mut Cells, first: usize) {
    let page = page(cells.rows());
    let lines = help_lines(cells.columns());
    for (row, line) in (0..).zip(lines.iter().skip(first).take(page)) {
        fill(cells, row);
        cells.text(1, row, &line.keys, INK, PAPER);
        cells.text(line.column, row, &line.what, line.ink, PAPER);
    }
}

/// Lines of help on a screen of so many rows.
fn page(rows: u16) -> usize {
    usize::from(rows.saturating_sub(1).max(1))
}

/// The first line of the help that still fills the screen.
pub(crate) fn clamped(first: usize, (columns, rows): (u16, u16)) -> usize {
    first.min(help_lines(columns).len().saturating_sub(page(rows)))
}

/// The first line of the help after a key; `None`: the key closes it.
pub(crate) fn scrolled(first: usize, key: Key, size: (u16, u16)) -> Option<usize> {
    let page = page(size.1);
    let wanted = match key.code {
        Code::Up => first.saturating_sub(1),
        Code::Down => first + 1,
        Code::PageUp => first.saturating_sub(page),
        Code::PageDown | Code::Char(' ') => first + page,
        Code::Home => 0,
        Code::End => usize::MAX,
        _ => return None,
    };
    Some(clamped(wanted, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_loses_no_word_on_a_narrow_screen() {
        let words = |columns: u16| {
            let lines = help_lines(columns);
            let texts = lines
                .iter()
                .flat_map(|line| [line.keys.clone(), line.what.clone()]);
            texts
                .collect::<Vec<_>>()
                .join(" ")
                .split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(words(40), words(400));
        for line in help_lines(60) {
            let end = usize::from(line.column) + line.what.chars().count();
            assert!(end < 60, "{}", line.what);
        }
    }
}
