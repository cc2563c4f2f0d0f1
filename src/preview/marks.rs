//! Marks of the lights over the picture: where they are, how they are drawn and
//! which one a pointer means.

use glam::{DVec2, DVec3};

use super::document::{EditedLight, position};
use super::shapes::Pen;
use super::view::{Eye, View};
use crate::frame::EncodedImage;
use crate::maths::functions::tan;
use crate::maths::order::Order;
use crate::output::{Line, with_lines};
use crate::scene::{Area, Camera, Directional, Environment, LightKind, Spot};

/// A pointer so near to a mark means it, widths of a cell.
const NEAR_CELLS: f64 = 2.0;
/// A pointer so near to the outline of a rectangle means it, widths of a cell.
const NEAR_OUTLINE_CELLS: f64 = 0.75;
/// Length of a cone over the extent.
const CONE: f64 = 0.2;
/// Length of an arrow of parallel light, share of half the picture's height.
const ARROW: f64 = 0.6;
/// Marks of skies stand in the corner, so many cells apart.
const COMPASS_CELLS: DVec2 = DVec2::new(4.0, 2.0);
/// Colours of a mark, of the selected one and of a light that is not shown: such
/// as walls seldom have, since in a picture of cells a line has no room for black
/// beside it.
const PLAIN: [u8; 3] = [0, 160, 255];
const SELECTED: [u8; 3] = [255, 40, 220];
const DARK: [u8; 3] = [120, 120, 130];
/// Width of lines, widths of a cell; at least a pixel.
const LINE_CELLS: f64 = 0.25;

/// The mark of a light.
#[derive(Debug, Clone)]
pub(crate) struct Mark {
    /// Where it is taken hold of, pixels.
    pub(crate) px: DVec2,
    /// Whether that is where the light is, and not the border it lies beyond.
    pub(crate) is_in_place: bool,
    /// Its lines, in the colour of a light that is not selected.
    lines: Vec<Line>,
    /// Which of these lines can be taken hold of too.
    outline: Option<usize>,
}

/// The marks of all lights, in their order.
pub(crate) fn marks(lights: &[EditedLight], camera: &Camera, view: &View) -> Vec<Mark> {
    let any_soloed = lights.iter().any(|it| it.is_soloed && !it.is_muted);
    let mut skies = 0;
    let mark = |edited: &EditedLight| {
        let is_shown = !edited.is_muted && (edited.is_soloed || !any_soloed);
        let colour = if is_shown { PLAIN } else { DARK };
        let width = (view.cell_px().x * LINE_CELLS).at_least(1.0);
        let pen = Pen::new(view, camera, colour, width);
        if matches!(edited.light.kind, LightKind::Environment(_)) {
            skies += 1;
        }
        mark_of(&edited.light.kind, pen, camera, view, skies)
    };
    lights.iter().map(mark).collect()
}

/// The light that a place of the picture means: the nearest mark within about two
/// cells. Of marks in one place, the one behind the selected one, so that all can
/// be reached by clicking again.
pub(crate) fn nearest(
    marks: &[Mark],
    view: &View,
    px: DVec2,
    selected: Option<usize>,
) -> Option<usize> {
    let order = |index: usize| match selected {
        Some(selected) => (index + marks.len() - selected - 1) % marks.len(),
        None => index,
    };
    let distance = |mark: &Mark| {
        let own = view.cells_between(mark.px, px);
        let outline = mark.outline.map(|index| &mark.lines[index].points);
        let beside = outline
            .is_some_and(|points| distance_to_outline(points, view, px) <= NEAR_OUTLINE_CELLS);
        if beside { own.at_most(NEAR_CELLS) } else { own }
    };
    let near = marks
        .iter()
        .enumerate()
        .map(|(index, mark)| (distance(mark), index));
    let mut near: Vec<(f64, usize)> = near.filter(|(cells, _)| *cells <= NEAR_CELLS).collect();
    // Half cells count as one place.
    near.sort_by_key(|&(cells, index)| ((cells * 2.0) as u32, order(index)));
    near.first().map(|&(_, index)| index)
}

