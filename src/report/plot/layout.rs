//! Sizes: how a plot's space is divided among legend, axes and data.

use super::axis::{Range, can_be_drawn};
use super::placing::Rectangle;
use crate::maths::order::Order;
use crate::report::{Axis, Plot, Scale};

/// Height of the letters, units of the plot.
pub(super) const FONT_SIZE: f64 = 13.0;
/// Width of a letter by its height. Browsers choose the font, so this is an
/// upper estimate for the mean letter of the usual sans-serif ones (0.50 to 0.56).
const LETTER_WIDTH: f64 = 0.57;
/// Height of a row of text.
pub(super) const ROW: f64 = 20.0;
/// From the left of a legend's entry to its text.
pub(super) const SWATCH: f64 = 30.0;
/// Between two entries of the legend.
const GAP: f64 = 18.0;

/// Outer size of a plot, without the margin of a file, and how many ticks its axes have space for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) width: f64,
    pub(super) height: f64,
    x_ticks: usize,
    y_ticks: usize,
}

/// For pages and for files.
pub(super) const WIDE: Size = Size {
    width: 760.0,
    height: 430.0,
    x_ticks: 8,
    y_ticks: 7,
};

/// For phones: letters of a wide plot scaled to 360 pixels could not be read.
pub(super) const NARROW: Size = Size {
    width: 360.0,
    height: 360.0,
    x_ticks: 5,
    y_ticks: 6,
};

/// One line of the legend: places of its entries from the left, their texts.
pub(super) struct Entry {
    pub(super) series: usize,
    pub(super) left: f64,
    pub(super) row: usize,
    pub(super) text: String,
}

/// A plot with a place for everything.
pub(super) struct Layout<'a> {
    pub(super) plot: &'a Plot,
    pub(super) size: Size,
    pub(super) x: Range,
    pub(super) y: Range,
    pub(super) legend: Vec<Entry>,
    /// Where the data is drawn.
    pub(super) area: Rectangle,
}

impl<'a> Layout<'a> {
    pub(super) fn new(plot: &'a Plot, size: Size) -> Self {
        let places: Vec<(f64, f64)> = drawn(plot).collect();
        let xs = places.iter().map(|place| place.0);
        let ys = places.iter().map(|place| place.1);
        let x = horizontal(plot.x.scale, xs, size);
        let y = Range::of(plot.y.scale, ys, size.y_ticks);

        let legend = legend(plot, size.width);
        let legend_rows = legend.last().map_or(0, |entry| entry.row + 1);
        let widest = y
            .ticks
            .iter()
            .map(|tick| text_width(&tick.text))
            .fold(0.0, f64::at_least);
        let last_tick = x.ticks.last().map_or(0.0, |tick| text_width(&tick.text));
        let area = Rectangle {
            left: widest + 12.0,
            // Legend, then the vertical axis' label.
            top: legend_rows as f64 * ROW + ROW + 14.0,
            right: size.width - (0.5 * last_tick).at_least(10.0),
            // Ticks, then the horizontal axis' label.
            bottom: size.height - 2.0 * ROW - 6.0,
        };
        Self {
            plot,
            size,
            x,
            y,
            legend,
            area,
        }
    }

    /// Where a value's point is, if it can be drawn.
    pub(super) fn point(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        is_drawn(self.plot, (x, y)).then(|| (self.across(x), self.down(y)))
    }

    pub(super) fn across(&self, x: f64) -> f64 {
        self.area.left + self.x.place(x) * (self.area.right - self.area.left)
    }

    pub(super) fn down(&self, y: f64) -> f64 {
        self.area.bottom + self.y.place(y) * (self.area.top - self.area.bottom)
    }
}

/// An axis with as many ticks as have space beside each other.
fn horizontal(scale: Scale, xs: impl Iterator<Item = f64> + Clone, size: Size) -> Range {
    let range = |tick_count| Range::of(scale, xs.clone(), tick_count);
    let fits = |range: &Range| {
        let widths = range
            .ticks
            .iter()
            .map(|tick| text_width(&tick.text) + 0.5 * GAP);
        // The labels of the vertical axis take their part of the width.
        widths.sum::<f64>() <= 0.85 * size.width
    };
    let fewer = (3..=size.x_ticks).rev().map(range);
    fewer.into_iter().find(fits).unwrap_or_else(|| range(2))
}

/// About how wide a text is.
pub(super) fn text_width(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER_WIDTH * FONT_SIZE
}

/// How many points and marks of a plot cannot be drawn.
pub(super) fn left_out(plot: &Plot) -> usize {
    all(plot).count() - drawn(plot).count()
}

fn drawn(plot: &Plot) -> impl Iterator<Item = (f64, f64)> {
    all(plot).filter(|&place| is_drawn(plot, place))
}

fn all(plot: &Plot) -> impl Iterator<Item = (f64, f64)> {
    let points = plot.series.iter().flat_map(|series| &series.points);
    let marks = plot.marks.iter().map(|mark| (mark.x, mark.y));
    points.copied().chain(marks)
}

fn is_drawn(plot: &Plot, (x, y): (f64, f64)) -> bool {
    let fits = |axis: &Axis, value| can_be_drawn(axis.scale, value);
    fits(&plot.x, x) && fits(&plot.y, y)
}

/// Entries from left to right, row by row; a text that is wider than the plot
/// is cut.
fn legend(plot: &Plot, width: f64) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let (mut left, mut row) = (0.0, 0);
    for (series, label) in plot.series.iter().map(|series| &series.label).enumerate() {
        let text = cut(label, width - SWATCH);
        let needed = SWATCH + text_width(&text);
        if left > 0.0 && left + needed > width {
            (left, row) = (0.0, row + 1);
        }
        entries.push(Entry {
            series,
            left,
            row,
            text,
        });
        left += needed + GAP;
    }
    entries
}

/// The text, or as much of it as is at most so wide.
pub(super) fn cut(text: &str, width: f64) -> String {
    if text_width(text) <= width {
        return text.to_owned();
    }
    let letters = (width / (LETTER_WIDTH * FONT_SIZE)).floor() as usize;
    let kept: String = text.chars().take(letters.saturating_sub(1)).collect();
    kept.trim_end().to_owned() + "…"
}
