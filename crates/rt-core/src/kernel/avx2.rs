//! Eight lanes with AVX2 and FMA.
#![cfg(all(target_arch = "x86_64", feature = "std"))]

use super::{Lanes, Vectorized};
use core::arch::x86_64::*;

/// Eight lanes in one register. Made in [`run`] only, after AVX2 and FMA were detected.
#[derive(Clone, Copy, Debug)]
pub struct Avx2Lanes(());

/// Runs the computation with AVX2.
///
/// # Safety
/// The machine must have AVX2, FMA, BMI1, BMI2 and LZCNT.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
pub(super) fn run<V: Vectorized>(task: V) -> V::Output {
    task.run(Avx2Lanes(()))
}

// SAFETY of every intrinsic below: a value of `Avx2Lanes` exists only inside `run`, whose callers have detected
// AVX2 and FMA. The loads and stores are unaligned ones on references to arrays of the right size.
impl Lanes for Avx2Lanes {
    type F = __m256;
    const FUSED: bool = true;
    #[inline(always)]
    fn splat(self, x: f32) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_set1_ps(x) }
    }
    #[inline(always)]
    fn load(self, from: &[f32; 8]) -> __m256 {
        // SAFETY: `self` proves AVX2; the pointer comes from a reference to eight f32.
        unsafe { _mm256_loadu_ps(from.as_ptr()) }
    }
    #[inline(always)]
    fn store(self, x: __m256) -> [f32; 8] {
        let mut to = [0.0; 8];
        // SAFETY: `self` proves AVX2; the pointer comes from an array of eight f32.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x) };
        to
    }
    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    fn mul_sub(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        // SAFETY: `self` proves FMA.
        unsafe { _mm256_fmsub_ps(a, b, c) }
    }
    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_max_ps(a, b) }
    }
    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_min_ps(a, b) }
    }
    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> u32 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32 }
    }
    #[inline(always)]
    fn prefetch<T>(self, value: &T) {
        let start = (value as *const T).cast::<i8>();
        for line in 0..core::mem::size_of::<T>().div_ceil(64).min(4) {
            // SAFETY: a prefetch never faults; the address lies within `value`.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(64 * line)) }
        }
    }
}
