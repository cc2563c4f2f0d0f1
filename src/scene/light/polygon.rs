//! A flat polygon that emits on one side: a triangle or a parallelogram.
//!
//! What it sends to a point has a closed form; only what stands in between
//! has to be sampled. Corners are kept and form factors are computed in double
//! precision: Lambert's sum cancels to a share of about (size / distance), and
//! an area light may lie far outside the scene.

mod lambert;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

/// A point is on the polygon's plane, and sees nothing of it, up to this share
/// of the largest coordinate: a point of a triangle is rounded in single
/// precision about three times, each time by up to half of `f32::EPSILON`.
/// Tenfold, a lamp 1e-5 above a floor would begin to miss it.
const ON_PLANE: f64 = 2.0 * f32::EPSILON as f64;

/// Size / distance below which a polygon acts like a point: the error is at
/// most its square, 1e-8, below the rounding of the result; Lambert's sum in
/// double precision has an error of about 1e-16 / 1e-4 there.
const POINT_LIKE: f64 = 1e-4;

/// A triangle or parallelogram of constant radiance on its front side, from
/// which its corners run counter-clockwise. Placed units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Polygon {
    corner: DVec3,
    edge_u: DVec3,
    edge_v: DVec3,
    shape: Shape,
    /// Unit normal of the front; zero for a polygon without area.
    normal: DVec3,
    area: f64,
    /// Square of a length that no two points of the polygon exceed.
    squared_size: f64,
    radiance: Vec3,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Triangle,
    Parallelogram,
}

impl Polygon {
    /// The triangle of three corners; `radiance` in W/(m2 sr).
    pub(crate) fn triangle(corners: [Vec3; 3], radiance: Vec3) -> Self {
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        Self::new(Shape::Triangle, a, [b - a, c - a], radiance)
    }

    /// The parallelogram of a corner and the two edges from it; its front is
    /// the side of `edge_u` x `edge_v`; `radiance` in W/(m2 sr).
    pub(crate) fn parallelogram(
        corner: DVec3,
        edge_u: DVec3,
        edge_v: DVec3,
        radiance: Vec3,
    ) -> Self {
        Self::new(Shape::Parallelogram, corner, [edge_u, edge_v], radiance)
    }

    fn new(shape: Shape, corner: DVec3, [edge_u, edge_v]: [DVec3; 2], radiance: Vec3) -> Self {
        let cross = edge_u.cross(edge_v);
        let doubled = cross.length();
        let squares = edge_u.length_squared() + edge_v.length_squared();
        let (area, squared_size) = match shape {
            Shape::Triangle => (0.5 * doubled, squares + squares),
            Shape::Parallelogram => (
                doubled,
                squares + 2.0 * edge_u.dot(edge_v).abs(), // the longer diagonal's
            ),
        };
        Self {
            corner,
            edge_u,
            edge_v,
            shape,
            normal: cross.normalize_or_zero(),
            area,
            squared_size,
            radiance,
        }
    }

    /// W/(m2 sr) on the front side.
    pub(crate) fn radiance(&self) -> Vec3 {
        self.radiance
    }

    /// Unit normal of the front; zero for a polygon without area.
    pub(crate) fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Area, placed units squared.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// Mean of its points.
    pub(crate) fn centroid(&self) -> DVec3 {
        let share = match self.shape {
            Shape::Triangle => 1.0 / 3.0,
            Shape::Parallelogram => 0.5,
        };
        self.corner + (self.edge_u + self.edge_v) * share
    }

    /// Corners counter-clockwise seen from the front, the last one repeated
    /// for a triangle, and how many there are.
    pub(crate) fn corners(&self) -> ([DVec3; 4], usize) {
        let (after_u, before_corner) = (self.corner + self.edge_u, self.corner + self.edge_v);
        match self.shape {
            Shape::Triangle => ([self.corner, after_u, before_corner, before_corner], 3),
            Shape::Parallelogram => (
                [self.corner, after_u, after_u + self.edge_v, before_corner],
                4,
            ),
        }
    }

    /// Share of pi x radiance that arrives as irradiance at a point of unit
    /// `normal` if nothing is in the way, 0 to 1: the form factor from the
    /// point to the polygon. Exactly 0 behind the polygon's plane and on it,
    /// and where the polygon is wholly below the horizon.
    pub(crate) fn form_factor(&self, position: Vec3, normal: Vec3) -> f32 {
        let position = position.as_dvec3();
        let to_corner = self.corner - position;
        let height = -self.normal.dot(to_corner);
        let largest = position.abs().max_element() + to_corner.abs().max_element();
        if height > ON_PLANE * largest {
            self.form_factor_in_front(to_corner, height, normal.as_dvec3())
        } else {
            0.0
        }
    }

