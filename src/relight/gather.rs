//! One final gather a pixel: its indirect light, and the sky's, by rays of its own.
//!
//! Vertices are half an edge apart from what a pixel shows, and their light is a mean
//! over edges. Seen over a gap that is no longer to be noticed, so a pixel sends rays
//! and reads the vertices where these arrive: with N bounces, the radiosity
//! rho (E0 + E^(N-1)), since the ray itself is the last bounce. Where a ray arrives so
//! close that the mesh shows, at the edge of a shadow, or from the other side of a
//! shading normal, E0 is asked for there by a shadow ray.
//!
//! A pixel's rays are cosine-distributed, so its irradiance is pi x the mean radiance
//! that they bring; where what sends light is far, it is fitted to some pixels around
//! (`smooth`) (Reichert, "A Two-Pass Radiosity Method Driven by Lights and Viewer
//! Position", 1992; Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001).

mod arriving;
mod lobe;
mod points;
mod smooth;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use rayon::prelude::*;

pub(super) use arriving::{Arriving, Rays, Wanted};
use points::{MOST_RAYS, PixelPoints};
use smooth::{Moments, smoothed};

use super::frame::GatheredParts;
use super::raster::Fragment;
use super::reach::seen_point;
use super::shade::View;
use super::sites::Sites;
use crate::bake::Progress;
use crate::maths::order::Order;
use crate::maths::sampling::{cosine_direction, mirrored_above};
use crate::scene::max_component;
use crate::simd::Hit;
use crate::surface::direct::SeenLobe;
use crate::surface::{NONE, Surface, SurfacePoint};

/// Rays a pixel. In the Cornell box (320 x 240) 256 leave 0.7 % of noise a pixel
/// (relRMSE), 128 leave 1.3 %, 64 leave 2.3 % and 16 leave 6.7 %; FLIP against a
/// reference that has 1.2 % itself is 0.016, -, 0.021 and 0.038. More would not fit
/// the sets of points, and means of 8 x 8 pixels gain next to nothing: 0.18 % with
/// 256, 0.22 % with 64, of which the reference's own noise is 0.15 %.
pub(super) const RAYS: u32 = 256;
/// Samples of a pixel of more than one surface; each takes an equal part of its rays.
const SAMPLES: u32 = 16;
/// Sites that one task takes.
const SITES_A_TASK: usize = 256;
/// A surface nearer than so many of its edge's lengths shows its triangles: the
/// shadow of a thing that stands on it may pass between corners that agree. (In a
/// Cornell box of edges of 0.2 m this is rare: the error of 8 x 8 means is 0.239 %
/// with 0 and 0.238 % with 1 and 2.)
const NEAR: f32 = 1.0;
/// Relative difference of a triangle's corners beyond which its direct light is not
/// interpolated. In a Cornell box of edges of 0.2 m the error of 8 x 8 means is
/// 0.377 % where all is interpolated, 0.264 % with 0.3, 0.238 % with 0.1 and 0.234 %
/// where nothing is; that of interpolated light at pixels is 0.609 %.
const UNIFORM_WITHIN: f32 = 0.1;

/// Cosine of the angle from which on a normal leans, 0.8 degrees: walls with normals of
/// their own never do, to rounding. Rays within the angle of the surface are hardly any.
const LEANS_BELOW: f32 = 0.9999;

const _: () = assert!(RAYS <= MOST_RAYS && RAYS.is_multiple_of(SAMPLES));

/// What rays read.
#[derive(Debug, Default)]
pub(crate) struct GatherLight {
    /// What of it is shown; rays are sent for nothing else.
    pub(super) parts: GatheredParts,
    /// What rays that arrive bring; nothing where nothing bounces.
    pub(crate) at_vertices: Option<LitVertices>,
}

/// Irradiance of the lighting vertices, W/m2.
#[derive(Debug)]
pub(crate) struct LitVertices {
    /// E0 + E^(N-1): of the lights, the sky, and one bounce less than the frame's.
    irradiance: Vec<Vec3>,
    /// The same without the lights: the sky's and bounced light.
    without_lights: Vec<Vec3>,
    /// Per triangle, whether E0 differs between its corners; front and back.
    uneven: Vec<[bool; 2]>,
    /// Per triangle, whether its shading normals lean, so that a ray may meet it from
    /// their other side.
    leaning: Vec<bool>,
    /// Length of an edge of each triangle's size, placed units.
    edges: Vec<f32>,
}

