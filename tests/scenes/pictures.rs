//! Image files of the scenes: paving, brickwork, a lantern's panes and an
//! evening sky. The PNG files are not compressed, so that their bytes depend on
//! no compressor's version.

use glam::{DVec2, DVec3};
use image::codecs::hdr::HdrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, Rgb};

/// Side of a repeating picture, pixels.
const TILE_SIDE: usize = 128;
/// Side of the picture of a lantern's pane.
const PANE_SIDE: usize = 16;
/// The evening sky.
const SKY_SIZE: [usize; 2] = [64, 32];
/// Radiance of a texel of the sun, W/(m2 sr); a texel there has 0.0093 sr.
const SUN: DVec3 = DVec3::new(150.0, 78.0, 30.0);
/// Row of the sun: 14 degrees above the horizon.
const SUN_ROW: usize = 13;

/// A file of a scene beside its mesh.
pub(crate) struct Picture {
    /// Name of the file.
    pub(crate) name: &'static str,
    /// What it holds.
    pub(crate) bytes: Vec<u8>,
}

/// Rows of stones with joints between them, every other row moved by half a
/// stone. The picture repeats, for the number of rows is even.
struct Masonry {
    stones_across: u32,
    rows: u32,
    /// Width of a joint as a share of the tile.
    joint: f64,
    /// Mean colour of the stones, sRGB 0 to 1.
    stone: DVec3,
    mortar: DVec3,
    /// Difference of brightness between stones.
    spread: f64,
    seed: u32,
}

/// Slabs of warm limestone.
pub(crate) fn paving() -> Picture {
    let masonry = Masonry {
        stones_across: 3,
        rows: 4,
        joint: 0.012,
        stone: DVec3::new(0.76, 0.71, 0.63),
        mortar: DVec3::new(0.46, 0.43, 0.38),
        spread: 0.13,
        seed: 1,
    };
    tile("paving.png", &masonry)
}

/// Red bricks in a running bond.
pub(crate) fn bricks() -> Picture {
    let masonry = Masonry {
        stones_across: 4,
        rows: 12,
        joint: 0.014,
        stone: DVec3::new(0.7, 0.4, 0.29),
        mortar: DVec3::new(0.74, 0.69, 0.61),
        spread: 0.16,
        seed: 2,
    };
    tile("bricks.png", &masonry)
}

/// A pane that glows in its middle, with a cross and a rim of dark iron.
pub(crate) fn pane() -> Picture {
    let glow = |place: DVec2| {
        let from_middle = (place - 0.5).abs();
        if from_middle.min_element() < 0.05 || from_middle.max_element() > 0.42 {
            return DVec3::splat(0.02);
        }
        DVec3::splat(1.0 - 0.7 * from_middle.length())
    };
    png("pane.png", PANE_SIDE, glow)
}

/// A clear sky after a warm day: deep blue above, orange around a sun of two
/// texels in the middle of the map (u = 0.5, towards +z) just above the horizon,
/// dark ground below.
pub(crate) fn evening_sky() -> Picture {
    let [width, height] = SKY_SIZE;
    let mut pixels = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let is_sun = (width / 2 - 1..=width / 2).contains(&x) && y == SUN_ROW;
            let radiance = if is_sun {
                SUN
            } else {
                sky_radiance(direction_of(x, y))
            };
            pixels.push(Rgb(radiance.as_vec3().to_array()));
        }
    }
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, width, height)
        .expect("a vector takes every byte");
    Picture {
        name: "evening.hdr",
        bytes,
    }
}

/// Radiance of the sky and the ground without the sun, W/(m2 sr).
fn sky_radiance(direction: DVec3) -> DVec3 {
    if direction.y < 0.0 {
        return DVec3::new(0.1, 0.085, 0.07);
    }
    let zenith = DVec3::new(0.06, 0.1, 0.25);
    let horizon = DVec3::new(0.36, 0.27, 0.32);
    let glow = DVec3::new(1.5, 0.7, 0.22);
    let height = libm::sqrt(direction.y);
    let towards_sun = 0.5 + 0.5 * direction.z;
    let low = 1.0 - height;
    horizon.lerp(zenith, height) + glow * (libm::pow(towards_sun, 4.0) * low * low)
}

/// Direction to the middle of a texel; u = 0.5 is +z.
fn direction_of(x: usize, y: usize) -> DVec3 {
    let [width, height] = SKY_SIZE.map(|count| count as f64);
    let azimuth = (x as f64 + 0.5) / width * std::f64::consts::TAU;
    let polar = (y as f64 + 0.5) / height * std::f64::consts::PI;
    let (across, up) = (libm::sin(polar), libm::cos(polar));
    DVec3::new(
        across * libm::sin(azimuth),
        up,
        -across * libm::cos(azimuth),
    )
}

fn tile(name: &'static str, masonry: &Masonry) -> Picture {
    png(name, TILE_SIDE, |place| masonry.colour(place))
}

impl Masonry {
    /// Colour at a place of the tile, 0 to 1 to the right and down.
    fn colour(&self, place: DVec2) -> DVec3 {
        let row = (place.y * f64::from(self.rows)).floor();
        let shift = if row % 2.0 == 0.0 { 0.0 } else { 0.5 };
        let along = place.x * f64::from(self.stones_across) + shift;
        let stone = along.floor() % f64::from(self.stones_across);
        let to_joint = [
            distance_to_whole(along) / f64::from(self.stones_across),
            distance_to_whole(place.y * f64::from(self.rows)) / f64::from(self.rows),
        ];
        let grain = self.noise([place.x, place.y].map(|p| (p * TILE_SIDE as f64) as u32), 3);
        if to_joint.into_iter().any(|d| d < 0.5 * self.joint) {
            return self.mortar * (1.0 + 0.1 * grain);
        }
        let cell = [stone as u32, row as u32];
        let brightness = 1.0 + self.spread * self.noise(cell, 0) + 0.05 * grain;
        let warmth = 0.35 * self.spread * self.noise(cell, 1);
        self.stone * brightness * DVec3::new(1.0 + warmth, 1.0, 1.0 - warmth)
    }

    /// A number from -1 to 1 for a cell.
    fn noise(&self, [x, y]: [u32; 2], kind: u32) -> f64 {
        let mut bits = self.seed;
        for word in [x, y, kind] {
            // The finalizer of MurmurHash3.
            bits = (bits ^ word).wrapping_mul(0x85eb_ca6b);
            bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
            bits ^= bits >> 16;
        }
        f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

fn distance_to_whole(x: f64) -> f64 {
    (x - x.round()).abs()
}

/// A square picture of sRGB colours, 0 to 1.
fn png(name: &'static str, side: usize, colour: impl Fn(DVec2) -> DVec3) -> Picture {
    let mut levels = Vec::new();
    for y in 0..side {
        for x in 0..side {
            let place = (DVec2::new(x as f64, y as f64) + 0.5) / side as f64;
            let rounded = (colour(place).clamp(DVec3::ZERO, DVec3::ONE) * 255.0).round();
            levels.extend(rounded.to_array().map(|level| level as u8));
        }
    }
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(
        &mut bytes,
        CompressionType::Uncompressed,
        FilterType::NoFilter,
    )
    .write_image(&levels, side as u32, side as u32, ExtendedColorType::Rgb8)
    .expect("a vector takes every byte");
    Picture { name, bytes }
}
