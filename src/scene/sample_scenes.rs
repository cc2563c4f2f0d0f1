//! Small scenes whose light is known, for tests of the stages after this one.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::files::{Files, Memory};
use super::sample_images;
use super::{
    Area, BakeKeys, Camera, Directional, Environment, GoldenKeys, Light, LightKind, Material, Mesh,
    MeshTriangle, Point, Radiance, RenderKeys, Scene, Spot,
};
use crate::texture::{EnvironmentMap, TextureFilter};

pub(crate) use super::sample_images::tga;

/// Which way the fronts of a closed body look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Facing {
    /// Into it: a room.
    Inward,
    /// Out of it: a thing.
    Outward,
}

/// A side of a box: the axis that it is perpendicular to, and which end.
pub(crate) type BoxSide = (usize, bool);

/// The six sides of a box.
pub(crate) const BOX_SIDES: [BoxSide; 6] = [
    (0, false),
    (0, true),
    (1, false),
    (1, true),
    (2, false),
    (2, true),
];

/// Long side over short side of the rectangles that span an icosahedron.
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;
/// Grid that corners of a unit sphere are rounded to, so that faces which
/// compute them in different orders get equal bits.
const SPHERE_GRID: f64 = (1 << 30) as f64;
/// Faces of an icosahedron, counter-clockwise from outside, as indices into
/// [`icosahedron_corners`].
const ICOSAHEDRON: [[usize; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// A mesh that grows body by body; all corners are file units.
#[derive(Debug, Clone, Default)]
pub(crate) struct SampleMesh {
    mesh: Mesh,
}

impl SampleMesh {
    /// Adds a triangle, counter-clockwise seen from its front.
    pub(crate) fn triangle(&mut self, corners: [DVec3; 3], material: u32) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(corners);
        self.mesh.triangles.push(MeshTriangle {
            corners: [first, first + 1, first + 2],
            normals: None,
            texture_coordinates: None,
            material,
        });
    }

    /// Adds a quad as two triangles, counter-clockwise seen from its front.
    pub(crate) fn quad(&mut self, corners: [DVec3; 4], material: u32) {
        let [a, b, c, d] = corners;
        self.triangle([a, b, c], material);
        self.triangle([a, c, d], material);
    }

    /// Adds sides of a box, all of one material.
    pub(crate) fn box_sides(
        &mut self,
        [lower, upper]: [DVec3; 2],
        facing: Facing,
        sides: &[BoxSide],
        material: u32,
    ) {
        for &(axis, high) in sides {
            let [a, b, c, d] = rectangle([lower, upper], (axis, high));
            // The corners run counter-clockwise seen from high values.
            if high == (facing == Facing::Outward) {
                self.quad([a, b, c, d], material);
            } else {
                self.quad([a, d, c, b], material);
            }
        }
    }

    /// Adds a sphere around the origin: an icosahedron whose edges are divided
    /// into `frequency` pieces, 10 `frequency`^2 + 2 vertices.
    pub(crate) fn sphere(&mut self, radius: f64, frequency: u32, facing: Facing) {
        let corners = icosahedron_corners();
        for face in ICOSAHEDRON {
            let [a, b, c] = face.map(|k| corners[k]);
            let at = |i: u32, j: u32| {
                let (u, v) = (f64::from(i), f64::from(j));
                let point = a * (f64::from(frequency) - u - v) + b * u + c * v;
                (point.normalize() * SPHERE_GRID).round() / SPHERE_GRID * radius
            };
            let mut add = |p: DVec3, q: DVec3, r: DVec3| match facing {
                Facing::Outward => self.triangle([p, q, r], 0),
                Facing::Inward => self.triangle([p, r, q], 0),
            };
            for i in 0..frequency {
                for j in 0..frequency - i {
                    add(at(i, j), at(i + 1, j), at(i, j + 1));
                    if i + j + 1 < frequency {
                        add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                    }
                }
            }
        }
    }

    /// A scene of the mesh: grey materials of the albedos, no light, a bake of
    /// so many rays a vertex and of edges of at most `max_edge`.
    pub(crate) fn scene(self, albedos: &[f32], max_edge: f64, rays: u32) -> Scene {
        let (lower, upper) = self.mesh.bounds();
        Scene {
            materials: albedos.iter().map(|&rho| grey(rho)).collect(),
            lights: Vec::new(),
            texture_filter: TextureFilter::default(),
            camera: Camera {
                position: lower + (upper - lower) * DVec3::new(0.4, 0.5, 0.9),
                target: (lower + upper) * 0.5,
                up: DVec3::Y,
                vfov_deg: 90.0,
                size: [64, 64],
            },
            render: RenderKeys::default(),
            bake: BakeKeys {
                max_edge: Some(max_edge),
                rays: Some(rays),
                ..BakeKeys::default()
            },
            animations: Vec::new(),
            golden: GoldenKeys::default(),
            files: Vec::new(),
            warnings: Vec::new(),
            mesh: self.mesh,
        }
    }
}

/// A grey diffuse material.
fn grey(albedo: f32) -> Material {
    Material {
        albedo: Vec3::splat(albedo),
        ..Material::unnamed()
    }
}

/// A point light of so many W/sr in every channel.
pub(crate) fn point_light(position: DVec3, intensity: f32) -> Light {
    Light {
        name: "lamp".to_owned(),
        kind: LightKind::Point(Point {
            position,
            intensity: Vec3::splat(intensity),
        }),
    }
}

/// A light of a kind.
fn light(name: &str, kind: LightKind) -> Light {
    Light {
        name: name.to_owned(),
        kind,
    }
}

/// A rectangle that emits on the side of its first edge x its second.
pub(crate) fn area_light(corner: DVec3, [edge_u, edge_v]: [DVec3; 2], radiance: f32) -> Light {
    let area = Area {
        corner,
        edge_u,
        edge_v,
        radiance: Vec3::splat(radiance),
    };
    light("rectangle", LightKind::Area(area))
}

/// A rectangle that emits downward, from its lowest to its highest corner.
pub(crate) fn lamp_facing_down(lower: DVec3, upper: DVec3, radiance: f32) -> Light {
    let size = upper - lower;
    area_light(lower, [DVec3::X * size.x, DVec3::Z * size.z], radiance)
}

/// A spot of so many W/sr that looks down; half angles in degrees.
pub(crate) fn spot_facing_down(
    position: DVec3,
    intensity: f32,
    [beam_deg, cutoff_deg]: [f32; 2],
) -> Light {
    let spot = Spot {
        position,
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(intensity),
        cutoff_deg,
        beam_deg,
    };
    light("spot", LightKind::Spot(spot))
}

/// Parallel light that travels in a direction (any length).
pub(crate) fn directional_light(direction: Vec3, irradiance: f32) -> Light {
    let directional = Directional {
        direction: direction.normalize(),
        irradiance: Vec3::splat(irradiance),
    };
    light("sun", LightKind::Directional(directional))
}

/// The same radiance from everywhere.
pub(crate) fn constant_sky(radiance: f32) -> Light {
    let sky = Environment {
        radiance: Radiance::Constant(Vec3::splat(radiance)),
        scale: 1.0,
        rotation_deg: 0.0,
    };
    light("sky", LightKind::Environment(sky))
}

/// A sky by columns and rows of a latitude-longitude map, as its file would
/// give it. Maps of one size are equal unless their names differ.
pub(crate) fn mapped_sky(
    name: &str,
    size: [u32; 2],
    radiance: impl Fn(u32, u32) -> f32,
) -> Environment {
    let bytes = sample_images::hdr(size, radiance);
    let path = format!("{name}.hdr");
    let map = EnvironmentMap::decode(&bytes, Path::new(&path)).expect("the bytes are an HDR file");
    Environment {
        radiance: Radiance::Map(Arc::new(map)),
        scale: 1.0,
        rotation_deg: 0.0,
    }
}

/// The light of a sky.
pub(crate) fn sky_light(sky: Environment) -> Light {
    light("sky", LightKind::Environment(sky))
}

/// A scene of files in memory, the first of which is the scene file.
pub(crate) fn scene_of_files(files: &[(&str, &[u8])]) -> Scene {
    let memory = Memory::of(files);
    let path = Path::new(files[0].0);
    let bytes = memory.read(path).expect("the first file is there");
    Scene::load_with(&bytes, path, &[], &memory).expect("the files are a scene")
}

/// A room of 2 m around the origin with a square window of a side of
/// 2 `half_window` in the middle of the wall at x = 1; with or without a block
/// that hovers before it.
pub(crate) fn room_with_window(
    half_window: f64,
    has_block: bool,
    max_edge: f64,
    rays: u32,
) -> Scene {
    let mut mesh = SampleMesh::default();
    let others: Vec<BoxSide> = BOX_SIDES
        .into_iter()
        .filter(|&side| side != (0, true))
        .collect();
    mesh.box_sides([DVec3::NEG_ONE, DVec3::ONE], Facing::Inward, &others, 0);
    let cuts = [-1.0, -half_window, half_window, 1.0];
    for (row, column) in (0..9).map(|k| (k / 3, k % 3)).filter(|&at| at != (1, 1)) {
        let lower = DVec3::new(-1.0, cuts[row], cuts[column]);
        let upper = DVec3::new(1.0, cuts[row + 1], cuts[column + 1]);
        mesh.box_sides([lower, upper], Facing::Inward, &[(0, true)], 0);
    }
    if has_block {
        let corners = [DVec3::new(0.1, -0.6, -0.5), DVec3::new(0.5, 0.1, 0.1)];
        mesh.box_sides(corners, Facing::Outward, &BOX_SIDES, 0);
    }
    mesh.scene(&[0.5], max_edge, rays)
}

/// A closed cube with inward fronts around the origin.
pub(crate) fn cube_room(size: f64, max_edge: f64, rays: u32) -> Scene {
    let half = DVec3::splat(0.5 * size);
    let mut mesh = SampleMesh::default();
    mesh.box_sides([-half, half], Facing::Inward, &BOX_SIDES, 0);
    mesh.scene(&[0.5], max_edge, rays)
}

/// A sphere with inward fronts around the origin.
pub(crate) fn hollow_sphere(radius: f64, frequency: u32, rays: u32) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.sphere(radius, frequency, Facing::Inward);
    mesh.scene(&[0.5], radius, rays)
}