/// What rays have brought to a site: irradiance, W/m2, and radiance by a lobe.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Gathered {
    /// Bounced light from surfaces that are near the site, as its pixel goes, and from
    /// the others.
    near: Vec3,
    far: Vec3,
    pub(super) sky: Vec3,
    /// Radiance by the lobe of bounced light and the sky, W/(m2 sr).
    pub(super) glossy: Vec3,
    /// 1 / the harmonic mean of the rays' lengths, in placed units.
    nearness: f32,
    /// The same, with no ray shorter than the reach from which on it is far.
    nearness_of_far: f32,
    /// Of the bounced light that comes from afar, and of the sky's.
    of_far: Moments,
    of_sky: Moments,
}

impl LitVertices {
    /// From the irradiance of all direct light, of the sky alone (none where it is
    /// empty) and of bounced light with one bounce less than the frame's.
    pub(crate) fn new(surface: &Surface, direct: &[Vec3], sky: &[Vec3], bounced: &[Vec3]) -> Self {
        let of_sky = |vertex: usize| sky.get(vertex).copied().unwrap_or(Vec3::ZERO);
        let sum = |(direct, bounced): (&Vec3, &Vec3)| *direct + *bounced;
        let triangles = 0..surface.mesh.triangles.len() as u32;
        Self {
            irradiance: direct.iter().zip(bounced).map(sum).collect(),
            without_lights: (0..bounced.len()).map(|v| bounced[v] + of_sky(v)).collect(),
            uneven: triangles
                .map(|t| [true, false].map(|front| is_uneven(surface, direct, (t, front))))
                .collect(),
            leaning: (0..surface.mesh.triangles.len() as u32)
                .map(|t| leans(surface, t))
                .collect(),
            // Of an equilateral triangle of the same area.
            edges: surface
                .mesh
                .triangles
                .iter()
                .map(|t| (t.area * (4.0 / 3.0_f32.sqrt())).sqrt())
                .collect(),
        }
    }

    /// Whether a ray sees more of a surface than its vertices have.
    fn is_coarse(&self, hit: &Hit, front: bool) -> bool {
        let triangle = hit.triangle as usize;
        self.uneven[triangle][usize::from(!front)] || hit.t < NEAR * self.edges[triangle]
    }
}

/// Whether a corner's shading normal is another than the triangle's own.
fn leans(surface: &Surface, triangle: u32) -> bool {
    let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    corners.into_iter().any(|corner| {
        let point = surface.point(triangle, corner, true);
        point.normal.dot(point.flat_normal) < LEANS_BELOW
    })
}

fn is_uneven(surface: &Surface, direct: &[Vec3], (triangle, front): (u32, bool)) -> bool {
    let corners = surface.vertices.of_triangle(triangle, front);
    if corners.contains(&NONE) {
        return true;
    }
    let [a, b, c] = corners.map(|vertex| max_component(direct[vertex as usize]));
    let (low, high) = (a.at_most(b).at_most(c), a.at_least(b).at_least(c));
    high - low > UNIFORM_WITHIN * high
}

/// What arrives at every site of a picture, and the rays that were sent; `None` if
/// it was stopped.
pub(super) fn at_sites(
    view: &View,
    light: &GatherLight,
    sites: &Sites,
    progress: &dyn Progress,
) -> Option<(Vec<Gathered>, u64)> {
    let sent = AtomicU64::new(0);
    let mut found = vec![Gathered::default(); sites.len()];
    let pixels_of_groups = sites.pixels_of_groups();
    progress.stage("gather", found.len().div_ceil(SITES_A_TASK) as u64);
    let tasks = found.par_chunks_mut(SITES_A_TASK).enumerate();
    tasks
        .try_for_each(|(task, found)| {
            if progress.cancelled() {
                return None;
            }
            let mut rays = Rays::new(view, light);
            for (index, gathered) in found.iter_mut().enumerate() {
                let site = task * SITES_A_TASK + index;
                *gathered = match site.checked_sub(sites.pixel_count()) {
                    None if sites.edges[site] => Gathered::default(),
                    None => at_pixel(&mut rays, view, sites, site),
                    Some(group) => {
                        let pixel = pixels_of_groups[group];
                        at_group(&mut rays, view, sites, (pixel, group))
                    }
                };
            }
            sent.fetch_add(rays.sent, Ordering::Relaxed);
            progress.advance(1);
            Some(())
        })
        .map(|()| {
            let found = match light.parts.irradiance {
                true => smoothed(view, sites, &found),
                false => found,
            };
            (found, sent.into_inner())
        })
}

