//! Pairs of small images, made by integer formulas so that any other program
//! can make the same.

use glam::Vec3;
use relume::{Image, PIXELS_PER_DEGREE};

/// Size of most images: some filters wide, and some bands of the code high.
pub(super) const SIZE: [u32; 2] = [96, 72];

/// Which measure a pair is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// sRGB levels 0 to 255.
    Ldr,
    /// Linear radiance.
    Hdr,
}

/// Two images and how far apart they are.
pub(super) struct Pair {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) reference: Image,
    pub(super) candidate: Image,
    pub(super) pixels_per_degree: f64,
    /// Mean error as `flip-evaluator` 1.7 of PyPI has it: what the test
    /// `maps_are_those_of_the_package` prints.
    pub(super) expected_mean: f64,
}

/// All pairs.
pub(super) fn all() -> Vec<Pair> {
    let mut pairs = ldr();
    pairs.extend(hdr());
    pairs
}

fn ldr() -> Vec<Pair> {
    let pair = |name, reference: &Image, candidate: Image, expected_mean| Pair {
        name,
        kind: Kind::Ldr,
        reference: reference.clone(),
        candidate,
        pixels_per_degree: PIXELS_PER_DEGREE,
        expected_mean,
    };
    let picture = of_size(SIZE, levels);
    let noisy = of_size(SIZE, |x, y| {
        (levels(x, y) + noise(x, y, 20)).clamp(Vec3::ZERO, Vec3::splat(255.0))
    });
    let shifted = of_size(SIZE, |x, y| levels(x.saturating_sub(1), y));
    // A corner, where filters reach beyond two borders at once.
    let one_pixel = of_size(SIZE, |x, y| match (x, y) {
        (1, 2) => Vec3::splat(255.0) - levels(x, y),
        _ => levels(x, y),
    });
    let finer = of_size(SIZE, |x, y| levels(x, y) + noise(x, y, 257) / 257.0);
    let narrow = of_size([5, 3], |x, y| levels(16 * x, 16 * y));
    let black = of_size(SIZE, |_, _| Vec3::ZERO);
    let white = of_size(SIZE, |_, _| Vec3::splat(255.0));
    let far = Pair {
        pixels_per_degree: 25.0,
        ..pair("noise at 25 px/degree", &picture, noisy.clone(), 0.235_186)
    };
    vec![
        pair("identical", &picture, picture.clone(), 0.0),
        pair("one pixel", &picture, one_pixel, 0.001_024),
        pair("shifted by a pixel", &picture, shifted, 0.185_325),
        pair("noise", &picture, noisy, 0.102_897),
        pair("blurred", &picture, blurred(&picture), 0.317_073),
        pair("16-bit noise", &picture, finer, 0.011_109),
        pair("black and white", &black, white, 0.967_321),
        pair("5 x 3 pixels", &narrow, blurred(&narrow), 0.611_414),
        far,
    ]
}

fn hdr() -> Vec<Pair> {
    let pair = |name, reference: &Image, candidate: Image, expected_mean| Pair {
        name,
        kind: Kind::Hdr,
        reference: reference.clone(),
        candidate,
        pixels_per_degree: PIXELS_PER_DEGREE,
        expected_mean,
    };
    let picture = of_size(SIZE, radiance);
    let noisy = |image: &Image| {
        of_size(SIZE, |x, y| {
            let value = image.pixel(x, y).unwrap_or_default();
            value * (Vec3::ONE + noise(x, y, 64) / 256.0)
        })
    };
    let mostly_black = of_size(
        SIZE,
        |x, y| {
            if x < 60 { Vec3::ZERO } else { radiance(x, y) }
        },
    );
    let flat = of_size(SIZE, |_, _| Vec3::new(0.25, 0.5, 0.125));
    vec![
        pair("identical", &picture, picture.clone(), 0.0),
        pair("noise", &picture, noisy(&picture), 0.092_577),
        pair(
            "scaled",
            &picture,
            picture.map(|value| 1.125 * value),
            0.167_553,
        ),
        pair("blurred", &picture, blurred(&picture), 0.318_278),
        pair(
            "black median, noise",
            &mostly_black,
            noisy(&mostly_black),
            0.034_372,
        ),
        pair(
            "black median, blurred",
            &mostly_black,
            blurred(&mostly_black),
            0.150_073,
        ),
        pair("flat, noise", &flat, noisy(&flat), 0.064_439),
    ]
}

pub(super) fn of_size([width, height]: [u32; 2], pixel: impl Fn(u32, u32) -> Vec3) -> Image {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| pixel(x, y)).collect();
    Image::new(width, height, pixels).expect("the size has pixels")
}

/// Ramps of all channels under a chequerboard of 16 pixels.
pub(super) fn levels(x: u32, y: u32) -> Vec3 {
    let chequer = 70 * ((x / 16 + y / 16) % 2);
    let channel = |offset: u32| ((2 * x + y + offset) % 180 + chequer) as f32;
    Vec3::new(channel(0), channel(40), channel(90))
}

/// The picture as radiance, a stop brighter every 12 pixels to the right.
pub(super) fn radiance(x: u32, y: u32) -> Vec3 {
    (levels(x, y) + Vec3::ONE) / 256.0 * (1 << (x / 12)) as f32
}

/// Whole numbers from -amplitude to amplitude, another a channel.
pub(super) fn noise(x: u32, y: u32, amplitude: u32) -> Vec3 {
    let channel = |channel: u32| {
        let mixed = (x + 1000 * y + 1_000_000 * channel).wrapping_mul(2_654_435_761);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(2_246_822_519);
        ((mixed >> 16) % (2 * amplitude + 1)) as f32 - amplitude as f32
    };
    Vec3::new(channel(0), channel(1), channel(2))
}

/// Means over squares of 4 x 4 pixels that end at the pixel.
fn blurred(image: &Image) -> Image {
    of_size([image.width(), image.height()], |x, y| {
        let mut sum = Vec3::ZERO;
        for (dx, dy) in (0..16).map(|i| (i % 4, i / 4)) {
            let at = image.pixel(x.saturating_sub(dx), y.saturating_sub(dy));
            sum += at.unwrap_or_default();
        }
        sum / 16.0
    })
}
