//! Colour spaces of FLIP: the opponent space in which the eye's contrast
//! sensitivity is known, and CIELAB with Hunt's correction, in which colours
//! are told apart.
//!
//! All are relative to the white of the display: `white_relative` colours are
//! X/Xn, Y/Yn, Z/Zn, which are 1, 1, 1 for white.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use crate::maths::functions::cbrt;

/// Chromaticities x, y of the primaries of Rec.709 and of its white, D65.
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
const WHITE: [f64; 2] = [0.3127, 0.3290];

/// Linear Rec.709 RGB to white-relative XYZ, and back.
struct Matrices {
    white_relative_from_rgb: DMat3,
    rgb_from_white_relative: DMat3,
}

static MATRICES: LazyLock<Matrices> = LazyLock::new(|| {
    let [red, green, blue] = PRIMARIES.map(xyz_of_unit_luminance);
    let white = xyz_of_unit_luminance(WHITE);
    let primaries = DMat3::from_cols(red, green, blue);
    let luminances = primaries.inverse() * white;
    let xyz_from_rgb = primaries * DMat3::from_diagonal(luminances);
    let white_relative_from_rgb = DMat3::from_diagonal(white.recip()) * xyz_from_rgb;
    Matrices {
        white_relative_from_rgb,
        rgb_from_white_relative: white_relative_from_rgb.inverse(),
    }
});

fn xyz_of_unit_luminance([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

/// YCxCz of a linear RGB colour, without its factors 116, 500 and 200 and its
/// offset -16: luminance, red-green and blue-yellow. The filters have unit
/// sums, so factors and offset commute with them and are left away; the
/// luminance is then what the feature filters want, 0 to 1.
pub(super) fn opponent_from_rgb(rgb: DVec3) -> DVec3 {
    let xyz = MATRICES.white_relative_from_rgb * rgb;
    DVec3::new(xyz.y, xyz.x - xyz.y, xyz.y - xyz.z)
}

/// Inverse of [`opponent_from_rgb`].
pub(super) fn rgb_from_opponent(opponent: DVec3) -> DVec3 {
    let y = opponent.x;
    MATRICES.rgb_from_white_relative * DVec3::new(opponent.y + y, y, y - opponent.z)
}

/// CIELAB of a linear RGB colour with Hunt's correction: a colour is the more
/// vivid the lighter it is, so a* and b* are multiplied by L*/100.
pub(super) fn hunt_lab_from_rgb(rgb: DVec3) -> DVec3 {
    let xyz = MATRICES.white_relative_from_rgb * rgb;
    let [x, y, z] = xyz.to_array().map(lightness_curve);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    DVec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z))
}

/// The curve of CIELAB: a cube root with a straight line near black.
fn lightness_curve(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA {
        cbrt(t)
    } else {
        t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
    }
}

/// HyAB distance of two colours, made for large differences: city block in
/// lightness, Euclidean in the other two (Abasi, Amani Tehran, Fairchild 2020).
pub(super) fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a few dozen double operations on values up to 100.
    const ROUNDING: f64 = 1e-11;

    #[test]
    fn white_is_white_and_luminances_are_rec_709() {
        assert!((opponent_from_rgb(DVec3::ONE) - DVec3::X).length() < ROUNDING);
        let lab = hunt_lab_from_rgb(DVec3::ONE);
        assert!((lab - DVec3::new(100.0, 0.0, 0.0)).length() < ROUNDING);
        for (primary, expected) in [(DVec3::X, 0.2126), (DVec3::Y, 0.7152), (DVec3::Z, 0.0722)] {
            // Rec.709 gives four digits.
            assert!((opponent_from_rgb(primary).x - expected).abs() < 5.1e-5);
        }
    }

    #[test]
    fn opponent_colours_go_there_and_back() {
        for rgb in [DVec3::ZERO, DVec3::new(0.1, 0.9, 0.3), DVec3::X] {
            let back = rgb_from_opponent(opponent_from_rgb(rgb));
            assert!((back - rgb).length() < ROUNDING, "{rgb} becomes {back}");
        }
    }

    #[test]
    fn red_is_where_the_tables_of_cielab_have_it() {
        // L* a* b* of sRGB red: 53.24, 80.09, 67.20; four digits are published.
        let lab = hunt_lab_from_rgb(DVec3::X);
        let expected = DVec3::new(53.24, 80.09 * 0.5324, 67.20 * 0.5324);
        assert!((lab - expected).abs().max_element() < 0.02, "{lab}");
    }
}
