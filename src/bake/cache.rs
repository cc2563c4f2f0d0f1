//! The bake from the cache folder, or a new one that goes there.

use std::io::Write;
use std::path::Path;

use glam::Vec3;

use super::file::{decode, encode};
use super::key::BakeKey;
use super::{Bake, BakeError, BakeSettings, RunSettings, bake};
use crate::surface::Surface;

/// Where a bake came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CacheOutcome {
    /// From the cache folder.
    Hit,
    /// Made anew.
    Miss,
}

/// A bake, where it came from, and what the user should know about the cache.
pub(crate) struct Baked {
    pub(crate) bake: Bake,
    /// The bake's without folded bounces.
    pub(crate) key: BakeKey,
    pub(crate) outcome: CacheOutcome,
    /// Bytes of the bake's file.
    pub(crate) file_bytes: usize,
    pub(crate) warnings: Vec<String>,
}

/// Albedo of every vertex of a surface, which may or may not have its back sides
/// yet.
pub(crate) type AlbedoOf<'a> = &'a dyn Fn(&Surface) -> Vec<Vec3>;

/// Takes the bake of a surface (whose back sides do not exist yet) from the
/// folder, or makes it and puts it there; then adds the back sides. Without a
/// folder, nothing is read or written. A file that cannot be used or written
/// is a warning: the bake itself is never in doubt. With a fixed albedo all
/// bounces are folded under it; the bake without is stored beside, so that
/// another albedo costs the folding alone.
pub(crate) fn load_or_bake(
    surface: &mut Surface,
    settings: &BakeSettings,
    fixed_albedo: Option<AlbedoOf>,
    folder: Option<&Path>,
    run: &RunSettings,
) -> Result<Baked, BakeError> {
    let keys = Keys::of(surface, settings, fixed_albedo);
    let mut warnings = Vec::new();
    match load(surface, &keys, folder) {
        Ok(Some(mut baked)) => {
            baked.warnings.extend(baked.bake.stats().shortfall());
            return Ok(baked);
        }
        Ok(None) => {}
        Err(problem) => warnings.push(format!("{problem}; baking anew")),
    }
    let bake = match fixed_albedo {
        Some(albedo_of) => {
            let mut unfolded = load_or_bake(surface, settings, None, folder, run)?;
            warnings.append(&mut unfolded.warnings);
            unfolded.bake.fold(surface, &albedo_of(surface), run)?;
            unfolded.bake
        }
        None => {
            let bake = bake(surface, settings, run)?;
            warnings.extend(bake.stats().shortfall());
            bake
        }
    };
    let (file_bytes, warning) = store(&bake, &keys.file, folder);
    warnings.extend(warning);
    Ok(Baked {
        bake,
        key: keys.unfolded,
        outcome: CacheOutcome::Miss,
        file_bytes,
        warnings,
    })
}

/// Puts a bake of this key whose bounces have been folded into the folder too: under
/// the albedo of the front vertices. Returns the bytes of its file, and what the user
/// should know.
pub(crate) fn store_folded(
    bake: &Bake,
    key: &BakeKey,
    albedo: &[Vec3],
    folder: Option<&Path>,
) -> (usize, Option<String>) {
    store(bake, &key.with_albedo(albedo), folder)
}

/// Puts a bake into the folder, if there is one. Returns the bytes of its file, and
/// what the user should know.
fn store(bake: &Bake, key: &BakeKey, folder: Option<&Path>) -> (usize, Option<String>) {
    let bytes = encode(bake, key);
    let path = folder.map(|folder| folder.join(key.file_name()));
    let error = path.and_then(|path| Some((write(&path, &bytes).err()?, path)));
    let warning = error.map(|(error, path)| {
        format!(
            "{}: the bake could not be stored ({error}); it will be made again next time",
            path.display()
        )
    });
    (bytes.len(), warning)
}

/// Takes the bake of a surface (whose back sides do not exist yet) from the
/// folder and adds the back sides; `None`, and the surface as it was, where
/// there is no bake. A file that cannot be used is an error that names it.
pub(crate) fn load_stored(
    surface: &mut Surface,
    settings: &BakeSettings,
    fixed_albedo: Option<AlbedoOf>,
    folder: Option<&Path>,
) -> Result<Option<Baked>, String> {
    load(surface, &Keys::of(surface, settings, fixed_albedo), folder)
}

/// What the bake of a surface is called, whose back sides do not exist yet.
struct Keys {
    /// Without folded bounces.
    unfolded: BakeKey,
    /// Of the file: the same where none are folded.
    file: BakeKey,
}

impl Keys {
    fn of(surface: &Surface, settings: &BakeSettings, fixed_albedo: Option<AlbedoOf>) -> Self {
        let unfolded = BakeKey::of(surface, settings);
        let file = match fixed_albedo {
            Some(albedo_of) => unfolded.with_albedo(&albedo_of(surface)),
            None => unfolded,
        };
        Self { unfolded, file }
    }
}

fn load(
    surface: &mut Surface,
    keys: &Keys,
    folder: Option<&Path>,
) -> Result<Option<Baked>, String> {
    let Some(path) = folder.map(|folder| folder.join(keys.file.file_name())) else {
        return Ok(None);
    };
    let found = read(&path, &keys.file, surface).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(found.map(|(bake, file_bytes)| {
        bake.add_sides_to(surface);
        Baked {
            bake,
            key: keys.unfolded,
            outcome: CacheOutcome::Hit,
            file_bytes,
            warnings: Vec::new(),
        }
    }))
}

/// The bake at a path; `None` where there is no file.
fn read(path: &Path, key: &BakeKey, surface: &Surface) -> Result<Option<(Bake, usize)>, String> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("the stored bake could not be read ({error})")),
    };
    let bake =
        decode(&bytes, key).map_err(|error| format!("the stored bake cannot be used: {error}"))?;
    if bake.backs().len() != surface.vertices.front_count() {
        return Err("the stored bake cannot be used: it is of another mesh".to_owned());
    }
    Ok(Some((bake, bytes.len())))
}

/// Writes beside the target and renames, so that no half file is ever seen.
fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".relume-");
    open_to_others(&mut builder);
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// Temporary files are private by default; a bake has the rights of any other
/// new file, so that a cache folder can be shared (the umask still applies).
#[cfg(unix)]
fn open_to_others(builder: &mut tempfile::Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(std::fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn open_to_others(_builder: &mut tempfile::Builder<'_, '_>) {}
