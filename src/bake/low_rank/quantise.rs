//! From factors to bytes: which components and functions a partition keeps,
//! their steps, and the response to constant light.

use super::factor::{Factors, Matrix};
use crate::bake::compress::{near_answers, quantise};
use crate::bake::rows::{FINE_BAND, GroupRows};
use crate::bake::transfer::GROUP;

/// Bytes of a function in the list of eight components: its number and its
/// coefficients.
const FUNCTION_BYTES: f64 = 10.0;
/// What a function must bring, relative to what the last component of the scene
/// brings, each for its bytes. Error in per cent and bytes a vertex at 1, 2 and 4:
/// the window's room 3.57, 3.60, 3.66 and 111, 104, 98; at 4 the statues' hall,
/// whose partitions see five times as many functions, has 169 bytes.
pub(in crate::bake) const FUNCTION_THRESHOLD: f64 = 4.0;
/// Scaling a receiver's components by more is no correction any longer: then
/// the shortest change of its row makes up for what is missing.
const RESPONSE_RANGE: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Responses below this share of what is missing cannot carry it.
const NO_RESPONSE: f64 = 1e-3;

/// A partition's components: their V, and what constant light makes of them.
pub(in crate::bake) struct Components {
    pub(in crate::bake) groups: Vec<GroupRows>,
    /// Components of each group, eight but in the last.
    pub(in crate::bake) counts: Vec<u32>,
    /// y of constant light of 1.
    pub(in crate::bake) constant: Vec<f64>,
}

/// Quantises V of the first `rank` components: of every group of eight, the
/// functions that bring enough. `functions` names the columns, `constant` holds
/// d_k / sigma_k for every function of the basis.
pub(in crate::bake) fn components(
    factors: &Factors,
    functions: &[u32],
    rank: usize,
    energy_a_byte: f64,
    constant: &[f64],
) -> Components {
    let mut out = Components {
        groups: Vec::new(),
        counts: Vec::new(),
        constant: Vec::new(),
    };
    for first in (0..rank).step_by(GROUP) {
        let count = GROUP.min(rank - first);
        let threshold = energy_a_byte * FUNCTION_BYTES * FUNCTION_THRESHOLD;
        let group = component_group(&factors.right, functions, first..first + count, threshold);
        out.constant.extend(responses(&group, count, constant));
        out.groups.push(group);
        out.counts.push(count as u32);
    }
    out
}

/// What the components of a group make of light whose coefficients, in the units
/// of V, are these.
pub(in crate::bake) fn responses(group: &GroupRows, count: usize, light: &[f64]) -> Vec<f64> {
    let mut responses = [0.0_f64; GROUP];
    for (index, (&k, values)) in group.functions.iter().zip(&group.coefficients).enumerate() {
        let is_coarse = index < group.coarse as usize;
        let band = if is_coarse { 1.0 } else { f64::from(FINE_BAND) };
        for lane in 0..GROUP {
            responses[lane] += f64::from(values[lane]) / band * light[k as usize];
        }
    }
    let lanes = responses.iter().zip(group.basis_steps).take(count);
    lanes.map(|(sum, step)| sum * f64::from(step)).collect()
}

fn component_group(
    right: &Matrix,
    functions: &[u32],
    range: std::ops::Range<usize>,
    threshold: f64,
) -> GroupRows {
    let row = |column: usize| -> [f32; GROUP] {
        let mut lanes = [0.0; GROUP];
        for (lane, component) in range.clone().enumerate() {
            lanes[lane] = right.row(column)[component];
        }
        lanes
    };
    let energy = |lanes: &[f32; GROUP]| {
        lanes
            .iter()
            .fold(0.0, |sum, &v| sum + f64::from(v) * f64::from(v))
    };
    let kept: Vec<(u32, [f32; GROUP])> = functions
        .iter()
        .enumerate()
        .map(|(column, &k)| (k, row(column)))
        .filter(|(_, lanes)| energy(lanes) >= threshold && energy(lanes) > 0.0)
        .collect();
    in_two_bands(&kept)
}

