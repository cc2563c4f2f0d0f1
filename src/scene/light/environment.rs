//! Environment: light from infinitely far away. Parsed and checked; not
//! rendered yet.

use std::path::PathBuf;

use glam::Vec3;

/// `kind = "environment"`.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Where the radiance comes from.
    pub radiance: Radiance,
    /// Factor on a map's values.
    pub scale: f32,
    /// Rotation about up, degrees.
    pub rotation_deg: f32,
}

/// Radiance of an environment.
#[derive(Debug, Clone, PartialEq)]
pub enum Radiance {
    /// The same in every direction, W/(m2 sr).
    Constant(Vec3),
    /// A latitude-longitude image, resolved against the scene file's folder.
    Map(PathBuf),
}
