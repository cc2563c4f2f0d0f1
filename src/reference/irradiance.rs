//! Indirect irradiance of vertices by paths.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::lights::Lights;
use super::{GlossyBounces, ReferencePart, ReferenceSettings, Tracer};
use crate::bake::RunSettings;
use crate::brdf::GlossyMaterials;
use crate::maths::hash::{hash3, uniform};
use crate::maths::sampling::{cosine_direction, mirrored_above};
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{Bounces, Material, PlacedLight, Scene};
use crate::surface::{NONE, Surface, offset_origin};

/// Independent batches of a vertex's paths.
const BATCHES: u32 = 16;

/// Which vertices, by how many paths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AtVertices<'a> {
    pub(crate) vertices: &'a [u32],
    /// Indirect bounces, at least 1.
    pub(crate) bounces: u32,
    /// Paths a vertex; a multiple of 16.
    pub(crate) samples: u32,
    pub(crate) seed: u32,
}

/// Mean over a vertex's area.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct AtVertex {
    /// Indirect irradiance, W/m2.
    pub(crate) irradiance: Vec3,
    /// Its variance, from the spread between batches of paths.
    pub(crate) variance: Vec3,
}

/// Indirect irradiance of vertices under one light without a shape; nothing else
/// in the scene emits. The surface has its back sides. `None` if it was stopped.
pub(crate) fn indirect_irradiance(
    scene: &Scene,
    surface: &Surface,
    light: &PlacedLight,
    what: &AtVertices,
    run: &RunSettings,
) -> Option<Vec<AtVertex>> {
    let mut dark = scene.clone();
    for material in &mut dark.materials {
        material.emission = Vec3::ZERO;
    }
    let settings = ReferenceSettings {
        camera: dark.camera,
        bounces: Bounces::Count(what.bounces - 1),
        samples: what.samples,
        seed: what.seed,
        part: ReferencePart::Global,
        glossy: GlossyBounces::None,
    };
    let tracer = Tracer {
        lights: Lights::alone(&dark, surface, light.clone()),
        scene: &dark,
        glossy: GlossyMaterials::of_all(dark.materials.iter().map(Material::gloss)),
        camera: settings.camera.place(&surface.placement),
        surface,
        level: run.level,
        settings: &settings,
    };
    what.vertices
        .par_iter()
        .map(|&vertex| {
            run.progress.advance(1);
            (!run.progress.cancelled()).then(|| tracer.at_vertex(vertex))
        })
        .collect()
}

impl Tracer<'_> {
    /// The mean over batches of paths, each of a scrambled set of its own, whose
    /// spread is the variance.
    fn at_vertex(&self, vertex: u32) -> AtVertex {
        let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        for batch in 0..BATCHES {
            let mean = self.batch_at_vertex(vertex, batch);
            sum += mean;
            squares += mean * mean;
        }
        let count = f64::from(BATCHES);
        let mean = sum / count;
        let variance = (squares / count - mean * mean) / (count - 1.0);
        AtVertex {
            irradiance: mean.as_vec3(),
            variance: variance.max(DVec3::ZERO).as_vec3(),
        }
    }

    /// pi x the mean radiance of cosine-weighted directions from the points of a
    /// vertex's area that are not inside a body.
    fn batch_at_vertex(&self, vertex: u32, batch: u32) -> DVec3 {
        let surface = self.surface;
        let set = hash3(self.settings.seed, vertex, batch);
        let points = ScrambledSobol::new(self.settings.seed, set);
        let mut sum = DVec3::ZERO;
        let mut count = 0;
        for sample in 0..(self.settings.samples / BATCHES).max(1) {
            let u = points.point(sample);
            let from = surface.sample_point(vertex as usize, [u[0], u[1]]);
            let about_normal = cosine_direction(from.normal, [u[2], u[3]]);
            let direction = mirrored_above(about_normal, from.flat_normal);
            count += 1;
            let Some(hit) = surface.arrival(self.level, &from, direction) else {
                continue;
            };
            if surface.vertices.of_triangle(hit.triangle, hit.front) == [NONE; 3] {
                count -= 1;
                continue;
            }
            let path = hash3(self.settings.seed ^ 0x1a7d, set, sample);
            let first = [3, 4].map(|dimension| uniform(path, 0, dimension));
            let origin = offset_origin(from.position, from.flat_normal, direction);
            let radiance = self.radiance_along((origin, direction), first, path);
            sum += radiance.as_dvec3() * std::f64::consts::PI;
        }
        sum / f64::from(count.max(1))
    }
}
