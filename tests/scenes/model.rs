//! A whole scene's mesh: materials and bodies.

use super::body::Body;

/// Decimals of a printed position. Positions are rounded to them on entry, so
/// that what the tests check is what the file holds.
pub(crate) const POSITION_DECIMALS: usize = 5;

/// The mesh of one scene, metres, Y up.
pub(crate) struct Model {
    /// Name of its folder and files.
    pub(crate) name: &'static str,
    /// First line of the OBJ file.
    pub(crate) title: &'static str,
    /// MTL name and `Kd`, linear Rec.709.
    pub(crate) materials: Vec<(&'static str, [f64; 3])>,
    /// Printed in this order.
    pub(crate) bodies: Vec<Body>,
}

impl Model {
    /// Rounds the bodies to what is printed.
    pub(crate) fn new(
        name: &'static str,
        title: &'static str,
        materials: &[(&'static str, [f64; 3])],
        bodies: Vec<Body>,
    ) -> Self {
        Self {
            name,
            title,
            materials: materials.to_vec(),
            bodies: bodies.into_iter().map(rounded).collect(),
        }
    }

    /// Positions of the file.
    pub(crate) fn vertex_count(&self) -> usize {
        self.bodies.iter().map(|body| body.positions.len()).sum()
    }

    /// Triangles after every polygon is split as a fan.
    pub(crate) fn triangle_count(&self) -> usize {
        self.bodies
            .iter()
            .map(|body| body.triangles().count())
            .sum()
    }
}

fn rounded(mut body: Body) -> Body {
    for position in &mut body.positions {
        *position = position.map(|value| round_to(value, POSITION_DECIMALS));
    }
    body
}

/// The nearest value with that many decimals; never the negative zero.
pub(crate) fn round_to(value: f64, decimals: usize) -> f64 {
    let mut steps = 1.0;
    for _ in 0..decimals {
        steps *= 10.0;
    }
    (value * steps).round() / steps + 0.0
}
