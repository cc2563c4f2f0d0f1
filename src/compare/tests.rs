//! How limits, masks, alpha and what is not finite combine.

use glam::Vec3;

use super::*;
use crate::frame::Image;
use crate::scene::{GoldenKeys, PixelLimit};

const SIZE: [u32; 2] = [12, 10];

/// Grey levels by number of pixel.
fn levels(level: impl Fn(usize) -> f32) -> ComparedImage {
    ComparedImage::new(LoadedImage::Levels(grey(level)))
}

fn linear(value: impl Fn(usize) -> f32) -> ComparedImage {
    ComparedImage::of_linear(grey(value))
}

fn grey(value: impl Fn(usize) -> f32) -> Image {
    let count = (SIZE[0] * SIZE[1]) as usize;
    let pixels = (0..count).map(|index| Vec3::splat(value(index)));
    Image::new(SIZE[0], SIZE[1], pixels.collect()).unwrap()
}

/// The first pixels are off by 5, 3 and 1.
fn pair() -> (ComparedImage, ComparedImage) {
    let apart = |index: usize| [5.0, 3.0, 1.0].get(index).copied().unwrap_or(0.0);
    (levels(|_| 100.0), levels(|index| 100.0 + apart(index)))
}

fn mask(level: impl Fn(usize) -> f32) -> Mask {
    Mask::of_image(&LoadedImage::Levels(grey(level))).unwrap()
}

fn limits(channel: Option<f64>, pixels: Option<u32>, flip: Option<f64>) -> Limits {
    Limits {
        max_channel_difference: channel,
        max_differing_pixels: pixels.map(PixelLimit::Count),
        max_flip: flip,
    }
}

fn measured(
    (reference, candidate): &(ComparedImage, ComparedImage),
    limits: &Limits,
    mask: Option<&Mask>,
) -> Measured {
    match judge(reference, candidate, limits, mask).unwrap() {
        Judgement::Measured(measured) => *measured,
        Judgement::OfOtherSize(mismatch) => panic!("{mismatch}"),
    }
}

#[test]
fn limits_combine_as_they_say() {
    let pair = pair();
    let mean = measured(&pair, &Limits::default(), None).figures.flip_mean;
    assert!(mean > 0.0);
    for (limits, failing) in [
        (limits(None, None, None), vec!["max_channel_difference"]),
        (limits(Some(5.0), None, None), vec![]),
        (
            limits(Some(4.9), None, None),
            vec!["max_channel_difference"],
        ),
        (limits(None, Some(3), None), vec![]),
        (limits(None, Some(2), None), vec!["max_differing_pixels"]),
        (limits(Some(1.0), Some(2), None), vec![]),
        (
            limits(Some(1.0), Some(1), None),
            vec!["max_differing_pixels"],
        ),
        (limits(None, None, Some(mean)), vec![]),
        (limits(None, None, Some(0.9 * mean)), vec!["max_flip"]),
        (limits(Some(5.0), None, Some(0.0)), vec!["max_flip"]),
        (
            limits(Some(0.0), None, Some(1.0)),
            vec!["max_channel_difference"],
        ),
        (
            limits(None, Some(1), Some(0.0)),
            vec!["max_differing_pixels", "max_flip"],
        ),
    ] {
        let failures = measured(&pair, &limits, None).failures;
        let failed: Vec<&str> = failures.iter().map(Failure::limit).collect();
        assert_eq!(failed, failing, "{limits:?}");
    }
    let share = |share| Limits {
        max_differing_pixels: Some(PixelLimit::Share(share)),
        ..Limits::default()
    };
    assert!(measured(&pair, &share(0.025), None).failures.is_empty());
    assert!(!measured(&pair, &share(0.024), None).failures.is_empty());
}

#[test]
fn a_key_that_is_zero_is_a_limit() {
    assert_eq!(Limits::of_keys(&GoldenKeys::default()), Limits::default());
    let keys = GoldenKeys {
        max_channel_difference: Some(0.0),
        max_flip: Some(0.9),
        ..GoldenKeys::default()
    };
    let limits = Limits::of_keys(&keys);
    assert_eq!(limits.max_channel_difference, Some(0.0));
    assert_eq!(limits.max_differing_pixels, None);
    let judged = measured(&pair(), &limits, None);
    let failed: Vec<&str> = judged.failures.iter().map(Failure::limit).collect();
    assert_eq!(failed, ["max_channel_difference"], "FLIP alone would pass");
}

