//! The spectral basis S: the lowest eigenvectors of each partition's Laplacian,
//! stored in the order in which rows and frames work.
//!
//! Vertices stand in *slots*, partition by partition and ascending inside one,
//! so that both products with S touch one run of slots at a time.

use std::ops::Range;

use rayon::prelude::*;
use thiserror::Error;

use super::eigen::{EigenError, lowest_eigenpairs};
use super::graph::VertexGraph;
use super::laplacian::Laplacian;
use super::partition::Partition;
use super::subspace::Block;
use crate::simd::Level;
use crate::simd::rows::project;

/// Seed of what stands in for functions that masses make dependent.
const MASS_SEED: u32 = 0x3a55;

/// Why there is no basis.
#[derive(Debug, Error, PartialEq)]
pub(crate) enum BasisError {
    /// The caller asked to stop.
    #[error("the computation of the basis was cancelled")]
    Cancelled,
    /// One part has no eigenvectors.
    #[error("part {part} of the surface has no basis")]
    Part {
        /// Number of the part.
        part: usize,
        /// What went wrong.
        source: EigenError,
    },
}

/// Where one part stands.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Part {
    first_slot: usize,
    slot_count: usize,
    first_function: usize,
    function_count: usize,
    first_value: usize,
}

/// Basis S (vertices x functions) of fields on the surface: orthonormal under
/// the masses M of the vertices, S^T M S = I, every function zero outside its
/// part; the functions of part 0 come first, those of a part in ascending order
/// of eigenvalue (and with masses each without what the ones before it have).
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Basis {
    parts: Vec<Part>,
    vertex_of_slot: Vec<u32>,
    slot_of_vertex: Vec<u32>,
    part_of_slot: Vec<u32>,
    /// Part by part: slots x functions, row-major.
    values: Vec<f32>,
    function_count: usize,
    /// M: a mass a slot; empty where all are 1.
    masses: Vec<f32>,
}

/// The lists that a basis is made of, as its file holds them.
pub(super) struct BasisLists<'a> {
    pub(super) vertex_of_slot: &'a [u32],
    pub(super) slot_counts: Vec<u32>,
    pub(super) function_counts: Vec<u32>,
    pub(super) values: &'a [f32],
    pub(super) masses: &'a [f32],
}

impl Basis {
    /// Lowest eigenvectors of each part, about `functions_per_part` of them: a
    /// cluster of equal eigenvalues is not cut (see [`lowest_eigenpairs`]).
    ///
    /// Runs on the threads of the current rayon pool, with the same bits for
    /// any number of them. `finished` is called after each part; once
    /// `cancelled` returns true no further part is begun.
    ///
    /// # Errors
    /// When cancelled, or when the eigensolver fails on a part.
    pub(crate) fn build(
        graph: &VertexGraph,
        partition: &Partition,
        functions_per_part: &[u32],
        finished: &(dyn Fn() + Sync),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Self, BasisError> {
        assert_eq!(
            functions_per_part.len(),
            partition.part_count(),
            "one number a part"
        );
        let solved: Vec<Result<Vec<f32>, BasisError>> = functions_per_part
            .par_iter()
            .enumerate()
            .map(|(part, &wanted)| {
                if cancelled() {
                    return Err(BasisError::Cancelled);
                }
                let laplacian = Laplacian::of_part(graph, partition, part);
                let pairs = lowest_eigenpairs(&laplacian, wanted as usize)
                    .map_err(|source| BasisError::Part { part, source })?;
                finished();
                Ok(pairs.vectors.iter().map(|&value| value as f32).collect())
            })
            .collect();
        // The error of the first part that failed wins, whatever the threads do.
        let solved = solved.into_iter().collect::<Result<Vec<_>, _>>()?;
        let members = (0..partition.part_count())
            .flat_map(|part| partition.members(part))
            .copied()
            .collect();
        let slot_counts: Vec<u32> = (0..partition.part_count())
            .map(|p| partition.members(p).len() as u32)
            .collect();
        let function_counts: Vec<u32> = solved
            .iter()
            .zip(&slot_counts)
            .map(|(values, &slots)| values.len() as u32 / slots)
            .collect();
        Ok(
            Self::from_lists(members, &slot_counts, &function_counts, solved.concat())
                .expect("a partition and its eigenvectors fit each other"),
        )
    }

    /// What the functions of each part span, made orthonormal under `masses`
    /// (above 0, one a vertex): projection is then the fit with the least squared
    /// error weighted by them.
    pub(crate) fn under_masses(mut self, masses: &[f32]) -> Self {
        let masses: Vec<f32> = self
            .vertex_of_slot
            .iter()
            .map(|&vertex| masses[vertex as usize])
            .collect();
        let mut rest = self.values.as_mut_slice();
        let mut jobs = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let (own, others) = rest.split_at_mut(part.slot_count * part.function_count);
            rest = others;
            let slots = part.first_slot..part.first_slot + part.slot_count;
            jobs.push((part.function_count, own, &masses[slots]));
        }
        jobs.into_par_iter()
            .for_each(|(count, values, masses)| orthonormalise(count, values, masses));
        self.masses = masses;
        self
    }

