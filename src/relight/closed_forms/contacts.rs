//! Walls and meshes that meet: what passes where they do, and meshes of unequal
//! fineness.

use glam::{DMat3, DVec3, Vec3};

use super::enclosures::form_factor_of_face;
use super::{Baked, Deviation, at_least, at_most, largest};
use crate::maths::order::Order;
use crate::scene::sample_scenes::{BOX_SIDES, Facing, SampleMesh, cube_room, point_light};
use crate::scene::{Bounces, Scene};

/// Edges of the tessellation of rooms side by side.
const EDGE: f64 = 0.25;
/// Light one edge length behind a wall that stands on a floor mesh of both
/// rooms, share of the lit room's mean: a thousandth is not seen beside the lit room.
/// Nothing at all is measured, since floors are cut below walls; it was 2.3 % where their
/// vertices had area in both rooms.
const BEHIND_WALL: f64 = 1e-3;
/// Irradiance at common points of a coarse and a partly fine mesh: what nobody sees. (1.3 %
/// is measured at the worst of the places.)
const UNEVEN: f64 = 0.02;
/// The same of indirect light alone at the worst of the places: 1.9 % is measured, and by
/// 2,048 and 6,144 rays a vertex 2.1 and 2.0 %, at a corner of the cube, where light falls
/// off within a coarse edge, so it is the coarse mesh and no noise. The mean is off by half
/// a per cent, and by 0.1 with edges of 0.2 m.
const UNEVEN_INDIRECT: f64 = 0.03;
/// How many times finer the fine wall is.
const FINER: f64 = 10.0;
/// Basis functions and coefficients a vertex that leave next to nothing out.
const FUNCTIONS: u32 = 360;
const COEFFICIENTS: u32 = 360;
/// Share of rays that slip out of a closed room: a hundred of a million. Cracks of
/// 1e-5 m are 2e-6 of a box, and lose as many; a seam as wide as 1e-3 m would be seen.
const LEAK: f64 = 1e-4;

/// Where the light of the lit room, the one at low x, is.
pub(super) fn lamp() -> [crate::scene::Light; 1] {
    [point_light(DVec3::new(-1.2, 0.3, 0.2), 1.0)]
}

/// Two closed rooms side by side, a wall's thickness apart.
pub(super) fn rooms_apart(thickness: f64) -> Scene {
    let mut mesh = SampleMesh::default();
    let half = 0.5 * thickness;
    for (material, low, high) in [(0, -2.0, -half), (1, half, 2.0)] {
        let corners = [DVec3::new(low, -1.0, -1.0), DVec3::new(high, 1.0, 1.0)];
        mesh.box_sides(corners, Facing::Inward, &BOX_SIDES, material);
    }
    mesh.scene(&[0.7, 0.7], EDGE, 256)
}

/// Direct and bounced light of all channels by vertex.
fn light_at_vertices(rooms: &Baked) -> Vec<f64> {
    let direct = rooms.direct(&lamp());
    let indirect = rooms.indirect(&lamp(), 0.7, Bounces::Count(4));
    let sum = |(d, i): (&Vec3, &Vec3)| f64::from(d.abs().x + i.abs().x);
    direct.iter().zip(&indirect).map(sum).collect()
}

/// Mean of the lit room's fronts.
fn mean_of_lit(rooms: &Baked, light: &[f64]) -> f64 {
    let lit: Vec<usize> = rooms
        .fronts()
        .filter(|&v| rooms.position(v).x < -0.1)
        .collect();
    lit.iter().map(|&v| light[v]).sum::<f64>() / lit.len() as f64
}

#[test]
fn a_room_that_shares_no_triangle_with_a_lit_one_is_black() {
    // A wall of 1 mm, and two walls in one plane.
    for thickness in [1e-3, 0.0] {
        let rooms = Baked::new(&rooms_apart(thickness));
        let light = light_at_vertices(&rooms);
        assert!(mean_of_lit(&rooms, &light) > 0.1, "the lit room is lit");
        // The second of two walls in one plane is left out: the first one's
        // back is the black room's.
        let is_dark = |v: &usize| {
            let is_wall_between = rooms.position(*v).x.abs() < 0.01;
            rooms.surface.vertices.materials()[*v] == 1
                || (is_wall_between && rooms.normal(*v).x > 0.9)
        };
        let dark: Vec<usize> = (0..rooms.vertex_count()).filter(is_dark).collect();
        assert!(dark.len() > 500, "{} dark vertices", dark.len());
        let figures = dark.into_iter().map(|v| light[v]);
        let what = format!("light behind a wall of {thickness} m, brightest vertex");
        at_most(&what, largest(figures), 0.0);
    }
}

