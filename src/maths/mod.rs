//! Deterministic mathematics: elementary functions with the same bits on every
//! machine, hashes in place of random number generators, low-discrepancy
//! points, and the warps that turn them into directions and surface points.

pub(crate) mod cube_cells;
pub(crate) mod functions;
pub(crate) mod hash;
pub(crate) mod order;
pub(crate) mod sampling;
pub(crate) mod sobol;
