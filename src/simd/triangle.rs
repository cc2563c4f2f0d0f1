//! The one triangle test, and what decides between two hits.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
//! 2013: move the corners so that the ray starts at 0, shear them so that it
//! runs along its longest axis, and take the signs of three edge functions in
//! the plane that is left.
//!
//! *No gap.* A corner's place in that plane depends on the ray and the corner
//! alone. An edge function is the difference of two rounded products; rounding
//! keeps order, so where it is not 0 its sign is right for these places. The
//! two triangles at an edge compute negated bits of it. 0 counts as inside, so
//! nothing lies between the two. For the same reason their fallback to f64 for
//! edge functions of 0 is not needed: it would only choose one of the two, as
//! the rule of the lowest index does here.
//!
//! *Padding.* Rounding moves a corner in the plane by at most 6e-7 where
//! corners are less than 4 from the origin along each axis: 1.2e-7 for corner
//! minus origin, 2.4e-7 for the shear factor, 1.2e-7 for the product and 1.2e-7
//! for the corner's depth in it. A triangle may be hit that far outside of
//! itself, so its box is padded by [`PADDING`], or the box would refuse a hit
//! that the neighbour's test has left to this triangle.

use super::lanes::Real;
use super::ray::{Hit, RaySetup};
use glam::Vec3;

/// How far a triangle's box extends beyond its corners: 16 units in the last
/// place at 1. Bounded from below by the 6e-7 above (an error
/// bound: the tests for leaks pass even at 0), from above by the offset of
/// rays that leave a surface, which must clear it.
const PADDING: f32 = 16.0 * f32::EPSILON * 0.5;

/// A triangle's corners, \[axis\]\[corner\], so that an axis is one load. The
/// fourth number of an axis repeats the first corner.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Corners([[f32; 4]; 3]);

impl Corners {
    pub(crate) fn new([a, b, c]: [Vec3; 3]) -> Self {
        Self(std::array::from_fn(|axis| {
            [a[axis], b[axis], c[axis], a[axis]]
        }))
    }

    /// The padded box of the triangle, \[axis\]\[0 lower, 1 upper\].
    #[inline(always)]
    pub(crate) fn padded_box(&self) -> [[f32; 2]; 3] {
        self.0.map(|[a, b, c, _]| {
            let lower = Real::min(a, Real::min(b, c));
            let upper = Real::max(a, Real::max(b, c));
            [lower - PADDING, upper + PADDING]
        })
    }
}

/// When a ray is inside a box: entry <= exit, entry >= 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) entry: f32,
    pub(crate) exit: f32,
}

impl Interval {
    #[cfg(test)]
    /// When `ray` is inside the padded box of a triangle.
    #[inline(always)]
    pub(crate) fn of_triangle(ray: &RaySetup, corners: &Corners) -> Option<Self> {
        let bounds = corners.padded_box();
        let (entry, exit) = ray.slab(|axis, side| bounds[axis][side]);
        (entry <= exit).then_some(Self { entry, exit })
    }
}

/// A hit before its barycentrics are divided out.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    t: f32,
    edges: [f32; 3],
    determinant: f32,
}

/// The triangle test. `interval` is when the ray is in the triangle's padded
/// box; the distance is clamped to it, so that the order of boxes is the order
/// of hits however the distance was rounded.
#[inline(always)]
fn cross(ray: &RaySetup, corners: &Corners, interval: Interval) -> Option<Crossing> {
    let [kx, ky, kz] = ray.axes;
    let [sx, sy, sz] = ray.shear;
    let moved = |axis: usize| corners.0[axis].map(|corner| corner - ray.origin[axis]);
    let (along, depth) = (moved(kz), moved(kz).map(|d| sz * d));
    let (x, y) = (moved(kx), moved(ky));
    let x: [f32; 4] = std::array::from_fn(|i| x[i] - sx * along[i]);
    let y: [f32; 4] = std::array::from_fn(|i| y[i] - sy * along[i]);

    // Twice the areas of the triangles that the ray makes with each edge.
    let u = x[2] * y[1] - y[2] * x[1];
    let v = x[0] * y[2] - y[0] * x[2];
    let w = x[1] * y[0] - y[1] * x[0];
    let lowest = Real::min(u, Real::min(v, w));
    let highest = Real::max(u, Real::max(v, w));
    if lowest < 0.0 && highest > 0.0 {
        return None;
    }
    let determinant = u + v + w;
    if determinant == 0.0 {
        return None;
    }
    let t = (u * depth[0] + v * depth[1] + w * depth[2]) / determinant;
    let t = Real::min(Real::max(t, interval.entry), interval.exit);
    Some(Crossing {
        t,
        edges: [u, v, w],
        determinant,
    })
}

/// The best hit so far: the smallest t, of equal ones the lowest index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Best {
    t: f32,
    /// Index in the caller's list. 0 as long as there is no hit: no index is
    /// below it, so a hit at exactly `t_max` does not count.
    triangle: u32,
    crossing: Option<Crossing>,
}

impl Best {
    #[inline(always)]
    pub(crate) fn none(ray: &RaySetup) -> Self {
        Self {
            t: ray.t_max,
            triangle: 0,
            crossing: None,
        }
    }

    /// Hits farther than this no longer matter.
    #[inline(always)]
    pub(crate) fn t(&self) -> f32 {
        self.t
    }

    /// Tests a triangle; `index` is only read where it is hit near enough.
    /// Returns whether it is the best now.
    #[inline(always)]
    pub(crate) fn offer(
        &mut self,
        ray: &RaySetup,
        corners: &Corners,
        interval: Interval,
        index: impl Fn() -> u32,
    ) -> bool {
        let Some(crossing) = cross(ray, corners, interval) else {
            return false;
        };
        let t = crossing.t;
        if !(t > 0.0 && t <= self.t) {
            return false;
        }
        let triangle = index();
        if t < self.t || triangle < self.triangle {
            *self = Self {
                t,
                triangle,
                crossing: Some(crossing),
            };
            return true;
        }
        false
    }

    #[inline(always)]
    pub(crate) fn hit(&self, ray: &RaySetup) -> Option<Hit> {
        self.crossing.map(|crossing| Hit {
            triangle: self.triangle,
            t: ray.t_from_origin(self.t),
            barycentrics: crossing.edges.map(|edge| edge / crossing.determinant),
        })
    }
}

/// Whether `ray` hits the triangle at all: the shadow query.
#[inline(always)]
pub(crate) fn hits(ray: &RaySetup, corners: &Corners, interval: Interval) -> bool {
    cross(ray, corners, interval).is_some_and(|crossing| crossing.t > 0.0 && crossing.t < ray.t_max)
}
