use std::hint::black_box;
use std::time::Instant;

use super::*;
use crate::maths::hash::uniform;
use crate::maths::order::Order;

/// Points along each axis of a footprint in the brute-force mean.
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
        // Points in rank and file would beat with the texels of wide footprints.
        let [a, b] = [(i % POINTS, 0), (i / POINTS, 1)]
            .map(|(k, axis)| (k as f32 + uniform(3, i, axis)) / POINTS as f32 - 0.5);
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

const STRETCHES: [f32; 3] = [1.0, 4.0, 16.0];

#[test]
fn means_agree_with_brute_force() {
    /// Measured worst of the atlas: 2.2 % at 8 texels, 1:16, and 1.9 % at 24
    /// texels, of which a footprint holds 144 blocks, so that the truth itself
    /// varies by 8 %; else 1.5 %.
    const LIMIT: f64 = 0.025;
    /// Of a checker of texels: its nearest image in parts of a texel's size,
    /// 4.2 % at 0.05 x 0.8.
    const FINE_CHECKER_LIMIT: f64 = 0.05;
    for (name, map) in maps() {
        let limit = if name == "checker of 1" {
            FINE_CHECKER_LIMIT
        } else {
            LIMIT
        };
        for filter in FILTERS {
            for extent in [0.05, 0.3, 1.0, 2.0, 4.0, 8.0, 11.0, 24.0, 64.0] {
                for stretch in STRETCHES {
                    let places = footprints(&map, extent, stretch, 12);
                    let error = relative_error(&map, &places, filter);
                    assert!(
                        error < limit,
                        "{name} {filter:?} {extent} x {stretch}: {error}"
                    );
                }
            }
        }
    }
}

fn maps() -> [(&'static str, TextureMap); 3] {
    [
        ("checker of 1", checker(1)),
        ("checker of 8", checker(8)),
        ("atlas", atlas()),
    ]
}

#[test]
#[ignore = "prints a table"]
#[expect(clippy::print_stdout, reason = "the table is what it is for")]
fn error_and_time() {
    println!("image          filter    texels  1:n   error %   ns");
    for (name, map) in maps() {
        for filter in FILTERS {
            for extent in [0.05, 0.3, 1.0, 2.0, 4.0, 8.0, 11.0, 24.0, 64.0] {
                for stretch in STRETCHES {
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
                        ns = ns.at_most(round / places.len() as f64);
                    }
                    println!("{name:14} {filter:9?} {extent:5} {stretch:5} {error:8.2} {ns:6.0}");
                }
            }
        }
    }
}

#[test]
fn means_are_continuous() {
    /// A step is a thousandth of the footprint's size or place, over which a
    /// truth of contrast 1 changes by at most about 4 thousandths; the rest is
    /// where a box becomes a covered outline and where octaves change.
    const LIMIT: f32 = 0.012;
    let map = checker(8);
    for filter in FILTERS {
        let mut last: Option<Vec3> = None;
        let mut extent = 0.002;
        while extent < 0.5 {
            let edges = [
                Vec2::new(extent, 0.3 * extent),
                Vec2::new(-0.2 * extent, extent),
            ];
            let mean = map.mean(Vec2::new(0.31, 0.17), edges[0], edges[1], filter);
            let step = last.map_or(0.0, |last| (mean - last).abs().max_element());
            assert!(step < LIMIT, "{filter:?} {extent}: {step}");
            last = Some(mean);
            extent *= 1.001;
        }
    }
}

#[test]
fn strange_coordinates_give_defined_colors() {
    let map = atlas();
    let clamped = TextureMap {
        clamp: true,
        ..map.clone()
    };
    let numbers = [0.0, 1e-30, -0.3, 7e4, -3e18, 3e38, f32::NAN, f32::INFINITY];
    for filter in FILTERS {
        for [a, b] in numbers.iter().flat_map(|&a| numbers.map(|b| [a, b])) {
            for map in [&map, &clamped] {
                for [at, x, y] in [[a, 0.01, b], [0.2, a, b], [b, a, a]] {
                    let [at, x, y] = [Vec2::new(at, a), Vec2::new(x, b), Vec2::new(b, y)];
                    let mean = map.mean(at, x, y, filter);
                    assert!(
                        mean.is_finite() && mean.max_element() < 1.0001,
                        "{at} {x} {y}"
                    );
                    assert!(map.point(at, filter).is_finite());
                }
            }
        }
    }
}

#[test]
fn places_follow_the_convention() {
    // Two rows: the upper one 1 and 2, the lower one 3 and 4 of 255.
    let map = map_of([2, 2], |x, y| [(1 + x + 2 * y) as u8; 3]);
    let at = |map: &TextureMap, u, v| map.point(Vec2::new(u, v), TextureFilter::Nearest).x;
    let linear = |level: usize| LINEAR_FROM_LEVEL[level];
    assert_eq!(at(&map, 0.25, 0.75), linear(1));
    assert_eq!(at(&map, 0.75, 0.25), linear(4));
    assert_eq!(at(&map, -0.75, 5.75), linear(1));
    let clamped = TextureMap {
        clamp: true,
        ..map.clone()
    };
    assert_eq!(at(&clamped, -7.0, -3.0), linear(3));
    let moved = TextureMap {
        scale: Vec2::splat(2.0),
        offset: Vec2::new(0.5, 0.0),
        ..map
    };
    assert_eq!(at(&moved, 0.125, 0.375), linear(2));
    let mean = moved.mean(Vec2::ZERO, Vec2::ZERO, Vec2::ZERO, TextureFilter::Bilinear);
    assert_eq!(mean, moved.point(Vec2::ZERO, TextureFilter::Bilinear));
}
