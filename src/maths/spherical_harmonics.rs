//! Real spherical harmonics of degree 0 to 3, orthonormal on the sphere.
//!
//! Number k = l (l + 1) + m has degree l and order m. As polynomials of a unit
//! vector they need no angle (Sloan, "Stupid Spherical Harmonics Tricks", 2008,
//! appendix A2).

use std::sync::LazyLock;

use glam::Vec3;

use super::dense_solve::inverse;

/// Harmonics of degree 0 to 3.
pub(crate) const HARMONICS: usize = 16;

/// Coefficients of a function on the sphere.
pub(crate) type Coefficients = [f32; HARMONICS];

/// h_0 = 1 / (2 sqrt(pi)), the constant one.
pub(crate) const CONSTANT: f32 = 0.282_094_8;

/// All harmonics at a unit vector.
#[rustfmt::skip]
pub(crate) fn harmonics(direction: Vec3) -> Coefficients {
    let Vec3 { x, y, z } = direction;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        CONSTANT,
        0.488_602_5 * y,
        0.488_602_5 * z,
        0.488_602_5 * x,
        1.092_548_5 * (x * y),
        1.092_548_5 * (y * z),
        0.315_391_56 * (3.0 * zz - 1.0),
        1.092_548_5 * (x * z),
        0.546_274_24 * (xx - yy),
        0.590_043_6 * (y * (3.0 * xx - yy)),
        2.890_611_4 * (x * y * z),
        0.457_045_8 * (y * (5.0 * zz - 1.0)),
        0.373_176_33 * (z * (5.0 * zz - 3.0)),
        0.457_045_8 * (x * (5.0 * zz - 1.0)),
        1.445_305_7 * (z * (xx - yy)),
        0.590_043_6 * (x * (xx - 3.0 * yy)),
    ]
}

/// A function of a degree l is known by its values in 2 l + 1 directions. The
/// first three, five and seven of these do, not normalised: the matrices of the
/// harmonics there have condition numbers of at most 2.9 (the best of 200,000
/// random sets of seven; the median is about 30).
const DIRECTIONS: [Vec3; 7] = [
    Vec3::new(0.5, 0.6, 0.6),
    Vec3::new(0.5, -0.5, 0.7),
    Vec3::new(-0.8, 0.6, 0.1),
    Vec3::new(0.1, 0.9, -0.5),
    Vec3::new(1.0, -0.1, 0.3),
    Vec3::new(0.6, -0.4, -0.7),
    Vec3::new(0.7, 0.7, 0.0),
];

/// What turns values in [`DIRECTIONS`] into coefficients, a matrix a degree.
struct FromValues {
    directions: [Vec3; 7],
    degree1: [[f32; 3]; 3],
    degree2: [[f32; 5]; 5],
    degree3: [[f32; 7]; 7],
}

static FROM_VALUES: LazyLock<FromValues> = LazyLock::new(|| {
    let directions = DIRECTIONS.map(Vec3::normalize);
    FromValues {
        directions,
        degree1: from_values(&directions, 1),
        degree2: from_values(&directions, 4),
        degree3: from_values(&directions, 9),
    }
});

/// Inverse of the `N` harmonics from number `first` on in the first `N` directions.
fn from_values<const N: usize>(directions: &[Vec3; 7], first: usize) -> [[f32; N]; N] {
    let at = |i: usize, k: usize| f64::from(harmonics(directions[i])[first + k]);
    let matrix = std::array::from_fn(|i| std::array::from_fn(|k| at(i, k)));
    inverse(matrix).map(|row| row.map(|value| value as f32))
}

/// Coefficients in the world of a function that is given in the frame with the
/// axes `x`, `y`, `z`, orthonormal unit vectors of the world: the block rotation
/// of degrees 0 to 3, by the function's values in a few directions of the world.
pub(crate) fn world_from_frame(function: &Coefficients, [x, y, z]: [Vec3; 3]) -> Coefficients {
    let table = &*FROM_VALUES;
    let mut values = [[0.0_f32; 7]; 3];
    for (i, &direction) in table.directions.iter().enumerate() {
        let in_frame = Vec3::new(direction.dot(x), direction.dot(y), direction.dot(z));
        let h = harmonics(in_frame);
        for (degree, range) in [1..4, 4..9, 9..16].into_iter().enumerate() {
            values[degree][i] = range.map(|k| function[k] * h[k]).sum();
        }
    }
    let mut world = [0.0; HARMONICS];
    world[0] = function[0];
    multiply(&table.degree1, &values[0], &mut world[1..4]);
    multiply(&table.degree2, &values[1], &mut world[4..9]);
    multiply(&table.degree3, &values[2], &mut world[9..16]);
    world
}

fn multiply<const N: usize>(matrix: &[[f32; N]; N], values: &[f32; 7], out: &mut [f32]) {
    for (slot, row) in out.iter_mut().zip(matrix) {
        *slot = row.iter().zip(values).map(|(m, value)| m * value).sum();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::uniform;
    use crate::maths::sampling::{sphere_direction, tangents};

    /// 512 x 16 midpoints: exact for these polynomials to 1e-4.
    fn sphere() -> impl Iterator<Item = (Vec3, f64)> {
        let (rows, columns) = (512, 16);
        let weight = 4.0 * std::f64::consts::PI / f64::from(rows * columns);
        (0..rows * columns).map(move |i| {
            let u = [(i / columns) as f32 + 0.5, (i % columns) as f32 + 0.5];
            let direction = sphere_direction([u[0] / rows as f32, u[1] / columns as f32]);
            (direction, weight)
        })
    }

    #[test]
    fn harmonics_are_orthonormal() {
        let mut products = [[0.0_f64; HARMONICS]; HARMONICS];
        for (direction, weight) in sphere() {
            let h = harmonics(direction);
            for (row, a) in products.iter_mut().zip(h) {
                for (slot, b) in row.iter_mut().zip(h) {
                    *slot += f64::from(a * b) * weight;
                }
            }
        }
        for (i, row) in products.iter().enumerate() {
            for (k, value) in row.iter().enumerate() {
                let wanted = f64::from(u8::from(i == k));
                assert!((value - wanted).abs() < 2e-4, "{i}, {k}: {value}");
            }
        }
    }

    #[test]
    fn a_turned_function_has_its_values_at_turned_directions() {
        for seed in 0..100 {
            let u = |k: u32| uniform(seed, k, 1);
            let function: Coefficients = std::array::from_fn(|k| u(k as u32) - 0.5);
            let z = sphere_direction([u(20), u(21)]);
            let (x, y) = tangents(z);
            let world = world_from_frame(&function, [x, y, z]);
            let direction = sphere_direction([u(22), u(23)]);
            let in_frame = Vec3::new(direction.dot(x), direction.dot(y), direction.dot(z));
            let value = |c: &Coefficients, d: Vec3| -> f32 {
                c.iter().zip(harmonics(d)).map(|(c, h)| c * h).sum()
            };
            let (here, there) = (value(&function, in_frame), value(&world, direction));
            assert!((here - there).abs() < 5e-6, "seed {seed}: {here} {there}");
        }
    }
}
