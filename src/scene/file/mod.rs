//! Reads the TOML scene file.
//!
//! Comes in: its text and the `--set` overrides. Goes out: [`Document`],
//! checked as far as the file alone allows. The text becomes a tree that knows
//! the place of every key and value ([`tree`]), overrides are grafted onto it
//! ([`overrides`]), and keys are taken out one by one ([`fields`]): serde's
//! derived readers lose the place inside tagged enums and lists.

mod animate;
pub(crate) mod fields;
mod overrides;
mod sections;
mod target;
mod tree;

use std::path::{Path, PathBuf};

use self::fields::{Fields, key_error};
use self::sections::MaterialKeys;
pub(crate) use self::target::{Target, default_light_name};
use self::tree::{Node, Table};
use super::images::{Images, Sources};
use super::place::Place;
use super::{Animation, BakeKeys, Camera, GoldenKeys, Light, Normals, RenderKeys, SceneError};
use crate::texture::TextureFilter;

pub use self::overrides::Override;
pub(crate) use self::tree::shortened;

const KEYS: [&str; 10] = [
    "mesh",
    "normals",
    "texture_filter",
    "camera",
    "light",
    "render",
    "bake",
    "material",
    "animate",
    "golden",
];

const NORMALS: [(&str, Normals); 3] = [
    ("file", Normals::File),
    ("flat", Normals::Flat),
    ("smooth", Normals::Smooth),
];

const TEXTURE_FILTERS: [(&str, TextureFilter); 2] = [
    ("bilinear", TextureFilter::Bilinear),
    ("nearest", TextureFilter::Nearest),
];

/// The scene file, checked, before the mesh is known.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    pub(crate) mesh: PathBuf,
    pub(crate) mesh_place: Place,
    pub(crate) normals: Normals,
    pub(crate) texture_filter: TextureFilter,
    pub(crate) camera: Camera,
    pub(crate) lights: Vec<Light>,
    pub(crate) render: RenderKeys,
    pub(crate) bake: BakeKeys,
    pub(crate) materials: Vec<MaterialKeys>,
    pub(crate) animations: Vec<Animation>,
    /// Materials that `[[animate]]` names, to be looked up in the mesh.
    pub(crate) animated_materials: Vec<(String, Place)>,
    pub(crate) golden: GoldenKeys,
    pub(crate) warnings: Vec<String>,
}

impl Document {
    /// Parses and checks a scene file; relative paths in it start at the
    /// folder of `path`.
    ///
    /// # Errors
    /// Text that is not TOML, and every key or value that is not allowed.
    pub(crate) fn parse(
        text: &str,
        path: &Path,
        overrides: &[Override],
        images: &Images<'_>,
    ) -> Result<Self, SceneError> {
        let mut table = tree::parse_document(text, path)?;
        for set in overrides {
            set.apply(&mut table)?;
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let sources = &Sources { folder, images };
        let start = Place::of_line(path, 1);
        let mut document = Self::read(table.clone(), &start, sources)?;
        document.read_animations(&table, &start, sources)?;
        Ok(document)
    }

    /// `set` of `[golden]`: what the scene's golden changes of it.
    ///
    /// # Errors
    /// Text that is not TOML, and a key of `[golden]` that is not allowed.
    pub(crate) fn golden_overrides(text: &str, path: &Path) -> Result<Vec<Override>, SceneError> {
        let table = tree::parse_document(text, path)?;
        let mut fields = Fields::of_document(table, Place::of_line(path, 1));
        let section = section(&mut fields, "golden", "[golden]")?;
        let keys = sections::golden(section, Path::new(""))?;
        keys.set.iter().map(|text| Override::parse(text)).collect()
    }

    /// Everything but `[[animate]]`, whose key frames are checked by reading
    /// the file as it is at each of them.
    fn read(table: Table, start: &Place, sources: &Sources<'_>) -> Result<Self, SceneError> {
        let mut fields = Fields::of_document(table, start.clone());
        fields.allow(&KEYS)?;
        let mesh = fields.require("mesh", "the path of an OBJ file")?;
        let normals = fields.take("normals");
        let texture_filter = fields.take("texture_filter");
        let camera = match fields.take("camera") {
            Some(item) => sections::camera(Fields::new("[camera]", item.into_node())?)?,
            None => return Err(fields.error("lacks the section [camera]")),
        };
        let lights = lights(tables(&mut fields, "light")?, sources)?;
        Ok(Self {
            mesh: sources.folder.join(mesh.name()?),
            mesh_place: mesh.place().clone(),
            normals: normals.map_or(Ok(Normals::File), |item| item.choice(&NORMALS))?,
            texture_filter: texture_filter.map_or(Ok(TextureFilter::Bilinear), |item| {
                item.choice(&TEXTURE_FILTERS)
            })?,
            camera,
            lights,
            render: sections::render(section(&mut fields, "render", "[render]")?)?,
            bake: sections::bake(section(&mut fields, "bake", "[bake]")?)?,
            materials: sections::materials(tables(&mut fields, "material")?)?,
            animations: Vec::new(),
            animated_materials: Vec::new(),
            golden: sections::golden(section(&mut fields, "golden", "[golden]")?, sources.folder)?,
            warnings: Vec::new(),
        })
    }

    fn read_animations(
        &mut self,
        table: &Table,
        start: &Place,
        sources: &Sources<'_>,
    ) -> Result<(), SceneError> {
        let mut fields = Fields::of_document(table.clone(), start.clone());
        let mut table = table.clone();
        table.remove("animate");
        for entry in tables(&mut fields, "animate")? {
            let place = entry.place().line_only();
            let (animation, material) = animate::read(entry, &table, &|changed| {
                Self::read(changed, start, sources).map(|_| ())
            })?;
            self.animated_materials.extend(material);
            if self.animations.is_empty() {
                self.warnings.push(format!(
                    "{place}: [[animate]] of {} is not rendered yet",
                    animation.target
                ));
            }
            self.animations.push(animation);
        }
        Ok(())
    }
}

/// A section that may be absent, which counts as empty.
fn section(fields: &mut Fields, key: &'static str, what: &str) -> Result<Fields, SceneError> {
    let node = match fields.take(key) {
        Some(item) => item.into_node(),
        None => Node::empty_table(fields.place().clone()),
    };
    Fields::new(what, node)
}

/// The entries of a list of tables, which may be absent.
fn tables(fields: &mut Fields, key: &'static str) -> Result<Vec<Fields>, SceneError> {
    let Some(item) = fields.take(key) else {
        return Ok(Vec::new());
    };
    let nodes = item.list().map_err(|_| {
        item.error(&format!(
            "a list of tables; write [[{key}]] above each entry"
        ))
    })?;
    let numbered = nodes.iter().enumerate();
    numbered
        .map(|(index, node)| Fields::new(format!("{key} {}", index + 1), node.clone()))
        .collect()
}

fn lights(entries: Vec<Fields>, sources: &Sources<'_>) -> Result<Vec<Light>, SceneError> {
    let mut lights: Vec<Light> = Vec::new();
    for (index, mut fields) in entries.into_iter().enumerate() {
        let name_item = fields.take("name");
        let name = match &name_item {
            Some(item) => item.name()?.to_owned(),
            None => default_light_name(index),
        };
        let place = fields.place().clone();
        if lights.iter().any(|light| light.name == name) {
            let place = name_item.as_ref().map_or(&place, |item| item.place());
            let message = format!("a second light is called {name:?}; give each a name of its own");
            return Err(key_error(place, message));
        }
        lights.push(Light::read(name, fields, sources)?);
    }
    Ok(lights)
}

#[cfg(test)]
mod tests;