#[test]
fn little_light_passes_below_a_wall_on_a_common_floor() {
    let mut mesh = SampleMesh::default();
    let shell = [DVec3::new(-2.0, -1.0, -1.0), DVec3::new(2.0, 1.0, 1.0)];
    mesh.box_sides(shell, Facing::Inward, &BOX_SIDES, 0);
    let wall = [DVec3::new(-0.01, -1.0, -1.0), DVec3::new(0.01, 1.0, 1.0)];
    mesh.box_sides(wall, Facing::Outward, &[(0, false), (0, true)], 1);
    let scene = mesh.scene(&[0.7, 0.7], EDGE, 256);
    for edge in [0.5 * EDGE, EDGE] {
        let mut scene = scene.clone();
        scene.bake.max_edge = Some(edge);
        let rooms = Baked::new(&scene);
        let light = light_at_vertices(&rooms);
        let mean = mean_of_lit(&rooms, &light);
        let brightest = |from: f64, to: f64| {
            let is_between = |v: &usize| (from..to).contains(&rooms.position(*v).x);
            let between = (0..rooms.vertex_count()).filter(is_between);
            largest(between.map(|v| light[v])) / mean
        };
        let what = format!(
            "light below a wall, edges {edge} m, share of the lit room's mean, {:.4} within \
             an edge, {:.4} at the far end, beyond an edge",
            brightest(0.005, edge),
            brightest(1.9, 3.0)
        );
        at_most(&what, brightest(edge, 3.0), BEHIND_WALL);
    }
}

/// A cube of 2 m whose wall at low z has so many cells along an edge.
fn room_with_fine_wall(max_edge: f64, rays: u32, cells: u32) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.box_sides(
        [DVec3::NEG_ONE, DVec3::ONE],
        Facing::Inward,
        &BOX_SIDES[..4],
        0,
    );
    mesh.box_sides(
        [DVec3::NEG_ONE, DVec3::ONE],
        Facing::Inward,
        &BOX_SIDES[5..],
        0,
    );
    let at = |k: u32| f64::from(k) / f64::from(cells) * 2.0 - 1.0;
    for (i, j) in (0..cells * cells).map(|k| (k % cells, k / cells)) {
        let corners = [
            DVec3::new(at(i), at(j), -1.0),
            DVec3::new(at(i + 1), at(j + 1), 1.0),
        ];
        mesh.box_sides(corners, Facing::Inward, &BOX_SIDES[4..5], 0);
    }
    mesh.scene(&[0.5], max_edge, rays)
}

/// The vertex of a list that is nearest to a place.
fn nearest(room: &Baked, list: &[usize], place: DVec3) -> usize {
    let distance = |v: &usize| room.position(*v).distance_squared(place);
    let found = list
        .iter()
        .copied()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    found.expect("the list has vertices")
}

/// The shortest edge on the wall at low z, file units.
fn shortest_edge(room: &Baked) -> f64 {
    let edges = (0..room.surface.mesh.triangles.len() as u32).flat_map(|triangle| {
        let corners = room.surface.vertices.of_triangle(triangle, true);
        (0..3).map(move |k| [corners[k], corners[(k + 1) % 3]].map(|v| v as usize))
    });
    let on_wall = edges.filter(|edge| edge.iter().all(|&v| room.normal(v).z > 0.9));
    on_wall
        .map(|[a, b]| room.position(a).distance(room.position(b)))
        .fold(f64::INFINITY, f64::at_most)
}

