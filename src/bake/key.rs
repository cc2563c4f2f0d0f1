//! The key of a bake: a hash of what the bake reads, and only of that.

use glam::Vec3;

use super::{BakeSettings, Scheme};
use crate::surface::Surface;

/// Changes whenever the same input gives another bake, but for what the two below
/// say, or the file another form.
pub(super) const ALGORITHM_VERSION: u32 = 19;

/// Changes whenever the search for an error that is asked for ends at other settings.
const SEARCH_VERSION: u32 = 4;

/// Changes whenever the same bake is folded in another way.
const FOLDING_VERSION: u32 = 1;

/// Content key of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BakeKey([u8; 32]);

impl BakeKey {
    /// Key of a surface's fronts (positions, normals, normal groups, material
    /// borders, which triangles are glossy) under settings. Albedo, lights and camera are not in it; sides
    /// follow from the geometry.
    pub(crate) fn of(surface: &Surface, settings: &BakeSettings) -> Self {
        let mut hash = blake3::Hasher::new();
        let mut words = |list: &[u32]| {
            for word in list {
                hash.update(&word.to_le_bytes());
            }
        };
        let functions = settings.functions.map_or([0, 0], |f| [1, f]);
        words(&[
            ALGORITHM_VERSION,
            settings.rays,
            settings.coefficients,
            settings.vertices_per_part,
        ]);
        words(&functions);
        // Without an error to reach, it is the same whether a key was set or not.
        if let Some(error) = settings.error {
            let bits = error.to_bits();
            let free = settings.free;
            words(&[SEARCH_VERSION, bits as u32, (bits >> 32) as u32]);
            words(&[free.rays, free.functions, free.coefficients].map(u32::from));
        }
        // Another partitioner makes another bake of the published scheme.
        if settings.scheme == Scheme::Paper {
            let [scheme, partitioner] =
                [settings.scheme.tag(), settings.scheme.partitioner().tag()];
            words(&[scheme, partitioner].map(u32::from));
        }
        words(&[
            surface.mesh.positions.len() as u32,
            surface.mesh.triangles.len() as u32,
        ]);
        let extent = (surface.placement.extent * surface.placement.scale).to_bits();
        words(&[extent as u32, (extent >> 32) as u32]);
        for position in &surface.mesh.positions {
            words(&position.to_array().map(f32::to_bits));
        }
        for (index, triangle) in surface.mesh.triangles.iter().enumerate() {
            words(&triangle.corners);
            words(&surface.vertices.of_triangle(index as u32, true));
            for normal in triangle.normals {
                words(&normal.to_array().map(f32::to_bits));
            }
        }
        // Slices are made only where a material is glossy.
        if surface.glossy_materials.contains(&true) {
            for triangle in &surface.mesh.triangles {
                let is_glossy = surface.glossy_materials[triangle.material as usize];
                words(&[u32::from(is_glossy)]);
            }
        }
        Self(*hash.finalize().as_bytes())
    }

    /// Key of the same bake with all bounces folded under an albedo a front
    /// vertex; back sides have that of their fronts.
    pub(super) fn with_albedo(&self, albedo: &[Vec3]) -> Self {
        let mut hash = blake3::Hasher::new();
        hash.update(b"fixed albedo");
        hash.update(&FOLDING_VERSION.to_le_bytes());
        hash.update(&self.0);
        for channel in albedo.iter().flat_map(|rho| rho.to_array()) {
            hash.update(&channel.to_bits().to_le_bytes());
        }
        Self(*hash.finalize().as_bytes())
    }

    pub(super) fn bytes(&self) -> &[u8; 32] {
        &self.0
    }

    pub(super) fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// Name of the file that holds the bake.
    pub(crate) fn file_name(&self) -> String {
        let hex: String = self.0[..16]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        format!("{hex}.bake")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::FreeKeys;
    use crate::scene::sample_scenes::room_with_blocks;
    use crate::surface::Detail;

    #[test]
    fn whether_a_key_was_set_counts_where_an_error_is_asked_for() {
        let scene = room_with_blocks(false, 0.3, 64);
        let surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
        let name = |error: Option<f64>, rays: bool| {
            let free = FreeKeys {
                rays,
                functions: true,
                coefficients: true,
            };
            let settings = BakeSettings {
                error,
                free,
                ..BakeSettings::of_keys(&scene.bake)
            };
            BakeKey::of(&surface, &settings).file_name()
        };
        assert_eq!(name(None, true), name(None, false));
        let asked = [
            name(None, true),
            name(Some(0.02), true),
            name(Some(0.02), false),
            name(Some(0.03), true),
        ];
        for (place, one) in asked.iter().enumerate() {
            assert!(!asked[..place].contains(one), "{place}");
        }
    }
}
