//! A dense matrix times a block of columns.
//!
//! The scalar definition is the loop below; other levels compile the same loop
//! with wider instructions. Every sum runs over the columns of the matrix in
//! their order, multiply and add stay apart, so every level gives the same bits.

use super::Level;

/// Columns of a block come in multiples of this.
pub(crate) const BLOCK_LANES: usize = 8;
/// Columns whose sums are kept in registers at a time.
const CHUNK: usize = 4 * BLOCK_LANES;

#[inline(always)]
fn multiply_body(matrix: &[f32], columns: usize, block: &[f32], width: usize, out: &mut [f32]) {
    for (row, out) in matrix
        .chunks_exact(columns)
        .zip(out.chunks_exact_mut(width))
    {
        let mut chunks = out.chunks_exact_mut(CHUNK);
        let mut first = 0;
        for out in &mut chunks {
            sum_columns::<CHUNK>(row, block, width, first, out);
            first += CHUNK;
        }
        for out in chunks.into_remainder().chunks_exact_mut(BLOCK_LANES) {
            sum_columns::<BLOCK_LANES>(row, block, width, first, out);
            first += BLOCK_LANES;
        }
    }
}

/// Sum over the block's rows of entry x row, for `N` columns from `first`.
#[inline(always)]
fn sum_columns<const N: usize>(
    entries: &[f32],
    block: &[f32],
    width: usize,
    first: usize,
    out: &mut [f32],
) {
    let mut sums = [0.0_f32; N];
    for (entry, values) in entries.iter().zip(block.chunks_exact(width)) {
        let values = &values[first..first + N];
        for lane in 0..N {
            sums[lane] += entry * values[lane];
        }
    }
    out.copy_from_slice(&sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn multiply_avx2(matrix: &[f32], columns: usize, block: &[f32], width: usize, out: &mut [f32]) {
    multiply_body(matrix, columns, block, width, out);
}

/// out = matrix x block: rows x `columns` times `columns` x `width`, all
/// row-major; `width` is a multiple of [`BLOCK_LANES`].
pub(crate) fn multiply(
    level: Level,
    matrix: &[f32],
    columns: usize,
    block: &[f32],
    width: usize,
    out: &mut [f32],
) {
    assert_eq!(width % BLOCK_LANES, 0, "whole lanes");
    assert_eq!(block.len(), columns * width, "a row of the block a column");
    match level.available() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => {
            // SAFETY: `available` returns this level only where the processor has AVX2.
            unsafe { multiply_avx2(matrix, columns, block, width, out) }
        }
        _ => multiply_body(matrix, columns, block, width, out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::uniform;

    #[test]
    fn every_level_gives_the_bits_of_the_plain_sum() {
        let (rows, columns, width) = (5, 37, 40);
        let numbers = |seed, count: usize| -> Vec<f32> {
            (0..count as u32)
                .map(|i| uniform(seed, i, 0) - 0.5)
                .collect()
        };
        let (matrix, block) = (numbers(1, rows * columns), numbers(2, columns * width));
        let plain = |i: usize, j: usize| {
            (0..columns).fold(0.0_f32, |sum, k| {
                sum + matrix[i * columns + k] * block[k * width + j]
            })
        };
        for level in [Level::Scalar, Level::Sse2, Level::Avx2] {
            let mut out = vec![0.0; rows * width];
            multiply(level, &matrix, columns, &block, width, &mut out);
            for (index, value) in out.iter().enumerate() {
                assert_eq!(*value, plain(index / width, index % width), "{level:?}");
            }
        }
    }
}
