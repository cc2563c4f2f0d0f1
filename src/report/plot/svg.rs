//! The drawing itself: grid and axes, legend, series, marks.

use maud::{Markup, html};

use super::caption;
use super::layout::{FONT_SIZE, Layout, ROW, SWATCH, cut, text_width};
use super::placing::{Rectangle, place_label};
use crate::maths::functions::{cos, sin};
use crate::report::colours::SERIES_COLOURS;
use crate::report::number::four_digits;
use crate::report::{Series, Style};

/// From a text's baseline up to the middle of its letters.
const HALF_LETTER: f64 = 0.36 * FONT_SIZE;
/// Lines with more points than this show a point only below the pointer.
const MOST_SHOWN_POINTS: usize = 60;
/// Distance of the places along a line that labels keep clear of.
const LINE_SPACING: f64 = 8.0;
/// Around a plot that is a file of its own.
const FILE_MARGIN: f64 = 14.0;
/// Radius of the ring around a marked point.
const RING: f64 = 8.0;

/// The whole plot; with a style it is a file of its own.
pub(super) fn draw(layout: &Layout<'_>, style: Option<Markup>) -> Markup {
    let size = layout.size;
    let is_file = style.is_some();
    let name = text(&caption(layout.plot));
    let margin = if is_file { FILE_MARGIN } else { 0.0 };
    let (width, height) = (size.width + 2.0 * margin, size.height + 2.0 * margin);
    let (corner, width, height) = (number(-margin), number(width), number(height));
    html! {
            svg .plot xmlns=[is_file.then_some("http://www.w3.org/2000/svg")]
                viewBox={ (corner) " " (corner) " " (width) " " (height) }
                width=[is_file.then_some(&width)] height=[is_file.then_some(&height)]
                role="img" aria-label=(name)
            {
                @if let Some(style) = style {
                    title { (name) }
                    (style)
    rect .ground x=(corner) y=(corner) width=(width) height=(height) {}
                }
                (legend(layout))
                (axes(layout))
                @for (index, series) in layout.plot.series.iter().enumerate() {
                    (draw_series(layout, index, series))
                }
                (marks(layout))
            }
        }
}

fn legend(layout: &Layout<'_>) -> Markup {
    html! {
        @for entry in &layout.legend {
            @let series = &layout.plot.series[entry.series];
            @let middle = (entry.row as f64 + 0.5) * ROW;
            g {
                title { (text(&series.label)) }
                @if series.style != Style::Dots {
                    path .line .dashed[series.style == Style::Dashed] style=(stroke(entry.series))
                        d=(polyline(&[(entry.left, middle), (entry.left + 22.0, middle)])) {}
                }
                path .point style=(fill(entry.series))
                    d=(shape(entry.series, (entry.left + 11.0, middle), 4.5)) {}
                text x=(number(entry.left + SWATCH)) y=(number(middle + HALF_LETTER)) {
                    (text(&entry.text))
                }
            }
        }
    }
}

fn axes(layout: &Layout<'_>) -> Markup {
    let area = &layout.area;
    let upright = |x: f64| polyline(&[(x, area.top), (x, area.bottom)]);
    let level = |y: f64| polyline(&[(area.left, y), (area.right, y)]);
    let corner = [
        (area.left, area.top),
        (area.left, area.bottom),
        (area.right, area.bottom),
    ];
    let width = layout.size.width;
    html! {
        @for &value in &layout.x.minor {
            path .grid .minor d=(upright(layout.across(value))) {}
        }
        @for &value in &layout.y.minor {
            path .grid .minor d=(level(layout.down(value))) {}
        }
        @for tick in &layout.x.ticks {
            @let x = layout.across(tick.value);
            path .grid d=(upright(x)) {}
            text .tick x=(number(x)) y=(number(area.bottom + ROW)) text-anchor="middle" {
                (tick.text)
            }
        }
        @for tick in &layout.y.ticks {
            @let y = layout.down(tick.value);
            path .grid d=(level(y)) {}
            text .tick x=(number(area.left - 8.0)) y=(number(y + HALF_LETTER)) text-anchor="end" {
                (tick.text)
            }
        }
        path .axis d=(polyline(&corner)) {}
        // The vertical axis is named above it, where it reads without turning one's head.
        text x="0" y=(number(area.top - 14.0)) { (text(&cut(&layout.plot.y.text(), width))) }
        text x=(number(area.right)) y=(number(area.bottom + 2.0 * ROW)) text-anchor="end" {
            (text(&cut(&layout.plot.x.text(), area.right)))
        }
    }
}

