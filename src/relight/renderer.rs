//! A scene that is ready to be lit and drawn, again and again.

use std::path::{Path, PathBuf};

use glam::Vec3;
use thiserror::Error;

use super::basis_view::{BasisFunctionError, BasisView};
use super::bounces::{BounceError, Transport};
use super::colours::VertexColours;
use super::component::Component;
use super::kept::{KeptDirect, KeptLights};
use super::outlook::{Outlook, SceneContents};
use super::shade::{View, draw};
use super::stages::Stages;
use crate::bake::{
    self, Bake, BakeError, BakeForecast, BakeSettings, BakeStats, CacheOutcome, RunSettings,
    Scheme, escaped_share_of_fronts, forecast, load_or_bake, load_stored,
};
use crate::frame::{Development, EncodedImage, Image};
use crate::maths::order::Order;
use crate::scene::{Bounces, Camera, Light, LightKind, PlacedLights, RenderKeys, Scene, Tone};
use crate::surface::{Detail, Surface};

/// Why there is no frame.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The precomputation failed or was stopped.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// The bounces do not converge.
    #[error(transparent)]
    Bounces(#[from] BounceError),
    /// The function of the basis to show does not exist.
    #[error(transparent)]
    Basis(#[from] BasisFunctionError),
    /// The job was stopped.
    #[error("the frame was stopped; nothing was written")]
    Cancelled,
}

/// What a frame shows and how: settings that change its bits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameSettings {
    /// The camera, with the size of the frame.
    pub camera: Camera,
    /// Indirect bounces after the direct light.
    pub bounces: Bounces,
    /// Shadow rays a pixel to a light that is no point, 1 to 16,384; what is
    /// beyond is taken for these.
    pub light_samples: u32,
    /// What is shown.
    pub component: Component,
}

impl FrameSettings {
    /// What the scene file asks for.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            camera: scene.camera,
            bounces: scene.render.bounces,
            light_samples: scene.render.light_samples,
            component: Component::Global,
        }
    }

    fn needs_bounces(&self) -> bool {
        self.component.needs_indirect() && self.bounces != Bounces::Count(0)
    }

    fn needs_direct_at_vertices(&self) -> bool {
        self.needs_bounces() || self.component == Component::ApproximatedDirect
    }

    /// The sky's direct light comes from the bake too.
    fn needs_sky(&self, lights: &PlacedLights) -> bool {
        self.component.needs_direct() && !lights.skies.is_empty()
    }
}

/// A frame: linear, neither exposed nor tone-mapped.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// What the image shows.
    pub component: Component,
    /// The component asked for, row 0 on top.
    pub image: Image,
    /// Pixels whose indirect (or approximated direct) light was below zero and
    /// was set to it.
    pub clamped_pixels: u64,
    /// Lights whose light at the vertices was computed for this frame.
    pub computed_lights: usize,
    /// Milliseconds by stage.
    pub stages: Stages,
}

/// The 8-bit levels of a component: light is exposed (EV) and goes through the
/// tone curve; albedo and pictures of the basis are colours; normals are shown as 0.5 + 0.5 n and depth
/// from white (nearest) to black (farthest).
pub fn develop(image: &Image, component: Component, exposure: f32, tone: Tone) -> EncodedImage {
    match component {
        Component::Albedo | Component::Partitions | Component::Basis(_) => {
            Development::Color.develop(image)
        }
        Component::Normal => Development::Plain
            .develop(&image.map(|n| if n == Vec3::ZERO { n } else { n * 0.5 + 0.5 })),
        Component::Depth => Development::Plain.develop(&nearness(image)),
        _ => Development::Radiance { exposure, tone }.develop(image),
    }
}

/// Depths as 1 (nearest) to 0 (farthest, and where nothing is seen).
fn nearness(depths: &Image) -> Image {
    let seen = || depths.pixels().iter().map(|p| p.x).filter(|&d| d > 0.0);
    let nearest = seen().fold(f32::INFINITY, f32::at_most);
    let range = seen().fold(0.0, f32::at_least) - nearest;
    depths.map(|p| {
        let share = if range > 0.0 {
            (p.x - nearest) / range
        } else {
            0.0
        };
        Vec3::splat(if p.x > 0.0 { 1.0 - share } else { 0.0 })
    })
}

impl Frame {
    /// The frame's 8-bit levels; see [`develop`].
    pub fn develop(&self, exposure: f32, tone: Tone) -> EncodedImage {
        develop(&self.image, self.component, exposure, tone)
    }
}

/// How big a scene and its bake are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneFigures {
    /// Lighting vertices, both sides.
    pub vertices: usize,
    /// Those on back sides.
    pub back_vertices: usize,
    /// Triangles of the lighting mesh.
    pub triangles: usize,
    /// Longest edge left whole, scene units.
    pub max_edge: f64,
    /// Of the bake, where one was needed.
    pub bake: Option<BakeFigures>,
}

