//! What is shown of the basis: direct light after projection on it, its
//! partitions and its functions.

use glam::{DVec3, Vec3};

use super::{Baked, at_least, at_most, frames_of};
use crate::bake::RunSettings;
use crate::maths::order::Order;
use crate::relight::basis_view::{BasisFunctionError, BasisView};
use crate::relight::{BasisFunction, Component, FrameSettings, RenderError, Renderer, develop};
use crate::scene::sample_scenes::{
    Facing, SampleMesh, cube_room, directional_light, point_light, room_with_blocks,
};
use crate::scene::{Scene, Tone};

/// Largest difference of a field that single-precision sums over a thousand
/// functions leave, relative to its largest value.
const ROUNDING: f64 = 1e-5;
/// A projection that leaves out functions must not be all of the field: the
/// room's basis loses several per cent.
const LOST: f64 = 0.01;
/// How high a wall rises that ends above a roof at 2 m: less than an edge.
const RIM_TOP: f64 = 2.08;
/// Light that the basis carries over the top of a wall, as root mean squares: 0.07 is
/// measured, and 0.29 where such neighbours are joined (`places`).
const INSIDE: f64 = 0.1;
/// Difference of linear colours that is seen at once.
const SEEN: f32 = 0.02;

/// A room under a lamp, with so many functions in all; `None`: the default.
fn lit_room(functions: Option<u32>) -> Scene {
    let mut scene = room_with_blocks(false, 0.2, 16);
    scene.bake.functions = functions;
    scene.lights = vec![point_light(DVec3::new(0.3, 0.7, 0.5), 2.0)];
    scene
}

fn largest_difference(a: &[Vec3], b: &[Vec3]) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = Vec3>| {
        f64::from(values.fold(0.0, |most, v| f32::at_least(most, v.abs().max_element())))
    };
    let differences = &mut a.iter().zip(b).map(|(a, b)| *a - *b);
    largest(differences) / largest(&mut b.iter().copied())
}

#[test]
fn as_many_functions_as_vertices_lose_nothing() {
    let scene = lit_room(Some(u32::MAX));
    let room = Baked::new(&scene);
    let basis = room.bake.basis();
    assert_eq!(basis.function_count(), room.vertex_count(), "a full basis");
    let direct = room.direct(&scene.lights);
    let off = largest_difference(&room.transport().projected(&direct), &direct);
    at_most("full basis, approximated direct light", off, ROUNDING);
}

#[test]
fn projecting_twice_is_projecting_once() {
    let scene = lit_room(None);
    let room = Baked::new(&scene);
    let direct = room.direct(&scene.lights);
    let once = room.transport().projected(&direct);
    let twice = room.transport().projected(&once);
    at_most(
        "projected twice",
        largest_difference(&twice, &once),
        ROUNDING,
    );
    let lost = largest_difference(&once, &direct);
    assert!(lost > LOST, "32 functions for 1,000 vertices lose {lost}");
}

/// A constant is in every partition's basis: even light on a floor keeps its
/// radiance rho E / pi in the picture.
#[test]
fn even_light_on_a_floor_is_approximated_by_itself() {
    let mut mesh = SampleMesh::default();
    let floor = [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, 1.0)];
    mesh.box_sides(floor, Facing::Outward, &[(1, true)], 0);
    let mut scene = mesh.scene(&[0.6], 0.05, 16);
    scene.lights = vec![directional_light(Vec3::NEG_Y, 3.0)];
    scene.camera.position = DVec3::new(0.0, 2.0, 0.5);
    scene.camera.vfov_deg = 30.0;
    let [shown, direct] = frames_of(&scene, [Component::ApproximatedDirect, Component::Direct]);
    let radiance = 0.6 * 3.0 * std::f32::consts::FRAC_1_PI;
    for (a, d) in shown.pixels().iter().zip(direct.pixels()) {
        let off = (*a - *d)
            .abs()
            .max_element()
            .at_least((a.x - radiance).abs());
        assert!(f64::from(off) <= ROUNDING, "{a} and {d} are not {radiance}");
    }
}

#[test]
fn approximated_light_is_not_negative_and_has_no_bounces() {
    let scene = lit_room(None);
    let mut renderer = Renderer::new(scene.clone(), None);
    let settings = FrameSettings {
        component: Component::ApproximatedDirect,
        bounces: crate::scene::Bounces::Count(0),
        ..FrameSettings::of_scene(&scene)
    };
    assert!(renderer.needs_bake(&settings), "the basis is in the bake");
    let frame = renderer.frame(&settings, &RunSettings::silent()).unwrap();
    let pixels = frame.image.pixels();
    assert!(frame.clamped_pixels > 0, "shadows ring below zero");
    assert!(pixels.iter().all(|p| p.min_element() >= 0.0), "clamped");
    let mean = pixels.iter().map(|p| p.x).sum::<f32>() / pixels.len() as f32;
    assert!(mean > 0.05, "the room is lit: {mean}");
    let exposed = frame.develop(1.0, Tone::Srgb);
    assert_ne!(exposed, frame.develop(0.0, Tone::Srgb), "it is light");
}

