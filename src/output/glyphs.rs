//! The few letters of a legend, as lines.

use crate::maths::order::Order;
use tiny_skia::{Path, PathBuilder};

/// Strokes of a letter, each from point to point, on a grid of 4 x 6: x to the
/// right, y down.
type Strokes = &'static [&'static [[u8; 2]]];

/// Distance from letter to letter, grid units.
const ADVANCE: f32 = 6.0;

/// What of a letter is drawn; nothing for one that is not known.
fn strokes(letter: char) -> Strokes {
    match letter {
        '0' => &[&[[0, 0], [4, 0], [4, 6], [0, 6], [0, 0]]],
        '1' => &[&[[1, 1], [2, 0], [2, 6]], &[[1, 6], [3, 6]]],
        '2' => &[&[[0, 0], [4, 0], [4, 3], [0, 3], [0, 6], [4, 6]]],
        '3' => &[&[[0, 0], [4, 0], [4, 6], [0, 6]], &[[1, 3], [4, 3]]],
        '4' => &[&[[0, 0], [0, 3], [4, 3]], &[[4, 0], [4, 6]]],
        '5' => &[&[[4, 0], [0, 0], [0, 3], [4, 3], [4, 6], [0, 6]]],
        '6' => &[&[[4, 0], [0, 0], [0, 6], [4, 6], [4, 3], [0, 3]]],
        '7' => &[&[[0, 0], [4, 0], [4, 1], [2, 6]]],
        '8' => &[&[[0, 0], [4, 0], [4, 6], [0, 6], [0, 0]], &[[0, 3], [4, 3]]],
        '9' => &[&[[4, 3], [0, 3], [0, 0], [4, 0], [4, 6], [0, 6]]],
        '.' => &[&[[2, 6], [2, 5]]],
        'F' => &[&[[4, 0], [0, 0], [0, 6]], &[[0, 3], [3, 3]]],
        'L' => &[&[[0, 0], [0, 6], [4, 6]]],
        'I' => &[&[[2, 0], [2, 6]], &[[1, 0], [3, 0]], &[[1, 6], [3, 6]]],
        'P' => &[&[[0, 6], [0, 0], [4, 0], [4, 3], [0, 3]]],
        _ => &[],
    }
}

/// Width of a text, pixels, where a grid unit is `unit` pixels wide.
pub(super) fn width(text: &str, unit: f32) -> f32 {
    let gap = ADVANCE - 4.0;
    (text.chars().count() as f32 * ADVANCE - gap).at_least(0.0) * unit
}

/// The lines of a text from its upper left corner; `None` for one without any.
pub(super) fn lines(text: &str, left: f32, top: f32, unit: f32) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, letter) in text.chars().enumerate() {
        let start = left + index as f32 * ADVANCE * unit;
        let place = |[x, y]: [u8; 2]| (start + f32::from(x) * unit, top + f32::from(y) * unit);
        for stroke in strokes(letter) {
            for (index, &point) in stroke.iter().enumerate() {
                let (x, y) = place(point);
                if index == 0 {
                    path.move_to(x, y);
                } else {
                    path.line_to(x, y);
                }
            }
        }
    }
    path.finish()
}
