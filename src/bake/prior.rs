//! Prior lights: how strongly each basis function is excited by lights in
//! general. Made by the bake with a seed of its own, never the scene's lights.

use glam::Vec3;
use rayon::prelude::*;

use super::places::Places;
use super::transfer::vertex_rays;
use super::{RunSettings, sky};
use crate::maths::hash::uniform;
use crate::maths::sampling::sphere_direction;
use crate::scene::PlacedLight;
use crate::simd::Level;
use crate::surface::{Surface, direct};

/// Numbers of prior lights by kind (some 250; 32 training lights did overfit).
const POINTS: u32 = 192;
const SPOTS: u32 = 32;
const DIRECTIONALS: u32 = 32;
/// Half angle of the prior spots, degrees.
const SPOT_CUTOFF_DEG: f32 = 20.0;
/// Prior skies, in an open scene.
const SKIES: usize = 7;
/// Rays a vertex that look for the prior skies.
const SKY_RAYS: u32 = 64;
/// Seed of these rays.
const SKY_SEED: u32 = 0x5ce1;
/// Seed that chooses.
const CHOOSING_SEED: u32 = 0x11947;
/// Seed that reports.
const REPORTING_SEED: u32 = 0x2b6f5;
/// Unseen lights: points near surfaces and far from them.
const UNSEEN_POINTS: u32 = 24;

/// The prior lights of a scene, in a fixed order. The constant light is not
/// among them: it has no place.
fn lights(places: &Places) -> Vec<PlacedLight> {
    if !places.any() {
        return Vec::new();
    }
    let key = |light| [CHOOSING_SEED, light];
    let points = (0..POINTS).map(|i| PlacedLight::unit_point(places.point(key(i))));
    let spots = (POINTS..POINTS + SPOTS).map(|i| unit_spot(places, key(i), SPOT_CUTOFF_DEG));
    let suns = (POINTS + SPOTS..POINTS + SPOTS + DIRECTIONALS).map(|i| unit_sun(places, key(i)));
    points.chain(spots).chain(suns).collect()
}

/// Point lights that nothing was chosen by, to report with.
pub(super) fn unseen_lights(places: &Places) -> Vec<PlacedLight> {
    if !places.any() {
        return Vec::new();
    }
    (0..UNSEEN_POINTS)
        .map(|light| PlacedLight::unit_point(places.point([REPORTING_SEED, light])))
        .collect()
}

/// A spot in a free place, in a random direction.
pub(super) fn unit_spot(places: &Places, [seed, light]: [u32; 2], cutoff_deg: f32) -> PlacedLight {
    let u = |dimension| uniform(seed, light, dimension);
    let direction = sphere_direction([u(8), u(9)]);
    PlacedLight::unit_spot(places.point([seed, light]), direction, cutoff_deg)
}

/// A sun that reaches what hands light on; any sun where there is none.
pub(super) fn unit_sun(places: &Places, [seed, light]: [u32; 2]) -> PlacedLight {
    let u = |dimension| uniform(seed, light, dimension);
    PlacedLight::unit_directional(if places.any_sun() {
        places.sun([seed, light])
    } else {
        sphere_direction([u(8), u(9)])
    })
}

/// Irradiance of every prior light at the vertices (albedo 1), each scaled to
/// RMS 1 and handed over one at a time: lights with a place, skies where the
/// scene is open, and the constant light last. Lights that reach nothing are
/// left out. Returns how many were handed over, or `None` if the job was
/// stopped.
pub(super) fn for_each(
    surface: &Surface,
    run: &RunSettings,
    mut take: impl FnMut(&[f32]),
) -> Option<usize> {
    let mut count = 0;
    let mut hand_over = |mut brightness: Vec<f32>| {
        if scale_to_rms_1(&mut brightness) {
            take(&brightness);
            count += 1;
        }
    };
    let shadows = direct::Shadows::of_surface(surface, run.level);
    let lights = lights(&Places::of(surface, run.level));
    run.progress.stage("prior lights", lights.len() as u64);
    for light in lights {
        if run.progress.cancelled() {
            return None;
        }
        run.progress.advance(1);
        let irradiance = direct::at_vertices_by_one_point(&shadows, &light);
        hand_over(irradiance.iter().map(|e| e.x).collect());
    }
    for sky in skies(surface, run.level) {
        hand_over(sky);
    }
    hand_over(vec![1.0; surface.vertices.len()]);
    Some(count)
}

/// Returns whether there is any light to scale.
fn scale_to_rms_1(brightness: &mut [f32]) -> bool {
    let square = |e: &f32| f64::from(*e) * f64::from(*e);
    let squares: f64 = brightness.iter().map(square).sum();
    let rms = (squares / brightness.len() as f64).sqrt();
    if rms > 0.0 {
        brightness
            .iter_mut()
            .for_each(|e| *e = (f64::from(*e) / rms) as f32);
    }
    rms > 0.0
}

/// Irradiance of prior skies at the vertices, roughly: one that is the same
/// everywhere, and a bright half of it about each axis. None in a closed scene.
fn skies(surface: &Surface, level: Level) -> Vec<Vec<f32>> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let lobes: Vec<Vec3> = axes.iter().flat_map(|&axis| [axis, -axis]).collect();
    let at_vertices: Vec<[f32; SKIES]> = (0..surface.vertices.len())
        .into_par_iter()
        .with_min_len(64)
        .map(|vertex| {
            let mut seen = [0.0; SKIES];
            for direction in escapes(surface, level, vertex) {
                seen[0] += 1.0 / SKY_RAYS as f32;
                for (sum, lobe) in seen[1..].iter_mut().zip(&lobes) {
                    *sum += direction.dot(*lobe).max(0.0) / SKY_RAYS as f32;
                }
            }
            seen
        })
        .collect();
    let escaped: f64 = at_vertices.iter().map(|seen| f64::from(seen[0])).sum();
    if escaped <= sky::OPEN_SHARE * at_vertices.len() as f64 {
        return Vec::new();
    }
    (0..SKIES)
        .map(|sky| at_vertices.iter().map(|seen| seen[sky]).collect())
        .collect()
}

/// Directions in which cosine-weighted rays of a vertex escape.
fn escapes(surface: &Surface, level: Level, vertex: usize) -> impl Iterator<Item = Vec3> {
    vertex_rays(surface, level, [SKY_SEED, vertex as u32], SKY_RAYS)
        .filter_map(|(_, (direction, hit))| hit.is_none().then_some(direction))
}
