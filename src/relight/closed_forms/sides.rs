//! What light cannot reach is exactly dark, and backs exist only where light
//! or an eye gets.

use glam::{DVec3, Vec3};

use super::Baked;
use crate::bake::RunSettings;
use crate::relight::{Component, FrameSettings, Renderer};
use crate::scene::sample_scenes::{BOX_SIDES, BoxSide, Facing, SampleMesh, point_light};
use crate::scene::{Bounces, LightKind, Scene};

/// Edges of the tessellation.
const EDGE: f64 = 0.125;
/// Light that the contact of an open box with the floor may let in beyond one edge
/// length, share of the room's mean. The floor is cut along the contact, so that no
/// vertex has area on both sides of it.
const CONTACT_LEAK: f64 = 1e-3;

/// Two parallel sheets around y = 0, fronts towards each other.
pub(super) fn two_sheets() -> Scene {
    let mut mesh = SampleMesh::default();
    let (lower, upper) = (DVec3::new(-1.0, -0.5, -1.0), DVec3::new(1.0, 0.5, 1.0));
    mesh.box_sides([lower, upper], Facing::Inward, &[(1, false), (1, true)], 0);
    mesh.scene(&[0.8], EDGE, 256)
}

pub(super) fn one_sheet() -> Scene {
    let mut mesh = SampleMesh::default();
    let (lower, upper) = (DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 1.0, 1.0));
    mesh.box_sides([lower, upper], Facing::Inward, &[(1, false)], 0);
    mesh.scene(&[0.8], EDGE, 256)
}

#[test]
fn the_dark_side_of_a_sheet_is_black() {
    let lights = [point_light(DVec3::new(0.2, 0.3, 0.1), 1.0)];
    for (name, scene) in [("one sheet", one_sheet()), ("two sheets", two_sheets())] {
        let sheets = Baked::new(&scene);
        let fronts = sheets.fronts().end;
        assert_eq!(
            sheets.vertex_count(),
            2 * fronts,
            "{name}: both sides can be seen"
        );
        let direct = sheets.direct(&lights);
        let indirect = sheets.indirect(&lights, 0.8, Bounces::Count(4));
        let lit = |v: &usize| direct[*v] != Vec3::ZERO || indirect[*v] != Vec3::ZERO;
        assert_eq!(
            sheets.fronts().filter(lit).count(),
            fronts,
            "{name}: the inner sides are lit"
        );
        let leaks = (fronts..sheets.vertex_count()).filter(lit).count();
        assert_eq!(
            leaks, 0,
            "{name}: {leaks} vertices of {fronts} are lit from behind"
        );
        for (eye, dark) in [(-3.0, true), (0.45, false)] {
            let mut lit_scene = scene.clone();
            lit_scene.lights = lights.to_vec();
            lit_scene.camera.position = DVec3::new(0.0, eye, 0.01);
            lit_scene.camera.target = DVec3::new(0.0, -0.5, 0.0);
            lit_scene.camera.vfov_deg = 30.0;
            let settings = FrameSettings::of_scene(&lit_scene);
            let frame = Renderer::new(lit_scene, None).frame(&settings, &RunSettings::silent());
            let pixels = frame.unwrap().image;
            let shown = pixels.pixels().iter().filter(|&&p| p != Vec3::ZERO).count();
            let wanted = if dark { 0 } else { 64 * 64 };
            assert_eq!(
                shown, wanted,
                "{name}: pixels that are not black, eye at y = {eye}"
            );
        }
    }
}

