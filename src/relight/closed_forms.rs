//! Light whose answer is known in closed form: the solver against physics,
//! not against itself. Every test prints its figures (`--nocapture`).
//!
//! | file | what is known |
//! |---|---|
//! | `enclosures` | furnace, one emitting face, hollow sphere, cube with a lamp |
//! | `operator` | linearity, boundedness, energy, rows, convergence of "all" |
//! | `sides` | what must stay exactly dark, and which backs exist |
//! | `direct_flux` | the light that a plane catches |
//! | `placement` | rooms far away, tiny and huge |
//! | `kept` | incremental frames have the bits of fresh ones |
//! | `basis` | direct light after projection, partitions and functions in colours |
//! | `borders` | partitions cannot be seen |
//! | `area` | rectangles, spots and parallel light on planes |
//! | `emitters` | walls that glow, lamps of triangles, ten thousand of them |
//! | `sky` | a constant sky over a plane and into a box |
//! | `maps` | maps of the sky, how they are turned, and their suns |
//! | `textures` | what a map on a surface is on average |
//! | `relit` | lamps and materials changed from frame to frame |
//! | `finite` | what has no meaning makes no frame that has none |

mod area;
mod basis;
mod borders;
mod direct_flux;
mod emitters;
mod enclosures;
mod finite;
mod kept;
mod maps;
mod operator;
mod placement;
mod relit;
mod sides;
mod sky;
mod textures;

use glam::{DVec3, Vec3};

use super::bounces::Transport;
use super::kept::KeptDirect;
use super::{Component, FrameSettings, Renderer};
use crate::bake::{Bake, BakeSettings, RunSettings, load_or_bake};
use crate::frame::Image;
use crate::scene::{Bounces, Light, PlacedLights, Placement, Scene};
use crate::simd::Level;
use crate::surface::{Detail, Surface};

/// A scene with its bake, and what the solver can be asked.
struct Baked {
    surface: Surface,
    bake: Bake,
}

impl Baked {
    fn new(scene: &Scene) -> Self {
        let mut surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
        let settings = BakeSettings::of_keys(&scene.bake);
        let bake = load_or_bake(&mut surface, &settings, None, &RunSettings::silent())
            .expect("nobody stops it and every part has a basis")
            .bake;
        Self { surface, bake }
    }

    fn transport(&self) -> Transport<'_> {
        Transport {
            bake: &self.bake,
            level: Level::detect(),
        }
    }

    fn vertex_count(&self) -> usize {
        self.surface.vertices.len()
    }

    /// Vertices of the front sides.
    fn fronts(&self) -> std::ops::Range<usize> {
        0..self.surface.vertices.front_count()
    }

    fn area(&self, vertex: usize) -> f64 {
        f64::from(self.surface.vertices.areas()[vertex])
    }

    fn normal(&self, vertex: usize) -> Vec3 {
        self.surface.vertices.normals()[vertex]
    }

    /// Position of a vertex, file units.
    fn position(&self, vertex: usize) -> DVec3 {
        let placed = self.surface.vertices.positions()[vertex];
        self.surface.placement.file_from_placed(placed)
    }

    /// Direct irradiance at the vertices.
    fn direct(&self, lights: &[Light]) -> Vec<Vec3> {
        let placed = PlacedLights::of_file(lights, &self.surface.placement);
        let mut kept = KeptDirect::default();
        kept.update(&self.surface, Level::detect(), &placed);
        kept.sum(self.vertex_count())
    }

    /// Irradiance of the skies among the lights at the vertices; empty without.
    fn sky(&self, lights: &[Light]) -> Vec<Vec3> {
        let placed = PlacedLights::of_file(lights, &self.surface.placement);
        let mut kept = KeptDirect::default();
        kept.sky(&self.surface, &self.bake, Level::detect(), &placed.skies)
            .to_vec()
    }

    /// Indirect irradiance under one albedo for all vertices.
    fn solve(&self, source: &[Vec3], albedo: f32, bounces: Bounces) -> Vec<Vec3> {
        let albedo = vec![Vec3::splat(albedo); self.vertex_count()];
        let solved = self.transport().solve(source, &albedo, bounces);
        solved.expect("light that decays has a limit")
    }

    /// T~ applied once to a radiosity at the vertices, by vertex.
    fn apply(&self, radiosity: &[Vec3]) -> Vec<Vec3> {
        self.solve(radiosity, 0.0, Bounces::Count(1))
    }

    /// Indirect irradiance of lights under one albedo.
    fn indirect(&self, lights: &[Light], albedo: f32, bounces: Bounces) -> Vec<Vec3> {
        let source: Vec<Vec3> = self.direct(lights).iter().map(|&e| e * albedo).collect();
        self.solve(&source, albedo, bounces)
    }
}

/// A frame of a scene as its file asks for it.
fn frame_of(scene: &Scene, component: Component) -> Image {
    let [image] = frames_of(scene, [component]);
    image
}

/// The same of several components, by one bake.
fn frames_of<const N: usize>(scene: &Scene, components: [Component; N]) -> [Image; N] {
    let mut renderer = Renderer::new(scene.clone(), None);
    components.map(|component| {
        let settings = FrameSettings {
            component,
            ..FrameSettings::of_scene(scene)
        };
        let frame = renderer.frame(&settings, &RunSettings::silent());
        frame.expect("the scene has a frame").image
    })
}

/// Where the ray through a place of the picture (pixels, row 0 on top) meets the
/// plane on which a coordinate has a value, file units.
fn seen_on_plane(scene: &Scene, [x, y]: [f64; 2], axis: usize, value: f64) -> DVec3 {
    let as_it_is = Placement {
        center: DVec3::ZERO,
        scale: 1.0,
        extent: 1.0,
    };
    let camera = scene.camera.place(&as_it_is);
    let direction = camera.direction(x, y).as_dvec3();
    camera.eye + direction * ((value - camera.eye[axis]) / direction[axis])
}

/// How values are spread about what they should be, weighted by area.
#[derive(Debug, Default)]
struct Deviation {
    /// Relative to the root mean square of what they should be.
    mean: f64,
    rms: f64,
    /// Largest deviation of one value.
    worst: f64,
}

impl Deviation {
    /// Of (weight, value, what it should be).
    fn of(values: impl Iterator<Item = (f64, f64, f64)>) -> Self {
        let (mut weights, mut sum, mut squares, mut norm, mut worst) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (weight, value, wanted) in values {
            let off = value - wanted;
            weights += weight;
            sum += weight * off;
            squares += weight * off * off;
            norm += weight * wanted * wanted;
            worst = f64::max(worst, off.abs());
        }
        assert!(weights > 0.0, "there is nothing to compare");
        let scale = (norm / weights).sqrt();
        Self {
            mean: sum / weights / scale,
            rms: (squares / weights).sqrt() / scale,
            worst: worst / scale,
        }
    }
}

/// Prints a figure beside its limit and insists on it.
#[allow(clippy::print_stderr, reason = "figures are read with --nocapture")]
fn at_most(what: &str, figure: f64, limit: f64) {
    eprintln!("{what}: {figure:.3e} (at most {limit:.1e})");
    assert!(figure <= limit, "{what}: {figure:e} is more than {limit:e}");
}
