//! Rows projected on the basis, several lanes at a time.

use super::basis::Basis;

/// c_k = sum_j R_j S_jk for all functions of the partitions that send: these, in
/// the order of the senders, and the coefficients of their functions. `scratch` has
/// a place for every function, is zero and is left so.
pub(super) fn project<const LANES: usize>(
    basis: &Basis,
    rows: &[(u32, [f32; LANES])],
    scratch: &mut [[f32; LANES]],
) -> (Vec<u32>, Vec<[f32; LANES]>) {
    let mut parts: Vec<u32> = Vec::new();
    for (slot, weights) in rows {
        let (part, functions) = basis.row(*slot);
        if parts.last() != Some(&part) {
            parts.push(part);
        }
        let range = basis.function_range(part);
        for (coefficient, &s) in scratch[range].iter_mut().zip(functions) {
            for lane in 0..LANES {
                coefficient[lane] += weights[lane] * s;
            }
        }
    }
    let mut coefficients = Vec::new();
    for &part in &parts {
        let own = &mut scratch[basis.function_range(part)];
        coefficients.extend_from_slice(own);
        own.fill([0.0; LANES]);
    }
    (parts, coefficients)
}
