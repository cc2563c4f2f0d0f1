//! Rectangles, spots and parallel light: on planes, where every point's
//! irradiance is known.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::{Deviation, at_most, frame_of, seen_on_plane, update};
use crate::frame::Image;
use crate::maths::functions::acos;
use crate::maths::sobol::ScrambledSobol;
use crate::relight::Component;
use crate::relight::kept::KeptDirect;
use crate::scene::sample_scenes::{
    Facing, SampleMesh, directional_light, lamp_facing_down, spot_facing_down,
};
use crate::scene::{Bounces, Light, PlacedLights, Scene};
use crate::surface::{Detail, Surface};

/// What a closed form may be missed by, root mean square over pixels and mean over
/// vertices: 0.07 % is measured under a spot, whose rim has 16 samples a pixel, 0.02 % by
/// a rectangle, and rounding where nothing is sampled.
const CLOSED_FORM: f64 = 2e-3;
/// The worst pixel over the root mean square of all: of pixels with a cone's
/// rim, 16 samples over a kink of brightness.
const WORST_PIXEL: f64 = 0.02;
/// One point of a vertex's area stands for it where neighbours differ by less
/// than 10 %: half of that is the most, a fifth of it is usual.
const ONE_POINT: f64 = 0.02;
/// Points of a vertex's area in the mean that a vertex should have.
const MANY_POINTS: u32 = 256;

/// A floor of 4 m, seen from above its edge.
fn floor(lights: Vec<Light>) -> Scene {
    let mut mesh = SampleMesh::default();
    let corners = [DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 1.0, 2.0)];
    mesh.box_sides(corners, Facing::Inward, &[(1, false)], 0);
    let mut scene = mesh.scene(&[0.5], 0.125, 64);
    scene.camera.position = DVec3::new(0.2, 0.7, 1.9);
    scene.camera.target = DVec3::ZERO;
    scene.camera.vfov_deg = 60.0;
    scene.render.bounces = Bounces::Count(0);
    scene.lights = lights;
    scene
}

/// The angle of a tangent.
fn atan(tangent: f64) -> f64 {
    acos(1.0 / (1.0 + tangent * tangent).sqrt()).copysign(tangent)
}

/// An integral over a rectangle by its antiderivative, which is 0 on the axes.
fn over_rectangle([x0, x1]: [f64; 2], [z0, z1]: [f64; 2], of: impl Fn(f64, f64) -> f64) -> f64 {
    of(x1, z1) - of(x0, z1) - of(x1, z0) + of(x0, z0)
}

/// Form factor from a point to a rectangle in a plane parallel to its own at
/// unit distance, with corners at the foot of the normal and at (a, b).
pub(super) fn parallel_corner(a: f64, b: f64) -> f64 {
    let (of_a, of_b) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / of_a * atan(b / of_a) + b / of_b * atan(a / of_b)) / (2.0 * PI)
}

/// Form factor from a point to a rectangle in a plane perpendicular to its own,
/// at unit distance, with a corner straight above the point and the other a
/// before it and b beside it.
pub(super) fn perpendicular_corner(a: f64, b: f64) -> f64 {
    let slant = (1.0 + a * a).sqrt();
    (atan(b) - atan(b / slant) / slant) / (2.0 * PI)
}

/// How an irradiance picture of a plane differs from what `wanted` says of its
/// points, at pixels whose centres lie on the plane's part of a `reach`.
fn deviation(
    scene: &Scene,
    image: &Image,
    (axis, value): (usize, f64),
    shows: impl Fn(DVec3) -> bool,
    wanted: impl Fn([f64; 2]) -> f64,
) -> Deviation {
    let mut values = Vec::new();
    for (x, y) in (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y))) {
        let at = [f64::from(x), f64::from(y)];
        let is_inside = (0..4).all(|k| {
            let corner = [at[0] + f64::from(k % 2), at[1] + f64::from(k / 2)];
            shows(seen_on_plane(scene, corner, axis, value))
        });
        if is_inside {
            let pixel = image.pixel(x, y).unwrap();
            values.push((1.0, f64::from(pixel.x), wanted(at)));
        }
    }
    assert!(values.len() > 500, "{} pixels show it", values.len());
    Deviation::of(values.into_iter())
}

/// Whether a point lies on the floor, away from its border.
fn on_floor(point: DVec3) -> bool {
    point.x.abs() < 1.95 && point.z.abs() < 1.95
}

fn check(what: &str, found: &Deviation) {
    at_most(
        &format!("{what}, mean {:+.2e}, rms", found.mean),
        found.rms,
        CLOSED_FORM,
    );
    at_most(&format!("{what}, worst pixel"), found.worst, WORST_PIXEL);
}

/// The lamp over the floor: its lowest and highest corner.
const LAMP: [DVec3; 2] = [DVec3::new(-0.5, 1.0, -0.3), DVec3::new(0.7, 1.0, 0.4)];

/// Irradiance on the floor under the lamp of radiance 1.
fn under_lamp(point: DVec3) -> f64 {
    let along = |axis: usize| LAMP.map(|corner| corner[axis] - point[axis]);
    PI * over_rectangle(along(0), along(2), parallel_corner)
}

#[test]
fn a_rectangle_lights_each_pixel_of_a_floor() {
    let scene = floor(vec![lamp_facing_down(LAMP[0], LAMP[1], 1.0)]);
    let image = frame_of(&scene, Component::Irradiance);
    let found = deviation(&scene, &image, (1, 0.0), on_floor, |[x, y]| {
        under_lamp(seen_on_plane(&scene, [x + 0.5, y + 0.5], 1, 0.0))
    });
    check("rectangle over a floor, pixels", &found);
}

