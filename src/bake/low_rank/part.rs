//! One partition's rows: sampled group by group, projected on the basis, and
//! factored; then they are forgotten.

use rayon::prelude::*;

use super::factor::{Factors, Matrix, factorise};
use super::near::{self, NearRule};
use super::smooth::{Neighbours, smooth};
use crate::bake::basis::Basis;
use crate::bake::compress::{EMPTY_REMAINDER, quantise_near};
use crate::bake::graph::VertexGraph;
use crate::bake::operator::{SkyRows, vertices_of};
use crate::bake::projection::project;
use crate::bake::rows::GroupRows;
use crate::bake::stats::GroupStats;
use crate::bake::transfer::{self, GROUP, Sampling, sample_group};
use crate::bake::{BakeError, Importance, RunSettings};
use crate::maths::order::Order;
use crate::surface::Surface;

/// Components that a partition may keep, times the mean.
const MOST_RANK: f64 = 2.0;
/// And so many more.
const MORE_RANK: usize = 8;
/// A function whose share of a partition's components is smaller is forgotten at
/// once.
const FORGOTTEN: f64 = 1e-7;
/// Energy of entries of V over that of the sample of their noise, at least. Bytes a
/// vertex and error of one bounce in per cent without this and with it, under lights
/// that bakes stated their error by at the time: cornell 130 and 86, 1.31 and 1.37;
/// window 211 and 101, 2.42 and 2.75.
const ENTRY_OVER_NOISE: f64 = 2.0;
/// What the sample of noise counts, as an amplitude: at 3,072 rays it
/// has some four times the energy of the noise (`smooth`). Error of one bounce in per
/// cent and bytes a vertex at 1, 0.71 and 0.5, under tuning lights, by 72 entries:
/// cornell 1.40, 1.32, 1.39 and 116, 122, 116; window 3.46, 2.98, 2.73 and 139, 157, 177;
/// sheet 1.85, 1.74, 1.74 and 108, 117, 116. With entries for about equal bytes (125, 126,
/// 119) means of five scenes are 2.41, 2.30, 2.39. (At 2,048 rays, where the sample has
/// too little energy, cornell is 1.69 and 1.79 at 1 and 0.71, window 3.72 and 3.40; at
/// the default of 6,144 only this value was tried.)
pub(in crate::bake) const NOISE_COUNTS: f32 = 0.71;
/// Areas are at least this share of the partition's mean: what a needle's tip
/// receives matters to nobody, but has to be finite.
const SMALLEST_AREA: f64 = 1e-6;
/// Groups that a task samples at least; a worker's memory is made for each.
const GROUPS_PER_TASK: usize = 8;

/// How the entries of a vertex are spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::bake) struct Budget {
    /// Entries of the near field in the mean.
    pub(in crate::bake) near: usize,
    /// Components in the mean.
    pub(in crate::bake) rank: usize,
}

/// Share of a row's entries that goes to the near field. Error of one bounce in per
/// cent at 0.2, 0.3, 0.4, 0.5 and 0.6 under tuning lights: the mean of cornell, window,
/// sheet and statues 2.39, 2.40, 2.43, 2.50, 2.57; sheet alone 2.06, 1.89, 1.85, 1.85,
/// 1.83, with a 95th percentile of 7.1 at 0.2 and 5.9 at 0.4.
pub(in crate::bake) const NEAR_SHARE: f64 = 0.4;

impl Budget {
    /// Splits `coefficients` entries a vertex.
    pub(in crate::bake) fn of(coefficients: u32) -> Self {
        let near = (f64::from(coefficients) * NEAR_SHARE).round() as usize;
        Self {
            near,
            rank: coefficients as usize - near,
        }
    }
}

/// What sampling and factoring need.
pub(super) struct Job<'a> {
    pub(super) surface: &'a Surface,
    pub(super) basis: &'a Basis,
    pub(super) graph: &'a VertexGraph,
    pub(super) sampling: Sampling<'a>,
    pub(super) importance: &'a Importance,
    pub(super) budget: Budget,
    pub(super) near: NearRule,
    pub(super) sky: &'a SkyRows<'a>,
    /// Partitions by their first vertices: an order that does not depend on how
    /// they are numbered, and nor do the sums over them then.
    pub(super) parts_in_order: &'a [u32],
}

/// One partition, sampled and factored.
pub(super) struct FoundPart {
    /// Groups of receivers, with their near field.
    pub(super) near: Vec<NearGroup>,
    /// Square roots of the receivers' areas.
    pub(super) roots_of_area: Vec<f32>,
    pub(super) factors: Factors,
    /// Functions of the factors' columns.
    pub(super) functions: Vec<u32>,
    pub(super) sky: Vec<GroupRows>,
    pub(super) stats: Vec<GroupStats>,
}