#[test]
fn the_smallest_limits_that_pass_are_exact() {
    let pair = pair();
    let found = measured(&pair, &limits(Some(1.0), None, None), None).passing;
    assert_eq!(found.max_channel_difference, Some(5.0));
    assert_eq!(found.max_differing_pixels, 3);
    assert_eq!(found.max_differing_pixels_beside, Some((1.0, 2)));
    let options = found.options();
    assert_eq!(options[0], "--max-channel-difference 5");
    assert_eq!(
        options[2],
        "--max-channel-difference 1 --max-differing-pixels 2"
    );
    assert_eq!(found.keys()[1], "max_differing_pixels = 3");
}

#[test]
fn a_mask_allows_as_many_levels_as_it_is_bright() {
    let pair = pair();
    let none = Limits::default();
    let three = measured(&pair, &none, Some(&mask(|_| 3.0)));
    assert_eq!(three.failures.len(), 1);
    assert_eq!(three.passing.max_channel_difference, Some(5.0));
    assert_eq!(three.passing.max_differing_pixels, 1);
    assert_eq!(
        three.figures.differing_pixels, 3,
        "figures are of what is there"
    );
    let five = measured(&pair, &none, Some(&mask(|_| 5.0)));
    assert!(five.failures.is_empty());
    assert_eq!(
        five.figures.flip_mean, 0.0,
        "FLIP is of what is not allowed"
    );
    // Beside linear values, a level is 1/255.
    let pair = (linear(|_| 0.5), linear(|_| 0.5 + 2.0 / 255.0));
    assert!(measured(&pair, &none, Some(&mask(|_| 1.9))).failures.len() == 1);
    assert!(
        measured(&pair, &none, Some(&mask(|_| 2.1)))
            .failures
            .is_empty()
    );
}

#[test]
fn an_ignored_pixel_counts_for_nothing() {
    let white = mask(|index| if index < 2 { 255.0 } else { 0.0 });
    let strange = (
        levels(|index| [100.0, 100.0, 80.0][index.min(2)]),
        levels(|index| [250.0, 0.0, 80.0][index.min(2)]),
    );
    let found = measured(&strange, &Limits::default(), Some(&white));
    assert!(found.failures.is_empty());
    let figures = found.figures;
    assert_eq!(figures.ignored_pixels, 2);
    assert_eq!(figures.differing_pixels, 0);
    for zero in [
        figures.max_channel_difference,
        figures.rmse,
        figures.relative_rmse,
        figures.relative_rmse_8x8,
        figures.bias,
        figures.flip_max,
    ] {
        assert_eq!(zero, 0.0);
    }
    let nan = |index: usize| if index == 0 { f32::NAN } else { 0.5 };
    let found = measured(
        &(linear(nan), linear(nan)),
        &Limits::default(),
        Some(&white),
    );
    assert!(found.failures.is_empty());
    assert_eq!(found.figures.non_finite_pixels, 0);
    assert_eq!(found.figures.flip_max, 0.0);
    // RMSE is of the pixels that count.
    let all_but_one = mask(|index| if index == 0 { 0.0 } else { 255.0 });
    let found = measured(&pair(), &Limits::default(), Some(&all_but_one));
    assert!((found.figures.rmse - 5.0).abs() < 1e-12);
    assert_eq!(found.figures.differing_share(), 1.0);
}

#[test]
fn what_is_not_finite_passes_only_as_a_differing_pixel() {
    let nan = |index: usize| if index == 7 { f32::NAN } else { 0.5 };
    let pair = (linear(nan), linear(nan));
    for (limits, failing) in [
        (limits(None, None, None), Some("max_channel_difference")),
        (
            limits(Some(f64::INFINITY), None, None),
            Some("max_channel_difference"),
        ),
        (limits(None, None, Some(1.0)), Some("non_finite_pixels")),
        (limits(None, Some(1), None), None),
    ] {
        let found = measured(&pair, &limits, Some(&mask(|_| 254.0)));
        let failed = found.failures.first().map(Failure::limit);
        assert_eq!(failed, failing, "{limits:?}");
        assert_eq!(found.passing.max_channel_difference, None);
        assert_eq!(found.passing.max_flip, None);
    }
}

