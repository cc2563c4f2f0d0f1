//! Traversal of a tree of eight-wide nodes, one ray at a time (Wald, Benthin
//! and Boulos, "Getting Rid of Packets", 2008): eight boxes against one ray in
//! the lanes, triangles one by one.

use super::Level;
#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2Lanes, Sse2Lanes};
use super::lanes::{Lanes, Real, ScalarLanes};
use super::ray::{Hit, Ray, RaySetup};
use super::triangle::{Best, Corners, Interval, hits};

/// Children of a node.
pub(crate) const CHILDREN: usize = 8;

/// Set in a child that is a triangle.
pub(crate) const LEAF: u32 = 1 << 31;

/// Room for the nodes that a ray has still to visit. A tree needs at most
/// seven a level and says how many at build time ([`WideTree::new`]). More
/// would only cost clearing it once a job.
const STACK_SIZE: usize = 256;

/// Eight boxes and what is in them: four cache lines, uncompressed.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    /// \[axis\]\[0 lower, 1 upper\]\[child\]. A triangle's box is its padded box.
    bounds: [[[f32; CHILDREN]; 2]; 3],
    /// Index of a node, or of a triangle in tree order.
    children: [u32; CHILDREN],
    /// Bit i is set where child i is a triangle.
    leaf_mask: u32,
}

impl WideNode {
    /// Eight empty lanes. An empty lane is a box that is inside out to
    /// infinity: every ray enters it at infinity and leaves it at -infinity.
    pub(crate) const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; CHILDREN], [f32::NEG_INFINITY; CHILDREN]]; 3],
        children: [0; CHILDREN],
        leaf_mask: 0,
    };

    /// Fills a lane with a child, which is a node's index, or a triangle's | [`LEAF`].
    pub(crate) fn set(&mut self, lane: usize, child: u32, bounds: [[f32; 2]; 3]) {
        self.children[lane] = child & !LEAF;
        self.leaf_mask |= u32::from(child & LEAF != 0) << lane;
        for (axis, [lower, upper]) in bounds.into_iter().enumerate() {
            self.bounds[axis][0][lane] = lower;
            self.bounds[axis][1][lane] = upper;
        }
    }

    /// The box around all children.
    pub(crate) fn union(&self) -> [[f32; 2]; 3] {
        self.bounds.map(|[lower, upper]| {
            [
                lower.into_iter().fold(f32::INFINITY, Real::min),
                upper.into_iter().fold(f32::NEG_INFINITY, Real::max),
            ]
        })
    }

    /// Number of children that are nodes.
    fn inner_count(&self) -> usize {
        (0..CHILDREN)
            .filter(|&lane| {
                self.leaf_mask & (1 << lane) == 0
                    && self.bounds[0][0][lane] <= self.bounds[0][1][lane]
            })
            .count()
    }
}

/// Nodes, and triangles in the order of the tree. Node 0 is the root; without
/// triangles there is none.
#[derive(Debug, Default)]
pub(crate) struct WideTree {
    nodes: Vec<WideNode>,
    corners: Vec<Corners>,
    /// The caller's index of each triangle in tree order.
    indices: Vec<u32>,
}

type Stack = [u64; STACK_SIZE];

impl WideTree {
    /// `nodes` have their children after them. `None` where a ray could have
    /// more nodes to visit than the stack has room for.
    pub(crate) fn new(
        nodes: Vec<WideNode>,
        corners: Vec<Corners>,
        indices: Vec<u32>,
    ) -> Option<Self> {
        // Entries that a ray may have on the stack when it reaches a node, and
        // while it is in that node.
        let mut waiting = vec![0_usize; nodes.len()];
        for (position, node) in nodes.iter().enumerate() {
            let inner_count = node.inner_count();
            let here = waiting[position] + inner_count;
            if here > STACK_SIZE {
                return None;
            }
            for lane in 0..CHILDREN {
                let child = node.children[lane] as usize;
                if node.leaf_mask & (1 << lane) == 0 && child > position {
                    waiting[child] = here - 1;
                }
            }
        }
        Some(Self {
            nodes,
            corners,
            indices,
        })
    }

    #[cfg(test)]
    /// Triangles in tree order.
    pub(crate) fn corners(&self) -> &[Corners] {
        &self.corners
    }

