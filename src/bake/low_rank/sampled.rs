//! The rows of all receivers, sampled and factored partition by partition, so
//! that no matrix of all vertices ever exists: a partition's rows are forgotten
//! when their leading components are known.

use rayon::prelude::*;

use super::LowRank;
use super::factor::last_energy;
use super::join::{QuantisedPart, join};
use super::near::{self, NearRule};
use super::part::{Budget, FoundPart, Job};
use super::quantise::{components, spread};
use crate::bake::basis::Basis;
use crate::bake::neighbours::vertex_graph;
use crate::bake::operator::{SkyRows, of_pilots, receiver_groups};
use crate::bake::rows::GroupRows;
use crate::bake::sky::Sky;
use crate::bake::stats::{BakeStats, GroupStats};
use crate::bake::transfer::{GROUP, Sampling};
use crate::bake::{BakeError, BakeSettings, Importance, RunSettings};
use crate::surface::Surface;

/// Groups of some partitions alone that their near field is measured by.
const FEW_PILOT_GROUPS: usize = 64;

/// Samples, factors and quantises all rows, and those of the sky where the scene
/// is open.
pub(in crate::bake) fn sampled_rows(
    task: Task,
) -> Result<(LowRank, Option<Sky>, BakeStats), BakeError> {
    let groups = receiver_groups(task.basis);
    let ask = |vertices: &[u32], rows: &_| near::scores(task.surface, vertices, rows);
    let (sky, scores) = SkyRows::new(task.basis, task.sampling(), &groups, ask);
    let near = NearRule::of_pilots(scores, Budget::of(task.settings.coefficients).near);
    task.run.proceed()?;
    let found = of_parts(task, (&sky, near), |_| true)?;
    let sky = sky.finish(&found.stats, &found.sky);
    let stats = BakeStats::of(&found.stats, task.settings, found.last_energy as f32);
    Ok((found.operator, sky, stats))
}

/// The same of some partitions alone, without the sky; the receivers of the
/// others are left in the dark.
pub(in crate::bake) fn pilot_rows(task: Task, is_pilot: &[bool]) -> Result<LowRank, BakeError> {
    let sky = SkyRows::unlimited(&[]);
    let wanted = |group: &(u32, u32)| is_pilot[task.basis.row(group.0).0 as usize];
    let groups: Vec<_> = receiver_groups(task.basis)
        .into_iter()
        .filter(wanted)
        .collect();
    let scores = of_pilots(
        task.basis,
        task.sampling(),
        &groups,
        FEW_PILOT_GROUPS,
        || (),
        |(), vertices, rows| near::scores(task.surface, vertices, rows),
    );
    let near = NearRule::of_pilots(scores, Budget::of(task.settings.coefficients).near);
    let found = of_parts(task, (&sky, near), |part| is_pilot[part as usize])?;
    Ok(found.operator)
}

/// What a bake is made of.
#[derive(Clone, Copy)]
pub(in crate::bake) struct Task<'a> {
    pub(in crate::bake) surface: &'a Surface,
    pub(in crate::bake) settings: &'a BakeSettings,
    pub(in crate::bake) run: &'a RunSettings<'a>,
    pub(in crate::bake) basis: &'a Basis,
    pub(in crate::bake) importance: &'a Importance,
}

/// An operator, and what else the same rays have told.
struct Found {
    operator: LowRank,
    stats: Vec<GroupStats>,
    sky: Vec<GroupRows>,
    /// Energy for each byte of the last component that was kept.
    last_energy: f64,
}

impl<'a> Task<'a> {
    fn sampling(&self) -> Sampling<'a> {
        Sampling {
            surface: self.surface,
            level: self.run.level,
            slot_of_vertex: self.basis.slot_of_vertex(),
            rays: self.settings.rays,
        }
    }
}

/// The operator for the receivers of some partitions.
fn of_parts(
    task: Task,
    (sky, near): (&SkyRows, NearRule),
    is_wanted: impl Fn(u32) -> bool + Sync,
) -> Result<Found, BakeError> {
    let (basis, run) = (task.basis, task.run);
    let groups = receiver_groups(basis);
    let mut parts_in_order: Vec<u32> = (0..basis.part_count() as u32).collect();
    parts_in_order.sort_by_key(|&part| first_vertex(basis, part));
    // Whoever is next to whom, also where the basis joins nothing: how far averaging goes
    // is chosen by what it costs.
    let graph = vertex_graph(task.surface);
    let job = Job {
        surface: task.surface,
        basis,
        graph: &graph,
        parts_in_order: &parts_in_order,
        sampling: task.sampling(),
        importance: task.importance,
        budget: Budget::of(task.settings.coefficients),
        near,
        sky,
    };
    let is_of_wanted = |group: &&(u32, u32)| is_wanted(basis.row(group.0).0);
    let steps = groups.iter().filter(is_of_wanted).count();
    run.progress.stage("transfer", steps as u64);
    let parts: Vec<FoundPart> = (0..basis.part_count() as u32)
        .into_par_iter()
        .map(|part| {
            if is_wanted(part) {
                job.part(part, run)
            } else {
                Ok(job.dark_part(part))
            }
        })
        .collect::<Result<_, _>>()?;

    let wanted = (0..basis.part_count() as u32).filter(|&part| is_wanted(part));
    let receivers: usize = wanted.map(|part| basis.slot_range(part).len()).sum();
    let factors = parts.iter().map(|part| &part.factors);
    let energy_a_byte = last_energy(factors, job.budget.rank * receivers);
    let stats: Vec<GroupStats> = parts.iter().flat_map(|p| &p.stats).copied().collect();
    let sky_rows: Vec<GroupRows> = parts.iter().flat_map(|p| p.sky.clone()).collect();
    let operator = job.quantise(parts, groups, energy_a_byte, run);
    operator
        .check(basis.slot_count(), basis.function_count())
        .expect("tables that were just made fit each other");
    Ok(Found {
        operator,
        stats,
        sky: sky_rows,
        last_energy: energy_a_byte,
    })
}

impl Job<'_> {
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
                let rank = part.factors.rank_worth(energy_a_byte);
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
                            (&near.targets, Some(&near.sums)),
                            &mut rows,
                        );
                        first += count;
                        rows
                    })
                    .collect();
                QuantisedPart {
                    components: found,
                    rows,
                }
            })
            .collect();
        join(quantised, sigma, self.basis.slot_count(), groups)
    }
}

fn first_vertex(basis: &Basis, part: u32) -> u32 {
    basis.vertex_of_slot()[basis.slot_range(part).start]
}
