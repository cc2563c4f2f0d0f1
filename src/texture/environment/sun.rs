//! Finds the sun of a map: one small source that outshines its surroundings
//! and the rest of the map.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use super::lookup::{direction_of, texel_solid_angles};
use crate::maths::functions::{cos, cos_f32};
use crate::maths::order::Order;

/// A small bright source in a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sun {
    /// Unit direction to its middle, in the map's frame.
    pub(crate) direction: Vec3,
    /// Irradiance on a plane that faces it, W/m2 for a map of scale 1: what
    /// its texels hold above the surrounding level.
    pub(crate) irradiance: Vec3,
    /// Angular radius, radians: of a disc of uniform radiance whose radiance has
    /// the same mean and mean square as the source's.
    pub(crate) radius_rad: f32,
}

/// Largest angular distance of a texel of the sun from its middle, degrees. A
/// photographed sun with its glare, or one of a map 64 texels wide, stays
/// below; a lamp's shade or a window seen from a room is wider.
const MAX_RADIUS_DEG: f32 = 5.0;
/// The surrounding level is that of a ring of these radii, degrees, about the
/// brightest texel: outside the largest sun, inside of what it stands before.
const RING_DEG: [f64; 2] = [6.0, 14.0];
/// A texel belongs to the sun from this multiple of the surrounding level on.
/// A clear sky rises to 3 to 5 times its mean about the sun; a painted sun is
/// 1e2 to 1e5 times as bright.
const ABOVE_SURROUNDINGS: f64 = 8.0;
/// ... and from this share of the brightest on, so that glare does not make a
/// tiny sun large. What is left is smaller than the sun in total.
const SHARE_OF_PEAK: f64 = 1e-3;
/// Smallest share of the map's whole light (irradiance that faces the sun, over
/// that plus pi times the mean radiance of the rest). Below a tenth, sampling
/// it like everything else does well; a hazy sun gives 0.2, a clear one 0.8.
const MIN_SHARE: f64 = 0.1;
/// Most light of other texels as bright as the sun's, over the sun's own: a
/// reflection of it is allowed, a second lamp is not.
const MAX_RIVALS: f64 = 0.25;

/// The sun and the texels without it; none if no source meets all criteria.
pub(super) fn find(size: [usize; 2], texels: &[Vec3]) -> Option<(Sun, Vec<Vec3>)> {
    let map = Map::new(size, texels);
    let peak = map.brightest()?;
    let surroundings = map.ring_mean(peak)?;
    let level = gray(surroundings);
    let brightness = map.brightness(peak);
    let threshold = (ABOVE_SURROUNDINGS * level).at_least(SHARE_OF_PEAK * brightness);
    if brightness < threshold {
        // A patch that is wider than the ring is what surrounds its own texels.
        return None;
    }
    let cluster = map.cluster(peak, threshold)?;
    let sun = map.sun_of(&cluster, surroundings)?;
    map.outshines_the_rest(&cluster, threshold, level)
        .then(|| (sun, map.without(&cluster, surroundings)))
}

fn gray(color: DVec3) -> f64 {
    color.element_sum() / 3.0
}

struct Map<'a> {
    size: [usize; 2],
    texels: &'a [Vec3],
    /// By row, sr.
    solid_angles: Vec<f32>,
}

impl<'a> Map<'a> {
    fn new(size: [usize; 2], texels: &'a [Vec3]) -> Self {
        Self {
            size,
            texels,
            solid_angles: texel_solid_angles(size),
        }
    }

    fn brightness(&self, texel: usize) -> f64 {
        gray(self.texels[texel].as_dvec3())
    }

    fn solid_angle(&self, texel: usize) -> f64 {
        f64::from(self.solid_angles[texel / self.size[0]])
    }

    fn direction(&self, texel: usize) -> Vec3 {
        let [width, height] = self.size;
        let [x, y] = [texel % width, texel / width].map(|k| k as f32 + 0.5);
        direction_of([x / width as f32, y / height as f32])
    }

    /// The first of the brightest texels; none in the dark.
    fn brightest(&self) -> Option<usize> {
        let mut best = (0, 0.0);
        for texel in 0..self.texels.len() {
            let brightness = self.brightness(texel);
            if brightness > best.1 {
                best = (texel, brightness);
            }
        }
        (best.1 > 0.0).then_some(best.0)
    }

    /// Rows that come within `angle_rad` of a direction.
    fn rows_near(&self, direction: Vec3, angle_rad: f32) -> std::ops::Range<usize> {
        let height = self.size[1];
        let v = super::lookup::place_of(direction)[1];
        let reach = angle_rad / PI;
        let from = ((v - reach) * height as f32).floor().at_least(0.0) as usize;
        let to = ((v + reach) * height as f32).ceil().at_least(0.0) as usize;
        from..to.min(height)
    }

