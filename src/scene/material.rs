//! A material: what MTL and `[[material]]` say about a surface.

use glam::Vec3;

use crate::brdf::{Gloss, LEAST_ROUGHNESS, NAMED_BRDFS, is_metal, nearest_kind};
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

/// How a material reflects, as far as it is edited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reflection {
    /// As [`Material::albedo`].
    pub(crate) albedo: Vec3,
    /// As [`Material::specular`].
    pub(crate) specular: Vec3,
    /// As [`Material::roughness`], 0 to 1; 1 where a material has none.
    pub(crate) roughness: f32,
}

impl Reflection {
    pub(crate) fn of(material: &Material) -> Self {
        Self {
            albedo: material.albedo,
            specular: material.specular,
            roughness: material.roughness.unwrap_or(1.0),
        }
    }

    /// Those of all materials, in order.
    pub(crate) fn of_all(materials: &[Material]) -> Vec<Self> {
        materials.iter().map(Self::of).collect()
    }

    /// Lets a material reflect like this. One without a roughness has none still
    /// where that is what it means.
    pub(crate) fn apply(self, material: &mut Material) {
        if self.roughness != material.roughness.unwrap_or(1.0) {
            material.roughness = Some(self.roughness);
        }
        material.albedo = self.albedo;
        material.specular = self.specular;
    }

    /// Whether its colour is the specular one.
    pub(crate) fn is_metal(self) -> bool {
        is_metal(self.albedo, self.specular)
    }

    /// Whether there is a lobe.
    pub(crate) fn is_glossy(self) -> bool {
        self.specular != Vec3::ZERO
    }

    /// The same surface as the next named kind of the one that it is, or is most
    /// like, or as the one before it; with the name.
    pub(crate) fn next_kind(self, by: i8) -> (Self, &'static str) {
        let is = nearest_kind(self.albedo, self.specular, self.roughness) as i64;
        let next = (is + i64::from(by)).rem_euclid(NAMED_BRDFS.len() as i64);
        let kind = NAMED_BRDFS[next as usize];
        let (albedo, specular, roughness) = kind.applied(self.albedo, self.specular);
        let next = Self {
            albedo,
            specular,
            roughness: roughness.unwrap_or(1.0),
        };
        (next, kind.name)
    }

    /// Rougher by a difference, as far as roughness goes, in whole thousandths,
    /// which are short in a file.
    pub(crate) fn rougher(self, by: f64) -> Self {
        let thousandths = ((f64::from(self.roughness) + by) * 1000.0).round();
        let least = f64::from(LEAST_ROUGHNESS) * 1000.0;
        Self {
            roughness: (thousandths.clamp(least.round(), 1000.0) / 1000.0) as f32,
            ..self
        }
    }

    /// What was edited of `self` since it was `saved`, and of the rest what is
    /// `fresh`.
    pub(crate) fn rebased(self, saved: Self, fresh: Self) -> Self {
        fn chosen<T: PartialEq>(edited: T, saved: T, fresh: T) -> T {
            if edited == saved { fresh } else { edited }
        }
        Self {
            albedo: chosen(self.albedo, saved.albedo, fresh.albedo),
            specular: chosen(self.specular, saved.specular, fresh.specular),
            roughness: chosen(self.roughness, saved.roughness, fresh.roughness),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_go_round_and_come_back_to_the_same_surface() {
        let matte = Reflection {
            albedo: Vec3::new(0.7, 0.1, 0.1),
            specular: Vec3::ZERO,
            roughness: 1.0,
        };
        for by in [1, -1] {
            let (mut surface, mut names) = (matte, Vec::new());
            for _ in NAMED_BRDFS {
                let (next, name) = surface.next_kind(by);
                names.push(name);
                surface = next;
            }
            assert_eq!(surface, matte);
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), NAMED_BRDFS.len());
        }
    }

    #[test]
    fn roughness_ends_at_its_limits() {
        let surface = Reflection::of(&Material::unnamed());
        assert_eq!(surface.rougher(0.05).roughness, 1.0);
        assert_eq!(surface.rougher(-0.05).roughness, 0.95);
        assert_eq!(surface.rougher(-2.0).roughness, LEAST_ROUGHNESS);
    }

    #[test]
    fn a_roughness_that_is_absent_stays_so_until_it_is_edited() {
        let mut material = Material::unnamed();
        Reflection::of(&material).apply(&mut material);
        assert_eq!(material, Material::unnamed());
        Reflection::of(&material).rougher(-0.5).apply(&mut material);
        assert_eq!(material.roughness, Some(0.5));
    }
}
