//! Seeds, and parts grown around them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Split;
use super::border;
use super::distance::{Nearest, Scratch};

/// Times that the seeds move to the centres of their parts, at least and at
/// most. On a triangulated grid of 35,000 vertices 2, 4, 8 and 20 steps cut
/// 11, 7, 6 and 5 % more edges than METIS.
const LLOYD_STEPS: (u64, u64) = (2, 8);

/// Vertices times steps: large components take fewer, so that half a million
/// vertices stay within a few seconds.
const LLOYD_WORK: u64 = 400_000;

/// Turns in which a part takes its vertices. One vertex a turn jumps about in
/// memory and takes half as long again; 16 turns leave parts less even.
const TURNS: u64 = 64;

/// Extreme points of a part that its centre is far from.
const PIVOTS: u32 = 4;

/// Labels every vertex of the component; each part is connected. The parts
/// with the shortest border of all steps stay.
pub(super) fn grow(split: &mut Split, scratch: &mut Scratch, refinement_passes: u32) {
    let mut seeds = farthest_seeds(split, scratch);
    let mut best: Option<(u64, Vec<u32>)> = None;
    for _ in 0..=lloyd_steps(split) {
        grow_around(split, &seeds);
        let cut = border::refine(split, refinement_passes);
        if best.as_ref().is_none_or(|best| cut < best.0) {
            best = Some((cut, labels_of(split)));
        }
        seeds = centres(split, scratch);
    }
    let labels = best.map_or_else(|| labels_of(split), |best| best.1);
    for (&vertex, &label) in split.members.iter().zip(&labels) {
        split.labels[vertex as usize] = label;
    }
}

fn lloyd_steps(split: &Split) -> u64 {
    (LLOYD_WORK / split.members.len() as u64).clamp(LLOYD_STEPS.0, LLOYD_STEPS.1)
}

fn labels_of(split: &Split) -> Vec<u32> {
    split
        .members
        .iter()
        .map(|&vertex| split.labels[vertex as usize])
        .collect()
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
    // Distances only shrink, so an entry that is out of date is too far up.
    let mut by_distance: BinaryHeap<(u64, Reverse<u32>)> = split
        .members
        .iter()
        .map(|&vertex| (scratch.distance(vertex), Reverse(vertex)))
        .collect();
    while seeds.len() < split.part_count as usize
        && let Some((distance, Reverse(vertex))) = by_distance.pop()
    {
        if distance > scratch.distance(vertex) {
            by_distance.push((scratch.distance(vertex), Reverse(vertex)));
        } else {
            scratch.add_source(split, vertex);
            seeds.push(vertex);
        }
    }
    seeds
}

/// Grows all parts at once: the lightest takes the nearest vertices of its
/// front that are still free. A part without a front stays as it is.
fn grow_around(split: &mut Split, seeds: &[u32]) {
    split
        .members
        .iter()
        .for_each(|&vertex| split.labels[vertex as usize] = u32::MAX);
    let turn = split.total_weight() / u64::from(split.part_count) / TURNS;
    let mut fronts: Vec<BinaryHeap<Nearest>> = seeds
        .iter()
        .map(|&seed| BinaryHeap::from([Reverse((0, seed))]))
        .collect();
    let mut lightest: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
    // Every part gets its seed before its neighbours can.
    for (part, front) in (0..split.part_count).zip(&mut fronts) {
        lightest.push(Reverse((take_nearest(split, front, part, 1), part)));
    }
    while let Some(Reverse((weight, part))) = lightest.pop() {
        let taken = take_nearest(split, &mut fronts[part as usize], part, turn);
        if taken > 0 {
            lightest.push(Reverse((weight + taken, part)));
        }
    }
}

/// Gives the nearest free vertices of the front to the part, until they weigh
/// `turn` and at least one if there is any; returns their weight.
fn take_nearest(split: &mut Split, front: &mut BinaryHeap<Nearest>, part: u32, turn: u64) -> u64 {
    let mut taken = 0;
    while taken < turn.max(1)
        && let Some(Reverse((distance, vertex))) = front.pop()
    {
        if split.labels[vertex as usize] != u32::MAX {
            continue;
        }
        split.labels[vertex as usize] = split.first_label + part;
        taken += split.weight(vertex);
        for (neighbour, cost) in split.graph.edges_of(vertex) {
            if split.labels[neighbour as usize] == u32::MAX {
                front.push(Reverse((distance + u64::from(cost), neighbour)));
            }
        }
    }
    taken
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
