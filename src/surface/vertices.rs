//! Lighting vertices: where radiosity and irradiance live.
//!
//! A lighting vertex is a point, a normal group, a material and a side. Corners
//! of triangles that meet at a point belong to one vertex if their triangles
//! are joined across edges that are no crease, no border of a material and no
//! border of the surface.

use glam::Vec3;

use super::Arrival;
use super::forest::Forest;
use super::mesh::{EdgeSide, LightingMesh, NONE, SurfaceTriangle, interpolated};
use crate::maths::functions::{acos_f32, sin_f32};

/// Shading normals that differ by more than this split a vertex: cosine of 20
/// degrees. A cylinder of 18 flat facets is the coarsest that counts as
/// smooth; irradiance averaged over facets 20 degrees apart differs from
/// either facet's by at most 2 % under a wide source.
const CREASE_COSINE: f32 = 0.94;

/// Shading normals that differ by more than this are two surfaces to a pixel:
/// cosine of 1.1 degrees. A pixel takes one point of each surface, and flat
/// facets 5 degrees apart, shaded as one, left 2 % of error in a picture (the
/// textured cow); 1.1 degrees change a grazing light's cosine by 2 % at most.
const PIXEL_SMOOTH_COSINE: f32 = 0.9998;

/// A point on one side of the surface, with the normals of that side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfacePoint {
    /// Placed units.
    pub(crate) position: Vec3,
    /// Unit shading normal.
    pub(crate) normal: Vec3,
    /// Unit normal of the flat triangle.
    pub(crate) flat_normal: Vec3,
}

/// One triangle at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FanTriangle {
    triangle: u32,
    /// Which corner of the triangle the vertex is.
    corner: u8,
    /// Area of the fan's triangles up to and with this one.
    cumulative_area: f32,
}

/// The lighting vertices: fronts first, along a space-filling curve, then backs.
#[derive(Debug, Clone, Default)]
pub(crate) struct LightingVertices {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    areas: Vec<f32>,
    materials: Vec<u32>,
    fan_offsets: Vec<u32>,
    fans: Vec<FanTriangle>,
    /// Which points of each vertex's area are in the open, a bit each.
    open_points: Vec<u8>,
    /// The front vertex of each back vertex, ascending.
    front_of_back: Vec<u32>,
    front_count: usize,
    /// Per triangle, the vertices of its front side.
    fronts: Vec<[u32; 3]>,
    /// Per triangle, the vertices of its back side, or [`NONE`].
    backs: Vec<[u32; 3]>,
}

/// An edge of the lighting mesh as drawing needs it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MeshEdge {
    /// Positions of the ends.
    pub(crate) corners: [u32; 2],
    /// The triangles on it; the second is [`NONE`] at a border.
    pub(crate) triangles: [u32; 2],
    /// Whether the surface, or the texture on it, is not smooth across it.
    pub(crate) crease: bool,
}

/// How triangles hang together.
pub(crate) struct Joints {
    /// Per triangle: the smooth patch that it belongs to.
    pub(crate) patches: Vec<u32>,
    pub(crate) edges: Vec<MeshEdge>,
    /// Lighting-vertex group of each triangle corner (3 a triangle), by its
    /// lowest corner.
    groups: Vec<u32>,
}

/// Joins corners and triangles across smooth edges. Three or more triangles on
/// an edge never join, nor do those on a contact: where a wall stands on a floor,
/// the floor's vertices on its two sides are different ones and nothing leaks.
/// To a pixel the floor is one surface all the same.
pub(crate) fn join(mesh: &LightingMesh) -> Joints {
    let mut corners = Forest::new(mesh.triangles.len() * 3);
    let mut patches = Forest::new(mesh.triangles.len());
    let mut edges = Vec::new();
    for sides in mesh.edge_sides().chunk_by(|a, b| a.corners == b.corners) {
        let is_contact = mesh.contacts.binary_search(&sides[0].corners).is_ok();
        let (smooth, second) = match sides {
            [a, b] if is_contact => (join_pair(mesh, *a, *b, None), b.triangle),
            [a, b] => (join_pair(mesh, *a, *b, Some(&mut corners)), b.triangle),
            _ => (false, NONE),
        };
        let smooth = smooth && is_map_continuous(mesh, sides);
        if smooth {
            patches.join(sides[0].triangle, second);
        }
        edges.push(MeshEdge {
            corners: sides[0].corners,
            triangles: [sides[0].triangle, second],
            crease: !smooth,
        });
    }
    Joints {
        patches: (0..mesh.triangles.len() as u32)
            .map(|t| patches.root(t))
            .collect(),
        edges,
        groups: (0..mesh.triangles.len() as u32 * 3)
            .map(|c| corners.root(c))
            .collect(),
    }
}

