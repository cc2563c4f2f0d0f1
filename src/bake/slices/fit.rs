//! From sampled slices to compressed ones, a partition at a time.

use rayon::prelude::*;

use super::quantise::{answering, quantised_near, quantised_run};
use super::sampled::{Sampling, Scratch, SliceTransfer, sample};
use super::{GROUPS_A_VERTEX, Slices};
use crate::bake::basis::Basis;
use crate::bake::low_rank::{
    Components, Factors, Matrix, components, last_energy, leading, responses,
};
use crate::bake::projection::project;
use crate::bake::rows::{GroupRows, Rows};
use crate::bake::transfer::GROUP;
use crate::bake::{BakeError, Importance, RunSettings, sky};
use crate::maths::spherical_harmonics::{Coefficients, HARMONICS};
use crate::surface::Surface;

/// Rays of a glossy vertex at most. A metal ball of roughness 0.5 (`scenes/glossy`,
/// edges of 0.12) against paths, means of 8 x 8 pixels in per cent, at 1,024 rays and
/// at 4,096: 18.8 and 19.3 with 24 components.
const MOST_RAYS: u32 = 1024;
/// Senders of a vertex that are kept one by one. The same ball with 16, 32: 7.6 and
/// 7.8 with 96 components, 18.8 and 14.2 with 24.
const NEAR: usize = 16;
/// Components of a partition in the mean, and at most. The same ball with 24, 48, 96
/// and 250: 18.8, 8.5, 7.6 and 7.5 (what 16 terms leave of the lobe); bias 7.4, 2.8,
/// 2.0 and 2.0. At 24 the partitions' borders can be seen.
const RANK: usize = 48;
const MOST_RANK: usize = 112;
/// Functions whose share of the energy of a partition is smaller are left out
/// before it is factored: there are thousands, and most are noise of the rays.
const LEAST_SHARE: f64 = 2e-6;
/// Vertices that one task samples.
const VERTICES_PER_TASK: usize = 4;

/// What slices are made of.
#[derive(Clone, Copy)]
pub(in crate::bake) struct Task<'a> {
    pub(in crate::bake) surface: &'a Surface,
    pub(in crate::bake) rays: u32,
    pub(in crate::bake) run: &'a RunSettings<'a>,
    pub(in crate::bake) basis: &'a Basis,
    pub(in crate::bake) importance: &'a Importance,
    /// The functions over the cells of the sky.
    pub(in crate::bake) sky: &'a Basis,
}

/// (Sender, its weight by slice).
type Entries = Vec<(u32, Coefficients)>;

/// One glossy vertex, sampled and projected.
struct FoundVertex {
    near: [GroupRows; GROUPS_A_VERTEX],
    /// What the components have to answer to constant light of the surfaces and of
    /// the sky.
    targets: [[f64; HARMONICS]; 2],
    /// Parts that the remainder comes from, ascending, and the coefficients of
    /// their functions; then those of the sky's.
    parts: Vec<u32>,
    coefficients: Vec<Coefficients>,
    of_sky: Vec<Coefficients>,
}

/// One partition's glossy vertices, factored.
struct FoundPart {
    vertices: Vec<FoundVertex>,
    roots_of_area: Vec<f32>,
    factors: Factors,
    /// Numbers of the factors' columns among all functions and the sky's.
    functions: Vec<u32>,
}

/// Samples and compresses the slices of all glossy vertices; `None` where there
/// are none.
pub(in crate::bake) fn sampled_slices(task: Task) -> Result<Option<Slices>, BakeError> {
    let basis = task.basis;
    let is_glossy = |slot: &usize| task.surface.is_glossy(basis.vertex_of_slot()[*slot]);
    let receivers: Vec<Vec<usize>> = (0..basis.part_count() as u32)
        .map(|part| basis.slot_range(part).filter(is_glossy).collect())
        .collect();
    let count: usize = receivers.iter().map(Vec::len).sum();
    if count == 0 {
        return Ok(None);
    }
    task.run.progress.stage("glossy slices", count as u64);
    let parts: Vec<FoundPart> = receivers
        .par_iter()
        .map(|slots| task.part(slots))
        .collect::<Result<_, _>>()?;
    let factors = parts.iter().map(|part| &part.factors);
    let energy = last_energy(factors, RANK * HARMONICS * count);
    let slices = task.quantise(&parts, receivers.concat(), energy);
    slices
        .check(basis.slot_count(), basis.function_count())
        .expect("tables that were just made fit each other");
    Ok(Some(slices))
}

