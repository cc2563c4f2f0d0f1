//! One node of the tree: what its polygons send into the distance, and how
//! wrong that is at a point.
//!
//! A polygon at v from a point of normal n gives the irradiance
//! pi L F = flux a b / |v|^4 with a = n . v and b = -N . v. A node expands
//! its polygons' sum about its centre: a b / |v|^4 with the mean normal, plus
//! the second derivatives with the covariance of positions and the first with
//! that of positions and normals (curved surfaces). Without these terms a cut
//! of as many nodes has ten times the error. Where polygons face away or lie
//! below the horizon, a and b are taken as uniform about their means with
//! their variances, and only positive ones count.

use std::sync::LazyLock;

use glam::{Mat3, Vec3};

use super::gathered::Gathered;
use crate::maths::functions::{cos_f32, sin_f32};
use crate::maths::order::Order;
use crate::scene::light::emitters::cut::Source;

/// Directions in which the polygons' response is known when a node is made.
pub(super) const PROBES: usize = 32;

/// Error of the expansion, as a share of flux / r^2, over (RMS size / r)^3.
const SIZE_ERROR: f32 = 1.0;

/// Error of the mean of positive values, where only some are, over the half
/// width of their distribution: 0.02 for a disk, 0.07 for two points, against
/// the uniform distribution that is assumed.
const CLIPPED_ERROR: f32 = 0.1;

/// Weight of the probes' error for mixed normals. Such errors have one sign (of
/// few polygons less light is expected than comes) and add up over thousands
/// of nodes: a soup of 10,000 triangles is wrong by up to 1.1 % with a quarter
/// of this, by 0.25 % with this.
const MIXED_ERROR: f32 = 16.0;

/// Up to this spread of normals [`CLIPPED_ERROR`] holds for them; beyond, the
/// probes tell, which are too far apart for less.
const NARROW: f32 = 0.5;

/// A range of polygons as one source.
#[derive(Debug, Clone, Copy, Default)]
pub(in super::super) struct Node {
    /// Mean position of the light.
    center: Vec3,
    /// No point is farther from the centre.
    radius: f32,
    /// Sum of radiance x area, W/sr.
    pub(super) flux: Vec3,
    /// That of the polygons' weights.
    weight: f32,
    /// Mean of the unit normals.
    mean_normal: Vec3,
    /// Unit vector along the mean normal.
    axis: Vec3,
    /// Sine of the largest angle between the axis and a normal; 2 from 90 degrees.
    spread: f32,
    /// Covariance of the positions.
    positions: Mat3,
    /// Mean of (position - centre) (normal - mean)^T.
    curvature: Mat3,
    /// Covariance of the normals.
    normals: Mat3,
    /// RMS error over all directions of the share of light they get; for
    /// normals that spread beyond [`NARROW`].
    face_error: f32,
    /// Mean square distance from the centre.
    squared_size: f32,
    /// Error of one expansion for all channels: distance of the channels'
    /// centres, and of their mean normals, from the common ones.
    color_shift: f32,
    color_turn: f32,
    /// Index of the first of two children, or of the polygon of a leaf.
    pub(super) first: u32,
    is_leaf: bool,
}

/// What to do with a node at a point.
pub(super) enum Verdict {
    /// Nothing of it reaches the point.
    Invisible,
    /// The node stands for its polygons, with this irradiance, W/m2.
    Stands(Vec3),
    /// Its parts have to be looked at.
    Open,
}

impl Node {
    pub(super) fn leaf(polygon: u32, gathered: &Gathered) -> Self {
        Self {
            first: polygon,
            is_leaf: true,
            ..Self::inner(0, gathered, 1.0)
        }
    }

