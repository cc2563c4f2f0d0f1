//! From linear radiance to 8-bit levels: exposure, tone curve, sRGB.
//!
//! The sRGB transfer function is IEC 61966-2-1. Encoding rounds half up, and
//! is exact: a value is compared with the 255 places where the level changes,
//! so no power function runs a pixel and every machine gives the same bytes.

use std::sync::LazyLock;

use glam::Vec3;

use super::{Image, ImageSizeError};
use crate::maths::functions::{exp2, linear_from_srgb};
use crate::scene::Tone;

/// An 8-bit picture, row 0 on top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EncodedImage {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
    undefined_pixels: u64,
}

impl EncodedImage {
    /// A picture of given levels: three bytes a pixel.
    ///
    /// # Errors
    /// If a side is 0 or the number of bytes is not `3 * width * height`.
    pub fn of_bytes(width: u32, height: u32, bytes: Vec<u8>) -> Result<Self, ImageSizeError> {
        let wanted = 3 * u64::from(width) * u64::from(height);
        if wanted == 0 || bytes.len() as u64 != wanted {
            return Err(ImageSizeError {
                width,
                height,
                pixel_count: bytes.len() / 3,
            });
        }
        Ok(Self {
            width,
            height,
            bytes,
            undefined_pixels: 0,
        })
    }

    /// Width, pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height, pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green and blue of every pixel, row by row from the top.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The levels as an image of numbers 0 to 255, as they are read from a file.
    pub fn levels(&self) -> Image {
        let (pixels, _) = self.bytes.as_chunks::<3>();
        let pixels = pixels.iter().map(|&rgb| Vec3::from(rgb.map(f32::from)));
        Image::new(self.width, self.height, pixels.collect())
            .expect("three bytes a pixel were written")
    }

    /// Pixels in which a channel was not a number; such a channel is 0 here.
    pub fn undefined_pixels(&self) -> u64 {
        self.undefined_pixels
    }
}

/// How a linear image becomes levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Development {
    /// Radiance: exposed by `exposure` EV, through the tone curve, as sRGB.
    Radiance { exposure: f32, tone: Tone },
    /// Values that are a display colour already (albedo): clipped, as sRGB.
    Color,
    /// Values that are no colours (normals, depths): 0..1 as level / 255.
    Plain,
}

impl Development {
    /// The levels of `image`.
    pub(crate) fn develop(self, image: &Image) -> EncodedImage {
        match self {
            Self::Radiance { exposure, tone } => {
                let gain = exp2(f64::from(exposure)) as f32;
                match tone {
                    Tone::Srgb => encode_with(image, |x| srgb_level(x * gain)),
                    Tone::Filmic => encode_with(image, |x| srgb_level(filmic(x * gain))),
                }
            }
            Self::Color => encode_with(image, srgb_level),
            Self::Plain => encode_with(image, plain_level),
        }
    }
}

fn encode_with(image: &Image, level: impl Fn(f32) -> u8) -> EncodedImage {
    let mut bytes = Vec::with_capacity(3 * image.pixels().len());
    let mut undefined_pixels = 0;
    for pixel in image.pixels() {
        undefined_pixels += u64::from(pixel.is_nan());
        bytes.extend_from_slice(&pixel.to_array().map(&level));
    }
    EncodedImage {
        width: image.width(),
        height: image.height(),
        bytes,
        undefined_pixels,
    }
}

/// ACES as fitted by Narkowicz ("ACES Filmic Tone Mapping Curve", 2016); a
/// value that is not a number stays one.
fn filmic(x: f32) -> f32 {
    // The curve passes 1 at x = 7.2, so larger values clip; cutting them
    // here keeps infinity from becoming infinity / infinity.
    const CLIPPED_FROM: f32 = 100.0;
    if x >= CLIPPED_FROM {
        return 1.0;
    }
    if x <= 0.0 {
        return 0.0;
    }
    x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
}

/// Level of a value that is no colour.
fn plain_level(x: f32) -> u8 {
    // The cast clips, and makes 0 of what is not a number.
    (x * 255.0 + 0.5) as u8
}

/// sRGB level of a linear value: clipped to 0..1, rounded half up; 0 for what
/// is not a number.
fn srgb_level(x: f32) -> u8 {
    if x >= 1.0 {
        return 255;
    }
    if x < FIRST_BUCKET || x.is_nan() {
        return 0;
    }
    let table = &*SRGB;
    let bucket = (x.to_bits() - FIRST_BUCKET.to_bits()) >> BUCKET_SHIFT;
    let level = table.bucket_levels[bucket as usize];
    level + u8::from(x >= table.thresholds[level as usize + 1])
}

/// Linear value of an sRGB level: 0..=255, or a 16-bit level divided by 257.
fn decode_level(level: f32) -> f32 {
    let whole = level as u8;
    if f32::from(whole) == level {
        SRGB.decoded[whole as usize]
    } else {
        linear_from_srgb(f64::from(level) / 255.0) as f32
    }
}

