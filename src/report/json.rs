//! The report for programs: everything but pixels, with the names of the files.

use serde_json::{Value, json};

use super::{
    Axis, Block, Cell, Comparison, Fact, Picture, Plot, PngImage, Report, Row, Scale, Section,
    Style, Table, picture_path, plot_path, table_path,
};

/// Raised when a key changes its meaning or goes away.
const SCHEMA: u32 = 1;

/// The report as JSON. A number that is not finite is null.
pub(super) fn write(report: &Report) -> String {
    let value = json!({
        "schema": SCHEMA,
        "title": report.title,
        "summary": report.summary.iter().map(fact).collect::<Vec<_>>(),
        "sections": report.sections.iter().map(section).collect::<Vec<_>>(),
    });
    format!("{value:#}\n")
}

fn fact(fact: &Fact) -> Value {
    json!({ "label": fact.label, "value": fact.value, "note": fact.note })
}

fn section(section: &Section) -> Value {
    json!({
        "anchor": section.anchor,
        "heading": section.heading,
        "paragraphs": section.paragraphs,
        "blocks": section.blocks.iter().map(block).collect::<Vec<_>>(),
    })
}

fn block(block: &Block) -> Value {
    match block {
        Block::Table(it) => table(it),
        Block::Plot(it) => plot(it),
        Block::Picture(it) => picture(it),
        Block::Comparison(it) => comparison(it),
    }
}

fn table(table: &Table) -> Value {
    let columns = table.columns.iter();
    let columns: Vec<Value> = columns
        .map(|it| json!({ "label": it.label, "unit": it.unit, "decimals": it.decimals }))
        .collect();
    json!({
        "kind": "table",
        "name": table.name,
        "caption": table.caption,
        "csv": table_path(&table.name),
        "columns": columns,
        "rows": table.rows.iter().map(row).collect::<Vec<_>>(),
    })
}

fn row(row: &Row) -> Value {
    let cell = |cell: &Cell| match cell {
        Cell::Text(text) => json!(text),
        Cell::Number(value) => json!(value),
        Cell::Missing => Value::Null,
    };
    json!({
        "highlight": row.highlight,
        "cells": row.cells.iter().map(cell).collect::<Vec<_>>(),
    })
}

fn plot(plot: &Plot) -> Value {
    let series = plot.series.iter().map(|series| {
        let style = match series.style {
            Style::Line => "line",
            Style::Dots => "dots",
            Style::Dashed => "dashed",
        };
        json!({ "label": series.label, "style": style, "points": series.points })
    });
    let marks = plot.marks.iter();
    let marks = marks.map(|mark| json!({ "label": mark.label, "x": mark.x, "y": mark.y }));
    json!({
        "kind": "plot",
        "name": plot.name,
        "caption": plot.caption,
        "csv": table_path(&plot.name),
        "svg": plot_path(&plot.name),
        "x": axis(&plot.x),
        "y": axis(&plot.y),
        "series": series.collect::<Vec<_>>(),
        "marks": marks.collect::<Vec<_>>(),
    })
}

fn axis(axis: &Axis) -> Value {
    let scale = match axis.scale {
        Scale::Linear => "linear",
        Scale::Log => "log",
    };
    json!({ "label": axis.label, "unit": axis.unit, "scale": scale })
}

fn picture(picture: &Picture) -> Value {
    json!({
        "kind": "picture",
        "name": picture.name,
        "caption": picture.caption,
        "alt": picture.alt,
        "image": image(&picture.name, &picture.image),
    })
}

fn comparison(comparison: &Comparison) -> Value {
    let mut value = json!({
        "kind": "comparison",
        "name": comparison.name,
        "caption": comparison.caption,
    });
    for (side, picture) in comparison.pictures() {
        value[side] = json!({
            "label": picture.label,
            "alt": picture.alt,
            "image": image(&comparison.file_name(&picture.file_word), &picture.image),
        });
    }
    if let Some(strip) = &comparison.strip {
        value["strip"] = image(&comparison.file_name("strip"), strip);
    }
    value
}

fn image(name: &str, image: &PngImage) -> Value {
    json!({ "file": picture_path(name), "width": image.width(), "height": image.height() })
}
