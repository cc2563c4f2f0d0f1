//! Rays per second, for tuning; prints, asserts only that the answers agree.
#![allow(clippy::print_stdout, reason = "a measurement that is run by hand")]

use super::build::{BUILD, BuildSettings, build_with};
use super::scenes::*;
use super::*;
use obvhs::ploc::PlocSearchDistance;
use std::time::Instant;

const ROUNDS: usize = 7;

/// Closest hits are measured as a bake asks for them: random points of the
/// surface, some hundred cosine-distributed rays from each. (One ray from each
/// of 200,000 points, which no caller does, waits for memory: 2.1 M/s in the
/// room, 1.4 in the blob, 2.4 and 1.6 times obvhs.)
const BOUNCE_POINTS: usize = 800;
const RAYS_PER_POINT: usize = 250;

/// A scene, its tree and the two kinds of rays that matter.
struct Case {
    name: &'static str,
    tree: RayTree,
    shadow: Vec<Ray>,
    bounce: Vec<Ray>,
}

fn case(name: &'static str, settings: BuildSettings) -> Case {
    let (mesh, eye, light, inside) = match name {
        "room" => (
            room(),
            Vec3::new(0.8, 0.3, 0.9),
            Vec3::new(-0.3, 0.8, 0.1),
            true,
        ),
        _ => (
            blob(),
            Vec3::new(1.2, 0.8, 1.4),
            Vec3::new(-0.9, 1.5, 1.0),
            false,
        ),
    };
    let tree = build_with(&mesh.positions, &mesh.triangles, settings);
    let pixels = pinhole_rays(eye, Vec3::new(0.0, -0.2, 0.0), 640, 480);
    let shadow = shadow_rays(&hit_points(&mesh, &tree, &pixels), light);
    let points = hit_points(&mesh, &tree, &scattered_rays(eye, inside, BOUNCE_POINTS));
    let points: Vec<_> = points
        .into_iter()
        .flat_map(|point| [point; RAYS_PER_POINT])
        .collect();
    Case {
        name,
        tree,
        shadow,
        bounce: cosine_rays(&points, 43),
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Million rays a second of each backend, medians of alternating rounds, and
/// the number of rays that each found hit.
fn compare(ray_count: usize, backends: &mut [(&str, &mut dyn FnMut() -> usize)]) {
    let mut times = vec![Vec::new(); backends.len()];
    let mut found = Vec::new();
    for _ in 0..ROUNDS {
        for ((_, run), times) in backends.iter_mut().zip(&mut times) {
            let start = Instant::now();
            found.push(run());
            times.push(start.elapsed().as_secs_f64());
        }
    }
    assert!(found.iter().all(|&count| count == found[0]), "{found:?}");
    let speeds: Vec<f64> = times
        .into_iter()
        .map(|times| ray_count as f64 / median(times) / 1e6)
        .collect();
    for ((name, _), speed) in backends.iter().zip(&speeds) {
        println!("    {name:8} {speed:6.2} M/s  x {:.2}", speed / speeds[0]);
    }
}

fn measure(case: &Case) {
    let (tree, shadow, bounce) = (&case.tree, &case.shadow, &case.bounce);
    let occluded = |level| {
        let mut found = vec![false; shadow.len()];
        move || {
            tree.occluded_many(level, shadow, &mut found);
            found.iter().filter(|&&occluded| occluded).count()
        }
    };
    println!("{}: {} coherent shadow rays", case.name, shadow.len());
    compare(
        shadow.len(),
        &mut [
            ("obvhs", &mut || {
                shadow.iter().filter(|ray| tree.occluded_obvhs(ray)).count()
            }),
            ("scalar", &mut occluded(Level::Scalar)),
            ("sse2", &mut occluded(Level::Sse2)),
            ("avx2", &mut occluded(Level::Avx2)),
        ],
    );
    let closest = |level| {
        let mut found = vec![None; bounce.len()];
        move || {
            tree.closest_many(level, bounce, &mut found);
            found.iter().flatten().count()
        }
    };
    println!("{}: {} cosine closest hits", case.name, bounce.len());
    compare(
        bounce.len(),
        &mut [
            ("obvhs", &mut || {
                bounce
                    .iter()
                    .filter_map(|ray| tree.closest_obvhs(ray))
                    .count()
            }),
            ("scalar", &mut closest(Level::Scalar)),
            ("sse2", &mut closest(Level::Sse2)),
            ("avx2", &mut closest(Level::Avx2)),
        ],
    );
}

/// Medians of five runs on a busy processor of two cores, AVX2, million rays a
/// second | times obvhs: room, shadow 14.6 | 4.1, closest 2.7 | 1.9; blob, shadow
/// 3.8 | 2.3, closest 4.1 | 1.8.
#[test]
#[ignore = "a measurement: cargo test --release rays_speed -- --ignored --nocapture"]
fn rays_speed() {
    for name in ["room", "blob"] {
        measure(&case(name, BUILD));
    }
}

#[test]
#[ignore = "a measurement of build settings: cargo test --release rays_build -- --ignored --nocapture"]
fn rays_build() {
    use PlocSearchDistance::{High, Low, Medium, VeryHigh};
    let cases: Vec<(String, Case)> = ["room", "blob"]
        .into_iter()
        .flat_map(|name| {
            [
                (Medium, 0, 0.02), (High, 0, 0.0), (High, 0, 0.02), (High, 0, 0.1),
                (High, 0, 0.5), (VeryHigh, 0, 0.02), (High, 2, 0.02), (Low, 2, 0.02),
            ]
            .map(|(search_distance, search_depth_threshold, reinsertion_batch_ratio)| {
                let settings = BuildSettings {
                    search_distance,
                    search_depth_threshold,
                    reinsertion_batch_ratio,
                };
                let mesh = if name == "room" { room() } else { blob() };
                let start = Instant::now();
                build_with(&mesh.positions, &mesh.triangles, settings);
                let ms = start.elapsed().as_secs_f64() * 1e3;
                let label = format!(
                    "{name} {search_distance:?} {search_depth_threshold} {reinsertion_batch_ratio} {ms:.0} ms"
                );
                (label, case(name, settings))
            })
        })
        .collect();
    let mut times = vec![(Vec::new(), Vec::new()); cases.len()];
    for _ in 0..ROUNDS {
        for ((_, case), times) in cases.iter().zip(&mut times) {
            let mut occluded = vec![false; case.shadow.len()];
            let mut hits = vec![None; case.bounce.len()];
            let start = Instant::now();
            case.tree
                .occluded_many(Level::detect(), &case.shadow, &mut occluded);
            let middle = Instant::now();
            case.tree
                .closest_many(Level::detect(), &case.bounce, &mut hits);
            times
                .0
                .push(case.shadow.len() as f64 / (middle - start).as_secs_f64() / 1e6);
            times
                .1
                .push(case.bounce.len() as f64 / middle.elapsed().as_secs_f64() / 1e6);
        }
    }
    for ((label, _), (shadow, bounce)) in cases.iter().zip(times) {
        println!(
            "{label}: shadow {:.2} M/s, closest {:.2} M/s",
            median(shadow),
            median(bounce)
        );
    }
}
