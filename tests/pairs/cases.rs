//! The pairs, made by integer formulas.

use glam::Vec3;
use relume::Image;

use super::files::{Side, exr, grey, no_image, palette, rgb, rgb16, rgba};
use super::formulas::{SIZE, levels, noise, of_size, radiance};

/// Two files and what `relume diff` has to say of them.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) reference: Side,
    pub(super) candidate: Side,
    /// A mask, as a grey PNG.
    pub(super) mask: Option<Side>,
    /// Without limits.
    pub(super) exit_code: i32,
}

/// All pairs.
pub(super) fn all() -> Vec<Case> {
    let mut cases = of_levels();
    cases.extend(of_depths());
    cases.extend(of_linear_values());
    cases.extend(of_broken_files());
    cases
}

fn case(name: &'static str, reference: Side, candidate: Side, exit_code: i32) -> Case {
    Case {
        name,
        reference,
        candidate,
        mask: None,
        exit_code,
    }
}

fn picture() -> Image {
    of_size(SIZE, levels)
}

/// Levels off by up to 20 either way.
fn noisy() -> Image {
    of_size(SIZE, |x, y| {
        (levels(x, y) + noise(x, y, 20)).clamp(Vec3::ZERO, Vec3::splat(255.0))
    })
}

fn of_levels() -> Vec<Case> {
    let picture = picture();
    let one_pixel = of_size(SIZE, |x, y| match (x, y) {
        (40, 30) => Vec3::splat(255.0) - levels(x, y),
        _ => levels(x, y),
    });
    let one_level = of_size(SIZE, |x, y| levels(x, y) + Vec3::Y);
    let shifted = of_size(SIZE, |x, y| levels(x.saturating_sub(1), y));
    let smaller = of_size([SIZE[0] - 1, SIZE[1]], levels);
    // White ignores, 8 levels are allowed in the middle, none on the right.
    let mask = of_size(SIZE, |x, _| {
        Vec3::splat(match x {
            0..32 => 255.0,
            32..64 => 8.0,
            _ => 0.0,
        })
    });
    let masked = Case {
        mask: Some(grey(&mask)),
        ..case("masked with grey", rgb(&picture), rgb(&noisy()), 1)
    };
    vec![
        case("identical", rgb(&picture), rgb(&picture), 0),
        case("one pixel", rgb(&picture), rgb(&one_pixel), 1),
        case("one level", rgb(&picture), rgb(&one_level), 1),
        case("shifted by a pixel", rgb(&picture), rgb(&shifted), 1),
        case("noise", rgb(&picture), rgb(&noisy()), 1),
        masked,
        case("other size", rgb(&picture), rgb(&smaller), 1),
    ]
}

/// Files of other sorts than 8-bit RGB.
fn of_depths() -> Vec<Case> {
    let (picture, noisy) = (picture(), noisy());
    let finer = of_size(SIZE, |x, y| {
        (levels(x, y) + noise(x, y, 257) / 257.0).max(Vec3::ZERO)
    });
    let grey_as_rgb = picture.map(|rgb| Vec3::splat(rgb.x));
    let fading = |index: usize| (255 - index % 7) as u8;
    vec![
        case("16-bit", rgb16(&picture), rgb16(&finer), 1),
        case("16-bit beside 8-bit", rgb(&picture), rgb16(&picture), 0),
        case("greyscale", grey(&picture), grey(&noisy), 1),
        case("greyscale beside RGB", grey(&picture), rgb(&grey_as_rgb), 0),
        case("palette", palette(&picture), palette(&noisy), 1),
        case("alpha", rgba(&picture, |_| 255), rgba(&picture, fading), 1),
        case("alpha on one side", rgb(&picture), rgba(&noisy, fading), 1),
        case("opaque alpha", rgb(&picture), rgba(&picture, |_| 255), 0),
    ]
}

fn of_linear_values() -> Vec<Case> {
    let bright = of_size(SIZE, radiance);
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
    let mut broken = bright.clone();
    broken.pixels_mut()[1234].y = f32::NAN;
    broken.pixels_mut()[2345].x = f32::INFINITY;
    vec![
        case("NaN", exr(&bright), exr(&broken), 1),
        case("NaN on both sides", exr(&broken), exr(&broken), 1),
        case("HDR noise", exr(&bright), exr(&noisy(&bright)), 1),
        case(
            "HDR with black median",
            exr(&mostly_black),
            exr(&noisy(&mostly_black)),
            1,
        ),
    ]
}

fn of_broken_files() -> Vec<Case> {
    let whole = rgb(&picture());
    let half = whole.bytes[..whole.bytes.len() / 2].to_vec();
    let linear = exr(&of_size(SIZE, radiance));
    vec![
        case("truncated file", whole.clone(), no_image(half), 3),
        case("no image", whole.clone(), no_image(b"a letter".to_vec()), 3),
        case("empty file", whole.clone(), no_image(Vec::new()), 3),
        case(
            "EXR with a PNG's name",
            whole.clone(),
            no_image(linear.bytes.clone()),
            3,
        ),
        case("EXR beside PNG", whole, linear, 2),
    ]
}
