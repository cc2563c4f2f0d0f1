//! From the components of all partitions to one operator.

use super::LowRank;
use super::quantise::Components;
use crate::bake::rows::{GroupRows, Rows};

/// A partition in bytes.
pub(super) struct QuantisedPart {
    pub(super) components: Components,
    /// Its groups of receivers: near field and U.
    pub(super) rows: Vec<GroupRows>,
}

/// Joins partitions in their order. `sigma` scales the functions that V stands
/// over, the near field names some of `sender_count` slots, and `groups` are the
/// receivers of all.
pub(super) fn join(
    parts: Vec<QuantisedPart>,
    sigma: &[f32],
    sender_count: usize,
    groups: Vec<(u32, u32)>,
) -> LowRank {
    let (mut component_groups, mut component_receivers) = (Vec::new(), Vec::new());
    let (mut rows, mut first_components) = (Vec::new(), Vec::new());
    let mut next = 0_u32;
    for part in parts {
        first_components.extend(std::iter::repeat_n(next, part.rows.len()));
        rows.extend(part.rows);
        let found = part.components;
        for (group, count) in found.groups.into_iter().zip(found.counts) {
            component_groups.push(group);
            component_receivers.push((next, count));
            next += count;
        }
    }
    LowRank {
        scales: sigma.iter().map(|s| 1.0 / s).collect(),
        components: Rows::join(0, sigma.len(), component_receivers, &component_groups),
        rows: Rows::join_runs(sender_count, next as usize, groups, &rows, first_components),
    }
}
