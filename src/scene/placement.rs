//! How the later stages see the scene: centred and scaled in double precision
//! before anything becomes single precision.

use glam::{DVec3, Vec3};

/// Map from the file's units to placed units, in which the scene's bounding
/// box is centred on the origin and its longest side lies in (0.5, 1].
/// The scale is a power of two, so that scaling is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    /// Centre of the bounding box, file units.
    pub(crate) center: DVec3,
    /// Placed units a file unit.
    pub(crate) scale: f64,
    /// Longest side of the bounding box, file units.
    pub(crate) extent: f64,
}

impl Placement {
    /// Placement of the box between two corners.
    pub(crate) fn of_bounds(lower: DVec3, upper: DVec3) -> Self {
        let size = upper - lower;
        let extent = size.max_element();
        let center = lower + size * 0.5;
        let mut scale = 1.0;
        if extent > 0.0 && extent.is_finite() {
            while extent * scale > 1.0 {
                scale *= 0.5;
            }
            while extent * scale <= 0.5 {
                scale *= 2.0;
            }
        }
        Self {
            center,
            scale,
            extent,
        }
    }

    /// A position in placed units.
    pub(crate) fn placed_from_file(&self, position: DVec3) -> Vec3 {
        ((position - self.center) * self.scale).as_vec3()
    }

    /// A position in the file's units.
    pub(crate) fn file_from_placed(&self, position: Vec3) -> DVec3 {
        position.as_dvec3() / self.scale + self.center
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_far_away_is_placed_like_one_at_home() {
        let home = Placement::of_bounds(DVec3::ZERO, DVec3::new(4.0, 3.0, 2.0));
        let away = Placement::of_bounds(DVec3::splat(1e6), DVec3::new(4.0, 3.0, 2.0) + 1e6);
        let corner = DVec3::new(4.0, 0.0, 2.0);
        assert_eq!(
            home.placed_from_file(corner),
            away.placed_from_file(corner + 1e6)
        );
        assert_eq!(home.placed_from_file(corner).x, 0.5);
    }
}
