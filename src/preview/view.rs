//! Where the picture is on the screen, and how it looks into the scene: from
//! cells to pixels, from pixels to rays and back. Scene units, double precision.

use glam::{DVec2, DVec3};

use crate::maths::functions::tan;
use crate::maths::order::Order;
use crate::scene::Camera;

/// Height of a cell over its width, about, in every terminal.
pub(crate) const CELL_HEIGHT: f64 = 2.0;
/// Nearer than this share of the extent to the plane of the eye, nothing is drawn.
const NEAR: f64 = 1e-4;

/// The picture on the screen, and the scene behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    /// First cell of the picture.
    pub(crate) column: u16,
    /// First cell of the picture.
    pub(crate) row: u16,
    /// Cells of the picture.
    pub(crate) columns: u16,
    /// Cells of the picture.
    pub(crate) rows: u16,
    /// Pixels of the picture, which are square.
    pub(crate) size_px: [u32; 2],
    /// Longest side of the scene's box, scene units.
    pub(crate) extent: f64,
}

/// The camera over the pixels of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Eye {
    pub(crate) position: DVec3,
    /// Unit axes; `down` is that of the picture.
    pub(crate) forward: DVec3,
    pub(crate) right: DVec3,
    pub(crate) down: DVec3,
    /// Distance of the picture's plane, pixels.
    focus_px: f64,
    middle_px: DVec2,
    /// Least depth at which something is drawn, scene units.
    near: f64,
}

/// A point as the eye sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Projected {
    /// Pixel coordinates, row 0 on top; meaningless where `depth` is not above 0.
    pub(crate) px: DVec2,
    /// Distance along the view, scene units; below 0 behind the eye.
    pub(crate) depth: f64,
}

impl View {
    /// Pixel coordinates of the middle of a cell; the cell may lie outside.
    pub(crate) fn px_of_cell(&self, column: u16, row: u16) -> DVec2 {
        let offset = |cell: u16, first: u16| f64::from(cell) - f64::from(first) + 0.5;
        DVec2::new(offset(column, self.column), offset(row, self.row)) * self.cell_px()
    }

    /// Size of a cell in pixels of the picture.
    pub(crate) fn cell_px(&self) -> DVec2 {
        let [width, height] = self.size_px.map(f64::from);
        let [columns, rows] = [self.columns, self.rows].map(|n| f64::from(n).at_least(1.0));
        DVec2::new(width / columns, height / rows)
    }

    /// Whether a cell is one of the picture's.
    pub(crate) fn holds(&self, column: u16, row: u16) -> bool {
        let inside = |cell: u16, first: u16, count: u16| {
            cell >= first && u32::from(cell) < u32::from(first) + u32::from(count)
        };
        inside(column, self.column, self.columns) && inside(row, self.row, self.rows)
    }

    /// Distance between two places of the picture in widths of a cell.
    pub(crate) fn cells_between(&self, a: DVec2, b: DVec2) -> f64 {
        let cells = (b - a) / self.cell_px();
        DVec2::new(cells.x, cells.y * CELL_HEIGHT).length()
    }

    /// The camera over this picture.
    pub(crate) fn eye(&self, camera: &Camera) -> Eye {
        let forward = (camera.target - camera.position).normalize();
        let right = forward.cross(camera.up).normalize();
        let [width, height] = self.size_px.map(f64::from);
        let half_height = tan(camera.vfov_deg * (std::f64::consts::PI / 360.0));
        Eye {
            position: camera.position,
            forward,
            right,
            down: forward.cross(right),
            focus_px: 0.5 * height / half_height,
            middle_px: DVec2::new(width, height) * 0.5,
            near: self.extent * NEAR,
        }
    }
}

impl Eye {
    /// A point as it is seen.
    pub(crate) fn project(&self, point: DVec3) -> Projected {
        let to_point = point - self.position;
        let depth = to_point.dot(self.forward);
        let across = DVec2::new(to_point.dot(self.right), to_point.dot(self.down));
        Projected {
            px: self.middle_px + across * (self.focus_px / depth),
            depth,
        }
    }

    /// Direction through a place of the picture, one unit deep.
    pub(crate) fn ray(&self, px: DVec2) -> DVec3 {
        let across = (px - self.middle_px) / self.focus_px;
        self.forward + self.right * across.x + self.down * across.y
    }

    /// The point that is seen at a place of the picture at a depth.
    pub(crate) fn point_at(&self, px: DVec2, depth: f64) -> DVec3 {
        self.position + self.ray(px) * depth
    }

    /// Scene units that a pixel is wide at a depth.
    pub(crate) fn pixel_at(&self, depth: f64) -> f64 {
        depth / self.focus_px
    }

