//! The leading part of a partition's remainder, as a product of two thin
//! matrices: randomised subspace iteration (Halko, Martinsson and Tropp 2011,
//! algorithms 4.4 and 5.1).
//!
//! Y = sqrt(A) C sigma is what prior lights make of the remainder. The columns
//! of U are the leading left singular vectors of Y, and Y ~ U (U^T Y).

use crate::bake::dense::symmetric_eigen;
use crate::bake::subspace::Block;
use crate::simd::Level;
use crate::simd::block::{BLOCK_LANES, multiply};

/// Columns beyond the rank asked for, which make the leading ones sharp.
const OVERSAMPLING: usize = 8;
/// Times that Y Y^T is applied after the first product: the spectrum falls off
/// by itself, and what is left is noise of the rays.
const POWER_STEPS: u32 = 2;
/// Seed of the start block.
const SEED: u32 = 0x10f4;

/// A matrix, row-major.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::bake) struct Matrix {
    pub(in crate::bake) rows: usize,
    pub(in crate::bake) columns: usize,
    pub(in crate::bake) values: Vec<f32>,
}

impl Matrix {
    pub(in crate::bake) fn zero(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            values: vec![0.0; rows * columns],
        }
    }

    pub(in crate::bake) fn row(&self, row: usize) -> &[f32] {
        &self.values[row * self.columns..(row + 1) * self.columns]
    }

    pub(in crate::bake) fn transposed(&self) -> Self {
        let mut transposed = Self::zero(self.columns, self.rows);
        for (row, values) in self.values.chunks_exact(self.columns.max(1)).enumerate() {
            for (column, &value) in values.iter().enumerate() {
                transposed.values[column * self.rows + row] = value;
            }
        }
        transposed
    }

    /// The same with columns of zeros up to whole lanes.
    fn padded(&self) -> Self {
        let columns = self.columns.next_multiple_of(BLOCK_LANES);
        let mut padded = Self::zero(self.rows, columns);
        let rows = padded.values.chunks_exact_mut(columns);
        for (out, row) in rows.zip(self.values.chunks_exact(self.columns)) {
            out[..self.columns].copy_from_slice(row);
        }
        padded
    }

    fn first_columns(&self, columns: usize) -> Self {
        let rows = self.values.chunks_exact(self.columns);
        Self {
            rows: self.rows,
            columns,
            values: rows.flat_map(|row| &row[..columns]).copied().collect(),
        }
    }

    pub(super) fn times(&self, level: Level, block: &Self) -> Self {
        let mut out = Self::zero(self.rows, block.columns);
        multiply(
            level,
            &self.values,
            self.columns,
            &block.values,
            block.columns,
            &mut out.values,
        );
        out
    }
}

/// Y ~ `left` x `right`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::bake) struct Factors {
    /// Rows x rank, orthonormal columns.
    pub(in crate::bake) left: Matrix,
    /// Columns of Y x rank: the transpose of U^T Y.
    pub(in crate::bake) right: Matrix,
    /// What noise alone makes of `right`.
    pub(in crate::bake) noise_of_right: Matrix,
    /// What each component is worth: squared singular values, and once they are
    /// smoothed what is left of them without noise.
    pub(in crate::bake) energies: Vec<f64>,
}

/// A component of less energy has a length that single precision does not hold; whoever
/// divided by it would have numbers that are not finite.
const LEAST_ENERGY: f64 = (f32::MIN_POSITIVE as f64) * (f32::MIN_POSITIVE as f64);

impl Factors {
    /// Components that bring so much energy for each of their bytes.
    pub(in crate::bake) fn rank_worth(&self, energy_a_byte: f64) -> usize {
        let bytes = self.left.rows as f64;
        let brings = |e: &&f64| **e > 0.0 && **e / bytes >= energy_a_byte;
        self.energies.iter().take_while(brings).count()
    }
}

