//! Area light: a black rectangle that emits on one side. Parsed and checked;
//! not rendered yet.

use glam::{DVec3, Vec3};

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