fn draw_series(layout: &Layout<'_>, index: usize, series: &Series) -> Markup {
    let is_shown = series.style == Style::Dots || series.points.len() <= MOST_SHOWN_POINTS;
    let runs = runs(layout, series);
    html! {
        g {
            @if series.style != Style::Dots {
                @for run in &runs {
                    path .line .dashed[series.style == Style::Dashed] style=(stroke(index))
                        d=(polyline(run)) {}
                }
            }
            @for &value in &series.points {
                @if let Some(point) = layout.point(value) {
                    path .point[is_shown] .hit[!is_shown] style=(fill(index))
                        d=(shape(index, point, 4.5))
                    {
                        title { (tooltip(layout, &series.label, value)) }
                    }
                }
            }
        }
    }
}

fn marks(layout: &Layout<'_>) -> Markup {
    let marked: Vec<(f64, f64)> = {
        let all = layout.plot.marks.iter();
        all.filter_map(|mark| layout.point((mark.x, mark.y)))
            .collect()
    };
    let data: Vec<(f64, f64)> = obstacles(layout).chain(marked).collect();
    let mut labels: Vec<Rectangle> = Vec::new();
    let mut drawn = Vec::new();
    for mark in &layout.plot.marks {
        let Some(point) = layout.point((mark.x, mark.y)) else {
            continue;
        };
        let label = cut(&mark.label, layout.area.right - layout.area.left);
        let size = (text_width(&label) + 4.0, ROW - 4.0);
        let place = place_label(point, size, &layout.area, &labels, &data);
        labels.push(place);
        let title = tooltip(layout, &mark.label, (mark.x, mark.y));
        drawn.push(html! {
            @if let Some(leader) = leader(point, &place) {
                path .leader d=(polyline(&leader)) {}
            }
            circle .mark cx=(number(point.0)) cy=(number(point.1)) r=(number(RING)) {
                title { (title) }
            }
            text .label x=(number(0.5 * (place.left + place.right))) text-anchor="middle"
                y=(number(place.bottom - 4.0)) { (text(&label)) }
        });
    }
    html! { @for mark in drawn { (mark) } }
}

/// From the ring to a label that is not beside it.
fn leader(point: (f64, f64), label: &Rectangle) -> Option<[(f64, f64); 2]> {
    let end = (
        point.0.clamp(label.left, label.right),
        point.1.clamp(label.top, label.bottom),
    );
    let (across, down) = (end.0 - point.0, end.1 - point.1);
    let distance = (across * across + down * down).sqrt();
    let part = RING / distance;
    let start = (point.0 + part * across, point.1 + part * down);
    (distance > 2.0 * RING).then_some([start, end])
}

/// Points of the data and places along its lines.
fn obstacles(layout: &Layout<'_>) -> impl Iterator<Item = (f64, f64)> {
    let series = layout.plot.series.iter();
    series.flat_map(|series| {
        let runs = runs(layout, series);
        let is_joined = series.style != Style::Dots;
        let points: Vec<_> = runs.iter().flatten().copied().collect();
        let between: Vec<_> = runs
            .iter()
            .filter(|_| is_joined)
            .flat_map(|run| run.windows(2).flat_map(|pair| between(pair[0], pair[1])))
            .collect();
        points.into_iter().chain(between)
    })
}

