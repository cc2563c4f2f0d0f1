//! Numbers that kernels are written over: one `f32`, or eight of them.
//!
//! Every operation acts on each lane alone and rounds once, so all
//! implementations give the same bits. Multiply-add is never fused.

/// Real numbers, lane by lane.
pub(super) trait Real: Copy {
    /// The same number in every lane.
    fn splat(value: f32) -> Self;
    /// `self - other`.
    fn sub(self, other: Self) -> Self;
    /// `self * other`.
    fn mul(self, other: Self) -> Self;
    /// `if self < other { self } else { other }`, which is `minps`: of equal
    /// numbers (0 and -0) or where one is NaN, the second.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`, which is `maxps`.
    fn max(self, other: Self) -> Self;
}

/// Eight real numbers.
pub(super) trait Lanes: Real {
    fn load(values: &[f32; 8]) -> Self;
    fn store(self) -> [f32; 8];
    /// Bit i is set where `self <= other` in lane i.
    fn le_mask(self, other: Self) -> u32;
}

impl Real for f32 {
    #[inline(always)]
    fn splat(value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn sub(self, other: f32) -> f32 {
        self - other
    }

    #[inline(always)]
    fn mul(self, other: f32) -> f32 {
        self * other
    }

    #[inline(always)]
    fn min(self, other: f32) -> f32 {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: f32) -> f32 {
        if self > other { self } else { other }
    }
}

/// Eight lanes as an array: the definition, and the path of processors that
/// have no other.
#[derive(Clone, Copy)]
pub(super) struct ScalarLanes([f32; 8]);

impl ScalarLanes {
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| operation(self.0[i], other.0[i])))
    }
}

impl Real for ScalarLanes {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([value; 8])
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, <f32 as Real>::sub)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, <f32 as Real>::mul)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, <f32 as Real>::min)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, <f32 as Real>::max)
    }
}

impl Lanes for ScalarLanes {
    #[inline(always)]
    fn load(values: &[f32; 8]) -> Self {
        Self(*values)
    }

    #[inline(always)]
    fn store(self) -> [f32; 8] {
        self.0
    }

    #[inline(always)]
    fn le_mask(self, other: Self) -> u32 {
        (0..8).fold(0, |mask, i| {
            mask | (u32::from(self.0[i] <= other.0[i]) << i)
        })
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2Lanes, Sse2Lanes};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Lanes, Real};
    use std::arch::x86_64::*;

    /// Two registers of four lanes. SSE2 belongs to every x86-64, so all of
    /// its intrinsics may always be called.
    #[derive(Clone, Copy)]
    pub(in crate::simd) struct Sse2Lanes(__m128, __m128);

    impl Real for Sse2Lanes {
        #[inline(always)]
        fn splat(value: f32) -> Self {
            // SAFETY: x86-64 has SSE2.
            let four = unsafe { _mm_set1_ps(value) };
            Self(four, four)
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: x86-64 has SSE2.
            let low = unsafe { _mm_sub_ps(self.0, other.0) };
            // SAFETY: x86-64 has SSE2.
            let high = unsafe { _mm_sub_ps(self.1, other.1) };
            Self(low, high)
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: x86-64 has SSE2.
            let low = unsafe { _mm_mul_ps(self.0, other.0) };
            // SAFETY: x86-64 has SSE2.
            let high = unsafe { _mm_mul_ps(self.1, other.1) };
            Self(low, high)
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: x86-64 has SSE2.
            let low = unsafe { _mm_min_ps(self.0, other.0) };
            // SAFETY: x86-64 has SSE2.
            let high = unsafe { _mm_min_ps(self.1, other.1) };
            Self(low, high)
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: x86-64 has SSE2.
            let low = unsafe { _mm_max_ps(self.0, other.0) };
            // SAFETY: x86-64 has SSE2.
            let high = unsafe { _mm_max_ps(self.1, other.1) };
            Self(low, high)
        }
    }

    impl Lanes for Sse2Lanes {
        #[inline(always)]
        fn load(values: &[f32; 8]) -> Self {
            let (low, high) = values.split_at(4);
            // SAFETY: `low` holds four floats, and the load needs no alignment.
            let low = unsafe { _mm_loadu_ps(low.as_ptr()) };
            // SAFETY: `high` holds four floats, and the load needs no alignment.
            let high = unsafe { _mm_loadu_ps(high.as_ptr()) };
            Self(low, high)
        }

        #[inline(always)]
        fn store(self) -> [f32; 8] {
            let mut values = [0.0; 8];
            let (low, high) = values.split_at_mut(4);
            // SAFETY: `low` has room for four floats, without alignment.
            unsafe { _mm_storeu_ps(low.as_mut_ptr(), self.0) };
            // SAFETY: `high` has room for four floats, without alignment.
            unsafe { _mm_storeu_ps(high.as_mut_ptr(), self.1) };
            values
        }

        #[inline(always)]
        fn le_mask(self, other: Self) -> u32 {
            // SAFETY: x86-64 has SSE2.
            let low = unsafe { _mm_cmple_ps(self.0, other.0) };
            // SAFETY: x86-64 has SSE2.
            let high = unsafe { _mm_cmple_ps(self.1, other.1) };
            // SAFETY: x86-64 has SSE2.
            let low = unsafe { _mm_movemask_ps(low) };
            // SAFETY: x86-64 has SSE2.
            let high = unsafe { _mm_movemask_ps(high) };
            (low | (high << 4)) as u32
        }
    }

    /// One register of eight lanes. Only functions of this room that carry
    /// `#[target_feature(enable = "avx2")]` may name this type: they are entered
    /// after `Level::available` said that the processor has AVX2.
    #[derive(Clone, Copy)]
    pub(in crate::simd) struct Avx2Lanes(__m256);

    impl Real for Avx2Lanes {
        #[inline(always)]
        fn splat(value: f32) -> Self {
            // SAFETY: the type is only named where AVX2 was found.
            Self(unsafe { _mm256_set1_ps(value) })
        }

        #[inline(always)]
        fn sub(self, other: Self) -> Self {
            // SAFETY: the type is only named where AVX2 was found.
            Self(unsafe { _mm256_sub_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn mul(self, other: Self) -> Self {
            // SAFETY: the type is only named where AVX2 was found.
            Self(unsafe { _mm256_mul_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: the type is only named where AVX2 was found.
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: the type is only named where AVX2 was found.
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }
    }

    impl Lanes for Avx2Lanes {
        #[inline(always)]
        fn load(values: &[f32; 8]) -> Self {
            // SAFETY: AVX2 was found, eight floats are there, no alignment needed.
            Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> [f32; 8] {
            let mut values = [0.0; 8];
            // SAFETY: AVX2 was found, eight floats have room, no alignment needed.
            unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) };
            values
        }

        #[inline(always)]
        fn le_mask(self, other: Self) -> u32 {
            // SAFETY: the type is only named where AVX2 was found.
            let lanes = unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) };
            // SAFETY: the type is only named where AVX2 was found.
            let mask = unsafe { _mm256_movemask_ps(lanes) };
            mask as u32
        }
    }
}
