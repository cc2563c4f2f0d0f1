//! Prior lights: how strongly each basis function is excited by lights in
//! general. Made by the bake with a seed of its own, never the scene's lights.

use super::RunSettings;
use super::places::Places;
use super::test_lights::CLEARANCE;
use crate::maths::hash::uniform;
use crate::maths::sampling::sphere_direction;
use crate::scene::PlacedLight;
use crate::surface::direct;

/// Numbers of prior lights by kind (some 250; 32 training lights did overfit).
const POINTS: u32 = 192;
const SPOTS: u32 = 32;
const DIRECTIONALS: u32 = 32;
/// Half angle of the prior spots, degrees.
const SPOT_CUTOFF_DEG: f32 = 20.0;
/// Seed that chooses.
const CHOOSING_SEED: u32 = 0x11947;
/// Seed that reports.
const REPORTING_SEED: u32 = 0x2b6f5;
/// Both.
#[cfg(test)]
pub(super) const SEEDS: [u32; 2] = [CHOOSING_SEED, REPORTING_SEED];
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
        .map(|light| PlacedLight::unit_point(places.room_point([REPORTING_SEED, light], CLEARANCE)))
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

/// Light of every prior light at the vertices (albedo 1), each scaled to bring the
/// same indirect light and handed over one at a time: lights with a place, skies
/// where the scene is open, and the constant light last. Lights that bring none
/// are left out. Returns how many were handed over, or `None` if the job was
/// stopped.
pub(super) fn for_each(
    places: &Places,
    run: &RunSettings,
    mut take: impl FnMut(&[f32]),
) -> Option<usize> {
    let surface = places.surface();
    let mut count = 0;
    let mut hand_over = |mut brightness: Vec<f32>| {
        if places.scale(&mut brightness) {
            take(&brightness);
            count += 1;
        }
    };
    let shadows = direct::Shadows::of_surface(surface, run.level);
    let lights = lights(places);
    run.progress.stage("prior lights", lights.len() as u64);
    for light in lights {
        if run.progress.cancelled() {
            return None;
        }
        run.progress.advance(1);
        let irradiance = direct::at_vertices_by_one_point(&shadows, &light);
        hand_over(irradiance.iter().map(|e| e.x).collect());
    }
    places.skies().into_iter().for_each(&mut hand_over);
    hand_over(vec![1.0; surface.vertices.len()]);
    Some(count)
}
