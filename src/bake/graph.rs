//! Who is next to whom among the lighting vertices.

use thiserror::Error;

/// Why a list of edges is no graph.
#[derive(Debug, Error, PartialEq, Eq)]
pub(crate) enum GraphError {
    /// An end of an edge does not exist.
    #[error("edge {edge} names vertex {vertex}, but there are only {vertex_count} vertices")]
    NoSuchVertex {
        /// Index in the list of edges.
        edge: usize,
        /// The end that does not exist.
        vertex: u32,
        /// Number of vertices of the graph.
        vertex_count: u32,
    },
    /// Both ends of an edge are the same vertex.
    #[error("edge {edge} joins vertex {vertex} to itself; leave such edges out")]
    Loop {
        /// Index in the list of edges.
        edge: usize,
        /// The vertex.
        vertex: u32,
    },
    /// The adjacency needs more entries than 32 bits count.
    #[error("{edge_count} edges are more than a vertex graph can index (2^31 - 1)")]
    TooManyEdges {
        /// Length of the list of edges.
        edge_count: usize,
    },
}

/// Undirected graph of lighting vertices in compressed rows: symmetric,
/// neighbours ascending, no loops, every cost at least 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct VertexGraph {
    /// Row of vertex i is `offsets[i]..offsets[i + 1]`; one longer than the
    /// number of vertices.
    offsets: Vec<u32>,
    neighbours: Vec<u32>,
    /// Cost of the edge to the neighbour at the same index.
    costs: Vec<u32>,
}

impl VertexGraph {
    /// Graph of `vertex_count` vertices with the undirected `edges`
    /// `(vertex, vertex, cost)` in any order and direction.
    ///
    /// Of equal edges the smallest cost stays. A cost of 0 becomes 1, so that
    /// distances grow along every path.
    ///
    /// # Errors
    /// An edge that names a missing vertex or joins a vertex to itself, or
    /// more than 2^31 - 1 edges.
    pub(crate) fn from_edges(
        vertex_count: u32,
        edges: &[(u32, u32, u32)],
    ) -> Result<Self, GraphError> {
        check_edges(vertex_count, edges)?;
        let mut directed: Vec<(u32, u32, u32)> = edges
            .iter()
            .flat_map(|&(a, b, cost)| [(a, b, cost.max(1)), (b, a, cost.max(1))])
            .collect();
        // Equal edges become neighbours in the list, the cheapest first.
        directed.sort_unstable();
        directed.dedup_by_key(|&mut (from, to, _)| (from, to));
        Ok(Self {
            offsets: row_offsets(vertex_count, &directed),
            neighbours: directed.iter().map(|&(_, to, _)| to).collect(),
            costs: directed.iter().map(|&(_, _, cost)| cost).collect(),
        })
    }

    /// The same vertices without some of the edges.
    pub(crate) fn without(&self, is_cut: impl Fn(u32, u32) -> bool) -> Self {
        let vertices = 0..self.vertex_count() as u32;
        let edges: Vec<(u32, u32, u32)> = vertices
            .flat_map(|a| self.edges_of(a).map(move |(b, cost)| (a, b, cost)))
            .filter(|&(a, b, _)| a < b && !is_cut(a, b))
            .collect();
        Self::from_edges(self.vertex_count() as u32, &edges)
            .expect("edges of this graph name its vertices")
    }

    /// Number of vertices.
    pub(crate) fn vertex_count(&self) -> usize {
        self.offsets.len() - 1
    }

    #[cfg(test)]
    /// Number of undirected edges.
    pub(crate) fn edge_count(&self) -> usize {
        self.neighbours.len() / 2
    }

    /// Neighbours of a vertex, ascending.
    pub(crate) fn neighbours(&self, vertex: u32) -> &[u32] {
        &self.neighbours[self.row(vertex)]
    }

    /// Costs of the edges to [`Self::neighbours`], in the same order.
    pub(crate) fn costs(&self, vertex: u32) -> &[u32] {
        &self.costs[self.row(vertex)]
    }

    /// Neighbours of a vertex with the cost of the edge to each, ascending.
    pub(crate) fn edges_of(&self, vertex: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        let neighbours = self.neighbours(vertex).iter().copied();
        neighbours.zip(self.costs(vertex).iter().copied())
    }

