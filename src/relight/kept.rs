//! Direct light at the vertices, kept light by light.

use glam::Vec3;

use crate::scene::PlacedLight;
use crate::simd::Level;
use crate::surface::{Surface, direct};

/// Each light's direct irradiance at the vertices. A light that did not change
/// is not computed again; the sum is always formed anew in the lights' order,
/// so an incremental frame has the bits of a fresh one.
#[derive(Debug, Default)]
pub(crate) struct KeptDirect {
    lights: Vec<(PlacedLight, Vec<Vec3>)>,
}

impl KeptDirect {
    /// Brings the kept vectors up to date; returns how many lights were computed.
    pub(crate) fn update(
        &mut self,
        surface: &Surface,
        level: Level,
        lights: &[PlacedLight],
    ) -> usize {
        let mut old = std::mem::take(&mut self.lights);
        let mut computed = 0;
        for light in lights {
            let same = old.iter().position(|(kept, _)| kept == light);
            let entry = match same {
                Some(position) => old.swap_remove(position),
                None => {
                    computed += 1;
                    (*light, direct::at_vertices(surface, level, light))
                }
            };
            self.lights.push(entry);
        }
        computed
    }

    /// Sum of all lights at every vertex, W/m2, in the lights' order from zero.
    pub(crate) fn sum(&self, vertex_count: usize) -> Vec<Vec3> {
        let mut sum = vec![Vec3::ZERO; vertex_count];
        for (_, irradiance) in &self.lights {
            sum.iter_mut()
                .zip(irradiance)
                .for_each(|(total, e)| *total += *e);
        }
        sum
    }
}
