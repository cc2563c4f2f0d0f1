//! What endless bounces make of the functions of the basis, in coordinates of
//! each partition's leading patterns.

use rayon::prelude::*;

use super::series::Series;
use crate::bake::low_rank::factor::{Factors, Matrix, orthonormal, padded, rotated};
use crate::bake::subspace::Block;
use crate::bake::{BakeError, RunSettings};
use crate::maths::hash::uniform;

/// Random lights that patterns are found from, three channels each. A partition
/// keeps some 30 to 60 patterns of the 3 x 40 that they span.
pub(super) const RANDOM_LIGHTS: usize = 40;
/// Patterns of a partition, at most.
pub(super) const PATTERNS: usize = 3 * RANDOM_LIGHTS;
/// Seed of these.
const SEED: u32 = 0xf01d;
/// Functions that are solved before their columns are forgotten: 12 B a vertex
/// each.
const COLUMNS_AT_ONCE: usize = 32;

/// What columns are computed with.
pub(super) struct Columns<'a> {
    pub(super) series: Series<'a>,
    /// sigma of the functions of red, green and blue.
    pub(super) sigma: &'a [f32],
    /// Square roots of the receivers' areas, by slot.
    pub(super) roots_of_area: &'a [f32],
    pub(super) run: &'a RunSettings<'a>,
}

/// A partition's orthonormal patterns: slots x patterns.
pub(super) type Patterns = Block;

impl Columns<'_> {
    /// (G - W) x in slots.
    pub(super) fn beyond_near(&self, source: &[[f32; 3]]) -> Option<Vec<[f32; 3]>> {
        let mut limit = self.series.limit(source)?;
        let near = self.series.operator.near_field(self.series.level, source);
        for (value, near) in limit.iter_mut().zip(near) {
            (0..3).for_each(|c| value[c] -= near[c]);
        }
        Some(limit)
    }

    /// (G - W) of several fields; `None` where one has no limit.
    fn all_beyond_near(
        &self,
        numbers: std::ops::Range<usize>,
        source: impl Fn(usize) -> Vec<[f32; 3]> + Sync,
    ) -> Result<Option<Vec<Vec<[f32; 3]>>>, BakeError> {
        let solved: Vec<_> = numbers
            .into_par_iter()
            .map(|number| {
                self.run.proceed()?;
                let solved = self.beyond_near(&source(number));
                self.run.progress.advance(1);
                Ok(solved)
            })
            .collect::<Result<_, _>>()?;
        Ok(solved.into_iter().collect())
    }

    /// Steps of progress of all that follows.
    pub(super) fn steps(&self) -> u64 {
        (RANDOM_LIGHTS + self.series.basis.function_count()) as u64
    }

    /// The patterns of every partition.
    fn patterns(&self) -> Result<Option<Vec<Patterns>>, BakeError> {
        let basis = self.series.basis;
        let random = |light: usize| {
            let entry = |function: usize, channel: usize| {
                let sigma = self.sigma[channel * basis.function_count() + function];
                let number = (3 * light + channel) as u32;
                sigma * (uniform(SEED, function as u32, number) - 0.5)
            };
            let light: Vec<[f32; 3]> = (0..basis.function_count())
                .map(|function| [0, 1, 2].map(|channel| entry(function, channel)))
                .collect();
            basis.reconstruct_rgb(&light)
        };
        let Some(answers) = self.all_beyond_near(0..RANDOM_LIGHTS, random)? else {
            return Ok(None);
        };
        let of_part = |part: u32| {
            let slots = basis.slot_range(part);
            let width = PATTERNS.min(slots.len());
            let rows = slots.clone().flat_map(|slot| {
                let root = self.roots_of_area[slot];
                answers
                    .iter()
                    .flat_map(move |field| field[slot].map(|value| value * root))
            });
            let sampled = Matrix {
                rows: slots.len(),
                columns: PATTERNS,
                values: rows.collect(),
            };
            orthonormal(&sampled, width)
        };
        let parts = (0..basis.part_count() as u32).into_par_iter();
        Ok(Some(parts.map(of_part).collect()))
    }

    /// The leading part of R of every partition, as a product; `None` where
    /// bounces have no limit.
    pub(super) fn factors(&self) -> Result<Option<Vec<Factors>>, BakeError> {
        let Some(patterns) = self.patterns()? else {
            return Ok(None);
        };
        let functions = self.series.basis.function_count();
        let of_part = |patterns: &Patterns| {
            let columns = padded(patterns).columns;
            Matrix::zero(3 * functions, columns)
        };
        let mut right: Vec<Matrix> = patterns.iter().map(of_part).collect();
        for first in (0..functions).step_by(COLUMNS_AT_ONCE) {
            let numbers = first..(first + COLUMNS_AT_ONCE).min(functions);
            let Some(solved) = self.all_beyond_near(numbers, |k| self.white(k))? else {
                return Ok(None);
            };
            let parts = right.par_iter_mut().zip(&patterns).enumerate();
            parts.for_each(|(part, (right, patterns))| {
                self.take(part as u32, first, &solved, patterns, right);
            });
        }
        let parts = patterns.par_iter().zip(right);
        let turned = parts.map(|(patterns, right)| rotated(patterns, &right, patterns.columns));
        Ok(Some(turned.collect()))
    }

    /// s_k in all channels.
    fn white(&self, function: usize) -> Vec<[f32; 3]> {
        let basis = self.series.basis;
        let mut light = vec![[0.0; 3]; basis.function_count()];
        light[function] = [1.0; 3];
        basis.reconstruct_rgb(&light)
    }

    /// Rows of Y^T Q of the functions from `first` on: sigma_k sqrt(A) R_k times
    /// the patterns of a partition.
    fn take(
        &self,
        part: u32,
        first: usize,
        solved: &[Vec<[f32; 3]>],
        patterns: &Patterns,
        right: &mut Matrix,
    ) {
        let slots = self.series.basis.slot_range(part);
        let functions = self.series.basis.function_count();
        let block = padded(patterns);
        for channel in 0..3 {
            let row = |(index, field): (usize, &Vec<[f32; 3]>)| {
                let sigma = self.sigma[channel * functions + first + index];
                let values = slots.clone().zip(&field[slots.clone()]);
                let scaled =
                    values.map(|(slot, value)| value[channel] * self.roots_of_area[slot] * sigma);
                scaled.collect::<Vec<f32>>()
            };
            let columns = Matrix {
                rows: solved.len(),
                columns: slots.len(),
                values: solved.iter().enumerate().flat_map(row).collect(),
            };
            let product = columns.times(self.series.level, &block);
            let place = (channel * functions + first) * right.columns;
            right.values[place..place + product.values.len()].copy_from_slice(&product.values);
        }
    }
}
