//! Eight lanes with AVX2 and FMA.
#![cfg(all(target_arch = "x86_64", feature = "std"))]

use super::lanes::{EXPONENT, LEAST};
use super::{Lanes, Vectorized};
use core::arch::x86_64::*;

/// Eight lanes in one register. Made in [`run`] only, after AVX2 and FMA were detected.
#[derive(Clone, Copy, Debug)]
pub struct Avx2Lanes(());

/// Runs the computation with AVX2.
///
/// # Safety
/// The machine must have AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn run<V: Vectorized>(task: V) -> V::Output {
    task.run(Avx2Lanes(()))
}

/// Where the halves of the lanes of a mask are, then those of lane 0.
const PACKED: [[i32; 8]; 16] = {
    let mut all = [[0; 8]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut lane, mut count) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 == 1 {
                all[mask][2 * count] = 2 * lane;
                all[mask][2 * count + 1] = 2 * lane + 1;
                count += 1;
            }
            lane += 1;
        }
        while count < 4 {
            all[mask][2 * count + 1] = 1;
            count += 1;
        }
        mask += 1;
    }
    all
};

// SAFETY of every intrinsic below: a value of `Avx2Lanes` exists only inside `run`, whose callers have detected
// AVX2 and FMA. The loads and stores are unaligned ones on references to arrays of the right size.
impl Lanes for Avx2Lanes {
    type F = __m256;
    type D = __m256d;
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
    fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
        // SAFETY: `self` proves FMA.
        unsafe { _mm256_fmadd_ps(a, b, c) }
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
    fn all_le<const N: usize>(self, pairs: [(__m256, __m256); N]) -> u32 {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let mut all = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
            // No iterator: one that is not inlined is compiled without the instruction set.
            let mut i = 0;
            while i < N {
                all = _mm256_and_ps(all, _mm256_cmp_ps::<_CMP_LE_OQ>(pairs[i].0, pairs[i].1));
                i += 1;
            }
            _mm256_movemask_ps(all) as u32
        }
    }
    #[inline(always)]
    fn positive_max(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
    }
    #[inline(always)]
    fn positive_min(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
    }
    #[inline(always)]
    fn positive_lt(self, a: __m256, b: __m256) -> u32 {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let less = _mm256_cmpgt_epi32(_mm256_castps_si256(b), _mm256_castps_si256(a));
            _mm256_movemask_ps(_mm256_castsi256_ps(less)) as u32
        }
    }
    #[inline(always)]
    fn large(self, numbers: [u32; 8]) -> u32 {
        // SAFETY: `self` proves AVX2; the pointer comes from an array of eight u32.
        unsafe { _mm256_movemask_ps(_mm256_loadu_ps(numbers.as_ptr().cast())) as u32 }
    }
    #[inline(always)]
    fn inverse(self, a: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let sign = _mm256_set1_ps(-0.0);
            let size = _mm256_max_ps(_mm256_andnot_ps(sign, a), _mm256_set1_ps(LEAST));
            _mm256_div_ps(_mm256_set1_ps(1.0), _mm256_or_ps(size, _mm256_and_ps(sign, a)))
        }
    }
    #[inline(always)]
    fn least(self, a: __m256) -> f32 {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let a = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let a = _mm_min_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_min_ss(a, _mm_movehdup_ps(a)))
        }
    }
    #[inline(always)]
    fn greatest(self, a: __m256) -> f32 {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let a = _mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let a = _mm_max_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_max_ss(a, _mm_movehdup_ps(a)))
        }
    }
    #[inline(always)]
    fn splat4(self, x: f64) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_set1_pd(x) }
    }
    #[inline(always)]
    fn load4(self, [a, b, c, d]: [f64; 4]) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_setr_pd(a, b, c, d) }
    }
    #[inline(always)]
    fn store4(self, x: __m256d) -> [f64; 4] {
        let mut to = [0.0; 4];
        // SAFETY: `self` proves AVX2; the pointer comes from an array of four f64.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), x) };
        to
    }
    #[inline(always)]
    fn round4(self, x: __m256d) -> [f32; 4] {
        let mut to = [0.0; 4];
        // SAFETY: `self` proves AVX2; the pointer comes from an array of four f32.
        unsafe { _mm_storeu_ps(to.as_mut_ptr(), _mm256_cvtpd_ps(x)) };
        to
    }
    #[inline(always)]
    fn add4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_add_pd(a, b) }
    }
    #[inline(always)]
    fn sub4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_sub_pd(a, b) }
    }
    #[inline(always)]
    fn mul4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_mul_pd(a, b) }
    }
    #[inline(always)]
    fn div4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_div_pd(a, b) }
    }
    #[inline(always)]
    fn neg4(self, a: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_xor_pd(_mm256_set1_pd(-0.0), a) }
    }
    #[inline(always)]
    fn sqrt4(self, a: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_sqrt_pd(a) }
    }
    #[inline(always)]
    fn two_product4(self, a: __m256d, b: __m256d) -> (__m256d, __m256d) {
        let p = self.mul4(a, b);
        // SAFETY: `self` proves FMA.
        (p, unsafe { _mm256_fmsub_pd(a, b, p) })
    }
    #[inline(always)]
    fn if_less4(self, a: __m256d, b: __m256d, then: __m256d, otherwise: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_blendv_pd(otherwise, then, _mm256_cmp_pd::<_CMP_LT_OQ>(a, b)) }
    }
    #[inline(always)]
    fn if_at_most4(self, a: __m256d, b: __m256d, then: __m256d, otherwise: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_blendv_pd(otherwise, then, _mm256_cmp_pd::<_CMP_LE_OQ>(a, b)) }
    }
    #[inline(always)]
    fn max4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_max_pd(a, b) }
    }
    #[inline(always)]
    fn min4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_min_pd(a, b) }
    }
    #[inline(always)]
    fn abs4(self, a: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), a) }
    }
    #[inline(always)]
    fn copy_sign4(self, a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            _mm256_or_pd(_mm256_andnot_pd(sign, a), _mm256_and_pd(sign, b))
        }
    }
    #[inline(always)]
    fn signs4(self, a: __m256d) -> u32 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_movemask_pd(a) as u32 }
    }
    #[inline(always)]
    fn binade4(self, a: __m256d) -> __m256d {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_and_pd(a, _mm256_set1_pd(f64::from_bits(EXPONENT))) }
    }
    #[inline(always)]
    fn whole4(self, a: __m256d) -> [u32; 4] {
        let mut to = [0; 4];
        // SAFETY: `self` proves AVX2; the pointer comes from an array of four u32.
        unsafe { _mm_storeu_si128(to.as_mut_ptr().cast(), _mm256_cvttpd_epi32(a)) };
        to
    }
    #[inline(always)]
    fn pack4(self, a: __m256d, mask: u32) -> __m256d {
        let order = &PACKED[mask as usize & 15];
        // SAFETY: `self` proves AVX2; the pointer comes from a reference to eight i32.
        unsafe {
            let order = _mm256_loadu_si256(order.as_ptr().cast());
            _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(a), order))
        }
    }
    #[inline(always)]
    fn le4(self, a: __m256d, b: __m256d) -> u32 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(a, b)) as u32 }
    }
    #[inline(always)]
    fn lt4(self, a: __m256d, b: __m256d) -> u32 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b)) as u32 }
    }
    #[inline(always)]
    fn prefetch<T>(self, value: &T) {
        super::prefetch(value);
    }
}
