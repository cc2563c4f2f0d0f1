//! What a picture's file says of how it was made.

use glam::DVec3;

use super::gather::RAYS;
use super::{Component, FrameSettings, Renderer};
use crate::frame::Metadata;
use crate::scene::{Bounces, Camera, Scene, SceneDigests, Tone};

/// The program, and the scene as a camera sees it: digests of what the scene
/// resolves to, without any path.
pub fn describe_scene(scene: &Scene, camera: &Camera) -> Metadata {
    let digests = SceneDigests::of(scene);
    let mut metadata = Metadata::of_program();
    metadata.set_own("scene", digests.scene);
    metadata.set_own("scene.geometry", digests.geometry);
    metadata.set_own("scene.materials", digests.materials);
    metadata.set_own("scene.lights", digests.lights);
    metadata.set_own("camera", camera_text(camera));
    metadata.set_own("size", format!("{}x{}", camera.size[0], camera.size[1]));
    metadata
}

/// Metadata of linear values with what makes levels of them: exposure and tone
/// curve, where the component is light.
pub fn describe_levels(
    linear: &Metadata,
    component: Component,
    exposure: f32,
    tone: Tone,
) -> Metadata {
    let mut metadata = linear.clone();
    if component.is_light() {
        let tone = match tone {
            Tone::Srgb => "srgb",
            Tone::Filmic => "filmic",
        };
        metadata.set_own("exposure", exposure.to_string());
        metadata.set_own("tone", tone);
    }
    metadata
}

/// Bounces as the command line has them.
pub fn bounces_text(bounces: Bounces) -> String {
    match bounces {
        Bounces::All => "all".to_owned(),
        Bounces::Count(count) => count.to_string(),
    }
}

impl Renderer {
    /// What determines the values of a frame that was drawn with these settings:
    /// scene, camera, what is shown, and the bake where the frame read one.
    /// Neither threads nor instructions nor the state of the cache are in it.
    pub fn describe(&self, settings: &FrameSettings) -> Metadata {
        let mut metadata = describe_scene(self.scene(), &settings.camera);
        metadata.set_own("component", settings.component.to_string());
        let component = settings.component;
        if component.needs_indirect() || component.needs_glossy() {
            metadata.set_own("bounces", bounces_text(settings.bounces));
        }
        if settings.component.needs_direct() {
            metadata.set_own("light_samples", settings.light_samples.to_string());
        }
        if self.gathered_parts(settings).any() {
            metadata.set_own("quality", settings.quality.name());
            metadata.set_own("gather.rays", RAYS.to_string());
        }
        let figures = self.figures();
        if let Some(bake) = figures.bake.filter(|_| self.reads_bake(settings)) {
            let stats = &bake.stats;
            for (name, value) in [
                ("bake.scheme", stats.scheme.name().to_owned()),
                ("bake.partitioner", stats.partitioner.name().to_owned()),
                ("bake.max_edge", figures.max_edge.to_string()),
                ("bake.vertices", figures.vertices.to_string()),
                ("bake.rays", stats.rays.to_string()),
                ("bake.functions", bake.functions.to_string()),
                (
                    "bake.coefficients",
                    format!("{:.2}", bake.coefficients_per_vertex),
                ),
            ] {
                metadata.set_own(name, value);
            }
        }
        metadata
    }
}

fn camera_text(camera: &Camera) -> String {
    let vector = |v: DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    format!(
        "position {} target {} up {} vfov {}",
        vector(camera.position),
        vector(camera.target),
        vector(camera.up),
        camera.vfov_deg
    )
}
