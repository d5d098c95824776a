//! Where a line crosses three pairs of planes, in lanes: those of two numbers that every x86-64 processor has, or of four.
//!
//! Each lane rounds as a number by itself does. The two kinds differ in nothing but the signs of zeros and in what they make
//! of NaN, of which [`SlabLanes::are_doubtful`] warns.

use super::pair::Pair;
use super::{Level, level, level::is_avx2};
use crate::math::{greater, lesser};
use crate::{Hit, Interval, Ray};
use core::ops::{Mul, Sub};

/// The lower planes across x, x, y and z, and the upper ones.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Planes(pub [[f64; 4]; 2]);

/// The parameters of a line at three pairs of planes: differences times the inverse of the direction.
pub trait SlabLanes: Copy {
    /// Where this line crosses these planes. Along a zero of the direction all parameters are infinite, or NaN within a plane.
    fn new(planes: &Planes, ray: &Ray) -> Self;
    /// The greatest parameter of those where the line enters a pair, and the least where it leaves one: of all three pairs,
    /// or, where some are NaN, of others only, or NaN.
    fn ends(&self) -> (f64, f64);
    /// The pairs that are entered later than `steps` numbers before the last one, which is positive, where nothing is in doubt:
    /// 3, 4 and 8 stand for those across x, y and z.
    fn entered(&self, steps: i64) -> usize;
    /// The pairs that are left sooner than `steps` numbers after the first one, which is positive, where nothing is in doubt.
    fn left(&self, steps: i64) -> usize;
    /// Along which axes the direction goes back: 1, 2 and 4.
    fn back(&self) -> usize;
    /// Whether a direction is subnormal, so that its inverse may say infinity too soon, or a parameter NaN.
    fn are_doubtful(&self) -> bool;
}

/// What is found with [`SlabLanes`], whatever their lanes.
pub trait Clipped {
    /// Implement it with `#[inline(always)]`: it is then compiled once for each kind of lanes.
    fn clipped<S: SlabLanes>(&self, ray: &Ray, within: Interval) -> Option<Hit>;
}

/// Finds it with the widest lanes of the level in use.
#[inline(always)]
pub fn clip<C: Clipped>(shape: &C, ray: &Ray, within: Interval) -> Option<Hit> {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if is_avx2() {
        // SAFETY: the level is Avx2 only after run-time detection of all that `wide::hit` names.
        return unsafe { wide::hit(shape, ray, within.min, within.max) };
    }
    let _ = is_avx2;
    clip_otherwise(shape, ray, within)
}

/// Without AVX2, or before it is known whether there is any.
#[inline(never)]
fn clip_otherwise<C: Clipped>(shape: &C, ray: &Ray, within: Interval) -> Option<Hit> {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if level() >= Level::Avx2 {
        // SAFETY: as above.
        return unsafe { wide::hit(shape, ray, within.min, within.max) };
    }
    let _ = (level, Level::Avx2);
    shape.clipped::<PairedSlabs>(ray, within)
}

/// Three numbers: one by itself and two in lanes.
#[derive(Clone, Copy, Debug)]
struct Triple {
    x: f64,
    y_z: Pair,
}

impl Triple {
    #[inline(always)]
    fn new([_, x, y, z]: [f64; 4]) -> Triple {
        Triple { x, y_z: Pair::new(y, z) }
    }
    /// The lesser of each two; that of `other` where one is NaN.
    #[inline(always)]
    fn min(self, other: Triple) -> Triple {
        Triple { x: lesser(self.x, other.x), y_z: self.y_z.min(other.y_z) }
    }
    /// The greater of each two; that of `other` where one is NaN.
    #[inline(always)]
    fn max(self, other: Triple) -> Triple {
        Triple { x: greater(self.x, other.x), y_z: self.y_z.max(other.y_z) }
    }
    /// The least of the three, of which none is NaN.
    #[inline(always)]
    fn least(self) -> f64 {
        lesser(lesser(self.y_z.high(), self.y_z.low()), self.x)
    }
    /// The greatest of the three, of which none is NaN.
    #[inline(always)]
    fn greatest(self) -> f64 {
        greater(greater(self.y_z.high(), self.y_z.low()), self.x)
    }
    /// For which of the three, as bits 1, 2 and 4.
    #[inline(always)]
    fn which(self, is: impl Fn(f64) -> bool) -> usize {
        usize::from(is(self.x)) | usize::from(is(self.y_z.low())) << 1 | usize::from(is(self.y_z.high())) << 2
    }
}

