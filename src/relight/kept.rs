//! What is kept from frame to frame: placed lights, and direct light at the
//! vertices, light by light.

use std::sync::Arc;

use glam::Vec3;

use super::frame::Effort;
use super::sum::{BlockSums, Part};
use crate::bake::{Bake, Progress};
use crate::maths::cube_cells::{CELL_COUNT, direction_in_cell};
use crate::scene::{
    Light, Material, PlacedEnvironment, PlacedLight, PlacedLights, PlacedRectangle, Placement,
    Scene,
};
use crate::simd::Level;
use crate::surface::Surface;
use crate::surface::direct::{self, Shadows};
use crate::texture::{TextureFilter, TextureMap};

/// The lights of the last frame, placed; a scene of thousands of emitters takes
/// a tenth of a second to place.
#[derive(Debug, Default)]
pub(crate) struct KeptLights {
    placed: Option<(PlacedFor, Arc<PlacedLights>)>,
}

/// What placed lights depend on, besides the mesh.
#[derive(Debug, PartialEq)]
struct PlacedFor {
    lights: Vec<Light>,
    /// Emission of each material.
    emission: Vec<(Vec3, Option<TextureMap>)>,
    filter: TextureFilter,
}

impl KeptLights {
    /// The lights as the scene has them now.
    pub(crate) fn update(&mut self, scene: &Scene, placement: &Placement) -> Arc<PlacedLights> {
        let emission = |m: &Material| (m.emission, m.emission_map.clone());
        let asked = PlacedFor {
            lights: scene.lights.clone(),
            emission: scene.materials.iter().map(emission).collect(),
            filter: scene.texture_filter,
        };
        if let Some((made_for, lights)) = &self.placed
            && *made_for == asked
        {
            return lights.clone();
        }
        let lights = Arc::new(PlacedLights::of(scene, placement));
        self.placed = Some((asked, lights.clone()));
        lights
    }
}

/// Each light's direct irradiance at the vertices. A light that did not change
/// is not computed again; the sum is that of all lights in their order, so an
/// incremental frame has the bits of a fresh one.
#[derive(Debug, Default)]
pub(crate) struct KeptDirect {
    lights: Vec<KeptLight>,
    /// The rectangles that were in the way.
    rectangles: Vec<PlacedRectangle>,
    /// Skies and what they do.
    sky: Option<(Vec<PlacedEnvironment>, Vec<Vec3>)>,
    /// Lights computed so far: the next one's number.
    computed: u64,
    blocks: BlockSums,
    /// Sum of all, once it was asked for.
    sum: Vec<Vec3>,
    /// Counts the changes of the sum.
    version: u64,
}

#[derive(Debug)]
struct KeptLight {
    light: PlacedLight,
    effort: Effort,
    part: Part,
}

/// What lights shine on, and how well it is to be found.
pub(crate) struct OnVertices<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) level: Level,
    pub(crate) effort: Effort,
    pub(crate) progress: &'a dyn Progress,
}

impl OnVertices<'_> {
    fn irradiance(&self, rectangles: &[PlacedRectangle], light: &PlacedLight) -> Vec<Vec3> {
        let shadows = Shadows {
            surface: self.surface,
            level: self.level,
            rectangles,
        };
        match self.effort {
            Effort::Full => direct::at_vertices(&shadows, light),
            Effort::Draft => direct::at_vertices_in_a_draft(&shadows, light),
        }
    }
}

impl KeptDirect {
    /// Brings the kept vectors up to date; returns how many lights were computed,
    /// or `None` if it was stopped, which is asked between lights.
    ///
    /// A draft takes whatever is there of a light that did not change, and makes
    /// drafts of the others; a full frame takes nothing from drafts.
    pub(crate) fn update(&mut self, job: &OnVertices, lights: &PlacedLights) -> Option<usize> {
        let mut old = std::mem::take(&mut self.lights);
        if self.rectangles != lights.rectangles {
            // A rectangle that moved may have been, or now be, in any light's way: no light
            // serves any more, nor does the sum, though none may be left to be computed.
            old.clear();
            self.sum.clear();
            self.rectangles.clone_from(&lights.rectangles);
        }
        let (old_count, mut in_order, mut computed) = (old.len(), true, 0);
        for light in &lights.sources {
            let serves = |kept: &KeptLight| {
                kept.light == *light && (kept.effort == Effort::Full || job.effort == Effort::Draft)
            };
            let entry = match old.iter().position(serves) {
                Some(position) => {
                    in_order &= position == 0;
                    old.remove(position)
                }
                None if job.progress.cancelled() => {
                    // What was found so far serves the next frame.
                    self.lights.append(&mut old);
                    self.sum.clear();
                    return None;
                }
                None => {
                    computed += 1;
                    self.computed += 1;
                    KeptLight {
                        light: light.clone(),
                        effort: job.effort,
                        part: Part {
                            id: self.computed,
                            values: job.irradiance(&lights.rectangles, light).into(),
                        },
                    }
                }
            };
            self.lights.push(entry);
        }
        if computed > 0 || !in_order || old_count != self.lights.len() {
            self.sum.clear();
        }
        Some(computed)
    }