/// How big a bake is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeFigures {
    /// Partitions of the basis.
    pub partitions: usize,
    /// Basis functions in all.
    pub functions: usize,
    /// Entries a vertex in the mean, near field included.
    pub coefficients_per_vertex: f64,
    /// Bytes of the bake's file.
    pub bytes: usize,
    /// Bytes of the compressed rows.
    pub row_bytes: usize,
    /// Whether it came from the cache.
    pub cached: bool,
    /// What the bake says of itself.
    pub stats: BakeStats,
}

/// The bake and where it came from.
struct Baked {
    bake: Bake,
    cached: bool,
    file_bytes: usize,
}

impl From<bake::Baked> for Baked {
    fn from(baked: bake::Baked) -> Self {
        Self {
            bake: baked.bake,
            cached: baked.outcome == CacheOutcome::Hit,
            file_bytes: baked.file_bytes,
        }
    }
}

/// A scene with its surface and, once a frame needs it, its bake. Lights,
/// albedos, camera and bounces may change from frame to frame; what did not
/// change is not computed again.
pub struct Renderer {
    scene: Scene,
    surface: Surface,
    baked: Option<Baked>,
    scheme: Scheme,
    cache_folder: Option<PathBuf>,
    placed: KeptLights,
    kept: KeptDirect,
    colours: VertexColours,
    warnings: Vec<String>,
    stages: Stages,
}

impl Renderer {
    /// Prepares a scene. Bakes come from and go to `cache_folder`; without one
    /// they live as long as the renderer.
    pub fn new(scene: Scene, cache_folder: Option<&Path>) -> Self {
        Self::with_scheme(scene, cache_folder, Scheme::Relume)
    }

    /// The same with a bake that follows a scheme of choice.
    pub fn with_scheme(scene: Scene, cache_folder: Option<&Path>, scheme: Scheme) -> Self {
        let mut stages = Stages::default();
        let surface = stages.time("surface", || {
            Surface::fronts(&scene, &Detail::of_keys(&scene.bake))
        });
        let mut warnings = surface.warnings.clone();
        warnings.extend(scheme.warning());
        Self {
            scene,
            surface,
            baked: None,
            scheme,
            cache_folder: cache_folder.map(Path::to_owned),
            placed: KeptLights::default(),
            kept: KeptDirect::default(),
            colours: VertexColours::default(),
            warnings,
            stages,
        }
    }

    /// The scene as it is lit now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Changes lights or materials; the mesh and `[bake]` stay what they are.
    /// Materials stay as many as they were, and a map can be given to one only
    /// where the scene was loaded with texture coordinates for it. One name may
    /// stand for two materials, with and without maps.
    pub fn relight(
        &mut self,
        change: impl FnOnce(&mut Vec<crate::scene::Light>, &mut Vec<crate::scene::Material>),
    ) {
        change(&mut self.scene.lights, &mut self.scene.materials);
    }

    /// Makes sure that there is a bake: from the cache, or a new one.
    pub fn bake(&mut self, run: &RunSettings) -> Result<(), BakeError> {
        if self.baked.is_some() {
            return Ok(());
        }
        let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
        let (surface, folder) = (&mut self.surface, self.cache_folder.as_deref());
        let baked = self
            .stages
            .time("bake", || load_or_bake(surface, &settings, folder, run))?;
        self.warnings.extend(baked.warnings.iter().cloned());
        self.baked = Some(baked.into());
        Ok(())
    }

    /// What the scene asks for and what its bake will cost, without baking:
    /// from a bake that exists, or from a few rays in about half a second.
    /// Nothing is written, and no later result changes.
    ///
    /// # Errors
    /// [`BakeError::Cancelled`] when the job was stopped.
    pub fn outlook(&mut self, run: &RunSettings) -> Result<Outlook, BakeError> {
        let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
        if self.baked.is_none() {
            self.load(&settings);
        }
        let bake = match &self.baked {
            Some(baked) => BakeForecast::of(&baked.bake, baked.file_bytes),
            None => forecast(&mut self.surface, &settings, run)?,
        };
        Ok(Outlook {
            contents: SceneContents::of(&self.scene, &self.surface),
            triangles: self.surface.mesh.triangles.len(),
            max_edge: self.surface.max_edge,
            escaped_share_of_fronts: escaped_share_of_fronts(&self.surface, run.level),
            frame: FrameSettings::of_scene(&self.scene),
            bake,
        })
    }

    /// Takes the bake from the cache, if it is there. One that cannot be used is
    /// warned of when it is made anew.
    fn load(&mut self, settings: &BakeSettings) {
        let (surface, folder) = (&mut self.surface, self.cache_folder.as_deref());
        let stored = self
            .stages
            .time("bake", || load_stored(surface, settings, folder));
        self.baked = stored.ok().flatten().map(Baked::from);
    }

    /// Whether a frame needs a bake that the renderer does not have yet.
    pub fn needs_bake(&self, settings: &FrameSettings) -> bool {
        self.baked.is_none() && self.reads_bake(settings)
    }

    /// Whether a frame depends on the bake.
    pub(super) fn reads_bake(&self, settings: &FrameSettings) -> bool {
        let is_sky = |light: &Light| matches!(light.kind, LightKind::Environment(_));
        let has_sky = self.scene.lights.iter().any(is_sky);
        let needs_sky = settings.component.needs_direct() && has_sky;
        let needs_basis = settings.component.needs_basis();
        settings.needs_bounces() || needs_sky || needs_basis
    }

