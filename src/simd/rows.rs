//! Rows x RGB: eight receivers read one shared list of entries.
//!
//! The scalar definition is the loop below; other levels compile the same loop
//! with wider instructions. A lane's sum runs over the entries in their order,
//! multiply and add stay apart, so every level gives the same bits.

use super::Level;

/// Receivers of a group.
pub(crate) const LANES: usize = 8;

/// Sums of a group: a channel, then a lane.
pub(crate) type GroupSums = [[f32; LANES]; 3];

/// A signed or unsigned byte as a number.
pub(crate) trait Quantised: Copy {
    fn value(self) -> f32;
}

impl Quantised for i8 {
    #[inline(always)]
    fn value(self) -> f32 {
        f32::from(self)
    }
}

impl Quantised for u8 {
    #[inline(always)]
    fn value(self) -> f32 {
        f32::from(self)
    }
}

/// A position in a table.
pub(crate) trait TableIndex: Copy {
    fn position(self) -> usize;
}

impl TableIndex for u16 {
    #[inline(always)]
    fn position(self) -> usize {
        usize::from(self)
    }
}

impl TableIndex for u32 {
    #[inline(always)]
    fn position(self) -> usize {
        self as usize
    }
}

/// Adds weights x rgb to the sums.
#[inline(always)]
fn add<Q: Quantised>(sums: &mut GroupSums, weights: &[Q; LANES], rgb: [f32; 3]) {
    let mut values = [0.0_f32; LANES];
    for lane in 0..LANES {
        values[lane] = weights[lane].value();
    }
    for channel in 0..3 {
        for lane in 0..LANES {
            sums[channel][lane] += values[lane] * rgb[channel];
        }
    }
}

#[inline(always)]
fn dot_body<I: TableIndex, Q: Quantised>(
    indices: &[I],
    weights: &[[Q; LANES]],
    table: &[[f32; 3]],
) -> GroupSums {
    let mut sums = [[0.0_f32; LANES]; 3];
    for (index, weights) in indices.iter().zip(weights) {
        add(&mut sums, weights, table[index.position()]);
    }
    sums
}

#[inline(always)]
fn dot_run_body<Q: Quantised>(weights: &[[Q; LANES]], table: &[[f32; 3]]) -> GroupSums {
    let mut sums = [[0.0_f32; LANES]; 3];
    for (rgb, weights) in table.iter().zip(weights) {
        add(&mut sums, weights, *rgb);
    }
    sums
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn dot_run_avx2<Q: Quantised>(weights: &[[Q; LANES]], table: &[[f32; 3]]) -> GroupSums {
    dot_run_body(weights, table)
}

/// [`dot`] of a list that names the table's entries one after the other.
pub(crate) fn dot_run<Q: Quantised>(
    level: Level,
    weights: &[[Q; LANES]],
    table: &[[f32; 3]],
) -> GroupSums {
    match level.available() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => {
            // SAFETY: `available` returns this level only where the processor has AVX2.
            unsafe { dot_run_avx2(weights, table) }
        }
        _ => dot_run_body(weights, table),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn dot_avx2<I: TableIndex, Q: Quantised>(
    indices: &[I],
    weights: &[[Q; LANES]],
    table: &[[f32; 3]],
) -> GroupSums {
    dot_body(indices, weights, table)
}

/// Sum over the entries of weight x table entry, per lane and channel.
pub(crate) fn dot<I: TableIndex, Q: Quantised>(
    level: Level,
    indices: &[I],
    weights: &[[Q; LANES]],
    table: &[[f32; 3]],
) -> GroupSums {
    match level.available() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => {
            // SAFETY: `available` returns this level only where the processor has AVX2.
            unsafe { dot_avx2(indices, weights, table) }
        }
        _ => dot_body(indices, weights, table),
    }
}

#[inline(always)]
fn project_body(
    functions: &[f32],
    count: usize,
    values: &[[f32; 3]],
    sums: &mut [[f32; 3]],
    scratch: &mut Vec<f32>,
) {
    scratch.clear();
    scratch.resize(3 * count, 0.0);
    let (red, rest) = scratch.split_at_mut(count);
    let (green, blue) = rest.split_at_mut(count);
    for (row, value) in functions.chunks_exact(count).zip(values) {
        for k in 0..count {
            red[k] += row[k] * value[0];
        }
        for k in 0..count {
            green[k] += row[k] * value[1];
        }
        for k in 0..count {
            blue[k] += row[k] * value[2];
        }
    }
    for k in 0..count {
        sums[k] = [red[k], green[k], blue[k]];
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn project_avx2(
    functions: &[f32],
    count: usize,
    values: &[[f32; 3]],
    sums: &mut [[f32; 3]],
    scratch: &mut Vec<f32>,
) {
    project_body(functions, count, values, sums, scratch);
}

/// S^T B of one partition: `functions` holds a row of `count` values for each
/// of `values`; `sums` gets `count` triples. Sums run over the rows in order.
pub(crate) fn project(
    level: Level,
    functions: &[f32],
    count: usize,
    values: &[[f32; 3]],
    sums: &mut [[f32; 3]],
    scratch: &mut Vec<f32>,
) {
    match level.available() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => {
            // SAFETY: `available` returns this level only where the processor has AVX2.
            unsafe { project_avx2(functions, count, values, sums, scratch) }
        }
        _ => project_body(functions, count, values, sums, scratch),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::{hash3, uniform};

    fn levels() -> [Level; 3] {
        [Level::Scalar, Level::Sse2, Level::Avx2]
    }

    #[test]
    fn every_level_gives_the_bits_of_the_scalar_definition() {
        let indices: Vec<u16> = (0..200).map(|i| (hash3(1, i, 0) % 64) as u16).collect();
        let weights: Vec<[i8; LANES]> = (0..200)
            .map(|i| [0, 1, 2, 3, 4, 5, 6, 7].map(|l| hash3(2, i, l) as i8))
            .collect();
        let table: Vec<[f32; 3]> = (0..64)
            .map(|i| [0, 1, 2].map(|c| uniform(3, i, c) - 0.3))
            .collect();
        let definition = dot_body(&indices, &weights, &table);
        let wide: Vec<u32> = indices.iter().map(|&i| u32::from(i)).collect();
        for level in levels() {
            assert_eq!(
                dot(level, &indices, &weights, &table),
                definition,
                "{level:?}"
            );
            assert_eq!(dot(level, &wide, &weights, &table), definition, "{level:?}");
            let run: Vec<u32> = (0..64).collect();
            let listed = dot_body(&run, &weights[..64], &table);
            assert_eq!(dot_run(level, &weights[..64], &table), listed, "{level:?}");
        }
    }

    #[test]
    fn projection_has_the_same_bits_at_every_level() {
        let functions: Vec<f32> = (0..37 * 11).map(|i| uniform(4, i, 0) - 0.5).collect();
        let values: Vec<[f32; 3]> = (0..37)
            .map(|i| [0, 1, 2].map(|c| uniform(5, i, c)))
            .collect();
        let mut scratch = Vec::new();
        let mut definition = vec![[0.0; 3]; 11];
        project_body(&functions, 11, &values, &mut definition, &mut scratch);
        let by_hand: f32 = (0..37).fold(0.0, |sum, i| sum + functions[i * 11 + 4] * values[i][2]);
        assert_eq!(definition[4][2], by_hand);
        for level in levels() {
            let mut sums = vec![[0.0; 3]; 11];
            project(level, &functions, 11, &values, &mut sums, &mut scratch);
            assert_eq!(sums, definition, "{level:?}");
        }
    }
}