impl Task<'_> {
    fn part(&self, slots: &[usize]) -> Result<FoundPart, BakeError> {
        let sampling = Sampling {
            surface: self.surface,
            level: self.run.level,
            slot_of_vertex: self.basis.slot_of_vertex(),
            rays: self.rays.min(MOST_RAYS),
        };
        let scratch = || {
            let count = self.basis.function_count().max(self.sky.function_count());
            let functions = vec![[0.0; HARMONICS]; count];
            (Scratch::new(self.basis.slot_count()), functions)
        };
        let vertices: Vec<FoundVertex> = slots
            .par_iter()
            .with_min_len(VERTICES_PER_TASK)
            .map_init(scratch, |(scratch, functions), &slot| {
                self.run.proceed()?;
                let transfer = sample(&sampling, self.basis.vertex_of_slot()[slot], scratch);
                self.run.progress.advance(1);
                Ok(self.projected(transfer, functions))
            })
            .collect::<Result<_, _>>()?;
        let areas = self.surface.vertices.areas();
        let area = |&slot: &usize| areas[self.basis.vertex_of_slot()[slot] as usize];
        let least = f32::MIN_POSITIVE;
        let root = |area: f32| if area > least { area } else { least }.sqrt();
        let roots_of_area: Vec<f32> = slots.iter().map(area).map(root).collect();
        let (y, functions) = self.whitened(&vertices, &roots_of_area);
        let factors = leading(self.run.level, &y, MOST_RANK.min(y.rows));
        Ok(FoundPart {
            vertices,
            roots_of_area,
            factors,
            functions,
        })
    }

    /// Splits the near field off and projects the rest.
    fn projected(&self, transfer: SliceTransfer, scratch: &mut [Coefficients]) -> FoundVertex {
        let mut targets = transfer.of_constant_light();
        let (near, rest) = split(transfer.entries);
        let near = quantised_near(&near, &mut targets[0]);
        let (parts, coefficients) = project(self.basis, &rest, scratch);
        let (_, of_sky) = project(self.sky, &transfer.sky, scratch);
        FoundVertex {
            near,
            targets,
            parts,
            coefficients,
            of_sky,
        }
    }

    /// Y = sqrt(A) C sigma of a partition, a row a slice, and the numbers of its
    /// columns: those that bring something.
    fn whitened(&self, vertices: &[FoundVertex], roots: &[f32]) -> (Matrix, Vec<u32>) {
        let (functions, sky_functions) = (self.basis.function_count(), self.sky.function_count());
        let sky_sigma = sky::sigma(self.sky, self.run.level);
        let sigma: Vec<f32> = [&self.importance.sigma[..], &sky_sigma].concat();
        let mut energies = vec![0.0_f64; functions + sky_functions];
        for (vertex, &root) in vertices.iter().zip(roots) {
            self.each_column(vertex, |column, values| {
                let scale = f64::from(root * sigma[column]);
                let squares = values.iter().map(|&v| f64::from(v) * f64::from(v));
                energies[column] += squares.sum::<f64>() * scale * scale;
            });
        }
        let least = energies.iter().sum::<f64>() * LEAST_SHARE;
        let kept: Vec<u32> = (0..energies.len() as u32)
            .filter(|&column| energies[column as usize] > least)
            .collect();
        let mut place = vec![u32::MAX; energies.len()];
        for (index, &column) in kept.iter().enumerate() {
            place[column as usize] = index as u32;
        }
        let mut y = Matrix::zero(vertices.len() * HARMONICS, kept.len());
        for (index, (vertex, &root)) in vertices.iter().zip(roots).enumerate() {
            self.each_column(vertex, |column, values| {
                if place[column] == u32::MAX {
                    return;
                }
                for (k, &value) in values.iter().enumerate() {
                    let entry = (index * HARMONICS + k) * y.columns + place[column] as usize;
                    y.values[entry] = value * root * sigma[column];
                }
            });
        }
        (y, kept)
    }

    /// A vertex's coefficients with their numbers among all functions and the
    /// sky's.
    fn each_column(&self, vertex: &FoundVertex, mut visit: impl FnMut(usize, &Coefficients)) {
        let ranges = vertex.parts.iter().map(|&p| self.basis.function_range(p));
        for (column, values) in ranges.flatten().zip(&vertex.coefficients) {
            visit(column, values);
        }
        for (column, values) in (self.basis.function_count()..).zip(&vertex.of_sky) {
            visit(column, values);
        }
    }

    fn quantise(&self, parts: &[FoundPart], slots: Vec<usize>, energy: f64) -> Slices {
        let level = self.run.level;
        let sky_sigma = sky::sigma(self.sky, level);
        let sigma: Vec<f32> = [&self.importance.sigma[..], &sky_sigma].concat();
        // Constant light of the surfaces, and of the sky, in the units of V.
        let functions = self.basis.function_count();
        let all = [self.basis.constant(level), self.sky.constant(level)].concat();
        let light = |is_of_sky: bool| -> Vec<f64> {
            let whitened =
                |(k, (&d, &s)): (usize, (&f32, &f32))| match (k >= functions) == is_of_sky {
                    true => f64::from(d) / f64::from(s),
                    false => 0.0,
                };
            all.iter().zip(&sigma).enumerate().map(whitened).collect()
        };
        let constant = [light(false), light(true)];
        let made: Vec<(Components, Vec<GroupRows>)> = parts
            .par_iter()
            .map(|part| part.quantised(energy, &constant))
            .collect();
        let (mut component_groups, mut component_receivers) = (Vec::new(), Vec::new());
        let (mut near, mut far, mut first_components) = (Vec::new(), Vec::new(), Vec::new());
        let mut next = 0_u32;
        for (part, (found, rows)) in parts.iter().zip(made) {
            first_components.extend(std::iter::repeat_n(next, rows.len()));
            far.extend(rows);
            near.extend(part.vertices.iter().flat_map(|vertex| vertex.near.clone()));
            for (group, count) in found.groups.into_iter().zip(found.counts) {
                component_groups.push(group);
                component_receivers.push((next, count));
                next += count;
            }
        }
        let groups: Vec<(u32, u32)> = (0..slots.len() * GROUPS_A_VERTEX)
            .map(|group| ((group * GROUP) as u32, GROUP as u32))
            .collect();
        Slices {
            receivers: slots.into_iter().map(|slot| slot as u32).collect(),
            scales: sigma.iter().map(|s| 1.0 / s).collect(),
            components: Rows::join(0, sigma.len(), component_receivers, &component_groups),
            near: Rows::join(0, self.basis.slot_count(), groups.clone(), &near),
            far: Rows::join_runs(0, next as usize, groups, &far, first_components),
        }
    }
}

