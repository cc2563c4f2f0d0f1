//! Whether the finished operator T~ keeps energy: how strongly light can grow
//! from bounce to bounce, and how much of what leaves arrives.

use super::places::Places;
use super::{Bake, prior};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::simd::Level;
use crate::surface::{Surface, direct};

/// Steps of the power iteration (decision 6 of the design). In a closed room
/// constant light has the eigenvalue 1 and other fields decay by a third or
/// more a step; in an open one the start is forgotten after some ten.
const POWER_STEPS: u32 = 200;
/// The growth is the mean over so many of the last steps, so that a pair of
/// conjugate eigenvalues does not make it swing.
const MEASURED_STEPS: u32 = 100;
/// Seed of the start fields.
const SEED: u32 = 0xe16e;

/// The largest absolute eigenvalue of T~, by power iteration from constant
/// light and from two fields of noise at once.
pub(super) fn largest_eigenvalue(bake: &Bake, level: Level) -> f64 {
    let noise = |slot: u32, channel| uniform(SEED, slot, channel) - 0.5;
    let mut field: Vec<[f32; 3]> = (0..bake.basis().slot_count() as u32)
        .map(|slot| [1.0, noise(slot, 1), noise(slot, 2)])
        .collect();
    normalise(&mut field);
    let mut growth_of_logarithm = [0.0; 3];
    for step in 0..POWER_STEPS {
        field = bake.apply(level, &field);
        let norms = normalise(&mut field);
        if step >= POWER_STEPS - MEASURED_STEPS {
            for channel in 0..3 {
                growth_of_logarithm[channel] += crate::maths::functions::ln(norms[channel]);
            }
        }
    }
    growth_of_logarithm
        .map(|sum| crate::maths::functions::exp(sum / f64::from(MEASURED_STEPS)))
        .into_iter()
        .fold(0.0, f64::at_least)
}

/// Scales every channel to a root mean square of 1 and returns what it was; a
/// channel without light stays as it is.
fn normalise(field: &mut [[f32; 3]]) -> [f64; 3] {
    let count = field.len().max(1) as f64;
    let norms = [0, 1, 2].map(|channel| {
        let squares = field
            .iter()
            .map(|value| f64::from(value[channel]) * f64::from(value[channel]));
        (squares.sum::<f64>() / count).sqrt()
    });
    for value in field {
        for channel in 0..3 {
            if norms[channel] > 0.0 {
                value[channel] = (f64::from(value[channel]) / norms[channel]) as f32;
            }
        }
    }
    norms
}

/// Energy that arrives over energy that can: sum A_i E_i / sum A_j r_j B_j, 1
/// for an exact reciprocal operator, since A_i T_ij is symmetric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EnergyRatios {
    pub(super) mean: f64,
    /// The ratio that is farthest from 1.
    pub(super) worst: f64,
}

/// Ratios of lights that the bake did not choose by.
pub(super) fn energy_ratios(
    bake: &Bake,
    surface: &Surface,
    places: &Places,
    level: Level,
) -> EnergyRatios {
    let in_slots = |values: &dyn Fn(usize) -> f32| -> Vec<[f32; 3]> {
        let vertices = bake.basis().vertex_of_slot().iter();
        vertices.map(|&v| [values(v as usize); 3]).collect()
    };
    let areas = in_slots(&|v| surface.vertices.areas()[v]);
    let arrived = bake.apply(level, &in_slots(&|_| 1.0));
    let (mut sum, mut count, mut worst) = (0.0, 0.0, 1.0_f64);
    let shadows = direct::Shadows::of_surface(surface, level);
    for light in prior::unseen_lights(places) {
        let direct = direct::at_vertices_by_one_point(&shadows, &light);
        let radiosity = in_slots(&|v| direct[v].x);
        let irradiance = bake.apply(level, &radiosity);
        let weighted = |field: &[[f32; 3]], weight: &dyn Fn(usize) -> f32| -> f64 {
            let terms = field.iter().zip(&areas).enumerate();
            terms
                .map(|(slot, (value, area))| {
                    f64::from(value[0]) * f64::from(area[0]) * f64::from(weight(slot))
                })
                .sum()
        };
        let sent = weighted(&radiosity, &|slot| arrived[slot][0]);
        if sent > 0.0 {
            let ratio = weighted(&irradiance, &|_| 1.0) / sent;
            sum += ratio;
            count += 1.0;
            if (ratio - 1.0).abs() > (worst - 1.0).abs() {
                worst = ratio;
            }
        }
    }
    EnergyRatios {
        mean: if count > 0.0 { sum / count } else { 1.0 },
        worst,
    }
}
