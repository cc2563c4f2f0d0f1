//! Colours of lights and surfaces, stepped by temperature, hue and saturation
//! with the luminance kept. Linear Rec.709.

use glam::{DVec3, Vec3};

use crate::maths::functions::pow;
use crate::maths::order::Order;
use crate::scene::max_component;

/// Luminance of the primaries, Rec.709.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);
/// Temperatures that the locus is approximated for, kelvin.
pub(crate) const TEMPERATURES: [f64; 2] = [1667.0, 25_000.0];
/// A colour without saturation gets so much of it when it is given a hue.
const FIRST_SATURATION: f64 = 0.2;
/// Hue that white is given first, degrees: orange, as lamps are.
const FIRST_HUE_DEG: f64 = 30.0;
/// Saturation below which a colour has no hue.
const GREY: f64 = 1e-4;

/// Rec.709 luminance.
pub(crate) fn luminance(colour: Vec3) -> f64 {
    LUMINANCE.dot(colour.as_dvec3())
}

/// Colour of a Planckian radiator of a temperature in kelvin, luminance 1.
///
/// Chromaticity by the cubic approximation of Kim et al. (US patent 7,024,034,
/// 2006) for 1,667 to 25,000 K; XYZ to Rec.709 by IEC 61966-2-1. Below some
/// 1,900 K blue would be negative and is 0.
pub(crate) fn planckian(kelvin: f64) -> DVec3 {
    let [lowest, highest] = TEMPERATURES;
    let t = 1000.0 / kelvin.clamp(lowest, highest);
    let cubic = |[a, b, c, d]: [f64; 4], x: f64| ((a * x + b) * x + c) * x + d;
    let is_warm = t >= 0.25;
    let x = if is_warm {
        cubic([-0.266_123_9, -0.234_358_9, 0.877_695_6, 0.179_910], t)
    } else {
        cubic([-3.025_846_9, 2.107_037_9, 0.222_634_7, 0.240_390], t)
    };
    let y = if t >= 1000.0 / 2222.0 {
        cubic(
            [-1.106_381_4, -1.348_110_20, 2.185_558_32, -0.202_196_83],
            x,
        )
    } else if is_warm {
        cubic(
            [-0.954_947_6, -1.374_185_93, 2.091_370_15, -0.167_488_67],
            x,
        )
    } else {
        cubic([3.081_758_0, -5.873_386_70, 3.751_129_97, -0.370_014_83], x)
    };
    let xyz = DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let rgb = DVec3::new(
        DVec3::new(3.240_454_2, -1.537_138_5, -0.498_531_4).dot(xyz),
        DVec3::new(-0.969_266_0, 1.876_010_8, 0.041_556_0).dot(xyz),
        DVec3::new(0.055_643_4, -0.204_025_9, 1.057_225_2).dot(xyz),
    );
    let rgb = rgb.max(DVec3::ZERO);
    rgb / LUMINANCE.dot(rgb)
}

