//! The rows of all receivers, sampled and factored partition by partition, so
//! that no matrix of all vertices ever exists: a partition's rows are forgotten
//! when their leading components are known.

use rayon::prelude::*;

use super::LowRank;
use super::factor::{Factors, Matrix, factorise};
use super::quantise::{components, spread};
use crate::bake::basis::Basis;
use crate::bake::compress::{EMPTY_REMAINDER, near_split, quantise_near};
use crate::bake::operator::{SkyRows, receiver_groups, vertices_of};
use crate::bake::rows::{GroupRows, Rows};
use crate::bake::sky::Sky;
use crate::bake::stats::{BakeStats, GroupStats};
use crate::bake::transfer::{self, GROUP, Sampling, sample_group};
use crate::bake::{BakeError, BakeSettings, Importance, RunSettings};
use crate::surface::Surface;

/// Components that a partition may keep, times the mean.
const MOST_RANK: f64 = 2.0;
/// And so many more.
const MORE_RANK: usize = 8;
/// A function whose share of a partition's components is smaller is forgotten at
/// once.
const FORGOTTEN: f64 = 1e-7;
/// Areas are at least this share of the partition's mean: what a needle's tip
/// receives matters to nobody, but has to be finite.
const SMALLEST_AREA: f64 = 1e-6;
/// Groups that a task samples at least; a worker's memory is made for each.
const GROUPS_PER_TASK: usize = 8;

/// How the entries of a vertex are spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::bake) struct Budget {
    /// Entries of the near field.
    pub(in crate::bake) near: usize,
    /// Components in the mean.
    pub(in crate::bake) rank: usize,
}

/// Share of a row's entries that goes to the near field.
const NEAR_SHARE: f64 = 0.4;

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

/// Samples, factors and quantises all rows, and those of the sky where the scene
/// is open.
pub(in crate::bake) fn sampled_rows(
    surface: &Surface,
    settings: &BakeSettings,
    run: &RunSettings,
    basis: &Basis,
    importance: &Importance,
) -> Result<(LowRank, Option<Sky>, BakeStats), BakeError> {
    let groups = receiver_groups(basis);
    let sampling = Sampling {
        surface,
        level: run.level,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: settings.rays,
    };
    let sky = SkyRows::new(basis, sampling, &groups);
    if run.progress.cancelled() {
        return Err(BakeError::Cancelled);
    }
    let mut parts_in_order: Vec<u32> = (0..basis.part_count() as u32).collect();
    parts_in_order.sort_by_key(|&part| first_vertex(basis, part));
    let job = Job {
        surface,
        basis,
        parts_in_order: &parts_in_order,
        sampling,
        importance,
        budget: Budget::of(settings.coefficients),
        sky: &sky,
    };
    run.progress.stage("transfer", groups.len() as u64);
    let parts: Vec<FoundPart> = (0..basis.part_count() as u32)
        .into_par_iter()
        .map(|part| job.part(part, run))
        .collect::<Result<_, _>>()?;

    let energy_a_byte = last_energy(&parts, job.budget.rank * basis.slot_count());
    let stats: Vec<GroupStats> = parts.iter().flat_map(|p| &p.stats).copied().collect();
    let sky_rows: Vec<GroupRows> = parts.iter().flat_map(|p| p.sky.clone()).collect();
    let sky = sky.finish(&stats, &sky_rows);
    let stats = BakeStats::of(&stats, settings, energy_a_byte as f32);
    let operator = job.quantise(parts, groups.clone(), energy_a_byte, run);
    operator
        .check(basis.slot_count(), basis.function_count())
        .expect("tables that were just made fit each other");
    Ok((operator, sky, stats))
}

/// What sampling and factoring need.
struct Job<'a> {
    surface: &'a Surface,
    basis: &'a Basis,
    sampling: Sampling<'a>,
    importance: &'a Importance,
    budget: Budget,
    sky: &'a SkyRows<'a>,
    /// Partitions by their first vertices: an order that does not depend on how
    /// they are numbered, and nor do the sums over them then.
    parts_in_order: &'a [u32],
}

/// One partition, sampled and factored.
struct FoundPart {
    /// Groups of receivers, with their near field.
    near: Vec<NearGroup>,
    /// Square roots of the receivers' areas.
    roots_of_area: Vec<f32>,
    factors: Factors,
    /// Functions of the factors' columns.
    functions: Vec<u32>,
    sky: Vec<GroupRows>,
    stats: Vec<GroupStats>,
}

