//! All bounces in one operator, for the albedo that it was made with.
//!
//! With rho the albedo, endless bounces of x = rho E0 are E = G x with
//! G = T~ + T~ rho G, for each colour channel its own. The near field W of the
//! first bounce stays as it is; all the rest is asked for what it makes of the
//! functions of the basis,
//!
//!   E ~ W x + R S^T M x,   R = (G - W) S,   and R ~ U V  by partition of receivers,
//!
//! and a frame costs that and one bounce of T~ on top, E ~ T~ (x + rho E), which
//! what is left out of E passes once more. U is shared by the channels: what bounces
//! brings the same patterns to a receiver whatever its colour, and a product
//! with RGB values costs as much as one with one channel. V stands over a table
//! of three times the functions: those of red, then green, then blue.
//!
//! Left out is what the basis cannot express of x, after the near field and one
//! more bounce. The stored error says what all of it comes to.
//!
//! A column of R is a solution of endless bounces. Held are never all columns
//! but their coordinates in a basis of each partition's leading patterns, which
//! the answers to a few random lights span (Halko, Martinsson and Tropp 2011,
//! algorithm 4.1): 12 B x functions x patterns a partition, 160 MB at 35,000
//! vertices and 2,240 functions instead of 940 MB.

mod audit;
mod columns;
mod series;

use super::LowRank;
use super::factor::Factors;
use super::join::{QuantisedPart, join};
use super::part::roots_of_area;
use super::quantise::{components, spread};
use crate::bake::basis::Basis;
use crate::bake::excitation::Excitation;
use crate::bake::operator::receiver_groups;
use crate::bake::places::Places;
use crate::bake::rows::GroupRows;
use crate::bake::test_lights::LIGHTS;
use crate::bake::transfer::GROUP;
use crate::bake::{BakeError, LightErrors, RunSettings, prior};
use crate::maths::rgb_fields::product;
use crate::simd::Level;
use columns::{Columns, PATTERNS, RANDOM_LIGHTS};
use rayon::prelude::*;
use series::Series;

/// Share of the light after the near field that may be left out with the small
/// components, root mean square.
const LEFT_OUT: f64 = 0.005;

/// The operator of all bounces. Fields are checked against each other when it is
/// made, in memory or from a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Folded {
    /// All but the near field: V over the functions of red, green and blue, and U.
    pub(in crate::bake) beyond_near: LowRank,
    /// How far it is off from bounces one by one, under lights that chose nothing.
    pub(in crate::bake) errors: LightErrors,
}

/// What bounces are folded of.
#[derive(Clone, Copy)]
pub(in crate::bake) struct FoldTask<'a> {
    /// T~.
    pub(in crate::bake) operator: &'a LowRank,
    pub(in crate::bake) basis: &'a Basis,
    pub(in crate::bake) places: &'a Places<'a>,
    /// Albedo, by slot.
    pub(in crate::bake) albedo: &'a [[f32; 3]],
    pub(in crate::bake) run: &'a RunSettings<'a>,
}

impl Folded {
    /// E of all bounces in slots from the radiosity before any, rho E0, under the
    /// albedo that was folded; `near` is T~.
    pub(in crate::bake) fn all_bounces(
        &self,
        level: Level,
        (basis, near): (&Basis, &LowRank),
        (source, albedo): (&[[f32; 3]], &[[f32; 3]]),
    ) -> Vec<[f32; 3]> {
        let beyond = product(albedo, &self.apply(level, (basis, near), source));
        let pairs = source.iter().zip(&beyond);
        let outgoing: Vec<[f32; 3]> = pairs
            .map(|(x, more)| [x[0] + more[0], x[1] + more[1], x[2] + more[2]])
            .collect();
        near.apply(level, basis, &outgoing)
    }

    /// The same before the last bounce.
    fn apply(
        &self,
        level: Level,
        (basis, near): (&Basis, &LowRank),
        source: &[[f32; 3]],
    ) -> Vec<[f32; 3]> {
        let light = by_channel(&basis.project_rgb(level, source));
        let arriving = self.beyond_near.components_of(level, &light);
        let groups: Vec<_> = (0..near.rows.group_count())
            .into_par_iter()
            .with_min_len(crate::bake::GROUPS_PER_TASK)
            .map(|group| {
                let mut sums = near.rows.gather_near(level, group, source);
                let rest = self
                    .beyond_near
                    .rows
                    .gather_functions(level, group, &arriving);
                for (sum, rest) in sums.as_flattened_mut().iter_mut().zip(rest.as_flattened()) {
                    *sum += rest;
                }
                sums
            })
            .collect();
        crate::bake::joined(&near.rows, &groups)
    }

    /// Whether its tables fit each other and T~ on a basis. Says what does not.
    pub(in crate::bake) fn check(&self, near: &LowRank, basis: &Basis) -> Result<(), &'static str> {
        let functions = 3 * basis.function_count();
        self.beyond_near.check(basis.slot_count(), functions)?;
        if self.beyond_near.rows.receivers == near.rows.receivers {
            Ok(())
        } else {
            Err("folded bounces of other groups")
        }
    }

    /// Bytes of all tables.
    pub(crate) fn bytes(&self) -> usize {
        self.beyond_near.bytes()
    }
}

/// Solutions of endless bounces that folding takes, with those that its error is
/// found by.
pub(in crate::bake) fn solutions_to_fold(functions: usize) -> usize {
    functions + RANDOM_LIGHTS + LIGHTS
}