    /// Members of each connected component, ascending; components by their
    /// smallest member.
    pub(crate) fn connected_components(&self) -> Vec<Vec<u32>> {
        let mut seen = vec![false; self.vertex_count()];
        let mut components = Vec::new();
        for start in 0..self.vertex_count() as u32 {
            if !seen[start as usize] {
                components.push(self.component_of(start, &mut seen));
            }
        }
        components
    }

    fn component_of(&self, start: u32, seen: &mut [bool]) -> Vec<u32> {
        seen[start as usize] = true;
        let mut members = vec![start];
        let mut visited = 0;
        while let Some(&vertex) = members.get(visited) {
            visited += 1;
            for &neighbour in self.neighbours(vertex) {
                if !seen[neighbour as usize] {
                    seen[neighbour as usize] = true;
                    members.push(neighbour);
                }
            }
        }
        members.sort_unstable();
        members
    }

    fn row(&self, vertex: u32) -> std::ops::Range<usize> {
        let vertex = vertex as usize;
        self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize
    }
}

fn check_edges(vertex_count: u32, edges: &[(u32, u32, u32)]) -> Result<(), GraphError> {
    let edge_count = edges.len();
    if edge_count > i32::MAX as usize {
        return Err(GraphError::TooManyEdges { edge_count });
    }
    for (edge, &(a, b, _)) in edges.iter().enumerate() {
        let vertex = a.max(b);
        if vertex >= vertex_count {
            return Err(GraphError::NoSuchVertex {
                edge,
                vertex,
                vertex_count,
            });
        }
        if a == b {
            return Err(GraphError::Loop { edge, vertex });
        }
    }
    Ok(())
}

/// Start of each row in a list sorted by its first entry.
fn row_offsets(vertex_count: u32, directed: &[(u32, u32, u32)]) -> Vec<u32> {
    let mut offsets = vec![0_u32; vertex_count as usize + 1];
    for &(from, _, _) in directed {
        offsets[from as usize + 1] += 1;
    }
    for vertex in 0..vertex_count as usize {
        offsets[vertex + 1] += offsets[vertex];
    }
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_are_cut_are_gone_from_both_ends() {
        let graph = VertexGraph::from_edges(4, &[(0, 1, 3), (1, 2, 5), (2, 3, 7)]).unwrap();
        let cut = graph.without(|a, b| (a, b) == (1, 2));
        let kept = VertexGraph::from_edges(4, &[(0, 1, 3), (2, 3, 7)]).unwrap();
        assert_eq!(cut, kept);
        assert_eq!(cut.connected_components(), [vec![0, 1], vec![2, 3]]);
    }

    #[test]
    fn equal_edges_keep_the_smallest_cost() {
        let graph = VertexGraph::from_edges(4, &[(2, 0, 9), (0, 2, 4), (1, 0, 0)]).unwrap();
        assert_eq!(graph.neighbours(0), [1, 2]);
        assert_eq!(graph.costs(0), [1, 4]);
        assert_eq!(graph.costs(2), [4]);
        assert_eq!(graph.edge_count(), 2);
        assert!(graph.neighbours(3).is_empty());
    }

    #[test]
    fn faulty_edges_are_named() {
        let missing = VertexGraph::from_edges(2, &[(0, 1, 1), (1, 2, 1)]).unwrap_err();
        assert_eq!(
            missing,
            GraphError::NoSuchVertex {
                edge: 1,
                vertex: 2,
                vertex_count: 2
            }
        );
        let looped = VertexGraph::from_edges(2, &[(1, 1, 1)]).unwrap_err();
        assert_eq!(looped, GraphError::Loop { edge: 0, vertex: 1 });
    }

    #[test]
    fn components_are_ordered_by_their_smallest_member() {
        let graph = VertexGraph::from_edges(6, &[(5, 1, 1), (4, 0, 1), (4, 2, 1)]).unwrap();
        assert_eq!(
            graph.connected_components(),
            [vec![0, 2, 4], vec![1, 5], vec![3]]
        );
    }

    #[test]
    fn a_graph_may_be_empty() {
        let graph = VertexGraph::from_edges(0, &[]).unwrap();
        assert!(graph.connected_components().is_empty());
    }
}
