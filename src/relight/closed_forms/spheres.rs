//! Inside a sphere every point sees every other one alike: a bounce spreads
//! light evenly, wherever it came from.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::enclosures::{ENCLOSED_LIGHT, SPHERE, furnace_radiance};
use super::{Deviation, at_most};
use crate::maths::functions::sin;
use crate::scene::sample_scenes::{lamp_facing_down, point_light, spot_facing_down};
use crate::scene::{Bounces, Light};

/// Form factors between patches: noise of some 200 rows and compression of a
/// patch's step of brightness, after averaging over a sixth of the sphere. 0.32 % is
/// measured, where patches send and receive.
const PATCHES: f64 = 0.01;

/// The worst of 4,842 vertices. The spot lights a small part of the sphere, so few of
/// a vertex's 1,024 rays bring light: one bounce of it is 0.9 % off in the root mean
/// square, and 4.6 % at the vertex where noise and ringing are most. All other lights
/// stay below 2.8 %.
const WORST_VERTEX: f64 = 0.06;

/// Area of the mesh, file units.
fn total_area() -> f64 {
    let scale = SPHERE.surface.placement.scale;
    SPHERE.fronts().map(|v| SPHERE.area(v)).sum::<f64>() / (scale * scale)
}

/// Flux of a spot of 1 W/sr: full to `beam`, from there linear in the angle
/// to `cutoff`; 2 pi times the integral of that over the sine.
fn flux_of_spot([beam_deg, cutoff_deg]: [f32; 2]) -> f64 {
    let [beam, cutoff] = [beam_deg, cutoff_deg].map(|angle| f64::from(angle).to_radians());
    2.0 * PI * (1.0 - (sin(cutoff) - sin(beam)) / (cutoff - beam))
}

/// Lights anywhere inside, with their flux.
fn lights() -> Vec<(&'static str, Light, f64)> {
    let angles = [15.0, 50.0];
    let (lower, upper) = (DVec3::new(-0.3, 0.2, -0.1), DVec3::new(0.1, 0.2, 0.3));
    let spot = spot_facing_down(DVec3::new(0.3, 0.5, -0.2), 3.0, angles);
    vec![
        (
            "point off the centre",
            point_light(DVec3::new(0.1, 0.2, -0.4), 3.0),
            12.0 * PI,
        ),
        (
            "point near the wall",
            point_light(DVec3::new(0.5, 0.5, 0.1), 3.0),
            12.0 * PI,
        ),
        ("spot", spot, 3.0 * flux_of_spot(angles)),
        (
            "rectangle",
            lamp_facing_down(lower, upper, 5.0),
            5.0 * PI * 0.16,
        ),
    ]
}

#[test]
fn a_hollow_sphere_is_lit_evenly_from_anywhere() {
    for (name, light, flux) in lights() {
        for albedo in [0.5_f32, 0.9] {
            for bounces in [Bounces::Count(1), Bounces::Count(3), Bounces::All] {
                let irradiance = SPHERE.indirect(std::slice::from_ref(&light), albedo, bounces);
                let series = furnace_radiance(f64::from(albedo), bounces) - 1.0;
                let wanted = series * flux / total_area();
                let found = Deviation::of(
                    SPHERE
                        .fronts()
                        .map(|v| (SPHERE.area(v), f64::from(irradiance[v].x), wanted)),
                );
                let what = format!(
                    "sphere, {name}, albedo {albedo}, {bounces:?}: mean {:+.4}",
                    found.mean
                );
                at_most(&format!("{what}, rms"), found.rms, ENCLOSED_LIGHT);
                at_most(&format!("{what}, worst"), found.worst, WORST_VERTEX);
            }
        }
    }
}

#[test]
fn patches_of_a_sphere_see_each_other_by_their_area() {
    let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    // The nearest of six directions decides the patch.
    let axes: Vec<DVec3> = axes.collect();
    let patch_of = |v: usize| {
        let toward = |k: &usize| SPHERE.position(v).dot(axes[*k]);
        (0..axes.len()).max_by(|a, b| toward(a).total_cmp(&toward(b)))
    };
    let patches: Vec<Option<usize>> = SPHERE.fronts().map(patch_of).collect();
    let area_of = |patch: usize| -> f64 {
        SPHERE
            .fronts()
            .filter(|&v| patches[v] == Some(patch))
            .map(|v| SPHERE.area(v))
            .sum()
    };
    let total: f64 = (0..axes.len()).map(area_of).sum();
    for sender in 0..axes.len() {
        let emits = |v: usize| patches.get(v) == Some(&Some(sender));
        let source: Vec<Vec3> = (0..SPHERE.vertex_count())
            .map(|v| Vec3::splat(f32::from(u8::from(emits(v)))))
            .collect();
        let irradiance = SPHERE.apply(&source);
        let wanted = area_of(sender) / total;
        let form_factor = |receiver: usize| -> f64 {
            let chosen = SPHERE.fronts().filter(|&v| patches[v] == Some(receiver));
            let flux: f64 = chosen
                .map(|v| SPHERE.area(v) * f64::from(irradiance[v].x))
                .sum();
            flux / area_of(receiver)
        };
        let found =
            Deviation::of((0..axes.len()).map(|receiver| (1.0, form_factor(receiver), wanted)));
        let what = format!("sphere, patch {sender} of {wanted:.4} to all patches, worst");
        at_most(&what, found.worst, PATCHES);
    }
}
