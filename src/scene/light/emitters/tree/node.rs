//! One node of the tree: what its polygons send into the distance, and how
//! wrong that is at a point.

use glam::{DVec3, Vec3};

use super::super::cut::Source;
use crate::scene::light::Polygon;
use crate::scene::light::emitters::weight;

/// Directions in which the polygons' response is known when a node is made.
const PROBES: usize = 32;

/// Error of taking all light from the centre, as a share of flux / r^2, over
/// (RMS size / r)^2. A uniform lamp parallel to the plane it lights, straight
/// above it, has 2; averaged over a wide lamp the errors cancel.
const SIZE_ERROR: f32 = 1.0;

/// A range of polygons as one source. Light that reaches a distant point from
/// direction d is flux x face(-d) x cos / r^2, where face(w) is the mean over
/// the polygons of max(0, normal . w).
#[derive(Debug, Clone, Copy, Default)]
pub(in super::super) struct Node {
    /// Mean position of the light.
    center: Vec3,
    /// No point is farther from the centre.
    radius: f32,
    /// Sum of radiance x area, W/sr.
    pub(super) flux: Vec3,
    /// That of [`weight`].
    weight: f32,
    /// Mean of the unit normals.
    mean_normal: Vec3,
    /// Unit vector along the mean normal.
    axis: Vec3,
    /// Sine of the largest angle between the axis and a normal; 2 from 90 degrees.
    spread: f32,
    /// Mean of normal x normal: xx, yy, zz, xy, xz, yz.
    second: [f32; 6],
    /// Whether face(w) is closest to the smooth model of mixed normals.
    mixed: bool,
    /// RMS error of face(w) over all directions.
    face_error: f32,
    /// Mean square distance from the centre.
    squared_size: f32,
    /// Distance between the centres of the channels and the common one.
    color_shift: f32,
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
        let total = gathered.weight;
        let center = gathered.center();
        let mean_normal = (gathered.normal / total).as_vec3();
        let second = gathered.second.map(|sum| (sum / total) as f32);
        let mut node = Self {
            center: center.as_vec3(),
            radius: gathered.radius_about(center) as f32,
            flux: gathered.flux.as_vec3(),
            weight: total as f32,
            mean_normal,
            axis: gathered.normal_axis().as_vec3(),
            spread: if cosine > 0.0 {
                (1.0 - cosine * cosine).max(0.0).sqrt() as f32
            } else {
                2.0
            },
            second,
            mixed: false,
            face_error: 0.0,
            squared_size: gathered.squared_size_about(center) as f32,
            color_shift: gathered.color_shift(center) as f32,
            first,
            is_leaf: false,
        };
        node.choose_model(&gathered.response);
        node.face_error += gathered.color_turn() as f32;
        node
    }

    pub(super) fn source(&self, index: u32) -> Source {
        if self.is_leaf {
            Source::Polygon(self.first)
        } else {
            Source::Node(index)
        }
    }

    /// Takes the model of face(w) that is closer to the true response.
    fn choose_model(&mut self, response: &[f32; PROBES]) {
        let error = |node: &Self| {
            let mut sum = 0.0;
            for (index, &exact) in response.iter().enumerate() {
                let error = node.face(probe(index)) - exact / node.weight;
                sum += error * error;
            }
            (sum / PROBES as f32).sqrt()
        };
        let clamped = error(self);
        self.mixed = true;
        let mixed = error(self);
        self.mixed = mixed < clamped;
        self.face_error = if self.mixed { mixed } else { clamped };
    }

    /// Mean of max(0, normal . w), for a unit vector w. Where the normals
    /// differ little, that of the mean normal. Where they are mixed,
    /// max(0, c) = (c + |c|) / 2 with |c| = 3/16 + 15/16 c^2, its projection
    /// on spherical harmonics up to degree 2.
    fn face(&self, w: Vec3) -> f32 {
        let mean = self.mean_normal.dot(w);
        let face = if self.mixed {
            let [xx, yy, zz, xy, xz, yz] = self.second;
            let square = xx * w.x * w.x
                + yy * w.y * w.y
                + zz * w.z * w.z
                + 2.0 * (xy * w.x * w.y + xz * w.x * w.z + yz * w.y * w.z);
            0.5 * mean + (3.0 / 32.0) + (15.0 / 32.0) * square
        } else {
            mean
        };
        if face > 0.0 { face } else { 0.0 }
    }

    /// Rough irradiance of the brightest channel, rather too low than too high.
    pub(super) fn estimate(&self, position: Vec3, normal: Vec3) -> f32 {
        let to_center = self.center - position;
        let above = normal.dot(to_center);
        if above <= 0.0 {
            return 0.0;
        }
        let squared = to_center.length_squared() + self.radius * self.radius;
        let inverse = 1.0 / squared.sqrt();
        self.weight * self.face(to_center * -inverse) * above * inverse / squared
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
        let backward = to_center * -inverse;
        // sin(a + b) <= sin a + sin b for the angles of the normals about their
        // axis and of the node's points about its centre.
        let turn = self.spread + self.radius * inverse;
        let facing = self.axis.dot(backward);
        if facing <= -turn {
            return Verdict::Invisible;
        }
        let squared_angle = self.squared_size * inverse * inverse;
        let mut error = SIZE_ERROR * squared_angle + self.color_shift * inverse;
        let face = if facing >= turn {
            self.mean_normal.dot(backward)
        } else {
            error += self.face_error;
            self.face(backward)
        };
        let mut cosine = above * inverse;
        if above < self.radius {
            let half = (3.0 * squared_angle).sqrt();
            cosine = mean_above_horizon(cosine, half);
            error += 0.25 * half;
        }
        let scale = self.weight * inverse * inverse;
        let irradiance = scale * face * cosine;
        if scale * error <= (relative * irradiance).max(allowed) {
            Verdict::Stands(self.flux * (face * cosine * inverse * inverse))
        } else {
            Verdict::Open
        }
    }
}

