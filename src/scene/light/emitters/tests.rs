//! The cut against the sum over all polygons, its samples against its sum.

use glam::Vec3;

use super::{Emitters, LightCut};
use crate::maths::functions::{cos_f32, sin_f32};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::scene::light::Polygon;
use crate::scene::max_component;

/// What a cut may differ from the sum over all polygons: an eighth of a level
/// of an 8-bit picture at mid grey.
const CUT_ERROR: f32 = 5e-3;
/// The same, as the root of the mean square over the points of a scene.
const TYPICAL_ERROR: f32 = 1.5e-3;
/// 16,384 scrambled Sobol points; polygons close to the point are noisiest.
const SAMPLED_ERROR: f32 = 1e-2;

fn random_vector(index: u32, first: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|d| 2.0 * uniform(23, index, first + d) - 1.0))
}

fn white(_: u32) -> Vec3 {
    Vec3::ONE
}

/// Sphere of 9,800 triangles with radius 0.2 about the origin.
fn sphere(radiance: impl Fn(u32) -> Vec3) -> Vec<Polygon> {
    const RINGS: u32 = 50;
    const SEGMENTS: u32 = 100;
    let point = |ring: u32, segment: u32| {
        let polar = std::f32::consts::PI * ring as f32 / RINGS as f32;
        let turn = std::f32::consts::TAU * (segment % SEGMENTS) as f32 / SEGMENTS as f32;
        let radius = 0.2 * sin_f32(polar);
        Vec3::new(
            radius * cos_f32(turn),
            0.2 * cos_f32(polar),
            -radius * sin_f32(turn),
        )
    };
    let mut polygons = Vec::new();
    for ring in 0..RINGS {
        for segment in 0..SEGMENTS {
            let [a, b] = [0, 1].map(|s| point(ring, segment + s));
            let [c, d] = [0, 1].map(|s| point(ring + 1, segment + s));
            if ring + 1 < RINGS {
                polygons.push(Polygon::triangle([a, c, d], radiance(ring)));
            }
            if ring > 0 {
                polygons.push(Polygon::triangle([a, d, b], radiance(ring)));
            }
        }
    }
    polygons
}

/// 100 x 100 square lamps at y = 0.5 over the floor of a unit box, facing down.
fn ceiling(radiance: impl Fn(u32) -> Vec3) -> Vec<Polygon> {
    (0..10_000)
        .map(|index| {
            let [x, z] = [index % 100, index / 100].map(|k| f64::from(k) * 0.01 - 0.497);
            Polygon::parallelogram(
                glam::DVec3::new(x, 0.5, z),
                glam::DVec3::X * 0.004,
                glam::DVec3::Z * 0.004,
                radiance(index),
            )
        })
        .collect()
}

/// 10,000 random triangles in the box from -0.5 to 0.5.
fn soup(radiance: impl Fn(u32) -> Vec3) -> Vec<Polygon> {
    (0..10_000)
        .map(|index| {
            let corner = random_vector(index, 0) * 0.5;
            let [u, v] = [3, 6].map(|d| random_vector(index, d) * 0.02);
            Polygon::triangle([corner, corner + u, corner + v], radiance(index))
        })
        .collect()
}

/// A sheet that emits on both sides, in two colours.
fn sheet() -> Vec<Polygon> {
    let mut polygons = ceiling(|_| Vec3::new(1.0, 0.2, 0.0));
    polygons.truncate(5000);
    let backs: Vec<Polygon> = polygons
        .iter()
        .map(|lamp| {
            let ([a, b, _, d], _) = lamp.corners();
            Polygon::parallelogram(a, d - a, b - a, Vec3::new(0.0, 0.3, 1.0))
        })
        .collect();
    polygons.extend(backs);
    polygons
}

fn colored(index: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|d| uniform(31, index, d)))
}

/// Red before green before blue, in the order of the list.
fn striped(index: u32) -> Vec3 {
    [Vec3::X, Vec3::Y, Vec3::Z][(index / 3334) as usize % 3]
}