/// Lists entries (their column, a value a lane) in eight bits, those that a
/// sixteenth of the steps suffices for behind the others.
pub(in crate::bake) fn in_two_bands(entries: &[(u32, [f32; GROUP])]) -> GroupRows {
    let steps = steps_of(entries.iter().map(|(_, lanes)| lanes));
    let mut rows = GroupRows {
        basis_steps: steps,
        ..GroupRows::default()
    };
    let is_fine = |lanes: &[f32; GROUP]| {
        (0..GROUP).all(|lane| lanes[lane].abs() * FINE_BAND <= 127.0 * steps[lane])
    };
    for (is_coarse, band) in [(true, 1.0), (false, FINE_BAND)] {
        for (column, lanes) in entries.iter().filter(|(_, l)| is_fine(l) != is_coarse) {
            rows.functions.push(*column);
            rows.coefficients.push(quantise(lanes, &steps, band));
        }
        if is_coarse {
            rows.coarse = rows.functions.len() as u32;
        }
    }
    rows
}

/// A 127th of the largest magnitude of each lane.
pub(in crate::bake) fn steps_of<'a>(
    entries: impl Iterator<Item = &'a [f32; GROUP]>,
) -> [f32; GROUP] {
    let mut steps = [0.0_f32; GROUP];
    for values in entries {
        for lane in 0..GROUP {
            let size = values[lane].abs() / 127.0;
            if size > steps[lane] {
                steps[lane] = size;
            }
        }
    }
    steps
}

/// U of a group of receivers: rows `first` on of the left factor, each divided
/// by the square root of its area, so that constant light arrives as `targets`
/// has it. `rows` holds the near field, whose sums are `near_sums`, if
/// it has one.
pub(super) fn spread(
    left: &Matrix,
    roots_of_area: &[f32],
    (first, count): (usize, usize),
    components: &Components,
    (targets, near_sums): (&[f64; GROUP], Option<&[f64; GROUP]>),
    rows: &mut GroupRows,
) {
    let rank = components.constant.len();
    let mut lanes = vec![[0.0_f32; GROUP]; rank];
    for lane in 0..count {
        let root = roots_of_area[first + lane];
        let row = left.row(first + lane)[..rank].iter().map(|u| u / root);
        let row = answering(row.collect(), &components.constant, targets[lane]);
        for (lanes, value) in lanes.iter_mut().zip(row) {
            lanes[lane] = value;
        }
    }
    let steps = steps_of(lanes.iter());
    let mut responses = [0.0_f64; GROUP];
    for (values, constant) in lanes.iter().zip(&components.constant) {
        let quantised = quantise(values, &steps, 1.0);
        for lane in 0..GROUP {
            responses[lane] += f64::from(quantised[lane]) * constant;
        }
        rows.coefficients.push(quantised);
    }
    rows.coarse = rank as u32;
    for lane in 0..GROUP {
        let (target, response) = (targets[lane], responses[lane]);
        if target <= 0.0 {
            continue;
        }
        let scale = target / response;
        if RESPONSE_RANGE.contains(&(scale / f64::from(steps[lane]))) {
            rows.basis_steps[lane] = scale as f32;
        } else if let Some(near_sums) = near_sums {
            near_answers(rows, lane, near_sums[lane], target);
        } else {
            rows.basis_steps[lane] = steps[lane];
        }
    }
}

/// A receiver's row, changed as little as possible so that its response to
/// constant light is about right: the last digits are left to the step.
fn answering(mut row: Vec<f32>, constant: &[f64], target: f64) -> Vec<f32> {
    if target <= 0.0 {
        row.fill(0.0);
        return row;
    }
    let terms = row.iter().zip(constant);
    let response: f64 = terms.map(|(&u, y)| f64::from(u) * y).sum();
    let squares: f64 = constant.iter().map(|y| y * y).sum();
    if !RESPONSE_RANGE.contains(&(target / response)) && squares.sqrt() > NO_RESPONSE * target {
        let factor = (target - response) / squares;
        for (u, y) in row.iter_mut().zip(constant) {
            *u += (factor * y) as f32;
        }
    }
    row
}
