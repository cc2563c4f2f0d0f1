//! Tables and plots of the sweeps.

use super::{BOUNCE_NAMES, in_percent, percent, table};
use crate::bake::Scheme;
use crate::maths::order::Order;
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
            point.uncut.map(|it| it.on_basis * 100.0).into(),
            point.uncut.map(|it| it.rows * 100.0).into(),
            Cell::Number(point.relight_ms),
            Cell::Number(point.bake_seconds),
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
        percent("dense rows", 2),
        Column::number("four bounces", "ms", 2),
        Column::number("bake", "s", 1),
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
                let uncut = of_scheme.filter_map(|p| Some((x(p), p.uncut?.on_basis * 100.0)));
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
    blocks.extend(costs(swept).iter().map(|(name, axis, value, caption)| {
        let mut series = by_scheme(points, value, 0, Style::Line, "");
        if swept == Swept::Coefficients {
            series.extend(dense(points, value));
        }
        let axis = Axis::log(axis[0], axis[1]);
        error_plot(name, caption, axis, series, marks(points, value))
    }));
    blocks
}

/// Name of a plot, label and unit of what is on its axis, and its caption.
type CostPlot = (
    &'static str,
    [&'static str; 2],
    fn(&Point) -> f64,
    &'static str,
);

/// Plots of error against a cost, of the sweep that shows it.
fn costs(swept: Swept) -> &'static [CostPlot] {
    match swept {
        Swept::Functions => &[],
        Swept::Coefficients => &[
            (
                "error-against-bytes",
                ["operator", "B/vertex"],
                |point| point.bytes_per_vertex,
                "Error against bytes of the operator, one bounce; the basis is apart. Dashed: the \
                 dense transfer by as many rays.",
            ),
            (
                "error-against-milliseconds",
                ["four bounces", "ms"],
                |point| point.relight_ms,
                "Error against the time of four bounces, all threads, direct light and pixels \
                 left out. Dashed: the dense transfer by as many rays, whatever its time.",
            ),
        ],
        Swept::Rays => &[(
            "error-against-bake-seconds",
            ["bake", "s"],
            |point| point.bake_seconds,
            "Error against the bake's time by the clock, one bounce: rays, basis and operator. The \
             scene's own bake has all that a bake does in it: sides, sky, the statement of its \
             error, and the search for one that is asked for.",
        )],
    }
}

/// The error of rows that nothing is left out of, over the width of a plot: one line
/// where the schemes have as many rays.
fn dense(points: &[Point], x: &dyn Fn(&Point) -> f64) -> Vec<Series> {
    let first = points.iter().map(x).reduce(f64::at_most);
    let last = points.iter().map(x).reduce(f64::at_least);
    let (Some(first), Some(last)) = (first, last) else {
        return Vec::new();
    };
    let of_scheme = |scheme: Scheme| {
        let mut own = points.iter().filter(|point| point.scheme == scheme);
        own.find_map(|point| Some((point.rays, point.uncut?.rows * 100.0)))
    };
    let mut found: Vec<(u32, f64)> = Scheme::ALL.into_iter().filter_map(of_scheme).collect();
    found.dedup_by_key(|(rays, _)| *rays);
    let line = |(rays, error): (u32, f64)| Series {
        label: format!("dense, {rays} rays"),
        points: vec![(first, error), (last, error)],
        style: Style::Dashed,
    };
    found.into_iter().map(line).collect()
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

/// (bytes a vertex, least errors of both schemes within so many, where a sweep
/// reaches).
pub(in crate::measure) fn at_equal_bytes(
    sweeps: &[(Swept, Vec<Point>)],
    which: usize,
) -> Vec<(f64, [Option<f64>; 2])> {
    let curves = Scheme::ALL.map(|scheme| {
        let of_bytes = sweeps.iter().filter(|(swept, _)| *swept != Swept::Rays);
        let curves = of_bytes.map(|(swept, points)| curve_of_bytes(*swept, points, scheme, which));
        curves.collect::<Vec<_>>()
    });
    let errors = |bytes: f64| curves.each_ref().map(|curves| least_within(curves, bytes));
    COMPARED_BYTES.map(|bytes| (bytes, errors(bytes))).to_vec()
}

/// (bytes a vertex, error) of a scheme in a sweep, in the order of what was allowed.
fn curve_of_bytes(swept: Swept, points: &[Point], scheme: Scheme, which: usize) -> Vec<(f64, f64)> {
    let mut of_scheme: Vec<&Point> = points.iter().filter(|it| it.scheme == scheme).collect();
    of_scheme.sort_by_key(|point| match swept {
        Swept::Functions => point.functions_asked,
        Swept::Coefficients => point.coefficients_asked,
        Swept::Rays => point.rays,
    });
    let pair = |point: &&Point| (point.bytes_per_vertex, point.errors[which].mean);
    of_scheme.iter().map(pair).collect()
}

/// The least error that some curve has within so many bytes, between its points too;
/// `None` where no curve reaches.
fn least_within(curves: &[Vec<(f64, f64)>], bytes: f64) -> Option<f64> {
    let reached = curves
        .iter()
        .filter_map(|curve| between(curve, bytes).or_else(|| beyond(curve, bytes)));
    let reached = reached.reduce(f64::at_most)?;
    let points = curves.iter().flatten();
    let within = points.filter(|&&(of_point, error)| of_point <= bytes && error > 0.0);
    Some(within.fold(reached, |least, &(_, error)| f64::at_most(least, error)))
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
pub(in crate::measure) fn equal_bytes(sweeps: &[(Swept, Vec<Point>)]) -> Block {
    let mut rows = Vec::new();
    for which in 0..2 {
        for (bytes, errors) in at_equal_bytes(sweeps, which) {
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
        "The least error of each scheme within so many bytes, of the sweeps of functions and \
         coefficients and between their points (straight in logarithms). Where twice as many make \
         a scheme store no more, it keeps its error; empty where no sweep reaches.",
        columns,
        rows,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_error_of_any_curve_counts_within_its_bytes() {
        let coefficients = vec![(30.0, 0.3), (60.0, 0.25), (60.0, 0.25)];
        let functions = vec![(40.0, 0.5), (50.0, 0.2), (110.0, 0.1)];
        let both = [coefficients, functions];
        assert_eq!(least_within(&both, 70.0), between(&both[1], 70.0));
        assert_eq!(least_within(&both, 130.0), Some(0.1), "the cheaper point");
        let first = least_within(&both, 30.0).unwrap();
        assert!((first - 0.3).abs() < 1e-12, "{first}");
        assert_eq!(least_within(&both, 20.0), None);
        assert_eq!(least_within(&both[1..], 130.0), None, "no curve ends there");
    }

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
