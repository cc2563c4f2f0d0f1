//! Indirect light at the vertices against transfer by many independent rays,
//! under lights that chose nothing.
//!
//! The truth comes in two halves of independent seeds, and their difference is
//! its noise. A half traces a row of every vertex for the bounces in between
//! and, from each receiver, many rays that nobody keeps for the last one: the
//! dense matrix is used row by row and never stored.

use super::contacts;
use super::statistics::{ByLight, errors, over_lights, standard_error, without_noise};
use super::sweeps::Uncut;
use crate::bake::{
    Bake, BakeError, BakeSettings, LIGHTS, LightErrors, RunSettings, Study, StudyLight,
    VertexFields,
};
use crate::maths::order::Order;
use crate::surface::Surface;

/// Seeds of this report alone: of its lights, of the rows in between and of the
/// last rows of both halves.
pub(super) const LIGHT_SEED: u32 = 0x4e90_47ed;
pub(super) const ROW_SEEDS: [u32; 2] = [0x4e90_0001, 0x4e90_0002];
pub(super) const LAST_SEEDS: [u32; 2] = [0x4e90_0003, 0x4e90_0004];
/// Rays a vertex of the rows in between, each half: their noise of 3 % is
/// independent from vertex to vertex, and the last bounce averages hundreds.
pub(super) const ROW_RAYS: u32 = 1024;
/// Rays a receiver of the last bounce, each half.
pub(super) const LAST_RAYS: u32 = 4096;
/// Scenes of more vertices have a subset of receivers: this many.
const FULL_VERTICES: usize = 20_000;
const SUBSET: usize = 8_192;
/// Points of a vertex's area that stand for all of it.
pub(super) const MANY_POINTS: u32 = 64;
/// Bounces of the longer test.
pub(super) const BOUNCES: u32 = 4;
/// The extremes: a lamp at a corner and a patch.
pub(super) const EXTREMES: usize = 2;

/// Lights, receivers and the truth at them.
pub(super) struct Truth {
    pub(super) lights: Vec<StudyLight>,
    /// Direct light at all vertices: test lights, then the extremes.
    direct: VertexFields,
    /// Grey albedo of the vertices.
    albedo: Vec<f32>,
    pub(super) receivers: Vec<u32>,
    areas: Vec<f64>,
    /// Whether each receiver is within an edge length of a contact.
    near_contact: Vec<bool>,
    /// At the receivers: test lights and extremes after one bounce and after
    /// four, then the test lights after one bounce by many points of each area.
    halves: [VertexFields; 2],
    mean: VertexFields,
}

/// Columns of the truth.
#[derive(Debug, Clone, Copy)]
enum Columns {
    One,
    Four,
    ManyPoints,
}

impl Columns {
    fn range(self) -> std::ops::Range<usize> {
        let all = LIGHTS + EXTREMES;
        match self {
            Self::One => 0..all,
            Self::Four => all..2 * all,
            Self::ManyPoints => 2 * all..2 * all + LIGHTS,
        }
    }
}

/// Errors of one scheme after one bounce and after four.
pub(super) struct SchemeErrors {
    /// By light: test lights, then the extremes.
    pub(super) by_bounces: [ByLight; 2],
    /// Of the test lights after one bounce, at receivers within an edge length of a
    /// contact and at the others, relative to what arrives there.
    pub(super) by_contact: [LightErrors; 2],
}

impl SchemeErrors {
    /// Over the test lights.
    pub(super) fn all(&self, which: usize) -> LightErrors {
        over_lights(&test_lights(&self.by_bounces[which]), |_| true)
    }

    /// Of the mean over the test lights.
    pub(super) fn standard_error(&self, which: usize) -> Option<f64> {
        standard_error(&test_lights(&self.by_bounces[which]))
    }
}

/// The test lights' errors, without the extremes.
pub(super) fn test_lights(errors: &ByLight) -> ByLight {
    errors[..LIGHTS].to_vec()
}

/// Parts of the error after one bounce.
pub(super) struct Parts {
    pub(super) noise: LightErrors,
    pub(super) basis: LightErrors,
    pub(super) compression: LightErrors,
    /// Of the sampled rows on the basis, nothing left out, against the truth.
    pub(super) uncut: LightErrors,
}

