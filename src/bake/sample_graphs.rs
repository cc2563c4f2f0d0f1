//! Graphs that the tests of this room share.

use super::graph::VertexGraph;

type Edge = (u32, u32, u32);

/// Vertices `0..count` one after another.
pub(crate) fn path(count: u32) -> VertexGraph {
    let edges: Vec<Edge> = (1..count).map(|i| (i - 1, i, 100)).collect();
    VertexGraph::from_edges(count, &edges).unwrap()
}

/// Hub 0 joined to each of `leaves` others.
pub(crate) fn star(leaves: u32) -> VertexGraph {
    let edges: Vec<Edge> = (1..=leaves).map(|i| (0, i, 100)).collect();
    VertexGraph::from_edges(leaves + 1, &edges).unwrap()
}

/// `width` x `height` vertices, rows first, four neighbours each.
pub(crate) fn square_grid(width: u32, height: u32) -> VertexGraph {
    let edges = grid_edges(width, height, |_, _| true);
    VertexGraph::from_edges(width * height, &edges).unwrap()
}

/// [`square_grid`] with one diagonal in each cell, cost of length.
pub(crate) fn triangle_grid(width: u32, height: u32) -> VertexGraph {
    let edges = triangle_grid_edges(width, height, |_, _| true);
    VertexGraph::from_edges(width * height, &edges).unwrap()
}

/// Triangulated `size` x `size` grid without the middle third in both
/// directions; vertices of the hole are left out.
pub(crate) fn grid_with_hole(size: u32) -> VertexGraph {
    let hole = size / 3..size - size / 3;
    let keep = |x: u32, y: u32| !(hole.contains(&x) && hole.contains(&y));
    let edges = triangle_grid_edges(size, size, keep);
    let mut names = vec![u32::MAX; (size * size) as usize];
    let mut count = 0;
    for vertex in 0..size * size {
        if keep(vertex % size, vertex / size) {
            names[vertex as usize] = count;
            count += 1;
        }
    }
    let renamed: Vec<Edge> = edges
        .iter()
        .map(|&(a, b, cost)| (names[a as usize], names[b as usize], cost))
        .collect();
    VertexGraph::from_edges(count, &renamed).unwrap()
}

/// Latitude and longitude sphere: `rings` circles of `around` vertices between
/// two poles, costs near the length on a sphere of radius 1000.
pub(crate) fn sphere(rings: u32, around: u32) -> VertexGraph {
    let (north, south) = (rings * around, rings * around + 1);
    let mut edges = Vec::new();
    for ring in 0..rings {
        let latitude = f64::from(ring + 1) / f64::from(rings + 1);
        let circle = 4.0 * latitude * (1.0 - latitude);
        let east = (6283.0 * circle / f64::from(around)) as u32;
        for step in 0..around {
            let here = ring * around + step;
            edges.push((here, ring * around + (step + 1) % around, east));
            let up = if ring + 1 < rings {
                here + around
            } else {
                south
            };
            edges.push((here, up, 3141 / (rings + 1)));
            if ring == 0 {
                edges.push((here, north, 3141 / (rings + 1)));
            }
        }
    }
    VertexGraph::from_edges(south + 1, &edges).unwrap()
}

/// `count` cubes of eight vertices, joined along their edges, apart from one
/// another.
pub(crate) fn boxes(count: u32) -> VertexGraph {
    let mut edges = Vec::new();
    for first in (0..count).map(|cube| cube * 8) {
        for corner in 0..8_u32 {
            for bit in [1, 2, 4] {
                if corner & bit == 0 {
                    edges.push((first + corner, first + (corner | bit), 100));
                }
            }
        }
    }
    VertexGraph::from_edges(count * 8, &edges).unwrap()
}

fn grid_edges(width: u32, height: u32, keep: impl Fn(u32, u32) -> bool) -> Vec<Edge> {
    grid_edges_along(width, height, &[(1, 0, 100), (0, 1, 100)], keep)
}

fn triangle_grid_edges(width: u32, height: u32, keep: impl Fn(u32, u32) -> bool) -> Vec<Edge> {
    grid_edges_along(
        width,
        height,
        &[(1, 0, 100), (0, 1, 100), (1, 1, 141)],
        keep,
    )
}

fn grid_edges_along(
    width: u32,
    height: u32,
    steps: &[Edge],
    keep: impl Fn(u32, u32) -> bool,
) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        for &(dx, dy, cost) in steps {
            let (to_x, to_y) = (x + dx, y + dy);
            if to_x < width && to_y < height && keep(x, y) && keep(to_x, to_y) {
                edges.push((y * width + x, to_y * width + to_x, cost));
            }
        }
    }
    edges
}
