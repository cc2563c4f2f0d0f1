//! Frames of a scene that is ready.

use std::sync::Arc;

use glam::Vec3;

use super::{Bounced, RenderError, Renderer};
use crate::bake::RunSettings;
use crate::relight::basis_view::BasisView;
use crate::relight::bounces::{BounceError, Transport};
use crate::relight::component::Component;
use crate::relight::frame::{Frame, FrameSettings};
use crate::relight::gather::{GatherLight, LitVertices};
use crate::relight::glossy_light::GlossyLight;
use crate::relight::kept::OnVertices;
use crate::relight::shade::{View, draw};
use crate::relight::stages::Stages;
use crate::scene::{Bounces, Material, PlacedLights, RenderKeys};

impl Renderer {
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
    /// is left out, bounced light and the sky's; bounces that are folded under
    /// another albedo are carried out one by one.
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
        let materials = self.scene.materials.iter();
        self.glossy.update(materials.map(Material::gloss));
        let at_vertices = self.light_at_vertices(settings, &lights, run, &mut stages)?;
        let view = View {
            surface: &self.surface,
            level: run.level,
            camera: settings.camera.place(&self.surface.placement),
            lights: &lights,
            scene: &self.scene,
            glossy: &self.glossy,
            light_samples: settings
                .light_samples
                .clamp(1, RenderKeys::MOST_LIGHT_SAMPLES),
            sky: &at_vertices.sky,
            indirect: &at_vertices.indirect,
            glossy_light: at_vertices.glossy.as_deref(),
            gather: at_vertices.gather.as_ref(),
            approximated: &at_vertices.approximated,
            basis: at_vertices.basis.as_ref(),
            component: settings.component,
            effort: settings.effort,
        };
        let kept = self.pictures.of(&view);
        let picture = draw(&view, kept, &mut stages, run.progress).ok_or(RenderError::Cancelled)?;
        Ok(Frame {
            component: settings.component,
            image: picture.image,
            clamped_pixels: picture.clamped_pixels,
            computed_lights: at_vertices.computed_lights,
            gathered_rays: picture.gathered_rays,
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
        if settings.gathers() {
            let parts = self.gathered_parts(settings);
            if !parts.any() {
                return Ok(found);
            }
            let at_vertices = settings
                .needs_bounces()
                .then(|| stages.time("bounces", || self.lit_vertices(settings.bounces, run)));
            let at_vertices = at_vertices.transpose()?;
            found.gather = Some(GatherLight { parts, at_vertices });
            return Ok(found);
        }
        let mut outgoing = None;
        if settings.needs_bounces() {
            let bounced = stages.time("bounces", || self.bounce(settings.bounces, run))?;
            found.indirect = Arc::clone(&bounced.irradiance);
            outgoing = Some(Arc::clone(&bounced.outgoing));
        }
        let is_shown = settings.component.needs_glossy() && self.glossy.any();
        let arrives = outgoing.is_some() || !lights.skies.is_empty();
        if is_shown
            && arrives
            && let Some(baked) = &self.baked
            && baked.bake.slices().is_some()
        {
            let kept = &mut self.glossy_light;
            found.glossy = Some(stages.time("glossy light", || {
                kept.of(&baked.bake, run.level, outgoing, &lights.skies)
            }));
        }
        Ok(found)
    }

    /// What the rays of a final gather read of the vertices; they are the last
    /// bounce themselves.
    fn lit_vertices(
        &mut self,
        bounces: Bounces,
        run: &RunSettings,
    ) -> Result<LitVertices, BounceError> {
        let before = match bounces {
            Bounces::Count(count) => Bounces::Count(count.saturating_sub(1)),
            Bounces::All => Bounces::All,
        };
        let bounced = Arc::clone(&self.bounce(before, run)?.irradiance);
        let surface = &self.surface;
        let (direct, sky) = self.kept.sum_and_sky(surface.vertices.len());
        Ok(LitVertices::new(surface, direct, sky, &bounced))
    }

    /// Bounced light at the vertices from the kept direct light; that of the last
    /// frame if nothing that it depends on has changed.
    fn bounce(&mut self, bounces: Bounces, run: &RunSettings) -> Result<&Bounced, BounceError> {
        let albedo = self.vertex_albedo();
        let (source, version) = self.reflected_direct(&albedo);
        let is_kept = self.bounced.as_ref().is_some_and(|last| {
            last.of_direct == version && last.bounces == bounces && last.albedo == albedo
        });
        if !is_kept {
            let transport = self.transport(run);
            let folded = match bounces {
                Bounces::All if self.is_folded() => transport.solve_folded(&source, &albedo),
                _ => None,
            };
            let solved = match folded {
                Some(solved) => solved,
                None => transport.solve(&source, &albedo, bounces)?,
            };
            self.bounced = Some(Bounced {
                of_direct: version,
                bounces,
                albedo,
                irradiance: solved.irradiance.into(),
                outgoing: solved.outgoing.into(),
            });
        }
        Ok(self.bounced.as_ref().expect("it was made above"))
    }

    fn transport(&self, run: &RunSettings) -> Transport<'_> {
        let baked = self.baked.as_ref().expect("the frame has made its bake");
        Transport {
            bake: &baked.bake,
            level: run.level,
        }
    }

    fn vertex_albedo(&self) -> Vec<Vec3> {
        self.colours
            .albedo(&self.scene, &self.glossy, &self.surface)
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
    glossy: Option<Arc<GlossyLight>>,
    approximated: Vec<Vec3>,
    /// What a final gather reads, where one is made.
    gather: Option<GatherLight>,
    basis: Option<BasisView>,
    computed_lights: usize,
}