    /// Irradiance of the skies at every vertex, W/m2; empty without a sky.
    pub(crate) fn sky(
        &mut self,
        surface: &Surface,
        bake: &Bake,
        level: Level,
        skies: &[PlacedEnvironment],
    ) -> &[Vec3] {
        let is_kept = self.sky.as_ref().is_some_and(|(kept, _)| kept == skies);
        if !is_kept {
            self.sky = Some((skies.to_vec(), sky_irradiance(surface, bake, level, skies)));
            self.sum.clear();
        }
        self.sky.as_ref().map_or(&[], |(_, irradiance)| irradiance)
    }

    /// Sum of all lights at every vertex, W/m2, in the lights' order from zero
    /// (by blocks where there are many), then the sky; and a number that tells one
    /// sum from another.
    pub(crate) fn sum(&mut self, vertex_count: usize) -> (&[Vec3], u64) {
        if self.sum.len() != vertex_count {
            let parts: Vec<Part> = self.lights.iter().map(|kept| kept.part.clone()).collect();
            self.sum = self.blocks.of(&parts, vertex_count);
            let sky = self.sky.iter().flat_map(|(_, irradiance)| irradiance);
            let pairs = self.sum.iter_mut().zip(sky);
            pairs.for_each(|(total, e)| *total += *e);
            self.version += 1;
        }
        (&self.sum, self.version)
    }

    /// The same sum, and the sky's part of it; empty without a sky.
    pub(crate) fn sum_and_sky(&mut self, vertex_count: usize) -> (&[Vec3], &[Vec3]) {
        self.sum(vertex_count);
        let sky = self.sky.as_ref().map_or(&[][..], |(_, sky)| sky);
        (&self.sum, sky)
    }
}

/// What the skies do to the vertices, by the cells of the sky; no entry where
/// they do nothing. Negative values may remain, as in bounced light.
fn sky_irradiance(
    surface: &Surface,
    bake: &Bake,
    level: Level,
    skies: &[PlacedEnvironment],
) -> Vec<Vec3> {
    let cells = cells_of(skies);
    if cells.is_empty() {
        return Vec::new();
    }
    let hemisphere = Hemisphere::new();
    let normals = surface.vertices.normals();
    let in_slots = bake.sky_irradiance(level, &cells, |vertex| {
        hemisphere.irradiance(normals[vertex as usize], &cells)
    });
    let mut at_vertices = vec![Vec3::ZERO; in_slots.len()];
    for (&vertex, &e) in bake.basis().vertex_of_slot().iter().zip(&in_slots) {
        at_vertices[vertex as usize] = Vec3::from_array(e);
    }
    at_vertices
}

/// H_m of all skies, W/m2; empty where they are black.
pub(super) fn cells_of(skies: &[PlacedEnvironment]) -> Vec<[f32; 3]> {
    let mut cells = vec![[0.0_f32; 3]; CELL_COUNT];
    for sky in skies {
        for (sum, cell) in cells.iter_mut().zip(sky.cells()) {
            for channel in 0..3 {
                sum[channel] += cell[channel];
            }
        }
    }
    if cells.iter().all(|cell| *cell == [0.0; 3]) {
        cells.clear();
    }
    cells
}

/// The sky over a plane that nothing is on.
struct Hemisphere {
    /// Middle of each cell and its solid angle, sr.
    cells: Vec<(Vec3, f32)>,
}

impl Hemisphere {
    fn new() -> Self {
        Self {
            cells: (0..CELL_COUNT)
                .map(|cell| direction_in_cell(cell, [0.5, 0.5]))
                .collect(),
        }
    }

    /// Irradiance on a plane of unit `normal` from H_m of the cells, W/m2: their
    /// mean by solid angle x cosine.
    fn irradiance(&self, normal: Vec3, sky: &[[f32; 3]]) -> [f32; 3] {
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for ((direction, solid_angle), cell) in self.cells.iter().zip(sky) {
            let cosine = direction.dot(normal);
            if cosine > 0.0 {
                let weight = cosine * solid_angle;
                weights += weight;
                for channel in 0..3 {
                    sum[channel] += weight * cell[channel];
                }
            }
        }
        sum.map(|value| value / weights)
    }
}
