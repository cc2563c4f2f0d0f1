//! Indirect light at some vertices against the path tracer, which shares no
//! transfer, basis or sample point with the frames.

use glam::Vec3;

use super::statistics::root_of_difference;
use crate::bake::{Bake, BakeError, RunSettings, StudyLight, TestKind};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::reference::{AtVertex, AtVertices, indirect_irradiance};
use crate::relight::Transport;
use crate::scene::{Bounces, PlacedLight, Scene};
use crate::surface::{Surface, direct};

/// Vertices that are looked at.
pub(super) const VERTICES: usize = 300;
/// Paths a vertex.
pub(super) const PATHS: u32 = 4096;
/// Indirect bounces.
pub(super) const BOUNCES: u32 = 4;
/// Seed of the vertices and of the paths.
const SEED: u32 = 0x4e90_0005;
/// Kinds of the lights; a closed scene has a second point for the sun.
const KINDS: [TestKind; 3] = [TestKind::Point, TestKind::Spot, TestKind::Sun];

/// What one light showed.
pub(super) struct LightAgainstPaths {
    pub(super) kind: TestKind,
    /// Root mean square over the area, relative: as found, and with the paths' own
    /// noise taken off.
    pub(super) errors: [f64; 2],
    /// Of the sum.
    pub(super) signed: f64,
    /// Standard error of the paths, relative: of a vertex and of the sum.
    pub(super) noise: [f64; 2],
}

/// What the comparison needs.
pub(super) struct Subject<'a> {
    pub(super) scene: &'a Scene,
    pub(super) surface: &'a Surface,
    pub(super) bakes: [&'a Bake; 2],
    /// Of the vertices.
    pub(super) albedo: &'a [Vec3],
}

/// One point, one spot and one sun (or a second point), each with the errors of
/// both bakes.
pub(super) fn against_paths(
    subject: &Subject,
    lights: &[StudyLight],
    run: &RunSettings,
) -> Result<Vec<[LightAgainstPaths; 2]>, BakeError> {
    let vertices = random_vertices(subject.surface);
    let chosen = choose(lights);
    run.progress
        .stage("paths at vertices", (chosen.len() * vertices.len()) as u64);
    chosen
        .into_iter()
        .map(|(kind, light)| {
            let what = AtVertices {
                vertices: &vertices,
                bounces: BOUNCES,
                samples: PATHS,
                seed: SEED,
            };
            let paths = indirect_irradiance(subject.scene, subject.surface, light, &what, run)
                .ok_or(BakeError::Cancelled)?;
            Ok(subject.bakes.map(|bake| {
                let irradiance = relit(subject, bake, light, run);
                compared(subject.surface, kind, &vertices, &paths, &irradiance)
            }))
        })
        .collect()
}

/// Different vertices at random.
fn random_vertices(surface: &Surface) -> Vec<u32> {
    let count = surface.vertices.len();
    let mut keys: Vec<(f32, u32)> = (0..count as u32)
        .map(|v| (uniform(SEED, v, 0), v))
        .collect();
    keys.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    keys.into_iter()
        .take(VERTICES)
        .map(|(_, vertex)| vertex)
        .collect()
}

fn choose(lights: &[StudyLight]) -> Vec<(TestKind, &PlacedLight)> {
    let mut chosen: Vec<usize> = Vec::new();
    for kind in KINDS {
        let find = |kind: TestKind, chosen: &[usize]| {
            lights.iter().enumerate().position(|(number, light)| {
                light.kind == kind && light.placed.is_some() && !chosen.contains(&number)
            })
        };
        let found = find(kind, &chosen).or_else(|| find(TestKind::Point, &chosen));
        chosen.extend(found);
    }
    let of = |number: &usize| {
        let light = &lights[*number];
        light.placed.as_ref().map(|placed| (light.kind, placed))
    };
    chosen.iter().filter_map(of).collect()
}

/// Indirect irradiance as a frame has it.
fn relit(subject: &Subject, bake: &Bake, light: &PlacedLight, run: &RunSettings) -> Vec<Vec3> {
    let shadows = direct::Shadows::of_surface(subject.surface, run.level);
    let arriving = direct::at_vertices(&shadows, light);
    let pairs = arriving.iter().zip(subject.albedo);
    let source: Vec<Vec3> = pairs.map(|(e, rho)| *e * *rho).collect();
    let transport = Transport {
        bake,
        level: run.level,
    };
    transport
        .solve(&source, subject.albedo, Bounces::Count(BOUNCES))
        .expect("a number of bounces always has a sum")
        .irradiance
}

fn compared(
    surface: &Surface,
    kind: TestKind,
    vertices: &[u32],
    paths: &[AtVertex],
    irradiance: &[Vec3],
) -> LightAgainstPaths {
    let (mut squares, mut all, mut variance) = (0.0, 0.0, 0.0);
    let (mut sum, mut total, mut variance_of_sum) = (0.0, 0.0, 0.0);
    for (&vertex, path) in vertices.iter().zip(paths) {
        let area = f64::from(surface.vertices.open_area(vertex as usize));
        let right = path.irradiance.as_dvec3();
        let difference = irradiance[vertex as usize].as_dvec3() - right;
        let own = path.variance.as_dvec3().element_sum();
        squares += area * difference.length_squared();
        all += area * right.length_squared();
        variance += area * own;
        sum += area * difference.element_sum();
        total += area * right.element_sum();
        // Channels of one path go together.
        variance_of_sum += 3.0 * area * area * own;
    }
    let all = f64::at_least(all, f64::MIN_POSITIVE);
    let total = f64::at_least(total, f64::MIN_POSITIVE);
    let [found, noise] = [squares / all, variance / all].map(f64::sqrt);
    LightAgainstPaths {
        kind,
        errors: [found, root_of_difference(found, noise)],
        signed: sum / total,
        noise: [noise, variance_of_sum.sqrt() / total],
    }
}
