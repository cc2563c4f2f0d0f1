//! Albedo at the lighting vertices: what light that bounces sees of a map.

use glam::Vec3;

use crate::scene::Scene;
use crate::surface::Surface;
use crate::surface::maps::means_at_vertices;
use crate::texture::{TextureFilter, TextureMap};

/// Mean colour of each vertex's map, kept as long as the maps stay the same;
/// Kd may change from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct VertexColours {
    /// Maps by material, filter and number of vertices that `means` was made of.
    made_of: Option<(Vec<Option<TextureMap>>, TextureFilter, usize)>,
    /// White where there is no map; empty where no material has one.
    means: Vec<Vec3>,
}

impl VertexColours {
    /// The means as the scene is now.
    pub(crate) fn new(scene: &Scene, surface: &Surface) -> Self {
        let mut colours = Self::default();
        colours.update(scene, surface);
        colours
    }

    /// Brings the means up to date.
    pub(crate) fn update(&mut self, scene: &Scene, surface: &Surface) {
        let maps = scene.materials.iter().map(|m| m.albedo_map.clone());
        let wanted = (
            maps.collect::<Vec<_>>(),
            scene.texture_filter,
            surface.vertices.len(),
        );
        if self.made_of.as_ref() == Some(&wanted) {
            return;
        }
        let maps = &wanted.0;
        self.means = if maps.iter().all(Option::is_none) {
            Vec::new()
        } else {
            means_at_vertices(surface, scene.texture_filter, |material| {
                maps[material as usize].as_ref()
            })
        };
        self.made_of = Some(wanted);
    }

    /// Kd x map of every vertex.
    pub(crate) fn albedo(&self, scene: &Scene, surface: &Surface) -> Vec<Vec3> {
        let materials = surface.vertices.materials().iter();
        let of_materials = materials.map(|&m| scene.materials[m as usize].albedo);
        if self.means.is_empty() {
            return of_materials.collect();
        }
        let means = self.means.iter();
        of_materials
            .zip(means)
            .map(|(kd, mean)| kd * *mean)
            .collect()
    }
}
