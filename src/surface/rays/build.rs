//! Building: obvhs clusters the triangles, its eight-wide topology is kept and
//! its boxes are computed anew, exactly.

use super::RayTree;
use crate::simd::{CHILDREN, Corners, LEAF, WideNode, WideTree};
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// How the tree is built.
#[derive(Clone, Copy, Debug)]
pub(super) struct BuildSettings {
    /// Neighbours along the Morton curve that a cluster is compared with (PLOC,
    /// Meister and Bittner 2018).
    pub(super) search_distance: PlocSearchDistance,
    /// Passes of clustering with direct neighbours only.
    pub(super) search_depth_threshold: usize,
    /// Share of the nodes tried for reinsertion (Meister and Bittner 2018).
    pub(super) reinsertion_batch_ratio: f32,
}

/// The settings of every tree. Million shadow rays a second, million closest hits
/// (one cosine ray from each of 200,000 surface points) and build time, AVX2 and
/// one thread, noise about 10 %, by `rays_build`:
///
/// | search, threshold, reinsertion | room | blob |
/// |---|---|---|
/// | medium, 0, 0.02 | 13.7, 2.4, 80 ms | 2.5, 1.4, 110 ms |
/// | high, 0, none | 14.0, 2.1, 67 ms | 3.0, 1.4, 121 ms |
/// | **high, 0, 0.02** | 13.4, 2.1, 69 ms | 3.3, 1.5, 84 ms |
/// | high, 0, 0.1 | 13.1, 2.1, 91 ms | 3.0, 1.5, 105 ms |
/// | high, 0, 0.5 | 13.5, 2.2, 185 ms | 3.3, 1.5, 148 ms |
/// | very high, 0, 0.02 | 12.3, 2.2, 99 ms | 2.6, 1.5, 86 ms |
/// | high, 2, 0.02 | 13.1, 2.2, 122 ms | 4.0, 1.5, 69 ms |
/// | low, 2, 0.02 | 12.0, 2.1, 78 ms | 2.6, 1.4, 47 ms |
///
/// Once leaves hold one triangle and boxes are exact, the rest is within noise;
/// a low search distance is the only one that loses on both.
pub(super) const BUILD: BuildSettings = BuildSettings {
    search_distance: PlocSearchDistance::High,
    search_depth_threshold: 0,
    reinsertion_batch_ratio: 0.02,
};

/// One triangle a leaf, so that a leaf's box is its triangle's padded box and
/// the lane's interval serves the triangle test.
const TRIANGLES_PER_LEAF: u32 = 1;

/// Added on each side of the boxes that obvhs gets. Its box test moves a plane
/// by up to four roundings of numbers up to 4 (1e-6), the moved and scaled ray
/// by two more (5e-7), the inverse of small components by 5e-7.
const OBVHS_PADDING: f32 = 4e-6;

/// Levels of a tree of obvhs: its traversal stack has room for 32 and
/// overwrites silently beyond, and its conversion recurses.
const LEVELS_AT_MOST: usize = 32;

/// Levels of the binary tree that are converted, by recursion.
const BINARY_LEVELS_AT_MOST: usize = 200;

/// Triangles with one and the same box that clustering may meet. Every cluster
/// of equals prefers the same one of its neighbours, so n equals take n passes
/// and make a chain of n levels.
const EQUALS_AT_MOST: usize = 64;

#[allow(
    clippy::disallowed_types,
    reason = "obvhs takes Vec3A; only the tree's shape depends on it, no hit does"
)]
/// The box of a triangle for obvhs.
fn obvhs_box(corners: &Corners) -> Aabb {
    let [x, y, z] = corners.padded_box();
    let bound = |side: usize| glam::Vec3A::new(x[side], y[side], z[side]);
    Aabb::new(bound(0) - OBVHS_PADDING, bound(1) + OBVHS_PADDING)
}

pub(super) fn build(positions: &[Vec3], triangles: &[[u32; 3]]) -> RayTree {
    build_with(positions, triangles, BUILD)
}

pub(super) fn build_with(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    settings: BuildSettings,
) -> RayTree {
    let corners: Vec<Corners> = triangles
        .iter()
        .map(|triangle| Corners::new(triangle.map(|vertex| positions[vertex as usize])))
        .collect();
    debug_assert!(
        positions.iter().all(|p| p.abs().max_element() <= 1.0),
        "the paddings are made for coordinates of at most 1"
    );
    let boxes: Vec<Aabb> = corners.iter().map(obvhs_box).collect();
    clustered(&boxes, settings)
        .and_then(|binary| convert(&binary, &corners))
        .or_else(|| convert(&halved(&boxes), &corners))
        .expect(
            "a tree split into halves has at most 33 levels of which eight-wide nodes take three",
        )
}

/// The tree for rays, or none where it is deeper than a stack.
fn convert(binary: &Bvh2, corners: &[Corners]) -> Option<RayTree> {
    let compressed = bvh2_to_cwbvh(binary, TRIANGLES_PER_LEAF, true, false);
    if level_count(&compressed) > LEVELS_AT_MOST {
        return None;
    }
    let in_order = |&triangle: &u32| corners[triangle as usize];
    let corners = compressed.primitive_indices.iter().map(in_order).collect();
    let wide = widen(&compressed, corners)?;
    Some(RayTree {
        wide,
        #[cfg(test)]
        compressed,
    })
}

