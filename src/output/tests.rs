use std::fs;

use glam::Vec3;

use super::*;
use crate::frame::{Development, flip};

/// 17 x 5 pixels with values below 0, above 1 and tiny.
fn gradient() -> Image {
    let pixels = (0..17 * 5).map(|i| Vec3::new(i as f32 * 0.03 - 0.1, 1e-9 * i as f32, 0.5));
    Image::new(17, 5, pixels.collect()).unwrap()
}

fn write_gradient(path: &Path) -> (Image, EncodedImage) {
    let linear = gradient();
    let encoded = Development::Color.develop(&linear);
    let frame = Picture {
        linear: &linear,
        encoded: &encoded,
    };
    write_picture(path, frame).unwrap();
    (linear, encoded)
}

#[test]
fn a_png_holds_the_levels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.PNG");
    let (_, encoded) = write_gradient(&path);
    let loaded = read_image(&path).unwrap();
    let levels: Vec<f32> = loaded
        .values()
        .pixels()
        .iter()
        .flat_map(|p| p.to_array())
        .collect();
    let expected: Vec<f32> = encoded.bytes().iter().copied().map(f32::from).collect();
    assert!(matches!(loaded, LoadedImage::Levels(_)));
    assert_eq!(levels, expected);
    let again = Development::Color.develop(&loaded.to_linear());
    assert_eq!(again.digest(), encoded.digest());
    // What goes into a report is the same file, and the report knows its size.
    let bytes = encode_png(&encoded).unwrap();
    assert_eq!(bytes, fs::read(&path).unwrap());
    let picture = crate::report::PngImage::new(bytes).unwrap();
    assert_eq!((picture.width(), picture.height()), (17, 5));
}

#[test]
fn an_exr_holds_the_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.exr");
    let (linear, _) = write_gradient(&path);
    let loaded = read_image(&path).unwrap();
    assert_eq!(loaded, LoadedImage::Linear(linear.clone()));
    assert_eq!(loaded.to_linear().digest(), linear.digest());
}

#[test]
fn sixteen_bit_levels_are_read_as_fractions() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep.png");
    let grey = image::ImageBuffer::from_fn(2, 1, |x, _| image::Luma([x as u16 * 257 + 100]));
    grey.save(&path).unwrap();
    let loaded = read_image(&path).unwrap();
    assert_eq!(loaded.values().pixels()[0], Vec3::splat(100.0 / 257.0));
    assert_eq!(loaded.values().pixels()[1], Vec3::splat(357.0 / 257.0));
}

#[test]
fn writing_leaves_one_file_and_replaces_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.png");
    fs::write(&path, b"old").unwrap();
    write_gradient(&path);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert!(read_image(&path).is_ok());
}

#[test]
fn an_unknown_extension_is_an_error_that_names_the_known_ones() {
    for name in ["frame.jpg", "frame", ".png"] {
        let message = check_format(Path::new(name)).unwrap_err().to_string();
        assert!(
            message.contains(".png") && message.contains(".exr"),
            "{message}"
        );
    }
    for format in &FORMATS {
        let message = OutputError::UnknownFormat("x".into()).to_string();
        assert!(message.contains(format.extension), "{message}");
    }
}

#[test]
fn missing_folders_and_broken_files_are_errors_with_the_path() {
    let folder = tempfile::tempdir().unwrap();
    let linear = gradient();
    let encoded = Development::Color.develop(&linear);
    let frame = Picture {
        linear: &linear,
        encoded: &encoded,
    };
    let missing = folder.path().join("no/frame.png");
    let error = write_picture(&missing, frame).unwrap_err();
    assert!(matches!(error, OutputError::Write { .. }), "{error}");
    assert!(matches!(
        read_image(&missing),
        Err(OutputError::Read { .. })
    ));
    for name in ["cut.png", "cut.exr"] {
        let path = folder.path().join(name);
        write_picture(&path, frame).unwrap();
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let error = read_image(&path).unwrap_err();
        assert!(matches!(error, OutputError::Decode { .. }), "{error}");
        assert!(error.to_string().contains(name), "{error}");
    }
}

fn metadata() -> PictureMetadata {
    let mut linear = Metadata::of_program();
    for name in ["a", "b", "c", "d", "e", "f", "g"] {
        linear.set_own(name, format!("value of {name}"));
    }
    let mut encoded = linear.clone();
    encoded.set_own("tone", "srgb");
    PictureMetadata { linear, encoded }
}

#[test]
fn files_keep_their_metadata_and_equal_frames_are_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let linear = gradient();
    let encoded = Development::Color.develop(&linear);
    let frame = Picture {
        linear: &linear,
        encoded: &encoded,
    };
    let metadata = metadata();
    for (extension, expected) in [("png", &metadata.encoded), ("exr", &metadata.linear)] {
        let path = folder.path().join(format!("frame.{extension}"));
        write_described(&path, frame, &metadata).unwrap();
        let bytes = fs::read(&path).unwrap();
        let loaded = read_compared(&path).unwrap();
        assert_eq!(loaded.metadata(), expected, "{extension}");
        assert_eq!(loaded.alpha(), None, "{extension}");
        write_described(&path, frame, &metadata).unwrap();
        assert_eq!(fs::read(&path).unwrap(), bytes, "{extension}");
        write_picture(&path, frame).unwrap();
        assert!(read_compared(&path).unwrap().metadata().is_empty());
    }
    let exr = read_image(&folder.path().join("frame.exr")).unwrap();
    assert_eq!(exr, LoadedImage::Linear(linear));
}

