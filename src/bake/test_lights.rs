//! Lights that chose nothing, to measure errors with: what people put into
//! scenes, in places where light bounces.
//!
//! Points and spots hang in free space, at least [`CLEARANCE`] extents from any
//! surface; suns reach what hands light on; skies have a bright half. A closed
//! scene gets more points instead of suns and skies. What lies beyond (a lamp
//! at a wall, a patch with a hard edge) has lights of its own: [`extremes`].

use glam::Vec3;
use rayon::prelude::*;

use super::arrangement::arranged;
use super::basis::Basis;
use super::footprint::Probes;
use super::places::Places;
use super::transfer::vertex_rays;
use super::{BakeError, RunSettings};
use crate::maths::hash::uniform;
use crate::maths::sampling::sphere_direction;
use crate::scene::PlacedLight;
use crate::surface::{Surface, direct};

/// Lights that are tested at once.
/// (Sets of 32 of two seeds differed by up to a fifth in the mean.)
pub(crate) const LIGHTS: usize = 64;
/// A value a light, by slot.
pub(super) type Fields = Vec<[f32; LIGHTS]>;

/// Distance that points and spots keep from surfaces, extents.
pub(super) const CLEARANCE: f64 = 0.05;
/// Distance that spots are thrown over, extents, where there is so much room.
const THROW: f64 = 0.25;
/// Half angles of the spots in turn, degrees.
const CUTOFFS_DEG: [f32; 2] = [30.0, 20.0];
/// A light of which less arrives at a second surface (share of what it sheds on
/// surfaces that see others at all) has no indirect light worth speaking of, and
/// is left out: a lamp over an open plane was 170 % wrong about nothing.
pub(super) const LEAST_INDIRECT: f64 = 0.02;
/// Rays a vertex that look for skies.
const SKY_RAYS: u32 = 256;
/// Distance of the extreme lamp from a corner and radius of the extreme patch,
/// extents.
const CORNER_DISTANCE: f32 = 0.02;
const PATCH_RADIUS: f32 = 0.05;

/// What a test light is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TestKind {
    /// A lamp in the room.
    Point,
    /// A spot of 30 or 20 degrees, aimed across the room.
    Spot,
    /// A sun that reaches what hands light on.
    Sun,
    /// The same sky everywhere, or one with a bright half.
    Sky,
}

impl TestKind {
    /// The name that reports use.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Sun => "sun",
            Self::Sky => "sky",
        }
    }
}

/// Kinds of the lights of an open and of a closed scene, with how many of each.
const OPEN: [(TestKind, usize); 4] = [
    (TestKind::Point, 28),
    (TestKind::Spot, 16),
    (TestKind::Sun, 12),
    (TestKind::Sky, 8),
];
const CLOSED: [(TestKind, usize); 2] = [(TestKind::Point, 44), (TestKind::Spot, 20)];

/// Lights of one seed and their direct light.
pub(super) struct TestLights {
    /// [`LIGHTS`] of them; a sky has no place, nor has a light that was not found.
    pub(super) lights: Vec<(TestKind, Option<PlacedLight>)>,
    /// Direct irradiance in slots, each light scaled to RMS 1; 0 for a light that
    /// reaches nothing.
    pub(super) brightness: Fields,
}

impl TestLights {
    /// The lights of a seed; stages of progress as [`Self::of_sets`] has them.
    pub(super) fn of(
        places: &Places,
        basis: &Basis,
        seed: u32,
        run: &RunSettings,
    ) -> Result<Self, BakeError> {
        let [set] = Self::of_sets(places, basis, [seed], run)?;
        Ok(set)
    }