fn between(from: (f64, f64), to: (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let (across, down) = (to.0 - from.0, to.1 - from.1);
    let count = ((across * across + down * down).sqrt() / LINE_SPACING) as usize;
    (1..=count).map(move |index| {
        let part = index as f64 / (count + 1) as f64;
        (from.0 + part * across, from.1 + part * down)
    })
}

/// The points of a series, cut where one cannot be drawn.
fn runs(layout: &Layout<'_>, series: &Series) -> Vec<Vec<(f64, f64)>> {
    let points: Vec<_> = series.points.iter().map(|&it| layout.point(it)).collect();
    points
        .split(Option::is_none)
        .map(|run| run.iter().copied().flatten().collect::<Vec<_>>())
        .filter(|run| !run.is_empty())
        .collect()
}

fn tooltip(layout: &Layout<'_>, label: &str, (x, y): (f64, f64)) -> String {
    let value = |axis: &crate::report::Axis, value: f64| {
        let text = format!("{}: {} {}", axis.label, four_digits(value), axis.unit);
        text.trim_end().to_owned()
    };
    let (x, y) = (value(&layout.plot.x, x), value(&layout.plot.y, y));
    text(&format!("{label}\n{x}\n{y}"))
}

fn stroke(series: usize) -> String {
    format!("stroke:var(--series-{})", series % SERIES_COLOURS)
}

fn fill(series: usize) -> String {
    format!("fill:var(--series-{})", series % SERIES_COLOURS)
}

/// The outline of a series' points around a place. Seven shapes and eight
/// colours: 56 series differ.
fn shape(series: usize, place: (f64, f64), radius: f64) -> String {
    match series % 7 {
        0 => circle(place, radius),
        1 => polygon(place, 4, 0.125, |_| 1.2 * radius),
        2 => polygon(place, 3, 0.75, |_| 1.35 * radius),
        3 => polygon(place, 4, 0.0, |_| 1.3 * radius),
        4 => polygon(place, 3, 0.25, |_| 1.35 * radius),
        // A star: every second corner lies further in.
        5 => polygon(place, 10, 0.75, |corner| match corner % 2 {
            0 => 1.6 * radius,
            _ => 0.65 * radius,
        }),
        _ => polygon(place, 3, 0.0, |_| 1.35 * radius),
    }
}

fn circle((x, y): (f64, f64), radius: f64) -> String {
    let (left, y, side) = (number(x - radius), number(y), number(2.0 * radius));
    let half = format!("a{radius} {radius} 0 0 1");
    format!("M{left} {y}{half} {side} 0{half} -{side} 0Z")
}

/// Corners at equal angles, the first so many turns from the right, clockwise.
fn polygon((x, y): (f64, f64), count: u32, first_turn: f64, radius: impl Fn(u32) -> f64) -> String {
    let corners = (0..count).map(|corner| {
        let turn = first_turn + f64::from(corner) / f64::from(count);
        let angle = turn * std::f64::consts::TAU;
        let radius = radius(corner);
        (x + radius * cos(angle), y + radius * sin(angle))
    });
    polyline(&corners.collect::<Vec<_>>()) + "Z"
}

fn polyline(points: &[(f64, f64)]) -> String {
    let places = points.iter().enumerate().map(|(index, &(x, y))| {
        let command = if index == 0 { 'M' } else { 'L' };
        format!("{command}{} {}", number(x), number(y))
    });
    let path: String = places.collect();
    match points {
        // A line of one point is a dot under round caps.
        [(x, y)] => format!("{path}L{} {}", number(*x), number(*y)),
        _ => path,
    }
}

/// A place in the drawing, to a tenth of a unit.
fn number(value: f64) -> String {
    let text = format!("{value:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// XML has no place for control characters, not even as references.
fn text(plain: &str) -> String {
    let allowed = |character: char| match character {
        '\n' | '\t' => character,
        _ if character.is_control() => '\u{fffd}',
        '\u{fffe}' | '\u{ffff}' => '\u{fffd}',
        _ => character,
    };
    plain.chars().map(allowed).collect()
}
