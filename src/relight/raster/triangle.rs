//! One triangle's edge functions and its plane.

use super::screen::{Corner, Linear};
use super::{Fragment, NEAR};

/// A triangle whose plane passes the eye at less than this share of the
/// distance to its corners is seen edge-on and draws nothing. Below about
/// 1e-14 its side is rounding noise; at 1e-11 the depth at a sample, which is
/// off by up to 1e-14 x 1e11 of itself, is still good to 0.1 %, and the
/// triangle covers less than 1e-8 pixels across.
const EDGE_ON: f64 = 1e-11;

/// Largest 1/depth that is seen.
pub(super) const MAX_INVERSE_DEPTH: f64 = 1.0 / NEAR;

/// What a loop over samples needs to know about a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct TriangleSetup {
    /// Edge functions: all are positive inside. `edges[k]` belongs to the edge
    /// opposite the corner `order[k]`.
    pub(super) edges: [Linear; 3],
    /// A sample is inside where every edge function is at least this: 0 on
    /// edges that own their samples, else the smallest positive number.
    pub(super) limits: [f64; 3],
    /// 1/depth over the screen.
    pub(super) inverse_depth: Linear,
    /// The corners in the order of their place.
    order: [u8; 3],
    /// Whether the camera sees the counter-clockwise side.
    pub(super) front: bool,
}

impl TriangleSetup {
    /// `None` for a triangle that draws nothing: without area, edge-on, or
    /// with a corner that is not finite.
    ///
    /// With corners p, q, r in the order of their place, the edge functions
    /// are q x r, r x p and p x q: each edge is computed from its own two
    /// corners in one order, so the two triangles at an edge have the same
    /// coefficients but for the sign, bit by bit, and between them there is
    /// no crack. The plane, too, depends on the places of the corners alone,
    /// so triangles drawn twice have equal depths.
    pub(super) fn new(corners: [Corner; 3]) -> Option<Self> {
        let (order, is_even) = sorted(&corners);
        let places = order.map(|corner| corners[corner as usize]);
        let (inverse_depth, determinant) = sorted_plane(&places)?;
        let [p, q, r] = places;
        let sign = determinant.signum();
        let edges = [
            edge(&q, &r).scaled(sign),
            edge(&p, &r).scaled(-sign),
            edge(&p, &q).scaled(sign),
        ];
        Some(Self {
            edges,
            limits: edges.map(|edge| limit(&edge)),
            inverse_depth,
            order,
            // The normal points at the eye where it is against the corners.
            front: (determinant < 0.0) == is_even,
        })
    }

    /// 1/depth at a sample if the triangle is seen there, else 0.
    #[cfg(test)]
    pub(super) fn inverse_depth_inside(&self, x: f64, y: f64) -> f64 {
        let inside = (0..3).all(|k| self.edges[k].at(x, y) >= self.limits[k]);
        let inverse_depth = self.inverse_depth.at(x, y);
        if inside && inverse_depth < MAX_INVERSE_DEPTH {
            inverse_depth
        } else {
            0.0
        }
    }

    /// The same at several samples at once. The conditions are masks of bits,
    /// since the compiler makes branches of anything else, and no vectors
    /// (three times the time).
    #[inline(always)]
    pub(super) fn inverse_depths_inside<const N: usize>(
        &self,
        xs: &[f64; N],
        ys: &[f64; N],
    ) -> [f64; N] {
        let [e0, e1, e2] = self.edges;
        let [l0, l1, l2] = self.limits;
        let mut inverse_depths = [0.0; N];
        for (result, (&x, &y)) in inverse_depths.iter_mut().zip(xs.iter().zip(ys)) {
            let inverse_depth = self.inverse_depth.at(x, y);
            let is_seen = mask(e0.at(x, y) >= l0)
                & mask(e1.at(x, y) >= l1)
                & mask(e2.at(x, y) >= l2)
                & mask(inverse_depth < MAX_INVERSE_DEPTH);
            *result = f64::from_bits(inverse_depth.to_bits() & is_seen);
        }
        inverse_depths
    }

    /// Whether all points within `reach_x` and `reach_y` pixels of (x, y) lie
    /// outside of one edge.
    #[inline(always)]
    pub(super) fn misses(&self, x: f64, y: f64, reach_x: f64, reach_y: f64) -> bool {
        let outside =
            |edge: &Linear| edge.at(x, y) + (edge.a.abs() * reach_x + edge.b.abs() * reach_y) < 0.0;
        outside(&self.edges[0]) | outside(&self.edges[1]) | outside(&self.edges[2])
    }

