//! The lowest eigenpairs of a Laplacian.
//!
//! Subspace iteration with a Chebyshev filter (Zhou, Saad, Tiago and
//! Chelikowsky 2006): a polynomial of the matrix, small on the unwanted end of
//! the spectrum, is applied to a block of vectors, which Rayleigh-Ritz then
//! turns into approximations of eigenvectors. A product with the sparse matrix
//! costs 10 % of a solve with its factors (700 vertices of a mesh have 4,900
//! entries, their factors 25,000 and are passed twice), and the filter needs a
//! handful of products for each step of the inverse.
//!
//! Every answer is checked twice: residuals, and a count by inertia that no
//! eigenvalue was missed.

use thiserror::Error;

use super::dense::symmetric_eigen;
use super::inertia::eigenvalues_below;
use super::laplacian::{Laplacian, Recurrence};
use super::subspace::Block;
use crate::maths::functions::ln;
use crate::maths::order::Order;

/// Largest |L v - lambda v| of an eigenpair, |v| = 1.
pub(super) const RESIDUAL_LIMIT: f64 = 1e-8;

/// Iteration stops at this residual, so that vectors with a gap of 1e-3 to the
/// next eigenvalue are exact to 1e-8 ([`SIGN_TIE`] counts on it). From 1e-9 to
/// here costs 10 % of the time.
const RESIDUAL_TARGET: f64 = 1e-11;

/// But not below this share of the largest eigenvalue: rounding.
const RESIDUAL_FLOOR: f64 = 1e-14;

/// Eigenvalues closer than this share of their size are one cluster.
const CLUSTER_GAP: f64 = 1e-6;

/// Eigenvalues closer than this share of the largest are one cluster; rounding
/// alone tells the zeros of several pieces apart by some 1e-16.
const CLUSTER_FLOOR: f64 = 1e-13;

/// Entries of a vector within this share of the largest count as equal to it:
/// symmetric parts have such pairs, and vectors are only as exact as
/// [`RESIDUAL_TARGET`] over the gap to the next eigenvalue, some 1e-8.
const SIGN_TIE: f64 = 1e-6;

/// Vectors beyond the wanted ones: the more, the wider the gap that the filter
/// has to work on. Between 6 and 16 the time differs by 10 %.
const GUARD_VECTORS: usize = 10;

/// Cycles of filter and Rayleigh-Ritz before the block is enlarged. Meshes
/// take 3 to 5.
const MAX_CYCLES: u32 = 12;

/// Degree of the filter for random vectors, before anything is known of the
/// spectrum.
const FIRST_DEGREE: u32 = 20;

/// Degree of the later filters, at least and at most.
const DEGREES: (f64, f64) = (6.0, 400.0);

/// Logarithm of how much more a filter may amplify the lowest vector than the
/// highest wanted one. Beyond 1e12, rounding in the high ones becomes lowest
/// ones of the same size.
const AMPLIFICATION_LIMIT: f64 = 27.0;

/// Where in the gap above the last eigenvalue the others are counted. Not the
/// middle: small parts have whole eigenvalues and whole valences, and a number
/// that equals a valence makes the first pivot of the count zero.
const PLACE_IN_GAP: f64 = 0.437_016;

/// A part this many times the size of the block, or smaller, is solved as a
/// dense matrix.
const DENSE_RATIO: usize = 2;

/// Why a part has no basis.
#[derive(Debug, Error, PartialEq)]
pub(crate) enum EigenError {
    /// The eigenvectors found are not accurate, or one was missed.
    #[error(
        "the eigensolver found no reliable answer for {wanted} functions of {size} vertices \
         (residual {residual:.1e}); ask for another number of functions"
    )]
    NoAnswer {
        /// Eigenpairs asked for.
        wanted: usize,
        /// Rows of the matrix.
        size: usize,
        /// Largest residual of the last attempt.
        residual: f64,
    },
}

/// Lowest eigenpairs, with whole clusters only.
#[derive(Debug, Clone)]
pub(crate) struct Eigenpairs {
    /// Eigenvalues, ascending.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "what tests compare with closed forms")
    )]
    pub(crate) values: Vec<f64>,
    /// Column k is the eigenvector of `values[k]`: row-major, rows of the
    /// Laplacian x number of values. Orthonormal; the entry of largest absolute
    /// value of each is positive.
    pub(crate) vectors: Vec<f64>,
    /// Largest |L v - lambda v|.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "checked before it is returned, and by tests")
    )]
    pub(crate) residual: f64,
}