/// A bucket is a range of floats that share the exponent and seven bits of the
/// mantissa. Seven bits suffice for at most one change of level a bucket: the
/// octave 0.5..1 has most changes, 67, and 128 buckets.
const BUCKET_SHIFT: u32 = 23 - 7;
/// Level 0 ends at 1.52e-4; the buckets start below it, at 2^-13, and end at 1.
const FIRST_BUCKET: f32 = 1.0 / 8192.0;
const BUCKET_COUNT: usize = 13 << 7;

struct SrgbTables {
    /// `thresholds[l]` is the smallest float whose level is `l` or more.
    thresholds: [f32; 257],
    /// Level of the first float of a bucket.
    bucket_levels: Vec<u8>,
    /// Linear value of a level.
    decoded: [f32; 256],
}

static SRGB: LazyLock<SrgbTables> = LazyLock::new(|| {
    let mut thresholds = [f32::INFINITY; 257];
    let mut decoded = [0.0; 256];
    for level in 0..256 {
        decoded[level] = linear_from_srgb(level as f64 / 255.0) as f32;
        thresholds[level] = round_up(linear_from_srgb((level as f64 - 0.5) / 255.0));
    }
    thresholds[0] = 0.0;
    let bucket_levels = (0..BUCKET_COUNT as u32)
        .map(|bucket| {
            let first = f32::from_bits(FIRST_BUCKET.to_bits() + (bucket << BUCKET_SHIFT));
            (thresholds[..256].partition_point(|&threshold| threshold <= first) - 1) as u8
        })
        .collect();
    SrgbTables {
        thresholds,
        bucket_levels,
        decoded,
    }
});

/// Smallest float that is not below `x`.
fn round_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x {
        nearest.next_up()
    } else {
        nearest
    }
}

/// Every channel of `image`, taken as sRGB levels 0..=255, as a linear value.
pub(crate) fn decode_levels(levels: &Image) -> Image {
    levels.map(decode_levels_of)
}

/// The channels of a pixel, taken as sRGB levels 0..=255, as linear values.
pub(super) fn decode_levels_of(pixel: Vec3) -> Vec3 {
    Vec3::from_array(pixel.to_array().map(decode_level))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::order::Order;

    #[test]
    fn all_levels_survive_decoding_and_encoding() {
        for level in 0..=255_u8 {
            assert_eq!(srgb_level(decode_level(f32::from(level))), level);
        }
        assert_eq!(decode_level(255.0), 1.0);
    }

    #[test]
    fn levels_are_those_of_the_transfer_function() {
        let mut x = 1e-6_f32;
        while x < 1.2 {
            let linear = f64::from(x).at_most(1.0);
            let encoded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * crate::maths::functions::pow(linear, 1.0 / 2.4) - 0.055
            };
            assert_eq!(srgb_level(x), (encoded * 255.0 + 0.5) as u8, "x = {x}");
            x *= 1.000_37;
        }
    }

    #[test]
    fn a_level_changes_at_its_threshold_and_not_before() {
        for level in 1..=255_u8 {
            let threshold = SRGB.thresholds[level as usize];
            assert_eq!(srgb_level(threshold), level);
            assert_eq!(srgb_level(threshold.next_down()), level - 1);
        }
    }

    #[test]
    fn sixteen_bit_levels_decode_between_their_neighbours() {
        let value = decode_level(100.5);
        assert!(decode_level(100.0) < value && value < decode_level(101.0));
    }

    #[test]
    fn strange_values_become_defined_levels_and_are_counted() {
        let pixels = vec![
            Vec3::new(f32::NAN, 0.5, 2.0),
            Vec3::new(f32::INFINITY, f32::NEG_INFINITY, -1.0),
        ];
        let image = Image::new(2, 1, pixels).unwrap();
        let radiance = |tone| Development::Radiance {
            exposure: 0.0,
            tone,
        };
        for (development, half) in [
            (radiance(Tone::Srgb), 188),
            (Development::Color, 188),
            (Development::Plain, 128),
            (radiance(Tone::Filmic), 206),
        ] {
            let encoded = development.develop(&image);
            assert_eq!(encoded.undefined_pixels(), 1, "{development:?}");
            assert_eq!(encoded.bytes()[0], 0);
            assert_eq!(encoded.bytes()[3..], [255, 0, 0]);
            assert_eq!(encoded.bytes()[1], half, "{development:?}");
        }
    }

    #[test]
    fn one_stop_doubles() {
        let image = Image::filled(1, 1, Vec3::new(0.1, 0.2, 0.4)).unwrap();
        let exposed = |exposure| {
            let tone = Tone::Srgb;
            Development::Radiance { exposure, tone }.develop(&image)
        };
        assert_eq!(exposed(1.0).bytes()[..2], exposed(0.0).bytes()[1..]);
    }
}
