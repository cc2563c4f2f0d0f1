use std::path::Path;

use image::codecs::hdr::HdrEncoder;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb, Rgba};

use super::*;

/// Width and height of the samples.
const SIZE: [u32; 2] = [13, 7];

fn level(x: u32, y: u32, channel: u32) -> u8 {
    (x * 19 + y * 31 + channel * 67) as u8
}

fn color_sample() -> DynamicImage {
    let pixel = |x, y| Rgb([level(x, y, 0), level(x, y, 1), level(x, y, 2)]);
    DynamicImage::ImageRgb8(ImageBuffer::from_fn(SIZE[0], SIZE[1], pixel))
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn radiance_sample() -> Vec<Rgb<f32>> {
    let value = |i: u32| Rgb([0.25 * i as f32, 1.5, 0.03 * i as f32]);
    (0..SIZE[0] * SIZE[1]).map(value).collect()
}

fn float_image() -> DynamicImage {
    let values = radiance_sample().iter().flat_map(|p| p.0).collect();
    DynamicImage::ImageRgb32F(ImageBuffer::from_raw(SIZE[0], SIZE[1], values).unwrap())
}

fn hdr_sample() -> Vec<u8> {
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&radiance_sample(), SIZE[0] as usize, SIZE[1] as usize)
        .unwrap();
    bytes
}

/// A grey baseline JPEG of 16 x 8 pixels, two blocks: one of level 228 (a
/// constant coefficient of 100 above the middle), one of 128.
fn jpeg_sample() -> Vec<u8> {
    let mut bytes = vec![0xff, 0xd8];
    // Quantisation by 1.
    bytes.extend([0xff, 0xdb, 0, 67, 0]);
    bytes.extend([1; 64]);
    // 8 bits, 8 rows, 16 columns, one component.
    bytes.extend([0xff, 0xc0, 0, 11, 8, 0, 8, 0, 16, 1, 1, 0x11, 0]);
    // Codes of two bits for the constant: category 0 (00) and 10 (01); for the
    // rest, one of a bit: end of block (0).
    let table = |class: u8, counts: [u8; 2], symbols: &[u8]| {
        let length = 19 + symbols.len() as u8;
        let mut segment = vec![0xff, 0xc4, 0, length, class];
        segment.extend(counts);
        segment.extend([0; 14]);
        segment.extend(symbols);
        segment
    };
    bytes.extend(table(0x00, [0, 2], &[0, 10]));
    bytes.extend(table(0x10, [1, 0], &[0]));
    bytes.extend([0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0]);
    // 01 + 1100100000 (800) + 0, then 01 + 0011011111 (-800) + 0, ones to fill.
    bytes.extend([0b0111_0010, 0b0000_0010, 0b0110_1111, 0b1011_1111]);
    bytes.extend([0xff, 0xd9]);
    bytes
}

fn levels_of(bytes: &[u8], name: &str) -> Vec<[u8; 3]> {
    let file = decode(bytes, Path::new(name)).unwrap();
    match file.pixels {
        Pixels::Levels(levels) => levels,
        Pixels::Linear(_) => panic!("{name} has 8 bits"),
    }
}

fn linear_of(bytes: &[u8], name: &str) -> Vec<Vec3> {
    decode(bytes, Path::new(name)).unwrap().pixels.into_linear()
}

fn refusal(bytes: &[u8], name: &str) -> String {
    decode(bytes, Path::new(name)).unwrap_err().to_string()
}

#[test]
fn lossless_formats_keep_every_level() {
    let wanted: Vec<[u8; 3]> = color_sample().into_rgb8().pixels().map(|p| p.0).collect();
    for (format, name) in [
        (ImageFormat::Png, "a.png"),
        (ImageFormat::Bmp, "a.bmp"),
        (ImageFormat::Tga, "a.TGA"),
        (ImageFormat::Png, "a.unknown"),
    ] {
        assert_eq!(levels_of(&encoded(&color_sample(), format), name), wanted);
    }
}

#[test]
fn alpha_is_ignored_and_grey_is_three_equal_channels() {
    let clear = ImageBuffer::from_fn(2, 1, |x, _| Rgba([9, 8, 7, x as u8]));
    let bytes = encoded(&DynamicImage::ImageRgba8(clear), ImageFormat::Png);
    assert_eq!(levels_of(&bytes, "a.png"), [[9, 8, 7]; 2]);
    let grey = ImageBuffer::from_fn(2, 1, |x, _| Luma([50 + x as u8]));
    let bytes = encoded(&DynamicImage::ImageLuma8(grey), ImageFormat::Png);
    assert_eq!(levels_of(&bytes, "a.png"), [[50; 3], [51; 3]]);
}

#[test]
fn sixteen_bits_follow_the_same_curve() {
    let grey = ImageBuffer::from_fn(256, 1, |x, _| Luma([x as u16 * 257]));
    let bytes = encoded(&DynamicImage::ImageLuma16(grey), ImageFormat::Png);
    let wanted: Vec<Vec3> = LINEAR_FROM_LEVEL.iter().map(|&x| Vec3::splat(x)).collect();
    assert_eq!(linear_of(&bytes, "a.png"), wanted);
    assert_eq!([wanted[0].x, wanted[255].x], [0.0, 1.0]);
}

