//! Direct light: what one light does to one point, and to a vertex's area.

use glam::Vec3;
use rayon::prelude::*;

use super::{Ray, Surface, SurfacePoint, close, offset_origin};
use crate::brdf::{Glossy, ViewedFrame};
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{Incident, LightSample, PlacedLight, PlacedRectangle, max_component};
use crate::simd::Level;

/// Points of a vertex's area where its direct light is not uniform: 8 get
/// nearly all of what averaging gains (decision 2 of the design).
pub(crate) const AREA_POINTS: u32 = 8;
/// Relative difference to a neighbour beyond which a vertex's light is not
/// uniform.
const UNIFORM_WITHIN: f32 = 0.1;
/// Seed of the points of vertices' areas.
const SEED: u32 = 0xd17e;
/// Seed of the points of [`at_vertices_by_many`].
const MANY_SEED: u32 = 0xd181;
/// Shadow rays to a light that is no point, from the first point of a vertex's
/// area.
const POINTS_OF_LIGHT: u32 = 16;
/// The same in a draft: bounces average over many vertices.
const POINTS_OF_LIGHT_IN_A_DRAFT: u32 = 2;
/// The same from each of all eight points, where one is not enough.
const POINTS_OF_LIGHT_EACH: u32 = 8;
/// Seed of the points of lights, seen from vertices.
const LIGHT_SEED: u32 = 0xd17f;
/// Shadow rays end this share of the distance before a local light, so that a
/// light that touches a surface lights it.
const BEFORE_LIGHT: f32 = 1.0 - 1e-4;

/// What shadow rays meet: the surface, and the black rectangles of area lights.
#[derive(Clone, Copy)]
pub(crate) struct Shadows<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) level: Level,
    pub(crate) rectangles: &'a [PlacedRectangle],
}

/// Which low-discrepancy points of a light that is no point shadow rays go to.
#[derive(Clone, Copy)]
pub(crate) struct LightPoints {
    pub(crate) set: ScrambledSobol,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// What shadow rays found of one light at one or more points.
///
/// The light that nothing hides is known in closed form; shadow rays tell the
/// share of it that arrives, each weighted by what it would bring. So a point in
/// full light has no noise. (Rays of several points are summed before the share
/// is formed: a ratio of few rays is biased, four a point by 0.3 % of the Cornell
/// box's direct light.)
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Found<'a> {
    /// The lobe of the points, if radiance by it is asked for.
    pub(crate) lobe: Option<SeenLobe<'a>>,
    /// Sum of the points' radiance by the lobe, W/(m2 sr): of what arrived.
    reflected: Vec3,
    /// Sum of the points' irradiance with nothing in the way, W/m2.
    open: Vec3,
    /// What the rays would bring, all of them and those that arrived.
    all: Vec3,
    lit: Vec3,
    /// Points.
    count: u32,
    /// Whether a ray found a point of the light.
    pub(crate) is_lit: bool,
    /// Whether a ray to the light was blocked.
    pub(crate) is_shadowed: bool,
}

/// A glossy lobe at a point, and where it is seen from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeenLobe<'a> {
    pub(crate) glossy: &'a Glossy,
    pub(crate) frame: ViewedFrame,
}

impl<'a> Found<'a> {
    /// Nothing so far, at points with a lobe.
    pub(crate) fn by(lobe: Option<SeenLobe<'a>>) -> Self {
        Self {
            lobe,
            ..Self::default()
        }
    }

    /// Mean radiance of the points by their lobe, W/(m2 sr).
    pub(crate) fn reflected(&self) -> Vec3 {
        self.reflected / (self.count as f32).at_least(1.0)
    }

    /// Mean irradiance of the points, W/m2.
    pub(crate) fn irradiance(&self) -> Vec3 {
        if !self.is_lit {
            return Vec3::ZERO;
        }
        let open = self.open / self.count as f32;
        if self.is_shadowed {
            open * share_of(self.lit, self.all)
        } else {
            open
        }
    }
}

impl LightPoints {
    /// Points `first` to `first + count` of the set of an index.
    pub(crate) fn of(seed: u32, index: u32, first: u32, count: u32) -> Self {
        Self {
            set: ScrambledSobol::new(seed, index),
            first,
            count,
        }
    }
}