#[test]
fn neighbouring_partitions_differ_in_colour() {
    // Of some 1,200 vertices a wall, so that walls are divided.
    let room = Baked::new(&cube_room(2.0, 0.06, 16));
    let basis = room.bake.basis();
    let view = BasisView::of(basis, Component::Partitions).unwrap();
    let Some(BasisView::Partitions(colours)) = view else {
        panic!("{view:?} shows no partitions");
    };
    let part = |v: u32| basis.row(basis.slot_of_vertex()[v as usize]).0;
    let mut borders = 0;
    for triangle in 0..room.surface.mesh.triangles.len() as u32 {
        let corners = room.surface.vertices.of_triangle(triangle, true);
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
            let off = (colours[a as usize] - colours[b as usize]).abs();
            let differ = off.max_element() > SEEN;
            assert_eq!(differ, part(a) != part(b), "vertices {a} and {b}: {off}");
            borders += usize::from(differ);
        }
    }
    assert!(borders > 100, "{borders} edges cross borders");
}

#[test]
fn a_picture_of_partitions_is_flat_and_knows_no_exposure() {
    let mut scene = lit_room(None);
    scene.camera.size = [64, 48];
    let [image] = frames_of(&scene, [Component::Partitions]);
    let pixels = image.pixels();
    let mut known: Vec<Vec3> = Vec::new();
    let mut flat = 0;
    for pair in pixels.windows(2).filter(|pair| pair[0] == pair[1]) {
        flat += 1;
        if !known.contains(&pair[0]) {
            known.push(pair[0]);
        }
    }
    assert!(
        flat > pixels.len() / 2 && (3..100).contains(&known.len()),
        "{flat} pixels like their neighbours in {} colours",
        known.len()
    );
    for component in [
        Component::Partitions,
        Component::Basis(BasisFunction::InAll(0)),
    ] {
        let developed = |exposure, tone| develop(&image, component, exposure, tone);
        let plain = developed(0.0, Tone::Srgb);
        assert_eq!(developed(2.0, Tone::Filmic), plain, "{component:?}");
    }
}

#[test]
fn a_function_has_one_partition_and_reaches_one() {
    let room = Baked::new(&lit_room(None));
    let basis = room.bake.basis();
    let values = |asked: BasisFunction| {
        let view = BasisView::of(basis, Component::Basis(asked));
        match view.expect("there is such a function") {
            Some(BasisView::Function(values)) => values,
            other => panic!("{other:?} is no function"),
        }
    };
    for partition in 0..basis.part_count() as u32 {
        let numbers = basis.function_range(partition);
        for number in [numbers.start, numbers.end - 1] {
            let function = (number - numbers.start) as u32;
            let of_partition = values(BasisFunction::InPartition {
                partition,
                function,
            });
            assert_eq!(of_partition, values(BasisFunction::InAll(number as u32)));
            let inside: Vec<f32> = of_partition.iter().copied().flatten().collect();
            assert_eq!(inside.len(), basis.slot_range(partition).len());
            let largest = inside
                .iter()
                .fold(0.0, |most, v| f32::at_least(most, v.abs()));
            assert_eq!(largest, 1.0, "function {number}");
            // The lowest frequency is a constant, all others have both signs.
            let is_constant = inside.iter().all(|v| (v - inside[0]).abs() < 1e-4);
            assert_eq!(is_constant, function == 0, "function {number}");
            let signs = [f32::lt as fn(&f32, &f32) -> bool, f32::gt]
                .map(|sign| inside.iter().any(|v| sign(v, &0.0)));
            assert_eq!(signs == [true; 2], function != 0, "function {number}");
        }
    }
}

