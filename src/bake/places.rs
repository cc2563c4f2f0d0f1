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
use crate::maths::order::Order;
use crate::maths::sampling::{cosine_direction, pick, sphere_direction};
use crate::simd::Level;
use crate::surface::{NONE, Ray, Surface, SurfacePoint, offset_origin};

/// Rays a vertex that look around.
const RAYS: u32 = 64;
/// Seed of these rays.
pub(super) const SEED: u32 = 0x5ce1;
/// Prior skies, in an open scene.
const SKIES: usize = 7;
/// Distances of lights from the surface, shares of the extent.
const NEAREST: f64 = 0.02;
const FARTHEST: f64 = 0.5;
/// Share of the way to the next surface at which a light stays in front of it.
const INSIDE_FREE_SPACE: f32 = 0.9;
/// Share of all rays that must escape for suns to have places.
const OPEN_SHARE: f64 = super::sky::OPEN_SHARE;

/// Neighbours whose shares of rays that arrive differ by more than this are not joined
/// by the basis: functions that go on from one to the other carry light along. 64 rays
/// know a share to some 0.06. Error of one bounce in per cent without this, at 0.3, 0.25
/// and 0.2, by 512 rays, under lights that bakes stated their error by at the time:
/// `sheet`, whose middle wall rises 5 cm above the roofs, 4.0, 3.4, 3.4 and 2.8 (a lamp
/// above the roof 42, 32, 29 and 9, a sun from behind 31, 9, 5 and 5); `window` by 1,024
/// rays 5.2 without and 4.9 at 0.2. Less was not tried. Of the statues' edges 0.4 per
/// cent are cut (3.06 without and 3.57 by 1,024 rays, at other receivers, whose rows have
/// 2.25 and 2.66 of noise), of Cornell's next to none.
const SEEN_APART: f32 = 0.2;

/// Least mass of a vertex in the basis, of the mean: what 64 rays do not see
/// may still be seen by others.
const LEAST_MASS: f64 = 0.02;

/// Tries to find a place with room around it.
const MOST_ATTEMPTS: u32 = 64;
/// First random number of the tries, and how many each takes.
const FIRST_ATTEMPT: u32 = 16;
const NUMBERS_AN_ATTEMPT: u32 = 8;

/// First random number of the tries of [`Places::aim`].
const FIRST_AIM: u32 = 1024;

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

/// What a vertex sees.
struct View {
    /// Share of its rays that arrive.
    arrived: f32,
    /// Share that escapes, and that of bright halves of the sky.
    skies: [f32; SKIES],
}

impl View {
    fn of(surface: &Surface, level: Level, vertex: u32, lobes: &[Vec3]) -> Self {
        let (mut arrived, mut skies) = (0_u32, [0.0; SKIES]);
        for (_, (direction, hit)) in vertex_rays(surface, level, [SEED, vertex], RAYS) {
            let Some(hit) = hit else {
                skies[0] += 1.0 / RAYS as f32;
                for (sum, lobe) in skies[1..].iter_mut().zip(lobes) {
                    let cosine = direction.dot(*lobe);
                    *sum += if cosine > 0.0 { cosine } else { 0.0 } / RAYS as f32;
                }
                continue;
            };
            let corners = surface.vertices.of_triangle(hit.triangle, hit.front);
            arrived += u32::from(corners != [NONE; 3]);
        }
        Self {
            arrived: arrived as f32 / RAYS as f32,
            skies,
        }
    }
}

/// What the rays of every vertex found.
pub(super) struct Places<'a> {
    surface: &'a Surface,
    level: Level,
    /// Share of each vertex's rays that arrive at another surface.
    arrived: Vec<f32>,
    /// What skies make of each vertex; empty in a closed scene.
    skies: Vec<[f32; SKIES]>,
    /// Area times arrived share of the vertices up to and with each.
    cumulative: Vec<f32>,
    /// The same times the share that escaped; empty in a closed scene.
    cumulative_of_suns: Vec<f32>,
}

