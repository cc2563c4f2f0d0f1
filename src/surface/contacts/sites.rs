//! Ends of contacts, moved a little so that no two are too close to each other,
//! to an edge or to a corner, and so that triangles that share an edge agree on
//! the points on it.

use std::collections::HashMap;

use glam::{DVec3, IVec3, Vec3};

use super::find::{Contact, Large};
use super::{COPLANAR_COSINE, Tolerances};
use crate::maths::order::Order;
use crate::surface::forest::Forest;

/// Bits of the positions of an edge's ends, ascending.
pub(super) type EdgeKey = [[u32; 3]; 2];

/// Where a point of a triangle is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    Corner(usize),
    /// On the edge that starts at a corner, at a share of the way from the end
    /// that comes first in its [`EdgeKey`].
    Edge(usize, f32),
    Inside,
}

/// An end of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Site {
    /// Placed units.
    pub(super) position: Vec3,
    pub(super) place: Place,
}

/// The point of an edge nearest to another point.
struct Along {
    /// The edge's first corner.
    edge: usize,
    /// Share of the way in the direction of the edge's key.
    share: f64,
    /// How far the other point is, placed units.
    off: f64,
    /// Of the edge, placed units.
    length: f64,
}

/// A contact between sites.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    /// Index in the list of large triangles.
    pub(super) target: u32,
    pub(super) ends: [Site; 2],
}

/// The ends of an edge in the order of its key, and the key.
pub(super) fn directed(a: Vec3, b: Vec3) -> ([Vec3; 2], EdgeKey) {
    // Adding zero turns -0 into +0, as welding does.
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let (of_a, of_b) = (bits(a), bits(b));
    if of_a <= of_b {
        ([a, b], [of_a, of_b])
    } else {
        ([b, a], [of_b, of_a])
    }
}

/// The point at a share of the way between two others.
pub(super) fn between([from, to]: [Vec3; 2], share: f32) -> Vec3 {
    let (from, to) = (from.as_dvec3(), to.as_dvec3());
    (from + (to - from) * f64::from(share)).as_vec3()
}

impl Large {
    pub(super) fn placed_corners(&self) -> [Vec3; 3] {
        self.corners.map(|corner| corner.as_vec3())
    }

    pub(super) fn edge(&self, first: usize) -> ([Vec3; 2], EdgeKey) {
        let corners = self.placed_corners();
        directed(corners[first], corners[(first + 1) % 3])
    }

    /// The site of a point of the triangle or just outside. What is outside comes
    /// to the nearest edge, however far: beyond an acute corner it may be.
    fn site(&self, point: DVec3, snap: f64) -> Site {
        let corners = self.placed_corners();
        let at_corner = |k: usize| Site {
            position: corners[k],
            place: Place::Corner(k),
        };
        let is_at = |k: &usize| self.corners[*k].distance(point) <= snap;
        if let Some(k) = (0..3).find(is_at) {
            return at_corner(k);
        }
        let [first, second, third] = [0, 1, 2].map(|k| self.along_edge(k, point));
        let nearer = |best: Along, other: Along| if other.off < best.off { other } else { best };
        let nearest = nearer(nearer(first, second), third);
        if nearest.off > snap && !self.is_outside(point) {
            return Site {
                position: point.as_vec3(),
                place: Place::Inside,
            };
        }
        let (share, length) = (nearest.share, nearest.length);
        if share * length <= snap || (1.0 - share) * length <= snap {
            let ([from, _], _) = self.edge(nearest.edge);
            let is_forwards = corners[nearest.edge] == from;
            let is_first = (share < 0.5) == is_forwards;
            return at_corner((nearest.edge + usize::from(!is_first)) % 3);
        }
        Site {
            // Known when the triangles on the edge have agreed on it.
            position: Vec3::NAN,
            place: Place::Edge(nearest.edge, share as f32),
        }
    }

    fn along_edge(&self, edge: usize, point: DVec3) -> Along {
        let ([from, to], _) = self.edge(edge);
        let (from, along) = (from.as_dvec3(), (to - from).as_dvec3());
        let share = (along.dot(point - from) / along.length_squared()).clamp(0.0, 1.0);
        Along {
            edge,
            share,
            off: point.distance(from + along * share),
            length: along.length(),
        }
    }

