//! Everything that lights a scene, in placed units.

use std::collections::HashSet;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::emitters::Emitters;
use super::polygon::Polygon;
use super::{Light, LightKind, PlacedEnvironment, PlacedLight, PlacedRectangle, PlacedSun};
use crate::maths::sobol::ScrambledSobol;
use crate::scene::{Material, MeshTriangle, Placement, Scene, same_corners};
use crate::texture::TextureMap;

/// Points at which a map of emission is averaged over a triangle.
const MAP_POINTS: u32 = 64;
/// Seed of these points.
const SEED: u32 = 0xe317;
/// Triangles whose emission a map varies are cut into four again and again, as
/// long as there are no more pieces than this.
const MOST_PIECES: usize = 512;
/// Cuts beyond which a piece is as small as a shadow is soft.
const MOST_CUTS: u32 = 3;

/// The lights of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct PlacedLights {
    /// What gives direct light with shadow rays: the lights of the file in their
    /// order, then the emitting triangles of the mesh as one, then the suns of
    /// environment maps.
    pub(crate) sources: Vec<PlacedLight>,
    /// Rectangles of the file: seen by the camera, black, in the way of light.
    pub(crate) rectangles: Vec<PlacedRectangle>,
    /// Environments.
    pub(crate) skies: Vec<PlacedEnvironment>,
}

impl PlacedLights {
    /// The lights as `scene` has them now.
    pub(crate) fn of(scene: &Scene, placement: &Placement) -> Self {
        let mut lights = Self::of_file(&scene.lights, placement);
        let polygons = emitting_polygons(scene, placement);
        if !polygons.is_empty() {
            let emitters = Arc::new(Emitters::new(polygons));
            lights.sources.push(PlacedLight::Surfaces(emitters));
        }
        let suns = lights.suns();
        lights
            .sources
            .extend(suns.into_iter().map(PlacedLight::Sun));
        lights
    }

    /// The lights of the scene file alone.
    pub(crate) fn of_file(from_file: &[Light], placement: &Placement) -> Self {
        let mut lights = Self::default();
        for light in from_file {
            match &light.kind {
                LightKind::Point(light) => {
                    lights
                        .sources
                        .push(PlacedLight::Point(light.place(placement)));
                }
                LightKind::Spot(light) => {
                    lights
                        .sources
                        .push(PlacedLight::Spot(light.place(placement)));
                }
                LightKind::Directional(light) => {
                    lights.sources.push(PlacedLight::Directional(light.place()));
                }
                LightKind::Area(light) => {
                    let rectangle = light.place(placement);
                    let emitters = Emitters::new(vec![rectangle.polygon()]);
                    lights
                        .sources
                        .push(PlacedLight::Surfaces(Arc::new(emitters)));
                    lights.rectangles.push(rectangle);
                }
                LightKind::Environment(light) => lights.skies.push(light.place()),
            }
        }
        lights
    }

    /// The suns of environment maps.
    pub(crate) fn suns(&self) -> Vec<PlacedSun> {
        self.skies
            .iter()
            .filter_map(PlacedEnvironment::sun)
            .collect()
    }

    /// Radiance of the sky from a unit direction, W/(m2 sr), mean over a cone
    /// `spread_rad` wide.
    pub(crate) fn sky_radiance(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        self.skies.iter().fold(Vec3::ZERO, |sum, sky| {
            sum + sky.radiance(direction, spread_rad)
        })
    }

    /// The same without the suns of maps, which are lights of their own.
    pub(crate) fn sky_without_suns(&self, direction: Vec3, spread_rad: f32) -> Vec3 {
        self.skies.iter().fold(Vec3::ZERO, |sum, sky| {
            sum + sky.radiance_without_sun(direction, spread_rad)
        })
    }
}

