//! The image files of a scene, each read and decoded once.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::SceneError;
use super::files::Finder;
use super::place::Place;
use crate::texture::{EnvironmentMap, Texture, TextureError};

/// Reads and decodes image files; what asks for the same path gets the same
/// image.
pub(crate) struct Images<'a> {
    finder: &'a Finder<'a>,
    /// By their path, and by the paths that were asked for.
    textures: RefCell<BTreeMap<PathBuf, Result<Arc<Texture>, Unreadable>>>,
    environments: RefCell<BTreeMap<PathBuf, Arc<EnvironmentMap>>>,
}

/// A file that cannot be read, and the system's words for it.
#[derive(Debug, Clone)]
pub(crate) struct Unreadable {
    pub(crate) path: PathBuf,
    pub(crate) reason: String,
}

impl<'a> Images<'a> {
    /// Images of the files that `finder` finds.
    pub(crate) fn new(finder: &'a Finder<'a>) -> Self {
        Self {
            finder,
            textures: RefCell::default(),
            environments: RefCell::default(),
        }
    }

    /// The colour map that `name`, written at `place` in a file of `folder`,
    /// means; see [`Finder::read_named`].
    ///
    /// # Errors
    /// A file that is there but is no such image.
    pub(crate) fn texture(
        &self,
        folder: &Path,
        name: &str,
        place: &Place,
    ) -> Result<Result<Arc<Texture>, Unreadable>, SceneError> {
        let asked = folder.join(name);
        let mut known = self.textures.borrow_mut();
        if let Some(texture) = known.get(&asked) {
            return Ok(texture.clone());
        }
        let (path, bytes) = self.finder.read_named(folder, name);
        let texture = match (known.get(&path), bytes) {
            (Some(texture), _) => texture.clone(),
            (None, Ok(bytes)) => Ok(Arc::new(
                Texture::decode(&bytes, &path).map_err(|source| unusable(place, source))?,
            )),
            (None, Err(error)) => Err(Unreadable {
                path: path.clone(),
                reason: error.to_string(),
            }),
        };
        known.insert(path, texture.clone());
        known.insert(asked, texture.clone());
        Ok(texture)
    }

    /// The map of the sky at `path`, which `place` asks for.
    ///
    /// # Errors
    /// A file that cannot be read, and one that is no such image.
    pub(crate) fn environment(
        &self,
        path: &Path,
        place: &Place,
    ) -> Result<Arc<EnvironmentMap>, SceneError> {
        let mut known = self.environments.borrow_mut();
        if let Some(map) = known.get(path) {
            return Ok(map.clone());
        }
        let bytes = self.finder.read(path).map_err(|source| SceneError::Read {
            place: format!("{place}: "),
            path: path.to_owned(),
            source,
        })?;
        let map = EnvironmentMap::decode(&bytes, path).map_err(|source| unusable(place, source))?;
        let map = Arc::new(map);
        known.insert(path.to_owned(), map.clone());
        Ok(map)
    }
}

fn unusable(place: &Place, source: TextureError) -> SceneError {
    SceneError::Image {
        place: place.to_string(),
        source,
    }
}

/// Where the files are that a scene file names.
pub(crate) struct Sources<'a> {
    /// Where relative paths start.
    pub(crate) folder: &'a Path,
    /// What decodes images.
    pub(crate) images: &'a Images<'a>,
}
