//! From fragments to a picture: direct light by shadow rays, indirect light
//! interpolated from the vertices of the side that is seen.
//!
//! Surfaces are shaded once a pixel, at the pixel's centre where the pixel is
//! uniform, else once for each surface in it, weighted by coverage. A light
//! whose visibility differs within a pixel's 3 x 3 neighbourhood, or whose own
//! edge (the rim of a cone) passes there, is asked for at every sample: by one
//! shadow ray, or by a quarter of `light_samples` if it is no point. Colours of
//! maps are means over the pixel; a depth is that of the largest piece in it. All
//! else stays where it is, so that direct and indirect light add up to both.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use super::basis_view::BasisView;
use super::component::{Component, Shaded, shown};
use super::frame::Effort;
use super::gather::{GatherLight, Gathered, at_sites};
use super::glossy_light::GlossyLight;
use super::lit_sites::{DirectLight, KeptPicture};
use super::paint::{Footprint, Paint};
use super::raster::{Fragment, SurfaceGroup};
use super::reach::seen_point;
use super::sites::{Sites, members};
use super::stages::Stages;
use crate::bake::Progress;
use crate::brdf::{GlossyMaterials, ViewedFrame};
use crate::frame::Image;
use crate::scene::{PlacedCamera, PlacedLights, Scene};
use crate::simd::Level;
use crate::surface::direct::{SeenLobe, Shadows};
use crate::surface::{NONE, Surface, SurfacePoint};

/// What a picture is made of.
pub(crate) struct View<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) level: Level,
    pub(crate) camera: PlacedCamera,
    pub(crate) lights: &'a PlacedLights,
    /// Materials, maps and how they are filtered.
    pub(crate) scene: &'a Scene,
    /// The materials' lobes.
    pub(crate) glossy: &'a GlossyMaterials,
    /// Shadow rays a pixel to a light that is no point.
    pub(crate) light_samples: u32,
    /// Irradiance of the sky at the vertices, W/m2; empty where there is none.
    pub(crate) sky: &'a [Vec3],
    /// Indirect irradiance at the vertices, W/m2; empty where not needed.
    pub(crate) indirect: &'a [Vec3],
    /// What arrives at glossy vertices by direction; none where not needed.
    pub(crate) glossy_light: Option<&'a GlossyLight>,
    /// What a final gather reads in place of the two above, where one is made.
    pub(crate) gather: Option<&'a GatherLight>,
    /// Radiosity by direct light at the vertices as the basis has it, W/m2;
    /// empty where not needed.
    pub(crate) approximated: &'a [Vec3],
    /// What is shown of the basis itself.
    pub(crate) basis: Option<&'a BasisView>,
    pub(crate) component: Component,
    pub(crate) effort: Effort,
}

impl View<'_> {
    /// What shadow rays meet.
    pub(super) fn shadows(&self) -> Shadows<'_> {
        Shadows {
            surface: self.surface,
            level: self.level,
            rectangles: &self.lights.rectangles,
        }
    }

    /// The lobe of what a fragment of the mesh shows.
    pub(super) fn lobe(&self, fragment: &Fragment, point: &SurfacePoint) -> Option<SeenLobe<'_>> {
        let triangle = &self.surface.mesh.triangles[fragment.triangle as usize];
        let glossy = self.glossy.of(triangle.material)?;
        let frame = ViewedFrame::of(point.normal, self.to_eye(point));
        Some(SeenLobe { glossy, frame })
    }

    /// Unit direction from a seen point to the eye.
    pub(super) fn to_eye(&self, point: &SurfacePoint) -> Vec3 {
        (self.camera.eye.as_vec3() - point.position).normalize_or(point.normal)
    }
}

/// A linear picture, and counts of how it was made.
pub(crate) struct Picture {
    pub(crate) image: Image,
    /// Pixels that had light from the basis below zero.
    pub(crate) clamped_pixels: u64,
    /// Rays that pixels sent in a final gather.
    pub(crate) gathered_rays: u64,
}

/// Draws a view with what is kept of the last one; `None` if it was stopped, which
/// is asked between stages.
pub(crate) fn draw(
    view: &View,
    kept: &mut KeptPicture,
    stages: &mut Stages,
    progress: &dyn Progress,
) -> Option<Picture> {
    let go_on = || (!progress.cancelled()).then_some(());
    go_on()?;
    let (sites, direct) = kept.direct(view, stages, &go_on)?;
    go_on()?;
    let (gathered, gathered_rays) = match view.gather {
        Some(light) => stages.time("gather", || at_sites(view, light, sites, progress))?,
        None => (Vec::new(), 0),
    };
    let shading = Shading {
        view,
        paint: Paint {
            scene: view.scene,
            mesh: &view.surface.mesh,
            camera: &view.camera,
        },
        sites,
        direct: &direct,
        gathered: &gathered,
    };
    let (image, clamped_pixels) = stages.time("shade", || shading.picture());
    go_on()?;
    Some(Picture {
        image,
        clamped_pixels,
        gathered_rays,
    })
}