/// Most memory that folding takes: three coordinates of every function in the
/// patterns of every partition.
pub(in crate::bake) fn folding_bytes(partitions: usize, functions: usize) -> usize {
    partitions * 3 * functions * PATTERNS * size_of::<f32>()
}

/// A coefficient of red, green or blue for each function of the three.
fn by_channel(light: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let of = |channel: usize| {
        light.iter().map(move |b| {
            let mut alone = [0.0; 3];
            alone[channel] = b[channel];
            alone
        })
    };
    (0..3).flat_map(of).collect()
}

impl FoldTask<'_> {
    /// Folds the bounces; `None` where they have no limit.
    pub(in crate::bake) fn fold(&self) -> Result<Option<Folded>, BakeError> {
        let (basis, run) = (self.basis, self.run);
        let series = self.series();
        let sigma = self.sigma()?;
        let surface = self.places.surface();
        let roots: Vec<f32> = (0..basis.part_count() as u32)
            .flat_map(|part| roots_of_area(surface, basis, basis.slot_range(part)))
            .collect();
        let columns = Columns {
            series,
            sigma: &sigma,
            roots_of_area: &roots,
            run,
        };
        run.progress.stage("folding bounces", columns.steps());
        // First, since it finds out at once whether there is a limit.
        let Some(constant) = columns.beyond_near(self.albedo) else {
            return Ok(None);
        };
        let Some(factors) = columns.factors()? else {
            return Ok(None);
        };
        let beyond_near = self.quantise(factors, &sigma, &roots, &constant);
        let mut folded = Folded {
            beyond_near,
            errors: LightErrors::default(),
        };
        folded
            .check(self.operator, basis)
            .expect("tables that were just made fit each other");
        folded.errors = self.errors(&folded)?;
        Ok(Some(folded))
    }

    fn series(&self) -> Series<'_> {
        Series {
            operator: self.operator,
            basis: self.basis,
            albedo: self.albedo,
            level: self.run.level,
        }
    }

    /// sigma of the functions of red, green and blue: of what the prior lights
    /// are once they are reflected.
    fn sigma(&self) -> Result<Vec<f32>, BakeError> {
        let mut excitation = Excitation::of_channels(self.basis);
        let take = |brightness: &[f32]| {
            let vertices = self.basis.vertex_of_slot().iter();
            let reflected: Vec<[f32; 3]> = vertices
                .zip(self.albedo)
                .map(|(&vertex, rho)| rho.map(|rho| rho * brightness[vertex as usize]))
                .collect();
            excitation.add_channels(&self.basis.project_rgb(self.run.level, &reflected));
        };
        let count = prior::for_each(self.places, self.run, take).ok_or(BakeError::Cancelled)?;
        Ok(excitation.sigma(count))
    }

    /// The components that bring enough, in bytes. Every receiver answers
    /// `constant`, what lies beyond the near field of all bounces under direct
    /// light of 1 everywhere, in the sum of the channels.
    fn quantise(
        &self,
        factors: Vec<Factors>,
        sigma: &[f32],
        roots_of_area: &[f32],
        constant: &[[f32; 3]],
    ) -> LowRank {
        let basis = self.basis;
        let light = by_channel(&basis.project_rgb(self.run.level, self.albedo));
        let light: Vec<f64> = light
            .iter()
            .zip(sigma)
            .map(|(b, &sigma)| f64::from(b[0] + b[1] + b[2]) / f64::from(sigma))
            .collect();
        let energy_a_byte = least_energy_a_byte(&factors);
        let functions: Vec<u32> = (0..sigma.len() as u32).collect();
        let of_part = |(part, factors): (usize, Factors)| {
            let slots = basis.slot_range(part as u32);
            let rank = rank_of(&factors, energy_a_byte);
            let found = components(&factors, &functions, rank, energy_a_byte, &light);
            let rows = slots.clone().step_by(GROUP).map(|first| {
                let own = first..slots.end.min(first + GROUP);
                let mut targets = [0.0; GROUP];
                for (target, value) in targets.iter_mut().zip(&constant[own.clone()]) {
                    *target = value.iter().map(|&v| f64::from(v)).sum();
                }
                let mut rows = GroupRows::default();
                spread(
                    &factors.left,
                    &roots_of_area[slots.clone()],
                    (first - slots.start, own.len()),
                    &found,
                    (&targets, None),
                    &mut rows,
                );
                rows
            });
            QuantisedPart {
                rows: rows.collect(),
                components: found,
            }
        };
        let parts: Vec<QuantisedPart> = factors.into_par_iter().enumerate().map(of_part).collect();
        join(parts, sigma, 0, receiver_groups(basis))
    }
}

/// Energy for each byte of the last component that is needed for no more to be
/// left out than may be.
fn least_energy_a_byte(factors: &[Factors]) -> f64 {
    let of_part = |part: &Factors| {
        let bytes = part.left.rows.max(1) as f64;
        let energies = part.energies.iter();
        energies.map(|&e| (e / bytes, e)).collect::<Vec<_>>()
    };
    let mut all: Vec<(f64, f64)> = factors.iter().flat_map(of_part).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = LEFT_OUT * LEFT_OUT * all.iter().map(|it| it.1).sum::<f64>();
    let mut left_out = 0.0;
    for (energy_a_byte, energy) in all {
        left_out += energy;
        if left_out > most {
            return energy_a_byte;
        }
    }
    0.0
}

/// Components of a partition that bring as much.
fn rank_of(factors: &Factors, energy_a_byte: f64) -> usize {
    let bytes = factors.left.rows as f64;
    let brings = |e: &&f64| **e > 0.0 && **e / bytes >= energy_a_byte;
    factors.energies.iter().take_while(brings).count()
}
