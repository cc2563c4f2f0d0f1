//! Rays, hits, and what a ray computes once before it meets boxes and triangles.

use super::lanes::Real;
use glam::{DVec3, Vec3};

/// A half line, in the coordinates of the scene after it was centred and
/// scaled into |coordinate| <= 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Finite; at most 1e6 away.
    pub(crate) origin: Vec3,
    /// Length between 1e-12 and 1e12; distances are measured in it.
    pub(crate) direction: Vec3,
    /// Only hits with 0 < t < `t_max` count; may be infinite.
    pub(crate) t_max: f32,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Position in the list that the tree was built from.
    pub(crate) triangle: u32,
    /// Distance in lengths of the ray's direction.
    pub(crate) t: f32,
    /// Weights of the triangle's three corners.
    pub(crate) barycentrics: [f32; 3],
}

/// Stands in for a direction component that is nearer to 0, so that its inverse
/// is finite and 0 x infinity never arises. Bounded from both sides: a box at
/// distance 4 divided by it must stay below the largest f32 (3e38), and against
/// the shortest direction (1e-12) it turns a ray by 1e-8, less than one rounding
/// of the direction.
const SMALLEST_COMPONENT: f32 = 1e-20;

/// An origin with a larger coordinate is first moved along its ray to the
/// sphere of this radius around the scene. The error of the triangle test grows
/// with the distance of the corners from the origin; at distances below 4 it is
/// 6e-7 (see [`super::triangle`]), and the boxes are padded by 9.5e-7 on account of it.
/// The sphere must hold the cube of half width 1: radius above sqrt(3).
const NEAR_RADIUS: f32 = 2.0;

/// Factor on a box's exit distance that makes the slab test conservative:
/// 1 + 2 gamma(3), gamma(n) = n e / (1 - n e), e = 2^-24 (Pharr, Jakob and
/// Humphreys, "Physically Based Rendering", section 6.8.2).
const EXIT_FACTOR: f32 = 1.0 + 2.0 * (3.0 * 0.5 * f32::EPSILON) / (1.0 - 3.0 * 0.5 * f32::EPSILON);

/// A ray with everything that does not depend on a box or triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RaySetup {
    pub(super) origin: [f32; 3],
    /// 1 / direction.
    pub(super) inverse: [f32; 3],
    /// 1 where the direction points down the axis, else 0: the bound (0 lower,
    /// 1 upper) that is met first.
    pub(super) near_bound: [usize; 3],
    /// Axes (kx, ky, kz) of Woop et al., kz the longest of the direction.
    pub(super) axes: [usize; 3],
    /// Sx, Sy, Sz of Woop et al.
    pub(super) shear: [f32; 3],
    /// From the moved origin.
    pub(super) t_max: f32,
    /// How far the origin was moved; 0 for most rays.
    t_moved: f64,
}

impl RaySetup {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        debug_assert!(
            ray.direction.length_squared() > 1e-25 && ray.direction.length_squared() < 1e25,
            "a ray's direction needs a length between 1e-12 and 1e12, got {}",
            ray.direction
        );
        let (origin, t_max, t_moved) = near_origin(ray);
        let direction = ray.direction.to_array();
        let (axes, shear) = shear(direction);
        Self {
            origin: origin.to_array(),
            inverse: direction.map(safe_inverse),
            near_bound: direction.map(|d| usize::from(d.is_sign_negative())),
            axes,
            shear,
            t_max,
            t_moved,
        }
    }

    #[cfg(test)]
    /// The origin after it was moved near the scene.
    pub(crate) fn origin(&self) -> Vec3 {
        Vec3::from_array(self.origin)
    }

    #[cfg(test)]
    /// The largest distance, from the moved origin.
    pub(crate) fn t_max(&self) -> f32 {
        self.t_max
    }

    /// Distance from the ray's own origin of a distance from the moved one.
    #[inline(always)]
    pub(crate) fn t_from_origin(&self, t: f32) -> f32 {
        (self.t_moved + f64::from(t)) as f32
    }

    /// Slab test, "from when to when is the ray in the box" (Kay and Kajiya
    /// 1986; Williams et al. 2005). `bounds` are \[axis\]\[0 lower, 1 upper\].
    /// Entry is at least 0; the ray misses the box where entry > exit.
    ///
    /// Monotone: (bound - origin) x inverse is two roundings, each of which
    /// keeps order, so a box inside another enters no earlier and exits no
    /// later, to the bit.
    #[inline(always)]
    pub(super) fn slab<R: Real>(&self, bound: impl Fn(usize, usize) -> R) -> (R, R) {
        let plane = |axis: usize, side: usize| {
            bound(axis, side)
                .sub(R::splat(self.origin[axis]))
                .mul(R::splat(self.inverse[axis]))
        };
        let near = |axis: usize| plane(axis, self.near_bound[axis] & 1);
        let far = |axis: usize| plane(axis, (self.near_bound[axis] & 1) ^ 1);
        let entry = near(0).max(near(1).max(near(2).max(R::splat(0.0))));
        let exit = far(0).min(far(1).min(far(2)));
        (entry, exit.mul(R::splat(EXIT_FACTOR)))
    }
}

/// Origin, `t_max` and distance moved, for a ray whose origin was brought near
/// the scene. Every triangle sees the same moved ray, so rounding it opens no
/// gap; and the move knows no tree.
#[inline(always)]
fn near_origin(ray: &Ray) -> (Vec3, f32, f64) {
    if ray.origin.abs().max_element() <= NEAR_RADIUS {
        return (ray.origin, ray.t_max, 0.0);
    }
    move_origin(ray)
}

/// The point of the sphere where the ray enters it; of a ray that passes by,
/// its point nearest to the scene. An origin that has the scene behind it
/// stays, for nothing is ahead of it.
fn move_origin(ray: &Ray) -> (Vec3, f32, f64) {
    let direction = ray.direction.as_dvec3();
    let origin = ray.origin.as_dvec3();
    let length_squared = direction.dot(direction);
    let t_nearest = -origin.dot(direction) / length_squared;
    let nearest: DVec3 = origin + direction * t_nearest;
    let radius_squared = f64::from(NEAR_RADIUS * NEAR_RADIUS);
    let half_chord_squared = (radius_squared - nearest.dot(nearest)) / length_squared;
    let half_chord = if half_chord_squared > 0.0 {
        half_chord_squared.sqrt()
    } else {
        0.0
    };
    let t_moved = t_nearest - half_chord;
    if t_moved <= 0.0 {
        return (ray.origin, ray.t_max, 0.0);
    }
    let moved = (origin + direction * t_moved).as_vec3();
    let t_max = (f64::from(ray.t_max) - t_moved) as f32;
    (moved, t_max, t_moved)
}

#[inline(always)]
fn safe_inverse(component: f32) -> f32 {
    let safe = if component.abs() < SMALLEST_COMPONENT {
        SMALLEST_COMPONENT.copysign(component)
    } else {
        component
    };
    1.0 / safe
}

/// Axes and shear of Woop et al., section 3.1. They also swap kx and ky where
/// the direction points down kz, to keep the winding; both windings are hit
/// here, so that is left out.
#[inline(always)]
fn shear(direction: [f32; 3]) -> ([usize; 3], [f32; 3]) {
    let [x, y, z] = direction.map(f32::abs);
    let axes = if x > y && x > z {
        [1, 2, 0]
    } else if y > z {
        [2, 0, 1]
    } else {
        [0, 1, 2]
    };
    let [dx, dy, dz] = axes.map(|axis| direction[axis]);
    (axes, [dx / dz, dy / dz, 1.0 / dz])
}
