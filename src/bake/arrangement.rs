//! Which lights a scene is tested under: of every kind a fixed number, spread over
//! what decides how hard a light is.
//!
//! A light that lights all of a room evenly is easily told by smooth functions, a
//! spot on one wall is not: errors of single lights differ by a factor of ten. So
//! the lights of a kind are not simply random. Of [`CANDIDATES`] times as many, in
//! the order of how evenly they light the scene, every run of so many gives one;
//! which one turns through the places that the run lights. Spread of the mean error
//! of sets of 32 over six seeds (standard deviation / largest over least) without
//! and with this, coarse meshes: cornell 8.6 and 6.0 %, 1.25 and 1.18; window 8.5
//! and 3.9 %, 1.24 and 1.11.

use rayon::prelude::*;

use super::footprint::{Footprint, Probes};
use super::places::Places;
use super::test_lights::{LEAST_INDIRECT, TestKind, light};
use crate::maths::hash::uniform;
use crate::scene::PlacedLight;

/// Candidates for every light.
const CANDIDATES: u32 = 8;
/// Random number that turns the choice, beyond those of the lights themselves.
const TURN: u32 = 4096;
/// A turn by this goes round evenly (the golden section).
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// As many lights of a kind as `numbers` (of the set) has; fewer where too few
/// candidates reach anything. None of a kind that has no place.
pub(super) fn arranged(
    places: &Places,
    probes: &Probes,
    kind: TestKind,
    seed: u32,
    numbers: std::ops::Range<u32>,
) -> Vec<PlacedLight> {
    let candidates = numbers.start * CANDIDATES..numbers.end * CANDIDATES;
    let mut found: Vec<(Footprint, PlacedLight)> = candidates
        .into_par_iter()
        .filter_map(|number| {
            let light = light(places, kind, [seed, number])?;
            Some((probes.footprint(&light), light))
        })
        // What no probe sees may be a small patch of light, the hardest case: its
        // share is asked for at all vertices later.
        .filter(|(it, _)| it.is_unseen() || it.indirect_share >= LEAST_INDIRECT)
        .collect();
    found.sort_by(|a, b| a.0.evenness.total_cmp(&b.0.evenness));
    let count = numbers.len().min(found.len());
    let start = f64::from(uniform(seed, numbers.start, TURN));
    let choose = |step: usize| {
        let mut run: Vec<usize> =
            (step * found.len() / count..(step + 1) * found.len() / count).collect();
        run.sort_by_key(|&candidate| found[candidate].0.brightest);
        let turned = start + step as f64 * GOLDEN;
        let place = (turned - turned.floor()) * run.len() as f64;
        found[run[place as usize]].1.clone()
    };
    (0..count).map(choose).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::sample_scenes::room_with_blocks;
    use crate::simd::Level;
    use crate::surface::Surface;

    #[test]
    fn lights_are_spread_over_how_evenly_they_light() {
        let scene = room_with_blocks(true, 0.4, 64);
        let surface = Surface::both_sides(&scene);
        let level = Level::detect();
        let places = Places::of(&surface, level);
        let probes = Probes::of(&places, 1);
        let evenness = |lights: &[PlacedLight]| -> Vec<f64> {
            lights
                .iter()
                .map(|light| probes.footprint(light).evenness)
                .collect()
        };
        let chosen = evenness(&arranged(&places, &probes, TestKind::Point, 1, 0..8));
        assert_eq!(chosen.len(), 8);
        assert!(chosen.is_sorted(), "{chosen:?}");
        // Every eighth of all candidates has one.
        let candidates: Vec<PlacedLight> = (0..8 * CANDIDATES)
            .filter_map(|number| light(&places, TestKind::Point, [1, number]))
            .collect();
        let mut all = evenness(&candidates);
        all.sort_by(f64::total_cmp);
        for (step, evenness) in chosen.iter().enumerate() {
            let run = &all[step * CANDIDATES as usize..(step + 1) * CANDIDATES as usize];
            assert!(
                (run[0]..=run[run.len() - 1]).contains(evenness),
                "{step}: {evenness}"
            );
        }
    }
}
