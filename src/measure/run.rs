//! The whole measurement of a scene, chapter by chapter.

use std::time::Instant;

use glam::Vec3;

use super::MeasureError;
use super::frame_errors::{self, Compared};
use super::glossy::{self, GlossyError};
use super::paths::{self, LightAgainstPaths, Subject};
use super::pictures;
use super::statistics::over_lights;
use super::sweeps::{Point, RAYS, Sweeper, Swept};
use super::vertices::{Parts, ROW_RAYS, SchemeErrors, Truth, test_lights};
use crate::bake::{Bake, BakeError, BakeSettings, RunSettings, Scheme, Study};
use crate::relight::{FrameSettings, Renderer, SceneFigures, vertex_albedo};
use crate::report::Block;
use crate::scene::Scene;
use crate::surface::{KeptArrivals, Surface};

/// Bytes that rays may take: those of all rows, which the bakes of the sweeps share,
/// and those of the truth's. 43,000 vertices have room for as many rays as a bake
/// traces, 75,000 for half of them, 120,000 for a quarter.
const KEPT_BYTES: u64 = {
    let most = isize::MAX as u64 / 2;
    if most < 5_000_000_000 {
        most
    } else {
        5_000_000_000
    }
};
/// Test lights that means should be over.
const LEAST_LIGHTS: usize = 32;
/// Beyond so many, the chapters of vertices and sweeps would take hours.
const MOST_VERTICES: usize = 150_000;

/// What a report is made with.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportSettings {
    /// What the scene is called.
    pub name: String,
    /// Camera, size and bounces of the frames; the component does not matter.
    pub frame: FrameSettings,
    /// Paths a pixel of the reference, in two halves; at least 4.
    pub samples: u32,
}

/// What was measured. A chapter that could not be is `None`, and `warnings` says
/// why.
pub(super) struct Measured {
    pub(super) settings: ReportSettings,
    pub(super) figures: SceneFigures,
    pub(super) threads: usize,
    /// Seconds of the bake by the clock.
    pub(super) bake_seconds: f64,
    pub(super) vertices: Option<Vertices>,
    pub(super) sweeps: Option<Sweeps>,
    pub(super) image: Option<Vec<Compared>>,
    /// Empty without glossy materials.
    pub(super) glossy: Vec<GlossyError>,
    pub(super) comparisons: Vec<Block>,
    pub(super) pictures: Vec<Block>,
    pub(super) warnings: Vec<String>,
    /// Seconds of each chapter by the clock.
    pub(super) chapter_seconds: Vec<(&'static str, f64)>,
}

/// Chapter of the vertices.
pub(super) struct Vertices {
    pub(super) truth: Truth,
    /// In the order of [`Scheme::ALL`].
    pub(super) schemes: Vec<SchemeResult>,
    pub(super) paths: Vec<[LightAgainstPaths; 2]>,
}

impl Vertices {
    /// Test lights that bring indirect light.
    pub(super) fn lights_that_arrive(&self) -> usize {
        let noise = self.truth.noise();
        over_lights(&test_lights(&noise[0]), |_| true).lights
    }
}

/// One scheme at the defaults.
pub(super) struct SchemeResult {
    pub(super) settings: BakeSettings,
    pub(super) point: Point,
    pub(super) errors: SchemeErrors,
    pub(super) parts: Parts,
}

/// Chapter of the sweeps.
pub(super) struct Sweeps {
    pub(super) points: Vec<(Swept, Vec<Point>)>,
    /// Rays a vertex of both schemes in the sweeps of functions and coefficients, in
    /// the order of [`Scheme::ALL`].
    pub(super) rays: [u32; 2],
    /// Whether some bake has more than that, which cannot all be kept.
    pub(super) is_reduced: bool,
}

/// Seconds of the chapters of vertices and sweeps, of those of the bake; for a path of
/// the reference; and for a pixel, which is gathered and traced by a few paths on one
/// thread too. On two cores 188 to 228 s for 12,000 vertices (bakes of 16 to 20 s,
/// 512 paths for each of 76,800 pixels), 2,112 s for 77,000 (one of 259 s, beside
/// builds).
const TRANSFER_OF_BAKE: f64 = 7.0;
const SECONDS_A_PATH: f64 = 1e-6;
const SECONDS_A_PIXEL: f64 = 5e-4;

/// About how many seconds a report takes whose bake takes `bake_seconds` for so many
/// vertices, on two threads; `None` where an error is asked for, whose bake nobody
/// knows before it is found.
pub fn report_seconds(
    scene: &Scene,
    settings: &ReportSettings,
    vertices: usize,
    bake_seconds: f64,
) -> Option<f64> {
    let transfer = if vertices > MOST_VERTICES {
        0.0
    } else {
        TRANSFER_OF_BAKE * bake_seconds
    };
    let [width, height] = settings.frame.camera.size;
    let pixels = f64::from(width) * f64::from(height);
    let image = match scene.has_light() {
        true => pixels * (f64::from(settings.samples) * SECONDS_A_PATH + SECONDS_A_PIXEL),
        false => 0.0,
    };
    scene
        .bake
        .error
        .is_none()
        .then_some(bake_seconds + transfer + image)
}

/// Measures a scene; every figure is of this run.
pub(super) fn measure(
    scene: Scene,
    settings: &ReportSettings,
    run: &RunSettings,
) -> Result<Measured, MeasureError> {
    let mut renderer = Renderer::new(scene, None);
    let mut clock = Chapters::default();
    let bake_seconds = {
        let start = Instant::now();
        renderer.bake(run)?;
        start.elapsed().as_secs_f64()
    };
    clock.next("bake");
    let mut warnings = renderer.take_warnings();
    warnings.extend(Scheme::Paper.warning());
    let (vertices, sweeps) =
        transfer_chapters(&renderer, bake_seconds, &mut warnings, &mut clock, run)?;
    let has_light = renderer.scene().has_light();
    let mut comparisons = Vec::new();
    let image = if has_light {
        let found =
            frame_errors::against_paths(&mut renderer, &settings.frame, settings.samples, run)?;
        for compared in &found {
            comparisons.push(pictures::comparison(renderer.scene(), compared)?);
        }
        Some(found)
    } else {
        warnings.push("the scene has no light: frames are not compared with paths".to_owned());
        None
    };
    clock.next("image");
    let glossy = if has_light {
        glossy::by_roughness(&mut renderer, &settings.frame, settings.samples, run)?
    } else {
        Vec::new()
    };
    clock.next("glossy");
    let pictures = pictures::components(&mut renderer, &settings.frame, has_light, run)?;
    clock.next("pictures");
    Ok(Measured {
        settings: settings.clone(),
        figures: renderer.figures(),
        #[allow(
            clippy::disallowed_methods,
            reason = "said in the report, used nowhere"
        )]
        threads: rayon::current_num_threads(),
        bake_seconds,
        vertices,
        sweeps,
        image,
        glossy,
        comparisons,
        pictures,
        warnings,
        chapter_seconds: clock.seconds,
    })
}

