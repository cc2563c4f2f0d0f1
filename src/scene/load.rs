//! From a path to a [`Scene`].

use std::io;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::file::Document;
use super::file::fields::{key_error, suggestion};
use super::files::{Disk, Files, Finder, Recorded};
use super::images::Images;
use super::maps::{self, MapStatement};
use super::material::Reflection;
use super::obj::{self, Loaded};
use super::place::Place;
use super::text::strict_text;
use super::{Material, Mesh, Override, Placement, Scene, SceneError};

impl Scene {
    /// Loads a scene file and the OBJ and MTL files that it names, with some
    /// keys replaced.
    ///
    /// # Errors
    /// A file that cannot be read ([`SceneError::is_io`]), and whatever cannot
    /// be understood or is out of range, with file, line and what is allowed.
    /// Missing MTL files and textures and broken faces are [`Scene::warnings`]
    /// instead.
    pub fn load(path: &Path, overrides: &[Override]) -> Result<Self, SceneError> {
        // Unlike the files that it names, it may be a pipe.
        let bytes = std::fs::read(path);
        let bytes = bytes.map_err(|source| unreadable("", path, source))?;
        Self::load_with(&bytes, path, overrides, &Disk)
    }

    /// [`Scene::load`] as the scene's golden image is drawn: with the keys that
    /// `set` of `[golden]` changes, and then those that are given.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load_for_golden(path: &Path, overrides: &[Override]) -> Result<Self, SceneError> {
        let bytes = std::fs::read(path);
        let bytes = bytes.map_err(|source| unreadable("", path, source))?;
        let mut all = Document::golden_overrides(strict_text(&bytes, path)?, path)?;
        all.extend_from_slice(overrides);
        Self::load_with(&bytes, path, &all, &Disk)
    }

    /// [`Scene::load`] of the bytes that `path` held a moment ago, and
    /// [`Scene::files`] also where there is no scene.
    pub(crate) fn load_bytes(
        bytes: &[u8],
        path: &Path,
        overrides: &[Override],
    ) -> (Vec<PathBuf>, Result<Self, SceneError>) {
        let files = Recorded::new(&Disk);
        let scene = Self::load_with(bytes, path, overrides, &files);
        (files.asked(), scene)
    }

    /// [`Scene::load`] of the bytes that `path` holds, with another source of
    /// files.
    pub(crate) fn load_with(
        bytes: &[u8],
        path: &Path,
        overrides: &[Override],
        files: &dyn Files,
    ) -> Result<Self, SceneError> {
        let files = Recorded::new(files);
        let finder = Finder::new(&files);
        let images = Images::new(&finder);
        let document = Document::parse(strict_text(bytes, path)?, path, overrides, &images)?;
        let asked_by = format!("{}: ", document.mesh_place);
        let mesh_bytes = files.read(&document.mesh);
        let mesh_bytes =
            mesh_bytes.map_err(|source| unreadable(&asked_by, &document.mesh, source))?;
        let mut loaded = obj::load(&mesh_bytes, &document.mesh, document.normals, &finder)?;
        check_extent(&loaded.mesh, &document.mesh)?;
        override_materials(&mut loaded, &document)?;
        maps::attach(&mut loaded, &images)?;
        let mut warnings = document.warnings;
        warnings.append(&mut loaded.warnings);
        Ok(Self {
            mesh: loaded.mesh,
            materials: loaded.materials,
            lights: document.lights,
            texture_filter: document.texture_filter,
            camera: document.camera,
            render: document.render,
            bake: document.bake,
            animations: document.animations,
            golden: document.golden,
            files: files.asked(),
            warnings,
        })
    }

    /// How the later stages see the scene.
    pub(crate) fn placement(&self) -> Placement {
        let (lower, upper) = self.mesh.bounds();
        Placement::of_bounds(lower, upper)
    }
}

/// A mesh whose squares of lengths vanish in double precision has no areas.
const LEAST_EXTENT: f64 = 1e-30;

fn check_extent(mesh: &Mesh, path: &Path) -> Result<(), SceneError> {
    let (lower, upper) = mesh.bounds();
    let extent = (upper - lower).max_element();
    if extent >= LEAST_EXTENT {
        return Ok(());
    }
    Err(SceneError::Mesh {
        place: path.display().to_string(),
        message: format!(
            "the mesh is {extent:e} units wide; the least is {LEAST_EXTENT:e}, so scale it up"
        ),
    })
}

fn unreadable(place: &str, path: &Path, source: io::Error) -> SceneError {
    SceneError::Read {
        place: place.to_owned(),
        path: path.to_owned(),
        source,
    }
}

/// Applies `[[material]]`, also to where warnings about a material point.
fn override_materials(loaded: &mut Loaded, document: &Document) -> Result<(), SceneError> {
    for keys in &document.materials {
        let index = material_index(loaded, &keys.name, &keys.name_place)?;
        let material = &mut loaded.materials[index];
        let maps = &mut loaded.material_maps[index];
        if let Some(albedo) = keys.albedo {
            material.albedo = albedo;
            multiply(&mut maps.albedo);
        }
        if keys.emission.is_some() {
            multiply(&mut maps.emission);
        }
        if let Some(brdf) = keys.brdf {
            // Beside a map that stands alone the colour counts as white, and what the
            // kind makes of it is said here.
            if maps.albedo.as_ref().is_some_and(|map| map.stands_alone) {
                material.albedo = Vec3::ONE;
                multiply(&mut maps.albedo);
            }
            let (albedo, specular, roughness) = brdf.applied(material.albedo, material.specular);
            *material = Material {
                albedo,
                specular,
                roughness,
                ..material.clone()
            };
        }
        material.specular = keys.specular.unwrap_or(material.specular);
        let reflection = Reflection::of(material);
        if let Some(map) = maps.albedo.as_mut() {
            // A kind that was switched to says what the surface is.
            let is_still = map.is_of_metal && keys.brdf.is_none();
            map.is_of_metal = reflection.is_glossy() && (is_still || reflection.is_metal());
        }
        material.roughness = keys.roughness.or(material.roughness);
        material.emission = keys.emission.unwrap_or(material.emission);
    }
    for (name, place) in &document.animated_materials {
        material_index(loaded, name, place)?;
    }
    Ok(())
}

/// An explicit colour multiplies the map, whatever it is.
fn multiply(map: &mut Option<MapStatement>) {
    if let Some(map) = map {
        map.stands_alone = false;
    }
}

fn material_index(loaded: &Loaded, name: &str, place: &Place) -> Result<usize, SceneError> {
    let names = loaded.materials.iter().map(|m| m.name.as_str());
    names
        .clone()
        .position(|known| known == name)
        .ok_or_else(|| {
            key_error(
                place,
                format!(
                    "no material of the mesh is called {name:?}; {}",
                    suggestion(name, names)
                ),
            )
        })
}

#[cfg(test)]
mod tests;
