//! Reads a latitude-longitude map, at points and over cones.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use crate::maths::functions::{atan2_f32, cos, cos_f32, sin_f32};
use crate::maths::order::Order;
use crate::texture::pyramid::{Level, coarser_levels};

/// Rows that a cone spans at most before a coarser level is read; at least half
/// as many are left. With 4 a lamp of one texel enters and leaves a cone in
/// steps of a quarter.
const ROWS: f32 = 6.0;
/// Texels of a row that are read before a coarser level serves it: near a pole
/// a cone goes all around.
const COLUMNS: f32 = 24.0;
/// Where in an octave of row heights (1..2) blending with the next level begins.
const BLEND_FROM: f32 = 1.6;

/// A map with its coarser copies.
#[derive(Debug, Clone)]
pub(super) struct Panorama {
    levels: Vec<Level>,
    /// Solid angle of a texel by level and row, sr.
    texel_solid_angles: Vec<Vec<f32>>,
}

/// Place of a direction in a map: u and v in 0..1.
pub(super) fn place_of(direction: Vec3) -> [f32; 2] {
    let turn = atan2_f32(direction.x, -direction.z) / TAU;
    let u = if turn < 0.0 { turn + 1.0 } else { turn };
    let across = (direction.x * direction.x + direction.z * direction.z).sqrt();
    // Near the poles the arc cosine of d.y would lose half the digits.
    [u, atan2_f32(across, direction.y) / PI]
}

/// Unit direction of a place.
pub(super) fn direction_of([u, v]: [f32; 2]) -> Vec3 {
    let [azimuth, polar] = [u * TAU, v * PI];
    let across = sin_f32(polar);
    Vec3::new(
        across * sin_f32(azimuth),
        cos_f32(polar),
        -across * cos_f32(azimuth),
    )
}

/// Share of the sphere's height between two rows (fractions too) of `height`:
/// times 2 pi their solid angle.
pub(super) fn strip_measure(from: f64, to: f64, height: usize) -> f64 {
    let angle = |row: f64| row / height as f64 * std::f64::consts::PI;
    cos(angle(from)) - cos(angle(to))
}

/// Solid angle (sr) of a texel by row.
pub(super) fn texel_solid_angles([width, height]: [usize; 2]) -> Vec<f32> {
    let row = |y: usize| strip_measure(y as f64, (y + 1) as f64, height);
    let turn = std::f64::consts::TAU / width as f64;
    (0..height).map(|y| (row(y) * turn) as f32).collect()
}

impl Panorama {
    pub(super) fn new(size: [usize; 2], texels: Vec<Vec3>) -> Self {
        let mut levels = coarser_levels(size, |i| texels[i], strip_measure);
        levels.insert(0, Level { size, texels });
        let texel_solid_angles = levels.iter().map(|l| texel_solid_angles(l.size)).collect();
        Self {
            levels,
            texel_solid_angles,
        }
    }

    /// Bytes of all levels.
    pub(super) fn bytes(&self) -> usize {
        self.levels.iter().map(Level::bytes).sum()
    }

    pub(super) fn size(&self) -> [usize; 2] {
        self.levels[0].size
    }

    pub(super) fn finest(&self) -> &[Vec3] {
        &self.levels[0].texels
    }

    /// The finest level of at most `width` columns.
    pub(super) fn level_within(&self, width: usize) -> &Level {
        let narrow = self.levels.iter().find(|level| level.size[0] <= width);
        narrow.unwrap_or(&self.levels[self.levels.len() - 1])
    }

    /// Mean over a cone `spread_rad` wide, as the rectangle of latitudes and
    /// longitudes that bounds it, by solid angle. Zero for a direction that is
    /// not finite.
    pub(super) fn mean(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        if !direction.is_finite() {
            return Vec3::ZERO;
        }
        let place = place_of(direction);
        let spread = if spread_rad > 0.0 {
            spread_rad.at_most(PI)
        } else {
            0.0
        };
        if spread == 0.0 {
            return self.level_mean(0, place, [0.0; 2]);
        }
        let height = spread / PI;
        let across = (direction.x * direction.x + direction.z * direction.z).sqrt();
        let width = if spread < TAU * across {
            spread / (TAU * across)
        } else {
            1.0
        };
        let (level, next_share) = self.level_for(height);
        let mean = self.level_mean(level, place, [width, height]);
        if next_share == 0.0 {
            return mean;
        }
        mean + (self.level_mean(level + 1, place, [width, height]) - mean) * next_share
    }