/// Energy for each byte of the last component that `bytes` of U pay for, over
/// several partitions.
pub(in crate::bake) fn last_energy<'a>(
    parts: impl Iterator<Item = &'a Factors>,
    bytes: usize,
) -> f64 {
    let mut all: Vec<(f64, usize)> = parts
        .flat_map(|factors| {
            let bytes = factors.left.rows;
            let energies = factors.energies.iter();
            energies.map(move |&e| (e / bytes as f64, bytes))
        })
        .filter(|&(energy, _)| energy > 0.0)
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut spent = 0;
    for &(energy, cost) in &all {
        spent += cost;
        if spent >= bytes {
            return energy;
        }
    }
    0.0
}

/// The leading `rank` components of Y, and what `noise`, a matrix of the noise in
/// Y alone, makes of their U: D V / s for U = Y V / s.
pub(in crate::bake) fn factorise(
    level: Level,
    y: &Matrix,
    noise: &Matrix,
    rank: usize,
) -> (Factors, Matrix) {
    let mut factors = leading(level, y, rank);
    if factors.energies.is_empty() {
        return (factors, Matrix::default());
    }
    let of_right = noise.transposed().times(level, &factors.left.padded());
    factors.noise_of_right = of_right.first_columns(factors.right.columns);
    let mut scaled = factors.right.clone();
    for row in scaled.values.chunks_exact_mut(scaled.columns) {
        for (value, &energy) in row.iter_mut().zip(&factors.energies) {
            *value = if energy > 0.0 {
                (f64::from(*value) / energy) as f32
            } else {
                0.0
            };
        }
    }
    let noise = noise.times(level, &scaled.padded());
    (factors, noise)
}

/// The leading `rank` components of Y, fewer where it has not so many rows, with
/// their squared singular values.
pub(in crate::bake) fn leading(level: Level, y: &Matrix, rank: usize) -> Factors {
    if y.columns == 0 || y.rows == 0 || rank == 0 {
        return Factors::default();
    }
    let width = (rank + OVERSAMPLING).min(y.rows);
    let transposed = y.transposed();
    let mut basis = orthonormal(
        &y.times(level, &padded(&Block::random(y.columns, width, SEED))),
        width,
    );
    for _ in 0..POWER_STEPS {
        let back = transposed.times(level, &padded(&basis));
        basis = orthonormal(&y.times(level, &back), width);
    }
    rotated(&basis, &transposed.times(level, &padded(&basis)), rank)
}

/// The first `width` columns, orthonormal.
pub(super) fn orthonormal(block: &Matrix, width: usize) -> Block {
    let rows = block.values.chunks_exact(block.columns);
    let mut out = Block {
        columns: width,
        values: rows
            .flat_map(|row| row[..width].iter().map(|&v| f64::from(v)))
            .collect(),
    };
    out.orthonormalise(SEED);
    out
}

/// A block with columns of zeros up to whole lanes.
pub(super) fn padded(block: &Block) -> Matrix {
    let rows = block.values.len() / block.columns;
    let columns = block.columns.next_multiple_of(BLOCK_LANES);
    let mut matrix = Matrix::zero(rows, columns);
    for (out, row) in matrix
        .values
        .chunks_exact_mut(columns)
        .zip(block.values.chunks_exact(block.columns))
    {
        for (out, &value) in out.iter_mut().zip(row) {
            *out = value as f32;
        }
    }
    matrix
}

