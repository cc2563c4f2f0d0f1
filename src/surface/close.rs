//! A light so close to a surface that what it does there is a spike, narrower
//! than the points of a vertex's area are apart.
//!
//! The vertex's irradiance is (1/A_i) Int phi_i E dA over its triangles. Each is
//! quartered until a piece is small for its distance to the light; the light is
//! asked for at the middle of each piece, with a shadow ray. Quartering goes deep
//! only under the light, so a light at a hundredth of an edge length takes some
//! hundred pieces a triangle.
//!
//! Vertices that are partly inside a body keep their points. A spot's cone is not
//! looked for: one narrower than a piece (10 degrees of half angle and less) is
//! sampled as badly as by points. A light nearer than the smallest piece is wide may
//! do too much or too little there.

use glam::{DVec3, Vec3};

use super::direct::{LightPoints, Shadows};
use crate::maths::order::Order;
use crate::scene::PlacedLight;

/// Longest edge of a piece over its distance to the light, at most. With a half,
/// the flux on a plane under a lamp 0.01 to 0.1 edges high is within 2 %.
const SMALL: f32 = 0.5;
/// Longest edge of a triangle over its distance to the light, from which on its
/// vertices are integrated: eight points have a mean error of 1 % at two edges.
const CLOSE: f32 = 0.5;
/// Share of the triangle of a piece that is not quartered: its edges are 1/4096 of
/// the triangle's, and a light nearer than that touches it.
const SMALLEST: f32 = 1.0 / 16_777_216.0;

/// The part of a triangle between three points, given by their barycentric
/// coordinates.
type Piece = [Vec3; 3];

/// Irradiance of a light at a vertex, W/m2, if the light is a point so close that
/// the vertex's few points would miss what it does.
pub(super) fn irradiance(shadows: &Shadows, light: &PlacedLight, vertex: usize) -> Option<Vec3> {
    let (surface, place) = (shadows.surface, light.place()?);
    let vertices = &surface.vertices;
    let front = vertices.front_of(vertex) == vertex;
    let is_close = vertices.fan(vertex).any(|(triangle, _)| {
        let whole = Pieces::of(shadows, light, place, (triangle, front));
        whole.is_larger(&WHOLE, CLOSE)
    });
    if !is_close {
        return None;
    }
    let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
    for (triangle, corner) in vertices.fan(vertex) {
        let pieces = Pieces::of(shadows, light, place, (triangle, front));
        pieces.add(&WHOLE, 1.0, &mut |middle, share, irradiance| {
            let weight = f64::from(pieces.area * share * middle[corner]);
            sum += irradiance.as_dvec3() * weight;
            weights += weight;
        });
    }
    Some((sum / weights.at_least(f64::MIN_POSITIVE)).as_vec3())
}

/// A whole triangle.
const WHOLE: Piece = [Vec3::X, Vec3::Y, Vec3::Z];

/// One side of a triangle under a light.
struct Pieces<'a> {
    shadows: &'a Shadows<'a>,
    light: &'a PlacedLight,
    place: Vec3,
    side: (u32, bool),
    corners: [Vec3; 3],
    area: f32,
}

impl<'a> Pieces<'a> {
    fn of(
        shadows: &'a Shadows<'a>,
        light: &'a PlacedLight,
        place: Vec3,
        side: (u32, bool),
    ) -> Self {
        let mesh = &shadows.surface.mesh;
        let corners = mesh.corner_positions(&mesh.triangles[side.0 as usize]);
        let [a, b, c] = corners;
        Self {
            shadows,
            light,
            place,
            side,
            corners,
            area: 0.5 * (b - a).cross(c - a).length(),
        }
    }

    fn position(&self, barycentrics: Vec3) -> Vec3 {
        let [a, b, c] = self.corners;
        a * barycentrics.x + b * barycentrics.y + c * barycentrics.z
    }

    /// Whether a piece's longest edge is more than so much of its distance to the
    /// light.
    fn is_larger(&self, piece: &Piece, share: f32) -> bool {
        let [a, b, c] = piece.map(|corner| self.position(corner));
        let edge = (b - a)
            .length_squared()
            .at_least((c - b).length_squared())
            .at_least((a - c).length_squared());
        let middle = (a + b + c) / 3.0;
        edge > share * share * middle.distance_squared(self.place)
    }

    /// Calls `take` for every small part of a piece, which is a share of the
    /// triangle: with the barycentric coordinates of the part's middle, its share
    /// of the triangle and the irradiance there.
    fn add(&self, piece: &Piece, share: f32, take: &mut impl FnMut(Vec3, f32, Vec3)) {
        let [a, b, c] = *piece;
        if share > SMALLEST && self.is_larger(piece, SMALL) {
            let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
            for quarter in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]] {
                self.add(&quarter, 0.25 * share, take);
            }
            return;
        }
        let middle = (a + b + c) / 3.0;
        let (triangle, front) = self.side;
        let surface = self.shadows.surface;
        let point = surface.point(triangle, middle.to_array(), front);
        // A light that is a point sends all through one ray, whatever the set.
        let to_light = LightPoints::of(0, 0, 0, 1);
        take(
            middle,
            share,
            self.shadows.irradiance(self.light, &point, to_light),
        );
    }
}