    /// The same with masses that a file holds: one a slot, or none. Says what is
    /// wrong with them.
    pub(super) fn with_masses(mut self, masses: Vec<f32>) -> Result<Self, &'static str> {
        let is_mass = |mass: &f32| mass.is_finite() && *mass > 0.0;
        let fits = masses.is_empty() || masses.len() == self.slot_count();
        if !fits || !masses.iter().all(is_mass) {
            return Err("masses that do not fit the vertices");
        }
        self.masses = masses;
        Ok(self)
    }

    /// A basis from the lists that it is made of: the vertices in the order of
    /// the slots, slots and functions of each part, and the values part by
    /// part. Says what does not fit.
    pub(super) fn from_lists(
        vertex_of_slot: Vec<u32>,
        slot_counts: &[u32],
        function_counts: &[u32],
        values: Vec<f32>,
    ) -> Result<Self, &'static str> {
        if slot_counts.len() != function_counts.len() {
            return Err("partitions of unequal number");
        }
        let mut basis = Self {
            vertex_of_slot,
            values,
            ..Self::default()
        };
        let mut end = Part::default();
        for (index, (&slots, &functions)) in slot_counts.iter().zip(function_counts).enumerate() {
            let part = Part {
                slot_count: slots as usize,
                function_count: functions as usize,
                ..end
            };
            // Before any memory is taken for what a file claims.
            if part.slot_count > basis.vertex_of_slot.len() - end.first_slot
                || part.function_count > part.slot_count
            {
                return Err("partitions that do not fit the vertices");
            }
            basis.parts.push(part);
            basis
                .part_of_slot
                .extend(std::iter::repeat_n(index as u32, part.slot_count));
            end.first_slot += part.slot_count;
            end.first_function += part.function_count;
            end.first_value += part.slot_count * part.function_count;
        }
        basis.function_count = end.first_function;
        if end.first_slot != basis.vertex_of_slot.len() || end.first_value != basis.values.len() {
            return Err("partitions that do not cover the vertices");
        }
        if basis.values.iter().any(|value| !value.is_finite()) {
            return Err("a basis function that is not finite");
        }
        basis.slot_of_vertex = inverse(&basis.vertex_of_slot)
            .ok_or("slots that are no permutation of the vertices")?;
        Ok(basis)
    }

    /// What [`Self::from_lists`] takes.
    pub(super) fn lists(&self) -> BasisLists<'_> {
        BasisLists {
            vertex_of_slot: &self.vertex_of_slot,
            slot_counts: self
                .parts
                .iter()
                .map(|part| part.slot_count as u32)
                .collect(),
            function_counts: self
                .parts
                .iter()
                .map(|part| part.function_count as u32)
                .collect(),
            values: &self.values,
            masses: &self.masses,
        }
    }

    /// Number of parts.
    pub(crate) fn part_count(&self) -> usize {
        self.parts.len()
    }

    /// Number of vertices.
    pub(crate) fn slot_count(&self) -> usize {
        self.vertex_of_slot.len()
    }

    /// Number of functions of all parts.
    pub(crate) fn function_count(&self) -> usize {
        self.function_count
    }

    /// Vertex in each slot.
    pub(crate) fn vertex_of_slot(&self) -> &[u32] {
        &self.vertex_of_slot
    }

    /// Slot of each vertex.
    pub(crate) fn slot_of_vertex(&self) -> &[u32] {
        &self.slot_of_vertex
    }

    /// Slots of a part.
    pub(crate) fn slot_range(&self, part: u32) -> Range<usize> {
        let part = self.parts[part as usize];
        part.first_slot..part.first_slot + part.slot_count
    }

    /// Functions of a part.
    pub(crate) fn function_range(&self, part: u32) -> Range<usize> {
        let part = self.parts[part as usize];
        part.first_function..part.first_function + part.function_count
    }

    /// The part of a slot, and the values of its functions there.
    pub(crate) fn row(&self, slot: u32) -> (u32, &[f32]) {
        let index = self.part_of_slot[slot as usize];
        let part = self.parts[index as usize];
        let first = part.first_value + (slot as usize - part.first_slot) * part.function_count;
        (index, &self.values[first..first + part.function_count])
    }

    /// Values of a part's functions: slots x functions, row-major.
    fn part_values(&self, part: Part) -> &[f32] {
        &self.values[part.first_value..part.first_value + part.slot_count * part.function_count]
    }

    /// b = S^T M B for an RGB value a slot. Sums run over the slots of a part in
    /// order, in single precision: the same bits for any number of threads.
    pub(crate) fn project_rgb(&self, level: Level, values: &[[f32; 3]]) -> Vec<[f32; 3]> {
        assert_eq!(values.len(), self.slot_count(), "one value a slot");
        let mut coefficients = vec![[0.0; 3]; self.function_count];
        let mut rest = coefficients.as_mut_slice();
        let mut jobs = Vec::with_capacity(self.parts.len());
        for &part in &self.parts {
            let (own, others) = rest.split_at_mut(part.function_count);
            rest = others;
            jobs.push((part, own));
        }
        jobs.into_par_iter().with_min_len(8).for_each_init(
            Default::default,
            |(weighted, scratch), (part, sums)| {
                project(
                    level,
                    self.part_values(part),
                    part.function_count,
                    self.times_masses(part, values, weighted),
                    sums,
                    scratch,
                );
            },
        );
        coefficients
    }

    /// M B of a part; B itself where all masses are 1.
    fn times_masses<'a>(
        &self,
        part: Part,
        values: &'a [[f32; 3]],
        weighted: &'a mut Vec<[f32; 3]>,
    ) -> &'a [[f32; 3]] {
        let slots = part.first_slot..part.first_slot + part.slot_count;
        let own = &values[slots.clone()];
        if self.masses.is_empty() {
            return own;
        }
        let products = own.iter().zip(&self.masses[slots]);
        weighted.clear();
        weighted.extend(products.map(|(value, mass)| value.map(|v| v * mass)));
        weighted
    }

    /// S b for an RGB coefficient a function: a value a slot. Sums run over the
    /// functions of a part in order, in single precision.
    pub(crate) fn reconstruct_rgb(&self, coefficients: &[[f32; 3]]) -> Vec<[f32; 3]> {
        assert_eq!(
            coefficients.len(),
            self.function_count(),
            "one coefficient a function"
        );
        let value = |slot: usize| {
            let (part, row) = self.row(slot as u32);
            let own = &coefficients[self.function_range(part)];
            row.iter().zip(own).fold([0.0; 3], |mut sum, (s, b)| {
                for channel in 0..3 {
                    sum[channel] += s * b[channel];
                }
                sum
            })
        };
        (0..self.slot_count())
            .into_par_iter()
            .with_min_len(256)
            .map(value)
            .collect()
    }

    /// d = S^T M 1, the coefficients of constant light of 1.
    pub(crate) fn constant(&self, level: Level) -> Vec<f32> {
        self.project_rgb(level, &vec![[1.0; 3]; self.slot_count()])
            .into_iter()
            .map(|c| c[0])
            .collect()
    }
}

