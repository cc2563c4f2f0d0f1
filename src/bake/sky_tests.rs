//! The sky in a bake: none in a closed scene, constant skies kept, and small
//! windows against brute force.

use super::file::encode;
use super::key::BakeKey;
use super::operator::{receiver_groups, vertices_of};
use super::response_tests::{baked, stored_response};
use super::transfer::{Sampling, sample_group};
use super::*;
use crate::maths::cube_cells::CELL_COUNT;
use crate::maths::sobol::ScrambledSobol;
use crate::scene::Scene;
use crate::scene::sample_scenes::{cube_room, room_with_blocks, room_with_window, separate_boxes};
use glam::Vec3;

/// Response of the stored rows to a constant sky against the sampled share.
const RESPONSE: f64 = 1e-6;
/// Noise at the vertices, relative, root mean square: what aiming asks for is
/// 3 %, of what the first batch of rays says of itself.
const WINDOW_NOISE: f64 = 0.04;
/// Mean over all vertices, relative: the noise of hundreds averaged.
const WINDOW_BIAS: f64 = 5e-3;
/// Shares of the sky at which a window is small and still worth its light.
const SHARES: std::ops::RangeInclusive<f64> = 0.001..=0.3;
/// Rays a vertex of the brute force, aimed at the window: 64 times a row's.
const BRUTE_RAYS: u32 = 16_384;
/// Half a side of the window: 1 % of its wall.
const HALF_WINDOW: f64 = 0.1;
/// Every so many vertices are compared.
const STRIDE: usize = 3;

/// Bytes of a bake's file.
fn file_length(bake: &Bake) -> usize {
    encode(bake, &BakeKey::from_bytes([0; 32])).len()
}

#[test]
fn only_open_scenes_pay_for_a_sky() {
    for (name, scene, is_open) in [
        ("closed room", room_with_blocks(true, 0.25, 128), false),
        ("cube", cube_room(2.0, 0.25, 128), false),
        ("open room", room_with_blocks(false, 0.25, 128), true),
        ("boxes", separate_boxes(1.0, 128), true),
    ] {
        let (_, bake) = baked(&scene);
        assert_eq!(bake.sky.is_some(), is_open, "{name}");
        assert_eq!(bake.sky_bytes() > 0, is_open, "{name}: bytes of the sky");
        let without = Bake {
            sky: None,
            ..bake.clone()
        };
        let more = file_length(&bake) - file_length(&without);
        if is_open {
            assert!(
                more >= bake.sky_bytes(),
                "{name}: the sky is not in the file"
            );
        } else {
            assert_eq!(more, 0, "{name}: the file has bytes for a sky");
            let none = bake.sky_irradiance(Level::detect(), &[[1.0; 3]; CELL_COUNT]);
            assert!(none.is_none(), "{name}: light of a sky that is shut out");
        }
    }
}

#[test]
fn a_constant_sky_is_answered_as_it_was_sampled() {
    for (name, scene) in [
        ("open room", room_with_blocks(false, 0.25, 256)),
        ("boxes", separate_boxes(1.0, 128)),
        ("window", room_with_window(HALF_WINDOW, true, 0.4, 256)),
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
                let share: f64 = shares.sum();
                worst = worst.max((stored[lane] - share).abs());
                largest_share = largest_share.max(share);
            }
        }
        assert!(largest_share > 0.01, "{name}: no vertex sees the sky");
        assert!(worst <= RESPONSE, "{name}: a row is {worst:e} off");
    }
}

/// Share of a vertex's light that comes through the window, by rays from its
/// area to the window's.
fn brute_share(surface: &Surface, vertex: usize) -> f64 {
    let points = ScrambledSobol::new(0xb07e, vertex as u32);
    let scale = surface.placement.scale as f32;
    let window = |u: f32, v: f32| {
        let side = |x: f32| (2.0 * x - 1.0) * HALF_WINDOW as f32 * scale;
        Vec3::new(scale, side(u), side(v))
    };
    let area = 4.0 * HALF_WINDOW as f32 * HALF_WINDOW as f32 * scale * scale;
    let mut sum = 0.0;
    for index in 0..BRUTE_RAYS {
        let u = points.point(index);
        let from = surface.sample_point(vertex, [u[0], u[1]]);
        let to_window = window(u[2], u[3]) - from.position;
        let squared = to_window.length_squared();
        let direction = to_window / squared.sqrt();
        let cosines = direction.dot(from.normal).max(0.0) * direction.x.max(0.0);
        if cosines > 0.0 && surface.arrival(Level::detect(), &from, direction).is_none() {
            sum += f64::from(cosines * area / (std::f32::consts::PI * squared));
        }
    }
    sum / f64::from(BRUTE_RAYS)
}

/// What the bake says of the sky's share at vertices, and brute force does.
fn window_shares(scene: &Scene) -> Vec<[f64; 2]> {
    let (surface, bake) = baked(scene);
    assert_eq!(surface.placement.center, glam::DVec3::ZERO);
    let cells = [[1.0; 3]; CELL_COUNT];
    let in_slots = bake.sky_irradiance(Level::detect(), &cells).unwrap();
    (0..surface.vertices.front_count() / STRIDE)
        .into_par_iter()
        .map(|index| {
            let v = index * STRIDE;
            let slot = bake.basis.slot_of_vertex()[v];
            [
                f64::from(in_slots[slot as usize][0]),
                brute_share(&surface, v),
            ]
        })
        .collect()
}

fn square(x: f64) -> f64 {
    x * x
}

#[test]
#[allow(clippy::print_stderr, reason = "figures are read with --nocapture")]
fn small_windows_are_found() {
    for (name, has_block) in [("empty", false), ("with a block", true)] {
        let found = window_shares(&room_with_window(HALF_WINDOW, has_block, 0.3, 1024));
        let small: Vec<[f64; 2]> = found
            .into_iter()
            .filter(|[_, wanted]| SHARES.contains(wanted))
            .collect();
        let count = small.len() as f64;
        let squares: f64 = small.iter().map(|[x, w]| square(x / w - 1.0)).sum();
        let noise = (squares / count).sqrt();
        let [sum, wanted_sum] = [0, 1].map(|k| small.iter().map(|s| s[k]).sum::<f64>());
        let mean_ratio = small.iter().map(|[x, w]| x / w).sum::<f64>() / count - 1.0;
        let bias = sum / wanted_sum - 1.0;
        eprintln!(
            "window, {name}: {count} vertices, noise {noise:.4}, light {bias:+.5}, \
             mean of ratios {mean_ratio:+.5}"
        );
        for (low, high) in [(0.001, 0.002), (0.002, 0.004), (0.004, 0.01), (0.01, 0.3)] {
            let part: Vec<f64> = small
                .iter()
                .filter(|[_, w]| (low..high).contains(w))
                .map(|[x, w]| x / w - 1.0)
                .collect();
            let n = part.len().max(1) as f64;
            eprintln!(
                "  share {low} to {high}: {} vertices, mean {:+.4}, rms {:.4}",
                part.len(),
                part.iter().sum::<f64>() / n,
                (part.iter().map(|x| x * x).sum::<f64>() / n).sqrt()
            );
        }
        assert!(count > 50.0, "{name}: {count} vertices see the window");
        assert!(noise <= WINDOW_NOISE, "{name}: noise {noise}");
        assert!(bias.abs() <= WINDOW_BIAS, "{name}: bias {bias}");
    }
}
