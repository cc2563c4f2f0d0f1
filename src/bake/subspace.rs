//! A few vectors of the length of a part, and what the eigensolver does with
//! them. Row-major, `size` x `columns`: inner loops run over the columns.

use super::dense::symmetric_eigen;
use super::laplacian::Laplacian;
use crate::maths::hash::uniform;
use crate::maths::order::Order;

/// Passes of orthonormalisation at most. Two are usual, three after a filter
/// that left columns nearly dependent.
const MAX_PASSES: u32 = 12;

/// A pass whose columns were orthonormal to this leaves them so to rounding.
const NEARLY_ORTHONORMAL: f64 = 1e-8;

/// A column with less than this share (squared) outside those before it is
/// noise, and replaced.
const DEPENDENT: f64 = 1e-13;

/// Vectors as the columns of a row-major matrix.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) columns: usize,
    pub(super) values: Vec<f64>,
}

impl Block {
    /// Columns of hashed numbers in -0.5..0.5.
    pub(super) fn random(size: usize, columns: usize, seed: u32) -> Self {
        let values = (0..size * columns)
            .map(|i| random_entry(seed, i / columns, i % columns))
            .collect();
        Self { columns, values }
    }

    /// All zero.
    pub(super) fn zero(size: usize, columns: usize) -> Self {
        Self {
            columns,
            values: vec![0.0; size * columns],
        }
    }

    fn rows(&self) -> std::slice::ChunksExact<'_, f64> {
        self.values.chunks_exact(self.columns)
    }

    fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, f64> {
        self.values.chunks_exact_mut(self.columns)
    }

    /// Upper triangle of self^T other, `columns` x `columns`.
    fn products(&self, other: &Self) -> Vec<f64> {
        let columns = self.columns;
        let mut sums = vec![0.0; columns * columns];
        for (own, other) in self.rows().zip(other.rows()) {
            for (j, &factor) in own.iter().enumerate() {
                let sums = &mut sums[j * columns + j..(j + 1) * columns];
                for (sum, &value) in sums.iter_mut().zip(&other[j..]) {
                    *sum += factor * value;
                }
            }
        }
        sums
    }

    /// Makes the columns orthonormal to rounding and keeps what they span, up
    /// to columns that depend on others; those become random ones.
    ///
    /// Cholesky QR, repeated until a pass finds nothing left to do (Yamamoto
    /// et al. 2015).
    pub(super) fn orthonormalise(&mut self, seed: u32) {
        for pass in 0..MAX_PASSES {
            let factor = Factor::of(&self.normalised_products());
            for row in self.rows_mut() {
                factor.divide(row);
            }
            for &column in &factor.dependent {
                self.randomise(column, seed.wrapping_add(pass + 1));
            }
            if factor.was_orthonormal {
                break;
            }
        }
    }

    /// Scales the columns to length 1; returns their products.
    fn normalised_products(&mut self) -> Vec<f64> {
        let columns = self.columns;
        let mut products = self.products(self);
        let scales: Vec<f64> = (0..columns)
            .map(|j| {
                let squared = products[j * columns + j];
                if squared > 0.0 {
                    1.0 / squared.sqrt()
                } else {
                    0.0
                }
            })
            .collect();
        for row in self.rows_mut() {
            row.iter_mut()
                .zip(&scales)
                .for_each(|(value, scale)| *value *= scale);
        }
        for (i, product) in products.iter_mut().enumerate() {
            *product *= scales[i / columns] * scales[i % columns];
        }
        products
    }

    fn randomise(&mut self, column: usize, seed: u32) {
        for (row, values) in self.rows_mut().enumerate() {
            values[column] = random_entry(seed, row, column);
        }
    }

    /// self rotation, where row k of `rotation` holds the combination that
    /// becomes column k; only the first `kept` rows.
    fn combined(&self, rotation: &[f64], kept: usize) -> Self {
        let columns = self.columns;
        let mut by_source = vec![0.0; columns * kept];
        for k in 0..kept {
            for j in 0..columns {
                by_source[j * kept + k] = rotation[k * columns + j];
            }
        }
        let mut result = Self::zero(self.values.len() / columns, kept);
        for (out, row) in result.rows_mut().zip(self.rows()) {
            for (&factor, combination) in row.iter().zip(by_source.chunks_exact(kept)) {
                for (out, &value) in out.iter_mut().zip(combination) {
                    *out += factor * value;
                }
            }
        }
        result
    }

    /// Rayleigh-Ritz: turns orthonormal columns into the best approximations
    /// of eigenvectors that they span, and returns their values, ascending.
    pub(super) fn ritz(&mut self, laplacian: &Laplacian) -> Option<Vec<f64>> {
        let columns = self.columns;
        let mut image = Self::zero(laplacian.size(), columns);
        laplacian.apply(&self.values, columns, &mut image.values);
        let mut projected = self.products(&image);
        for j in 0..columns {
            for k in 0..j {
                projected[j * columns + k] = projected[k * columns + j];
            }
        }
        let eigen = symmetric_eigen(projected, columns)?;
        *self = self.combined(&eigen.vectors, columns);
        Some(eigen.values)
    }

    /// |L v - value v| of each column v.
    pub(super) fn residuals(&self, laplacian: &Laplacian, values: &[f64]) -> Vec<f64> {
        let mut image = Self::zero(laplacian.size(), self.columns);
        laplacian.apply(&self.values, self.columns, &mut image.values);
        let mut squared = vec![0.0; self.columns];
        for (image, row) in image.rows().zip(self.rows()) {
            for k in 0..self.columns {
                let difference = image[k] - values[k] * row[k];
                squared[k] += difference * difference;
            }
        }
        squared.iter().map(|sum| sum.sqrt()).collect()
    }

    /// The first `kept` columns.
    pub(super) fn first(&self, kept: usize) -> Self {
        let values = self.rows().flat_map(|row| &row[..kept]).copied().collect();
        Self {
            columns: kept,
            values,
        }
    }

    /// Makes the entry of largest absolute value of each column positive, the
    /// lowest row where several are equal up to `tie`, relative.
    pub(super) fn fix_signs(&mut self, tie: f64) {
        let mut largest = vec![0.0_f64; self.columns];
        for row in self.rows() {
            for (largest, value) in largest.iter_mut().zip(row) {
                *largest = largest.at_least(value.abs());
            }
        }
        let mut signs = vec![0.0; self.columns];
        for row in self.rows() {
            for (column, &value) in row.iter().enumerate() {
                if signs[column] == 0.0 && value.abs() >= largest[column] * (1.0 - tie) {
                    signs[column] = if value < 0.0 { -1.0 } else { 1.0 };
                }
            }
        }
        for row in self.rows_mut() {
            row.iter_mut()
                .zip(&signs)
                .for_each(|(value, sign)| *value *= sign);
        }
    }
}

