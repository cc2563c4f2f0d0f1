//! From fragments to a picture: direct light by shadow rays, indirect light
//! interpolated from the vertices of the side that is seen.
//!
//! Surfaces are shaded once a pixel, at the pixel's centre where the pixel is
//! uniform, else once for each surface in it, weighted by coverage. A light
//! whose visibility differs within a pixel's 3 x 3 neighbourhood, or whose own
//! edge (the rim of a cone) passes there, gets one shadow ray a sample; all else
//! stays where it is, so that direct and indirect light add up to both.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use super::component::{Component, Shaded, shown};
use super::raster::{
    CenterBuffer, Fragment, RasterMesh, SampleBuffer, edge_pixels, rasterize, rasterize_samples,
    surface_groups,
};
use super::stages::Stages;
use crate::frame::Image;
use crate::scene::{PlacedCamera, PlacedLight};
use crate::simd::Level;
use crate::surface::direct::{hidden, irradiance, unoccluded};
use crate::surface::{NONE, Surface, SurfacePoint};

/// What a picture is made of.
pub(crate) struct View<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) level: Level,
    pub(crate) camera: PlacedCamera,
    pub(crate) lights: &'a [PlacedLight],
    /// Diffuse albedo of each material.
    pub(crate) albedo: &'a [Vec3],
    /// Indirect irradiance at the vertices, W/m2; empty where not needed.
    pub(crate) indirect: &'a [Vec3],
    pub(crate) component: Component,
}

/// A linear picture, and how many of its pixels had indirect light below zero.
pub(crate) struct Picture {
    pub(crate) image: Image,
    pub(crate) clamped_pixels: u64,
}

/// What one light does at a pixel's centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reach {
    /// Faces away, or nothing is there.
    Away,
    Lit,
    Shadowed,
}

/// Draws a view.
pub(crate) fn draw(view: &View, stages: &mut Stages) -> Picture {
    let corners: Vec<[u32; 3]> = view
        .surface
        .mesh
        .triangles
        .iter()
        .map(|t| t.corners)
        .collect();
    let mesh = RasterMesh {
        positions: &view.surface.mesh.positions,
        triangles: &corners,
        patches: &view.surface.patches,
        edges: &view.surface.edges,
    };
    let centers = stages.time("raster", || rasterize(&view.camera, &mesh));
    let edges = stages.time("edges", || edge_pixels(&view.camera, &mesh, &centers));
    let lights: &[PlacedLight] = if view.component.needs_direct() {
        view.lights
    } else {
        &[]
    };
    let reaches = stages.time("shadow rays", || Reaches::trace(view, lights, &centers));
    let mixed = reaches.mixed(view, lights, &centers);
    let mut mask = edges.clone();
    for (pixel, masked) in mask.iter_mut().enumerate() {
        *masked |= mixed.iter().any(|light| light[pixel]);
    }
    let samples = stages.time("samples", || rasterize_samples(&view.camera, &mesh, &mask));
    let shading = Shading {
        view,
        mesh: &mesh,
        centers: &centers,
        edges: &edges,
        samples: &samples,
        reaches: &reaches,
        mixed: &mixed,
        lights,
    };
    stages.time("shade", || shading.picture())
}

/// Every light's reach at every pixel's centre.
struct Reaches {
    /// Light by light, a value a pixel.
    lights: Vec<Vec<Reach>>,
}

impl Reaches {
    fn trace(view: &View, lights: &[PlacedLight], centers: &CenterBuffer) -> Self {
        let reach = |light: &PlacedLight, fragment: &Fragment| {
            let Some(point) = seen_point(view, fragment) else {
                return Reach::Away;
            };
            let sample = light.sample(point.position);
            if unoccluded(&sample, &point) == Vec3::ZERO {
                Reach::Away
            } else if hidden(view.surface, view.level, &sample, &point) {
                Reach::Shadowed
            } else {
                Reach::Lit
            }
        };
        let fragments = &centers.fragments;
        let lights = lights
            .iter()
            .map(|light| {
                fragments
                    .par_iter()
                    .with_min_len(512)
                    .map(|fragment| reach(light, fragment))
                    .collect()
            })
            .collect();
        Self { lights }
    }

