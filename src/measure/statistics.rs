//! Errors of fields over vertices, and statistics over lights.

use crate::bake::{LightErrors, VertexFields, relative_error};
use crate::maths::functions::{exp, ln};

/// Error of each light, relative: root mean square over the area, and of the
/// light's sum; `None` for a light that does not arrive.
pub(super) type ByLight = Vec<Option<[f64; 2]>>;

/// Area-weighted relative errors of an estimate, field by field.
pub(super) fn errors(areas: &[f64], truth: &VertexFields, estimate: &VertexFields) -> ByLight {
    assert_eq!(truth.width, estimate.width, "fields of the same lights");
    (0..truth.width)
        .map(|light| {
            let values = areas.iter().zip(truth.rows()).zip(estimate.rows());
            relative_error(values.map(|((area, right), found)| (*area, right[light], found[light])))
        })
        .collect()
}

/// Errors without the truth's own noise, which is independent of them.
pub(super) fn without_noise(errors: ByLight, noise: &ByLight) -> ByLight {
    let pairs = errors.into_iter().zip(noise);
    pairs
        .map(|(error, noise)| {
            let ([error, signed], [noise, _]) = (error?, (*noise)?);
            Some([root_of_difference(error, noise), signed])
        })
        .collect()
}

/// sqrt(a^2 - b^2), 0 where b is larger.
pub(super) fn root_of_difference(a: f64, b: f64) -> f64 {
    let squared = a * a - b * b;
    if squared > 0.0 { squared.sqrt() } else { 0.0 }
}

/// Statistics over the lights that `counts` chooses.
pub(super) fn over_lights(errors: &ByLight, counts: impl Fn(usize) -> bool) -> LightErrors {
    let chosen: Vec<_> = (0..errors.len())
        .map(|light| errors[light].filter(|_| counts(light)))
        .collect();
    LightErrors::of(&chosen)
}

/// Standard error of the mean over the lights that arrive, if they were chosen at random:
/// test lights are spread evenly, so theirs is less. `None` of fewer than two.
pub(super) fn standard_error(errors: &ByLight) -> Option<f64> {
    let found: Vec<f64> = errors.iter().flatten().map(|e| e[0]).collect();
    let count = found.len() as f64;
    if found.len() < 2 {
        return None;
    }
    let mean = found.iter().sum::<f64>() / count;
    let squares: f64 = found.iter().map(|e| (e - mean) * (e - mean)).sum();
    Some((squares / (count * (count - 1.0))).sqrt())
}

/// The value of a curve at `x` between its points, straight in logarithms;
/// `None` outside of them.
pub(super) fn between(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.windows(2).find_map(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let is_usable = x0 > 0.0 && x1 > x0 && y0 > 0.0 && y1 > 0.0;
        (is_usable && (x0..=x1).contains(&x)).then(|| {
            let share = (ln(x) - ln(x0)) / (ln(x1) - ln(x0));
            exp(ln(y0) + share * (ln(y1) - ln(y0)))
        })
    })
}

/// The middle of some values; `NaN` of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[count / 2],
        count => 0.5 * (values[count / 2 - 1] + values[count / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a few operations in double precision.
    const ROUNDING: f64 = 1e-12;

    fn field(values: &[f32]) -> VertexFields {
        VertexFields::of_columns(&[values.to_vec()])
    }

    #[test]
    fn errors_are_weighted_by_area_and_relative() {
        let areas = [1.0, 4.0];
        let found = errors(&areas, &field(&[2.0, 1.0]), &field(&[2.0, 1.5]));
        let [error, signed] = found[0].unwrap();
        assert!((error - (1.0_f64 / 8.0).sqrt()).abs() < ROUNDING, "{error}");
        assert!((signed - 2.0 / 6.0).abs() < ROUNDING, "{signed}");
        let dark = errors(&areas, &field(&[0.0, 0.0]), &field(&[1.0, 0.0]));
        assert_eq!(dark, [None], "no error relative to nothing");
    }

    #[test]
    fn noise_is_taken_off_in_quadrature() {
        let errors = vec![Some([5.0, 0.1]), Some([1.0, 0.2]), None];
        let noise = vec![Some([3.0, 0.0]), Some([2.0, 0.0]), None];
        let left = without_noise(errors, &noise);
        assert_eq!(left, [Some([4.0, 0.1]), Some([0.0, 0.2]), None]);
    }

    #[test]
    fn lights_are_chosen_by_number() {
        let errors: ByLight = (0..32).map(|i| Some([f64::from(i), 0.5])).collect();
        let all = over_lights(&errors, |_| true);
        assert_eq!(
            (all.mean, all.p95, all.worst, all.signed),
            (15.5, 30.0, 31.0, 0.5)
        );
        let two = over_lights(&errors, |light| light < 2);
        assert_eq!((two.mean, two.worst), (0.5, 1.0));
    }

    #[test]
    fn a_mean_of_more_lights_is_surer() {
        let of = |values: &[f64]| -> ByLight { values.iter().map(|&e| Some([e, 0.0])).collect() };
        // Variance 2 of two values, over two.
        let found = standard_error(&of(&[1.0, 3.0])).unwrap();
        assert!((found - 1.0).abs() < ROUNDING, "{found}");
        // Variance 4 / 3 of four, over four; a light that does not arrive is no value.
        let mut four = of(&[1.0, 3.0, 1.0, 3.0]);
        four.push(None);
        let found = standard_error(&four).unwrap();
        assert!((found - (1.0_f64 / 3.0).sqrt()).abs() < ROUNDING, "{found}");
        assert_eq!(standard_error(&of(&[1.0])), None);
    }

    #[test]
    fn curves_are_straight_in_logarithms_and_end() {
        let power = [(400.0, 4.0), (100.0, 8.0), (25.0, 16.0)];
        let value = between(&power, 50.0).unwrap();
        assert!((value - 8.0 * 2.0_f64.sqrt()).abs() < 1e-9, "{value}");
        assert_eq!(between(&power, 20.0), None);
        assert_eq!(between(&power, 500.0), None);
    }

    #[test]
    fn the_median_lies_in_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }
}