#[test]
fn chunks_of_other_programs_are_no_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.png");
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, 1, 1);
    encoder
        .add_text_chunk("Creation Time".to_owned(), "today".to_owned())
        .unwrap();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[7]).unwrap();
    writer.finish().unwrap();
    fs::write(&path, bytes).unwrap();
    let loaded = read_compared(&path).unwrap();
    assert!(loaded.metadata().is_empty());
    assert_eq!(loaded.pixels().values().pixels(), [Vec3::splat(7.0)]);
}

/// A layer of a size at a place, with channels of one value each.
fn exr_file(
    path: &Path,
    channels: &[(&str, ::exr::image::FlatSamples)],
    layer: [usize; 2],
    place: [i32; 2],
    window: [usize; 2],
) {
    use ::exr::image::{AnyChannel, AnyChannels, Image, Layer};
    use ::exr::math::Vec2;
    use ::exr::meta::attribute::IntegerBounds;
    use ::exr::meta::header::{ImageAttributes, LayerAttributes};
    use ::exr::prelude::{Encoding, WritableImage};
    let list = channels.iter().cloned();
    let list = list.map(|(name, samples)| AnyChannel::new(name, samples));
    let attributes = LayerAttributes {
        layer_position: Vec2(place[0], place[1]),
        ..LayerAttributes::default()
    };
    let size = Vec2(layer[0], layer[1]);
    let channels = AnyChannels::sort(list.collect());
    let layer = Layer::new(size, attributes, Encoding::UNCOMPRESSED, channels);
    let window = IntegerBounds::from_dimensions(Vec2(window[0], window[1]));
    Image::empty(ImageAttributes::new(window))
        .with_layer(layer)
        .write()
        .to_file(path)
        .unwrap();
}

#[test]
fn exr_files_of_half_floats_luminance_and_alpha_are_read() {
    use ::exr::image::FlatSamples;
    use ::exr::prelude::f16;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.exr");
    let half = |value: f32| FlatSamples::F16(vec![f16::from_f32(value); 4]);
    let float = |value: f32| FlatSamples::F32(vec![value; 4]);

    let rgba = [
        ("R", half(0.5)),
        ("G", half(2.0)),
        ("B", half(f32::NAN)),
        ("A", float(0.25)),
    ];
    exr_file(&path, &rgba, [2, 2], [0, 0], [2, 2]);
    let loaded = read_compared(&path).unwrap();
    assert_eq!(loaded.alpha(), Some([0.25; 4].as_slice()));
    let pixel = loaded.pixels().values().pixels()[3];
    assert_eq!((pixel.x, pixel.y, pixel.z.is_nan()), (0.5, 2.0, true));

    // Luminance alone, and a layer smaller than the window.
    exr_file(&path, &[("Y", float(0.75))], [2, 2], [1, 0], [4, 2]);
    let loaded = read_compared(&path).unwrap();
    let greys: Vec<f32> = loaded.pixels().values().pixels()[..4]
        .iter()
        .map(|p| p.x)
        .collect();
    assert_eq!(greys, [0.0, 0.75, 0.75, 0.0]);
    assert_eq!(loaded.alpha(), None);

    exr_file(&path, &[("Z", float(1.0))], [2, 2], [0, 0], [2, 2]);
    let error = read_compared(&path).unwrap_err();
    assert!(matches!(error, OutputError::Decode { .. }), "{error}");
}

#[test]
fn a_heat_map_is_the_map_over_a_legend() {
    let black = Image::filled(100, 30, Vec3::ZERO).unwrap();
    let mut lit = black.clone();
    lit.pixels_mut()[50].x = 255.0;
    let map = flip(&black, &lit, 67.0).unwrap();
    let picture = heat_map(&map);
    // Three times as large, to be at least 256 wide.
    assert_eq!(picture.width(), 300);
    assert!(picture.height() > 90);
    let scale = crate::compare::HeatScale::of(&map);
    for (x, y) in [(0, 0), (50, 0), (99, 29)] {
        let expected = scale.colour(f64::from(map.values()[y * 100 + x]));
        let place = (3 * y + 1) * 300 + 3 * x + 1;
        assert_eq!(picture.bytes()[3 * place..3 * place + 3], expected);
    }
    let legend = &picture.bytes()[3 * 300 * 90..];
    let has = |colour: [u8; 3]| legend.as_chunks::<3>().0.contains(&colour);
    assert!(has(scale.colour(0.0)) && has(scale.colour(scale.top())));
}

#[test]
fn damaged_files_are_errors_or_images_and_never_more() {
    let folder = tempfile::tempdir().unwrap();
    let linear = gradient();
    let encoded = Development::Color.develop(&linear);
    let frame = Picture {
        linear: &linear,
        encoded: &encoded,
    };
    for name in ["damaged.png", "damaged.exr"] {
        let path = folder.path().join(name);
        write_described(&path, frame, &metadata()).unwrap();
        let whole = fs::read(&path).unwrap();
        let decode = format_of(&path).unwrap().decode;
        for length in (0..whole.len() - 1).step_by(3) {
            assert!(decode(&whole[..length]).is_err(), "{name}: {length} bytes");
        }
        for place in 0..whole.len() {
            for bits in [0x01, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[place] ^= bits;
                // Some damage is to a name or a value, and leaves an image.
                let _ = decode(&damaged);
            }
        }
    }
}