    /// Per light, the pixels where it takes a shadow ray a sample.
    fn mixed(&self, view: &View, lights: &[PlacedLight], centers: &CenterBuffer) -> Vec<Vec<bool>> {
        let (width, height) = (view.camera.width as usize, view.camera.height as usize);
        let positions: Vec<Option<Vec3>> = centers
            .fragments
            .par_iter()
            .map(|f| seen_point(view, f).map(|p| p.position))
            .collect();
        lights
            .iter()
            .zip(&self.lights)
            .map(|(light, reach)| {
                let differs = |a: usize, b: usize| {
                    let shadow_edge = matches!(
                        (reach[a], reach[b]),
                        (Reach::Lit, Reach::Shadowed) | (Reach::Shadowed, Reach::Lit)
                    );
                    let own_edge = || match (positions[a], positions[b]) {
                        (Some(p), Some(q)) => light.edge_between(p, q),
                        _ => false,
                    };
                    shadow_edge || own_edge()
                };
                mark_differing_neighbours(width, height, differs)
            })
            .collect()
    }
}

/// Marks both of any two pixels of a 2 x 2 block that differ: a pixel is marked
/// if it differs from one of its eight neighbours.
fn mark_differing_neighbours(
    width: usize,
    height: usize,
    differs: impl Fn(usize, usize) -> bool,
) -> Vec<bool> {
    let mut marked = vec![false; width * height];
    for y in 0..height {
        for x in 0..width {
            let here = y * width + x;
            let right = (x + 1 < width).then_some(here + 1);
            let below = (y + 1 < height).then_some(here + width);
            let below_right = right.and(below).map(|b| b + 1);
            let below_left = (x > 0).then_some(below).flatten().map(|b| b - 1);
            for other in [right, below, below_right, below_left]
                .into_iter()
                .flatten()
            {
                if differs(here, other) {
                    marked[here] = true;
                    marked[other] = true;
                }
            }
        }
    }
    marked
}

/// The point that a fragment shows, with normals on the viewer's side: of the
/// shading normal, so that a light on its other side gives nothing.
fn seen_point(view: &View, fragment: &Fragment) -> Option<SurfacePoint> {
    if !fragment.is_covered() {
        return None;
    }
    let mut point = view
        .surface
        .point(fragment.triangle, fragment.barycentrics, fragment.front);
    let to_eye = view.camera.eye.as_vec3() - point.position;
    if point.normal.dot(to_eye) < 0.0 {
        point.normal = -point.normal;
    }
    Some(point)
}

struct Shading<'a> {
    view: &'a View<'a>,
    mesh: &'a RasterMesh<'a>,
    centers: &'a CenterBuffer,
    /// Pixels of more than one surface.
    edges: &'a [bool],
    samples: &'a SampleBuffer,
    reaches: &'a Reaches,
    mixed: &'a [Vec<bool>],
    lights: &'a [PlacedLight],
}

