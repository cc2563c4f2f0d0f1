//! Lines of marks: from the scene through the eye to pixels, cut at the plane of
//! the eye and at the picture's border.

use glam::{DVec2, DVec3};

use super::view::{Eye, View};
use crate::maths::functions::{cos, sin};
use crate::output::Line;
use crate::scene::Camera;

/// Pieces of a circle; a multiple of four.
const PIECES: usize = 24;
/// Pieces of a small ring.
const RING_PIECES: usize = 8;
/// Length and half width of an arrow's head over the arrow's length.
const HEAD: [f64; 2] = [0.15, 0.06];
/// Lines are cut so far beyond the border, pixels.
const BEYOND: f64 = 16.0;

/// Draws in one colour and width.
pub(super) struct Pen {
    eye: Eye,
    size: DVec2,
    colour: [u8; 3],
    width_px: f64,
    lines: Vec<Line>,
}

impl Pen {
    pub(super) fn new(view: &View, camera: &Camera, colour: [u8; 3], width_px: f64) -> Self {
        Self {
            eye: view.eye(camera),
            size: DVec2::from_array(view.size_px.map(f64::from)),
            colour,
            width_px,
            lines: Vec::new(),
        }
    }

    pub(super) fn into_lines(self) -> Vec<Line> {
        self.lines
    }

    /// A line in the scene.
    pub(super) fn line(&mut self, a: DVec3, b: DVec3) {
        if let Some([a, b]) = self.eye.line(a, b) {
            self.line_px(a, b);
        }
    }

    /// A line in the picture, cut at its border.
    pub(super) fn line_px(&mut self, a: DVec2, b: DVec2) {
        let low = DVec2::splat(-BEYOND);
        if let Some([a, b]) = cut(a, b, low, self.size - low) {
            self.push(&[a, b], false);
        }
    }

    /// A closed line through points of the scene; its number among the lines if it
    /// is before the eye as a whole.
    pub(super) fn outline(&mut self, points: &[DVec3]) -> Option<usize> {
        let limit = self.size * 4.0;
        let px: Vec<DVec2> = points.iter().map(|p| self.eye.project(*p).px).collect();
        let is_near = |px: &DVec2| px.cmpge(-limit).all() && px.cmple(limit * 2.0).all();
        if points.iter().all(|point| self.eye.is_before(*point)) && px.iter().all(is_near) {
            self.push(&px, true);
            return Some(self.lines.len() - 1);
        }
        for (index, point) in points.iter().enumerate() {
            self.line(*point, points[(index + 1) % points.len()]);
        }
        None
    }

    /// A circle about a point, spanned by two unit vectors; returns its points.
    pub(super) fn circle(&mut self, middle: DVec3, [u, v]: [DVec3; 2], radius: f64) -> Vec<DVec3> {
        let point = |index: usize| {
            let [x, y] = unit_circle(index, PIECES);
            middle + (u * x + v * y) * radius
        };
        let points: Vec<DVec3> = (0..PIECES).map(point).collect();
        self.outline(&points);
        points
    }

    /// A line with a head at its end.
    pub(super) fn arrow(&mut self, from: DVec3, to: DVec3) {
        self.line(from, to);
        let along = to - from;
        let aside = along.cross(self.eye.position - to).normalize_or_zero() * along.length();
        let [length, width] = HEAD;
        for side in [-width, width] {
            self.line(to, to - along * length + aside * side);
        }
    }

    /// A small ring.
    pub(super) fn ring(&mut self, middle: DVec2, radius: f64) {
        let point = |index| middle + DVec2::from_array(unit_circle(index, RING_PIECES)) * radius;
        let points: Vec<DVec2> = (0..RING_PIECES).map(point).collect();
        self.push(&points, true);
    }

    /// A small square on its tip: the light is elsewhere.
    pub(super) fn diamond(&mut self, middle: DVec2, radius: f64) {
        let corners = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y];
        self.push(&corners.map(|corner| middle + corner * radius), true);
    }

    /// Four short lines outward from a ring.
    pub(super) fn cross(&mut self, middle: DVec2, radius: f64) {
        for direction in [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y] {
            self.line_px(
                middle + direction * (0.5 * radius),
                middle + direction * radius,
            );
        }
    }

    fn push(&mut self, points: &[DVec2], is_closed: bool) {
        self.lines.push(Line {
            points: points.iter().map(|px| px.as_vec2().to_array()).collect(),
            is_closed,
            colour: self.colour,
            width_px: self.width_px as f32,
        });
    }
}

fn unit_circle(index: usize, pieces: usize) -> [f64; 2] {
    let angle = std::f64::consts::TAU * index as f64 / pieces as f64;
    [cos(angle), sin(angle)]
}

/// The part of a line inside of a box (Liang and Barsky 1984).
fn cut(a: DVec2, b: DVec2, low: DVec2, high: DVec2) -> Option<[DVec2; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let speed = b[axis] - a[axis];
        if speed == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let [mut first, mut second] = [low, high].map(|side| (side[axis] - a[axis]) / speed);
        if first > second {
            std::mem::swap(&mut first, &mut second);
        }
        if first > enter {
            enter = first;
        }
        if second < leave {
            leave = second;
        }
    }
    let at = |share: f64| a + (b - a) * share;
    (enter <= leave).then(|| [at(enter), at(leave)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_border() {
        let (low, high) = (DVec2::ZERO, DVec2::splat(10.0));
        let cut = |a: [f64; 2], b: [f64; 2]| super::cut(a.into(), b.into(), low, high);
        assert_eq!(
            cut([-5.0, 5.0], [15.0, 5.0]),
            Some([DVec2::new(0.0, 5.0), DVec2::new(10.0, 5.0)])
        );
        assert_eq!(
            cut([1.0, 1.0], [2.0, 2.0]),
            Some([DVec2::splat(1.0), DVec2::splat(2.0)])
        );
        assert_eq!(cut([-5.0, 0.0], [5.0, -20.0]), None);
        assert_eq!(cut([-1.0, 0.0], [-1.0, 9.0]), None);
    }
}
