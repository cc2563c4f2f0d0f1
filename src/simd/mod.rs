//! Kernels for several numbers at a time: the only room with `unsafe`.
//!
//! In come plain slices, out go plain slices, and the bits are the same at
//! every [`Level`]: a kernel is written once over the traits of `lanes`, whose
//! scalar implementation is its definition. A job enters its instruction set
//! once (`#[target_feature]` on the outermost function, everything below is
//! `#[inline(always)]`).
#![allow(
    unsafe_code,
    reason = "vendor intrinsics are unsafe to call; no other room may use them"
)]

pub(crate) mod block;
mod lanes;
pub(crate) mod lists;
pub(crate) mod ray;
pub(crate) mod rows;
mod traverse;
pub(crate) mod triangle;

pub(crate) use ray::{Hit, Ray};
pub(crate) use traverse::{CHILDREN, LEAF, WideNode, WideTree};
pub(crate) use triangle::Corners;

/// Instruction set of the kernels. It changes the speed, never the bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Eight lanes as an array; the definition of every kernel.
    Scalar,
    /// Two registers of four lanes; every x86-64 has it.
    Sse2,
    /// One register of eight lanes.
    Avx2,
}

impl Level {
    /// The best level of this processor. The standard library looks it up once
    /// and keeps the answer, so a call is a load and a comparison.
    #[inline]
    pub fn detect() -> Level {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx2") {
                return Level::Avx2;
            }
            Level::Sse2
        }
        #[cfg(not(target_arch = "x86_64"))]
        Level::Scalar
    }

    /// This level, or the best one of this processor where it lacks this one.
    /// Every kernel passes through here before it enters an instruction set,
    /// which makes a `Level` sound whoever made it.
    #[inline]
    pub fn available(self) -> Level {
        self.min(Level::detect())
    }
}