impl<'a> Shadows<'a> {
    /// Shadows of the surface alone.
    pub(crate) fn of_surface(surface: &'a Surface, level: Level) -> Self {
        Self {
            surface,
            level,
            rectangles: &[],
        }
    }

    /// Whether a light's sample is hidden from a point. The shadow ray starts
    /// on the flat triangle.
    pub(crate) fn hidden(&self, sample: &LightSample, point: &SurfacePoint) -> bool {
        let origin = offset_origin(point.position, point.flat_normal, sample.direction);
        let t_max = sample.distance * BEFORE_LIGHT;
        let blocks =
            |rectangle: &PlacedRectangle| rectangle.blocks(origin, sample.direction, t_max);
        self.rectangles.iter().any(blocks)
            || self.surface.rays.occluded(
                self.level,
                &Ray {
                    origin,
                    direction: sample.direction,
                    t_max,
                },
            )
    }

    /// Irradiance of one light at one point, W/m2.
    pub(crate) fn irradiance(
        &self,
        light: &PlacedLight,
        point: &SurfacePoint,
        points: LightPoints,
    ) -> Vec3 {
        let mut found = Found::default();
        self.find(light, point, points, &mut found);
        found.irradiance()
    }

    /// Adds what one light does at one point.
    pub(crate) fn find(
        &self,
        light: &PlacedLight,
        point: &SurfacePoint,
        points: LightPoints,
        found: &mut Found,
    ) {
        let incident = light.incident(point.position, point.normal);
        self.follow_all((&incident, point.position), point, points, found);
    }

    /// Adds what reaches one point, as of what reaches `from`: the point itself,
    /// or another one less than a pixel away. Shadow rays go from the point to
    /// the points of the light all the same.
    pub(crate) fn follow_all(
        &self,
        (incident, from): (&Incident, Vec3),
        point: &SurfacePoint,
        points: LightPoints,
        found: &mut Found,
    ) {
        found.count += 1;
        let open = incident.open();
        if open == Vec3::ZERO {
            return;
        }
        found.open += open;
        if incident.is_sharp() {
            // One ray tells all of this point's light.
            if let Some(sample) = incident.sample([0.0; 2]) {
                self.follow(&sample, open, point, found);
            }
            return;
        }
        let mut asked = false;
        let share = 1.0 / points.count as f32;
        for index in points.first..points.first + points.count {
            let Some(sample) = incident.sample(points.set.point2(index)) else {
                continue;
            };
            let brings = sample.irradiance_on(point.normal);
            if brings != Vec3::ZERO {
                let sample = sample.seen_from(from, point.position);
                self.follow(&sample, brings * share, point, found);
                asked = true;
            }
        }
        // Light that no point of it spoke for counts as if nothing hid it.
        if !asked {
            found.is_lit = true;
            found.all += open;
            found.lit += open;
        }
    }

    /// Follows a shadow ray that would bring so much.
    fn follow(&self, sample: &LightSample, brings: Vec3, point: &SurfacePoint, found: &mut Found) {
        found.all += brings;
        if self.hidden(sample, point) {
            found.is_shadowed = true;
        } else {
            found.is_lit = true;
            found.lit += brings;
            if let Some(lobe) = &found.lobe {
                found.reflected += brings * lobe.glossy.value(&lobe.frame, sample.direction);
            }
        }
    }
}

/// Radiance by a lobe (W/(m2 sr)) of what arrives at a point that nothing hides the
/// light from.
pub(crate) fn reflected_in_the_open(
    incident: &Incident,
    point: &SurfacePoint,
    lobe: &SeenLobe,
    points: LightPoints,
) -> Vec3 {
    let reflected = |sample: LightSample| {
        sample.irradiance_on(point.normal) * lobe.glossy.value(&lobe.frame, sample.direction)
    };
    if incident.is_sharp() {
        return incident.sample([0.0; 2]).map_or(Vec3::ZERO, reflected);
    }
    let indices = points.first..points.first + points.count;
    let samples = indices.filter_map(|index| incident.sample(points.set.point2(index)));
    samples.fold(Vec3::ZERO, |sum, sample| sum + reflected(sample)) / points.count as f32
}

