//! The pixels in which one sample is not enough.
//!
//! Two tests, and a pixel is marked by either. Edges that show (borders,
//! creases, silhouettes) are walked over the screen, so that even what falls
//! between all pixel centres is found. And the fragments of neighbouring
//! centres are compared, which finds where surfaces pass through each other
//! or where one hides another part of itself.

use rayon::prelude::*;

use super::centers::CenterBuffer;
use super::screen::{Corner, Screen};
use super::triangle::Plane;
use super::{Fragment, MeshEdge, NEAR, NONE, RasterMesh, surface_of};
use crate::scene::PlacedCamera;

/// An edge touches the pixels that are this close to it, pixels; far above the
/// rounding of its ends.
const TOUCH_MARGIN: f64 = 1e-6;

/// Edges that a thread takes at a time.
const CHUNK: usize = 2048;

/// Flags, one a pixel, of the pixels in which more than one surface is seen,
/// or that may be such: `centers` is what [`super::rasterize`] returned for
/// the same camera and mesh.
pub(crate) fn edge_pixels(
    camera: &PlacedCamera,
    mesh: &RasterMesh,
    centers: &CenterBuffer,
) -> Vec<bool> {
    let view = View::new(camera, mesh, centers);
    let mut marks = view.pixels_unlike_a_neighbour();
    let walked: Vec<Vec<u32>> = mesh
        .edges
        .par_chunks(CHUNK)
        .map(|edges| {
            let mut pixels = Vec::new();
            for edge in edges.iter().filter(|edge| view.shows(edge)) {
                view.walk(edge, &mut pixels);
            }
            pixels
        })
        .collect();
    for pixel in walked.into_iter().flatten() {
        marks[pixel as usize] = true;
    }
    marks
}

/// Everything that the tests look at.
struct View<'a> {
    mesh: &'a RasterMesh<'a>,
    centers: &'a CenterBuffer,
    screen: Screen,
    corners: Vec<Corner>,
    /// One a triangle.
    planes: Vec<Option<Plane>>,
    tolerance: f64,
    width: usize,
    height: usize,
}

impl<'a> View<'a> {
    fn new(camera: &PlacedCamera, mesh: &'a RasterMesh, centers: &'a CenterBuffer) -> Self {
        let screen = Screen::new(camera);
        let corners = screen.project_all(mesh.positions);
        let plane =
            |triangle: &[u32; 3]| Plane::new(&triangle.map(|corner| corners[corner as usize]));
        let triangles = mesh.triangles.par_iter().with_min_len(CHUNK);
        let planes = triangles.map(plane).collect();
        Self {
            mesh,
            centers,
            screen,
            corners,
            planes,
            tolerance: screen.depth_tolerance(),
            width: centers.width as usize,
            height: centers.height as usize,
        }
    }

    /// Marks pixels whose centre sees another surface than one of the eight
    /// pixels about it, or a depth that does not fit that one's plane.
    fn pixels_unlike_a_neighbour(&self) -> Vec<bool> {
        let mut marks = vec![false; self.width * self.height];
        marks
            .par_chunks_mut(self.width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, mark) in row.iter_mut().enumerate() {
                    *mark = self.is_unlike_a_neighbour(x, y);
                }
            });
        marks
    }

    fn is_unlike_a_neighbour(&self, x: usize, y: usize) -> bool {
        let own = &self.centers.fragments[y * self.width + x];
        let own_surface = surface_of(own, self.mesh);
        let inverse_depth = 1.0 / f64::from(own.depth);
        let center_x = x as f64 + 0.5 - self.screen.half_width;
        let center_y = y as f64 + 0.5 - self.screen.half_height;
        let fits = |other: &Fragment| {
            surface_of(other, self.mesh) == own_surface
                && self.plane(other.triangle).is_some_and(|plane| {
                    plane.holds(center_x, center_y, inverse_depth, self.tolerance)
                })
        };
        self.neighbourhood(x, y)
            .any(|other| other.triangle != own.triangle && !fits(other))
    }

    /// The plane of a triangle, unless it is none or draws nothing.
    fn plane(&self, triangle: u32) -> Option<&Plane> {
        self.planes.get(triangle as usize)?.as_ref()
    }

    /// The fragments of the 3 x 3 pixels about (x, y) that are in the picture.
    fn neighbourhood(&self, x: usize, y: usize) -> impl Iterator<Item = &Fragment> {
        let columns = x.saturating_sub(1)..self.width.min(x + 2);
        (y.saturating_sub(1)..self.height.min(y + 2)).flat_map(move |y| {
            let row = y * self.width;
            &self.centers.fragments[row + columns.start..row + columns.end]
        })
    }

    /// Whether the edge is one from this eye: a border or crease, or between
    /// triangles of which one is turned away.
    fn shows(&self, edge: &MeshEdge) -> bool {
        let [first, second] = edge.triangles;
        edge.crease || second == NONE || self.front(first) != self.front(second)
    }

    fn front(&self, triangle: u32) -> Option<bool> {
        self.plane(triangle).map(|plane| plane.front)
    }

    /// Adds the pixels that an edge touches where it is not hidden.
    fn walk(&self, edge: &MeshEdge, pixels: &mut Vec<u32>) {
        let ends = edge.corners.map(|corner| self.corners[corner as usize]);
        let Some(segment) = self.segment(ends) else {
            return;
        };
        let (size, transposed) = if segment.is_steep() {
            ([self.height, self.width], true)
        } else {
            ([self.width, self.height], false)
        };
        let segment = segment.transposed_if(transposed);
        segment.for_squares(size, |major, minor, part| {
            let (x, y) = if transposed {
                (minor, major)
            } else {
                (major, minor)
            };
            if !self.is_hidden(x, y, &part.map(|point| point.transposed_if(transposed))) {
                pixels.push((y * self.width + x) as u32);
            }
        });
    }

    /// The part of an edge beyond the near plane and in the window.
    fn segment(&self, [a, b]: [Corner; 2]) -> Option<Segment> {
        let ends = match (a.w > NEAR, b.w > NEAR) {
            (true, true) => [a, b],
            (true, false) => [a, b.at_near_plane(&a)],
            (false, true) => [a.at_near_plane(&b), b],
            (false, false) => return None,
        };
        let point = |corner: Corner| Point {
            x: corner.x / corner.w + self.screen.half_width,
            y: corner.y / corner.w + self.screen.half_height,
            inverse_depth: 1.0 / corner.w,
        };
        Segment(ends.map(point)).clipped(self.width as f64, self.height as f64)
    }

    /// Whether a part of an edge, in or at the pixel (x, y), certainly lies
    /// behind what is seen: the centres of this pixel and of all pixels about
    /// it see nearer surfaces, whose planes pass before both ends of the part.
    /// (Depths alone would hide the far edge of a floor behind the floor.)
    fn is_hidden(&self, x: usize, y: usize, part: &[Point; 2]) -> bool {
        self.neighbourhood(x, y)
            .all(|fragment| part.iter().all(|point| self.hides(fragment, point)))
    }

    fn hides(&self, fragment: &Fragment, point: &Point) -> bool {
        let Some(plane) = self.plane(fragment.triangle) else {
            return false;
        };
        let limit = point.inverse_depth * (1.0 + self.tolerance);
        let x = point.x - self.screen.half_width;
        let y = point.y - self.screen.half_height;
        plane.inverse_depth.at(x, y) > limit && 1.0 / f64::from(fragment.depth) > limit
    }
}

