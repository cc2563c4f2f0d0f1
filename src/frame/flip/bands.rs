//! The error map, in bands of rows: each band converts the rows that its
//! filters reach and keeps nothing else, so memory does not grow with the image
//! and bands run in parallel. A pixel's error is the same in any band.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::colour::opponent_from_rgb;
use super::errors::{ErrorScale, Perceived};
use super::exposures::tone_mapped;
use super::filters::{Filter, Filters, Separable};
use crate::frame::Image;
use crate::frame::tone::decode_levels_of;
use crate::maths::order::Order;

/// Rows of a band. Its filters reach 10 rows farther on both sides at the usual
/// size of pixels: fewer rows convert more pixels twice, more leave threads idle
/// on small images.
const BAND_ROWS: usize = 32;

/// How pixels are shown.
#[derive(Debug, Clone, Copy)]
pub(super) enum Display {
    /// They are sRGB levels 0 to 255.
    Levels,
    /// They are radiance: multiplied by the gain, through the tone curve.
    Exposed { gain: f64 },
}

/// Largest error of every pixel over the displays, row by row. The images have
/// one size.
pub(super) fn error_map(
    reference: &Image,
    candidate: &Image,
    filters: &Filters,
    displays: &[Display],
) -> Vec<f32> {
    let width = reference.width() as usize;
    let mut errors = vec![0.0; reference.pixels().len()];
    let scale = ErrorScale::new();
    let bands = errors.par_chunks_mut(BAND_ROWS * width).enumerate();
    bands.for_each(|(index, errors)| {
        let first = index * BAND_ROWS;
        let band = Band {
            images: [reference, candidate],
            rows: first..first + errors.len() / width,
            radius: filters.radius(),
        };
        if band.is_equal() {
            return;
        }
        for &display in displays {
            band.add_errors(filters, scale, display, errors);
        }
        band.mark_undefined(errors);
    });
    errors
}

/// Some rows of the two images.
struct Band<'a> {
    images: [&'a Image; 2],
    rows: Range<usize>,
    /// How far the filters reach, pixels.
    radius: usize,
}

impl Band<'_> {
    fn width(&self) -> usize {
        self.images[0].width() as usize
    }

    /// The rows and all that their filters reach.
    fn reached_rows(&self) -> Range<usize> {
        let last = self.images[0].height() as usize;
        self.rows.start.saturating_sub(self.radius)..(self.rows.end + self.radius).min(last)
    }

    /// Whether the images are finite and equal wherever the filters reach: then
    /// both are filtered to the same, and the errors are exactly 0.
    fn is_equal(&self) -> bool {
        let rows = self.reached_rows();
        let pixels = rows.start * self.width()..rows.end * self.width();
        let [reference, candidate] = self.images.map(|image| &image.pixels()[pixels.clone()]);
        let mut pairs = reference.iter().zip(candidate);
        pairs.all(|(a, b)| a == b && a.is_finite())
    }

    /// Raises `errors` to those that this display shows.
    fn add_errors(
        &self,
        filters: &Filters,
        scale: ErrorScale,
        display: Display,
        errors: &mut [f32],
    ) {
        let width = self.width();
        let planes = self
            .images
            .map(|image| Planes::new(image, self.reached_rows(), display));
        let mut rows = [PerceivedRow::new(width), PerceivedRow::new(width)];
        for (y, errors) in self.rows.clone().zip(errors.chunks_exact_mut(width)) {
            for (row, planes) in rows.iter_mut().zip(&planes) {
                row.fill(filters, planes, y);
            }
            for (x, error) in errors.iter_mut().enumerate() {
                let found = scale.error(rows[0].pixel(x), rows[1].pixel(x)) as f32;
                *error = error.at_least(found);
            }
        }
    }

    /// Gives the error 1 to pixels whose filters reach a value that is not finite.
    fn mark_undefined(&self, errors: &mut [f32]) {
        let width = self.width();
        for y in self.reached_rows() {
            for x in 0..width {
                let index = y * width + x;
                if self
                    .images
                    .iter()
                    .all(|image| image.pixels()[index].is_finite())
                {
                    continue;
                }
                let columns = x.saturating_sub(self.radius)..(x + self.radius + 1).min(width);
                let rows = y.saturating_sub(self.radius).max(self.rows.start)
                    ..(y + self.radius + 1).min(self.rows.end);
                for row in rows {
                    let start = (row - self.rows.start) * width;
                    errors[start + columns.start..start + columns.end].fill(1.0);
                }
            }
        }
    }
}

