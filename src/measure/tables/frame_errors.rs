//! Tables of the chapter of frames.

use super::{in_percent, percent, table};
use crate::measure::figures::named;
use crate::measure::frame_errors::Compared;
use crate::relight::COMPONENTS;
use crate::report::{Axis, Block, Cell, Column, Mark, Plot, Row, Series, Style};

/// What the errors of [`Compared::rms`] are of.
const MEANS: [&str; 2] = ["pixels", "8 x 8 blocks"];

/// Errors of the frames in linear light.
pub(in crate::measure) fn image_errors(compared: &[Compared]) -> Block {
    let mut rows = Vec::new();
    for it in compared {
        for (means, rms) in MEANS.into_iter().zip(it.rms) {
            let mut cells = vec![it.name().into(), means.into()];
            cells.extend([rms.found, rms.noise, rms.corrected()].map(in_percent));
            rows.push(Row::plain(cells));
        }
        let mut cells = vec![it.name().into(), "whole picture (bias)".into()];
        cells.extend([it.bias, it.bias_noise].map(in_percent));
        cells.push(Cell::Missing);
        rows.push(Row::plain(cells));
    }
    let columns = vec![
        Column::text("light"),
        Column::text("means of"),
        percent("relRMSE", 3),
        percent("noise of the reference", 3),
        percent("without it", 3),
    ];
    table(
        "image-errors",
        "Linear light of frames against the reference.",
        columns,
        rows,
    )
}

/// Errors of the frames as an observer sees them.
pub(in crate::measure) fn image_flip(compared: &[Compared]) -> Block {
    let row = |it: &Compared| {
        let mut cells = vec![it.name().into()];
        let flip = [it.flip.mean(), it.flip.percentile(95.0), it.flip_of_halves];
        cells.extend(flip.map(Cell::Number));
        Row::plain(cells)
    };
    let columns = vec![
        Column::text("light"),
        Column::number("mean", "", 4),
        Column::number("95th percentile", "", 4),
        Column::number("mean between the reference's halves", "", 4),
    ];
    table(
        "image-flip",
        "FLIP of developed frames against the reference.",
        columns,
        compared.iter().map(row).collect(),
    )
}

/// Time at equal error.
pub(in crate::measure) fn image_times(compared: &[Compared], bake_seconds: f64) -> Block {
    let mut rows = Vec::new();
    for it in compared {
        for (which, means) in MEANS.into_iter().enumerate() {
            let paths = &it.paths[which];
            rows.push(Row::plain(vec![
                it.name().into(),
                means.into(),
                known(it.rms[which].corrected() * 100.0),
                in_percent(paths.error_of_one),
                known(paths.samples),
                Cell::Number(it.seconds_a_sample),
                known(paths.seconds),
                Cell::Number(it.frame_ms),
                known(it.ratios()[which]),
                it.break_even(which, bake_seconds).into(),
            ]));
        }
    }
    let columns = vec![
        Column::text("light"),
        Column::text("error of"),
        percent("error", 2),
        percent("paths' error at 1 path", 1),
        Column::number("paths for the same error", "1/pixel", 1),
        Column::number("1 path a pixel", "s", 4),
        Column::number("paths, one thread", "s", 2),
        Column::number("frame, one thread", "ms", 1),
        Column::number("paths / frame", "", 1),
        Column::number("break-even", "frames", 0),
    ];
    table(
        "time-at-equal-error",
        "Time of one thread at which the path tracer is as wrong as a frame, by its error at few \
         paths and 1 / sqrt(paths); empty where the reference's noise hides the frame's error. \
         Break-even: frames after which the bake has paid.",
        columns,
        rows,
    )
}

/// A value above zero that is known, or nothing.
fn known(value: f64) -> Cell {
    Some(value).filter(|it| *it > 0.0 && it.is_finite()).into()
}

/// How the path tracer's error falls.
pub(in crate::measure) fn path_errors(compared: &[Compared]) -> Block {
    let mut series = Vec::new();
    let mut marks = Vec::new();
    for it in compared {
        for (which, means) in ["pixels", "8 x 8"].into_iter().enumerate() {
            let paths = &it.paths[which];
            let label = format!("{}, {means}", it.name());
            if paths.samples.is_finite() {
                marks.push(Mark {
                    label: format!("frame: {label}"),
                    x: paths.samples,
                    y: it.rms[which].corrected() * 100.0,
                });
            }
            series.push(Series {
                label,
                points: paths.tried.iter().map(|&(x, y)| (x, y * 100.0)).collect(),
                style: Style::Line,
            });
        }
    }
    Block::Plot(Plot {
        name: "path-tracer-error".to_owned(),
        caption: "The path tracer's error at few paths, and the paths that it would need for the \
                  frame's error."
            .to_owned(),
        x: Axis::log("paths", "1/pixel"),
        y: Axis::log("relRMSE", "%"),
        series,
        marks,
    })
}

impl Compared {
    /// What the frame shows, and how, unless it is as always.
    pub(in crate::measure) fn name(&self) -> String {
        named(self.component_name(), self.quality)
    }

    pub(in crate::measure) fn component_name(&self) -> &'static str {
        let known = COMPONENTS.iter();
        let found = known
            .into_iter()
            .find(|(_, component)| *component == self.component);
        found.map_or("light", |(name, _)| name)
    }
}
