use super::super::partition::{PartitionSettings, partition};
use super::super::sample_graphs;
use super::*;
use crate::bake::places::Places;
use crate::bake::{BakeSettings, Importance, RunSettings, low_rank, spectral_basis};
use crate::maths::order::Order;
use crate::scene::sample_scenes::room_with_blocks;
use crate::surface::{Detail, Surface};

/// Largest deviation of a constant from its projection onto the basis.
const CONSTANT_ERROR: f32 = 1e-5;

/// Light under other names of the partitions, share of its mean: sums in
/// another order, single precision.
const RENAMED: f32 = 1e-5;

fn parts_of(graph: &VertexGraph, vertices_per_part: u32) -> Partition {
    let weights = vec![1; graph.vertex_count()];
    let settings = PartitionSettings {
        vertices_per_part,
        ..PartitionSettings::default()
    };
    partition(graph, &weights, settings)
}

fn basis_of(graph: &VertexGraph, vertices_per_part: u32, functions: u32) -> Basis {
    let partition = parts_of(graph, vertices_per_part);
    let wanted = vec![functions; partition.part_count()];
    Basis::build(graph, &partition, &wanted, &|| {}, &|| false).unwrap()
}

/// S b at every vertex, for scalar coefficients.
fn reconstruct(basis: &Basis, coefficients: &[f32]) -> Vec<f32> {
    let mut values = vec![0.0; basis.slot_count()];
    for (slot, &vertex) in basis.vertex_of_slot().iter().enumerate() {
        let (part, row) = basis.row(slot as u32);
        let own = &coefficients[basis.function_range(part)];
        values[vertex as usize] = row.iter().zip(own).map(|(s, b)| s * b).sum();
    }
    values
}

fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(work)
}

#[test]
fn constant_light_is_reproduced_on_every_part() {
    let graphs = [
        sample_graphs::boxes(200),
        sample_graphs::triangle_grid(40, 40),
        sample_graphs::grid_with_hole(45),
        sample_graphs::star(300),
        VertexGraph::from_edges(4, &[(0, 1, 1)]).unwrap(),
    ];
    for graph in graphs {
        let basis = basis_of(&graph, 400, 12);
        for value in reconstruct(&basis, &basis.constant(Level::Scalar)) {
            assert!((value - 1.0).abs() <= CONSTANT_ERROR, "{value}");
        }
    }
}

#[test]
fn functions_are_orthonormal_after_rounding() {
    let basis = basis_of(&sample_graphs::triangle_grid(50, 40), 500, 20);
    for &part in &basis.parts {
        let count = part.function_count;
        for j in 0..count {
            for k in 0..=j {
                let rows = basis.part_values(part).chunks_exact(count);
                let product: f64 = rows.map(|row| f64::from(row[j]) * f64::from(row[k])).sum();
                let unit = if j == k { 1.0 } else { 0.0 };
                assert!((product - unit).abs() < 1e-6, "{j} {k}: {product}");
            }
        }
    }
}

/// A basis of two parts under masses from 0.02 to 1.
fn under_masses() -> (Basis, Vec<f32>) {
    let basis = basis_of(&sample_graphs::triangle_grid(30, 20), 300, 8);
    let mass = |i: u32| [0.02, 0.3, 1.0][i as usize % 3];
    let masses: Vec<f32> = (0..basis.slot_count() as u32).map(mass).collect();
    (basis.under_masses(&masses), masses)
}

#[test]
fn masses_keep_orthonormal_functions_and_constant_light() {
    let (basis, masses) = under_masses();
    for value in reconstruct(&basis, &basis.constant(Level::Scalar)) {
        assert!((value - 1.0).abs() <= CONSTANT_ERROR, "{value}");
    }
    for part in 0..basis.part_count() as u32 {
        for (j, k) in [(0, 0), (3, 3), (0, 5), (2, 7)] {
            let terms = basis.slot_range(part).map(|slot| {
                let row = basis.row(slot as u32).1;
                let mass = masses[basis.vertex_of_slot()[slot] as usize];
                f64::from(row[j]) * f64::from(row[k]) * f64::from(mass)
            });
            let (product, unit) = (terms.sum::<f64>(), if j == k { 1.0 } else { 0.0 });
            assert!((product - unit).abs() < 1e-5, "{j} {k}: {product}");
        }
    }
}

