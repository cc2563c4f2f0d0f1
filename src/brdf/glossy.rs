//! The lobes of a scene's materials, ready to reflect.

use std::sync::Arc;

use glam::Vec3;

use super::{Gloss, Lobe, ViewedFrame};
use crate::maths::order::Order;
use crate::maths::spherical_harmonics::{Coefficients, world_from_frame};

/// A lobe with its colour.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Glossy {
    /// F0 per channel.
    specular: Vec3,
    lobe: Arc<Lobe>,
}

impl Glossy {
    /// f_s (1/sr) per channel towards the viewer for light from a direction.
    pub(crate) fn value(&self, frame: &ViewedFrame, to_light: Vec3) -> Vec3 {
        self.lobe.ggx.value(frame, to_light).of(self.specular)
    }

    /// A direction to a light (world), drawn by the lobe, and f_s cos / density.
    pub(crate) fn sample(&self, frame: &ViewedFrame, u: [f32; 2]) -> Option<(Vec3, Vec3)> {
        let (direction, weight) = self.lobe.ggx.sample(frame.cosine, u)?;
        Some((frame.world(direction), weight.of(self.specular)))
    }

    /// Density (1/sr) of [`Self::sample`].
    pub(crate) fn density(&self, frame: &ViewedFrame, to_light: Vec3) -> f32 {
        self.lobe.ggx.density(frame, to_light)
    }

    /// Directional albedo E_s per channel at a cosine of the viewer, at most 1.
    pub(crate) fn albedo(&self, cosine: f32) -> Vec3 {
        at_most_one(self.lobe.albedo(cosine).of(self.specular))
    }

    /// Mean directional albedo per channel (the paper's rho_0), at most 1.
    pub(crate) fn mean_albedo(&self) -> Vec3 {
        at_most_one(self.lobe.mean_albedo.of(self.specular))
    }

    /// Perceptual roughness.
    pub(crate) fn roughness(&self) -> f32 {
        self.lobe.roughness()
    }

    /// Radiance towards the viewer (W/(m2 sr)) by light whose 16 coefficients in
    /// the world are G_k = Int L_in h_k cos dw: sum over k of rho_k (D G)_k with
    /// the lobe turned instead of the light.
    pub(crate) fn reflected(&self, frame: &ViewedFrame, light: &[Vec3; 16]) -> Vec3 {
        let turned = |part: &Coefficients| {
            let world = world_from_frame(part, frame.axes);
            let pairs = world.iter().zip(light);
            pairs.fold(Vec3::ZERO, |sum, (rho, g)| sum + *g * *rho)
        };
        let [coloured, white] = self.lobe.coefficients(frame.cosine);
        self.specular * turned(&coloured) + turned(&white)
    }
}

fn at_most_one(colour: Vec3) -> Vec3 {
    Vec3::from_array(colour.to_array().map(|c| c.at_most(1.0)))
}

/// The lobes of all materials of a scene, by index; tables are kept as long as
/// some material has their roughness.
#[derive(Debug, Clone, Default)]
pub(crate) struct GlossyMaterials {
    of_material: Vec<Option<Glossy>>,
}

impl GlossyMaterials {
    /// The lobes of materials in their order.
    pub(crate) fn of_all(materials: impl Iterator<Item = Option<Gloss>>) -> Self {
        let mut all = Self::default();
        all.update(materials);
        all
    }

    /// Brings the lobes up to date with the materials, in their order.
    pub(crate) fn update(&mut self, materials: impl Iterator<Item = Option<Gloss>>) {
        let mut lobes: Vec<Arc<Lobe>> = Vec::new();
        for glossy in self.of_material.iter().flatten() {
            lobes.push(Arc::clone(&glossy.lobe));
        }
        let made = materials.map(|gloss| {
            let gloss = gloss?;
            let known = lobes.iter().find(|it| it.roughness() == gloss.roughness);
            let lobe = match known {
                Some(lobe) => Arc::clone(lobe),
                None => {
                    let lobe = Arc::new(Lobe::of_roughness(gloss.roughness));
                    lobes.push(Arc::clone(&lobe));
                    lobe
                }
            };
            Some(Glossy {
                specular: gloss.specular,
                lobe,
            })
        });
        self.of_material = made.collect();
    }

    /// The lobe of a material, if it has one.
    pub(crate) fn of(&self, material: u32) -> Option<&Glossy> {
        self.of_material.get(material as usize)?.as_ref()
    }

    /// Whether any material has a lobe.
    pub(crate) fn any(&self) -> bool {
        self.of_material.iter().any(Option::is_some)
    }
}

/// Same colours and roughnesses reflect the same.
impl PartialEq for GlossyMaterials {
    fn eq(&self, other: &Self) -> bool {
        let key = |it: &Option<Glossy>| it.as_ref().map(|g| (g.specular, g.roughness()));
        let (a, b) = (self.of_material.iter(), other.of_material.iter());
        a.map(key).eq(b.map(key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::spherical_harmonics::harmonics;

    fn glossy(roughness: f32) -> GlossyMaterials {
        let gloss = Gloss::of(Vec3::new(0.9, 0.5, 0.1), roughness);
        GlossyMaterials::of_all([None, gloss, gloss].into_iter())
    }

    #[test]
    fn equal_roughnesses_share_a_table() {
        let materials = glossy(0.4);
        assert!(materials.of(0).is_none() && materials.any());
        let [a, b] = [1, 2].map(|k| materials.of(k).unwrap());
        assert!(Arc::ptr_eq(&a.lobe, &b.lobe));
    }

    /// Light from one direction: G_k = E h_k. The broader the lobe, the better 16
    /// terms have it: at roughness 1 within 8 % of the lobe's peak.
    #[test]
    fn a_broad_lobe_is_its_own_sum_and_turns_with_the_object() {
        let materials = glossy(1.0);
        let glossy = materials.of(1).unwrap();
        let normal = Vec3::new(0.2, 0.9, -0.3).normalize();
        let eye = Vec3::new(0.6, 0.7, 0.1).normalize();
        let light = Vec3::new(-0.3, 0.8, 0.5).normalize();
        let reflected = |[normal, eye, light]: [Vec3; 3]| {
            let frame = ViewedFrame::of(normal, eye);
            let g: [Vec3; 16] = harmonics(light).map(|h| Vec3::splat(h * normal.dot(light)));
            glossy.reflected(&frame, &g)
        };
        let here = reflected([normal, eye, light]);
        let exact = glossy.value(&ViewedFrame::of(normal, eye), light) * normal.dot(light);
        assert!((here - exact).abs().max_element() < 0.08 * exact.max_element());
        let turned = |v: Vec3| Vec3::new(v.z, v.x, v.y);
        let there = reflected([normal, eye, light].map(turned));
        assert!((here - there).abs().max_element() < 1e-5, "{here} {there}");
    }
}
