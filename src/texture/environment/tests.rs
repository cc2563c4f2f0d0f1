use std::f64::consts::PI;

use super::*;
use crate::maths::functions::{cos_f32, sin_f32};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use lookup::direction_of;

fn map_of(size: [usize; 2], radiance: impl Fn(Vec3) -> f32) -> EnvironmentMap {
    let texels = (0..size[0] * size[1])
        .map(|i| {
            let u = ((i % size[0]) as f32 + 0.5) / size[0] as f32;
            let v = ((i / size[0]) as f32 + 0.5) / size[1] as f32;
            Vec3::new(1.0, 0.5, 0.25) * radiance(direction_of([u, v]))
        })
        .collect();
    EnvironmentMap::new(Path::new("sky.exr"), size, texels)
}

/// Directions spread over the sphere, with the poles.
fn directions(count: u32) -> Vec<Vec3> {
    let mut found: Vec<Vec3> = (0..count)
        .map(|i| {
            let y = 1.0 - 2.0 * uniform(1, i, 0);
            let angle = uniform(1, i, 1) * std::f32::consts::TAU;
            let across = (1.0 - y * y).at_least(0.0).sqrt();
            Vec3::new(across * sin_f32(angle), y, across * cos_f32(angle))
        })
        .collect();
    found.extend([Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z]);
    found
}

fn disc(direction: Vec3, toward: Vec3, radius_deg: f32) -> bool {
    direction.dot(toward) > cos_f32(radius_deg.to_radians())
}

fn toward_sun() -> Vec3 {
    Vec3::new(0.6, 0.64, -0.48).normalize()
}

/// A sky with a sun of two degrees across.
fn sunny() -> EnvironmentMap {
    map_of([512, 256], |d| {
        1.0 + 0.5 * d.y
            + if disc(d, toward_sun(), 2.0) {
                5000.0
            } else {
                0.0
            }
    })
}

#[test]
fn a_uniform_map_is_its_constant_everywhere() {
    const ROUNDING: f32 = 1e-6;
    for size in [[64, 32], [33, 17], [2, 1], [1, 1], [512, 256]] {
        let map = map_of(size, |_| 2.0);
        for d in directions(200) {
            for spread in [0.0, 1e-4, 0.01, 0.1, 0.7, 3.0, 9.0] {
                let got = map.radiance(d, spread);
                assert!(
                    (got.x - 2.0).abs() < 2.0 * ROUNDING,
                    "{size:?} {d} {spread}: {got}"
                );
            }
        }
        assert_eq!(map.sun(), None);
        for mean in map.cell_means(|d| d) {
            assert!((mean.x - 2.0).abs() < 2.0 * ROUNDING, "{mean}");
        }
    }
}

#[test]
fn directions_and_places_follow_the_convention() {
    // 8 x 4 texels, each its own value: the corner of u = v = 0 is straight up.
    let texels: Vec<Vec3> = (0..32).map(|i| Vec3::splat(i as f32)).collect();
    let map = EnvironmentMap::new(Path::new("sky.exr"), [8, 4], texels);
    for i in 0..32 {
        let place = [((i % 8) as f32 + 0.5) / 8.0, ((i / 8) as f32 + 0.5) / 4.0];
        let got = map.radiance(direction_of(place), 0.0).x;
        assert!((got - i as f32).abs() < 1e-4, "{i} {got}");
    }
    // -Z is u = 0, halfway between the last and the first column; +X is u = 1/4.
    let at = |d: Vec3| map.radiance(d, 0.0).x;
    assert!((at(Vec3::NEG_Z) - (8.0 + 15.0 + 16.0 + 23.0) / 4.0).abs() < 1e-4);
    assert!((at(Vec3::X) - (9.0 + 10.0 + 17.0 + 18.0) / 4.0).abs() < 1e-4);
    assert_eq!(map.radiance(Vec3::NAN, 0.1), Vec3::ZERO);
}

#[test]
fn cones_agree_with_brute_force() {
    /// The rectangle of latitudes and longitudes is not the cone, and this sky
    /// has a wave every 15 degrees.
    const LIMIT: f64 = 0.03;
    let sky = |d: Vec3| 1.5 + sin_f32(24.0 * d.x) * cos_f32(12.0 * d.y);
    let map = map_of([512, 256], sky);
    for spread in [0.01_f32, 0.05, 0.2] {
        let [mut error, mut truth] = [0.0; 2];
        for d in directions(100) {
            let side = d.any_orthonormal_vector();
            let up = side.cross(d);
            let mut wanted = 0.0;
            for i in 0..64 {
                let [a, b] = [i % 8, i / 8].map(|k| (k as f32 - 3.5) / 8.0 * spread);
                wanted += f64::from(sky((d + side * a + up * b).normalize())) / 64.0;
            }
            let difference = f64::from(map.radiance(d, spread).x) - wanted;
            error += difference * difference;
            truth += wanted * wanted;
        }
        assert!(
            (error / truth).sqrt() < LIMIT,
            "{spread}: {}",
            (error / truth).sqrt()
        );
    }
}

