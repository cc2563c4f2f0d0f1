//! Closed forms, brute force and degenerate positions.

use glam::{DVec3, Vec3};

use super::Polygon;
use crate::maths::functions::{acos, cos, sin};
use crate::maths::hash::uniform;
use crate::maths::order::Order;

/// The brief's limit for closed forms; single-precision results of about 0.2
/// are rounded by 1e-8, the rest is headroom for the averages below.
const CLOSED_FORM: f64 = 1e-4;
/// Two form factors added in single precision, each within 1e-7.
const ADDITIVE: f32 = 1e-6;
/// Midpoint sums over 300 x 300 cells: (1/300)^2 times the second derivatives
/// of the integrand (below 20 here), and one cell's width at the horizon.
const QUADRATURE: f64 = 2e-4;
/// Relative rounding of a result in single precision.
const ROUNDED: f32 = 3e-7;

fn quad(corner: [f32; 3], u: [f32; 3], v: [f32; 3]) -> Polygon {
    let [corner, u, v] = [corner, u, v].map(|v| Vec3::from(v).as_dvec3());
    Polygon::parallelogram(corner, u, v, Vec3::ONE)
}

/// Unit square at y = 1 that faces down, over 0..1 in x and z.
fn ceiling() -> Polygon {
    quad([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
}

fn random_vector(index: u32, first: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|d| 2.0 * uniform(11, index, first + d) - 1.0))
}

/// Midpoint sum over the polygon, horizon and back side left out.
fn by_quadrature(polygon: &Polygon, position: Vec3, normal: Vec3) -> f64 {
    const CELLS: usize = 300;
    let ([a, b, _, d], count) = polygon.corners();
    let (u, v) = (b - a, d - a);
    let mut sum = 0.0;
    for i in 0..CELLS {
        for j in 0..CELLS {
            let [s, t] = [i, j].map(|k| (k as f64 + 0.5) / CELLS as f64);
            let inside = match count {
                3 => {
                    if s + t > 1.0 {
                        continue;
                    }
                    if i + j + 1 == CELLS { 0.5 } else { 1.0 }
                }
                _ => 1.0,
            };
            let to_point = a + u * s + v * t - position.as_dvec3();
            let squared = to_point.length_squared();
            let cosines = normal.as_dvec3().dot(to_point).at_least(0.0)
                * (-polygon.normal().dot(to_point)).at_least(0.0);
            sum += inside * cosines / (squared * squared);
        }
    }
    sum * u.cross(v).length() / ((CELLS * CELLS) as f64 * std::f64::consts::PI)
}

/// Form factor from a point at distance 1 below the corner of a parallel
/// rectangle a x b (Howell, "A Catalog of Radiation Heat Transfer
/// Configuration Factors", B-3).
fn parallel_corner(a: f64, b: f64) -> f64 {
    let atan = |x: f64| acos(1.0 / (1.0 + x * x).sqrt());
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * atan(b / ra) + b / rb * atan(a / rb)) / (2.0 * std::f64::consts::PI)
}

#[test]
fn parallel_squares_have_their_closed_form() {
    let from_corner = f64::from(ceiling().form_factor(Vec3::ZERO, Vec3::Y));
    let expected = parallel_corner(1.0, 1.0);
    assert!(
        (from_corner - expected).abs() < CLOSED_FORM,
        "{from_corner}"
    );
    let from_center = f64::from(ceiling().form_factor(Vec3::new(0.5, 0.0, 0.5), Vec3::Y));
    let expected = 4.0 * parallel_corner(0.5, 0.5);
    assert!((expected - 0.2395).abs() < CLOSED_FORM, "{expected}");
    assert!(
        (from_center - expected).abs() < CLOSED_FORM,
        "{from_center}"
    );
}

#[test]
fn a_rectangle_over_a_plane_has_its_closed_form() {
    let polygon = quad([-1.0, 0.5, -2.0], [3.0, 0.0, 0.0], [0.0, 0.0, 3.0]);
    let value = f64::from(polygon.form_factor(Vec3::ZERO, Vec3::Y));
    let expected: f64 = [(2.0, 4.0), (2.0, 2.0), (4.0, 4.0), (4.0, 2.0)]
        .iter()
        .map(|&(a, b)| parallel_corner(a, b))
        .sum();
    assert!((value - expected).abs() < CLOSED_FORM, "{value} {expected}");
}

