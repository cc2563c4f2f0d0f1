//! Where files come from, and which file a name in an OBJ or MTL file means.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::io;
use std::path::{Component, Path, PathBuf};

/// A source of files: the disk, or a table in tests.
pub(crate) trait Files {
    /// The bytes of a file.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// What a folder holds, in any order; nothing where it cannot be listed.
    fn names(&self, folder: &Path) -> Vec<OsString>;
}

/// The file system.
#[derive(Debug)]
pub(crate) struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let kind = std::fs::metadata(path)?.file_type();
        if kind.is_file() || kind.is_dir() {
            // The system's own words say that a folder is no file.
            std::fs::read(path)
        } else {
            // A device may have no end, and a pipe no beginning.
            Err(io::Error::other("it is a device or a pipe, not a file"))
        }
    }

    fn names(&self, folder: &Path) -> Vec<OsString> {
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        let entries = std::fs::read_dir(folder).into_iter().flatten();
        entries.flatten().map(|entry| entry.file_name()).collect()
    }
}

/// Files of a source, with a list of those that were asked for.
pub(crate) struct Recorded<'a> {
    files: &'a dyn Files,
    asked: RefCell<BTreeSet<PathBuf>>,
}

impl<'a> Recorded<'a> {
    pub(crate) fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            asked: RefCell::default(),
        }
    }

    /// Every path that was asked for, whether there is a file or not, in order of
    /// their names.
    pub(crate) fn asked(&self) -> Vec<PathBuf> {
        self.asked.borrow().iter().cloned().collect()
    }
}

impl Files for Recorded<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.asked.borrow_mut().insert(path.to_owned());
        self.files.read(path)
    }

    fn names(&self, folder: &Path) -> Vec<OsString> {
        self.files.names(folder)
    }
}

/// A path and what reading it gives.
pub(crate) type ReadFile = (PathBuf, io::Result<Vec<u8>>);

/// Finds the files that names in OBJ and MTL files mean.
pub(crate) struct Finder<'a> {
    files: &'a dyn Files,
    /// The folders looked into so far.
    listings: RefCell<BTreeMap<PathBuf, Listing>>,
}

/// What a folder holds.
#[derive(Debug, Default)]
struct Listing {
    names: BTreeSet<OsString>,
    /// By name in lower case; `None` where several are equal.
    by_lower_case: BTreeMap<String, Option<OsString>>,
}

impl<'a> Finder<'a> {
    /// Finds files of a source.
    pub(crate) fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            listings: RefCell::default(),
        }
    }

    /// Reads the file at exactly this path.
    pub(crate) fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files.read(path)
    }

    /// Reads the file that `name` means, written in a file of `folder` by
    /// whatever program on whatever system: back-slashes separate too, quotes
    /// may stand around it and a comment after it. Where no such file can be
    /// read,
    /// 1. an absolute path, being that of another machine, stands for its last
    ///    part, beside the file that names it;
    /// 2. upper and lower case are taken as equal, if just one name fits.
    ///
    /// Gives the path as written, and the error of reading it, where nothing
    /// helps.
    pub(crate) fn read_named(&self, folder: &Path, name: &str) -> ReadFile {
        let found = self.read_spelled(folder, name);
        match name.split_once(" #") {
            Some((before, _)) if found.1.is_err() => {
                let without_comment = self.read_spelled(folder, before.trim_end());
                if without_comment.1.is_ok() {
                    without_comment
                } else {
                    found
                }
            }
            _ => found,
        }
    }

    fn read_spelled(&self, folder: &Path, name: &str) -> ReadFile {
        let name = unquoted(name).replace('\\', "/");
        let written = folder.join(&name);
        let bytes = self.files.read(&written);
        if bytes.is_ok() {
            return (written, bytes);
        }
        let relative = if is_absolute(&name) {
            name.rsplit('/').next().unwrap_or_default()
        } else {
            &name
        };
        let similar = self.ignoring_case(folder, relative);
        let similar = similar.filter(|path| *path != written);
        match similar.map(|path| (self.files.read(&path), path)) {
            Some((Ok(bytes), path)) => (path, Ok(bytes)),
            _ => (written, bytes),
        }
    }

    /// A path below `folder` that is equal to `relative` but for upper and
    /// lower case; `None` where none or several are.
    fn ignoring_case(&self, folder: &Path, relative: &str) -> Option<PathBuf> {
        let mut path = folder.to_owned();
        for component in Path::new(relative).components() {
            match component {
                Component::CurDir => {}
                Component::ParentDir => path.push(component),
                Component::Normal(name) => {
                    let name = self.name_in(&path, name)?;
                    path.push(name);
                }
                Component::Prefix(_) | Component::RootDir => return None,
            }
        }
        Some(path)
    }

    /// The name in a folder that is equal to `name`, or equal but for case.
    fn name_in(&self, folder: &Path, name: &OsStr) -> Option<OsString> {
        let mut listings = self.listings.borrow_mut();
        if !listings.contains_key(folder) {
            let listing = Listing::of(self.files.names(folder));
            listings.insert(folder.to_owned(), listing);
        }
        let listing = &listings[folder];
        if listing.names.contains(name) {
            return Some(name.to_owned());
        }
        listing.by_lower_case.get(&lower_case(name))?.clone()
    }
}