    /// Mean radiance around a texel; none if the map is too coarse for a ring.
    fn ring_mean(&self, peak: usize) -> Option<DVec3> {
        let [inner, outer] = RING_DEG.map(|angle| cos(angle.to_radians()) as f32);
        let direction = self.direction(peak);
        let [mut sum, mut solid_angle] = [DVec3::ZERO, DVec3::ZERO];
        for row in self.rows_near(direction, RING_DEG[1].to_radians() as f32) {
            for texel in row * self.size[0]..(row + 1) * self.size[0] {
                let cosine = self.direction(texel).dot(direction);
                if cosine < inner && cosine > outer {
                    sum += self.texels[texel].as_dvec3() * self.solid_angle(texel);
                    solid_angle += DVec3::splat(self.solid_angle(texel));
                }
            }
        }
        (solid_angle.x > 0.0).then(|| sum / solid_angle)
    }

    /// The texels above the threshold that hang together with the peak,
    /// ascending; none if they reach too far.
    fn cluster(&self, peak: usize, threshold: f64) -> Option<Vec<usize>> {
        let [width, height] = self.size;
        let farthest = cos_f32(2.0 * MAX_RADIUS_DEG.to_radians());
        let middle = self.direction(peak);
        let mut found = vec![peak];
        let mut is_known = vec![false; width * height];
        is_known[peak] = true;
        let mut next = 0;
        while next < found.len() {
            let [x, y] = [found[next] % width, found[next] / width];
            next += 1;
            for step in 0..9 {
                let beside = (x + width + step % 3 - 1) % width;
                let Some(row) = (y + step / 3).checked_sub(1).filter(|&row| row < height) else {
                    continue;
                };
                let texel = row * width + beside;
                if is_known[texel] || self.brightness(texel) < threshold {
                    continue;
                }
                if self.direction(texel).dot(middle) < farthest {
                    return None;
                }
                is_known[texel] = true;
                found.push(texel);
            }
        }
        found.sort_unstable();
        Some(found)
    }

    fn excess(&self, texel: usize, surroundings: DVec3) -> DVec3 {
        (self.texels[texel].as_dvec3() - surroundings) * self.solid_angle(texel)
    }

    /// The source of a cluster; none if it is too wide.
    fn sun_of(&self, cluster: &[usize], surroundings: DVec3) -> Option<Sun> {
        let [mut irradiance, mut toward] = [DVec3::ZERO; 2];
        let mut squares = 0.0;
        for &texel in cluster {
            let excess = self.excess(texel, surroundings);
            irradiance += excess;
            toward += self.direction(texel).as_dvec3() * gray(excess);
            squares += gray(excess) * gray(excess) / self.solid_angle(texel);
        }
        let direction = toward.normalize_or_zero().as_vec3();
        let farthest = cos_f32(MAX_RADIUS_DEG.to_radians());
        let is_compact = cluster
            .iter()
            .all(|&texel| self.direction(texel).dot(direction) >= farthest);
        let solid_angle = gray(irradiance) * gray(irradiance) / squares;
        let radius_rad = (solid_angle / std::f64::consts::PI).sqrt() as f32;
        let is_small = is_compact && radius_rad <= MAX_RADIUS_DEG.to_radians();
        is_small.then_some(Sun {
            direction,
            irradiance: irradiance.as_vec3(),
            radius_rad,
        })
    }

    fn outshines_the_rest(&self, cluster: &[usize], threshold: f64, level: f64) -> bool {
        let [mut sun, mut rest, mut rivals] = [0.0; 3];
        let mut members = cluster.iter().copied().peekable();
        for texel in 0..self.texels.len() {
            let light = self.brightness(texel) * self.solid_angle(texel);
            if members.next_if_eq(&texel).is_some() {
                sun += light - level * self.solid_angle(texel);
                continue;
            }
            rest += light;
            if self.brightness(texel) >= threshold {
                rivals += light;
            }
        }
        // pi times the mean radiance over the sphere of 4 pi.
        let rest_irradiance = rest / 4.0;
        sun >= MIN_SHARE * (sun + rest_irradiance) && rivals <= MAX_RIVALS * sun
    }

    /// The texels with the cluster at the surrounding level.
    fn without(&self, cluster: &[usize], surroundings: DVec3) -> Vec<Vec3> {
        let mut texels = self.texels.to_vec();
        for &texel in cluster {
            texels[texel] = surroundings.as_vec3();
        }
        texels
    }
}