    /// [`Self::form_factor`] of a point at a positive `height` over the front.
    fn form_factor_in_front(&self, to_corner: DVec3, height: f64, normal: DVec3) -> f32 {
        if self.squared_size < POINT_LIKE * POINT_LIKE * to_corner.length_squared() {
            return self.form_factor_from_afar(to_corner, height, normal);
        }
        let (after_u, before_corner) = (to_corner + self.edge_u, to_corner + self.edge_v);
        let factor = match self.shape {
            Shape::Triangle => lambert::form_factor([to_corner, after_u, before_corner], normal),
            Shape::Parallelogram => lambert::form_factor(
                [to_corner, after_u, after_u + self.edge_v, before_corner],
                normal,
            ),
        };
        factor as f32
    }

    /// A cos cos / (pi r^2) at the centroid, of a polygon that is tiny against
    /// its distance r.
    fn form_factor_from_afar(&self, to_corner: DVec3, height: f64, normal: DVec3) -> f32 {
        let to_centroid = self.centroid() - self.corner + to_corner;
        let squared = to_centroid.length_squared();
        let above = normal.dot(to_centroid);
        if above > 0.0 {
            (self.area * above * height / (std::f64::consts::PI * squared * squared)) as f32
        } else {
            0.0
        }
    }

    /// A point of the part above the horizon of `normal` at `position`, uniform
    /// over that part's area, from two uniforms; and that area. `None` where the
    /// polygon is wholly below.
    pub(super) fn sample_above(
        &self,
        position: DVec3,
        normal: DVec3,
        u: [f32; 2],
    ) -> Option<(DVec3, f64)> {
        let (corners, count) = self.corners();
        let corners = corners.map(|corner| corner - position);
        let heights = corners.map(|corner| normal.dot(corner));
        let above = heights[..count].iter().filter(|&&h| h > 0.0).count();
        if above == count {
            return Some((self.sample_point(u), self.area));
        }
        if above == 0 {
            return None;
        }
        let (clipped, count) = lambert::above_horizon(&corners[..count], &heights[..count]);
        let (point, area) = point_of_fan(&clipped[..count], u);
        (area > 0.0).then_some((point + position, area))
    }

    /// [`Self::sample_point`] rounded.
    #[cfg(test)]
    pub(crate) fn sample(&self, u: [f32; 2]) -> Vec3 {
        self.sample_point(u).as_vec3()
    }

    /// A point of the polygon with uniform density over its area, from two
    /// uniforms. The map of the square to the polygon keeps neighbours together.
    pub(super) fn sample_point(&self, u: [f32; 2]) -> DVec3 {
        let [a, b] = u.map(f64::from);
        let (along_u, along_v) = match self.shape {
            Shape::Parallelogram => (a, b),
            Shape::Triangle => {
                let root = a.sqrt();
                (root * (1.0 - b), root * b)
            }
        };
        self.corner + self.edge_u * along_u + self.edge_v * along_v
    }
}

/// A point uniform over the area of a convex polygon, cut as a fan from its
/// first corner, and the area.
fn point_of_fan(corners: &[DVec3], [u, v]: [f32; 2]) -> (DVec3, f64) {
    let apex = corners[0];
    let mut areas = [0.0; lambert::MOST_CORNERS];
    let mut total = 0.0;
    for (k, edge) in corners[1..].windows(2).enumerate() {
        total += 0.5 * (edge[0] - apex).cross(edge[1] - apex).length();
        areas[k] = total;
    }
    let last = corners.len() - 3;
    let target = f64::from(u) * total;
    let k = areas[..last].iter().filter(|&&area| area <= target).count();
    let before = if k == 0 { 0.0 } else { areas[k - 1] };
    let width = areas[k] - before;
    let rest = if width > 0.0 {
        (target - before) / width
    } else {
        0.0
    };
    let root = rest.clamp(0.0, 1.0).sqrt();
    let along = f64::from(v) * root;
    let point = apex + (corners[k + 1] - apex) * (root - along) + (corners[k + 2] - apex) * along;
    (point, total)
}
