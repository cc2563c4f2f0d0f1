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
    /// the specular colour.
    pub fn applied(&self, albedo: Vec3, specular: Vec3) -> (Vec3, Vec3, Option<f32>) {
        let colour = if is_metal(albedo, specular) {
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

/// Whether a surface is a metal: its albedo is black, and what it reflects is not
/// the lobe of a black dielectric.
pub(crate) fn is_metal(albedo: Vec3, specular: Vec3) -> bool {
    albedo == Vec3::ZERO && specular != Vec3::ZERO && specular != Vec3::splat(DIELECTRIC)
}

/// Place in [`NAMED_BRDFS`] of the kind that a surface is, or is most like: of those
/// with or without a lobe, metal or not, the one of the nearest roughness.
pub(crate) fn nearest_kind(albedo: Vec3, specular: Vec3, roughness: f32) -> usize {
    let is_metal = is_metal(albedo, specular);
    let distance = |kind: &NamedBrdf| match (kind.roughness, specular == Vec3::ZERO) {
        (None, true) => Some(0.0),
        (Some(of_kind), false) if kind.is_metal == is_metal => Some((of_kind - roughness).abs()),
        _ => None,
    };
    let alike = NAMED_BRDFS.iter().enumerate();
    let alike = alike.filter_map(|(index, kind)| Some((index, distance(kind)?)));
    let nearest = alike.min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map_or(0, |(index, _)| index)
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

    #[test]
    fn surfaces_are_of_the_kind_that_was_applied() {
        for colour in [Vec3::new(0.7, 0.1, 0.1), Vec3::ONE] {
            for (index, kind) in NAMED_BRDFS.iter().enumerate() {
                let (albedo, specular, roughness) = kind.applied(colour, Vec3::ZERO);
                let nearest = nearest_kind(albedo, specular, roughness.unwrap_or(1.0));
                assert_eq!(nearest, index, "{}", kind.name);
            }
        }
        let rougher = nearest_kind(Vec3::ONE, Vec3::splat(0.1), 0.4);
        assert_eq!(NAMED_BRDFS[rougher].name, "plastic");
    }

    #[test]
    fn black_plastic_is_no_metal_and_stays_black() {
        let plastic = NamedBrdf::of_name("plastic").unwrap();
        let (albedo, specular, _) = plastic.applied(Vec3::ZERO, Vec3::ZERO);
        assert_eq!(
            plastic.applied(albedo, specular),
            (Vec3::ZERO, Vec3::splat(DIELECTRIC), Some(0.3))
        );
    }
}