impl Listing {
    fn of(names: Vec<OsString>) -> Self {
        let mut listing = Self::default();
        for name in names {
            listing
                .by_lower_case
                .entry(lower_case(&name))
                .and_modify(|only| *only = None)
                .or_insert_with(|| Some(name.clone()));
            listing.names.insert(name);
        }
        listing
    }
}

fn lower_case(name: &OsStr) -> String {
    name.to_string_lossy().to_lowercase()
}

/// Without quotes around it.
fn unquoted(name: &str) -> &str {
    let inside = |quote| name.strip_prefix(quote)?.strip_suffix(quote);
    inside('"').or_else(|| inside('\'')).unwrap_or(name)
}

/// Whether a path starts at the root of a system, whichever that is.
fn is_absolute(path: &str) -> bool {
    let has_drive = |(drive, _): (&str, &str)| drive.len() == 1;
    path.starts_with('/') || path.split_once(':').is_some_and(has_drive)
}

/// Files in memory.
#[cfg(test)]
#[derive(Debug, Default)]
pub(crate) struct Memory(pub(crate) BTreeMap<PathBuf, Vec<u8>>);

#[cfg(test)]
impl Memory {
    /// A table of paths and contents.
    pub(crate) fn of(files: &[(&str, &[u8])]) -> Self {
        let files = files.iter();
        Self(
            files
                .map(|(path, bytes)| (PathBuf::from(path), bytes.to_vec()))
                .collect(),
        )
    }
}

#[cfg(test)]
impl Files for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.0.get(path).cloned();
        bytes.ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn names(&self, folder: &Path) -> Vec<OsString> {
        let below = self
            .0
            .keys()
            .filter_map(|path| path.strip_prefix(folder).ok());
        below
            .filter_map(|path| path.iter().next().map(ToOwned::to_owned))
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str) -> Option<String> {
        let files = Memory::of(&[
            ("dir/Wood 1.PNG", b""),
            ("dir/Textures/Größe.png", b""),
            ("dir/two.png", b""),
            ("dir/Two.png", b""),
            ("dir/has #1.png", b""),
        ]);
        let (path, bytes) = Finder::new(&files).read_named(Path::new("dir"), name);
        bytes.ok().map(|_| path.to_string_lossy().into_owned())
    }

    #[test]
    fn names_of_other_programs_and_systems() {
        let wood = Some("dir/Wood 1.PNG".to_owned());
        for name in [
            "Wood 1.PNG",
            "wood 1.png",
            "\"wood 1.png\"",
            "'Wood 1.PNG'",
            "./wood 1.png",
            "Wood 1.PNG # a comment",
            "C:\\Users\\me\\Wood 1.PNG",
            "C:/Users/me/wood 1.png",
            "/home/me/wood 1.png",
            "\\\\server\\share\\Wood 1.PNG",
        ] {
            let path = found(name).map(|path| path.replace("/./", "/"));
            assert_eq!(path, wood, "{name}");
        }
        let size = Some("dir/Textures/Größe.png".to_owned());
        assert_eq!(
            found("textures\\GRÖSSE.png"),
            None,
            "two letters are not one"
        );
        assert_eq!(found("textures\\GRÖßE.PNG"), size);
        assert_eq!(found("has #1.png"), Some("dir/has #1.png".to_owned()));
    }

    #[test]
    fn names_that_mean_no_file() {
        assert_eq!(found("two.png"), Some("dir/two.png".to_owned()));
        assert_eq!(found("TWO.png"), None, "two names fit");
        for name in ["", "/", "..", "C:", "\"", "Textures", "a/wood 1.png"] {
            assert_eq!(found(name), None, "{name}");
        }
    }

    #[test]
    fn folders_and_devices_are_no_files() {
        assert!(Disk.read(Path::new("/")).is_err());
        if cfg!(unix) {
            assert!(Disk.read(Path::new("/dev/zero")).is_err());
        }
        assert!(Disk.names(Path::new("")).contains(&"Cargo.toml".into()));
    }
}
