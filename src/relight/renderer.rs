//! A scene that is ready to be lit and drawn, again and again.

mod fixed_albedo;
mod frames;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use thiserror::Error;

use super::basis_view::BasisFunctionError;
use super::bounces::BounceError;
use super::colours::{VertexColours, vertex_albedo};
use super::frame::{FrameSettings, GatheredParts};
use super::glossy_light::KeptGlossyLight;
use super::kept::{KeptDirect, KeptLights};
use super::lit_sites::KeptPictures;
use super::outlook::{Outlook, SceneContents};
use super::seen::SeenSurfaces;
use super::stages::Stages;
use crate::bake::{
    self, AlbedoOf, Bake, BakeError, BakeForecast, BakeKey, BakeSettings, BakeStats, CacheOutcome,
    RunSettings, Scheme, Slices, escaped_share_of_fronts, forecast, forecast_of_folding,
    load_or_bake, load_stored,
};
use crate::brdf::GlossyMaterials;
use crate::scene::{Bounces, Light, LightKind, Scene};
use crate::surface::{Detail, Surface};
use fixed_albedo::FixedAlbedo;

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
    /// Vertices of glossy materials.
    pub glossy_vertices: usize,
    /// Coefficients of such a vertex in the mean: 16 slices, near field included.
    pub slice_coefficients_per_vertex: f64,
    /// Bytes of the slices.
    pub slice_bytes: usize,
    /// Bytes of the folded bounces, where the albedo is fixed; else 0.
    pub folded_bytes: usize,
    /// Whether it came from the cache.
    pub cached: bool,
    /// What the bake says of itself.
    pub stats: BakeStats,
}

/// The bake and where it came from.
#[derive(Clone)]
struct Baked {
    bake: Arc<Bake>,
    /// The bake's without folded bounces.
    key: BakeKey,
    cached: bool,
    file_bytes: usize,
    /// What its bounces are folded under, or would be if they had a limit.
    fixed_albedo: Option<FixedAlbedo>,
}

/// The bake of a renderer for another one of the same surface, which takes it from
/// here as it would from the cache folder.
#[derive(Clone)]
pub(crate) struct BakeAtHand(Baked);

