//! One triangle cut along contacts: its usual tessellation away from them, and a
//! constrained Delaunay triangulation of all corners, so that no piece straddles a
//! contact.

use std::collections::HashMap;

use glam::{DVec2, DVec3, IVec3, Vec3};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

use super::Tolerances;
use super::lines::{Line, crossings, distance_to, split_at};
use super::sites::{Place, Segment, between, directed};
use crate::surface::tessellate::{PieceCorner, halve, tessellate};

/// Corners of the usual tessellation this close to a contact give way to those on
/// it, share of the longest edge left whole.
const GIVE_WAY: f64 = 0.35;

/// A triangle that is cut, or whose edges are.
pub(super) struct Job<'a> {
    pub(super) corners: [Vec3; 3],
    /// Points on each edge, as shares of the way in the direction of its key.
    pub(super) on_edges: [&'a [f32]; 3],
    pub(super) segments: &'a [Segment],
    pub(super) tolerances: &'a Tolerances,
}

/// What a triangle becomes.
#[derive(Debug, Default)]
pub(super) struct Cut {
    pub(super) pieces: Vec<[PieceCorner; 3]>,
    /// Edges of pieces on which something stands.
    pub(super) contacts: Vec<[PieceCorner; 2]>,
}

/// A corner of pieces.
#[derive(Debug, Clone, Copy)]
struct Node {
    corner: PieceCorner,
    /// In the plane of two axes, in which the triangle is counter-clockwise.
    flat: DVec2,
    /// The edges of the triangle that it lies on, a bit each.
    edges: u8,
}

/// The nodes of one triangle as they are found.
struct Nodes<'a> {
    job: &'a Job<'a>,
    axes: [usize; 2],
    nodes: Vec<Node>,
    /// Per edge, its nodes from the end that comes first in its key to the other.
    chains: [Vec<usize>; 3],
    index_of: HashMap<[u32; 3], usize>,
}

/// Lines no longer than a cell of space, by the cells of their middles.
struct Fixed {
    cell: f64,
    lines: HashMap<IVec3, Vec<[DVec3; 2]>>,
}

impl Fixed {
    /// Cells as wide as the longest edge left whole, and its slack.
    fn of_cells(max_edge: f64) -> Self {
        Self {
            cell: max_edge * 1.01,
            lines: HashMap::new(),
        }
    }

    fn cell(&self, position: DVec3) -> IVec3 {
        (position / self.cell).floor().as_ivec3()
    }

    fn add(&mut self, line: [DVec3; 2]) {
        let cell = self.cell((line[0] + line[1]) * 0.5);
        self.lines.entry(cell).or_default().push(line);
    }

    /// Whether all are farther than `near`, less than half a cell, from a point.
    fn are_farther(&self, position: DVec3, near: f64) -> bool {
        let middle = self.cell(position);
        (0..27).all(|k| {
            let beside = middle + IVec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            let lines = self.lines.get(&beside).map_or(&[][..], Vec::as_slice);
            lines
                .iter()
                .all(|line| distance_to(*line, position) >= near)
        })
    }
}

/// Cuts a triangle.
pub(super) fn cut(job: &Job<'_>) -> Cut {
    let mut nodes = Nodes::of_corners(job);
    for k in 0..3 {
        nodes.add_chain(k);
    }
    let lines = nodes.add_lines();
    nodes.add_grid(&lines);
    let contacts = nodes.contacts(&lines);
    Cut {
        pieces: nodes.pieces(&lines),
        contacts,
    }
}