#[test]
fn projection_under_masses_keeps_what_is_handed_on() {
    let (basis, masses) = under_masses();
    let bright = |i: u32| if i.is_multiple_of(7) { 5.0 } else { 0.1 };
    let slots = basis.vertex_of_slot().iter();
    let light: Vec<[f32; 3]> = slots.map(|&v| [bright(v); 3]).collect();
    let kept = basis.reconstruct_rgb(&basis.project_rgb(Level::Scalar, &light));
    for part in 0..basis.part_count() as u32 {
        let sum = |field: &[[f32; 3]]| -> f64 {
            let terms = basis.slot_range(part).map(|slot| {
                let mass = masses[basis.vertex_of_slot()[slot] as usize];
                f64::from(field[slot][0]) * f64::from(mass)
            });
            terms.sum()
        };
        let ratio = sum(&kept) / sum(&light);
        assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
    }
}

#[test]
fn masses_of_a_file_are_checked() {
    let basis = || basis_of(&sample_graphs::path(6), 6, 2);
    assert!(basis().with_masses(Vec::new()).is_ok());
    assert!(basis().with_masses(vec![0.5; 6]).is_ok());
    for wrong in [vec![1.0; 5], vec![0.0; 6], vec![f32::NAN; 6], vec![-1.0; 6]] {
        assert!(basis().with_masses(wrong).is_err());
    }
}

#[test]
fn a_function_projects_onto_itself() {
    let basis = basis_of(&sample_graphs::triangle_grid(30, 20), 300, 8);
    let mut values = vec![[0.0; 3]; basis.slot_count()];
    for slot in basis.slot_range(1) {
        let function = basis.row(slot as u32).1[3];
        values[slot] = [function, 2.0 * function, 0.0];
    }
    let wanted = basis.function_range(1).start + 3;
    for (k, coefficient) in basis.project_rgb(Level::Scalar, &values).iter().enumerate() {
        let unit = if k == wanted { 1.0 } else { 0.0 };
        for (found, wanted) in coefficient.iter().zip([unit, 2.0 * unit, 0.0]) {
            assert!((found - wanted).abs() < 1e-5, "{k}: {found}");
        }
    }
}

