//! Smaller copies of an image: every texel is the exact mean of the area that
//! it covers, for odd sizes too.

use crate::maths::order::Order;
use glam::Vec3;

/// One copy, row 0 on top.
#[derive(Debug, Clone)]
pub(super) struct Level {
    /// Width and height.
    pub(super) size: [usize; 2],
    pub(super) texels: Vec<Vec3>,
}

impl Level {
    /// Bytes of the texels.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.texels.as_slice())
    }
}

/// The texels of the next finer level that a coarse one covers along an axis,
/// with their shares.
type Shares = Vec<(usize, f32)>;

/// All coarser levels of an image of `size`, down to one texel; each side is
/// half the one before, rounded down. `row_measure(a, b, height)` says how much
/// the strip from row a to row b (fractions too) of `height` rows weighs.
pub(super) fn coarser_levels(
    size: [usize; 2],
    texel: impl Fn(usize) -> Vec3,
    row_measure: impl Fn(f64, f64, usize) -> f64,
) -> Vec<Level> {
    let mut levels = Vec::new();
    if size == [1, 1] {
        return levels;
    }
    levels.push(halved(size, texel, &row_measure));
    while let Some(last) = levels.last().filter(|last| last.size != [1, 1]) {
        let next = halved(last.size, |i| last.texels[i], &row_measure);
        levels.push(next);
    }
    levels
}

/// The measure of strips of a flat image.
pub(super) fn strip_area(from: f64, to: f64, _height: usize) -> f64 {
    to - from
}

fn halved(
    size: [usize; 2],
    texel: impl Fn(usize) -> Vec3,
    row_measure: &impl Fn(f64, f64, usize) -> f64,
) -> Level {
    let half = size.map(|n| (n / 2).max(1));
    let columns = shares(size[0], half[0], |a, b| b - a);
    let rows = shares(size[1], half[1], |a, b| row_measure(a, b, size[1]));
    let mut texels = Vec::with_capacity(half[0] * half[1]);
    for row in &rows {
        for column in &columns {
            let mut mean = Vec3::ZERO;
            for &(y, row_share) in row {
                for &(x, share) in column {
                    mean += texel(y * size[0] + x) * (row_share * share);
                }
            }
            texels.push(mean);
        }
    }
    Level { size: half, texels }
}

fn shares(fine: usize, coarse: usize, measure: impl Fn(f64, f64) -> f64) -> Vec<Shares> {
    let width = fine as f64 / coarse as f64;
    (0..coarse)
        .map(|i| {
            let (from, to) = (i as f64 * width, (i + 1) as f64 * width);
            let whole = measure(from, to);
            let last = (to.ceil() as usize).min(fine);
            (from as usize..last)
                .map(|x| {
                    let part = measure(from.at_least(x as f64), to.at_most((x + 1) as f64));
                    (x, (part / whole) as f32)
                })
                .filter(|&(_, share)| share > 0.0)
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of shares and sums in single precision.
    const ROUNDING: f32 = 1e-6;

    #[test]
    fn every_level_keeps_the_mean() {
        for size in [[8, 4], [7, 5], [13, 1], [1, 3]] {
            let value = |i: usize| Vec3::new((i * i % 7) as f32, i as f32, 1.0) / 40.0;
            let count = size[0] * size[1];
            let mean = (0..count).map(value).sum::<Vec3>() / count as f32;
            let levels = coarser_levels(size, value, strip_area);
            assert_eq!(levels.last().unwrap().size, [1, 1]);
            for level in levels {
                let got = level.texels.iter().sum::<Vec3>() / level.texels.len() as f32;
                assert!((got - mean).abs().max_element() < ROUNDING, "{size:?}");
            }
        }
    }

    #[test]
    fn odd_sizes_share_the_middle_texel() {
        let levels = coarser_levels([5, 1], |i| Vec3::splat(i as f32), strip_area);
        // Texels of 2.5: 0 1 2/2, and 2/2 3 4.
        let wanted = [(0.0 + 1.0 + 0.5 * 2.0) / 2.5, (0.5 * 2.0 + 3.0 + 4.0) / 2.5];
        assert_eq!(levels[0].size, [2, 1]);
        for (got, wanted) in levels[0].texels.iter().zip(wanted) {
            assert!((got.x - wanted).abs() < ROUNDING);
        }
    }
}
