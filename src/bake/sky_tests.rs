//! The sky in a bake: none in a closed scene, constant skies kept, and small
//! windows against brute force.

use super::file::encode;
use super::key::BakeKey;
use super::operator::{receiver_groups, vertices_of};
use super::response_tests::{baked, stored_response};
use super::transfer::{Sampling, sample_group};
use super::*;
use crate::maths::cube_cells::CELL_COUNT;
use crate::maths::order::Order;
use crate::maths::sobol::ScrambledSobol;
use crate::scene::sample_scenes::{cube_room, room_with_blocks, room_with_window, separate_boxes};
use glam::Vec3;

/// Response of the stored rows to a constant sky against the sampled share.
const RESPONSE: f64 = 1e-6;
/// Shares of the sky through a small window, and the relative noise (root mean
/// square) that their vertices may have. Aiming asks for 3 %; in rooms as coarse
/// as these a few rows of the smallest shares are left whose cells no other row
/// of their group has found: measured 10 %, 5 % and 5 %.
const NOISE: [(std::ops::Range<f64>, f64); 3] = [
    (0.001..0.002, 0.15),
    (0.002..0.004, 0.08),
    (0.004..0.3, 0.06),
];
/// Mean over all vertices of a room, relative: three times the standard error
/// of hundreds of vertices of 8 % of noise.
const WINDOW_BIAS: f64 = 0.01;
/// Half sides of windows, 1 % and 16 % of a wall, and the mesh's longest edge (of
/// 0.5 m, rows of a group see a small window too far apart: 43 % of noise).
const WINDOWS: [(f64, f64); 2] = [(0.1, 0.33), (0.4, 0.5)];
/// Rays a vertex of the brute force, aimed at the window: as many as a
/// row's, but none goes astray: without aim 250 to 1,000 times as many.
const BRUTE_RAYS: u32 = 1_024;
/// Bytes of a bake's file.
fn file_length(bake: &Bake) -> usize {
    encode(bake, &BakeKey::from_bytes([0; 32])).len()
}

/// Light of a sky of H = 1 at the vertices; what nothing hides it from sees
/// `unhidden`.
fn light_of_sky(bake: &Bake, unhidden: f32) -> Vec<f32> {
    let cells = [[1.0; 3]; CELL_COUNT];
    let in_slots = bake.sky_irradiance(Level::detect(), &cells, |_| [unhidden; 3]);
    let slots = bake.basis.slot_of_vertex().iter();
    slots.map(|&slot| in_slots[slot as usize][0]).collect()
}

/// The outside of a convex room sees nothing else, and pays for no rows either.
#[test]
fn a_closed_scene_has_no_byte_for_the_sky() {
    for (name, scene) in [
        ("closed room", room_with_blocks(true, 0.25, 128)),
        ("cube", cube_room(2.0, 0.25, 128)),
    ] {
        let (surface, bake) = baked(&scene);
        assert!(bake.sky.is_none(), "{name}: rows of the sky");
        assert_eq!(bake.sky_bytes(), 0);
        let inside = surface.vertices.front_count();
        let light = light_of_sky(&bake, 7.0);
        let lit = light[..inside].iter().filter(|&&e| e != 0.0).count();
        assert_eq!(lit, 0, "{name}: vertices inside that see the sky");
        let hidden = light[inside..].iter().filter(|&&e| e != 7.0).count();
        assert_eq!(hidden, 0, "{name}: vertices outside that do not");
        assert!(light.len() > inside, "{name}: it has an outside");
    }
}

#[test]
fn a_sky_is_the_end_of_its_file() {
    let (_, bake) = baked(&room_with_blocks(false, 0.25, 128));
    let without = Bake {
        sky: None,
        ..bake.clone()
    };
    let more = file_length(&bake) - file_length(&without);
    assert!(more >= bake.sky_bytes(), "the sky is not in the file");
    // The lengths of the lists, and what is not counted as rows.
    let rest = more - bake.sky_bytes();
    assert!(rest < bake.sky_bytes(), "{rest} bytes more than the sky's");
    assert_eq!(without.sky_bytes(), 0);
    let dark = light_of_sky(&without, 0.0).iter().all(|&e| e == 0.0);
    assert!(dark, "light of a sky that is not there");
}

