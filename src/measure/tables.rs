//! Tables and plots of what was measured.

use super::image::Compared;
use super::run::{SchemeResult, Vertices};
use super::statistics::{between, over_lights};
use super::sweeps::{Point, Swept};
use super::vertices::{EXTREMES, test_lights};
use crate::bake::{LIGHTS, LightErrors, Scheme, TestKind};
use crate::report::{Axis, Block, Cell, Column, Mark, Plot, Row, Series, Style, Table};

/// Bytes a vertex at which the schemes are compared.
pub(super) const COMPARED_BYTES: [f64; 3] = [100.0, 130.0, 160.0];
/// The word on rows and marks of the default settings.
const DEFAULT: &str = "default";
const EXTREME_NAMES: [&str; EXTREMES] =
    ["lamp 0.02 extents from a corner", "patch with a hard edge"];
const KINDS: [TestKind; 4] = [
    TestKind::Point,
    TestKind::Spot,
    TestKind::Sun,
    TestKind::Sky,
];
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

/// The columns of [`light_cells`].
fn light_columns() -> [Column; 4] {
    [
        percent("mean", 2),
        percent("95th percentile", 2),
        percent("worst", 2),
        percent("signed mean", 3),
    ]
}

fn light_cells(errors: LightErrors) -> [Cell; 4] {
    [errors.mean, errors.p95, errors.worst, errors.signed].map(in_percent)
}

/// Errors over the test lights.
pub(super) fn vertex_errors(found: &Vertices) -> Block {
    let noise = found
        .truth
        .noise()
        .map(|it| over_lights(&test_lights(&it), |_| true));
    let mut rows = Vec::new();
    for scheme in &found.schemes {
        for which in 0..2 {
            let mut cells = name_cells(scheme, which);
            cells.extend(light_cells(scheme.errors.all(which)));
            cells.push(in_percent(noise[which].mean));
            cells.push(Cell::Number(scheme.point.bytes_per_vertex));
            rows.push(Row::plain(cells));
        }
    }
    let mut columns = vec![Column::text("scheme"), Column::text("bounces")];
    columns.extend(light_columns());
    columns.push(percent("noise of the truth", 2));
    columns.push(Column::number("operator", "B/vertex", 0));
    table(
        "vertex-errors",
        "Relative error of indirect light at the vertices, over the test lights; the noise of the \
         truth is taken off in quadrature.",
        columns,
        rows,
    )
}

fn name_cells(scheme: &SchemeResult, which: usize) -> Vec<Cell> {
    vec![
        scheme.settings.scheme.name().into(),
        BOUNCE_NAMES[which].into(),
    ]
}

/// The same by kind of light.
pub(super) fn errors_by_kind(found: &Vertices) -> Block {
    let mut rows = Vec::new();
    for kind in KINDS {
        let is_kind = |light: usize| found.truth.lights[light].kind == kind;
        let count = (0..LIGHTS).filter(|&light| is_kind(light)).count();
        if count == 0 {
            continue;
        }
        for scheme in &found.schemes {
            for which in 0..2 {
                let errors = test_lights(&scheme.errors.by_bounces[which]);
                let mut cells = vec![kind.name().into(), Cell::Number(count as f64)];
                cells.extend(name_cells(scheme, which));
                cells.extend(light_cells(over_lights(&errors, is_kind)));
                rows.push(Row::plain(cells));
            }
        }
    }
    let mut columns = vec![
        Column::text("lights"),
        Column::number("count", "", 0),
        Column::text("scheme"),
        Column::text("bounces"),
    ];
    columns.extend(light_columns());
    table(
        "vertex-errors-by-kind",
        "The same by kind of light.",
        columns,
        rows,
    )
}