/// Makes functions (vertices x `count`) orthonormal under masses: with
/// Q R = sqrt(M) S, R upper triangular, they become Q / sqrt(M) = S R^-1. The
/// first keeps its shape.
fn orthonormalise(count: usize, values: &mut [f32], masses: &[f32]) {
    let mut block = Block::zero(masses.len(), count);
    let rows = block.values.chunks_exact_mut(count);
    for ((row, functions), &mass) in rows.zip(values.chunks_exact(count)).zip(masses) {
        let root = f64::from(mass).sqrt();
        for (entry, &value) in row.iter_mut().zip(functions) {
            *entry = f64::from(value) * root;
        }
    }
    block.orthonormalise(MASS_SEED);
    let rows = block.values.chunks_exact(count);
    for ((functions, row), &mass) in values.chunks_exact_mut(count).zip(rows).zip(masses) {
        let root = f64::from(mass).sqrt();
        for (value, entry) in functions.iter_mut().zip(row) {
            *value = (entry / root) as f32;
        }
    }
}

/// The inverse of a permutation, if it is one.
fn inverse(permutation: &[u32]) -> Option<Vec<u32>> {
    let mut inverse = vec![u32::MAX; permutation.len()];
    for (position, &value) in permutation.iter().enumerate() {
        let entry = inverse.get_mut(value as usize)?;
        if *entry != u32::MAX {
            return None;
        }
        *entry = position as u32;
    }
    Some(inverse)
}

#[cfg(test)]
mod tests;