    #[cfg(test)]
    /// The caller's index of each triangle in tree order.
    pub(crate) fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// The nearest hit of every ray.
    pub(crate) fn closest_many(&self, level: Level, rays: &[Ray], found: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), found.len(), "one answer for each ray");
        match level.available() {
            // SAFETY: `available` found AVX2.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { closest_avx2(self, rays, found) },
            #[cfg(target_arch = "x86_64")]
            Level::Sse2 => closest_all::<Sse2Lanes>(self, rays, found),
            _ => closest_all::<ScalarLanes>(self, rays, found),
        }
    }

    /// Whether anything is hit, for every ray.
    pub(crate) fn occluded_many(&self, level: Level, rays: &[Ray], found: &mut [bool]) {
        assert_eq!(rays.len(), found.len(), "one answer for each ray");
        match level.available() {
            // SAFETY: `available` found AVX2.
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => unsafe { occluded_avx2(self, rays, found) },
            #[cfg(target_arch = "x86_64")]
            Level::Sse2 => occluded_all::<Sse2Lanes>(self, rays, found),
            _ => occluded_all::<ScalarLanes>(self, rays, found),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn closest_avx2(tree: &WideTree, rays: &[Ray], found: &mut [Option<Hit>]) {
    closest_all::<Avx2Lanes>(tree, rays, found);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn occluded_avx2(tree: &WideTree, rays: &[Ray], found: &mut [bool]) {
    occluded_all::<Avx2Lanes>(tree, rays, found);
}

#[inline(always)]
fn closest_all<L: Lanes>(tree: &WideTree, rays: &[Ray], found: &mut [Option<Hit>]) {
    let mut stack = [0; STACK_SIZE];
    for (ray, found) in rays.iter().zip(found) {
        *found = closest::<L>(tree, &RaySetup::new(ray), &mut stack);
    }
}

#[inline(always)]
fn occluded_all<L: Lanes>(tree: &WideTree, rays: &[Ray], found: &mut [bool]) {
    let mut stack = [0; STACK_SIZE];
    for (ray, found) in rays.iter().zip(found) {
        *found = occluded::<L>(tree, &RaySetup::new(ray), &mut stack);
    }
}

/// Lanes of a node that the ray is in before `t_max`, and when.
#[inline(always)]
fn enter<L: Lanes>(node: &WideNode, ray: &RaySetup, t_max: f32) -> (u32, L, L) {
    let (entry, exit) = ray.slab(|axis, side| L::load(&node.bounds[axis][side]));
    let mask = entry.le_mask(exit.min(L::splat(t_max)));
    (mask, entry, exit)
}

/// The set bits of a mask, lowest first.
#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (mask != 0).then(|| {
            let bit = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            bit & (CHILDREN - 1)
        })
    })
}

/// A ray visits 8.3 nodes and tests 2.2 triangles in a room of 75,000 triangles
/// (cosine rays from the surface), 9.4 and 3.5 in a bumpy blob; a shadow ray from
/// a room's camera 4.5 and 0.6.
///
/// Tried without a gain beyond noise of 10 %: triangles before the order of
/// children (medians of five runs 1.82 and 1.84 times obvhs's traversal, this
/// 1.87 and 1.82), the next child through the stack, prefetching triangles, all
/// children or the nearest child, and skipping the stores of nodes where no lane
/// is entered. Random order makes the time one of branches and memory, which is
/// why AVX2 is only 1.2 times the scalar lanes here.
#[inline(always)]
fn closest<L: Lanes>(tree: &WideTree, ray: &RaySetup, stack: &mut Stack) -> Option<Hit> {
    let mut best = Best::none(ray);
    let mut node = tree.nodes.first()?;
    let mut waiting = 0;
    loop {
        let (mask, entry, exit) = enter::<L>(node, ray, best.t());
        let entries = entry.store();
        let exits = exit.store();
        // The nearest child is next, without a detour through the stack.
        let mut next = NOTHING;
        let first = waiting;
        for lane in bits(mask & !node.leaf_mask) {
            let child = pack(entries[lane], node.children[lane]);
            if next != NOTHING {
                push_sorted(stack, first, &mut waiting, next.max(child));
            }
            next = next.min(child);
        }
        for lane in bits(mask & node.leaf_mask) {
            let interval = Interval {
                entry: entries[lane],
                exit: exits[lane],
            };
            let triangle = node.children[lane] as usize;
            best.offer(ray, &tree.corners[triangle], interval, || {
                tree.indices[triangle]
            });
        }
        node = loop {
            let (entry, index) = unpack(next);
            if entry <= best.t() {
                break &tree.nodes[index];
            }
            if waiting == 0 {
                return best.hit(ray);
            }
            waiting -= 1;
            next = stack[waiting];
        };
    }
}

/// No node: behind all others. As a distance it is NaN, which is not within any.
const NOTHING: u64 = u64::MAX;

/// Entry distance and node in one number that orders by distance: an entry is
/// never below 0 nor -0, and such floats order like their bits.
#[inline(always)]
fn pack(entry: f32, node: u32) -> u64 {
    (u64::from(entry.to_bits()) << 32) | u64::from(node)
}

#[inline(always)]
fn unpack(packed: u64) -> (f32, usize) {
    (
        f32::from_bits((packed >> 32) as u32),
        packed as u32 as usize,
    )
}

/// Inserts a packed node among those of its parent, which begin at `first`, so
/// that the nearest is on top.
#[inline(always)]
fn push_sorted(stack: &mut Stack, first: usize, waiting: &mut usize, packed: u64) {
    let mut place = *waiting;
    while place > first && stack[place - 1] < packed {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = packed;
    *waiting += 1;
}

#[inline(always)]
fn occluded<L: Lanes>(tree: &WideTree, ray: &RaySetup, stack: &mut Stack) -> bool {
    let Some(mut node) = tree.nodes.first() else {
        return false;
    };
    let mut waiting = 0;
    loop {
        let (mask, entry, exit) = enter::<L>(node, ray, ray.t_max);
        let leaves = mask & node.leaf_mask;
        if leaves != 0 {
            let entries = entry.store();
            let exits = exit.store();
            for lane in bits(leaves) {
                let interval = Interval {
                    entry: entries[lane],
                    exit: exits[lane],
                };
                let triangle = node.children[lane] as usize;
                if hits(ray, &tree.corners[triangle], interval) {
                    return true;
                }
            }
        }
        for lane in bits(mask & !node.leaf_mask) {
            stack[waiting] = u64::from(node.children[lane]);
            waiting += 1;
        }
        if waiting == 0 {
            return false;
        }
        waiting -= 1;
        node = &tree.nodes[stack[waiting] as usize];
    }
}
