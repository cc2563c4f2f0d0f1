//! Settings that change a bake's bits.

use crate::scene::BakeKeys;

/// Rays a vertex: leaves 2.8 % of sampling noise (decision 3 of the design).
const RAYS: u32 = 1024;
/// Basis functions for 1,000 vertices.
const FUNCTIONS_PER_1000: f64 = 32.0;
/// Coefficients a vertex, near field included.
const COEFFICIENTS: u32 = 128;
/// Vertices a partition: 48 to 64 partitions at 35,000 vertices (decision 8).
const VERTICES_PER_PART: u32 = 600;

/// Settings of a bake, resolved against their defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BakeSettings {
    /// Rays a lighting vertex.
    pub rays: u32,
    /// Basis functions in all; `None`: 32 for 1,000 vertices.
    pub functions: Option<u32>,
    /// Coefficients a vertex in the mean, near field included.
    pub coefficients: u32,
    /// Vertices a partition.
    pub vertices_per_part: u32,
}

impl BakeSettings {
    /// The settings that `[bake]` asks for.
    pub fn of_keys(keys: &BakeKeys) -> Self {
        Self {
            rays: keys.rays.unwrap_or(RAYS),
            functions: keys.functions,
            coefficients: keys.coefficients.unwrap_or(COEFFICIENTS),
            vertices_per_part: VERTICES_PER_PART,
        }
    }

    /// Basis functions for so many vertices.
    pub(super) fn function_count(&self, vertices: usize) -> u32 {
        self.functions
            .unwrap_or_else(|| (vertices as f64 * FUNCTIONS_PER_1000 / 1000.0).ceil() as u32)
    }
}
