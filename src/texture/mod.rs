//! Image maps: decoded once, filtered, looked up.
//!
//! Comes in: the bytes of an image file. Goes out: [`Texture`], a colour map of
//! a material, and [`EnvironmentMap`], the radiance of the sky. Linear Rec.709
//! everywhere. The only room that decodes images for scenes.

mod environment;
mod error;
mod exr_file;
mod grid;
mod image_file;
mod jpeg;
mod map;
mod parts;
mod pyramid;
mod slabs;

pub use environment::EnvironmentMap;
pub use error::TextureError;
pub use map::{Texture, TextureFilter, TextureMap};
