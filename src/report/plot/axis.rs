//! From values to places along an axis, and the ticks that name some of them.

use crate::maths::functions::ln;
use crate::maths::order::Order;
use crate::report::Scale;
use crate::report::number::{decimal, decimal_exponent, decimal_text};

/// Numbers beyond this, and on a logarithmic axis those below its inverse, are
/// not drawn: the ratio of an axis' ends (10^220 with its margins) stays a
/// number.
const LARGEST_DRAWN: f64 = 1e100;
/// Values closer together than this part of their size are drawn as one: ticks
/// between them would need more digits than anyone reads.
const SMALLEST_SPREAD: f64 = 1e-9;
/// Free space at either end of a logarithmic axis, part of its length.
const LOG_MARGIN: f64 = 0.05;
/// A tick may miss the end of the range by so much of a step and still be in it.
const ROUNDING: f64 = 1e-9;
/// Most decades that have lines between them.
const MOST_DIVIDED_DECADES: i32 = 6;

/// A scale with its two ends and its ticks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Range {
    scale: Scale,
    low: f64,
    high: f64,
    /// Named places, rising.
    pub(super) ticks: Vec<Tick>,
    /// Places that have a line but no name, as values.
    pub(super) minor: Vec<f64>,
}

/// A named place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) text: String,
}

/// Whether a value has a place on an axis.
pub(super) fn can_be_drawn(scale: Scale, value: f64) -> bool {
    match scale {
        Scale::Linear => value.abs() <= LARGEST_DRAWN,
        Scale::Log => (1.0 / LARGEST_DRAWN..=LARGEST_DRAWN).contains(&value),
    }
}

impl Range {
    /// An axis that holds all values (which can be drawn) with at most about
    /// `tick_count` ticks (at least 2).
    pub(super) fn of(
        scale: Scale,
        values: impl IntoIterator<Item = f64>,
        tick_count: usize,
    ) -> Self {
        let ends = values.into_iter().fold(None, |ends, value| match ends {
            None => Some((value, value)),
            Some((low, high)) => Some((value.at_most(low), value.at_least(high))),
        });
        match scale {
            Scale::Linear => Self::linear(ends.unwrap_or((0.0, 1.0)), tick_count),
            Scale::Log => Self::log(ends.unwrap_or((1.0, 10.0)), tick_count),
        }
    }

    /// Part of the axis below a value: 0 at the low end, 1 at the high one.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => ln(value / self.low) / ln(self.high / self.low),
        }
    }

    /// The axis begins and ends at a tick (Heckbert, "Nice numbers for graph
    /// labels", Graphics Gems 1990).
    fn linear((low, high): (f64, f64), tick_count: usize) -> Self {
        let (low, high) = spread(low, high);
        let low = if low > 0.0 && low <= 0.5 * high {
            0.0
        } else {
            low
        };
        let step = Step::for_range(low, high, tick_count);
        let first = (low / step.size() + ROUNDING).floor() as i64;
        let last = (high / step.size() - ROUNDING).ceil() as i64;
        let ticks: Vec<Tick> = (first..=last).map(|index| step.tick(index)).collect();
        let end = |tick: Option<&Tick>, value| tick.map_or(value, |tick| tick.value);
        Self {
            scale: Scale::Linear,
            low: end(ticks.first(), low),
            high: end(ticks.last(), high),
            ticks,
            minor: Vec::new(),
        }
    }

    /// Ticks at 1, 2, 5 of each decade if there are few decades, else at powers
    /// of ten, else at every so many of them.
    fn log((low, high): (f64, f64), tick_count: usize) -> Self {
        let (low, high) = match high / low < 1.0 + SMALLEST_SPREAD {
            true => (low / 2.0, high * 2.0),
            false => (low, high),
        };
        let margin = crate::maths::functions::exp(LOG_MARGIN * ln(high / low));
        let (low, high) = (low / margin, high * margin);
        let inside = |tick: &Tick| (low..=high).contains(&tick.value);
        let decades = decimal_exponent(low)..=decimal_exponent(high);
        let ticks_at = |mantissas: &[i64]| -> Vec<Tick> {
            let all = decades.clone().flat_map(|exponent| {
                mantissas
                    .iter()
                    .map(move |&mantissa| Tick::at(mantissa, exponent))
            });
            all.filter(inside).collect()
        };

        let mut ticks = ticks_at(&[1, 2, 5]);
        let mut minor = Vec::new();
        if ticks.len() < 3 {
            let step = Step::for_range(low, high, tick_count);
            let (first, last) = (low / step.size(), high / step.size());
            let steps = first.ceil() as i64..=last.floor() as i64;
            ticks = steps.map(|index| step.tick(index)).collect();
        } else if ticks.len() > tick_count {
            ticks = ticks_at(&[1]);
            let stride = ticks.len().div_ceil(tick_count);
            ticks = ticks.into_iter().step_by(stride).collect();
            if decades.end() - decades.start() <= MOST_DIVIDED_DECADES {
                let between = ticks_at(&[2, 3, 4, 5, 6, 7, 8, 9]);
                minor = between.into_iter().map(|tick| tick.value).collect();
            }
        }
        Self {
            scale: Scale::Log,
            low,
            high,
            ticks,
            minor,
        }
    }
}

