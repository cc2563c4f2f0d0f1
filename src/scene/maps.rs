//! Gives materials the image maps that their MTL statements name.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::defects::{Defect, Defects};
use super::images::{Images, Unreadable};
use super::obj::Loaded;
use super::place::Place;
use super::{Material, Mesh, SceneError};
use crate::texture::{Texture, TextureMap};

/// A texture statement of MTL.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapStatement {
    /// The file as written.
    pub(crate) name: String,
    /// Folder of the MTL file, where relative names start.
    pub(crate) folder: PathBuf,
    pub(crate) place: Place,
    /// `-s`.
    pub(crate) scale: Vec2,
    /// `-o`.
    pub(crate) offset: Vec2,
    /// `-clamp`.
    pub(crate) clamp: bool,
    /// Whether the colour beside it is absent or black, by which exporters
    /// mean the map alone.
    pub(crate) stands_alone: bool,
    /// Whether the surface is a metal, all or in part, whose lobe the map would tint.
    pub(crate) is_of_metal: bool,
}

/// The texture statements of a material.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct MaterialMaps {
    pub(crate) albedo: Option<MapStatement>,
    pub(crate) emission: Option<MapStatement>,
}

impl MapStatement {
    fn map(&self, texture: Arc<Texture>) -> TextureMap {
        TextureMap {
            texture,
            scale: self.scale,
            offset: self.offset,
            clamp: self.clamp,
        }
    }
}

/// Triangles of a material.
#[derive(Debug, Clone, Copy, Default)]
struct Uses {
    all: usize,
    without_texture_coordinates: usize,
}

/// Loads the maps of the materials that triangles use. Triangles without
/// texture coordinates are drawn without maps: where a material has some of
/// these, they get a second material of its name that has no map. What a map
/// that cannot be read leaves is the colour beside it, and its default where
/// that is absent or black.
///
/// # Errors
/// A file that is there but is no such image.
pub(crate) fn attach(loaded: &mut Loaded, images: &Images<'_>) -> Result<(), SceneError> {
    let mut defects = Defects::default();
    let mut twin_of: Vec<Option<u32>> = vec![None; loaded.materials.len()];
    let uses = uses(&loaded.mesh, loaded.materials.len());
    for (index, uses) in uses.into_iter().enumerate() {
        let maps = loaded.material_maps[index].clone();
        let Some(first) = maps.albedo.as_ref().or(maps.emission.as_ref()) else {
            continue;
        };
        let plain = loaded.materials[index].clone();
        if uses.without_texture_coordinates < uses.all {
            load(&mut loaded.materials[index], &maps, images, &mut defects)?;
        }
        if uses.without_texture_coordinates == 0 {
            continue;
        }
        let text = format!(
            "material {:?} has a texture, but triangles without texture coordinates; \
             these are drawn without it",
            plain.name
        );
        defects.add_text(Defect::NoTextureCoordinates, &first.place, &text);
        if uses.without_texture_coordinates < uses.all && loaded.materials[index] != plain {
            twin_of[index] = Some(loaded.materials.len() as u32);
            loaded.materials.push(plain);
            loaded.material_maps.push(MaterialMaps::default());
            let place = loaded.material_places[index].clone();
            loaded.material_places.push(place);
        }
    }
    for triangle in &mut loaded.mesh.triangles {
        if triangle.texture_coordinates.is_none() {
            let twin = twin_of[triangle.material as usize];
            triangle.material = twin.unwrap_or(triangle.material);
        }
    }
    loaded.warnings.extend(defects.into_warnings());
    Ok(())
}

fn load(
    material: &mut Material,
    maps: &MaterialMaps,
    images: &Images<'_>,
    defects: &mut Defects,
) -> Result<(), SceneError> {
    if let Some(statement) = &maps.albedo {
        let defect = Defect::MissingAlbedoMap;
        if let Some(texture) = texture(statement, images, defect, defects)? {
            if statement.stands_alone {
                material.albedo = Vec3::ONE;
            }
            let texture = if texture.exceeds_one() {
                defects.add_at(Defect::ColourAboveOne, &statement.place);
                Arc::new(texture.clamped_to_one())
            } else {
                texture
            };
            material.albedo_map = Some(statement.map(texture));
            if statement.is_of_metal {
                let text = format!(
                    "material {:?} is a metal, and its map_Kd does not tint what it reflects: {}",
                    material.name,
                    Defect::MapOfMetal.text()
                );
                defects.add_text(Defect::MapOfMetal, &statement.place, &text);
            }
        }
    }
    if let Some(statement) = &maps.emission {
        let defect = Defect::MissingEmissionMap;
        if let Some(texture) = texture(statement, images, defect, defects)? {
            if statement.stands_alone {
                material.emission = Vec3::ONE;
            }
            material.emission_map = Some(statement.map(texture));
        }
    }
    Ok(())
}

/// The image of a statement, or `None` with a warning.
fn texture(
    statement: &MapStatement,
    images: &Images<'_>,
    defect: Defect,
    defects: &mut Defects,
) -> Result<Option<Arc<Texture>>, SceneError> {
    let MapStatement {
        folder,
        name,
        place,
        ..
    } = statement;
    match images.texture(folder, name, place)? {
        Ok(texture) => Ok(Some(texture)),
        Err(Unreadable { path, reason }) => {
            let text = format!(
                "cannot read the texture {} ({reason}); {}",
                path.display(),
                defect.text()
            );
            defects.add_text(defect, place, &text);
            Ok(None)
        }
    }
}

fn uses(mesh: &Mesh, material_count: usize) -> Vec<Uses> {
    let mut uses = vec![Uses::default(); material_count];
    for triangle in &mesh.triangles {
        let uses = &mut uses[triangle.material as usize];
        uses.all += 1;
        uses.without_texture_coordinates += usize::from(triangle.texture_coordinates.is_none());
    }
    uses
}

#[cfg(test)]
mod tests;
