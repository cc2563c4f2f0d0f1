//! How surfaces reflect: a diffuse part and a glossy lobe,
//! f = Kd/pi (1 - E_s) + f_s.
//!
//! Comes in: the specular colour and roughness of a material. Goes out: values of
//! the lobe f_s for direct light ([`Ggx`]), its directional albedo E_s and its 16
//! spherical-harmonics coefficients by the view's angle ([`Lobe`]), directions for
//! paths. E_s leaves the diffuse part what the lobe does not reflect (Ashikhmin
//! and Shirley, "An Anisotropic Phong BRDF Model", 2000, without the factor of the
//! light's direction, which would make it reciprocal and darker), so that no
//! surface gives back more than it got.
//!
//! Fresnel is Schlick's: F = F0 (1 - s) + s, s = (1 - v.h)^5. Everything linear in
//! the lobe therefore has two parts, what the specular colour F0 multiplies and
//! what is white: [`Parts`]. A table made for a roughness serves every colour.

mod ggx;
mod glossy;
mod lobe;
mod named;

pub(crate) use ggx::{Ggx, ViewedFrame};
pub(crate) use glossy::{Glossy, GlossyMaterials};
pub(crate) use lobe::Lobe;
pub(crate) use named::{DIELECTRIC, is_metal, nearest_kind};
pub use named::{NAMED_BRDFS, NamedBrdf};

use glam::Vec3;

use crate::maths::order::Order;

/// Least roughness of a lobe: what is smoother reflects as this does. Its
/// highlight is 0.6 degrees wide; below, direct light of a point falls between
/// pixels and single precision loses the peak.
pub(crate) const LEAST_ROUGHNESS: f32 = 0.05;

/// A glossy lobe of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gloss {
    /// Reflectance F0 at normal incidence per channel, 0 to 1.
    pub specular: Vec3,
    /// Perceptual roughness, 0.05 to 1: the square root of GGX's alpha.
    pub roughness: f32,
}

impl Gloss {
    /// Gloss of a specular colour, if it is not black; `roughness` from 0 on.
    pub(crate) fn of(specular: Vec3, roughness: f32) -> Option<Self> {
        (specular != Vec3::ZERO).then(|| Self {
            specular,
            roughness: roughness.at_least(LEAST_ROUGHNESS).at_most(1.0),
        })
    }
}

/// Roughness of a Phong exponent `Ns` of 0 and more: alpha = sqrt(2 / (Ns + 2))
/// (Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces",
/// section 5.2), and roughness is its square root.
pub(crate) fn roughness_of_exponent(exponent: f64) -> f64 {
    (2.0 / (exponent + 2.0)).sqrt().sqrt()
}

/// Something linear in the lobe: specular colour x `coloured` + `white`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Parts {
    pub(crate) coloured: f32,
    pub(crate) white: f32,
}

impl Parts {
    /// A value split by Schlick's term of the cosine between viewer and half vector.
    fn split(value: f32, view_dot_half: f32) -> Self {
        let m = (1.0 - view_dot_half).at_least(0.0);
        let schlick = (m * m) * (m * m) * m;
        Self {
            coloured: value * (1.0 - schlick),
            white: value * schlick,
        }
    }

    /// The value for a specular colour.
    pub(crate) fn of(self, specular: Vec3) -> Vec3 {
        specular * self.coloured + Vec3::splat(self.white)
    }

    fn mixed(self, other: Self, share: f32) -> Self {
        Self {
            coloured: self.coloured + (other.coloured - self.coloured) * share,
            white: self.white + (other.white - self.white) * share,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_become_roughness() {
        assert_eq!(roughness_of_exponent(0.0), 1.0);
        // alpha 0.16 is roughness 0.4.
        let exponent = 2.0 / (0.16 * 0.16) - 2.0;
        assert!((roughness_of_exponent(exponent) - 0.4).abs() < 1e-12);
    }

    #[test]
    fn black_has_no_lobe_and_mirrors_are_held_back() {
        assert_eq!(Gloss::of(Vec3::ZERO, 0.5), None);
        let mirror = Gloss::of(Vec3::ONE, 0.0).unwrap();
        assert_eq!(mirror.roughness, LEAST_ROUGHNESS);
    }
}
