//! Direct light at a path's vertex: one point of every light, drawn at random.
//!
//! Emitting surfaces are drawn by power over the lighting mesh and environment
//! maps by brightness, with none of the closed forms, light trees, cells and
//! extracted suns of the renderer, so that a fault there shows.

use glam::Vec3;

use super::{Vertex, colour_at};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::maths::sampling::{mirrored_cosine_density, pick};
use crate::scene::{
    LightSample, PlacedEnvironment, PlacedLight, PlacedLights, PlacedRectangle, PlacedSun, Scene,
    max_component,
};
use crate::simd::Level;
use crate::surface::direct::{Found, LightPoints, SeenLobe, Shadows};
use crate::surface::{Surface, SurfacePoint};

/// The lights of a scene as paths use them.
pub(super) struct Lights<'a> {
    scene: &'a Scene,
    surface: &'a Surface,
    /// Points, spots, directional lights.
    sharp: Vec<PlacedLight>,
    rectangles: Vec<PlacedRectangle>,
    skies: Vec<PlacedEnvironment>,
    /// Suns of the skies' maps: rectangles block them, as they block any light
    /// with shadow rays, but not the rest of the sky.
    suns: Vec<PlacedSun>,
    /// Triangles of the lighting mesh that emit.
    emitting: Vec<u32>,
    /// Area x largest channel of emission, up to and with each of these.
    cumulative_power: Vec<f32>,
}

/// How a path's direction was drawn.
pub(super) enum Drawn {
    /// About the normal, with this density, 1/sr.
    Diffuse(f32),
    /// By a glossy lobe, with this density, 1/sr.
    ByLobe(f32),
}

impl Drawn {
    pub(super) fn diffuse(point: &SurfacePoint, direction: Vec3) -> Self {
        Self::Diffuse(path_density(point, direction))
    }

    fn density(&self) -> f32 {
        match self {
            Self::Diffuse(density) | Self::ByLobe(density) => *density,
        }
    }
}

/// Density (1/sr) of a path's directions.
fn path_density(point: &SurfacePoint, direction: Vec3) -> f32 {
    mirrored_cosine_density(point.normal, point.flat_normal, direction)
}

impl<'a> Lights<'a> {
    pub(super) fn of(scene: &'a Scene, surface: &'a Surface) -> Self {
        let placed = PlacedLights::of(scene, &surface.placement);
        let triangles = &surface.mesh.triangles;
        let emission = |t: u32| scene.materials[triangles[t as usize].material as usize].emission;
        let emitting: Vec<u32> = (0..triangles.len() as u32)
            .filter(|&t| emission(t) != Vec3::ZERO)
            .collect();
        let cumulative_power = emitting
            .iter()
            .scan(0.0, |total, &t| {
                *total += triangles[t as usize].area * max_component(emission(t));
                Some(*total)
            })
            .collect();
        Self {
            scene,
            surface,
            sharp: placed
                .sources
                .iter()
                .filter(|light| light.is_sharp())
                .cloned()
                .collect(),
            suns: placed.suns(),
            rectangles: placed.rectangles,
            skies: placed.skies,
            emitting,
            cumulative_power,
        }
    }

    /// One light without a shape, alone; nothing emits.
    pub(super) fn alone(scene: &'a Scene, surface: &'a Surface, light: PlacedLight) -> Self {
        Self {
            scene,
            surface,
            sharp: vec![light],
            rectangles: Vec::new(),
            skies: Vec::new(),
            suns: Vec::new(),
            emitting: Vec::new(),
            cumulative_power: Vec::new(),
        }
    }

    pub(super) fn has_sky(&self) -> bool {
        !self.skies.is_empty()
    }

    /// Radiance that a point of the mesh emits on its front, W/(m2 sr).
    pub(super) fn emission(&self, site: (u32, [f32; 3])) -> Vec3 {
        let material = self.surface.mesh.triangles[site.0 as usize].material;
        let material = &self.scene.materials[material as usize];
        if material.emission == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let map = material.emission_map.as_ref();
        material.emission * colour_at(self.scene, self.surface, map, site)
    }