    /// The lights of some seeds, whose skies come by the same rays: a stage of progress,
    /// and one of their skies.
    pub(super) fn of_sets<const SETS: usize>(
        places: &Places,
        basis: &Basis,
        seeds: [u32; SETS],
        run: &RunSettings,
    ) -> Result<[Self; SETS], BakeError> {
        run.progress.stage("test lights", (SETS * LIGHTS) as u64);
        let shadows = direct::Shadows::of_surface(places.surface(), places.level());
        let (mut sets, mut skies) = (Vec::new(), Vec::new());
        for (which, seed) in seeds.into_iter().enumerate() {
            run.proceed()?;
            let mut set = Self {
                lights: lights(places, seed),
                brightness: vec![[0.0; LIGHTS]; basis.slot_count()],
            };
            for number in 0..LIGHTS {
                run.proceed()?;
                let (kind, light) = &set.lights[number];
                if *kind == TestKind::Sky {
                    skies.push((which, number));
                }
                if let Some(light) = light {
                    let direct = direct::at_vertices(&shadows, light);
                    let values: Vec<f32> = direct.iter().map(|e| e.x).collect();
                    set.take(places, basis, number, &values);
                }
                run.progress.advance(1);
            }
            sets.push(set);
        }
        let keys: Vec<[u32; 2]> = skies
            .iter()
            .map(|&(which, number)| [seeds[which], number as u32])
            .collect();
        let of_skies = skies_of(places.surface(), run, &keys)?;
        for ((which, number), values) in skies.into_iter().zip(of_skies) {
            sets[which].take(places, basis, number, &values);
        }
        let mut sets = sets.into_iter();
        Ok(seeds.map(|_| sets.next().expect("one of every seed")))
    }

    /// Stores a light's values at the vertices, if it brings indirect light.
    fn take(&mut self, places: &Places, basis: &Basis, number: usize, values: &[f32]) {
        if places.indirect_share(values) >= LEAST_INDIRECT {
            store(basis, values, number, &mut self.brightness);
        }
    }

    /// A lamp 0.02 extents from a corner, and a patch with a hard edge that is
    /// lit alone: numbers 0 and 1; the others are dark.
    pub(super) fn extremes(places: &Places, basis: &Basis, seed: u32) -> Self {
        let (surface, level) = (places.surface(), places.level());
        let mut brightness = vec![[0.0; LIGHTS]; basis.slot_count()];
        if places.any() {
            let extent = (surface.placement.extent * surface.placement.scale) as f32;
            let shadows = direct::Shadows::of_surface(surface, level);
            let lamp = PlacedLight::unit_point(places.corner(CORNER_DISTANCE * extent));
            let lamp: Vec<f32> = direct::at_vertices(&shadows, &lamp)
                .iter()
                .map(|e| e.x)
                .collect();
            store(basis, &lamp, 0, &mut brightness);
            let middle = places.surface_point([seed, 0]);
            let patch: Vec<f32> = surface
                .vertices
                .positions()
                .iter()
                .zip(surface.vertices.normals())
                .map(|(position, normal)| {
                    let near = position.distance(middle.position) < PATCH_RADIUS * extent;
                    f32::from(u8::from(near && normal.dot(middle.flat_normal) > 0.5))
                })
                .collect();
            store(basis, &patch, 1, &mut brightness);
        }
        Self {
            lights: vec![(TestKind::Point, None); LIGHTS],
            brightness,
        }
    }
}

/// A light with a place or a direction; `None` for a sky.
pub(super) fn light(
    places: &Places,
    kind: TestKind,
    [seed, number]: [u32; 2],
) -> Option<PlacedLight> {
    let key = [seed, number];
    match kind {
        TestKind::Point => Some(PlacedLight::unit_point(places.room_point(key, CLEARANCE))),
        TestKind::Spot => {
            let cutoff = CUTOFFS_DEG[number as usize % CUTOFFS_DEG.len()];
            let place = places.room_point(key, CLEARANCE);
            let direction = places.aim(key, place, THROW);
            Some(PlacedLight::unit_spot(place, direction, cutoff))
        }
        TestKind::Sun => Some(PlacedLight::unit_directional(places.sun(key))),
        TestKind::Sky => None,
    }
}

/// The lights of a seed, kind by kind; those without a place count too.
fn lights(places: &Places, seed: u32) -> Vec<(TestKind, Option<PlacedLight>)> {
    let table: &[(TestKind, usize)] = if places.any_sun() { &OPEN } else { &CLOSED };
    let probes = places.any().then(|| Probes::of(places, seed));
    let (mut lights, mut first) = (Vec::new(), 0);
    for &(kind, count) in table {
        let numbers = first..first + count as u32;
        first = numbers.end;
        let found = match &probes {
            Some(probes) if kind != TestKind::Sky => {
                arranged(places, probes, kind, seed, numbers.clone())
            }
            _ => Vec::new(),
        };
        let missing = count - found.len();
        lights.extend(found.into_iter().map(|light| (kind, Some(light))));
        lights.extend(std::iter::repeat_n((kind, None), missing));
    }
    lights
}

