//! The published table (section 3.3 of the paper): for every receiver its own
//! list of basis coefficients, 8 bits each with one step for the whole scene.
//!
//!   E_i = q sum_k c_ik b_k, c_ik an i8, b = S^T B

use std::ops::Range;

use rayon::prelude::*;

use crate::bake::basis::Basis;
use crate::bake::rows::Indices;
use crate::simd::Level;
use crate::simd::lists::{Lists, sum_lists};

/// Receivers that one task of [`PaperRows::apply`] takes.
const RECEIVERS_PER_TASK: usize = 256;
/// The largest coefficient as it is stored.
const LARGEST: f32 = 127.0;

/// Steps that are tried, each smaller than the one before by this factor: down
/// to a 128th of the largest.
const STEPS: usize = 15;
const STEP_RATIO: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// The largest coefficients of one receiver, not quantised yet: (function, c),
/// functions ascending.
pub(super) type Coefficients = Vec<(u32, f32)>;

/// The lists of all receivers, in the order of the slots. Fields are checked
/// against each other when a table is read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PaperRows {
    pub(in crate::bake) function_count: usize,
    /// Entries before each receiver's list; one more than there are slots.
    pub(in crate::bake) offsets: Vec<u32>,
    pub(in crate::bake) functions: Indices,
    pub(in crate::bake) coefficients: Vec<i8>,
    /// q: the one step of all coefficients; 0 where there is none.
    pub(in crate::bake) step: f32,
    /// Receivers that nothing sends light to. Not the same as an empty list:
    /// all entries of a faint row may be quantised to zero.
    pub(in crate::bake) alone: Vec<bool>,
}

impl PaperRows {
    /// Quantises the rows of all slots and leaves out what becomes zero ("all
    /// elements that are quantized to zero", section 3.3); `constant` is S^T 1.
    pub(super) fn quantised(rows: &[Coefficients], constant: &[f32], alone: Vec<bool>) -> Self {
        let step = best_step(rows, constant);
        let mut table = Self {
            function_count: constant.len(),
            offsets: vec![0],
            functions: Indices::for_table(constant.len()),
            coefficients: Vec::new(),
            step,
            alone,
        };
        for row in rows {
            for &(function, c) in row {
                let steps = steps_of(c, step);
                if steps != 0.0 {
                    table.functions.extend(&[function]);
                    table.coefficients.push(steps as i8);
                }
            }
            table.offsets.push(table.coefficients.len() as u32);
        }
        table
    }

    /// Whether every list fits the others and every index the basis, so that
    /// the kernel never leaves a table. Says what does not.
    pub(in crate::bake) fn check(&self, slot_count: usize) -> Result<(), &'static str> {
        if self.offsets.len() != slot_count + 1 || self.alone.len() != slot_count {
            return Err("lists that do not cover the vertices");
        }
        let ends = (self.offsets[0], self.offsets[slot_count] as usize);
        if ends != (0, self.coefficients.len()) || !self.offsets.is_sorted() {
            return Err("lists of the wrong length");
        }
        if self.functions.len() != self.coefficients.len() {
            return Err("coefficients of the wrong length");
        }
        let largest = self.functions.largest();
        if largest.is_some_and(|function| function as usize >= self.function_count) {
            return Err("an index beyond its table");
        }
        if !self.step.is_finite() || self.step < 0.0 {
            return Err("a step that is no size");
        }
        Ok(())
    }

    /// E = T~ B in slots: irradiance from radiosity, W/m2.
    pub(in crate::bake) fn apply(
        &self,
        level: Level,
        basis: &Basis,
        radiosity: &[[f32; 3]],
    ) -> Vec<[f32; 3]> {
        let light = basis.project_rgb(level, radiosity);
        let light: Vec<[f32; 4]> = light.iter().map(|&[r, g, b]| [r, g, b, 0.0]).collect();
        let mut irradiance = vec![[0.0; 3]; self.alone.len()];
        let tasks = irradiance.par_chunks_mut(RECEIVERS_PER_TASK).enumerate();
        tasks.for_each(|(task, sums)| {
            let first = task * RECEIVERS_PER_TASK;
            self.sum(level, first, &light, sums);
            for channel in sums.as_flattened_mut() {
                *channel *= self.step;
            }
        });
        irradiance
    }

    /// Sums of the lists from a slot on, in steps.
    fn sum(&self, level: Level, first: usize, light: &[[f32; 4]], sums: &mut [[f32; 3]]) {
        let offsets = &self.offsets[first..=first + sums.len()];
        let weights = self.coefficients.as_slice();
        match &self.functions {
            Indices::Narrow(indices) => {
                let lists = Lists {
                    offsets,
                    indices,
                    weights,
                };
                sum_lists(level, lists, light, sums);
            }
            Indices::Wide(indices) => {
                let lists = Lists {
                    offsets,
                    indices,
                    weights,
                };
                sum_lists(level, lists, light, sums);
            }
        }
    }

    /// Slots of receivers that nothing sends light to.
    pub(in crate::bake) fn without_senders(&self) -> Vec<Range<usize>> {
        let slots = (0..self.alone.len()).filter(|&slot| self.alone[slot]);
        slots.map(|slot| slot..slot + 1).collect()
    }

    /// Bytes of the lists.
    pub(in crate::bake) fn bytes(&self) -> usize {
        self.functions.bytes()
            + self.coefficients.len()
            + self.offsets.len() * size_of::<u32>()
            + self.alone.len()
            + size_of::<f32>()
    }

    /// Coefficients a vertex in the mean.
    pub(in crate::bake) fn coefficients_per_vertex(&self) -> f64 {
        self.coefficients.len() as f64 / self.alone.len().max(1) as f64
    }
}

/// c as a whole number of steps, clipped to 8 bits.
fn steps_of(c: f32, step: f32) -> f32 {
    if step > 0.0 {
        (c / step).round().clamp(-LARGEST, LARGEST)
    } else {
        0.0
    }
}

/// The step, from the one that makes the largest element 127 downwards, with
/// which the table answers constant light most nearly as its elements do before
/// they are quantised; 0 where there is none. Of equally good ones the largest.
fn best_step(rows: &[Coefficients], constant: &[f32]) -> f32 {
    let sizes = rows.iter().flatten().map(|&(_, c)| c.abs());
    let largest = sizes.fold(0.0, |max, size| if size > max { size } else { max });
    let mut steps = vec![largest / LARGEST];
    for candidate in 1..STEPS {
        steps.push(steps[candidate - 1] * STEP_RATIO);
    }
    let error = |&step: &f32| -> f64 {
        let of_row = |row: &Coefficients| {
            let terms = row.iter().map(|&(function, c)| {
                f64::from(c - steps_of(c, step) * step) * f64::from(constant[function as usize])
            });
            let sum: f64 = terms.sum();
            sum * sum
        };
        rows.iter().map(of_row).sum()
    };
    // Each sum runs over the rows in their order, whoever makes it.
    let errors: Vec<f64> = steps.par_iter().map(error).collect();
    let mut best = 0;
    for candidate in 1..STEPS {
        if errors[candidate] < errors[best] {
            best = candidate;
        }
    }
    steps[best]
}
