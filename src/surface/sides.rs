//! Which back sides exist: those that can be seen or lit (decision 1 of the
//! design: a ray that starts under an object hits the inside of its faces and
//! must not read the lit outside).

use rayon::prelude::*;

use super::shrunken::Shrunken;
use super::{NONE, Surface, SurfacePoint, direct};
use crate::maths::sampling::cosine_direction;
use crate::maths::sobol::ScrambledSobol;
use crate::simd::Level;

/// Rays from a vertex's back. A closed body shows none of them a front or the
/// open, by construction of the ray test, so more rays only find smaller holes.
const PILOT_RAYS: u32 = 64;
/// Pilot rays that must see something. Faces that were drawn in apart from each
/// other overlap by 2e-5 where they met, so one ray in 10,000 slips out (a box
/// of 725 vertices on a floor had 5 that saw with one ray, none with two).
const SEEING_RAYS: usize = 2;
/// Rays from a vertex's front, only in scenes whose backs see nothing.
const FRONT_PILOT_RAYS: u32 = 8;
/// Rays from each point of a vertex's area that tell whether it is in the open.
const OPEN_RAYS: u32 = 4;
/// Seed of the pilot rays, apart from the transfer's.
const SEED: u32 = 0x51de;

/// Marks front vertices whose back sees a front side or the open, and their
/// neighbours, between which values are interpolated.
///
/// Where no back sees anything but backs and no front sees anything at all,
/// the only place for light to bounce is the inside of a body, so all backs
/// exist: a room that was modelled inside out.
pub(super) fn visible_backs(surface: &Surface, level: Level) -> Vec<bool> {
    let shrunken = Shrunken::of(surface);
    let seen: Vec<bool> = (0..surface.vertices.front_count())
        .into_par_iter()
        .map(|v| back_sees(surface, &shrunken, level, v))
        .collect();
    if !seen.contains(&true) && !fronts_see_anything(surface, level) {
        return vec![true; seen.len()];
    }
    let mut wanted = seen.clone();
    for triangle in 0..surface.mesh.triangles.len() as u32 {
        let corners = surface.vertices.of_triangle(triangle, true);
        if corners.iter().any(|&v| seen[v as usize]) {
            corners.iter().for_each(|&v| wanted[v as usize] = true);
        }
    }
    wanted
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

fn back_sees(surface: &Surface, shrunken: &Shrunken, level: Level, vertex: usize) -> bool {
    let sees = |u: &[f32; 4]| {
        let point = shrunken.sample_point(surface, vertex, [u[0], u[1]]);
        let back = SurfacePoint {
            normal: -point.normal,
            flat_normal: -point.flat_normal,
            ..point
        };
        let direction = cosine_direction(back.flat_normal, [u[2], u[3]]);
        shrunken
            .arrival(level, &back, direction)
            .is_none_or(|hit| hit.front)
    };
    pilot_uniforms(vertex, PILOT_RAYS)
        .filter(sees)
        .take(SEEING_RAYS)
        .count()
        == SEEING_RAYS
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
