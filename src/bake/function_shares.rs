//! How many basis functions each partition gets.

use crate::maths::order::Order;

/// Share of a part over that of the largest, at least: parts without one get
/// functions only when the others are full.
const SMALLEST_SHARE: f64 = 1e-12;

/// What parts get functions by: the root of what each hands on of light of 1 (the
/// sum of its vertices' masses) times its number of vertices.
///
/// Error of one bounce in per cent by area, by vertices, by what is handed on, and by
/// this root, under tuning lights: cornell 1.65, 1.60, 1.44, 1.40; window 4.00, 3.97,
/// 3.54, 3.46; sheet 2.37, 2.24, 1.97, 1.85; statues 4.53, 2.96, 3.52, 3.02. By area
/// alone small dense bodies have no functions to speak of (a spot on a statue was
/// 240 % wrong), and the outsides of walls have half of them.
pub(super) fn root_shares(handed_on: &[f64], sizes: &[usize]) -> Vec<f64> {
    let pairs = handed_on.iter().zip(sizes);
    pairs
        .map(|(handed_on, &size)| (handed_on * size as f64).sqrt())
        .collect()
}

/// Shares `total` functions among parts by `shares`: at least 1 a part, at most
/// its number of vertices in `sizes`; fractions go to the largest remainders, the
/// lowest part on ties.
///
/// The sum is `total` unless the bounds forbid it. Where all shares are 0, the
/// sizes decide.
pub(super) fn functions_by_share(shares: &[f64], sizes: &[usize], total: u32) -> Vec<u32> {
    assert_eq!(shares.len(), sizes.len(), "one share and one size a part");
    let largest = shares
        .iter()
        .fold(0.0_f64, |max, &share| max.at_least(share));
    let shares: Vec<f64> = if largest > 0.0 {
        shares
            .iter()
            .map(|&share| share.at_least(SMALLEST_SHARE * largest))
            .collect()
    } else {
        sizes.iter().map(|&size| size as f64).collect()
    };
    let quotas = bounded_quotas(&shares, sizes, f64::from(total));
    let mut counts: Vec<u32> = quotas.iter().map(|quota| quota.floor() as u32).collect();
    let mut by_remainder: Vec<usize> = (0..counts.len()).collect();
    let remainder = |part: usize| quotas[part] - quotas[part].floor();
    by_remainder.sort_by(|&a, &b| remainder(b).total_cmp(&remainder(a)).then(a.cmp(&b)));
    let mut left = i64::from(total) - counts.iter().map(|&count| i64::from(count)).sum::<i64>();
    for part in by_remainder {
        if left > 0 && (counts[part] as usize) < sizes[part] {
            counts[part] += 1;
            left -= 1;
        }
    }
    counts
}

/// Halvings of the range of scales: enough for quotas exact to rounding when
/// areas differ by 12 decimal places.
const BISECTIONS: u32 = 120;

/// Quotas proportional to `shares` but within 1..=size, with the sum `total`
/// if the bounds allow it.
fn bounded_quotas(shares: &[f64], sizes: &[usize], total: f64) -> Vec<f64> {
    let quota = |part: usize, scale: f64| (shares[part] * scale).clamp(1.0, sizes[part] as f64);
    let sum = |scale: f64| {
        (0..shares.len())
            .map(|part| quota(part, scale))
            .sum::<f64>()
    };
    // The sum grows with the scale up to where all parts are full.
    let fullest = (0..shares.len()).map(|part| sizes[part] as f64 / shares[part]);
    let (mut low, mut high) = (0.0, fullest.fold(0.0, f64::at_least));
    if sum(high) <= total {
        low = high;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if sum(middle) <= total {
            low = middle;
        } else {
            high = middle;
        }
    }
    (0..shares.len()).map(|part| quota(part, low)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_are_shared_out() {
        assert_eq!(functions_by_share(&[1.0, 3.0], &[50, 50], 20), [5, 15]);
        // Largest remainders, the lowest part on ties.
        assert_eq!(
            functions_by_share(&[1.0, 1.0, 1.0], &[9, 9, 9], 11),
            [4, 4, 3]
        );
        // At least one, at most the size; the others take what is left.
        assert_eq!(
            functions_by_share(&[0.0, 1e9, 1.0, 1.0], &[9, 4, 9, 9], 13),
            [1, 4, 4, 4]
        );
        assert_eq!(functions_by_share(&[0.0, 0.0], &[1, 3], 4), [1, 3]);
        assert_eq!(functions_by_share(&[1.0, 1.0], &[3, 3], 1), [1, 1]);
        assert_eq!(functions_by_share(&[1.0, 0.0], &[3, 3], 99), [3, 3]);
        assert!(functions_by_share(&[], &[], 7).is_empty());
    }

    #[test]
    fn no_function_is_lost_in_the_sharing() {
        let areas: Vec<f64> = (0..57)
            .map(|part| 0.01 + f64::from(part * part % 31))
            .collect();
        let sizes: Vec<usize> = (0..57).map(|part| 20 + part * 7 % 90).collect();
        for total in [57, 100, 1024, 2000] {
            assert_eq!(
                functions_by_share(&areas, &sizes, total)
                    .iter()
                    .sum::<u32>(),
                total
            );
        }
    }
}