#[test]
fn each_side_of_a_sheet_has_its_own_light() {
    // A sheet between two others that face it, red light above it, green below.
    let mut mesh = SampleMesh::default();
    for (bottom, side) in [(-0.5, false), (0.0, false), (-0.5, true)] {
        let corners = [DVec3::new(-1.0, bottom, -1.0), DVec3::new(1.0, 0.5, 1.0)];
        mesh.box_sides(corners, Facing::Inward, &[(1, side)], 0);
    }
    let sheets = Baked::new(&mesh.scene(&[0.8], EDGE, 256));
    let mut lights = [0.25, -0.25].map(|y| point_light(DVec3::new(0.2, y, 0.1), 1.0));
    for (light, colour) in lights.iter_mut().zip([Vec3::X, Vec3::Y]) {
        let LightKind::Point(point) = &mut light.kind else {
            panic!("both are point lights")
        };
        point.intensity = colour;
    }
    let direct = sheets.direct(&lights);
    let indirect = sheets.indirect(&lights, 0.8, Bounces::Count(4));
    let on_middle = |&v: &usize| sheets.position(v).y.abs() < 0.1;
    for (name, upward, own, other) in [
        ("upper", 1.0, Vec3::X, Vec3::Y),
        ("lower", -1.0, Vec3::Y, Vec3::X),
    ] {
        let side: Vec<usize> = (0..sheets.vertex_count())
            .filter(on_middle)
            .filter(|&v| sheets.normal(v).y * upward > 0.9)
            .collect();
        assert!(side.len() > 100, "{} vertices", side.len());
        for (what, light) in [("direct", &direct), ("indirect", &indirect)] {
            let has = |colour: Vec3| {
                side.iter()
                    .filter(|&&v| light[v].dot(colour) != 0.0)
                    .count()
            };
            assert_eq!(
                has(own),
                side.len(),
                "{name}, {what}: vertices with their light"
            );
            assert_eq!(
                has(other),
                0,
                "{name}, {what}: vertices with the other side's light"
            );
        }
    }
}

/// A room of 2 m with a box in it: resting on the floor or not, with the sides
/// that it has.
fn room_with_box(bottom: f64, sides: &[BoxSide]) -> Scene {
    let mut mesh = SampleMesh::default();
    mesh.box_sides(
        [DVec3::splat(-1.0), DVec3::ONE],
        Facing::Inward,
        &BOX_SIDES,
        0,
    );
    let corners = [
        DVec3::new(-0.5, bottom, -0.5),
        DVec3::new(0.5, bottom + 0.75, 0.5),
    ];
    mesh.box_sides(corners, Facing::Outward, sides, 1);
    mesh.scene(&[0.7, 0.7], EDGE, 256)
}

/// All sides but the bottom.
const WITHOUT_BOTTOM: [BoxSide; 5] = [(0, false), (0, true), (1, true), (2, false), (2, true)];

/// Back vertices of the box's material.
fn backs_of_box(room: &Baked) -> Vec<usize> {
    let is_box = |&v: &usize| room.surface.vertices.materials()[v] == 1;
    (room.fronts().end..room.vertex_count())
        .filter(is_box)
        .collect()
}

#[test]
fn only_open_bodies_have_backs() {
    let hovering = Baked::new(&room_with_box(-0.8, &BOX_SIDES));
    assert_eq!(backs_of_box(&hovering).len(), 0, "backs in a closed box");
    let open = Baked::new(&room_with_box(-0.8, &WITHOUT_BOTTOM));
    let fronts = open
        .fronts()
        .filter(|&v| open.surface.vertices.materials()[v] == 1)
        .count();
    assert_eq!(
        backs_of_box(&open).len(),
        fronts,
        "an open box shows all its backs"
    );
}

#[test]
fn a_closed_box_on_the_floor_has_no_backs() {
    let standing = Baked::new(&room_with_box(-1.0, &BOX_SIDES));
    assert_eq!(
        backs_of_box(&standing).len(),
        0,
        "backs in a closed box that stands on the floor"
    );
}

