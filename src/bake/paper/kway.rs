//! METIS 5, multilevel k-way (Karypis and Kumar 1998), which the paper
//! partitions by.
//!
//! METIS draws from the C library's `rand()`, one state for the whole process:
//! calls take turns here, but other C code may draw in between, and C libraries
//! differ. So what it returns is outside relume's promise of equal bits.

use std::sync::{Mutex, PoisonError};

use ::metis::option::Seed;

use crate::bake::graph::VertexGraph;
use crate::bake::partition::Partition;

/// METIS starts `rand()` from this in every call.
const SEED: i32 = 1;

/// One call at a time.
static TURN: Mutex<()> = Mutex::new(());

/// About `part_count` parts of equal numbers of vertices, with few edges
/// between them; every edge counts alike, as in the basis. Parts need not be
/// connected.
///
/// # Errors
/// What METIS says.
pub(super) fn partition(graph: &VertexGraph, part_count: u32) -> Result<Partition, String> {
    let too_large = || "the mesh is too large for METIS".to_owned();
    let index = |number: usize| i32::try_from(number).map_err(|_| too_large());
    let (mut offsets, mut neighbours) = (vec![0], Vec::new());
    for vertex in 0..graph.vertex_count() as u32 {
        for &neighbour in graph.neighbours(vertex) {
            neighbours.push(index(neighbour as usize)?);
        }
        offsets.push(index(neighbours.len())?);
    }
    let mut labels = vec![0; graph.vertex_count()];
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    ::metis::Graph::new(1, index(part_count as usize)?, &offsets, &neighbours)
        .map_err(|error| format!("METIS refuses the mesh: {error}"))?
        .set_option(Seed(SEED))
        .part_kway(&mut labels)
        .map_err(|error| format!("METIS failed: {error}"))?;
    let labels: Vec<u32> = labels.iter().map(|&label| label as u32).collect();
    Ok(Partition::from_part_of(&labels))
}
