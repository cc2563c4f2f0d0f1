//! What a scene asks for and what it will cost, before anything is baked.

use std::collections::BTreeMap;
use std::path::Path;

use super::frame::FrameSettings;
use crate::bake::{BakeForecast, OPEN_SHARE};
use crate::scene::{LightKind, Material, PlacedLight, PlacedLights, Radiance, Scene};
use crate::surface::Surface;

/// What lies ahead of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// What the files hold.
    pub contents: SceneContents,
    /// Triangles of the lighting mesh.
    pub triangles: usize,
    /// Longest edge left whole, scene units.
    pub max_edge: f64,
    /// The same as the scene asks for, where that would make too many vertices.
    pub max_edge_asked: Option<f64>,
    /// Error of indirect light that is asked for, where a bake begins with a search for
    /// it; the forecast is that of the settings before.
    pub error_asked: Option<f64>,
    /// Share of the rays of front sides that escape, 0 to 1, by a survey.
    pub escaped_share_of_fronts: f64,
    /// The frame that the scene file asks for.
    pub frame: FrameSettings,
    /// The bake, forecast or found.
    pub bake: BakeForecast,
}

/// Which sides of the surface see the sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SkyView {
    /// Front sides: an environment is a light like any other.
    Fronts,
    /// Back sides alone, such as the outside of a closed room's walls: an
    /// environment lights only these.
    BacksAlone,
    /// None past anything: the scene is closed, and its bake has no rows for the
    /// sky. The outside of its walls, which sees nothing else, needs none.
    Nobody,
}

/// What a scene's files hold.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneContents {
    /// Triangles of the file, before tessellation.
    pub triangles: usize,
    /// Longest side of the bounding box, scene units.
    pub extent: f64,
    /// Materials that triangles use.
    pub materials: usize,
    /// Textures of these materials and maps of environments, each file once.
    pub images: ImageCounts,
    /// Lights by kind.
    pub lights: LightCounts,
}

/// Images in memory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ImageCounts {
    /// Different files.
    pub count: usize,
    /// Pixels of all files.
    pub pixels: usize,
    /// Bytes in memory, smaller copies included.
    pub bytes: usize,
}

/// Lights by kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LightCounts {
    /// `kind = "point"`.
    pub point: usize,
    /// `kind = "spot"`.
    pub spot: usize,
    /// `kind = "directional"`.
    pub directional: usize,
    /// `kind = "area"`.
    pub area: usize,
    /// `kind = "environment"`.
    pub environment: usize,
    /// Triangles of materials that emit: all of them are one more light.
    pub emitting_triangles: usize,
    /// Suns found in maps of environments: each is one more light.
    pub suns: usize,
    /// Sources of direct light that one shadow ray a pixel is enough for.
    pub sharp: usize,
    /// Sources that take [`FrameSettings::light_samples`] shadow rays a pixel.
    pub soft: usize,
}

impl Outlook {
    /// Shadow rays of a pixel that one surface fills, all lights together; a
    /// pixel at an edge or in a penumbra takes up to 16 times as many.
    pub fn shadow_rays_a_pixel(&self) -> usize {
        let lights = &self.contents.lights;
        lights.sharp + lights.soft * self.frame.light_samples as usize
    }

    /// Who sees the sky.
    pub fn sky_view(&self) -> SkyView {
        if !self.bake.has_sky {
            SkyView::Nobody
        } else if self.escaped_share_of_fronts > OPEN_SHARE {
            SkyView::Fronts
        } else {
            SkyView::BacksAlone
        }
    }
}

impl SceneContents {
    pub(super) fn of(scene: &Scene, surface: &Surface) -> Self {
        let used = used_materials(scene);
        Self {
            triangles: scene.mesh.triangles.len(),
            extent: surface.placement.extent,
            materials: used.len(),
            images: ImageCounts::of(scene, &used),
            lights: LightCounts::of(scene, surface),
        }
    }
}

fn used_materials(scene: &Scene) -> Vec<&Material> {
    let mut is_used = vec![false; scene.materials.len()];
    for triangle in &scene.mesh.triangles {
        is_used[triangle.material as usize] = true;
    }
    let materials = scene.materials.iter().zip(is_used);
    materials
        .filter_map(|(m, used)| used.then_some(m))
        .collect()
}

impl ImageCounts {
    fn of(scene: &Scene, used: &[&Material]) -> Self {
        let mut images: BTreeMap<&Path, ([u32; 2], usize)> = BTreeMap::new();
        for material in used {
            let maps = [&material.albedo_map, &material.emission_map];
            for map in maps.into_iter().flatten() {
                let texture = &map.texture;
                images.insert(texture.path(), (texture.size(), texture.bytes()));
            }
        }
        for light in &scene.lights {
            if let LightKind::Environment(environment) = &light.kind
                && let Radiance::Map(map) = &environment.radiance
            {
                images.insert(map.path(), (map.size(), map.bytes()));
            }
        }
        let pixels = |&([width, height], _): &([u32; 2], usize)| width as usize * height as usize;
        Self {
            count: images.len(),
            pixels: images.values().map(pixels).sum(),
            bytes: images.values().map(|&(_, bytes)| bytes).sum(),
        }
    }
}

impl LightCounts {
    fn of(scene: &Scene, surface: &Surface) -> Self {
        let mut counts = Self::default();
        for light in &scene.lights {
            match light.kind {
                LightKind::Point(_) => counts.point += 1,
                LightKind::Spot(_) => counts.spot += 1,
                LightKind::Directional(_) => counts.directional += 1,
                LightKind::Area(_) => counts.area += 1,
                LightKind::Environment(_) => counts.environment += 1,
            }
        }
        counts.emitting_triangles = scene.emitting_triangles().count();
        for source in PlacedLights::of(scene, &surface.placement).sources {
            match source {
                PlacedLight::Surfaces(_) => counts.soft += 1,
                PlacedLight::Sun(_) => {
                    counts.suns += 1;
                    counts.soft += 1;
                }
                PlacedLight::Point(_) | PlacedLight::Spot(_) | PlacedLight::Directional(_) => {
                    counts.sharp += 1;
                }
            }
        }
        counts
    }
}
