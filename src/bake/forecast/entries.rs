//! What rows will hold, and their bytes, by the rules of the bake itself.

use crate::bake::compress::Budget;
use crate::bake::pilot::GroupView;
use crate::bake::scheme::Scheme;
use crate::bake::transfer::GROUP;
use crate::bake::{BakeSettings, low_rank, sky};
use crate::maths::cube_cells::CELL_COUNT;
use crate::maths::order::Order;

/// Entries of a group's lists, in the mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entries {
    pub(super) near: f64,
    pub(super) basis: f64,
}

impl Entries {
    /// A group whose rays met so many senders, of which those with functions.
    fn of_group(budget: Budget, senders: f64, functions: f64) -> Self {
        let near = senders.at_most(budget.near as f64);
        let is_spending = senders > near;
        let most = if is_spending {
            budget.basis as f64
        } else {
            0.0
        };
        Self {
            near,
            basis: most.at_most(functions),
        }
    }

    fn mean(of_groups: impl ExactSizeIterator<Item = Self>) -> Self {
        let count = of_groups.len().max(1) as f64;
        let (near, basis) = of_groups.fold((0.0, 0.0), |(near, basis), entries| {
            (near + entries.near, basis + entries.basis)
        });
        Self {
            near: near / count,
            basis: basis / count,
        }
    }

    /// Bytes of rows, as [`crate::bake::rows::Rows::bytes`] counts them.
    pub(super) fn row_bytes(self, groups: usize, senders: usize, functions: usize) -> usize {
        let index = |table: usize| if table <= 1 << 16 { 2.0 } else { 4.0 };
        let near = self.near * (index(senders) + GROUP as f64);
        let basis = self.basis * (index(functions) + GROUP as f64);
        ((near + basis) * groups as f64) as usize + groups * (2 * GROUP * 4 + 3 * 4)
    }

    /// Bytes of a near field and a product, as [`crate::bake::low_rank::LowRank::bytes`]
    /// counts them.
    pub(super) fn low_rank_bytes(
        self,
        groups: usize,
        senders: usize,
        functions: usize,
        parts: usize,
    ) -> usize {
        // The components of a group are a run: its functions have no numbers.
        let rows = Self { basis: 0.0, ..self }.row_bytes(groups, senders, functions)
            + (self.basis * GROUP as f64 * groups as f64) as usize
            + groups * 4;
        let component_groups = self.basis * parts as f64 / GROUP as f64;
        let lists = Self {
            near: 0.0,
            basis: functions as f64 * LISTED_SHARE,
        };
        rows + functions * 4 + lists.row_bytes(component_groups.ceil() as usize, 0, functions)
    }
}

/// Share of all functions that a group of components lists: 0.05 in the window's
/// room, 0.06 in the statues' hall, 0.08 in cornell, 0.12 in the sheet's room. (Bytes
/// of rows are then 1.11, 1.02, 0.94 and 0.84 of those of default bakes.)
const LISTED_SHARE: f64 = 0.06;

/// Share of the components paid for that stand out of the noise of so many rays: 0.55
/// in a small room at 64, all of them in the larger scenes from 128 on.
fn components_kept(rays: u32) -> f64 {
    1.0 - 0.4 * (64.0 / f64::from(rays)).at_most(1.0)
}

/// Bytes of the published table, as [`crate::bake::paper::PaperRows::bytes`] counts
/// them, of so many coefficients a vertex.
pub(super) fn paper_bytes(coefficients: f64, vertices: usize, functions: usize) -> usize {
    let entry = if functions <= 1 << 16 { 3.0 } else { 5.0 };
    (coefficients * entry * vertices as f64) as usize + vertices * 5 + 8
}

/// Entries of the rows of all groups.
pub(super) fn surface_entries(views: &[GroupView], settings: &BakeSettings) -> Entries {
    if settings.scheme == Scheme::Paper {
        // The largest of every vertex: nobody leaves anything to others.
        let budget = Budget {
            near: 0,
            basis: settings.coefficients as usize,
        };
        let of_group =
            |view: &GroupView| Entries::of_group(budget, view.most_senders, view.functions as f64);
        return Entries::mean(views.iter().map(of_group));
    }
    let own = low_rank::Budget::of(settings.coefficients);
    let senders = views.iter().map(|view| view.most_senders).collect();
    let budget = Budget {
        near: evened(own.near, senders),
        basis: (own.rank as f64 * components_kept(settings.rays)) as usize,
    };
    let functions = |view: &GroupView| {
        let is_spending = view.most_senders > budget.near as f64;
        if is_spending {
            view.functions as f64
        } else {
            0.0
        }
    };
    let budget = Budget {
        basis: evened(budget.basis, views.iter().map(functions).collect()),
        ..budget
    };
    let of_group =
        |view: &GroupView| Entries::of_group(budget, view.most_senders, view.functions as f64);
    Entries::mean(views.iter().map(of_group))
}

/// What a group may spend when those that see little leave the others the rest:
/// `mean` is that over all groups. `wanted` of each.
fn evened(mean: usize, wanted: Vec<f64>) -> usize {
    let total = (mean * wanted.len()) as f64;
    let (mut low, mut high) = (mean, mean * wanted.len().max(1));
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        let spent: f64 = wanted.iter().map(|w| w.at_most(middle as f64)).sum();
        if spent <= total {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    low
}

/// Entries of the rows of the sky.
pub(super) fn sky_entries(views: &[GroupView]) -> Entries {
    let budget = Budget::of(sky::COEFFICIENTS);
    let of_group = |view: &GroupView| {
        let sees_only_sky = view.most_senders == 0.0;
        let cells = if sees_only_sky {
            0.0
        } else {
            view.most_cells.at_most(CELL_COUNT as f64)
        };
        Entries::of_group(budget, cells, f64::from(sky::FUNCTIONS))
    };
    Entries::mean(views.iter().map(of_group))
}
