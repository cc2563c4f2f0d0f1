//! Tables and plots as CSV (RFC 4180): one head row, CRLF behind every row,
//! fields with a comma, a quote or a line break in quotes. So little of a
//! format needs no dependency.

use super::number::exact;
use super::{Axis, Cell, Column, Plot, Table};

/// The rows of a table. If a row stands out, a last column says why.
pub(super) fn table(table: &Table) -> String {
    let has_highlights = table.rows.iter().any(|row| row.highlight.is_some());
    let mut head: Vec<String> = table.columns.iter().map(column_head).collect();
    if has_highlights {
        head.push("highlight".to_owned());
    }
    let mut text = record(&head);
    for row in &table.rows {
        let mut fields: Vec<String> = row.cells.iter().map(field).collect();
        if has_highlights {
            fields.push(row.highlight.clone().unwrap_or_default());
        }
        text += &record(&fields);
    }
    text
}

/// All points of a plot, also those that cannot be drawn, and its marks.
pub(super) fn plot(plot: &Plot) -> String {
    let heads = ["kind", "label"].map(str::to_owned);
    let [kind, label] = heads;
    let mut text = record(&[kind, label, plot.x.text(), plot.y.text()]);
    for series in &plot.series {
        for &(x, y) in &series.points {
            text += &record(&["point".to_owned(), series.label.clone(), exact(x), exact(y)]);
        }
    }
    for mark in &plot.marks {
        let place = [exact(mark.x), exact(mark.y)];
        let [x, y] = place;
        text += &record(&["mark".to_owned(), mark.label.clone(), x, y]);
    }
    text
}

impl Axis {
    /// Label with unit.
    pub(super) fn text(&self) -> String {
        with_unit(&self.label, &self.unit)
    }
}

fn column_head(column: &Column) -> String {
    with_unit(&column.label, &column.unit)
}

fn with_unit(label: &str, unit: &str) -> String {
    match unit {
        "" => label.to_owned(),
        _ => format!("{label} ({unit})"),
    }
}

fn field(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number(value) => exact(*value),
        Cell::Missing => String::new(),
    }
}

fn record(fields: &[String]) -> String {
    let quoted: Vec<String> = fields.iter().map(|field| quoted(field)).collect();
    quoted.join(",") + "\r\n"
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Row;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        let table_of = |rows| Table {
            columns: vec![
                Column::text("scene, \"view\""),
                Column::number("time", "ms", 1),
            ],
            rows,
            ..Table::default()
        };
        let rows = vec![
            Row::plain(vec!["two\nlines".into(), 1.25e-7.into()]),
            Row::plain(vec!["plain".into(), Cell::Missing]),
        ];
        assert_eq!(
            table(&table_of(rows)),
            "\"scene, \"\"view\"\"\",time (ms)\r\n\"two\nlines\",1.25e-7\r\nplain,\r\n"
        );
        let rows = vec![Row::highlighted(
            vec!["a".into(), f64::NAN.into()],
            "default",
        )];
        let text = table(&table_of(rows));
        assert!(text.ends_with(",highlight\r\na,NaN,default\r\n"), "{text}");
    }
}
