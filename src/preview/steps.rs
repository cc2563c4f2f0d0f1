//! Steps that follow the size of a scene, and coordinates that are short to write.

use glam::{DVec3, Vec3};

use crate::maths::functions::{cos, sin};

/// Shares of the extent: a step of a light, and the last digit of a coordinate.
const STEP: f64 = 1.0 / 40.0;
const LAST_DIGIT: i32 = -7;

/// A step of a light or a walk: about a fortieth of the extent, and 1, 2 or 5
/// times a power of ten, so that coordinates stay round.
pub(crate) fn step(extent: f64) -> f64 {
    let wanted = extent * STEP;
    let exponent = exponent(wanted);
    let mantissa = wanted / power_of_ten(exponent);
    let round = match mantissa {
        m if m < 1.5 => "1",
        m if m < 3.5 => "2",
        m if m < 7.5 => "5",
        _ => "10",
    };
    format!("{round}e{exponent}").parse().unwrap_or(wanted)
}

/// Coordinates rounded to a ten-millionth of the extent: far below what can be
/// seen, and short in a file.
pub(crate) fn tidy(place: DVec3, extent: f64) -> DVec3 {
    let decimals = -(exponent(extent) + LAST_DIGIT);
    let round = |x: f64| match usize::try_from(decimals) {
        Ok(decimals) => format!("{x:.decimals$}").parse().unwrap_or(x),
        Err(_) => x,
    };
    // No minus before zero.
    DVec3::from_array(place.to_array().map(round)) + 0.0
}

/// Exponent of ten of a number above 0.
fn exponent(number: f64) -> i32 {
    let text = format!("{number:e}");
    let exponent = text.split_once('e').and_then(|(_, e)| e.parse().ok());
    exponent.unwrap_or(0)
}

fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

/// A vector turned about a unit axis, counter-clockwise seen from its tip
/// (Rodrigues).
pub(crate) fn rotated(vector: DVec3, axis: DVec3, angle_deg: f64) -> DVec3 {
    let angle = angle_deg * (std::f64::consts::PI / 180.0);
    let (sine, cosine) = (sin(angle), cos(angle));
    vector * cosine + axis.cross(vector) * sine + axis * (axis.dot(vector) * (1.0 - cosine))
}

/// A direction as the scene file's reader rounds it; what is zero but for rounding
/// is zero.
pub(crate) fn direction(vector: DVec3) -> Vec3 {
    let unit = vector.normalize_or(DVec3::NEG_Y).to_array();
    let snapped = unit.map(|x| if x.abs() < 1e-9 { 0.0 } else { x });
    DVec3::from_array(snapped).normalize().as_vec3()
}

/// The world axis nearest to a direction, other than those that are taken.
pub(crate) fn nearest_axis(direction: DVec3, taken: DVec3) -> DVec3 {
    let free = direction * (DVec3::ONE - taken.abs());
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut best = axes[0];
    for axis in axes {
        let is_free = axis.dot(taken.abs()) == 0.0;
        let is_nearer = free.dot(axis).abs() > free.dot(best).abs();
        if is_free && (is_nearer || best.dot(taken.abs()) != 0.0) {
            best = axis;
        }
    }
    if direction.dot(best) < 0.0 {
        -best
    } else {
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_follow_the_size() {
        for (extent, expected) in [
            (2.0, 0.05),
            (4.0, 0.1),
            (100.0, 2.0),
            (37.0, 1.0),
            (3e-5, 1e-6),
        ] {
            assert_eq!(step(extent), expected, "{extent}");
        }
        let place = DVec3::new(0.1 + 0.2, -1e-12, 1.0 / 3.0);
        assert_eq!(tidy(place, 2.0), DVec3::new(0.3, 0.0, 0.333_333_3));
        assert_eq!(tidy(DVec3::splat(0.5), 1e9), DVec3::splat(0.5));
    }

    #[test]
    fn axes_are_three_and_differ() {
        let forward = DVec3::new(0.5, -0.6, -0.62).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let x = nearest_axis(right, DVec3::ZERO);
        let y = nearest_axis(DVec3::Y, x);
        let z = nearest_axis(forward, x + y);
        assert_eq!([x, y, z], [DVec3::X, DVec3::Y, DVec3::NEG_Z]);
        let turned = rotated(DVec3::X, DVec3::Y, 90.0);
        assert!((turned - DVec3::NEG_Z).length() < 1e-15);
    }
}
