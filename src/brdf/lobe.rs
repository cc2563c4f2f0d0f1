//! Tables of a lobe over the view's angle: directional albedo, and the 16
//! coefficients that light of the final bounce is multiplied by (paper,
//! equation 6).
//!
//! The lobe is fitted where light can come from, on the hemisphere, weighted by
//! the cosine: rho = (Q + eps I)^-1 q, Q_kl = Int_H h_k h_l cos dw,
//! q_k = Int_H f_s h_k cos dw, eps = 1e-3 tr(Q)/16. (The plain projection of f_s on
//! the sphere returns 0.982 for 0.929 of a constant environment at roughness 0.2,
//! and more than 1 at 0.4.)

use glam::Vec3;

use super::{Ggx, Parts};
use crate::maths::dense_solve::solve;
use crate::maths::functions::{cos_f32, sin_f32};
use crate::maths::order::Order;
use crate::maths::spherical_harmonics::{CONSTANT, Coefficients, HARMONICS, harmonics};

/// View angles of a table.
const ANGLES: usize = 64;
/// Directions drawn for an angle: facets by height, and by azimuth. 128 x 32 are
/// within 4e-4 of 512 x 128 in albedo at any roughness from 0.1 on, 64 x 24 within
/// 1e-3; the table takes some 10 ms.
const HEIGHTS: u32 = 128;
const AZIMUTHS: u32 = 32;
/// Share of the mean eigenvalue of Q that steadies the fit: harmonics are nearly
/// dependent on a hemisphere, and what no light from above could be in the slices
/// (rounding, other normals of a triangle's corners) is multiplied by up to 174, 69 and
/// 28 at 1e-4, 1e-3 and 1e-2 and a roughness of 0.2. A faceted ball in a white sky is
/// off by 12, 7 and 5 % at its outline then; a metal ball against paths (`scenes/glossy`,
/// means of 8 x 8 pixels) at a roughness of 0.8 by 2.3, 2.6 and 3.1 %, at 0.4 by 15.4,
/// 15.6 and 16.1 %.
const STEADYING: f64 = 1e-3;

/// A lobe of one roughness, tabulated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lobe {
    pub(crate) ggx: Ggx,
    roughness: f32,
    rows: Vec<Row>,
    /// Mean of the directional albedo over cosine-weighted viewers.
    pub(crate) mean_albedo: Parts,
}

/// At one view angle.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    albedo: Parts,
    /// What the specular colour multiplies, and what is white.
    coefficients: [Coefficients; 2],
}

impl Lobe {
    /// Makes the tables of a roughness of at least
    /// [`LEAST_ROUGHNESS`](super::LEAST_ROUGHNESS).
    pub(crate) fn of_roughness(roughness: f32) -> Self {
        let ggx = Ggx::of_roughness(roughness);
        let products = hemisphere_products();
        let rows: Vec<Row> = (0..ANGLES)
            .map(|index| Row::of(&ggx, cosine_of(index), &products))
            .collect();
        let mut lobe = Self {
            ggx,
            roughness,
            rows,
            mean_albedo: Parts::default(),
        };
        lobe.mean_albedo = lobe.mean();
        lobe
    }

    pub(crate) fn roughness(&self) -> f32 {
        self.roughness
    }

    /// Directional albedo E_s at a cosine of the viewer: the integral of f_s cos
    /// over the hemisphere.
    pub(crate) fn albedo(&self, cosine: f32) -> Parts {
        let (index, share) = place(cosine);
        let (a, b) = (&self.rows[index], &self.rows[index + 1]);
        a.albedo.mixed(b.albedo, share)
    }

    /// Coefficients of f_s in the frame of normal and viewer: those that the
    /// specular colour multiplies, and the white ones.
    pub(crate) fn coefficients(&self, cosine: f32) -> [Coefficients; 2] {
        let (index, share) = place(cosine);
        let (a, b) = (&self.rows[index], &self.rows[index + 1]);
        std::array::from_fn(|part| {
            let (a, b) = (&a.coefficients[part], &b.coefficients[part]);
            std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
        })
    }