impl Sub for Triple {
    type Output = Triple;
    #[inline(always)]
    fn sub(self, other: Triple) -> Triple {
        Triple { x: self.x - other.x, y_z: self.y_z - other.y_z }
    }
}

impl Mul for Triple {
    type Output = Triple;
    #[inline(always)]
    fn mul(self, other: Triple) -> Triple {
        Triple { x: self.x * other.x, y_z: self.y_z * other.y_z }
    }
}

/// As every machine has them.
#[derive(Clone, Copy, Debug)]
pub struct PairedSlabs {
    lower: Triple,
    upper: Triple,
    direction: Triple,
}

impl PairedSlabs {
    #[inline(always)]
    fn near(&self) -> Triple {
        self.lower.min(self.upper)
    }
    #[inline(always)]
    fn far(&self) -> Triple {
        self.lower.max(self.upper)
    }
    /// Those for which this holds, the first one twice.
    #[inline(always)]
    fn pairs(at: usize) -> usize {
        at << 1 | (at & 1)
    }
}

impl SlabLanes for PairedSlabs {
    #[inline(always)]
    fn new(planes: &Planes, ray: &Ray) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        // Differences and inverses with the other sign: the origin is read once.
        let backward = Triple { x: -1.0 / d.x, y_z: Pair::splat(-1.0) / Pair::new(d.y, d.z) };
        let start = Triple { x: o.x, y_z: Pair::new(o.y, o.z) };
        let [lower, upper] = planes.0.map(Triple::new);
        let direction = Triple { x: d.x, y_z: Pair::new(d.y, d.z) };
        PairedSlabs { lower: (start - lower) * backward, upper: (start - upper) * backward, direction }
    }
    #[inline(always)]
    fn ends(&self) -> (f64, f64) {
        (self.near().greatest(), self.far().least())
    }
    #[inline(always)]
    fn entered(&self, steps: i64) -> usize {
        let limit = self.near().greatest().to_bits() as i64 - steps;
        PairedSlabs::pairs(self.near().which(|t| t.to_bits() as i64 > limit))
    }
    #[inline(always)]
    fn left(&self, steps: i64) -> usize {
        let limit = self.far().least().to_bits() as i64 + steps;
        PairedSlabs::pairs(self.far().which(|t| limit > t.to_bits() as i64))
    }
    #[inline(always)]
    fn are_doubtful(&self) -> bool {
        // Subnormal numbers have the bits from 1 to 2^52 - 1, and their sign; zero is the last in this order.
        let is_subnormal = |d: f64| (d.to_bits() << 1).wrapping_sub(1) < (1 << 53) - 1;
        let parameters = self.lower.which(f64::is_nan) | self.upper.which(f64::is_nan);
        self.direction.which(is_subnormal) | parameters != 0
    }
    #[inline(always)]
    fn back(&self) -> usize {
        self.direction.which(f64::is_sign_negative)
    }
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
pub(super) mod wide {
    //! Four lanes with AVX2: x twice, y and z.
    use super::*;
    use core::arch::x86_64::*;

    macro_rules! avx2 {
        ($call:expr) => {
            // SAFETY: a `WideSlabs` is made and used in `hit` only, after AVX2 was detected; loads are of arrays that are
            // large enough.
            unsafe { $call }
        };
    }

    /// Finds it with AVX2. The interval travels in registers.
    ///
    /// # Safety
    /// The machine must have AVX2, BMI1 and BMI2.
    #[target_feature(enable = "avx2,bmi1,bmi2")]
    pub(super) fn hit<C: Clipped>(shape: &C, ray: &Ray, min: f64, max: f64) -> Option<Hit> {
        shape.clipped::<WideSlabs>(ray, Interval { min, max })
    }

    /// With AVX2: made inside [`hit`] only.
    #[derive(Clone, Copy, Debug)]
    pub struct WideSlabs {
        near: __m256d,
        far: __m256d,
        direction: __m256d,
    }