/// PLOC and reinsertion, or none for input that would make it a chain.
fn clustered(boxes: &[Aabb], settings: BuildSettings) -> Option<Bvh2> {
    if most_equals(boxes) > EQUALS_AT_MOST {
        return None;
    }
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
        settings.search_distance,
        boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        settings.search_depth_threshold,
    );
    if binary_level_count(&binary) > BINARY_LEVELS_AT_MOST {
        return None;
    }
    ReinsertionOptimizer::default().run(&mut binary, settings.reinsertion_batch_ratio, None);
    (binary_level_count(&binary) <= BINARY_LEVELS_AT_MOST).then_some(binary)
}

/// The largest number of boxes with the same bits.
fn most_equals(boxes: &[Aabb]) -> usize {
    let mut hashes: Vec<u32> = boxes.iter().map(box_hash).collect();
    hashes.sort_unstable();
    hashes
        .chunk_by(|a, b| a == b)
        .map(<[u32]>::len)
        .max()
        .unwrap_or(0)
}

fn box_hash(bounds: &Aabb) -> u32 {
    let (lower, upper) = (bounds.min.to_array(), bounds.max.to_array());
    lower.into_iter().chain(upper).fold(0, |hash, bound| {
        crate::maths::hash::mix(hash ^ bound.to_bits())
    })
}

fn binary_level_count(tree: &Bvh2) -> usize {
    let mut level_count = 0;
    let mut level: Vec<u32> = if tree.nodes.is_empty() {
        vec![]
    } else {
        vec![0]
    };
    while !level.is_empty() {
        level_count += 1;
        level = level
            .iter()
            .map(|&index| &tree.nodes[index as usize])
            .filter(|node| !node.is_leaf())
            .flat_map(|node| [node.first_index, node.first_index + 1])
            .collect();
    }
    level_count
}

/// Children of obvhs's nodes come after them.
fn level_count(tree: &CwBvh) -> usize {
    let mut levels = vec![1_usize; tree.nodes.len()];
    for (position, node) in tree.nodes.iter().enumerate() {
        for child in (0..CHILDREN).filter(|&child| !node.is_leaf(child)) {
            levels[node.child_node_index(child) as usize] = levels[position] + 1;
        }
    }
    levels.into_iter().max().unwrap_or(0)
}

/// The fallback: halves of the boxes along the longest axis of their centres,
/// however they lie. As deep as the logarithm of their number.
fn halved(boxes: &[Aabb]) -> Bvh2 {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = Vec::with_capacity(2 * boxes.len());
    if !boxes.is_empty() {
        nodes.push(Bvh2Node::default());
        halve(boxes, &mut order, 0, 0, &mut nodes);
    }
    Bvh2 {
        nodes,
        primitive_indices: order,
        ..Bvh2::default()
    }
}

/// Fills node `position` with `order`, which begins at `first` in the whole.
fn halve(
    boxes: &[Aabb],
    order: &mut [u32],
    first: u32,
    position: usize,
    nodes: &mut Vec<Bvh2Node>,
) {
    let around = order
        .iter()
        .map(|&index| boxes[index as usize])
        .reduce(|a, b| a.union(&b))
        .expect("halves are not empty");
    if order.len() == 1 {
        nodes[position] = Bvh2Node::new(around, 1, first);
        return;
    }
    let axis = around.largest_axis();
    order.sort_unstable_by(|&a, &b| {
        let centre = |index: u32| boxes[index as usize].center()[axis];
        centre(a).total_cmp(&centre(b)).then(a.cmp(&b))
    });
    let children = nodes.len();
    nodes[position] = Bvh2Node::new(around, 0, children as u32);
    nodes.resize(children + 2, Bvh2Node::default());
    let (left, right) = order.split_at_mut(order.len() / 2);
    let middle = first + left.len() as u32;
    halve(boxes, left, first, children, nodes);
    halve(boxes, right, middle, children + 1, nodes);
}

/// The topology of obvhs's tree with exact boxes from the bottom up.
fn widen(tree: &CwBvh, corners: Vec<Corners>) -> Option<WideTree> {
    let mut nodes = vec![WideNode::EMPTY; tree.nodes.len()];
    for position in (0..nodes.len()).rev() {
        let source = &tree.nodes[position];
        let mut node = WideNode::EMPTY;
        for lane in (0..CHILDREN).filter(|&lane| !source.is_child_empty(lane)) {
            if source.is_leaf(lane) {
                let (triangle, _) = source.child_primitives(lane);
                let bounds = corners[triangle as usize].padded_box();
                node.set(lane, triangle | LEAF, bounds);
            } else {
                let child = source.child_node_index(lane);
                node.set(lane, child, nodes[child as usize].union());
            }
        }
        nodes[position] = node;
    }
    WideTree::new(nodes, corners, tree.primitive_indices.clone())
}
