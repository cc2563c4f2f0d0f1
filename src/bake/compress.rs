//! From sampled transfer to sparse rows, as what a group sees of the sky is stored:
//! near field split off, projected on a basis, truncated by |c| sigma, quantised,
//! constant response kept. Other rows take some of these steps.

use super::basis::Basis;
use super::rows::{FINE_BAND, GroupRows};
use super::transfer::{GROUP, GroupTransfer};
use crate::maths::order::Order;

/// Share of a row's budget that goes to single cells of the sky: an eighth to a fifth
/// was best for sparse rows of the transfer, and a half worse than none.
const NEAR_SHARE: f64 = 0.2;
/// Scaling the basis part beyond these factors means that constants are
/// missing; they are kept first.
const RESPONSE_RANGE: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Remainders below this share of a row are as good as none.
pub(super) const EMPTY_REMAINDER: f64 = 1e-7;

/// How a row's budget is spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Budget {
    /// Entries of the near field a group.
    pub(super) near: usize,
    /// Basis coefficients a group in the mean.
    pub(super) basis: usize,
}

impl Budget {
    /// Splits `coefficients` entries a vertex.
    pub(super) fn of(coefficients: u32) -> Self {
        let near = (f64::from(coefficients) * NEAR_SHARE).round() as usize;
        Self {
            near,
            basis: coefficients as usize - near,
        }
    }
}

/// What compression knows of the basis.
pub(super) struct Compressor<'a> {
    pub(super) basis: &'a Basis,
    /// sigma_k: RMS over prior lights of the light's coefficient.
    pub(super) sigma: &'a [f32],
    /// d = S^T 1.
    pub(super) constant: &'a [f32],
    pub(super) budget: Budget,
}

/// One worker's memory: coefficients of a group, linear in the functions.
pub(super) struct Scratch {
    coefficients: Vec<[f32; GROUP]>,
    /// Parts that the current group receives from, ascending.
    parts: Vec<u32>,
}

impl Scratch {
    pub(super) fn new(basis: &Basis) -> Self {
        Self {
            coefficients: vec![[0.0; GROUP]; basis.function_count()],
            parts: Vec::new(),
        }
    }
}

/// A group whose near field has been taken out.
pub(super) struct Split {
    pub(super) near: Vec<(u32, [f32; GROUP])>,
    pub(super) remainder: Vec<(u32, [f32; GROUP])>,
    /// Noise of the remainder's entries, where the transfer says it.
    pub(super) remainder_noise: Vec<[f32; GROUP]>,
}

/// Near field: the senders with the largest sum over the group of T^2.
pub(super) fn near_split(transfer: &GroupTransfer, most: usize) -> Split {
    let squares = |(_, weights): &(u32, [f32; GROUP])| weights.iter().fold(0.0, |s, w| s + w * w);
    let scores: Vec<f32> = transfer.entries.iter().map(squares).collect();
    split(transfer, &largest(&scores, most))
}

/// Which are the `most` largest scores; the first of equal ones.
pub(super) fn largest(scores: &[f32], most: usize) -> Vec<bool> {
    let mut order: Vec<u32> = (0..scores.len() as u32).collect();
    let count = most.min(order.len());
    if count < order.len() && count > 0 {
        let score = |i: u32| scores[i as usize];
        let by_score = |a: &u32, b: &u32| score(*b).total_cmp(&score(*a)).then(a.cmp(b));
        order.select_nth_unstable_by(count, by_score);
    }
    let mut is_largest = vec![false; scores.len()];
    order[..count]
        .iter()
        .for_each(|&i| is_largest[i as usize] = true);
    is_largest
}

/// A group with the entries of some senders (ascending) taken out.
pub(super) fn split_senders(transfer: &GroupTransfer, senders: &[u32]) -> Split {
    let is_near = |(slot, _): &(u32, [f32; GROUP])| senders.binary_search(slot).is_ok();
    let is_near: Vec<bool> = transfer.entries.iter().map(is_near).collect();
    split(transfer, &is_near)
}

/// A group with some entries taken out.
pub(super) fn split(transfer: &GroupTransfer, is_near: &[bool]) -> Split {
    let pick = |wanted: bool| {
        let chosen = transfer
            .entries
            .iter()
            .zip(is_near)
            .filter(|&(_, &near)| near == wanted);
        chosen.map(|(&entry, _)| entry).collect::<Vec<_>>()
    };
    let far = transfer.noise.iter().zip(is_near);
    let remainder_noise = far.filter(|&(_, &near)| !near).map(|(&noise, _)| noise);
    Split {
        near: pick(true),
        remainder: pick(false),
        remainder_noise: remainder_noise.collect(),
    }
}

