//! Direct light: what one light does to one point, and to a vertex's area.

use glam::Vec3;
use rayon::prelude::*;

use super::{Ray, Surface, SurfacePoint, offset_origin};
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{LightSample, PlacedLight, max_component};
use crate::simd::Level;

/// Points of a vertex's area where its direct light is not uniform: 8 get
/// nearly all of what averaging gains (decision 2 of the design).
pub(crate) const AREA_POINTS: u32 = 8;
/// Relative difference to a neighbour beyond which a vertex's light is not
/// uniform.
const UNIFORM_WITHIN: f32 = 0.1;
/// Seed of the points of vertices' areas.
const SEED: u32 = 0xd17e;
/// Shadow rays end this share of the distance before a local light, so that a
/// light that touches a surface lights it.
const BEFORE_LIGHT: f32 = 1.0 - 1e-4;

/// Irradiance that would reach a point from a light's sample if nothing were
/// in the way, W/m2: zero behind the shading normal.
pub(crate) fn unoccluded(sample: &LightSample, point: &SurfacePoint) -> Vec3 {
    let cosine = sample.direction.dot(point.normal);
    if cosine > 0.0 {
        sample.irradiance * cosine
    } else {
        Vec3::ZERO
    }
}

/// Whether a light's sample is hidden from a point. The shadow ray starts on
/// the flat triangle.
pub(crate) fn hidden(
    surface: &Surface,
    level: Level,
    sample: &LightSample,
    point: &SurfacePoint,
) -> bool {
    let origin = offset_origin(point.position, point.flat_normal, sample.direction);
    surface.rays.occluded(
        level,
        &Ray {
            origin,
            direction: sample.direction,
            t_max: sample.distance * BEFORE_LIGHT,
        },
    )
}

/// Irradiance of one light at one point, W/m2, with a shadow ray.
pub(crate) fn irradiance(
    surface: &Surface,
    level: Level,
    light: &PlacedLight,
    point: &SurfacePoint,
) -> Vec3 {
    let sample = light.sample(point.position);
    let open = unoccluded(&sample, point);
    if open == Vec3::ZERO || hidden(surface, level, &sample, point) {
        Vec3::ZERO
    } else {
        open
    }
}

/// Fixed points of a vertex's area, the same in every frame.
pub(super) struct AreaPoints<'a> {
    surface: &'a Surface,
    vertex: usize,
    set: ScrambledSobol,
}

impl<'a> AreaPoints<'a> {
    pub(super) fn of(surface: &'a Surface, vertex: usize) -> Self {
        Self {
            surface,
            vertex,
            set: ScrambledSobol::new(SEED, vertex as u32),
        }
    }

    /// Point `index`, below [`AREA_POINTS`].
    pub(super) fn point(&self, index: u32) -> SurfacePoint {
        self.surface
            .sample_point(self.vertex, self.set.point2(index))
    }

    /// Numbers of the points that are in the open, ascending.
    fn open(&self) -> impl Iterator<Item = u32> + use<> {
        let open = self.surface.vertices.open_points(self.vertex);
        (0..AREA_POINTS).filter(move |index| open >> index & 1 == 1)
    }
}

/// Irradiance of one light at every vertex by one point each, W/m2: the first
/// point of its area that is in the open; zero where none is.
pub(crate) fn at_vertices_by_one_point(
    surface: &Surface,
    level: Level,
    light: &PlacedLight,
) -> Vec<Vec3> {
    (0..surface.vertices.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|v| {
            let points = AreaPoints::of(surface, v);
            let first = points.open().next();
            first.map_or(Vec3::ZERO, |index| {
                irradiance(surface, level, light, &points.point(index))
            })
        })
        .collect()
}

/// Irradiance of one light averaged over every vertex's area, W/m2.
///
/// One point decides where it agrees with those of the neighbours; elsewhere,
/// at the borders of shadows and cones and close to the light, the mean of
/// [`AREA_POINTS`] does.
pub(crate) fn at_vertices(surface: &Surface, level: Level, light: &PlacedLight) -> Vec<Vec3> {
    let coarse = at_vertices_by_one_point(surface, level, light);
    let uneven = uneven_vertices(surface, &coarse);
    (0..coarse.len())
        .into_par_iter()
        .with_min_len(64)
        .map(|v| {
            if uneven[v] {
                area_mean(surface, level, light, v, coarse[v])
            } else {
                coarse[v]
            }
        })
        .collect()
}

fn area_mean(
    surface: &Surface,
    level: Level,
    light: &PlacedLight,
    vertex: usize,
    first: Vec3,
) -> Vec3 {
    let points = AreaPoints::of(surface, vertex);
    let (count, sum) = points
        .open()
        .skip(1)
        .fold((1, first), |(count, sum), index| {
            (
                count + 1,
                sum + irradiance(surface, level, light, &points.point(index)),
            )
        });
    sum / count as f32
}

/// Marks vertices of triangles whose corners differ by more than
/// [`UNIFORM_WITHIN`].
fn uneven_vertices(surface: &Surface, irradiance: &[Vec3]) -> Vec<bool> {
    let brightness: Vec<f32> = irradiance.iter().map(|&e| max_component(e)).collect();
    let mut uneven = vec![false; brightness.len()];
    for triangle in 0..surface.mesh.triangles.len() as u32 {
        for front in [true, false] {
            let corners = surface.vertices.of_triangle(triangle, front);
            if corners.contains(&super::NONE) {
                corners
                    .iter()
                    .filter(|&&v| v != super::NONE)
                    .for_each(|&v| uneven[v as usize] = true);
                continue;
            }
            let [a, b, c] = corners.map(|v| brightness[v as usize]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            if high - low > UNIFORM_WITHIN * high {
                corners.iter().for_each(|&v| uneven[v as usize] = true);
            }
        }
    }
    uneven
}