#[test]
fn colours_of_a_function_are_red_white_blue_and_grey() {
    let view = BasisView::Function(vec![Some(1.0), Some(0.0), Some(-1.0), None]);
    let at = |vertex: u32| view.colour([vertex; 3], [0.2, 0.5, 0.3], 1.0);
    assert_eq!(at(0), Vec3::X);
    assert_eq!(at(1), Vec3::ONE);
    assert_eq!(at(2), Vec3::Z);
    let grey = at(3);
    assert!(
        grey.x > 0.1 && grey == Vec3::splat(grey.x),
        "{grey} is grey"
    );
    // Outside of the partition a point takes nothing of it, and inside nothing
    // of what is outside.
    let across = |weight| view.colour([0, 3, 3], [weight, 1.0 - weight, 0.0], 1.0);
    assert_eq!([across(0.4), across(0.6)], [grey, Vec3::X]);
    let halfway = view.colour([0, 1, 3], [0.4, 0.4, 0.2], 1.0);
    let half = crate::maths::functions::linear_from_srgb(0.5) as f32;
    assert!(
        (halfway - Vec3::new(1.0, half, half)).length() < 1e-6,
        "{halfway}"
    );
}

#[test]
fn functions_that_do_not_exist_are_named_with_how_many_do() {
    let scene = lit_room(None);
    let mut renderer = Renderer::new(scene.clone(), None);
    renderer.bake(&RunSettings::silent()).unwrap();
    let figures = renderer.figures().bake.expect("it was baked");
    let mut ask = |function| {
        let settings = FrameSettings {
            component: Component::Basis(function),
            ..FrameSettings::of_scene(&scene)
        };
        match renderer.frame(&settings, &RunSettings::silent()) {
            Ok(_) => None,
            Err(RenderError::Basis(error)) => Some(error),
            Err(error) => panic!("another error: {error}"),
        }
    };
    let last = figures.functions as u32 - 1;
    assert_eq!(ask(BasisFunction::InAll(last)), None, "the last function");
    let asked = BasisFunction::InAll(last + 1);
    let error = ask(asked).expect("one more is too many");
    let (functions, partitions) = (figures.functions, figures.partitions);
    let wanted = BasisFunctionError::Function {
        asked,
        functions,
        partitions,
    };
    assert_eq!(error, wanted);
    let text = error.to_string();
    for word in [
        format!("basis:{}", last + 1),
        format!("{functions} functions"),
        format!("{partitions} partitions"),
        format!("0 to {last}"),
    ] {
        assert!(text.contains(&word), "{word:?} is not in {text:?}");
    }
    let of = |partition, function| BasisFunction::InPartition {
        partition,
        function,
    };
    assert_eq!(ask(of(partitions as u32 - 1, 0)), None);
    let no_partition = ask(of(partitions as u32, 0)).expect("one too many");
    assert!(matches!(no_partition, BasisFunctionError::Partition { .. }));
    let no_function = ask(of(0, 1_000_000)).expect("no partition has as many");
    let is_named = matches!(
        no_function,
        BasisFunctionError::FunctionOfPartition { partition: 0, .. }
    );
    assert!(is_named, "{no_function}");
}

/// A room whose one wall stands a little away from the others and rises above the
/// roof, by less than an edge: its last vertices belong to the outside, the next ones
/// to the room.
fn room_below_a_rim() -> Scene {
    let mut mesh = SampleMesh::default();
    let room = [DVec3::new(0.02, 0.0, -1.0), DVec3::new(2.0, 2.0, 1.0)];
    let others = [(0, true), (1, false), (1, true), (2, false), (2, true)];
    mesh.box_sides(room, Facing::Inward, &others, 0);
    let wall = [DVec3::new(0.0, -0.1, -1.1), DVec3::new(2.0, RIM_TOP, 1.1)];
    mesh.box_sides(wall, Facing::Inward, &[(0, false)], 0);
    let mut scene = mesh.scene(&[0.8], 0.125, 256);
    // Onto the roof and the wall above it.
    scene.lights = vec![directional_light(Vec3::new(-0.6, -0.8, 0.0), 1.0)];
    scene
}

#[test]
fn light_on_a_wall_above_the_roof_stays_outside() {
    let room = Baked::new(&room_below_a_rim());
    let direct = room.direct(&room_below_a_rim().lights);
    let projected = room.transport().projected(&direct);
    // On the wall: what is outside and lit, and what is in the room, away from cracks.
    let (mut lit, mut carried) = (0.0, 0.0);
    for (v, light) in projected.iter().enumerate() {
        let place = room.position(v);
        if place.x > 0.01 || room.normal(v).x < 0.9 || place.z.abs() > 0.8 {
            continue;
        }
        let lit_by = f64::from(direct[v].x);
        lit += room.area(v) * lit_by * lit_by;
        if (0.2..1.9).contains(&place.y) {
            assert_eq!(direct[v], Vec3::ZERO, "the light shines into the room");
            let light = f64::from(light.x);
            carried += room.area(v) * light * light;
        }
    }
    at_least("light on a wall above the roof, squared", lit, 1e-3);
    at_most(
        "light above the roof, share of its size that the basis has in the room",
        (carried / lit).sqrt(),
        INSIDE,
    );
}
