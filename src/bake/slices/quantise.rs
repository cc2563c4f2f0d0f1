//! Slices in eight bits, so that constant light still arrives as it should.

use super::GROUPS_A_VERTEX;
use crate::bake::compress::quantise;
use crate::bake::low_rank::{in_two_bands, steps_of};
use crate::bake::rows::{FINE_BAND, GroupRows};
use crate::bake::transfer::GROUP;
use crate::maths::spherical_harmonics::{Coefficients, HARMONICS};

/// Square of the sine between what the components make of two lights, below which
/// a row cannot answer both.
const LEAST_ANGLE: f64 = 1e-6;

/// Changes a row as little as possible so that it answers two lights as it should:
/// the shortest change lies in the plane of what the components make of the two.
pub(super) fn answering(row: &mut [f32], answers: &[Vec<f64>; 2], targets: [f64; 2]) {
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let [a, b] = answers;
    let (aa, ab, bb) = (product(a, a), product(a, b), product(b, b));
    let now: Vec<f64> = row.iter().map(|&u| f64::from(u)).collect();
    let missing = [targets[0] - product(&now, a), targets[1] - product(&now, b)];
    let determinant = aa * bb - ab * ab;
    let [of_a, of_b] = if determinant > LEAST_ANGLE * aa * bb {
        [
            (missing[0] * bb - missing[1] * ab) / determinant,
            (missing[1] * aa - missing[0] * ab) / determinant,
        ]
    } else if aa > 0.0 {
        [missing[0] / aa, 0.0]
    } else {
        return;
    };
    for (u, (a, b)) in row.iter_mut().zip(a.iter().zip(b)) {
        *u += (of_a * a + of_b * b) as f32;
    }
}

/// Entries in eight bits, with a step a lane; the last ones, as many as it suffices
/// for, with a sixteenth of it.
///
/// What rounding an entry does to constant light, `constant` of each component, is
/// made up for by the next ones: a sharp lobe multiplies errors of slices that no
/// light from above could have by a hundred (16 harmonics are nearly dependent on a
/// hemisphere), and constant light would come back 2.4 % wrong at a roughness of 0.2.
pub(super) fn quantised_run(lanes: &[[f32; GROUP]], constant: &[f64]) -> GroupRows {
    let steps = steps_of(lanes.iter());
    let is_coarse = |lanes: &[f32; GROUP]| {
        (0..GROUP).any(|lane| lanes[lane].abs() * FINE_BAND > 127.0 * steps[lane])
    };
    let coarse = lanes.iter().rposition(is_coarse).map_or(0, |last| last + 1);
    let mut rows = GroupRows {
        coarse: coarse as u32,
        basis_steps: steps,
        ..GroupRows::default()
    };
    let mut owed = [0.0_f64; GROUP];
    for (index, (values, &answer)) in lanes.iter().zip(constant).enumerate() {
        let band = if index < coarse { 1.0 } else { FINE_BAND };
        let mut wanted = *values;
        for lane in 0..GROUP {
            let more = (owed[lane] / answer) as f32;
            // More than a step would spoil the entry itself.
            if more.abs() <= steps[lane] / band {
                wanted[lane] += more;
            }
        }
        let quantised = quantise(&wanted, &steps, band);
        for lane in 0..GROUP {
            let made = f64::from(quantised[lane]) * f64::from(steps[lane] / band);
            owed[lane] += (f64::from(values[lane]) - made) * answer;
        }
        rows.coefficients.push(quantised);
    }
    rows
}

/// The near field's weights in eight bits; what they bring of constant light is
/// taken off the targets.
pub(super) fn quantised_near(
    near: &[(u32, Coefficients)],
    targets: &mut [f64; HARMONICS],
) -> [GroupRows; GROUPS_A_VERTEX] {
    std::array::from_fn(|half| {
        let first = half * GROUP;
        let lanes = |weights: &Coefficients| std::array::from_fn(|lane| weights[first + lane]);
        let entries: Vec<_> = near
            .iter()
            .map(|(s, weights)| (*s, lanes(weights)))
            .collect();
        let rows = in_two_bands(&entries);
        for (index, values) in rows.coefficients.iter().enumerate() {
            let is_coarse = index < rows.coarse as usize;
            let band = if is_coarse { 1.0 } else { FINE_BAND };
            for lane in 0..GROUP {
                let step = f64::from(rows.basis_steps[lane] / band);
                targets[first + lane] -= f64::from(values[lane]) * step;
            }
        }
        rows
    })
}
