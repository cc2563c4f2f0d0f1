//! Colours of image maps on the surface.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::{LightingMesh, Surface};
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::texture::{TextureFilter, TextureMap};

/// Points of a vertex's area at which a map is averaged over a piece each; each
/// piece is exact in itself. On fields as large as the edges, black and white,
/// 64 leave 1.7 % (RMS) and 16 leave 5.2 %.
const POINTS: std::ops::RangeInclusive<usize> = 16..=64;
/// Points of all vertices that are worth the time: 64 for each of 586,000 took
/// 17 s, and vertices that many are small.
const POINTS_IN_ALL: usize = 1 << 22;
/// Seed of the points.
const SEED: u32 = 0x3ab5;

/// Mean colour of a map around a point of a triangle: over the parallelogram
/// whose sides are `along_x` and `along_y` (placed units, in the triangle's
/// plane). `None` where the triangle has no texture coordinates.
pub(crate) fn mean_around(
    mesh: &LightingMesh,
    map: &TextureMap,
    filter: TextureFilter,
    site: (u32, [f32; 3]),
    [along_x, along_y]: [Vec3; 2],
) -> Option<Vec3> {
    let (triangle, [a, b, c]) = site;
    let uv = mesh.texture_coordinates_of(triangle)?;
    let gradient = UvGradient::of(mesh, triangle, uv);
    let at = uv[0] * a + uv[1] * b + uv[2] * c;
    Some(map.mean(at, gradient.along(along_x), gradient.along(along_y), filter))
}

/// How texture coordinates change along a triangle.
struct UvGradient {
    /// Barycentric coordinates of the second and third corner change by the
    /// dot product with these.
    slopes: [Vec3; 2],
    edges: [Vec2; 2],
}

impl UvGradient {
    fn of(mesh: &LightingMesh, triangle: u32, uv: [Vec2; 3]) -> Self {
        let triangle = &mesh.triangles[triangle as usize];
        let [p, q, r] = mesh.corner_positions(triangle);
        let (e1, e2) = (q - p, r - p);
        let normal = e1.cross(e2);
        let squared = normal.length_squared().at_least(f32::MIN_POSITIVE);
        Self {
            slopes: [e2.cross(normal) / squared, normal.cross(e1) / squared],
            edges: [uv[1] - uv[0], uv[2] - uv[0]],
        }
    }

    fn along(&self, step: Vec3) -> Vec2 {
        self.edges[0] * self.slopes[0].dot(step) + self.edges[1] * self.slopes[1].dot(step)
    }
}

/// Mean colour over each vertex's area of the map of its material, weighted by
/// the vertex's hat; white for materials without one. `map_of` gives a
/// material's map.
pub(crate) fn means_at_vertices<'m>(
    surface: &Surface,
    filter: TextureFilter,
    map_of: impl Fn(u32) -> Option<&'m TextureMap> + Sync,
) -> Vec<Vec3> {
    let vertices = surface.vertices.len();
    let affordable = POINTS_IN_ALL / vertices.max(1);
    let points = affordable.clamp(*POINTS.start(), *POINTS.end()) as u32;
    (0..vertices)
        .into_par_iter()
        .with_min_len(64)
        .map(|vertex| {
            let map = map_of(surface.vertices.materials()[vertex]);
            map.map_or(Vec3::ONE, |map| {
                mean_at_vertex(surface, filter, map, (vertex, points))
            })
        })
        .collect()
}

fn mean_at_vertex(
    surface: &Surface,
    filter: TextureFilter,
    map: &TextureMap,
    (vertex, count): (usize, u32),
) -> Vec3 {
    // Both sides show the same points.
    let front = surface.vertices.front_of(vertex);
    let points = ScrambledSobol::new(SEED, front as u32);
    // A vertex's area is a third of its triangles'; points lie in all of these.
    let side = (3.0 * surface.vertices.areas()[vertex] / count as f32).sqrt();
    let sum = (0..count).fold(Vec3::ZERO, |sum, index| {
        let site = surface.vertices.sample_site(front, points.point2(index));
        let triangle = &surface.mesh.triangles[site.0 as usize];
        let (t, b) = crate::maths::sampling::tangents(triangle.flat_normal);
        let around = mean_around(&surface.mesh, map, filter, site, [t * side, b * side]);
        sum + around.unwrap_or(Vec3::ONE)
    });
    sum / count as f32
}
