//! Tables and plots of what was measured.

mod frame_errors;
mod glossy;
mod methods;
mod sweeps;
mod vertices;

pub(super) use frame_errors::{image_errors, image_flip, image_times, path_errors};
pub(super) use glossy::glossy_errors;
pub(super) use methods::knob;
pub(super) use sweeps::{at_equal_bytes, equal_bytes, ratio, sweep_plots, sweep_table};
pub(super) use vertices::{
    errors_by_contact, errors_by_kind, extremes, parts, paths, vertex_errors,
};

use crate::report::{Block, Cell, Column, Row, Table};

/// Names of the two tests of a bake.
const BOUNCE_NAMES: [&str; 2] = ["one, white", "four, scene's grey"];

fn percent(label: &str, decimals: usize) -> Column {
    Column::number(label, "%", decimals)
}

fn in_percent(value: f64) -> Cell {
    Cell::Number(value * 100.0)
}

fn table(name: &str, caption: &str, columns: Vec<Column>, rows: Vec<Row>) -> Block {
    Block::Table(Table {
        name: name.to_owned(),
        caption: caption.to_owned(),
        columns,
        rows,
    })
}

/// Time of the chapters.
pub(super) fn chapter_times(seconds: &[(&'static str, f64)]) -> Block {
    let row = |&(chapter, seconds): &(&'static str, f64)| {
        Row::plain(vec![chapter.into(), Cell::Number(seconds)])
    };
    table(
        "time-of-the-report",
        "Seconds of the chapters by the clock.",
        vec![Column::text("chapter"), Column::number("time", "s", 1)],
        seconds.iter().map(row).collect(),
    )
}
