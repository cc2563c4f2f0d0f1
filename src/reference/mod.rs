//! A diffuse path tracer: the truth that everything else is measured against.
//!
//! Comes in: the same scene, lights and rays as the renderer's. Goes out: a
//! picture with its own noise. It shares no transfer, basis, rasterizer or
//! sample point with the renderer, so a fault there shows; a fault in scene,
//! lights or rays passes between them, which is why a test compares with an
//! independent renderer as well.

mod irradiance;
mod lights;

use glam::Vec3;
use rayon::prelude::*;

use crate::bake::RunSettings;
use crate::frame::Image;
use crate::maths::hash::{hash3, uniform};
use crate::maths::order::Order;
use crate::maths::sampling::{cosine_direction, mirrored_above};
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{Bounces, Camera, PlacedCamera, Scene, max_component};
use crate::simd::Level;
use crate::surface::maps::mean_around;
use crate::surface::{Detail, Ray, Surface, SurfacePoint};
use crate::texture::TextureMap;
pub(crate) use irradiance::{AtVertex, AtVertices, indirect_irradiance};
use lights::{Drawn, Lights};

/// Points of one pixel that one scrambled set covers.
const POINTS_PER_SET: u32 = 1 << 15;
/// With endless bounces, paths of this length begin to be ended by chance.
const ROULETTE_AFTER: u32 = 8;
/// Longest path with endless bounces; at albedo 0.99 it cuts 4e-5 of the light.
const LONGEST: u32 = 1_000;

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
    /// Whether direct light is part of the picture.
    pub direct: bool,
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
    camera: PlacedCamera,
    settings: &'a ReferenceSettings,
}

/// Where a path is: a point with normals on the side it arrived from.
struct Vertex {
    point: SurfacePoint,
    albedo: Vec3,
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
        let counts = |bounce: u32| bounce > 0 || self.settings.direct;
        // How the last direction was drawn; not at all from the eye.
        let mut drawn: Option<Drawn> = None;
        for bounce in 0..=longest + 1 {
            let (vertex, distance) = self.arrive(origin, direction);
            if bounce == 0
                && let Some(lamp) = self.lights.rectangle_seen(origin, direction, distance)
            {
                return if counts(0) { lamp } else { Vec3::ZERO };
            }
            let Some(vertex) = vertex else {
                // What a direction meets belongs to the vertex that it left.
                if counts(bounce.saturating_sub(1)) {
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
            throughput *= vertex.albedo;
            if counts(bounce) {
                let direct =
                    self.lights
                        .irradiance(self.level, &vertex.point, hash3(path, bounce, 7));
                radiance += throughput * direct * std::f32::consts::FRAC_1_PI;
            }
            if bounce == longest && !self.lights.has_sky() {
                break;
            }
            let u = if bounce == 0 {
                first
            } else {
                [0, 1].map(|d| uniform(path, bounce, d))
            };
            let about_normal = cosine_direction(vertex.point.normal, u);
            direction = mirrored_above(about_normal, vertex.point.flat_normal);
            if !self.survives(&mut throughput, bounce, path) {
                break;
            }
            origin = crate::surface::offset_origin(
                vertex.point.position,
                vertex.point.flat_normal,
                direction,
            );
            drawn = Some(Drawn::of(&vertex.point, direction));
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
