//! Area light: a black rectangle that emits on one side. Parsed and checked;
//! not rendered yet.

use glam::{DVec3, Vec3};

use crate::scene::SceneError;
use crate::scene::file::fields::{Fields, unit};

/// Keys besides `name` and `kind`.
pub(super) const KEYS: &[&str] = &["corner", "edge_u", "edge_v", "radiance"];

/// `kind = "area"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// File units.
    pub corner: DVec3,
    /// Edge from the corner, file units.
    pub edge_u: DVec3,
    /// Other edge from the corner; it emits on the side of `edge_u` x `edge_v`.
    pub edge_v: DVec3,
    /// W/(m2 sr).
    pub radiance: Vec3,
}

impl Area {
    pub(super) fn read(fields: &mut Fields) -> Result<Self, SceneError> {
        let corner = fields.require("corner", "[x, y, z]")?.vector()?;
        let edge_u = fields
            .require("edge_u", "an edge from the corner")?
            .vector()?;
        let edge_v_item = fields.require("edge_v", "the other edge from the corner")?;
        let edge_v = edge_v_item.vector()?;
        let radiance = fields.require("radiance", "[r, g, b], W/(m2 sr)")?;
        let parallel = match (unit(edge_u), unit(edge_v)) {
            (Some(u), Some(v)) => u.cross(v) == DVec3::ZERO,
            _ => true,
        };
        if parallel {
            return Err(edge_v_item.error("an edge that spans an area together with `edge_u`"));
        }
        Ok(Self {
            corner,
            edge_u,
            edge_v,
            radiance: radiance.light()?,
        })
    }
}