/// Front sides of the file's triangles that emit; of triangles with the same
/// corners only the first, as rays see them.
fn emitting_polygons(scene: &Scene, placement: &Placement) -> Vec<Polygon> {
    let emits = |t: &&MeshTriangle| scene.materials[t.material as usize].emission != Vec3::ZERO;
    if !scene.mesh.triangles.iter().any(|t| emits(&t)) {
        return Vec::new();
    }
    let place = |corner: u32| placement.placed_from_file(scene.mesh.positions[corner as usize]);
    let mut seen = HashSet::new();
    let emitting: Vec<(&MeshTriangle, [Vec3; 3])> = scene
        .mesh
        .triangles
        .iter()
        .map(|triangle| (triangle, triangle.corners.map(place)))
        .filter(|(_, corners)| seen.insert(same_corners(*corners)))
        .filter(|(triangle, _)| emits(triangle))
        .collect();
    let cuts = cuts_for(emitting.len());
    let mut polygons = Vec::new();
    for (triangle, corners) in emitting {
        let material = &scene.materials[triangle.material as usize];
        match emission_map(scene, triangle, material) {
            None => polygons.push(Polygon::triangle(corners, material.emission)),
            Some((map, uv)) => {
                let piece = Piece { corners, uv };
                piece.cut(cuts, &mut |piece| {
                    let radiance = material.emission * piece.mean(scene, map);
                    polygons.push(Polygon::triangle(piece.corners, radiance));
                });
            }
        }
    }
    polygons
}

/// Times that a textured triangle is cut into four.
fn cuts_for(triangles: usize) -> u32 {
    (0..=MOST_CUTS)
        .rev()
        .find(|&cuts| triangles << (2 * cuts) <= MOST_PIECES)
        .unwrap_or(0)
}

fn emission_map<'a>(
    scene: &Scene,
    triangle: &MeshTriangle,
    material: &'a Material,
) -> Option<(&'a TextureMap, [Vec2; 3])> {
    let map = material.emission_map.as_ref()?;
    let uv = triangle
        .texture_coordinates?
        .map(|i| scene.mesh.texture_coordinates[i as usize].as_vec2());
    Some((map, uv))
}

/// A part of an emitting triangle with its texture coordinates.
#[derive(Clone, Copy)]
struct Piece {
    corners: [Vec3; 3],
    uv: [Vec2; 3],
}

impl Piece {
    fn cut(self, cuts: u32, emit: &mut dyn FnMut(Self)) {
        if cuts == 0 {
            return emit(self);
        }
        let middle = |i: usize, j: usize| {
            (
                (self.corners[i] + self.corners[j]) * 0.5,
                (self.uv[i] + self.uv[j]) * 0.5,
            )
        };
        let own = |i: usize| (self.corners[i], self.uv[i]);
        let middles = [middle(0, 1), middle(1, 2), middle(2, 0)];
        for part in [
            [own(0), middles[0], middles[2]],
            [middles[0], own(1), middles[1]],
            [middles[2], middles[1], own(2)],
            middles,
        ] {
            let piece = Self {
                corners: part.map(|(corner, _)| corner),
                uv: part.map(|(_, uv)| uv),
            };
            piece.cut(cuts - 1, emit);
        }
    }

    /// Mean colour of a map over the piece.
    fn mean(&self, scene: &Scene, map: &TextureMap) -> Vec3 {
        let [a, b, c] = self.uv;
        // Each point stands for a parallelogram of its share of the triangle.
        let side = 1.0 / (2.0 * MAP_POINTS as f32).sqrt();
        let points = ScrambledSobol::new(SEED, 0);
        let sum = (0..MAP_POINTS).fold(Vec3::ZERO, |sum, index| {
            // The upper half of the unit square is folded onto the lower one.
            let [u, v] = points.point2(index);
            let [u, v] = if u + v > 1.0 {
                [1.0 - u, 1.0 - v]
            } else {
                [u, v]
            };
            let at = a + (b - a) * u + (c - a) * v;
            sum + map.mean(at, (b - a) * side, (c - a) * side, scene.texture_filter)
        });
        sum / MAP_POINTS as f32
    }
}
