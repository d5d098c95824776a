//! Three `f64`, the coordinates of a vector: one by itself and two in lanes.

use super::pair::Pair;
use crate::math::{greater, lesser};
use core::ops::{Mul, Sub};

#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
use core::arch::x86_64::*;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
type Quarters = __m128;
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
type Quarters = u32;

/// Three numbers.
#[derive(Clone, Copy, Debug)]
pub struct Triple {
    /// The first.
    pub x: f64,
    /// The others.
    pub y_z: Pair,
}

/// Which of three numbers have a property.
#[derive(Clone, Copy, Debug)]
pub struct Which(Quarters);

impl Triple {
    /// The lesser of each two; that of `other` where one is NaN.
    #[inline(always)]
    pub fn min(self, other: Triple) -> Triple {
        Triple { x: lesser(self.x, other.x), y_z: self.y_z.min(other.y_z) }
    }
    /// The greater of each two; that of `other` where one is NaN.
    #[inline(always)]
    pub fn max(self, other: Triple) -> Triple {
        Triple { x: greater(self.x, other.x), y_z: self.y_z.max(other.y_z) }
    }
    /// The least of the three, of which none is NaN.
    #[inline(always)]
    pub fn least(self) -> f64 {
        lesser(lesser(self.y_z.high(), self.y_z.low()), self.x)
    }
    /// The greatest of the three, of which none is NaN.
    #[inline(always)]
    pub fn greatest(self) -> f64 {
        greater(greater(self.y_z.high(), self.y_z.low()), self.x)
    }
    /// Whether the three and their sum are finite.
    #[inline(always)]
    #[allow(clippy::eq_op)] // A number less itself is zero, an infinity or NaN is not.
    pub fn is_finite(self) -> bool {
        let sum = self.x + (self.y_z.high() + self.y_z.low());
        !(sum - sum).is_nan()
    }
    /// Whether one of the three, or of the other three, is NaN.
    #[inline(always)]
    pub fn is_nan(self, other: Triple) -> bool {
        self.x.is_nan() | other.x.is_nan() || self.y_z.is_nan(other.y_z)
    }
    /// Which are negative, zeros included.
    #[inline(always)]
    pub fn negative(self) -> Which {
        Which::signs(Pair::splat(self.x), self.y_z)
    }
}

#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
mod sse2 {
    use super::*;

    macro_rules! sse2 {
        ($call:expr) => {
            // SAFETY: these functions have registers for arguments, and need SSE2, which this is compiled for.
            unsafe { $call }
        };
    }

    impl Triple {
        /// Which are at least a positive limit.
        #[inline(always)]
        pub fn at_least(self, limit: f64) -> Which {
            let (limit, x) = (Pair::splat(limit).0, Pair::splat(self.x).0);
            Which::signs(Pair(sse2!(_mm_cmple_sd(limit, x))), Pair(sse2!(_mm_cmple_pd(limit, self.y_z.0))))
        }
        /// Which are at most a positive limit, or NaN.
        #[inline(always)]
        pub fn at_most(self, limit: f64) -> Which {
            let (limit, x) = (Pair::splat(limit).0, Pair::splat(self.x).0);
            Which::signs(Pair(sse2!(_mm_cmpnlt_sd(limit, x))), Pair(sse2!(_mm_cmpnlt_pd(limit, self.y_z.0))))
        }
    }

    impl Which {
        /// The upper halves of both of `x`, and of both of `y_z`.
        #[inline(always)]
        pub(super) fn signs(x: Pair, y_z: Pair) -> Which {
            Which(sse2!(_mm_shuffle_ps(_mm_castpd_ps(x.0), _mm_castpd_ps(y_z.0), 0b11_01_11_01)))
        }
        /// Those that have both properties.
        #[inline(always)]
        pub fn and(self, other: Which) -> Which {
            Which(sse2!(_mm_and_ps(self.0, other.0)))
        }
        /// As bits: 1, 4 and 8.
        #[inline(always)]
        pub fn bits(self) -> u32 {
            sse2!(_mm_movemask_ps(self.0)) as u32
        }
    }
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
mod portable {
    use super::*;

    impl Triple {
        /// Which are at least a positive limit.
        #[inline(always)]
        pub fn at_least(self, limit: f64) -> Which {
            let is = |x: f64| u32::from(x >= limit);
            Which(is(self.x) | is(self.y_z.low()) << 2 | is(self.y_z.high()) << 3)
        }
        /// Which are at most a positive limit, or NaN.
        #[inline(always)]
        pub fn at_most(self, limit: f64) -> Which {
            let is = |x: f64| u32::from(!(x > limit));
            Which(is(self.x) | is(self.y_z.low()) << 2 | is(self.y_z.high()) << 3)
        }
    }

    impl Which {
        /// The signs of the low one of `x` and of both of `y_z`.
        #[inline(always)]
        pub(super) fn signs(x: Pair, y_z: Pair) -> Which {
            Which(u32::from(x.low().is_sign_negative()) | (y_z.signs() as u32) << 2)
        }
        /// Those that have both properties.
        #[inline(always)]
        pub fn and(self, other: Which) -> Which {
            Which(self.0 & other.0)
        }
        /// As bits: 1, 4 and 8.
        #[inline(always)]
        pub fn bits(self) -> u32 {
            self.0
        }
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
