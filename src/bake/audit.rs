//! How wrong an operator is: its indirect light against transfer that was
//! sampled many times as well, at some of the vertices, under lights that chose
//! nothing.
//!
//! The error of one light is sqrt(sum A (E - R)^2 / sum A R^2) over receivers, of
//! one bounce of its direct light on white surfaces; A is the area that is in the
//! open. (With all area, floor under the Cornell box's blocks was half of all
//! error: its rays nearly all end inside, and nobody sees it.) R has noise too;
//! its two halves, of independent seeds, say how much, and that is taken off. The
//! receivers are whole groups of eight, spread over the scene.

use rayon::prelude::*;

use super::compress::split_senders;
use super::operator::vertices_of;
use super::receivers::{Receivers, Truth};
use super::test_lights::{Fields, LIGHTS, TestLights};
use super::transfer::{self, GROUP, GroupTransfer, Sampling, sample_group};
use super::{Bake, BakeSettings, RunSettings};
use crate::bake::basis::Basis;
use crate::simd::Level;
use crate::surface::Surface;

/// Seeds of the two halves of the truth that a bake's figure is against.
pub(super) const TRUE_SEEDS: [u32; 2] = [0x51d_e001, 0x51d_e002];

/// How much an audit looks at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AuditSize {
    /// Groups of eight receivers.
    pub(crate) groups: usize,
    /// Rays of each half of the truth.
    pub(crate) rays: u32,
}

impl AuditSize {
    /// What a bake does for its own figure: some 8 million rays at 1,024 receivers.
    /// (Those of 512 stated a quarter more than all vertices showed in cornell.)
    pub(crate) const SHORT: Self = Self {
        groups: 128,
        rays: 4096,
    };
}

/// Relative errors of indirect light over the test lights: root mean square
/// over the area, 0.01 is one per cent.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LightErrors {
    /// Mean over the lights.
    pub mean: f64,
    /// 95th percentile over the lights.
    pub p95: f64,
    /// The light with the largest error.
    pub worst: f64,
    /// Mean over the lights of the relative error of their sum over the area.
    pub signed: f64,
    /// Lights that arrive, which these are of; without any, the figures are 0 and
    /// say nothing.
    pub lights: usize,
}

/// The basis is to blame from this share of the whole error on.
const OF_BASIS: f64 = 0.7;
/// What is left out is to blame from so many times the rays' noise on: it holds the
/// noise too, most of which is better left out. `window` has 1.0 by 12,288 rays and 90
/// coefficients, trials of the statues 2.3 to 3.3 by the defaults.
const OF_COEFFICIENTS: f64 = 1.5;

/// Errors of an operator, and where they come from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorParts {
    /// Of the stored operator.
    pub total: LightErrors,
    /// Of the sampled rows before anything was left out. A low-rank product
    /// removes a good part of it, so that the total may be smaller.
    pub noise: LightErrors,
    /// What the functions of the basis cannot express of the light, with the
    /// near field.
    pub basis: LightErrors,
    /// What is stored, against the sampled rows on all functions: what was left
    /// out, noise included.
    pub compression: LightErrors,
    /// Noise of the truth that was taken off.
    pub truth: LightErrors,
}

impl ErrorParts {
    /// Whether functions that cannot follow the light are mostly to blame.
    pub(super) fn is_of_basis(&self) -> bool {
        self.basis.mean > OF_BASIS * self.total.mean
    }

    /// Whether, if not, coefficients that are left out are, and not rays.
    pub(super) fn is_of_coefficients(&self) -> bool {
        self.compression.mean > OF_COEFFICIENTS * self.noise.mean
    }

    fn all(&self) -> [LightErrors; 5] {
        [
            self.total,
            self.noise,
            self.basis,
            self.compression,
            self.truth,
        ]
    }

    /// All figures, for a file.
    pub(super) fn numbers(&self) -> Vec<f64> {
        self.all().iter().flat_map(LightErrors::numbers).collect()
    }

    /// What [`Self::numbers`] gave; `None` if these are not so many.
    pub(super) fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (groups, []) = numbers.as_chunks::<5>() else {
            return None;
        };
        let of = LightErrors::of_numbers;
        let [total, noise, basis, compression, truth] = groups else {
            return None;
        };
        Some(Self {
            total: of(total),
            noise: of(noise),
            basis: of(basis),
            compression: of(compression),
            truth: of(truth),
        })
    }
}

impl LightErrors {
    /// All figures, for a file.
    pub(super) fn numbers(&self) -> [f64; 5] {
        let lights = self.lights as f64;
        [self.mean, self.p95, self.worst, self.signed, lights]
    }

    /// What [`Self::numbers`] gave; `None` if these are not so many.
    pub(super) fn from_numbers(numbers: &[f64]) -> Option<Self> {
        numbers.try_into().ok().map(Self::of_numbers)
    }

    fn of_numbers(&[mean, p95, worst, signed, lights]: &[f64; 5]) -> Self {
        Self {
            mean,
            p95,
            worst,
            signed,
            lights: lights as usize,
        }
    }

    /// Statistics over the lights that arrive.
    pub(crate) fn of(errors: &[Option<[f64; 2]>; LIGHTS]) -> Self {
        let found: Vec<[f64; 2]> = errors.iter().copied().flatten().collect();
        if found.is_empty() {
            return Self::default();
        }
        let mut sizes: Vec<f64> = found.iter().map(|e| e[0]).collect();
        sizes.sort_by(f64::total_cmp);
        let count = found.len() as f64;
        let place = (0.95 * (sizes.len() - 1) as f64).ceil() as usize;
        Self {
            mean: sizes.iter().sum::<f64>() / count,
            p95: sizes[place],
            worst: sizes[sizes.len() - 1],
            signed: found.iter().map(|e| e[1]).sum::<f64>() / count,
            lights: found.len(),
        }
    }
}