    /// Radiance of the rectangle that a ray from the eye meets before
    /// `distance`; black from behind.
    pub(super) fn rectangle_seen(
        &self,
        origin: Vec3,
        direction: Vec3,
        distance: f32,
    ) -> Option<Vec3> {
        let mut nearest = (distance, None);
        for rectangle in &self.rectangles {
            if let Some(t) = rectangle.hit(origin, direction)
                && t < nearest.0
            {
                let faces = rectangle.normal.as_vec3().dot(direction) < 0.0;
                let radiance = if faces {
                    rectangle.radiance
                } else {
                    Vec3::ZERO
                };
                nearest = (t, Some(radiance));
            }
        }
        nearest.1
    }

    /// Radiance of the sky along a path's direction, weighted against the
    /// directions that [`Self::irradiance`] draws (balance heuristic, Veach and
    /// Guibas 1995).
    pub(super) fn sky_seen(&self, origin: Vec3, direction: Vec3, drawn: Option<&Drawn>) -> Vec3 {
        if drawn.is_some() && self.is_blocked_sun(origin, direction) {
            return Vec3::ZERO;
        }
        self.skies.iter().fold(Vec3::ZERO, |sum, sky| {
            let weight = drawn.map_or(1.0, |drawn| {
                drawn.density() / (drawn.density() + sky.density(direction))
            });
            sum + sky.radiance(direction, 0.0) * weight
        })
    }

    /// Whether a direction leads to a sun with a rectangle in the way.
    fn is_blocked_sun(&self, origin: Vec3, direction: Vec3) -> bool {
        self.suns.iter().any(|sun| sun.contains(direction))
            && self
                .rectangles
                .iter()
                .any(|rectangle| rectangle.blocks(origin, direction, f32::INFINITY))
    }

    /// Irradiance at a point by one point of every light, W/m2.
    pub(super) fn irradiance(&self, level: Level, point: &SurfacePoint, seed: u32) -> Vec3 {
        let shadows = Shadows {
            surface: self.surface,
            level,
            rectangles: &self.rectangles,
        };
        let one = LightPoints::of(0, 0, 0, 1);
        let mut sum = self.sharp.iter().fold(Vec3::ZERO, |sum, light| {
            sum + shadows.irradiance(light, point, one)
        });
        for (index, rectangle) in self.rectangles.iter().enumerate() {
            let u = [0, 1].map(|d| uniform(seed, index as u32, d));
            sum += arriving(&shadows, point, &of_rectangle(rectangle, point, u));
        }
        if !self.emitting.is_empty() {
            let u = [2, 3, 4].map(|d| uniform(seed, 0, d));
            sum += arriving(&shadows, point, &self.of_mesh(point, u));
        }
        // The transfer ignores rectangles, and the sky's light comes through it.
        let sky_shadows = Shadows::of_surface(self.surface, level);
        for (index, sky) in self.skies.iter().enumerate() {
            let u = [5, 6].map(|d| uniform(seed, index as u32, d));
            sum += self.of_sky(&sky_shadows, sky, point, u);
        }
        sum
    }

    /// Radiance by a lobe of one point of every light but the skies, W/(m2 sr);
    /// light of surfaces is weighted against the lobe's own directions.
    pub(super) fn reflected(
        &self,
        level: Level,
        point: &SurfacePoint,
        lobe: &SeenLobe,
        seed: u32,
    ) -> Vec3 {
        let shadows = Shadows {
            surface: self.surface,
            level,
            rectangles: &self.rectangles,
        };
        let mut sum = Vec3::ZERO;
        for light in &self.sharp {
            let mut found = Found::by(Some(*lobe));
            shadows.find(light, point, LightPoints::of(0, 0, 0, 1), &mut found);
            sum += found.reflected();
        }
        let by_lobe = |(sample, density): (LightSample, f32)| {
            // A path's own directions do not lead there.
            if sample.direction.dot(point.flat_normal) <= 0.0 {
                return Vec3::ZERO;
            }
            let arriving = arriving(&shadows, point, &sample);
            let drawn = lobe.glossy.density(&lobe.frame, sample.direction);
            let weight = density / (density + drawn).at_least(f32::MIN_POSITIVE);
            arriving * lobe.glossy.value(&lobe.frame, sample.direction) * weight
        };
        for (index, rectangle) in self.rectangles.iter().enumerate() {
            let u = [10, 11].map(|d| uniform(seed, index as u32, d));
            let sample = of_rectangle(rectangle, point, u);
            let cosine = -sample.direction.dot(rectangle.normal.as_vec3());
            sum += by_lobe((
                sample,
                density_of(area_of(rectangle), sample.distance, cosine),
            ));
        }
        if !self.emitting.is_empty() {
            let u = [12, 13, 14].map(|d| uniform(seed, 0, d));
            let (triangle, sample) = self.drawn_of_mesh(point, u);
            sum += by_lobe((sample, self.mesh_density(triangle, &sample)));
        }
        sum
    }