struct Shading<'a> {
    view: &'a View<'a>,
    paint: Paint<'a>,
    sites: &'a Sites,
    direct: &'a DirectLight,
    /// What a final gather found by site; empty where none was made.
    gathered: &'a [Gathered],
}

impl Shading<'_> {
    /// The picture, and how many of its pixels had light from the basis below zero.
    fn picture(&self) -> (Image, u64) {
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
        (image, clamped.into_inner())
    }

    /// The pixel's value, and whether light from the basis was below zero there.
    fn pixel(&self, pixel: usize) -> (Vec3, bool) {
        match self.sites.samples.pixel(pixel) {
            Some(samples) => self.pixel_of_surfaces(pixel, samples),
            None => self.uniform_pixel(pixel),
        }
    }

    /// Direct irradiance at a site, W/m2, and radiance by its lobe, W/(m2 sr).
    fn direct(&self, site: usize) -> [Vec3; 2] {
        let lists = [&self.direct.irradiance, &self.direct.reflected];
        lists.map(|list| list.get(site).copied().unwrap_or(Vec3::ZERO))
    }

    /// A pixel of one surface, shaded at its centre.
    fn uniform_pixel(&self, pixel: usize) -> (Vec3, bool) {
        let fragment = &self.sites.centers.fragments[pixel];
        let Some(point) = &self.sites.points[pixel] else {
            return (self.no_surface(pixel, fragment), false);
        };
        let colours = self.colours(fragment, Footprint::Pixel);
        self.shaded(fragment, point, pixel, colours)
    }

    /// A pixel of more than one surface: each is shaded once, at its sample
    /// closest to its middle, and weighted by the samples that it covers.
    fn pixel_of_surfaces(&self, pixel: usize, samples: &[Fragment; 16]) -> (Vec3, bool) {
        let share = |members: u32| members as f32 / 16.0;
        let uncovered = samples.iter().filter(|s| !s.is_covered()).count() as u32;
        if self.view.component == Component::Depth {
            // Between two surfaces there is none.
            return (self.largest_of_pixel(pixel, samples, uncovered), false);
        }
        let mut value = Vec3::ZERO;
        if uncovered > 0 {
            value += self.no_surface(pixel, &Fragment::EMPTY) * share(uncovered);
        }
        let mut below_zero = false;
        for (site, group) in self.sites.groups(pixel) {
            let (shade, negative) = self.of_group(pixel, (site, group), samples);
            value += shade * share(group.members.count_ones());
            below_zero |= negative;
        }
        (value, below_zero)
    }

    /// The value of the largest piece of a surface in a pixel, the first of equals;
    /// nothing where surfaces cover less than half of it.
    fn largest_of_pixel(&self, pixel: usize, samples: &[Fragment; 16], uncovered: u32) -> Vec3 {
        let mut largest: Option<(usize, SurfaceGroup)> = None;
        for (site, group) in self.sites.groups(pixel) {
            let size = |group: SurfaceGroup| group.members.count_ones();
            if largest.is_none_or(|(_, other)| size(group) > size(other)) {
                largest = Some((site, group));
            }
        }
        let seen = largest.filter(|_| uncovered <= 8);
        seen.map_or(Vec3::ZERO, |it| self.of_group(pixel, it, samples).0)
    }

    /// The value of one surface of a pixel, and whether light from the basis was below
    /// zero there.
    fn of_group(
        &self,
        pixel: usize,
        (site, group): (usize, SurfaceGroup),
        samples: &[Fragment; 16],
    ) -> (Vec3, bool) {
        let fragment = &samples[group.representative as usize];
        match seen_point(self.view, fragment) {
            None => (self.no_surface(pixel, fragment), false),
            Some(point) => {
                let colours = self.colours_of_group(fragment, members(group, samples));
                self.shaded(fragment, &point, site, colours)
            }
        }
    }

    /// Albedo and emission of a surface in a pixel: means over its samples where
    /// it has a map.
    fn colours_of_group<'f>(
        &self,
        fragment: &Fragment,
        members: impl Iterator<Item = &'f Fragment>,
    ) -> [Vec3; 2] {
        if !self.paint.has_map(fragment) {
            return self.colours(fragment, Footprint::Sample);
        }
        let (sum, count) = members.fold(([Vec3::ZERO; 2], 0), |(sum, count), member| {
            let [albedo, emission] = self.colours(member, Footprint::Sample);
            ([sum[0] + albedo, sum[1] + emission], count + 1)
        });
        sum.map(|colour| colour / count as f32)
    }

    /// Albedo and emission of a fragment.
    fn colours(&self, fragment: &Fragment, footprint: Footprint) -> [Vec3; 2] {
        let emission = if self.view.component.shows_emission() {
            self.paint.emission(fragment, footprint)
        } else {
            Vec3::ZERO
        };
        [self.paint.albedo(fragment, footprint), emission]
    }

    /// Value of a fragment that shows no surface of the mesh: a light's
    /// rectangle, or the sky.
    fn no_surface(&self, pixel: usize, fragment: &Fragment) -> Vec3 {
        let view = self.view;
        if let Some(index) = self.sites.geometry.rectangle_of(fragment) {
            let rectangle = &view.lights.rectangles[index];
            let side = if fragment.front { 1.0 } else { -1.0 };
            let shaded = Shaded {
                emission: if fragment.front {
                    rectangle.radiance
                } else {
                    Vec3::ZERO
                },
                normal: rectangle.normal.as_vec3() * side,
                depth: self.scene_depth(fragment),
                ..Shaded::default()
            };
            return shown(view.component, &shaded);
        }
        if !view.component.shows_emission() || view.lights.skies.is_empty() {
            return Vec3::ZERO;
        }
        let (width, camera) = (view.camera.width as usize, &view.camera);
        let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        let spread_rad = camera.right.length() as f32;
        view.lights.sky_radiance(camera.direction(x, y), spread_rad)
    }

    /// Value of a fragment under the light of a site.
    fn shaded(
        &self,
        fragment: &Fragment,
        point: &SurfacePoint,
        site: usize,
        [albedo, emission]: [Vec3; 2],
    ) -> (Vec3, bool) {
        let view = self.view;
        let [direct, reflected] = self.direct(site);
        let gathered = self.gathered.get(site);
        let [indirect, sky] = match gathered {
            Some(gathered) => [gathered.indirect(), gathered.sky],
            None => [view.indirect, view.sky].map(|light| self.interpolated(fragment, light)),
        };
        let lobe = view.lobe(fragment, point);
        let of_lobe = |lobe: &SeenLobe| lobe.glossy.albedo(lobe.frame.cosine);
        let lobe_albedo = lobe.as_ref().map_or(Vec3::ZERO, of_lobe);
        let by_slices = || {
            let glossy = lobe.as_ref()?.glossy;
            let corners = self.corners(fragment);
            let light = view.glossy_light?.at(corners, fragment.barycentrics)?;
            let normal = self.vertex_normal(fragment, point);
            let frame = ViewedFrame::of(normal, view.to_eye(point));
            Some(glossy.reflected(&frame, &light))
        };
        let glossy = gathered.map(|it| it.glossy).or_else(by_slices);
        let (glossy, glossy_dark) = clamped(glossy.unwrap_or(Vec3::ZERO));
        let (indirect, dark) = clamped(indirect);
        let (sky, sky_dark) = clamped(sky);
        let (approximated, darker) = clamped(self.interpolated(fragment, view.approximated));
        let shaded = Shaded {
            direct: direct + sky,
            indirect,
            approximated,
            emission,
            albedo,
            diffuse: albedo * (Vec3::ONE - lobe_albedo),
            reflected,
            glossy,
            normal: point.normal,
            depth: self.scene_depth(fragment),
            basis: view
                .basis
                .map_or(Vec3::ZERO, |b| self.basis_colour(b, fragment, point)),
        };
        (
            shown(view.component, &shaded),
            dark || darker || sky_dark || glossy_dark,
        )
    }

    /// The normal interpolated from the vertices, whose slices hold light of their own
    /// hemispheres. It differs from the shading normal on flat faces of round bodies,
    /// and just inside an outline, where it may look away from the eye.
    fn vertex_normal(&self, fragment: &Fragment, point: &SurfacePoint) -> Vec3 {
        let normals = self.view.surface.vertices.normals();
        self.interpolated(fragment, normals)
            .normalize_or(point.normal)
    }

    /// Vertices of the side of a triangle that is seen.
    fn corners(&self, fragment: &Fragment) -> [u32; 3] {
        let vertices = &self.view.surface.vertices;
        vertices.of_triangle(fragment.triangle, fragment.front)
    }

    fn basis_colour(&self, basis: &BasisView, fragment: &Fragment, point: &SurfacePoint) -> Vec3 {
        let corners = self.corners(fragment);
        let to_eye = self.view.camera.eye.as_vec3() - point.position;
        let facing = point.normal.dot(to_eye.normalize_or_zero());
        basis.colour(corners, fragment.barycentrics, facing)
    }

    /// Distance along the view axis, scene units.
    fn scene_depth(&self, fragment: &Fragment) -> f32 {
        (f64::from(fragment.depth) / self.view.surface.placement.scale) as f32
    }

    /// Irradiance interpolated from the vertices of the side that is seen; zero
    /// from no values.
    fn interpolated(&self, fragment: &Fragment, at_vertices: &[Vec3]) -> Vec3 {
        if at_vertices.is_empty() {
            return Vec3::ZERO;
        }
        let weighted = self
            .corners(fragment)
            .into_iter()
            .zip(fragment.barycentrics);
        weighted.fold(Vec3::ZERO, |sum, (vertex, weight)| {
            if vertex == NONE {
                sum
            } else {
                sum + at_vertices[vertex as usize] * weight
            }
        })
    }
}

/// Light that is not negative, and whether it was below zero.
fn clamped(light: Vec3) -> (Vec3, bool) {
    let clamped = light.to_array().map(|e| if e < 0.0 { 0.0 } else { e });
    (Vec3::from_array(clamped), clamped != light.to_array())
}
