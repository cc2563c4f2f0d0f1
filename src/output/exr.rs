//! OpenEXR: linear float RGB out; half or float RGB, RGBA or luminance in;
//! metadata as attributes.

use std::io::Cursor;

use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{Encoding, ReadChannels, ReadLayers, SpecificChannels, WritableImage, read};
use glam::Vec3;

use super::{CodecError, Format, MOST_SIDE, Picture, PictureMetadata};
use crate::compare::ComparedImage;
use crate::frame::{Image, LoadedImage, Metadata};

pub(super) const FORMAT: Format = Format {
    extension: "exr",
    encode,
    decode,
};

type FlatLayer = Layer<AnyChannels<FlatSamples>>;

fn encode(frame: Picture<'_>, metadata: &PictureMetadata) -> Result<Vec<u8>, CodecError> {
    let (image, metadata) = (frame.linear, &metadata.linear);
    let size = Vec2(image.width() as usize, image.height() as usize);
    let mut attributes = LayerAttributes::default();
    for (name, value) in metadata.entries() {
        let (name, value) = (text(name)?, text(value)?);
        if name.eq(Metadata::SOFTWARE) {
            attributes.software_name = Some(value);
        } else {
            attributes.other.insert(name, AttributeValue::Text(value));
        }
    }
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let pixel = image.pixels()[at.flat_index_for_size(size)];
        (pixel.x, pixel.y, pixel.z)
    });
    let layer = Layer::new(size, attributes, Encoding::FAST_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    exr::image::Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes)?;
    Ok(bytes)
}

fn text(value: &str) -> Result<Text, CodecError> {
    Text::new_or_none(value)
        .ok_or_else(|| format!("{value:?} has letters that EXR does not know").into())
}

/// Puts the header's attributes in the order of their names: the encoder keeps
/// them in a hash map and writes them in another order every time. Their length
/// in all stays, and so do the places of the pixels.
fn sort_attributes(bytes: &mut [u8]) -> Result<(), CodecError> {
    /// Magic number and version.
    const START: usize = 8;
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut end = START;
    while bytes.get(end).is_some_and(|&first| first != 0) {
        let length = attribute_length(&bytes[end..]).ok_or("the header was not understood")?;
        attributes.push(bytes[end..end + length].to_vec());
        end += length;
    }
    attributes.sort();
    bytes[START..end].copy_from_slice(&attributes.concat());
    Ok(())
}

/// Bytes of the attribute at the start: name and type, each ended by a zero,
/// four bytes of length, and as many of value.
fn attribute_length(bytes: &[u8]) -> Option<usize> {
    let name = bytes.iter().position(|&byte| byte == 0)? + 1;
    let kind = bytes.get(name..)?.iter().position(|&byte| byte == 0)? + 1;
    let value = name + kind + size_of::<u32>();
    let size = bytes
        .get(name + kind..value)?
        .first_chunk::<{ size_of::<u32>() }>()?;
    let length = value + u32::from_le_bytes(*size) as usize;
    (length <= bytes.len()).then_some(length)
}

fn decode(bytes: &[u8]) -> Result<ComparedImage, CodecError> {
    check(bytes)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    let window = image.attributes.display_window;
    let layers = image.layer_data.iter();
    let mut found = layers.filter_map(|layer| Some((layer, colour_channels(layer)?)));
    let (layer, [red, green, blue]) = found
        .next()
        .ok_or("no layer has the channels R, G and B, or Y")?;
    let [red, green, blue] =
        [red, green, blue].map(|channel| in_window(layer, channel, window, 0.0));
    let colours = red.into_iter().zip(green).zip(blue);
    let colours = colours.map(|((r, g), b)| Vec3::new(r, g, b)).collect();
    let [width, height] = [window.size.width(), window.size.height()].map(|side| side as u32);
    let pixels = LoadedImage::Linear(Image::new(width, height, colours)?);
    let decoded = ComparedImage::new(pixels).with_metadata(metadata(&layer.attributes));
    match channel(layer, "A") {
        Some(alpha) => Ok(decoded.with_alpha(in_window(layer, alpha, window, 0.0))?),
        None => Ok(decoded),
    }
}

/// Refuses, before the pixels are read, what is too large, and a compression
/// whose decoded bits depend on the processor.
fn check(bytes: &[u8]) -> Result<(), CodecError> {
    for header in &MetaData::read_from_buffered(Cursor::new(bytes), false)?.headers {
        if matches!(
            header.compression,
            Compression::DWAA(_) | Compression::DWAB(_)
        ) {
            return Err(
                "the lossy compression DWA decodes to other values on other processors; \
                 save it with ZIP or PIZ"
                    .into(),
            );
        }
        let window = header.shared_attributes.display_window.size;
        for size in [header.layer_size, window] {
            let [width, height] = [size.width(), size.height()];
            if width.max(height) > MOST_SIDE as usize {
                return Err(format!(
                    "{width} x {height} pixels; at most {MOST_SIDE} a side are read"
                )
                .into());
            }
        }
    }
    Ok(())
}

/// Red, green and blue, or luminance in the place of all three.
fn colour_channels(layer: &FlatLayer) -> Option<[&AnyChannel<FlatSamples>; 3]> {
    let colours = ["R", "G", "B"].map(|name| channel(layer, name));
    if let [Some(red), Some(green), Some(blue)] = colours {
        return Some([red, green, blue]);
    }
    let luminance = channel(layer, "Y")?;
    let is_grey = colours.iter().all(Option::is_none) && channel(layer, "RY").is_none();
    is_grey.then_some([luminance; 3])
}

fn channel<'a>(layer: &'a FlatLayer, name: &str) -> Option<&'a AnyChannel<FlatSamples>> {
    let channels = &layer.channel_data.list;
    channels
        .iter()
        .find(|channel| channel.name.eq_case_insensitive(name))
}

/// The values of a channel in the display window, `outside` where the layer has
/// none.
fn in_window(
    layer: &FlatLayer,
    channel: &AnyChannel<FlatSamples>,
    window: IntegerBounds,
    outside: f32,
) -> Vec<f32> {
    let mut values = vec![outside; window.size.area()];
    let offset = layer.attributes.layer_position - window.position;
    let samples = channel.sample_data.values_as_f32();
    for (index, value) in samples.enumerate() {
        let x = (index % layer.size.width()) as i64 + i64::from(offset.x());
        let y = (index / layer.size.width()) as i64 + i64::from(offset.y());
        let [width, height] = [window.size.width(), window.size.height()].map(|n| n as i64);
        if (0..width).contains(&x) && (0..height).contains(&y) {
            values[(y * width + x) as usize] = value;
        }
    }
    values
}

/// relume's own attributes, in the order of their names; those of other
/// programs, which like to hold times, say nothing of a frame.
fn metadata(attributes: &LayerAttributes) -> Metadata {
    let mut metadata = Metadata::default();
    if let Some(software) = &attributes.software_name {
        metadata.set(Metadata::SOFTWARE, software.to_string());
    }
    #[expect(
        clippy::disallowed_methods,
        reason = "what the map holds is sorted before anyone sees it"
    )]
    let own = attributes
        .other
        .iter()
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        });
    let mut own: Vec<(String, String)> = own
        .filter(|(name, _)| name.starts_with(Metadata::PREFIX))
        .collect();
    own.sort();
    for (name, value) in own {
        metadata.set(&name, value);
    }
    metadata
}
