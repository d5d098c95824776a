//! Lanes: eight `f32` for box tests, four `f64` for shading; once portable and once for AVX2.

use super::{Dekker, Product};
use crate::math::sqrt;

/// The operations of a box test on eight `f32` at once, and arithmetic on four `f64`.
///
/// A value of an implementing type is the proof that the machine has the instructions: it can only be had inside
/// [`vectorize`](super::vectorize). Box tests only cull, so two implementations need not agree in the last bit; each
/// states how a product and a difference round.
pub trait Lanes: Copy {
    /// Eight lanes.
    type F: Copy;
    /// The same value in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// The lanes of an array.
    fn load(self, from: &[f32; 8]) -> Self::F;
    /// The lanes as an array.
    fn store(self, x: Self::F) -> [f32; 8];
    /// `a + b`.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a - b`.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b`.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`: `b` when either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`: `b` when either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The lanes in which `a <= b`, one bit each, lane 0 the lowest.
    fn le(self, a: Self::F, b: Self::F) -> u32;
    /// The lanes in which `a <= b` for each of these pairs, one bit each, lane 0 the lowest.
    fn all_le<const N: usize>(self, pairs: [(Self::F, Self::F); N]) -> u32;
    /// The greater of both if one is at least +0, otherwise either; for numbers that are not NaN. Compared as integers:
    /// one cycle, not two or four.
    fn positive_max(self, a: Self::F, b: Self::F) -> Self::F;
    /// The lesser of both if none is negative (-0 is), otherwise a negative one; for numbers that are not NaN.
    fn positive_min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The lanes in which `a < b`, and maybe those in which `a = b`, for numbers that are not NaN and `a` that is at least
    /// +0.
    fn positive_lt(self, a: Self::F, b: Self::F) -> u32;
    /// The numbers that are at least 2^31, one bit each, the first the lowest.
    fn large(self, numbers: [u32; 8]) -> u32;
    /// `1 / a`, for |a| < 2^-100 that of 2^-100 with its sign.
    fn inverse(self, a: Self::F) -> Self::F;
    /// The least lane; any of the others when some are NaN.
    fn least(self, a: Self::F) -> f32;
    /// The greatest lane; any of the others when some are NaN.
    fn greatest(self, a: Self::F) -> f32;

