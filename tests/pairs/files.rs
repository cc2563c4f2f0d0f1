//! Image files of every kind, made without relume's own writers.

use std::io::Cursor;

use exr::prelude::{SpecificChannels, WritableImage};
use glam::Vec3;
use png::{BitDepth, ColorType, Encoder};
use relume::Image;

/// A file, and what it means to a reader.
#[derive(Clone)]
pub(super) struct Side {
    pub(super) bytes: Vec<u8>,
    pub(super) extension: &'static str,
    pub(super) size: [u32; 2],
    /// Red, green, blue and alpha by pixel; empty for what is no image.
    pub(super) values: Vec<[f32; 4]>,
}

/// Levels of an opaque image as 8-bit RGB.
pub(super) fn rgb(levels: &Image) -> Side {
    let values = opaque(levels, 255.0);
    let samples = values.iter().flat_map(|rgba| rgba[..3].to_vec());
    let bytes: Vec<u8> = samples.map(|level| level as u8).collect();
    png(levels, ColorType::Rgb, BitDepth::Eight, &bytes, values)
}

/// Levels with fractions of 1/257 as 16-bit RGB.
pub(super) fn rgb16(levels: &Image) -> Side {
    let deep = |level: f32| (level * 257.0).round() as u16;
    let values: Vec<[f32; 4]> = opaque(levels, 255.0)
        .iter()
        .map(|rgba| rgba.map(|level| f32::from(deep(level)) / 257.0))
        .collect();
    let samples = values.iter().flat_map(|rgba| rgba[..3].to_vec());
    let bytes: Vec<u8> = samples
        .flat_map(|level| deep(level).to_be_bytes())
        .collect();
    png(levels, ColorType::Rgb, BitDepth::Sixteen, &bytes, values)
}

/// The red levels as 8-bit grey.
pub(super) fn grey(levels: &Image) -> Side {
    let levels = levels.map(|rgb| Vec3::splat(rgb.x));
    let bytes: Vec<u8> = levels.pixels().iter().map(|rgb| rgb.x as u8).collect();
    let values = opaque(&levels, 255.0);
    png(
        &levels,
        ColorType::Grayscale,
        BitDepth::Eight,
        &bytes,
        values,
    )
}

/// Levels as 8-bit RGBA, with an alpha by number of pixel.
pub(super) fn rgba(levels: &Image, alpha: impl Fn(usize) -> u8) -> Side {
    let mut values = opaque(levels, 255.0);
    for (index, rgba) in values.iter_mut().enumerate() {
        rgba[3] = f32::from(alpha(index));
    }
    let samples = values.iter().flatten();
    let bytes: Vec<u8> = samples.map(|&level| level as u8).collect();
    png(levels, ColorType::Rgba, BitDepth::Eight, &bytes, values)
}

/// The red levels, halved to fit, as a palette of greys.
pub(super) fn palette(levels: &Image) -> Side {
    let levels = levels.map(|rgb| Vec3::splat((rgb.x / 2.0).floor() * 2.0));
    let indices: Vec<u8> = levels.pixels().iter().map(|p| (p.x / 2.0) as u8).collect();
    let colours: Vec<u8> = (0..=127_u8).flat_map(|index| [2 * index; 3]).collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, levels.width(), levels.height());
    encoder.set_color(ColorType::Indexed);
    encoder.set_palette(colours);
    let mut writer = encoder.write_header().expect("the header is written");
    let written = writer.write_image_data(&indices);
    written.and_then(|()| writer.finish()).expect("a PNG file");
    let values = opaque(&levels, 255.0);
    side(&levels, "png", bytes, values)
}

/// Linear values as float RGB.
pub(super) fn exr(image: &Image) -> Side {
    let size = (image.width() as usize, image.height() as usize);
    let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
        let pixel = image.pixels()[at.1 * size.0 + at.0];
        (pixel.x, pixel.y, pixel.z)
    });
    let mut bytes = Cursor::new(Vec::new());
    exr::image::Image::from_channels(size, channels)
        .write()
        .to_buffered(&mut bytes)
        .expect("an EXR file");
    side(image, "exr", bytes.into_inner(), opaque(image, 1.0))
}

/// Bytes under a name that promises a PNG.
pub(super) fn no_image(bytes: Vec<u8>) -> Side {
    Side {
        bytes,
        extension: "png",
        size: [0, 0],
        values: Vec::new(),
    }
}

fn png(
    image: &Image,
    color: ColorType,
    depth: BitDepth,
    samples: &[u8],
    values: Vec<[f32; 4]>,
) -> Side {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, image.width(), image.height());
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("the header is written");
    let written = writer.write_image_data(samples);
    written.and_then(|()| writer.finish()).expect("a PNG file");
    side(image, "png", bytes, values)
}

fn side(image: &Image, extension: &'static str, bytes: Vec<u8>, values: Vec<[f32; 4]>) -> Side {
    Side {
        bytes,
        extension,
        size: [image.width(), image.height()],
        values,
    }
}

fn opaque(image: &Image, alpha: f32) -> Vec<[f32; 4]> {
    let pixels = image.pixels().iter();
    pixels.map(|p| [p.x, p.y, p.z, alpha]).collect()
}
