//! Tables of the variants that were tried.

use super::{percent, table};
use crate::measure::methods::{Knob, Variant};
use crate::report::{Block, Cell, Column, Row};

/// Scenes of a knob in the order in which they were measured.
fn scenes(knob: &Knob) -> Vec<&str> {
    let first = knob.variants.first();
    let findings = first.iter().flat_map(|variant| &variant.findings);
    findings.map(|finding| finding.scene.as_str()).collect()
}

/// The mean over the scenes, if all have it.
fn mean(values: impl Iterator<Item = Option<f64>>) -> Cell {
    let values: Option<Vec<f64>> = values.collect();
    match values {
        Some(values) if !values.is_empty() => {
            Cell::Number(values.iter().sum::<f64>() / values.len() as f64)
        }
        _ => Cell::Missing,
    }
}

/// The variants of a knob: means over the scenes, then scene by scene.
pub(in crate::measure) fn knob(knob: &Knob) -> Block {
    let mut columns = vec![
        Column::text("variant"),
        percent("one bounce", 2),
        percent("95th percentile", 2),
        percent("signed, mean size", 2),
        percent("four bounces", 2),
        percent("95th percentile of these", 2),
        Column::number("bytes a vertex", "", 0),
        Column::number("processor", "s", 1),
    ];
    let scenes = scenes(knob);
    columns.extend(scenes.iter().map(|scene| percent(scene, 2)));
    let row = |variant: &Variant| {
        let of = |get: &dyn Fn(&crate::measure::methods::Finding) -> Option<f64>| {
            mean(variant.findings.iter().map(get))
        };
        let mut cells = vec![
            variant.name.as_str().into(),
            of(&|it| Some(it.one[0])),
            of(&|it| Some(it.one[1])),
            of(&|it| Some(it.one[2].abs())),
            of(&|it| Some(it.four?[0])),
            of(&|it| Some(it.four?[1])),
            of(&|it| it.bytes),
            of(&|it| it.cpu_seconds),
        ];
        cells.extend(scenes.iter().map(|scene| {
            let found = variant.findings.iter().find(|it| it.scene == **scene);
            found.map_or(Cell::Missing, |it| Cell::Number(it.one[0]))
        }));
        if variant.chosen {
            Row::highlighted(cells, "chosen")
        } else {
            Row::plain(cells)
        }
    };
    let slug = knob.name.to_lowercase().replace(' ', "-");
    table(
        &format!("method-{slug}"),
        &format!(
            "{}: means over the scenes, then one bounce scene by scene. {}",
            knob.name, knob.reason
        ),
        columns,
        knob.variants.iter().map(row).collect(),
    )
}