/// One bounce of the lights by the stored operator, slots.
pub(crate) fn stored_bounce(bake: &Bake, level: Level, fields: &Fields) -> Fields {
    in_threes(fields, |radiosity| bake.apply(level, radiosity))
}

/// Fields that an operator on RGB makes of fields.
pub(super) fn in_threes(fields: &Fields, apply: impl Fn(&[[f32; 3]]) -> Vec<[f32; 3]>) -> Fields {
    let mut out = vec![[0.0; LIGHTS]; fields.len()];
    for first in (0..LIGHTS).step_by(3) {
        let channels = first..(first + 3).min(LIGHTS);
        let radiosity: Vec<[f32; 3]> = fields
            .iter()
            .map(|values| {
                let mut rgb = [0.0; 3];
                rgb[..channels.len()].copy_from_slice(&values[channels.clone()]);
                rgb
            })
            .collect();
        for (out, rgb) in out.iter_mut().zip(apply(&radiosity)) {
            out[channels.clone()].copy_from_slice(&rgb[..channels.len()]);
        }
    }
    out
}

/// What the basis keeps of the lights: S S^T B, slots.
pub(super) fn smooth(basis: &Basis, level: Level, fields: &Fields) -> Fields {
    in_threes(fields, |values| {
        basis.reconstruct_rgb(&basis.project_rgb(level, values))
    })
}

/// Audits a finished bake under test lights.
pub(crate) fn audit(
    bake: &Bake,
    surface: &Surface,
    settings: &BakeSettings,
    lights: &TestLights,
    size: AuditSize,
    run: &RunSettings,
) -> ErrorParts {
    let receivers = Receivers::spread(surface, bake.basis(), size.groups);
    let stored = |fields: &Fields| stored_bounce(bake, run.level, fields);
    let near_of = |first_slot| bake.operator().near_of(first_slot);
    let fields = &lights.brightness;
    let basis = bake.basis();
    let job = (surface, basis, run.level);
    let truth = Truth::sample(job, &receivers, (TRUE_SEEDS, size.rays), fields);
    let job = (surface, basis, settings, run);
    audit_at(job, (&receivers, &truth), lights, (stored, near_of))
}

/// Audits an operator, given as what it makes of fields and as the senders of the
/// near field of a group by its first slot, at some receivers.
pub(super) fn audit_at(
    (surface, basis, settings, run): (&Surface, &Basis, &BakeSettings, &RunSettings),
    (receivers, truth): (&Receivers, &Truth),
    lights: &TestLights,
    (stored, near_of): (impl Fn(&Fields) -> Fields, impl Fn(u32) -> Vec<u32> + Sync),
) -> ErrorParts {
    let fields = &lights.brightness;
    let sampling = Sampling {
        surface,
        level: run.level,
        slot_of_vertex: basis.slot_of_vertex(),
        rays: settings.rays,
    };
    let kept = smooth(basis, run.level, fields);
    let sampled: Vec<[Vec<[f32; LIGHTS]>; 2]> = receivers
        .groups()
        .par_iter()
        .map_init(
            || transfer::Scratch::new(basis.slot_count()),
            |scratch, &group| {
                let rows = sample_group(&sampling, vertices_of(basis, group), scratch);
                let near = near_of(group.0);
                whole_and_on_basis(&rows, &near, group.1 as usize, fields, &kept)
            },
        )
        .collect();
    let (whole, on_basis): (Vec<_>, Vec<_>) = sampled.into_iter().map(|[a, b]| (a, b)).unzip();
    let (whole, on_basis) = (whole.concat(), on_basis.concat());
    let stored = receivers.pick(&stored(fields));
    let between = |right: &Fields, other: &Fields| LightErrors::of(&receivers.errors(right, other));
    let against_truth = |estimate: &Fields| LightErrors::of(&truth.errors(receivers, estimate));
    ErrorParts {
        total: against_truth(&stored),
        noise: against_truth(&whole),
        basis: between(&whole, &on_basis),
        compression: between(&on_basis, &stored),
        truth: LightErrors::of(&truth.noise(receivers)),
    }
}

/// What a group receives of the lights by its sampled rows, and by its near
/// field (of these senders) and the rest of the rows on the basis.
pub(super) fn whole_and_on_basis(
    rows: &GroupTransfer,
    near: &[u32],
    count: usize,
    fields: &Fields,
    kept: &Fields,
) -> [Vec<[f32; LIGHTS]>; 2] {
    let gather = |entries: &[(u32, [f32; GROUP])], fields: &Fields| {
        let mut sums = vec![[0.0_f32; LIGHTS]; count];
        for (slot, weights) in entries {
            let values = &fields[*slot as usize];
            for (sums, &weight) in sums.iter_mut().zip(weights) {
                for light in 0..LIGHTS {
                    sums[light] += weight * values[light];
                }
            }
        }
        sums
    };
    let split = split_senders(rows, near);
    let near = gather(&split.near, fields);
    let sum = |rest: Vec<[f32; LIGHTS]>| {
        let pairs = near.iter().zip(&rest);
        pairs
            .map(|(a, b)| std::array::from_fn(|l| a[l] + b[l]))
            .collect()
    };
    [
        sum(gather(&split.remainder, fields)),
        sum(gather(&split.remainder, kept)),
    ]
}