/// The two extremes.
pub(super) fn extremes(found: &Vertices) -> Block {
    let noise = found.truth.noise();
    let mut rows = Vec::new();
    for (number, name) in EXTREME_NAMES.into_iter().enumerate() {
        for scheme in &found.schemes {
            for which in 0..2 {
                let light = LIGHTS + number;
                let error = scheme.errors.by_bounces[which][light];
                let mut cells = vec![name.into()];
                cells.extend(name_cells(scheme, which));
                cells.extend([0, 1].map(|i| Cell::from(error.map(|e| e[i] * 100.0))));
                cells.push(noise[which][light].map(|e| e[0] * 100.0).into());
                rows.push(Row::plain(cells));
            }
        }
    }
    let columns = vec![
        Column::text("light"),
        Column::text("scheme"),
        Column::text("bounces"),
        percent("error", 2),
        percent("signed", 3),
        percent("noise of the truth", 2),
    ];
    table(
        "extreme-lights",
        "Lights beyond what the defaults are for, apart from the means above.",
        columns,
        rows,
    )
}

/// Where the error after one bounce comes from.
pub(super) fn parts(found: &Vertices) -> Block {
    let sampling = found.truth.vertex_sampling();
    let mut rows = Vec::new();
    for scheme in &found.schemes {
        let parts = &scheme.parts;
        for (what, errors) in [
            ("total", scheme.errors.all(0)),
            ("noise of the sampled rows", parts.noise),
            ("basis", parts.basis),
            ("compression", parts.compression),
        ] {
            let mut cells = vec![scheme.settings.scheme.name().into(), what.into()];
            cells.extend(light_cells(errors));
            rows.push(Row::plain(cells));
        }
    }
    let mut cells = vec!["both".into(), "vertex sampling".into()];
    cells.extend(light_cells(sampling));
    rows.push(Row::plain(cells));
    let mut columns = vec![Column::text("scheme"), Column::text("part")];
    columns.extend(light_columns());
    table(
        "error-parts",
        "Parts of the error after one bounce. They do not sum up: a low-rank product takes off a \
         good part of the noise.",
        columns,
        rows,
    )
}

/// Some vertices against the path tracer.
pub(super) fn paths(found: &Vertices) -> Block {
    let mut rows = Vec::new();
    for light in &found.paths {
        for (scheme, light) in Scheme::ALL.iter().zip(light) {
            let mut cells = vec![light.kind.name().into(), scheme.name().into()];
            let [found, own] = light.errors;
            let figures = [found, light.noise[0], own, light.signed, light.noise[1]];
            cells.extend(figures.map(in_percent));
            rows.push(Row::plain(cells));
        }
    }
    let columns = vec![
        Column::text("light"),
        Column::text("scheme"),
        percent("found", 2),
        percent("standard error of the paths", 2),
        percent("error without it", 2),
        percent("signed", 3),
        percent("standard error of their sum", 3),
    ];
    table(
        "vertices-against-paths",
        "Indirect light of four bounces in the scene's colours at random vertices, against paths; \
         their standard error is taken off in quadrature.",
        columns,
        rows,
    )
}

impl Swept {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Functions => "functions",
            Self::Coefficients => "coefficients",
            Self::Rays => "rays",
        }
    }

    fn caption(self) -> &'static str {
        match self {
            Self::Functions => {
                "Error against functions of the basis (the paper's figure 6), one bounce; dashed: \
                 nothing left out and nothing quantised."
            }
            Self::Coefficients => "Error against entries a vertex, one bounce and four.",
            Self::Rays => "Error against rays a vertex, one bounce.",
        }
    }
}

/// The table of a sweep.
pub(super) fn sweep_table(swept: Swept, points: &[Point]) -> Block {
    let row = |point: &Point| {
        let cells = vec![
            point.scheme.name().into(),
            Cell::Number(point.functions as f64),
            Cell::Number(point.coefficients),
            Cell::Number(f64::from(point.rays)),
            Cell::Number(point.bytes_per_vertex),
            in_percent(point.errors[0].mean),
            in_percent(point.errors[0].p95),
            in_percent(point.errors[1].mean),
            point.uncut.map(|error| error * 100.0).into(),
            Cell::Number(point.relight_ms),
        ];
        if point.is_default {
            Row::highlighted(cells, DEFAULT)
        } else {
            Row::plain(cells)
        }
    };
    let columns = vec![
        Column::text("scheme"),
        Column::number("functions", "", 0),
        Column::number("entries a vertex", "", 1),
        Column::number("rays", "", 0),
        Column::number("operator", "B/vertex", 0),
        percent("one bounce", 2),
        percent("95th percentile", 2),
        percent("four bounces", 2),
        percent("nothing cut", 2),
        Column::number("four bounces", "ms", 2),
    ];
    let name = format!("sweep-{}", swept.name());
    table(
        &name,
        "Means over the test lights.",
        columns,
        points.iter().map(row).collect(),
    )
}

