//! Cut meshes hang together as before, and nothing of them straddles a contact.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3, Vec3};

use super::{Cuts, SNAP};
use crate::maths::order::Order;
use crate::scene::Scene;
use crate::scene::sample_scenes::{BOX_SIDES, Facing, SampleMesh, cube_room};
use crate::surface::vertices::join;
use crate::surface::{Detail, LightingMesh, Surface};

const EDGE: f64 = 0.25;

/// A box turned about the vertical.
fn turned_box(mesh: &mut SampleMesh, turn: f64, center: DVec3, size: DVec3, material: u32) {
    let turned = DMat3::from_rotation_y(turn);
    let at = |x, y, z| center + turned * (0.5 * size * DVec3::new(x, y, z));
    let l = -1.0;
    let h = 1.0;
    for corners in [
        [at(l, l, l), at(h, l, l), at(h, l, h), at(l, l, h)],
        [at(l, h, l), at(l, h, h), at(h, h, h), at(h, h, l)],
        [at(l, l, l), at(l, h, l), at(h, h, l), at(h, l, l)],
        [at(l, l, h), at(h, l, h), at(h, h, h), at(l, h, h)],
        [at(l, l, l), at(l, l, h), at(l, h, h), at(l, h, l)],
        [at(h, l, l), at(h, h, l), at(h, h, h), at(h, l, h)],
    ] {
        mesh.quad(corners, material);
    }
}

/// A floor (material 0) on which a turned box and a thin wall stand; a second box
/// crosses the floor; a table's leg touches it. All of it is turned, so that no
/// coordinate is round.
fn furnished_floor() -> Scene {
    let mut mesh = SampleMesh::default();
    let [low, high] = [DVec3::new(-2.0, 0.0, -1.5), DVec3::new(2.0, 0.0, 1.5)];
    let at = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    mesh.quad(
        [
            at(low.x, low.z),
            at(low.x, high.z),
            at(high.x, high.z),
            at(high.x, low.z),
        ],
        0,
    );
    let standing = DVec3::new(-0.6, 0.5, 0.3);
    turned_box(&mut mesh, 0.4, standing, DVec3::ONE, 1);
    turned_box(
        &mut mesh,
        0.9,
        DVec3::new(1.2, 0.1, -0.5),
        DVec3::splat(0.7),
        1,
    );
    let wall = [DVec3::new(0.5, 0.0, -1.5), DVec3::new(0.52, 1.0, 1.5)];
    mesh.box_sides(wall, Facing::Outward, &BOX_SIDES, 1);
    let leg = [DVec3::new(-1.7, 0.0, -1.2), DVec3::new(-1.66, 1.0, -1.16)];
    mesh.box_sides(leg, Facing::Outward, &BOX_SIDES, 1);
    let mut scene = mesh.scene(&[0.5, 0.5], EDGE, 16);
    let turned = DMat3::from_rotation_z(0.61) * DMat3::from_rotation_x(0.37);
    for position in &mut scene.mesh.positions {
        *position = turned * *position + DVec3::splat(7.0);
    }
    scene
}

fn surface(scene: &Scene) -> Surface {
    Surface::fronts(scene, &Detail::of_keys(&scene.bake))
}

/// Where a placed point of [`furnished_floor`] is before all is turned.
fn unturned(surface: &Surface, position: Vec3) -> DVec3 {
    let turned = DMat3::from_rotation_z(0.61) * DMat3::from_rotation_x(0.37);
    turned.transpose() * (surface.placement.file_from_placed(position) - DVec3::splat(7.0))
}

/// On which side of the wall and in which box a point of the floor is; `None`
/// within `margin` of a line between.
fn room(point: DVec3, margin: f64) -> Option<[i32; 4]> {
    let mut room = [0; 4];
    for (k, x) in [0.5, 0.52].into_iter().enumerate() {
        room[k] = side(point.x - x, margin)?;
    }
    let boxes = [
        (0.4, DVec3::new(-0.6, 0.5, 0.3), 0.5),
        (0.9, DVec3::new(1.2, 0.1, -0.5), 0.35),
    ];
    for (k, (turn, center, half)) in boxes.into_iter().enumerate() {
        let local = (DMat3::from_rotation_y(turn).transpose() * (point - center)).abs();
        room[2 + k] = side(local.x.at_least(local.z) - half, margin)?;
    }
    Some(room)
}

fn side(distance: f64, margin: f64) -> Option<i32> {
    (distance.abs() > margin).then_some(if distance > 0.0 { 1 } else { -1 })
}

fn floor_triangles(mesh: &LightingMesh) -> impl Iterator<Item = u32> {
    (0..mesh.triangles.len() as u32).filter(|&t| mesh.triangles[t as usize].material == 0)
}

#[test]
fn no_floor_vertex_reaches_across_a_contact() {
    let surface = surface(&furnished_floor());
    let margin = 2.0 * SNAP * EDGE;
    let mut rooms_of: BTreeMap<u32, Vec<[i32; 4]>> = BTreeMap::new();
    for triangle in floor_triangles(&surface.mesh) {
        let corners = surface
            .mesh
            .corner_positions(&surface.mesh.triangles[triangle as usize]);
        // Points all over the triangle are in one room.
        for (i, j) in (0..=8).flat_map(|i| (0..=8 - i).map(move |j| (i, j))) {
            let (u, v) = (i as f32 / 8.0, j as f32 / 8.0);
            let point = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
            if let Some(room) = room(unturned(&surface, point), margin) {
                for vertex in surface.vertices.of_triangle(triangle, true) {
                    rooms_of.entry(vertex).or_default().push(room);
                }
            }
        }
    }
    assert!(rooms_of.len() > 300, "{} floor vertices", rooms_of.len());
    let mut rooms: Vec<[i32; 4]> = Vec::new();
    for (vertex, of_vertex) in &mut rooms_of {
        of_vertex.dedup();
        assert_eq!(of_vertex.len(), 1, "vertex {vertex} is in two rooms");
        rooms.push(of_vertex[0]);
    }
    rooms.sort_unstable();
    rooms.dedup();
    // Both sides of the wall and both boxes; the inside of the wall is too thin.
    assert!(rooms.len() >= 4, "{rooms:?}");
}