/// Whether the two triangles on an edge have the same texture coordinates
/// there, so that a pixel across it shows one piece of a texture.
fn is_map_continuous(mesh: &LightingMesh, sides: &[EdgeSide]) -> bool {
    let [a, b] = sides else { return false };
    let at = |side: &EdgeSide| mesh.texture_coordinates_of(side.triangle);
    match (at(a), at(b)) {
        (None, None) => true,
        (Some(s), Some(t)) => {
            let (i, j) = (usize::from(a.first), usize::from(b.first));
            // The edge runs the other way in the neighbour.
            s[i] == t[(j + 1) % 3] && s[(i + 1) % 3] == t[j]
        }
        _ => false,
    }
}

/// Joins the corners at both ends of an edge between two triangles, if any are to
/// be joined, where their normals agree; returns whether they do at both ends so well that a pixel sees
/// one surface.
fn join_pair(
    mesh: &LightingMesh,
    a: EdgeSide,
    b: EdgeSide,
    mut corners: Option<&mut Forest>,
) -> bool {
    let (s, t) = (
        &mesh.triangles[a.triangle as usize],
        &mesh.triangles[b.triangle as usize],
    );
    let same_way_round = s.edge(a.first)[0] == t.edge(b.first)[0];
    if s.material != t.material || same_way_round {
        return false;
    }
    let (i, j) = (usize::from(a.first), usize::from(b.first));
    // The edge runs the other way in the neighbour: its start is our end.
    let ends = [(i, (j + 1) % 3), ((i + 1) % 3, j)];
    let mut smooth = true;
    for (k, l) in ends {
        let cosine = s.normals[k].dot(t.normals[l]);
        if cosine >= CREASE_COSINE
            && let Some(corners) = &mut corners
        {
            corners.join(a.triangle * 3 + k as u32, b.triangle * 3 + l as u32);
        }
        smooth &= cosine >= PIXEL_SMOOTH_COSINE;
    }
    smooth
}

impl LightingVertices {
    /// The front sides' vertices, in the order of a space-filling curve.
    pub(crate) fn fronts(mesh: &LightingMesh, joints: &Joints) -> Self {
        let position_of = |corner: u32| {
            let triangle = &mesh.triangles[corner as usize / 3];
            mesh.positions[triangle.corners[corner as usize % 3] as usize]
        };
        let mut order: Vec<(u64, u32, u32)> = (0..joints.groups.len() as u32)
            .map(|c| (joints.groups[c as usize], c))
            .map(|(group, c)| (morton(position_of(group)), group, c))
            .collect();
        order.sort_unstable();

        let mut vertices = Self {
            fronts: vec![[NONE; 3]; mesh.triangles.len()],
            ..Self::default()
        };
        for fan in order.chunk_by(|a, b| a.1 == b.1) {
            let index = vertices.positions.len() as u32;
            let mut normal = Vec3::ZERO;
            let mut area = 0.0;
            vertices.fan_offsets.push(vertices.fans.len() as u32);
            for &(_, _, c) in fan {
                let (triangle, corner) = (c / 3, (c % 3) as u8);
                let t = &mesh.triangles[triangle as usize];
                normal += t.normals[usize::from(corner)] * t.area;
                area += t.area;
                vertices.fronts[triangle as usize][usize::from(corner)] = index;
                vertices.fans.push(FanTriangle {
                    triangle,
                    corner,
                    cumulative_area: area,
                });
            }
            let first = &mesh.triangles[fan[0].2 as usize / 3];
            vertices.positions.push(position_of(fan[0].1));
            vertices.normals.push(interpolated(
                [normal, Vec3::ZERO, Vec3::ZERO],
                Vec3::X,
                first.flat_normal,
            ));
            vertices.areas.push(area / 3.0);
            vertices.materials.push(first.material);
        }
        vertices.fan_offsets.push(vertices.fans.len() as u32);
        vertices.front_count = vertices.positions.len();
        vertices.open_points = vec![u8::MAX; vertices.front_count];
        vertices.backs = vec![[NONE; 3]; mesh.triangles.len()];
        vertices
    }

