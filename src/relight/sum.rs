//! Sums of many lights, of which one or a few change from frame to frame.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

/// Lights in a block. Of 500 lights, one that moves costs 16 additions and 32, not
/// 500; up to 16, the sum is that in the lights' order.
pub(super) const BLOCK: usize = 16;
/// Places whose lights one task adds up.
const PLACES_A_TASK: usize = 4096;

/// What one light does at every place, with a number that no other has.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub(super) id: u64,
    /// Irradiance, W/m2, or radiance by a lobe, W/(m2 sr).
    pub(super) values: Arc<[Vec3]>,
}

/// Sums of blocks of parts, each from zero in their order. A block whose parts are
/// the same as in the last sum is not added up again, which changes no bit.
#[derive(Debug, Default)]
pub(super) struct BlockSums {
    blocks: Vec<Block>,
}

#[derive(Debug)]
struct Block {
    ids: Vec<u64>,
    sum: Vec<Vec3>,
}

impl BlockSums {
    /// The sum of all parts at `count` places: of their blocks, in their order.
    pub(super) fn of(&mut self, parts: &[Part], count: usize) -> Vec<Vec3> {
        let mut total = vec![Vec3::ZERO; count];
        for (index, parts) in parts.chunks(BLOCK).enumerate() {
            self.add(index, parts, &mut total);
        }
        self.blocks.truncate(parts.len().div_ceil(BLOCK));
        total
    }

    /// Adds a block of at most [`BLOCK`] parts to the sum of those before it.
    pub(super) fn add(&mut self, index: usize, parts: &[Part], total: &mut [Vec3]) {
        let ids = || parts.iter().map(|part| part.id);
        let is_kept = self.blocks.get(index).is_some_and(|block| {
            block.sum.len() == total.len() && block.ids.iter().copied().eq(ids())
        });
        if !is_kept {
            let block = Block {
                ids: ids().collect(),
                sum: added(total.len(), parts),
            };
            match self.blocks.get_mut(index) {
                Some(old) => *old = block,
                None => self.blocks.push(block),
            }
        }
        let block = &self.blocks[index].sum;
        let pairs = total.par_iter_mut().zip(block).with_min_len(PLACES_A_TASK);
        pairs.for_each(|(total, e)| *total += *e);
    }
}

/// Sum of parts from zero, in their order.
fn added(count: usize, parts: &[Part]) -> Vec<Vec3> {
    (0..count)
        .into_par_iter()
        .with_min_len(PLACES_A_TASK)
        .map(|place| {
            let parts = parts.iter();
            parts.fold(Vec3::ZERO, |sum, part| sum + part.values[place])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(id: u64, count: usize) -> Part {
        let value = |place: usize| Vec3::splat(((id * 37 + place as u64 * 11) % 101) as f32 / 7.0);
        Part {
            id,
            values: (0..count).map(value).collect(),
        }
    }

    #[test]
    fn sums_that_are_kept_have_the_bits_of_fresh_ones() {
        let count = 50;
        let mut kept = BlockSums::default();
        let mut ids: Vec<u64> = (0..40).collect();
        for step in 0..12_u64 {
            match step % 4 {
                0 => ids[step as usize] = 100 + step,
                1 => ids.swap(1, 25),
                2 => ids.truncate(ids.len() - 5),
                _ => ids.push(200 + step),
            }
            let parts: Vec<Part> = ids.iter().map(|&id| part(id, count)).collect();
            assert_eq!(
                kept.of(&parts, count),
                BlockSums::default().of(&parts, count),
                "step {step}"
            );
        }
    }

    #[test]
    fn a_few_lights_are_added_in_their_order() {
        let parts: Vec<Part> = (0..BLOCK as u64).map(|id| part(id, 9)).collect();
        let plain = (0..9).map(|place| {
            let parts = parts.iter();
            parts.fold(Vec3::ZERO, |sum, part| sum + part.values[place])
        });
        let plain: Vec<Vec3> = plain.collect();
        assert_eq!(BlockSums::default().of(&parts, 9), plain);
        assert_eq!(BlockSums::default().of(&[], 2), [Vec3::ZERO; 2]);
    }
}
