//! The smallest limits with which two images pass.

use super::{Figures, Limits, pixels::PixelDifferences};

/// Sets of limits that would let a candidate pass, each by itself, and each as
/// small as it can be. Figures are exact here; texts round them up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassingLimits {
    /// Limit on channels, alone; `None`: a pixel is infinite or not a number.
    pub max_channel_difference: Option<f64>,
    /// Limit on pixels, alone.
    pub max_differing_pixels: u64,
    /// Limit on pixels beside the limit on channels that was given, where one
    /// above 0 was.
    pub max_differing_pixels_beside: Option<(f64, u64)>,
    /// Limit on the mean of FLIP, alone; `None`: a pixel is infinite or not a
    /// number, or alpha differs.
    pub max_flip: Option<f64>,
}

/// Digits of a limit in a text.
const DIGITS: usize = 4;

impl PassingLimits {
    pub(super) fn of(
        limits: &Limits,
        figures: &Figures,
        differences: &PixelDifferences,
        beyond: u64,
    ) -> Self {
        let largest = differences.largest_beyond_mask();
        let given = limits.max_channel_difference.filter(|&limit| limit > 0.0);
        let seen = figures.non_finite_pixels == 0 && differences.differing_alphas() == 0;
        Self {
            max_channel_difference: largest.is_finite().then_some(largest),
            max_differing_pixels: differences.beyond(0.0),
            max_differing_pixels_beside: given.map(|limit| (limit, beyond)),
            max_flip: seen.then_some(figures.flip_mean),
        }
    }

    /// Each set as options of `relume diff`.
    pub fn options(&self) -> Vec<String> {
        self.sets(" ", |name, value| {
            format!("--{} {value}", name.replace('_', "-"))
        })
    }

    /// Each set as keys of a scene's `[golden]`.
    pub fn keys(&self) -> Vec<String> {
        self.sets("\n", |name, value| format!("{name} = {value}"))
    }

    /// All sets of keys in one line of text.
    pub fn keys_text(&self) -> String {
        self.keys().join(", or ").replace('\n', " and ")
    }

    fn sets(&self, separator: &str, one: impl Fn(&str, String) -> String) -> Vec<String> {
        let channel = |value| one("max_channel_difference", value);
        let pixels = |count: u64| one("max_differing_pixels", count.to_string());
        let mut sets = Vec::new();
        sets.extend(self.max_channel_difference.map(|x| channel(rounded_up(x))));
        sets.push(pixels(self.max_differing_pixels));
        if let Some((limit, count)) = self.max_differing_pixels_beside {
            sets.push([channel(limit.to_string()), pixels(count)].join(separator));
        }
        let flip = self.max_flip.map(rounded_up);
        sets.extend(flip.map(|value| one("max_flip", value)));
        sets
    }
}

/// The shortest number of few digits that is not below `x`, which is not
/// negative.
fn rounded_up(x: f64) -> String {
    let exact = x.to_string();
    if exact.len() <= DIGITS {
        return exact;
    }
    let text = format!("{x:.*e}", DIGITS - 1);
    let parse = |text: &str| text.parse::<f64>().unwrap_or(f64::INFINITY);
    let nearest = parse(&text);
    if nearest >= x {
        return nearest.to_string();
    }
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let next = digits.replace('.', "").parse::<u64>().unwrap_or(0) + 1;
    let exponent = exponent.parse::<i32>().unwrap_or(0) - (DIGITS as i32 - 1);
    parse(&format!("{next}e{exponent}")).to_string()
}

#[cfg(test)]
mod tests {
    use super::rounded_up;

    #[test]
    fn limits_are_short_and_never_below() {
        for (x, text) in [
            (0.0, "0"),
            (3.0, "3"),
            (0.123_456, "0.1235"),
            (0.123_41, "0.1235"),
            (0.000_123_401, "0.0001235"),
            (0.999_96, "1"),
            (99.999, "100"),
            (123_412.0, "123500"),
        ] {
            assert_eq!(rounded_up(x), text);
            assert!(text.parse::<f64>().unwrap() >= x);
        }
    }
}