    /// `[x, x, y, z]`, in pieces as it may just have been written.
    #[inline(always)]
    fn load([x, y_z @ ..]: &[f64; 3]) -> __m256d {
        let x = avx2!(_mm256_castpd128_pd256(_mm_loaddup_pd(x)));
        avx2!(_mm256_insertf128_pd(x, _mm_loadu_pd(y_z.as_ptr()), 1))
    }

    impl WideSlabs {
        /// The greatest of those entered, in all lanes.
        #[inline(always)]
        fn entry(&self) -> __m256d {
            let two = avx2!(_mm256_max_pd(self.near, _mm256_permute2f128_pd(self.near, self.near, 1)));
            avx2!(_mm256_max_pd(two, _mm256_permute_pd(two, 0b0101)))
        }
        /// The least of those left, in all lanes.
        #[inline(always)]
        fn exit(&self) -> __m256d {
            let two = avx2!(_mm256_min_pd(self.far, _mm256_permute2f128_pd(self.far, self.far, 1)));
            avx2!(_mm256_min_pd(two, _mm256_permute_pd(two, 0b0101)))
        }
        #[inline(always)]
        fn doubts(&self) -> __m256d {
            // The bits of a size less one: of a subnormal number those of one that is less than this, of zero those of a NaN.
            const LEAST: f64 = f64::from_bits((1 << 52) - 1);
            let size = avx2!(_mm256_castpd_si256(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.direction)));
            let less = avx2!(_mm256_castsi256_pd(_mm256_add_epi64(size, _mm256_set1_epi64x(-1))));
            let subnormal = avx2!(_mm256_cmp_pd(less, _mm256_set1_pd(LEAST), _CMP_LT_OQ));
            avx2!(_mm256_or_pd(subnormal, _mm256_cmp_pd(self.near, self.far, _CMP_UNORD_Q)))
        }
    }

    impl SlabLanes for WideSlabs {
        #[inline(always)]
        fn new(planes: &Planes, ray: &Ray) -> Self {
            let (start, direction) = (load(ray.origin.as_ref()), load(ray.direction.as_ref()));
            let backward = avx2!(_mm256_div_pd(_mm256_set1_pd(-1.0), direction));
            let [lower, upper] = &planes.0;
            let (lower, upper) =
                (avx2!(_mm256_load_pd(lower.as_ptr())), avx2!(_mm256_load_pd(upper.as_ptr())));
            // Which of two planes comes first is known before the division has ended.
            let first = avx2!(_mm256_blendv_pd(lower, upper, direction));
            let last = avx2!(_mm256_blendv_pd(upper, lower, direction));
            let near = avx2!(_mm256_mul_pd(_mm256_sub_pd(start, first), backward));
            let far = avx2!(_mm256_mul_pd(_mm256_sub_pd(start, last), backward));
            WideSlabs { near, far, direction }
        }
        #[inline(always)]
        fn ends(&self) -> (f64, f64) {
            (avx2!(_mm256_cvtsd_f64(self.entry())), avx2!(_mm256_cvtsd_f64(self.exit())))
        }
        #[inline(always)]
        fn entered(&self, steps: i64) -> usize {
            let near = avx2!(_mm256_castpd_si256(self.near));
            let last = avx2!(_mm256_castpd_si256(self.entry()));
            let limit = avx2!(_mm256_sub_epi64(last, _mm256_set1_epi64x(steps)));
            avx2!(_mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(near, limit)))) as usize
        }
        #[inline(always)]
        fn left(&self, steps: i64) -> usize {
            let far = avx2!(_mm256_castpd_si256(self.far));
            let first = avx2!(_mm256_castpd_si256(self.exit()));
            let limit = avx2!(_mm256_add_epi64(first, _mm256_set1_epi64x(steps)));
            avx2!(_mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(limit, far)))) as usize
        }
        #[inline(always)]
        fn are_doubtful(&self) -> bool {
            avx2!(_mm256_movemask_pd(self.doubts())) != 0
        }
        #[inline(always)]
        fn back(&self) -> usize {
            avx2!(_mm256_movemask_pd(self.direction)) as usize >> 1
        }
    }
}
