//! From two filtered pixels to one error (LDR-FLIP, sections 4.1.3 to 4.3).

use glam::DVec3;

use super::colour::{hunt_lab_from_rgb, hyab, rgb_from_opponent};
use crate::maths::functions::pow;
use crate::maths::order::Order;

/// Exponent of the colour distance, q_c.
const COLOUR_EXPONENT: f64 = 0.7;
/// Share of the largest colour distance from which on distances are squeezed, p_c.
const SQUEEZED_FROM: f64 = 0.4;
/// Colour error of that distance, p_t.
const ERROR_WHERE_SQUEEZED: f64 = 0.95;
/// Exponent of the feature difference, q_f.
const FEATURE_EXPONENT: f64 = 0.5;

/// What the filters make of one pixel of one image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Perceived {
    /// Opponent colour after the contrast sensitivity of the eye.
    pub(super) opponent: DVec3,
    /// Strength of edges, 0 to 1 for an edge along a side.
    pub(super) edge: f64,
    /// Strength of points and lines.
    pub(super) point: f64,
}

/// Turns differences into errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct ErrorScale {
    /// Largest colour distance, to the power of q_c: green to blue.
    largest_distance: f64,
}

impl ErrorScale {
    pub(super) fn new() -> Self {
        let distance = hyab(hunt_lab_from_rgb(DVec3::Y), hunt_lab_from_rgb(DVec3::Z));
        Self {
            largest_distance: pow(distance, COLOUR_EXPONENT),
        }
    }

    /// Error between two pixels, 0 to 1: the colour error, raised by differing
    /// features (equation 1 of LDR-FLIP).
    pub(super) fn error(self, reference: Perceived, candidate: Perceived) -> f64 {
        let colour = self.colour_error(reference.opponent, candidate.opponent);
        pow(colour, 1.0 - feature_error(reference, candidate))
    }

    fn colour_error(self, reference: DVec3, candidate: DVec3) -> f64 {
        let distance = hyab(seen_colour(reference), seen_colour(candidate));
        self.redistributed(pow(distance, COLOUR_EXPONENT))
    }

    /// Distances up to p_c of the largest take the errors 0 to p_t, the rest
    /// what is left: large distances all look wrong.
    fn redistributed(self, distance: f64) -> f64 {
        let knee = SQUEEZED_FROM * self.largest_distance;
        if distance < knee {
            ERROR_WHERE_SQUEEZED / knee * distance
        } else {
            let beyond = (distance - knee) / (self.largest_distance - knee);
            // Rounding alone can pass 1.
            (ERROR_WHERE_SQUEEZED + beyond * (1.0 - ERROR_WHERE_SQUEEZED)).at_most(1.0)
        }
    }
}

/// Filtered colours can leave the gamut of the display, and are put back into
/// it before they are judged.
fn seen_colour(opponent: DVec3) -> DVec3 {
    let rgb = rgb_from_opponent(opponent);
    hunt_lab_from_rgb(rgb.clamp(DVec3::ZERO, DVec3::ONE))
}

fn feature_error(reference: Perceived, candidate: Perceived) -> f64 {
    let edges = (candidate.edge - reference.edge).abs();
    let points = (candidate.point - reference.point).abs();
    // The exponent is a half, for which the square root is exact.
    const { assert!(FEATURE_EXPONENT == 0.5, "the root below is square") };
    (std::f64::consts::FRAC_1_SQRT_2 * edges.at_least(points))
        .at_most(1.0)
        .sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::flip::colour::opponent_from_rgb;

    fn flat(rgb: DVec3) -> Perceived {
        Perceived {
            opponent: opponent_from_rgb(rgb),
            edge: 0.0,
            point: 0.0,
        }
    }

    #[test]
    fn green_and_blue_are_farthest_apart() {
        let error = ErrorScale::new().error(flat(DVec3::Y), flat(DVec3::Z));
        assert!((error - 1.0).abs() < 1e-12, "{error}");
    }

    #[test]
    fn the_squeeze_has_its_knee_and_its_ends() {
        let scale = ErrorScale::new();
        let largest = scale.largest_distance;
        assert_eq!(scale.redistributed(0.0), 0.0);
        let knee = scale.redistributed(0.4 * largest);
        assert!((knee - 0.95).abs() < 1e-12);
        assert!((scale.redistributed(0.2 * largest) - 0.475).abs() < 1e-12);
        assert!((scale.redistributed(largest) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn features_raise_an_error_and_make_none() {
        let scale = ErrorScale::new();
        let (a, b) = (flat(DVec3::splat(0.5)), flat(DVec3::splat(0.6)));
        let with_edge = Perceived { edge: 0.1, ..b };
        assert!(scale.error(a, with_edge) > scale.error(a, b));
        assert_eq!(scale.error(a, Perceived { edge: 0.1, ..a }), 0.0);
    }
}