#[test]
fn nothing_is_lit_inside_a_box_on_the_floor() {
    let lights = [point_light(DVec3::new(0.3, 0.6, 0.2), 1.0)];
    for (name, sides) in [
        ("closed", &BOX_SIDES[..]),
        ("without a bottom", &WITHOUT_BOTTOM),
    ] {
        let room = Baked::new(&room_with_box(-1.0, sides));
        let direct = room.direct(&lights);
        let indirect = room.indirect(&lights, 0.7, Bounces::Count(4));
        // Of what is within one edge of the contact nothing is asked here.
        let is_inside =
            |p: DVec3| p.x.abs() < 0.5 - EDGE && p.z.abs() < 0.5 - EDGE && p.y < -0.25 - EDGE;
        let inside: Vec<usize> = (0..room.vertex_count())
            .filter(|&v| is_inside(room.position(v)))
            .collect();
        assert!(
            inside.len() >= 25,
            "{name}: {} vertices inside",
            inside.len()
        );
        let lit: Vec<usize> = inside
            .iter()
            .copied()
            .filter(|&v| direct[v] != Vec3::ZERO)
            .collect();
        assert_eq!(lit.len(), 0, "{name}: vertices inside with direct light");
        let mean = room.fronts().map(|v| f64::from(indirect[v].x)).sum::<f64>()
            / room.fronts().len() as f64;
        let floor = inside
            .iter()
            .copied()
            .filter(|&v| room.normal(v).y > 0.9 && v < room.fronts().end);
        let brightest = super::largest(floor.map(|v| f64::from(indirect[v].x.abs())));
        super::at_most(
            &format!("indirect light under a box, {name}, share of the room's mean"),
            brightest / mean,
            0.0,
        );
    }
}

#[test]
fn backs_of_a_standing_box_are_dark() {
    let lights = [point_light(DVec3::new(0.3, 0.6, 0.2), 1.0)];
    let room = Baked::new(&room_with_box(-1.0, &WITHOUT_BOTTOM));
    let indirect = room.indirect(&lights, 0.7, Bounces::Count(4));
    let mean =
        room.fronts().map(|v| f64::from(indirect[v].x)).sum::<f64>() / room.fronts().len() as f64;
    let high = backs_of_box(&room)
        .into_iter()
        .filter(|&v| room.position(v).y > -1.0 + 0.999 * EDGE);
    let high: Vec<usize> = high.collect();
    assert!(high.len() > 100, "{} inner vertices", high.len());
    let light_of = |v: &usize| f64::from(indirect[*v].abs().max_element());
    let brightest = super::largest(high.iter().map(light_of));
    super::at_most(
        "light on the inner walls of a standing box, share of the room's mean",
        brightest / mean,
        CONTACT_LEAK,
    );
}

#[test]
fn components_agree_that_the_dark_is_dark() {
    let mut scene = two_sheets();
    scene.lights = vec![point_light(DVec3::new(0.2, 0.3, 0.1), 1.0)];
    scene.camera.position = DVec3::new(0.0, 3.0, 0.01);
    scene.camera.target = DVec3::ZERO;
    scene.camera.vfov_deg = 30.0;
    let mut settings = FrameSettings::of_scene(&scene);
    let mut renderer = Renderer::new(scene, None);
    for component in [
        Component::Direct,
        Component::Indirect,
        Component::Irradiance,
    ] {
        settings.component = component;
        let frame = renderer.frame(&settings, &RunSettings::silent()).unwrap();
        let lit = frame
            .image
            .pixels()
            .iter()
            .filter(|&&p| p != Vec3::ZERO)
            .count();
        assert_eq!(lit, 0, "{component:?}: pixels of a dark side that are lit");
    }
}

/// Most difference between a room and its twin with all faces turned over:
/// sampling noise of their sums. 0.12 % is measured.
const TWIN_DIFFERENCE: f64 = 4e-3;

/// A box room that is open below, its fronts inward or outward.
fn open_room(facing: Facing) -> Scene {
    let mut mesh = SampleMesh::default();
    let corners = [DVec3::splat(-1.0), DVec3::ONE];
    mesh.box_sides(corners, facing, &WITHOUT_BOTTOM, 0);
    mesh.scene(&[0.7], EDGE, 256)
}

#[test]
fn a_room_inside_out_is_as_bright_as_its_twin() {
    let lights = [point_light(DVec3::new(0.3, 0.5, 0.2), 1.0)];
    let [inward, outward] = [Facing::Inward, Facing::Outward].map(|facing| {
        let room = Baked::new(&open_room(facing));
        let indirect = room.indirect(&lights, 0.7, Bounces::Count(4));
        indirect.iter().map(|e| f64::from(e.x)).sum::<f64>()
    });
    assert!(inward > 0.0, "the room is lit");
    super::at_most(
        "difference of a room from its twin inside out",
        (outward / inward - 1.0).abs(),
        TWIN_DIFFERENCE,
    );
}
