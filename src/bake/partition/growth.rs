//! Seeds, and parts grown around them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Split;
use super::distance::{Nearest, Scratch};

/// Times that the seeds move to the centres of their parts.
const LLOYD_STEPS: u32 = 4;

/// Extreme points of a part that its centre is far from.
const PIVOTS: u32 = 4;

/// Labels every vertex of the component; each part is connected.
pub(super) fn grow(split: &mut Split, scratch: &mut Scratch) {
    let mut seeds = farthest_seeds(split, scratch);
    grow_around(split, &seeds);
    let mut best = (spread(split), labels_of(split));
    for _ in 0..LLOYD_STEPS {
        seeds = centres(split, scratch);
        grow_around(split, &seeds);
        let spread = spread(split);
        if spread < best.0 {
            best = (spread, labels_of(split));
        }
    }
    for (&vertex, &label) in split.members.iter().zip(&best.1) {
        split.labels[vertex as usize] = label;
    }
}

fn labels_of(split: &Split) -> Vec<u32> {
    split
        .members
        .iter()
        .map(|&vertex| split.labels[vertex as usize])
        .collect()
}

/// Sum of the squared weights: least when all parts weigh the same.
fn spread(split: &Split) -> u128 {
    split
        .part_weights()
        .iter()
        .map(|&weight| u128::from(weight) * u128::from(weight))
        .sum()
}

/// One vertex a part, each as far as can be from those before it.
///
/// The first is far from the lowest vertex, that is at an end of the component.
fn farthest_seeds(split: &Split, scratch: &mut Scratch) -> Vec<u32> {
    scratch.forget(split.members);
    scratch.add_source(split, split.members[0]);
    let mut seeds = vec![scratch.farthest(split.members)];
    scratch.forget(split.members);
    scratch.add_source(split, seeds[0]);
    while seeds.len() < split.part_count as usize {
        let seed = scratch.farthest(split.members);
        scratch.add_source(split, seed);
        seeds.push(seed);
    }
    seeds
}

/// Grows all parts at once: the lightest takes the nearest vertex of its front
/// that is still free. A part without a front stays as it is.
fn grow_around(split: &mut Split, seeds: &[u32]) {
    split
        .members
        .iter()
        .for_each(|&vertex| split.labels[vertex as usize] = u32::MAX);
    let mut fronts: Vec<BinaryHeap<Nearest>> = seeds
        .iter()
        .map(|&seed| BinaryHeap::from([Reverse((0, seed))]))
        .collect();
    let mut lightest: BinaryHeap<Reverse<(u64, u32)>> = (0..split.part_count)
        .map(|part| Reverse((0, part)))
        .collect();
    while let Some(Reverse((weight, part))) = lightest.pop() {
        if let Some(vertex) = take_nearest(split, &mut fronts[part as usize], part) {
            lightest.push(Reverse((weight + split.weight(vertex), part)));
        }
    }
}

/// Gives the nearest free vertex of the front to the part.
fn take_nearest(split: &mut Split, front: &mut BinaryHeap<Nearest>, part: u32) -> Option<u32> {
    while let Some(Reverse((distance, vertex))) = front.pop() {
        if split.labels[vertex as usize] != u32::MAX {
            continue;
        }
        split.labels[vertex as usize] = split.first_label + part;
        for (neighbour, cost) in split.graph.edges_of(vertex) {
            if split.labels[neighbour as usize] == u32::MAX {
                front.push(Reverse((distance + u64::from(cost), neighbour)));
            }
        }
        return Some(vertex);
    }
    None
}

/// Centre of each part.
fn centres(split: &Split, scratch: &mut Scratch) -> Vec<u32> {
    let mut members = vec![Vec::new(); split.part_count as usize];
    for &vertex in split.members {
        members[(split.labels[vertex as usize] - split.first_label) as usize].push(vertex);
    }
    members
        .iter()
        .map(|members| centre(split, members, scratch))
        .collect()
}

/// The vertex whose greatest distance to some extreme points of the part is
/// least, along paths inside the part; the lowest index on ties.
fn centre(split: &Split, members: &[u32], scratch: &mut Scratch) -> u32 {
    scratch.start_extent(members);
    scratch.forget(members);
    scratch.add_source(split, members[0]);
    let mut pivot = scratch.farthest(members);
    for _ in 0..PIVOTS {
        scratch.forget(members);
        scratch.add_source(split, pivot);
        pivot = scratch.note_extent(members);
    }
    scratch.innermost(members)
}