#[test]
fn a_constant_sky_is_answered_as_it_was_sampled() {
    for (name, scene) in [
        ("open room", room_with_blocks(false, 0.25, 256)),
        ("boxes", separate_boxes(1.0, 64)),
        ("window", room_with_window(0.1, true, 0.5, 256)),
    ] {
        let (surface, bake) = baked(&scene);
        let level = Level::detect();
        let sampling = Sampling {
            surface: &surface,
            level,
            slot_of_vertex: bake.basis.slot_of_vertex(),
            rays: bake.stats.rays,
        };
        let constant = sky::basis().constant(level);
        let rows = bake.sky.as_ref().expect("the scene is open").rows();
        let mut scratch = transfer::Scratch::new(bake.basis.slot_count());
        let (mut worst, mut largest_share) = (0.0_f64, 0.0_f64);
        for (index, group) in receiver_groups(&bake.basis).into_iter().enumerate() {
            let sampled = sample_group(&sampling, vertices_of(&bake.basis, group), &mut scratch);
            let stored = stored_response(rows, index, &constant);
            for lane in 0..group.1 as usize {
                let shares = sampled
                    .sky
                    .iter()
                    .map(|(_, shares)| f64::from(shares[lane]));
                // Where nothing hides the sky, no row says so.
                let share: f64 = if sampled.sees_only_sky() {
                    0.0
                } else {
                    shares.sum()
                };
                worst = worst.at_least((stored[lane] - share).abs());
                largest_share = largest_share.at_least(share);
            }
        }
        assert!(largest_share > 0.01, "{name}: no vertex sees the sky");
        assert!(worst <= RESPONSE, "{name}: a row is {worst:e} off");
    }
}

/// Share of a vertex's light that comes through a window, by rays from its area
/// to the window's.
fn brute_share(surface: &Surface, half_window: f64, vertex: usize) -> f64 {
    let points = ScrambledSobol::new(0xb07e, vertex as u32);
    let scale = surface.placement.scale as f32;
    let half = half_window as f32 * scale;
    let area = 4.0 * half * half;
    let mut sum = 0.0;
    for index in 0..BRUTE_RAYS {
        let u = points.point(index);
        let from = surface.sample_point(vertex, [u[0], u[1]]);
        let [y, z] = [u[2], u[3]].map(|x| (2.0 * x - 1.0) * half);
        let to_window = Vec3::new(scale, y, z) - from.position;
        let squared = to_window.length_squared();
        let direction = to_window / squared.sqrt();
        let cosines = direction.dot(from.normal).at_least(0.0) * direction.x.at_least(0.0);
        if cosines > 0.0 && surface.arrival(Level::detect(), &from, direction).is_none() {
            sum += f64::from(cosines * area / (std::f32::consts::PI * squared));
        }
    }
    sum / f64::from(BRUTE_RAYS)
}

/// What the bake says of the sky's share at the vertices of the room, over what
/// brute force says, and the latter.
fn window_ratios(half_window: f64, max_edge: f64) -> Vec<[f64; 2]> {
    let (surface, bake) = baked(&room_with_window(half_window, true, max_edge, 1024));
    assert_eq!(surface.placement.center, glam::DVec3::ZERO);
    let light = light_of_sky(&bake, 1.0);
    (0..surface.vertices.front_count())
        .into_par_iter()
        .map(|v| {
            let found = light[v];
            let wanted = brute_share(&surface, half_window, v);
            [f64::from(found) / wanted, wanted]
        })
        .collect()
}

/// Number of ratios, their mean and their root mean square difference from 1.
fn spread(ratios: &[[f64; 2]], shares: &std::ops::Range<f64>) -> (usize, f64, f64) {
    let within = ratios.iter().filter(|[_, share]| shares.contains(share));
    let offs: Vec<f64> = within.map(|[ratio, _]| ratio - 1.0).collect();
    let count = offs.len().max(1) as f64;
    let mean = offs.iter().sum::<f64>() / count;
    let squares: f64 = offs.iter().map(|off| off * off).sum();
    (offs.len(), mean, (squares / count).sqrt())
}

#[test]
#[allow(clippy::print_stderr, reason = "figures are read with --nocapture")]
fn small_windows_are_found() {
    for (half_window, max_edge) in WINDOWS {
        let ratios = window_ratios(half_window, max_edge);
        let name = format!("window of {} m", 2.0 * half_window);
        for (shares, limit) in NOISE {
            let (count, mean, noise) = spread(&ratios, &shares);
            eprintln!(
                "{name}, shares {shares:?}: {count} vertices, mean {mean:+.4}, noise {noise:.4}"
            );
            assert!(noise <= limit, "{name}, shares {shares:?}: noise {noise}");
        }
        let (count, mean, _) = spread(&ratios, &(NOISE[0].0.start..NOISE[2].0.end));
        eprintln!("{name}: {count} vertices, mean {mean:+.5}");
        assert!(count > 50, "{name}: {count} vertices see the window");
        assert!(mean.abs() <= WINDOW_BIAS, "{name}: bias {mean}");
    }
}