    fn is_outside(&self, point: DVec3) -> bool {
        (0..3).any(|k| {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            self.normal.cross(b - a).dot(point - a) < 0.0
        })
    }
}

impl Segment {
    /// The edge of the triangle that the segment lies on, by its first corner.
    pub(super) fn edge(&self) -> Option<usize> {
        let is_on = |site: &Site, k: usize| match site.place {
            Place::Corner(corner) => corner == k || corner == (k + 1) % 3,
            Place::Edge(edge, _) => edge == k,
            Place::Inside => false,
        };
        (0..3).find(|&k| self.ends.iter().all(|site| is_on(site, k)))
    }
}

/// The contacts as segments between sites, without those that separate nothing:
/// those on creases and borders, and small groups.
pub(super) fn segments(
    large: &[Large],
    contacts: &[Contact],
    tolerances: &Tolerances,
) -> Vec<Segment> {
    let segment = |contact: &Contact| Segment {
        target: contact.target,
        ends: contact
            .ends
            .map(|end| large[contact.target as usize].site(end, tolerances.snap)),
    };
    let mut segments: Vec<Segment> = contacts.iter().map(segment).collect();
    agree_on_edges(large, &mut segments, tolerances.snap);
    for of_target in segments.chunk_by_mut(|a, b| a.target == b.target) {
        merge_inside(of_target, tolerances.snap);
    }
    segments.retain(|segment| segment.ends[0].position != segment.ends[1].position);
    let smooth = SmoothEdges::of(large);
    segments.retain(|segment| {
        let edge = segment.edge();
        edge.is_none_or(|k| smooth.contains(&large[segment.target as usize].edge(k).1))
    });
    drop_small_groups(&mut segments, tolerances.smallest_group);
    segments
}

/// Sites on one edge that are close to each other become one, whatever triangle
/// they were found in.
fn agree_on_edges(large: &[Large], segments: &mut [Segment], snap: f64) {
    let mut shares: Vec<(EdgeKey, f32)> = Vec::new();
    for segment in segments.iter() {
        for site in &segment.ends {
            if let Place::Edge(k, share) = site.place {
                shares.push((large[segment.target as usize].edge(k).1, share));
            }
        }
    }
    shares.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    shares.dedup();
    let mut kept: Vec<(EdgeKey, f32)> = Vec::new();
    for &(key, share) in &shares {
        let [from, to] = key.map(|bits| Vec3::from_array(bits.map(f32::from_bits)).as_dvec3());
        let is_close = |&(other, first): &(EdgeKey, f32)| {
            other == key && f64::from(share - first) * from.distance(to) <= 2.0 * snap
        };
        if !kept.last().is_some_and(is_close) {
            kept.push((key, share));
        }
    }
    for segment in segments {
        let triangle = &large[segment.target as usize];
        for site in &mut segment.ends {
            if let Place::Edge(k, share) = site.place {
                let (ends, key) = triangle.edge(k);
                let after = kept.partition_point(|&(other, first)| {
                    other < key || (other == key && first <= share)
                });
                let agreed = kept[after - 1].1;
                site.place = Place::Edge(k, agreed);
                site.position = between(ends, agreed);
            }
        }
    }
}

/// Sites inside one triangle that are close to each other become one: the first.
fn merge_inside(segments: &mut [Segment], snap: f64) {
    let mut kept = Kept::of_snap(snap);
    for site in segments.iter_mut().flat_map(|segment| &mut segment.ends) {
        if site.place == Place::Inside {
            site.position = kept.first_close(site.position);
        }
    }
}

/// Positions by cells of space.
struct Kept {
    snap: f64,
    positions: Vec<Vec3>,
    /// Those of a cell, ascending.
    in_cell: HashMap<IVec3, Vec<usize>>,
}

impl Kept {
    fn of_snap(snap: f64) -> Self {
        Self {
            snap,
            positions: Vec::new(),
            in_cell: HashMap::new(),
        }
    }

    /// Cells twice as wide as what is close, so that rounding hides no neighbour.
    fn cell(&self, position: Vec3) -> IVec3 {
        (position.as_dvec3() / (2.0 * self.snap)).floor().as_ivec3()
    }