    /// Radiance by a lobe of one direction of every sky, W/(m2 sr), weighted
    /// against the lobe's own directions.
    pub(super) fn sky_reflected(
        &self,
        level: Level,
        point: &SurfacePoint,
        lobe: &SeenLobe,
        seed: u32,
    ) -> Vec3 {
        let shadows = Shadows::of_surface(self.surface, level);
        let mut sum = Vec3::ZERO;
        for (index, sky) in self.skies.iter().enumerate() {
            let u = [15, 16].map(|d| uniform(seed, index as u32, d));
            let Some((direction, density)) = sky.sample(u) else {
                continue;
            };
            let cosine = direction.dot(point.normal);
            let is_above = cosine > 0.0 && direction.dot(point.flat_normal) > 0.0;
            let sample = LightSample {
                direction,
                distance: f32::INFINITY,
                irradiance: Vec3::ZERO,
            };
            if !is_above
                || self.is_blocked_sun(point.position, direction)
                || shadows.hidden(&sample, point)
            {
                continue;
            }
            let drawn = lobe.glossy.density(&lobe.frame, direction);
            let value = lobe.glossy.value(&lobe.frame, direction);
            sum += sky.radiance(direction, 0.0) * value * (cosine / (density + drawn));
        }
        sum
    }

    /// Radiance of the light that a direction of a lobe (with its origin) meets
    /// before or at a vertex of the path, weighted against [`Self::reflected`].
    pub(super) fn seen_by_lobe(
        &self,
        (origin, direction): (Vec3, Vec3),
        distance: f32,
        vertex: Option<&Vertex>,
        drawn: f32,
    ) -> Vec3 {
        let weight = |density: f32| drawn / (drawn + density).at_least(f32::MIN_POSITIVE);
        let rectangles = self.rectangles.iter();
        let hits = rectangles.filter_map(|r| r.hit(origin, direction).map(|t| (t, r)));
        let nearest = hits
            .filter(|(t, _)| *t < distance)
            .reduce(|a, b| if b.0 < a.0 { b } else { a });
        if let Some((t, rectangle)) = nearest {
            let cosine = -rectangle.normal.as_vec3().dot(direction);
            if cosine <= 0.0 {
                return Vec3::ZERO;
            }
            return rectangle.radiance * weight(density_of(area_of(rectangle), t, cosine));
        }
        let Some(vertex) = vertex.filter(|vertex| vertex.emission != Vec3::ZERO) else {
            return Vec3::ZERO;
        };
        let sample = LightSample {
            direction,
            distance,
            irradiance: Vec3::ZERO,
        };
        vertex.emission * weight(self.mesh_density(vertex.triangle, &sample))
    }

    /// Density (1/sr) of directions to an emitting triangle by
    /// [`Self::drawn_of_mesh`].
    fn mesh_density(&self, triangle: u32, sample: &LightSample) -> f32 {
        let mesh = &self.surface.mesh.triangles[triangle as usize];
        let emission = self.scene.materials[mesh.material as usize].emission;
        let Some(total) = self.cumulative_power.last() else {
            return 0.0;
        };
        let cosine = -sample.direction.dot(mesh.flat_normal);
        // The chance of the triangle over its area is its emission over all power.
        let area = total / max_component(emission).at_least(f32::MIN_POSITIVE);
        density_of(area, sample.distance, cosine)
    }