    /// Whether a point is far enough before the eye to be drawn.
    pub(crate) fn is_before(&self, point: DVec3) -> bool {
        self.project(point).depth > self.near
    }

    /// The part of a line between two points that is before the eye, in pixels.
    pub(crate) fn line(&self, a: DVec3, b: DVec3) -> Option<[DVec2; 2]> {
        let depths = [a, b].map(|point| (point - self.position).dot(self.forward));
        if depths[0] <= self.near && depths[1] <= self.near {
            return None;
        }
        let cut = |from: usize, inside: DVec3, outside: DVec3| {
            let share = (depths[from] - self.near) / (depths[from] - depths[1 - from]);
            inside + (outside - inside) * share
        };
        let [a, b] = match depths.map(|depth| depth > self.near) {
            [true, false] => [a, cut(0, a, b)],
            [false, true] => [cut(1, b, a), b],
            _ => [a, b],
        };
        Some([a, b].map(|point| {
            let to_point = point - self.position;
            let across = DVec2::new(to_point.dot(self.right), to_point.dot(self.down));
            let depth = to_point.dot(self.forward).at_least(self.near);
            self.middle_px + across * (self.focus_px / depth)
        }))
    }

    /// The nearest place inside of the picture's border, `inset` pixels from it,
    /// in the direction in which a point lies; with whether that is where the
    /// point itself is seen.
    pub(crate) fn within_border(&self, point: DVec3, inset: DVec2) -> (DVec2, bool) {
        let to_point = point - self.position;
        let across = DVec2::new(to_point.dot(self.right), to_point.dot(self.down));
        let room = (self.middle_px - inset).max(DVec2::splat(0.5));
        if self.is_before(point) {
            let px = self.project(point).px - self.middle_px;
            if px.abs().cmple(room).all() {
                return (self.middle_px + px, true);
            }
        }
        // Straight behind is below: the way to turn is as far to either side.
        let across = if across.length() > 0.0 {
            across
        } else {
            DVec2::Y
        };
        let share = (room.x / across.x.abs()).at_most(room.y / across.y.abs());
        (self.middle_px + across * share, false)
    }
}

#[cfg(test)]
pub(crate) fn sample_view() -> (View, Camera) {
    let view = View {
        column: 2,
        row: 1,
        columns: 40,
        rows: 15,
        size_px: [40, 30],
        extent: 2.0,
    };
    let camera = Camera {
        position: DVec3::new(0.0, 1.0, 6.8),
        target: DVec3::new(0.0, 1.0, 0.0),
        up: DVec3::Y,
        vfov_deg: 19.5,
        size: [640, 480],
    };
    (view, camera)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_sees_as_the_renderers_camera_does() {
        use crate::scene::Placement;
        let (view, mut camera) = sample_view();
        camera.up = DVec3::new(0.3, 1.0, 0.2);
        let eye = view.eye(&camera);
        camera.size = view.size_px;
        let placement = Placement::of_bounds(DVec3::splat(-1.0), DVec3::splat(1.0));
        let placed = camera.place(&placement);
        for px in [DVec2::new(0.5, 0.5), DVec2::new(33.0, 7.25)] {
            let expected = placed.direction(px.x, px.y).as_dvec3();
            let direction = eye.ray(px).normalize();
            assert!((direction - expected).length() < 1e-6, "{px}");
        }
    }

    #[test]
    fn points_come_back_from_the_picture() {
        let (view, camera) = sample_view();
        let eye = view.eye(&camera);
        let point = DVec3::new(0.4, 1.3, -0.2);
        let seen = eye.project(point);
        assert!((eye.point_at(seen.px, seen.depth) - point).length() < 1e-12);
        assert_eq!(view.px_of_cell(2, 1), DVec2::new(0.5, 1.0));
        assert!(view.holds(41, 15) && !view.holds(42, 15) && !view.holds(1, 1));
    }

    #[test]
    fn lines_and_marks_behind_the_eye_are_cut() {
        let (view, camera) = sample_view();
        let eye = view.eye(&camera);
        let (before, behind) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.5, 1.0, 20.0));
        let [a, b] = eye.line(before, behind).unwrap();
        assert_eq!(a, eye.project(before).px);
        assert!(b.x > 40.0 && b.y == 15.0, "{b}");
        assert_eq!(eye.line(behind, behind), None);
        let (px, is_seen) = eye.within_border(behind, DVec2::new(1.0, 2.0));
        assert_eq!((px, is_seen), (DVec2::new(39.0, 15.0), false));
        let straight_behind = DVec3::new(0.0, 1.0, 20.0);
        let (px, _) = eye.within_border(straight_behind, DVec2::new(1.0, 2.0));
        assert_eq!(px, DVec2::new(20.0, 28.0));
    }
}