#[test]
fn reconstruction_undoes_projection_of_what_the_basis_holds() {
    let basis = basis_of(&sample_graphs::triangle_grid(30, 20), 300, 8);
    let coefficients: Vec<[f32; 3]> = (0..basis.function_count())
        .map(|k| [k as f32, 1.0 - k as f32, 0.5])
        .collect();
    let values = basis.reconstruct_rgb(&coefficients);
    for (channel, values) in [0, 1, 2].map(|c| (c, values.iter().map(move |v| v[c]))) {
        let scalars: Vec<f32> = coefficients.iter().map(|b| b[channel]).collect();
        let by_vertex = reconstruct(&basis, &scalars);
        let slots = basis.vertex_of_slot().iter();
        assert!(slots.map(|&v| by_vertex[v as usize]).eq(values));
    }
    let projected = basis.project_rgb(Level::Scalar, &values);
    for (found, wanted) in projected.iter().zip(&coefficients) {
        let off = (0..3).map(|c| (found[c] - wanted[c]).abs());
        assert!(
            off.fold(0.0, f32::at_least) < 1e-4,
            "{found:?} is not {wanted:?}"
        );
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let graph = sample_graphs::grid_with_hole(60);
    let build = || basis_of(&graph, 300, 16);
    let (one, three) = (in_pool(1, build), in_pool(3, build));
    let hash = |basis: &Basis| {
        let mut hasher = blake3::Hasher::new();
        for value in &basis.values {
            hasher.update(&value.to_le_bytes());
        }
        hasher.finalize().to_hex().to_string()
    };
    assert_eq!(hash(&one), hash(&three));
    // The bits of development and release builds alike, on every machine.
    assert_eq!(&hash(&one)[..16], "811b22d3d16df9b8");
}

#[test]
fn progress_is_told_and_cancelling_stops() {
    let graph = sample_graphs::boxes(20);
    let partition = parts_of(&graph, 100);
    let told = std::sync::atomic::AtomicUsize::new(0);
    let count = || {
        told.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    };
    let wanted = vec![2; partition.part_count()];
    Basis::build(&graph, &partition, &wanted, &count, &|| false).unwrap();
    assert_eq!(told.into_inner(), 20);
    let cancelled = Basis::build(&graph, &partition, &wanted, &|| {}, &|| true);
    assert_eq!(cancelled, Err(BasisError::Cancelled));
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    assert!(Basis::from_lists(vec![0, 1, 2], &[2, 1], &[1, 1], vec![0.5; 3]).is_ok());
    assert!(Basis::from_lists(vec![0, 1, 1], &[2, 1], &[1, 1], vec![0.5; 3]).is_err());
    assert!(Basis::from_lists(vec![0, 1, 3], &[2, 1], &[1, 1], vec![0.5; 3]).is_err());
    assert!(Basis::from_lists(vec![0, 1, 2], &[2, 1], &[1, 2], vec![0.5; 3]).is_err());
    assert!(Basis::from_lists(vec![0, 1, 2], &[2, 1], &[1, 1], vec![f32::NAN; 3]).is_err());
}

/// The same basis with its partitions in the opposite order.
fn renamed(basis: &Basis) -> Basis {
    let parts: Vec<u32> = (0..basis.part_count() as u32).rev().collect();
    let lists = basis.lists();
    let of_parts = |list: &[u32]| -> Vec<u32> { parts.iter().map(|&p| list[p as usize]).collect() };
    let slots = parts.iter().flat_map(|&p| basis.slot_range(p));
    let values = parts
        .iter()
        .flat_map(|&p| basis.part_values(basis.parts[p as usize]));
    Basis::from_lists(
        slots.map(|slot| basis.vertex_of_slot()[slot]).collect(),
        &of_parts(&lists.slot_counts),
        &of_parts(&lists.function_counts),
        values.copied().collect(),
    )
    .and_then(|renamed| {
        let slots = parts.iter().flat_map(|&p| basis.slot_range(p));
        renamed.with_masses(slots.map(|slot| basis.masses[slot]).collect())
    })
    .unwrap()
}

#[test]
fn renaming_partitions_changes_no_light() {
    let scene = room_with_blocks(true, 0.14, 32);
    let mut surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
    let settings = BakeSettings::of_keys(&scene.bake);
    let run = RunSettings::silent();
    let backs = surface.visible_backs(run.level);
    surface.add_backs(&backs);
    let places = Places::of(&surface, run.level);
    let basis = spectral_basis(&places, &settings, &run).unwrap();
    assert!(basis.part_count() > 4, "{} partitions", basis.part_count());
    // Bounced light of a field that is bright in one corner, by vertex.
    let corner = surface.vertices.positions()[0];
    let bright = |v: u32| {
        let distance = surface.vertices.positions()[v as usize].distance(corner);
        [1.0 / (0.05 + distance * distance); 3]
    };
    let bounced = |basis: &Basis| -> Vec<f32> {
        let importance = Importance::of(&places, &run, basis).unwrap();
        let (rows, ..) = low_rank::sampled_rows(low_rank::Task {
            surface: &surface,
            settings: &settings,
            run: &run,
            basis,
            importance: &importance,
        })
        .unwrap();
        let sent: Vec<[f32; 3]> = basis.vertex_of_slot().iter().map(|&v| bright(v)).collect();
        let arrived = rows.apply(run.level, basis, &sent);
        let slots = basis.slot_of_vertex().iter();
        slots.map(|&slot| arrived[slot as usize][0]).collect()
    };
    let (light, other) = (bounced(&basis), bounced(&renamed(&basis)));
    let mean = light.iter().sum::<f32>() / light.len() as f32;
    let worst = light.iter().zip(&other).fold(0.0_f32, |worst, (a, b)| {
        let off = (a - b).abs() / mean;
        assert!(off.is_finite(), "{a} and {b}");
        worst.at_least(off)
    });
    assert!(worst <= RENAMED, "light changes by {worst:e} of its mean");
}
