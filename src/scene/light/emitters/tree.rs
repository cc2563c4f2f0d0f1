//! A binary tree over polygons. Each node knows what its polygons send into
//! the distance; one polygon a leaf.

mod gathered;
mod node;

use super::cut::{LightCut, Source};
use super::{Polygon, weight};
use crate::maths::order::Order;
use crate::scene::max_component;
use gathered::Gathered;
use node::{Node, Verdict};

/// A node is taken for its polygons where its estimated error is at most this
/// share of its own light. With 0.006 an emissive sphere of 10,000 triangles
/// is wrong by up to 0.6 %, with 0.003 by 0.35 %.
const RELATIVE_ERROR: f32 = 0.003;
/// ... or this share of all light, as estimated from [`COARSE_NODES`]: some
/// 40 such errors of either sign add up to less than 0.2 %. With 1e-5 twice as many
/// nodes are visited for the same total error.
const ABSOLUTE_ERROR: f32 = 2e-4;
/// ... or this share of the light if everything faced everything: where a lamp
/// is all but below the horizon, not all of its polygons are looked at.
const FLOOR: f32 = 2e-6;
/// Nodes near the root from which a point's light is first estimated.
const COARSE_NODES: usize = 16;
/// Spread of the normals against the spread in space (standard deviations,
/// the latter relative to the node's size) above which a node is split by
/// normals. Between 0.71, where the two sides of an emissive sheet are still
/// separated, and 1, where evenly mixed polygons begin to be.
const NORMAL_WEIGHT: f64 = 0.85;
/// The tree is balanced: 2^32 polygons are 32 deep.
const STACK: usize = 40;

/// See the module; the first node is the root.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Nodes that cover all polygons once.
    coarse: Vec<u32>,
}

impl Tree {
    /// Of at least [`COARSE_NODES`] polygons.
    pub(super) fn new(polygons: &[Polygon]) -> Self {
        let items: Vec<Item> = polygons.iter().map(Item::new).collect();
        let mut order: Vec<u32> = (0..polygons.len() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * polygons.len());
        nodes.push(Node::default());
        Builder {
            polygons,
            items: &items,
            nodes: &mut nodes,
        }
        .build(0, &mut order);
        let coarse = coarse_nodes(&nodes);
        Self { nodes, coarse }
    }

    /// Adds to a cut what reaches its point.
    pub(super) fn walk(&self, polygons: &[Polygon], cut: &mut LightCut) {
        let (position, normal) = (cut.position, cut.normal);
        let (mut estimate, mut potential) = (0.0, 0.0);
        for &node in &self.coarse {
            let (lit, at_most) = self.nodes[node as usize].estimate(position, normal);
            estimate += lit;
            potential += at_most;
        }
        let allowed = estimate * ABSOLUTE_ERROR + potential * FLOOR;
        let mut stack = [0_u32; STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let node = &self.nodes[index as usize];
            match node.judge(position, normal, RELATIVE_ERROR, allowed) {
                Verdict::Invisible => {}
                Verdict::Stands(irradiance) => cut.add(node.source(index), irradiance),
                Verdict::Open => match node.source(index) {
                    Source::Polygon(polygon) => {
                        cut.add_polygon(polygon, &polygons[polygon as usize]);
                    }
                    Source::Node(_) => {
                        stack[depth] = node.first + 1;
                        stack[depth + 1] = node.first;
                        depth += 2;
                    }
                },
            }
        }
    }

    /// A polygon of a node chosen by power with a uniform: its index, the
    /// probability of the choice, and what is left of the uniform.
    pub(super) fn descend(&self, node: u32, uniform: f32) -> (u32, f32, f32) {
        let (mut index, mut chance, mut rest) = (node, 1.0, uniform);
        loop {
            let node = &self.nodes[index as usize];
            if let Source::Polygon(polygon) = node.source(index) {
                return (polygon, chance, rest);
            }
            let [first, second] =
                [0, 1].map(|child| max_component(self.nodes[(node.first + child) as usize].flux));
            let share = first / (first + second);
            if rest < share {
                index = node.first;
                chance *= share;
                rest /= share;
            } else {
                index = node.first + 1;
                chance *= 1.0 - share;
                rest = (rest - share) / (1.0 - share);
            }
            rest = rest.clamp(0.0, 1.0 - f32::EPSILON / 2.0);
        }
    }
}

