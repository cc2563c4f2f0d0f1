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
use super::reach::{Reach, SeenPoints, mixed, seen_point, seen_points, trace};
use super::stages::Stages;
use crate::bake::Progress;
use crate::frame::Image;
use crate::scene::{PlacedCamera, PlacedLight};
use crate::simd::Level;
use crate::surface::direct::{irradiance, unoccluded};
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

/// Draws a view; `None` if it was stopped, which is asked between stages.
pub(crate) fn draw(view: &View, stages: &mut Stages, progress: &dyn Progress) -> Option<Picture> {
    let go_on = || (!progress.cancelled()).then_some(());
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
    go_on()?;
    let edges = stages.time("edges", || edge_pixels(&view.camera, &mesh, &centers));
    let lights: &[PlacedLight] = if view.component.needs_direct() {
        view.lights
    } else {
        &[]
    };
    go_on()?;
    let points = stages.time("points", || seen_points(view, &centers));
    let reaches: Vec<Vec<Reach>> = stages.time("shadow rays", || {
        lights
            .iter()
            .map(|light| go_on().map(|()| trace(view, light, &points)))
            .collect::<Option<_>>()
    })?;
    let mixed: Vec<Vec<bool>> = stages.time("shadow edges", || {
        lights
            .iter()
            .zip(&reaches)
            .map(|(light, reach)| mixed(view, light, &points, reach))
            .collect()
    });
    let mut mask = edges.clone();
    for light in &mixed {
        mask.iter_mut()
            .zip(light)
            .for_each(|(masked, mixed)| *masked |= mixed);
    }
    go_on()?;
    let samples = stages.time("samples", || rasterize_samples(&view.camera, &mesh, &mask));
    let shading = Shading {
        view,
        mesh: &mesh,
        centers: &centers,
        points: &points,
        edges: &edges,
        samples: &samples,
        reaches: &reaches,
        mixed: &mixed,
        lights,
    };
    go_on()?;
    let picture = stages.time("shade", || shading.picture());
    go_on()?;
    Some(picture)
}

struct Shading<'a> {
    view: &'a View<'a>,
    mesh: &'a RasterMesh<'a>,
    centers: &'a CenterBuffer,
    points: &'a SeenPoints,
    /// Pixels of more than one surface.
    edges: &'a [bool],
    samples: &'a SampleBuffer,
    reaches: &'a [Vec<Reach>],
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
        match self.samples.pixel(pixel) {
            Some(samples) if self.edges[pixel] => self.pixel_of_surfaces(pixel, samples),
            samples => self.uniform_pixel(pixel, samples),
        }
    }

    /// A pixel of one surface, shaded at its centre; lights with a shadow's
    /// edge in it are averaged over `samples`.
    fn uniform_pixel(&self, pixel: usize, samples: Option<&[Fragment; 16]>) -> (Vec3, bool) {
        let Some(point) = &self.points[pixel] else {
            return (Vec3::ZERO, false);
        };
        let at_light = |light: usize| match samples {
            Some(samples) if self.mixed[light][pixel] => self.light_mean(light, samples.iter()),
            _ if self.reaches[light][pixel] == Reach::Lit => {
                unoccluded(&self.lights[light].sample(point.position), point)
            }
            _ => Vec3::ZERO,
        };
        let direct = (0..self.lights.len()).fold(Vec3::ZERO, |sum, light| sum + at_light(light));
        self.shaded(&self.centers.fragments[pixel], point, direct)
    }

    /// A pixel of more than one surface: each is shaded once, at its sample
    /// closest to its middle, and weighted by the samples that it covers.
    fn pixel_of_surfaces(&self, pixel: usize, samples: &[Fragment; 16]) -> (Vec3, bool) {
        let at = [
            pixel as u32 % self.view.camera.width,
            pixel as u32 / self.view.camera.width,
        ];
        let mut value = Vec3::ZERO;
        let mut below_zero = false;
        for group in surface_groups(samples, self.mesh, &self.view.camera, at).iter() {
            let fragment = &samples[group.representative as usize];
            let Some(point) = seen_point(self.view, fragment) else {
                continue;
            };
            let members = || {
                (0..16)
                    .filter(|k| group.members >> k & 1 == 1)
                    .map(|k| &samples[k])
            };
            let at_light = |light: usize| {
                if self.mixed[light][pixel] {
                    self.light_mean(light, members())
                } else {
                    irradiance(
                        self.view.surface,
                        self.view.level,
                        &self.lights[light],
                        &point,
                    )
                }
            };
            let direct =
                (0..self.lights.len()).fold(Vec3::ZERO, |sum, light| sum + at_light(light));
            let (shade, negative) = self.shaded(fragment, &point, direct);
            value += shade * (group.members.count_ones() as f32 / 16.0);
            below_zero |= negative;
        }
        (value, below_zero)
    }

    /// Irradiance of one light, the mean over fragments with a shadow ray each.
    fn light_mean<'f>(&self, light: usize, fragments: impl Iterator<Item = &'f Fragment>) -> Vec3 {
        let (sum, count) = fragments.fold((Vec3::ZERO, 0), |(sum, count), fragment| {
            let at = seen_point(self.view, fragment).map_or(Vec3::ZERO, |point| {
                irradiance(
                    self.view.surface,
                    self.view.level,
                    &self.lights[light],
                    &point,
                )
            });
            (sum + at, count + 1)
        });
        sum / count as f32
    }

    /// Value of a fragment under direct irradiance.
    fn shaded(&self, fragment: &Fragment, point: &SurfacePoint, direct: Vec3) -> (Vec3, bool) {
        let view = self.view;
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