fn distance_to_outline(points: &[[f32; 2]], view: &View, px: DVec2) -> f64 {
    let point = |index: usize| {
        let [x, y] = points[index % points.len()];
        DVec2::new(f64::from(x), f64::from(y))
    };
    (0..points.len()).fold(f64::INFINITY, |least, index| {
        let (a, b) = (point(index), point(index + 1));
        let along = (b - a).length_squared().at_least(1e-12);
        let share = ((px - a).dot(b - a) / along).clamp(0.0, 1.0);
        least.at_most(view.cells_between(a + (b - a) * share, px))
    })
}

/// The picture with marks over it, the selected one last and highlighted.
pub(crate) fn with_marks(
    picture: &EncodedImage,
    marks: &[Mark],
    selected: Option<usize>,
) -> EncodedImage {
    let plain = marks
        .iter()
        .enumerate()
        .filter(|(index, _)| Some(*index) != selected);
    let mut lines: Vec<Line> = plain.flat_map(|(_, mark)| mark.lines.clone()).collect();
    if let Some(mark) = selected.and_then(|index| marks.get(index)) {
        lines.extend(mark.lines.iter().cloned().map(|line| Line {
            colour: SELECTED,
            ..line
        }));
    }
    with_lines(picture, &lines)
}

/// Where the arrow of parallel light begins: it ends at the camera's target and is
/// as long as can be seen.
pub(crate) fn arrow_start(light: &Directional, camera: &Camera) -> DVec3 {
    camera.target - light.direction.as_dvec3() * arrow_length(camera)
}

/// Length of the arrow of parallel light, scene units.
pub(crate) fn arrow_length(camera: &Camera) -> f64 {
    let half_height = tan(camera.vfov_deg * (std::f64::consts::PI / 360.0)).at_most(1.0);
    (camera.target - camera.position).length() * half_height * ARROW
}

fn mark_of(kind: &LightKind, mut pen: Pen, camera: &Camera, view: &View, sky: u32) -> Mark {
    let cell = view.cell_px();
    let place = match kind {
        LightKind::Directional(light) => Some(arrow_start(light, camera)),
        kind => position(kind),
    };
    let Some(place) = place else {
        let corner = DVec2::new(f64::from(view.size_px[0]), 0.0);
        let offset = COMPASS_CELLS * DVec2::new(f64::from(sky) - 0.25, 0.75);
        let px = (corner + offset * DVec2::new(-1.0, 1.0) * cell).max(cell * 0.5);
        if let LightKind::Environment(light) = kind {
            compass(&mut pen, px, light, &view.eye(camera), cell);
        }
        return Mark {
            px,
            is_in_place: true,
            lines: pen.into_lines(),
            outline: None,
        };
    };
    let (px, is_in_place) = view.eye(camera).within_border(place, cell);
    if is_in_place {
        pen.ring(px, ring_radius(cell));
    } else {
        pen.diamond(px, ring_radius(cell));
    }
    let mut outline = None;
    match kind {
        LightKind::Point(_) if is_in_place => pen.cross(px, ring_radius(cell) * 2.0),
        LightKind::Spot(light) => cone(&mut pen, light, view.extent),
        LightKind::Directional(_) => pen.arrow(place, camera.target),
        LightKind::Area(light) => outline = rectangle(&mut pen, light),
        _ => {}
    }
    Mark {
        px,
        is_in_place,
        lines: pen.into_lines(),
        outline,
    }
}

fn ring_radius(cell: DVec2) -> f64 {
    cell.x.at_most(cell.y) * 0.75
}

