//! A material: what MTL and `[[material]]` say about a surface.

use glam::Vec3;

use crate::texture::TextureMap;

/// A diffuse material, with what later stages may need of MTL.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// MTL name; empty for triangles without a material. A material with maps
    /// has a second of its name, without maps, where some of its triangles lack
    /// texture coordinates; those with maps have texture coordinates always.
    pub name: String,
    /// Diffuse albedo `Kd` per channel, 0 to 1, linear Rec.709.
    pub albedo: Vec3,
    /// Emitted radiance `Ke`, W/(m2 sr), front side only.
    pub emission: Vec3,
    /// `map_Kd`, which multiplies the albedo.
    pub albedo_map: Option<TextureMap>,
    /// `map_Ke`, which multiplies the emission.
    pub emission_map: Option<TextureMap>,
    /// Specular colour `Ks` (or `specular` of the scene file); zero where absent.
    pub specular: Vec3,
    /// Roughness 0 to 1, from `Ns`, `Pr` or the scene file.
    pub roughness: Option<f32>,
}

impl Material {
    /// The material of triangles that name none: grey, Kd 0.8.
    pub fn unnamed() -> Self {
        Self {
            name: String::new(),
            albedo: Vec3::splat(0.8),
            emission: Vec3::ZERO,
            albedo_map: None,
            emission_map: None,
            specular: Vec3::ZERO,
            roughness: None,
        }
    }
}
