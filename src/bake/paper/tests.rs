//! The published table against what it stands for.

use super::rows::PaperRows;
use crate::bake::file::{decode, encode};
use crate::bake::key::BakeKey;
use crate::bake::operator::{receiver_groups, vertices_of};
use crate::bake::rows::Indices;
use crate::bake::transfer::{self, Sampling, sample_group};
use crate::bake::{Bake, BakeSettings, Operator, RunSettings, Scheme, Silent, bake};
use crate::maths::hash::uniform;
use crate::maths::order::Order;
use crate::scene::Scene;
use crate::scene::sample_scenes::{room_with_blocks, separate_boxes};
use crate::simd::Level;
use crate::surface::{Detail, Surface};

/// More coefficients than any vertex has: nothing is left out but by the step.
const ALL: u32 = 1 << 20;
/// Single precision through sums of hundreds of products, relative to their
/// sizes: 500 roundings of 6e-8.
const ROUNDING: f64 = 3e-5;

fn settings(scene: &Scene, coefficients: u32) -> BakeSettings {
    BakeSettings {
        coefficients,
        ..BakeSettings::of_scheme(Scheme::Paper, &scene.bake)
    }
}

fn baked(scene: &Scene, coefficients: u32, level: Level) -> (Surface, Bake) {
    let mut surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
    let run = RunSettings {
        level,
        progress: &Silent,
    };
    let bake = bake(&mut surface, &settings(scene, coefficients), &run).unwrap();
    (surface, bake)
}

fn paper_rows(bake: &Bake) -> &PaperRows {
    match &bake.operator {
        Operator::Paper(rows) => rows,
        Operator::LowRank(_) => panic!("the scheme is the published one"),
    }
}

/// A slot's list: (function, c as stored).
fn stored(rows: &PaperRows, slot: usize) -> Vec<(usize, f64)> {
    let entries = rows.offsets[slot] as usize..rows.offsets[slot + 1] as usize;
    let function = |entry: usize| match &rows.functions {
        Indices::Narrow(list) => usize::from(list[entry]),
        Indices::Wide(list) => list[entry] as usize,
    };
    let c = |entry: usize| f64::from(rows.coefficients[entry]) * f64::from(rows.step);
    entries.map(|entry| (function(entry), c(entry))).collect()
}

/// T S of the sampled rows in double precision, a row a slot.
fn dense_rows(surface: &Surface, bake: &Bake) -> Vec<Vec<f64>> {
    let basis = &bake.basis;
    let sampling = Sampling {
        surface,
        level: Level::Scalar,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: bake.stats.rays,
    };
    let mut scratch = transfer::Scratch::new(basis.slot_count());
    let mut rows = vec![vec![0.0; basis.function_count()]; basis.slot_count()];
    for group in receiver_groups(basis) {
        let sampled = sample_group(&sampling, vertices_of(basis, group), &mut scratch);
        for (sender, weights) in &sampled.entries {
            let (part, values) = basis.row(*sender);
            for (k, s) in basis.function_range(part).zip(values) {
                for lane in 0..group.1 as usize {
                    let slot = group.0 as usize + lane;
                    rows[slot][k] += f64::from(weights[lane]) * f64::from(*s);
                }
            }
        }
    }
    rows
}

/// How far a stored element may be from c: half a step, and what 127 steps do
/// not reach.
fn slack(c: f64, step: f64) -> f64 {
    (c.abs() - 127.0 * step).at_least(0.5 * step)
}

/// Light that differs from slot to slot and channel to channel.
fn uneven_light(slot_count: usize) -> Vec<[f32; 3]> {
    (0..slot_count as u32)
        .map(|slot| [0, 1, 2].map(|channel| uniform(0x11, slot, channel)))
        .collect()
}

#[test]
fn the_table_answers_as_the_dense_product_within_half_a_step_an_element() {
    let scene = room_with_blocks(false, 0.25, 64);
    let (surface, bake) = baked(&scene, ALL, Level::detect());
    let dense = dense_rows(&surface, &bake);
    let radiosity = uneven_light(bake.basis.slot_count());
    let light = bake.basis.project_rgb(Level::Scalar, &radiosity);
    let answer = bake.apply(Level::detect(), &radiosity);
    let step = f64::from(paper_rows(&bake).step);
    let (mut lit, mut closest) = (0, f64::INFINITY);
    for (slot, row) in dense.iter().enumerate() {
        for channel in 0..3 {
            let terms = row.iter().zip(&light);
            let exact: f64 = terms.clone().map(|(c, b)| c * f64::from(b[channel])).sum();
            // Functions of partitions that send nothing are not in the list.
            let may_be_off: f64 = terms
                .filter(|&(&c, _)| c != 0.0)
                .map(|(c, b)| (slack(*c, step) + ROUNDING * c.abs()) * f64::from(b[channel]).abs())
                .sum();
            let off = (f64::from(answer[slot][channel]) - exact).abs();
            assert!(
                off <= may_be_off * (1.0 + ROUNDING),
                "slot {slot}: {off:e} off, at most {may_be_off:e}"
            );
            lit += usize::from(exact > 0.1);
            closest = closest.at_most(if exact > 0.1 {
                may_be_off / exact
            } else {
                f64::INFINITY
            });
        }
    }
    assert!(lit > dense.len(), "much of the room is lit: {lit}");
    assert!(closest < 0.5, "the bound says something: {closest}");
}