fn exact(polygons: &[Polygon], position: Vec3, normal: Vec3) -> Vec3 {
    let mut sum = glam::DVec3::ZERO;
    for polygon in polygons {
        let factor = polygon.form_factor(position, normal) * std::f32::consts::PI;
        sum += (polygon.radiance() * factor).as_dvec3();
    }
    sum.as_vec3()
}

/// Points around the scenes above, outside the sphere of radius 0.25.
fn places(count: u32) -> impl Iterator<Item = (Vec3, Vec3)> {
    (0..count).filter_map(|index| {
        let position = random_vector(index, 20) * 0.8;
        let normal = random_vector(index, 23).normalize();
        (position.length() > 0.25).then_some((position, normal))
    })
}

struct Errors {
    largest: f32,
    typical: f32,
    entries: f32,
}

/// Errors relative to the exact light. Points that see less than a hundredth
/// of the brightest are measured against that hundredth.
fn errors(polygons: &[Polygon]) -> Errors {
    let emitters = Emitters::new(polygons.to_vec());
    let results: Vec<(Vec3, LightCut)> = places(300)
        .map(|(p, n)| (exact(polygons, p, n), emitters.cut(p, n)))
        .collect();
    let brightest = results
        .iter()
        .map(|(exact, _)| max_component(*exact))
        .fold(0.0, f32::at_least);
    let (mut largest, mut squares, mut entries) = (0.0, 0.0, 0);
    for (exact, cut) in &results {
        let scale = max_component(*exact).at_least(0.01 * brightest);
        let error = max_component((cut.open() - *exact).abs()) / scale;
        assert!(cut.open().is_finite() && error.is_finite(), "{error}");
        largest = f32::at_least(largest, error);
        squares += error * error;
        entries += cut.len();
    }
    let count = results.len() as f32;
    Errors {
        largest,
        typical: (squares / count).sqrt(),
        entries: entries as f32 / count,
    }
}

fn scenes() -> Vec<(&'static str, Vec<Polygon>)> {
    vec![
        ("sphere", sphere(white)),
        ("ceiling", ceiling(white)),
        ("soup", soup(white)),
        ("coloured soup", soup(colored)),
        ("striped ceiling", ceiling(striped)),
        ("striped sphere", sphere(|ring| striped(ring * 200))),
        ("two-sided sheet", sheet()),
    ]
}

#[test]
fn a_cut_of_many_polygons_is_nearly_their_sum() {
    for (name, polygons) in scenes() {
        let errors = errors(&polygons);
        assert!(errors.largest < CUT_ERROR, "{name}: {}", errors.largest);
        assert!(errors.typical < TYPICAL_ERROR, "{name}: {}", errors.typical);
    }
}

#[test]
fn few_polygons_are_summed_exactly() {
    let polygons: Vec<Polygon> = soup(colored).into_iter().take(20).collect();
    let emitters = Emitters::new(polygons.clone());
    for (position, normal) in places(50) {
        let (sum, open) = (
            exact(&polygons, position, normal),
            emitters.cut(position, normal).open(),
        );
        assert!((sum - open).length() <= 1e-6 * sum.length(), "{sum} {open}");
    }
}

#[test]
fn the_mean_of_samples_is_the_open_irradiance() {
    let few: Vec<Polygon> = soup(colored).into_iter().take(20).collect();
    let mut all = scenes();
    all.push(("few", few));
    for (name, polygons) in all {
        let emitters = Emitters::new(polygons);
        let brightest = places(40)
            .map(|(position, normal)| max_component(emitters.cut(position, normal).open()))
            .fold(0.0, f32::at_least);
        for (set, (position, normal)) in places(12).enumerate() {
            let cut = emitters.cut(position, normal);
            let points = ScrambledSobol::new(9, set as u32);
            let mut sum = glam::DVec3::ZERO;
            for index in 0..16_384 {
                if let Some(sample) = cut.sample(&emitters, points.point2(index)) {
                    let cosine = sample.direction.dot(normal);
                    assert!(cosine > -1e-6 && sample.distance > 0.0);
                    sum += (sample.irradiance * cosine.at_least(0.0)).as_dvec3();
                }
            }
            let mean = (sum / 16_384.0).as_vec3();
            let scale = max_component(cut.open()).at_least(0.01 * brightest);
            assert!(
                max_component((mean - cut.open()).abs()) <= SAMPLED_ERROR * scale,
                "{name}, {position}: {mean} {}",
                cut.open()
            );
        }
    }
}

