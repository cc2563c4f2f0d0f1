//! Light whose answer is known in closed form: the solver against physics,
//! not against itself. Every test prints its figures (`--nocapture`).
//!
//! | file | what is known |
//! |---|---|
//! | `enclosures` | furnace, one emitting face, cube with a lamp |
//! | `point_kernel` | what a furnace alone does not see |
//! | `spheres` | a bounce inside a sphere is the same everywhere |
//! | `plates` | form factors of rectangles, light between plates |
//! | `operator` | linearity, boundedness, energy, rows, convergence of "all" |
//! | `sides` | what must stay exactly dark, and which backs exist |
//! | `contacts` | walls that meet, cracks, meshes of unequal fineness |
//! | `dark` | pictures without light |
//! | `direct_flux` | the light that a plane catches |
//! | `placement` | rooms far away, tiny and huge |
//! | `kept` | incremental frames have the bits of fresh ones |
//! | `basis` | direct light after projection, partitions and functions in colours |
//! | `borders` | partitions cannot be seen |
//! | `clamped` | what a basis rings below zero |
//! | `area` | rectangles, spots and parallel light on planes |
//! | `emitters` | walls that glow, lamps of triangles, ten thousand of them |
//! | `sky` | a constant sky over a plane and into a box |
//! | `maps` | maps of the sky, how they are turned, and their suns |
//! | `textures` | what a map on a surface is on average |
//! | `relit` | lamps and materials changed from frame to frame |
//! | `messy` | files and faces as other programs leave them |
//! | `gather` | sky, furnace and sphere by rays of the pixels' own |
//! | `glossy` | furnaces of lobes, slices against paths |
//! | `finite` | what has no meaning makes no frame that has none |
//!
//! Where the answer to a known hard case is tested, here and elsewhere;
//! `case_table` checks the names, and that none is ignored.
//!
//! | case | tests |
//! |---|---|
//! | furnace Le / (1 - rho) | `a_furnace_glows_evenly` |
//! | ... of emitting walls | `a_furnace_of_emitting_walls_is_le_over_1_minus_rho` |
//! | ... rho = 1 | `albedo_one_in_a_closed_room_has_no_limit` |
//! | row sums, closed | `closed_rooms_keep_their_rays` |
//! | row sums, open | `constant_light_is_the_share_of_rays_that_arrive` |
//! | ... as stored | `stored_rows_answer_constant_light_like_sampled_ones` |
//! | furnace's pair | `one_emitting_face_lights_the_others_as_form_factors_say` |
//! | point kernel | `a_furnace_passes_a_wrong_kernel_that_one_face_betrays` |
//! | sphere, any light | `a_hollow_sphere_is_lit_evenly_from_anywhere` |
//! | sphere, form factors | `patches_of_a_sphere_see_each_other_by_their_area` |
//! | cube of 10 m | `a_cube_with_a_lamp_in_its_centre_has_the_published_luminance` |
//! | unit squares | `two_unit_squares_exchange_a_fifth` |
//! | ... as lights | `perpendicular_squares_exchange_a_fifth` |
//! | wide plates | `light_between_wide_plates_is_a_geometric_series` |
//! | point to polygon | `any_polygon_agrees_with_quadrature` |
//! | ... at the horizon | `the_horizon_cuts_a_rectangle_above_a_wall` |
//! | half of the flux, also far below an edge | `a_wide_plane_catches_half_the_flux` |
//! | 200 bounces | `two_hundred_bounces_stay_bounded` |
//! | box on a floor | `nothing_is_lit_inside_a_box_on_the_floor` |
//! | ... open below | `backs_of_a_standing_box_are_dark` |
//! | thin wall | `a_room_that_shares_no_triangle_with_a_lit_one_is_black` |
//! | ... in pictures | `a_room_beside_a_lit_one_is_black_in_pictures` |
//! | ... on a common floor | `little_light_passes_below_a_wall_on_a_common_floor` |
//! | wall ten times finer | `a_wall_ten_times_finer_changes_nothing` |
//! | T-junctions, cracks | `cracks_let_next_to_no_ray_out` |
//! | faces of no meaning | `faces_without_meaning_leave_a_finite_picture` |
//! | ... doubled, flat | `doubled_and_flat_faces_change_no_pixel` |
//! | ... told with a line | `broken_faces_are_dropped_with_one_warning_a_kind` |
//! | 200 boxes | `constant_light_is_reproduced_on_each_of_200_boxes` |
//! | planes 1e-4 apart | `planes_that_nearly_touch_see_nothing_else` |
//! | a plane alone | `a_plane_alone_sees_nothing` |
//! | room moved, scaled | `a_room_looks_the_same_anywhere_and_at_any_size` |
//! | files of all kinds | `a_messy_file_is_the_picture_of_a_clean_one` |
//! | lit from one side | `the_dark_side_of_a_sheet_is_black` |
//! | ... in pictures | `the_back_of_a_lit_sheet_is_black_in_pictures` |
//! | ... from both | `each_side_of_a_sheet_has_its_own_light` |
//! | equal eigenvalues | `projector_of_a_square_grid` |
//! | ... clusters | `no_cluster_is_cut` |
//! | ... signs | `the_largest_entry_is_positive` |
//! | partition borders | `usual_jumps_at_borders_are_like_those_inside` |
//! | ... with blocks | `a_border_adds_no_jump_to_those_of_the_light` |
//! | partitions renamed | `renaming_partitions_changes_no_light` |
//! | linearity | `bounced_light_is_linear` |
//! | ... folded | `folded_bounces_are_linear` |
//! | ... of skies | `light_of_skies_adds_up` |
//! | light off | `no_light_is_exactly_no_light` |
//! | ... in pictures | `lights_of_no_brightness_leave_pictures_black` |
//! | ... switched off | `a_light_that_is_switched_off_leaves_nothing` |
//! | 10,000 moves | `ten_thousand_moves_leave_no_trace` |
//! | albedo edit | `an_edited_albedo_gives_the_frame_of_a_fresh_scene_without_a_bake` |
//! | negative light | `light_below_zero_reaches_no_pixel_and_is_counted` |
//! | ... of skies | `light_of_a_sky_below_zero_reaches_no_pixel_and_is_counted` |
//! | ... by lobes | `light_of_lobes_below_zero_reaches_no_pixel_and_is_counted` |
//! | ... gathered | `no_gathered_pixel_is_below_zero` |
//! | ... reported | `pixels_below_zero_are_reported` |
//! | threads, levels | `tiny` |
//! | final gather | `gathering_in_a_furnace_finds_its_series` |
//! | ... in a sphere | `gathering_in_a_sphere_finds_even_light` |
//! | another renderer | `relume_agrees_with_mitsuba` |