impl Compressor<'_> {
    /// Scores (sum over the group of (c sigma)^2) of all functions that a group
    /// receives from: what one threshold for the whole scene is chosen from.
    pub(super) fn scores(&self, transfer: &GroupTransfer, scratch: &mut Scratch) -> Vec<f32> {
        let split = near_split(transfer, self.budget.near);
        self.project(&split.remainder, scratch);
        let scores = self
            .touched(scratch)
            .map(|k| self.score(k, scratch))
            .filter(|&s| s > 0.0)
            .collect();
        self.clear(scratch);
        scores
    }

    /// The rows of a group under a threshold on the scores.
    pub(super) fn compress(
        &self,
        transfer: &GroupTransfer,
        threshold: f32,
        scratch: &mut Scratch,
    ) -> GroupRows {
        let split = near_split(transfer, self.budget.near);
        self.project(&split.remainder, scratch);
        let mut rows = GroupRows::default();
        let near_sums = quantise_near(&split.near, &mut rows);
        let mut target = transfer.arrived;
        for lane in 0..GROUP {
            target[lane] = (target[lane] - near_sums[lane]).at_least(0.0);
            if target[lane] < EMPTY_REMAINDER {
                target[lane] = 0.0;
            }
        }
        let mut kept: Vec<u32> = self
            .touched(scratch)
            .filter(|&k| self.score(k, scratch) >= threshold)
            .map(|k| k as u32)
            .collect();
        self.keep_constants(&target, &mut kept, scratch);
        self.quantise_basis(&target, &near_sums, &kept, scratch, &mut rows);
        self.clear(scratch);
        rows
    }

    /// c_ik = sum_j R_ij S_jk for all functions of the parts that send.
    fn project(&self, remainder: &[(u32, [f32; GROUP])], scratch: &mut Scratch) {
        for (slot, weights) in remainder {
            let (part, functions) = self.basis.row(*slot);
            if scratch.parts.last() != Some(&part) {
                scratch.parts.push(part);
            }
            let range = self.basis.function_range(part);
            for (coefficient, &s) in scratch.coefficients[range].iter_mut().zip(functions) {
                for lane in 0..GROUP {
                    coefficient[lane] += weights[lane] * s;
                }
            }
        }
    }

    /// Functions of the parts that send, ascending.
    fn touched<'s>(&'s self, scratch: &Scratch) -> impl Iterator<Item = usize> + use<'s> {
        scratch
            .parts
            .clone()
            .into_iter()
            .flat_map(|part| self.basis.function_range(part))
    }

    /// Sum over the group of (c sigma)^2.
    fn score(&self, k: usize, scratch: &Scratch) -> f32 {
        let squares = scratch.coefficients[k]
            .iter()
            .fold(0.0, |sum, c| sum + c * c);
        squares * self.sigma[k] * self.sigma[k]
    }

    fn clear(&self, scratch: &mut Scratch) {
        for part in std::mem::take(&mut scratch.parts) {
            scratch.coefficients[self.basis.function_range(part)].fill([0.0; GROUP]);
        }
    }

    /// Adds the functions with a constant share that miss most until no lane's
    /// basis part has to be scaled by more than [`RESPONSE_RANGE`].
    fn keep_constants(&self, target: &[f64; GROUP], kept: &mut Vec<u32>, scratch: &Scratch) {
        let response = |k: usize, lane: usize| {
            f64::from(scratch.coefficients[k][lane]) * f64::from(self.constant[k])
        };
        let mut sums = [0.0; GROUP];
        for &k in kept.iter() {
            for lane in 0..GROUP {
                sums[lane] += response(k as usize, lane);
            }
        }
        let fits = |sums: &[f64; GROUP]| {
            (0..GROUP).all(|lane| {
                target[lane] == 0.0 || RESPONSE_RANGE.contains(&(target[lane] / sums[lane]))
            })
        };
        if fits(&sums) {
            return;
        }
        let mut missing: Vec<(f64, u32)> = self
            .touched(scratch)
            .filter(|&k| self.constant[k] != 0.0 && kept.binary_search(&(k as u32)).is_err())
            .map(|k| {
                (
                    (0..GROUP).map(|lane| response(k, lane).abs()).sum(),
                    k as u32,
                )
            })
            .filter(|&(share, _): &(f64, u32)| share > 0.0)
            .collect();
        missing.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, k) in missing {
            kept.push(k);
            for lane in 0..GROUP {
                sums[lane] += response(k as usize, lane);
            }
            if fits(&sums) {
                break;
            }
        }
        kept.sort_unstable();
    }

    /// i8 coefficients in two bands, steps scaled so that the quantised row
    /// answers constant light as the sampled row does.
    fn quantise_basis(
        &self,
        target: &[f64; GROUP],
        near_sums: &[f64; GROUP],
        kept: &[u32],
        scratch: &Scratch,
        rows: &mut GroupRows,
    ) {
        let mut steps = [0.0_f32; GROUP];
        for &k in kept {
            for lane in 0..GROUP {
                let size = scratch.coefficients[k as usize][lane].abs() / 127.0;
                if size > steps[lane] {
                    steps[lane] = size;
                }
            }
        }
        let is_fine = |k: u32| {
            let c = &scratch.coefficients[k as usize];
            (0..GROUP).all(|lane| c[lane].abs() * FINE_BAND <= 127.0 * steps[lane])
        };
        let (coarse, fine): (Vec<u32>, Vec<u32>) = kept.iter().partition(|&&k| !is_fine(k));
        let mut responses = [0.0_f64; GROUP];
        for (list, band) in [(&coarse, 1.0), (&fine, FINE_BAND)] {
            for &k in list {
                let quantised = quantise(&scratch.coefficients[k as usize], &steps, band);
                if quantised == [0; GROUP] {
                    continue;
                }
                for lane in 0..GROUP {
                    let share = f64::from(quantised[lane]) / f64::from(band);
                    responses[lane] += share * f64::from(self.constant[k as usize]);
                }
                rows.functions.push(k);
                rows.coefficients.push(quantised);
            }
            if band == 1.0 {
                rows.coarse = rows.functions.len() as u32;
            }
        }
        for lane in 0..GROUP {
            if target[lane] > 0.0 && responses[lane] <= 0.0 {
                // Its constants were quantised away beside larger entries.
                near_answers(rows, lane, near_sums[lane], target[lane]);
            } else if target[lane] > 0.0 {
                rows.basis_steps[lane] = (target[lane] / responses[lane]) as f32;
            }
        }
    }
}

