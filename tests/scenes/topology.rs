//! What must hold for a body: checks that name the first fault they find.

use std::collections::BTreeMap;

use glam::DVec3;

use super::body::Body;

/// How far off a line a point may lie and still count as on it, metres: the
/// files are rounded to 1e-5.
const ON_LINE: f64 = 1e-5;
/// Least cosine between a given normal and the triangles beside it. Tight
/// folds of the statues turn by about 80 degrees within one triangle.
const LEAST_NORMAL_COSINE: f64 = 0.1;

/// Every directed edge occurs once.
pub(crate) fn check_manifold(body: &Body) -> Result<(), String> {
    match directed_edges(body)
        .into_iter()
        .find(|&(_, count)| count > 1)
    {
        Some((edge, count)) => Err(format!("edge {edge:?} occurs {count} times")),
        None => Ok(()),
    }
}

/// Every directed edge has its opposite.
pub(crate) fn check_watertight(body: &Body) -> Result<(), String> {
    let edges = directed_edges(body);
    match edges.keys().find(|&&[a, b]| !edges.contains_key(&[b, a])) {
        Some(edge) => Err(format!("edge {edge:?} is open")),
        None => Ok(()),
    }
}

/// The enclosed volume has this sign: positive where fronts face outward.
pub(crate) fn check_volume_sign(body: &Body, sign: f64) -> Result<(), String> {
    let volume: f64 = body
        .triangles()
        .map(|triangle| body.positions[triangle[0]].dot(body.doubled_area(triangle)) / 6.0)
        .sum();
    if volume * sign > 0.0 {
        return Ok(());
    }
    Err(format!("volume {volume} has the wrong sign"))
}

/// Every triangle's front is seen from the point.
pub(crate) fn check_faces_towards(body: &Body, seen_from: DVec3) -> Result<(), String> {
    let away = body.triangles().find(|&triangle| {
        let to_point = seen_from - body.positions[triangle[0]];
        body.doubled_area(triangle).dot(to_point) <= 0.0
    });
    match away {
        Some(triangle) => Err(format!("triangle {triangle:?} faces away")),
        None => Ok(()),
    }
}

/// Every triangle has at least this area.
pub(crate) fn check_areas(body: &Body, least: f64) -> Result<(), String> {
    for triangle in body.triangles() {
        let area = 0.5 * body.doubled_area(triangle).length();
        if area < least {
            return Err(format!("triangle {triangle:?} has the area {area:e}"));
        }
    }
    Ok(())
}

/// No two positions are equal, and every one is used.
pub(crate) fn check_distinct_positions(body: &Body) -> Result<(), String> {
    let mut used = vec![false; body.positions.len()];
    body.triangles()
        .flatten()
        .for_each(|corner| used[corner] = true);
    if let Some(corner) = used.iter().position(|&used| !used) {
        return Err(format!("position {corner} belongs to no face"));
    }
    let mut seen = BTreeMap::new();
    for (index, position) in body.positions.iter().enumerate() {
        let bits = position.to_array().map(f64::to_bits);
        if let Some(other) = seen.insert(bits, index) {
            return Err(format!("positions {other} and {index} are equal"));
        }
    }
    Ok(())
}

/// No position lies inside an edge of a face.
pub(crate) fn check_no_t_junctions(body: &Body) -> Result<(), String> {
    for [a, b] in directed_edges(body).into_keys() {
        let (start, end) = (body.positions[a], body.positions[b]);
        let inside = |&point: &DVec3| lies_inside(point, start, end);
        if let Some(corner) = body.positions.iter().position(inside) {
            return Err(format!("position {corner} lies inside edge {:?}", [a, b]));
        }
    }
    Ok(())
}

/// Given normals are on the front side of their triangles.
pub(crate) fn check_normals(body: &Body) -> Result<(), String> {
    let Some(normals) = &body.normals else {
        return Ok(());
    };
    for triangle in body.triangles() {
        let flat = body.doubled_area(triangle).normalize();
        for corner in triangle {
            let cosine = normals[corner].dot(flat);
            if cosine < LEAST_NORMAL_COSINE {
                return Err(format!("normal {corner} is off by the cosine {cosine}"));
            }
        }
    }
    Ok(())
}

/// Area of the surface, square metres.
pub(crate) fn area(body: &Body) -> f64 {
    body.triangles()
        .map(|triangle| 0.5 * body.doubled_area(triangle).length())
        .sum()
}

fn directed_edges(body: &Body) -> BTreeMap<[usize; 2], u32> {
    let mut edges = BTreeMap::new();
    for face in &body.faces {
        let corners = &face.corners;
        for (k, &corner) in corners.iter().enumerate() {
            let next = corners[(k + 1) % corners.len()];
            *edges.entry([corner, next]).or_insert(0) += 1;
        }
    }
    edges
}

/// Whether a point lies on the line between two others, apart from its ends.
fn lies_inside(point: DVec3, start: DVec3, end: DVec3) -> bool {
    let line = end - start;
    let along = (point - start).dot(line) / line.length();
    let nearest = start + line.normalize() * along;
    along > ON_LINE && along < line.length() - ON_LINE && point.distance(nearest) < ON_LINE
}
