//! The smallest image files, for tests.

/// A PNG of one pixel of the sRGB colour 128, 64, 255.
pub(crate) const PNG: &[u8] =
    b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90wS\xde\0\
      \0\0\x0cIDATx\xdachp\xf8\x0f\0\x03\x03\x01\xc0\xc0z\x88H\0\0\0\0IEND\xaeB`\
      \x82";

/// A latitude-longitude map of two pixels of radiance 1, in the HDR format.
pub(crate) const HDR: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\
      \x80\x80\x80\x81\x80\x80\x80\x81";

/// A map of radiance, grey, row 0 on top, in the HDR format: values keep eight
/// bits.
pub(crate) fn hdr([width, height]: [u32; 2], radiance: impl Fn(u32, u32) -> f32) -> Vec<u8> {
    let head = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    let mut bytes = head.into_bytes();
    for row in 0..height {
        for column in 0..width {
            bytes.extend(shared_exponent(radiance(column, row)));
        }
    }
    bytes
}

/// Three equal mantissas and the exponent of a value.
fn shared_exponent(value: f32) -> [u8; 4] {
    if value == 0.0 {
        return [0; 4];
    }
    let (mut mantissa, mut exponent) = (value, 128_u8);
    while mantissa >= 1.0 {
        (mantissa, exponent) = (mantissa * 0.5, exponent + 1);
    }
    while mantissa < 0.5 {
        (mantissa, exponent) = (mantissa * 2.0, exponent - 1);
    }
    let mantissa = (mantissa * 256.0) as u8;
    [mantissa, mantissa, mantissa, exponent]
}

/// A picture of sRGB levels, row 0 on top, as an uncompressed TGA.
pub(crate) fn tga([width, height]: [u16; 2], level: impl Fn(u16, u16) -> [u8; 3]) -> Vec<u8> {
    /// Uncompressed true colour.
    const KIND: u8 = 2;
    /// The first row is the top one.
    const FROM_TOP: u8 = 0x20;
    let mut bytes = vec![0, 0, KIND, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend([width, height].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend([24, FROM_TOP]);
    for row in 0..height {
        for column in 0..width {
            let [r, g, b] = level(column, row);
            bytes.extend([b, g, r]);
        }
    }
    bytes
}