#[test]
fn a_sun_is_found_and_taken_out() {
    let map = sunny();
    let sun = map.sun().unwrap();
    // The texels' edges are 0.35 degrees from the disc's at most.
    assert!(sun.direction.dot(toward_sun()) > cos_f32(0.2_f32.to_radians()));
    assert!((sun.radius_rad.to_degrees() / 2.0 - 1.0).abs() < 0.05);
    let left = map.radiance_without_sun(toward_sun(), 0.0).x;
    let sky = 1.0 + 0.5 * toward_sun().y;
    assert!((left / sky - 1.0).abs() < 0.05, "{left} {sky}");
    assert!(map.radiance(toward_sun(), 0.0).x > 4000.0);
}

#[test]
fn sun_and_rest_hold_the_light_of_the_map() {
    /// Sums in single precision.
    const LIMIT: f64 = 1e-3;
    let map = sunny();
    let total = |panorama: &Panorama| -> f64 {
        let solid_angles = lookup::texel_solid_angles(panorama.size());
        let light = |(i, c): (usize, &Vec3)| f64::from(c.y * solid_angles[i / 512]);
        panorama.finest().iter().enumerate().map(light).sum()
    };
    let (sun, rest) = map.sun.as_ref().unwrap();
    let parts = total(rest) + f64::from(sun.irradiance.y);
    assert!((parts / total(&map.panorama) - 1.0).abs() < LIMIT);
}

#[test]
fn what_is_no_sun_is_left() {
    let around = |d: Vec3, count: u32, radius: f32| {
        directions(200)[..count as usize]
            .iter()
            .any(|&lamp| disc(d, lamp, radius))
    };
    let maps: [(&str, EnvironmentMap); 6] = [
        ("gradient", map_of([256, 128], |d| 1.0 + 0.9 * d.y)),
        (
            "overcast with a bright patch",
            map_of([256, 128], |d| {
                let toward = d.dot(toward_sun()).at_least(0.0);
                1.0 + 6.0 * (0..20).fold(1.0, |power, _| power * toward)
            }),
        ),
        (
            "window",
            map_of(
                [256, 128],
                |d| if disc(d, Vec3::X, 15.0) { 500.0 } else { 0.2 },
            ),
        ),
        (
            "lamps",
            map_of([256, 128], |d| if around(d, 9, 2.0) { 900.0 } else { 0.2 }),
        ),
        (
            "plain patch of a few texels",
            map_of([64, 32], |d| if disc(d, Vec3::X, 8.5) { 1.0 } else { 0.0 }),
        ),
        ("dark", map_of([256, 128], |_| 0.0)),
    ];
    for (name, map) in maps {
        assert_eq!(map.sun(), None, "{name}");
        let d = toward_sun();
        assert_eq!(
            map.radiance_without_sun(d, 0.1),
            map.radiance(d, 0.1),
            "{name}"
        );
    }
}

#[test]
fn the_density_integrates_to_one_and_is_what_is_sampled() {
    /// Standard deviations of a cell's count of samples.
    const DEVIATIONS: f64 = 5.0;
    /// Rounding of 1e-6 over texels of 0.02, with a margin.
    const MOST_AT_BORDERS: f64 = 1e-3;
    let map = map_of([48, 24], |d| 0.1 + (3.0 * d.x + d.y).at_least(0.0));
    let cell_of = crate::maths::cube_cells::cell_of;
    let mut wanted = vec![0.0; CELL_COUNT];
    for (cell, share) in wanted.iter_mut().enumerate() {
        for i in 0..400 {
            let place = [i % 20, i / 20].map(|k| (k as f32 + 0.5) / 20.0);
            let (d, solid_angle) = direction_in_cell(cell, place);
            *share += f64::from(map.density(d) * solid_angle) / 400.0;
        }
    }
    let total: f64 = wanted.iter().sum();
    assert!((total - 1.0).abs() < 2e-3, "{total}");
    let count = 200_000;
    let mut border_count = 0;
    let mut got = vec![0.0; CELL_COUNT];
    for i in 0..count {
        let (d, density) = map.sample([uniform(5, i, 0), uniform(5, i, 1)]);
        assert!((d.length() - 1.0).abs() < 1e-5);
        // A direction on a texel's border may round into the next one.
        let agrees = (density / map.density(d) - 1.0).abs() < 1e-3;
        border_count += u32::from(!agrees);
        got[cell_of(d)] += 1.0;
    }
    assert!(
        f64::from(border_count) < MOST_AT_BORDERS * f64::from(count),
        "{border_count}"
    );
    for (got, wanted) in got.iter().zip(&wanted) {
        let mean = wanted * f64::from(count);
        let limit = DEVIATIONS * mean.sqrt() + 0.01 * mean;
        assert!((got - mean).abs() < limit, "{got} {mean}");
    }
}

