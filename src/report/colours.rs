//! The colours of pages and plots, for light and for dark.

/// Colours of one scheme, as CSS.
struct Scheme {
    /// Behind everything.
    surface: &'static str,
    /// Behind heads of tables, buttons and the summary.
    panel: &'static str,
    /// Text.
    ink: &'static str,
    /// Text of less weight: captions, units, ticks.
    muted: &'static str,
    /// Lines between rows, grid of plots.
    grid: &'static str,
    /// Links, focus, the edge of rows that stand out.
    accent: &'static str,
    /// Behind rows that stand out.
    highlight: &'static str,
    /// Series of plots.
    series: [&'static str; SERIES_COLOURS],
}

/// Colours of series before they repeat.
pub(super) const SERIES_COLOURS: usize = 8;

// The series' colours were chosen greedily, each as far as possible from those
// before it: the smallest Oklab distance as seen with normal sight, protanopia,
// deuteranopia and tritanopia (Machado, Oliveira, Fernandes 2009), among the
// colours with enough contrast to the surface. The smallest distance of any two
// is 0.11 in light and 0.10 in dark; the first four are 0.15 and 0.25 apart.
// Series also differ in the shape of their points.
const LIGHT: Scheme = Scheme {
    surface: "#ffffff",
    panel: "#f3f4f6",
    ink: "#1b1e23",
    muted: "#565d68",
    grid: "#d9dce1",
    accent: "#0b5cad",
    highlight: "#e8f1fb",
    series: [
        "#0072b2", "#c31e0f", "#781d59", "#e96e2d", "#2d9dc1", "#252fb1", "#6a6a6a", "#806ef9",
    ],
};

const DARK: Scheme = Scheme {
    surface: "#16181c",
    panel: "#212429",
    ink: "#e8eaed",
    muted: "#a9b0ba",
    grid: "#383d45",
    accent: "#7db8f5",
    highlight: "#1f3145",
    series: [
        "#56b4e9", "#efe345", "#bb6802", "#7bf5f5", "#5471f5", "#e89772", "#808080", "#23dbc1",
    ],
};

/// The colours as CSS variables that follow the reader's scheme; paper is light.
pub(super) fn css() -> String {
    format!(
        ":root{{color-scheme:light dark;{}}}\n\
         @media screen and (prefers-color-scheme:dark){{:root{{{}}}}}\n",
        LIGHT.variables(),
        DARK.variables(),
    )
}

impl Scheme {
    fn variables(&self) -> String {
        let named = [
            ("surface", self.surface),
            ("panel", self.panel),
            ("ink", self.ink),
            ("muted", self.muted),
            ("grid", self.grid),
            ("accent", self.accent),
            ("highlight", self.highlight),
        ];
        let named = named
            .iter()
            .map(|(name, colour)| format!("--{name}:{colour};"));
        let series = self.series.iter().enumerate();
        let series = series.map(|(index, colour)| format!("--series-{index}:{colour};"));
        named.chain(series).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::functions::linear_from_srgb;
    use crate::maths::order::Order;

    /// Smallest contrast of text (WCAG 2.2, 1.4.3, level AA).
    const TEXT_CONTRAST: f64 = 4.5;
    /// Smallest contrast of what must be seen but is no text (WCAG 2.2, 1.4.11).
    const GRAPHICS_CONTRAST: f64 = 3.0;

    /// Relative luminance of `#rrggbb` (WCAG 2.2).
    fn luminance(colour: &str) -> f64 {
        let weights = [0.2126, 0.7152, 0.0722];
        let channel = |index: usize| {
            let digits = &colour[1 + 2 * index..3 + 2 * index];
            linear_from_srgb(f64::from(u8::from_str_radix(digits, 16).unwrap()) / 255.0)
        };
        (0..3).map(|index| weights[index] * channel(index)).sum()
    }

    fn contrast(one: &str, other: &str) -> f64 {
        let (a, b) = (luminance(one), luminance(other));
        (a.at_least(b) + 0.05) / (a.at_most(b) + 0.05)
    }

    #[test]
    fn everything_stands_out_from_what_is_behind_it() {
        for scheme in [LIGHT, DARK] {
            for text in [scheme.ink, scheme.muted, scheme.accent] {
                for behind in [scheme.surface, scheme.panel, scheme.highlight] {
                    let contrast = contrast(text, behind);
                    assert!(contrast >= TEXT_CONTRAST, "{text} on {behind}: {contrast}");
                }
            }
            for series in scheme.series {
                let contrast = contrast(series, scheme.surface);
                assert!(contrast >= GRAPHICS_CONTRAST, "{series}: {contrast}");
            }
        }
    }
}