/// Skies by seed and number, each 1 in every direction and brighter about a random one: what
/// the vertices have of them, by the same rays, of the first one's seed. A stage of
/// progress, if there are any.
fn skies_of(
    surface: &Surface,
    run: &RunSettings,
    skies: &[[u32; 2]],
) -> Result<Vec<Vec<f32>>, BakeError> {
    let Some(&[seed, _]) = skies.first() else {
        return Ok(Vec::new());
    };
    let lobe = |&[seed, number]: &[u32; 2]| -> (Vec3, f32) {
        let u = |dimension| uniform(seed, number, dimension);
        (sphere_direction([u(8), u(9)]), 4.0 * u(10))
    };
    let lobes: Vec<(Vec3, f32)> = skies.iter().map(lobe).collect();
    run.progress
        .stage("test skies", surface.vertices.len() as u64);
    let row_of = |vertex: u32| {
        run.proceed()?;
        let mut sums = vec![0.0_f32; lobes.len()];
        for (_, (direction, hit)) in vertex_rays(surface, run.level, [seed, vertex], SKY_RAYS) {
            if hit.is_some() {
                continue;
            }
            for (sum, (axis, brighter)) in sums.iter_mut().zip(&lobes) {
                let cosine = direction.dot(*axis);
                *sum += 1.0 + brighter * if cosine > 0.0 { cosine } else { 0.0 };
            }
        }
        run.progress.advance(1);
        Ok(sums)
    };
    let rows: Vec<Vec<f32>> = (0..surface.vertices.len() as u32)
        .into_par_iter()
        .with_min_len(64)
        .map(row_of)
        .collect::<Result<_, BakeError>>()?;
    let of_sky = |sky: usize| rows.iter().map(|row| row[sky]).collect();
    Ok((0..lobes.len()).map(of_sky).collect())
}

/// Stores a light's values at the vertices in slots, scaled to RMS 1.
fn store(basis: &Basis, values: &[f32], light: usize, fields: &mut Fields) {
    let square = |e: &f32| f64::from(*e) * f64::from(*e);
    let squares: f64 = values.iter().map(square).sum();
    let rms = (squares / values.len().max(1) as f64).sqrt();
    if rms > 0.0 {
        for (vertex, &value) in values.iter().enumerate() {
            let slot = basis.slot_of_vertex()[vertex] as usize;
            fields[slot][light] = (f64::from(value) / rms) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeSettings, spectral_basis};
    use crate::scene::sample_scenes::room_with_blocks;

    #[test]
    fn lights_do_not_depend_on_other_sets_but_for_the_rays_of_skies() {
        let scene = room_with_blocks(false, 0.4, 16);
        let surface = Surface::both_sides(&scene);
        let run = RunSettings::silent();
        let places = Places::of(&surface, run.level);
        let basis = spectral_basis(&places, &BakeSettings::of_keys(&scene.bake), &run).unwrap();
        let seeds = [5, 6];
        let together = TestLights::of_sets(&places, &basis, seeds, &run).unwrap();
        let alone = seeds.map(|seed| TestLights::of(&places, &basis, seed, &run).unwrap());
        assert!(together[0].brightness == alone[0].brightness, "bit by bit");
        let (mut lamps, mut skies) = (0, 0);
        for light in 0..LIGHTS {
            let of = |set: &TestLights| set.brightness.iter().map(|it| it[light]).collect();
            let [here, there]: [Vec<f32>; 2] = [&together[1], &alone[1]].map(of);
            if alone[1].lights[light].0 != TestKind::Sky {
                assert_eq!(here, there, "{light}");
                lamps += usize::from(here.iter().any(|&e| e > 0.0));
                continue;
            }
            // By other rays, whose noise is what differs.
            let off: f32 = here
                .iter()
                .zip(&there)
                .map(|(a, b)| (a - b) * (a - b))
                .sum();
            let all: f32 = there.iter().map(|b| b * b).sum();
            assert!(off < 0.01 * all, "{light}: {off} of {all}");
            skies += usize::from(all > 0.0);
        }
        assert!(lamps > 20 && skies > 4, "{lamps} lamps and {skies} skies");
    }
}