#[test]
fn a_wall_ten_times_finer_changes_nothing() {
    // As many functions as the coarse mesh can bear: by a share of its few vertices it
    // has so few that it is off itself, which is no fault of fineness.
    let baked = |mut room: Scene| {
        room.bake.functions = Some(FUNCTIONS);
        room.bake.coefficients = Some(COEFFICIENTS);
        Baked::new(&room)
    };
    // Walls are cut until no edge is longer, so what they are cut into is asked.
    let (edge, rays) = (0.4, 512);
    let coarse = baked(cube_room(2.0, edge, rays));
    let cells = (2.0 * FINER / shortest_edge(&coarse)).round() as u32;
    let fine = baked(room_with_fine_wall(edge, rays, cells));
    let finer = shortest_edge(&coarse) / shortest_edge(&fine);
    at_least("how many times finer one wall is", finer, 0.999 * FINER);
    let place_of_light = DVec3::new(0.2, 0.1, 0.3);
    let lights = [point_light(place_of_light, 1.0)];
    let [of_coarse, of_fine] =
        [&coarse, &fine].map(|room| room.indirect(&lights, 0.7, Bounces::Count(4)));
    for normal in [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
        Vec3::Z,
    ] {
        let on_wall = |room: &Baked| -> Vec<usize> {
            let is_on = |v: &usize| room.normal(*v).dot(normal) > 0.9;
            room.fronts().filter(is_on).collect()
        };
        let there = on_wall(&fine);
        // A coarse vertex has the mean of its area; so has what it is compared
        // with, by the fine vertices in it.
        let at_fine = |v: usize| {
            let at = |place, _| f64::from(of_fine[nearest(&fine, &there, place)].x);
            if normal == Vec3::Z {
                coarse.area_mean(v, at)
            } else {
                at(coarse.position(v), DVec3::ZERO)
            }
        };
        // Frames have the direct light of each point, whatever the mesh.
        let direct = |v: usize| {
            let to_light = place_of_light - coarse.position(v);
            let squared = to_light.length_squared();
            to_light.dot(normal.as_dvec3()) / squared.sqrt() / squared
        };
        let deviation = |share_of_direct: f64| {
            Deviation::of(on_wall(&coarse).into_iter().map(|v| {
                let beside = share_of_direct * direct(v);
                let e = f64::from(of_coarse[v].x);
                (coarse.area(v), at_fine(v) + beside, e + beside)
            }))
        };
        let limits = [
            ("all light", 1.0, UNEVEN),
            ("indirect", 0.0, UNEVEN_INDIRECT),
        ];
        for (name, share_of_direct, most) in limits {
            let found = deviation(share_of_direct);
            let what = format!(
                "one wall ten times finer, {name}, wall {normal}, mean {:+.4}",
                found.mean
            );
            at_most(&format!("{what}, rms"), found.rms, UNEVEN);
            at_most(&format!("{what}, worst"), found.worst, most);
        }
    }
    // The furnace and its twin: no ray is lost along the seams, where the fine
    // wall's corners lie inside its neighbours' edges, and rows tell walls apart.
    let ones = fine.apply(&vec![Vec3::ONE; fine.vertex_count()]);
    let lost = |v: usize| (f64::from(ones[v].x) - 1.0).abs();
    let mean = fine.fronts().map(lost).sum::<f64>() / fine.fronts().len() as f64;
    let what = format!(
        "one wall ten times finer, furnace, worst {:.1e}, mean",
        largest(fine.fronts().map(lost))
    );
    at_most(&what, mean, LEAK);
    let emits = |v: usize| fine.normal(v).x > 0.9 && v < fine.fronts().end;
    let source: Vec<Vec3> = (0..fine.vertex_count())
        .map(|v| Vec3::splat(f32::from(u8::from(emits(v)))))
        .collect();
    let irradiance = fine.apply(&source);
    for (name, normal) in [
        ("opposite", Vec3::NEG_X),
        ("adjacent", Vec3::Y),
        ("adjacent fine", Vec3::Z),
    ] {
        let on_face = fine.fronts().filter(|&v| fine.normal(v).dot(normal) > 0.9);
        let found = Deviation::of(on_face.map(|v| {
            let at = |point, normal| form_factor_of_face(point, normal, 1.0);
            (
                fine.area(v),
                f64::from(irradiance[v].x),
                fine.area_mean(v, at),
            )
        }));
        let what = format!(
            "one wall ten times finer, one face emits, {name}, worst {:.4}, rms {:.4}, mean",
            found.worst, found.rms
        );
        at_most(&what, found.mean.abs(), UNEVEN);
    }
}

/// A closed box, turned so that no coordinate is a round number, whose wall at
/// low x consists of strips that meet no other corner and are `gap` apart.
fn cracked_box(gap: f64) -> Scene {
    let turned = DMat3::from_rotation_y(0.61) * DMat3::from_rotation_x(0.37);
    let mut mesh = SampleMesh::default();
    let [lower, upper] = [DVec3::new(-1.0, -0.7, -0.9), DVec3::new(1.1, 0.8, 1.0)];
    mesh.box_sides([lower, upper], Facing::Inward, &BOX_SIDES[1..], 0);
    let cuts = [lower.y, -0.237, 0.411, upper.y];
    for strip in 0..3 {
        let low = cuts[strip] + if strip == 0 { 0.0 } else { gap };
        let corners = [
            DVec3::new(lower.x, low, lower.z),
            DVec3::new(upper.x, cuts[strip + 1], upper.z),
        ];
        mesh.box_sides(corners, Facing::Inward, &BOX_SIDES[..1], 0);
    }
    let mut scene = mesh.scene(&[0.5], 0.2, 256);
    for position in &mut scene.mesh.positions {
        *position = turned * *position;
    }
    scene
}

#[test]
fn cracks_let_next_to_no_ray_out() {
    // T-junctions whose edges meet but for rounding, and cracks of 1e-5 m, of
    // which two take 2e-6 of the surface.
    for gap in [0.0, 1e-5] {
        let room = Baked::new(&cracked_box(gap));
        let arrived = room.apply(&vec![Vec3::ONE; room.vertex_count()]);
        let lost: f64 = room
            .fronts()
            .map(|v| room.area(v) * (1.0 - f64::from(arrived[v].x)))
            .sum();
        let area: f64 = room.fronts().map(|v| room.area(v)).sum();
        let what = format!("rays that leave a turned box with cracks of {gap} m");
        at_most(&what, lost / area, LEAK);
    }
}