#[test]
fn alpha_counts_where_either_image_has_it() {
    let with_alpha = |alpha: f32| levels(|_| 9.0).with_alpha(vec![alpha; 120]).unwrap();
    let none = Limits::default();
    let opaque = measured(&(levels(|_| 9.0), with_alpha(255.0)), &none, None);
    assert!(opaque.failures.is_empty());
    assert_eq!(opaque.figures.max_alpha_difference, Some(0.0));
    let pair = (with_alpha(250.0), levels(|_| 9.0));
    let seen_through = measured(&pair, &none, None);
    assert_eq!(seen_through.figures.max_channel_difference, 5.0);
    assert_eq!(seen_through.figures.max_alpha_difference, Some(5.0));
    assert_eq!(seen_through.figures.differing_pixels, 120);
    assert_eq!(seen_through.passing.max_flip, None);
    let by_flip = measured(&pair, &limits(None, None, Some(1.0)), None);
    assert_eq!(by_flip.failures, [Failure::Alpha { pixels: 120 }]);
    assert!(
        measured(&pair, &limits(Some(5.0), None, None), None)
            .failures
            .is_empty()
    );
    assert!(levels(|_| 9.0).with_alpha(vec![255.0; 3]).is_err());
}

#[test]
fn what_does_not_go_together_is_said() {
    let (reference, candidate) = pair();
    let none = Limits::default();
    let kinds = judge(&reference, &linear(|_| 0.5), &none, None);
    assert_eq!(kinds, Err(JudgeError::Kinds));
    let white = judge(&reference, &candidate, &none, Some(&mask(|_| 255.0)));
    assert_eq!(white, Err(JudgeError::NothingLeft));
    let small = LoadedImage::Levels(Image::filled(2, 2, Vec3::ZERO).unwrap());
    let of_other_size = Mask::of_image(&small).unwrap();
    let found = judge(&reference, &candidate, &none, Some(&of_other_size));
    assert!(matches!(found, Err(JudgeError::MaskSize { .. })));
    let judgement = judge(&reference, &ComparedImage::new(small), &none, None).unwrap();
    assert!(!judgement.passes() && judgement.measured().is_none());
    assert!(judgement.failures()[0].contains("12 x 10"));
    let coloured = LoadedImage::Levels(grey(|_| 3.0).map(|rgb| rgb + Vec3::X));
    assert_eq!(
        Mask::of_image(&coloured),
        Err(MaskError::Coloured { x: 0, y: 0 })
    );
    let linear = LoadedImage::Linear(grey(|_| 1.0));
    assert_eq!(Mask::of_image(&linear), Err(MaskError::Linear));
}

#[test]
fn a_strip_shows_every_difference() {
    let (reference, candidate) = pair();
    let white = mask(|index| if index == 1 { 255.0 } else { 0.0 });
    let picture = strip(&reference, &candidate, Some(&white));
    assert_eq!([picture.width(), picture.height()], [3 * 12 + 8, 10]);
    let level = |x: usize| picture.bytes()[3 * x];
    let difference = 12 + 4;
    assert_eq!((level(0), level(2 * 12 + 8)), (100, 105));
    assert_eq!(level(difference), 255, "the largest is white");
    assert!(level(difference + 2) > 56, "one level is seen");
    assert_eq!(level(difference + 1), 40, "what is ignored has its colour");
    assert_eq!(level(difference + 3), 0);
    // Too small to be shown, and still seen; and what is not finite.
    let value = |index: usize| match index {
        0 => 0.5 + 1e-6,
        1 => f32::INFINITY,
        _ => 0.5,
    };
    let picture = strip(&linear(|_| 0.5), &linear(value), None);
    assert_eq!(picture.bytes()[3 * difference..3 * difference + 3], [56; 3]);
    let strange = 3 * (difference + 1);
    assert_eq!(picture.bytes()[strange..strange + 3], [255, 0, 255]);
}