/// Turns an orthonormal basis Q (and Y^T Q) so that its columns are singular
/// vectors: the eigenvectors of (Y^T Q)^T (Y^T Q).
pub(super) fn rotated(basis: &Block, right: &Matrix, rank: usize) -> Factors {
    let width = basis.columns;
    let mut gram = vec![0.0_f64; width * width];
    for row in right.values.chunks_exact(right.columns) {
        for i in 0..width {
            let value = f64::from(row[i]);
            for j in 0..width {
                gram[i * width + j] += value * f64::from(row[j]);
            }
        }
    }
    let eigen = symmetric_eigen(gram, width).expect("finite symmetric matrices have eigenvectors");
    let kept = rank.min(width);
    // Descending: the last eigenvectors first.
    let turns: Vec<&[f64]> = eigen.vectors.chunks_exact(width).rev().take(kept).collect();
    let turn = |row: &[f64], out: &mut Vec<f32>| {
        for vector in &turns {
            let sum = row.iter().zip(*vector).fold(0.0, |sum, (a, b)| sum + a * b);
            out.push(sum as f32);
        }
    };
    let (mut left, mut turned) = (Vec::new(), Vec::new());
    for row in basis.values.chunks_exact(width) {
        turn(row, &mut left);
    }
    let mut wide = vec![0.0; width];
    for row in right.values.chunks_exact(right.columns) {
        for (wide, &value) in wide.iter_mut().zip(row) {
            *wide = f64::from(value);
        }
        turn(&wide, &mut turned);
    }
    let values = eigen.values.iter().rev().take(kept);
    Factors {
        left: Matrix {
            rows: basis.values.len() / width,
            columns: kept,
            values: left,
        },
        right: Matrix {
            rows: right.rows,
            columns: kept,
            values: turned,
        },
        energies: values
            .map(|&v| if v >= LEAST_ENERGY { v } else { 0.0 })
            .collect(),
        noise_of_right: Matrix::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::uniform;

    /// Single precision keeps a product of 60 numbers to some 1e-6; the rest
    /// is what two power steps leave of the last wanted component.
    const EXACT: f32 = 1e-4;

    /// A matrix whose five singular values fall off by about four each.
    fn of_rank_five(rows: usize, columns: usize) -> Matrix {
        let entry = |i: usize, k: usize| {
            (0..5).fold(0.0, |sum, r| {
                let scale = 1.0 / (1 << (2 * r)) as f32;
                let a = uniform(1, i as u32, r as u32) - 0.5;
                let b = uniform(2, k as u32, r as u32) - 0.5;
                sum + scale * a * b
            })
        };
        let places = (0..rows).flat_map(|i| (0..columns).map(move |k| (i, k)));
        Matrix {
            rows,
            columns,
            values: places.map(|(i, k)| entry(i, k)).collect(),
        }
    }

    #[test]
    fn a_matrix_of_rank_five_is_found_whole() {
        let (rows, columns, rank) = (60, 90, 5);
        let y = of_rank_five(rows, columns);
        let factors = leading(Level::detect(), &y, rank);
        assert!(factors.energies.is_sorted_by(|a, b| a >= b));
        for i in 0..rows {
            for k in 0..columns {
                let product: f32 = (0..rank)
                    .map(|r| factors.left.row(i)[r] * factors.right.row(k)[r])
                    .sum();
                let difference = (product - y.row(i)[k]).abs();
                assert!(difference < EXACT, "{i} {k}: {difference}");
            }
        }
        let all: f64 = y.values.iter().map(|&v| f64::from(v) * f64::from(v)).sum();
        let found: f64 = factors.energies.iter().sum();
        assert!((found / all - 1.0).abs() < 1e-5, "{found} of {all}");
    }

    #[test]
    fn noise_goes_the_way_of_the_matrix() {
        let y = of_rank_five(24, 40);
        let (factors, noise) = factorise(Level::detect(), &y, &y, 4);
        let close = |a: &Matrix, b: &Matrix, columns: usize| {
            for row in 0..a.rows {
                for (a, b) in a.row(row)[..columns].iter().zip(b.row(row)) {
                    assert!((a - b).abs() < 0.01, "{a} {b}");
                }
            }
        };
        close(&noise, &factors.left, 4);
        close(&factors.noise_of_right, &factors.right, 4);
    }

    #[test]
    fn every_level_finds_the_same_bits() {
        let mut y = Matrix::zero(40, 30);
        for (index, value) in y.values.iter_mut().enumerate() {
            *value = uniform(3, index as u32, 0) - 0.3;
        }
        let scalar = leading(Level::Scalar, &y, 12);
        for level in [Level::Sse2, Level::Avx2] {
            assert_eq!(leading(level, &y, 12), scalar, "{level:?}");
        }
        assert_eq!(scalar.left.columns, 12);
    }

    #[test]
    fn fewer_rows_than_components_give_as_many_as_rows() {
        let y = Matrix {
            rows: 3,
            columns: 4,
            values: (0..12).map(|i| uniform(4, i, 0)).collect(),
        };
        let factors = leading(Level::detect(), &y, 16);
        assert_eq!(factors.energies.len(), 3);
        assert_eq!(
            leading(Level::detect(), &Matrix::default(), 16),
            Factors::default()
        );
    }
}
