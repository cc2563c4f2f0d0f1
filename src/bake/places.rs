//! Where lights matter: places from which light would bounce.
//!
//! A lamp over the outside of a wall, or a sun that only roofs see, has no
//! indirect light worth a coefficient, and its relative error is noise. So
//! places are chosen by what a surface could hand on: its area times the share
//! of its rays that arrive at another surface, and for a sun that of the rays
//! that escape too. In a room with a small window that gives suns that shine
//! through it.

use glam::Vec3;
use rayon::prelude::*;

use super::transfer::vertex_rays;
use crate::maths::functions::{exp, ln};
use crate::maths::hash::uniform;
use crate::maths::sampling::{pick, sphere_direction};
use crate::simd::Level;
use crate::surface::{NONE, Ray, Surface, offset_origin};

/// Rays a vertex that look around.
const RAYS: u32 = 64;
/// Seed of these rays.
const SEED: u32 = 0x5ce1;
/// Distances of lights from the surface, shares of the extent.
const NEAREST: f64 = 0.02;
const FARTHEST: f64 = 0.5;
/// Share of the way to the next surface at which a light stays in front of it.
const INSIDE_FREE_SPACE: f32 = 0.9;
/// Share of all rays that must escape for suns to have places.
const OPEN_SHARE: f64 = super::sky::OPEN_SHARE;

/// What the rays of every vertex found.
pub(super) struct Places<'a> {
    surface: &'a Surface,
    level: Level,
    /// Area times arrived share of the vertices up to and with each.
    cumulative: Vec<f32>,
    /// The same times the share that escaped; empty in a closed scene.
    cumulative_of_suns: Vec<f32>,
}

impl<'a> Places<'a> {
    pub(super) fn of(surface: &'a Surface, level: Level) -> Self {
        let shares: Vec<[f32; 2]> = (0..surface.vertices.len())
            .into_par_iter()
            .with_min_len(64)
            .map(|vertex| {
                let (mut arrived, mut escaped) = (0_u32, 0_u32);
                for (_, (_, hit)) in vertex_rays(surface, level, [SEED, vertex as u32], RAYS) {
                    match hit {
                        None => escaped += 1,
                        Some(hit) => {
                            let corners = surface.vertices.of_triangle(hit.triangle, hit.front);
                            arrived += u32::from(corners != [NONE; 3]);
                        }
                    }
                }
                [arrived, escaped].map(|count| count as f32 / RAYS as f32)
            })
            .collect();
        let areas = surface.vertices.areas();
        let cumulative = |weight: &dyn Fn([f32; 2]) -> f32| -> Vec<f32> {
            let terms = shares.iter().zip(areas);
            terms
                .scan(0.0, |total, (&share, area)| {
                    *total += area * weight(share);
                    Some(*total)
                })
                .collect()
        };
        let escaped: f64 = shares.iter().map(|s| f64::from(s[1])).sum();
        let is_open = escaped > OPEN_SHARE * shares.len() as f64;
        let cumulative_of_suns = if is_open {
            cumulative(&|[arrived, escaped]| arrived * escaped)
        } else {
            Vec::new()
        };
        Self {
            surface,
            level,
            cumulative: cumulative(&|[arrived, _]| arrived),
            cumulative_of_suns,
        }
    }

    /// Whether there is a surface that hands light on.
    pub(super) fn any(&self) -> bool {
        self.cumulative.last().is_some_and(|&total| total > 0.0)
    }

    /// Whether a sun reaches a surface that hands light on.
    pub(super) fn any_sun(&self) -> bool {
        self.cumulative_of_suns
            .last()
            .is_some_and(|&total| total > 0.0)
    }

    /// A surface point moved along a random direction of its side by a
    /// log-uniform distance, not through another surface. Placed units.
    pub(super) fn point(&self, [seed, light]: [u32; 2]) -> Vec3 {
        let (surface, level) = (self.surface, self.level);
        let u = |dimension| uniform(seed, light, dimension);
        let vertex = pick(&self.cumulative, u(0));
        let from = surface.sample_point(vertex, [u(1), u(2)]);
        let towards = sphere_direction([u(3), u(4)]);
        let towards = if towards.dot(from.flat_normal) < 0.0 {
            -towards
        } else {
            towards
        };
        let extent = surface.placement.extent * surface.placement.scale;
        let distance = extent * exp(ln(NEAREST) + f64::from(u(5)) * (ln(FARTHEST) - ln(NEAREST)));
        let origin = offset_origin(from.position, from.flat_normal, towards);
        let free = surface.rays.closest(
            level,
            &Ray {
                origin,
                direction: towards,
                t_max: f32::INFINITY,
            },
        );
        let reach = free.map_or(f32::INFINITY, |hit| hit.t * INSIDE_FREE_SPACE);
        let distance = distance as f32;
        origin + towards * if distance < reach { distance } else { reach }
    }

    /// A place in free space: on the chord from a random surface point along a
    /// random direction of its side, uniform, at least `nearest` extents away
    /// from either end where the chord allows it. Placed units.
    pub(super) fn room_point(&self, [seed, light]: [u32; 2], nearest: f64) -> Vec3 {
        let (surface, level) = (self.surface, self.level);
        let u = |dimension| uniform(seed, light, dimension);
        let extent = (surface.placement.extent * surface.placement.scale) as f32;
        let margin = nearest as f32 * extent;
        for attempt in 0..64_u32 {
            let u = |dimension: u32| u(16 + attempt * 8 + dimension);
            let vertex = pick(&self.cumulative, u(0));
            let from = surface.sample_point(vertex, [u(1), u(2)]);
            let towards = crate::maths::sampling::cosine_direction(from.flat_normal, [u(3), u(4)]);
            let origin = offset_origin(from.position, from.flat_normal, towards);
            let chord = |origin, direction| {
                let free = surface.rays.closest(
                    level,
                    &Ray {
                        origin,
                        direction,
                        t_max: f32::INFINITY,
                    },
                );
                free.map_or(extent, |hit| hit.t)
            };
            let place = origin + towards * (u(5) * chord(origin, towards).min(extent));
            // Nothing within the margin in fourteen directions.
            let free = (0..14).all(|d| {
                let direction = if d < 6 {
                    let mut v = Vec3::ZERO;
                    v[d / 2] = if d % 2 == 0 { 1.0 } else { -1.0 };
                    v
                } else {
                    let s = |bit: usize| if (d - 6) >> bit & 1 == 0 { 1.0 } else { -1.0 };
                    Vec3::new(s(0), s(1), s(2)).normalize()
                };
                chord(place, direction) > margin
            });
            if free {
                return place;
            }
        }
        self.point([seed, light])
    }

    /// Direction of travel of a sun that reaches a surface that hands light on.
    pub(super) fn sun(&self, [seed, light]: [u32; 2]) -> Vec3 {
        let vertex = pick(&self.cumulative_of_suns, uniform(seed, light, 0));
        let rays = vertex_rays(self.surface, self.level, [SEED, vertex as u32], RAYS);
        let open: Vec<Vec3> = rays
            .filter_map(|(_, (direction, hit))| hit.is_none().then_some(direction))
            .collect();
        let chosen = (uniform(seed, light, 1) * open.len() as f32) as usize;
        open.get(chosen.min(open.len().max(1) - 1))
            .map_or(Vec3::NEG_Y, |&towards| -towards)
    }
}
