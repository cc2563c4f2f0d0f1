//! The laboratory's table of knobs: what a bake of a variant does otherwise.

use std::sync::RwLock;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Operator {
    Combinatorial,
    /// Combinatorial with the areas as masses of the eigenproblem.
    CombinatorialArea,
    /// Cotangent weights and areas as masses.
    Cotangent,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Masses {
    One,
    Area,
    Bounce,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Share {
    Area,
    Vertices,
    RootOfBoth,
    Bounce,
    RootOfBounce,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Knobs {
    pub(crate) laplacian: Operator,
    pub(crate) masses: Masses,
    pub(crate) least_mass: f64,
    pub(crate) share: Share,
    pub(crate) near_share: f64,
    /// One threshold on area x T^2 for the scene; with at most so many times
    /// the mean a group. 0: the same for all.
    pub(crate) near_most: f64,
    pub(crate) sparse: bool,
    pub(crate) equal_rank: bool,
    pub(crate) constant: bool,
    pub(crate) smoothing: bool,
    pub(crate) leave_noise: bool,
    pub(crate) function_threshold: f64,
    /// Rays by area to this power.
    pub(crate) rays_power: f64,
    pub(crate) rays_most: f64,
}

pub(crate) const DEFAULT: Knobs = Knobs {
    laplacian: Operator::Combinatorial,
    masses: Masses::Bounce,
    least_mass: 0.02,
    share: Share::RootOfBounce,
    near_share: 0.4,
    near_most: 4.0,
    sparse: false,
    equal_rank: false,
    constant: true,
    smoothing: true,
    leave_noise: true,
    function_threshold: 4.0,
    rays_power: 0.0,
    rays_most: 2.0,
};

static NOW: RwLock<Knobs> = RwLock::new(DEFAULT);

pub(crate) fn now() -> Knobs {
    *NOW.read().expect("no variant panics")
}

pub(crate) fn set(knobs: Knobs) {
    *NOW.write().expect("no variant panics") = knobs;
}
