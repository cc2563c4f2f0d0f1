//! What is asked of a frame, and a frame.

use glam::Vec3;

use super::component::Component;
use super::quality::Quality;
use super::stages::Stages;
use crate::frame::{Development, EncodedImage, Image};
use crate::maths::order::Order;
use crate::scene::{Bounces, Camera, PlacedLights, Scene, Tone};

/// How much work goes into a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Effort {
    /// All that makes a frame exact.
    #[default]
    Full,
    /// For a picture that is about to change: one point a pixel (edges have
    /// steps), one point a vertex and few shadow rays to lights that are no
    /// points. Bounces are whole.
    Draft,
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
    /// How exactly.
    pub effort: Effort,
    /// Where indirect light and the sky's come from.
    pub quality: Quality,
}

impl FrameSettings {
    /// What the scene file asks for.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            camera: scene.camera,
            bounces: scene.render.bounces,
            light_samples: scene.render.light_samples,
            component: Component::Global,
            effort: Effort::Full,
            quality: Quality::Standard,
        }
    }

    pub(super) fn needs_bounces(&self) -> bool {
        let needed = self.component.needs_indirect() || self.component.needs_glossy();
        needed && self.bounces != Bounces::Count(0)
    }

    pub(super) fn needs_direct_at_vertices(&self) -> bool {
        self.needs_bounces() || self.component == Component::ApproximatedDirect
    }

    /// Whether a final gather is made.
    pub(super) fn gathers(&self) -> bool {
        self.quality == Quality::Gather && self.effort == Effort::Full
    }

    /// The sky's direct light comes from the bake too.
    pub(super) fn needs_sky(&self, lights: &PlacedLights) -> bool {
        self.component.needs_direct() && !lights.skies.is_empty()
    }

    /// What of a final gather is shown, with or without a sky and materials that have
    /// a lobe; nothing of one that is not made.
    pub(super) fn gathered_parts(&self, has_sky: bool, has_lobes: bool) -> GatheredParts {
        if !self.gathers() {
            return GatheredParts::default();
        }
        let (component, bounces) = (self.component, self.needs_bounces());
        let by_lobes = has_lobes && component.needs_glossy() && (bounces || has_sky);
        GatheredParts {
            irradiance: (component.needs_indirect() && bounces)
                || (component.needs_direct() && has_sky),
            by_lobes,
            sky: has_sky && (component.needs_direct() || by_lobes),
        }
    }
}

/// What of a final gather a frame shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct GatheredParts {
    /// Irradiance of bounced light or the sky.
    pub(super) irradiance: bool,
    /// What lobes reflect of the same.
    pub(super) by_lobes: bool,
    /// Whether rays that escape bring the sky's light.
    pub(super) sky: bool,
}

impl GatheredParts {
    /// Whether there is anything to gather.
    pub(super) fn any(self) -> bool {
        self.irradiance || self.by_lobes
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
    /// Rays that pixels sent in a final gather, those to lamps not counted.
    pub gathered_rays: u64,
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
