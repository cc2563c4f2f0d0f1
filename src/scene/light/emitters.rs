//! Many polygons that emit: emissive triangles of a scene and its rectangles.
//!
//! `new` builds a tree over them (`tree`). [`Emitters::cut`] walks it for one
//! point: a node that is small against its distance stands for its polygons,
//! another is opened, down to Lambert's formula for single polygons (`cut`).
//! The result, a [`LightCut`], is both the irradiance without obstacles and
//! the means to choose where shadow rays go.
//!
//! After Walter et al., "Lightcuts: A Scalable Approach to Illumination"
//! (SIGGRAPH 2005), with Barnes and Hut's order of traversal (Nature 1986) in
//! place of a heap, since a point's cut has to take microseconds.

mod cut;
#[cfg(test)]
mod tests;
mod tree;

use glam::Vec3;

use super::Polygon;
use crate::scene::max_component;

pub(crate) use cut::LightCut;
use tree::Tree;

/// Up to this many polygons are summed one by one, without a tree: 32 take
/// about 2 us at most, as long as a walk through a tree.
const SUMMED: usize = 32;

/// A fixed list of polygons with a tree over them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Emitters {
    polygons: Vec<Polygon>,
    /// None for up to [`SUMMED`] polygons.
    tree: Option<Tree>,
}

impl Emitters {
    /// Polygons that emit nothing, or have no area, are dropped.
    pub(crate) fn new(mut polygons: Vec<Polygon>) -> Self {
        polygons.retain(|polygon| weight(polygon) > 0.0);
        let tree = (polygons.len() > SUMMED).then(|| Tree::new(&polygons));
        Self { polygons, tree }
    }

    /// What reaches a point of unit `normal` if nothing is in the way.
    pub(crate) fn cut(&self, position: Vec3, normal: Vec3) -> LightCut {
        let mut cut = LightCut::default();
        self.cut_into(position, normal, &mut cut);
        cut
    }

    /// [`Self::cut`] into a used one, whose memory is kept.
    pub(crate) fn cut_into(&self, position: Vec3, normal: Vec3, cut: &mut LightCut) {
        cut.begin(position, normal);
        match &self.tree {
            Some(tree) => tree.walk(&self.polygons, cut),
            None => {
                for (index, polygon) in self.polygons.iter().enumerate() {
                    cut.add_polygon(index as u32, polygon);
                }
            }
        }
    }
}

/// Emitters are equal that have the same polygons in the same order: the tree
/// follows from them.
impl PartialEq for Emitters {
    fn eq(&self, other: &Self) -> bool {
        self.polygons == other.polygons
    }
}

/// Radiance of the brightest channel x area: what choices are proportional to.
fn weight(polygon: &Polygon) -> f64 {
    f64::from(max_component(polygon.radiance())) * polygon.area()
}
