use super::super::graph::VertexGraph;
use super::super::sample_graphs;
use super::*;
use crate::maths::functions::sin;
use crate::maths::order::Order;

/// Deviation from orthonormality that rounding explains.
const ORTHONORMAL: f64 = 1e-12;

fn lowest(graph: &VertexGraph, wanted: usize) -> Eigenpairs {
    let laplacian = Laplacian::of_graph(graph);
    let pairs = lowest_eigenpairs(&laplacian, wanted).unwrap();
    assert!(pairs.residual <= RESIDUAL_LIMIT);
    assert_orthonormal(&pairs);
    pairs
}

fn assert_orthonormal(pairs: &Eigenpairs) {
    let count = pairs.values.len();
    for j in 0..count {
        for k in 0..=j {
            let rows = pairs.vectors.chunks_exact(count);
            let product: f64 = rows.map(|row| row[j] * row[k]).sum();
            let unit = if j == k { 1.0 } else { 0.0 };
            assert!(
                (product - unit).abs() <= ORTHONORMAL,
                "columns {j} and {k}: {product}"
            );
        }
    }
}

/// Eigenvalue k of a path of n vertices: 4 sin^2(pi k / 2n).
fn path_value(k: usize, n: usize) -> f64 {
    let root = 2.0 * sin(std::f64::consts::FRAC_PI_2 * k as f64 / n as f64);
    root * root
}

/// Entry i of eigenvector k of a path of n vertices, length 1:
/// cos(pi k (i + 1/2) / n).
fn path_entry(k: usize, i: usize, n: usize) -> f64 {
    let scale = (if k == 0 { 1.0 } else { 2.0 } / n as f64).sqrt();
    let angle = std::f64::consts::PI * k as f64 * (i as f64 + 0.5) / n as f64;
    scale * sin(angle + std::f64::consts::FRAC_PI_2)
}

#[test]
fn spectrum_of_a_path() {
    let pairs = lowest(&sample_graphs::path(300), 12);
    assert_eq!(pairs.values.len(), 12);
    for (k, &value) in pairs.values.iter().enumerate() {
        assert!((value - path_value(k, 300)).abs() < 1e-12, "{k}: {value}");
        let sign = pairs.vectors[k].signum();
        for i in 0..300 {
            let entry = sign * pairs.vectors[i * 12 + k];
            assert!(
                (entry - path_entry(k, i, 300)).abs() < 1e-8,
                "{k} {i}: {entry}"
            );
        }
    }
}

#[test]
fn the_largest_entry_is_positive() {
    let pairs = lowest(&sample_graphs::grid_with_hole(30), 20);
    let count = pairs.values.len();
    for k in 0..count {
        let column = pairs.vectors.iter().skip(k).step_by(count);
        let largest = column
            .clone()
            .fold(0.0_f64, |max, entry| max.at_least(entry.abs()));
        let first = column
            .clone()
            .find(|entry| entry.abs() >= largest * (1.0 - SIGN_TIE));
        assert!(*first.unwrap() > 0.0, "column {k}");
    }
}

#[test]
fn projector_of_a_square_grid() {
    // Eigenvalues are sums of two of a path, most of them twice.
    let n = 20;
    let mut modes: Vec<(f64, usize, usize)> = (0..n * n)
        .map(|i| (path_value(i % n, n) + path_value(i / n, n), i % n, i / n))
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pairs = lowest(&sample_graphs::square_grid(n as u32, n as u32), 24);
    let count = pairs.values.len();
    for (value, mode) in pairs.values.iter().zip(&modes) {
        assert!((value - mode.0).abs() < 1e-12);
    }
    let row = |i: usize| &pairs.vectors[i * count..(i + 1) * count];
    for (a, b) in (0..n * n).flat_map(|a| [(a, a), (a, 7), (a, n * n - 1 - a)]) {
        let found: f64 = row(a).iter().zip(row(b)).map(|(x, y)| x * y).sum();
        let mode_at = |mode: &(f64, usize, usize), i: usize| {
            path_entry(mode.1, i % n, n) * path_entry(mode.2, i / n, n)
        };
        let known: f64 = modes[..count]
            .iter()
            .map(|mode| mode_at(mode, a) * mode_at(mode, b))
            .sum();
        assert!((found - known).abs() < 1e-6, "{a} {b}: {found} {known}");
    }
}

#[test]
fn no_cluster_is_cut() {
    // Eigenvalues of the square grid by size: one, two, one, two, two, ...
    let square = sample_graphs::square_grid(20, 20);
    let counts: Vec<usize> = (1..=6)
        .map(|wanted| lowest(&square, wanted).values.len())
        .collect();
    assert_eq!(counts, [1, 1, 3, 4, 4, 6]);
    // A star has 0, then 1 for every leaf but one, then one large value.
    let star = sample_graphs::star(200);
    assert_eq!(lowest(&star, 5).values.len(), 1);
    assert_eq!(lowest(&star, 200).values.len(), 200);
    assert_eq!(lowest(&star, 400).values.len(), 201);
}

#[test]
fn kernels_of_several_pieces_are_whole() {
    // 60 pieces: fewer functions than pieces would cut the cluster at 0.
    let pairs = lowest(&sample_graphs::boxes(60), 7);
    assert_eq!(pairs.values.len(), 60);
    assert!(pairs.values.iter().all(|value| value.abs() < 1e-12));
}

#[test]
fn tiny_parts_have_full_bases() {
    for size in 1..=3_u32 {
        let graph = sample_graphs::path(size);
        assert_eq!(lowest(&graph, 24).values.len(), size as usize);
        assert_eq!(lowest(&graph, 1).values.len(), 1);
    }
    let pair = lowest(&sample_graphs::path(2), 2);
    assert!((pair.values[1] - 2.0).abs() < 1e-14);
}

#[test]
fn dense_and_filtered_answers_agree() {
    let laplacian = Laplacian::of_graph(&sample_graphs::grid_with_hole(24));
    let dense = dense_pairs(&laplacian).unwrap();
    let filtered = filtered_pairs(&laplacian, 21, 30, 5).unwrap();
    for (a, b) in dense.values.iter().zip(&filtered.values) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn inertia_tells_of_a_missing_pair() {
    let laplacian = Laplacian::of_graph(&sample_graphs::triangle_grid(12, 10));
    let mut found = dense_pairs(&laplacian).unwrap();
    assert!(found.is_proven(&laplacian, 9, 0.0));
    found.values.remove(4);
    assert!(!found.is_proven(&laplacian, 9, 0.0));
}

#[test]
fn hubs_and_long_strips_converge() {
    // A fan: a path of 500 vertices, all joined to one more.
    let rim = (1..500).map(|i| (i - 1, i, 1));
    let spokes = (0..500).map(|i| (i, 500, 1));
    let edges: Vec<(u32, u32, u32)> = rim.chain(spokes).collect();
    let fan = VertexGraph::from_edges(501, &edges).unwrap();
    assert_eq!(lowest(&fan, 20).values.len(), 20);
    assert_eq!(
        lowest(&sample_graphs::triangle_grid(350, 2), 24)
            .values
            .len(),
        24
    );
}