#[test]
fn polygons_without_light_or_area_are_dropped() {
    let dark = Polygon::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], Vec3::ZERO);
    let flat = Polygon::triangle([Vec3::ZERO, Vec3::X, Vec3::X], Vec3::ONE);
    let emitters = Emitters::new(vec![dark, flat]);
    assert_eq!(emitters, Emitters::default());
    let cut = emitters.cut(Vec3::Z, Vec3::NEG_Z);
    assert_eq!(cut.open(), Vec3::ZERO);
    assert!(cut.sample(&emitters, [0.5, 0.5]).is_none());
    assert_eq!(emitters, Emitters::default());
}

#[test]
fn a_hundred_polygons_in_one_place_are_a_hundred_times_one() {
    let one = Polygon::triangle([Vec3::ZERO, Vec3::X, Vec3::Y], Vec3::ONE);
    let emitters = Emitters::new(vec![one; 100]);
    for (position, normal) in places(50) {
        let expected =
            Vec3::splat(100.0 * std::f32::consts::PI) * one.form_factor(position, normal);
        let open = emitters.cut(position, normal).open();
        assert!((open - expected).length() <= CUT_ERROR * expected.length() + 1e-6);
    }
}

#[test]
fn equal_lists_give_equal_emitters_and_cuts() {
    let (a, b) = (Emitters::new(soup(white)), Emitters::new(soup(white)));
    assert_eq!(a, b);
    assert_ne!(a, Emitters::new(soup(colored)));
    let mut used = LightCut::default();
    for (position, normal) in places(50) {
        b.cut_into(position, normal, &mut used);
        assert_eq!(a.cut(position, normal).open(), used.open());
    }
}

#[test]
#[ignore = "prints errors and times; run with --release --nocapture"]
#[allow(clippy::print_stdout, reason = "a timing is read by a person")]
fn time_cuts() {
    let mut scenes = scenes();
    let one = Polygon::parallelogram(
        glam::DVec3::new(-0.1, 0.9, -0.1),
        glam::DVec3::X * 0.2,
        glam::DVec3::Z * 0.2,
        Vec3::ONE,
    );
    scenes.push(("one quad", vec![one]));
    for (name, polygons) in scenes {
        let begin = std::time::Instant::now();
        let emitters = Emitters::new(polygons.clone());
        let build_ms = begin.elapsed().as_secs_f64() * 1e3;
        let places: Vec<_> = places(2000).collect();
        let mut cut = LightCut::default();
        let mut sum = 0.0;
        let begin = std::time::Instant::now();
        for &(position, normal) in &places {
            emitters.cut_into(position, normal, &mut cut);
            sum += cut.open().x;
        }
        let cut_ns = begin.elapsed().as_nanos() as f64 / places.len() as f64;
        // Neighbouring pixels of a floor, which find the tree in the caches.
        let begin = std::time::Instant::now();
        for index in 0..10_000 {
            let [x, z] = [index % 100, index / 100].map(|k| k as f32 * 0.01 - 0.5);
            emitters.cut_into(Vec3::new(x, -0.5, z), Vec3::Y, &mut cut);
            sum += cut.open().x;
        }
        let floor_ns = begin.elapsed().as_nanos() as f64 / 1e4;
        let (position, normal) = places[0];
        emitters.cut_into(position, normal, &mut cut);
        let begin = std::time::Instant::now();
        for index in 0..10_000 {
            let u = [0, 1].map(|d| uniform(3, index, d));
            sum += cut.sample(&emitters, u).map_or(0.0, |s| s.distance);
        }
        let sample_ns = begin.elapsed().as_nanos() as f64 / 1e4;
        let Errors {
            largest,
            typical,
            entries,
        } = errors(&polygons);
        println!(
            "{name}: build {build_ms:.2} ms, cut {cut_ns:.0} ns, \
             on a floor {floor_ns:.0} ns, sample {sample_ns:.0} ns, \
             {entries:.0} entries, error {typical:.5} RMS {largest:.5} max (sum {sum})"
        );
    }
}