#[test]
fn a_rectangle_lights_the_vertices_of_a_floor() {
    let scene = floor(vec![lamp_facing_down(LAMP[0], LAMP[1], 1.0)]);
    let surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
    let placed = PlacedLights::of(&scene, &surface.placement);
    let mut kept = KeptDirect::default();
    update(&mut kept, &surface, &placed);
    let (irradiance, _) = kept.sum(surface.vertices.len());
    let over_area = |vertex: usize| {
        let points = ScrambledSobol::new(5, vertex as u32);
        let at = |k: u32| {
            let placed = surface.sample_point(vertex, points.point2(k)).position;
            under_lamp(surface.placement.file_from_placed(placed))
        };
        (0..MANY_POINTS).map(at).sum::<f64>() / f64::from(MANY_POINTS)
    };
    let areas = surface.vertices.areas();
    let found = Deviation::of((0..irradiance.len()).map(|v| {
        let weight = f64::from(areas[v]);
        (weight, f64::from(irradiance[v].x), over_area(v))
    }));
    let what = "rectangle over a floor, vertices";
    at_most(&format!("{what}, mean"), found.mean.abs(), CLOSED_FORM);
    at_most(
        &format!("{what}, worst {:.4}, rms", found.worst),
        found.rms,
        ONE_POINT,
    );
}

#[test]
fn the_horizon_cuts_a_rectangle_above_a_wall() {
    let (height, half) = (1.2, 0.4);
    let mut mesh = SampleMesh::default();
    let corners = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(1.0, 1.0, 1.0)];
    mesh.box_sides(corners, Facing::Inward, &[(0, false)], 0);
    let mut scene = mesh.scene(&[0.5], 0.125, 64);
    // Half of it is behind the wall's plane, and passes above the wall.
    let (lower, upper) = (
        DVec3::new(-0.5, height, -half),
        DVec3::new(0.5, height, half),
    );
    scene.lights = vec![lamp_facing_down(lower, upper, 1.0)];
    scene.render.bounces = Bounces::Count(0);
    scene.camera.position = DVec3::new(1.5, 0.5, 0.0);
    scene.camera.target = DVec3::new(0.0, 0.5, 0.0);
    scene.camera.vfov_deg = 40.0;
    let image = frame_of(&scene, Component::Irradiance);
    let on_wall = |p: DVec3| p.y > 0.02 && p.y < 0.98 && p.z.abs() < 0.98;
    let found = deviation(&scene, &image, (0, 0.0), on_wall, |[x, y]| {
        let point = seen_on_plane(&scene, [x + 0.5, y + 0.5], 0, 0.0);
        let above = height - point.y;
        let beside = [-half - point.z, half - point.z].map(|z| z / above);
        PI * over_rectangle([0.0, 0.5 / above], beside, perpendicular_corner)
    });
    check("rectangle cut by a wall's horizon", &found);
}

#[test]
fn a_spot_lights_a_disc_of_the_floor() {
    let (height, intensity) = (1.5, 2.0);
    let [beam_deg, cutoff_deg] = [20.0_f32, 30.0];
    let position = DVec3::new(0.1, height, 0.2);
    let scene = floor(vec![spot_facing_down(
        position,
        intensity,
        [beam_deg, cutoff_deg],
    )]);
    let at = |point: DVec3| {
        let to_point = point - position;
        let cosine = height / to_point.length();
        let angle_deg = acos(cosine).to_degrees();
        let falloff =
            (f64::from(cutoff_deg) - angle_deg) / (f64::from(cutoff_deg) - f64::from(beam_deg));
        f64::from(intensity) * cosine / to_point.length_squared() * falloff.clamp(0.0, 1.0)
    };
    let image = frame_of(&scene, Component::Irradiance);
    let found = deviation(&scene, &image, (1, 0.0), on_floor, |[x, y]| {
        // The mean over the pixel, for those with the rim in them.
        let sample = |k: u32| {
            let step = |i: u32| (f64::from(i) + 0.5) / 16.0;
            let place = [x + step(k % 16), y + step(k / 16)];
            at(seen_on_plane(&scene, place, 1, 0.0))
        };
        (0..256).map(sample).sum::<f64>() / 256.0
    });
    check("spot over a floor", &found);
    let dark = image.pixels().iter().filter(|p| **p == Vec3::ZERO).count();
    let lit = image.pixels().len() - dark;
    assert!(dark > 500 && lit > 500, "{dark} pixels dark, {lit} lit");
}

#[test]
fn parallel_light_follows_the_cosine() {
    for direction in [
        Vec3::NEG_Y,
        Vec3::new(1.0, -1.0, 0.5),
        Vec3::new(3.0, -0.1, 0.0),
    ] {
        let scene = floor(vec![directional_light(direction, 2.0)]);
        let image = frame_of(&scene, Component::Irradiance);
        let cosine = f64::from(-direction.normalize().y);
        let found = deviation(&scene, &image, (1, 0.0), on_floor, |_| 2.0 * cosine);
        check(&format!("parallel light along {direction}"), &found);
    }
    let scene = floor(vec![directional_light(Vec3::Y, 1.0)]);
    let image = frame_of(&scene, Component::Irradiance);
    let lit = image.pixels().iter().filter(|p| **p != Vec3::ZERO).count();
    assert_eq!(lit, 0, "pixels lit from below");
}