/// Opponent colours of some rows, a plane a channel.
struct Planes {
    width: usize,
    rows: Range<usize>,
    channels: [Vec<f64>; 3],
}

impl Planes {
    fn new(image: &Image, rows: Range<usize>, display: Display) -> Self {
        let width = image.width() as usize;
        let pixels = &image.pixels()[rows.start * width..rows.end * width];
        let mut channels = [(); 3].map(|()| Vec::with_capacity(pixels.len()));
        for &pixel in pixels {
            // What is not finite is marked later, and must not spread as NaN.
            let rgb = if !pixel.is_finite() {
                DVec3::ZERO
            } else {
                match display {
                    Display::Levels => decode_levels_of(pixel).as_dvec3(),
                    Display::Exposed { gain } => tone_mapped(pixel, gain),
                }
            };
            let opponent = opponent_from_rgb(rgb.clamp(DVec3::ZERO, DVec3::ONE));
            for (channel, value) in channels.iter_mut().zip(opponent.to_array()) {
                channel.push(value);
            }
        }
        Self {
            width,
            rows,
            channels,
        }
    }

    /// Row `y` of a channel; beyond the image, its nearest row.
    fn row(&self, channel: usize, y: isize) -> &[f64] {
        let (first, last) = (self.rows.start as isize, self.rows.end as isize - 1);
        let start = (y.clamp(first, last) - first) as usize * self.width;
        &self.channels[channel][start..start + self.width]
    }
}

/// One row of one image after all filters.
struct PerceivedRow {
    opponent: [Vec<f64>; 3],
    edges: [Vec<f64>; 2],
    points: [Vec<f64>; 2],
    /// A row filtered along y, with its ends repeated to both sides.
    padded: Vec<f64>,
}

impl PerceivedRow {
    fn new(width: usize) -> Self {
        let row = || vec![0.0; width];
        Self {
            opponent: [row(), row(), row()],
            edges: [row(), row()],
            points: [row(), row()],
            padded: Vec::new(),
        }
    }

    fn fill(&mut self, filters: &Filters, planes: &Planes, y: usize) {
        for (channel, out) in self.opponent.iter_mut().enumerate() {
            let filter = &filters.sensitivity[channel];
            filter_row(filter, planes, channel, y, &mut self.padded, out);
        }
        for (filter, out) in filters.edges.iter().zip(&mut self.edges) {
            filter_row(filter, planes, 0, y, &mut self.padded, out);
        }
        for (filter, out) in filters.points.iter().zip(&mut self.points) {
            filter_row(filter, planes, 0, y, &mut self.padded, out);
        }
    }

    fn pixel(&self, x: usize) -> Perceived {
        let strength =
            |[across, down]: &[Vec<f64>; 2]| (across[x] * across[x] + down[x] * down[x]).sqrt();
        let [luminance, red_green, blue_yellow] = &self.opponent;
        Perceived {
            opponent: DVec3::new(luminance[x], red_green[x], blue_yellow[x]),
            edge: strength(&self.edges),
            point: strength(&self.points),
        }
    }
}

/// Row `y` of a channel, filtered.
fn filter_row(
    filter: &Filter,
    planes: &Planes,
    channel: usize,
    y: usize,
    padded: &mut Vec<f64>,
    out: &mut [f64],
) {
    out.fill(0.0);
    for part in &filter.parts {
        filter_down(part, planes, channel, y, padded);
        for (offset, &weight) in part.across.iter().enumerate() {
            add_scaled(out, weight, &padded[offset..]);
        }
    }
}

/// Fills `padded` with row `y` filtered along y, its ends repeated as often as
/// the filter along x reaches.
fn filter_down(part: &Separable, planes: &Planes, channel: usize, y: usize, padded: &mut Vec<f64>) {
    let (margin, reach) = (part.across.len() / 2, part.down.len() / 2);
    padded.clear();
    padded.resize(planes.width + 2 * margin, 0.0);
    let row = &mut padded[margin..margin + planes.width];
    for (offset, &weight) in part.down.iter().enumerate() {
        let source = y as isize + offset as isize - reach as isize;
        add_scaled(row, weight, planes.row(channel, source));
    }
    let (first, last) = (row[0], row[planes.width - 1]);
    padded[..margin].fill(first);
    padded[margin + planes.width..].fill(last);
}

/// Adds `weight` times as many of `values` as `sums` has.
fn add_scaled(sums: &mut [f64], weight: f64, values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}
