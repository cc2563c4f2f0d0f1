//! How far folded bounces are off from bounces one by one.

use rayon::prelude::*;

use super::{FoldTask, Folded};
use crate::bake::audit::LIGHT_SEEDS;
use crate::bake::receivers::relative_error;
use crate::bake::test_lights::{LIGHTS, TestLights};
use crate::bake::{BakeError, LightErrors};
use crate::maths::rgb_fields::product;

impl FoldTask<'_> {
    /// Relative difference under the first of the lights that a bake states its error by, as
    /// seen on the vertices' area in the open, all channels together.
    pub(super) fn errors(&self, folded: &Folded) -> Result<LightErrors, BakeError> {
        let run = self.run;
        let lights = TestLights::of(self.places, self.basis, LIGHT_SEEDS[0], run)?;
        run.progress.stage("error of folding", LIGHTS as u64);
        let vertices = &self.places.surface().vertices;
        let slots = self.basis.vertex_of_slot().iter();
        let areas: Vec<f64> = slots
            .map(|&vertex| f64::from(vertices.open_area(vertex as usize)))
            .collect();
        let error_of = |light: usize| {
            run.proceed()?;
            let of_light = lights.brightness.iter().map(|values| [values[light]; 3]);
            let source = product(self.albedo, &of_light.collect::<Vec<_>>());
            let operator = (self.basis, self.operator);
            let found = folded.all_bounces(run.level, operator, (&source, self.albedo));
            let limit = self.series().limit(&source);
            run.progress.advance(1);
            Ok(limit.and_then(|limit| {
                let values = areas.iter().zip(limit.iter().zip(&found));
                relative_error(values.flat_map(|(&area, (limit, found))| {
                    [0, 1, 2].map(|channel| (area, limit[channel], found[channel]))
                }))
            }))
        };
        let errors: Vec<_> = (0..LIGHTS)
            .into_par_iter()
            .map(error_of)
            .collect::<Result<_, _>>()?;
        Ok(LightErrors::of(&errors))
    }
}
