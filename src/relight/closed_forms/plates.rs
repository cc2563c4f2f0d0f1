//! Rectangles and nothing else: what one sends to the other, and what light
//! does between them.

use glam::{DVec3, Vec3};

use super::area::parallel_corner;
use super::{Baked, Deviation, at_most, largest};
use crate::scene::Bounces;
use crate::scene::sample_scenes::{BoxSide, Facing, SampleMesh, point_light};

/// Form factors of the unit squares: less than half of what tells the one (0.19982)
/// from the other (0.20004), so that a mistaken one is found.
const FORM_FACTOR: f64 = 4e-4;
/// Rays a vertex for it: by 512 the noise of some 300 rows is 6e-4 in the mean.
const FORM_FACTOR_RAYS: u32 = 8192;
/// Plates of 80 m at a distance of 1 m lose 0.06 % of a bounce at the centre
/// through the gap between their edges; the rest is noise of 256 rays.
const WIDE: f64 = 0.01;
/// Mean over planes 1e-4 apart, whose gap lets 2e-4 of the light out: the rays
/// that find it.
const NEAR: f64 = 3e-4;
/// A vertex away from their border, from which no ray of some hundred finds the
/// gap: single precision.
const ENCLOSED: f64 = 1e-5;

/// Sides of a box, fronts inward.
fn plates(corners: [DVec3; 2], sides: &[BoxSide], max_edge: f64, rays: u32) -> Baked {
    let mut mesh = SampleMesh::default();
    mesh.box_sides(corners, Facing::Inward, sides, 0);
    Baked::new(&mesh.scene(&[0.5], max_edge, rays))
}

/// Fronts of the side of a normal.
fn facing(plates: &Baked, normal: Vec3) -> Vec<usize> {
    let is_of = |v: &usize| plates.normal(*v).dot(normal) > 0.9;
    plates.fronts().filter(is_of).collect()
}

/// Irradiance of one side that sends 1 W/m2, by vertex.
fn sent_by(plates: &Baked, sender: Vec3) -> Vec<f64> {
    let senders = facing(plates, sender);
    let mut source = vec![Vec3::ZERO; plates.vertex_count()];
    for v in senders {
        source[v] = Vec3::ONE;
    }
    let irradiance = plates.apply(&source);
    irradiance.iter().map(|e| f64::from(e.x)).collect()
}

#[test]
fn two_unit_squares_exchange_a_fifth() {
    let unit = [DVec3::ZERO, DVec3::ONE];
    for (name, sides, normals, wanted) in [
        (
            "parallel",
            [(1, false), (1, true)],
            [Vec3::Y, Vec3::NEG_Y],
            0.199_82,
        ),
        (
            "perpendicular",
            [(1, false), (0, false)],
            [Vec3::Y, Vec3::X],
            0.200_04,
        ),
    ] {
        let squares = plates(unit, &sides, 1.0 / 12.0, FORM_FACTOR_RAYS);
        for (sender, receiver) in [(0, 1), (1, 0)] {
            let irradiance = sent_by(&squares, normals[sender]);
            let received = facing(&squares, normals[receiver]);
            let found = Deviation::of(
                received
                    .iter()
                    .map(|&v| (squares.area(v), irradiance[v], wanted)),
            );
            let what = format!("unit squares, {name}, {sender} to {receiver}, mean");
            at_most(&what, found.mean.abs(), FORM_FACTOR);
            let backs = squares.fronts().end..squares.vertex_count();
            let behind = largest(backs.map(|v| irradiance[v].abs()));
            at_most("light behind them", behind, 0.0);
        }
    }
}

