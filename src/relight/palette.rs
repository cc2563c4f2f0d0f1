//! Colours that are easy to tell apart, as many as are asked for.

use glam::Vec3;

use crate::maths::functions::{linear_from_srgb, pow};
use crate::maths::order::Order;

/// Steps of a channel between 0 and 255 that colours are chosen from.
const STEP: usize = 17;
/// Smallest difference of a colour's channels: grey has another meaning in
/// these pictures.
const LEAST_CHROMA: u8 = 68;
/// Smallest value of a colour's largest channel: black is where nothing is.
const LEAST_VALUE: u8 = 102;
/// The first colour.
const FIRST: Levels = [204, 51, 51];

/// sRGB levels of a colour.
type Levels = [u8; 3];

/// A place in Oklab: lightness 0 to 1, and two axes of hue and chroma.
type Oklab = [f64; 3];

/// The first `count` colours of a list without end, linear. The colour of a
/// number depends on nothing but the number.
///
/// Every colour is the one farthest from all before it (Glasbey, van der
/// Heijden, Toh and Gray, "Colour displays for categorical images", 2007; here
/// by distance in Oklab. By weighted distance of levels, neighbours of two
/// shades of cyan looked the same). All of some 3,000 colours are used once
/// before the list starts again.
pub(super) fn distinct_colours(count: usize) -> Vec<Vec3> {
    let levels = farthest_first(count);
    let chosen = levels.iter().map(linear).collect::<Vec<_>>();
    (0..count).map(|k| chosen[k % chosen.len()]).collect()
}

/// The linear colour of sRGB levels.
pub(super) fn linear(levels: &Levels) -> Vec3 {
    Vec3::from_array(levels.map(|level| linear_level(level) as f32))
}

fn linear_level(level: u8) -> f64 {
    linear_from_srgb(f64::from(level) / 255.0)
}

fn farthest_first(count: usize) -> Vec<Levels> {
    let candidates: Vec<(Levels, Oklab)> =
        candidates().into_iter().map(|c| (c, oklab(&c))).collect();
    let mut chosen = vec![FIRST];
    let mut last = oklab(&FIRST);
    let mut nearest = vec![f64::INFINITY; candidates.len()];
    while chosen.len() < count {
        let mut farthest = 0;
        for (k, (_, place)) in candidates.iter().enumerate() {
            nearest[k] = nearest[k].at_most(squared_distance(*place, last));
            if nearest[k] > nearest[farthest] {
                farthest = k;
            }
        }
        if nearest[farthest] == 0.0 {
            break;
        }
        let (levels, place) = candidates[farthest];
        chosen.push(levels);
        last = place;
    }
    chosen
}

fn candidates() -> Vec<Levels> {
    let steps = || (0..=u8::MAX).step_by(STEP);
    let mut colours = Vec::new();
    for red in steps() {
        for green in steps() {
            colours.extend(steps().map(|blue| [red, green, blue]));
        }
    }
    let fits = |colour: &Levels| {
        let [red, green, blue] = *colour;
        let largest = red.max(green).max(blue);
        largest >= LEAST_VALUE && largest - red.min(green).min(blue) >= LEAST_CHROMA
    };
    colours.retain(fits);
    colours
}

/// A colour where distances are differences that eyes see (Ottosson, "A
/// perceptual color space for image processing", 2020).
fn oklab(levels: &Levels) -> Oklab {
    let rgb = levels.map(linear_level);
    let dot = |m: [f64; 3], v: [f64; 3]| m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
    let cones = [
        [0.412_221_470_8, 0.536_332_536_3, 0.051_445_992_9],
        [0.211_903_498_2, 0.680_699_545_1, 0.107_396_956_6],
        [0.088_302_461_9, 0.281_718_837_6, 0.629_978_700_5],
    ]
    .map(|row| pow(dot(row, rgb), 1.0 / 3.0));
    [
        [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
        [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
        [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
    ]
    .map(|row| dot(row, cones))
}

fn squared_distance(a: Oklab, b: Oklab) -> f64 {
    let [l, m, n] = [0, 1, 2].map(|k| a[k] - b[k]);
    l * l + m * m + n * n
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance in Oklab of any two of so many colours; eyes tell 0.02 apart.
    /// The largest scene of the repository has 200 partitions.
    const FIGURES: [(usize, f64); 2] = [(64, 0.08), (200, 0.05)];

    #[test]
    fn any_two_of_the_first_colours_can_be_told_apart() {
        for (count, apart) in FIGURES {
            let colours: Vec<Oklab> = farthest_first(count).iter().map(oklab).collect();
            let pairs = (0..count).flat_map(|a| (0..a).map(move |b| (a, b)));
            let least = pairs
                .map(|(a, b)| squared_distance(colours[a], colours[b]))
                .fold(f64::INFINITY, f64::at_most)
                .sqrt();
            assert!(least >= apart, "{count} colours: {least} apart");
        }
    }

    #[test]
    fn oklab_has_its_published_places() {
        for (levels, place) in [
            ([255, 255, 255], [1.0, 0.0, 0.0]),
            ([255, 0, 0], [0.628, 0.225, 0.126]),
            ([0, 0, 255], [0.452, -0.032, -0.312]),
        ] {
            let off = squared_distance(oklab(&levels), place).sqrt();
            assert!(off < 1e-3, "{levels:?}: {off}");
        }
    }

    #[test]
    fn a_number_keeps_its_colour_and_the_list_has_no_end() {
        let few = distinct_colours(10);
        let many = distinct_colours(5_000);
        assert_eq!(few[..], many[..10], "the colour of a number changes");
        assert_eq!(many.len(), 5_000);
        let all = candidates().len();
        assert_eq!(many[..100], many[all..all + 100], "the list starts again");
    }
}
