//! Lights that say what matters to a group of receivers.
//!
//! How strongly lights excite a function (sigma) says what matters on the whole
//! surface. A group of receivers may see something else: through a small window
//! the sky makes the window's frame a hundred times brighter than the walls, and
//! although the frame is a five hundredth of what the walls behind see, it is
//! then a fifth of their light. With sigma alone its functions were dropped, and
//! the room lost 12 % of its bounced light.
//!
//! So a group weighs the partitions: by their light under each witness, relative
//! to what the group receives under it.

use super::basis::Basis;
use super::transfer::{GROUP, GroupTransfer};

/// Witnesses, a fraction of the prior lights; unused places stay dark.
pub(super) const WITNESSES: usize = 40;
/// Irradiance, of a light whose RMS on all surfaces is 1, below which a receiver
/// counts as dark: what it sees then is not made ever more important.
const DARK: f32 = 0.02;

/// What every witness does to every partition.
pub(super) struct Witnesses {
    /// Mean irradiance on each partition, by witness.
    means: Vec<[f32; WITNESSES]>,
    /// Mean of its square.
    squares: Vec<[f32; WITNESSES]>,
    count: usize,
}

impl Witnesses {
    pub(super) fn new(basis: &Basis) -> Self {
        Self {
            means: vec![[0.0; WITNESSES]; basis.part_count()],
            squares: vec![[0.0; WITNESSES]; basis.part_count()],
            count: 0,
        }
    }

    /// Adds a light, by the irradiance at the vertices; no more than
    /// [`WITNESSES`] are kept.
    pub(super) fn add(&mut self, basis: &Basis, irradiance: &[f32]) {
        if self.count == WITNESSES {
            return;
        }
        for part in 0..basis.part_count() {
            let slots = basis.slot_range(part as u32);
            let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
            for &vertex in &basis.vertex_of_slot()[slots.clone()] {
                let e = f64::from(irradiance[vertex as usize]);
                sum += e;
                squares += e * e;
            }
            let slots = slots.len().max(1) as f64;
            self.means[part][self.count] = (sum / slots) as f32;
            self.squares[part][self.count] = (squares / slots) as f32;
        }
        self.count += 1;
    }

    /// Weights of the partitions that a group receives from (partition, weight),
    /// ascending; their mean over what the group receives is 1.
    pub(super) fn weights(&self, basis: &Basis, transfer: &GroupTransfer) -> Vec<(u32, f32)> {
        let received = received_by_part(basis, transfer);
        let mut arriving = [0.0_f32; WITNESSES];
        for &(part, share) in &received {
            let means = &self.means[part as usize];
            for (sum, mean) in arriving.iter_mut().zip(means) {
                *sum += share * mean;
            }
        }
        let relative = arriving.map(|e| 1.0 / (e * e + DARK * DARK));
        let mut weights: Vec<(u32, f32)> = received
            .iter()
            .map(|&(part, _)| (part, self.weight(part, &relative)))
            .collect();
        let total: f32 = received.iter().map(|(_, share)| share).sum();
        let weighted = received.iter().zip(&weights);
        let sum: f32 = weighted.map(|((_, share), (_, w))| share * w).sum();
        if sum > 0.0 {
            weights.iter_mut().for_each(|(_, w)| *w *= total / sum);
        }
        weights
    }

    /// Mean over the witnesses of a partition's light, relative to the group's,
    /// over the mean of its light as sigma has it.
    fn weight(&self, part: u32, relative: &[f32; WITNESSES]) -> f32 {
        let squares = &self.squares[part as usize];
        let (mut weighted, mut plain) = (0.0_f32, 0.0_f32);
        for (square, relative) in squares.iter().zip(relative) {
            weighted += square * relative;
            plain += square;
        }
        if plain > 0.0 { weighted / plain } else { 1.0 }
    }
}

/// Share of a group's light that comes from each partition it receives from,
/// under light that is the same everywhere; ascending.
fn received_by_part(basis: &Basis, transfer: &GroupTransfer) -> Vec<(u32, f32)> {
    let mut received: Vec<(u32, f32)> = Vec::new();
    for (slot, weights) in &transfer.entries {
        let (part, _) = basis.row(*slot);
        let share = weights.iter().fold(0.0, |sum, w| sum + w) / GROUP as f32;
        match received.last_mut() {
            Some((last, sum)) if *last == part => *sum += share,
            _ => received.push((part, share)),
        }
    }
    received
}
