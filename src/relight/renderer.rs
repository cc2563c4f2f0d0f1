//! A scene that is ready to be lit and drawn, again and again.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use thiserror::Error;

use super::basis_view::{BasisFunctionError, BasisView};
use super::bounces::{BounceError, Transport};
use super::colours::VertexColours;
use super::component::Component;
use super::frame::{Effort, Frame, FrameSettings};
use super::kept::{KeptDirect, KeptLights, OnVertices};
use super::lit_sites::KeptPicture;
use super::outlook::{Outlook, SceneContents};
use super::seen::SeenSurfaces;
use super::shade::{View, draw};
use super::stages::Stages;
use crate::bake::{
    self, Bake, BakeError, BakeForecast, BakeSettings, BakeStats, CacheOutcome, RunSettings,
    Scheme, escaped_share_of_fronts, forecast, load_or_bake, load_stored,
};
use crate::scene::{Bounces, Light, LightKind, PlacedLights, RenderKeys, Scene};
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
    bounced: Option<Bounced>,
    /// Drafts and full frames, which follow one another while lights are moved.
    pictures: [KeptPicture; 2],
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
            bounced: None,
            pictures: Default::default(),
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

    /// Takes the bake from the cache folder, if a valid one is there; says whether
    /// the renderer has a bake now.
    pub fn load_bake(&mut self) -> bool {
        if self.baked.is_none() {
            let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
            self.load(&settings);
        }
        self.baked.is_some()
    }

    /// What the last frame of such an effort shows of the mesh; nothing before the
    /// first.
    pub fn seen(&self, effort: Effort) -> SeenSurfaces {
        let sites = self.pictures[effort as usize].sites();
        sites.map_or_else(SeenSurfaces::default, |sites| {
            SeenSurfaces::of(sites, &self.surface)
        })
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
    ///
    /// # Errors
    /// A bake that failed or was stopped, a function of the basis that is none,
    /// bounces without a limit, a frame that was stopped.
    pub fn frame(
        &mut self,
        settings: &FrameSettings,
        run: &RunSettings,
    ) -> Result<Frame, RenderError> {
        if self.needs_bake(settings) {
            self.bake(run)?;
        }
        self.frame_so_far(settings, run)
    }

    /// The same with what there is: without a bake, the light that it would bring
    /// is left out, bounced light and the sky's.
    ///
    /// # Errors
    /// As [`Self::frame`], but for those of a bake.
    pub fn frame_so_far(
        &mut self,
        settings: &FrameSettings,
        run: &RunSettings,
    ) -> Result<Frame, RenderError> {
        let mut stages = Stages::default();
        let lights = stages.time("lights", || {
            self.placed.update(&self.scene, &self.surface.placement)
        });
        let at_vertices = self.light_at_vertices(settings, &lights, run, &mut stages)?;
        let view = View {
            surface: &self.surface,
            level: run.level,
            camera: settings.camera.place(&self.surface.placement),
            lights: &lights,
            scene: &self.scene,
            light_samples: settings
                .light_samples
                .clamp(1, RenderKeys::MOST_LIGHT_SAMPLES),
            sky: &at_vertices.sky,
            indirect: &at_vertices.indirect,
            approximated: &at_vertices.approximated,
            basis: at_vertices.basis.as_ref(),
            component: settings.component,
            effort: settings.effort,
        };
        let kept = &mut self.pictures[settings.effort as usize];
        let picture = draw(&view, kept, &mut stages, run.progress).ok_or(RenderError::Cancelled)?;
        Ok(Frame {
            component: settings.component,
            image: picture.image,
            clamped_pixels: picture.clamped_pixels,
            computed_lights: at_vertices.computed_lights,
            stages,
        })
    }

    /// What a frame needs of the vertices and the bake, as far as there is one.
    fn light_at_vertices(
        &mut self,
        settings: &FrameSettings,
        lights: &PlacedLights,
        run: &RunSettings,
        stages: &mut Stages,
    ) -> Result<AtVertices, RenderError> {
        let mut found = AtVertices::default();
        let Some(baked) = &self.baked else {
            return Ok(found);
        };
        if settings.component.needs_basis() {
            found.basis = BasisView::of(baked.bake.basis(), settings.component)?;
        }
        if settings.needs_direct_at_vertices() || settings.needs_sky(lights) {
            let (surface, kept) = (&self.surface, &mut self.kept);
            let sky = stages.time("sky", || {
                kept.sky(surface, &baked.bake, run.level, &lights.skies)
            });
            if settings.needs_sky(lights) {
                found.sky = sky.to_vec();
            }
        }
        if settings.needs_direct_at_vertices() {
            let job = OnVertices {
                surface: &self.surface,
                level: run.level,
                effort: settings.effort,
                progress: run.progress,
            };
            let kept = &mut self.kept;
            let computed = stages.time("direct at vertices", || kept.update(&job, lights));
            found.computed_lights = computed.ok_or(RenderError::Cancelled)?;
            let (scene, surface, colours) = (&self.scene, &self.surface, &mut self.colours);
            stages.time("colours at vertices", || colours.update(scene, surface));
        }
        if settings.component == Component::ApproximatedDirect {
            found.approximated = stages.time("projection", || {
                let (source, _) = self.reflected_direct(&self.vertex_albedo());
                self.transport(run).projected(&source)
            });
        }
        if settings.needs_bounces() {
            found.indirect = stages.time("bounces", || self.bounce(settings.bounces, run))?;
        }
        Ok(found)
    }

    /// Indirect irradiance at the vertices from the kept direct light; that of the
    /// last frame if nothing that it depends on has changed.
    fn bounce(&mut self, bounces: Bounces, run: &RunSettings) -> Result<Arc<[Vec3]>, BounceError> {
        let albedo = self.vertex_albedo();
        let (source, version) = self.reflected_direct(&albedo);
        if let Some(last) = &self.bounced
            && last.of_direct == version
            && last.bounces == bounces
            && last.albedo == albedo
        {
            return Ok(last.irradiance.clone());
        }
        let irradiance: Arc<[Vec3]> = self.transport(run).solve(&source, &albedo, bounces)?.into();
        self.bounced = Some(Bounced {
            of_direct: version,
            bounces,
            albedo,
            irradiance: irradiance.clone(),
        });
        Ok(irradiance)
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

    /// Radiosity of the vertices by the kept direct light, W/m2, and the number of
    /// that direct light.
    fn reflected_direct(&mut self, albedo: &[Vec3]) -> (Vec<Vec3>, u64) {
        let (direct, version) = self.kept.sum(self.surface.vertices.len());
        let pairs = direct.iter().zip(albedo);
        (pairs.map(|(e, rho)| *e * *rho).collect(), version)
    }
}

/// What a frame reads at the vertices; what it does not need is empty.
#[derive(Default)]
struct AtVertices {
    sky: Vec<Vec3>,
    indirect: Arc<[Vec3]>,
    approximated: Vec<Vec3>,
    basis: Option<BasisView>,
    computed_lights: usize,
}

/// The last solution, and what it depends on besides the bake.
struct Bounced {
    /// Number of the sum of direct light.
    of_direct: u64,
    bounces: Bounces,
    albedo: Vec<Vec3>,
    irradiance: Arc<[Vec3]>,
}
