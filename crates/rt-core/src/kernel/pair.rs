//! Two `f64` at once, as every x86-64 processor has them.
//!
//! Each lane rounds as a number by itself does, so the bits are those of the same arithmetic without lanes. Two sums or
//! products cost what one costs, and `hit` needs many things twice: numerator and denominator, entry and exit, a number and
//! the bound of its error.

use core::ops::{Add, Div, Mul, Sub};

#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
use core::arch::x86_64::*;
#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
type Lanes = __m128d;
#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
type Lanes = [f64; 2];

#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
macro_rules! sse2 {
    ($call:expr) => {
        // SAFETY: these functions have registers for arguments, and need SSE2, which this is compiled for.
        unsafe { $call }
    };
}

/// Two numbers.
#[derive(Clone, Copy, Debug)]
pub struct Pair(pub(super) Lanes);

/// Pairs in memory, where they can be operands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Pairs<const N: usize>(pub [[f64; 2]; N]);

impl<const N: usize> Pairs<N> {
    /// The pair of this number.
    #[inline(always)]
    pub fn get(&self, number: usize) -> Pair {
        let [low, high] = self.0[number];
        Pair::new(low, high)
    }
}

#[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
impl Pair {
    /// The pair of these numbers.
    #[inline(always)]
    pub fn new(low: f64, high: f64) -> Pair {
        Pair(sse2!(_mm_set_pd(high, low)))
    }
    /// The number twice.
    #[inline(always)]
    pub fn splat(x: f64) -> Pair {
        Pair(sse2!(_mm_set1_pd(x)))
    }
    /// The first number.
    #[inline(always)]
    pub fn low(self) -> f64 {
        sse2!(_mm_cvtsd_f64(self.0))
    }
    /// The second number.
    #[inline(always)]
    pub fn high(self) -> f64 {
        sse2!(_mm_cvtsd_f64(_mm_unpackhi_pd(self.0, self.0)))
    }
    /// The first numbers of two pairs.
    #[inline(always)]
    pub fn lows(self, other: Pair) -> Pair {
        Pair(sse2!(_mm_unpacklo_pd(self.0, other.0)))
    }
    /// The second numbers of two pairs.
    #[inline(always)]
    pub fn highs(self, other: Pair) -> Pair {
        Pair(sse2!(_mm_unpackhi_pd(self.0, other.0)))
    }
    /// The sizes of both.
    #[inline(always)]
    pub fn abs(self) -> Pair {
        Pair(sse2!(_mm_andnot_pd(_mm_set1_pd(-0.0), self.0)))
    }
    /// The greater of each two; that of `other` where one is NaN.
    #[inline(always)]
    pub fn max(self, other: Pair) -> Pair {
        Pair(sse2!(_mm_max_pd(self.0, other.0)))
    }
    /// The lesser of each two; that of `other` where one is NaN.
    #[inline(always)]
    pub fn min(self, other: Pair) -> Pair {
        Pair(sse2!(_mm_min_pd(self.0, other.0)))
    }
    /// Whether a number of either pair is NaN.
    #[inline(always)]
    pub fn is_nan(self, other: Pair) -> bool {
        sse2!(_mm_movemask_pd(_mm_cmpunord_pd(self.0, other.0))) != 0
    }
    /// Whether both are less than those of the other: false for NaN.
    #[inline(always)]
    pub fn is_below(self, other: Pair) -> bool {
        sse2!(_mm_movemask_pd(_mm_cmpnlt_pd(self.0, other.0))) == 0
    }
    /// Which are less than those of the other, one bit each, the low lane first.
    #[inline(always)]
    pub fn below(self, other: Pair) -> i32 {
        sse2!(_mm_movemask_pd(_mm_cmplt_pd(self.0, other.0)))
    }
    /// The signs of both, one bit each, the low lane first.
    #[inline(always)]
    pub fn signs(self) -> i32 {
        sse2!(_mm_movemask_pd(self.0))
    }
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
impl Pair {
    /// The pair of these numbers.
    #[inline(always)]
    pub fn new(low: f64, high: f64) -> Pair {
        Pair([low, high])
    }
    /// The number twice.
    #[inline(always)]
    pub fn splat(x: f64) -> Pair {
        Pair([x, x])
    }
    /// The first number.
    #[inline(always)]
    pub fn low(self) -> f64 {
        self.0[0]
    }
    /// The second number.
    #[inline(always)]
    pub fn high(self) -> f64 {
        self.0[1]
    }
    /// The first numbers of two pairs.
    #[inline(always)]
    pub fn lows(self, other: Pair) -> Pair {
        Pair([self.0[0], other.0[0]])
    }
    /// The second numbers of two pairs.
    #[inline(always)]
    pub fn highs(self, other: Pair) -> Pair {
        Pair([self.0[1], other.0[1]])
    }
    /// The sizes of both.
    #[inline(always)]
    pub fn abs(self) -> Pair {
        Pair(self.0.map(f64::abs))
    }
    /// The greater of each two; that of `other` where one is NaN.
    #[inline(always)]
    pub fn max(self, other: Pair) -> Pair {
        let greater = |a: f64, b: f64| if a > b { a } else { b };
        Pair([greater(self.0[0], other.0[0]), greater(self.0[1], other.0[1])])
    }
    /// The lesser of each two; that of `other` where one is NaN.
    #[inline(always)]
    pub fn min(self, other: Pair) -> Pair {
        let lesser = |a: f64, b: f64| if a < b { a } else { b };
        Pair([lesser(self.0[0], other.0[0]), lesser(self.0[1], other.0[1])])
    }
    /// Whether a number of either pair is NaN.
    #[inline(always)]
    pub fn is_nan(self, other: Pair) -> bool {
        self.0[0].is_nan() | self.0[1].is_nan() | other.0[0].is_nan() | other.0[1].is_nan()
    }
    /// Whether both are less than those of the other: false for NaN.
    #[inline(always)]
    pub fn is_below(self, other: Pair) -> bool {
        self.0[0] < other.0[0] && self.0[1] < other.0[1]
    }
    /// Which are less than those of the other, one bit each, the low lane first.
    #[inline(always)]
    pub fn below(self, other: Pair) -> i32 {
        i32::from(self.0[0] < other.0[0]) | i32::from(self.0[1] < other.0[1]) << 1
    }
    /// The signs of both, one bit each, the low lane first.
    #[inline(always)]
    pub fn signs(self) -> i32 {
        i32::from(self.0[0].is_sign_negative()) | i32::from(self.0[1].is_sign_negative()) << 1
    }
}

macro_rules! each_lane {
    ($($name:ident $method:ident $sse:ident $op:tt;)*) => {
        $(impl $name for Pair {
            type Output = Pair;
            #[inline(always)]
            fn $method(self, other: Pair) -> Pair {
                #[cfg(all(target_arch = "x86_64", target_feature = "sse2"))]
                return Pair(sse2!($sse(self.0, other.0)));
                #[cfg(not(all(target_arch = "x86_64", target_feature = "sse2")))]
                return Pair([self.0[0] $op other.0[0], self.0[1] $op other.0[1]]);
            }
        })*
    };
}
each_lane! {
    Add add _mm_add_pd +;
    Sub sub _mm_sub_pd -;
    Mul mul _mm_mul_pd *;
    Div div _mm_div_pd /;
}