    /// Adds the back side of every front vertex that is marked.
    pub(crate) fn add_backs(&mut self, wanted: &[bool]) {
        assert_eq!(wanted.len(), self.front_count, "one mark a front vertex");
        let mut back_of = vec![NONE; self.front_count];
        for front in (0..self.front_count).filter(|&i| wanted[i]) {
            back_of[front] = self.positions.len() as u32;
            self.positions.push(self.positions[front]);
            self.normals.push(-self.normals[front]);
            self.areas.push(self.areas[front]);
            self.materials.push(self.materials[front]);
            self.open_points.push(u8::MAX);
            self.front_of_back.push(front as u32);
        }
        for (back, front) in self.backs.iter_mut().zip(&self.fronts) {
            *back = front.map(|v| back_of[v as usize]);
        }
    }

    /// Says which points of each vertex's area are in the open.
    pub(crate) fn set_open_points(&mut self, open_points: Vec<u8>) {
        assert_eq!(open_points.len(), self.len(), "one set of points a vertex");
        self.open_points = open_points;
    }

    /// The points of a vertex's area that are in the open, a bit each.
    pub(crate) fn open_points(&self, vertex: usize) -> u8 {
        self.open_points[vertex]
    }

    /// Area of a vertex that is in the open, placed units squared: what is inside
    /// a closed body, such as the floor under a box, nobody sees.
    pub(crate) fn open_area(&self, vertex: usize) -> f32 {
        let open = self.open_points[vertex].count_ones() as f32 / u8::BITS as f32;
        self.areas[vertex] * open
    }

    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    pub(crate) fn front_count(&self) -> usize {
        self.front_count
    }

    /// Positions, placed units.
    pub(crate) fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Unit normals of the vertices' sides.
    pub(crate) fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Areas: a third of the triangles around each vertex, placed units squared.
    pub(crate) fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// Material index of each vertex.
    pub(crate) fn materials(&self) -> &[u32] {
        &self.materials
    }

    /// Vertices at a triangle's corners on its front or back side; [`NONE`]
    /// where the side has none.
    pub(crate) fn of_triangle(&self, triangle: u32, front: bool) -> [u32; 3] {
        if front {
            self.fronts[triangle as usize]
        } else {
            self.backs[triangle as usize]
        }
    }

    /// Vertices at whose corners a ray arrived, and their weights, without those that
    /// have none; `None` where the side has no vertices: inside of a body.
    pub(crate) fn met(&self, hit: &Arrival) -> Option<impl Iterator<Item = (u32, f32)>> {
        let corners = self.of_triangle(hit.triangle, hit.front);
        let weighted = corners.into_iter().zip(hit.barycentrics);
        let met = weighted.filter(|&(vertex, weight)| vertex != NONE && weight > 0.0);
        (corners != [NONE; 3]).then_some(met)
    }

    /// The front vertex of a back vertex, itself for a front vertex.
    pub(crate) fn front_of(&self, vertex: usize) -> usize {
        match vertex.checked_sub(self.front_count) {
            None => vertex,
            Some(back) => self.front_of_back[back] as usize,
        }
    }

    /// The point of a vertex's area for two uniforms, with density proportional
    /// to area x barycentric hat.
    ///
    /// The first uniform walks round the fan: it picks a triangle by area and
    /// what is left of it divides the two far corners; the second gives the
    /// hat's weight, whose distribution Beta(2, 2) is inverted in closed form.
    /// (The same distribution as sorting three uniforms, Dirichlet(2, 1, 1),
    /// with one dimension less for the low-discrepancy points.)
    pub(crate) fn sample_point(
        &self,
        mesh: &LightingMesh,
        vertex: usize,
        u: [f32; 2],
    ) -> SurfacePoint {
        let (triangle, barycentrics) = self.sample_site(vertex, u);
        surface_point(
            mesh,
            triangle,
            barycentrics,
            self.front_of(vertex) == vertex,
        )
    }

