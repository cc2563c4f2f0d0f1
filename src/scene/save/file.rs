//! Replaces a file that a person keeps.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What became of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Saved {
    /// It holds the new bytes.
    Written,
    /// It no longer holds the bytes that were read, and was left alone.
    ChangedMeanwhile,
}

/// Puts new bytes into a file, through a temporary file in its folder, so that
/// it holds the old or the new ones at any time. A link is followed and stays,
/// permissions stay. Where `read` is given and the file no longer holds these
/// bytes (or is gone), nothing is written.
///
/// # Errors
/// If the file is write-protected or the folder cannot be written to.
pub(crate) fn save_file(path: &Path, read: Option<&[u8]>, bytes: &[u8]) -> io::Result<Saved> {
    if let Some(read) = read
        && holds_other(path, read)?
    {
        return Ok(Saved::ChangedMeanwhile);
    }
    let target = followed(path)?;
    let permissions = match fs::metadata(&target) {
        Ok(found) if found.permissions().readonly() => {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        Ok(found) => Some(found.permissions()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new()
        .prefix(".relume-")
        .tempfile_in(folder)?;
    file.write_all(bytes)?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    Ok(Saved::Written)
}

fn holds_other(path: &Path, read: &[u8]) -> io::Result<bool> {
    match fs::read(path) {
        Ok(found) => Ok(found != read),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(error),
    }
}

/// The file that a path leads to; the path itself where there is none yet.
fn followed(path: &Path) -> io::Result<PathBuf> {
    match fs::canonicalize(path) {
        Ok(target) => Ok(target),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(path.to_owned()),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_changed_meanwhile_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, "old").unwrap();
        let saved = save_file(&path, Some(b"old"), b"new").unwrap();
        assert_eq!(
            (saved, fs::read(&path).unwrap()),
            (Saved::Written, b"new".to_vec())
        );
        let saved = save_file(&path, Some(b"old"), b"newer").unwrap();
        assert_eq!(saved, Saved::ChangedMeanwhile);
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(save_file(&path, None, b"newer").unwrap(), Saved::Written);
        assert_eq!(
            fs::read_dir(folder.path()).unwrap().count(),
            1,
            "no file is left over"
        );
        fs::remove_file(&path).unwrap();
        let saved = save_file(&path, Some(b"newer"), b"x").unwrap();
        assert_eq!(
            saved,
            Saved::ChangedMeanwhile,
            "a file that is gone has changed"
        );
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("target.toml");
        let link = folder.path().join("link.toml");
        fs::write(&target, "old").unwrap();
        fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("target.toml", &link).unwrap();
        assert_eq!(
            save_file(&link, Some(b"old"), b"new").unwrap(),
            Saved::Written
        );
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"new");
        let mode = fs::metadata(&target).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        fs::set_permissions(&target, fs::Permissions::from_mode(0o440)).unwrap();
        let error = save_file(&link, Some(b"new"), b"newer").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::PermissionDenied);
    }
}