/// A pixel of one surface: all rays start from its centre.
fn at_pixel(rays: &mut Rays, view: &View, sites: &Sites, pixel: usize) -> Gathered {
    let Some(point) = &sites.points[pixel] else {
        return Gathered::default();
    };
    let points = PixelPoints::of(pixel as u32, view.camera.width, RAYS);
    let mut sum = Gathered::default();
    let lobe = view.lobe(&sites.centers.fragments[pixel], point);
    add(rays, (point, lobe), &points, 0..RAYS, &mut sum);
    sum.mean(RAYS)
}

/// One surface of a pixel of several: each of its samples sends a sixteenth of the
/// rays, and those of all surfaces together are one pixel's.
fn at_group(rays: &mut Rays, view: &View, sites: &Sites, (pixel, group): (u32, usize)) -> Gathered {
    let samples = sites.samples.pixel(pixel as usize);
    let samples: &[Fragment; 16] = samples.expect("a pixel of an edge has samples");
    let members = sites.group(group).members;
    let points = PixelPoints::of(pixel, view.camera.width, RAYS);
    let (mut sum, mut count) = (Gathered::default(), 0);
    for sample in (0..SAMPLES).filter(|sample| members >> sample & 1 == 1) {
        let fragment = &samples[sample as usize];
        if let Some(point) = seen_point(view, fragment) {
            let first = sample * (RAYS / SAMPLES);
            add(
                rays,
                (&point, view.lobe(fragment, &point)),
                &points,
                first..first + RAYS / SAMPLES,
                &mut sum,
            );
            count += RAYS / SAMPLES;
        }
    }
    sum.mean(count)
}

/// Adds what some of a pixel's rays bring to a point.
fn add(
    rays: &mut Rays,
    (from, lobe): (&SurfacePoint, Option<SeenLobe>),
    points: &PixelPoints,
    numbers: std::ops::Range<u32>,
    sum: &mut Gathered,
) {
    if let Some(lobe) = lobe.filter(|_| rays.light.parts.by_lobes) {
        sum.glossy += lobe::gathered(rays, from, &lobe, points, numbers.clone());
    }
    if !rays.light.parts.irradiance {
        return;
    }
    // Of a hemisphere that is weighted by the cosine, which is pi of solid angle.
    let spread_rad = (std::f32::consts::PI / RAYS as f32).sqrt();
    let wanted: Vec<Wanted> = numbers
        .map(|number| {
            let [u, v, light, _] = points.uniforms(number);
            let about_normal = cosine_direction(from.normal, [u, v]);
            Wanted {
                direction: mirrored_above(about_normal, from.flat_normal),
                spread_rad,
                light,
                light_points: points.of_lights(number),
            }
        })
        .collect();
    let reach = smooth::reach(rays.view, from);
    rays.arriving(from, &wanted, &mut |it: Arriving| {
        let far = smooth::far_share(it.nearness * reach);
        sum.near += it.bounced * (1.0 - far);
        sum.far += it.bounced * far;
        sum.sky += it.sky;
        sum.nearness += it.nearness;
        sum.nearness_of_far += it.nearness * far + (1.0 - far) / reach;
        sum.of_far.add(it.bounced, far);
        sum.of_sky.add(it.sky, far);
    });
}

impl Gathered {
    /// Bounced irradiance, W/m2.
    pub(super) fn indirect(&self) -> Vec3 {
        self.near + self.far
    }

    /// From the sum of the radiance of some cosine-distributed rays, and that of as
    /// many of a lobe.
    fn mean(self, rays: u32) -> Self {
        let share = 1.0 / rays.max(1) as f32;
        Self {
            near: self.near * (std::f32::consts::PI * share),
            far: self.far * (std::f32::consts::PI * share),
            sky: self.sky * (std::f32::consts::PI * share),
            glossy: self.glossy * share,
            nearness: self.nearness * share,
            nearness_of_far: self.nearness_of_far * share,
            of_far: self.of_far.times(share),
            of_sky: self.of_sky.times(share),
        }
    }
}
