//! A whole scene: materials, bodies, and the pictures beside the mesh.

use super::body::Body;
use super::pictures::Picture;

/// Decimals of a printed position. Positions are rounded to them on entry, so
/// that what the tests check is what the file holds.
pub(crate) const POSITION_DECIMALS: usize = 5;

/// The mesh of one scene, metres, Y up.
pub(crate) struct Model {
    /// Name of its folder and files.
    pub(crate) name: &'static str,
    /// First line of the OBJ file.
    pub(crate) title: &'static str,
    /// Printed in this order.
    pub(crate) materials: Vec<Material>,
    /// Printed in this order.
    pub(crate) bodies: Vec<Body>,
    /// Textures, and maps of the sky that the scene files name.
    pub(crate) pictures: Vec<Picture>,
}

/// A material of the MTL file.
#[derive(Clone)]
pub(crate) struct Material {
    pub(crate) name: &'static str,
    /// `Kd`, linear Rec.709.
    pub(crate) albedo: [f64; 3],
    /// `Ke`, W/(m2 sr).
    pub(crate) emission: [f64; 3],
    /// Its image map, if it has one.
    pub(crate) map: Option<Map>,
}

/// An image map, laid onto each face along the axis that the face faces most.
#[derive(Clone, Copy)]
pub(crate) struct Map {
    pub(crate) kind: MapKind,
    /// Name of a [`Picture`].
    pub(crate) file: &'static str,
    /// Metres after which it repeats, from the origin on.
    pub(crate) period: f64,
}

/// What a map is multiplied with.
#[derive(Clone, Copy)]
pub(crate) enum MapKind {
    /// `map_Kd`.
    Albedo,
    /// `map_Ke`.
    Emission,
}

impl Material {
    /// One colour all over.
    pub(crate) const fn plain(name: &'static str, albedo: [f64; 3]) -> Self {
        Self {
            name,
            albedo,
            emission: [0.0; 3],
            map: None,
        }
    }

    /// White times a map.
    pub(crate) const fn mapped(
        name: &'static str,
        kind: MapKind,
        file: &'static str,
        period: f64,
    ) -> Self {
        Self {
            map: Some(Map { kind, file, period }),
            ..Self::plain(name, [1.0; 3])
        }
    }
}

impl Model {
    /// Rounds the bodies to what is printed.
    pub(crate) fn new(
        name: &'static str,
        title: &'static str,
        materials: Vec<Material>,
        bodies: Vec<Body>,
    ) -> Self {
        Self {
            name,
            title,
            materials,
            bodies: bodies.into_iter().map(rounded).collect(),
            pictures: Vec::new(),
        }
    }

    /// The map of a material.
    pub(crate) fn map_of(&self, material: &str) -> Option<Map> {
        let found = self.materials.iter().find(|m| m.name == material);
        found.and_then(|material| material.map)
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