#[test]
fn perpendicular_squares_exchange_a_fifth() {
    // Wall x = 0 that faces +x, over a floor that shares the edge x = 0, y = 0.
    let wall = quad([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    const CELLS: usize = 400;
    let mut sum = 0.0;
    for i in 0..CELLS {
        for j in 0..CELLS {
            let [x, z] = [i, j].map(|k| (k as f32 + 0.5) / CELLS as f32);
            sum += f64::from(wall.form_factor(Vec3::new(x, 0.0, z), Vec3::Y));
        }
    }
    let mean = sum / (CELLS * CELLS) as f64;
    assert!((mean - 0.200_044).abs() < CLOSED_FORM, "{mean}");
}

#[test]
fn any_polygon_agrees_with_quadrature() {
    let mut clipped = 0;
    for index in 0..120 {
        let corner = random_vector(index, 0);
        let (u, v) = (random_vector(index, 3), random_vector(index, 6));
        let normal = random_vector(index, 9).normalize();
        let triangle = Polygon::triangle([corner, corner + u, corner + v], Vec3::ONE);
        let polygon = if index % 2 == 0 {
            triangle
        } else {
            Polygon::parallelogram(corner.as_dvec3(), u.as_dvec3(), v.as_dvec3(), Vec3::ONE)
        };
        // From a point at distance at least 0.5 of the plane, on either side.
        let position = corner - u.cross(v).normalize() * (0.5 + uniform(11, index, 12));
        for position in [position, corner + (corner - position)] {
            let expected = by_quadrature(&polygon, position, normal);
            let value = f64::from(polygon.form_factor(position, normal));
            assert!(
                (value - expected).abs() < QUADRATURE,
                "{index}: {value} {expected}"
            );
            let (corners, count) = polygon.corners();
            let above = corners[..count]
                .iter()
                .filter(|&&c| (c - position.as_dvec3()).dot(normal.as_dvec3()) > 0.0)
                .count();
            clipped += usize::from(value > 0.0 && above != count);
        }
    }
    assert!(clipped > 20, "only {clipped} polygons cross the horizon");
}

#[test]
fn a_rectangle_equals_its_triangles_and_its_quarters() {
    for index in 0..200 {
        let [corner, u, v, position] = [0, 3, 6, 9].map(|d| random_vector(index, d));
        let normal = random_vector(index, 12).normalize();
        let whole =
            Polygon::parallelogram(corner.as_dvec3(), u.as_dvec3(), v.as_dvec3(), Vec3::ONE)
                .form_factor(position, normal);
        let triangles = Polygon::triangle([corner, corner + u, corner + u + v], Vec3::ONE)
            .form_factor(position, normal)
            + Polygon::triangle([corner, corner + u + v, corner + v], Vec3::ONE)
                .form_factor(position, normal);
        assert!((whole - triangles).abs() < ADDITIVE, "{whole} {triangles}");
        let (half_u, half_v) = (u.as_dvec3() * 0.5, v.as_dvec3() * 0.5);
        let quarters: f32 = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
            .iter()
            .map(|&(a, b)| {
                let corner = corner.as_dvec3() + half_u * a + half_v * b;
                Polygon::parallelogram(corner, half_u, half_v, Vec3::ONE)
                    .form_factor(position, normal)
            })
            .sum();
        assert!(
            (whole - quarters).abs() < 2.0 * ADDITIVE,
            "{whole} {quarters}"
        );
    }
}

#[test]
fn form_factors_do_not_depend_on_the_unit_of_length() {
    for index in 0..100 {
        let vectors = [0, 3, 6, 9].map(|d| random_vector(index, d));
        let normal = random_vector(index, 12).normalize();
        // A power of two, so that every coordinate scales exactly.
        let [small, large] = [1.0 / 4096.0, 4096.0].map(|scale| {
            let [corner, u, v, position] = vectors.map(|v| v * scale);
            Polygon::parallelogram(corner.as_dvec3(), u.as_dvec3(), v.as_dvec3(), Vec3::ONE)
                .form_factor(position, normal)
        });
        assert_eq!(small, large);
    }
}

#[test]
fn a_tiny_or_far_polygon_acts_like_a_point() {
    let normal = Vec3::new(0.1, 1.0, -0.2).normalize();
    // On both sides of the switch from Lambert's sum to the point.
    for size in [3e-3_f32, 1.1e-4, 0.9e-4, 1e-6] {
        let distance = 1e3 * size.at_least(1e-3);
        let ratio = size / distance;
        let polygon = quad([0.0, distance, 0.0], [size, 0.0, 0.0], [0.0, 0.0, size]);
        let to_centroid =
            DVec3::new(0.5, 0.0, 0.5) * f64::from(size) + DVec3::Y * f64::from(distance);
        let cosines = normal.as_dvec3().dot(to_centroid) * f64::from(distance);
        let expected = f64::from(size * size) * cosines
            / (std::f64::consts::PI * to_centroid.length_squared() * to_centroid.length_squared());
        let value = polygon.form_factor(Vec3::ZERO, normal);
        let error = (value / expected as f32 - 1.0).abs();
        assert!(error < ROUNDED + ratio * ratio, "{size}: {error}");
    }
}

#[test]
fn a_lamp_just_above_a_point_fills_its_sky() {
    for height in [1e-3_f32, 1e-4, 1e-5] {
        let lamp = quad([-0.5, height, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let value = lamp.form_factor(Vec3::ZERO, Vec3::Y);
        assert!(
            (1.0 - value).abs() < 10.0 * height * height + ROUNDED,
            "{height}: {value}"
        );
        // Half of the sky of a wall belongs to the lamp.
        let on_a_wall = lamp.form_factor(Vec3::ZERO, Vec3::X);
        assert!(
            (0.5 - on_a_wall).abs() < 2.0 * height,
            "{height}: {on_a_wall}"
        );
    }
}

#[test]
fn behind_or_below_is_exactly_nothing() {
    let lamp = ceiling();
    assert_eq!(lamp.form_factor(Vec3::new(0.5, 2.0, 0.5), Vec3::NEG_Y), 0.0);
    assert_eq!(lamp.form_factor(Vec3::new(0.5, 0.0, 0.5), Vec3::NEG_Y), 0.0);
    assert_eq!(
        lamp.form_factor(Vec3::new(-1.0, 0.0, 0.5), Vec3::NEG_X),
        0.0
    );
    let flat = Polygon::triangle([Vec3::ZERO, Vec3::X, Vec3::X * 2.0], Vec3::ONE);
    assert_eq!(flat.form_factor(Vec3::Y, Vec3::NEG_Y), 0.0);
}

#[test]
fn degenerate_positions_give_finite_shares() {
    let lamp = ceiling();
    let triangle = Polygon::triangle([Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::ONE], Vec3::ONE);
    // Corner, edge, inside, on the plane outside, and all of these shifted.
    let places = [
        [0.0, 0.0],
        [1.0, 1.0],
        [0.5, 0.0],
        [0.5, 0.5],
        [0.3, 0.3],
        [2.0, 0.5],
    ];
    for [x, z] in places {
        for shift in [0.0, 1e-7, -1e-7, 1e-5, -1e-5, 1e-3, 1e3, -1e3] {
            let position = Vec3::new(x, 1.0 + shift, z);
            for normal in 0..64 {
                let normal = random_vector(normal, 0).normalize();
                for polygon in [&lamp, &triangle] {
                    let value = polygon.form_factor(position, normal);
                    assert!((0.0..=1.0).contains(&value), "{position} {normal}: {value}");
                    assert!(shift != 0.0 || value == 0.0, "on the plane: {value}");
                }
            }
        }
    }
}

#[test]
fn samples_are_uniform_over_the_area() {
    /// Midpoints of 64 x 64 strata: their mean is exact to 1/64^2.
    const MEAN: f64 = 5e-4;
    let triangle = Polygon::triangle([Vec3::ZERO, Vec3::X * 2.0, Vec3::ONE], Vec3::ONE);
    for polygon in [ceiling(), triangle] {
        let (mut mean, mut second) = (DVec3::ZERO, 0.0);
        for i in 0..64 * 64 {
            let u = [i % 64, i / 64].map(|k| (k as f32 + 0.5) / 64.0);
            let point = polygon.sample(u).as_dvec3();
            assert!((point - polygon.centroid()).dot(polygon.normal()).abs() < 1e-6);
            mean += point / 4096.0;
            let x = point.x - polygon.centroid().x;
            second += x * x / 4096.0;
        }
        assert!((mean - polygon.centroid()).length() < MEAN, "{mean}");
        // Variance of x: 1/12 for the square, (4 + 1 - 2)/18 for the triangle.
        let expected = if polygon.corners().1 == 4 {
            1.0 / 12.0
        } else {
            3.0 / 18.0
        };
        assert!((second - expected).abs() < MEAN, "{second}");
    }
}

#[test]
#[ignore = "prints times; run with --release --nocapture"]
#[allow(clippy::print_stdout, reason = "a timing is read by a person")]
fn time_form_factors() {
    const CALLS: u32 = 1_000_000;
    let triangle = Polygon::triangle([Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::ONE], Vec3::ONE);
    for (name, polygon) in [("quad", ceiling()), ("triangle", triangle)] {
        for (place, tilt) in [("above the horizon", 0.0), ("clipped", 1.2)] {
            let normal = Vec3::new(sin(tilt) as f32, cos(tilt) as f32, 0.0);
            let begin = std::time::Instant::now();
            let mut sum = 0.0;
            for i in 0..CALLS {
                sum += polygon.form_factor(Vec3::new(i as f32 * 1e-6, 0.0, 0.5), normal);
            }
            let ns = begin.elapsed().as_nanos() as f64 / f64::from(CALLS);
            println!("{name}, {place}: {ns:.1} ns (sum {sum})");
        }
    }
}