    /// Four `f64`. Whatever is computed with them is the same bits in all implementations.
    type D: Copy;
    /// The same value in all lanes.
    fn splat4(self, x: f64) -> Self::D;
    /// The lanes of an array.
    fn load4(self, from: [f64; 4]) -> Self::D;
    /// The lanes as an array.
    fn store4(self, x: Self::D) -> [f64; 4];
    /// The lanes rounded to nearest.
    fn round4(self, x: Self::D) -> [f32; 4];
    /// `a + b`.
    fn add4(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a - b`.
    fn sub4(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a * b`.
    fn mul4(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a / b`.
    fn div4(self, a: Self::D, b: Self::D) -> Self::D;
    /// `-a`.
    fn neg4(self, a: Self::D) -> Self::D;
    /// The square root, correctly rounded.
    fn sqrt4(self, a: Self::D) -> Self::D;
    /// The product and what its rounding left: [`Product::two_product`](super::Product::two_product).
    fn two_product4(self, a: Self::D, b: Self::D) -> (Self::D, Self::D);
    /// `if a < b { then } else { otherwise }`.
    fn if_less4(self, a: Self::D, b: Self::D, then: Self::D, otherwise: Self::D) -> Self::D;
    /// `if a <= b { then } else { otherwise }`.
    fn if_at_most4(self, a: Self::D, b: Self::D, then: Self::D, otherwise: Self::D) -> Self::D;
    /// `|a|`.
    fn abs4(self, a: Self::D) -> Self::D;
    /// The sizes of `a` with the signs of `b`.
    fn copy_sign4(self, a: Self::D, b: Self::D) -> Self::D;
    /// The signs, one bit each: 1 for numbers that are negative, or -0.
    fn signs4(self, a: Self::D) -> u32;
    /// `if a > b { a } else { b }`: `b` when either is NaN.
    fn max4(self, a: Self::D, b: Self::D) -> Self::D;
    /// `if a < b { a } else { b }`: `b` when either is NaN.
    fn min4(self, a: Self::D, b: Self::D) -> Self::D;
    /// The power of two with the exponent of `a`, which is positive: 0 for subnormal numbers, infinite for NaN.
    fn binade4(self, a: Self::D) -> Self::D;
    /// The lanes without their fractions; any numbers for those that are NaN or not in `0..2^31`.
    fn whole4(self, a: Self::D) -> [u32; 4];
    /// The lanes of the mask first, in their order; any of the others behind them.
    fn pack4(self, a: Self::D, mask: u32) -> Self::D;
    /// The lanes in which `a <= b`, one bit each, lane 0 the lowest.
    fn le4(self, a: Self::D, b: Self::D) -> u32;
    /// The lanes in which `a < b`, one bit each, lane 0 the lowest.
    fn lt4(self, a: Self::D, b: Self::D) -> u32;

    /// Asks for the cache lines of a value that will be needed soon. Has no effect but on time.
    fn prefetch<T>(self, value: &T);
}

/// A computation that is generic over the lanes.
///
/// Implement [`run`](Vectorized::run) with `#[inline(always)]`, and so everything hot that it calls: it is then
/// compiled once for each instruction set.
pub trait Vectorized {
    /// What is computed.
    type Output;
    /// Computes it with these lanes.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// 2^-100.
pub(super) const LEAST: f32 = crate::math::exp2i(-100) as f32;

/// The bits of an `f64` that hold its exponent.
pub(super) const EXPONENT: u64 = 0x7ff << 52;

/// Eight lanes without any assumption about the machine.
#[derive(Clone, Copy, Debug)]
pub struct PortableLanes;

#[inline(always)]
fn each(a: [f32; 8], b: [f32; 8], f: impl Fn(f32, f32) -> f32) -> [f32; 8] {
    core::array::from_fn(|i| f(a[i], b[i]))
}

#[inline(always)]
fn each4(a: [f64; 4], b: [f64; 4], f: impl Fn(f64, f64) -> f64) -> [f64; 4] {
    core::array::from_fn(|i| f(a[i], b[i]))
}

impl Lanes for PortableLanes {
    type F = [f32; 8];
    type D = [f64; 4];
    #[inline(always)]
    fn splat(self, x: f32) -> [f32; 8] {
        [x; 8]
    }
    #[inline(always)]
    fn load(self, from: &[f32; 8]) -> [f32; 8] {
        *from
    }
    #[inline(always)]
    fn store(self, x: [f32; 8]) -> [f32; 8] {
        x
    }
    #[inline(always)]
    fn add(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn mul_add(self, a: [f32; 8], b: [f32; 8], c: [f32; 8]) -> [f32; 8] {
        self.add(self.mul(a, b), c)
    }
    #[inline(always)]
    fn max(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn le(self, a: [f32; 8], b: [f32; 8]) -> u32 {
        (0..8).fold(0, |mask, i| mask | (((a[i] <= b[i]) as u32) << i))
    }
    #[inline(always)]
    fn all_le<const N: usize>(self, pairs: [([f32; 8], [f32; 8]); N]) -> u32 {
        pairs.iter().fold(255, |mask, (a, b)| mask & self.le(*a, *b))
    }
    #[inline(always)]
    fn positive_max(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        self.max(a, b)
    }
    #[inline(always)]
    fn positive_min(self, a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        self.min(a, b)
    }
    #[inline(always)]
    fn positive_lt(self, a: [f32; 8], b: [f32; 8]) -> u32 {
        self.le(a, b)
    }
    #[inline(always)]
    fn large(self, numbers: [u32; 8]) -> u32 {
        (0..8).fold(0, |mask, i| mask | numbers[i] >> 31 << i)
    }
    #[inline(always)]
    fn inverse(self, a: [f32; 8]) -> [f32; 8] {
        a.map(|a| 1.0 / (if a.abs() > LEAST { a.abs() } else { LEAST }).copysign(a))
    }
    #[inline(always)]
    fn least(self, a: [f32; 8]) -> f32 {
        a.into_iter().fold(f32::INFINITY, |least, a| if a < least { a } else { least })
    }
    #[inline(always)]
    fn greatest(self, a: [f32; 8]) -> f32 {
        a.into_iter().fold(f32::NEG_INFINITY, |most, a| if a > most { a } else { most })
    }
    #[inline(always)]
    fn splat4(self, x: f64) -> [f64; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn load4(self, from: [f64; 4]) -> [f64; 4] {
        from
    }
    #[inline(always)]
    fn store4(self, x: [f64; 4]) -> [f64; 4] {
        x
    }
    #[inline(always)]
    fn round4(self, x: [f64; 4]) -> [f32; 4] {
        x.map(|x| x as f32)
    }
    #[inline(always)]
    fn add4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn abs4(self, a: [f64; 4]) -> [f64; 4] {
        a.map(f64::abs)
    }
    #[inline(always)]
    fn copy_sign4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, f64::copysign)
    }
    #[inline(always)]
    fn signs4(self, a: [f64; 4]) -> u32 {
        (0..4).fold(0, |mask, i| mask | (a[i].is_sign_negative() as u32) << i)
    }
    #[inline(always)]
    fn neg4(self, a: [f64; 4]) -> [f64; 4] {
        a.map(|a| -a)
    }
    #[inline(always)]
    fn sqrt4(self, a: [f64; 4]) -> [f64; 4] {
        a.map(sqrt)
    }
    #[inline(always)]
    fn two_product4(self, a: [f64; 4], b: [f64; 4]) -> ([f64; 4], [f64; 4]) {
        (self.mul4(a, b), each4(a, b, |a, b| Dekker::two_product(a, b).1))
    }
    #[inline(always)]
    fn if_less4(self, a: [f64; 4], b: [f64; 4], then: [f64; 4], otherwise: [f64; 4]) -> [f64; 4] {
        core::array::from_fn(|i| if a[i] < b[i] { then[i] } else { otherwise[i] })
    }
    #[inline(always)]
    fn if_at_most4(self, a: [f64; 4], b: [f64; 4], then: [f64; 4], otherwise: [f64; 4]) -> [f64; 4] {
        core::array::from_fn(|i| if a[i] <= b[i] { then[i] } else { otherwise[i] })
    }
    #[inline(always)]
    fn max4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min4(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        each4(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn binade4(self, a: [f64; 4]) -> [f64; 4] {
        a.map(|a| f64::from_bits(a.to_bits() & EXPONENT))
    }
    #[inline(always)]
    fn whole4(self, a: [f64; 4]) -> [u32; 4] {
        a.map(|a| a as u32)
    }
    #[inline(always)]
    fn pack4(self, a: [f64; 4], mask: u32) -> [f64; 4] {
        let mut packed = a;
        let mut count = 0;
        for (lane, &number) in a.iter().enumerate() {
            packed[count & 3] = number;
            count += (mask >> lane & 1) as usize;
        }
        packed
    }
    #[inline(always)]
    fn le4(self, a: [f64; 4], b: [f64; 4]) -> u32 {
        (0..4).fold(0, |mask, i| mask | (((a[i] <= b[i]) as u32) << i))
    }
    #[inline(always)]
    fn lt4(self, a: [f64; 4], b: [f64; 4]) -> u32 {
        (0..4).fold(0, |mask, i| mask | (((a[i] < b[i]) as u32) << i))
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}
}