/// A room of 2 m, closed or open towards +z, with two blocks that hover (so
/// that no part of the floor is hidden from all light).
pub(crate) fn room_with_blocks(closed: bool, max_edge: f64, rays: u32) -> Scene {
    let mut mesh = SampleMesh::default();
    let sides = if closed {
        &BOX_SIDES[..]
    } else {
        &BOX_SIDES[..5]
    };
    mesh.box_sides([DVec3::splat(-1.0), DVec3::ONE], Facing::Inward, sides, 0);
    for [lower, upper] in [
        [[0.1, -0.9, 0.0], [0.6, -0.4, 0.5]],
        [[-0.7, -0.8, -0.6], [-0.2, 0.4, -0.1]],
    ] {
        let corners = [DVec3::from_array(lower), DVec3::from_array(upper)];
        mesh.box_sides(corners, Facing::Outward, &BOX_SIDES, 1);
    }
    mesh.scene(&[0.7, 0.5], max_edge, rays)
}

/// 200 boxes of different sizes that touch nothing, fronts outward.
pub(crate) fn separate_boxes(max_edge: f64, rays: u32) -> Scene {
    let mut mesh = SampleMesh::default();
    for index in 0..200 {
        let cell = DVec3::new(
            f64::from(index % 10),
            f64::from(index / 10 % 5),
            f64::from(index / 50),
        );
        let size = 0.3 + 0.05 * f64::from(index % 7);
        let corners = [cell, cell + DVec3::new(size, 0.8 * size, 0.6)];
        mesh.box_sides(corners, Facing::Outward, &BOX_SIDES, 0);
    }
    mesh.scene(&[0.5], max_edge, rays)
}

