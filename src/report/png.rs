//! A picture as the bytes of a PNG file.

use super::ReportError;

/// The 8 bytes at the head of every PNG file, then length and name of its first
/// chunk (W3C PNG, third edition, sections 5.2 and 11.2.1).
const HEAD: [u8; 16] = *b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR";

/// The bytes of a PNG file, looked at only as far as its size: decoding is the
/// browser's work.
#[derive(Clone, PartialEq, Eq)]
pub struct PngImage {
    bytes: Vec<u8>,
    width: u32,
    height: u32,
}

impl PngImage {
    /// Takes over a PNG file.
    ///
    /// # Errors
    /// [`ReportError::NotPng`] if the bytes begin like something else.
    pub fn new(bytes: Vec<u8>) -> Result<Self, ReportError> {
        let side = |at: usize| {
            let bytes = bytes.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_be_bytes(bytes)).filter(|&side| side > 0)
        };
        match (bytes.starts_with(&HEAD), side(16), side(20)) {
            (true, Some(width), Some(height)) => Ok(Self {
                bytes,
                width,
                height,
            }),
            _ => Err(ReportError::NotPng {
                byte_count: bytes.len(),
            }),
        }
    }

    /// The file as it was given.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Width, pixels; at least 1.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height, pixels; at least 1.
    pub fn height(&self) -> u32 {
        self.height
    }
}

impl std::fmt::Debug for PngImage {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (width, height) = (self.width, self.height);
        write!(formatter, "PngImage({width} x {height})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_is_read_and_other_bytes_are_refused() {
        let mut bytes = HEAD.to_vec();
        bytes.extend([0, 0, 1, 0, 0, 0, 0, 3]);
        let image = PngImage::new(bytes.clone()).unwrap();
        assert_eq!((image.width(), image.height()), (256, 3));

        bytes.truncate(23);
        assert!(PngImage::new(bytes.clone()).is_err(), "cut off");
        bytes.extend([0]);
        assert!(PngImage::new(bytes).is_err(), "a height of 0");
        assert!(PngImage::new(b"GIF89a".to_vec()).is_err());
    }
}
