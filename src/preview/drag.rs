//! Dragging with the mouse: from where it began to where the pointer is, so that
//! no rounding adds up on the way.

use glam::{DVec2, DVec3};

use super::camera_moves::{orbit, pan};
use super::document::{Document, position};
use super::light_edits::{place, set_direction};
use super::marks::{arrow_length, arrow_start};
use super::view::View;
use crate::maths::functions::exp2;
use crate::maths::order::Order;
use crate::scene::{Camera, LightKind};

/// An orbit across the whole width of the picture, degrees; a sky turns twice as far.
const ORBIT_DEG: f64 = 180.0;
/// A drag along the view doubles the distance so many times over the height of
/// the picture.
const DOUBLINGS: f64 = 4.0;

/// What is dragged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Dragged {
    /// A light, across the view.
    Across(usize),
    /// A light, along the view.
    Along(usize),
    Orbit,
    Pan,
}

/// A drag that has begun.
#[derive(Debug, Clone)]
pub(super) struct Drag {
    pub(super) what: Dragged,
    /// Cell of the press.
    pub(super) cell: [u16; 2],
    /// Whether the pointer has left that cell.
    pub(super) has_moved: bool,
    /// Whether what was before is kept for undo.
    pub(super) is_recorded: bool,
    /// Pixels of the press, and from the pointer to what was taken hold of.
    start_px: DVec2,
    grip: DVec2,
    /// The document at the press.
    pub(super) start: Document,
}

impl Drag {
    /// A drag of what was pressed at a cell; `grip_px` is where it is taken hold of.
    pub(super) fn new(
        what: Dragged,
        cell: [u16; 2],
        view: &View,
        grip_px: Option<DVec2>,
        start: Document,
    ) -> Self {
        let start_px = view.px_of_cell(cell[0], cell[1]);
        Self {
            what,
            cell,
            has_moved: false,
            is_recorded: false,
            start_px,
            grip: grip_px.map_or(DVec2::ZERO, |px| px - start_px),
            start,
        }
    }

    /// The document with the pointer at a place of the picture.
    pub(super) fn to(&self, px: DVec2, view: &View) -> Document {
        let mut document = self.start.clone();
        let camera = document.camera;
        let width = f64::from(view.size_px[0]).at_least(1.0);
        let by = (px - self.start_px) / width;
        match self.what {
            Dragged::Across(index) => {
                if let Some(edited) = document.lights.get_mut(index) {
                    self.across(&mut edited.light.kind, px, view, &camera);
                }
            }
            Dragged::Along(index) => {
                if let Some(edited) = document.lights.get_mut(index) {
                    self.along(&mut edited.light.kind, px, view, &camera);
                }
            }
            Dragged::Orbit => {
                let degrees = [-by.x * ORBIT_DEG, by.y * ORBIT_DEG];
                document.camera = orbit(&camera, degrees, view.extent);
            }
            Dragged::Pan => {
                let depth = (camera.target - camera.position).length();
                let units = (self.start_px - px) * view.eye(&camera).pixel_at(depth);
                document.camera = pan(&camera, units, view.extent);
            }
        }
        document
    }

    /// In the plane of the view in which the light is: it stays under the pointer.
    fn across(&self, kind: &mut LightKind, px: DVec2, view: &View, camera: &Camera) {
        let eye = view.eye(camera);
        let px_of_light = px + self.grip;
        match kind {
            LightKind::Directional(light) => {
                let start = arrow_start(light, camera);
                let is_before = (start - camera.target).dot(eye.forward) <= 0.0;
                let ray = eye.ray(px_of_light).normalize();
                let radius = arrow_length(camera);
                let offset = on_sphere(camera.position - camera.target, ray, radius, is_before);
                set_direction(kind, -offset);
            }
            LightKind::Environment(light) => {
                let turns = (px.x - self.start_px.x) / f64::from(view.size_px[0]).at_least(1.0);
                let degrees = f64::from(light.rotation_deg) - turns * 2.0 * ORBIT_DEG;
                let tenths = (degrees.rem_euclid(360.0) * 10.0).round() % 3600.0;
                light.rotation_deg = (tenths / 10.0) as f32;
            }
            local => {
                let Some(old) = position(local) else {
                    return;
                };
                // A light behind the eye comes to where the camera looks.
                let depth = if eye.is_before(old) {
                    eye.project(old).depth
                } else {
                    (camera.target - camera.position).length()
                };
                place(local, eye.point_at(px_of_light, depth), view.extent);
            }
        }
    }

    /// Along the line from the eye through the light: up is away.
    fn along(&self, kind: &mut LightKind, px: DVec2, view: &View, camera: &Camera) {
        let Some(old) = position(kind) else {
            return self.across(kind, px, view, camera);
        };
        let height = f64::from(view.size_px[1]).at_least(1.0);
        let doublings = (self.start_px.y - px.y) / height * DOUBLINGS;
        let away = camera.position + (old - camera.position) * exp2(doublings);
        place(kind, away, view.extent);
    }
}

/// Where a ray from `origin` meets a sphere about zero: at its near or far side;
/// beside the sphere, the point of its outline that is nearest to the ray.
fn on_sphere(origin: DVec3, ray: DVec3, radius: f64, near: bool) -> DVec3 {
    let middle = -origin.dot(ray);
    let closest = origin + ray * middle;
    let room = radius * radius - closest.length_squared();
    if room <= 0.0 {
        return closest;
    }
    let half = room.sqrt();
    closest + ray * if near { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_side_of_the_sphere_that_is_meant() {
        let origin = DVec3::new(0.0, 0.0, 5.0);
        let ahead = DVec3::NEG_Z;
        assert_eq!(
            on_sphere(origin, ahead, 2.0, true),
            DVec3::new(0.0, 0.0, 2.0)
        );
        assert_eq!(
            on_sphere(origin, ahead, 2.0, false),
            DVec3::new(0.0, 0.0, -2.0)
        );
        let beside = on_sphere(origin + DVec3::X * 3.0, ahead, 2.0, true);
        assert_eq!(beside, DVec3::new(3.0, 0.0, 0.0));
    }
}
