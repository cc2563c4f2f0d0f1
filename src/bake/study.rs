//! Many bakes of one surface, and what they are measured by. What does not
//! depend on a bake's settings is computed once: rays, places of lights, prior
//! lights. A bake of a study has the transfer of any other bake of the same
//! settings, bit by bit; it has no sky and states no error of itself.

use rayon::prelude::*;

use super::audit::{smooth, whole_and_on_basis};
use super::budget::settings_for_error;
use super::excitation::Excitation;
use super::operator::{receiver_groups, vertices_of};
use super::places::Places;
use super::test_lights::{Fields, LIGHTS, TestKind, TestLights};
use super::transfer::{self, Sampling, sample_group, trace_arrivals, vertex_rays};
use super::{
    Bake, BakeError, BakeSettings, Importance, Operator, RunSettings, Scheme, low_rank, paper,
    prior, spectral_basis,
};
use crate::bake::basis::Basis;
use crate::bake::stats::BakeStats;
use crate::scene::{PlacedLight, Scene};
use crate::simd::Level;
use crate::surface::{Arrival, Detail, KeptArrivals, Surface, direct};

/// Values of several fields at every vertex, or at some of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VertexFields {
    /// Fields.
    pub(crate) width: usize,
    /// Vertex by vertex.
    pub(crate) values: Vec<f32>,
}

impl VertexFields {
    /// Fields side by side, each a value a vertex.
    pub(crate) fn of_columns(columns: &[Vec<f32>]) -> Self {
        let count = columns.first().map_or(0, Vec::len);
        let values = (0..count).flat_map(|v| columns.iter().map(move |column| column[v]));
        Self {
            width: columns.len(),
            values: values.collect(),
        }
    }

    /// The values of one vertex.
    pub(crate) fn row(&self, vertex: usize) -> &[f32] {
        &self.values[vertex * self.width..(vertex + 1) * self.width]
    }

    /// The values of one field.
    pub(crate) fn column(&self, field: usize) -> Vec<f32> {
        self.rows().map(|row| row[field]).collect()
    }

    /// The values of all vertices.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.values.chunks_exact(self.width.max(1))
    }

    /// Fields of a range of this one.
    pub(crate) fn columns(&self, range: std::ops::Range<usize>) -> Self {
        Self {
            width: range.len(),
            values: self
                .rows()
                .flat_map(|row| &row[range.clone()])
                .copied()
                .collect(),
        }
    }

    /// The fields of some vertices.
    pub(crate) fn at(&self, vertices: &[u32]) -> Self {
        let rows = vertices.iter().flat_map(|&v| self.row(v as usize));
        Self {
            width: self.width,
            values: rows.copied().collect(),
        }
    }

    /// Both side by side.
    pub(crate) fn beside(&self, other: &Self) -> Self {
        let rows = self.rows().zip(other.rows());
        Self {
            width: self.width + other.width,
            values: rows.flat_map(|(a, b)| a.iter().chain(b)).copied().collect(),
        }
    }
}

/// A light of a study.
#[derive(Debug, Clone)]
pub(crate) struct StudyLight {
    pub(crate) kind: TestKind,
    /// `None`: a sky.
    pub(crate) placed: Option<PlacedLight>,
}

/// What bakes of one surface share.
pub(crate) struct Study<'a> {
    surface: &'a Surface,
    places: Places<'a>,
    backs: Vec<bool>,
    open_points: Vec<u8>,
    /// Brightness of every prior light at the vertices.
    priors: Vec<Vec<f32>>,
}

impl<'a> Study<'a> {
    /// The surface of a scene as a bake of it has it, with the first `rays`
    /// arrivals of every row kept.
    pub(crate) fn surface(
        scene: &Scene,
        bake: &Bake,
        rays: u32,
        run: &RunSettings,
    ) -> Result<Surface, BakeError> {
        let mut surface = Surface::fronts(scene, &Detail::of_keys(&scene.bake));
        bake.add_sides_to(&mut surface);
        run.progress
            .stage("rays of all rows", surface.vertices.len() as u64);
        let kept = trace_arrivals(&surface, run.level, (None, rays), run.progress);
        surface.kept_arrivals = Some(kept.ok_or(BakeError::Cancelled)?);
        Ok(surface)
    }

