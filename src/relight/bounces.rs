//! Bounces: B = source + rho E, E = T~ B, as often as asked for.

use glam::Vec3;
use thiserror::Error;

use crate::bake::Bake;
use crate::scene::Bounces;
use crate::simd::Level;

/// "All" stops when the estimated remainder changes the total by less.
const REMAINDER: f64 = 1e-5;
/// The ratio of successive bounces has settled when it changes by less.
const SETTLED: f64 = 1e-3;
/// Bounces after which "all" gives up: at albedo 0.99 in a closed room it needs
/// some 20, since the remainder is extrapolated.
const MOST_BOUNCES: u32 = 4_000;

/// Why there is no solution.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum BounceError {
    /// More light after a bounce than before it.
    #[error(
        "bounces = \"all\" does not converge: every bounce carries {ratio:.4} of the light before it; \
         lower the albedo below 1 or ask for a number of bounces"
    )]
    Diverges {
        /// Energy of a bounce, share of the bounce before it.
        ratio: f64,
    },
}

/// The transfer operator T~, ready to be applied.
#[derive(Clone, Copy)]
pub(crate) struct Transport<'a> {
    pub(crate) bake: &'a Bake,
    pub(crate) level: Level,
}

impl Transport<'_> {
    /// Indirect irradiance at every vertex, W/m2, of bounces 1 to N.
    ///
    /// `source` is the radiosity of the vertices before any bounce (albedo x
    /// direct irradiance, or pi x emitted radiance), W/m2; `albedo` that of
    /// the vertices. Negative values may remain: the basis rings; clamp where
    /// light is shown, not here, so that light stays linear.
    pub(crate) fn solve(
        &self,
        source: &[Vec3],
        albedo: &[Vec3],
        bounces: Bounces,
    ) -> Result<Vec<Vec3>, BounceError> {
        let basis = self.bake.basis();
        let in_slots = |values: &[Vec3]| -> Vec<[f32; 3]> {
            basis
                .vertex_of_slot()
                .iter()
                .map(|&v| values[v as usize].to_array())
                .collect()
        };
        let (source, albedo) = (in_slots(source), in_slots(albedo));
        let irradiance = match bounces {
            Bounces::Count(count) => self.count(&source, &albedo, count),
            Bounces::All => self.all(&source, &albedo)?,
        };
        let mut at_vertices = vec![Vec3::ZERO; irradiance.len()];
        for (&vertex, &e) in basis.vertex_of_slot().iter().zip(&irradiance) {
            at_vertices[vertex as usize] = Vec3::from_array(e);
        }
        Ok(at_vertices)
    }

    fn count(&self, source: &[[f32; 3]], albedo: &[[f32; 3]], count: u32) -> Vec<[f32; 3]> {
        let mut irradiance = vec![[0.0; 3]; source.len()];
        for _ in 0..count {
            irradiance = self.bake.apply(self.level, &radiosity(source, albedo, &irradiance));
        }
        irradiance
    }

    /// Bounces until the rest of the geometric series, as the ratio of the last
    /// bounces tells it, no longer changes the total.
    fn all(&self, source: &[[f32; 3]], albedo: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, BounceError> {
        let mut irradiance = vec![[0.0; 3]; source.len()];
        let mut last = Increment::default();
        let mut last_total = [0.0; 3];
        for _ in 0..MOST_BOUNCES {
            let next = self.bake.apply(self.level, &radiosity(source, albedo, &irradiance));
            let increment = Increment::between(&irradiance, &next, &last);
            irradiance = next;
            if increment.settled(&last) {
                if let Some(ratio) = increment.growing() {
                    return Err(BounceError::Diverges { ratio });
                }
                let total = increment.total_with_rest(&irradiance);
                let change = (0..3)
                    .map(|c| (total[c] - last_total[c]).abs() / total[c].max(f64::MIN_POSITIVE));
                if change.fold(0.0, f64::max) < REMAINDER {
                    increment.add_rest(&mut irradiance);
                    return Ok(irradiance);
                }
                last_total = total;
            }
            last = increment;
        }
        Err(BounceError::Diverges {
            ratio: last.ratio.iter().copied().fold(0.0, f64::max),
        })
    }
}

/// B = source + rho E.
fn radiosity(source: &[[f32; 3]], albedo: &[[f32; 3]], irradiance: &[[f32; 3]]) -> Vec<[f32; 3]> {
    source
        .iter()
        .zip(albedo)
        .zip(irradiance)
        .map(|((s, rho), e)| {
            [
                s[0] + rho[0] * e[0],
                s[1] + rho[1] * e[1],
                s[2] + rho[2] * e[2],
            ]
        })
        .collect()
}

/// What the last bounce added.
#[derive(Default)]
struct Increment {
    added: Vec<[f32; 3]>,
    /// Sum of what was added, per channel.
    energy: [f64; 3],
    /// Its ratio to the bounce before, per channel.
    ratio: [f64; 3],
}

impl Increment {
    fn between(before: &[[f32; 3]], after: &[[f32; 3]], last: &Self) -> Self {
        let added: Vec<[f32; 3]> = before
            .iter()
            .zip(after)
            .map(|(b, a)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]])
            .collect();
        let energy = [0, 1, 2].map(|c| added.iter().map(|a| f64::from(a[c])).sum::<f64>());
        let ratio = [0, 1, 2].map(|c| {
            if last.energy[c] > 0.0 {
                energy[c] / last.energy[c]
            } else {
                0.0
            }
        });
        Self {
            added,
            energy,
            ratio,
        }
    }

    fn settled(&self, last: &Self) -> bool {
        !last.added.is_empty() && (0..3).all(|c| (self.ratio[c] - last.ratio[c]).abs() < SETTLED)
    }

    fn growing(&self) -> Option<f64> {
        self.ratio.iter().copied().find(|&ratio| ratio >= 1.0)
    }

    fn rest(&self) -> [f64; 3] {
        self.ratio.map(|ratio| ratio / (1.0 - ratio))
    }

    fn total_with_rest(&self, irradiance: &[[f32; 3]]) -> [f64; 3] {
        let rest = self.rest();
        [0, 1, 2].map(|c| {
            irradiance.iter().map(|e| f64::from(e[c])).sum::<f64>() + self.energy[c] * rest[c]
        })
    }

    fn add_rest(&self, irradiance: &mut [[f32; 3]]) {
        let rest = self.rest().map(|r| r as f32);
        for (e, added) in irradiance.iter_mut().zip(&self.added) {
            for c in 0..3 {
                e[c] += added[c] * rest[c];
            }
        }
    }
}
