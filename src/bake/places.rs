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
use crate::maths::sampling::{cosine_direction, pick, sphere_direction};
use crate::simd::Level;
use crate::surface::{NONE, Ray, Surface, SurfacePoint, offset_origin};

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

/// Tries to find a place with room around it.
const MOST_ATTEMPTS: u32 = 64;
/// First random number of the tries, and how many each takes.
const FIRST_ATTEMPT: u32 = 16;
const NUMBERS_AN_ATTEMPT: u32 = 8;

/// Directions that are looked into for room: along the axes and the diagonals.
fn around() -> impl Iterator<Item = Vec3> {
    let signs = [-1.0_f32, 0.0, 1.0];
    let all = signs
        .into_iter()
        .flat_map(move |x| signs.map(|y| (x, y)))
        .flat_map(move |(x, y)| signs.map(|z| Vec3::new(x, y, z)));
    all.map(Vec3::normalize_or_zero)
        .filter(|d| *d != Vec3::ZERO)
}

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
        let surface = self.surface;
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
        let reach = self.reach(origin, towards) * INSIDE_FREE_SPACE;
        let distance = distance as f32;
        origin + towards * if distance < reach { distance } else { reach }
    }

    /// A place in free space: uniform on the chord from a random surface point
    /// along a random direction of its side, with nothing nearer than `clearance`
    /// extents in the directions that are looked into. Placed units.
    pub(super) fn room_point(&self, [seed, light]: [u32; 2], clearance: f64) -> Vec3 {
        let extent = (self.surface.placement.extent * self.surface.placement.scale) as f32;
        let clearance = clearance as f32 * extent;
        for attempt in 0..MOST_ATTEMPTS {
            let first = FIRST_ATTEMPT + attempt * NUMBERS_AN_ATTEMPT;
            let u = |dimension: u32| uniform(seed, light, first + dimension);
            let vertex = pick(&self.cumulative, u(0));
            let from = self.surface.sample_point(vertex, [u(1), u(2)]);
            let towards = cosine_direction(from.flat_normal, [u(3), u(4)]);
            let origin = offset_origin(from.position, from.flat_normal, towards);
            let chord = self.reach(origin, towards).min(extent);
            let place = origin + towards * (u(5) * chord);
            if around().all(|direction| self.reach(place, direction) > clearance) {
                return place;
            }
        }
        self.point([seed, light])
    }

    /// A random surface point that hands light on.
    pub(super) fn surface_point(&self, [seed, light]: [u32; 2]) -> SurfacePoint {
        let u = |dimension| uniform(seed, light, dimension);
        let vertex = pick(&self.cumulative, u(0));
        self.surface.sample_point(vertex, [u(1), u(2)])
    }

    /// A place so far from the corner that is farthest from the middle of what
    /// hands light on, towards the middle. Placed units.
    pub(super) fn corner(&self, distance: f32) -> Vec3 {
        let positions = self.surface.vertices.positions();
        let mut last = 0.0;
        let (mut middle, mut total) = (Vec3::ZERO, 0.0_f32);
        let mut farthest = (0.0, Vec3::ZERO);
        for (&position, &sum) in positions.iter().zip(&self.cumulative) {
            middle += position * (sum - last);
            total += sum - last;
            last = sum;
        }
        middle /= total;
        last = 0.0;
        for (&position, &sum) in positions.iter().zip(&self.cumulative) {
            let away = position.distance_squared(middle);
            if sum > last && away > farthest.0 {
                farthest = (away, position);
            }
            last = sum;
        }
        farthest.1 + (middle - farthest.1).normalize_or_zero() * distance
    }

    /// Distance to the next surface.
    fn reach(&self, origin: Vec3, direction: Vec3) -> f32 {
        let ray = Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        };
        let hit = self.surface.rays.closest(self.level, &ray);
        hit.map_or(f32::INFINITY, |hit| hit.t)
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