fn random_entry(seed: u32, row: usize, column: usize) -> f64 {
    f64::from(uniform(seed, row as u32, column as u32)) - 0.5
}

/// Upper triangle R with R^T R = products of unit columns.
struct Factor {
    columns: usize,
    entries: Vec<f64>,
    /// Columns that the ones before them span; their rows of R are 0.
    dependent: Vec<usize>,
    was_orthonormal: bool,
}

impl Factor {
    fn of(products: &[f64]) -> Self {
        let columns = (products.len() as f64).sqrt() as usize;
        let mut entries = products.to_vec();
        let mut dependent = Vec::new();
        let mut deviation = 0.0_f64;
        for j in 0..columns {
            let above = &products[j * columns + j + 1..(j + 1) * columns];
            deviation = above
                .iter()
                .fold(deviation, |max, product| max.at_least(product.abs()));
            let pivot = entries[j * columns + j];
            if pivot > DEPENDENT {
                scale_pivot_row(
                    &mut entries[j * columns + j..(j + 1) * columns],
                    pivot.sqrt(),
                );
                subtract_row(&mut entries, columns, j);
            } else {
                dependent.push(j);
                entries[j * columns + j..(j + 1) * columns].fill(0.0);
            }
        }
        let was_orthonormal = dependent.is_empty() && deviation <= NEARLY_ORTHONORMAL;
        Self {
            columns,
            entries,
            dependent,
            was_orthonormal,
        }
    }

    /// row = row R^-1.
    fn divide(&self, row: &mut [f64]) {
        for j in 0..self.columns {
            let factors = &self.entries[j * self.columns + j..(j + 1) * self.columns];
            if factors[0] == 0.0 {
                continue;
            }
            let (head, tail) = row[j..].split_at_mut(1);
            head[0] /= factors[0];
            for (value, &factor) in tail.iter_mut().zip(&factors[1..]) {
                *value -= head[0] * factor;
            }
        }
    }
}

fn scale_pivot_row(row: &mut [f64], root: f64) {
    row[0] = root;
    row[1..].iter_mut().for_each(|entry| *entry /= root);
}

/// Removes row j of R from the products below it.
fn subtract_row(entries: &mut [f64], columns: usize, j: usize) {
    let (done, below) = entries.split_at_mut((j + 1) * columns);
    let pivot_row = &done[j * columns..];
    for (k, row) in (j + 1..columns).zip(below.chunks_exact_mut(columns)) {
        for (entry, &value) in row[k..].iter_mut().zip(&pivot_row[k..]) {
            *entry -= pivot_row[k] * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_columns_become_orthonormal_too() {
        let mut block = Block::random(30, 6, 1);
        for row in block.values.chunks_exact_mut(6) {
            row[3] = row[0] + 2.0 * row[1];
            row[4] = 0.0;
            row[5] = 1e9 * row[2] + 1e-3 * row[5];
        }
        block.orthonormalise(2);
        let products = block.products(&block);
        for j in 0..6 {
            for k in j..6 {
                let unit = if j == k { 1.0 } else { 0.0 };
                assert!((products[j * 6 + k] - unit).abs() < 1e-14, "{j} {k}");
            }
        }
    }

    #[test]
    fn signs_follow_the_first_of_the_largest_entries() {
        let mut block = Block {
            columns: 2,
            values: vec![-2.0, 0.5, 2.0, -1.0],
        };
        block.fix_signs(1e-9);
        assert_eq!(block.values, [2.0, -0.5, -2.0, 1.0]);
    }
}