    /// 2 Int E_s mu dmu by midpoints.
    fn mean(&self) -> Parts {
        const POINTS: u32 = 512;
        let mut sum = [0.0_f64; 2];
        for point in 0..POINTS {
            let cosine = (point as f32 + 0.5) / POINTS as f32;
            let albedo = self.albedo(cosine);
            sum[0] += f64::from(albedo.coloured * cosine);
            sum[1] += f64::from(albedo.white * cosine);
        }
        let [coloured, white] = sum.map(|sum| (2.0 * sum / f64::from(POINTS)) as f32);
        Parts { coloured, white }
    }
}

/// Cosine of the viewer of a row: denser near the horizon, where Fresnel's term
/// and masking bend.
fn cosine_of(index: usize) -> f32 {
    let root = index as f32 / (ANGLES - 1) as f32;
    (root * root).at_least(1e-4)
}

/// Between which rows a cosine lies, and where.
fn place(cosine: f32) -> (usize, f32) {
    let at = cosine.at_least(0.0).at_most(1.0).sqrt() * (ANGLES - 1) as f32;
    let index = (at as usize).min(ANGLES - 2);
    (index, at - index as f32)
}

impl Row {
    fn of(ggx: &Ggx, cosine: f32, products: &[[f64; HARMONICS]; HARMONICS]) -> Self {
        let count = f64::from(HEIGHTS * AZIMUTHS);
        let mut albedo = [0.0_f64; 2];
        let mut right_sides = [[0.0_f64; HARMONICS]; 2];
        for index in 0..HEIGHTS * AZIMUTHS {
            let u = [
                ((index / AZIMUTHS) as f32 + 0.5) / HEIGHTS as f32,
                ((index % AZIMUTHS) as f32 + 0.5) / AZIMUTHS as f32,
            ];
            let Some((light, parts)) = ggx.sample(cosine, u) else {
                continue;
            };
            let h = harmonics(light);
            for (part, value) in [parts.coloured, parts.white].into_iter().enumerate() {
                albedo[part] += f64::from(value) / count;
                for (slot, h) in right_sides[part].iter_mut().zip(h) {
                    *slot += f64::from(value * h) / count;
                }
            }
        }
        solve(*products, &mut right_sides);
        for (row, albedo) in right_sides.iter_mut().zip(albedo) {
            keep_constant_light(row, albedo, &products[0]);
        }
        Self {
            albedo: Parts {
                coloured: albedo[0] as f32,
                white: albedo[1] as f32,
            },
            coefficients: right_sides.map(|row| row.map(|value| value as f32)),
        }
    }
}

/// Scales a fit so that it returns the directional albedo of constant light, whose
/// coefficients are Q_0k / h_0: steadied, it returns up to 1.2 % less, of a sharp lobe
/// seen flatly.
fn keep_constant_light(row: &mut [f64; HARMONICS], albedo: f64, of_first: &[f64; HARMONICS]) {
    let mut light = *of_first;
    // Q_00 without what steadies it: the integral of h_0^2 cos.
    light[0] = 0.25;
    let returned: f64 = row.iter().zip(light).map(|(rho, g)| rho * g).sum();
    let scale = albedo * f64::from(CONSTANT) / returned;
    if scale.is_finite() {
        row.iter_mut().for_each(|rho| *rho *= scale);
    }
}

