//! What is kept from frame to frame: placed lights, and direct light at the
//! vertices, light by light.

use std::sync::Arc;

use glam::Vec3;

use crate::bake::Bake;
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
/// is not computed again; the sum is always formed anew in the lights' order,
/// so an incremental frame has the bits of a fresh one.
#[derive(Debug, Default)]
pub(crate) struct KeptDirect {
    lights: Vec<(PlacedLight, Vec<Vec3>)>,
    /// The rectangles that were in the way.
    rectangles: Vec<PlacedRectangle>,
    /// Skies and what they do.
    sky: Option<(Vec<PlacedEnvironment>, Vec<Vec3>)>,
}

impl KeptDirect {
    /// Brings the kept vectors up to date; returns how many lights were computed.
    pub(crate) fn update(
        &mut self,
        surface: &Surface,
        level: Level,
        lights: &PlacedLights,
    ) -> usize {
        let shadows = Shadows {
            surface,
            level,
            rectangles: &lights.rectangles,
        };
        let mut old = std::mem::take(&mut self.lights);
        if self.rectangles != lights.rectangles {
            // A rectangle that moved may have been, or now be, in any light's way.
            old.clear();
            self.rectangles.clone_from(&lights.rectangles);
        }
        let mut computed = 0;
        for light in &lights.sources {
            let same = old.iter().position(|(kept, _)| kept == light);
            let entry = match same {
                Some(position) => old.swap_remove(position),
                None => {
                    computed += 1;
                    (light.clone(), direct::at_vertices(&shadows, light))
                }
            };
            self.lights.push(entry);
        }
        computed
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
        }
        self.sky.as_ref().map_or(&[], |(_, irradiance)| irradiance)
    }

    /// Sum of all lights at every vertex, W/m2, in the lights' order from zero,
    /// then the sky.
    pub(crate) fn sum(&self, vertex_count: usize) -> Vec<Vec3> {
        let mut sum = vec![Vec3::ZERO; vertex_count];
        let skies = self.sky.iter().map(|(_, irradiance)| irradiance);
        for irradiance in self.lights.iter().map(|(_, e)| e).chain(skies) {
            sum.iter_mut()
                .zip(irradiance)
                .for_each(|(total, e)| *total += *e);
        }
        sum
    }
}

/// What the skies do to the vertices, by the cells of the sky; no entry where
/// they do nothing.
fn sky_irradiance(
    surface: &Surface,
    bake: &Bake,
    level: Level,
    skies: &[PlacedEnvironment],
) -> Vec<Vec3> {
    let mut cells = vec![[0.0_f32; 3]; CELL_COUNT];
    for sky in skies {
        for (sum, cell) in cells.iter_mut().zip(sky.cells()) {
            for channel in 0..3 {
                sum[channel] += cell[channel];
            }
        }
    }
    if cells.iter().all(|cell| *cell == [0.0; 3]) {
        return Vec::new();
    }
    let hemisphere = Hemisphere::new();
    let normals = surface.vertices.normals();
    let in_slots = bake.sky_irradiance(level, &cells, |vertex| {
        hemisphere.irradiance(normals[vertex as usize], &cells)
    });
    let mut at_vertices = vec![Vec3::ZERO; in_slots.len()];
    for (&vertex, &e) in bake.basis().vertex_of_slot().iter().zip(&in_slots) {
        // A basis rings; light is not negative.
        at_vertices[vertex as usize] = Vec3::from_array(e.map(|e| if e > 0.0 { e } else { 0.0 }));
    }
    at_vertices
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