struct NearGroup {
    rows: GroupRows,
    /// Sums of the near field.
    sums: [f64; GROUP],
    /// What the components have to answer to constant light.
    targets: [f64; GROUP],
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
    fn part(&self, part: u32, run: &RunSettings) -> Result<FoundPart, BakeError> {
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
                    if run.progress.cancelled() {
                        return Err(BakeError::Cancelled);
                    }
                    let found = self.group(group, scratch);
                    run.progress.advance(1);
                    Ok(found)
                },
            )
            .collect::<Result<_, _>>()?;
        let roots_of_area = self.roots_of_area(slots);
        let (y, functions) = self.whitened(&found, &roots_of_area, |group| &group.coefficients);
        let (noise, _) = self.whitened(&found, &roots_of_area, |group| &group.noise);
        let most = (self.budget.rank as f64 * MOST_RANK) as usize + MORE_RANK;
        let factors = factorise(run.level, &y, &noise, most.min(y.rows));
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
        let split = near_split(&transfer, self.budget.near);
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
        let (parts, coefficients) = self.project(&split.remainder, &mut scratch.coefficients);
        let (_, noise) = self.project(&noise, &mut scratch.coefficients);
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

    /// c_ik = sum_j R_ij S_jk for all functions of the parts that send.
    fn project(
        &self,
        remainder: &[(u32, [f32; GROUP])],
        scratch: &mut [[f32; GROUP]],
    ) -> (Vec<u32>, Vec<[f32; GROUP]>) {
        let mut parts: Vec<u32> = Vec::new();
        for (slot, weights) in remainder {
            let (part, functions) = self.basis.row(*slot);
            if parts.last() != Some(&part) {
                parts.push(part);
            }
            let range = self.basis.function_range(part);
            for (coefficient, &s) in scratch[range].iter_mut().zip(functions) {
                for lane in 0..GROUP {
                    coefficient[lane] += weights[lane] * s;
                }
            }
        }
        let mut coefficients = Vec::new();
        for &part in &parts {
            let own = &mut scratch[self.basis.function_range(part)];
            coefficients.extend_from_slice(own);
            own.fill([0.0; GROUP]);
        }
        (parts, coefficients)
    }

    fn roots_of_area(&self, slots: std::ops::Range<usize>) -> Vec<f32> {
        let vertices = &self.basis.vertex_of_slot()[slots];
        let areas = self.surface.vertices.areas();
        let areas = vertices.iter().map(|&v| f64::from(areas[v as usize]));
        let mean = areas.clone().sum::<f64>() / vertices.len().max(1) as f64;
        let least = f64::max(mean * SMALLEST_AREA, f64::from(f32::MIN_POSITIVE));
        areas
            .map(|area| if area > least { area } else { least }.sqrt() as f32)
            .collect()
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

    /// The operator, with every partition's components that bring enough.
    fn quantise(
        &self,
        parts: Vec<FoundPart>,
        groups: Vec<(u32, u32)>,
        energy_a_byte: f64,
        run: &RunSettings,
    ) -> LowRank {
        let sigma = &self.importance.sigma;
        let constant: Vec<f64> = self
            .basis
            .constant(run.level)
            .iter()
            .zip(sigma)
            .map(|(&d, &s)| f64::from(d) / f64::from(s))
            .collect();
        let quantised: Vec<_> = parts
            .into_par_iter()
            .map(|part| {
                let rank = rank_of(&part, energy_a_byte);
                let found = components(
                    &part.factors,
                    &part.functions,
                    rank,
                    energy_a_byte,
                    &constant,
                );
                let mut first = 0;
                let rows: Vec<GroupRows> = part
                    .near
                    .into_iter()
                    .map(|near| {
                        let mut rows = near.rows;
                        let count = GROUP.min(part.roots_of_area.len() - first);
                        spread(
                            &part.factors.left,
                            &part.roots_of_area,
                            (first, count),
                            &found,
                            (&near.targets, &near.sums),
                            &mut rows,
                        );
                        first += count;
                        rows
                    })
                    .collect();
                (found, rank as u32, rows)
            })
            .collect();
        let (mut component_groups, mut component_receivers) = (Vec::new(), Vec::new());
        let (mut rows, mut first_components) = (Vec::new(), Vec::new());
        let mut next = 0_u32;
        for (found, rank, of_part) in quantised {
            first_components.extend(std::iter::repeat_n(next, of_part.len()));
            rows.extend(of_part);
            for (group, count) in found.groups.into_iter().zip(found.counts) {
                component_groups.push(group);
                component_receivers.push((next, count));
                next += count;
            }
            debug_assert_eq!(
                first_components.last().map(|f| f + rank),
                Some(next),
                "all components of the part"
            );
        }
        LowRank {
            scales: sigma.iter().map(|s| 1.0 / s).collect(),
            components: Rows::join(
                0,
                self.basis.function_count(),
                component_receivers,
                &component_groups,
            ),
            rows: Rows::join_runs(
                self.basis.slot_count(),
                next as usize,
                groups,
                &rows,
                first_components,
            ),
        }
    }
}

fn first_vertex(basis: &Basis, part: u32) -> u32 {
    basis.vertex_of_slot()[basis.slot_range(part).start]
}

/// One worker's memory.
struct Scratch {
    transfer: transfer::Scratch,
    /// Coefficients of a group, linear in the functions; zero between groups.
    coefficients: Vec<[f32; GROUP]>,
    sky: crate::bake::compress::Scratch,
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

/// Energy for each byte of the last component that `bytes` of U pay for.
fn last_energy(parts: &[FoundPart], bytes: usize) -> f64 {
    let mut all: Vec<(f64, usize)> = parts
        .iter()
        .flat_map(|part| {
            let bytes = part.factors.left.rows;
            let energies = part.factors.energies.iter();
            energies.map(move |&e| (e / bytes as f64, bytes))
        })
        .filter(|&(energy, _)| energy > 0.0)
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut spent = 0;
    for &(energy, cost) in &all {
        spent += cost;
        if spent >= bytes {
            return energy;
        }
    }
    0.0
}

/// Components of a partition that bring as much.
fn rank_of(part: &FoundPart, energy_a_byte: f64) -> usize {
    let bytes = part.factors.left.rows as f64;
    let brings = |e: &&f64| **e > 0.0 && **e / bytes >= energy_a_byte;
    part.factors.energies.iter().take_while(brings).count()
}
