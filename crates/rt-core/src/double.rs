//! Double-double arithmetic from error-free transformations: about 106 bits.
//!
//! Sources: Dekker 1971 (doi:10.1007/BF01397083); Hida, Li and Bailey 2001 (doi:10.1109/ARITH.2001.930115);
//! error bounds: Joldes, Muller and Popescu 2017 (doi:10.1145/3121432), u = 2^-53: sum 3 u^2, product 5 u^2 (with
//! plain products of the low parts), quotient 10 u^2, square root 4 u^2, all relative, in the ranges where
//! [`Product::two_product`] is exact.

use crate::kernel::{Product, Real, Twice};
use crate::math::sqrt;
use core::ops::{Add, Neg, Sub};

/// `(s, e)` with `s = fl(a + b)` and `s + e = a + b` exactly (Knuth).
#[inline(always)]
pub fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

/// `(s, e)` with `s = fl(a - b)` and `s + e = a - b` exactly.
#[inline(always)]
pub fn two_difference<R: Real>(a: R, b: R) -> (R, R) {
    two_sum(a, -b)
}

/// [`two_sum`] for `|a| >= |b|` or `a = 0` (Dekker).
#[inline(always)]
pub fn fast_two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let s = a + b;
    (s, b - (s - a))
}

/// An unevaluated sum of two `f64`, the second at most half a unit in the last place of the first; or one such sum in each
/// lane of [`Four`](crate::kernel::Four).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double<R = f64> {
    /// The sum, rounded to nearest.
    pub high: R,
    /// What the rounding left.
    pub low: R,
}

impl Double {
    /// Zero.
    pub const ZERO: Double = Double { high: 0.0, low: 0.0 };
    /// One.
    pub const ONE: Double = Double { high: 1.0, low: 0.0 };

    /// The value of one `f64`.
    #[inline(always)]
    pub const fn from(a: f64) -> Self {
        Double { high: a, low: 0.0 }
    }
}

// The products take the kind of exact product as a parameter, which the operators' traits have no place for.
#[allow(clippy::should_implement_trait)]
impl<R: Real> Double<R> {
    /// The same number in all lanes, of as many as `like` has.
    #[inline(always)]
    pub fn all(like: R, a: Double) -> Self {
        Double { high: like.all(a.high), low: like.all(a.low) }
    }

    /// The exact sum of two `f64`.
    #[inline(always)]
    pub fn sum(a: R, b: R) -> Self {
        let (high, low) = two_sum(a, b);
        Double { high, low }
    }

    /// The exact difference of two `f64`.
    #[inline(always)]
    pub fn difference(a: R, b: R) -> Self {
        Double::sum(a, -b)
    }

    /// The exact product of two `f64`.
    #[inline(always)]
    pub fn product<P: Product>(a: R, b: R) -> Self {
        let (high, low) = R::two_product::<P>(a, b);
        Double { high, low }
    }

    /// The product with a `f64`.
    #[inline(always)]
    pub fn scale<P: Product>(self, b: R) -> Self {
        let (p, e) = R::two_product::<P>(self.high, b);
        let (high, low) = fast_two_sum(p, e + self.low * b);
        Double { high, low }
    }

    /// The product with a power of two: exact.
    #[inline(always)]
    pub fn scale_exact(self, power: R) -> Self {
        Double { high: self.high * power, low: self.low * power }
    }

    /// The product.
    #[inline(always)]
    pub fn mul<P: Product>(self, b: Self) -> Self {
        let (p, e) = R::two_product::<P>(self.high, b.high);
        let (high, low) = fast_two_sum(p, e + (self.high * b.low + self.low * b.high));
        Double { high, low }
    }

    /// The square.
    #[inline(always)]
    pub fn square<P: Product>(self) -> Self {
        let (p, e) = R::two_product::<P>(self.high, self.high);
        let (high, low) = fast_two_sum(p, e + e.all(2.0) * (self.high * self.low));
        Double { high, low }
    }

    /// The quotient.
    #[inline(always)]
    pub fn div<P: Product>(self, b: Self) -> Self {
        let q = self.high / b.high;
        let r = self - b.scale::<P>(q);
        let (high, low) = fast_two_sum(q, r.high / b.high);
        Double { high, low }
    }

    /// The quotient, given the inverse of the large part of the divisor: one Newton step from the rounded quotient. The
    /// remainder is at most 5 u of the dividend and rounds three times, the step twice: right to 2^-101.
    #[inline(always)]
    pub fn div_with<P: Product>(self, b: Self, inverse: R) -> Self {
        let q = self.high * inverse;
        let (p, e) = R::two_product::<P>(q, b.high);
        let rest = ((self.high - p) - e) + (self.low - q * b.low);
        let (high, low) = fast_two_sum(q, rest * inverse);
        Double { high, low }
    }

    /// The nearest `f64`.
    #[inline(always)]
    pub fn to_f64(self) -> R {
        self.high + self.low
    }
}

impl<R> Double<Twice<R>> {
    /// The numbers of both.
    #[inline(always)]
    pub fn both(a: Double<R>, b: Double<R>) -> Self {
        Double { high: Twice(a.high, b.high), low: Twice(a.low, b.low) }
    }
}

impl Double {
    /// The square root; zero for zero and for negative values.
    #[inline(always)]
    pub fn sqrt<P: Product>(self) -> Self {
        if self.high <= 0.0 {
            return Double::ZERO;
        }
        let s = sqrt(self.high);
        let r = self - Double::product::<P>(s, s);
        let (high, low) = fast_two_sum(s, r.high / (2.0 * s));
        Double { high, low }
    }

    /// The absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }
}

impl<R: Real> Neg for Double<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Double { high: -self.high, low: -self.low }
    }
}

impl<R: Real> Add for Double<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        let (s, e) = two_sum(self.high, b.high);
        let (t, f) = two_sum(self.low, b.low);
        let (s, e) = fast_two_sum(s, e + t);
        let (high, low) = fast_two_sum(s, e + f);
        Double { high, low }
    }
}

impl<R: Real> Sub for Double<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self + (-b)
    }
}

impl<R: Real> Add<R> for Double<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: R) -> Self {
        let (s, e) = two_sum(self.high, b);
        let (high, low) = fast_two_sum(s, e + self.low);
        Double { high, low }
    }
}

impl<R: Real> Sub<R> for Double<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: R) -> Self {
        self + (-b)
    }
}

impl PartialOrd for Double {
    #[inline(always)]
    fn partial_cmp(&self, other: &Double) -> Option<core::cmp::Ordering> {
        match self.high.partial_cmp(&other.high) {
            Some(core::cmp::Ordering::Equal) => self.low.partial_cmp(&other.low),
            order => order,
        }
    }
}