#[test]
fn light_between_wide_plates_is_a_geometric_series() {
    let (half, [below, above]) = (40.0, [0.8_f32, 0.5]);
    let corners = [DVec3::new(-half, 0.0, -half), DVec3::new(half, 1.0, half)];
    let plates = plates(corners, &[(1, false), (1, true)], 4.0, 256);
    let is_below = |v: usize| plates.normal(v).y > 0.0;
    let escapes = 1.0 - 4.0 * parallel_corner(half, half);
    assert!(escapes < 1e-3, "the plates are wide: {escapes}");
    // Direct irradiance of each plate, W/m2, and M = rho x it.
    let direct = [2.0_f32, 0.7];
    let [m_below, m_above] = [below * direct[0], above * direct[1]];
    let source: Vec<Vec3> = (0..plates.vertex_count())
        .map(|v| Vec3::splat(if is_below(v) { m_below } else { m_above }))
        .collect();
    let albedo = |v: usize| if is_below(v) { below } else { above };
    let irradiance = plates.solve_by(&source, albedo, Bounces::All);
    let decay = f64::from(below * above);
    for (name, normal, own, other, rho) in [
        ("lower", Vec3::Y, m_below, m_above, below),
        ("upper", Vec3::NEG_Y, m_above, m_below, above),
    ] {
        let wanted = f64::from(own + rho * other) / (1.0 - decay);
        let is_central = |v: &usize| plates.position(*v).with_y(0.0).length() < 0.3 * half;
        let central = facing(&plates, normal).into_iter().filter(is_central);
        let found = Deviation::of(central.map(|v| {
            let radiosity = f64::from(own + rho * irradiance[v].x);
            (plates.area(v), radiosity, wanted)
        }));
        let what = format!(
            "wide plates, radiosity of the {name}, mean {:+.4}, worst",
            found.mean
        );
        at_most(&what, found.worst, WIDE);
    }
}

#[test]
fn planes_that_nearly_touch_see_nothing_else() {
    let corners = [DVec3::ZERO, DVec3::new(1.0, 1e-4, 1.0)];
    let planes = plates(corners, &[(1, false), (1, true)], 0.125, 256);
    for (sender, receiver) in [(Vec3::Y, Vec3::NEG_Y), (Vec3::NEG_Y, Vec3::Y)] {
        let irradiance = sent_by(&planes, sender);
        let received = facing(&planes, receiver);
        let found = Deviation::of(
            received
                .iter()
                .map(|&v| (planes.area(v), irradiance[v], 1.0 - 2e-4)),
        );
        let what = format!(
            "planes 1e-4 apart, form factor, worst {:.4}, mean",
            found.worst
        );
        at_most(&what, found.mean.abs(), NEAR);
        let is_inside = |v: &usize| {
            let place = planes.position(*v);
            [place.x, place.z].iter().all(|x| (0.1..0.9).contains(x))
        };
        let inside = received.into_iter().filter(is_inside);
        let worst = largest(inside.map(|v| (irradiance[v] - 1.0).abs()));
        at_most("planes 1e-4 apart, away from the border", worst, ENCLOSED);
        let itself = facing(&planes, sender).into_iter();
        let back = planes.fronts().end..planes.vertex_count();
        let elsewhere = largest(itself.chain(back).map(|v| irradiance[v].abs()));
        at_most("planes 1e-4 apart, light elsewhere", elsewhere, 0.0);
    }
}

#[test]
fn a_plane_alone_sees_nothing() {
    let plane = plates([DVec3::ZERO, DVec3::ONE], &[(1, false)], 0.125, 256);
    let light = point_light(DVec3::new(0.3, 0.2, 0.6), 1.0);
    let lit = plane.direct(std::slice::from_ref(&light));
    assert!(lit.iter().any(|&e| e != Vec3::ZERO), "the plane is lit");
    for source in [lit, vec![Vec3::ONE; plane.vertex_count()]] {
        let irradiance = plane.solve(&source, 0.9, Bounces::Count(3));
        let bounced = irradiance.iter().map(|e| f64::from(e.abs().element_sum()));
        at_most("bounced light on a plane alone", largest(bounced), 0.0);
    }
}
