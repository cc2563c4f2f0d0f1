//! Compressed rows: eight receivers share two lists, near field and
//! coefficients of a table of functions.
//!
//!   E_i = sum_near w_ij B_j + sum_k c_ik b_k
//!
//! The functions are those of a basis, listed, or the components of a low-rank
//! product, of which a group reads a run.
//!
//! w is u8 with a step a receiver; c is i8 with a step a receiver in two bands
//! of magnitude: the coarse entries first, then the fine ones, whose step is
//! [`FINE_BAND`] times smaller.

use super::transfer::GROUP;
use crate::simd::Level;
use crate::simd::rows::{GroupSums, dot, dot_run};

/// Ratio of the steps of the two bands.
pub(crate) const FINE_BAND: f32 = 16.0;

/// One group's rows before they join the table.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroupRows {
    /// Senders (slots) of the near field.
    pub(crate) near: Vec<u32>,
    pub(crate) near_weights: Vec<[u8; GROUP]>,
    pub(crate) near_steps: [f32; GROUP],
    /// Basis functions, coarse band first.
    pub(crate) functions: Vec<u32>,
    pub(crate) coefficients: Vec<[i8; GROUP]>,
    /// How many of `functions` are in the coarse band.
    pub(crate) coarse: u32,
    pub(crate) basis_steps: [f32; GROUP],
}

/// Positions in a table, 16 bits wide where they suffice.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Indices {
    Narrow(Vec<u16>),
    Wide(Vec<u32>),
}

impl Indices {
    pub(super) fn for_table(len: usize) -> Self {
        if len <= 1 << 16 {
            Self::Narrow(Vec::new())
        } else {
            Self::Wide(Vec::new())
        }
    }

    pub(super) fn extend(&mut self, more: &[u32]) {
        match self {
            Self::Narrow(list) => list.extend(more.iter().map(|&i| i as u16)),
            Self::Wide(list) => list.extend_from_slice(more),
        }
    }

    /// Number of entries.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Narrow(list) => list.len(),
            Self::Wide(list) => list.len(),
        }
    }

    /// Bytes of all entries.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Narrow(list) => list.len() * 2,
            Self::Wide(list) => list.len() * 4,
        }
    }

    pub(super) fn largest(&self) -> Option<u32> {
        match self {
            Self::Narrow(list) => list.iter().max().map(|&i| u32::from(i)),
            Self::Wide(list) => list.iter().max().copied(),
        }
    }
}

/// Which functions a group's coefficients belong to.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Columns {
    /// Each is named.
    Listed(Indices),
    /// A run from this function on, by group.
    Runs(Vec<u32>),
}

impl Columns {
    fn bytes(&self) -> usize {
        match self {
            Self::Listed(list) => list.bytes(),
            Self::Runs(first) => first.len() * 4,
        }
    }
}

/// The rows of all groups. Fields are checked against each other when a table
/// is made, in memory or from a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rows {
    /// Senders that the near field may name: slots, or cells of the sky.
    pub(super) sender_count: usize,
    pub(super) function_count: usize,
    /// Entries before each group; one more than there are groups.
    pub(super) near_offsets: Vec<u32>,
    pub(super) near: Indices,
    pub(super) near_weights: Vec<[u8; GROUP]>,
    pub(super) near_steps: Vec<[f32; GROUP]>,
    pub(super) basis_offsets: Vec<u32>,
    pub(super) coarse: Vec<u32>,
    pub(super) functions: Columns,
    pub(super) coefficients: Vec<[i8; GROUP]>,
    pub(super) basis_steps: Vec<[f32; GROUP]>,
    /// Slots of each group: the first, and how many.
    pub(super) receivers: Vec<(u32, u32)>,
}

impl Rows {
    /// Joins groups in their order; `receivers` names the slots of each.
    pub(super) fn join(
        sender_count: usize,
        function_count: usize,
        receivers: Vec<(u32, u32)>,
        groups: &[GroupRows],
    ) -> Self {
        let mut functions = Indices::for_table(function_count);
        groups.iter().for_each(|g| functions.extend(&g.functions));
        let functions = Columns::Listed(functions);
        Self::join_columns(sender_count, function_count, receivers, groups, functions)
    }

