//! What an EXR file's header says before its pixels are read.

use exr::compression::Compression;
use exr::meta::MetaData;

use super::image_file::{Fault, check_size};

/// Refuses sizes above the limits and compressions whose decoded bits depend
/// on the processor.
pub(super) fn check(bytes: &[u8]) -> Result<(), Fault> {
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
    Ok(())
}