/// The `wanted` lowest eigenpairs, or fewer: a cluster of equal eigenvalues
/// (relative gap 1e-6) is never cut, so the last cluster is left out if it is
/// not wanted whole. If it is the only one, it is taken whole. `wanted` of at
/// least the number of rows gives all.
///
/// # Errors
/// If residuals stay above 1e-8 or the inertia of the matrix tells of an
/// eigenvalue that was not found.
pub(crate) fn lowest_eigenpairs(
    laplacian: &Laplacian,
    wanted: usize,
) -> Result<Eigenpairs, EigenError> {
    let size = laplacian.size();
    assert!(size > 0, "a part has at least one vertex");
    let wanted = wanted.clamp(1, size);
    let mut converged = wanted + 1;
    let mut columns = converged + GUARD_VECTORS + wanted / 8;
    let mut residual = f64::INFINITY;
    for seed in 0.. {
        let is_dense = size <= DENSE_RATIO * columns;
        let found = if is_dense {
            dense_pairs(laplacian)
        } else {
            filtered_pairs(laplacian, converged, columns, seed)
        };
        if let Some(found) = found {
            let kept = whole_clusters(&found.values, wanted, size, laplacian.upper_bound());
            residual = found.residual(laplacian, kept);
            if found.is_proven(laplacian, kept, residual) {
                return Ok(found.into_pairs(kept, residual));
            }
            if kept == 0 {
                // One cluster reaches beyond all that was computed.
                converged *= 2;
            }
        }
        if is_dense {
            break;
        }
        columns = 2 * columns.max(converged);
    }
    Err(EigenError::NoAnswer {
        wanted,
        size,
        residual,
    })
}

/// Eigenpairs from the lowest one on, without a gap if all went well.
struct Found {
    values: Vec<f64>,
    /// At least one column a value.
    vectors: Block,
}

impl Found {
    /// Largest residual of the first `kept` pairs; infinite if none is kept.
    fn residual(&self, laplacian: &Laplacian, kept: usize) -> f64 {
        if kept == 0 {
            return f64::INFINITY;
        }
        let residuals = self.vectors.first(kept).residuals(laplacian, &self.values);
        residuals
            .iter()
            .fold(0.0, |max, &residual| max.at_least(residual))
    }

    /// Whether the first `kept` pairs are accurate and none is missing.
    fn is_proven(&self, laplacian: &Laplacian, kept: usize, residual: f64) -> bool {
        let none_missing = || {
            let (below, above) = (self.values[kept - 1], self.values[kept]);
            let in_the_gap = below + PLACE_IN_GAP * (above - below);
            eigenvalues_below(laplacian, in_the_gap) == kept
        };
        residual <= RESIDUAL_LIMIT && (kept == laplacian.size() || none_missing())
    }

    fn into_pairs(self, kept: usize, residual: f64) -> Eigenpairs {
        let mut vectors = self.vectors.first(kept);
        vectors.fix_signs(SIGN_TIE);
        Eigenpairs {
            values: self.values[..kept].to_vec(),
            vectors: vectors.values,
            residual,
        }
    }
}

/// Largest number of values, at most `wanted`, that does not end inside a
/// cluster; if there is none, the smallest number above. 0 if that is not
/// among the `values`, the lowest of `size`.
fn whole_clusters(values: &[f64], wanted: usize, size: usize, upper_bound: f64) -> usize {
    let ends_cluster = |&count: &usize| {
        count == size
            || count < values.len() && {
                let (below, above) = (values[count - 1], values[count]);
                above - below > CLUSTER_GAP * above + CLUSTER_FLOOR * upper_bound
            }
    };
    let below = (1..=wanted).rev().find(ends_cluster);
    below
        .or_else(|| (wanted + 1..=values.len()).find(ends_cluster))
        .unwrap_or(0)
}

/// All eigenpairs, from the dense matrix.
fn dense_pairs(laplacian: &Laplacian) -> Option<Found> {
    let size = laplacian.size();
    let eigen = symmetric_eigen(laplacian.to_dense(), size)?;
    let mut vectors = Block::zero(size, size);
    for (i, value) in vectors.values.iter_mut().enumerate() {
        *value = eigen.vectors[i % size * size + i / size];
    }
    Some(Found {
        values: eigen.values,
        vectors,
    })
}

