//! Light of the final glossy bounce at vertices and between them.

use std::sync::Arc;

use glam::Vec3;

use crate::bake::Bake;
use crate::scene::PlacedEnvironment;
use crate::simd::Level;
use crate::surface::NONE;

/// Coefficients of a vertex.
const SLICES: usize = 16;

/// What arrives at the glossy vertices by direction: G_k, W/m2.
#[derive(Debug, Default)]
pub(crate) struct GlossyLight {
    /// Place of each vertex in `light`; [`NONE`] without slices.
    places: Vec<u32>,
    light: Vec<[Vec3; SLICES]>,
}

impl GlossyLight {
    /// From the radiosity of all slots that the final bounce starts with, W/m2, and
    /// the cells of the skies (empty without one), W/m2.
    fn of(bake: &Bake, level: Level, outgoing: &[[f32; 3]], cells: &[[f32; 3]]) -> Self {
        let Some((slots, light)) = bake.glossy_light(level, outgoing, cells) else {
            return Self::default();
        };
        let vertex_of_slot = bake.basis().vertex_of_slot();
        let mut places = vec![NONE; vertex_of_slot.len()];
        for (place, &slot) in slots.iter().enumerate() {
            places[vertex_of_slot[slot as usize] as usize] = place as u32;
        }
        let vectors = light.into_iter().map(|g| g.map(Vec3::from_array));
        Self {
            places,
            light: vectors.collect(),
        }
    }

    /// Interpolated between corners that have slices; `None` where none has.
    pub(crate) fn at(&self, corners: [u32; 3], weights: [f32; 3]) -> Option<[Vec3; SLICES]> {
        let mut sum = [Vec3::ZERO; SLICES];
        let mut any = false;
        for (vertex, weight) in corners.into_iter().zip(weights) {
            let place = self.places.get(vertex as usize).copied();
            let Some(place) = place.filter(|&place| place != NONE) else {
                continue;
            };
            any = true;
            for (sum, g) in sum.iter_mut().zip(&self.light[place as usize]) {
                *sum += *g * weight;
            }
        }
        any.then_some(sum)
    }
}

/// The light of the last frame, kept while it stays the same.
#[derive(Default)]
pub(crate) struct KeptGlossyLight {
    last: Option<Last>,
}

struct Last {
    /// None where nothing bounces.
    outgoing: Option<Arc<[[f32; 3]]>>,
    skies: Vec<PlacedEnvironment>,
    light: Arc<GlossyLight>,
}

impl KeptGlossyLight {
    /// The light of a bake's slices; see [`GlossyLight`]. `outgoing` is none where
    /// nothing bounces.
    pub(crate) fn of(
        &mut self,
        bake: &Bake,
        level: Level,
        outgoing: Option<Arc<[[f32; 3]]>>,
        skies: &[PlacedEnvironment],
    ) -> Arc<GlossyLight> {
        let place = |it: &Option<Arc<[[f32; 3]]>>| it.as_ref().map(Arc::as_ptr);
        if let Some(last) = &self.last
            && place(&last.outgoing) == place(&outgoing)
            && last.skies == skies
        {
            return Arc::clone(&last.light);
        }
        let cells = super::kept::cells_of(skies);
        let light = Arc::new(match &outgoing {
            Some(outgoing) => GlossyLight::of(bake, level, outgoing, &cells),
            None => {
                let darkness = vec![[0.0; 3]; bake.basis().slot_count()];
                GlossyLight::of(bake, level, &darkness, &cells)
            }
        });
        self.last = Some(Last {
            outgoing,
            skies: skies.to_vec(),
            light: Arc::clone(&light),
        });
        light
    }
}
