//! A frame at the scene's size, into a file: what `render` writes of the scene as
//! it is lit now.

use std::path::Path;

use super::painter::{Painter, Wish};
use crate::bake::RunSettings;
use crate::output::{Picture, PictureMetadata, write_described};
use crate::relight::{FrameSettings, describe_levels};

/// Draws and writes it; gives the digest of its pixels, or says why not.
pub(crate) fn write_frame(
    painter: &mut Painter,
    wish: &Wish,
    size: [u32; 2],
    path: &Path,
    run: &RunSettings,
) -> Result<String, String> {
    if painter.lacks_folding(wish) {
        return Err("with fixed_albedo another albedo needs a bake, which is not ready".to_owned());
    }
    if painter.lacks_bake(wish) {
        return Err("the bake is not ready, and its light would be missing".to_owned());
    }
    if let Some(name) = painter.lacks_slices_of(wish) {
        return Err(format!(
            "the bounced gloss of {name} needs a bake, which is not ready"
        ));
    }
    let frame = painter.whole_frame(wish, size, run);
    let frame = frame.map_err(|error| error.to_string())?;
    let levels = frame.develop(wish.exposure, wish.tone);
    let mut settings: FrameSettings = wish.frame;
    settings.camera.size = size;
    let linear = painter.renderer().describe(&settings);
    let metadata = PictureMetadata {
        encoded: describe_levels(&linear, settings.component, wish.exposure, wish.tone),
        linear,
    };
    let picture = Picture {
        linear: &frame.image,
        encoded: &levels,
    };
    write_described(path, picture, &metadata).map_err(|error| error.to_string())?;
    Ok(levels.digest())
}
