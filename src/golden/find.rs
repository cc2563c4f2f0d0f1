//! Finds the scenes of a suite and the goldens that none of them has.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::place::{BESIDE, EXTENSIONS, FOLDER, GoldenScene, relative, root_of};

/// Marks a folder of files that can be made anew (<https://bford.info/cachedir/>),
/// such as Cargo's `target`.
const CACHE_MARK: &str = "CACHEDIR.TAG";
/// The key without which no scene file is one.
const SCENE_KEY: &str = "mesh";
/// What ends the name of a mask, which may lie among goldens.
const MASK: &str = ".mask";

/// The scenes below some paths.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Suite {
    /// In the order of the paths, and below a folder in that of names.
    pub scenes: Vec<GoldenScene>,
    /// Images that are where goldens are, and that are no scene's.
    pub without_scene: Vec<PathBuf>,
}

/// A path of a suite cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: could not be read; check the path and its permissions", path.display())]
pub struct FindError {
    /// The file or folder.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

/// Finds scenes and goldens below folders and at files.
///
/// A file that is given is a scene. Below a folder, a `.toml` file is a scene if
/// it has a golden or if it sets `mesh` above its first section; whether the rest
/// of it can be understood does not matter here. Folders whose name begins with
/// a point, folders marked as caches (`CACHEDIR.TAG`) and links to folders are
/// left out. An image is where goldens are if it lies in the folder `golden` of a
/// root, in the place of a scene below one of the paths, or if it is called
/// `X.golden.png`; one that is called `X.mask.png` is a mask.
///
/// # Errors
/// If a path, or a folder below it, cannot be read.
pub fn find(paths: &[PathBuf]) -> Result<Suite, FindError> {
    let mut search = Search::default();
    for path in paths {
        search.add(path)?;
    }
    Ok(search.suite)
}

#[derive(Default)]
struct Search {
    suite: Suite,
    /// Whole paths of the suite's scenes and of the images that were judged.
    seen: Vec<PathBuf>,
}

impl Search {
    fn add(&mut self, path: &Path) -> Result<(), FindError> {
        let whole = path.canonicalize().map_err(|source| FindError {
            path: path.to_owned(),
            source,
        })?;
        if !whole.is_dir() {
            return self.add_scene(path, true);
        }
        let mut files = Vec::new();
        walk(path, &mut files)?;
        for file in &files {
            if file.extension().is_some_and(|it| it == "toml") {
                self.add_scene(file, false)?;
            } else if is_image_called(file, BESIDE) {
                self.add_stray(file, &whole);
            }
        }
        // Goldens of the scenes below the path lie in folders below it and in
        // the root's, which may be above it.
        let mut folders: Vec<PathBuf> = files
            .iter()
            .flat_map(|file| file.ancestors())
            .filter(|it| it.starts_with(path))
            .filter(|it| it.file_name().is_some_and(|name| name == FOLDER))
            .map(Path::to_owned)
            .collect();
        folders.extend(root_of(&whole.join(SCENE_KEY)).map(|root| root.join(FOLDER)));
        folders.sort();
        folders.dedup();
        for folder in folders {
            let mut images = Vec::new();
            walk(&folder, &mut images)?;
            images.iter().for_each(|it| self.add_stray(it, &whole));
        }
        Ok(())
    }

    fn add_scene(&mut self, path: &Path, is_given: bool) -> Result<(), FindError> {
        let error = |source| FindError {
            path: path.to_owned(),
            source,
        };
        let whole = path.canonicalize().map_err(error)?;
        if self.seen.contains(&whole) {
            return Ok(());
        }
        let found = GoldenScene::of(path).map_err(error)?;
        if is_given || found.has_golden() || sets_mesh(&fs::read(path).map_err(error)?) {
            self.suite.scenes.push(found);
            self.seen.push(whole);
        }
        Ok(())
    }

    /// Takes note of an image that has no scene, if its scene would be below
    /// `given`.
    fn add_stray(&mut self, image: &Path, given: &Path) {
        let Ok(whole) = image.canonicalize() else {
            return;
        };
        if !is_image_called(image, "") || is_image_called(image, MASK) || self.seen.contains(&whole)
        {
            return;
        }
        let scenes = scenes_of(&whole);
        let mut there = scenes.iter().filter(|it| it.starts_with(given));
        let has_place = there.clone().next().is_some();
        let shown = relative(&whole);
        let is_used = there
            .any(|scene| GoldenScene::of(scene).is_ok_and(|it| it.all_goldens().contains(&shown)));
        if has_place && !is_used {
            self.suite.without_scene.push(shown);
            self.seen.push(whole);
        }
    }
}

/// The scene files whose golden an image could be by its place.
fn scenes_of(image: &Path) -> Vec<PathBuf> {
    let mut scenes = Vec::new();
    let stem = image.with_extension("");
    if is_image_called(image, BESIDE) {
        scenes.push(stem.with_extension("toml"));
    }
    for folder in image.ancestors().skip(1) {
        if folder.file_name().is_some_and(|name| name == FOLDER) {
            let place = folder.parent().zip(image.strip_prefix(folder).ok());
            scenes.extend(place.map(|(root, inside)| {
                let mut name = inside.file_stem().unwrap_or_default().to_owned();
                name.push(".toml");
                root.join(inside.with_file_name(name))
            }));
        }
    }
    scenes
}

/// Whether a file has an extension of goldens, and `end` before it.
fn is_image_called(file: &Path, end: &str) -> bool {
    let stem = file.file_stem().unwrap_or_default().as_encoded_bytes();
    let is_image = |known: &str| file.extension().is_some_and(|it| it == known);
    stem.ends_with(end.as_bytes()) && EXTENSIONS.iter().any(|known| is_image(known))
}

/// Whether a line above the first section of a TOML text sets `mesh`. The text
/// need not be TOML: a scene with a mistake is a scene.
fn sets_mesh(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.lines().map(str::trim_start);
    let above = lines.by_ref().take_while(|line| !line.starts_with('['));
    above.into_iter().any(|line| {
        let key = line.split_once('=').map(|(key, _)| key.trim());
        key.is_some_and(|key| key.trim_matches(['"', '\'']) == SCENE_KEY)
    })
}

/// All files below a folder, in the order of their names.
fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), FindError> {
    let error = |source| FindError {
        path: folder.to_owned(),
        source,
    };
    if folder.join(CACHE_MARK).exists() {
        return Ok(());
    }
    let entries = fs::read_dir(folder).map_err(error)?;
    let mut entries = entries.collect::<io::Result<Vec<_>>>().map_err(error)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        if entry.file_name().as_encoded_bytes().starts_with(b".") {
            continue;
        }
        // Of a link this is the link's own type, so no circle is followed.
        let kind = entry.file_type().map_err(error)?;
        if kind.is_dir() {
            walk(&entry.path(), files)?;
        } else if entry.path().is_file() {
            files.push(entry.path());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