    /// The fragment at a sample that is inside.
    pub(super) fn fragment(&self, triangle: u32, x: f64, y: f64) -> Fragment {
        let weights = [0, 1, 2].map(|k| self.edges[k].at(x, y));
        let sum = weights[0] + weights[1] + weights[2];
        let mut barycentrics = [1.0 / 3.0; 3];
        if sum > 0.0 {
            let scale = 1.0 / sum;
            for (corner, weight) in self.order.into_iter().zip(weights) {
                barycentrics[corner as usize] = (weight * scale) as f32;
            }
        }
        Fragment {
            triangle,
            barycentrics,
            depth: (1.0 / self.inverse_depth.at(x, y)) as f32,
            front: self.front,
        }
    }
}

/// All bits set, or none.
#[inline(always)]
fn mask(condition: bool) -> u64 {
    u64::from(condition).wrapping_neg()
}

/// Samples being drawn: the nearest surface at each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest<const N: usize> {
    /// 1/depth, 0 where nothing was drawn.
    pub(super) inverse_depths: [f64; N],
    /// Who drew it; 0 is nobody. As wide as the depths, so that one
    /// comparison selects both.
    pub(super) owners: [u64; N],
}

impl<const N: usize> Nearest<N> {
    /// Nothing was drawn.
    pub(super) const EMPTY: Self = Self {
        inverse_depths: [0.0; N],
        owners: [0; N],
    };

    /// Draws what is nearer than all before, by its 1/depths.
    #[inline(always)]
    pub(super) fn draw(&mut self, owner: u64, inverse_depths: &[f64; N]) {
        let old = self.inverse_depths.iter_mut().zip(&mut self.owners);
        for ((old, old_owner), new) in old.zip(inverse_depths) {
            let is_nearer = mask(*new > *old);
            *old = f64::from_bits((new.to_bits() & is_nearer) | (old.to_bits() & !is_nearer));
            *old_owner = (owner & is_nearer) | (*old_owner & !is_nearer);
        }
    }
}

/// The edge function of two corners, the first before the second. With the
/// difference in it the terms are small where the edge is short.
fn edge(first: &Corner, second: &Corner) -> Linear {
    first.cross(&second.minus(first))
}

/// Who owns a sample that lies exactly on an edge: the triangle that an
/// infinitely small step to the right (and a smaller one down) leads into.
/// Of two triangles on different sides of the edge that is exactly one.
fn limit(edge: &Linear) -> f64 {
    let owns = edge.a > 0.0 || (edge.a == 0.0 && edge.b > 0.0);
    if owns { 0.0 } else { f64::from_bits(1) }
}

/// Indices of the corners in the order of their place, and whether the order
/// is an even permutation.
fn sorted(corners: &[Corner; 3]) -> ([u8; 3], bool) {
    let before = |a: usize, b: usize| corners[a].is_before(&corners[b]);
    let (low, high, even) = if before(1, 0) {
        (1, 0, false)
    } else {
        (0, 1, true)
    };
    if before(2, low) {
        ([2, low as u8, high as u8], even)
    } else if before(2, high) {
        ([low as u8, 2, high as u8], !even)
    } else {
        ([low as u8, high as u8, 2], even)
    }
}

/// The plane of a triangle, for what lies beside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    /// 1/depth over the screen.
    pub(super) inverse_depth: Linear,
    /// Whether the camera sees the counter-clockwise side.
    pub(super) front: bool,
}

impl Plane {
    /// `None` for a triangle that draws nothing.
    pub(super) fn new(corners: &[Corner; 3]) -> Option<Self> {
        let (order, is_even) = sorted(corners);
        let places = order.map(|corner| corners[corner as usize]);
        let (inverse_depth, determinant) = sorted_plane(&places)?;
        Some(Self {
            inverse_depth,
            front: (determinant < 0.0) == is_even,
        })
    }

    /// Whether something with the given 1/depth at (x, y) lies within the
    /// relative tolerance of depth about this plane:
    /// |1/i - 1/p| <= t/i, times i p, for i the one's and p the plane's.
    pub(super) fn holds(&self, x: f64, y: f64, inverse_depth: f64, tolerance: f64) -> bool {
        let plane = self.inverse_depth.at(x, y);
        (inverse_depth - plane).abs() <= tolerance * plane
    }
}

/// Plane and determinant of three corners in the order of their place.
fn sorted_plane([p, q, r]: &[Corner; 3]) -> Option<(Linear, f64)> {
    let normal = q.minus(p).cross(&r.minus(p));
    let terms = [normal.a * p.x, normal.b * p.y, normal.c * p.w];
    let determinant = terms[0] + (terms[1] + terms[2]);
    let magnitude = terms[0].abs() + terms[1].abs() + terms[2].abs();
    // False, too, where a corner is not finite.
    let is_drawn = determinant.abs() > EDGE_ON * magnitude && magnitude.is_finite();
    is_drawn.then(|| (normal.scaled(1.0 / determinant), determinant))
}
