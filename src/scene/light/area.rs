//! Area light: a black rectangle that emits on one side.

use glam::{DVec3, Vec3};

use super::Polygon;
use crate::scene::file::fields::{Fields, unit};
use crate::scene::{Placement, SceneError};

/// Keys besides `name` and `kind`.
pub(super) const KEYS: &[&str] = &["corner", "edge_u", "edge_v", "radiance"];

/// `kind = "area"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// File units.
    pub corner: DVec3,
    /// Edge from the corner, file units.
    pub edge_u: DVec3,
    /// Other edge from the corner; it emits on the side of `edge_u` x `edge_v`.
    pub edge_v: DVec3,
    /// W/(m2 sr).
    pub radiance: Vec3,
}

/// A rectangle (or parallelogram) in placed units. In double precision, since
/// it may lie far outside the scene's box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlacedRectangle {
    pub(crate) corner: DVec3,
    pub(crate) edge_u: DVec3,
    pub(crate) edge_v: DVec3,
    /// Unit normal of the side that emits.
    pub(crate) normal: DVec3,
    /// W/(m2 sr); the unit of length does not enter it.
    pub(crate) radiance: Vec3,
}

impl Area {
    pub(super) fn read(fields: &mut Fields) -> Result<Self, SceneError> {
        let corner = fields.require("corner", "[x, y, z]")?.vector()?;
        let edge_u = fields
            .require("edge_u", "an edge from the corner")?
            .vector()?;
        let edge_v_item = fields.require("edge_v", "the other edge from the corner")?;
        let edge_v = edge_v_item.vector()?;
        let radiance = fields.require("radiance", "[r, g, b], W/(m2 sr)")?;
        let parallel = match (unit(edge_u), unit(edge_v)) {
            (Some(u), Some(v)) => u.cross(v) == DVec3::ZERO,
            _ => true,
        };
        if parallel {
            return Err(edge_v_item.error("an edge that spans an area together with `edge_u`"));
        }
        Ok(Self {
            corner,
            edge_u,
            edge_v,
            radiance: radiance.light()?,
        })
    }
}

impl Area {
    /// The rectangle in placed units.
    pub(crate) fn place(&self, placement: &Placement) -> PlacedRectangle {
        // Of the edges as the file has them: only they are sure to span an area
        // in any unit.
        let directions = [self.edge_u, self.edge_v].map(|edge| edge.normalize_or_zero());
        PlacedRectangle {
            corner: (self.corner - placement.center) * placement.scale,
            edge_u: self.edge_u * placement.scale,
            edge_v: self.edge_v * placement.scale,
            normal: directions[0].cross(directions[1]).normalize_or_zero(),
            radiance: self.radiance,
        }
    }
}

impl PlacedRectangle {
    /// The rectangle as a source of light.
    pub(crate) fn polygon(&self) -> Polygon {
        Polygon::parallelogram(self.corner, self.edge_u, self.edge_v, self.radiance)
    }

    /// Whether a ray meets the rectangle, from either side, at a distance t
    /// with 0 < t < `t_max`; in units of the direction's length.
    pub(crate) fn blocks(&self, origin: Vec3, direction: Vec3, t_max: f32) -> bool {
        self.hit(origin, direction).is_some_and(|t| t < t_max)
    }

    /// Distance above 0 at which a ray meets the rectangle, from either side,
    /// in units of the direction's length. A ray within the plane misses.
    pub(crate) fn hit(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let (to_corner, direction) = (self.corner - origin.as_dvec3(), direction.as_dvec3());
        let spanned = self.edge_u.cross(self.edge_v);
        let speed = spanned.dot(direction);
        let t = spanned.dot(to_corner) / speed;
        if !(speed != 0.0 && t > 0.0) {
            return None;
        }
        // Where the plane is met, as multiples of the edges.
        let met = direction * t - to_corner;
        let squared_area = spanned.length_squared();
        let along_u = met.cross(self.edge_v).dot(spanned) / squared_area;
        let along_v = self.edge_u.cross(met).dot(spanned) / squared_area;
        let inside = (0.0..=1.0).contains(&along_u) && (0.0..=1.0).contains(&along_v);
        let t = t as f32;
        (inside && t > 0.0).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp() -> Area {
        Area {
            corner: DVec3::new(-1.0, 4.0, -1.0),
            edge_u: DVec3::new(2.0, 0.0, 0.0),
            edge_v: DVec3::new(0.0, 0.0, 2.0),
            radiance: Vec3::new(1.0, 2.0, 3.0),
        }
    }

    /// A room of 4 units about the origin: placed units are quarters.
    fn placement() -> Placement {
        Placement::of_bounds(DVec3::splat(-2.0), DVec3::splat(2.0))
    }

    #[test]
    fn placing_scales_lengths_and_keeps_radiance_and_light() {
        let placed = lamp().place(&placement());
        assert_eq!(placed.corner, DVec3::new(-0.25, 1.0, -0.25));
        assert_eq!(placed.normal, DVec3::NEG_Y);
        assert_eq!(placed.radiance, lamp().radiance);
        assert_eq!(placed.polygon().radiance(), lamp().radiance);
        let unplaced =
            Polygon::parallelogram(lamp().corner, lamp().edge_u, lamp().edge_v, lamp().radiance);
        assert_eq!(
            placed.polygon().form_factor(Vec3::X * 0.25, Vec3::Y),
            unplaced.form_factor(Vec3::X, Vec3::Y)
        );
    }

    #[test]
    fn rays_meet_both_sides_within_the_edges_only() {
        let placed = lamp().place(&placement());
        assert_eq!(placed.hit(Vec3::ZERO, Vec3::Y), Some(1.0));
        assert_eq!(placed.hit(Vec3::Y * 3.0, Vec3::NEG_Y), Some(2.0));
        assert_eq!(placed.hit(Vec3::ZERO, Vec3::NEG_Y), None);
        assert_eq!(placed.hit(Vec3::X * 0.26, Vec3::Y), None);
        assert_eq!(placed.hit(Vec3::Z * 0.24, Vec3::Y), Some(1.0));
        assert_eq!(placed.hit(Vec3::Y, Vec3::X), None);
        assert!(placed.blocks(Vec3::ZERO, Vec3::Y, 1.1));
        assert!(!placed.blocks(Vec3::ZERO, Vec3::Y, 1.0));
        assert!(!placed.blocks(Vec3::Y, Vec3::Y, 1.0));
    }

    #[test]
    fn a_slanted_parallelogram_far_away_is_hit_where_it_is() {
        let far = PlacedRectangle {
            corner: DVec3::new(1e6, 1e6, 0.0),
            edge_u: DVec3::new(1e5, -1e5, 0.0),
            edge_v: DVec3::new(5e4, -5e4, 1e5),
            normal: DVec3::new(-1.0, -1.0, 0.0).normalize(),
            radiance: Vec3::ONE,
        };
        let towards = |u: f64, v: f64| {
            let point = far.corner + far.edge_u * u + far.edge_v * v;
            far.hit(Vec3::ZERO, point.normalize().as_vec3())
                .map(|t| f64::from(t) / point.length())
        };
        for (u, v) in [(0.01, 0.01), (0.99, 0.01), (0.5, 0.99), (0.99, 0.99)] {
            // Rounding of the direction and of the distance.
            assert!(towards(u, v).is_some_and(|ratio| (ratio - 1.0).abs() < 1e-6));
        }
        for (u, v) in [(-0.01, 0.5), (1.01, 0.5), (0.5, 1.01), (0.5, -0.01)] {
            assert_eq!(towards(u, v), None);
        }
    }
}