    /// `cosine`: the smallest between a normal and the normals' axis.
    pub(super) fn inner(first: u32, gathered: &Gathered, cosine: f64) -> Self {
        let center = gathered.center();
        let positions = gathered.position_covariance();
        let mut node = Self {
            center: center.as_vec3(),
            radius: gathered.radius_about(center) as f32,
            flux: gathered.flux().as_vec3(),
            weight: gathered.weight() as f32,
            mean_normal: gathered.mean_normal().as_vec3(),
            axis: gathered.normal_axis().as_vec3(),
            spread: if cosine > 0.0 {
                (1.0 - cosine * cosine).at_least(0.0).sqrt() as f32
            } else {
                2.0
            },
            positions: positions.as_mat3(),
            curvature: gathered.curvature().as_mat3(),
            normals: gathered.normal_covariance().as_mat3(),
            face_error: 0.0,
            squared_size: (positions.x_axis.x + positions.y_axis.y + positions.z_axis.z) as f32,
            color_shift: gathered.color_shift() as f32,
            color_turn: gathered.color_turn() as f32,
            first,
            is_leaf: false,
        };
        if node.spread > NARROW {
            node.face_error = node.probed_error(gathered.response());
        }
        node
    }

    pub(super) fn source(&self, index: u32) -> Source {
        if self.is_leaf {
            Source::Polygon(self.first)
        } else {
            Source::Node(index)
        }
    }

    fn probed_error(&self, response: &[f32; PROBES]) -> f32 {
        let mut sum = 0.0;
        for (index, &exact) in response.iter().enumerate() {
            let error = self.face(probe(index)) - exact / self.weight;
            sum += error * error;
        }
        (sum / PROBES as f32).sqrt()
    }

    /// Mean over the polygons of max(0, normal . w), for a unit vector w.
    fn face(&self, w: Vec3) -> f32 {
        let variance = w.dot(self.normals * w);
        mean_of_positive(self.mean_normal.dot(w), half_width(variance))
    }

    /// Rough irradiance of the brightest channel, rather too low than too high,
    /// and what it were if all faced each other.
    pub(super) fn estimate(&self, position: Vec3, normal: Vec3) -> (f32, f32) {
        let to_center = self.center - position;
        let squared = to_center.length_squared() + self.radius * self.radius;
        let inverse = 1.0 / squared.sqrt();
        let potential = self.weight * inverse * inverse;
        let above = normal.dot(to_center) * inverse;
        if above > 0.0 {
            let face = self.face(to_center * -inverse);
            (potential * face * above, potential)
        } else {
            (0.0, potential)
        }
    }

    /// Whether the node may stand for its polygons: its error is at most
    /// `relative` of its irradiance or `allowed`, W/m2.
    pub(super) fn judge(
        &self,
        position: Vec3,
        normal: Vec3,
        relative: f32,
        allowed: f32,
    ) -> Verdict {
        let to_center = self.center - position;
        let squared = to_center.length_squared();
        let above = normal.dot(to_center);
        if above <= -self.radius {
            return Verdict::Invisible;
        }
        if squared <= self.radius * self.radius {
            return Verdict::Open;
        }
        let inverse = 1.0 / squared.sqrt();
        let direction = to_center * inverse;
        // sin(a + b) <= sin a + sin b for the angles of the normals about their
        // axis and of the node's points about its centre.
        let turn = self.spread + self.radius * inverse;
        let facing = -self.axis.dot(direction);
        if facing <= -turn {
            return Verdict::Invisible;
        }
        let scale = self.weight * inverse * inverse;
        let angle = (self.squared_size * inverse * inverse).sqrt();
        let error = SIZE_ERROR * angle * angle * angle + self.color_shift * inverse;
        if scale * error > (relative * scale).at_least(allowed) {
            return Verdict::Open;
        }
        let (value, error) = if facing >= turn && above >= self.radius {
            let value = self.expanded(direction, normal, inverse);
            (value, error + self.color_turn)
        } else {
            let (value, clipped) = self.clipped(direction, normal, inverse);
            (value, error + clipped + self.color_turn)
        };
        if scale * error <= (relative * scale * value).at_least(allowed) {
            Verdict::Stands(self.flux * (value.at_least(0.0) * inverse * inverse))
        } else {
            Verdict::Open
        }
    }