    /// The level at which `height` (share of the map's) spans at most [`ROWS`]
    /// rows, and the share of the next one.
    fn level_for(&self, height: f32) -> (usize, f32) {
        let rows = height * self.size()[1] as f32 / ROWS;
        let last = self.levels.len() - 1;
        if rows < 0.5 {
            return (0, 0.0);
        }
        let octave = (rows.to_bits() >> 23) as i32 - 127;
        let within = f32::from_bits(rows.to_bits() & 0x7f_ffff | 0x3f80_0000);
        let level = (octave + 1).max(0) as usize;
        if level >= last {
            return (last, 0.0);
        }
        let next_share = ((within - BLEND_FROM) / (2.0 - BLEND_FROM)).at_least(0.0);
        (level, next_share)
    }

    /// Mean of a level over a rectangle about a place, sizes as shares of the
    /// map's.
    fn level_mean(&self, level: usize, [u, v]: [f32; 2], [width, height]: [f32; 2]) -> Vec3 {
        let rows = self.levels[level].size[1];
        let from = (v - 0.5 * height).at_least(0.0) * rows as f32;
        let to = (v + 0.5 * height).at_most(1.0) * rows as f32;
        let solid_angles = &self.texel_solid_angles[level];
        let mut sum = Vec3::ZERO;
        let mut total = 0.0;
        visit_shares(from, to, |row, share| {
            let row = row.clamp(0, rows as i32 - 1) as usize;
            // A point is interpolated linearly; a mean goes by solid angle.
            let weight = if height > 0.0 {
                share * solid_angles[row]
            } else {
                share
            };
            sum += self.row_mean(level, row, u, width) * weight;
            total += weight;
        });
        sum / total
    }

    /// Mean of a level's row over `width` about u.
    fn row_mean(&self, level: usize, row: usize, u: f32, width: f32) -> Vec3 {
        let [columns, rows] = self.levels[level].size;
        if width * columns as f32 > COLUMNS && level + 1 < self.levels.len() {
            let coarser_rows = self.levels[level + 1].size[1];
            let place = (row as f32 + 0.5) * coarser_rows as f32 / rows as f32;
            return self.row_mean(level + 1, place as usize, u, width);
        }
        let texels = &self.levels[level].texels[row * columns..(row + 1) * columns];
        let half = 0.5 * width;
        let mut sum = Vec3::ZERO;
        let mut total = 0.0;
        visit_shares(
            (u - half) * columns as f32,
            (u + half) * columns as f32,
            |column, share| {
                sum += texels[column.rem_euclid(columns as i32) as usize] * share;
                total += share;
            },
        );
        sum / total
    }
}

/// Calls `visit(texel, weight)` for the texels, with centres at half numbers,
/// of the integral of a linear interpolation from one place to another; the
/// two weights of the interpolation itself where they are equal.
fn visit_shares(from: f32, to: f32, mut visit: impl FnMut(i32, f32)) {
    /// Below this width the difference of the integrals loses digits.
    const POINT: f32 = 1e-3;
    let first = (from - 0.5).floor();
    if to - from < POINT {
        let share = from - 0.5 - first;
        visit(first as i32, 1.0 - share);
        visit(first as i32 + 1, share);
        return;
    }
    let last = (to - 0.5).floor() + 1.0;
    let mut texel = first;
    while texel <= last {
        let center = texel + 0.5;
        visit(
            texel as i32,
            hat_integral(to - center) - hat_integral(from - center),
        );
        texel += 1.0;
    }
}

/// Integral of the hat function of width 2 and height 1 up to x.
fn hat_integral(x: f32) -> f32 {
    let x = x.clamp(-1.0, 1.0);
    if x < 0.0 {
        0.5 * (1.0 + x) * (1.0 + x)
    } else {
        1.0 - 0.5 * (1.0 - x) * (1.0 - x)
    }
}
