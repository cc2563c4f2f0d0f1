//! Whole plots: what is drawn, what is left out, what stays inside.

use super::*;
use crate::report::{Axis, Mark, Series, Style};

fn plot(x: Axis, y: Axis, points: &[(f64, f64)]) -> Plot {
    Plot {
        name: "plot".to_owned(),
        caption: "A plot.".to_owned(),
        x,
        y,
        series: vec![Series {
            label: "series".to_owned(),
            points: points.to_vec(),
            style: Style::Line,
        }],
        marks: Vec::new(),
    }
}

fn linear() -> Axis {
    Axis::linear("x", "")
}

/// Places on the way of the first line of a drawing.
fn lines(svg: &str) -> Vec<&str> {
    let marker = "class=\"line\" style=\"stroke:var(--series-0)\" d=\"";
    let behind = svg.split(marker).skip(1);
    behind.filter_map(|text| text.split('"').next()).collect()
}

#[test]
fn points_without_a_place_are_left_out_and_counted() {
    let points = [
        (1.0, 1.0),
        (2.0, 2.0),
        (f64::NAN, 1.0),
        (3.0, 0.0),
        (4.0, -1.0),
        (5.0, f64::INFINITY),
        (6.0, 3.0),
        (7.0, 1.0),
    ];
    let mut plot = plot(linear(), Axis::log("y", "ms"), &points);
    plot.marks.push(Mark {
        label: "nowhere".to_owned(),
        x: 1.0,
        y: 0.0,
    });
    let caption = caption(&plot);
    assert!(
        caption.starts_with("A plot. (5 points are not drawn"),
        "{caption}"
    );
    let svg = standalone(&plot);
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    assert!(!svg.contains("nowhere"));
    // One line of the legend, then the line before the gap and that behind it.
    assert_eq!(lines(&svg).len(), 3, "{svg}");
    assert_eq!(svg.matches("x: ").count(), 4, "a tooltip for each point");

    plot.series[0].points.truncate(3);
    plot.marks.clear();
    assert!(super::caption(&plot).contains("(1 point is not drawn"));
    plot.series[0].points.truncate(2);
    assert_eq!(super::caption(&plot), "A plot.");
}

#[test]
fn places_follow_the_scales() {
    let decades = plot(
        Axis::log("x", ""),
        linear(),
        &[(1.0, 0.0), (10.0, 1.0), (100.0, 2.0)],
    );
    let layout = Layout::new(&decades, WIDE);
    let places = [1.0, 10.0, 100.0].map(|x| layout.across(x));
    let (first, second) = (places[1] - places[0], places[2] - places[1]);
    assert!(
        (first - second).abs() < 1e-9,
        "equal factors are equally long: {places:?}"
    );
    assert_eq!(layout.down(0.0), layout.area.bottom);
    assert_eq!(layout.down(2.0), layout.area.top);
}

#[test]
fn any_data_is_drawn_inside_the_plot() {
    let data: [&[(f64, f64)]; 6] = [
        &[],
        &[(0.0, 0.0)],
        &[(5.0, 5.0)],
        &[(1e-9, 1e9), (1e9, 1e-9)],
        &[(-3.0, -1e-9), (-2.0, -1e-3)],
        &[(1e9, 1.0), (1e9 + 2.0, 2.0)],
    ];
    for points in data {
        for (x, y) in [
            (linear(), linear()),
            (Axis::log("x", ""), Axis::log("y", "")),
        ] {
            for size in [WIDE, NARROW] {
                let plot = plot(x.clone(), y.clone(), points);
                let layout = Layout::new(&plot, size);
                let area = &layout.area;
                assert!(
                    area.right - area.left > 0.5 * size.width,
                    "{points:?}: {area:?}"
                );
                assert!(
                    area.bottom - area.top > 0.5 * size.height,
                    "{points:?}: {area:?}"
                );
                for &point in points {
                    let Some((x, y)) = layout.point(point) else {
                        continue;
                    };
                    assert!(
                        (area.left - 0.1..area.right + 0.1).contains(&x),
                        "{point:?}"
                    );
                    assert!(
                        (area.top - 0.1..area.bottom + 0.1).contains(&y),
                        "{point:?}"
                    );
                }
                let ticks = layout.x.ticks.iter().map(|tick| {
                    let half = 0.5 * layout::text_width(&tick.text);
                    (
                        layout.across(tick.value) - half,
                        layout.across(tick.value) + half,
                    )
                });
                let ticks: Vec<_> = ticks.collect();
                for pair in ticks.windows(2) {
                    assert!(
                        pair[0].1 < pair[1].0,
                        "{points:?}: ticks overlap: {ticks:?}"
                    );
                }
                assert!(ticks.iter().all(|tick| tick.1 <= size.width), "{ticks:?}");
            }
        }
    }
}

#[test]
fn the_legend_breaks_its_lines_and_cuts_long_texts() {
    let mut plot = plot(linear(), linear(), &[(0.0, 1.0)]);
    let series = plot.series[0].clone();
    plot.series = (0..12)
        .map(|index| Series {
            label: "a long label ".repeat(1 + index),
            ..series.clone()
        })
        .collect();
    let layout = Layout::new(&plot, WIDE);
    for entry in &layout.legend {
        let right = entry.left + layout::SWATCH + layout::text_width(&entry.text);
        assert!(right <= WIDE.width, "{} ends at {right}", entry.text);
        assert!(
            (entry.row + 1) as f64 * layout::ROW < layout.area.top,
            "above the data"
        );
    }
    assert!(layout.legend[11].text.ends_with('…'));
}
