//! relume's own scheme: a near field, and a low-rank product for the rest.
//!
//!   E_i = sum_near w_ij B_j + sum_r u_ir y_r,   y_r = sum_k v_rk b_k,   b = S^T B
//!
//! What a vertex receives from afar hardly differs from what its neighbours
//! receive: the rows of one partition's remainder span few dimensions. Its rows
//! C (vertices x functions) are factored, C ~ U V, with the components chosen by
//! what prior lights make of them (the design's low rank of the remainder over
//! receivers). A frame computes y once a partition, and then a short dense
//! product a vertex. U is averaged over neighbouring receivers where what changes
//! between them is noise of the rays (`smooth`), and components that are only
//! noise are left out with the small ones: the product is nearer to the true
//! transfer than the sampled rows that it was made of.

mod factor;
mod folded;
mod join;
mod near;
mod part;
mod quantise;
mod sampled;
mod smooth;

pub(super) use factor::{Factors, Matrix, last_energy, leading};
pub(crate) use folded::Folded;
pub(super) use folded::{FoldTask, folding_bytes, solutions_to_fold};
pub(super) use part::Budget;
#[cfg(test)]
pub(super) use part::{NEAR_SHARE, NOISE_COUNTS};
#[cfg(test)]
pub(super) use quantise::FUNCTION_THRESHOLD;
pub(super) use quantise::{Components, components, in_two_bands, responses, steps_of};
pub(super) use sampled::{Task, pilot_rows, sampled_rows};

use rayon::prelude::*;

use super::are_scales;
use super::basis::Basis;
use super::rows::Rows;
use crate::simd::Level;

/// Groups of eight components that one task takes.
const GROUPS_PER_TASK: usize = 8;

/// The compressed operator. Fields are checked against each other when it is
/// made, in memory or from a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LowRank {
    /// 1 / sigma_k: what a light's coefficients are multiplied by before V,
    /// whose entries are of like size then.
    pub(super) scales: Vec<f32>,
    /// V: a row a component, those of a partition one after the other.
    pub(super) components: Rows,
    /// The near field, and U over the components of a receiver's partition.
    pub(super) rows: Rows,
}

impl LowRank {
    /// Whether its tables fit each other and a basis of so many functions over
    /// so many slots. Says what does not.
    pub(super) fn check(
        &self,
        slot_count: usize,
        function_count: usize,
    ) -> Result<(), &'static str> {
        if !are_scales(&self.scales, function_count) {
            return Err("scales that do not fit the functions");
        }
        self.components.check(self.rows.function_count)?;
        self.rows.check(slot_count)
    }

    /// Components of all partitions.
    pub(crate) fn component_count(&self) -> usize {
        self.rows.function_count
    }

    /// E = T~ B in slots: irradiance from radiosity, W/m2.
    pub(super) fn apply(
        &self,
        level: Level,
        basis: &Basis,
        radiosity: &[[f32; 3]],
    ) -> Vec<[f32; 3]> {
        let arriving = self.components_of(level, &basis.project_rgb(level, radiosity));
        super::apply_rows(level, &self.rows, radiosity, &arriving)
    }

    /// y = V b of all components, from a light's coefficients.
    fn components_of(&self, level: Level, light: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let scaled: Vec<[f32; 3]> = light
            .iter()
            .zip(&self.scales)
            .map(|(b, scale)| b.map(|b| b * scale))
            .collect();
        let groups: Vec<_> = (0..self.components.group_count())
            .into_par_iter()
            .with_min_len(GROUPS_PER_TASK)
            .map(|group| self.components.gather(level, group, &[], &scaled))
            .collect();
        super::joined(&self.components, &groups)
    }

    /// W B in slots: what the near field alone brings, W/m2.
    fn near_field(&self, level: Level, radiosity: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let groups = (0..self.rows.group_count()).into_par_iter();
        let groups: Vec<_> = groups
            .with_min_len(super::GROUPS_PER_TASK)
            .map(|group| self.rows.gather_near(level, group, radiosity))
            .collect();
        super::joined(&self.rows, &groups)
    }

    /// Bytes of all tables.
    pub(crate) fn bytes(&self) -> usize {
        self.scales.len() * 4 + self.components.bytes() + self.rows.bytes()
    }

    /// Senders (slots, ascending) of the near field of the group that begins with
    /// a slot.
    pub(super) fn near_of(&self, first_slot: u32) -> Vec<u32> {
        let starts = self
            .rows
            .receivers
            .binary_search_by_key(&first_slot, |it| it.0);
        starts.map_or(Vec::new(), |group| self.rows.near_of(group))
    }

    /// Entries of a vertex in the mean: near field and components.
    pub(crate) fn coefficients_per_vertex(&self) -> f64 {
        self.rows.coefficients_per_vertex()
    }
}
