//! Bounces that are folded under a fixed albedo: whether they still are.

use std::sync::Arc;

use glam::Vec3;

use super::Renderer;
use crate::bake::{BakeError, RunSettings, Scheme, store_folded};
use crate::brdf::Gloss;
use crate::relight::colours::vertex_albedo;
use crate::relight::frame::FrameSettings;
use crate::scene::{Bounces, Scene};
use crate::texture::TextureMap;

/// What the materials hand on of light: Kd, map and lobe of each.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FixedAlbedo(Vec<(Vec3, Option<TextureMap>, Option<Gloss>)>);

/// What the user should know of a fixed albedo.
pub(super) fn warning(scene: &Scene, scheme: Scheme) -> Option<String> {
    (scene.bake.fixed_albedo && scheme == Scheme::Paper).then(|| {
        "[bake] fixed_albedo changes nothing: the published scheme folds no bounces".to_owned()
    })
}

impl Renderer {
    /// The albedo to fold bounces under, if it is fixed.
    pub(super) fn fixed_albedo(&self) -> Option<FixedAlbedo> {
        let is_fixed = self.scene.bake.fixed_albedo && self.scheme == Scheme::Relume;
        let materials = self.scene.materials.iter();
        let albedo = materials.map(|it| (it.albedo, it.albedo_map.clone(), it.gloss()));
        is_fixed.then(|| FixedAlbedo(albedo.collect()))
    }

    /// Whether the bake's bounces are folded under the albedo as it is now.
    pub(super) fn is_folded(&self) -> bool {
        let fixed = self.baked.as_ref().and_then(|it| it.fixed_albedo.as_ref());
        fixed.is_some() && fixed == self.fixed_albedo().as_ref()
    }

    /// Whether a frame of all bounces finds them folded under another albedo than
    /// it is now, so that it needs a bake. ([`Self::frame_so_far`] goes on with
    /// bounces one by one, which is as right and slower.)
    pub fn needs_folding(&self, settings: &FrameSettings) -> bool {
        let asks = settings.bounces == Bounces::All && settings.needs_bounces();
        asks && self.lacks_folding()
    }

    /// Whether the bounces of the bake are to be folded, and are not under the albedo
    /// as it is now.
    pub(super) fn lacks_folding(&self) -> bool {
        let is_fixed = self.scene.bake.fixed_albedo && self.scheme == Scheme::Relume;
        is_fixed && self.baked.is_some() && !self.is_folded()
    }

    /// Folds the bounces of the bake under the albedo as it is now. A bake from the
    /// cache folder that has none folded yet goes there again with them; what is edited
    /// after that does not.
    pub(super) fn fold_anew(&mut self, run: &RunSettings) -> Result<(), BakeError> {
        if !self.lacks_folding() {
            return Ok(());
        }
        let fixed_albedo = self.fixed_albedo();
        let Some(baked) = self.baked.as_mut() else {
            return Ok(());
        };
        let (scene, surface) = (&self.scene, &self.surface);
        let folder = self.cache_folder.as_deref();
        let warning = self.stages.time("bake", || {
            let albedo = vertex_albedo(scene, surface);
            let bake = Arc::make_mut(&mut baked.bake);
            bake.fold(surface, &albedo, run)?;
            if baked.fixed_albedo.is_some() {
                return Ok(None);
            }
            baked.cached = false;
            let fronts = &albedo[..surface.vertices.front_count()];
            let (bytes, warning) = store_folded(bake, &baked.key, fronts, folder);
            baked.file_bytes = bytes;
            Ok(warning)
        })?;
        self.warnings.extend(warning);
        baked.fixed_albedo = fixed_albedo;
        self.bounced = None;
        Ok(())
    }
}
