//! What each light does at the pixels' centres, and where one answer a pixel is
//! not enough.

use glam::Vec3;
use rayon::prelude::*;

use super::raster::{CenterBuffer, Fragment};
use super::shade::View;
use crate::scene::PlacedLight;
use crate::surface::SurfacePoint;
use crate::surface::direct::{hidden, unoccluded};

/// Pixels that one task takes.
const PIXELS_PER_TASK: usize = 512;

/// What one light does at a pixel's centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// Faces away, or nothing is there.
    Away,
    Lit,
    Shadowed,
}

/// The point that each pixel's centre shows.
pub(super) type SeenPoints = Vec<Option<SurfacePoint>>;

/// The points that the centres of all pixels show.
pub(super) fn seen_points(view: &View, centers: &CenterBuffer) -> SeenPoints {
    centers
        .fragments
        .par_iter()
        .with_min_len(PIXELS_PER_TASK)
        .map(|fragment| seen_point(view, fragment))
        .collect()
}

/// The point that a fragment shows, with normals on the viewer's side: of the
/// shading normal, so that a light on its other side gives nothing.
pub(super) fn seen_point(view: &View, fragment: &Fragment) -> Option<SurfacePoint> {
    if !fragment.is_covered() {
        return None;
    }
    let mut point = view
        .surface
        .point(fragment.triangle, fragment.barycentrics, fragment.front);
    let to_eye = view.camera.eye.as_vec3() - point.position;
    if point.normal.dot(to_eye) < 0.0 {
        point.normal = -point.normal;
    }
    Some(point)
}

/// A light's reach at every pixel's centre.
pub(super) fn trace(view: &View, light: &PlacedLight, points: &SeenPoints) -> Vec<Reach> {
    let reach = |point: &Option<SurfacePoint>| {
        let Some(point) = point else {
            return Reach::Away;
        };
        let sample = light.sample(point.position);
        if unoccluded(&sample, point) == Vec3::ZERO {
            Reach::Away
        } else if hidden(view.surface, view.level, &sample, point) {
            Reach::Shadowed
        } else {
            Reach::Lit
        }
    };
    points
        .par_iter()
        .with_min_len(PIXELS_PER_TASK)
        .map(reach)
        .collect()
}

/// The pixels where a light takes a shadow ray a sample: it is lit or shadowed
/// otherwise than one of its eight neighbours, or an edge of the light itself
/// runs between them.
pub(super) fn mixed(
    view: &View,
    light: &PlacedLight,
    points: &SeenPoints,
    reach: &[Reach],
) -> Vec<bool> {
    let (width, height) = (view.camera.width as usize, view.camera.height as usize);
    let differs = |a: usize, b: usize| {
        let shadow_edge = matches!(
            (reach[a], reach[b]),
            (Reach::Lit, Reach::Shadowed) | (Reach::Shadowed, Reach::Lit)
        );
        let own_edge = || match (&points[a], &points[b]) {
            (Some(p), Some(q)) => light.edge_between(p.position, q.position),
            _ => false,
        };
        shadow_edge || own_edge()
    };
    (0..width * height)
        .into_par_iter()
        .with_min_len(PIXELS_PER_TASK)
        .map(|pixel| neighbours(pixel, width, height).any(|other| differs(pixel, other)))
        .collect()
}

/// The up to eight neighbours of a pixel.
fn neighbours(pixel: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (pixel % width, pixel / width);
    let columns = x.saturating_sub(1)..(x + 2).min(width);
    let rows = y.saturating_sub(1)..(y + 2).min(height);
    rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
        .filter(move |&other| other != pixel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_has_three_neighbours_and_the_middle_eight() {
        assert_eq!(neighbours(0, 4, 3).collect::<Vec<_>>(), [1, 4, 5]);
        assert_eq!(
            neighbours(5, 4, 3).collect::<Vec<_>>(),
            [0, 1, 2, 4, 6, 8, 9, 10]
        );
        assert_eq!(neighbours(11, 4, 3).count(), 3);
        assert_eq!(neighbours(0, 1, 1).count(), 0);
    }
}
