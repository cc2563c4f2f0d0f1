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
        && let Some(above) = row.checked_sub(1)
    {
        fill(cells, above);
        cells.text(0, above, error, WRONG, PAPER);
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

/// The help over the picture, from its line `first` on.
pub(crate) fn help(cells: &mut Cells, first: usize) {
    let lines = keys::help();
    let widest = lines.iter().map(|(keys, _)| keys.chars().count()).max();
    let keys_width = widest.unwrap_or(0).min(KEYS_WIDTH);
    let page = page(cells.rows());
    for (row, (keys, what)) in (0..).zip(lines.iter().skip(first).take(page)) {
        fill(cells, row);
        if keys.is_empty() {
            cells.text(1, row, what, NAME, PAPER);
        } else {
            cells.text(1, row, keys, INK, PAPER);
            let column = 1 + (keys.chars().count().max(keys_width) + GAP) as u16;
            cells.text(column, row, what, FAINT, PAPER);
        }
    }
}

/// Lines of help on a screen of so many rows.
fn page(rows: u16) -> usize {
    usize::from(rows.saturating_sub(1).max(1))
}

/// The first line of the help that still fills the screen.
pub(crate) fn clamped(first: usize, (_, rows): (u16, u16)) -> usize {
    first.min(keys::help().len().saturating_sub(page(rows)))
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