impl FoundPart {
    /// V of the components that bring enough, and U of all rows.
    fn quantised(&self, energy: f64, constant: &[Vec<f64>; 2]) -> (Components, Vec<GroupRows>) {
        let rank = self.factors.rank_worth(energy);
        let mut found = components(&self.factors, &self.functions, rank, energy, &constant[0]);
        // U holds what each component brings, so that entries of components that
        // only a few vertices have, large where they are, do not coarsen the steps
        // of those that all have: V gives up its size.
        let sizes: Vec<f32> = self.factors.energies[..rank]
            .iter()
            .map(|energy| energy.sqrt() as f32)
            .collect();
        let steps = found.groups.iter_mut().flat_map(|it| &mut it.basis_steps);
        steps.zip(&sizes).for_each(|(step, size)| *step /= size);
        let groups = || found.groups.iter().zip(&found.counts);
        let answers = constant.each_ref().map(|light| -> Vec<f64> {
            let of_group = |(group, &count)| responses(group, count as usize, light);
            groups().flat_map(of_group).collect()
        });
        let everywhere: Vec<f64> = answers[0]
            .iter()
            .zip(&answers[1])
            .map(|(a, b)| a + b)
            .collect();
        let mut rows = Vec::new();
        for (index, (vertex, &root)) in self.vertices.iter().zip(&self.roots_of_area).enumerate() {
            for first in (0..HARMONICS).step_by(GROUP) {
                let mut lanes = vec![[0.0_f32; GROUP]; rank];
                for lane in 0..GROUP {
                    let left = self.factors.left.row(index * HARMONICS + first + lane);
                    let mut row: Vec<f32> = left
                        .iter()
                        .zip(&sizes)
                        .map(|(u, size)| u * size / root)
                        .collect();
                    let targets = vertex.targets.map(|of| of[first + lane]);
                    answering(&mut row, &answers, targets);
                    for (slot, value) in lanes.iter_mut().zip(row) {
                        slot[lane] = value;
                    }
                }
                rows.push(quantised_run(&lanes, &everywhere));
            }
        }
        (found, rows)
    }
}

/// The senders with the largest weights, over all slices, and the others.
fn split(entries: Entries) -> (Entries, Entries) {
    let worth = |weights: &Coefficients| weights.iter().fold(0.0, |sum, w| sum + w * w);
    let mut order: Vec<usize> = (0..entries.len()).collect();
    order.sort_by(|&a, &b| worth(&entries[b].1).total_cmp(&worth(&entries[a].1)));
    let mut is_near = vec![false; entries.len()];
    order
        .iter()
        .take(NEAR)
        .for_each(|&index| is_near[index] = true);
    let mut flags = is_near.into_iter();
    entries
        .into_iter()
        .partition(|_| flags.next() == Some(true))
}