#[test]
fn a_cut_floor_has_no_hole_and_no_t_junction() {
    let surface = surface(&furnished_floor());
    let mesh = &surface.mesh;
    let scale = surface.placement.scale;
    let area: f64 = floor_triangles(mesh)
        .map(|t| f64::from(mesh.triangles[t as usize].area) / (scale * scale))
        .sum();
    assert!((area - 12.0).abs() < 1e-4, "{area}");
    // Edges of the floor with one triangle are on its border.
    let mut uses: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for triangle in floor_triangles(mesh) {
        for first in 0..3 {
            let [a, b] = mesh.triangles[triangle as usize].edge(first);
            *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    for (ends, count) in uses {
        let on_border = ends.iter().all(|&end| {
            let p = unturned(&surface, mesh.positions[end as usize]);
            (p.x.abs() - 2.0).abs() < 1e-5 || (p.z.abs() - 1.5).abs() < 1e-5
        });
        let [a, b] = ends.map(|end| mesh.positions[end as usize]);
        assert!(count == 2 || (count == 1 && on_border), "{a} {b}: {count}");
        let length = f64::from(a.distance(b)) / scale;
        assert!(length < EDGE * 1.001, "an edge of {length}");
    }
}

#[test]
fn the_normals_of_cut_pieces_are_those_of_the_floor() {
    let surface = surface(&furnished_floor());
    let mesh = &surface.mesh;
    let turned = DMat3::from_rotation_z(0.61) * DMat3::from_rotation_x(0.37);
    let up = (turned * DVec3::Y).as_vec3();
    for triangle in floor_triangles(mesh) {
        let triangle = &mesh.triangles[triangle as usize];
        assert!(triangle.flat_normal.distance(up) < 1e-5);
        let [a, b, c] = mesh.corner_positions(triangle).map(|p| p.as_dvec3());
        assert!((b - a).cross(c - a).dot(up.as_dvec3()) > 0.0);
    }
}

/// Edges of the lighting mesh on which something stands.
fn cut_edges(scene: &Scene) -> usize {
    surface(scene).mesh.contacts.len()
}

#[test]
fn only_large_things_that_touch_cut() {
    assert_eq!(cut_edges(&cube_room(2.0, EDGE, 16)), 0, "a room alone");
    let floor_with = |lower: DVec3, upper: DVec3, max_edge: f64| {
        let mut mesh = SampleMesh::default();
        mesh.box_sides(
            [DVec3::new(-2.0, -1.0, -2.0), DVec3::new(2.0, 1.0, 2.0)],
            Facing::Inward,
            &BOX_SIDES,
            0,
        );
        mesh.box_sides([lower, upper], Facing::Outward, &BOX_SIDES, 0);
        mesh.scene(&[0.5], max_edge, 16)
    };
    let low = DVec3::new(-0.55, -1.0, -0.55);
    let high = DVec3::new(0.62, 0.1, 0.57);
    assert!(cut_edges(&floor_with(low, high, EDGE)) > 16, "a box");
    let lifted = DVec3::Y * 0.1;
    let hovering = floor_with(low + lifted, high, EDGE);
    assert_eq!(cut_edges(&hovering), 0, "a box that hovers");
    let leg = floor_with(low, low + DVec3::new(0.05, 1.0, 0.05), EDGE);
    assert_eq!(cut_edges(&leg), 0, "a leg");
    let small = floor_with(low, low + 0.14, EDGE);
    assert_eq!(cut_edges(&small), 0, "a box smaller than an edge");
}

#[test]
fn joints_of_contacts_keep_the_surface_one_to_pixels() {
    let surface = surface(&furnished_floor());
    let joints = join(&surface.mesh);
    let mut patches: Vec<u32> = floor_triangles(&surface.mesh)
        .map(|t| joints.patches[t as usize])
        .collect();
    patches.sort_unstable();
    patches.dedup();
    let separate = surface.mesh.contacts.len();
    assert!(separate > 40, "{separate} edges of contacts");
    assert!(patches.len() <= 5, "{} patches", patches.len());
}

/// A floor on which a wall stands, at a place that is hardly not 0.
#[test]
fn coordinates_that_vanish_in_products_are_cut_like_zero() {
    let pieces_at = |x: f32| {
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let [a, b, c, d] = [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)];
        let up = |z: f32| Vec3::new(x, 0.8, z);
        let [e, f] = [at(x, -0.7), at(x, 0.6)];
        let triangles = [
            [a, b, c],
            [a, c, d],
            [e, f, up(0.6)],
            [e, up(0.6), up(-0.7)],
        ];
        let cuts = Cuts::of(&triangles, 0.25);
        let pieces = |triangle: u32| cuts.pieces(triangle).map_or(0, <[_]>::len);
        assert!(!cuts.contacts.is_empty(), "the wall stands on the floor");
        [pieces(0), pieces(1)]
    };
    let at_zero = pieces_at(0.0);
    assert!(at_zero[0] > 10 && at_zero[1] > 10, "{at_zero:?}");
    for x in [1e-44, -1e-44, f32::from_bits(1), 1e-42, 1e-38] {
        assert_eq!(pieces_at(x), at_zero, "{x:e}");
    }
}
