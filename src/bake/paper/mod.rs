//! The published scheme, as a yardstick for relume's own: `--scheme paper`.
//!
//! Wang, Zhu and Humphreys, "Precomputed Radiance Transfer for Real-Time
//! Indirect Lighting using A Spectral Mesh Basis", EGSR 2007. It differs from
//! relume's scheme in how the transfer is represented, not in the physics: the
//! rows are sampled by the same rays and have the same sides.
//!
//! | what | as published | where |
//! |---|---|---|
//! | partitions | METIS, k-way, of 500 to 1,000 vertices | 3.3, table 1 |
//! | functions | 1,024 in all, shared equally | section 4, figure 6 |
//! | basis | eigenvectors of the graph's Laplacian, every edge alike | 3.1 |
//! | rows of T | projected on the basis, nothing added or corrected | 3.2 |
//! | kept | 60 to 100 elements a vertex | 3.3, table 1 |
//! | stored | quantised; what becomes zero is left out | 3.3 |
//!
//! The text that we have lacks the part of section 3.3 on how elements are
//! chosen and quantised; its end is left ("truncating all elements that are
//! quantized to zero", "on average we keep only 60 to 100 elements per vertex").
//! The plainest reading: of every vertex at most the `bake.coefficients` largest
//! |c| are kept; all are quantised to 8 bits with one step for the whole scene;
//! and what that quantises to zero is left out. How the step is chosen, nobody
//! says. One that makes the largest element 127 leaves 38 elements a vertex in
//! the Cornell box of `scenes/` (66 a vertex that sees anything: the paper's
//! numbers), but 18 in `scenes/window`, whose small pieces have large elements:
//! 28 % of error at any limit from 40 to 100. So the benefit of the doubt: from
//! that step down to a 128th of it, the one with which the table answers constant
//! light best; larger elements are clipped to 127. (Those figures are of an earlier mesh.
//! By METIS on that of today, `window` has 57 % by the clipped step, suns and skies 120
//! to 220 and lamps 8 to 14, and 10 % with nothing cut; relume's partitions, each in one
//! piece, leave 17 % within 160 bytes a vertex. The plain step was not tried again.)
//!
//! Other readings and deviations:
//! - Partitions have 500 vertices below [`SMALL_SCENE`] vertices and 1,000 from
//!   there on: table 1 has 500 for 4 and 7 thousand vertices, 1,000 from 25
//!   thousand on. Back sides count as vertices.
//! - Functions are equally many in every partition (section 4 gives the sum
//!   alone); where a partition has too few vertices for its share, the others
//!   take the rest, and a cluster of equal eigenvalues is never cut.
//! - The Laplacian is D - A. The paper prints I - D^-1 A, which is not symmetric
//!   and has no orthonormal eigenvectors, and calls it that of the binary
//!   adjacency matrix.
//! - The transfer has its 1/pi and areas, which equation 1 lacks.
//! - The light of the sky, which the paper leaves out, is stored as in relume's
//!   scheme.
//! - The glossy final bounce (equations 5 and 6) has no part here.

#[cfg(feature = "metis")]
mod kway;
mod rows;
mod sampled;
#[cfg(test)]
mod tests;

pub(crate) use rows::PaperRows;
pub(super) use sampled::sampled_rows;

use super::BakeError;
use super::function_shares::functions_by_share;
use super::graph::VertexGraph;
use super::partition::Partition;

/// Functions in all (section 4: more gain little).
pub(super) const FUNCTIONS: u32 = 1024;
/// Most coefficients a vertex: the upper end of "60 to 100". Table 1 has means
/// of 62, 63, 66 and 85 for diffuse scenes, and so have ours once what is
/// quantised to zero is left out.
pub(super) const COEFFICIENTS: u32 = 100;
/// Scenes of fewer vertices are small.
const SMALL_SCENE: usize = 10_000;
/// Vertices a partition of small scenes and of others (table 1).
const PART_SIZES: [u32; 2] = [500, 1000];

/// Vertices a partition in a scene of so many.
pub(super) fn vertices_per_part(vertex_count: usize) -> u32 {
    PART_SIZES[usize::from(vertex_count >= SMALL_SCENE)]
}

/// `total` functions shared equally among parts of so many vertices.
pub(super) fn equal_functions(sizes: &[usize], total: u32) -> Vec<u32> {
    functions_by_share(&vec![1.0; sizes.len()], sizes, total)
}

/// Partitions by METIS. A part may be in pieces, and holds small components
/// together: its Laplacian has the eigenvectors of the pieces, of each in
/// proportion to its size, since eigenvalues thin out with the size.
///
/// # Errors
/// When METIS fails.
#[cfg(feature = "metis")]
pub(super) fn partition(
    graph: &VertexGraph,
    vertices_per_part: u32,
) -> Result<Partition, BakeError> {
    let per_part = vertices_per_part as usize;
    let parts = ((graph.vertex_count() + per_part / 2) / per_part).max(1);
    kway::partition(graph, parts as u32).map_err(BakeError::Basis)
}

/// Partitions by relume's own partitioner, for want of METIS; every part is one
/// piece, so that small components are parts by themselves.
///
/// # Errors
/// None; METIS has some.
#[cfg(not(feature = "metis"))]
pub(super) fn partition(
    graph: &VertexGraph,
    vertices_per_part: u32,
) -> Result<Partition, BakeError> {
    Ok(super::own_partition(graph, vertices_per_part))
}
