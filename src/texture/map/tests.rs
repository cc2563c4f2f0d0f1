use std::hint::black_box;
use std::time::Instant;

use super::*;
use crate::maths::hash::uniform;

/// Points along each axis of a footprint in the brute-force mean. At 16 texels
/// a side they are a sixth of a texel apart, which leaves 0.3 % at a checker.
const POINTS: u32 = 160;

/// Uniform in 0..1 by index.
fn random(index: u32) -> f32 {
    uniform(7, index, 0)
}

fn map_of(size: [u32; 2], level: impl Fn(u32, u32) -> [u8; 3]) -> TextureMap {
    let levels = (0..size[0] * size[1])
        .map(|i| level(i % size[0], i / size[0]))
        .collect();
    TextureMap {
        texture: Arc::new(Texture::new(
            Path::new("test.png"),
            size,
            Pixels::Levels(levels),
        )),
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        clamp: false,
    }
}

fn checker(cell: u32) -> TextureMap {
    map_of([128, 128], |x, y| {
        [255 * ((x / cell + y / cell) % 2) as u8; 3]
    })
}

/// Sprites of 16 x 16 texels, drawn in blocks of 2 x 2 in eight colours.
fn atlas() -> TextureMap {
    map_of([96, 160], |x, y| {
        let sprite = x / 16 + 6 * (y / 16);
        let block = (random(sprite * 64 + x / 2 % 8 + 8 * (y / 2 % 8)) * 8.0) as u8;
        [255 * (block & 1), 127 * (block & 2), 63 * (block & 4)]
    })
}

fn brute_force(map: &TextureMap, at: [Vec2; 3], filter: TextureFilter) -> Vec3 {
    let mut sum = glam::DVec3::ZERO;
    for i in 0..POINTS * POINTS {
        let [a, b] = [i % POINTS, i / POINTS].map(|k| (k as f32 + 0.5) / POINTS as f32 - 0.5);
        sum += map.point(at[0] + at[1] * a + at[2] * b, filter).as_dvec3();
    }
    (sum / f64::from(POINTS * POINTS)).as_vec3()
}

/// Footprints of a picture: `extent` texels across, `stretch` times as long,
/// turned any way.
fn footprints(map: &TextureMap, extent: f32, stretch: f32, count: u32) -> Vec<[Vec2; 3]> {
    let size = map.texture.size.map(|n| n as f32);
    let texel = Vec2::new(1.0 / size[0], 1.0 / size[1]);
    (0..count)
        .map(|i| {
            let [u, v, turn] = [0, 1, 2].map(|k| random(1000 + 3 * i + k));
            // One in four is upright, as on a wall that faces the camera.
            let angle = if i % 4 == 0 {
                0.0
            } else {
                turn * std::f32::consts::TAU
            };
            let [sine, cosine] = [
                crate::maths::functions::sin_f32(angle),
                crate::maths::functions::cos_f32(angle),
            ];
            let along = Vec2::new(cosine, sine) * extent * texel;
            let across = Vec2::new(-sine, cosine) * extent * texel;
            [Vec2::new(u, v), along * stretch, across]
        })
        .collect()
}

/// Root of the mean square error over that of the truth.
fn relative_error(map: &TextureMap, places: &[[Vec2; 3]], filter: TextureFilter) -> f64 {
    let [mut error, mut truth] = [0.0; 2];
    for &at in places {
        let wanted = brute_force(map, at, filter);
        let got = map.mean(at[0], at[1], at[2], filter);
        error += f64::from((got - wanted).length_squared());
        truth += f64::from(wanted.length_squared());
    }
    (error / truth).sqrt()
}

const FILTERS: [TextureFilter; 2] = [TextureFilter::Bilinear, TextureFilter::Nearest];

#[test]
fn means_agree_with_brute_force() {
    /// See the table that `error_and_time` prints: about 0.5 % where texels are
    /// seen, the most where a footprint holds many of them, at which the truth
    /// itself varies by little more. What is left is the border inside cells
    /// that are taken as uniform.
    const LIMIT: f64 = 0.03;
    for (name, map) in [
        ("checker of 1", checker(1)),
        ("checker of 8", checker(8)),
        ("atlas", atlas()),
    ] {
        for filter in FILTERS {
            for (extent, stretch) in [
                (0.05, 1.0),
                (0.3, 1.0),
                (1.0, 1.0),
                (1.0, 16.0),
                (3.0, 4.0),
                (12.0, 1.0),
                (8.0, 8.0),
            ] {
                let places = footprints(&map, extent, stretch, 48);
                let error = relative_error(&map, &places, filter);
                assert!(
                    error < LIMIT,
                    "{name} {filter:?} {extent} x {stretch}: {error}"
                );
            }
        }
    }
}

#[test]
#[ignore = "prints a table"]
#[expect(clippy::print_stdout, reason = "the table is what it is for")]
fn error_and_time() {
    println!("image          filter    texels  1:n   error %   ns");
    for (name, map) in [
        ("checker of 1", checker(1)),
        ("checker of 8", checker(8)),
        ("atlas", atlas()),
    ] {
        for filter in FILTERS {
            for extent in [0.05, 0.3, 1.0, 2.0, 4.0, 8.0, 11.0, 24.0] {
                for stretch in [1.0, 4.0, 16.0] {
                    let places = footprints(&map, extent, stretch, 64);
                    let error = 100.0 * relative_error(&map, &places, filter);
                    // The fastest of many rounds: others use the machine too.
                    let mut ns = f64::INFINITY;
                    for _ in 0..400 {
                        let start = Instant::now();
                        for at in &places {
                            black_box(map.mean(at[0], at[1], at[2], filter));
                        }
                        let round = start.elapsed().as_secs_f64() * 1e9;
                        ns = ns.min(round / places.len() as f64);
                    }
                    println!("{name:14} {filter:9?} {extent:5} {stretch:5} {error:8.2} {ns:6.0}");
                }
            }
        }
    }
}
