//! Short names of pictures: equal digests mean equal pixels.

use super::{EncodedImage, Image};

/// Hex digits of a digest: the first 16 bytes of the hash.
const HEX_DIGITS: usize = 32;

impl Image {
    /// Digest of the size and of the bits of every value.
    pub fn digest(&self) -> String {
        let bytes: Vec<u8> = self
            .pixels()
            .iter()
            .flat_map(|pixel| pixel.to_array())
            .flat_map(f32::to_le_bytes)
            .collect();
        digest(self.width(), self.height(), &bytes)
    }
}

impl EncodedImage {
    /// Digest of the size and of the levels.
    pub fn digest(&self) -> String {
        digest(self.width(), self.height(), self.bytes())
    }
}

fn digest(width: u32, height: u32, bytes: &[u8]) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&width.to_le_bytes());
    hasher.update(&height.to_le_bytes());
    hasher.update(bytes);
    hasher.finalize().to_hex()[..HEX_DIGITS].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_digest_sees_the_size_and_every_bit() {
        let wide = Image::filled(4, 2, Vec3::ONE).unwrap();
        let tall = Image::filled(2, 4, Vec3::ONE).unwrap();
        let mut changed = wide.clone();
        changed.pixels_mut()[7].z = 1.0 + f32::EPSILON;
        assert_eq!(wide.digest().len(), 32);
        assert_eq!(wide.digest(), wide.clone().digest());
        assert_ne!(wide.digest(), tall.digest());
        assert_ne!(wide.digest(), changed.digest());
    }
}
