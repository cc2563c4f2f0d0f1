//! Short names of what a scene resolves to: equal digests mean that the same is
//! lit and seen. No name, path, line or comment is in them, so a scene that is
//! moved or written in another way keeps its digests.

use blake3::Hasher;
use glam::{DVec3, Vec3};

use super::{Light, LightKind, Material, Mesh, Radiance, Scene};
use crate::texture::{TextureFilter, TextureMap};

/// Hex digits of a digest: the first 16 bytes of the hash.
const HEX_DIGITS: usize = 32;

/// What of a scene an image can differ by, besides camera and settings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SceneDigests {
    /// Triangles, normals and texture coordinates.
    pub(crate) geometry: String,
    /// Materials with the pixels of their maps, and how these are filtered.
    pub(crate) materials: String,
    /// Lights, in their order, with the pixels of their maps.
    pub(crate) lights: String,
    /// All three.
    pub(crate) scene: String,
}

impl SceneDigests {
    pub(crate) fn of(scene: &Scene) -> Self {
        let geometry = digest(|words| words.mesh(&scene.mesh));
        let materials = digest(|words| {
            words.word(u64::from(scene.texture_filter == TextureFilter::Nearest));
            for material in &scene.materials {
                words.material(material);
            }
        });
        let lights = digest(|words| {
            for light in &scene.lights {
                words.light(light);
            }
        });
        let scene = digest(|words| {
            for part in [&geometry, &materials, &lights] {
                words.0.update(part.as_bytes());
            }
        });
        Self {
            geometry,
            materials,
            lights,
            scene,
        }
    }
}

fn digest(fill: impl FnOnce(&mut Words)) -> String {
    let mut words = Words(Hasher::new());
    fill(&mut words);
    words.0.finalize().to_hex()[..HEX_DIGITS].to_owned()
}

/// A hash that is fed with numbers.
struct Words(Hasher);

impl Words {
    fn word(&mut self, word: u64) {
        self.0.update(&word.to_le_bytes());
    }

    fn numbers<const N: usize>(&mut self, numbers: [f64; N]) {
        for number in numbers {
            self.word(number.to_bits());
        }
    }

    fn colour(&mut self, rgb: Vec3) {
        self.numbers(rgb.to_array().map(f64::from));
    }

    fn place(&mut self, place: DVec3) {
        self.numbers(place.to_array());
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.word(mesh.positions.len() as u64);
        mesh.positions.iter().for_each(|&p| self.place(p));
        self.word(mesh.normals.len() as u64);
        mesh.normals.iter().for_each(|&n| self.place(n));
        self.word(mesh.texture_coordinates.len() as u64);
        for uv in &mesh.texture_coordinates {
            self.numbers(uv.to_array());
        }
        for triangle in &mesh.triangles {
            let indices = [triangle.normals, triangle.texture_coordinates];
            let [normals, coordinates] = indices.map(|i| i.unwrap_or([u32::MAX; 3]));
            for index in [triangle.corners, normals, coordinates].concat() {
                self.word(u64::from(index));
            }
            self.word(u64::from(triangle.material));
        }
    }

    fn material(&mut self, material: &Material) {
        for colour in [material.albedo, material.emission, material.specular] {
            self.colour(colour);
        }
        self.numbers([material.roughness.map_or(-1.0, f64::from)]);
        self.map(material.albedo_map.as_ref());
        self.map(material.emission_map.as_ref());
    }

    fn map(&mut self, map: Option<&TextureMap>) {
        self.word(u64::from(map.is_some()));
        if let Some(map) = map {
            self.0.update(map.texture.digest());
            let [scale, offset] = [map.scale, map.offset].map(|v| v.as_dvec2().to_array());
            self.numbers(scale);
            self.numbers(offset);
            self.word(u64::from(map.clamp));
        }
    }

    /// A number a kind comes first, so that two kinds never read alike.
    fn light(&mut self, light: &Light) {
        match &light.kind {
            LightKind::Point(point) => {
                self.word(0);
                self.place(point.position);
                self.colour(point.intensity);
            }
            LightKind::Spot(spot) => {
                self.word(1);
                self.place(spot.position);
                self.colour(spot.direction);
                self.colour(spot.intensity);
                self.numbers([spot.cutoff_deg, spot.beam_deg].map(f64::from));
            }
            LightKind::Directional(light) => {
                self.word(2);
                self.colour(light.direction);
                self.colour(light.irradiance);
            }
            LightKind::Area(area) => {
                self.word(3);
                for place in [area.corner, area.edge_u, area.edge_v] {
                    self.place(place);
                }
                self.colour(area.radiance);
            }
            LightKind::Environment(environment) => {
                self.word(4);
                self.radiance(&environment.radiance);
                self.numbers([environment.scale, environment.rotation_deg].map(f64::from));
            }
        }
    }

    fn radiance(&mut self, radiance: &Radiance) {
        match radiance {
            Radiance::Constant(radiance) => {
                self.word(0);
                self.colour(*radiance);
            }
            Radiance::Map(map) => {
                self.word(1);
                self.0.update(map.digest());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::sample_scenes;

    #[test]
    fn a_digest_sees_what_it_is_of_and_no_names() {
        let mut scene = sample_scenes::cube_room(2.0, 1.0, 16);
        scene.lights = vec![sample_scenes::constant_sky(1.0)];
        let before = SceneDigests::of(&scene);
        let mut changed = scene.clone();
        changed.materials[0].name = "renamed".to_owned();
        changed.materials[0].albedo.x += 0.01;
        changed
            .lights
            .iter_mut()
            .for_each(|light| light.name = "renamed".to_owned());
        let after = SceneDigests::of(&changed);
        assert_eq!(before.geometry, after.geometry);
        assert_ne!(before.materials, after.materials);
        assert_eq!(before.lights, after.lights);
        assert_ne!(before.scene, after.scene);
        changed.materials = scene.materials.clone();
        changed.materials[0].name = "renamed".to_owned();
        assert_eq!(SceneDigests::of(&changed), before);
        changed.lights = vec![sample_scenes::constant_sky(1.5)];
        assert_ne!(SceneDigests::of(&changed).lights, before.lights);
        changed.mesh.positions[0].x += 0.5;
        assert_ne!(SceneDigests::of(&changed).geometry, before.geometry);
    }
}