    /// The same of groups whose coefficients belong to a run of functions each.
    pub(super) fn join_runs(
        sender_count: usize,
        function_count: usize,
        receivers: Vec<(u32, u32)>,
        groups: &[GroupRows],
        first_functions: Vec<u32>,
    ) -> Self {
        let runs = Columns::Runs(first_functions);
        Self::join_columns(sender_count, function_count, receivers, groups, runs)
    }

    fn join_columns(
        sender_count: usize,
        function_count: usize,
        receivers: Vec<(u32, u32)>,
        groups: &[GroupRows],
        functions: Columns,
    ) -> Self {
        let mut rows = Self {
            sender_count,
            function_count,
            near_offsets: vec![0],
            near: Indices::for_table(sender_count),
            near_weights: Vec::new(),
            near_steps: Vec::new(),
            basis_offsets: vec![0],
            coarse: Vec::new(),
            functions,
            coefficients: Vec::new(),
            basis_steps: Vec::new(),
            receivers,
        };
        for group in groups {
            rows.near.extend(&group.near);
            rows.near_weights.extend_from_slice(&group.near_weights);
            rows.near_steps.push(group.near_steps);
            rows.near_offsets.push(rows.near_weights.len() as u32);
            rows.coefficients.extend_from_slice(&group.coefficients);
            rows.coarse.push(group.coarse);
            rows.basis_steps.push(group.basis_steps);
            rows.basis_offsets.push(rows.coefficients.len() as u32);
        }
        rows
    }

