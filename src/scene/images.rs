//! The image files of a scene, each read and decoded once.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::SceneError;
use super::obj::ReadFile;
use super::place::Place;
use crate::texture::{EnvironmentMap, Texture, TextureError};

/// Reads and decodes image files; what asks for the same path gets the same
/// image.
pub(crate) struct Images<'a> {
    read: ReadFile<'a>,
    textures: RefCell<BTreeMap<PathBuf, Arc<Texture>>>,
    environments: RefCell<BTreeMap<PathBuf, Arc<EnvironmentMap>>>,
}

impl<'a> Images<'a> {
    /// Images of files that `read` finds.
    pub(crate) fn new(read: ReadFile<'a>) -> Self {
        Self {
            read,
            textures: RefCell::default(),
            environments: RefCell::default(),
        }
    }

    /// The colour map at `path`, which `place` asks for.
    ///
    /// # Errors
    /// A file that cannot be read, and one that is not such an image.
    pub(crate) fn texture(&self, path: &Path, place: &Place) -> Result<Arc<Texture>, SceneError> {
        self.image(&self.textures, path, place, Texture::decode)
    }

    /// The map of the sky at `path`, which `place` asks for.
    ///
    /// # Errors
    /// A file that cannot be read, and one that is not such an image.
    pub(crate) fn environment(
        &self,
        path: &Path,
        place: &Place,
    ) -> Result<Arc<EnvironmentMap>, SceneError> {
        self.image(&self.environments, path, place, EnvironmentMap::decode)
    }

    fn image<T>(
        &self,
        known: &RefCell<BTreeMap<PathBuf, Arc<T>>>,
        path: &Path,
        place: &Place,
        decode: fn(&[u8], &Path) -> Result<T, TextureError>,
    ) -> Result<Arc<T>, SceneError> {
        if let Some(image) = known.borrow().get(path) {
            return Ok(image.clone());
        }
        let bytes = (self.read)(path).map_err(|source| SceneError::Read {
            place: format!("{place}: "),
            path: path.to_owned(),
            source,
        })?;
        let image = decode(&bytes, path).map_err(|source| SceneError::Image {
            place: place.to_string(),
            source,
        })?;
        let image = Arc::new(image);
        known.borrow_mut().insert(path.to_owned(), image.clone());
        Ok(image)
    }
}

/// Where the files are that a scene file names.
pub(crate) struct Sources<'a> {
    /// Where relative paths start.
    pub(crate) folder: &'a Path,
    /// What decodes images.
    pub(crate) images: &'a Images<'a>,
}