impl Parts {
    /// What is left where nothing is cut.
    pub(super) fn uncut(&self) -> Uncut {
        Uncut {
            rows: self.noise.mean,
            on_basis: self.uncut.mean,
        }
    }
}

impl Truth {
    pub(super) fn find(
        study: &Study,
        surface: &Surface,
        bake: &Bake,
        albedo: Vec<f32>,
        run: &RunSettings,
    ) -> Result<Self, BakeError> {
        let (lights, direct) = study.lights(bake.basis(), LIGHT_SEED, run)?;
        let direct = direct.beside(&study.extremes(bake.basis(), LIGHT_SEED));
        let many = by_many_points(study, &lights, &direct, run)?;
        let receivers = receivers(bake);
        let half = |which: usize| -> Result<VertexFields, BakeError> {
            run.progress
                .stage("true rows", surface.vertices.len() as u64);
            let rows = study.trace(ROW_SEEDS[which], ROW_RAYS, run)?;
            let mut brightness = times(&albedo, &direct);
            for _ in 1..BOUNCES {
                let arriving = study.bounce_by(&rows, &brightness);
                brightness = times(&albedo, &plus(&direct, &arriving));
            }
            drop(rows);
            let fields = direct.beside(&brightness).beside(&many);
            run.progress
                .stage("true last bounce", receivers.len() as u64);
            study.bounce_at(&receivers, [LAST_SEEDS[which], LAST_RAYS], &fields, run)
        };
        let halves = [half(0)?, half(1)?];
        let pairs = halves[0].values.iter().zip(&halves[1].values);
        let mean = VertexFields {
            width: halves[0].width,
            values: pairs.map(|(a, b)| 0.5 * (a + b)).collect(),
        };
        Ok(Self {
            areas: receivers
                .iter()
                .map(|&v| f64::from(surface.vertices.open_area(v as usize)))
                .collect(),
            near_contact: contacts::are_near(surface, &receivers),
            lights,
            direct,
            albedo,
            receivers,
            halves,
            mean,
        })
    }

    /// Grey albedo of the vertices.
    pub(super) fn albedo(&self) -> &[f32] {
        &self.albedo
    }

    /// Noise of the truth itself, by light, after one bounce and four.
    pub(super) fn noise(&self) -> [ByLight; 2] {
        [Columns::One, Columns::Four].map(|columns| self.noise_of(columns))
    }

    fn noise_of(&self, columns: Columns) -> ByLight {
        self.noise_over(&self.areas, columns)
    }

    fn noise_over(&self, areas: &[f64], columns: Columns) -> ByLight {
        let [mean, half] = [&self.mean, &self.halves[0]].map(|it| it.columns(columns.range()));
        errors(areas, &mean, &half)
    }

    /// Errors of values at all vertices, without the truth's noise.
    fn errors(&self, columns: Columns, estimate: &VertexFields) -> ByLight {
        self.errors_over(&self.areas, columns, estimate)
    }

    /// The same by some areas of the receivers, 0 for those that do not count.
    fn errors_over(&self, areas: &[f64], columns: Columns, estimate: &VertexFields) -> ByLight {
        let truth = self.mean.columns(columns.range());
        let width = estimate.width;
        let truth = truth.columns(0..width);
        let found = errors(areas, &truth, &estimate.at(&self.receivers));
        without_noise(found, &self.noise_over(areas, columns))
    }

    /// Areas of the receivers within an edge length of a contact, or of the others.
    fn areas_by_contact(&self, near: bool) -> Vec<f64> {
        let pairs = self.areas.iter().zip(&self.near_contact);
        let counts = |(&area, &is_near): (&f64, &bool)| if is_near == near { area } else { 0.0 };
        pairs.map(counts).collect()
    }

    /// Share of the receivers' area within an edge length of a contact, 0 to 1.
    pub(super) fn share_near_contacts(&self) -> f64 {
        let all: f64 = self.areas.iter().sum();
        let near: f64 = self.areas_by_contact(true).iter().sum();
        near / all.at_least(f64::MIN_POSITIVE)
    }

