//! What the user wrote: the OBJ mesh with its MTL materials, and the TOML
//! scene file with lights, camera and settings.
//!
//! Comes in: paths. Goes out: [`Scene`], checked, in the units of the file and
//! in double precision, with a [`Placement`] that says how the later stages
//! see it. The only room that names `tobj`, `toml`
//! and `toml_edit`.

mod animation;
mod camera;
mod defects;
mod digest;
mod error;
mod file;
mod files;
mod golden;
mod images;
mod light;
mod load;
mod maps;
mod material;
mod mesh;
mod obj;
mod place;
mod placement;
#[cfg(test)]
mod sample_images;
#[cfg(test)]
pub(crate) mod sample_scenes;
mod save;
mod text;

use glam::Vec3;

pub use animation::Animation;

pub use camera::Camera;
pub(crate) use camera::PlacedCamera;
pub(crate) use digest::SceneDigests;
pub use error::SceneError;
pub use file::Override;
pub use golden::{GoldenKeys, PixelLimit};
pub use light::{Area, Directional, Environment, Light, LightKind, Point, Radiance, Spot};
pub(crate) use light::{
    Incident, LightSample, PlacedEnvironment, PlacedLight, PlacedLights, PlacedRectangle, PlacedSun,
};
pub use material::Material;
pub(crate) use material::Reflection;
pub(crate) use mesh::same_corners;
pub use mesh::{Mesh, MeshTriangle};
pub(crate) use placement::Placement;
pub(crate) use save::{Edited, EditedFile, SaveError, Saved, edited_file, save_file};

use crate::texture::TextureFilter;

/// A scene as the user described it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Triangles and normals, units of the file.
    pub mesh: Mesh,
    /// Materials; the index is [`MeshTriangle::material`].
    pub materials: Vec<Material>,
    /// Lights in the order of the file.
    pub lights: Vec<Light>,
    /// How textures are read between texel centres.
    pub texture_filter: TextureFilter,
    /// The camera.
    pub camera: Camera,
    /// `[render]`.
    pub render: RenderKeys,
    /// `[bake]`.
    pub bake: BakeKeys,
    /// `[[animate]]`, in the order of the file.
    pub animations: Vec<Animation>,
    /// `[golden]`.
    pub golden: GoldenKeys,
    /// The files besides the scene file that it was read from, or that it names
    /// and are not there.
    pub files: Vec<std::path::PathBuf>,
    /// What was dropped, clamped or is not rendered yet: one sentence a kind.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Whether there is a light or a triangle that emits.
    pub fn has_light(&self) -> bool {
        !self.lights.is_empty() || self.emitting_triangles().next().is_some()
    }

    /// The triangles whose material emits.
    pub(crate) fn emitting_triangles(&self) -> impl Iterator<Item = &MeshTriangle> {
        let emits = |it: &&MeshTriangle| {
            let material = &self.materials[it.material as usize];
            material.emission != Vec3::ZERO
        };
        self.mesh.triangles.iter().filter(emits)
    }
}

/// Where shading normals come from: `normals`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Normals {
    /// `vn` where all corners of a face have one, else flat.
    File,
    /// The face's own normal.
    Flat,
    /// Area-weighted over equal positions within one material.
    Smooth,
}

/// Number of indirect bounces after the direct light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bounces {
    /// Exactly this many.
    Count(u32),
    /// Until the remainder is below 1e-5 of the total.
    All,
}

/// Tone curve from exposed radiance to display values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Clip to 0..1.
    Srgb,
    /// ACES as fitted by Narkowicz.
    Filmic,
}

/// `[render]`: settings of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderKeys {
    /// Indirect bounces; 4 by default.
    pub bounces: Bounces,
    /// EV; radiance x 2^EV before the tone curve.
    pub exposure: f32,
    /// Tone curve of 8-bit output.
    pub tone: Tone,
    /// Shadow rays an area light and pixel.
    pub light_samples: u32,
}

impl RenderKeys {
    /// Where a light is partly hidden, a pixel takes four times as many points of
    /// it, out of a set of 65,536.
    pub(crate) const MOST_LIGHT_SAMPLES: u32 = 16_384;
}

impl Default for RenderKeys {
    fn default() -> Self {
        Self {
            bounces: Bounces::Count(4),
            exposure: 0.0,
            tone: Tone::Srgb,
            light_samples: 16,
        }
    }
}

/// `[bake]`: settings of the precomputation; `None` where the key is absent.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BakeKeys {
    /// Relative error of indirect light to reach.
    pub error: Option<f64>,
    /// Longest edge that is left undivided, scene units.
    pub max_edge: Option<f64>,
    /// Most lighting vertices that tessellation may make.
    pub vertices: Option<u32>,
    /// Rays a lighting vertex.
    pub rays: Option<u32>,
    /// Basis functions in all.
    pub functions: Option<u32>,
    /// Coefficients a vertex in the mean, near field included.
    pub coefficients: Option<u32>,
    /// `fixed_albedo`: all bounces folded into one operator.
    pub fixed_albedo: bool,
}

/// Largest component of an RGB triple.
pub(crate) fn max_component(rgb: Vec3) -> f32 {
    let mut largest = rgb.x;
    if rgb.y > largest {
        largest = rgb.y;
    }
    if rgb.z > largest {
        largest = rgb.z;
    }
    largest
}