/// The plots of a sweep.
pub(super) fn sweep_plots(swept: Swept, points: &[Point]) -> Vec<Block> {
    let name = swept.name();
    let x = |point: &Point| swept.place(point);
    let label = if swept == Swept::Coefficients {
        "entries a vertex"
    } else {
        name
    };
    let mut series = by_scheme(points, &x, 0, Style::Line, "");
    match swept {
        Swept::Functions => {
            for scheme in Scheme::ALL {
                let of_scheme = points.iter().filter(|point| point.scheme == scheme);
                let uncut = of_scheme.filter_map(|p| Some((x(p), p.uncut? * 100.0)));
                series.push(Series {
                    label: format!("{}, nothing cut", scheme.name()),
                    points: uncut.collect(),
                    style: Style::Dashed,
                });
            }
        }
        Swept::Coefficients => {
            series.extend(by_scheme(points, &x, 1, Style::Dashed, ", four bounces"))
        }
        Swept::Rays => {}
    }
    let mut blocks = vec![error_plot(
        &format!("error-against-{name}"),
        swept.caption(),
        Axis::log(label, ""),
        series,
        marks(points, &x),
    )];
    if swept == Swept::Coefficients {
        for (name, axis, value, caption) in [
            (
                "error-against-bytes",
                Axis::log("operator", "B/vertex"),
                (|p: &Point| p.bytes_per_vertex) as fn(&Point) -> f64,
                "Error against bytes of the operator, one bounce; the basis is apart.",
            ),
            (
                "error-against-milliseconds",
                Axis::log("four bounces", "ms"),
                |p: &Point| p.relight_ms,
                "Error against the time of four bounces, all threads, direct light and pixels \
                 left out.",
            ),
        ] {
            let series = by_scheme(points, &value, 0, Style::Line, "");
            blocks.push(error_plot(
                name,
                caption,
                axis,
                series,
                marks(points, &value),
            ));
        }
    }
    blocks
}

fn by_scheme(
    points: &[Point],
    x: &dyn Fn(&Point) -> f64,
    which: usize,
    style: Style,
    behind: &str,
) -> Vec<Series> {
    Scheme::ALL
        .into_iter()
        .map(|scheme| Series {
            label: format!("{}{behind}", scheme.name()),
            points: points
                .iter()
                .filter(|point| point.scheme == scheme)
                .map(|point| (x(point), point.errors[which].mean * 100.0))
                .collect(),
            style,
        })
        .collect()
}

fn marks(points: &[Point], x: &dyn Fn(&Point) -> f64) -> Vec<Mark> {
    points
        .iter()
        .filter(|point| point.is_default)
        .map(|point| Mark {
            label: DEFAULT.to_owned(),
            x: x(point),
            y: point.errors[0].mean * 100.0,
        })
        .collect()
}

fn error_plot(name: &str, caption: &str, x: Axis, series: Vec<Series>, marks: Vec<Mark>) -> Block {
    Block::Plot(Plot {
        name: name.to_owned(),
        caption: caption.to_owned(),
        x,
        y: Axis::log("error of indirect light", "%"),
        series,
        marks,
    })
}

