//! Where a scene's golden is.
//!
//! The root of a scene is the nearest folder above its file (its own folder
//! first) that holds a folder `golden`; a folder with a `.git` is the last that
//! is looked at, so that no suite reaches out of its repository. The golden of
//! `ROOT/a/b.toml` is `ROOT/golden/a/b.png`. Beside the scene, `b.golden.png`
//! serves too, with or without a root. Of each, `.exr` is as good as `.png`.
//! A scene has one golden.

use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

/// Folder of goldens below a root.
pub(super) const FOLDER: &str = "golden";
/// Extensions of goldens; a new one has the first.
pub(super) const EXTENSIONS: [&str; 2] = ["png", "exr"];
/// What ends the name of a golden beside its scene, before the extension.
pub(super) const BESIDE: &str = ".golden";
/// Marks a folder above which nothing belongs to the suite.
const REPOSITORY: &str = ".git";

/// A scene file and the place of its golden image.
///
/// Paths are relative to the current folder where they lie below it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GoldenScene {
    scene: PathBuf,
    found: Vec<PathBuf>,
    /// Where a golden is written if there is none.
    new: PathBuf,
}

impl GoldenScene {
    /// Looks where the golden of a scene file is (see the [room](super) for the
    /// rule). Neither file is read.
    ///
    /// # Errors
    /// If the scene file is not there.
    pub fn of(scene: &Path) -> io::Result<Self> {
        let whole = scene.canonicalize()?;
        let beside = [BESIDE, ""].map(|end| with_end(&whole, end));
        let below_root = root_of(&whole).and_then(|root| {
            let inside = whole.strip_prefix(&root).ok()?;
            Some(root.join(FOLDER).join(inside))
        });
        let below_root = below_root.as_deref().map(|path| with_end(path, ""));
        let places = below_root.iter().chain(&beside[..1]);
        let files = places.flat_map(|stem| EXTENSIONS.map(|it| with_extension(stem, it)));
        let new = with_extension(below_root.as_ref().unwrap_or(&beside[0]), EXTENSIONS[0]);
        Ok(Self {
            scene: relative(scene),
            found: files
                .filter(|it| it.exists())
                .map(|it| relative(&it))
                .collect(),
            new: relative(&new),
        })
    }

    /// The scene file.
    pub fn scene(&self) -> &Path {
        &self.scene
    }

    /// The golden, or where it is to be.
    pub fn golden(&self) -> &Path {
        self.found.first().unwrap_or(&self.new)
    }

    /// Whether a golden is there.
    pub fn has_golden(&self) -> bool {
        !self.found.is_empty()
    }

    /// All goldens that are there; more than one is a mistake.
    pub(super) fn all_goldens(&self) -> &[PathBuf] {
        &self.found
    }

    /// Lets a missing golden be linear values (`.exr`) instead of levels.
    #[must_use]
    pub fn with_linear_golden(mut self) -> Self {
        self.new.set_extension(EXTENSIONS[1]);
        self
    }
}

/// The root of a whole path; see the [room](super).
pub(super) fn root_of(whole: &Path) -> Option<PathBuf> {
    for folder in whole.ancestors().skip(1) {
        if folder.join(FOLDER).is_dir() {
            return Some(folder.to_owned());
        }
        if folder.join(REPOSITORY).exists() {
            return None;
        }
    }
    None
}

/// The path without its extension and with `end` at the end of its name.
fn with_end(path: &Path, end: &str) -> PathBuf {
    let mut name: OsString = path.file_stem().unwrap_or_default().to_owned();
    name.push(end);
    path.with_file_name(name)
}

/// The path with an extension behind its whole name, whatever dots it has.
fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut name: OsString = stem.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(extension);
    stem.with_file_name(name)
}

/// The path from the current folder, if it lies below; else as it is.
pub(super) fn relative(path: &Path) -> PathBuf {
    let here = std::env::current_dir().and_then(|it| it.canonicalize());
    let inside = here.ok().and_then(|here| path.strip_prefix(here).ok());
    let path = inside.unwrap_or(path);
    // "./a" is "a"; the components of a path leave such points out but at its start.
    path.strip_prefix(".").unwrap_or(path).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// An empty file at a path of `folder`, whose folders are made.
    fn touch(folder: &Path, path: &str) -> PathBuf {
        let file = folder.join(path);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, "").unwrap();
        file
    }

    #[test]
    fn the_nearest_folder_with_goldens_is_the_root() {
        let folder = tempfile::tempdir().unwrap();
        let top = folder.path().canonicalize().unwrap();
        let scene = touch(&top, "scenes/box/lamp.v2.toml");
        let golden = || GoldenScene::of(&scene).unwrap().golden().to_owned();
        fs::create_dir(top.join(".git")).unwrap();
        assert_eq!(golden(), top.join("scenes/box/lamp.v2.golden.png"));
        fs::create_dir(top.join("golden")).unwrap();
        assert_eq!(golden(), top.join("golden/scenes/box/lamp.v2.png"));
        fs::create_dir(top.join("scenes/golden")).unwrap();
        assert_eq!(golden(), top.join("scenes/golden/box/lamp.v2.png"));
        fs::create_dir(top.join("scenes/.git")).unwrap();
        fs::remove_dir(top.join("scenes/golden")).unwrap();
        assert_eq!(golden(), top.join("scenes/box/lamp.v2.golden.png"));
    }

    #[test]
    fn goldens_that_are_there_are_found_in_both_places_and_formats() {
        let folder = tempfile::tempdir().unwrap();
        let top = folder.path().canonicalize().unwrap();
        let scene = touch(&top, "a.toml");
        assert!(!GoldenScene::of(&scene).unwrap().has_golden());
        let linear = touch(&top, "a.golden.exr");
        assert_eq!(GoldenScene::of(&scene).unwrap().golden(), linear);
        let levels = touch(&top, "golden/a.png");
        let found = GoldenScene::of(&scene).unwrap();
        assert_eq!(found.all_goldens(), [levels, linear]);
    }
}