impl Baked {
    fn of(baked: bake::Baked, fixed_albedo: Option<FixedAlbedo>) -> Self {
        Self {
            bake: Arc::new(baked.bake),
            key: baked.key,
            cached: baked.outcome == CacheOutcome::Hit,
            file_bytes: baked.file_bytes,
            fixed_albedo,
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
    pictures: KeptPictures,
    colours: VertexColours,
    glossy: GlossyMaterials,
    glossy_light: KeptGlossyLight,
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
        warnings.extend(fixed_albedo::warning(&scene, scheme));
        Self {
            scene,
            surface,
            baked: None,
            scheme,
            cache_folder: cache_folder.map(Path::to_owned),
            placed: KeptLights::default(),
            kept: KeptDirect::default(),
            bounced: None,
            pictures: KeptPictures::default(),
            colours: VertexColours::default(),
            glossy: GlossyMaterials::default(),
            glossy_light: KeptGlossyLight::default(),
            warnings,
            stages,
        }
    }

    /// The scene as it is lit now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Changes lights or materials; the mesh and `[bake]` stay what they are. With
    /// `fixed_albedo`, another albedo needs a bake again: [`Self::needs_bake`].
    /// Materials stay as many as they were, and a map can be given to one only
    /// where the scene was loaded with texture coordinates for it. One name may
    /// stand for two materials, with and without maps. One that had no specular colour
    /// when the renderer was made has no slices: given one, it reflects lamps alone,
    /// unless a gather is asked for ([`FrameSettings::quality`]).
    pub fn relight(
        &mut self,
        change: impl FnOnce(&mut Vec<crate::scene::Light>, &mut Vec<crate::scene::Material>),
    ) {
        change(&mut self.scene.lights, &mut self.scene.materials);
    }

    /// Makes sure that there is a bake: from the cache, or a new one. One whose
    /// fixed albedo is another since [`Self::relight`] is folded anew, and is not
    /// stored.
    pub fn bake(&mut self, run: &RunSettings) -> Result<(), BakeError> {
        if self.baked.is_some() {
            return self.fold_anew(run);
        }
        let fixed_albedo = self.fixed_albedo();
        let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
        let (surface, folder) = (&mut self.surface, self.cache_folder.as_deref());
        let scene = &self.scene;
        let albedo_of = |surface: &Surface| vertex_albedo(scene, surface);
        let albedo: Option<AlbedoOf> = fixed_albedo.as_ref().map(|_| &albedo_of as AlbedoOf);
        let baked = self.stages.time("bake", || {
            load_or_bake(surface, &settings, albedo, folder, run)
        })?;
        self.warnings.extend(baked.warnings.iter().cloned());
        self.baked = Some(Baked::of(baked, fixed_albedo));
        Ok(())
    }

    /// What the scene asks for and what its bake will cost, without baking:
    /// from a bake that exists, whose bounces may be left to fold, or from a few rays
    /// in about half a second. Nothing is written, and no later result changes.
    ///
    /// # Errors
    /// [`BakeError::Cancelled`] when the job was stopped.
    pub fn outlook(&mut self, run: &RunSettings) -> Result<Outlook, BakeError> {
        let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
        if self.baked.is_none() {
            self.load(&settings);
        }
        let folds = self.fixed_albedo().is_some();
        let bake = match &self.baked {
            Some(baked) if self.lacks_folding() => {
                forecast_of_folding(&self.surface, (&baked.bake, baked.file_bytes), run)?
            }
            Some(baked) => BakeForecast::of(&baked.bake, baked.file_bytes),
            None => forecast(&mut self.surface, &settings, folds, run)?,
        };
        let asked = self.scene.bake.max_edge;
        Ok(Outlook {
            contents: SceneContents::of(&self.scene, &self.surface),
            triangles: self.surface.mesh.triangles.len(),
            max_edge: self.surface.max_edge,
            max_edge_asked: asked.filter(|asked| self.surface.max_edge > asked * (1.0 + 1e-6)),
            error_asked: match self.scheme {
                Scheme::Relume => self.scene.bake.error,
                Scheme::Paper => None,
            },
            escaped_share_of_fronts: escaped_share_of_fronts(&self.surface, run.level),
            frame: FrameSettings::of_scene(&self.scene),
            bake,
        })
    }

    /// Takes the bake from the cache, if it is there; where its bounces are to be
    /// folded and are not, one without. One that cannot be used is warned of when it
    /// is made anew, or here where the other takes its place.
    fn load(&mut self, settings: &BakeSettings) {
        let fixed_albedo = self.fixed_albedo();
        let (surface, folder) = (&mut self.surface, self.cache_folder.as_deref());
        let scene = &self.scene;
        let albedo_of = |surface: &Surface| vertex_albedo(scene, surface);
        let mut stored = |albedo| load_stored(surface, settings, albedo, folder);
        let mut damaged = None;
        self.baked = self.stages.time("bake", || {
            let folded = fixed_albedo.and_then(|fixed| {
                let folded = stored(Some(&albedo_of as AlbedoOf));
                let folded = folded.map_err(|warning| damaged = Some(warning));
                Some(Baked::of(folded.ok()??, Some(fixed)))
            });
            folded.or_else(|| Some(Baked::of(stored(None).ok()??, None)))
        });
        if let Some(baked) = &self.baked {
            self.warnings.extend(damaged);
            self.warnings.extend(baked.bake.stats().shortfall());
        }
    }

    /// Takes the bake from the cache folder, if a valid one is there; says whether
    /// the renderer has the bake that it asks for now. (It may have one whose bounces
    /// are to be folded still: [`Self::bake`].)
    pub fn load_bake(&mut self) -> bool {
        if self.baked.is_none() {
            let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
            self.load(&settings);
        }
        self.baked.is_some() && !self.lacks_folding()
    }

    /// The bake, for another renderer.
    pub(crate) fn bake_at_hand(&self) -> Option<BakeAtHand> {
        self.baked.clone().map(BakeAtHand)
    }

    /// Takes the bake of another renderer, if it is that of this surface and there is
    /// none yet.
    pub(crate) fn take_bake(&mut self, at_hand: &BakeAtHand) {
        let settings = BakeSettings::of_scheme(self.scheme, &self.scene.bake);
        if self.baked.is_none() && BakeKey::of(&self.surface, &settings) == at_hand.0.key {
            at_hand.0.bake.add_sides_to(&mut self.surface);
            self.baked = Some(at_hand.0.clone());
        }
    }

    /// What the last frame shows of the mesh; nothing before the first.
    pub fn seen(&self) -> SeenSurfaces {
        let sites = self.pictures.last_sites();
        sites.map_or_else(SeenSurfaces::default, |sites| {
            SeenSurfaces::of(sites, &self.surface)
        })
    }

    /// Whether a frame needs a bake that the renderer does not have yet: none, or
    /// one whose fixed albedo is another now.
    pub fn needs_bake(&self, settings: &FrameSettings) -> bool {
        (self.baked.is_none() && self.reads_bake(settings)) || self.needs_folding(settings)
    }

    /// The first material with a lobe whose final bounce a frame would show if the
    /// bake had slices of it: without a lobe when the scene was made ready, it has
    /// none. A renderer of the scene as it is now has them.
    pub(crate) fn lacks_slices_of(&self, settings: &FrameSettings) -> Option<&str> {
        let asks = settings.component.needs_glossy() && self.reads_bake(settings);
        if !asks || self.baked.is_none() || settings.gathers() {
            return None;
        }
        let pairs = self.scene.materials.iter();
        let mut pairs = pairs.zip(&self.surface.glossy_materials);
        let lacking = pairs.find(|(material, is_known)| material.gloss().is_some() && !**is_known);
        lacking.map(|(material, _)| material.name.as_str())
    }

    /// Whether there is a bake, whatever it lacks.
    pub(crate) fn has_bake(&self) -> bool {
        self.baked.is_some()
    }

    /// Whether a frame depends on the bake.
    pub(super) fn reads_bake(&self, settings: &FrameSettings) -> bool {
        let sees_sky = settings.component.needs_direct() || settings.component.needs_glossy();
        let needs_sky = sees_sky && self.has_sky();
        let needs_basis = settings.component.needs_basis();
        settings.needs_bounces() || needs_sky || needs_basis
    }

    /// Whether a light is a sky.
    pub(super) fn has_sky(&self) -> bool {
        let is_sky = |light: &Light| matches!(light.kind, LightKind::Environment(_));
        self.scene.lights.iter().any(is_sky)
    }

    /// What of a final gather a frame shows.
    pub(super) fn gathered_parts(&self, settings: &FrameSettings) -> GatheredParts {
        let has_lobes = self.scene.materials.iter().any(|it| it.gloss().is_some());
        settings.gathered_parts(self.has_sky(), has_lobes)
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
                glossy_vertices: baked.bake.slices().map_or(0, Slices::vertex_count),
                slice_coefficients_per_vertex: baked
                    .bake
                    .slices()
                    .map_or(0.0, Slices::coefficients_per_vertex),
                slice_bytes: baked.bake.slices().map_or(0, Slices::bytes),
                folded_bytes: baked.bake.folded_bytes(),
                cached: baked.cached,
                stats: *baked.bake.stats(),
            }),
        }
    }

    /// The surface, and the bake once there is one.
    pub(crate) fn transfer(&self) -> (&Surface, Option<&Bake>) {
        (&self.surface, self.baked.as_ref().map(|baked| &*baked.bake))
    }
}

/// The last solution, and what it depends on besides the bake.
struct Bounced {
    /// Number of the sum of direct light.
    of_direct: u64,
    bounces: Bounces,
    albedo: Vec<Vec3>,
    irradiance: Arc<[Vec3]>,
    /// What the last bounce started with, in slots.
    outgoing: Arc<[[f32; 3]]>,
}