impl<'a> Places<'a> {
    pub(super) fn of(surface: &'a Surface, level: Level) -> Self {
        let lobes: Vec<Vec3> = [Vec3::X, Vec3::Y, Vec3::Z]
            .into_iter()
            .flat_map(|axis| [axis, -axis])
            .collect();
        let views: Vec<View> = (0..surface.vertices.len())
            .into_par_iter()
            .with_min_len(64)
            .map(|vertex| View::of(surface, level, vertex as u32, &lobes))
            .collect();
        let cumulative = |weight: &dyn Fn(&View) -> f32| -> Vec<f32> {
            let terms = views.iter().zip(surface.vertices.areas());
            terms
                .scan(0.0, |total, (view, area)| {
                    *total += area * weight(view);
                    Some(*total)
                })
                .collect()
        };
        let escaped: f64 = views.iter().map(|view| f64::from(view.skies[0])).sum();
        let is_open = escaped > OPEN_SHARE * views.len() as f64;
        let (mut skies, mut cumulative_of_suns) = (Vec::new(), Vec::new());
        if is_open {
            skies = views.iter().map(|view| view.skies).collect();
            cumulative_of_suns = cumulative(&|view| view.arrived * view.skies[0]);
        }
        Self {
            surface,
            level,
            arrived: views.iter().map(|view| view.arrived).collect(),
            skies,
            cumulative: cumulative(&|view| view.arrived),
            cumulative_of_suns,
        }
    }

    /// Leaves of a light at the vertices what they can hand on, and scales it so
    /// that it brings as much indirect light as any other: by the reciprocity of
    /// form factors, sum_i A_i E_i = sum_j A_j r_j B_j. (Scaled to the same
    /// direct light, a sun that mostly shines on roofs counted for nothing in
    /// the room behind its window, and lost up to a fourth of its light there.)
    /// Returns whether it brings any.
    pub(super) fn scale(&self, brightness: &mut [f32]) -> bool {
        let (mut indirect, mut area) = (0.0, 0.0);
        for ((b, &arrived), &a) in brightness
            .iter_mut()
            .zip(&self.arrived)
            .zip(self.surface.vertices.areas())
        {
            if arrived == 0.0 {
                *b = 0.0;
            }
            indirect += f64::from(a) * f64::from(arrived) * f64::from(*b);
            area += f64::from(a);
        }
        let scale = area / indirect;
        let is_finite = indirect > 0.0 && scale.is_finite();
        if is_finite {
            for b in brightness {
                *b = (f64::from(*b) * scale) as f32;
            }
        }
        is_finite
    }