pub(super) struct NearGroup {
    pub(super) rows: GroupRows,
    /// Sums of the near field.
    pub(super) sums: [f64; GROUP],
    /// What the components have to answer to constant light.
    pub(super) targets: [f64; GROUP],
}

/// One group, sampled and projected.
struct FoundGroup {
    near: NearGroup,
    /// Parts that the remainder comes from, ascending, and the coefficients of
    /// their functions.
    parts: Vec<u32>,
    coefficients: Vec<[f32; GROUP]>,
    /// Noise of these coefficients.
    noise: Vec<[f32; GROUP]>,
    sky: GroupRows,
    stats: GroupStats,
}

impl Job<'_> {
    pub(super) fn part(&self, part: u32, run: &RunSettings) -> Result<FoundPart, BakeError> {
        let slots = self.basis.slot_range(part);
        let groups: Vec<(u32, u32)> = slots
            .clone()
            .step_by(GROUP)
            .map(|first| (first as u32, (slots.end - first).min(GROUP) as u32))
            .collect();
        let found: Vec<FoundGroup> = groups
            .par_iter()
            .with_min_len(GROUPS_PER_TASK)
            .map_init(
                || self.scratch(),
                |scratch, &group| {
                    run.proceed()?;
                    let found = self.group(group, scratch);
                    run.progress.advance(1);
                    Ok(found)
                },
            )
            .collect::<Result<_, _>>()?;
        let roots_of_area = roots_of_area(self.surface, self.basis, slots);
        let (y, functions) = self.whitened(&found, &roots_of_area, |group| &group.coefficients);
        let (mut noise, _) = self.whitened(&found, &roots_of_area, |group| &group.noise);
        noise
            .values
            .iter_mut()
            .for_each(|value| *value *= NOISE_COUNTS);
        let most = (self.budget.rank as f64 * MOST_RANK) as usize + MORE_RANK;
        let (mut factors, noise) = factorise(run.level, &y, &noise, most.min(y.rows));
        if !factors.energies.is_empty() {
            let neighbours = Neighbours::of_part(self.graph, self.basis, part);
            smooth(&mut factors, &noise, &roots_of_area, &neighbours);
        }
        leave_noise_out(&mut factors);
        let (factors, functions) = without_forgotten(factors, functions);
        let mut out = FoundPart {
            near: Vec::new(),
            roots_of_area,
            factors,
            functions,
            sky: Vec::new(),
            stats: Vec::new(),
        };
        for group in found {
            out.near.push(group.near);
            out.sky.push(group.sky);
            out.stats.push(group.stats);
        }
        Ok(out)
    }

    /// A partition that receives nothing.
    pub(super) fn dark_part(&self, part: u32) -> FoundPart {
        let slots = self.basis.slot_range(part);
        let groups = slots.clone().step_by(GROUP);
        FoundPart {
            near: groups
                .map(|_| NearGroup {
                    rows: GroupRows::default(),
                    sums: [0.0; GROUP],
                    targets: [0.0; GROUP],
                })
                .collect(),
            roots_of_area: vec![1.0; slots.len()],
            factors: Factors::default(),
            functions: Vec::new(),
            sky: Vec::new(),
            stats: Vec::new(),
        }
    }

    fn scratch(&self) -> Scratch {
        Scratch {
            transfer: transfer::Scratch::new(self.basis.slot_count()),
            coefficients: vec![[0.0; GROUP]; self.basis.function_count()],
            sky: self.sky.scratch(),
        }
    }

    fn group(&self, group: (u32, u32), scratch: &mut Scratch) -> FoundGroup {
        let receivers = vertices_of(self.basis, group);
        let transfer = sample_group(&self.sampling, receivers, &mut scratch.transfer);
        let scores = near::scores(self.surface, receivers, &transfer);
        let split = self.near.split(&transfer, &scores);
        let mut rows = GroupRows::default();
        let sums = quantise_near(&split.near, &mut rows);
        let mut targets = [0.0; GROUP];
        for lane in 0..GROUP {
            let target = transfer.arrived[lane] - sums[lane];
            targets[lane] = if target < EMPTY_REMAINDER {
                0.0
            } else {
                target
            };
        }
        let slots = split.remainder.iter().map(|&(slot, _)| slot);
        let noise: Vec<_> = slots.zip(split.remainder_noise).collect();
        let (parts, coefficients) =
            project(self.basis, &split.remainder, &mut scratch.coefficients);
        let (_, noise) = project(self.basis, &noise, &mut scratch.coefficients);
        FoundGroup {
            near: NearGroup {
                rows,
                sums,
                targets,
            },
            parts,
            coefficients,
            noise,
            sky: self.sky.compress(&transfer, &mut scratch.sky),
            stats: GroupStats::of(&transfer, group.1 as usize),
        }
    }

    /// Y = sqrt(A) C sigma of a partition, and the functions of its columns.
    fn whitened(
        &self,
        groups: &[FoundGroup],
        roots_of_area: &[f32],
        of: impl Fn(&FoundGroup) -> &[[f32; GROUP]],
    ) -> (Matrix, Vec<u32>) {
        let mut column_of_part = vec![u32::MAX; self.basis.part_count()];
        for &part in groups.iter().flat_map(|group| &group.parts) {
            column_of_part[part as usize] = 0;
        }
        let mut functions: Vec<u32> = Vec::new();
        for &part in self.parts_in_order {
            let column = &mut column_of_part[part as usize];
            if *column == 0 {
                *column = functions.len() as u32;
                functions.extend(self.basis.function_range(part).map(|k| k as u32));
            }
        }
        let mut y = Matrix::zero(roots_of_area.len(), functions.len());
        for (group, roots) in groups
            .iter()
            .zip(roots_of_area.chunks(GROUP))
            .enumerate()
            .map(|(i, g)| ((i, g.0), g.1))
        {
            let (index, group) = group;
            let mut rest = of(group);
            for &part in &group.parts {
                let range = self.basis.function_range(part);
                let (own, others) = rest.split_at(range.len());
                rest = others;
                let first = column_of_part[part as usize] as usize;
                for ((column, values), k) in (first..).zip(own).zip(range) {
                    for (lane, root) in roots.iter().enumerate() {
                        let entry = (index * GROUP + lane) * y.columns + column;
                        y.values[entry] = values[lane] * root * self.importance.sigma[k];
                    }
                }
            }
        }
        (y, functions)
    }
}

