//! What each light does at the pixels' centres, and where one answer a pixel is
//! not enough.

use rayon::prelude::*;

use super::raster::{CenterBuffer, Fragment};
use super::shade::View;
use crate::scene::PlacedLight;
use crate::surface::SurfacePoint;
use crate::surface::direct::{Found, LightPoints};

/// Seed of the points of lights, seen from pixels' centres.
const LIGHT_SEED: u32 = 0x9e11;
/// Pixels that one task takes.
const PIXELS_PER_TASK: usize = 512;

/// What one light does at a pixel's centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// Faces away, or nothing is there.
    Away,
    Lit,
    Shadowed,
    /// Partly hidden: in the penumbra of a light that is no point.
    Partly,
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

/// The point of the surface that a fragment shows, with normals on the viewer's
/// side: of the shading normal, so that a light on its other side gives nothing.
pub(super) fn seen_point(view: &View, fragment: &Fragment) -> Option<SurfacePoint> {
    // Behind the mesh in the list come the rectangles of lights, and NONE.
    if fragment.triangle as usize >= view.surface.mesh.triangles.len() {
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
    let shadows = view.shadows();
    let reach = |(pixel, point): (usize, &Option<SurfacePoint>)| {
        let Some(point) = point else {
            return Reach::Away;
        };
        let to_light = LightPoints::of(LIGHT_SEED, pixel as u32, 0, view.light_samples);
        let mut found = Found::default();
        shadows.find(light, point, to_light, &mut found);
        match (found.is_lit, found.is_shadowed) {
            (false, false) => Reach::Away,
            (true, false) => Reach::Lit,
            (false, true) => Reach::Shadowed,
            (true, true) => Reach::Partly,
        }
    };
    points
        .par_iter()
        .with_min_len(PIXELS_PER_TASK)
        .enumerate()
        .map(reach)
        .collect()
}

/// The pixels where a light takes shadow rays at every sample: it is lit or
/// shadowed otherwise than one of its eight neighbours, lies in a penumbra, or an
/// edge of the light itself runs between them.
pub(super) fn mixed(
    view: &View,
    light: &PlacedLight,
    points: &SeenPoints,
    reach: &[Reach],
) -> Vec<bool> {
    let (width, height) = (view.camera.width as usize, view.camera.height as usize);
    let shadow_edge = |pixel: usize| {
        let differs: fn(&Reach) -> bool = match reach[pixel] {
            Reach::Away => return false,
            Reach::Partly => return true,
            Reach::Lit => |other| matches!(other, Reach::Shadowed | Reach::Partly),
            Reach::Shadowed => |other| matches!(other, Reach::Lit | Reach::Partly),
        };
        neighbourhood(pixel, width, height).any(|row| reach[row].iter().any(differs))
    };
    let own_edge = |pixel: usize| {
        let crosses = |other: &Option<SurfacePoint>| match (&points[pixel], other) {
            (Some(p), Some(q)) => light.edge_between(p.position, q.position),
            _ => false,
        };
        light.has_edges()
            && neighbourhood(pixel, width, height).any(|row| points[row].iter().any(crosses))
    };
    (0..width * height)
        .into_par_iter()
        .with_min_len(PIXELS_PER_TASK)
        .map(|pixel| shadow_edge(pixel) || own_edge(pixel))
        .collect()
}

/// The pixels of the 3 x 3 block around a pixel, row by row.
fn neighbourhood(
    pixel: usize,
    width: usize,
    height: usize,
) -> impl Iterator<Item = std::ops::Range<usize>> {
    let (x, y) = (pixel % width, pixel / width);
    let (first, end) = (x.saturating_sub(1), (x + 2).min(width));
    (y.saturating_sub(1)..(y + 2).min(height))
        .map(move |row| row * width + first..row * width + end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_has_a_block_of_four_and_the_middle_of_nine() {
        let rows = |pixel| neighbourhood(pixel, 4, 3).collect::<Vec<_>>();
        assert_eq!(rows(0), [0..2, 4..6]);
        assert_eq!(rows(5), [0..3, 4..7, 8..11]);
        assert_eq!(rows(11), [6..8, 10..12]);
        assert_eq!(
            neighbourhood(0, 1, 1).map(|row| row.len()).sum::<usize>(),
            1
        );
    }
}
