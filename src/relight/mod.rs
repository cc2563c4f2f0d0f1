//! From a baked surface, lights, albedos and a camera to a frame.
//!
//! Comes in: [`crate::surface::Surface`], [`crate::bake::Bake`] and what the
//! scene says at run time. Goes out: a linear picture. Reads no file.
//!
//! direct light at vertices -> bounces -> indirect irradiance a vertex
//! camera -> rasterizer -> direct light a pixel -> shade

mod basis_view;
mod bounces;
#[cfg(test)]
mod closed_forms;
mod colours;
mod component;
mod description;
mod geometry;
mod kept;
mod outlook;
mod paint;
mod palette;
mod raster;
mod reach;
mod renderer;
mod shade;
mod stages;

pub use basis_view::BasisFunctionError;
pub use bounces::BounceError;
pub(crate) use bounces::Transport;
pub(crate) use colours::VertexColours;
pub use component::{BasisFunction, COMPONENTS, Component, ComponentError};
pub use description::{bounces_text, describe_levels, describe_scene};
pub use outlook::{ImageCounts, LightCounts, Outlook, SceneContents, SkyView};
pub use renderer::{
    BakeFigures, Frame, FrameSettings, RenderError, Renderer, SceneFigures, develop,
};
pub use stages::Stages;
