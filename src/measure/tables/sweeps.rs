//! Tables and plots of the sweeps.

use super::{BOUNCE_NAMES, in_percent, percent, table};
use crate::bake::Scheme;
use crate::measure::statistics::between;
use crate::measure::sweeps::{Point, Swept};
use crate::report::{Axis, Block, Cell, Column, Mark, Plot, Row, Series, Style};

/// Bytes a vertex at which the schemes are compared.
const COMPARED_BYTES: [f64; 3] = [100.0, 130.0, 160.0];
/// The word on rows and marks of the default settings.
const DEFAULT: &str = "default";

impl Swept {
    pub(in crate::measure) fn name(self) -> &'static str {
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
pub(in crate::measure) fn sweep_table(swept: Swept, points: &[Point]) -> Block {
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
pub(in crate::measure) fn sweep_plots(swept: Swept, points: &[Point]) -> Vec<Block> {
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

/// (bytes a vertex, errors of both schemes within so many, where the sweep of
/// coefficients reaches).
pub(in crate::measure) fn at_equal_bytes(
    points: &[Point],
    which: usize,
) -> Vec<(f64, [Option<f64>; 2])> {
    COMPARED_BYTES
        .into_iter()
        .map(|bytes| {
            let errors = Scheme::ALL.map(|scheme| {
                let mut of_scheme: Vec<&Point> =
                    points.iter().filter(|it| it.scheme == scheme).collect();
                of_scheme.sort_by_key(|point| point.coefficients_asked);
                let curve: Vec<(f64, f64)> = of_scheme
                    .iter()
                    .map(|p| (p.bytes_per_vertex, p.errors[which].mean))
                    .collect();
                between(&curve, bytes).or_else(|| beyond(&curve, bytes))
            });
            (bytes, errors)
        })
        .collect()
}

/// The error of a scheme that stores fewer bytes whatever it is allowed: of the points
/// of its curve, in the order of the coefficients that they were allowed, the last two
/// are one.
fn beyond(curve: &[(f64, f64)], bytes: f64) -> Option<f64> {
    let [.., before, last] = curve else {
        return None;
    };
    (before == last && last.1 > 0.0 && bytes > last.0).then_some(last.1)
}

/// How many times as wrong the published scheme is.
pub(in crate::measure) fn ratio([relume, paper]: [Option<f64>; 2]) -> Option<f64> {
    Some(paper? / relume?)
}

/// Both schemes at equal bytes.
pub(in crate::measure) fn equal_bytes(points: &[Point]) -> Block {
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
        "Error within so many bytes, between the points of the sweep of coefficients (straight \
         in logarithms). Where twice the coefficients make a scheme store no more, it keeps its \
         error; empty where the sweep does not reach.",
        columns,
        rows,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scheme_that_stores_all_keeps_its_error_and_a_cut_sweep_says_nothing() {
        let growing = [(30.0, 0.3), (60.0, 0.25), (70.0, 0.24)];
        assert_eq!(beyond(&growing, 100.0), None);
        let whole = [(30.0, 0.3), (70.0, 0.24), (70.0, 0.24)];
        assert_eq!(beyond(&whole, 100.0), Some(0.24));
        assert_eq!(beyond(&whole, 20.0), None);
        assert_eq!(beyond(&whole[..1], 100.0), None);
        assert_eq!(
            beyond(&[(70.0, 0.0); 2], 100.0),
            None,
            "nothing was measured"
        );
    }
}
