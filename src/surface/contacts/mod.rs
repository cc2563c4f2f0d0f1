//! The lighting mesh is cut along contacts: where a wall stands on a floor, a box
//! on a table or two bodies cross, no lighting triangle lies on both sides, and
//! the vertices on the line are different ones for each side. Otherwise the hats
//! of floor vertices below a thin wall reach into both rooms and carry the lit
//! one's light across (2.3 % of its mean), and those beside a box darken with
//! what is below it.
//!
//! Comes in: the triangles of the scene. Goes out: [`Cuts`], pieces instead of
//! some of them, for tessellation to finish. Where nothing touches, nothing
//! changes.
//!
//! Only triangles that tessellation cuts anyway take part, on both sides: a finely
//! meshed statue neither cuts the floor nor is cut. What touches in less than the
//! longest edge in all, such as the leg of a table, is left alone too: what it
//! hides is smaller than what a vertex resolves.
//!
//! | file | what it does |
//! |---|---|
//! | `find` | pairs of triangles, and the segment where one stands on the other |
//! | `sites` | ends of segments, so that triangles with a common edge agree |
//! | `lines` | segments of one plane among each other |
//! | `cut` | the pieces of one triangle, by constrained Delaunay triangulation |

mod cut;
mod find;
mod lines;
mod sites;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};

use glam::Vec3;
use rayon::prelude::*;

use cut::{Cut, Job, cut};
use find::Large;
use sites::{EdgeKey, Place, Segment, directed};

use super::tessellate::PieceCorner;

/// Triangles whose normals are closer than this (10 degrees) do not cut each
/// other: they continue, cover or lie on one another.
const COPLANAR_COSINE: f64 = 0.985;
/// Corners this close to a plane touch it, share of the longest edge left whole:
/// a box 1 mm above the floor of a room of 5 m stands on it.
const TOUCH: f64 = 0.01;
/// Points of contacts closer than this are one, share of the longest edge left
/// whole. Pieces are not thinner, so their normals are good to 1e-3 in single
/// precision; the contact is off by no more than this.
const SNAP: f64 = 0.01;
/// Segments that hang together cut only if they are as far across as this, share
/// of the longest edge left whole.
const SMALLEST_GROUP: f64 = 1.0;
/// Segments that cut one triangle, at most: the time grows with their square (4,050
/// take 0.3 s, 200 boxes that cross each other 0.14 s in all, Cornell's 0.01 s, at
/// little optimisation).
const MOST_SEGMENTS: usize = 4_096;

/// What is close and what is long, placed units.
struct Tolerances {
    touch: f64,
    snap: f64,
    smallest_group: f64,
    /// Longest edge left whole.
    max_edge: f64,
    /// The same, as tessellation takes it.
    limit: f32,
}

/// What contacts make of a scene's triangles.
#[derive(Default)]
pub(super) struct Cuts {
    pieces: HashMap<u32, Vec<[PieceCorner; 3]>>,
    /// Edges of pieces on which something stands.
    pub(super) contacts: Vec<[PieceCorner; 2]>,
}

impl Cuts {
    /// Finds where triangles (placed corners, each once) touch or cross.
    /// Tessellation leaves edges of `max_edge` whole.
    pub(super) fn of(triangles: &[[Vec3; 3]], max_edge: f32) -> Self {
        let wide = f64::from(max_edge);
        let tolerances = Tolerances {
            touch: TOUCH * wide,
            snap: SNAP * wide,
            smallest_group: SMALLEST_GROUP * wide,
            max_edge: wide,
            limit: max_edge,
        };
        let large: Vec<Large> = (0..triangles.len() as u32)
            .filter_map(|index| Large::of(index, triangles[index as usize], &tolerances))
            .collect();
        let contacts = find::contacts(&large, &tolerances);
        let segments = sites::segments(&large, &contacts, &tolerances);
        if segments.is_empty() {
            return Self::default();
        }
        let points = EdgePoints::of(&large, &segments);
        let jobs = jobs(triangles, &large, &segments, &points);
        let cuts: Vec<Cut> = jobs
            .par_iter()
            .map(|&(index, segments)| {
                let corners = triangles[index as usize];
                let on_edge = |k: usize| points.of_edge(corners[k], corners[(k + 1) % 3]);
                cut(&Job {
                    corners,
                    on_edges: [on_edge(0), on_edge(1), on_edge(2)],
                    segments,
                    tolerances: &tolerances,
                })
            })
            .collect();
        let mut all = Self::default();
        for ((index, _), cut) in jobs.into_iter().zip(cuts) {
            all.pieces.insert(index, cut.pieces);
            all.contacts.extend(cut.contacts);
        }
        all
    }

    /// The pieces of a triangle that is cut.
    pub(super) fn pieces(&self, triangle: u32) -> Option<&[[PieceCorner; 3]]> {
        self.pieces.get(&triangle).map(Vec::as_slice)
    }
}

/// The triangles that are cut, by segments or at points of their edges alone.
fn jobs<'s>(
    triangles: &[[Vec3; 3]],
    large: &[Large],
    segments: &'s [Segment],
    points: &EdgePoints,
) -> Vec<(u32, &'s [Segment])> {
    let mut jobs: Vec<(u32, &[Segment])> = segments
        .chunk_by(|a, b| a.target == b.target)
        .map(|of_target| {
            let some = &of_target[..of_target.len().min(MOST_SEGMENTS)];
            (large[of_target[0].target as usize].index, some)
        })
        .collect();
    let cut: HashSet<u32> = jobs.iter().map(|&(index, _)| index).collect();
    let has_points = |index: &u32| {
        let [a, b, c] = triangles[*index as usize];
        [(a, b), (b, c), (c, a)]
            .into_iter()
            .any(|(from, to)| !points.of_edge(from, to).is_empty())
    };
    let beside = (0..triangles.len() as u32).filter(|index| !cut.contains(index));
    jobs.extend(beside.filter(has_points).map(|index| (index, &[][..])));
    jobs
}

/// Points of contacts on edges of triangles.
struct EdgePoints {
    /// Where the shares of an edge are.
    ranges: HashMap<EdgeKey, (usize, usize)>,
    /// Shares of the way from the end that comes first in the key.
    shares: Vec<f32>,
}

impl EdgePoints {
    fn of(large: &[Large], segments: &[Segment]) -> Self {
        let mut points: Vec<(EdgeKey, f32)> = Vec::new();
        for segment in segments {
            for site in &segment.ends {
                if let Place::Edge(k, share) = site.place {
                    points.push((large[segment.target as usize].edge(k).1, share));
                }
            }
        }
        points.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        points.dedup();
        let mut ranges = HashMap::new();
        let mut first = 0;
        for of_edge in points.chunk_by(|a, b| a.0 == b.0) {
            ranges.insert(of_edge[0].0, (first, first + of_edge.len()));
            first += of_edge.len();
        }
        Self {
            ranges,
            shares: points.into_iter().map(|(_, share)| share).collect(),
        }
    }

    fn of_edge(&self, from: Vec3, to: Vec3) -> &[f32] {
        let (_, key) = directed(from, to);
        let (first, end) = self.ranges.get(&key).copied().unwrap_or((0, 0));
        &self.shares[first..end]
    }
}
