//! What reaches one point from many polygons, and where it comes from.

use glam::Vec3;

use super::Emitters;
use crate::scene::light::{LightSample, Polygon};
use crate::scene::max_component;

/// Largest number below 1: uniforms stay in [0, 1).
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Light from [`Emitters`] that reaches a point if nothing is in the way, as
/// entries of a tree's cut: single polygons and nodes.
#[derive(Debug, Clone, Default)]
pub(crate) struct LightCut {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    open: Vec3,
    entries: Vec<Entry>,
}

/// A share of the light.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// Sum of the weights up to this entry, its own included; a weight is the
    /// irradiance of the brightest channel.
    cumulative: f32,
    source: Source,
}

/// Where an entry's light comes from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Source {
    /// Index of a polygon.
    Polygon(u32),
    /// Index of a node of the tree.
    Node(u32),
}

impl LightCut {
    pub(super) fn begin(&mut self, position: Vec3, normal: Vec3) {
        self.position = position;
        self.normal = normal;
        self.open = Vec3::ZERO;
        self.entries.clear();
    }

    /// Adds a polygon by Lambert's formula.
    pub(super) fn add_polygon(&mut self, index: u32, polygon: &Polygon) {
        let factor = polygon.form_factor(self.position, self.normal);
        let irradiance = polygon.radiance() * (std::f32::consts::PI * factor);
        self.add(Source::Polygon(index), irradiance);
    }

    /// Adds an entry, W/m2, unless it is nothing.
    pub(super) fn add(&mut self, source: Source, irradiance: Vec3) {
        let weight = max_component(irradiance);
        if weight > 0.0 {
            self.open += irradiance;
            let before = self.entries.last().map_or(0.0, |entry| entry.cumulative);
            self.entries.push(Entry {
                cumulative: before + weight,
                source,
            });
        }
    }

    /// Irradiance if nothing is in the way, W/m2.
    pub(crate) fn open(&self) -> Vec3 {
        self.open
    }

    /// Number of entries: 0 where no light can arrive.
    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// A point of the emitters this cut was made from, chosen by two uniforms:
    /// an entry in proportion to its irradiance, in a node a polygon by its
    /// power, in a polygon a point by area of what is above the horizon.
    ///
    /// The sample's irradiance is divided by the density of that choice, so
    /// that the mean over the uniforms of irradiance x cosine is
    /// [`Self::open`] (for nodes, within their error). `None` where the chosen
    /// point is below the horizon or sees the point from behind: it counts as
    /// a sample without light.
    pub(crate) fn sample(&self, emitters: &Emitters, u: [f32; 2]) -> Option<LightSample> {
        let total = self.entries.last()?.cumulative;
        let target = u[0] * total;
        let index = self
            .entries
            .partition_point(|entry| entry.cumulative <= target)
            .min(self.entries.len() - 1);
        let before = match index {
            0 => 0.0,
            _ => self.entries[index - 1].cumulative,
        };
        let width = self.entries[index].cumulative - before;
        // Stretched to the entry's interval, neighbouring uniforms stay neighbours.
        let rest = ((target - before) / width).clamp(0.0, BELOW_ONE);
        let (polygon, chance, rest) = match self.entries[index].source {
            Source::Polygon(polygon) => (polygon, 1.0, rest),
            Source::Node(node) => emitters.tree.as_ref()?.descend(node, rest),
        };
        let probability = width / total * chance;
        let polygon = &emitters.polygons[polygon as usize];
        self.sample_polygon(polygon, [rest, u[1]], probability)
    }

    /// A point of a polygon that was chosen with a probability.
    fn sample_polygon(
        &self,
        polygon: &Polygon,
        u: [f32; 2],
        probability: f32,
    ) -> Option<LightSample> {
        let (position, normal) = (self.position.as_dvec3(), self.normal.as_dvec3());
        let (point, area) = polygon.sample_above(position, normal, u)?;
        let to_light = point - position;
        let squared = to_light.length_squared();
        let distance = squared.sqrt();
        let front = -polygon.normal().dot(to_light);
        let above = normal.dot(to_light);
        if !(front > 0.0 && above > 0.0 && probability > 0.0) {
            return None;
        }
        // L cos dA / r^2, with cos = front / r and dA = area.
        let factor = front * area / (squared * distance * f64::from(probability));
        Some(LightSample {
            direction: (to_light / distance).as_vec3(),
            distance: distance as f32,
            irradiance: polygon.radiance() * factor as f32,
        })
    }
}
