use super::super::sample_graphs;
use super::*;

fn split_into(graph: &VertexGraph, vertices_per_part: u32) -> Partition {
    let weights = vec![1; graph.vertex_count()];
    let settings = PartitionSettings {
        vertices_per_part,
        ..PartitionSettings::default()
    };
    partition(graph, &weights, settings)
}

/// Size of the largest part over the mean size.
fn imbalance(partition: &Partition) -> f64 {
    let largest = (0..partition.part_count())
        .map(|part| partition.members(part).len())
        .max();
    let mean = partition.vertex_count() as f64 / partition.part_count() as f64;
    largest.unwrap() as f64 / mean
}

fn assert_sound(graph: &VertexGraph, partition: &Partition) {
    let mut smallest = None;
    for part in 0..partition.part_count() {
        let members = partition.members(part);
        assert!(members.is_sorted(), "members of part {part} are ascending");
        assert!(
            smallest < members.first(),
            "parts are numbered by their smallest member"
        );
        smallest = members.first();
        assert_eq!(
            pieces(graph, partition, members),
            1,
            "part {part} is one piece"
        );
    }
}

/// Number of connected pieces of a part.
fn pieces(graph: &VertexGraph, partition: &Partition, members: &[u32]) -> usize {
    let part = partition.part_of(members[0]);
    let edges: Vec<(u32, u32, u32)> = members
        .iter()
        .flat_map(|&from| graph.neighbours(from).iter().map(move |&to| (from, to)))
        .filter(|&(_, to)| partition.part_of(to) == part)
        .map(|(from, to)| {
            let local = |vertex| members.binary_search(&vertex).unwrap() as u32;
            (local(from), local(to), 1)
        })
        .collect();
    let inside = VertexGraph::from_edges(members.len() as u32, &edges).unwrap();
    inside.connected_components().len()
}

/// (name, graph, vertices a part, largest cut allowed). The cuts are 5 % above
/// what was measured (771, 1247, 1475, 839, 105 and 9; METIS 5 reaches 595,
/// 1102 and 1382 on the first three), so that a change for the worse shows.
fn yardsticks() -> Vec<(&'static str, VertexGraph, u32, usize)> {
    vec![
        (
            "square grid 100 x 100",
            sample_graphs::square_grid(100, 100),
            700,
            810,
        ),
        (
            "triangle grid 100 x 100",
            sample_graphs::triangle_grid(100, 100),
            700,
            1310,
        ),
        (
            "grid with a hole",
            sample_graphs::grid_with_hole(120),
            700,
            1550,
        ),
        ("sphere", sample_graphs::sphere(60, 120), 500, 880),
        (
            "strip 4 x 2000",
            sample_graphs::triangle_grid(4, 2000),
            500,
            110,
        ),
        ("path", sample_graphs::path(5000), 500, 9),
    ]
}

#[test]
fn parts_are_connected_balanced_and_short_of_border() {
    for (name, graph, vertices_per_part, largest_cut) in yardsticks() {
        let partition = split_into(&graph, vertices_per_part);
        assert_sound(&graph, &partition);
        let wanted = (graph.vertex_count() as f64 / f64::from(vertices_per_part)).round();
        assert_eq!(partition.part_count() as f64, wanted, "{name}");
        let (imbalance, cut) = (imbalance(&partition), partition.edge_cut(&graph));
        assert!(
            imbalance <= 1.3,
            "{name}: largest part {imbalance:.3} of the mean"
        );
        assert!(
            cut <= largest_cut,
            "{name}: {cut} of {} edges cut",
            graph.edge_count()
        );
    }
}

#[test]
fn a_star_keeps_its_hub_in_one_piece() {
    let graph = sample_graphs::star(1000);
    let partition = split_into(&graph, 100);
    assert_sound(&graph, &partition);
    assert_eq!(partition.part_count(), 10);
}

#[test]
fn small_components_are_parts_by_themselves() {
    let graph = sample_graphs::boxes(200);
    let partition = split_into(&graph, 100);
    assert_sound(&graph, &partition);
    assert_eq!(partition.part_count(), 200);
    let lone = VertexGraph::from_edges(3, &[]).unwrap();
    assert_eq!(split_into(&lone, 1).part_count(), 3);
}

#[test]
fn one_vertex_a_part_is_possible() {
    let graph = sample_graphs::triangle_grid(6, 5);
    assert_eq!(split_into(&graph, 1).part_count(), 30);
}

#[test]
fn heavy_vertices_fill_a_part_sooner() {
    let graph = sample_graphs::triangle_grid(40, 40);
    let weights: Vec<u32> = (0..1600)
        .map(|vertex| if vertex < 800 { 3 } else { 1 })
        .collect();
    let settings = PartitionSettings {
        vertices_per_part: 400,
        ..PartitionSettings::default()
    };
    let partition = partition(&graph, &weights, settings);
    assert_sound(&graph, &partition);
    let weight = |part| -> u32 {
        let members: &[u32] = partition.members(part);
        members.iter().map(|&vertex| weights[vertex as usize]).sum()
    };
    assert_eq!(partition.part_count(), 8);
    assert!(
        (0..8).all(|part| weight(part) <= 520),
        "within 1.3 of the mean weight"
    );
}

#[test]
fn borders_follow_dear_edges() {
    // A crease across the middle of the grid, ten times as dear to cross.
    let plain = sample_graphs::triangle_grid(40, 40);
    let crosses = |a: u32, b: u32| (a / 40 < 20) != (b / 40 < 20);
    let edges: Vec<(u32, u32, u32)> = (0..1600)
        .flat_map(|a| plain.edges_of(a).map(move |(b, cost)| (a, b, cost)))
        .map(|(a, b, cost)| (a, b, if crosses(a, b) { cost * 10 } else { cost }))
        .collect();
    let creased = VertexGraph::from_edges(1600, &edges).unwrap();
    let partition = split_into(&creased, 400);
    let straddling = (0..40)
        .filter(|&x| partition.part_of(19 * 40 + x) == partition.part_of(20 * 40 + x))
        .count();
    assert!(
        straddling <= 4,
        "{straddling} of 40 edges over the crease stay inside a part"
    );
}

#[test]
fn the_same_graph_gives_the_same_parts() {
    let graph = sample_graphs::grid_with_hole(90);
    assert_eq!(split_into(&graph, 300), split_into(&graph, 300));
}