/// Q + eps I.
fn hemisphere_products() -> [[f64; HARMONICS]; HARMONICS] {
    const HEIGHTS: u32 = 128;
    const AZIMUTHS: u32 = 16;
    let weight = std::f64::consts::PI / f64::from(HEIGHTS * AZIMUTHS);
    let mut products = [[0.0; HARMONICS]; HARMONICS];
    for index in 0..HEIGHTS * AZIMUTHS {
        // Uniform in the square of the height: cosine-weighted.
        let u = ((index / AZIMUTHS) as f32 + 0.5) / HEIGHTS as f32;
        let angle = std::f32::consts::TAU * ((index % AZIMUTHS) as f32 + 0.5) / AZIMUTHS as f32;
        let radius = u.sqrt();
        let height = (1.0 - u).sqrt();
        let direction = Vec3::new(radius * cos_f32(angle), radius * sin_f32(angle), height);
        let h = harmonics(direction);
        for (row, a) in products.iter_mut().zip(h) {
            for (slot, b) in row.iter_mut().zip(h) {
                *slot += f64::from(a) * f64::from(b) * weight;
            }
        }
    }
    let trace: f64 = (0..HARMONICS).map(|k| products[k][k]).sum();
    for (k, row) in products.iter_mut().enumerate() {
        row[k] += STEADYING * trace / HARMONICS as f64;
    }
    products
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUGHNESSES: [f32; 6] = [0.05, 0.2, 0.4, 0.5, 0.7, 1.0];

    fn total(parts: Parts) -> f32 {
        parts.coloured + parts.white
    }

    /// Of a white lobe by many directions.
    fn albedo_by_many(ggx: &Ggx, cosine: f32) -> f32 {
        let (heights, azimuths) = (600, 200);
        let weight = |i: u32| {
            let u = [
                ((i / azimuths) as f32 + 0.5) / heights as f32,
                ((i % azimuths) as f32 + 0.5) / azimuths as f32,
            ];
            let sample = ggx.sample(cosine, u);
            sample.map_or(0.0, |(_, parts)| f64::from(total(parts)))
        };
        let sum: f64 = (0..heights * azimuths).map(weight).sum();
        (sum / f64::from(heights * azimuths)) as f32
    }

    #[test]
    fn a_furnace_gives_back_no_more_than_it_got() {
        for roughness in ROUGHNESSES {
            let lobe = Lobe::of_roughness(roughness);
            let albedos: Vec<f32> = (1..=100)
                .map(|k| total(lobe.albedo(k as f32 / 100.0)))
                .collect();
            assert!(albedos.iter().all(|&a| a > 0.0 && a <= 1.0), "{roughness}");
            if roughness <= 0.4 {
                let least = albedos.iter().fold(1.0_f32, |a, &b| a.at_most(b));
                assert!(least >= 0.85, "roughness {roughness}: {least}");
            }
        }
    }

    #[test]
    fn tables_hold_the_directional_albedo() {
        for roughness in ROUGHNESSES {
            let lobe = Lobe::of_roughness(roughness);
            for cosine in [0.03, 0.11, 0.35, 0.77, 1.0] {
                let (table, many) = (
                    total(lobe.albedo(cosine)),
                    albedo_by_many(&lobe.ggx, cosine),
                );
                assert!(
                    (table - many).abs() < 2e-3,
                    "roughness {roughness}, cosine {cosine}: {table} {many}"
                );
            }
        }
    }

    /// Light of radiance 1 from everywhere above: G_k = Int_H h_k cos dw.
    #[test]
    fn constant_light_returns_the_directional_albedo() {
        let products = hemisphere_products();
        let light: Coefficients = std::array::from_fn(|k| {
            let steadied = if k == 0 { STEADYING * 0.25 } else { 0.0 };
            ((products[0][k] - steadied) / f64::from(CONSTANT)) as f32
        });
        for roughness in ROUGHNESSES {
            let lobe = Lobe::of_roughness(roughness);
            for cosine in [0.1, 0.4, 0.7, 1.0] {
                let [coloured, white] = lobe.coefficients(cosine);
                let both = coloured.iter().zip(white);
                let returned: f32 = both.zip(light).map(|((a, b), g)| (a + b) * g).sum();
                let albedo = total(lobe.albedo(cosine));
                assert!(
                    (returned / albedo - 1.0).abs() < 0.01,
                    "roughness {roughness}, cosine {cosine}: {returned} {albedo}"
                );
            }
        }
    }

    #[test]
    fn a_grey_lobe_is_a_grey_sum_of_its_parts() {
        let lobe = Lobe::of_roughness(0.3);
        let white = lobe.albedo(0.6).of(Vec3::ONE).x;
        let dark = lobe.albedo(0.6).of(Vec3::splat(0.04)).x;
        assert!(dark > 0.04 * white && dark < 0.08 * white, "{dark} {white}");
    }
}
