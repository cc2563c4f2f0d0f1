//! A path tracer: the truth that everything else is measured against.
//!
//! Comes in: the same scene, lights and rays as the renderer's. Goes out: a
//! picture with its own noise. It shares no transfer, basis, rasterizer or
//! sample point with the renderer, so a fault there shows; a fault in scene,
//! lights or rays passes between them, which is why a test compares with an
//! independent renderer as well.

mod irradiance;
mod lights;
mod lobes;

use glam::Vec3;
use rayon::prelude::*;

use crate::bake::RunSettings;
use crate::brdf::GlossyMaterials;
use crate::frame::Image;
use crate::maths::hash::{hash3, uniform};
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{Bounces, Camera, Material, PlacedCamera, Scene, max_component};
use crate::simd::Level;
use crate::surface::maps::mean_around;
use crate::surface::{Detail, Ray, Surface, SurfacePoint};
use crate::texture::TextureMap;
pub(crate) use irradiance::{AtVertex, AtVertices, indirect_irradiance};
use lights::{Drawn, Lights};
use lobes::{Branch, Reflection};

/// Points of one pixel that one scrambled set covers.
const POINTS_PER_SET: u32 = 1 << 15;
/// With endless bounces, paths of this length begin to be ended by chance.
const ROULETTE_AFTER: u32 = 8;
/// Longest path with endless bounces; at albedo 0.99 it cuts 4e-5 of the light.
const LONGEST: u32 = 1_000;

/// What a reference picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReferencePart {
    /// All light.
    Global,
    /// Bounced light by the diffuse part of what is seen.
    Indirect,
    /// Light of the sky and of bounces by the lobe of what is seen.
    Glossy,
}

/// Where paths are reflected by glossy lobes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GlossyBounces {
    /// Nowhere: every surface is diffuse, with the lobe's mean directional albedo
    /// beside its own.
    None,
    /// Only where the eye sees them; before that as in [`Self::None`]. What the
    /// renderer approximates.
    Final,
    /// Everywhere.
    All,
}

/// Settings of a reference picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceSettings {
    /// The camera, with the size of the picture.
    pub camera: Camera,
    /// Indirect bounces after the direct light.
    pub bounces: Bounces,
    /// Paths a pixel, at least 2.
    pub samples: u32,
    /// Another seed, another picture with the same mean.
    pub seed: u32,
    /// What of the light is shown.
    pub part: ReferencePart,
    /// Where lobes reflect.
    pub glossy: GlossyBounces,
}

/// A path-traced picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Mean radiance over each pixel, W/(m2 sr), linear.
    pub image: Image,
    /// Standard error of the picture, relative L2: half the difference of the
    /// means of the first and the second half of its paths.
    pub noise: f64,
    /// The same of the mean over the picture.
    pub noise_of_mean: f64,
}

/// Traces a scene. Returns `None` if it was cancelled.
pub fn trace(scene: &Scene, settings: &ReferenceSettings, run: &RunSettings) -> Option<Reference> {
    let surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
    let tracer = Tracer {
        lights: Lights::of(scene, &surface),
        scene,
        glossy: GlossyMaterials::of_all(scene.materials.iter().map(Material::gloss)),
        camera: settings.camera.place(&surface.placement),
        surface: &surface,
        level: run.level,
        settings,
    };
    let [width, height] = settings.camera.size;
    run.progress.stage("paths", u64::from(height));
    let rows: Vec<Vec<[Vec3; 2]>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let pixel = |x| (!run.progress.cancelled()).then(|| tracer.pixel(x, y));
            let row = (0..width).map(pixel).collect::<Option<_>>()?;
            run.progress.advance(1);
            Some(row)
        })
        .collect::<Option<_>>()?;
    Some(joined(width, height, &rows.concat()))
}

/// The picture of two halves, and what their difference says of its noise.
fn joined(width: u32, height: u32, halves: &[[Vec3; 2]]) -> Reference {
    let mean: Vec<Vec3> = halves.iter().map(|[a, b]| (*a + *b) * 0.5).collect();
    let sum = |value: &dyn Fn(usize) -> f64| (0..halves.len()).map(value).sum::<f64>();
    let squares = sum(&|i| f64::from(mean[i].length_squared())).at_least(f64::MIN_POSITIVE);
    let errors = sum(&|i| f64::from(((halves[i][0] - halves[i][1]) * 0.5).length_squared()));
    let total = sum(&|i| f64::from(mean[i].element_sum())).at_least(f64::MIN_POSITIVE);
    let difference = sum(&|i| f64::from((halves[i][0] - halves[i][1]).element_sum()) * 0.5);
    Reference {
        image: Image::new(width, height, mean).expect("a pixel each was traced"),
        noise: (errors / squares).sqrt(),
        noise_of_mean: difference.abs() / total,
    }
}