/// (bytes a vertex, errors of both schemes) where the sweep of coefficients
/// reaches both.
pub(super) fn at_equal_bytes(points: &[Point], which: usize) -> Vec<(f64, [Option<f64>; 2])> {
    COMPARED_BYTES
        .into_iter()
        .map(|bytes| {
            let errors = Scheme::ALL.map(|scheme| {
                let of_scheme = points.iter().filter(|point| point.scheme == scheme);
                let curve: Vec<(f64, f64)> = of_scheme
                    .map(|p| (p.bytes_per_vertex, p.errors[which].mean))
                    .collect();
                between(&curve, bytes)
            });
            (bytes, errors)
        })
        .collect()
}

/// How many times as wrong the published scheme is.
pub(super) fn ratio([relume, paper]: [Option<f64>; 2]) -> Option<f64> {
    Some(paper? / relume?)
}

/// Both schemes at equal bytes.
pub(super) fn equal_bytes(points: &[Point]) -> Block {
    let mut rows = Vec::new();
    for which in 0..2 {
        for (bytes, errors) in at_equal_bytes(points, which) {
            let [relume, paper] = errors.map(|error| Cell::from(error.map(|e| e * 100.0)));
            rows.push(Row::plain(vec![
                Cell::Number(bytes),
                BOUNCE_NAMES[which].into(),
                relume,
                paper,
                ratio(errors).into(),
            ]));
        }
    }
    let columns = vec![
        Column::number("operator", "B/vertex", 0),
        Column::text("bounces"),
        percent("relume", 2),
        percent("paper", 2),
        Column::number("paper / relume", "", 2),
    ];
    table(
        "equal-bytes",
        "Error at equal bytes, between the points of the sweep of coefficients (straight in \
         logarithms); empty where the sweep does not reach.",
        columns,
        rows,
    )
}

/// What the errors of [`Compared::rms`] are of.
const MEANS: [&str; 2] = ["pixels", "8 x 8 blocks"];

/// Errors of the frames in linear light.
pub(super) fn image_errors(compared: &[Compared]) -> Block {
    let mut rows = Vec::new();
    for it in compared {
        for (means, rms) in MEANS.into_iter().zip(it.rms) {
            let mut cells = vec![it.component_name().into(), means.into()];
            cells.extend([rms.found, rms.noise, rms.corrected()].map(in_percent));
            rows.push(Row::plain(cells));
        }
        let mut cells = vec![it.component_name().into(), "whole picture (bias)".into()];
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
pub(super) fn image_flip(compared: &[Compared]) -> Block {
    let row = |it: &Compared| {
        let mut cells = vec![it.component_name().into()];
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
pub(super) fn image_times(compared: &[Compared], bake_seconds: f64) -> Block {
    let mut rows = Vec::new();
    for it in compared {
        for (which, means) in MEANS.into_iter().enumerate() {
            let paths = &it.paths[which];
            rows.push(Row::plain(vec![
                it.component_name().into(),
                means.into(),
                in_percent(it.rms[which].corrected()),
                in_percent(paths.error_of_one),
                Cell::Number(paths.samples),
                Cell::Number(it.seconds_a_sample),
                Cell::Number(paths.seconds),
                Cell::Number(it.frame_ms),
                Cell::Number(it.ratios()[which]),
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
         paths and 1 / sqrt(paths). Break-even: frames after which the bake has paid.",
        columns,
        rows,
    )
}

/// How the path tracer's error falls.
pub(super) fn path_errors(compared: &[Compared]) -> Block {
    let mut series = Vec::new();
    let mut marks = Vec::new();
    for it in compared {
        for (which, means) in ["pixels", "8 x 8"].into_iter().enumerate() {
            let paths = &it.paths[which];
            let label = format!("{}, {means}", it.component_name());
            marks.push(Mark {
                label: format!("frame: {label}"),
                x: paths.samples,
                y: it.rms[which].corrected() * 100.0,
            });
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
    pub(super) fn component_name(&self) -> &'static str {
        let known = crate::relight::COMPONENTS.iter();
        let found = known
            .into_iter()
            .find(|(_, component)| *component == self.component);
        found.map_or("light", |(name, _)| name)
    }
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
