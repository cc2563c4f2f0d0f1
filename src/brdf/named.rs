//! Reflection by name: a new one is a line in the table.

use glam::Vec3;

/// Reflectance at normal incidence of a surface with a refractive index of 1.5.
pub(crate) const DIELECTRIC: f32 = 0.04;

/// A named kind of surface, to switch a material to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedBrdf {
    /// Name in the scene file, in `brdf = "..."`.
    pub name: &'static str,
    /// Roughness of its lobe; none without one.
    roughness: Option<f32>,
    /// Whether the material's colour is the lobe's instead of the diffuse part's.
    is_metal: bool,
}

const fn named(name: &'static str, roughness: Option<f32>, is_metal: bool) -> NamedBrdf {
    NamedBrdf {
        name,
        roughness,
        is_metal,
    }
}

/// All kinds by their names.
pub const NAMED_BRDFS: [NamedBrdf; 5] = [
    named("matte", None, false),
    named("satin", Some(0.55), false),
    named("plastic", Some(0.3), false),
    named("brushed metal", Some(0.5), true),
    named("polished metal", Some(0.2), true),
];

impl NamedBrdf {
    /// The kind of a name.
    pub fn of_name(name: &str) -> Option<Self> {
        NAMED_BRDFS.into_iter().find(|known| known.name == name)
    }

    /// Albedo, specular colour and roughness of a material of this kind whose
    /// albedo and specular colour were these. Its colour is the albedo, of a metal
    /// (whose albedo is black) the specular colour.
    pub fn applied(&self, albedo: Vec3, specular: Vec3) -> (Vec3, Vec3, Option<f32>) {
        let colour = if albedo == Vec3::ZERO {
            specular
        } else {
            albedo
        };
        match self.roughness {
            None => (colour, Vec3::ZERO, None),
            Some(roughness) if self.is_metal => (Vec3::ZERO, colour, Some(roughness)),
            Some(roughness) => (colour, Vec3::splat(DIELECTRIC), Some(roughness)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_material_that_was_a_metal_gets_its_colour_back() {
        let red = Vec3::new(0.7, 0.1, 0.1);
        let metal = NamedBrdf::of_name("brushed metal").unwrap();
        let (albedo, specular, _) = metal.applied(red, Vec3::ZERO);
        assert_eq!((albedo, specular), (Vec3::ZERO, red));
        for kind in NAMED_BRDFS {
            let (albedo, specular, roughness) = kind.applied(albedo, specular);
            assert_eq!(albedo + specular * f32::from(u8::from(kind.is_metal)), red);
            assert_eq!(roughness.is_some(), specular != Vec3::ZERO, "{}", kind.name);
        }
    }
}