    /// The triangles of a vertex, each with the number of its corner there.
    pub(crate) fn fan(&self, vertex: usize) -> impl Iterator<Item = (u32, usize)> {
        let front = self.front_of(vertex);
        let range = self.fan_offsets[front] as usize..self.fan_offsets[front + 1] as usize;
        let fan = self.fans[range].iter();
        fan.map(|part| (part.triangle, usize::from(part.corner)))
    }

    /// Triangle and barycentric coordinates of [`Self::sample_point`].
    pub(crate) fn sample_site(&self, vertex: usize, u: [f32; 2]) -> (u32, [f32; 3]) {
        let front = self.front_of(vertex);
        let fan =
            &self.fans[self.fan_offsets[front] as usize..self.fan_offsets[front + 1] as usize];
        let total = fan[fan.len() - 1].cumulative_area;
        let target = u[0] * total;
        let k = fan
            .partition_point(|f| f.cumulative_area <= target)
            .min(fan.len() - 1);
        let before = if k == 0 {
            0.0
        } else {
            fan[k - 1].cumulative_area
        };
        let across = ((target - before) / (fan[k].cumulative_area - before)).clamp(0.0, 1.0);
        let hat = inverse_hat(u[1]);
        let corner = usize::from(fan[k].corner);
        let mut barycentrics = [0.0; 3];
        barycentrics[corner] = hat;
        barycentrics[(corner + 1) % 3] = (1.0 - hat) * (1.0 - across);
        barycentrics[(corner + 2) % 3] = (1.0 - hat) * across;
        (fan[k].triangle, barycentrics)
    }
}

/// The point of a triangle at barycentric coordinates, seen from one side.
pub(crate) fn surface_point(
    mesh: &LightingMesh,
    triangle: u32,
    barycentrics: [f32; 3],
    front: bool,
) -> SurfacePoint {
    let t: &SurfaceTriangle = &mesh.triangles[triangle as usize];
    let [a, b, c] = mesh.corner_positions(t);
    let normal = interpolated(t.normals, Vec3::from_array(barycentrics), t.flat_normal);
    let side = if front { 1.0 } else { -1.0 };
    SurfacePoint {
        position: a * barycentrics[0] + b * barycentrics[1] + c * barycentrics[2],
        normal: normal * side,
        flat_normal: t.flat_normal * side,
    }
}

/// Inverse of the distribution 3 x^2 - 2 x^3 (Beta(2, 2)), by the
/// trigonometric solution of the cubic.
fn inverse_hat(u: f32) -> f32 {
    let third = (std::f32::consts::FRAC_PI_2 - acos_f32(1.0 - 2.0 * u)) / 3.0;
    (0.5 - sin_f32(third)).clamp(0.0, 1.0)
}

/// Position on the space-filling curve of Morton, 21 bits an axis.
fn morton(position: Vec3) -> u64 {
    let spread = |x: f32| {
        let cell =
            ((f64::from(x) + 1.0) * f64::from(1 << 20)).clamp(0.0, f64::from((1 << 21) - 1)) as u64;
        let mut v = cell;
        v = (v | (v << 32)) & 0x001f_0000_0000_ffff;
        v = (v | (v << 16)) & 0x001f_0000_ff00_00ff;
        v = (v | (v << 8)) & 0x100f_00f0_0f00_f00f;
        v = (v | (v << 4)) & 0x10c3_0c30_c30c_30c3;
        (v | (v << 2)) & 0x1249_2492_4924_9249
    };
    spread(position.x) << 2 | spread(position.y) << 1 | spread(position.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hat_weight_inverts_its_distribution() {
        for u in [0.0_f32, 0.1, 0.25, 0.5, 0.9, 0.999] {
            let x = inverse_hat(u);
            assert!((3.0 * x * x - 2.0 * x * x * x - u).abs() < 1e-5, "{u}: {x}");
        }
    }

    #[test]
    fn morton_order_keeps_neighbours_together() {
        let near = morton(Vec3::splat(0.1)) ^ morton(Vec3::splat(0.1001));
        let far = morton(Vec3::splat(0.1)) ^ morton(Vec3::splat(0.9));
        assert!(near < far);
    }
}
