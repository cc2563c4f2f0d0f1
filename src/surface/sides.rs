//! Which back sides exist: those that can be seen or lit (decision 1 of the
//! design: a ray that starts under an object hits the inside of its faces and
//! must not read the lit outside).

use rayon::prelude::*;

use super::forest::Forest;
use super::shrunken::Shrunken;
use super::{NONE, Surface, SurfacePoint, direct};
use crate::maths::sampling::cosine_direction;
use crate::maths::sobol::ScrambledSobol;
use crate::simd::Level;

/// Rays from a vertex's back. They find out what its cavity is, not what the
/// vertex sees, so a few are enough.
const PILOT_RAYS: u32 = 32;
/// The same where an estimate will do, at least. A cavity is judged by the rays
/// of all its vertices: in five scenes of 11,000 to 53,000 fronts, 7 to 32 a
/// vertex found as many backs as 32.
const LEAST_PILOT_RAYS: u32 = 4;
/// Share of a cavity's rays that must meet a front or the open. Where faces
/// touched, drawing them in leaves overlaps of 2e-5 through which one ray in
/// 10,000 slips (a box of 725 vertices on a floor: 5 of 46,400); a mouth of
/// this share lets in as little light as it shows.
const LEAST_OPEN_SHARE: f64 = 0.005;
/// Rays from a vertex's front, only in scenes whose backs see nothing.
const FRONT_PILOT_RAYS: u32 = 8;
/// Rays from each point of a vertex's area that tell whether it is in the open.
const OPEN_RAYS: u32 = 4;
/// Seed of the pilot rays, apart from the transfer's.
const SEED: u32 = 0x51de;

/// Marks front vertices whose back can be seen or lit.
///
/// Backs that see each other enclose one cavity. A cavity that sees a front or
/// the open is part of the world, all of it: an alcove lights its own depths.
/// One that does not is the inside of a closed body, where no light is, and
/// has no vertices.
///
/// Where all cavities are closed and no front sees anything at all, the only
/// place for light to bounce is inside a body, so all backs exist: a room that
/// was modelled inside out.
pub(super) fn visible_backs(surface: &Surface, level: Level) -> Vec<bool> {
    visible_backs_by(surface, level, PILOT_RAYS)
}

/// The same by about `most_rays` rays in all, and the rays of
/// [`visible_backs`] for each of these: 1 where the answer is its answer.
pub(super) fn about_visible_backs(
    surface: &Surface,
    level: Level,
    most_rays: usize,
) -> (Vec<bool>, f64) {
    let affordable = most_rays / surface.vertices.front_count().max(1);
    let rays = affordable.clamp(LEAST_PILOT_RAYS as usize, PILOT_RAYS as usize) as u32;
    let backs = visible_backs_by(surface, level, rays);
    (backs, f64::from(PILOT_RAYS) / f64::from(rays))
}

fn visible_backs_by(surface: &Surface, level: Level, pilot_rays: u32) -> Vec<bool> {
    let shrunken = Shrunken::of(surface);
    let views: Vec<BackView> = (0..surface.vertices.front_count())
        .into_par_iter()
        .map(|vertex| {
            BackView::of(
                surface,
                &shrunken,
                level,
                pilot_uniforms(vertex, pilot_rays),
                vertex,
            )
        })
        .collect();
    let cavities = cavities(surface, &views);
    let mut open = vec![0_u64; views.len()];
    let mut rays = vec![0_u64; views.len()];
    for (view, &cavity) in views.iter().zip(&cavities) {
        open[cavity as usize] += u64::from(view.open_rays);
        rays[cavity as usize] += u64::from(pilot_rays);
    }
    let is_open = |&cavity: &u32| {
        open[cavity as usize] as f64 >= LEAST_OPEN_SHARE * rays[cavity as usize] as f64
    };
    let wanted: Vec<bool> = cavities.iter().map(is_open).collect();
    if !wanted.contains(&true) && !fronts_see_anything(surface, level) {
        return vec![true; wanted.len()];
    }
    wanted
}

/// What the pilot rays of a vertex's back met.
struct BackView {
    /// Rays that met a front or escaped.
    open_rays: u32,
    /// Triangles whose backs the others met.
    backs: Vec<u32>,
}

impl BackView {
    fn of(
        surface: &Surface,
        shrunken: &Shrunken,
        level: Level,
        uniforms: impl Iterator<Item = [f32; 4]>,
        vertex: usize,
    ) -> Self {
        let mut view = Self {
            open_rays: 0,
            backs: Vec::new(),
        };
        for u in uniforms {
            let point = shrunken.sample_point(surface, vertex, [u[0], u[1]]);
            let back = SurfacePoint {
                normal: -point.normal,
                flat_normal: -point.flat_normal,
                ..point
            };
            let direction = cosine_direction(back.flat_normal, [u[2], u[3]]);
            match shrunken.arrival(level, &back, direction) {
                Some(hit) if !hit.front => view.backs.push(hit.triangle),
                _ => view.open_rays += 1,
            }
        }
        view.backs.sort_unstable();
        view.backs.dedup();
        view
    }
}

/// The cavity of each vertex's back, named by one of its vertices.
fn cavities(surface: &Surface, views: &[BackView]) -> Vec<u32> {
    let mut forest = Forest::new(views.len());
    for (vertex, view) in views.iter().enumerate() {
        for &triangle in &view.backs {
            for corner in surface.vertices.of_triangle(triangle, true) {
                forest.join(vertex as u32, corner);
            }
        }
    }
    (0..views.len() as u32)
        .map(|vertex| forest.root(vertex))
        .collect()
}

/// Per vertex, the points of its area (a bit each, see
/// [`direct::AREA_POINTS`]) that are not inside a closed body: light that
/// reaches the others is seen by nobody. Needs the back sides.
pub(super) fn open_points(surface: &Surface, level: Level) -> Vec<u8> {
    let is_inside = |point: &SurfacePoint, vertex: usize, index: u32| {
        let set = ScrambledSobol::new(SEED ^ index, vertex as u32);
        let meets_inside = |k: &u32| {
            let direction = cosine_direction(point.flat_normal, set.point2(*k));
            let hit = surface.arrival(level, point, direction);
            hit.is_some_and(|hit| {
                surface.vertices.of_triangle(hit.triangle, hit.front) == [NONE; 3]
            })
        };
        2 * (0..OPEN_RAYS).filter(meets_inside).count() > OPEN_RAYS as usize
    };
    (0..surface.vertices.len())
        .into_par_iter()
        .map(|vertex| {
            let points = direct::AreaPoints::of(surface, vertex);
            (0..direct::AREA_POINTS)
                .filter(|&index| !is_inside(&points.point(index), vertex, index))
                .fold(0, |bits, index| bits | 1 << index)
        })
        .collect()
}

fn fronts_see_anything(surface: &Surface, level: Level) -> bool {
    (0..surface.vertices.front_count())
        .into_par_iter()
        .any(|vertex| {
            pilot_uniforms(vertex, FRONT_PILOT_RAYS).any(|u| {
                let point = surface.sample_point(vertex, [u[0], u[1]]);
                surface
                    .arrival(
                        level,
                        &point,
                        cosine_direction(point.flat_normal, [u[2], u[3]]),
                    )
                    .is_some()
            })
        })
}

/// Uniforms for a point of a vertex's area and a direction.
fn pilot_uniforms(vertex: usize, count: u32) -> impl Iterator<Item = [f32; 4]> {
    let set = ScrambledSobol::new(SEED, vertex as u32);
    (0..count).map(move |k| set.point(k))
}