/// Square roots of the areas of the receivers in some slots of one partition.
pub(super) fn roots_of_area(
    surface: &Surface,
    basis: &Basis,
    slots: std::ops::Range<usize>,
) -> Vec<f32> {
    let vertices = &basis.vertex_of_slot()[slots];
    let areas = surface.vertices.areas();
    let areas = vertices.iter().map(|&v| f64::from(areas[v as usize]));
    let mean = areas.clone().sum::<f64>() / vertices.len().max(1) as f64;
    let least = f64::at_least(mean * SMALLEST_AREA, f64::from(f32::MIN_POSITIVE));
    areas
        .map(|area| if area > least { area } else { least }.sqrt() as f32)
        .collect()
}

/// One worker's memory.
struct Scratch {
    transfer: transfer::Scratch,
    /// Coefficients of a group, linear in the functions; zero between groups.
    coefficients: Vec<[f32; GROUP]>,
    sky: crate::bake::compress::Scratch,
}

/// Takes out of V what is mostly noise: of a function, its entries in a group of
/// eight components, as they are listed together.
fn leave_noise_out(factors: &mut Factors) {
    let rank = factors.right.columns;
    let energy = |entries: &[f32]| {
        let squares = entries.iter().map(|&v| f64::from(v) * f64::from(v));
        squares.sum::<f64>()
    };
    let noise = std::mem::take(&mut factors.noise_of_right);
    let rows = factors.right.values.chunks_exact_mut(rank.max(1));
    for (row, noise) in rows.zip(noise.values.chunks_exact(rank.max(1))) {
        for (entries, noise) in row.chunks_mut(GROUP).zip(noise.chunks(GROUP)) {
            if energy(entries) <= ENTRY_OVER_NOISE * energy(noise) {
                entries.fill(0.0);
            }
        }
    }
}

/// Drops the functions that hardly any component has.
fn without_forgotten(factors: Factors, functions: Vec<u32>) -> (Factors, Vec<u32>) {
    let total: f64 = factors.energies.iter().sum();
    let energy = |row: &[f32]| {
        row.iter()
            .fold(0.0, |sum, &v| sum + f64::from(v) * f64::from(v))
    };
    let mut right = Matrix {
        rows: 0,
        columns: factors.right.columns,
        values: Vec::new(),
    };
    let mut kept = Vec::new();
    for (row, k) in factors
        .right
        .values
        .chunks_exact(right.columns.max(1))
        .zip(functions)
    {
        if energy(row) > total * FORGOTTEN {
            right.values.extend_from_slice(row);
            right.rows += 1;
            kept.push(k);
        }
    }
    (Factors { right, ..factors }, kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_that_are_mostly_noise_go_by_the_group() {
        let row = |values: [f32; 10]| Matrix {
            rows: 1,
            columns: 10,
            values: values.to_vec(),
        };
        let mut factors = Factors {
            right: row([1.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5]),
            noise_of_right: row([0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.4]),
            ..Factors::default()
        };
        leave_noise_out(&mut factors);
        assert_eq!(factors.right.values[..2], [1.0, 0.1], "one that stands out");
        assert_eq!(factors.right.values[8..], [0.0, 0.0]);
    }
}
