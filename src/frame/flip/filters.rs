//! The filters of LDR-FLIP as sums of separable ones: contrast sensitivity of
//! the eye (section 4.1.1) and detectors of edges and points (section 4.2).

use std::f64::consts::PI;

use crate::maths::functions::exp;

/// Parameters a and b of a Gaussian a sqrt(pi / b) exp(-pi² x² / b), x in
/// degrees: the contrast sensitivities of luminance and red-green need one,
/// that of blue-yellow two (table 1 of LDR-FLIP).
const LUMINANCE: [Gaussian; 1] = [Gaussian { a: 1.0, b: 0.0047 }];
const RED_GREEN: [Gaussian; 1] = [Gaussian { a: 1.0, b: 0.0053 }];
const BLUE_YELLOW: [Gaussian; 2] = [
    Gaussian { a: 34.1, b: 0.04 },
    Gaussian { a: 13.5, b: 0.025 },
];
/// The widest b: all sensitivity filters are cut at its third standard deviation.
const WIDEST_B: f64 = 0.04;
/// Width of the features that the eye finds best, degrees.
const FEATURE_WIDTH_DEG: f64 = 0.082;

struct Gaussian {
    a: f64,
    b: f64,
}

/// All filters for one size of pixels.
pub(super) struct Filters {
    /// For the three opponent channels, each with sum 1.
    pub(super) sensitivity: [Filter; 3],
    /// First derivatives of luminance along x and y; a step from 0 to 1 along a
    /// side gives 1.
    pub(super) edges: [Filter; 2],
    /// Second derivatives of luminance along x and y.
    pub(super) points: [Filter; 2],
}

/// A filter: the sum of its parts.
pub(super) struct Filter {
    pub(super) parts: Vec<Separable>,
}

/// Weights at -radius..=radius along y, then along x.
pub(super) struct Separable {
    pub(super) down: Vec<f64>,
    pub(super) across: Vec<f64>,
}

impl Filters {
    /// `pixels_per_degree` from 1 to 1000.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let sensitivity_radius = 3.0 * (WIDEST_B / (2.0 * PI * PI)).sqrt() * pixels_per_degree;
        let radius = sensitivity_radius.ceil() as i32;
        let sensitivity =
            |gaussians: &[Gaussian]| Filter::sensitivity(gaussians, radius, pixels_per_degree);
        let deviation = 0.5 * FEATURE_WIDTH_DEG * pixels_per_degree;
        let [smooth, first, second] = feature_kernels(deviation);
        Self {
            sensitivity: [
                sensitivity(&LUMINANCE),
                sensitivity(&RED_GREEN),
                sensitivity(&BLUE_YELLOW),
            ],
            edges: [
                Filter::product(&smooth, &first),
                Filter::product(&first, &smooth),
            ],
            points: [
                Filter::product(&smooth, &second),
                Filter::product(&second, &smooth),
            ],
        }
    }

    /// Farthest pixel along a side that has a say in another one's error.
    pub(super) fn radius(&self) -> usize {
        let all = self.sensitivity.iter().chain(&self.edges);
        all.chain(&self.points)
            .flat_map(|filter| &filter.parts)
            .map(|part| part.down.len().max(part.across.len()) / 2)
            .max()
            .unwrap_or(0)
    }
}

impl Filter {
    /// The Gaussians over a square of pixels, divided by their sum over it.
    fn sensitivity(gaussians: &[Gaussian], radius: i32, pixels_per_degree: f64) -> Self {
        // Each Gaussian as its kernel of unit sum and its sum over the square.
        let parts: Vec<(Vec<f64>, f64)> = gaussians
            .iter()
            .map(|gaussian| {
                let kernel = kernel(radius, |x| {
                    let degrees = x / pixels_per_degree;
                    exp(-PI * PI * degrees * degrees / gaussian.b)
                });
                let sum: f64 = kernel.iter().sum();
                let square = gaussian.a * (PI / gaussian.b).sqrt() * sum * sum;
                (scaled(&kernel, 1.0 / sum), square)
            })
            .collect();
        let total: f64 = parts.iter().map(|(_, square)| square).sum();
        Self {
            parts: parts
                .into_iter()
                .map(|(kernel, square)| Separable {
                    across: scaled(&kernel, square / total),
                    down: kernel,
                })
                .collect(),
        }
    }

    fn product(down: &[f64], across: &[f64]) -> Self {
        Self {
            parts: vec![Separable {
                down: down.to_vec(),
                across: across.to_vec(),
            }],
        }
    }
}

/// A Gaussian of unit sum and its first and second derivative, of which the
/// weights above 0 sum to 1 and those below to -1.
fn feature_kernels(deviation: f64) -> [Vec<f64>; 3] {
    let radius = (3.0 * deviation).ceil() as i32;
    let variance = deviation * deviation;
    let gaussian = |x: f64| exp(-x * x / (2.0 * variance));
    let smooth = kernel(radius, gaussian);
    let sum: f64 = smooth.iter().sum();
    let first = kernel(radius, |x| -x * gaussian(x));
    let second = kernel(radius, |x| (x * x / variance - 1.0) * gaussian(x));
    [
        scaled(&smooth, 1.0 / sum),
        with_unit_sides(&first),
        with_unit_sides(&second),
    ]
}

fn kernel(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

fn scaled(kernel: &[f64], factor: f64) -> Vec<f64> {
    kernel.iter().map(|weight| weight * factor).collect()
}

fn with_unit_sides(kernel: &[f64]) -> Vec<f64> {
    let above: f64 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let below: f64 = kernel.iter().filter(|weight| **weight < 0.0).sum();
    kernel
        .iter()
        .map(|&weight| weight / if weight > 0.0 { above } else { -below })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::PIXELS_PER_DEGREE;

    /// Rounding of a sum of some hundred weights.
    const ROUNDING: f64 = 1e-13;

    fn sum(filter: &Filter, keep: impl Fn(f64) -> bool) -> f64 {
        let mut sum = 0.0;
        for part in &filter.parts {
            for down in &part.down {
                let row = part.across.iter().map(|across| down * across);
                sum += row.filter(|weight| keep(*weight)).sum::<f64>();
            }
        }
        sum
    }

    #[test]
    fn filters_have_their_sums_for_every_size_of_pixels() {
        for pixels_per_degree in [1.0, 20.0, PIXELS_PER_DEGREE, 1000.0] {
            let filters = Filters::new(pixels_per_degree);
            for filter in &filters.sensitivity {
                assert!((sum(filter, |_| true) - 1.0).abs() < ROUNDING);
            }
            for filter in filters.edges.iter().chain(&filters.points) {
                assert!((sum(filter, |weight| weight > 0.0) - 1.0).abs() < ROUNDING);
                assert!((sum(filter, |weight| weight < 0.0) + 1.0).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn the_radius_is_three_deviations_of_the_widest() {
        assert_eq!(Filters::new(PIXELS_PER_DEGREE).radius(), 10);
    }
}
