//! Colours of a heat map: a quantity from 0 to the top of a scale.

use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use crate::frame::{Development, FlipMap, Image};
use crate::maths::functions::{cos, sin};

/// Colours between the ends of the scale.
const STEPS: usize = 256;
/// Lightness of CIELAB at the ends: nearly black, nearly white.
const LIGHTNESS: [f64; 2] = [3.0, 96.0];
/// Hue of CIELAB at the ends, degrees: violet, by red and orange, to yellow.
const HUE_DEG: [f64; 2] = [295.0, 455.0];
/// Chroma of CIELAB halfway; both ends are near grey. At 75 the reds leave the
/// gamut of sRGB and are cut, at 50 the map looks brown.
const CHROMA: f64 = 64.0;
/// Smallest top of a scale. Less of FLIP is below what two 8-bit levels make.
const LEAST_TOP: f64 = 0.001;

/// The range of values that the colours of a heat map stand for: from 0 to a
/// round number that no value exceeds, so that the weakest map still shows its
/// shape. Lightness grows evenly with the value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatScale {
    top: f64,
}

impl HeatScale {
    /// The scale of a map: 1, 0.5, 0.2, 0.1 and so on, the smallest that holds
    /// all of its values; 1 for a map of zeros.
    pub fn of(map: &FlipMap) -> Self {
        let max = map.max();
        let mut top = 1.0;
        let mut decade = 1.0;
        while max > 0.0 && decade > LEAST_TOP {
            for part in [2.0, 5.0, 10.0] {
                if max <= decade / part {
                    top = decade / part;
                }
            }
            decade /= 10.0;
        }
        Self { top }
    }

    /// The value of the lightest colour.
    pub fn top(&self) -> f64 {
        self.top
    }

    /// Red, green and blue levels for a value.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        // The cast clips, and makes 0 of what is not a number.
        let step = (value / self.top * (STEPS - 1) as f64 + 0.5) as usize;
        COLOURS[step.min(STEPS - 1)]
    }
}

static COLOURS: LazyLock<Vec<[u8; 3]>> = LazyLock::new(|| {
    let shares = (0..STEPS).map(|step| step as f64 / (STEPS - 1) as f64);
    let colours = shares.map(|share| linear_colour(share).as_vec3());
    let colours = colours
        .map(|rgb| rgb.clamp(Vec3::ZERO, Vec3::ONE))
        .collect();
    let row = Image::new(STEPS as u32, 1, colours).expect("one row of the steps");
    let levels = Development::Color.develop(&row);
    levels.bytes().as_chunks::<3>().0.to_vec()
});

/// Linear sRGB of a share of the scale: a straight line in lightness and hue of
/// CIELAB, an arc in chroma.
fn linear_colour(share: f64) -> DVec3 {
    let between = |[from, to]: [f64; 2]| from + share * (to - from);
    let hue = between(HUE_DEG).to_radians();
    let chroma = CHROMA * sin(share * std::f64::consts::PI);
    linear_from_lab(between(LIGHTNESS), chroma * cos(hue), chroma * sin(hue))
}

/// Linear sRGB of CIELAB (CIE 15:2004; white D65, matrix of IEC 61966-2-1).
fn linear_from_lab(lightness: f64, a: f64, b: f64) -> DVec3 {
    const WHITE: DVec3 = DVec3::new(0.950_47, 1.0, 1.088_83);
    let y = (lightness + 16.0) / 116.0;
    let cubes = [y + a / 500.0, y, y - b / 200.0].map(|f| {
        if f > 6.0 / 29.0 {
            f * f * f
        } else {
            3.0 * (6.0_f64 / 29.0) * (6.0 / 29.0) * (f - 4.0 / 29.0)
        }
    });
    let xyz = DVec3::from_array(cubes) * WHITE;
    DVec3::new(
        3.240_454_2 * xyz.x - 1.537_138_5 * xyz.y - 0.498_531_4 * xyz.z,
        -0.969_266_0 * xyz.x + 1.876_010_8 * xyz.y + 0.041_556_0 * xyz.z,
        0.055_643_4 * xyz.x - 0.204_025_9 * xyz.y + 1.057_225_2 * xyz.z,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::flip;
    use crate::maths::functions::linear_from_srgb;

    #[test]
    fn colours_only_get_lighter() {
        let luminance = |rgb: &[u8; 3]| {
            let linear = rgb.map(|level| linear_from_srgb(f64::from(level) / 255.0));
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let luminances: Vec<f64> = COLOURS.iter().map(luminance).collect();
        // A cut channel and the rounding to levels may undo a part of a step.
        let slack = 0.002;
        assert!(luminances.windows(2).all(|w| w[1] > w[0] - slack));
        assert!(luminances[0] < 0.01 && luminances[STEPS - 1] > 0.85);
    }

    #[test]
    fn a_scale_is_round_and_holds_its_map() {
        let black = Image::filled(8, 8, Vec3::ZERO).unwrap();
        for (level, top) in [(0.0, 1.0), (255.0, 1.0)] {
            let grey = Image::filled(8, 8, Vec3::splat(level)).unwrap();
            let map = flip(&black, &grey, 67.0).unwrap();
            assert_eq!(HeatScale::of(&map).top(), top);
        }
        let faint = Image::filled(8, 8, Vec3::splat(1.0)).unwrap();
        let map = flip(&black, &faint, 67.0).unwrap();
        let scale = HeatScale::of(&map);
        assert!(map.max() > 0.0 && scale.top() < 0.1 && map.max() <= scale.top());
        assert_eq!(scale.colour(0.0), COLOURS[0]);
        assert_eq!(scale.colour(2.0), COLOURS[STEPS - 1]);
    }
}
