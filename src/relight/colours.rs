//! Albedo at the lighting vertices: what light that bounces sees of a map.

use glam::Vec3;

use crate::brdf::GlossyMaterials;
use crate::scene::{Material, Scene};
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

/// Share of light that every vertex hands on to the next bounce, as the scene is now.
pub(crate) fn vertex_albedo(scene: &Scene, surface: &Surface) -> Vec<Vec3> {
    let mut colours = VertexColours::default();
    colours.update(scene, surface);
    let glossy = GlossyMaterials::of_all(scene.materials.iter().map(Material::gloss));
    colours.albedo(scene, &glossy, surface)
}

impl VertexColours {
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

    /// Share of light that every vertex hands on to the next bounce: Kd x map of
    /// what its lobe leaves, and the lobe's mean directional albedo.
    pub(crate) fn albedo(
        &self,
        scene: &Scene,
        glossy: &GlossyMaterials,
        surface: &Surface,
    ) -> Vec<Vec3> {
        let means = self.means.iter().copied();
        let means = means.chain(std::iter::repeat(Vec3::ONE));
        let materials = surface.vertices.materials().iter().zip(means);
        let albedo = |(&material, mean): (&u32, Vec3)| {
            let kd = scene.materials[material as usize].albedo * mean;
            match glossy.of(material) {
                Some(lobe) => {
                    let by_lobe = lobe.mean_albedo();
                    kd * (Vec3::ONE - by_lobe) + by_lobe
                }
                None => kd,
            }
        };
        materials.map(albedo).collect()
    }
}