#[test]
fn the_largest_elements_of_every_vertex_are_kept() {
    const KEPT: usize = 12;
    let scene = room_with_blocks(false, 0.25, 64);
    let (surface, bake) = baked(&scene, KEPT as u32, Level::detect());
    let rows = paper_rows(&bake);
    let step = f64::from(rows.step);
    let mut full = 0;
    for (slot, row) in dense_rows(&surface, &bake).iter().enumerate() {
        let list = stored(rows, slot);
        assert!(list.len() <= KEPT, "slot {slot} keeps {}", list.len());
        assert!(
            list.iter()
                .all(|&(k, c)| (c - row[k]).abs() <= slack(row[k], step) + ROUNDING),
            "slot {slot}: an element is more than half a step off"
        );
        let mut dropped = row.clone();
        list.iter().for_each(|&(k, _)| dropped[k] = 0.0);
        let largest = dropped.iter().fold(0.0_f64, |max, c| max.at_least(c.abs()));
        let smallest = list
            .iter()
            .fold(f64::INFINITY, |min, &(k, _)| min.at_most(row[k].abs()));
        let bound = if list.len() == KEPT {
            smallest
        } else {
            0.5 * step
        };
        assert!(
            largest <= bound + ROUNDING,
            "slot {slot}: {largest:e} is dropped, {bound:e} would be kept"
        );
        full += usize::from(list.len() == KEPT);
    }
    assert!(full > 100, "the limit binds at {full} vertices");
}

#[test]
fn one_step_serves_the_whole_scene() {
    let rows = [
        vec![(0, 0.5), (3, -1.27)],
        vec![(1, 0.0049), (2, 0.0051)],
        Vec::new(),
    ];
    let table = PaperRows::quantised(&rows, &[1.0, 0.0, 0.0, 1.0], vec![false, false, true]);
    // The largest is 127 steps; 0.49 of a step is zero, 0.51 is one.
    assert_eq!(table.coefficients, [50, -127, 1]);
    assert_eq!(table.functions, Indices::Narrow(vec![0, 3, 2]));
    assert_eq!(table.offsets, [0, 2, 3, 3]);
    assert_eq!(table.step, 1.27 / 127.0);
    assert_eq!(table.check(3), Ok(()));
    let alone: Vec<usize> = table.without_senders().into_iter().flatten().collect();
    assert_eq!(alone, [2]);
    let dark = PaperRows::quantised(&[Vec::new()], &[1.0; 4], vec![false]);
    assert_eq!((dark.step, dark.check(1)), (0.0, Ok(())));
}

/// Two large elements that answer no constant light are clipped for the sake of
/// the small ones that do.
#[test]
fn the_step_serves_constant_light() {
    let small: Vec<(u32, f32)> = (1..60).map(|k| (k, 0.003 + 0.0001 * k as f32)).collect();
    let rows = [vec![(0, 12.7)], small.clone(), vec![(0, -12.7)]];
    let mut constant = vec![1.0; 60];
    constant[0] = 0.0;
    let table = PaperRows::quantised(&rows, &constant, vec![false; 3]);
    assert!(table.step < 0.005, "the step is {}", table.step);
    assert_eq!((table.coefficients[0], table.coefficients[60]), (127, -127));
    assert_eq!(table.functions.len(), 2 + small.len(), "nothing is zero");
}

#[test]
fn lists_that_do_not_fit_are_named() {
    let rows = [vec![(0, 0.5), (3, -1.27)], vec![(1, 1.0)]];
    let table = PaperRows::quantised(&rows, &[1.0; 4], vec![false; 2]);
    let changes: [fn(&mut PaperRows); 8] = [
        |t| t.offsets[1] = 9,
        |t| t.offsets[0] = 1,
        |t| t.offsets[2] = 2,
        |t| t.alone.push(true),
        |t| t.functions = Indices::Narrow(vec![0, 3]),
        |t| t.functions = Indices::Wide(vec![0, 4, 1]),
        |t| t.step = f32::NAN,
        |t| t.coefficients.push(1),
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut table = table.clone();
        change(&mut table);
        assert!(table.check(2).is_err(), "change {index} passes");
    }
    assert!(table.check(1).is_err() && table.check(3).is_err());
    assert_eq!(table.check(2), Ok(()));
}

#[test]
fn threads_and_instructions_change_no_bit() {
    let scene = room_with_blocks(false, 0.25, 64);
    let on_threads = |threads: usize, level: Level| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let bake = baked(&scene, 40, level).1;
            let answer = bake.apply(level, &uneven_light(bake.basis.slot_count()));
            (bake, answer)
        })
    };
    let one = on_threads(1, Level::Scalar);
    for (threads, level) in [(3, Level::detect()), (2, Level::Sse2)] {
        let other = on_threads(threads, level);
        assert!(other.0 == one.0, "{threads} threads, {level:?}: a bake");
        assert!(other.1 == one.1, "{threads} threads, {level:?}: an answer");
    }
}

#[test]
fn a_stored_bake_comes_back_as_it_was() {
    for scene in [room_with_blocks(false, 0.5, 32), separate_boxes(1.0, 32)] {
        let (surface, bake) = baked(&scene, 40, Level::detect());
        let key = BakeKey::of(&surface, &settings(&scene, 40));
        assert_eq!(bake.stats.scheme, Scheme::Paper);
        assert_eq!(bake.stats.partitioner, Scheme::Paper.partitioner());
        assert!(decode(&encode(&bake, &key), &key) == Ok(bake));
        let relume = BakeSettings::of_keys(&scene.bake);
        assert_ne!(
            BakeKey::of(&surface, &relume),
            key,
            "a scheme is in the key"
        );
    }
}

#[test]
fn part_sizes_and_functions_are_those_of_table_1() {
    // Spheres and planks of 4 and 7 thousand vertices; horses of 25.
    let sizes = [4_000, 7_000, 25_000, 35_000].map(super::vertices_per_part);
    assert_eq!(sizes, [500, 500, 1000, 1000]);
    assert_eq!(
        super::equal_functions(&[500, 501, 499, 8], 80),
        [24, 24, 24, 8]
    );
}
