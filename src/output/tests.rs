use std::fs;

use glam::Vec3;

use super::*;
use crate::frame::Development;

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
