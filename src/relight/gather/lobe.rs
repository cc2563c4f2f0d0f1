//! What a glossy lobe gathers: rays of its own, drawn by the facets that the eye
//! sees, so that a reflection is as sharp as the lobe.

use glam::Vec3;

use super::arriving::{Rays, Wanted};
use super::points::PixelPoints;
use crate::maths::order::Order;
use crate::surface::SurfacePoint;
use crate::surface::direct::SeenLobe;

/// Widest cone that one ray stands for, radians.
const WIDEST: f32 = 0.5;

/// Sum of the radiance (W/(m2 sr)) that some of a pixel's rays bring by a lobe; over
/// their number it is the lobe's radiance towards the eye. Rays that facets send into
/// the surface bring nothing.
pub(super) fn gathered(
    rays: &mut Rays,
    from: &SurfacePoint,
    lobe: &SeenLobe,
    points: &PixelPoints,
    numbers: std::ops::Range<u32>,
) -> Vec3 {
    let (mut wanted, mut weights) = (Vec::new(), Vec::new());
    for number in numbers {
        let [u, v, light, _] = points.uniforms(number);
        let Some((direction, weight)) = lobe.glossy.sample(&lobe.frame, [u, v]) else {
            continue;
        };
        if direction.dot(from.flat_normal) <= 0.0 {
            continue;
        }
        let density = lobe.glossy.density(&lobe.frame, direction);
        let solid_angle = 1.0 / (density * super::RAYS as f32).at_least(f32::MIN_POSITIVE);
        wanted.push(Wanted {
            direction,
            spread_rad: solid_angle.sqrt().at_most(WIDEST),
            light,
            light_points: points.of_lights(number),
        });
        weights.push(weight);
    }
    let mut sum = Vec3::ZERO;
    let mut weights = weights.into_iter();
    rays.arriving(from, &wanted, &mut |it| {
        let weight = weights.next().unwrap_or(Vec3::ZERO);
        sum += weight * (it.bounced + it.sky);
    });
    sum
}