/// The lowest `converged` pairs, by filtering a random block of `columns`.
fn filtered_pairs(
    laplacian: &Laplacian,
    converged: usize,
    columns: usize,
    seed: u32,
) -> Option<Found> {
    let mut vectors = Block::random(laplacian.size(), columns, seed);
    let mut filter = Filter::first(laplacian, columns);
    for cycle in 0..MAX_CYCLES {
        filter.apply(laplacian, &mut vectors);
        vectors.orthonormalise(seed.wrapping_add(cycle * 1000));
        let mut values = vectors.ritz(laplacian)?;
        let residuals = vectors.residuals(laplacian, &values);
        let worst = residuals[..converged]
            .iter()
            .fold(0.0_f64, |max, &r| max.at_least(r));
        if worst <= filter.target {
            values.truncate(converged);
            return Some(Found { values, vectors });
        }
        filter = filter.next(values[converged - 1], values[columns - 1], worst);
    }
    None
}

/// Chebyshev polynomial of a Laplacian: within -1..1 on the damped interval
/// `from..upper_bound`, growing below, scaled to 1 at 0.
struct Filter {
    from: f64,
    upper_bound: f64,
    degree: u32,
    /// Residual to reach.
    target: f64,
}

impl Filter {
    /// Filter for random vectors.
    fn first(laplacian: &Laplacian, columns: usize) -> Self {
        let upper_bound = laplacian.upper_bound();
        // The number of eigenvalues of a flat mesh below x grows like x (Weyl):
        // 22 columns / size is the one at `columns` of a triangulated plane.
        let guess = 22.0 * columns as f64 / laplacian.size() as f64;
        Self {
            from: guess.at_most(0.5 * upper_bound),
            upper_bound,
            degree: FIRST_DEGREE,
            target: RESIDUAL_TARGET.at_least(RESIDUAL_FLOOR * upper_bound),
        }
    }

    /// Filter that damps everything from the Ritz value `damped` on and takes
    /// the residual of the pair at `wanted` from `residual` to the target, or
    /// as far towards it as rounding allows.
    fn next(&self, wanted: f64, damped: f64, residual: f64) -> Self {
        let from = damped.clamp(1e-12 * self.upper_bound, 0.9 * self.upper_bound);
        let next = Self { from, ..*self };
        let missing = ln(2.0 * residual / self.target);
        let (wanted_rate, lowest_rate) = (next.rate(wanted), next.rate(0.0));
        let enough = missing / wanted_rate.at_least(1e-6);
        let safe = AMPLIFICATION_LIMIT / (lowest_rate - wanted_rate).at_least(1e-6);
        let degree = enough.at_most(safe).clamp(DEGREES.0, DEGREES.1);
        Self {
            degree: degree as u32,
            ..next
        }
    }

    /// Logarithm of the growth of the polynomial with each degree at an
    /// eigenvalue: the inverse hyperbolic cosine of its place outside -1..1.
    fn rate(&self, eigenvalue: f64) -> f64 {
        let place = ((self.upper_bound + self.from - 2.0 * eigenvalue)
            / (self.upper_bound - self.from))
            .at_least(1.0);
        ln(place + (place * place - 1.0).sqrt())
    }

    /// vectors = polynomial(L) vectors, by the three-term recurrence in the
    /// scaled form that cannot overflow (Zhou et al., algorithm 3.1).
    fn apply(&self, laplacian: &Laplacian, vectors: &mut Block) {
        let half_width = 0.5 * (self.upper_bound - self.from);
        let centre = 0.5 * (self.upper_bound + self.from);
        let first_scale = -half_width / centre;
        let mut scale = first_scale;
        let columns = vectors.columns;
        let mut next = Block::zero(laplacian.size(), columns);
        let terms = Recurrence {
            shift: centre,
            factor: scale / half_width,
            previous: 0.0,
        };
        laplacian.advance(&vectors.values, columns, &terms, &mut next.values);
        for _ in 1..self.degree {
            std::mem::swap(vectors, &mut next);
            let next_scale = 1.0 / (2.0 / first_scale - scale);
            let terms = Recurrence {
                shift: centre,
                factor: 2.0 * next_scale / half_width,
                previous: scale * next_scale,
            };
            laplacian.advance(&vectors.values, columns, &terms, &mut next.values);
            scale = next_scale;
        }
        std::mem::swap(vectors, &mut next);
    }
}

#[cfg(test)]
mod tests;