    /// The first position that this one is close to: itself if there is none.
    fn first_close(&mut self, position: Vec3) -> Vec3 {
        let cell = self.cell(position);
        let step = |k: i32| IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        let beside = (0..27).map(|k| cell.wrapping_add(step(k)));
        let near = beside.filter_map(|cell| self.in_cell.get(&cell)).flatten();
        let is_close = |&&k: &&usize| f64::from(self.positions[k].distance(position)) <= self.snap;
        if let Some(&first) = near.filter(is_close).min() {
            return self.positions[first];
        }
        let in_cell = self.in_cell.entry(cell).or_default();
        in_cell.push(self.positions.len());
        self.positions.push(position);
        position
    }
}

/// Edges between two nearly coplanar large triangles.
struct SmoothEdges(Vec<EdgeKey>);

impl SmoothEdges {
    fn of(large: &[Large]) -> Self {
        let mut sides: Vec<(EdgeKey, u32)> = (0..large.len())
            .flat_map(|t| (0..3).map(move |k| (large[t].edge(k).1, t as u32)))
            .collect();
        sides.sort_unstable();
        let is_smooth = |sides: &&[(EdgeKey, u32)]| match sides {
            [a, b] => {
                let [a, b] = [a.1, b.1].map(|t| large[t as usize].normal);
                a.dot(b) > COPLANAR_COSINE
            }
            _ => false,
        };
        let runs = sides.chunk_by(|a, b| a.0 == b.0);
        Self(runs.filter(is_smooth).map(|sides| sides[0].0).collect())
    }

    fn contains(&self, key: &EdgeKey) -> bool {
        self.0.binary_search(key).is_ok()
    }
}

/// Drops segments that hang together in less than a length: legs of a table.
fn drop_small_groups(segments: &mut Vec<Segment>, smallest: f64) {
    let mut index_of = HashMap::new();
    let mut positions = Vec::new();
    let mut id = |position: Vec3| {
        let next = positions.len() as u32;
        let bits = position.to_array().map(f32::to_bits);
        let id = *index_of.entry(bits).or_insert(next);
        if id == next {
            positions.push(position);
        }
        id
    };
    let ends: Vec<[u32; 2]> = segments
        .iter()
        .map(|segment| segment.ends.map(|site| id(site.position)))
        .collect();
    let mut forest = Forest::new(positions.len());
    for &[a, b] in &ends {
        forest.join(a, b);
    }
    let mut boxes: Vec<[Vec3; 2]> = positions.iter().map(|&p| [p, p]).collect();
    for (id, &position) in positions.iter().enumerate() {
        let [lower, upper] = &mut boxes[forest.root(id as u32) as usize];
        for axis in 0..3 {
            lower[axis] = lower[axis].at_most(position[axis]);
            upper[axis] = upper[axis].at_least(position[axis]);
        }
    }
    let mut of_segment = ends.iter();
    segments.retain(|_| {
        let ends = of_segment.next().expect("there are ends for each segment");
        let [lower, upper] = boxes[forest.root(ends[0]) as usize];
        f64::from(lower.distance(upper)) >= smallest
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::uniform;

    #[test]
    fn sites_merge_into_the_first_that_is_close() {
        let snap = 0.02;
        let end = |k: u32| Site {
            // Some lie exactly on the borders of cells.
            position: [0, 1, 2]
                .map(|axis| match axis {
                    2 => (uniform(3, k, axis) * 8.0).floor() * 0.04,
                    _ => uniform(3, k, axis) - 0.5,
                })
                .into(),
            place: match k % 7 {
                0 => Place::Corner(0),
                _ => Place::Inside,
            },
        };
        let mut segments: Vec<Segment> = (0..2_000)
            .map(|k| Segment {
                target: 0,
                ends: [end(2 * k), end(2 * k + 1)],
            })
            .collect();
        let mut kept: Vec<Vec3> = Vec::new();
        let mut expected = segments.clone();
        for site in expected.iter_mut().flat_map(|segment| &mut segment.ends) {
            let is_close = |other: &&Vec3| f64::from(other.distance(site.position)) <= snap;
            match kept.iter().find(is_close) {
                _ if site.place != Place::Inside => {}
                Some(&other) => site.position = other,
                None => kept.push(site.position),
            }
        }
        assert!(kept.len() > 1_000 && kept.len() < 3_000, "{}", kept.len());
        merge_inside(&mut segments, snap);
        let ends = |of: &[Segment]| of.iter().flat_map(|it| it.ends).collect::<Vec<_>>();
        assert!(ends(&segments) == ends(&expected));
    }
}
