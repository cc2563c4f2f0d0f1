//! Lines between points of a plane: where they cross and pass by each other's
//! ends.

use glam::{DVec2, DVec3};

/// Indices of two points.
pub(super) type Line = [usize; 2];

/// Where lines cross, farther than `snap` from the ends of both.
pub(super) fn crossings(points: &[DVec2], lines: &[Line], snap: f64) -> Vec<DVec2> {
    let mut found = Vec::new();
    for (i, &first) in lines.iter().enumerate() {
        for &second in &lines[i + 1..] {
            let [p, q] = first.map(|end| points[end]);
            let [r, s] = second.map(|end| points[end]);
            if are_apart([p, q], [r, s]) {
                continue;
            }
            let (along, across) = (q - p, s - r);
            let turn = along.perp_dot(across);
            if turn == 0.0 {
                continue;
            }
            let t = (r - p).perp_dot(across) / turn;
            let u = (r - p).perp_dot(along) / turn;
            let is_inner =
                |share: f64, length: f64| share * length > snap && (1.0 - share) * length > snap;
            if is_inner(t, along.length()) && is_inner(u, across.length()) {
                found.push(p + along * t);
            }
        }
    }
    found
}

/// Whether the boxes of two lines have nothing in common.
fn are_apart([p, q]: [DVec2; 2], [r, s]: [DVec2; 2]) -> bool {
    let apart = |axis: usize| {
        let below = |a: f64, b: f64, c: f64, d: f64| a < c && a < d && b < c && b < d;
        below(p[axis], q[axis], r[axis], s[axis]) || below(r[axis], s[axis], p[axis], q[axis])
    };
    apart(0) || apart(1)
}

/// The lines, cut at all points that they pass within `snap`; each once.
pub(super) fn split_at(points: &[DVec2], lines: &[Line], snap: f64) -> Vec<Line> {
    let mut pieces: Vec<Line> = Vec::new();
    for &[from, to] in lines {
        let (start, along) = (points[from], points[to] - points[from]);
        let length = along.length();
        let place = |point: DVec2| {
            let share = along.dot(point - start) / (length * length);
            let off = along.perp_dot(point - start).abs() / length;
            let is_inner = share * length > 0.0 && (1.0 - share) * length > 0.0;
            (is_inner && off <= snap).then_some(share)
        };
        let mut passed: Vec<(f64, usize)> = (0..points.len())
            .filter(|node| *node != from && *node != to)
            .filter_map(|node| place(points[node]).map(|share| (share, node)))
            .collect();
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let inner = passed.into_iter().map(|(_, node)| node);
        let stops: Vec<usize> = [from].into_iter().chain(inner).chain([to]).collect();
        pieces.extend(stops.windows(2).map(|ends| [ends[0], ends[1]]));
    }
    let mut once: Vec<(Line, usize)> = pieces
        .into_iter()
        .enumerate()
        .map(|(rank, [a, b])| ([a.min(b), a.max(b)], rank))
        .collect();
    once.sort_unstable();
    once.dedup_by_key(|&mut (line, _)| line);
    once.into_iter().map(|(line, _)| line).collect()
}

/// Distance of a point from a segment.
pub(super) fn distance_to([from, to]: [DVec3; 2], point: DVec3) -> f64 {
    let along = to - from;
    let squared = along.length_squared();
    let share = if squared > 0.0 {
        (along.dot(point - from) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    point.distance(from + along * share)
}
