//! From a baked surface, lights, albedos and a camera to a frame.
//!
//! Comes in: [`crate::surface::Surface`], [`crate::bake::Bake`] and what the
//! scene says at run time. Goes out: a linear picture. Reads no file.
//!
//! direct light at vertices -> bounces -> indirect irradiance a vertex
//! camera -> rasterizer -> direct light a pixel -> shade
//!
//! Between the two, where a still picture is wanted: a final gather a pixel.

mod basis_view;
mod bounces;
#[cfg(test)]
mod closed_forms;
mod colours;
mod component;
mod description;
mod frame;
mod gather;
mod geometry;
mod glossy_light;
mod kept;
mod lit_sites;
mod outlook;
mod paint;
mod palette;
mod quality;
mod raster;
mod reach;
mod renderer;
mod seen;
mod shade;
mod sites;
mod stages;
mod sum;

pub use basis_view::BasisFunctionError;
pub use bounces::BounceError;
pub(crate) use bounces::Transport;
pub(crate) use colours::vertex_albedo;
pub use component::{BasisFunction, COMPONENTS, Component, ComponentError};
pub use description::{bounces_text, describe_levels, describe_scene};
pub use frame::{Effort, Frame, FrameSettings, develop};
pub use outlook::{ImageCounts, LightCounts, Outlook, SceneContents, SkyView};
pub use quality::{Quality, QualityError};
pub(crate) use renderer::BakeAtHand;
pub use renderer::{BakeFigures, RenderError, Renderer, SceneFigures};
pub use seen::SeenSurfaces;
pub use stages::Stages;