    /// Prepares bakes of a surface that [`Self::surface`] made.
    pub(crate) fn new(
        surface: &'a Surface,
        bake: &Bake,
        run: &RunSettings,
    ) -> Result<Self, BakeError> {
        let places = Places::of(surface, run.level);
        let mut priors = Vec::new();
        prior::for_each(&places, run, |brightness| priors.push(brightness.to_vec()))
            .ok_or(BakeError::Cancelled)?;
        Ok(Self {
            surface,
            places,
            backs: bake.backs().to_vec(),
            open_points: bake.open_points().to_vec(),
            priors,
        })
    }

    /// Settings with the rays, functions and coefficients that a bake of them finds,
    /// where they ask for an error.
    pub(crate) fn found(
        &self,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<BakeSettings, BakeError> {
        settings_for_error(self.surface, &self.places, settings, run)
    }

    /// A bake without a sky and without statements about itself.
    pub(crate) fn bake(
        &self,
        settings: &BakeSettings,
        run: &RunSettings,
    ) -> Result<Bake, BakeError> {
        let basis = spectral_basis(&self.places, settings, run)?;
        let operator = match settings.scheme {
            Scheme::Relume => {
                let mut excitation = Excitation::new(&basis);
                for brightness in &self.priors {
                    excitation.add(&basis, run.level, brightness);
                }
                let importance = Importance {
                    sigma: excitation.sigma(self.priors.len()),
                };
                let rows = low_rank::sampled_rows(low_rank::Task {
                    surface: self.surface,
                    settings,
                    run,
                    basis: &basis,
                    importance: &importance,
                })?;
                Operator::LowRank(Box::new(rows.0))
            }
            Scheme::Paper => {
                Operator::Paper(paper::sampled_rows(self.surface, settings, run, &basis)?.0)
            }
        };
        Ok(Bake {
            backs: self.backs.clone(),
            open_points: self.open_points.clone(),
            basis,
            operator,
            sky: None,
            slices: None,
            folded: None,
            stats: BakeStats::default(),
        })
    }

    /// Whether some surface hands light on to another.
    pub(crate) fn has_bounces(&self) -> bool {
        self.places.any()
    }

    /// The test lights of a seed and their direct light at the vertices (RMS 1).
    pub(crate) fn lights(
        &self,
        basis: &Basis,
        seed: u32,
        run: &RunSettings,
    ) -> Result<(Vec<StudyLight>, VertexFields), BakeError> {
        let lights = TestLights::of(&self.places, basis, seed, run)?;
        let fields = by_vertex(basis, &lights.brightness);
        let study = lights.lights.into_iter();
        let study = study.map(|(kind, placed)| StudyLight { kind, placed });
        Ok((study.collect(), fields))
    }

    /// Direct light of a lamp 0.02 extents from a corner, and of a patch with a
    /// hard edge.
    pub(crate) fn extremes(&self, basis: &Basis, seed: u32) -> VertexFields {
        let lights = TestLights::extremes(&self.places, basis, seed);
        by_vertex(basis, &lights.brightness).columns(0..2)
    }

    /// Direct light of a light by many points of every vertex's area, and by those
    /// that a frame uses.
    pub(crate) fn by_many_points_and_few(
        &self,
        light: &PlacedLight,
        points: u32,
        level: Level,
    ) -> [Vec<f32>; 2] {
        let shadows = direct::Shadows::of_surface(self.surface, level);
        let red = |values: Vec<glam::Vec3>| values.iter().map(|e| e.x).collect();
        [
            red(direct::at_vertices_by_many(&shadows, light, points)),
            red(direct::at_vertices(&shadows, light)),
        ]
    }

    /// Traces rays of a seed from every vertex and keeps where they arrive.
    pub(crate) fn trace(
        &self,
        seed: u32,
        rays: u32,
        run: &RunSettings,
    ) -> Result<KeptArrivals, BakeError> {
        trace_arrivals(self.surface, run.level, (Some(seed), rays), run.progress)
            .ok_or(BakeError::Cancelled)
    }

    /// One bounce of fields at every vertex by arrivals that were kept.
    pub(crate) fn bounce_by(&self, kept: &KeptArrivals, fields: &VertexFields) -> VertexFields {
        let rows: Vec<Vec<f32>> = (0..self.surface.vertices.len() as u32)
            .into_par_iter()
            .with_min_len(16)
            .map(|vertex| self.gather(kept.of_vertex(vertex, kept.rays()), fields))
            .collect();
        VertexFields {
            width: fields.width,
            values: rows.concat(),
        }
    }

    /// One bounce of fields at some vertices by rays of a seed that nobody keeps.
    pub(crate) fn bounce_at(
        &self,
        receivers: &[u32],
        [seed, rays]: [u32; 2],
        fields: &VertexFields,
        run: &RunSettings,
    ) -> Result<VertexFields, BakeError> {
        let rows: Option<Vec<Vec<f32>>> = receivers
            .par_iter()
            .with_min_len(4)
            .map(|&vertex| {
                if run.progress.cancelled() {
                    return None;
                }
                let traced = vertex_rays(self.surface, run.level, [seed, vertex], rays);
                let row = self.gather(traced.map(|(_, (_, hit))| hit), fields);
                run.progress.advance(1);
                Some(row)
            })
            .collect();
        Ok(VertexFields {
            width: fields.width,
            values: rows.ok_or(BakeError::Cancelled)?.concat(),
        })
    }

    /// Mean of fields over the arrivals of a vertex, those inside bodies left out.
    fn gather(
        &self,
        arrivals: impl Iterator<Item = Option<Arrival>>,
        fields: &VertexFields,
    ) -> Vec<f32> {
        let mut sums = vec![0.0_f32; fields.width];
        let mut count = 0;
        for arrival in arrivals {
            count += 1;
            let Some(hit) = arrival else { continue };
            let Some(met) = self.surface.vertices.met(&hit) else {
                count -= 1;
                continue;
            };
            for (sender, weight) in met {
                for (sum, value) in sums.iter_mut().zip(fields.row(sender as usize)) {
                    *sum += weight * value;
                }
            }
        }
        let scale = 1.0 / count.max(1) as f32;
        sums.iter_mut().for_each(|sum| *sum *= scale);
        sums
    }

    /// One bounce of the test lights by the sampled rows of a bake: whole, and
    /// with what is not near field on all functions of the basis.
    pub(crate) fn whole_and_on_basis(
        &self,
        bake: &Bake,
        settings: &BakeSettings,
        lights: &VertexFields,
        run: &RunSettings,
    ) -> Result<[VertexFields; 2], BakeError> {
        let basis = bake.basis();
        let fields: Fields = basis
            .vertex_of_slot()
            .iter()
            .map(|&v| std::array::from_fn(|l| lights.row(v as usize)[l]))
            .collect();
        let kept = smooth(basis, run.level, &fields);
        let sampling = Sampling {
            surface: self.surface,
            level: run.level,
            slot_of_vertex: basis.slot_of_vertex(),
            rays: settings.rays,
        };
        let groups = receiver_groups(basis);
        run.progress.stage("parts of error", groups.len() as u64);
        let found: Option<Vec<[Vec<[f32; LIGHTS]>; 2]>> = groups
            .par_iter()
            .map_init(
                || transfer::Scratch::new(basis.slot_count()),
                |scratch, &group| {
                    if run.progress.cancelled() {
                        return None;
                    }
                    let rows = sample_group(&sampling, vertices_of(basis, group), scratch);
                    let near = bake.operator().near_of(group.0);
                    let pair = whole_and_on_basis(&rows, &near, group.1 as usize, &fields, &kept);
                    run.progress.advance(1);
                    Some(pair)
                },
            )
            .collect();
        let found = found.ok_or(BakeError::Cancelled)?;
        Ok([0, 1].map(|which| {
            let slots: Fields = found
                .iter()
                .flat_map(|pair| &pair[which])
                .copied()
                .collect();
            by_vertex(basis, &slots)
        }))
    }
}

fn by_vertex(basis: &Basis, fields: &Fields) -> VertexFields {
    let rows = basis.slot_of_vertex().iter();
    VertexFields {
        width: LIGHTS,
        values: rows.flat_map(|&slot| fields[slot as usize]).collect(),
    }
}

impl Bake {
    /// E = T~ B of several fields at the vertices.
    pub(crate) fn bounce(&self, level: Level, fields: &VertexFields) -> VertexFields {
        let mut out = vec![0.0; fields.values.len()];
        for first in (0..fields.width).step_by(3) {
            let channels = first..(first + 3).min(fields.width);
            let vertices = self.basis.vertex_of_slot();
            let radiosity: Vec<[f32; 3]> = vertices
                .iter()
                .map(|&v| {
                    let mut rgb = [0.0; 3];
                    rgb[..channels.len()]
                        .copy_from_slice(&fields.row(v as usize)[channels.clone()]);
                    rgb
                })
                .collect();
            for (&vertex, rgb) in vertices.iter().zip(self.apply(level, &radiosity)) {
                let row = vertex as usize * fields.width;
                out[row + first..row + channels.end].copy_from_slice(&rgb[..channels.len()]);
            }
        }
        VertexFields {
            width: fields.width,
            values: out,
        }
    }
}