#[test]
fn float_formats_are_linear() {
    let exr = encoded(&float_image(), ImageFormat::OpenExr);
    let wanted: Vec<Vec3> = radiance_sample().iter().map(|p| Vec3::from(p.0)).collect();
    assert_eq!(linear_of(&exr, "a.exr"), wanted);
    // Radiance's mantissas have 8 bits and are cut off, relative to the largest
    // of the three channels.
    const HDR_STEP: f32 = 1.0 / 128.0;
    for (got, wanted) in linear_of(&hdr_sample(), "a.hdr").iter().zip(&wanted) {
        assert!((*got - *wanted).abs().max_element() <= HDR_STEP * wanted.max_element());
    }
}

#[test]
fn undefined_radiance_becomes_defined() {
    let values = vec![f32::NAN, -1.0, f32::INFINITY, f32::NEG_INFINITY, 1e38, 2.0];
    let image = ImageBuffer::from_raw(2, 1, values).unwrap();
    let bytes = encoded(&DynamicImage::ImageRgb32F(image), ImageFormat::OpenExr);
    let wanted = [
        Vec3::new(0.0, 0.0, MAX_RADIANCE),
        Vec3::new(0.0, MAX_RADIANCE, 2.0),
    ];
    assert_eq!(linear_of(&bytes, "a.exr"), wanted);
}

#[test]
fn jpeg_blocks_have_their_levels() {
    let levels = levels_of(&jpeg_sample(), "a.jpeg");
    assert_eq!(levels.len(), 128);
    for (i, got) in levels.iter().enumerate() {
        assert_eq!(*got, [if i % 16 < 8 { 228 } else { 128 }; 3], "{i}");
    }
}

#[test]
fn stray_bytes_between_the_segments_of_a_jpeg_are_skipped() {
    let mut bytes = jpeg_sample();
    // Behind the table of quantisation, before the frame.
    let at = 2 + 69;
    assert_eq!(bytes[at..at + 2], [0xff, 0xc0]);
    bytes.splice(at..at, [0, 0, 0]);
    assert_eq!(
        levels_of(&bytes, "a.jpg"),
        levels_of(&jpeg_sample(), "a.jpg")
    );
}

#[test]
fn an_exr_of_luminance_is_grey() {
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, SmallVec, WritableImage};
    let channel = AnyChannel::new("Y", FlatSamples::F32(vec![0.5, 2.0, -1.0]));
    let channels = AnyChannels::sort(SmallVec::from_vec(vec![channel]));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((3, 1), channels)
        .write()
        .to_buffered(&mut bytes)
        .unwrap();
    let wanted = [0.5, 2.0, 0.0].map(Vec3::splat);
    assert_eq!(linear_of(bytes.get_ref(), "a.exr"), wanted);
}

#[test]
fn content_that_the_name_does_not_promise_is_named() {
    let png = encoded(&color_sample(), ImageFormat::Png);
    let message = refusal(&png, "wall.jpg");
    for part in ["wall.jpg", "promises JPEG", "looks like PNG", "rename"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(refusal(b"hello", "a.png").contains("promises PNG"));
    assert!(refusal(b"hello", "a.txt").contains("no image"));
    assert!(refusal(b"", "a.png").contains("empty"));
    assert!(refusal(&png[..60], "a.png").contains("cut short"));
}

#[test]
fn sizes_beyond_the_limits_fail_before_memory_is_taken() {
    // A TGA's header alone.
    for (width, height, part) in [
        (20_000_u32, 2_u32, "16384 a side"),
        (16_384, 16_384, "134217728 in all"),
        (0, 4, "empty"),
    ] {
        let mut tga = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        tga.extend((width as u16).to_le_bytes());
        tga.extend((height as u16).to_le_bytes());
        tga.extend([24, 0]);
        let message = refusal(&tga, "big.tga");
        assert!(message.contains(part), "{message}");
    }
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n";
    assert!(decode(hdr, Path::new("a.hdr")).is_err());
}

#[test]
fn lossy_dwa_files_are_refused() {
    let mut bytes = encoded(&float_image(), ImageFormat::OpenExr);
    let mark = b"compression\0compression\0";
    let at = bytes.windows(mark.len()).position(|w| w == mark).unwrap();
    bytes[at + mark.len() + 4] = 8;
    assert!(refusal(&bytes, "a.exr").contains("ZIP"));
}

#[test]
fn broken_files_are_errors_and_never_panics() {
    let samples = [
        ("a.png", encoded(&color_sample(), ImageFormat::Png)),
        ("a.bmp", encoded(&color_sample(), ImageFormat::Bmp)),
        ("a.tga", encoded(&color_sample(), ImageFormat::Tga)),
        ("a.exr", encoded(&float_image(), ImageFormat::OpenExr)),
        ("a.hdr", hdr_sample()),
        ("a.jpg", jpeg_sample()),
    ];
    for (name, bytes) in samples {
        let path = Path::new(name);
        for length in (0..bytes.len() - 3).step_by(50) {
            let cut = decode(&bytes[..length], path);
            // A TGA is read without its footer, so only cuts of pixels fail.
            assert!(cut.is_err() || name == "a.tga", "{name} of {length}");
        }
        for bit in (0..bytes.len() * 8).step_by(3) {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let values = decode(&flipped, path).map(|file| file.pixels.into_linear());
            let defined = |v: &Vec3| v.is_finite() && v.min_element() >= 0.0;
            assert!(values.is_err() || values.unwrap().iter().all(defined));
        }
    }
}
