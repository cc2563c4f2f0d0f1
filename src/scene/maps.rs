//! Gives materials the image maps that their MTL statements name.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::images::Images;
use super::obj::Loaded;
use super::place::Place;
use super::{Material, Mesh, SceneError};
use crate::texture::{Texture, TextureMap};

/// A texture statement of MTL.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapStatement {
    /// The file, resolved against the MTL's folder.
    pub(crate) path: PathBuf,
    pub(crate) place: Place,
    pub(crate) scale: Vec2,
    pub(crate) offset: Vec2,
    pub(crate) clamp: bool,
    /// Whether the colour beside it is absent or black, which means the map
    /// alone.
    pub(crate) stands_alone: bool,
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

/// Loads the maps of the materials that triangles use.
///
/// # Errors
/// A file that is there but is not such an image.
pub(crate) fn attach(loaded: &mut Loaded, images: &Images<'_>) -> Result<(), SceneError> {
    let is_used = used(&loaded.mesh, loaded.materials.len());
    for (index, maps) in loaded.material_maps.iter().enumerate() {
        if !is_used[index] {
            continue;
        }
        let material: &mut Material = &mut loaded.materials[index];
        for (statement, colour, slot) in [
            (&maps.albedo, &mut material.albedo, &mut material.albedo_map),
            (
                &maps.emission,
                &mut material.emission,
                &mut material.emission_map,
            ),
        ] {
            let Some(statement) = statement else { continue };
            match images.texture(&statement.path, &statement.place) {
                Ok(texture) => {
                    if statement.stands_alone {
                        *colour = Vec3::ONE;
                    }
                    *slot = Some(statement.map(texture));
                }
                Err(SceneError::Read { path, source, .. }) => loaded.warnings.push(format!(
                    "{}: cannot read the texture {} ({source}); material {:?} is drawn without it",
                    statement.place,
                    path.display(),
                    material.name
                )),
                Err(error) => return Err(error),
            }
        }
    }
    Ok(())
}

/// Which materials triangles use.
pub(crate) fn used(mesh: &Mesh, material_count: usize) -> Vec<bool> {
    let mut is_used = vec![false; material_count];
    for triangle in &mesh.triangles {
        is_used[triangle.material as usize] = true;
    }
    is_used
}
