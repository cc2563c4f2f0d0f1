//! How strongly lights in general excite each basis function.

use super::basis::Basis;
use crate::simd::Level;

/// Sum over prior lights of the squared coefficient of each function.
pub(super) struct Excitation {
    squares: Vec<f64>,
}

impl Excitation {
    /// sigma_k is at least this share of the mean sigma.
    const FLOOR: f64 = 0.05;

    pub(super) fn new(basis: &Basis) -> Self {
        Self {
            squares: vec![0.0; basis.function_count()],
        }
    }

    /// For the functions of red, then those of green and of blue.
    pub(super) fn of_channels(basis: &Basis) -> Self {
        Self {
            squares: vec![0.0; 3 * basis.function_count()],
        }
    }

    /// Adds a light by its coefficients.
    pub(super) fn add_channels(&mut self, light: &[[f32; 3]]) {
        let of_channels = (0..3).flat_map(|channel| light.iter().map(move |b| b[channel]));
        for (square, c) in self.squares.iter_mut().zip(of_channels) {
            *square += f64::from(c) * f64::from(c);
        }
    }

    pub(super) fn add(&mut self, basis: &Basis, level: Level, brightness: &[f32]) {
        let in_slots: Vec<[f32; 3]> = basis
            .vertex_of_slot()
            .iter()
            .map(|&v| [brightness[v as usize], 0.0, 0.0])
            .collect();
        for (square, [c, ..]) in self
            .squares
            .iter_mut()
            .zip(basis.project_rgb(level, &in_slots))
        {
            *square += f64::from(c) * f64::from(c);
        }
    }

    /// sigma_k; where no light brings anything, all functions matter alike.
    pub(super) fn sigma(self, light_count: usize) -> Vec<f32> {
        if self.squares.iter().all(|&square| square == 0.0) {
            return vec![1.0; self.squares.len()];
        }
        let sigma: Vec<f64> = self
            .squares
            .iter()
            .map(|s| (s / light_count as f64).sqrt())
            .collect();
        let mean = sigma.iter().sum::<f64>() / sigma.len().max(1) as f64;
        sigma.into_iter().map(|s| if s < mean * Self::FLOOR { mean * Self::FLOOR } else { s } as f32).collect()
    }
}