/// Lets the near field of a lane, whose sum is `near`, answer constant light for
/// what else should.
pub(super) fn near_answers(rows: &mut GroupRows, lane: usize, near: f64, missing: f64) {
    if near > 0.0 {
        rows.near_steps[lane] *= ((near + missing) / near) as f32;
    }
}

pub(super) fn quantise(values: &[f32; GROUP], steps: &[f32; GROUP], band: f32) -> [i8; GROUP] {
    let mut out = [0; GROUP];
    for lane in 0..GROUP {
        if steps[lane] > 0.0 {
            out[lane] = (values[lane] / steps[lane] * band)
                .round()
                .clamp(-127.0, 127.0) as i8;
        }
    }
    out
}

/// u8 weights with a step a receiver, scaled so that the sum is kept; returns
/// the sums.
pub(super) fn quantise_near(near: &[(u32, [f32; GROUP])], rows: &mut GroupRows) -> [f64; GROUP] {
    let mut largest = [0.0_f32; GROUP];
    let mut sums = [0.0_f64; GROUP];
    for (_, weights) in near {
        for lane in 0..GROUP {
            sums[lane] += f64::from(weights[lane]);
            if weights[lane] > largest[lane] {
                largest[lane] = weights[lane];
            }
        }
    }
    let mut quantised_sums = [0.0_f64; GROUP];
    for (slot, weights) in near {
        let mut quantised = [0_u8; GROUP];
        for lane in 0..GROUP {
            if largest[lane] > 0.0 {
                quantised[lane] = (weights[lane] / largest[lane] * 255.0).round() as u8;
            }
            quantised_sums[lane] += f64::from(quantised[lane]);
        }
        rows.near.push(*slot);
        rows.near_weights.push(quantised);
    }
    for lane in 0..GROUP {
        if quantised_sums[lane] > 0.0 {
            rows.near_steps[lane] = (sums[lane] / quantised_sums[lane]) as f32;
        }
    }
    sums
}
