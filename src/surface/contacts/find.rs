//! Where triangles touch or cross each other.

use glam::{DVec3, Vec3};

use super::{COPLANAR_COSINE, Tolerances};
use crate::maths::order::Order;

/// A triangle of the file that tessellation cuts, in double precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Large {
    /// Which triangle of the scene it is.
    pub(super) index: u32,
    /// Placed units.
    pub(super) corners: [DVec3; 3],
    /// Unit normal.
    pub(super) normal: DVec3,
    lower: DVec3,
    upper: DVec3,
}

/// A segment in the plane of a triangle along which another one stands on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    /// Index in the list of large triangles.
    pub(super) target: u32,
    /// Placed units; in the triangle, but for the tolerance.
    pub(super) ends: [DVec3; 2],
}

impl Large {
    /// The triangle, if it has an area and an edge that tessellation cuts.
    pub(super) fn of(index: u32, corners: [Vec3; 3], tolerances: &Tolerances) -> Option<Self> {
        let corners = corners.map(|corner| corner.as_dvec3());
        let [a, b, c] = corners;
        let longest = (b - a)
            .length()
            .at_least((c - b).length())
            .at_least((a - c).length());
        let area_normal = (b - a).cross(c - a);
        // Needles have no inside to cut.
        let height = area_normal.length() / longest;
        if longest <= tolerances.max_edge || height <= 2.0 * tolerances.snap {
            return None;
        }
        let over = |f: fn(f64, f64) -> f64| {
            DVec3::new(
                f(f(a.x, b.x), c.x),
                f(f(a.y, b.y), c.y),
                f(f(a.z, b.z), c.z),
            )
        };
        Some(Self {
            index,
            corners,
            normal: area_normal.normalize(),
            lower: over(f64::at_most) - tolerances.touch,
            upper: over(f64::at_least) + tolerances.touch,
        })
    }

    fn is_near(&self, other: &Self) -> bool {
        self.lower.cmple(other.upper).all() && other.lower.cmple(self.upper).all()
    }

    /// Corners that the two have in common.
    fn shared_corners(&self, other: &Self) -> usize {
        let is_shared = |corner: &&DVec3| other.corners.contains(corner);
        self.corners.iter().filter(is_shared).count()
    }

    /// The segment that the triangle has in common with a plane through `point`,
    /// moved into the plane. Corners closer to it than `touch` lie in it.
    fn section(&self, point: DVec3, normal: DVec3, touch: f64) -> Option<[DVec3; 2]> {
        let distances = self.corners.map(|corner| {
            let distance = normal.dot(corner - point);
            if distance.abs() < touch {
                0.0
            } else {
                distance
            }
        });
        let mut ends = Vec::with_capacity(3);
        for k in 0..3 {
            let (d, e) = (distances[k], distances[(k + 1) % 3]);
            let (p, q) = (self.corners[k], self.corners[(k + 1) % 3]);
            if d == 0.0 {
                ends.push(p);
            } else if e != 0.0 && (d > 0.0) != (e > 0.0) {
                ends.push(p + (q - p) * (d / (d - e)));
            }
        }
        let in_plane = |end: DVec3| end - normal * normal.dot(end - point);
        match ends[..] {
            [p, q] => Some([in_plane(p), in_plane(q)]),
            _ => None,
        }
    }

    /// The part of a segment of the triangle's plane that is in the triangle. An
    /// end that is outside by no more than `snap` stays.
    fn clipped(&self, [mut p, mut q]: [DVec3; 2], snap: f64) -> Option<[DVec3; 2]> {
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            let inwards = self.normal.cross(b - a).normalize();
            let (d, e) = (inwards.dot(p - a), inwards.dot(q - a));
            let is_outside = (d <= 0.0 && e < -snap) || (e <= 0.0 && d < -snap);
            if is_outside {
                return None;
            }
            let crossing = p + (q - p) * (d / (d - e));
            if d < -snap {
                p = crossing;
            } else if e < -snap {
                q = crossing;
            }
        }
        ((q - p).length() > snap).then_some([p, q])
    }

    /// Where another triangle stands on this one.
    fn contact(&self, other: &Self, tolerances: &Tolerances) -> Option<[DVec3; 2]> {
        let section = other.section(self.corners[0], self.normal, tolerances.touch)?;
        self.clipped(section, tolerances.snap)
    }
}

/// All contacts between triangles that are not nearly coplanar and have no edge
/// in common, in the order of the triangles.
pub(super) fn contacts(large: &[Large], tolerances: &Tolerances) -> Vec<Contact> {
    let mut found = Vec::new();
    for_near_pairs(large, |i, j| {
        let (a, b) = (&large[i], &large[j]);
        if a.normal.dot(b.normal).abs() > COPLANAR_COSINE || a.shared_corners(b) > 1 {
            return;
        }
        for (target, cutter) in [(i, j), (j, i)] {
            if let Some(ends) = large[target].contact(&large[cutter], tolerances) {
                found.push((target as u32, cutter as u32, ends));
            }
        }
    });
    found.sort_unstable_by_key(|&(target, cutter, _)| (target, cutter));
    let contact = |(target, _, ends)| Contact { target, ends };
    found.into_iter().map(contact).collect()
}

/// Calls `take` for the pairs whose boxes meet: they are swept along the axis on
/// which they are narrowest.
fn for_near_pairs(large: &[Large], mut take: impl FnMut(usize, usize)) {
    let widths = large
        .iter()
        .fold(DVec3::ZERO, |sum, t| sum + (t.upper - t.lower));
    let narrowest = |best: usize, axis| {
        if widths[axis] < widths[best] {
            axis
        } else {
            best
        }
    };
    let axis = [1, 2].into_iter().fold(0, narrowest);
    let mut order: Vec<usize> = (0..large.len()).collect();
    order.sort_by(|&i, &j| large[i].lower[axis].total_cmp(&large[j].lower[axis]));
    for (rank, &i) in order.iter().enumerate() {
        for &j in &order[rank + 1..] {
            if large[j].lower[axis] > large[i].upper[axis] {
                break;
            }
            if large[i].is_near(&large[j]) {
                take(i.min(j), i.max(j));
            }
        }
    }
}
