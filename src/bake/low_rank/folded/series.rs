//! Endless bounces of any field, of either sign: E = T~ x + T~ rho E.
//!
//! The bounces are summed one by one. Sooner or later each is the one before it
//! times a ratio; what is still to come is then known. The ratio is the one that
//! fits best at all vertices, since a function of the basis has no energy that
//! could be followed: its sum is about zero.

use crate::bake::basis::Basis;
use crate::bake::low_rank::LowRank;
use crate::maths::order::Order;
use crate::maths::rgb_fields::{add, product};
use crate::simd::Level;

/// What may be missing or too much of a sum, root mean square over the vertices,
/// share of the sum. Steps of eight bits leave some 30 times as much.
const TOLERANCE: f64 = 1e-4;
/// A bounce of this share of the one before it does not decay: as in `bounces`,
/// single precision rounds a closed room of albedo 1 to within 1e-6 of 1.
const DECAYS: f64 = 1.0 - 1e-5;
/// Bounces after which there is no limit. Two plates of albedo 0.99, whose light
/// swings from one to the other so that no ratio fits, take some 500.
const MOST_BOUNCES: u32 = 1000;
/// Bounces that may grow: light that leaves a corner for many small vertices does.
const MOST_GROWING: u32 = 64;

/// T~ and the albedo of each slot.
pub(super) struct Series<'a> {
    pub(super) operator: &'a LowRank,
    pub(super) basis: &'a Basis,
    pub(super) albedo: &'a [[f32; 3]],
    pub(super) level: Level,
}

impl Series<'_> {
    /// G x: irradiance of all bounces in slots from the radiosity before any.
    /// `None` where they have no limit.
    pub(super) fn limit(&self, source: &[[f32; 3]]) -> Option<Vec<[f32; 3]>> {
        let mut last = self.bounce(source);
        let mut sum = last.clone();
        for bounce in 0..MOST_BOUNCES {
            let outgoing = product(self.albedo, &last);
            let next = self.bounce(&outgoing);
            add(&mut sum, &next, [1.0; 3]);
            let steps = [0, 1, 2].map(|channel| Step::of(&last, &next, &sum, channel));
            let grows = steps.iter().any(|step| step.ratio >= DECAYS);
            if grows && bounce >= MOST_GROWING {
                return None;
            }
            if steps.iter().all(Step::is_settled) {
                add(&mut sum, &next, steps.map(|step| step.rest()));
                return Some(sum);
            }
            last = next;
        }
        None
    }

    fn bounce(&self, radiosity: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.operator.apply(self.level, self.basis, radiosity)
    }
}

/// One bounce after another, in a channel.
struct Step {
    /// Of the one to the other, by least squares.
    ratio: f64,
    /// What the ratio does not explain, root of the sum of squares.
    off: f64,
    /// Magnitude of all so far.
    sum: f64,
}

impl Step {
    fn of(last: &[[f32; 3]], next: &[[f32; 3]], sum: &[[f32; 3]], channel: usize) -> Self {
        let (mut before, mut across, mut after, mut all) = (0.0, 0.0, 0.0, 0.0);
        for ((a, b), s) in last.iter().zip(next).zip(sum) {
            let [a, b, s] = [a, b, s].map(|value| f64::from(value[channel]));
            before += a * a;
            across += a * b;
            after += b * b;
            all += s * s;
        }
        let ratio = if before > 0.0 { across / before } else { 0.0 };
        Self {
            ratio,
            off: f64::at_least(after - ratio * across, 0.0).sqrt(),
            sum: all.sqrt(),
        }
    }

    /// Whether what the ratio does not explain, were it to decay as slowly, is
    /// small.
    fn is_settled(&self) -> bool {
        self.ratio < DECAYS && self.off <= TOLERANCE * (1.0 - self.ratio) * self.sum
    }

    /// Sum of all later bounces over the last.
    fn rest(&self) -> f64 {
        self.ratio / (1.0 - self.ratio)
    }
}
