//! Reads OBJ meshes and MTL materials.
//!
//! Comes in: the bytes of an OBJ file and a way to read the MTL files that it
//! names. Goes out: [`Loaded`]. Three steps: [`clean`] and [`mtl`] go over the
//! text, know the lines, drop what is broken and write a text that `tobj`
//! takes without stumbling; `tobj` parses that; [`build`] makes the mesh.

mod build;
mod clean;
mod lines;
mod mtl;
mod smooth;
mod texture_statement;

use std::path::Path;

use self::clean::Cleaned;
use self::mtl::Libraries;
use super::defects::Defects;
use super::files::Finder;
use super::maps::MaterialMaps;
use super::place::Place;
use super::text::lenient_text;
use super::{Material, Mesh, Normals, SceneError};

/// An OBJ file with its materials.
#[derive(Debug)]
pub(crate) struct Loaded {
    pub(crate) mesh: Mesh,
    pub(crate) materials: Vec<Material>,
    /// Where each material is defined.
    pub(crate) material_places: Vec<Place>,
    /// The texture statements of each material.
    pub(crate) material_maps: Vec<MaterialMaps>,
    /// What was dropped or clamped: one sentence a kind.
    pub(crate) warnings: Vec<String>,
}

/// Parses the OBJ file that `bytes` were read from.
///
/// # Errors
/// Bytes that are no text, statements that cannot be understood, and a file
/// without a triangle.
pub(crate) fn load(
    bytes: &[u8],
    path: &Path,
    normals: Normals,
    finder: &Finder<'_>,
) -> Result<Loaded, SceneError> {
    let text = lenient_text(bytes, path)?;
    let text = lines::normalized(&text);
    let mut defects = Defects::default();
    let libraries = Libraries::read(&text, path, finder, &mut defects)?;
    let cleaned = clean::clean(&text, path, normals, &libraries, &mut defects)?;
    let (models, parsed) = parse(&cleaned, &libraries).map_err(|error| SceneError::Mesh {
        place: path.display().to_string(),
        message: format!("cannot be understood: {error}"),
    })?;
    let (mut materials, mut material_maps) = libraries.materials(&parsed);
    let mut mesh = build::mesh(&models, &cleaned, path, materials.len(), &mut defects)?;
    let mut material_places = libraries.places();
    let unnamed = materials.len() as u32;
    if mesh.triangles.iter().any(|t| t.material == unnamed) {
        materials.push(Material::unnamed());
        material_maps.push(MaterialMaps::default());
        material_places.push(Place::of_line(path, 1));
    }
    if normals == Normals::Smooth {
        smooth::smooth(&mut mesh);
    }
    Ok(Loaded {
        mesh,
        materials,
        material_places,
        material_maps,
        warnings: defects.into_warnings(),
    })
}

type Parsed = (Vec<tobj::Model>, Vec<tobj::Material>);

/// tobj triangulates a polygon as a fan from its first corner (quads
/// likewise), and returns the faces in their order.
fn parse(cleaned: &Cleaned, libraries: &Libraries) -> Result<Parsed, tobj::LoadError> {
    let options = tobj::LoadOptions {
        single_index: false,
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let (models, materials) = tobj::load_obj_buf(&mut cleaned.text.as_bytes(), &options, |_| {
        tobj::load_mtl_buf(&mut libraries.text().as_bytes())
    })?;
    Ok((models, materials?))
}

#[cfg(test)]
mod tests;