/// Temperature of the Planckian radiator whose ratio of blue to red is nearest
/// to the colour's, kelvin.
pub(crate) fn temperature(colour: Vec3) -> f64 {
    let [mut low, mut high] = TEMPERATURES;
    let (red, blue) = (f64::from(colour.x), f64::from(colour.z));
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        let known = planckian(middle);
        if known.z * red < blue * known.x {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The colour of a Planckian radiator with the luminance of `colour`, colder by
/// so many mired (a million over the temperature); and its temperature.
pub(crate) fn colder(colour: Vec3, mired: f64) -> (Vec3, f64) {
    let [lowest, highest] = TEMPERATURES;
    let now = 1e6 / temperature(colour);
    let kelvin = 1e6 / (now - mired).clamp(1e6 / highest, 1e6 / lowest);
    let rgb = planckian(kelvin) * luminance(colour);
    (tidy(rgb), kelvin)
}

/// A colour with its hue turned by some degrees, its luminance kept. White gets
/// a hue first.
pub(crate) fn turned(colour: Vec3, degrees: f64) -> Vec3 {
    let hsv = hsv_from_rgb(colour.as_dvec3());
    let turned = if hsv[1] < GREY {
        [FIRST_HUE_DEG, FIRST_SATURATION, hsv[2]]
    } else {
        [(hsv[0] + degrees).rem_euclid(360.0), hsv[1], hsv[2]]
    };
    with_luminance(rgb_from_hsv(turned), luminance(colour))
}

/// A colour with its difference from grey of the same luminance multiplied by a
/// factor, as far as no channel becomes negative.
pub(crate) fn saturated(colour: Vec3, factor: f64) -> Vec3 {
    let grey = luminance(colour);
    let rgb = colour.as_dvec3();
    if factor > 1.0 && hsv_from_rgb(rgb)[1] < GREY {
        return turned(colour, 0.0);
    }
    let deepest = (grey - rgb.min_element()).at_least(1e-300);
    let factor = factor.at_most(grey / deepest);
    tidy((DVec3::splat(grey) + (rgb - grey) * factor).max(DVec3::ZERO))
}

/// A light's colour multiplied by a factor.
pub(crate) fn brighter(colour: Vec3, factor: f64) -> Vec3 {
    tidy(colour.as_dvec3() * factor)
}

/// A surface's colour multiplied by a factor, as far as no channel exceeds 1;
/// black becomes `least` when it is to be lighter.
pub(crate) fn lighter(albedo: Vec3, factor: f64, least: f32) -> Vec3 {
    if factor > 1.0 && albedo == Vec3::ZERO {
        return Vec3::splat(least);
    }
    within_one(brighter(albedo, factor))
}

/// A surface's colour scaled down until no channel exceeds 1.
pub(crate) fn within_one(albedo: Vec3) -> Vec3 {
    let largest = max_component(albedo);
    let scaled = if largest > 1.0 {
        albedo / largest
    } else {
        albedo
    };
    scaled.clamp(Vec3::ZERO, Vec3::ONE)
}

/// Six digits: what a person can tell apart by far, and short in a file.
pub(crate) fn tidy(colour: DVec3) -> Vec3 {
    Vec3::from_array(colour.to_array().map(|x| digits(x, 6) as f32))
}

/// A number rounded to so many digits.
pub(crate) fn digits(number: f64, digits: usize) -> f64 {
    let places = digits - 1;
    format!("{number:.places$e}").parse().unwrap_or(number)
}

fn with_luminance(rgb: DVec3, wanted: f64) -> Vec3 {
    let is = LUMINANCE.dot(rgb);
    tidy(if is > 0.0 { rgb * (wanted / is) } else { rgb })
}

/// Hue in degrees, saturation, value (Smith 1978).
fn hsv_from_rgb(rgb: DVec3) -> [f64; 3] {
    let (value, least) = (rgb.max_element(), rgb.min_element());
    let range = value - least;
    if range <= 0.0 {
        return [0.0, 0.0, value];
    }
    let hue = if value == rgb.x {
        (rgb.y - rgb.z) / range
    } else if value == rgb.y {
        2.0 + (rgb.z - rgb.x) / range
    } else {
        4.0 + (rgb.x - rgb.y) / range
    };
    [(hue * 60.0).rem_euclid(360.0), range / value, value]
}

fn rgb_from_hsv([hue, saturation, value]: [f64; 3]) -> DVec3 {
    let channel = |offset: f64| {
        let k = (offset + hue / 60.0).rem_euclid(6.0);
        let ramp = k.at_most(4.0 - k).clamp(0.0, 1.0);
        value - value * saturation * ramp
    };
    DVec3::new(channel(5.0), channel(3.0), channel(1.0))
}

/// A factor a step, for a number of steps that may be a fraction or negative.
pub(crate) fn factor(a_step: f64, steps: f64) -> f64 {
    pow(a_step, steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn daylight_is_white_and_a_candle_red() {
        // Planckian light of 6,504 K is a little off the white of Rec.709.
        assert!((planckian(6504.0) - DVec3::ONE).abs().max_element() < 0.05);
        let candle = planckian(1900.0);
        assert!(candle.x > 2.0 && candle.z < 0.05, "{candle}");
        for kelvin in [2000.0, 3000.0, 4000.0, 4001.0, 6500.0, 10_000.0, 20_000.0] {
            let found = temperature(planckian(kelvin).as_vec3());
            assert!((found / kelvin - 1.0).abs() < 1e-3, "{kelvin}: {found}");
        }
    }

    #[test]
    fn luminance_is_kept() {
        for colour in [
            [3.3, 2.9, 2.3],
            [1.0, 1.0, 1.0],
            [0.0, 0.2, 0.9],
            [5.0, 0.0, 0.0],
        ] {
            let colour = Vec3::from_array(colour);
            for changed in [
                colder(colour, 30.0).0,
                colder(colour, -1000.0).0,
                turned(colour, 25.0),
                turned(colour, -200.0),
                saturated(colour, 0.5),
                saturated(colour, 4.0),
            ] {
                let ratio = luminance(changed) / luminance(colour);
                assert!((ratio - 1.0).abs() < 1e-5, "{colour} became {changed}");
                assert!(changed.min_element() >= 0.0, "{changed}");
            }
        }
        assert_eq!(
            saturated(Vec3::new(0.9, 0.1, 0.3), 0.0).x,
            saturated(Vec3::new(0.9, 0.1, 0.3), 0.0).z
        );
        assert_eq!(colder(Vec3::ZERO, 10.0).0, Vec3::ZERO);
    }

    #[test]
    fn hues_come_back_after_a_turn() {
        let colour = Vec3::new(0.8, 0.3, 0.1);
        let back = turned(turned(colour, 100.0), 260.0);
        assert!((back - colour).abs().max_element() < 1e-5, "{back}");
    }

    #[test]
    fn surfaces_stay_within_one() {
        let albedo = Vec3::new(0.9, 0.45, 0.0);
        assert_eq!(lighter(albedo, 10.0, 0.05), Vec3::new(1.0, 0.5, 0.0));
        assert_eq!(lighter(Vec3::ZERO, 1.1, 0.05), Vec3::splat(0.05));
    }
}
