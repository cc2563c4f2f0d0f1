//! The linear RGB image that every stage after shading works on.

use glam::{DVec3, Vec3};

/// Linear Rec.709 RGB, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<Vec3>,
}

/// Width, height and number of pixels do not fit together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "an image of {width} x {height} pixels needs at least one pixel and exactly \
     width x height of them, but {pixel_count} were given"
)]
pub struct ImageSizeError {
    /// Width asked for, pixels.
    pub width: u32,
    /// Height asked for, pixels.
    pub height: u32,
    /// Number of pixels given.
    pub pixel_count: usize,
}

impl Image {
    /// An image of the given pixels, row by row from the top.
    ///
    /// # Errors
    /// If a side is 0 or the number of pixels is not `width * height`.
    pub fn new(width: u32, height: u32, pixels: Vec<Vec3>) -> Result<Self, ImageSizeError> {
        let wanted = u64::from(width) * u64::from(height);
        if wanted == 0 || pixels.len() as u64 != wanted {
            return Err(ImageSizeError {
                width,
                height,
                pixel_count: pixels.len(),
            });
        }
        Ok(Self {
            width,
            height,
            pixels,
        })
    }

    /// An image of one colour.
    ///
    /// # Errors
    /// If a side is 0.
    pub fn filled(width: u32, height: u32, value: Vec3) -> Result<Self, ImageSizeError> {
        let count = width as usize * height as usize;
        Self::new(width, height, vec![value; count])
    }

    /// Width, pixels; at least 1.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height, pixels; at least 1.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Vec3] {
        &self.pixels
    }

    /// All pixels for writing; the size cannot change.
    pub fn pixels_mut(&mut self) -> &mut [Vec3] {
        &mut self.pixels
    }

    /// The pixel in column `x` of row `y` (row 0 on top), if there is one.
    pub fn pixel(&self, x: u32, y: u32) -> Option<Vec3> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let index = y as usize * self.width as usize + x as usize;
        self.pixels.get(index).copied()
    }

    /// The same image with `change` applied to every pixel.
    #[must_use]
    pub fn map(&self, change: impl Fn(Vec3) -> Vec3) -> Self {
        Self {
            width: self.width,
            height: self.height,
            pixels: self.pixels.iter().map(|&pixel| change(pixel)).collect(),
        }
    }

    /// Means over squares of `block` x `block` pixels (at least 1); squares at
    /// the right and at the bottom that are cut hold the mean of what is left.
    /// Comparing block means instead of pixels takes the noise out of a
    /// path-traced reference but keeps its bias.
    #[must_use]
    pub fn block_means(&self, block: u32) -> Self {
        let block = block.max(1);
        let (across, down) = (self.width.div_ceil(block), self.height.div_ceil(block));
        let mut pixels = Vec::with_capacity(across as usize * down as usize);
        for block_y in 0..down {
            for block_x in 0..across {
                pixels.push(self.block_mean(block_x * block, block_y * block, block));
            }
        }
        Self {
            width: across,
            height: down,
            pixels,
        }
    }

    fn block_mean(&self, x0: u32, y0: u32, block: u32) -> Vec3 {
        let x1 = self.width.min(x0 + block);
        let y1 = self.height.min(y0 + block);
        let mut sum = DVec3::ZERO;
        for y in y0..y1 {
            let row = y as usize * self.width as usize;
            for pixel in &self.pixels[row + x0 as usize..row + x1 as usize] {
                sum += pixel.as_dvec3();
            }
        }
        (sum / (f64::from(x1 - x0) * f64::from(y1 - y0))).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert!(Image::new(2, 2, vec![Vec3::ONE; 4]).is_ok());
        assert!(Image::new(2, 2, vec![Vec3::ONE; 3]).is_err());
        assert!(Image::new(0, 2, vec![]).is_err());
        assert!(Image::filled(3, 0, Vec3::ONE).is_err());
    }

    #[test]
    fn block_means_of_a_ramp_are_its_values_at_block_centers() {
        let pixels = (0..20 * 9).map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 1.0));
        let image = Image::new(20, 9, pixels.collect()).unwrap();
        let means = image.block_means(8);
        assert_eq!((means.width(), means.height()), (3, 2));
        assert_eq!(means.pixel(0, 0), Some(Vec3::new(3.5, 3.5, 1.0)));
        // The last column has four pixels a row, the last row only one row.
        assert_eq!(means.pixel(2, 1), Some(Vec3::new(17.5, 8.0, 1.0)));
        assert_eq!(means.pixel(3, 0), None);
    }
}
