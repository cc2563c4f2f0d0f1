//! Sums over a node's polygons, from which it is made.

use glam::{DMat3, DVec3};

use super::node::{PROBES, probe};
use crate::maths::order::Order;
use crate::scene::light::Polygon;
use crate::scene::light::emitters::weight;

/// Sums over a node's polygons.
#[derive(Debug, Clone)]
pub(super) struct Gathered {
    weight: f64,
    flux: DVec3,
    /// Of weight x position.
    position: DVec3,
    /// Of weight x position position^T, over the polygons' areas.
    position_position: DMat3,
    /// Of weight x normal.
    normal: DVec3,
    /// Of weight x normal normal^T.
    normal_normal: DMat3,
    /// Of weight x position normal^T.
    position_normal: DMat3,
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
        // Of a triangle and of a parallelogram alike: a twelfth over the corners.
        let mut spread = outer(center, center);
        for &corner in &corners[..count] {
            spread += outer(corner - center, corner - center) * (1.0 / 12.0);
        }
        let normal = n.as_vec3();
        let channels = [flux.x, flux.y, flux.z];
        Self {
            weight,
            flux,
            position: center * weight,
            position_position: spread * weight,
            normal: n * weight,
            normal_normal: outer(n, n) * weight,
            position_normal: outer(center, n) * weight,
            response: std::array::from_fn(|index| {
                weight as f32 * normal.dot(probe(index)).at_least(0.0)
            }),
            channel_position: channels.map(|flux| center * flux),
            channel_normal: channels.map(|flux| n * flux),
            lower: corners.iter().copied().fold(center, DVec3::min),
            upper: corners.iter().copied().fold(center, DVec3::max),
        }
    }

    pub(super) fn joined(&self, other: &Self) -> Self {
        let both = |a: &[DVec3; 3], b: &[DVec3; 3]| [0, 1, 2].map(|c| a[c] + b[c]);
        Self {
            weight: self.weight + other.weight,
            flux: self.flux + other.flux,
            position: self.position + other.position,
            position_position: self.position_position + other.position_position,
            normal: self.normal + other.normal,
            normal_normal: self.normal_normal + other.normal_normal,
            position_normal: self.position_normal + other.position_normal,
            response: std::array::from_fn(|k| self.response[k] + other.response[k]),
            channel_position: both(&self.channel_position, &other.channel_position),
            channel_normal: both(&self.channel_normal, &other.channel_normal),
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
        }
    }

    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    pub(super) fn flux(&self) -> DVec3 {
        self.flux
    }

    pub(super) fn response(&self) -> &[f32; PROBES] {
        &self.response
    }

    pub(super) fn center(&self) -> DVec3 {
        self.position / self.weight
    }

    pub(super) fn mean_normal(&self) -> DVec3 {
        self.normal / self.weight
    }

    /// Unit vector along the mean normal, or zero.
    pub(super) fn normal_axis(&self) -> DVec3 {
        self.normal.normalize_or_zero()
    }

    pub(super) fn position_covariance(&self) -> DMat3 {
        self.position_position * (1.0 / self.weight) - outer(self.center(), self.center())
    }

    pub(super) fn normal_covariance(&self) -> DMat3 {
        self.normal_normal * (1.0 / self.weight) - outer(self.mean_normal(), self.mean_normal())
    }

    /// Mean of (position - centre) (normal - mean)^T.
    pub(super) fn curvature(&self) -> DMat3 {
        self.position_normal * (1.0 / self.weight) - outer(self.center(), self.mean_normal())
    }

    pub(super) fn radius_about(&self, center: DVec3) -> f64 {
        (self.upper - center).max(center - self.lower).length()
    }

    /// How far the channels' centres are from the common one, by their share.
    pub(super) fn color_shift(&self) -> f64 {
        let center = self.center();
        self.by_channel(|channel, flux| (self.channel_position[channel] / flux - center).length())
    }

    /// How far the channels' mean normals are from the common one, by their share.
    pub(super) fn color_turn(&self) -> f64 {
        let mean = self.mean_normal();
        self.by_channel(|channel, flux| (self.channel_normal[channel] / flux - mean).length())
    }

    /// Largest over the channels of a deviation x the channel's share of the brightest.
    fn by_channel(&self, deviation: impl Fn(usize, f64) -> f64) -> f64 {
        let flux = [self.flux.x, self.flux.y, self.flux.z];
        let brightest = self.flux.max_element();
        let mut largest = 0.0;
        for channel in 0..3 {
            if flux[channel] > 0.0 {
                largest = f64::at_least(
                    largest,
                    deviation(channel, flux[channel]) * flux[channel] / brightest,
                );
            }
        }
        largest
    }
}

/// a b^T.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