/// The level of the tree that has [`COARSE_NODES`] nodes, or its leaves.
fn coarse_nodes(nodes: &[Node]) -> Vec<u32> {
    let mut coarse = vec![0_u32];
    while coarse.len() < COARSE_NODES {
        coarse = coarse
            .iter()
            .flat_map(|&index| match nodes[index as usize].source(index) {
                Source::Polygon(_) => vec![index],
                Source::Node(_) => {
                    let first = nodes[index as usize].first;
                    vec![first, first + 1]
                }
            })
            .collect();
    }
    coarse
}

/// What splitting looks at: a polygon's place in space and among normals.
struct Item {
    /// Centroid and unit normal.
    coordinates: [f64; 6],
    weight: f64,
}

impl Item {
    fn new(polygon: &Polygon) -> Self {
        let (center, normal) = (polygon.centroid(), polygon.normal());
        Self {
            coordinates: [center.x, center.y, center.z, normal.x, normal.y, normal.z],
            weight: weight(polygon),
        }
    }
}

struct Builder<'a> {
    polygons: &'a [Polygon],
    items: &'a [Item],
    nodes: &'a mut Vec<Node>,
}

impl Builder<'_> {
    /// Fills node `index`, which has been reserved, with the polygons of `order`.
    fn build(&mut self, index: usize, order: &mut [u32]) -> Gathered {
        if let [polygon] = *order {
            let gathered = Gathered::of_polygon(&self.polygons[polygon as usize]);
            self.nodes[index] = Node::leaf(polygon, &gathered);
            return gathered;
        }
        let axis = self.split_axis(order);
        let middle = order.len() / 2;
        // Equal coordinates go by index, so that the halves are unique.
        order.select_nth_unstable_by(middle, |&a, &b| {
            let [key_a, key_b] = [a, b].map(|i| self.items[i as usize].coordinates[axis]);
            key_a.total_cmp(&key_b).then(a.cmp(&b))
        });
        let first = self.nodes.len();
        self.nodes.extend([Node::default(), Node::default()]);
        let (low, high) = order.split_at_mut(middle);
        // In which order the halves were left is the standard library's affair,
        // another version's another; sums over them are to be the same.
        low.sort_unstable();
        high.sort_unstable();
        let low = self.build(first, low);
        let high = self.build(first + 1, high);
        let gathered = low.joined(&high);
        let axis = gathered.normal_axis();
        let cosine = order
            .iter()
            .map(|&i| self.polygons[i as usize].normal().dot(axis))
            .fold(1.0, f64::at_most);
        self.nodes[index] = Node::inner(first as u32, &gathered, cosine);
        gathered
    }

    /// Coordinate, of space or of the normals, in which the polygons vary most.
    fn split_axis(&self, order: &[u32]) -> usize {
        let anchor = &self.items[order[0] as usize].coordinates;
        let (mut sum, mut squares, mut total) = ([0.0; 6], [0.0; 6], 0.0);
        for &index in order {
            let item = &self.items[index as usize];
            total += item.weight;
            for axis in 0..6 {
                let away = item.coordinates[axis] - anchor[axis];
                sum[axis] += item.weight * away;
                squares[axis] += item.weight * away * away;
            }
        }
        let variance: [f64; 6] = std::array::from_fn(|axis| {
            let mean = sum[axis] / total;
            squares[axis] / total - mean * mean
        });
        let squared_size = variance[0] + variance[1] + variance[2];
        let mut best = 0;
        let mut most = 0.0;
        for axis in 0..6 {
            let scale = if axis < 3 {
                1.0
            } else {
                NORMAL_WEIGHT * NORMAL_WEIGHT * squared_size
            };
            if variance[axis] * scale > most {
                most = variance[axis] * scale;
                best = axis;
            }
        }
        best
    }
}
