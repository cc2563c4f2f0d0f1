//! Distances along the edges of the graph (Dijkstra 1959), in whole numbers.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Split;

/// A vertex with its distance; the nearest first, then the lowest index.
pub(super) type Nearest = Reverse<(u64, u32)>;

/// Arrays of one entry a vertex of the whole graph, made once. An entry is
/// valid only for the vertices that the last search set.
pub(super) struct Scratch {
    distance: Vec<u64>,
    /// Distances to the nearest and to the farthest of the extreme points of a
    /// part, while its centre is looked for.
    to_extremes: Vec<(u64, u64)>,
    heap: BinaryHeap<Nearest>,
}

impl Scratch {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            distance: vec![u64::MAX; vertex_count],
            to_extremes: vec![(u64::MAX, 0); vertex_count],
            heap: BinaryHeap::new(),
        }
    }

    /// Forgets the distances of `vertices`.
    pub(super) fn forget(&mut self, vertices: &[u32]) {
        vertices
            .iter()
            .for_each(|&vertex| self.distance[vertex as usize] = u64::MAX);
    }

    /// Lowers the distances of the vertices that are nearer to `source` than
    /// to any earlier source, on paths with the label of `source` only.
    pub(super) fn add_source(&mut self, split: &Split, source: u32) {
        let label = split.labels[source as usize];
        self.distance[source as usize] = 0;
        self.heap.push(Reverse((0, source)));
        while let Some(Reverse((distance, vertex))) = self.heap.pop() {
            if distance > self.distance[vertex as usize] {
                continue;
            }
            for (neighbour, cost) in split.graph.edges_of(vertex) {
                let through = distance + u64::from(cost);
                let known = &mut self.distance[neighbour as usize];
                if through < *known && split.labels[neighbour as usize] == label {
                    *known = through;
                    self.heap.push(Reverse((through, neighbour)));
                }
            }
        }
    }

    /// Distance from the nearest source.
    pub(super) fn distance(&self, vertex: u32) -> u64 {
        self.distance[vertex as usize]
    }

    /// The vertex farthest from the sources; the lowest index on ties.
    pub(super) fn farthest(&self, vertices: &[u32]) -> u32 {
        let farthest = vertices
            .iter()
            .copied()
            .max_by_key(|&vertex| (self.distance[vertex as usize], Reverse(vertex)));
        farthest.expect("a component and a part have at least one vertex")
    }

    /// Forgets the extreme points of the part with these members.
    pub(super) fn start_extent(&mut self, members: &[u32]) {
        members
            .iter()
            .for_each(|&vertex| self.to_extremes[vertex as usize] = (u64::MAX, 0));
    }

    /// Takes the source of the last search as an extreme point; returns the
    /// vertex that is farthest from all of them, the lowest index on ties.
    pub(super) fn note_extent(&mut self, members: &[u32]) -> u32 {
        let mut outermost = (0, members[0]);
        for &vertex in members {
            let distance = self.distance[vertex as usize];
            let (nearest, farthest) = &mut self.to_extremes[vertex as usize];
            *nearest = distance.min(*nearest);
            *farthest = distance.max(*farthest);
            if *nearest > outermost.0 {
                outermost = (*nearest, vertex);
            }
        }
        outermost.1
    }

    /// The vertex that is least far from the extreme points; the lowest index
    /// on ties.
    pub(super) fn innermost(&self, members: &[u32]) -> u32 {
        let innermost = members
            .iter()
            .copied()
            .min_by_key(|&vertex| (self.to_extremes[vertex as usize].1, vertex));
        innermost.expect("a part has at least one vertex")
    }
}