    /// What the user should know about mesh and cache; each sentence once.
    pub fn take_warnings(&mut self) -> Vec<String> {
        std::mem::take(&mut self.warnings)
    }

    /// Milliseconds that preparation took, by stage.
    pub fn preparation(&self) -> &Stages {
        &self.stages
    }

    /// How big everything is.
    pub fn figures(&self) -> SceneFigures {
        let vertices = &self.surface.vertices;
        SceneFigures {
            vertices: vertices.len(),
            back_vertices: vertices.len() - vertices.front_count(),
            triangles: self.surface.mesh.triangles.len(),
            max_edge: self.surface.max_edge,
            bake: self.baked.as_ref().map(|baked| BakeFigures {
                partitions: baked.bake.basis().part_count(),
                functions: baked.bake.basis().function_count(),
                coefficients_per_vertex: baked.bake.operator().coefficients_per_vertex(),
                bytes: baked.file_bytes,
                row_bytes: baked.bake.operator().bytes(),
                cached: baked.cached,
                stats: *baked.bake.stats(),
            }),
        }
    }

    /// The surface, and the bake once there is one.
    pub(crate) fn transfer(&self) -> (&Surface, Option<&Bake>) {
        (&self.surface, self.baked.as_ref().map(|baked| &baked.bake))
    }

    /// Draws a frame; bakes first where the frame needs it.
    pub fn frame(
        &mut self,
        settings: &FrameSettings,
        run: &RunSettings,
    ) -> Result<Frame, RenderError> {
        let mut stages = Stages::default();
        let lights = stages.time("lights", || {
            self.placed.update(&self.scene, &self.surface.placement)
        });
        let mut computed_lights = 0;
        let mut indirect = Vec::new();
        let mut sky = Vec::new();
        let mut approximated = Vec::new();
        let mut basis = None;
        if settings.component.needs_basis() {
            self.bake(run)?;
            let baked = self.baked.as_ref().expect("the frame has made its bake");
            basis = BasisView::of(baked.bake.basis(), settings.component)?;
        }
        if settings.needs_direct_at_vertices() || settings.needs_sky(&lights) {
            self.bake(run)?;
            let baked = self.baked.as_ref().expect("the frame has made its bake");
            let (surface, kept) = (&self.surface, &mut self.kept);
            let at_vertices = stages.time("sky", || {
                kept.sky(surface, &baked.bake, run.level, &lights.skies)
            });
            if settings.needs_sky(&lights) {
                sky = at_vertices.to_vec();
            }
        }
        if settings.needs_direct_at_vertices() {
            let (surface, kept) = (&self.surface, &mut self.kept);
            computed_lights = stages.time("direct at vertices", || {
                kept.update(surface, run.level, &lights)
            });
            let (scene, colours) = (&self.scene, &mut self.colours);
            stages.time("colours at vertices", || colours.update(scene, surface));
        }
        if settings.component == Component::ApproximatedDirect {
            approximated = stages.time("projection", || {
                let source = self.reflected_direct(&self.vertex_albedo());
                self.transport(run).projected(&source)
            });
        }
        if settings.needs_bounces() {
            indirect = stages.time("bounces", || self.bounce(settings.bounces, run))?;
        }
        let view = View {
            surface: &self.surface,
            level: run.level,
            camera: settings.camera.place(&self.surface.placement),
            lights: &lights,
            scene: &self.scene,
            light_samples: settings
                .light_samples
                .clamp(1, RenderKeys::MOST_LIGHT_SAMPLES),
            sky: &sky,
            indirect: &indirect,
            approximated: &approximated,
            basis: basis.as_ref(),
            component: settings.component,
        };
        let picture = draw(&view, &mut stages, run.progress).ok_or(RenderError::Cancelled)?;
        Ok(Frame {
            component: settings.component,
            image: picture.image,
            clamped_pixels: picture.clamped_pixels,
            computed_lights,
            stages,
        })
    }

    /// Indirect irradiance at the vertices from the kept direct light.
    fn bounce(&self, bounces: Bounces, run: &RunSettings) -> Result<Vec<Vec3>, BounceError> {
        let albedo = self.vertex_albedo();
        let source = self.reflected_direct(&albedo);
        self.transport(run).solve(&source, &albedo, bounces)
    }

    fn transport(&self, run: &RunSettings) -> Transport<'_> {
        let baked = self.baked.as_ref().expect("the frame has made its bake");
        Transport {
            bake: &baked.bake,
            level: run.level,
        }
    }

    fn vertex_albedo(&self) -> Vec<Vec3> {
        self.colours.albedo(&self.scene, &self.surface)
    }

    /// Radiosity of the vertices by the kept direct light, W/m2.
    fn reflected_direct(&self, albedo: &[Vec3]) -> Vec<Vec3> {
        let direct = self.kept.sum(self.surface.vertices.len());
        direct
            .iter()
            .zip(albedo)
            .map(|(e, rho)| *e * *rho)
            .collect()
    }
}
