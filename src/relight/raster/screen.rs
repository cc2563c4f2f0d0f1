//! Corners in homogeneous screen coordinates.

use glam::Vec3;
use rayon::prelude::*;

use super::NEAR;
use crate::scene::PlacedCamera;

/// A sample may not come nearer to a corner than this, pixels; see
/// [`Screen::project`]. Large enough that the signs of all edge functions about
/// the corner are certain (their errors are near 1e-11 pixels), and so small
/// that nothing is visible.
const CORNER_CLEARANCE: f64 = 4e-6;

/// All sample positions (pixel centres and the 16 of a pixel) are multiples of
/// a 32nd of a pixel.
const SAMPLE_GRID: f64 = 32.0;

/// A point in homogeneous pixel coordinates about the middle of the picture:
/// (x/w, y/w) is its distance from there in pixels, right and down, and w its
/// depth along the view axis in placed units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) w: f64,
}

impl Corner {
    /// An order of corners by value, so that two corners at one place count
    /// as one whatever their indices are.
    pub(super) fn is_before(&self, other: &Self) -> bool {
        if self.x != other.x {
            return self.x < other.x;
        }
        if self.y != other.y {
            return self.y < other.y;
        }
        self.w < other.w
    }

    /// Cross product, as a linear function of the screen.
    pub(super) fn cross(&self, other: &Self) -> Linear {
        Linear {
            a: self.y * other.w - self.w * other.y,
            b: self.w * other.x - self.x * other.w,
            c: self.x * other.y - self.y * other.x,
        }
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            w: self.w - other.w,
        }
    }

    /// The point where the way to `other` crosses the near plane.
    pub(super) fn at_near_plane(&self, other: &Self) -> Self {
        let t = (NEAR - self.w) / (other.w - self.w);
        Self {
            x: self.x + t * (other.x - self.x),
            y: self.y + t * (other.y - self.y),
            w: NEAR,
        }
    }
}

/// A function `a x + b y + c` of the centred pixel coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Linear {
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) c: f64,
}

impl Linear {
    /// The value at (x, y). Every loop of the rasterizer evaluates exactly
    /// this expression, so that all of them agree on every bit.
    #[inline(always)]
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        self.a * x + (self.b * y + self.c)
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            a: self.a * factor,
            b: self.b * factor,
            c: self.c * factor,
        }
    }
}

/// The map from placed points to the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screen {
    camera: PlacedCamera,
    /// Row vectors that turn a point relative to the eye into x and y.
    x_axis: glam::DVec3,
    y_axis: glam::DVec3,
    /// Centred coordinates of the picture's upper left corner, negated.
    pub(super) half_width: f64,
    pub(super) half_height: f64,
}

impl Screen {
    pub(super) fn new(camera: &PlacedCamera) -> Self {
        Self {
            camera: *camera,
            x_axis: camera.right / camera.right.length_squared(),
            y_axis: camera.down / camera.down.length_squared(),
            half_width: 0.5 * f64::from(camera.width),
            half_height: 0.5 * f64::from(camera.height),
        }
    }

    /// Depths on one smooth surface differ from its planes by at most this
    /// share: two pixel footprints, i.e. twice what a pixel measures at unit
    /// depth. The floor is for lenses so long that a pixel is narrower than
    /// the rounding of a depth.
    pub(super) fn depth_tolerance(&self) -> f64 {
        const FOOTPRINTS: f64 = 2.0;
        const ROUNDING: f64 = 1e-6;
        FOOTPRINTS * self.camera.right.length() + ROUNDING
    }

    /// All positions.
    pub(super) fn project_all(&self, positions: &[Vec3]) -> Vec<Corner> {
        positions
            .par_iter()
            .with_min_len(1024)
            .map(|&position| self.project(position))
            .collect()
    }

    /// A position on the screen.
    ///
    /// Where a corner falls on a possible sample position, it is moved off it:
    /// there all edges about the corner pass through the sample, rounding
    /// alone would decide each of their signs, and a closed fan of triangles
    /// could be missed by the sample altogether. Equal positions move equally,
    /// so no gap opens.
    pub(super) fn project(&self, position: Vec3) -> Corner {
        let from_eye = position.as_dvec3() - self.camera.eye;
        let mut corner = Corner {
            x: from_eye.dot(self.x_axis),
            y: from_eye.dot(self.y_axis),
            w: from_eye.dot(self.camera.forward),
        };
        if corner.w > NEAR {
            // Half the width and height lie on the grid too.
            let (x, y) = (corner.x / corner.w, corner.y / corner.w);
            if is_on_sample_grid(x) && is_on_sample_grid(y) {
                corner.x += CORNER_CLEARANCE * corner.w;
                corner.y += 0.5 * CORNER_CLEARANCE * corner.w;
            }
        }
        corner
    }
}

fn is_on_sample_grid(x: f64) -> bool {
    let scaled = x * SAMPLE_GRID;
    (scaled - scaled.round()).abs() < 0.25 * CORNER_CLEARANCE * SAMPLE_GRID
}