/// Ends that are apart, also around a single value.
fn spread(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().at_least(high.abs());
    if size == 0.0 {
        (0.0, 1.0)
    } else if high - low <= SMALLEST_SPREAD * size {
        (low - 0.5 * size, high + 0.5 * size)
    } else {
        (low, high)
    }
}

/// `mantissa * 10^exponent` between two ticks, the mantissa 1, 2 or 5. Ticks
/// are whole multiples of it, so that their texts are exact.
#[derive(Debug, Clone, Copy)]
struct Step {
    mantissa: i64,
    exponent: i32,
}

impl Step {
    /// The smallest step with which a range has at most `count` of them.
    fn for_range(low: f64, high: f64, count: usize) -> Self {
        let least = (high - low) / count as f64;
        let exponent = decimal_exponent(least);
        let enough = |mantissa: &i64| decimal(*mantissa, exponent) >= least;
        match [1, 2, 5].into_iter().find(enough) {
            Some(mantissa) => Self { mantissa, exponent },
            None => Self {
                mantissa: 1,
                exponent: exponent + 1,
            },
        }
    }

    fn size(self) -> f64 {
        decimal(self.mantissa, self.exponent)
    }

    fn tick(self, index: i64) -> Tick {
        Tick::at(index * self.mantissa, self.exponent)
    }
}

impl Tick {
    fn at(mantissa: i64, exponent: i32) -> Self {
        Self {
            value: decimal(mantissa, exponent),
            text: decimal_text(mantissa, exponent),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 7;

    fn texts(scale: Scale, values: &[f64]) -> Vec<String> {
        let range = Range::of(scale, values.iter().copied(), COUNT);
        range.ticks.into_iter().map(|tick| tick.text).collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        let linear = |values: &[f64]| texts(Scale::Linear, values).join(" ");
        assert_eq!(
            linear(&[0.0, 0.0]),
            "0.0 0.2 0.4 0.6 0.8 1.0".replace("0.0", "0")
        );
        assert_eq!(linear(&[]), linear(&[0.0]));
        assert_eq!(linear(&[3.0, 97.0]), "0 20 40 60 80 100");
        assert_eq!(
            linear(&[-0.07, -0.01]),
            "−0.07 −0.06 −0.05 −0.04 −0.03 −0.02 −0.01"
        );
        assert_eq!(linear(&[-3.0, 2.5]), "−3 −2 −1 0 1 2 3");
        assert_eq!(
            linear(&[1e9, 3e9]),
            "0 5·10⁸ 10⁹ 1.5·10⁹ 2·10⁹ 2.5·10⁹ 3·10⁹"
        );
    }

    #[test]
    fn log_ticks_are_decades_or_parts_of_them() {
        let log = |values: &[f64]| texts(Scale::Log, values).join(" ");
        assert_eq!(log(&[1.0, 40.0]), "1 2 5 10 20");
        assert_eq!(log(&[1e-3, 1e3]), "0.001 0.01 0.1 1 10 100 1,000");
        assert_eq!(log(&[1e-9, 1e9]), "10⁻⁹ 10⁻⁶ 0.001 1 1,000 10⁶ 10⁹");
        assert_eq!(log(&[100.0, 130.0]), "100 105 110 115 120 125 130");
        assert_eq!(log(&[3.0]), "2 3 4 5 6");
    }

    #[test]
    fn any_values_that_can_be_drawn_lie_on_an_axis_with_ticks() {
        let sizes = [1e-100, 1e-9, 0.3, 1.0, 7.7, 1e6 + 1e-9, 1e6, 1e9, 1e100];
        for scale in [Scale::Linear, Scale::Log] {
            let signs: &[f64] = match scale {
                Scale::Linear => &[-1.0, 0.0, 1.0],
                Scale::Log => &[1.0],
            };
            let values: Vec<f64> = sizes
                .iter()
                .flat_map(|size| signs.iter().map(move |sign| sign * size))
                .collect();
            for &one in &values {
                for &other in &values {
                    assert!(can_be_drawn(scale, one));
                    let range = Range::of(scale, [one, other], COUNT);
                    let places = [one, other].map(|value| range.place(value));
                    let ticks = range.ticks.iter().map(|tick| range.place(tick.value));
                    let all: Vec<f64> = places.into_iter().chain(ticks).collect();
                    let inside = |place: &f64| (-1e-6..=1.0 + 1e-6).contains(place);
                    assert!(all.iter().all(inside), "{one} {other}: {all:?}");
                    let count = range.ticks.len();
                    assert!(
                        (2..=COUNT + 2).contains(&count),
                        "{one} {other}: {count} ticks"
                    );
                }
            }
        }
    }

    #[test]
    fn what_has_no_place_is_known() {
        for value in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e101] {
            assert!(!can_be_drawn(Scale::Linear, value) && !can_be_drawn(Scale::Log, value));
        }
        for value in [0.0, -1.0] {
            assert!(can_be_drawn(Scale::Linear, value) && !can_be_drawn(Scale::Log, value));
        }
    }
}