    /// Whether every list fits the others and every index its table, so that
    /// the kernels never leave a table, and whether the receivers are all of
    /// `slot_count` slots. Says what does not.
    pub(super) fn check(&self, slot_count: usize) -> Result<(), &'static str> {
        let groups = self.receivers.len();
        let offsets_fit = |offsets: &[u32], len: usize| {
            offsets.len() == groups + 1
                && offsets[0] == 0
                && offsets.is_sorted()
                && offsets.last().is_some_and(|&last| last as usize == len)
        };
        let lengths = [
            self.near_steps.len(),
            self.basis_steps.len(),
            self.coarse.len(),
        ];
        if lengths.iter().any(|&len| len != groups) {
            return Err("groups of unequal number");
        }
        if !offsets_fit(&self.near_offsets, self.near_weights.len())
            || self.near.len() != self.near_weights.len()
        {
            return Err("near field of the wrong length");
        }
        if !offsets_fit(&self.basis_offsets, self.coefficients.len()) {
            return Err("coefficients of the wrong length");
        }
        let near_fits = |index: u32| (index as usize) < self.sender_count;
        if !self.near.largest().is_none_or(near_fits) {
            return Err("an index beyond its table");
        }
        self.check_functions()?;
        let coarse_fits =
            |g: usize| self.coarse[g] <= self.basis_offsets[g + 1] - self.basis_offsets[g];
        if !(0..groups).all(coarse_fits) {
            return Err("a coarse band longer than its row");
        }
        let mut next = 0_u32;
        for &(first, count) in &self.receivers {
            if first != next || count == 0 || count as usize > GROUP {
                return Err("receivers out of order");
            }
            next += count;
        }
        if next as usize == slot_count {
            Ok(())
        } else {
            Err("receivers that do not cover the vertices")
        }
    }

    fn check_functions(&self) -> Result<(), &'static str> {
        match &self.functions {
            Columns::Listed(list) => {
                let fits = |index: u32| (index as usize) < self.function_count;
                if list.len() != self.coefficients.len() {
                    Err("coefficients of the wrong length")
                } else if list.largest().is_none_or(fits) {
                    Ok(())
                } else {
                    Err("an index beyond its table")
                }
            }
            Columns::Runs(first) => {
                let length = |g: usize| self.basis_offsets[g + 1] - self.basis_offsets[g];
                let fits = |g: usize| {
                    let end = u64::from(first[g]) + u64::from(length(g));
                    end <= self.function_count as u64
                };
                if first.len() == self.receivers.len() && (0..first.len()).all(fits) {
                    Ok(())
                } else {
                    Err("a run beyond its table")
                }
            }
        }
    }

    /// Number of groups.
    pub(crate) fn group_count(&self) -> usize {
        self.receivers.len()
    }

    /// First slot of a group, and how many slots it has.
    pub(crate) fn receivers(&self, group: usize) -> (usize, usize) {
        let (first, count) = self.receivers[group];
        (first as usize, count as usize)
    }

    /// Senders of a group's near field.
    pub(super) fn near_of(&self, group: usize) -> Vec<u32> {
        let range = self.near_offsets[group] as usize..self.near_offsets[group + 1] as usize;
        match &self.near {
            Indices::Narrow(list) => list[range].iter().map(|&i| u32::from(i)).collect(),
            Indices::Wide(list) => list[range].to_vec(),
        }
    }

    /// Whether a group has an entry at all.
    pub(crate) fn is_empty(&self, group: usize) -> bool {
        self.near_offsets[group] == self.near_offsets[group + 1]
            && self.basis_offsets[group] == self.basis_offsets[group + 1]
    }

    /// Irradiance of a group's receivers (a channel, then a lane) from the
    /// radiosity of all slots and the light's basis coefficients.
    pub(crate) fn gather(
        &self,
        level: Level,
        group: usize,
        radiosity: &[[f32; 3]],
        light: &[[f32; 3]],
    ) -> GroupSums {
        let mut sums = self.gather_near(level, group, radiosity);
        let smooth = self.gather_functions(level, group, light);
        for channel in 0..3 {
            for lane in 0..GROUP {
                sums[channel][lane] += smooth[channel][lane];
            }
        }
        sums
    }

    /// What the near field alone brings.
    pub(super) fn gather_near(
        &self,
        level: Level,
        group: usize,
        radiosity: &[[f32; 3]],
    ) -> GroupSums {
        let range = self.near_offsets[group] as usize..self.near_offsets[group + 1] as usize;
        let weights = &self.near_weights[range.clone()];
        let mut sums = gather_list(level, &self.near, range, weights, radiosity);
        for channel in &mut sums {
            for (sum, step) in channel.iter_mut().zip(&self.near_steps[group]) {
                *sum *= step;
            }
        }
        sums
    }

    /// What the functions alone bring.
    pub(super) fn gather_functions(
        &self,
        level: Level,
        group: usize,
        light: &[[f32; 3]],
    ) -> GroupSums {
        let basis = self.basis_offsets[group] as usize..self.basis_offsets[group + 1] as usize;
        let split = basis.start + self.coarse[group] as usize;
        let band = |range: std::ops::Range<usize>| {
            let coefficients = &self.coefficients[range.clone()];
            match &self.functions {
                Columns::Listed(list) => gather_list(level, list, range, coefficients, light),
                Columns::Runs(first) => {
                    let start = first[group] as usize + (range.start - basis.start);
                    dot_run(level, coefficients, &light[start..start + range.len()])
                }
            }
        };
        let (coarse, fine) = (band(basis.start..split), band(split..basis.end));
        let steps = &self.basis_steps[group];
        let mut sums = coarse;
        for channel in 0..3 {
            for lane in 0..GROUP {
                let smooth = coarse[channel][lane] + fine[channel][lane] * (1.0 / FINE_BAND);
                sums[channel][lane] = smooth * steps[lane];
            }
        }
        sums
    }

    /// Bytes of the operator, all lists and steps.
    pub(crate) fn bytes(&self) -> usize {
        self.near.bytes()
            + self.functions.bytes()
            + (self.near_weights.len() + self.coefficients.len()) * GROUP
            + (self.near_steps.len() + self.basis_steps.len()) * GROUP * 4
            + (self.near_offsets.len() + self.basis_offsets.len() + self.coarse.len()) * 4
    }

    /// Entries a vertex in the mean, near field included.
    pub(crate) fn coefficients_per_vertex(&self) -> f64 {
        let entries: usize = (0..self.group_count())
            .map(|g| {
                let near = self.near_offsets[g + 1] - self.near_offsets[g];
                let basis = self.basis_offsets[g + 1] - self.basis_offsets[g];
                (near + basis) as usize * self.receivers[g].1 as usize
            })
            .sum();
        let receivers: u32 = self.receivers.iter().map(|&(_, count)| count).sum();
        entries as f64 / f64::from(receivers.max(1))
    }
}

fn gather_list<Q: crate::simd::rows::Quantised>(
    level: Level,
    indices: &Indices,
    range: std::ops::Range<usize>,
    weights: &[[Q; GROUP]],
    table: &[[f32; 3]],
) -> GroupSums {
    match indices {
        Indices::Narrow(list) => dot(level, &list[range], weights, table),
        Indices::Wide(list) => dot(level, &list[range], weights, table),
    }
}
