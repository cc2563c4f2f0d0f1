//! Colours of the surface as the materials have them now.

use glam::{DVec3, Vec3};

use super::raster::Fragment;
use crate::scene::{Material, PlacedCamera, Scene};
use crate::surface::LightingMesh;
use crate::surface::maps::mean_around;
use crate::texture::TextureMap;

/// Albedo and emission at fragments.
pub(crate) struct Paint<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) mesh: &'a LightingMesh,
    pub(crate) camera: &'a PlacedCamera,
}

/// How much of a pixel a fragment stands for.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Footprint {
    /// The whole pixel.
    Pixel,
    /// One of its sixteen samples: a quarter of it either way.
    Sample,
}

impl Footprint {
    fn width_px(self) -> f64 {
        match self {
            Self::Pixel => 1.0,
            Self::Sample => 0.25,
        }
    }
}

impl Paint<'_> {
    fn material(&self, fragment: &Fragment) -> &Material {
        let material = self.mesh.triangles[fragment.triangle as usize].material;
        &self.scene.materials[material as usize]
    }

    /// Whether a fragment's colours come from a map.
    pub(crate) fn has_map(&self, fragment: &Fragment) -> bool {
        let material = self.material(fragment);
        (material.albedo_map.is_some() || material.emission_map.is_some())
            && self
                .mesh
                .texture_coordinates_of(fragment.triangle)
                .is_some()
    }

    /// Diffuse albedo over what a fragment stands for.
    pub(crate) fn albedo(&self, fragment: &Fragment, footprint: Footprint) -> Vec3 {
        let material = self.material(fragment);
        material.albedo * self.colour(material.albedo_map.as_ref(), fragment, footprint)
    }

    /// Emitted radiance over what a fragment stands for, W/(m2 sr): of fronts
    /// only.
    pub(crate) fn emission(&self, fragment: &Fragment, footprint: Footprint) -> Vec3 {
        let material = self.material(fragment);
        if material.emission == Vec3::ZERO || !fragment.front {
            return Vec3::ZERO;
        }
        material.emission * self.colour(material.emission_map.as_ref(), fragment, footprint)
    }

    /// Mean colour of a map, white without one.
    fn colour(&self, map: Option<&TextureMap>, fragment: &Fragment, footprint: Footprint) -> Vec3 {
        map.and_then(|map| {
            mean_around(
                self.mesh,
                map,
                self.scene.texture_filter,
                (fragment.triangle, fragment.barycentrics),
                self.steps(fragment, footprint.width_px()),
            )
        })
        .unwrap_or(Vec3::ONE)
    }

    /// How far the seen point moves along its triangle for steps of `width_px`
    /// to the right and down in the picture, placed units.
    ///
    /// The eye's ray e + t d meets the plane at t = c / (n d); a step of d by s
    /// moves the point by t (s - d (n s) / (n d)).
    fn steps(&self, fragment: &Fragment, width_px: f64) -> [Vec3; 2] {
        let triangle = &self.mesh.triangles[fragment.triangle as usize];
        let normal = triangle.flat_normal.as_dvec3();
        let [a, b, c] = self.mesh.corner_positions(triangle);
        let [u, v, w] = fragment.barycentrics;
        let point = (a * u + b * v + c * w).as_dvec3();
        let depth = f64::from(fragment.depth);
        let towards = (point - self.camera.eye) / depth;
        let facing = normal.dot(towards);
        let step = |s: DVec3| {
            let along = s - towards * (normal.dot(s) / facing);
            let moved = (along * (depth * width_px)).as_vec3();
            // Seen edge-on there is no such point.
            if moved.is_finite() { moved } else { Vec3::ZERO }
        };
        [step(self.camera.right), step(self.camera.down)]
    }
}
