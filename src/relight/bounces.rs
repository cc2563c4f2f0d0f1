//! Bounces: B = source + rho E, E = T~ B, as often as asked for.

use glam::Vec3;
use thiserror::Error;

use crate::bake::Bake;
use crate::maths::order::Order;
use crate::maths::rgb_fields::{add, product};
use crate::scene::Bounces;
use crate::simd::Level;

/// "All" stops when a bounce changes the estimated limit by less, in the mean
/// over the vertices.
const REMAINDER: f64 = 1e-5;
/// The ratio of successive bounces has settled when it changes by less.
const SETTLED: f64 = 1e-3;
/// A bounce of this share of the one before it does not decay: single precision
/// rounds a closed room of albedo 1 to within 1e-6 of 1, and a limit 1e5 times
/// the first bounce is none.
const DECAYS: f64 = 1.0 - 1e-5;
/// A bounce of this share of all before it is lost in their rounding, so their
/// sum is the limit. Between two plates of unequal albedo light swings from one
/// to the other: the ratio of successive bounces alternates for ever and never
/// settles.
const NOTHING_LEFT: f64 = 1e-7;
/// Bounces that may grow before "all" gives up: light that leaves a corner for
/// many small vertices grows in their sum for a bounce or two.
const MOST_GROWING: u32 = 64;
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

/// Bounced light, and what the last bounce started with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solution {
    /// Indirect irradiance at every vertex, W/m2.
    pub(crate) irradiance: Vec<Vec3>,
    /// The radiosity whose light that is, W/m2, in slots: zero without a bounce.
    pub(crate) outgoing: Vec<[f32; 3]>,
}

impl Transport<'_> {
    /// Light of bounces 1 to N at every vertex.
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
    ) -> Result<Solution, BounceError> {
        let (source, albedo) = (self.in_slots(source), self.in_slots(albedo));
        let (irradiance, outgoing) = match bounces {
            Bounces::Count(count) => self.count(&source, &albedo, count),
            Bounces::All => {
                let limit = self.all(&source, &albedo)?;
                let outgoing = radiosity(&source, &albedo, &limit);
                (limit, outgoing)
            }
        };
        Ok(Solution {
            irradiance: self.at_vertices(&irradiance),
            outgoing,
        })
    }

    /// The same of all bounces by the bake's operator for them; `None` without. The
    /// albedo is the one that they were folded under.
    pub(crate) fn solve_folded(&self, source: &[Vec3], albedo: &[Vec3]) -> Option<Solution> {
        let (source, albedo) = (self.in_slots(source), self.in_slots(albedo));
        let irradiance = self.bake.all_bounces(self.level, &source, &albedo)?;
        Some(Solution {
            irradiance: self.at_vertices(&irradiance),
            outgoing: radiosity(&source, &albedo, &irradiance),
        })
    }

    /// S S^T B at every vertex: what projection on the basis leaves of a field.
    /// It may be negative where B is not.
    pub(crate) fn projected(&self, radiosity: &[Vec3]) -> Vec<Vec3> {
        let basis = self.bake.basis();
        let light = basis.project_rgb(self.level, &self.in_slots(radiosity));
        self.at_vertices(&basis.reconstruct_rgb(&light))
    }

    fn in_slots(&self, values: &[Vec3]) -> Vec<[f32; 3]> {
        let vertices = self.bake.basis().vertex_of_slot().iter();
        vertices.map(|&v| values[v as usize].to_array()).collect()
    }

    fn at_vertices(&self, in_slots: &[[f32; 3]]) -> Vec<Vec3> {
        let mut values = vec![Vec3::ZERO; in_slots.len()];
        for (&vertex, &value) in self.bake.basis().vertex_of_slot().iter().zip(in_slots) {
            values[vertex as usize] = Vec3::from_array(value);
        }
        values
    }

    /// E^N, and the B that gave it.
    fn count(
        &self,
        source: &[[f32; 3]],
        albedo: &[[f32; 3]],
        count: u32,
    ) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
        let mut irradiance = vec![[0.0; 3]; source.len()];
        let mut outgoing = irradiance.clone();
        for _ in 0..count {
            outgoing = radiosity(source, albedo, &irradiance);
            irradiance = self.bake.apply(self.level, &outgoing);
        }
        (irradiance, outgoing)
    }

    /// Bounces until the limit of the geometric series, as the ratio of the
    /// last bounces tells it, no longer changes at the vertices.
    ///
    /// Each bounce is carried on by itself and not found as a difference of
    /// sums, whose rounding would drown it: at albedo 0.99 in a furnace that
    /// made the ratio of successive bounces exceed 1.
    fn all(&self, source: &[[f32; 3]], albedo: &[[f32; 3]]) -> Result<Vec<[f32; 3]>, BounceError> {
        let mut irradiance = vec![[0.0; 3]; source.len()];
        let mut outgoing = source.to_vec();
        let mut last = Increment::default();
        let mut last_limit: Vec<[f32; 3]> = Vec::new();
        for bounce in 0..MOST_BOUNCES {
            let increment = Increment::of(self.bake.apply(self.level, &outgoing), &last);
            add(&mut irradiance, &increment.added, [1.0; 3]);
            let growing = increment.growing();
            if let Some(ratio) = growing
                && bounce >= MOST_GROWING
            {
                return Err(BounceError::Diverges { ratio });
            }
            if growing.is_none() && increment.settled(&last) {
                let mut limit = irradiance.clone();
                add(&mut limit, &increment.added, increment.rest());
                if !last_limit.is_empty() && change(&last_limit, &limit) < REMAINDER {
                    return Ok(limit);
                }
                last_limit = limit;
            }
            if magnitude(&increment.added) <= NOTHING_LEFT * magnitude(&irradiance) {
                return Ok(irradiance);
            }
            outgoing = product(albedo, &increment.added);
            last = increment;
        }
        Err(BounceError::Diverges {
            ratio: last.ratio.iter().copied().fold(0.0, f64::at_least),
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

/// Sum of a field's absolute values.
fn magnitude(field: &[[f32; 3]]) -> f64 {
    let absolute = |value: &f32| f64::from(value.abs());
    field.iter().flatten().map(absolute).sum()
}

/// Mean absolute difference of two fields, share of the mean of the second, of
/// the channel where it is largest. Fields are compared and not their sums: in
/// a closed room the sum is right after two bounces, wherever the light is.
fn change(before: &[[f32; 3]], after: &[[f32; 3]]) -> f64 {
    let of_channel = |channel: usize| {
        let (mut difference, mut total) = (0.0, 0.0);
        for (b, a) in before.iter().zip(after) {
            difference += f64::from((a[channel] - b[channel]).abs());
            total += f64::from(a[channel].abs());
        }
        difference / f64::at_least(total, f64::MIN_POSITIVE)
    };
    [0, 1, 2]
        .map(of_channel)
        .into_iter()
        .fold(0.0, f64::at_least)
}

/// One bounce.
#[derive(Default)]
struct Increment {
    added: Vec<[f32; 3]>,
    /// Sum of what was added, per channel.
    energy: [f64; 3],
    /// Its ratio to the bounce before, per channel.
    ratio: [f64; 3],
}

impl Increment {
    fn of(added: Vec<[f32; 3]>, last: &Self) -> Self {
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
        self.ratio.iter().copied().find(|&ratio| ratio >= DECAYS)
    }

    /// Sum of all later bounces over this one, per channel.
    fn rest(&self) -> [f64; 3] {
        self.ratio.map(|ratio| ratio / (1.0 - ratio))
    }
}
