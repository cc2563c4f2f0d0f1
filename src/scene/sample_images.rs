//! The smallest image files, for tests.

/// A PNG of one pixel of the sRGB colour 128, 64, 255.
pub(crate) const PNG: &[u8] =
    b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90wS\xde\0\
      \0\0\x0cIDATx\xdachp\xf8\x0f\0\x03\x03\x01\xc0\xc0z\x88H\0\0\0\0IEND\xaeB`\
      \x82";

/// A latitude-longitude map of two pixels of radiance 1, in the HDR format.
pub(crate) const HDR: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\
      \x80\x80\x80\x81\x80\x80\x80\x81";
