//! The tile rasterizer: which triangle a pixel, or a sample in it, sees.
//!
//! Comes in: a [`PlacedCamera`] and a [`RasterMesh`]. Goes out: one
//! [`Fragment`] a pixel centre ([`rasterize`]), the pixels in which something
//! changes ([`edge_pixels`]), 16 fragments for each of those
//! ([`rasterize_samples`]), and the surfaces among the 16 ([`surface_groups`]).
//!
//! Method: Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
//! Coordinates" (Graphics Hardware 1997), in double precision. A sample lies
//! in a triangle if three edge functions are positive; they need no division
//! and no clipping, even for triangles that reach behind the camera.
//!
//! ```text
//! positions ─ screen: homogeneous corners ─ bins: triangles a tile ─┬─ centers
//!                     triangle: edge functions, plane of 1/depth    ├─ samples
//!                                                                   └─ edges, groups
//! ```
//!
//! The result depends on nothing but the input: tiles run in parallel, but in
//! each the triangles come in the order of their index, and of equal depths
//! the lowest index wins.

mod bins;
mod centers;
mod edges;
mod groups;
mod samples;
mod screen;
#[cfg(test)]
mod tests;
mod triangle;

use glam::Vec3;

pub(crate) use crate::surface::{MeshEdge, NONE};

pub(crate) use centers::{CenterBuffer, rasterize};
pub(crate) use edges::edge_pixels;
pub(crate) use groups::{SurfaceGroup, surface_groups};
pub(crate) use samples::{SampleBuffer, rasterize_samples};

/// Depth along the view axis, placed units, below which nothing is seen.
///
/// The scene's longest side is 0.5 to 1 placed units and positions are floats,
/// so near the walls they are 3e-8 to 6e-8 apart. At 1e-5 that is below one
/// per cent of the distance, the picture is still a picture; a hundredth
/// of that would show the rounding. Upwards: a camera 1e-4 from a wall (a
/// millimetre in a room of ten metres) must still see it.
pub(crate) const NEAR: f64 = 1e-5;

/// The triangles that a picture shows, placed units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RasterMesh<'a> {
    /// Corner positions; equal positions may appear more than once.
    pub(crate) positions: &'a [Vec3],
    /// Indices into `positions`, counter-clockwise seen from the front.
    pub(crate) triangles: &'a [[u32; 3]],
    /// The smooth patch that a triangle belongs to, one a triangle.
    pub(crate) patches: &'a [u32],
    /// Every edge of the mesh, once.
    pub(crate) edges: &'a [MeshEdge],
}

/// What one sample sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fragment {
    /// Index of the triangle, or [`NONE`].
    pub(crate) triangle: u32,
    /// Weights of the triangle's corners, perspective-correct: none is
    /// negative and the sum is 1 (0, 0, 0 where nothing is seen).
    pub(crate) barycentrics: [f32; 3],
    /// Distance along the view axis, placed units; infinite where nothing is
    /// seen.
    pub(crate) depth: f32,
    /// Whether the camera sees the counter-clockwise side.
    pub(crate) front: bool,
}

impl Fragment {
    /// A sample that sees nothing.
    pub(crate) const EMPTY: Self = Self {
        triangle: NONE,
        barycentrics: [0.0; 3],
        depth: f32::INFINITY,
        front: false,
    };

    /// Whether the sample sees a triangle.
    pub(crate) fn is_covered(&self) -> bool {
        self.triangle != NONE
    }
}

/// Identity of the smooth surface that a fragment lies on: its patch and the
/// side that is seen; `None` where nothing is.
fn surface_of(fragment: &Fragment, mesh: &RasterMesh) -> Option<(u32, bool)> {
    let patch = mesh.patches.get(fragment.triangle as usize)?;
    Some((*patch, fragment.front))
}