/// Clock of the chapters.
struct Chapters {
    since: Instant,
    seconds: Vec<(&'static str, f64)>,
}

impl Default for Chapters {
    fn default() -> Self {
        Self {
            since: Instant::now(),
            seconds: Vec::new(),
        }
    }
}

impl Chapters {
    /// What went by since the last chapter belongs to this one.
    fn next(&mut self, chapter: &'static str) {
        self.seconds
            .push((chapter, self.since.elapsed().as_secs_f64()));
        self.since = Instant::now();
    }
}

/// The chapters that look at the transfer itself.
fn transfer_chapters(
    renderer: &Renderer,
    bake_seconds: f64,
    warnings: &mut Vec<String>,
    clock: &mut Chapters,
    run: &RunSettings,
) -> Result<(Option<Vertices>, Option<Sweeps>), MeasureError> {
    let (surface, bake) = renderer.transfer();
    let bake = bake.expect("the renderer has baked");
    let count = surface.vertices.len();
    if count > MOST_VERTICES {
        warnings.push(format!(
            "{count} vertices are too many for the chapters of vertices and sweeps, which end at \
             {MOST_VERTICES}; set bake.max_edge to a longer edge to have them"
        ));
        return Ok((None, None));
    }
    let rays = kept_rays(count);
    let start = Instant::now();
    let surface = Study::surface(renderer.scene(), bake, rays, run)?;
    let seconds_a_ray = start.elapsed().as_secs_f64() / f64::from(rays);
    let study = Study::new(&surface, bake, run)?;
    if !study.has_bounces() {
        warnings
            .push("no surface of the scene sees another: there is no indirect light".to_owned());
        return Ok((None, None));
    }
    let albedo = vertex_albedo(renderer.scene(), &surface);
    let cost = Cost {
        most_rays: rays,
        seconds_a_ray,
        bake_seconds,
    };
    let subject = (renderer.scene(), bake, &albedo[..]);
    let found = vertices(&study, &surface, subject, &cost, run)?;
    let lights = found.lights_that_arrive();
    if lights < LEAST_LIGHTS {
        warnings.push(format!(
            "only {lights} of the test lights bring indirect light: means over them say less than \
             they should"
        ));
    }
    clock.next("vertices");
    let sweeps = sweeps(&study, &found, &cost, run)?;
    clock.next("sweeps");
    Ok((Some(found), Some(sweeps)))
}

/// What the bakes of a study cost, and keep.
struct Cost {
    /// Rays a vertex that are kept.
    most_rays: u32,
    /// What tracing one from every vertex took, in the mean, with the preparation of the
    /// surface.
    seconds_a_ray: f64,
    /// Of the scene's own bake.
    bake_seconds: f64,
}

/// Rays a vertex that are kept of so many vertices: the most that the sweep of rays
/// asks for within [`KEPT_BYTES`], or the least of it.
fn kept_rays(vertices: usize) -> u32 {
    let bytes = |rays: u32| KeptArrivals::bytes_of(vertices as u64 * u64::from(rays));
    let fits = |&rays: &u32| bytes(rays) + bytes(ROW_RAYS) <= KEPT_BYTES;
    RAYS.into_iter().rev().find(fits).unwrap_or(RAYS[0])
}

fn vertices(
    study: &Study,
    surface: &Surface,
    (scene, bake, albedo): (&Scene, &Bake, &[Vec3]),
    cost: &Cost,
    run: &RunSettings,
) -> Result<Vertices, BakeError> {
    let grey = albedo.iter().map(|rho| rho.element_sum() / 3.0).collect();
    let truth = Truth::find(study, surface, bake, grey, run)?;
    let sweeper = Sweeper {
        study,
        truth: &truth,
        most_rays: cost.most_rays,
        seconds_a_ray: cost.seconds_a_ray,
    };
    let mut settings = Vec::new();
    let mut made = Vec::new();
    for scheme in Scheme::ALL {
        let asked = BakeSettings::of_scheme(scheme, &scene.bake);
        let found = study.found(&asked, run)?;
        // A study has the transfer of any bake of its settings, and this one is there.
        made.push(match scheme == bake.stats().scheme {
            true => None,
            false => Some(sweeper.timed_bake(&found, run)?),
        });
        settings.push(found);
    }
    let made = [0, 1].map(|scheme: usize| match &made[scheme] {
        Some((bake, seconds)) => (bake, *seconds),
        None => (bake, cost.bake_seconds),
    });
    let mut schemes = Vec::new();
    for (settings, (bake, seconds)) in settings.into_iter().zip(made) {
        let parts = truth.parts(study, bake, &settings, run)?;
        let point = Point {
            is_default: true,
            uncut: Some(parts.uncut()),
            ..sweeper.point(bake, &settings, seconds, run)
        };
        schemes.push(SchemeResult {
            settings,
            point,
            errors: truth.scheme(bake, run),
            parts,
        });
    }
    let subject = Subject {
        scene,
        surface,
        bakes: made.map(|(bake, _)| bake),
        albedo,
    };
    let sampling = truth.vertex_sampling_by_light();
    let paths = paths::against_paths(&subject, &truth.lights, &sampling, run)?;
    Ok(Vertices {
        truth,
        schemes,
        paths,
    })
}

/// The sweeps, whose points share the rays that the study keeps.
/// Where the defaults have more, functions and coefficients start from the same
/// settings with as few.
fn sweeps(
    study: &Study,
    vertices: &Vertices,
    cost: &Cost,
    run: &RunSettings,
) -> Result<Sweeps, BakeError> {
    let sweeper = Sweeper {
        study,
        truth: &vertices.truth,
        most_rays: cost.most_rays,
        seconds_a_ray: cost.seconds_a_ray,
    };
    let (mut defaults, mut starts) = (Vec::new(), Vec::new());
    for scheme in &vertices.schemes {
        defaults.push((scheme.settings, scheme.point));
        if scheme.settings.rays <= cost.most_rays {
            starts.push((scheme.settings, scheme.point));
        } else {
            let settings = BakeSettings {
                rays: cost.most_rays,
                ..scheme.settings
            };
            starts.push((settings, sweeper.start(&settings, run)?));
        }
    }
    let points = Swept::ALL.into_iter().map(|swept| {
        let from = if swept == Swept::Rays {
            &defaults
        } else {
            &starts
        };
        Ok((swept, sweeper.sweep(swept, from, run)?))
    });
    Ok(Sweeps {
        points: points.collect::<Result<_, BakeError>>()?,
        rays: [0, 1].map(|scheme| starts[scheme].0.rays),
        is_reduced: (0..2).any(|scheme| starts[scheme].0.rays < defaults[scheme].0.rays),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_pointer_width = "64")]
    #[test]
    fn rays_that_are_kept_fit_into_memory() {
        let found = [
            1,
            43_596,
            43_597,
            76_293,
            76_294,
            122_070,
            122_071,
            MOST_VERTICES,
        ];
        let rays = [6144, 6144, 3072, 3072, 1536, 1536, 768, 768];
        assert_eq!(found.map(kept_rays), rays);
        assert_eq!(kept_rays(10_000_000), 384, "the least, whatever it takes");
    }
}
