//! Indirect light at some vertices against the path tracer, which shares no
//! transfer, basis or sample point with the frames.

use glam::Vec3;

use super::statistics::{ByLight, root_of_difference};
use crate::bake::{Bake, BakeError, RunSettings, StudyLight, TestKind};
use crate::maths::hash::uniform;
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
    /// What averaging its direct light over a few points of each area costs, one
    /// bounce; part of the error.
    pub(super) vertex_sampling: Option<f64>,
    /// `None` where none of it reaches the vertices that are looked at.
    pub(super) found: Option<AgainstPaths>,
}

/// Relative errors of one light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AgainstPaths {
    /// Root mean square over the area, the paths' own noise in it.
    pub(super) error: f64,
    /// Of the sum.
    pub(super) signed: f64,
    /// Standard error of the paths: of a vertex and of the sum.
    pub(super) noise: [f64; 2],
}

impl AgainstPaths {
    /// The error with the paths' noise taken off; `None` where that hides it.
    pub(super) fn corrected(&self) -> Option<f64> {
        Some(root_of_difference(self.error, self.noise[0])).filter(|&error| error > 0.0)
    }
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
    vertex_sampling: &ByLight,
    run: &RunSettings,
) -> Result<Vec<[LightAgainstPaths; 2]>, BakeError> {
    let vertices = random_vertices(subject.surface);
    let chosen = chosen(lights, vertex_sampling);
    run.progress
        .stage("paths at vertices", (chosen.len() * vertices.len()) as u64);
    chosen
        .into_iter()
        .map(|(number, light)| {
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
                LightAgainstPaths {
                    kind: lights[number].kind,
                    vertex_sampling: vertex_sampling[number].map(|[error, _]| error),
                    found: compared(subject.surface, &vertices, &paths, &irradiance),
                }
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

/// A light of each kind: the middle one of those that arrive, in their order, which
/// is that of how evenly they light the scene. The first ones of a kind light next to
/// nothing of it.
fn chosen<'a>(lights: &'a [StudyLight], arriving: &ByLight) -> Vec<(usize, &'a PlacedLight)> {
    let mut chosen: Vec<usize> = Vec::new();
    for kind in KINDS {
        let find = |kind: TestKind, chosen: &[usize]| {
            let is_one = |&number: &usize| {
                let light = &lights[number];
                let is_placed = light.kind == kind && light.placed.is_some();
                is_placed && arriving[number].is_some() && !chosen.contains(&number)
            };
            let all: Vec<usize> = (0..lights.len()).filter(is_one).collect();
            all.get(all.len() / 2).copied()
        };
        let found = find(kind, &chosen).or_else(|| find(TestKind::Point, &chosen));
        chosen.extend(found);
    }
    let of = |number: usize| Some((number, lights[number].placed.as_ref()?));
    chosen.into_iter().filter_map(of).collect()
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
    vertices: &[u32],
    paths: &[AtVertex],
    irradiance: &[Vec3],
) -> Option<AgainstPaths> {
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
    let [error, noise] = [squares / all, variance / all].map(f64::sqrt);
    (total > 0.0).then_some(AgainstPaths {
        error,
        signed: sum / total,
        noise: [noise, variance_of_sum.sqrt() / total],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_the_middle_of_those_that_arrive() {
        let sun = || Some(PlacedLight::unit_directional(Vec3::NEG_Y));
        let kinds = [TestKind::Point, TestKind::Sun, TestKind::Sky];
        let lights: Vec<StudyLight> = kinds
            .into_iter()
            .flat_map(|kind| [kind; 4])
            .map(|kind| StudyLight {
                kind,
                placed: if kind == TestKind::Sky { None } else { sun() },
            })
            .collect();
        let mut arriving: ByLight = vec![Some([0.1, 0.0]); lights.len()];
        let numbers = |arriving: &ByLight| {
            let chosen = chosen(&lights, arriving).into_iter();
            chosen.map(|(number, _)| number).collect::<Vec<_>>()
        };
        assert_eq!(numbers(&arriving), [2, 1, 6], "a second point for the spot");
        arriving[..4].fill(None);
        arriving[6] = None;
        assert_eq!(numbers(&arriving), [5], "dark points are none");
    }

    #[test]
    fn what_noise_hides_is_no_error_of_zero() {
        let found = |error| AgainstPaths {
            error,
            signed: 0.0,
            noise: [0.03, 0.01],
        };
        assert_eq!(found(0.02).corrected(), None);
        let left = found(0.05).corrected().unwrap();
        assert!((left - 0.04).abs() < 1e-12, "{left}");
    }
}
