//! Properties of whole maps; agreement with the authors' package is in
//! `tests/flip.rs`.

use glam::{Vec3, Vec3Swizzles};

use super::*;

/// Some bands high and wider than the filters.
const SIZE: [u32; 2] = [50, 80];
/// How far the filters reach at [`PIXELS_PER_DEGREE`].
const RADIUS: u32 = 10;

fn of_size([width, height]: [u32; 2], pixel: impl Fn(u32, u32) -> Vec3) -> Image {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| pixel(x, y)).collect();
    Image::new(width, height, pixels).unwrap()
}

/// Levels with ramps and steps in all channels.
fn picture() -> Image {
    of_size(SIZE, |x, y| {
        let channel = |factor: u32| ((factor * x + 2 * y + 50 * (x / 9 % 2)) % 256) as f32;
        Vec3::new(channel(1), channel(3), channel(5))
    })
}

fn with_pixel(image: &Image, x: u32, y: u32, value: Vec3) -> Image {
    let mut changed = image.clone();
    changed.pixels_mut()[(y * image.width() + x) as usize] = value;
    changed
}

fn grey(value: f32) -> Image {
    Image::filled(SIZE[0], SIZE[1], Vec3::splat(value)).unwrap()
}

fn ldr(reference: &Image, candidate: &Image) -> FlipMap {
    flip(reference, candidate, PIXELS_PER_DEGREE).unwrap()
}

fn hdr(reference: &Image, candidate: &Image) -> FlipMap {
    hdr_flip(reference, candidate, PIXELS_PER_DEGREE)
        .unwrap()
        .map
}

#[test]
fn the_usual_observer_has_67_pixels_a_degree() {
    assert!((PIXELS_PER_DEGREE - 67.0206).abs() < 1e-4);
}

#[test]
fn equal_images_have_no_error_at_all() {
    let image = picture();
    for map in [ldr(&image, &image), hdr(&image, &image)] {
        assert_eq!((map.width(), map.height()), (SIZE[0], SIZE[1]));
        assert_eq!(map.values().len(), image.pixels().len());
        assert!(map.values().iter().all(|&error| error == 0.0));
    }
}

/// In one band with the changed pixel nothing is skipped, so this is also that
/// equal surroundings are filtered to exactly 0.
#[test]
fn an_error_reaches_as_far_as_the_filters_and_no_farther() {
    let image = picture();
    let changed = with_pixel(&image, 25, 40, Vec3::new(0.0, 255.0, 0.0));
    for map in [ldr(&image, &changed), hdr(&image, &changed)] {
        for (index, &error) in map.values().iter().enumerate() {
            let (x, y) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
            let distance = x.abs_diff(25).max(y.abs_diff(40));
            assert!(distance <= RADIUS || error == 0.0, "{x}, {y}: {error}");
            assert!(distance > 2 || error > 0.0, "{x}, {y}: {error}");
        }
        assert!((0.01..1.0).contains(&map.max()), "{}", map.max());
    }
}

#[test]
fn black_and_white_are_nearly_as_far_as_colours_go() {
    for map in [
        ldr(&grey(0.0), &grey(255.0)),
        ldr(&grey(255.0), &grey(0.0)),
        hdr(&grey(1.0), &grey(0.0)),
    ] {
        assert!(map.mean() > 0.9 && map.max() <= 1.0, "{}", map.mean());
    }
}

#[test]
fn threads_change_no_bit() {
    let (image, other) = (picture(), picture().map(|value| value * 0.9 + Vec3::ONE));
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| (ldr(&image, &other), hdr(&image, &other)))
    };
    assert_eq!(with_threads(1), with_threads(3));
}

/// Bands meet here at row 32; a picture that is the same from top to bottom has
/// the same errors in every row.
#[test]
fn bands_leave_no_seams() {
    let columns = of_size(SIZE, |x, _| Vec3::splat((5 * x) as f32));
    let other = columns.map(|value| value.yxz() * Vec3::new(0.9, 1.0, 0.8));
    for map in [ldr(&columns, &other), hdr(&columns, &other)] {
        let first = &map.values()[..SIZE[0] as usize];
        for row in map.values().chunks_exact(SIZE[0] as usize) {
            assert_eq!(row, first);
        }
    }
}