    /// Errors of a bake after one bounce on white and four on the scene's grey.
    pub(super) fn scheme(&self, bake: &Bake, run: &RunSettings) -> SchemeErrors {
        let one = bake.bounce(run.level, &self.direct);
        let mut arriving = bake.bounce(run.level, &times(&self.albedo, &self.direct));
        for _ in 1..BOUNCES {
            let brightness = times(&self.albedo, &plus(&self.direct, &arriving));
            arriving = bake.bounce(run.level, &brightness);
        }
        let by_contact = [true, false].map(|near| {
            let areas = self.areas_by_contact(near);
            let errors = self.errors_over(&areas, Columns::One, &one);
            over_lights(&test_lights(&errors), |_| true)
        });
        SchemeErrors {
            by_bounces: [
                self.errors(Columns::One, &one),
                self.errors(Columns::Four, &arriving),
            ],
            by_contact,
        }
    }

    /// Where a bake's error comes from.
    pub(super) fn parts(
        &self,
        study: &Study,
        bake: &Bake,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<Parts, BakeError> {
        let lights = self.direct.columns(0..LIGHTS);
        let [whole, on_basis] = study.whole_and_on_basis(bake, settings, &lights, run)?;
        let stored = bake.bounce(run.level, &lights);
        let between = |right: &VertexFields, other: &VertexFields| {
            let [right, other] = [right, other].map(|it| it.at(&self.receivers));
            over_lights(&errors(&self.areas, &right, &other), |_| true)
        };
        let against_truth =
            |estimate: &VertexFields| over_lights(&self.errors(Columns::One, estimate), |_| true);
        Ok(Parts {
            noise: against_truth(&whole),
            basis: between(&whole, &on_basis),
            compression: between(&on_basis, &stored),
            uncut: against_truth(&on_basis),
        })
    }

    /// What averaging direct light over a few points of each area costs; skies,
    /// which have no points, are left out. The same rays bring both.
    pub(super) fn vertex_sampling(&self) -> LightErrors {
        over_lights(&self.vertex_sampling_by_light(), |light| {
            self.lights[light].placed.is_some()
        })
    }

    /// The same by light; `None` for one that does not arrive.
    pub(super) fn vertex_sampling_by_light(&self) -> ByLight {
        let few = self.mean.columns(0..LIGHTS);
        let many = self.mean.columns(Columns::ManyPoints.range());
        errors(&self.areas, &many, &few)
    }
}

/// All vertices, or a subset spread over the order in which the rows work.
fn receivers(bake: &Bake) -> Vec<u32> {
    let all = bake.basis().vertex_of_slot();
    if all.len() <= FULL_VERTICES {
        return all.to_vec();
    }
    let place = |i: usize| all[(2 * i + 1) * all.len() / (2 * SUBSET)];
    (0..SUBSET).map(place).collect()
}

/// Direct light of the test lights by many points of each area, scaled as the
/// light by few points is.
fn by_many_points(
    study: &Study,
    lights: &[StudyLight],
    direct: &VertexFields,
    run: &RunSettings,
) -> Result<VertexFields, BakeError> {
    run.progress.stage("direct light", lights.len() as u64);
    let columns: Result<Vec<Vec<f32>>, BakeError> = lights
        .iter()
        .enumerate()
        .map(|(number, light)| {
            if run.progress.cancelled() {
                return Err(BakeError::Cancelled);
            }
            run.progress.advance(1);
            let scaled = direct.column(number);
            let Some(placed) = &light.placed else {
                return Ok(scaled);
            };
            let [many, few] = study.by_many_points_and_few(placed, MANY_POINTS, run.level);
            let sum = |values: &[f32]| values.iter().map(|&v| f64::from(v)).sum::<f64>();
            let scale = sum(&scaled) / sum(&few).at_least(f64::MIN_POSITIVE);
            Ok(many
                .iter()
                .map(|&e| (f64::from(e) * scale) as f32)
                .collect())
        })
        .collect();
    Ok(VertexFields::of_columns(&columns?))
}

/// Fields times a value a vertex.
fn times(factors: &[f32], fields: &VertexFields) -> VertexFields {
    let rows = factors.iter().zip(fields.rows());
    VertexFields {
        width: fields.width,
        values: rows
            .flat_map(|(f, row)| row.iter().map(move |v| f * v))
            .collect(),
    }
}

fn plus(a: &VertexFields, b: &VertexFields) -> VertexFields {
    VertexFields {
        width: a.width,
        values: a.values.iter().zip(&b.values).map(|(a, b)| a + b).collect(),
    }
}
