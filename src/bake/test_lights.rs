//! Lights that chose nothing, to measure errors with: what people put into
//! scenes, in places where light bounces.
//!
//! Points and spots hang in free space, at least [`CLEARANCE`] extents from any
//! surface; suns reach what hands light on; skies have a bright half. A closed
//! scene gets more points instead of suns and skies. What lies beyond (a lamp
//! at a wall, a patch with a hard edge) has lights of its own: [`extremes`].

use rayon::prelude::*;

use super::basis::Basis;
use super::places::Places;
use super::transfer::vertex_rays;
use crate::maths::hash::uniform;
use crate::maths::sampling::sphere_direction;
use crate::scene::PlacedLight;
use crate::simd::Level;
use crate::surface::{Surface, direct};

/// Lights that are tested at once.
pub(crate) const LIGHTS: usize = 32;
/// A value a light, by slot.
pub(crate) type Fields = Vec<[f32; LIGHTS]>;

/// Distance that points and spots keep from surfaces, extents.
pub(super) const CLEARANCE: f64 = 0.05;
/// Distance that spots are thrown over, extents, where there is so much room.
const THROW: f64 = 0.25;
/// Half angles of the spots in turn, degrees.
const CUTOFFS_DEG: [f32; 2] = [30.0, 20.0];
/// A light of which less arrives at a second surface (share of what it sheds on
/// surfaces that see others at all) has no indirect light worth speaking of, and
/// is left out: a lamp over an open plane was 170 % wrong about nothing.
const LEAST_INDIRECT: f64 = 0.02;
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
    (TestKind::Point, 14),
    (TestKind::Spot, 8),
    (TestKind::Sun, 6),
    (TestKind::Sky, 4),
];
const CLOSED: [(TestKind, usize); 2] = [(TestKind::Point, 22), (TestKind::Spot, 10)];

/// Lights of one seed and their direct light.
pub(crate) struct TestLights {
    pub(crate) kinds: Vec<TestKind>,
    /// Direct irradiance in slots, each light scaled to RMS 1; 0 for a light that
    /// reaches nothing.
    pub(crate) brightness: Fields,
}

impl TestLights {
    pub(crate) fn of(places: &Places, basis: &Basis, seed: u32) -> Self {
        let (surface, level) = (places.surface(), places.level());
        let lights = arranged(places, seed);
        let kinds = lights.iter().map(|&(kind, _)| kind).collect();
        let mut brightness = vec![[0.0; LIGHTS]; basis.slot_count()];
        if places.any() {
            let shadows = direct::Shadows::of_surface(surface, level);
            for (number, (_, light)) in lights.iter().enumerate() {
                let values = match light {
                    Some(light) => direct::at_vertices(&shadows, light)
                        .iter()
                        .map(|e| e.x)
                        .collect(),
                    None => sky(surface, level, [seed, number as u32]),
                };
                if places.indirect_share(&values) >= LEAST_INDIRECT {
                    store(basis, &values, number, &mut brightness);
                }
            }
        }
        Self { kinds, brightness }
    }

    /// A lamp 0.02 extents from a corner, and a patch with a hard edge that is
    /// lit alone: numbers 0 and 1; the others are dark.
    pub(crate) fn extremes(places: &Places, basis: &Basis, seed: u32) -> Self {
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
            kinds: vec![TestKind::Point; LIGHTS],
            brightness,
        }
    }
}

/// The lights of a seed: of every kind as many as the table has. Of
/// [`CANDIDATES`] times as many random ones, those are taken that stand in the
/// middle of the order by how evenly they light what hands light on, in equal
/// steps.
pub(super) fn arranged(places: &Places, seed: u32) -> Vec<(TestKind, Option<PlacedLight>)> {
    let table: &[(TestKind, usize)] = if places.any_sun() { &OPEN } else { &CLOSED };
    let mut lights = Vec::new();
    for &(kind, count) in table {
        if kind == TestKind::Sky || !places.any() {
            lights.extend(std::iter::repeat_n((kind, None), count));
        } else {
            let of_kind = arranged_of_kind(places, kind, count, [seed, lights.len() as u32]);
            lights.extend(of_kind.into_iter().map(|light| (kind, Some(light))));
        }
    }
    lights
}

fn arranged_of_kind(
    places: &Places,
    kind: TestKind,
    count: usize,
    [seed, first]: [u32; 2],
) -> Vec<PlacedLight> {
    if std::env::var("LAB_OLD").is_ok() {
        return (0..count as u32)
            .filter_map(|number| light(places, kind, [seed, first + number]))
            .collect();
    }
    let probes = places.probes(seed);
    let candidates = (count * CANDIDATES) as u32;
    let mut found: Vec<(super::places::Footprint, PlacedLight)> = (0..candidates)
        .into_par_iter()
        .filter_map(|number| {
            let light = light(places, kind, [seed, first * CANDIDATES as u32 + number])?;
            Some((places.footprint(&probes, &light), light))
        })
        .collect();
    let brings = |it: &(super::places::Footprint, PlacedLight)| it.0.indirect_share >= LEAST_INDIRECT;
    if found.iter().filter(|it| brings(it)).count() >= count {
        found.retain(brings);
    }
    found.sort_by(|a, b| a.0.evenness.total_cmp(&b.0.evenness));
    (0..count)
        .map(|step| {
            let range = step * found.len() / count..(step + 1) * found.len() / count;
            let mut block: Vec<usize> = range.collect();
            block.sort_by_key(|&i| found[i].0.brightest);
            let turn = (step as f64 * 0.618_033_988_749_895 + f64::from(uniform(seed, first, 77))).fract();
            found[block[(turn * block.len() as f64) as usize]].1.clone()
        })
        .collect()
}

/// Candidates for every light.
const CANDIDATES: usize = 8;

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

/// A sky that is 1 in every direction and brighter about a random one.
fn sky(surface: &Surface, level: Level, [seed, number]: [u32; 2]) -> Vec<f32> {
    let u = |dimension| uniform(seed, number, dimension);
    let axis = sphere_direction([u(8), u(9)]);
    let brighter = 4.0 * u(10);
    (0..surface.vertices.len() as u32)
        .into_par_iter()
        .with_min_len(64)
        .map(|vertex| {
            let rays = vertex_rays(surface, level, [seed, vertex], SKY_RAYS);
            let escaped = rays.filter(|(_, (_, hit))| hit.is_none());
            escaped.fold(0.0_f32, |sum, (_, (direction, _))| {
                let cosine = direction.dot(axis);
                sum + 1.0 + brighter * if cosine > 0.0 { cosine } else { 0.0 }
            })
        })
        .collect()
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