/// A side of a box, counter-clockwise seen from high values of its axis.
fn rectangle([lower, upper]: [DVec3; 2], (axis, high): BoxSide) -> [DVec3; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut corner = if high { upper } else { lower };
    [(false, false), (true, false), (true, true), (false, true)].map(|(at_u, at_v)| {
        corner[u] = if at_u { upper[u] } else { lower[u] };
        corner[v] = if at_v { upper[v] } else { lower[v] };
        corner
    })
}

fn icosahedron_corners() -> Vec<DVec3> {
    let mut corners = Vec::with_capacity(12);
    for axis in 0..3 {
        for [along, across] in [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
            let mut corner = DVec3::ZERO;
            corner[axis] = along;
            corner[(axis + 1) % 3] = across * GOLDEN_RATIO;
            corners.push(corner);
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signed volume, positive if the fronts look outward.
    fn volume(mesh: &SampleMesh) -> f64 {
        let corners = |t: &MeshTriangle| t.corners.map(|c| mesh.mesh.positions[c as usize]);
        let triangles = mesh.mesh.triangles.iter().map(corners);
        triangles.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn bodies_have_their_volume_and_face_their_way() {
        for (facing, sign) in [(Facing::Inward, -1.0), (Facing::Outward, 1.0)] {
            let mut cuboid = SampleMesh::default();
            let corners = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 4.0, 6.0)];
            cuboid.box_sides(corners, facing, &BOX_SIDES, 0);
            assert_eq!(volume(&cuboid), sign * 6.0, "box, {facing:?}");

            let mut sphere = SampleMesh::default();
            sphere.sphere(1.0, 16, facing);
            let share = volume(&sphere) / (4.0 / 3.0 * std::f64::consts::PI) * sign;
            assert!((0.98..1.0).contains(&share), "sphere, {facing:?}: {share}");
            assert_eq!(sphere.mesh.triangles.len(), 20 * 16 * 16);
        }
    }

    #[test]
    fn a_sphere_has_no_seams() {
        let mut sphere = SampleMesh::default();
        sphere.sphere(1.0, 16, Facing::Inward);
        let mut corners: Vec<[u64; 3]> = sphere
            .mesh
            .positions
            .iter()
            .map(|p| p.to_array().map(|x| (x + 0.0).to_bits()))
            .collect();
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(
            corners.len(),
            10 * 16 * 16 + 2,
            "corners that are not shared"
        );
    }
}
