//! What a bake says of itself.

use super::BakeSettings;
use super::audit::{ErrorParts, LightErrors};
use super::budget;
use super::scheme::{Partitioner, Scheme};
use super::transfer::GroupTransfer;
use crate::maths::order::Order;

/// Figures of one group of receivers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct GroupStats {
    receivers: f64,
    arrived: f64,
    escaped: f64,
    /// Escaped, unless the group sees nothing else.
    escaped_past: f64,
    senders: f64,
}

impl GroupStats {
    pub(super) fn of(transfer: &GroupTransfer, receivers: usize) -> Self {
        Self {
            receivers: receivers as f64,
            arrived: transfer.arrived.iter().sum(),
            escaped: transfer.escaped.iter().sum(),
            escaped_past: if transfer.sees_only_sky() {
                0.0
            } else {
                transfer.escaped.iter().sum()
            },
            senders: transfer.entries.len() as f64,
        }
    }
}

/// Share of all rays that escape past something, 0 to 1.
pub(super) fn escaped_past_something(groups: &[GroupStats]) -> f64 {
    let escaped: f64 = groups.iter().map(|g| g.escaped_past).sum();
    escaped
        / groups
            .iter()
            .map(|g| g.receivers)
            .sum::<f64>()
            .at_least(1.0)
}

/// Figures of a bake, kept in its file.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BakeStats {
    /// How the transfer is stored.
    pub scheme: Scheme,
    /// What cut the mesh into partitions.
    pub partitioner: Partitioner,
    /// Rays a vertex.
    pub rays: u32,
    /// Score below which coefficients were dropped.
    pub threshold: f32,
    /// Share of all rays that arrived at a lit side, 0 to 1.
    pub arrived_share: f64,
    /// Share of all rays that escaped, 0 to 1; the rest met a side that light
    /// cannot reach.
    pub escaped_share: f64,
    /// Senders that a group of eight receivers saw, in the mean.
    pub senders_per_group: f64,
    /// Largest absolute eigenvalue of the compressed operator: bounces stay
    /// bounded where albedo x this is below 1.
    pub largest_eigenvalue: f64,
    /// Energy that arrives over energy that can, 1 where none is lost or
    /// made: mean over lights that the bake did not choose by.
    pub energy_mean: f64,
    /// That of the light for which it is farthest from 1.
    pub energy_worst: f64,
    /// Error that was asked for, if one was.
    pub error_asked: Option<f64>,
    /// Error of one bounce of indirect light, under lights that the bake did not
    /// choose by.
    pub errors: ErrorParts,
    /// How far folded bounces are off from bounces one by one, under 64 of these
    /// lights, where bounces are folded.
    pub folding: Option<LightErrors>,
}

impl BakeStats {
    pub(super) fn of(groups: &[GroupStats], settings: &BakeSettings, threshold: f32) -> Self {
        let sum = |field: fn(&GroupStats) -> f64| groups.iter().map(field).sum::<f64>();
        let receivers = sum(|g| g.receivers).at_least(1.0);
        Self {
            scheme: settings.scheme,
            partitioner: settings.scheme.partitioner(),
            rays: settings.rays,
            error_asked: settings.error,
            threshold,
            arrived_share: sum(|g| g.arrived) / receivers,
            escaped_share: sum(|g| g.escaped) / receivers,
            senders_per_group: sum(|g| g.senders) / groups.len().max(1) as f64,
            // Of the finished operator, so not known yet.
            ..Self::default()
        }
    }
}

impl BakeStats {
    /// What the user should know where the error that was asked for is not
    /// reached: by how much, why, and which key would help.
    pub fn shortfall(&self) -> Option<String> {
        let asked = self.error_asked?;
        let reached = self.errors.total;
        if reached.lights == 0 {
            let asked = percent(asked);
            return Some(format!(
                "no test light brings indirect light: whether that of others is within {asked}, as was \
                 asked for, is not known"
            ));
        }
        if reached.mean <= asked {
            return None;
        }
        let cause = if self.errors.is_of_basis() {
            "the functions of the basis cannot follow the light on vertices this far apart: more \
             bake.functions, or a smaller bake.max_edge (and more bake.vertices where they are the \
             limit) would help"
                .to_owned()
        } else if self.errors.is_of_coefficients() {
            "too much of the transfer is left out: more bake.coefficients would help".to_owned()
        } else {
            let rays = self.rays;
            // Only who sets the key gets more.
            let most = match rays == *budget::RAYS.end() {
                true => ", the most that a search takes,",
                false => "",
            };
            format!("{rays} rays a vertex{most} are too few: more bake.rays would help")
        };
        Some(format!(
            "indirect light is within {} in the mean of test lights, {} were asked for; {cause}",
            percent(reached.mean),
            percent(asked),
        ))
    }
}

fn percent(error: f64) -> String {
    format!("{:.2} %", error * 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_mean(mean: f64) -> LightErrors {
        LightErrors {
            mean,
            lights: 64,
            ..LightErrors::default()
        }
    }

    /// What a bake says that was asked for 2 %, by the parts of its error.
    fn said(total: f64, parts: [f64; 3]) -> Option<String> {
        said_by(6144, total, parts)
    }

    /// The same of one by so many rays.
    fn said_by(rays: u32, total: f64, [basis, compression, noise]: [f64; 3]) -> Option<String> {
        let errors = ErrorParts {
            total: of_mean(total),
            basis: of_mean(basis),
            compression: of_mean(compression),
            noise: of_mean(noise),
            ..ErrorParts::default()
        };
        let stats = BakeStats {
            rays,
            error_asked: Some(0.02),
            errors,
            ..BakeStats::default()
        };
        stats.shortfall()
    }

    #[test]
    fn a_shortfall_names_the_key_that_would_help() {
        let key_of = |total, parts| {
            let text = said(total, parts).expect("it falls short");
            assert!(text.contains("2.00 % were asked for"), "{text}");
            ["functions", "coefficients", "rays"]
                .into_iter()
                .filter(|key| text.contains(&format!("more bake.{key}")))
                .collect::<Vec<_>>()
        };
        assert_eq!(key_of(0.03, [0.025, 0.01, 0.01]), ["functions"]);
        assert_eq!(key_of(0.03, [0.006, 0.014, 0.004]), ["coefficients"]);
        assert_eq!(key_of(0.0201, [0.006, 0.014, 0.015]), ["rays"]);
        for (rays, words) in [
            (
                16_384,
                "16384 rays a vertex, the most that a search takes, are",
            ),
            (6144, "6144 rays a vertex are"),
        ] {
            let of_rays = said_by(rays, 0.0201, [0.006, 0.014, 0.015]).unwrap_or_default();
            assert!(of_rays.contains(words), "{of_rays}");
        }
        assert_eq!(said(0.02, [0.02, 0.01, 0.01]), None);
    }

    #[test]
    fn an_error_of_no_light_is_not_called_reached() {
        let stats = BakeStats {
            error_asked: Some(0.02),
            ..BakeStats::default()
        };
        let text = stats.shortfall().expect("nothing is known");
        assert!(text.contains("no test light"), "{text}");
    }
}