impl<'a> Nodes<'a> {
    fn of_corners(job: &'a Job<'a>) -> Self {
        let [a, b, c] = job.corners.map(|corner| corner.as_dvec3());
        let normal = (b - a).cross(c - a);
        let size = normal.abs();
        let widest = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let mut axes = [(widest + 1) % 3, (widest + 2) % 3];
        if normal[widest] < 0.0 {
            axes.reverse();
        }
        let mut nodes = Self {
            job,
            axes,
            nodes: Vec::new(),
            chains: [const { Vec::new() }; 3],
            index_of: HashMap::new(),
        };
        for (k, unit) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
            let corner = PieceCorner {
                position: job.corners[k],
                source_barycentrics: unit,
            };
            nodes.add(corner, 1 << k | 1 << ((k + 2) % 3));
        }
        nodes
    }

    /// The node at a position, new or found before.
    fn add(&mut self, corner: PieceCorner, edges: u8) -> usize {
        let next = self.nodes.len();
        let bits = (corner.position + Vec3::ZERO).to_array().map(f32::to_bits);
        let index = *self.index_of.entry(bits).or_insert(next);
        if index == next {
            let position = corner.position.as_dvec3();
            self.nodes.push(Node {
                corner,
                flat: DVec2::new(position[self.axes[0]], position[self.axes[1]]),
                edges,
            });
        }
        index
    }

    /// Adds the nodes inside an edge: those of the usual tessellation, which give
    /// way to the points of contacts. They depend on nothing but the edge.
    fn add_chain(&mut self, edge: usize) {
        let ends = [edge, (edge + 1) % 3];
        let (directed_ends, _) = directed(self.job.corners[ends[0]], self.job.corners[ends[1]]);
        let is_forwards = directed_ends[0] == self.job.corners[ends[0]];
        let [from, to] = if is_forwards {
            ends
        } else {
            [ends[1], ends[0]]
        };
        let extra = self.job.on_edges[edge];
        let length = f64::from(directed_ends[0].distance(directed_ends[1]));
        let gives_way = |share: f32| {
            let near = self.job.tolerances.max_edge * GIVE_WAY / length;
            let is_near = |other: &f32| f64::from((share - other).abs()) < near;
            extra.iter().any(is_near)
        };
        let mut inner: Vec<(f32, PieceCorner)> = Vec::new();
        let [a, b] = [from, to].map(|k| self.nodes[k].corner);
        halve(a, b, self.job.tolerances.limit, &mut |corner| {
            let share = corner.source_barycentrics[to];
            if !gives_way(share) {
                inner.push((share, corner));
            }
        });
        inner.extend(extra.iter().map(|&share| {
            let corner = PieceCorner {
                position: between(directed_ends, share),
                source_barycentrics: a.source_barycentrics * (1.0 - share)
                    + b.source_barycentrics * share,
            };
            (share, corner)
        }));
        inner.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut chain = vec![from];
        for (_, corner) in inner {
            chain.push(self.add(corner, 1 << edge));
        }
        chain.push(to);
        self.chains[edge] = chain;
    }

    /// Adds the nodes of contacts inside the triangle and returns the lines
    /// between them, none longer than the limit.
    fn add_lines(&mut self) -> Vec<Line> {
        let snap = self.job.tolerances.snap;
        let mut lines: Vec<Line> = Vec::new();
        for segment in self.job.segments {
            if segment.edge().is_none() {
                lines.push(segment.ends.map(|site| match site.place {
                    Place::Corner(k) => k,
                    Place::Edge(..) | Place::Inside => self.add_inside(site.position.as_dvec3()),
                }));
            }
        }
        for flat in crossings(&self.flats(), &lines, snap) {
            let position = self.lifted(flat);
            let is_close = |node: &Node| node.flat.distance(flat) <= snap;
            // A node on an edge that the triangle beside does not know of would
            // be a T-junction.
            if !self.nodes.iter().any(is_close) && !self.is_at_edge(position) {
                self.add_inside(position);
            }
        }
        let mut short = Vec::new();
        for [from, to] in split_at(&self.flats(), &lines, snap) {
            let mut last = from;
            let [a, b] = [from, to].map(|node| self.nodes[node].corner);
            let mut inner = Vec::new();
            halve(a, b, self.job.tolerances.limit, &mut |corner| {
                inner.push(corner);
            });
            for corner in inner {
                let node = self.add(corner, 0);
                short.push([last, node]);
                last = node;
            }
            short.push([last, to]);
        }
        short
    }

    /// Whether a point of the triangle is closer to an edge than `snap`.
    fn is_at_edge(&self, position: DVec3) -> bool {
        let corners = self.job.corners.map(|corner| corner.as_dvec3());
        let distance = |k: usize| distance_to([corners[k], corners[(k + 1) % 3]], position);
        (0..3).any(|k| distance(k) <= self.job.tolerances.snap)
    }

    /// A node of a position that is on an edge already or inside.
    fn add_inside(&mut self, position: DVec3) -> usize {
        let corner = PieceCorner {
            position: position.as_vec3(),
            source_barycentrics: self.barycentrics(position),
        };
        self.add(corner, 0)
    }

    fn barycentrics(&self, position: DVec3) -> Vec3 {
        let p = DVec2::new(position[self.axes[0]], position[self.axes[1]]);
        let [a, b, c] = [0, 1, 2].map(|k| self.nodes[k].flat);
        let whole = (b - a).perp_dot(c - a);
        let v = (p - a).perp_dot(c - a) / whole;
        let w = (b - a).perp_dot(p - a) / whole;
        DVec3::new(1.0 - v - w, v, w).as_vec3()
    }

    /// The point of the triangle's plane that is seen at a place of the two axes.
    fn lifted(&self, flat: DVec2) -> DVec3 {
        let [a, b, c] = [0, 1, 2].map(|k| self.nodes[k].flat);
        let whole = (b - a).perp_dot(c - a);
        let v = (flat - a).perp_dot(c - a) / whole;
        let w = (b - a).perp_dot(flat - a) / whole;
        let [a, b, c] = self.job.corners.map(|corner| corner.as_dvec3());
        a + (b - a) * v + (c - a) * w
    }

    fn flats(&self) -> Vec<DVec2> {
        self.nodes.iter().map(|node| node.flat).collect()
    }

    /// Adds the inner corners of the usual tessellation, but for those close to a
    /// contact.
    fn add_grid(&mut self, lines: &[Line]) {
        let mut inner: Vec<PieceCorner> = Vec::new();
        tessellate(self.job.corners, self.job.tolerances.limit, &mut |piece| {
            let is_inner = |c: &PieceCorner| c.source_barycentrics.cmpgt(Vec3::ZERO).all();
            inner.extend(piece.into_iter().filter(is_inner));
        });
        let near = self.job.tolerances.max_edge * GIVE_WAY;
        let mut fixed = Fixed::of_cells(self.job.tolerances.max_edge);
        for line in lines {
            fixed.add(line.map(|node| self.nodes[node].corner.position.as_dvec3()));
        }
        for k in 0..3 {
            let (ends, _) = directed(self.job.corners[k], self.job.corners[(k + 1) % 3]);
            for &share in self.job.on_edges[k] {
                fixed.add([between(ends, share).as_dvec3(); 2]);
            }
        }
        for corner in inner {
            if fixed.are_farther(corner.position.as_dvec3(), near) {
                self.add(corner, 0);
            }
        }
    }

    /// Edges of pieces on which something stands.
    fn contacts(&self, lines: &[Line]) -> Vec<[PieceCorner; 2]> {
        let corners = |line: &Line| line.map(|node| self.nodes[node].corner);
        let mut contacts: Vec<[PieceCorner; 2]> = lines.iter().map(corners).collect();
        for segment in self.job.segments {
            let Some(edge) = segment.edge() else { continue };
            let chain = &self.chains[edge];
            let rank = |position: Vec3| {
                let at = |&node: &usize| self.nodes[node].corner.position == position;
                chain.iter().position(at)
            };
            let [Some(first), Some(last)] = segment.ends.map(|site| rank(site.position)) else {
                continue;
            };
            let part = &chain[first.min(last)..=first.max(last)];
            contacts.extend(part.windows(2).map(|pair| corners(&[pair[0], pair[1]])));
        }
        contacts
    }

    /// Triangulates the nodes.
    fn pieces(&self, lines: &[Line]) -> Vec<[PieceCorner; 3]> {
        let mut mesh: ConstrainedDelaunayTriangulation<Point2<f64>> =
            ConstrainedDelaunayTriangulation::new();
        let mut node_of: Vec<usize> = Vec::with_capacity(self.nodes.len());
        let handles: Vec<FixedVertexHandle> = self
            .nodes
            .iter()
            .enumerate()
            .map(|(index, node)| {
                // What is so near to 0 that products of it vanish is taken for it.
                let place = mitigate_underflow(Point2::new(node.flat.x, node.flat.y));
                let handle = mesh
                    .insert(place)
                    .expect("placed positions are finite and not beyond 1");
                if handle.index() == node_of.len() {
                    node_of.push(index);
                }
                handle
            })
            .collect();
        let chains = self.chains.iter().flat_map(|chain| chain.windows(2));
        for [a, b] in chains
            .map(|pair| [pair[0], pair[1]])
            .chain(lines.iter().copied())
        {
            let (a, b) = (handles[a], handles[b]);
            if a != b && mesh.can_add_constraint(a, b) {
                mesh.add_constraint(a, b);
            }
        }
        let of_face = mesh.inner_faces().map(|face| {
            face.vertices()
                .map(|vertex| self.nodes[node_of[vertex.fix().index()]])
        });
        // Nodes on an edge are on a straight line but for rounding: what is
        // between them is no part of the triangle.
        of_face
            .filter(|[a, b, c]| a.edges & b.edges & c.edges == 0)
            .map(|face| face.map(|node| node.corner))
            .collect()
    }
}