mod area;
mod basis;
mod borders;
mod case_table;
mod clamped;
mod contacts;
mod dark;
mod direct_flux;
mod emitters;
mod enclosures;
mod finite;
mod folded;
mod gather;
mod glossy;
mod kept;
mod maps;
mod messy;
mod operator;
mod placement;
mod plates;
mod point_kernel;
mod relit;
mod sides;
mod sky;
mod spheres;
mod textures;

use glam::{DVec3, Vec3};

use super::bounces::Transport;
use super::kept::{KeptDirect, OnVertices};
use super::{Component, Effort, FrameSettings, Renderer};
use crate::bake::{Bake, BakeSettings, RunSettings, Silent, load_or_bake};
use crate::frame::Image;
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{Bounces, Light, PlacedLights, Placement, Scene};
use crate::simd::Level;
use crate::surface::{Detail, Surface};

/// Points of a vertex's area in a mean over it, and their seed, which is no
/// stage's own.
const AREA_POINTS: u32 = 64;
const AREA_SEED: u32 = 0xc105;

/// A scene with its bake, and what the solver can be asked.
struct Baked {
    surface: Surface,
    bake: Bake,
}

impl Baked {
    fn new(scene: &Scene) -> Self {
        let mut surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
        let settings = BakeSettings::of_keys(&scene.bake);
        let bake = load_or_bake(&mut surface, &settings, None, None, &RunSettings::silent())
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

    /// Mean over a vertex's area of a function of place (file units) and normal.
    fn area_mean(&self, vertex: usize, of: impl Fn(DVec3, DVec3) -> f64) -> f64 {
        let set = ScrambledSobol::new(AREA_SEED, vertex as u32);
        let at = |index: u32| {
            let point = self.surface.sample_point(vertex, set.point2(index));
            let position = self.surface.placement.file_from_placed(point.position);
            of(position, point.normal.as_dvec3())
        };
        (0..AREA_POINTS).map(at).sum::<f64>() / f64::from(AREA_POINTS)
    }

    /// Direct irradiance at the vertices.
    fn direct(&self, lights: &[Light]) -> Vec<Vec3> {
        let placed = PlacedLights::of_file(lights, &self.surface.placement);
        let mut kept = KeptDirect::default();
        update(&mut kept, &self.surface, &placed);
        kept.sum(self.vertex_count()).0.to_vec()
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
        self.solve_by(source, |_| albedo, bounces)
    }

    /// The same under an albedo by vertex.
    fn solve_by(
        &self,
        source: &[Vec3],
        albedo: impl Fn(usize) -> f32,
        bounces: Bounces,
    ) -> Vec<Vec3> {
        let albedo: Vec<Vec3> = (0..self.vertex_count())
            .map(|v| Vec3::splat(albedo(v)))
            .collect();
        let solved = self.transport().solve(source, &albedo, bounces);
        let solved = solved.map(|solution| solution.irradiance);
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

/// Brings lights at the vertices up to date, exactly; returns how many were new.
fn update(kept: &mut KeptDirect, surface: &Surface, lights: &PlacedLights) -> usize {
    let job = OnVertices {
        surface,
        level: Level::detect(),
        effort: Effort::Full,
        progress: &Silent,
    };
    kept.update(&job, lights).expect("nobody stops it")
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
            worst = largest([worst, off.abs()]);
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

/// The largest of some magnitudes. None at all, or one that is not a number (which
/// `f64::max` passes over), would make a fault look like a perfect match.
fn largest(magnitudes: impl IntoIterator<Item = f64>) -> f64 {
    magnitudes
        .into_iter()
        .inspect(|magnitude| assert!(!magnitude.is_nan(), "a figure is not a number"))
        .reduce(f64::at_least)
        .expect("there is a figure to look at")
}

#[test]
#[should_panic(expected = "not a number")]
fn what_is_not_a_number_is_no_match() {
    largest([f64::NAN, 1.0]);
}

#[test]
#[should_panic(expected = "figure to look at")]
fn nothing_is_no_match() {
    largest([]);
}

/// Prints a figure beside its limit and insists on it.
#[allow(clippy::print_stderr, reason = "figures are read with --nocapture")]
fn at_most(what: &str, figure: f64, limit: f64) {
    eprintln!("{what}: {figure:.3e} (at most {limit:.1e})");
    assert!(figure <= limit, "{what}: {figure:e} is more than {limit:e}");
}

/// The same for a figure that must not be small: what a test has to see.
#[allow(clippy::print_stderr, reason = "figures are read with --nocapture")]
fn at_least(what: &str, figure: f64, limit: f64) {
    eprintln!("{what}: {figure:.3e} (at least {limit:.1e})");
    assert!(figure >= limit, "{what}: {figure:e} is less than {limit:e}");
}
