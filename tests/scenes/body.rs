//! One connected piece of a mesh.

use glam::DVec3;

/// What a body is, and so what the tests ask of it.
#[derive(Clone, Copy)]
pub(crate) enum Shape {
    /// Closed, fronts outward.
    Solid,
    /// Closed, fronts inward.
    Hollow,
    /// With borders; every front is seen from this point.
    Open {
        /// A point in front of all faces.
        seen_from: DVec3,
    },
}

/// A polygon, counter-clockwise seen from its front.
#[derive(Clone)]
pub(crate) struct Face {
    /// MTL name.
    pub(crate) material: &'static str,
    /// Indices into [`Body::positions`].
    pub(crate) corners: Vec<usize>,
}

/// Polygons over shared positions.
#[derive(Clone)]
pub(crate) struct Body {
    /// Name in the file.
    pub(crate) name: &'static str,
    /// What the tests ask of it.
    pub(crate) shape: Shape,
    /// Metres.
    pub(crate) positions: Vec<DVec3>,
    /// One unit normal a position; `None`: flat faces.
    pub(crate) normals: Option<Vec<DVec3>>,
    /// The surface.
    pub(crate) faces: Vec<Face>,
}

impl Body {
    /// Corners of all triangles, each polygon split as a fan from its first.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.faces.iter().flat_map(|face| {
            let corners = &face.corners;
            (2..corners.len()).map(move |k| [corners[0], corners[k - 1], corners[k]])
        })
    }

    /// Cross product of a triangle's edges: its normal, twice its area long.
    pub(crate) fn doubled_area(&self, [a, b, c]: [usize; 3]) -> DVec3 {
        let [a, b, c] = [a, b, c].map(|corner| self.positions[corner]);
        (b - a).cross(c - a)
    }

    /// Gives every position the area-weighted normal of its triangles.
    pub(crate) fn smoothed(mut self) -> Self {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in self.triangles() {
            let normal = self.doubled_area(triangle);
            for corner in triangle {
                sums[corner] += normal;
            }
        }
        self.normals = Some(sums.iter().map(|sum| sum.normalize()).collect());
        self
    }

    /// Turned about the vertical axis through the origin, counter-clockwise
    /// seen from above.
    pub(crate) fn turned(mut self, angle_deg: f64) -> Self {
        let angle = angle_deg * (std::f64::consts::PI / 180.0);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let turn = |v: DVec3| DVec3::new(v.x * cos + v.z * sin, v.y, v.z * cos - v.x * sin);
        self.positions.iter_mut().for_each(|p| *p = turn(*p));
        if let Some(normals) = &mut self.normals {
            normals.iter_mut().for_each(|n| *n = turn(*n));
        }
        self
    }

    /// Moved by an offset.
    pub(crate) fn moved(mut self, x: f64, y: f64, z: f64) -> Self {
        let offset = DVec3::new(x, y, z);
        self.positions.iter_mut().for_each(|p| *p += offset);
        self
    }

    /// Moved up or down until the lowest position has this height.
    pub(crate) fn standing_at(self, height: f64) -> Self {
        let lowest = self
            .positions
            .iter()
            .map(|position| position.y)
            .min_by(f64::total_cmp)
            .expect("a body has positions");
        self.moved(0.0, height - lowest, 0.0)
    }
}
