//! What an EXR file's header says before its pixels are read, and files of
//! luminance alone, which the decoder for colours does not take.

use std::io::Cursor;

use exr::compression::Compression;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers, read};
use glam::Vec3;

use super::image_file::{Fault, ImageFile, Pixels, check_size, defined_radiance};

/// What a file holds.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Channels {
    /// Red, green and blue, or something that is refused later.
    Color,
    /// The channel Y and no colour.
    Luminance,
}

/// Refuses sizes above the limits and compressions whose decoded bits depend
/// on the processor.
pub(super) fn check(bytes: &[u8]) -> Result<Channels, Fault> {
    let meta = MetaData::read_from_buffered(bytes, false)
        .map_err(|error| Fault::Broken(error.to_string()))?;
    for header in &meta.headers {
        if matches!(
            header.compression,
            Compression::DWAA(_) | Compression::DWAB(_)
        ) {
            return Err(Fault::Content(
                "an OpenEXR file of the lossy compression DWA, which decodes to other values on \
                 other processors; save it with ZIP or PIZ"
                    .to_owned(),
            ));
        }
        for size in [
            header.layer_size,
            header.shared_attributes.display_window.size,
        ] {
            check_size(size.width() as u64, size.height() as u64)?;
        }
    }
    let has = |name: &str| {
        let mut channels = meta.headers.iter().flat_map(|header| &header.channels.list);
        channels.any(|channel| channel.name.eq_case_insensitive(name))
    };
    let is_luminance = has("Y") && !["R", "G", "B", "RY", "BY"].into_iter().any(has);
    Ok(if is_luminance {
        Channels::Luminance
    } else {
        Channels::Color
    })
}

/// The image of a file whose channel Y is its luminance.
pub(super) fn read_luminance(bytes: &[u8]) -> Result<ImageFile, Fault> {
    let broken = |error: exr::error::Error| Fault::Broken(error.to_string());
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    let layer = image.layer_data;
    let channels = &layer.channel_data.list;
    let luminance = channels
        .iter()
        .find(|channel| channel.name.eq_case_insensitive("Y"))
        .ok_or_else(|| Fault::Broken("no luminance in the first layer".to_owned()))?;
    let values = luminance.sample_data.values_as_f32();
    let pixels: Vec<Vec3> = values.map(|y| Vec3::splat(defined_radiance(y))).collect();
    let [width, height] = [layer.size.width(), layer.size.height()];
    if pixels.len() != width * height {
        return Err(Fault::Broken("pixels are missing".to_owned()));
    }
    Ok(ImageFile {
        size: [width as u32, height as u32],
        pixels: Pixels::Linear(pixels),
    })
}