struct Tracer<'a> {
    surface: &'a Surface,
    level: Level,
    lights: Lights<'a>,
    scene: &'a Scene,
    glossy: GlossyMaterials,
    camera: PlacedCamera,
    settings: &'a ReferenceSettings,
}

/// Where a path is: a point with normals on the side it arrived from.
struct Vertex {
    point: SurfacePoint,
    /// Kd, with its map.
    albedo: Vec3,
    material: u32,
    triangle: u32,
    /// Radiance that the side emits, W/(m2 sr).
    emission: Vec3,
}

impl Tracer<'_> {
    /// Means over the first and the second half of a pixel's paths.
    fn pixel(&self, x: u32, y: u32) -> [Vec3; 2] {
        let pixel = y * self.camera.width + x;
        // Halves in order: even and odd points of a Sobol set lie on different
        // sides of the pixel.
        let first_half = self.settings.samples.div_ceil(2);
        let mut sums = [Vec3::ZERO; 2];
        for sample in 0..self.settings.samples {
            let set = hash3(self.settings.seed, pixel, sample / POINTS_PER_SET);
            let u = ScrambledSobol::new(self.settings.seed, set).point(sample % POINTS_PER_SET);
            let path = hash3(self.settings.seed ^ 0x9a7d, pixel, sample);
            sums[usize::from(sample >= first_half)] += self.radiance(
                f64::from(x) + f64::from(u[0]),
                f64::from(y) + f64::from(u[1]),
                [u[2], u[3]],
                path,
            );
        }
        let second_half = self.settings.samples - first_half;
        [sums[0] / first_half as f32, sums[1] / second_half as f32]
    }

    /// Radiance along one path through pixel coordinates (x, y). `first` are
    /// the uniforms of the first bounce, `path` seeds the others.
    fn radiance(&self, x: f64, y: f64, first: [f32; 2], path: u32) -> Vec3 {
        let direction = self.camera.direction(x, y);
        self.radiance_along((self.camera.eye.as_vec3(), direction), first, path)
    }

    /// Radiance along one path that begins with a ray: origin and direction.
    fn radiance_along(&self, ray: (Vec3, Vec3), first: [f32; 2], path: u32) -> Vec3 {
        let (mut origin, mut direction) = ray;
        let mut throughput = Vec3::ONE;
        let mut radiance = Vec3::ZERO;
        let longest = match self.settings.bounces {
            Bounces::Count(count) => count,
            Bounces::All => LONGEST,
        };
        // Light at the first vertex is direct light.
        let part = self.settings.part;
        let counts = |bounce: u32| bounce > 0 || part == ReferencePart::Global;
        // How the last direction was drawn; not at all from the eye.
        let mut drawn: Option<Drawn> = None;
        for bounce in 0..=longest + 1 {
            let (vertex, distance) = self.arrive(origin, direction);
            if bounce == 0
                && let Some(lamp) = self.lights.rectangle_seen(origin, direction, distance)
            {
                return if counts(0) { lamp } else { Vec3::ZERO };
            }
            if let Some(Drawn::ByLobe(density)) = drawn
                && counts(bounce - 1)
            {
                let ray = (origin, direction);
                let light = self
                    .lights
                    .seen_by_lobe(ray, distance, vertex.as_ref(), density);
                radiance += throughput * light;
            }
            let Some(vertex) = vertex else {
                // What a direction meets belongs to the vertex that it left.
                let from_eye = bounce == 0 && part != ReferencePart::Global;
                if counts(bounce.saturating_sub(1)) || (part == ReferencePart::Glossy && !from_eye)
                {
                    radiance +=
                        throughput * self.lights.sky_seen(origin, direction, drawn.as_ref());
                }
                break;
            };
            if bounce > longest {
                break;
            }
            if bounce == 0 && counts(0) {
                radiance += vertex.emission;
            }
            let reflection = self.reflection(&vertex, -direction, bounce);
            let seed = hash3(path, bounce, 7);
            radiance += throughput * self.next_event(&vertex.point, &reflection, bounce, seed);
            let branch = reflection.branch(bounce, part, uniform(path, bounce, 3));
            let Some(branch) = branch else {
                break;
            };
            let is_last = bounce == longest;
            if is_last && !self.lights.has_sky() && matches!(branch, Branch::Diffuse(_)) {
                break;
            }
            let u = if bounce == 0 {
                first
            } else {
                [0, 1].map(|d| uniform(path, bounce, d))
            };
            let Some(next) = branch.followed(&vertex.point, u) else {
                break;
            };
            throughput *= next.weight;
            if !self.survives(&mut throughput, bounce, path) {
                break;
            }
            direction = next.direction;
            origin = crate::surface::offset_origin(
                vertex.point.position,
                vertex.point.flat_normal,
                direction,
            );
            drawn = Some(next.drawn);
        }
        radiance
    }

    /// How a path's vertex reflects towards where the path came from.
    fn reflection(&self, vertex: &Vertex, to_eye: Vec3, bounce: u32) -> Reflection<'_> {
        let glossy = self.glossy.of(vertex.material);
        let reflects = match self.settings.glossy {
            GlossyBounces::None => false,
            GlossyBounces::Final => bounce == 0,
            GlossyBounces::All => true,
        };
        Reflection::of(vertex.albedo, glossy, reflects, &vertex.point, to_eye)
    }

    /// Radiance by light that comes straight from lights, as far as it counts.
    fn next_event(
        &self,
        point: &SurfacePoint,
        reflection: &Reflection,
        bounce: u32,
        seed: u32,
    ) -> Vec3 {
        let part = self.settings.part;
        let mut radiance = Vec3::ZERO;
        if bounce > 0 || part == ReferencePart::Global {
            let irradiance = self.lights.irradiance(self.level, point, seed);
            radiance += reflection.diffuse * irradiance * std::f32::consts::FRAC_1_PI;
            if let Some(lobe) = &reflection.lobe {
                radiance += self.lights.reflected(self.level, point, lobe, seed);
            }
        }
        let shows_sky = bounce > 0 || part != ReferencePart::Indirect;
        if let Some(lobe) = &reflection.lobe
            && shows_sky
        {
            radiance += self.lights.sky_reflected(self.level, point, lobe, seed);
        }
        radiance
    }

    /// Russian roulette, only where bounces are endless.
    fn survives(&self, throughput: &mut Vec3, bounce: u32, path: u32) -> bool {
        if self.settings.bounces != Bounces::All || bounce < ROULETTE_AFTER {
            return true;
        }
        let chance = max_component(*throughput).at_most(1.0);
        if uniform(path, bounce, 2) >= chance {
            return false;
        }
        *throughput /= chance;
        true
    }

    /// What a ray meets, and how far away.
    fn arrive(&self, origin: Vec3, direction: Vec3) -> (Option<Vertex>, f32) {
        let ray = Ray {
            origin,
            direction,
            t_max: f32::INFINITY,
        };
        let Some(hit) = self.surface.rays.closest(self.level, &ray) else {
            return (None, f32::INFINITY);
        };
        let triangle = &self.surface.mesh.triangles[hit.triangle as usize];
        let front = triangle.flat_normal.dot(direction) < 0.0;
        let mut point = self.surface.point(hit.triangle, hit.barycentrics, front);
        if point.normal.dot(direction) > 0.0 {
            point.normal = -point.normal;
        }
        let site = (hit.triangle, hit.barycentrics);
        let vertex = Vertex {
            point,
            albedo: self.albedo(site),
            material: triangle.material,
            triangle: hit.triangle,
            emission: if front {
                self.lights.emission(site)
            } else {
                Vec3::ZERO
            },
        };
        (Some(vertex), hit.t)
    }

    fn albedo(&self, site: (u32, [f32; 3])) -> Vec3 {
        let material = self.surface.mesh.triangles[site.0 as usize].material;
        let material = &self.scene.materials[material as usize];
        let map = material.albedo_map.as_ref();
        material.albedo * colour_at(self.scene, self.surface, map, site)
    }
}

/// Colour of a map at a point, white without one.
fn colour_at(
    scene: &Scene,
    surface: &Surface,
    map: Option<&TextureMap>,
    site: (u32, [f32; 3]),
) -> Vec3 {
    let point_alone = [Vec3::ZERO; 2];
    map.and_then(|map| mean_around(&surface.mesh, map, scene.texture_filter, site, point_alone))
        .unwrap_or(Vec3::ONE)
}