/// Mean of max(0, c) over cosines c within `half` of a cosine.
fn mean_above_horizon(cosine: f32, half: f32) -> f32 {
    if cosine >= half {
        cosine
    } else if cosine <= -half {
        0.0
    } else {
        (cosine + half) * (cosine + half) / (4.0 * half)
    }
}

/// Direction `index` of the probes: a spiral over the sphere (Saff and
/// Kuijlaars 1997), whose turn is the golden angle's, by repeated rotation.
fn probe(index: usize) -> Vec3 {
    PROBE_DIRECTIONS[index]
}

/// Golden-angle spiral, see [`probe`].
static PROBE_DIRECTIONS: std::sync::LazyLock<[Vec3; PROBES]> = std::sync::LazyLock::new(|| {
    /// pi (3 - sqrt 5), radians.
    const GOLDEN_ANGLE: f32 = 2.399_963_2;
    std::array::from_fn(|index| {
        let height = 1.0 - (2 * index + 1) as f32 / PROBES as f32;
        let radius = (1.0 - height * height).sqrt();
        let angle = GOLDEN_ANGLE * index as f32;
        Vec3::new(
            radius * crate::maths::functions::cos_f32(angle),
            radius * crate::maths::functions::sin_f32(angle),
            height,
        )
    })
});

/// Sums over a node's polygons.
#[derive(Debug, Clone)]
pub(super) struct Gathered {
    weight: f64,
    flux: DVec3,
    /// Of weight x position.
    position: DVec3,
    /// Of weight x |position|^2, over the polygons' areas.
    squared_position: f64,
    /// Of weight x normal.
    normal: DVec3,
    /// Of weight x normal x normal.
    second: [f64; 6],
    /// Of weight x max(0, normal . probe).
    response: [f32; PROBES],
    /// Of flux x position and flux x normal, by channel.
    channel_position: [DVec3; 3],
    channel_normal: [DVec3; 3],
    lower: DVec3,
    upper: DVec3,
}

impl Gathered {
    pub(super) fn of_polygon(polygon: &Polygon) -> Self {
        let weight = weight(polygon);
        let (center, n) = (polygon.centroid(), polygon.normal());
        let flux = polygon.radiance().as_dvec3() * polygon.area();
        let (corners, count) = polygon.corners();
        let second_moment = corners[..count]
            .iter()
            .map(|&corner| (corner - center).length_squared())
            .sum::<f64>()
            / 12.0;
        let normal = n.as_vec3();
        let channels = [flux.x, flux.y, flux.z];
        Self {
            weight,
            flux,
            position: center * weight,
            squared_position: (center.length_squared() + second_moment) * weight,
            normal: n * weight,
            second: [
                n.x * n.x,
                n.y * n.y,
                n.z * n.z,
                n.x * n.y,
                n.x * n.z,
                n.y * n.z,
            ]
            .map(|product| product * weight),
            response: std::array::from_fn(|index| {
                weight as f32 * normal.dot(probe(index)).max(0.0)
            }),
            channel_position: channels.map(|flux| center * flux),
            channel_normal: channels.map(|flux| n * flux),
            lower: corners.iter().copied().fold(center, DVec3::min),
            upper: corners.iter().copied().fold(center, DVec3::max),
        }
    }

    pub(super) fn joined(&self, other: Self) -> Self {
        let both = |a: &[DVec3; 3], b: &[DVec3; 3]| [0, 1, 2].map(|c| a[c] + b[c]);
        Self {
            weight: self.weight + other.weight,
            flux: self.flux + other.flux,
            position: self.position + other.position,
            squared_position: self.squared_position + other.squared_position,
            normal: self.normal + other.normal,
            second: std::array::from_fn(|k| self.second[k] + other.second[k]),
            response: std::array::from_fn(|k| self.response[k] + other.response[k]),
            channel_position: both(&self.channel_position, &other.channel_position),
            channel_normal: both(&self.channel_normal, &other.channel_normal),
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
        }
    }

    fn center(&self) -> DVec3 {
        self.position / self.weight
    }

    /// Unit vector along the mean normal, or zero.
    pub(super) fn normal_axis(&self) -> DVec3 {
        self.normal.normalize_or_zero()
    }

    fn radius_about(&self, center: DVec3) -> f64 {
        (self.upper - center).max(center - self.lower).length()
    }

    fn squared_size_about(&self, center: DVec3) -> f64 {
        (self.squared_position / self.weight - center.length_squared()).max(0.0)
    }

    /// How far the channels' centres are from the common one, by their share.
    fn color_shift(&self, center: DVec3) -> f64 {
        self.by_channel(|channel, flux| (self.channel_position[channel] / flux - center).length())
    }

    /// How far the channels' mean normals are from the common one, by their share.
    fn color_turn(&self) -> f64 {
        let mean = self.normal / self.weight;
        self.by_channel(|channel, flux| (self.channel_normal[channel] / flux - mean).length())
    }

    /// Largest over the channels of a deviation x the channel's share of the brightest.
    fn by_channel(&self, deviation: impl Fn(usize, f64) -> f64) -> f64 {
        let flux = [self.flux.x, self.flux.y, self.flux.z];
        let brightest = self.flux.max_element();
        let mut largest = 0.0;
        for channel in 0..3 {
            if flux[channel] > 0.0 {
                largest = f64::max(
                    largest,
                    deviation(channel, flux[channel]) * flux[channel] / brightest,
                );
            }
        }
        largest
    }
}
