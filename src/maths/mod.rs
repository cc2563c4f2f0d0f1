//! Deterministic mathematics: elementary functions with the same bits on every
//! machine, hashes in place of random number generators, low-discrepancy
//! points, the warps that turn them into directions and surface points, spherical
//! harmonics, small systems of equations, fields of three channels.

pub(crate) mod cube_cells;
pub(crate) mod dense_solve;
pub(crate) mod functions;
pub(crate) mod hash;
pub(crate) mod order;
pub(crate) mod rgb_fields;
pub(crate) mod sampling;
pub(crate) mod sobol;
pub(crate) mod spherical_harmonics;
