//! The rows of all receivers in the published scheme: sampled as in relume's
//! own, projected on the basis, cut to the largest elements, quantised.

use rayon::prelude::*;

use super::rows::{Coefficients, PaperRows};
use crate::bake::basis::Basis;
use crate::bake::compress;
use crate::bake::operator::{SkyRows, receiver_groups, vertices_of};
use crate::bake::rows::GroupRows;
use crate::bake::sky::Sky;
use crate::bake::stats::{BakeStats, GroupStats};
use crate::bake::transfer::{self, GROUP, GroupTransfer, Sampling, sample_group};
use crate::bake::{BakeError, BakeSettings, RunSettings};
use crate::surface::Surface;

/// Samples all rows and stores them as published; those of the sky, where the
/// scene is open, as in relume's scheme.
pub(in crate::bake) fn sampled_rows(
    surface: &Surface,
    settings: &BakeSettings,
    run: &RunSettings,
    basis: &Basis,
) -> Result<(PaperRows, Option<Sky>, BakeStats), BakeError> {
    let groups = receiver_groups(basis);
    let sampling = Sampling {
        surface,
        level: run.level,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: settings.rays,
    };
    let (sky, _) = SkyRows::new(basis, sampling, &groups, |_, _| ());
    let job = Job {
        basis,
        sampling,
        most_coefficients: settings.coefficients as usize,
        sky: &sky,
        groups: &groups,
    };
    run.proceed()?;
    run.progress.stage("transfer", groups.len() as u64);
    let found = job.project_all(run)?;

    let stats: Vec<GroupStats> = found.iter().map(|f| f.stats).collect();
    let alone = found
        .iter()
        .flat_map(|f| vec![f.is_alone; f.rows.len()])
        .collect();
    let (rows, sky_rows): (Vec<Vec<Coefficients>>, Vec<GroupRows>) =
        found.into_iter().map(|f| (f.rows, f.sky)).unzip();
    let rows = PaperRows::quantised(&rows.concat(), &basis.constant(run.level), alone);
    rows.check(basis.slot_count())
        .expect("rows that were just made fit each other");
    let sky = sky.finish(&stats, &sky_rows);
    // What is smaller than half a step is quantised to zero.
    let stats = BakeStats::of(&stats, settings, 0.5 * rows.step);
    Ok((rows, sky, stats))
}

/// What sampling and projecting need.
struct Job<'a> {
    basis: &'a Basis,
    sampling: Sampling<'a>,
    most_coefficients: usize,
    sky: &'a SkyRows<'a>,
    groups: &'a [(u32, u32)],
}

/// One group, sampled and projected.
struct FoundGroup {
    /// A list for each receiver.
    rows: Vec<Coefficients>,
    /// Whether nothing sends light to the group.
    is_alone: bool,
    sky: GroupRows,
    stats: GroupStats,
}

/// One worker's memory.
struct Scratch {
    transfer: transfer::Scratch,
    sky: compress::Scratch,
    /// c of a group's receivers, linear in the functions; zero between groups.
    coefficients: Vec<[f32; GROUP]>,
}

impl Job<'_> {
    fn scratch(&self) -> Scratch {
        Scratch {
            transfer: transfer::Scratch::new(self.basis.slot_count()),
            sky: self.sky.scratch(),
            coefficients: vec![[0.0; GROUP]; self.basis.function_count()],
        }
    }

    fn sample(&self, group: (u32, u32), scratch: &mut Scratch) -> GroupTransfer {
        let receivers = vertices_of(self.basis, group);
        sample_group(&self.sampling, receivers, &mut scratch.transfer)
    }

    fn project_all(&self, run: &RunSettings) -> Result<Vec<FoundGroup>, BakeError> {
        let project = |scratch: &mut Scratch, &group: &(u32, u32)| {
            run.proceed()?;
            let transfer = self.sample(group, scratch);
            let found = FoundGroup {
                rows: self.project(&transfer, group.1 as usize, &mut scratch.coefficients),
                is_alone: transfer.sees_only_sky(),
                sky: self.sky.compress(&transfer, &mut scratch.sky),
                stats: GroupStats::of(&transfer, group.1 as usize),
            };
            run.progress.advance(1);
            Ok(found)
        };
        let groups = self.groups.par_iter();
        groups.map_init(|| self.scratch(), project).collect()
    }

    /// The largest elements of T^s = T S (equation 4) of each receiver of a group.
    fn project(
        &self,
        transfer: &GroupTransfer,
        receivers: usize,
        coefficients: &mut [[f32; GROUP]],
    ) -> Vec<Coefficients> {
        let mut parts: Vec<u32> = Vec::new();
        for (slot, weights) in &transfer.entries {
            let (part, functions) = self.basis.row(*slot);
            // Senders ascend, and so do their parts.
            if parts.last() != Some(&part) {
                parts.push(part);
            }
            let own = &mut coefficients[self.basis.function_range(part)];
            for (coefficient, &s) in own.iter_mut().zip(functions) {
                for lane in 0..GROUP {
                    coefficient[lane] += weights[lane] * s;
                }
            }
        }
        let functions: Vec<usize> = parts
            .iter()
            .flat_map(|&part| self.basis.function_range(part))
            .collect();
        let row = |lane: usize| -> Coefficients {
            let entries = functions
                .iter()
                .map(|&k| (k as u32, coefficients[k][lane]))
                .filter(|&(_, c)| c != 0.0);
            largest(entries.collect(), self.most_coefficients)
        };
        let rows = (0..receivers).map(row).collect();
        for k in functions {
            coefficients[k] = [0.0; GROUP];
        }
        rows
    }
}

/// The `count` entries of largest |c|, functions ascending; of equal ones the
/// lower function.
fn largest(mut entries: Coefficients, count: usize) -> Coefficients {
    if count < entries.len() {
        if count > 0 {
            entries.select_nth_unstable_by(count - 1, |a, b| {
                b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0))
            });
        }
        entries.truncate(count);
        entries.sort_unstable_by_key(|&(function, _)| function);
    }
    entries
}