/// Share per channel; none of nothing.
fn share_of(part: Vec3, whole: Vec3) -> Vec3 {
    let share = |part: f32, whole: f32| if whole > 0.0 { part / whole } else { 0.0 };
    Vec3::new(
        share(part.x, whole.x),
        share(part.y, whole.y),
        share(part.z, whole.z),
    )
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
pub(crate) fn at_vertices_by_one_point(shadows: &Shadows, light: &PlacedLight) -> Vec<Vec3> {
    by_one_point(shadows, light, POINTS_OF_LIGHT)
}

/// The same by fewer shadow rays where the light is no point: for a picture that
/// is about to change.
pub(crate) fn at_vertices_in_a_draft(shadows: &Shadows, light: &PlacedLight) -> Vec<Vec3> {
    by_one_point(shadows, light, POINTS_OF_LIGHT_IN_A_DRAFT)
}

fn by_one_point(shadows: &Shadows, light: &PlacedLight, points_of_light: u32) -> Vec<Vec3> {
    (0..shadows.surface.vertices.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|v| {
            let points = AreaPoints::of(shadows.surface, v);
            let first = points.open().next();
            first.map_or(Vec3::ZERO, |index| {
                let to_light = LightPoints::of(LIGHT_SEED, v as u32, 0, points_of_light);
                shadows.irradiance(light, &points.point(index), to_light)
            })
        })
        .collect()
}

/// Irradiance of one light averaged over every vertex's area, W/m2.
///
/// One point decides where it agrees with those of the neighbours; elsewhere,
/// at the borders of shadows and cones, the mean of [`AREA_POINTS`] does, and
/// close to the light an integral.
pub(crate) fn at_vertices(shadows: &Shadows, light: &PlacedLight) -> Vec<Vec3> {
    let coarse = at_vertices_by_one_point(shadows, light);
    let uneven = uneven_vertices(shadows.surface, &coarse);
    (0..coarse.len())
        .into_par_iter()
        .with_min_len(64)
        .map(|v| {
            if uneven[v] {
                area_mean(shadows, light, v)
            } else {
                coarse[v]
            }
        })
        .collect()
}

/// The same by `points` points of every vertex that is wholly in the open, without
/// regard to the neighbours; the others have their [`AREA_POINTS`]. What the few
/// points of [`at_vertices`] are measured by.
pub(crate) fn at_vertices_by_many(
    shadows: &Shadows,
    light: &PlacedLight,
    points: u32,
) -> Vec<Vec3> {
    let vertices = &shadows.surface.vertices;
    (0..vertices.len())
        .into_par_iter()
        .with_min_len(16)
        .map(|v| {
            if vertices.open_points(v) != u8::MAX {
                return area_mean(shadows, light, v);
            }
            // A set of its own: the few points are no part of the many.
            let set = ScrambledSobol::new(MANY_SEED, v as u32);
            // Of lights that are no points; a study's are.
            let of_light = ScrambledSobol::new(MANY_SEED ^ LIGHT_SEED, v as u32);
            let mut found = Found::default();
            for index in 0..points {
                let point = shadows.surface.sample_point(v, set.point2(index));
                let to_light = LightPoints {
                    set: of_light,
                    first: of_light.shuffled(index),
                    count: 1,
                };
                shadows.find(light, &point, to_light, &mut found);
            }
            found.irradiance()
        })
        .collect()
}

fn area_mean(shadows: &Shadows, light: &PlacedLight, vertex: usize) -> Vec3 {
    if shadows.surface.vertices.open_points(vertex) == u8::MAX
        && let Some(irradiance) = close::irradiance(shadows, light, vertex)
    {
        return irradiance;
    }
    let points = AreaPoints::of(shadows.surface, vertex);
    let mut found = Found::default();
    for index in points.open() {
        let first = index * POINTS_OF_LIGHT_EACH;
        let to_light = LightPoints::of(LIGHT_SEED, vertex as u32, first, POINTS_OF_LIGHT_EACH);
        shadows.find(light, &points.point(index), to_light, &mut found);
    }
    found.irradiance()
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
            let (low, high) = (a.at_most(b).at_most(c), a.at_least(b).at_least(c));
            if high - low > UNIFORM_WITHIN * high {
                corners.iter().for_each(|&v| uneven[v as usize] = true);
            }
        }
    }
    uneven
}
