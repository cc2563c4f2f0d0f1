//! A material: what MTL and `[[material]]` say about a surface.

use glam::Vec3;

use crate::brdf::Gloss;
use crate::texture::TextureMap;

/// How a surface reflects and emits: f = Kd/pi (1 - E_s) + f_s, with the GGX lobe
/// f_s of [`Self::gloss`] and its directional albedo E_s.
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
    /// Specular colour at normal incidence, 0 to 1 per channel: `Ks`, what `Pr` and
    /// `Pm` make of Kd, or `specular` of the scene file; zero where absent. No map
    /// multiplies it.
    pub specular: Vec3,
    /// Perceptual roughness 0 to 1, from `Pr`, `Ns` or the scene file; 1 where
    /// absent, as of an `Ns` of 0.
    pub roughness: Option<f32>,
}

impl Material {
    /// The glossy lobe; none where the specular colour is black.
    pub fn gloss(&self) -> Option<Gloss> {
        Gloss::of(self.specular, self.roughness.unwrap_or(1.0))
    }

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