    /// A point of the emitting mesh, drawn by power.
    fn of_mesh(&self, point: &SurfacePoint, u: [f32; 3]) -> LightSample {
        self.drawn_of_mesh(point, u).1
    }

    /// The same with its triangle.
    fn drawn_of_mesh(&self, point: &SurfacePoint, [u, v, w]: [f32; 3]) -> (u32, LightSample) {
        let index = pick(&self.cumulative_power, u);
        let triangle = self.emitting[index];
        let before = index
            .checked_sub(1)
            .map_or(0.0, |i| self.cumulative_power[i]);
        let total = self.cumulative_power[self.cumulative_power.len() - 1];
        let chance = (self.cumulative_power[index] - before) / total;
        // Uniform over the triangle (Turk 1990).
        let root = v.sqrt();
        let site = (triangle, [1.0 - root, root * (1.0 - w), root * w]);
        let there = self.surface.point(triangle, site.1, true);
        let area = self.surface.mesh.triangles[triangle as usize].area;
        let intensity = self.emission(site) * (area / chance);
        let sample = toward(point, there.position, there.flat_normal, intensity);
        (triangle, sample)
    }

    /// Irradiance of a sky by one direction drawn by its brightness, weighted
    /// against the path's own direction; a sky without a map is left to that.
    fn of_sky(
        &self,
        shadows: &Shadows,
        sky: &PlacedEnvironment,
        point: &SurfacePoint,
        u: [f32; 2],
    ) -> Vec3 {
        let Some((direction, density)) = sky.sample(u) else {
            return Vec3::ZERO;
        };
        let of_path = path_density(point, direction);
        if of_path <= 0.0 || self.is_blocked_sun(point.position, direction) {
            return Vec3::ZERO;
        }
        let sample = LightSample {
            direction,
            distance: f32::INFINITY,
            irradiance: Vec3::ZERO,
        };
        if shadows.hidden(&sample, point) {
            return Vec3::ZERO;
        }
        let weighted = of_path / (of_path + density);
        sky.radiance(direction, 0.0) * (weighted * std::f32::consts::PI)
    }
}

/// A point of a rectangle, uniform over its area.
fn of_rectangle(rectangle: &PlacedRectangle, point: &SurfacePoint, u: [f32; 2]) -> LightSample {
    let there =
        rectangle.corner + rectangle.edge_u * f64::from(u[0]) + rectangle.edge_v * f64::from(u[1]);
    let area = area_of(rectangle);
    toward(
        point,
        there.as_vec3(),
        rectangle.normal.as_vec3(),
        rectangle.radiance * area,
    )
}

/// Square placed units.
fn area_of(rectangle: &PlacedRectangle) -> f32 {
    rectangle.edge_u.cross(rectangle.edge_v).length() as f32
}

/// Density (1/sr) of directions to points that are uniform over an area whose
/// normal has a cosine to the direction back.
fn density_of(area: f32, distance: f32, cosine: f32) -> f32 {
    distance * distance / (area * cosine.at_least(1e-6))
}

/// What a piece of a light sends to a point; `intensity` is its radiance x area
/// in placed units.
fn toward(point: &SurfacePoint, there: Vec3, normal: Vec3, intensity: Vec3) -> LightSample {
    let to_light = there - point.position;
    let squared = to_light.length_squared().at_least(f32::MIN_POSITIVE);
    let distance = squared.sqrt();
    let direction = to_light / distance;
    let cosine = (-direction).dot(normal).at_least(0.0);
    LightSample {
        direction,
        distance,
        irradiance: intensity * (cosine / squared),
    }
}

/// Irradiance of a sample after its shadow ray.
fn arriving(shadows: &Shadows, point: &SurfacePoint, sample: &LightSample) -> Vec3 {
    let open = sample.irradiance_on(point.normal);
    if open == Vec3::ZERO || shadows.hidden(sample, point) {
        Vec3::ZERO
    } else {
        open
    }
}