/// A point of an edge, in pixels from the picture's upper left corner.
#[derive(Debug, Clone, Copy)]
struct Point {
    x: f64,
    y: f64,
    inverse_depth: f64,
}

impl Point {
    fn toward(&self, other: &Self, t: f64) -> Self {
        Self {
            x: self.x + t * (other.x - self.x),
            y: self.y + t * (other.y - self.y),
            // Straight on the screen, as 1/depth is on any plane.
            inverse_depth: self.inverse_depth + t * (other.inverse_depth - self.inverse_depth),
        }
    }

    fn transposed_if(self, transposed: bool) -> Self {
        if !transposed {
            return self;
        }
        Self {
            x: self.y,
            y: self.x,
            ..self
        }
    }
}

/// A straight line on the screen.
#[derive(Debug, Clone, Copy)]
struct Segment([Point; 2]);

impl Segment {
    fn is_steep(&self) -> bool {
        let [a, b] = &self.0;
        (b.y - a.y).abs() > (b.x - a.x).abs()
    }

    fn transposed_if(self, transposed: bool) -> Self {
        Self(self.0.map(|point| point.transposed_if(transposed)))
    }

    /// The part in the window, with a margin (Liang and Barsky, "A New Concept
    /// and Method for Line Clipping", 1984). `None` if there is none.
    fn clipped(&self, width: f64, height: f64) -> Option<Self> {
        let [a, b] = &self.0;
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let mut range = [0.0, 1.0];
        for (step, distance) in [
            (-dx, a.x + TOUCH_MARGIN),
            (dx, width + TOUCH_MARGIN - a.x),
            (-dy, a.y + TOUCH_MARGIN),
            (dy, height + TOUCH_MARGIN - a.y),
        ] {
            let t = distance / step;
            if step < 0.0 && t > range[0] {
                range[0] = t;
            } else if step > 0.0 && t < range[1] {
                range[1] = t;
            } else if step == 0.0 && distance < 0.0 {
                return None;
            }
        }
        // False, too, where an end is not finite.
        (range[0] <= range[1] && dx.is_finite() && dy.is_finite())
            .then(|| Self([a.toward(b, range[0]), a.toward(b, range[1])]))
    }

    /// Calls `visit` with every square (column, row) that a line, not steep,
    /// touches, and with the part of the line in that column.
    fn for_squares(&self, size: [usize; 2], mut visit: impl FnMut(usize, usize, [Point; 2])) {
        let [mut a, mut b] = self.0;
        if b.x < a.x {
            std::mem::swap(&mut a, &mut b);
        }
        let length = b.x - a.x;
        for column in squares(a.x, b.x, size[0]) {
            let at = |x: f64| {
                let t = if length > 0.0 {
                    (x - a.x) / length
                } else {
                    0.0
                };
                a.toward(&b, t.clamp(0.0, 1.0))
            };
            let part = if length > TOUCH_MARGIN {
                [at(column as f64), at(column as f64 + 1.0)]
            } else {
                [a, b]
            };
            let [low, high] = if part[0].y < part[1].y {
                [part[0].y, part[1].y]
            } else {
                [part[1].y, part[0].y]
            };
            for row in squares(low, high, size[1]) {
                visit(column, row, part);
            }
        }
    }
}

/// The squares of `count` that a range touches, with a margin.
fn squares(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    // Casts of negative numbers give 0.
    let first = (low - TOUCH_MARGIN).floor() as usize;
    let end = (high + TOUCH_MARGIN).floor() + 1.0;
    first..count.min(end as usize)
}
