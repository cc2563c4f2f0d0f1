//! The final glossy bounce: what arrives at glossy vertices by direction, as 16
//! spherical-harmonics coefficients (paper, equations 5 and 6).
//!
//!   G_ik = Int L_in(w) h_k(w) (n_i.w)+ dw = sum_j T^k_ij B_j + sum_m X^k_im H_m,
//!   T^k_ij = (1/N) sum over the rays of i that hit j of lambda_j h_k(w)
//!
//! The factor pi of the rays' cosine density and 1/pi of L = B/pi cancel, so
//! T^0 = h_0 T. The rays are those of the vertex's row of T, or the first of them.
//! The harmonics are those of the world's directions, so that coefficients can be
//! interpolated over a triangle.
//!
//! A slice of a vertex is compressed like a row of T: a near field, whose weights
//! have signs here, and the rest C ~ U V over the functions of the basis, with all
//! slices of a partition's vertices in one factorisation; the functions over the
//! cells of the sky are more columns of it. Constant light from everywhere arrives
//! exactly, up to the last digit of U. Vertices whose material is not glossy have no slices.

mod fit;
mod quantise;
mod sampled;

use super::basis::Basis;
use super::rows::Rows;
use super::transfer::GROUP;
use super::{apply_rows, are_scales, sky};
use crate::maths::spherical_harmonics::HARMONICS;
use crate::simd::Level;

pub(super) use fit::{Task, sampled_slices};

/// Groups of eight rows that a vertex has.
const GROUPS_A_VERTEX: usize = HARMONICS / GROUP;

/// Bytes of a glossy vertex, for forecasts.
pub(super) const BYTES_A_VERTEX: usize = 1_000;

/// The compressed slices. Fields are checked against each other when they are
/// made, in memory or from a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Slices {
    /// Slots of the glossy vertices, ascending; row 16 g + k is slice k of the g-th.
    pub(super) receivers: Vec<u32>,
    /// 1 / sigma of the functions of the basis, then of those of the sky.
    pub(super) scales: Vec<f32>,
    /// V: a row a component, those of a partition one after the other.
    pub(super) components: Rows,
    /// The near field: slots in place of functions, since weights have signs.
    pub(super) near: Rows,
    /// U over the components of a receiver's partition.
    pub(super) far: Rows,
}

impl Slices {
    /// Whether the tables fit each other and a basis of so many functions over so
    /// many slots. Says what does not.
    pub(super) fn check(
        &self,
        slot_count: usize,
        function_count: usize,
    ) -> Result<(), &'static str> {
        let functions = function_count + sky::FUNCTIONS as usize;
        let ascends = self.receivers.is_sorted_by(|a, b| a < b);
        let fits = self
            .receivers
            .last()
            .is_none_or(|&s| (s as usize) < slot_count);
        if !ascends || !fits {
            return Err("glossy vertices that do not exist");
        }
        if !are_scales(&self.scales, functions) {
            return Err("scales of slices that do not fit the functions");
        }
        let rows = self.receivers.len() * HARMONICS;
        self.components.check(self.far.function_count)?;
        self.near.check(rows)?;
        self.far.check(rows)
    }

    /// G in the order of `receivers`: 16 coefficients a vertex, W/m2, from the
    /// radiosity of all slots, W/m2, and H_m of the sky's cells, W/m2 (empty without
    /// a sky).
    pub(super) fn apply(
        &self,
        level: Level,
        basis: &Basis,
        radiosity: &[[f32; 3]],
        cells: &[[f32; 3]],
    ) -> Vec<[[f32; 3]; HARMONICS]> {
        let mut light = basis.project_rgb(level, radiosity);
        if cells.is_empty() {
            light.resize(self.scales.len(), [0.0; 3]);
        } else {
            light.extend(sky::basis().project_rgb(level, cells));
        }
        for (light, scale) in light.iter_mut().zip(&self.scales) {
            *light = light.map(|b| b * scale);
        }
        let arriving = apply_rows(level, &self.components, &[], &light);
        let near = apply_rows(level, &self.near, &[], radiosity);
        let far = apply_rows(level, &self.far, &[], &arriving);
        let (near, _) = near.as_chunks::<HARMONICS>();
        let (far, _) = far.as_chunks::<HARMONICS>();
        let sums = near.iter().zip(far).map(|(near, far)| {
            std::array::from_fn(|k| std::array::from_fn(|c| near[k][c] + far[k][c]))
        });
        sums.collect()
    }

    /// Bytes of all tables.
    pub(crate) fn bytes(&self) -> usize {
        (self.receivers.len() + self.scales.len()) * 4
            + self.components.bytes()
            + self.near.bytes()
            + self.far.bytes()
    }

    /// Glossy vertices.
    pub(crate) fn vertex_count(&self) -> usize {
        self.receivers.len()
    }

    /// Coefficients of a glossy vertex in the mean, all slices and the near field
    /// included.
    pub(crate) fn coefficients_per_vertex(&self) -> f64 {
        let of_row = self.near.coefficients_per_vertex() + self.far.coefficients_per_vertex();
        of_row * HARMONICS as f64
    }
}

#[cfg(test)]
mod tests;
