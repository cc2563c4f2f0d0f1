//! Lists x RGB: every receiver has a list of entries of its own.
//!
//! The four lanes of a sum are red, green, blue and a fourth that is zero, so
//! that an entry of the table is one load; entry e of a list goes to the sum
//! e mod [`SUMS`], and the sums are joined in a fixed order. The scalar
//! definition is the loop below; other levels compile the same loop with wider
//! instructions, multiply and add stay apart, so every level gives the same bits.

use super::Level;
use super::rows::TableIndex;

/// Sums of one list that are under way at a time: a chain of additions alone
/// waits for each of them.
const SUMS: usize = 4;

/// The lists of some receivers, one after another.
#[derive(Clone, Copy)]
pub(crate) struct Lists<'a, I> {
    /// Entries before each list; one more than there are lists.
    pub(crate) offsets: &'a [u32],
    /// Position in the table of every entry of all lists that `offsets` counts.
    pub(crate) indices: &'a [I],
    pub(crate) weights: &'a [i8],
}

#[inline(always)]
fn add<I: TableIndex>(sum: &mut [f32; 4], index: I, weight: i8, table: &[[f32; 4]]) {
    let (weight, entry) = (f32::from(weight), table[index.position()]);
    for channel in 0..4 {
        sum[channel] += weight * entry[channel];
    }
}

#[inline(always)]
fn list_sum<I: TableIndex>(indices: &[I], weights: &[i8], table: &[[f32; 4]]) -> [f32; 3] {
    let mut sums = [[0.0_f32; 4]; SUMS];
    let (whole_indices, last_indices) = indices.as_chunks::<SUMS>();
    let (whole_weights, last_weights) = weights.as_chunks::<SUMS>();
    for (indices, weights) in whole_indices.iter().zip(whole_weights) {
        for s in 0..SUMS {
            add(&mut sums[s], indices[s], weights[s], table);
        }
    }
    for (s, (&index, &weight)) in last_indices.iter().zip(last_weights).enumerate() {
        add(&mut sums[s], index, weight, table);
    }
    std::array::from_fn(|channel| {
        (sums[0][channel] + sums[1][channel]) + (sums[2][channel] + sums[3][channel])
    })
}

#[inline(always)]
fn sum_lists_body<I: TableIndex>(lists: Lists<I>, table: &[[f32; 4]], sums: &mut [[f32; 3]]) {
    for (list, sum) in sums.iter_mut().enumerate() {
        let range = lists.offsets[list] as usize..lists.offsets[list + 1] as usize;
        *sum = list_sum(&lists.indices[range.clone()], &lists.weights[range], table);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sum_lists_avx2<I: TableIndex>(lists: Lists<I>, table: &[[f32; 4]], sums: &mut [[f32; 3]]) {
    sum_lists_body(lists, table, sums);
}

/// Sum over the entries of each list of weight x table entry, per channel.
/// `lists.offsets` has one entry more than `sums`; the fourth channel of the
/// table is not read out.
pub(crate) fn sum_lists<I: TableIndex>(
    level: Level,
    lists: Lists<I>,
    table: &[[f32; 4]],
    sums: &mut [[f32; 3]],
) {
    match level.available() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => {
            // SAFETY: `available` returns this level only where the processor has AVX2.
            unsafe { sum_lists_avx2(lists, table, sums) }
        }
        _ => sum_lists_body(lists, table, sums),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::{hash3, uniform};

    /// Lists of 0 to 12 entries, so that every remainder is met.
    const LENGTHS: [u32; 7] = [0, 1, 2, 3, 4, 7, 12];
    const TABLE: u32 = 64;

    #[test]
    fn every_level_gives_the_bits_of_the_scalar_definition() {
        let mut offsets = vec![0];
        for length in LENGTHS {
            offsets.push(offsets[offsets.len() - 1] + length);
        }
        let count = offsets[LENGTHS.len()];
        let narrow: Vec<u16> = (0..count)
            .map(|i| (hash3(1, i, 0) % TABLE) as u16)
            .collect();
        let wide: Vec<u32> = narrow.iter().map(|&i| u32::from(i)).collect();
        let weights: Vec<i8> = (0..count).map(|i| hash3(2, i, 0) as i8).collect();
        let table: Vec<[f32; 4]> = (0..TABLE)
            .map(|i| [0, 1, 2, 3].map(|c| uniform(3, i, c) - 0.3))
            .collect();
        // The definition once more, entry by entry.
        let by_hand = |list: usize, channel: usize| {
            let mut sums = [0.0_f32; SUMS];
            for (place, entry) in (offsets[list]..offsets[list + 1]).enumerate() {
                let (index, weight) = (wide[entry as usize], weights[entry as usize]);
                sums[place % SUMS] += f32::from(weight) * table[index as usize][channel];
            }
            (sums[0] + sums[1]) + (sums[2] + sums[3])
        };
        for level in [Level::Scalar, Level::Sse2, Level::Avx2] {
            let (mut of_narrow, mut of_wide) = ([[9.0; 3]; 7], [[9.0; 3]; 7]);
            let (offsets, weights) = (offsets.as_slice(), weights.as_slice());
            let lists = Lists {
                offsets,
                indices: &narrow,
                weights,
            };
            sum_lists(level, lists, &table, &mut of_narrow);
            let lists = Lists {
                offsets,
                indices: &wide,
                weights,
            };
            sum_lists(level, lists, &table, &mut of_wide);
            for list in 0..LENGTHS.len() {
                let expected = [0, 1, 2].map(|channel| by_hand(list, channel));
                assert_eq!(of_narrow[list], expected, "{level:?}, list {list}");
                assert_eq!(of_wide[list], expected, "{level:?}, list {list}, wide");
            }
        }
    }
}