    /// Whether two neighbours see so differently that what lights the one says nothing
    /// of the other: where a wall rises above the roof beside it, say.
    pub(super) fn see_apart(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].map(|vertex| self.arrived[vertex as usize]);
        (a - b).abs() > SEEN_APART
    }

    /// Share of a light on the surfaces that hand light on which arrives at
    /// another, 0 to 1.
    pub(super) fn indirect_share(&self, brightness: &[f32]) -> f64 {
        let (mut indirect, mut all) = (0.0, 0.0);
        let areas = self.surface.vertices.areas();
        for ((&b, &arrived), &area) in brightness.iter().zip(&self.arrived).zip(areas) {
            if arrived > 0.0 {
                let light = f64::from(area) * f64::from(b);
                indirect += light * f64::from(arrived);
                all += light;
            }
        }
        if all > 0.0 { indirect / all } else { 0.0 }
    }

    /// Irradiance of prior skies at the vertices, roughly: one that is the same
    /// everywhere, and a bright half of it about each axis. None in a closed
    /// scene.
    pub(super) fn skies(&self) -> Vec<Vec<f32>> {
        let sky = |sky: usize| self.skies.iter().map(|seen| seen[sky]).collect();
        let count = if self.skies.is_empty() { 0 } else { SKIES };
        (0..count).map(sky).collect()
    }

    /// What each vertex hands on of light of 1: its area times the share of its
    /// rays that arrive, in the mean 1. By the reciprocity of form factors it is
    /// what arrives at all others, sum_i A_i T_ij, so a basis that is orthonormal
    /// under these masses keeps the energy of what bounces, and light where
    /// nobody sees it does not reach its coefficients.
    pub(super) fn masses(&self) -> Vec<f32> {
        let areas = self.surface.vertices.areas();
        let handed_on = |(&area, &arrived): (&f32, &f32)| f64::from(area) * f64::from(arrived);
        let products: Vec<f64> = areas.iter().zip(&self.arrived).map(handed_on).collect();
        let mean = products.iter().sum::<f64>() / products.len().max(1) as f64;
        let share = |product: f64| {
            let share = product / mean;
            if share > LEAST_MASS {
                share as f32
            } else {
                LEAST_MASS as f32
            }
        };
        if mean > 0.0 {
            products.into_iter().map(share).collect()
        } else {
            vec![1.0; products.len()]
        }
    }

    pub(super) fn surface(&self) -> &'a Surface {
        self.surface
    }

    pub(super) fn level(&self) -> Level {
        self.level
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
            let chord = self.reach(origin, towards).at_most(extent);
            let place = origin + towards * (u(5) * chord);
            if around().all(|direction| self.reach(place, direction) > clearance) {
                return place;
            }
        }
        self.point([seed, light])
    }

    /// A direction (unit) from a place in which the next surface is at least
    /// `throw` extents away, or the farthest of those that were tried.
    pub(super) fn aim(&self, [seed, light]: [u32; 2], place: Vec3, throw: f64) -> Vec3 {
        let extent = self.surface.placement.extent * self.surface.placement.scale;
        let wanted = (throw * extent) as f32;
        let mut best = (0.0, Vec3::NEG_Y);
        for attempt in 0..MOST_ATTEMPTS {
            let first = FIRST_AIM + attempt * 2;
            let u = |dimension| uniform(seed, light, first + dimension);
            let direction = sphere_direction([u(0), u(1)]);
            let reach = self.reach(place, direction);
            // Into the sky is no aim.
            if reach.is_finite() && reach > best.0 {
                best = (reach, direction);
            }
            if best.0 > wanted {
                break;
            }
        }
        best.1
    }

    /// The vertex in which a share (0 to 1) of all that is handed on ends, and the
    /// share of its rays that arrive (above 0).
    pub(super) fn hands_on(&self, share: f32) -> (usize, f64) {
        let vertex = pick(&self.cumulative, share);
        (vertex, f64::from(self.arrived[vertex]))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::sample_scenes::room_with_blocks;

    #[test]
    fn masses_are_what_vertices_hand_on() {
        let scene = room_with_blocks(true, 0.5, 64);
        let surface = Surface::both_sides(&scene);
        let level = Level::detect();
        let places = Places::of(&surface, level);
        let masses = places.masses();
        let areas = surface.vertices.areas();
        let handed_on = |v: usize| areas[v] * places.arrived[v];
        let brightest = (0..masses.len()).max_by(|&a, &b| handed_on(a).total_cmp(&handed_on(b)));
        let brightest = brightest.expect("the room has vertices");
        let mut least_count = 0;
        for (vertex, &mass) in masses.iter().enumerate() {
            let share = mass / masses[brightest];
            let expected = handed_on(vertex) / handed_on(brightest);
            if mass == LEAST_MASS as f32 {
                assert!(share >= expected, "vertex {vertex}");
                least_count += 1;
            } else {
                assert!((share - expected).abs() < 1e-5, "vertex {vertex}");
            }
        }
        assert!(least_count > 0, "the outsides of walls hand nothing on");
    }
}