#[test]
fn light_is_never_where_the_density_is_zero() {
    for map in [sunny(), map_of([16, 8], |_| 0.0)] {
        for d in directions(500) {
            assert!(f64::from(map.density(d)) > 0.04 / (4.0 * PI));
        }
    }
    for edge in [[0.0, 0.0], [0.999_999_94, 0.999_999_94], [0.0, 0.5]] {
        let (d, density) = sunny().sample(edge);
        assert!(d.is_finite() && density > 0.0);
    }
}

#[test]
fn cell_means_keep_the_light_of_the_sky_and_turn_with_it() {
    /// The bounding rectangles of the cones near the poles overlap.
    const LIMIT: f64 = 2e-3;
    let map = map_of([128, 64], |d| 1.0 + 0.8 * d.y + 0.5 * d.x);
    let means = map.cell_means(|d| d);
    for (cell, mean) in means.iter().enumerate() {
        let (d, _) = direction_in_cell(cell, [0.5, 0.5]);
        let wanted = 1.0 + 0.8 * d.y + 0.5 * d.x;
        assert!((mean.x - wanted).abs() < 0.02, "{cell}: {mean} {wanted}");
    }
    let mean: f64 = means
        .iter()
        .enumerate()
        .map(|(cell, mean)| {
            let share = |i: usize| {
                let place = [i % 16, i / 16].map(|k| (k as f32 + 0.5) / 16.0);
                f64::from(direction_in_cell(cell, place).1) / 256.0
            };
            f64::from(mean.x) * (0..256).map(share).sum::<f64>()
        })
        .sum::<f64>()
        / (4.0 * PI);
    assert!((mean - 1.0).abs() < LIMIT, "{mean}");
    let turned = map.cell_means(|d| Vec3::new(-d.x, d.y, -d.z));
    let cell = crate::maths::cube_cells::cell_of(Vec3::new(-0.9, 0.1, 0.1));
    let opposite = crate::maths::cube_cells::cell_of(Vec3::new(0.9, 0.1, -0.1));
    assert!((turned[cell].x - means[opposite].x).abs() < 2e-3);
}

#[test]
fn cell_means_agree_with_brute_force() {
    /// The rectangles that are read reach a little beyond a cell's border,
    /// where this sky of texels of its own brightness each has steps.
    const LIMIT: f64 = 0.03;
    /// Directions along a cell's side.
    const ALONG: usize = 48;
    let size = [64, 32];
    let texels = (0..size[0] * size[1])
        .map(|i| Vec3::splat(uniform(11, i as u32, 0)))
        .collect();
    let map = EnvironmentMap::new(Path::new("sky.exr"), size, texels);
    assert_eq!(map.sun(), None);
    let means = map.cell_means(|d| d);
    for (cell, mean) in means.iter().enumerate() {
        let [mut sum, mut total] = [0.0; 2];
        for i in 0..ALONG * ALONG {
            let place = [i % ALONG, i / ALONG].map(|k| (k as f32 + 0.5) / ALONG as f32);
            let (d, solid_angle) = direction_in_cell(cell, place);
            sum += f64::from(map.radiance(d, 0.0).x * solid_angle);
            total += f64::from(solid_angle);
        }
        let wanted = sum / total;
        let error = (f64::from(mean.x) / wanted - 1.0).abs();
        assert!(error < LIMIT, "{cell}: {mean} {wanted}");
    }
}

#[test]
fn images_without_radiance_are_refused() {
    let mut png = std::io::Cursor::new(Vec::new());
    image::DynamicImage::new_rgb8(4, 2)
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    let error = EnvironmentMap::decode(png.get_ref(), Path::new("sky.png")).unwrap_err();
    assert!(error.to_string().contains("no radiance"), "{error}");
}
