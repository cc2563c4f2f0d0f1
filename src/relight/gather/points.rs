//! Which low-discrepancy points a pixel's rays take.

use crate::maths::hash::hash3;
use crate::maths::sobol::ScrambledSobol;
use crate::surface::direct::LightPoints;

/// Side of the squares of pixels that share one set of points. A set has 65,536.
const TILE_PX: u32 = 16;
/// Rays that every pixel of a tile may take.
pub(super) const MOST_RAYS: u32 = 65_536 / (TILE_PX * TILE_PX);
/// Times that a tile is quartered down to its pixels.
const LEVELS: u32 = TILE_PX.trailing_zeros();
/// Seed of the order of pixels.
const CURVE_SEED: u32 = 0x6a72;
/// Seed of the directions of rays.
const SEED: u32 = 0x6a70;
/// Seed of the points of lights that shadow rays go to.
const LIGHT_SEED: u32 = 0x6a71;

/// The points of one pixel: a run of the set of its tile.
///
/// Runs are handed out along a curve that visits quarters of quarters, so those of 2 x 2, 4 x 4, ... pixels are
/// runs themselves, and as even as one pixel's: what one pixel's points miss, its
/// neighbours have. Noise is then of high frequency, and the means of blocks have
/// next to none. In which order four quarters are visited differs from place to place:
/// always in that of a Z, even columns were lighter than odd ones over whole tiles
/// (Ahmed and Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo
/// Sampling Error via Hierarchical Ordering of Pixels", 2020).
#[derive(Clone, Copy)]
pub(super) struct PixelPoints {
    /// First point of the pixel in the sets.
    first: u32,
    directions: ScrambledSobol,
    lights: ScrambledSobol,
}

impl PixelPoints {
    /// Of a pixel in a picture `width_px` wide, `rays` a pixel.
    pub(super) fn of(pixel: u32, width_px: u32, rays: u32) -> Self {
        debug_assert!(rays <= MOST_RAYS, "a set has 65,536 points");
        let (x, y) = (pixel % width_px, pixel / width_px);
        let tile = y / TILE_PX * width_px.div_ceil(TILE_PX) + x / TILE_PX;
        Self {
            first: place_on_curve(tile, [x % TILE_PX, y % TILE_PX]) * rays,
            directions: ScrambledSobol::new(SEED, tile),
            lights: ScrambledSobol::new(LIGHT_SEED, tile),
        }
    }

    /// Four uniforms of one of the pixel's rays.
    pub(super) fn uniforms(&self, ray: u32) -> [f32; 4] {
        self.directions.point(self.first + ray)
    }

    /// The point of a light that one of the pixel's rays asks for where it arrives. (In
    /// the order of the rays a direction would choose the point of the light, and whole
    /// tiles would have the shadow of a part of it.)
    pub(super) fn of_lights(&self, ray: u32) -> LightPoints {
        LightPoints {
            set: self.lights,
            first: self.lights.shuffled(self.first + ray),
            count: 1,
        }
    }
}

/// Place of a pixel of a tile (coordinates below 16) on the tile's curve.
fn place_on_curve(tile: u32, [x, y]: [u32; 2]) -> u32 {
    (0..LEVELS).rev().fold(0, |place, level| {
        let quarter = (x >> level & 1) | (y >> level & 1) << 1;
        // One of the eight ways to turn and mirror a square.
        let way = hash3(CURVE_SEED ^ tile, place, level);
        let turned = if way >> 2 & 1 == 1 {
            quarter >> 1 | (quarter & 1) << 1
        } else {
            quarter
        };
        place << 2 | (turned ^ (way & 3))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_of_a_tile_share_no_point() {
        let mut places: Vec<u32> = (0..256)
            .map(|k| place_on_curve(3, [k % 16, k / 16]))
            .collect();
        places.sort_unstable();
        assert!(places.into_iter().eq(0..256));
    }

    #[test]
    fn a_block_of_four_pixels_is_as_even_as_one() {
        let rays = 64;
        let mut seen = [false; 256];
        for pixel in [0, 1, 40, 41] {
            let points = PixelPoints::of(pixel, 40, rays);
            for ray in 0..rays {
                let [u, v, ..] = points.uniforms(ray);
                seen[(u * 16.0) as usize * 16 + (v * 16.0) as usize] = true;
            }
        }
        assert!(seen.iter().all(|&s| s), "a 16 x 16 cell has no point");
    }

    #[test]
    fn a_direction_does_not_choose_the_point_of_the_light() {
        let mut seen = [false; 256];
        for pixel in [0, 1, 40, 41] {
            let points = PixelPoints::of(pixel, 40, 256);
            for ray in 0..256 {
                let light = points.of_lights(ray);
                let [u, at] = [points.uniforms(ray)[0], light.set.point2(light.first)[0]];
                seen[(u * 16.0) as usize * 16 + (at * 16.0) as usize] = true;
            }
        }
        let cells = seen.into_iter().filter(|&s| s).count();
        assert!(cells > 240, "{cells} of 256 pairs");
    }
}