#[test]
fn what_is_not_finite_is_wrong_as_far_as_filters_spread_it() {
    let image = picture();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let strange = with_pixel(&image, 3, 35, Vec3::new(0.5, value, 0.5));
        for (reference, candidate) in [(&strange, &strange), (&image, &strange), (&strange, &image)]
        {
            for map in [ldr(reference, candidate), hdr(reference, candidate)] {
                for (index, &error) in map.values().iter().enumerate() {
                    let (x, y) = (index as u32 % SIZE[0], index as u32 / SIZE[0]);
                    let is_near = x.abs_diff(3).max(y.abs_diff(35)) <= RADIUS;
                    assert_eq!(error, f32::from(u8::from(is_near)), "{x}, {y}");
                }
            }
        }
    }
}

#[test]
fn black_references_have_an_answer() {
    let (black, dim) = (grey(0.0), grey(1e-3));
    assert_eq!(hdr(&black, &black).max(), 0.0);
    let map = hdr(&black, &dim);
    assert!(map.mean() > 0.9 && map.max() <= 1.0, "{}", map.mean());
    // What is below the darkest luminance by as much again is not light.
    assert!(hdr(&black, &grey(1e-14)).max() < 0.01);
    // Most of the picture is black, and a lamp is not.
    let lamp = with_pixel(&black, 20, 20, Vec3::splat(1e4));
    let found = hdr_flip(&lamp, &black, PIXELS_PER_DEGREE).unwrap();
    assert!(found.map.values()[0] == 0.0 && found.map.max() > 0.1);
    assert!(found.start_exposure < found.stop_exposure);
    assert!(found.exposure_count > 20, "{}", found.exposure_count);
}

/// The reference chooses the exposures and is shown as 0.85 in them, so a
/// candidate that is too bright by any factor is off by at most 0.15.
#[test]
fn the_largest_and_the_smallest_numbers_are_judged() {
    for (a, b) in [(f32::MAX, 1.0), (1.0, f32::MAX), (f32::MIN_POSITIVE, 1.0)] {
        let map = hdr(&grey(a), &grey(b));
        let mut errors = map.values().iter();
        assert!(errors.all(|error| (0.1..=1.0).contains(error)), "{a}, {b}");
    }
}

#[test]
fn negative_light_is_none() {
    let (light, dark) = (grey(1.0), grey(0.0));
    let less = grey(-5.0);
    assert_eq!(hdr(&light, &less), hdr(&light, &dark));
    assert_eq!(hdr(&dark, &less).max(), 0.0);
}

#[test]
fn strange_pixel_sizes_count_as_the_nearest_that_is_not() {
    let (image, other) = (grey(10.0), grey(30.0));
    let small = |image: &Image| of_size([3, 2], |x, y| image.pixel(x, y).unwrap());
    let (image, other) = (small(&image), small(&other));
    let at = |pixels_per_degree| flip(&image, &other, pixels_per_degree).unwrap();
    for strange in [f64::NAN, 0.0, -3.0, f64::NEG_INFINITY] {
        assert_eq!(at(strange), at(1.0));
    }
    assert_eq!(at(f64::INFINITY), at(1000.0));
    assert!(at(1000.0).max() > 0.0);
}

#[test]
fn one_pixel_is_an_image() {
    let of = |value| Image::filled(1, 1, Vec3::splat(value)).unwrap();
    assert!(ldr(&of(0.0), &of(255.0)).max() > 0.9);
    assert!(hdr(&of(1.0), &of(2.0)).max() > 0.1);
}

#[test]
fn sizes_must_agree() {
    let (tall, wide) = (
        of_size([2, 3], |_, _| Vec3::ONE),
        of_size([3, 2], |_, _| Vec3::ONE),
    );
    let error = flip(&tall, &wide, PIXELS_PER_DEGREE).unwrap_err();
    assert_eq!((error.reference, error.candidate), ([2, 3], [3, 2]));
    assert!(hdr_flip(&tall, &wide, PIXELS_PER_DEGREE).is_err());
}

#[test]
fn numbers_of_a_map_have_their_closed_forms() {
    let map = FlipMap {
        width: 5,
        height: 1,
        values: vec![0.5, 0.0, 1.0, 0.25, 0.75],
    };
    assert_eq!(map.mean(), 0.5);
    assert_eq!(map.max(), 1.0);
    for (percent, error) in [
        (-1.0, 0.0),
        (0.0, 0.0),
        (50.0, 0.5),
        (75.0, 0.75),
        (87.5, 0.875),
        (100.0, 1.0),
        (200.0, 1.0),
    ] {
        assert_eq!(map.percentile(percent), error, "{percent}");
    }
}
