//! Directions by brightness.
//!
//! Texels are drawn by their brightness times solid angle, a row first and then
//! a column in it, and a direction uniformly inside the texel (Pharr, Jakob,
//! Humphreys, "Physically Based Rendering", 4th edition, 12.5). The brightness
//! of a texel is the mean of the bilinear interpolation over it, and a share of
//! the samples is uniform, so no direction with light has density 0.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::lookup::{Panorama, place_of, texel_solid_angles};
use crate::maths::functions::{cos, cos_f32, sin_f32};
use crate::maths::order::Order;

/// Share of the samples that is uniform over the sphere. It bounds what a dim
/// direction can weigh: 20 times its share. More is taken from the bright ones.
const UNIFORM_SHARE: f64 = 0.05;
/// Widest map that is drawn from as it is; wider ones by solid-angle means of
/// this width, which costs 24 MB and blurs a sun over 0.18 degrees at most.
const MAX_WIDTH: usize = 2048;

/// Tables of a map.
#[derive(Debug, Clone)]
pub(super) struct Distribution {
    size: [usize; 2],
    /// Probability of the rows up to and with each; the last is 1.
    rows: Vec<f64>,
    /// For each row, probability of its columns up to and with each.
    columns: Vec<f32>,
    /// Cosine of the polar angle at the upper edge of each row, and -1.
    cosines: Vec<f32>,
    solid_angles: Vec<f32>,
}

impl Distribution {
    pub(super) fn new(panorama: &Panorama) -> Self {
        let level = panorama.level_within(MAX_WIDTH);
        let [width, height] = level.size;
        let solid_angles = texel_solid_angles(level.size);
        let brightness = smoothed(level.size, &level.texels);
        let total: f64 = (0..width * height)
            .map(|i| brightness[i] * f64::from(solid_angles[i / width]))
            .sum();
        let (scale, uniform) = if total > 0.0 && total.is_finite() {
            ((1.0 - UNIFORM_SHARE) / total, UNIFORM_SHARE)
        } else {
            (0.0, 1.0)
        };
        let per_solid_angle = uniform / (4.0 * std::f64::consts::PI);
        let mut rows = Vec::with_capacity(height);
        let mut columns = Vec::with_capacity(width * height);
        let mut sum = 0.0;
        for (row, &solid_angle) in brightness.chunks_exact(width).zip(&solid_angles) {
            let mut within = 0.0;
            let mut sums = Vec::with_capacity(width);
            for &brightness in row {
                within += (brightness * scale + per_solid_angle) * f64::from(solid_angle);
                sums.push(within);
            }
            columns.extend(sums.iter().map(|part| (part / within) as f32));
            sum += within;
            rows.push(sum);
        }
        rows.iter_mut().for_each(|part| *part /= sum);
        let angle = |row: usize| row as f64 / height as f64 * std::f64::consts::PI;
        Self {
            size: level.size,
            rows,
            columns,
            cosines: (0..=height).map(|row| cos(angle(row)) as f32).collect(),
            solid_angles,
        }
    }

    fn row(&self, y: usize) -> &[f32] {
        &self.columns[y * self.size[0]..(y + 1) * self.size[0]]
    }

    /// Share of the samples in a row, and in a column of it.
    fn shares(&self, [x, y]: [usize; 2]) -> [f64; 2] {
        let before = if y == 0 { 0.0 } else { self.rows[y - 1] };
        let row = self.row(y);
        let left = if x == 0 { 0.0 } else { row[x - 1] };
        [self.rows[y] - before, f64::from(row[x] - left)]
    }

    fn texel_density(&self, texel: [usize; 2]) -> f32 {
        let [row, column] = self.shares(texel);
        (row * column / f64::from(self.solid_angles[texel[1]])) as f32
    }

    /// A direction and its density, 1/sr.
    pub(super) fn sample(&self, [across, down]: [f32; 2]) -> (Vec3, f32) {
        let [width, height] = self.size;
        let down = f64::from(down);
        let y = self
            .rows
            .partition_point(|&part| part <= down)
            .min(height - 1);
        let row = self.row(y);
        let x = row.partition_point(|&part| part <= across).min(width - 1);
        let [row_share, column_share] = self.shares([x, y]);
        let before = if y == 0 { 0.0 } else { self.rows[y - 1] };
        let left = if x == 0 { 0.0 } else { row[x - 1] };
        let down_within = ((down - before) / row_share).clamp(0.0, 1.0) as f32;
        let across_within = (f64::from(across - left) / column_share).clamp(0.0, 1.0) as f32;
        // Uniform in solid angle: uniform in the cosine.
        let upright = self.cosines[y] + (self.cosines[y + 1] - self.cosines[y]) * down_within;
        let azimuth = (x as f32 + across_within) / width as f32 * TAU;
        let radius = (1.0 - upright * upright).at_least(0.0).sqrt();
        let direction = Vec3::new(
            radius * sin_f32(azimuth),
            upright,
            -radius * cos_f32(azimuth),
        );
        (direction, self.texel_density([x, y]))
    }

    /// Density (1/sr) of a unit direction.
    pub(super) fn density(&self, direction: Vec3) -> f32 {
        if !direction.is_finite() {
            return 1.0 / (4.0 * PI);
        }
        let [u, v] = place_of(direction);
        let [width, height] = self.size;
        let x = ((u * width as f32) as usize).min(width - 1);
        let y = ((v * height as f32) as usize).min(height - 1);
        self.texel_density([x, y])
    }
}

/// Mean over each texel of the bilinear interpolation of the channels' mean:
/// 1/8, 6/8, 1/8 along each axis.
fn smoothed([width, height]: [usize; 2], texels: &[Vec3]) -> Vec<f64> {
    let gray = |x: usize, y: usize| f64::from(texels[y * width + x].element_sum()) / 3.0;
    let along_row = |x: usize, y: usize| {
        let [left, right] = [(x + width - 1) % width, (x + 1) % width];
        0.125 * (gray(left, y) + gray(right, y)) + 0.75 * gray(x, y)
    };
    (0..width * height)
        .map(|i| {
            let [x, y] = [i % width, i / width];
            let [above, below] = [y.saturating_sub(1), (y + 1).min(height - 1)];
            0.125 * (along_row(x, above) + along_row(x, below)) + 0.75 * along_row(x, y)
        })
        .collect()
}
