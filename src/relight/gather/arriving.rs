//! Radiance that arrives along rays: from the surfaces that they meet, by their
//! lighting vertices, and from the sky.

use glam::Vec3;

use super::GatherLight;
use crate::maths::order::Order;
use crate::maths::sampling::{pick, tangents};
use crate::relight::shade::View;
use crate::scene::{Incident, max_component};
use crate::simd::Hit;
use crate::surface::direct::{Found, LightPoints};
use crate::surface::maps::mean_around;
use crate::surface::{NONE, Ray, SurfacePoint, offset_origin};

/// One direction from which light is wanted.
#[derive(Clone, Copy)]
pub(in crate::relight) struct Wanted {
    /// Unit vector, above the flat triangle that it leaves.
    pub(in crate::relight) direction: Vec3,
    /// Width of the cone of directions that it stands for.
    pub(in crate::relight) spread_rad: f32,
    /// Uniform that draws a light where the ray arrives, and the point of that
    /// light that a shadow ray goes to.
    pub(in crate::relight) light: f32,
    pub(in crate::relight) light_points: LightPoints,
}

/// Radiance from one direction, W/(m2 sr).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(in crate::relight) struct Arriving {
    /// Reflected by a surface, without what that surface emits: emitters are direct
    /// light. Slightly below zero where the basis rings.
    pub(in crate::relight) bounced: Vec3,
    /// From the sky without its suns: these are direct light.
    pub(in crate::relight) sky: Vec3,
    /// 1 / the way that it came, in placed units; 0 from the sky.
    pub(in crate::relight) nearness: f32,
}

/// What rays bring to the points of a view.
pub(in crate::relight) struct Rays<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) light: &'a GatherLight,
    /// Rays sent so far.
    pub(super) sent: u64,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    incidents: Vec<Incident<'a>>,
    chances: Vec<f32>,
}

impl<'a> Rays<'a> {
    pub(in crate::relight) fn new(view: &'a View<'a>, light: &'a GatherLight) -> Self {
        Self {
            view,
            light,
            sent: 0,
            rays: Vec::new(),
            hits: Vec::new(),
            incidents: Vec::new(),
            chances: Vec::new(),
        }
    }

    /// Radiance that arrives at a point from each of some directions, in their
    /// order.
    pub(in crate::relight) fn arriving(
        &mut self,
        from: &SurfacePoint,
        wanted: &[Wanted],
        take: &mut dyn FnMut(Arriving),
    ) {
        self.rays.clear();
        self.rays.extend(wanted.iter().map(|it| Ray {
            origin: offset_origin(from.position, from.flat_normal, it.direction),
            direction: it.direction,
            t_max: f32::INFINITY,
        }));
        self.sent += wanted.len() as u64;
        self.hits.clear();
        self.hits.resize(wanted.len(), None);
        let (view, tree) = (self.view, &self.view.surface.rays);
        tree.closest_many(view.level, &self.rays, &mut self.hits);
        for (index, it) in wanted.iter().enumerate() {
            let mut found = Arriving::default();
            match self.hits[index] {
                Some(hit) => {
                    found.bounced = self.reflected(&hit, it);
                    found.nearness = 1.0 / hit.t.at_least(f32::MIN_POSITIVE);
                }
                None if self.light.parts.sky => {
                    found.sky = view.lights.sky_without_suns(it.direction, it.spread_rad);
                }
                None => {}
            }
            take(found);
        }
    }

    /// Radiance that a surface reflects back along a ray.
    fn reflected(&mut self, hit: &Hit, wanted: &Wanted) -> Vec3 {
        let Some(at_vertices) = &self.light.at_vertices else {
            return Vec3::ZERO;
        };
        let surface = self.view.surface;
        let triangle = &surface.mesh.triangles[hit.triangle as usize];
        let front = triangle.flat_normal.dot(wanted.direction) < 0.0;
        let corners = surface.vertices.of_triangle(hit.triangle, front);
        if corners == [NONE; 3] {
            return Vec3::ZERO;
        }
        let interpolated = |values: &[Vec3]| {
            let weighted = corners.into_iter().zip(hit.barycentrics);
            let there = weighted.filter(|(vertex, _)| *vertex != NONE);
            there.fold(Vec3::ZERO, |sum, (vertex, weight)| {
                sum + values[vertex as usize] * weight
            })
        };
        let mut asks_lights = at_vertices.is_coarse(hit, front);
        let mut point = None;
        if asks_lights || at_vertices.leaning[hit.triangle as usize] {
            let mut seen = surface.point(hit.triangle, hit.barycentrics, front);
            if seen.normal.dot(wanted.direction) > 0.0 {
                // A light on the other side of the shading normal gives nothing, which
                // vertices cannot know.
                seen.normal = -seen.normal;
                asks_lights = true;
            }
            point = Some(seen);
        }
        let irradiance = match point.filter(|_| asks_lights) {
            Some(point) => interpolated(&at_vertices.without_lights) + self.direct(&point, wanted),
            None => interpolated(&at_vertices.irradiance),
        };
        let albedo = self.albedo(hit, hit.t * wanted.spread_rad);
        albedo * irradiance * std::f32::consts::FRAC_1_PI
    }

    /// Share of light that is handed on over a square of side `width` (placed units) about a hit.
    fn albedo(&self, hit: &Hit, width: f32) -> Vec3 {
        let (mesh, scene) = (&self.view.surface.mesh, self.view.scene);
        let triangle = &mesh.triangles[hit.triangle as usize];
        let material = &scene.materials[triangle.material as usize];
        let colour = material.albedo_map.as_ref().and_then(|map| {
            let (t, b) = tangents(triangle.flat_normal);
            let site = (hit.triangle, hit.barycentrics);
            let around = [t * width, b * width];
            mean_around(mesh, map, scene.texture_filter, site, around)
        });
        let diffuse = material.albedo * colour.unwrap_or(Vec3::ONE);
        match self.view.glossy.of(triangle.material) {
            Some(glossy) => {
                let by_lobe = glossy.mean_albedo();
                diffuse * (Vec3::ONE - by_lobe) + by_lobe
            }
            None => diffuse,
        }
    }

    /// Irradiance of the lights at a point by one shadow ray, W/m2: to a light drawn
    /// by what it would bring.
    fn direct(&mut self, point: &SurfacePoint, wanted: &Wanted) -> Vec3 {
        let (incidents, chances) = (&mut self.incidents, &mut self.chances);
        incidents.clear();
        chances.clear();
        let mut total = 0.0;
        for light in &self.view.lights.sources {
            let incident = light.incident(point.position, point.normal);
            total += max_component(incident.open());
            incidents.push(incident);
            chances.push(total);
        }
        if total <= 0.0 {
            return Vec3::ZERO;
        }
        let drawn = pick(chances, wanted.light);
        let before = drawn.checked_sub(1).map_or(0.0, |index| chances[index]);
        let chance = (chances[drawn] - before) / total;
        if chance <= 0.0 {
            return Vec3::ZERO;
        }
        let mut found = Found::default();
        let arriving = (&incidents[drawn], point.position);
        let shadows = self.view.shadows();
        shadows.follow_all(arriving, point, wanted.light_points, &mut found);
        found.irradiance() / chance
    }
}