/// Axis, rim and four sides of the cone.
fn cone(pen: &mut Pen, light: &Spot, extent: f64) {
    let axis = light.direction.as_dvec3();
    let length = extent * CONE;
    let half_angle = f64::from(light.cutoff_deg) * (std::f64::consts::PI / 180.0);
    let (sine, cosine) = (
        crate::maths::functions::sin(half_angle),
        crate::maths::functions::cos(half_angle),
    );
    let side = axis.any_orthonormal_vector();
    let other = axis.cross(side);
    let middle = light.position + axis * (length * cosine);
    let rim = pen.circle(middle, [side, other], length * sine);
    for quarter in 0..4 {
        pen.line(light.position, rim[quarter * rim.len() / 4]);
    }
    pen.line(light.position, light.position + axis * length);
}

/// Outline and normal; which line is the outline, if all of it is before the eye.
fn rectangle(pen: &mut Pen, light: &Area) -> Option<usize> {
    let (u, v) = (light.edge_u, light.edge_v);
    let corners = [
        light.corner,
        light.corner + u,
        light.corner + u + v,
        light.corner + v,
    ];
    let outline = pen.outline(&corners);
    let middle = light.corner + (u + v) * 0.5;
    let normal = u
        .normalize_or_zero()
        .cross(v.normalize_or_zero())
        .normalize_or_zero();
    let length = 0.5 * u.length().at_most(v.length());
    pen.arrow(middle, middle + normal * length);
    outline
}

/// A ring whose needle points where the middle of the map's first column is, with
/// the view's direction upward.
fn compass(pen: &mut Pen, px: DVec2, light: &Environment, eye: &Eye, cell: DVec2) {
    let angle = f64::from(light.rotation_deg) * (std::f64::consts::PI / 180.0);
    let (sine, cosine) = (
        crate::maths::functions::sin(angle),
        crate::maths::functions::cos(angle),
    );
    // The direction of u = 0, -Z, turned as the sky is.
    let north = DVec3::new(-sine, 0.0, -cosine);
    let level = |v: DVec3| DVec3::new(v.x, 0.0, v.z).normalize_or_zero();
    let ahead = level(if eye.forward.y.abs() < 0.99 {
        eye.forward
    } else {
        -eye.down
    });
    let needle = DVec2::new(north.dot(level(eye.right)), -north.dot(ahead));
    let radius = ring_radius(cell) * 2.0;
    pen.ring(px, radius);
    pen.line_px(px - needle * (0.5 * radius), px + needle * (1.5 * radius));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(px: [f64; 2]) -> Mark {
        Mark {
            px: px.into(),
            is_in_place: true,
            lines: Vec::new(),
            outline: None,
        }
    }

    #[test]
    fn the_nearest_mark_within_two_cells_is_meant() {
        let (view, _) = super::super::view::sample_view();
        let marks = [mark([10.0, 10.0]), mark([14.0, 10.0]), mark([14.0, 10.2])];
        let meant = |px: [f64; 2], selected| nearest(&marks, &view, px.into(), selected);
        assert_eq!(meant([11.0, 10.0], None), Some(0));
        assert_eq!(meant([10.0, 12.5], None), None);
        assert_eq!(meant([14.0, 10.0], None), Some(1));
        // Clicks again and again reach all that lie in one place.
        assert_eq!(meant([14.0, 10.0], Some(1)), Some(2));
        assert_eq!(meant([14.0, 10.0], Some(2)), Some(1));
        assert_eq!(nearest(&[], &view, DVec2::ZERO, None), None);
    }

    #[test]
    fn the_outline_of_a_rectangle_can_be_taken_hold_of() {
        let (view, camera) = super::super::view::sample_view();
        let kind = LightKind::Area(Area {
            corner: DVec3::new(-0.8, 0.5, 0.0),
            edge_u: DVec3::X * 1.6,
            edge_v: DVec3::Y * 1.0,
            radiance: glam::Vec3::ONE,
        });
        let light = crate::scene::Light {
            name: "panel".to_owned(),
            kind,
        };
        let marks = marks(&[EditedLight::new(light)], &camera, &view);
        let corner = view.eye(&camera).project(DVec3::new(-0.8, 0.75, 0.0)).px;
        assert_eq!(nearest(&marks, &view, corner, None), Some(0));
        assert_eq!(nearest(&marks, &view, corner + DVec2::X * 3.0, None), None);
    }
}