impl Shading<'_> {
    fn picture(&self) -> Picture {
        let (width, height) = (self.view.camera.width, self.view.camera.height);
        let clamped = AtomicU64::new(0);
        let pixels: Vec<Vec3> = (0..width as usize * height as usize)
            .into_par_iter()
            .with_min_len(256)
            .map(|pixel| {
                let (value, below_zero) = self.pixel(pixel);
                if below_zero {
                    clamped.fetch_add(1, Ordering::Relaxed);
                }
                value
            })
            .collect();
        let image = Image::new(width, height, pixels).expect("a pixel each was made");
        Picture {
            image,
            clamped_pixels: clamped.into_inner(),
        }
    }

    /// The pixel's value, and whether indirect light was below zero there.
    fn pixel(&self, pixel: usize) -> (Vec3, bool) {
        let samples = self.samples.pixel(pixel);
        match samples.filter(|_| self.edges[pixel]) {
            Some(samples) => self.sampled_pixel(pixel, samples),
            None => self.shaded(
                &self.centers.fragments[pixel],
                |light| self.reaches.lights[light][pixel] == Reach::Lit,
                |light| {
                    let samples = samples.filter(|_| self.mixed[light][pixel])?;
                    let sum = samples.iter().map(|f| self.light_at(light, f));
                    Some(sum.sum::<Vec3>() / samples.len() as f32)
                },
            ),
        }
    }

    /// A pixel of more than one surface.
    fn sampled_pixel(&self, pixel: usize, samples: &[Fragment; 16]) -> (Vec3, bool) {
        let at = [
            pixel as u32 % self.view.camera.width,
            pixel as u32 / self.view.camera.width,
        ];
        let mut value = Vec3::ZERO;
        let mut below_zero = false;
        for group in surface_groups(samples, self.mesh, &self.view.camera, at).iter() {
            let members = || {
                (0..16)
                    .filter(|k| group.members >> k & 1 == 1)
                    .map(|k| &samples[k])
            };
            let fragment = &samples[group.representative as usize];
            let mean = |light: usize| {
                let sum = members().fold(Vec3::ZERO, |sum, f| sum + self.light_at(light, f));
                sum / members().count() as f32
            };
            let whole =
                |light: usize| (!self.mixed[light][pixel]).then(|| self.light_at(light, fragment));
            let (shade, negative) = self.shaded(
                fragment,
                |_| false,
                |light| Some(whole(light).unwrap_or_else(|| mean(light))),
            );
            value += shade * (members().count() as f32 / 16.0);
            below_zero |= negative;
        }
        (value, below_zero)
    }

    /// Irradiance of one light at a fragment, with a shadow ray.
    fn light_at(&self, light: usize, fragment: &Fragment) -> Vec3 {
        seen_point(self.view, fragment).map_or(Vec3::ZERO, |point| {
            irradiance(
                self.view.surface,
                self.view.level,
                &self.lights[light],
                &point,
            )
        })
    }

    /// Value of a fragment. A light's irradiance is `known` already, or what it
    /// is unoccluded where it is `lit`.
    fn shaded(
        &self,
        fragment: &Fragment,
        lit: impl Fn(usize) -> bool,
        known: impl Fn(usize) -> Option<Vec3>,
    ) -> (Vec3, bool) {
        let view = self.view;
        let Some(point) = seen_point(view, fragment) else {
            return (Vec3::ZERO, false);
        };
        let mut direct = Vec3::ZERO;
        for (index, light) in self.lights.iter().enumerate() {
            direct += match known(index) {
                Some(irradiance) => irradiance,
                None if lit(index) => unoccluded(&light.sample(point.position), &point),
                None => Vec3::ZERO,
            };
        }
        let (indirect, below_zero) = self.indirect(fragment);
        let material = view.surface.mesh.triangles[fragment.triangle as usize].material;
        let shaded = Shaded {
            direct,
            indirect,
            albedo: view.albedo[material as usize],
            normal: point.normal,
            depth: (f64::from(fragment.depth) / view.surface.placement.scale) as f32,
        };
        (shown(view.component, &shaded), below_zero)
    }

    /// Indirect irradiance interpolated from the side's vertices, clamped at
    /// zero, and whether it had to be.
    fn indirect(&self, fragment: &Fragment) -> (Vec3, bool) {
        if self.view.indirect.is_empty() {
            return (Vec3::ZERO, false);
        }
        let corners = self
            .view
            .surface
            .vertices
            .of_triangle(fragment.triangle, fragment.front);
        let sum = corners.into_iter().zip(fragment.barycentrics).fold(
            Vec3::ZERO,
            |sum, (vertex, weight)| {
                if vertex == NONE {
                    sum
                } else {
                    sum + self.view.indirect[vertex as usize] * weight
                }
            },
        );
        let clamped = sum.to_array().map(|e| if e < 0.0 { 0.0 } else { e });
        (Vec3::from_array(clamped), clamped != sum.to_array())
    }
}
