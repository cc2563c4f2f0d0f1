//! Constant light through the whole bake: basis, sampled rows, and rows as
//! they are stored.

use super::operator::{receiver_groups, vertices_of};
use super::rows::Columns;
use super::transfer::{GROUP, Sampling, sample_group};
use super::*;
use crate::maths::order::Order;
use crate::scene::Scene;
use crate::scene::sample_scenes::{hollow_sphere, room_with_blocks, separate_boxes};
use crate::surface::Detail;

/// Response of the stored rows to constant light against the sampled share of
/// rays: a step is a float, the rest is counted in double precision.
const RESPONSE: f64 = 1e-6;
/// Constant light on the basis and back, single precision.
const REPRODUCED: f64 = 1e-5;
/// r_i + e_i = 1 where no ray meets a side without vertices; weights are floats.
const ROW_SUM: f64 = 1e-5;

pub(super) fn baked(scene: &Scene) -> (Surface, Bake) {
    let mut surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
    let settings = BakeSettings::of_keys(&scene.bake);
    let bake = bake(&mut surface, &settings, &RunSettings::silent()).unwrap();
    (surface, bake)
}

/// Sampled and stored response of every slot, and its escaped share.
fn responses(surface: &Surface, bake: &Bake) -> Vec<[f64; 3]> {
    let level = Level::detect();
    let sampling = Sampling {
        surface,
        level,
        slot_of_vertex: bake.basis.slot_of_vertex(),
        rays: bake.stats.rays,
    };
    let (constant, rows) = low_rank(bake);
    let mut scratch = transfer::Scratch::new(bake.basis.slot_count());
    let mut found = Vec::new();
    for (index, group) in receiver_groups(&bake.basis).into_iter().enumerate() {
        let sampled = sample_group(&sampling, vertices_of(&bake.basis, group), &mut scratch);
        let stored = stored_response(rows, index, &constant);
        let lanes = 0..group.1 as usize;
        found.extend(lanes.map(|l| [sampled.arrived[l], stored[l], sampled.escaped[l]]));
    }
    found
}

/// What constant light of 1 makes of the components, and the rows that read them.
fn low_rank(bake: &Bake) -> (Vec<f32>, &Rows) {
    let Operator::LowRank(operator) = &bake.operator else {
        panic!("the default scheme is the low-rank one");
    };
    let constant = bake.basis.constant(Level::detect());
    let scaled = constant.iter().zip(&operator.scales);
    let scaled: Vec<f32> = scaled.map(|(d, scale)| d * scale).collect();
    let components = &operator.components;
    let of_group = |group| {
        let lanes = stored_response(components, group, &scaled);
        let (_, count) = components.receivers(group);
        lanes.into_iter().take(count)
    };
    let answers = (0..components.group_count()).flat_map(of_group);
    (answers.map(|y| y as f32).collect(), &operator.rows)
}

/// What a group's stored rows make of constant light, in double precision.
pub(super) fn stored_response(rows: &Rows, group: usize, constant: &[f32]) -> [f64; GROUP] {
    let range = |offsets: &[u32]| offsets[group] as usize..offsets[group + 1] as usize;
    let basis = range(&rows.basis_offsets);
    let coarse_end = basis.start + rows.coarse[group] as usize;
    let function = |entry: usize| match &rows.functions {
        Columns::Listed(rows::Indices::Narrow(list)) => usize::from(list[entry]),
        Columns::Listed(rows::Indices::Wide(list)) => list[entry] as usize,
        Columns::Runs(first) => first[group] as usize + (entry - basis.start),
    };
    std::array::from_fn(|lane| {
        let near = &rows.near_weights[range(&rows.near_offsets)];
        let near: f64 = near.iter().map(|weights| f64::from(weights[lane])).sum();
        let smooth: f64 = basis
            .clone()
            .map(|entry| {
                let band = if entry < coarse_end {
                    1.0
                } else {
                    f64::from(rows::FINE_BAND)
                };
                let share = f64::from(rows.coefficients[entry][lane]) / band;
                share * f64::from(constant[function(entry)])
            })
            .sum();
        near * f64::from(rows.near_steps[group][lane])
            + smooth * f64::from(rows.basis_steps[group][lane])
    })
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| {
        assert!(!value.is_nan(), "a value is not a number");
        f64::at_least(largest, value.abs())
    })
}

#[test]
fn stored_rows_answer_constant_light_like_sampled_ones() {
    for (name, scene) in [
        ("200 boxes", separate_boxes(1.0, 256)),
        ("open room", room_with_blocks(false, 0.15, 256)),
        ("closed room", room_with_blocks(true, 0.15, 256)),
        ("sphere", hollow_sphere(1.0, 10, 256)),
    ] {
        let (surface, bake) = baked(&scene);
        let found = responses(&surface, &bake);
        let off = largest(found.iter().map(|[sampled, stored, _]| stored - sampled));
        assert!(off <= RESPONSE, "{name}: a row is {off:e} off");
        let sums = largest(
            found
                .iter()
                .map(|[arrived, _, escaped]| arrived + escaped - 1.0),
        );
        assert!(
            sums <= ROW_SUM,
            "{name}: a row and its sky are {sums:e} off 1"
        );
    }
}

#[test]
fn constant_light_is_reproduced_on_each_of_200_boxes() {
    let (_, bake) = baked(&separate_boxes(0.2, 64));
    let constant = bake.basis.constant(Level::detect());
    let reproduced = |slot: usize| -> f64 {
        let (part, values) = bake.basis.row(slot as u32);
        let own = &constant[bake.basis.function_range(part)];
        values.iter().zip(own).map(|(s, d)| f64::from(s * d)).sum()
    };
    let off = largest((0..bake.basis().slot_count()).map(|slot| reproduced(slot) - 1.0));
    assert!(off <= REPRODUCED, "constant light is {off:e} off");
}