    /// Irradiance over flux / r^2 of a node that is all in front and above.
    /// With v of unit length, C the positions' covariance, D the curvature,
    /// both in units of the distance, and m the mean normal:
    /// a b - a tr D - n D v + 4 a v D v
    /// - n C m - 4 b n C v + 4 a m C v - 2 a b tr C + 12 a b v C v.
    fn expanded(&self, v: Vec3, n: Vec3, inverse: f32) -> f32 {
        let m = self.mean_normal;
        let (a, b) = (n.dot(v), -m.dot(v));
        let (cv, cn) = (self.positions * v, self.positions * n);
        let dv = self.curvature * v;
        let trace = self.curvature.x_axis.x + self.curvature.y_axis.y + self.curvature.z_axis.z;
        let first = 4.0 * a * v.dot(dv) - a * trace - n.dot(dv);
        let second = 12.0 * a * b * v.dot(cv) - 2.0 * a * b * self.squared_size - m.dot(cn)
            + 4.0 * (a * m.dot(cv) - b * n.dot(cv));
        a * b + inverse * (first + inverse * second)
    }

    /// Irradiance over flux / r^2 of a node that is partly turned away or
    /// below the horizon, and its error.
    fn clipped(&self, v: Vec3, n: Vec3, inverse: f32) -> (f32, f32) {
        let m = self.mean_normal;
        let above_half = half_width(n.dot(self.positions * n)) * inverse;
        // Variance of N . (v + x / r) about m . v.
        let facing_variance = v.dot(self.normals * v)
            + inverse * 2.0 * m.dot(self.curvature * v)
            + inverse * inverse * m.dot(self.positions * m);
        let facing_half = half_width(facing_variance);
        let a = n.dot(v);
        let b = -m.dot(v);
        let facing = mean_of_positive(b, facing_half);
        let above = mean_of_positive(a, above_half);
        let facing_error = if self.spread > NARROW {
            MIXED_ERROR * self.face_error
        } else if b < facing_half {
            CLIPPED_ERROR * facing_half
        } else {
            0.0
        };
        let above_error = if a < above_half {
            CLIPPED_ERROR * above_half
        } else {
            0.0
        };
        let error = facing_error * above + above_error * facing;
        let share = share_of_positive(a, above_half) * share_of_positive(b, facing_half);
        let bend = self.expanded(v, n, inverse) - a * b;
        (facing * above + share * bend, error)
    }
}

/// Half width of the uniform distribution of a variance.
fn half_width(variance: f32) -> f32 {
    (3.0 * variance.at_least(0.0)).sqrt()
}

/// Mean of max(0, x) for x uniform within `half` of `mean`.
fn mean_of_positive(mean: f32, half: f32) -> f32 {
    if mean >= half {
        mean
    } else if mean <= -half {
        0.0
    } else {
        (mean + half) * (mean + half) / (4.0 * half)
    }
}

/// Share of x uniform within `half` of `mean` that is positive.
fn share_of_positive(mean: f32, half: f32) -> f32 {
    if mean >= half {
        1.0
    } else if mean <= -half {
        0.0
    } else {
        (mean + half) / (2.0 * half)
    }
}

/// Direction `index` of the probes.
pub(super) fn probe(index: usize) -> Vec3 {
    PROBE_DIRECTIONS[index]
}

/// Spiral over the sphere that turns by the golden angle.
static PROBE_DIRECTIONS: LazyLock<[Vec3; PROBES]> = LazyLock::new(|| {
    /// pi (3 - sqrt 5), radians.
    const GOLDEN_ANGLE: f32 = 2.399_963_2;
    std::array::from_fn(|index| {
        let height = 1.0 - (2 * index + 1) as f32 / PROBES as f32;
        let radius = (1.0 - height * height).sqrt();
        let angle = GOLDEN_ANGLE * index as f32;
        Vec3::new(radius * cos_f32(angle), radius * sin_f32(angle), height)
    })
});
