//! Exact sums of many products: expansions of `f64`, for the few decisions that double-double leaves in doubt.
//!
//! Source: Shewchuk 1997, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates
//! (doi:10.1007/PL00009321), grow-expansion with zero elimination.

use crate::double::{Double, fast_two_sum, two_sum};
use crate::kernel::Product;

/// The most components an expansion holds: an exact 3 by 3 determinant of differences has six products of three
/// factors of two components each, every one an exact product of at most 4 components: 6 * 8 * 4 = 192.
const CAPACITY: usize = 192;

/// An exact sum: components of ascending size that do not overlap, none of them zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expansion {
    parts: [f64; CAPACITY],
    len: usize,
}

impl Expansion {
    /// Zero.
    pub(crate) const ZERO: Expansion = Expansion { parts: [0.0; CAPACITY], len: 0 };

    /// Adds one number.
    pub(crate) fn add(&mut self, b: f64) {
        let mut sum = b;
        let mut kept = 0;
        for i in 0..self.len {
            let (s, e) = two_sum(sum, self.parts[i]);
            sum = s;
            if e != 0.0 {
                self.parts[kept] = e;
                kept += 1;
            }
        }
        if sum != 0.0 {
            if kept == CAPACITY {
                // Cannot happen for the sums named above; drop the least part rather than panic.
                self.parts.copy_within(1.., 0);
                kept -= 1;
            }
            self.parts[kept] = sum;
            kept += 1;
        }
        self.len = kept;
    }

    /// Adds the product of two numbers.
    pub(crate) fn add_product<P: Product>(&mut self, a: f64, b: f64) {
        let p = product::<P>(a, b);
        if p.low != 0.0 {
            self.add(p.low);
        }
        self.add(p.high);
    }

    /// Adds the product of two unevaluated sums.
    pub(crate) fn add_double_product<P: Product>(&mut self, a: Double, b: Double) {
        for x in [a.low, a.high] {
            for y in [b.low, b.high] {
                if x != 0.0 && y != 0.0 {
                    self.add_product::<P>(x, y);
                }
            }
        }
    }

    /// Adds the product of an expansion and an unevaluated sum.
    pub(crate) fn add_expansion_product<P: Product>(&mut self, a: &Expansion, b: Double) {
        for &x in &a.parts[..a.len] {
            for y in [b.low, b.high] {
                if y != 0.0 {
                    self.add_product::<P>(x, y);
                }
            }
        }
    }

    /// Whether it is negative (-1), zero (0) or positive (1).
    pub(crate) fn sign(&self) -> i32 {
        match self.parts[..self.len].last() {
            Some(&last) => {
                if last > 0.0 {
                    1
                } else {
                    -1
                }
            }
            None => 0,
        }
    }

    /// The product with a power of two: exact unless parts underflow.
    pub(crate) fn scale_exact(&mut self, power: f64) {
        for part in &mut self.parts[..self.len] {
            *part *= power;
        }
    }

    /// The sum of two `f64` that is nearest, within 2^-104 of the exact value, relatively (the two leading components
    /// of Shewchuk's compress).
    pub(crate) fn rounded(&self) -> Double {
        let mut parts = self.parts[..self.len].iter().rev();
        let mut sum = parts.next().copied().unwrap_or(0.0);
        let mut high = None;
        for &part in parts {
            let (s, rest) = fast_two_sum(sum, part);
            if rest == 0.0 {
                sum = s;
            } else if let Some(high) = high {
                return Double::sum(high, s);
            } else {
                (high, sum) = (Some(s), rest);
            }
        }
        match high {
            Some(high) => Double::sum(high, sum),
            None => Double::from(sum),
        }
    }
}

/// The exact product of prescaled numbers. Products below 2^-968, where the error of the product is not a `f64`, count
/// as exact: they are that small beside another factor in `[1, 2)`, and so the bits do not depend on the machine.
#[inline(always)]
pub(crate) fn product<P: Product>(a: f64, b: f64) -> Double {
    const LEAST: f64 = crate::math::exp2i(-968);
    let p = Double::product::<P>(a, b);
    if p.high.abs() < LEAST { Double::from(p.high) } else { p }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Dekker;

    #[test]
    fn sums_that_cancel_are_exact() {
        let mut sum = Expansion::ZERO;
        for x in [1e300, 1.0, -1e300, 1e-300, -1.0] {
            sum.add(x);
        }
        assert_eq!((sum.sign(), sum.rounded()), (1, Double::from(1e-300)));
        sum.add(-1e-300);
        assert_eq!((sum.sign(), sum.rounded()), (0, Double::ZERO));
    }

    #[test]
    fn products_that_cancel_are_exact() {
        // (1 + e)(1 - e) - 1 = -e^2.
        let e = f64::EPSILON;
        let mut sum = Expansion::ZERO;
        sum.add_product::<Dekker>(1.0 + e, 1.0 - e);
        sum.add(-1.0);
        assert_eq!(sum.rounded(), Double::from(-e * e));
        let mut other = Expansion::ZERO;
        other.add_double_product::<Dekker>(Double::sum(1.0, e * e), Double::sum(1.0, -e * e));
        other.add(-1.0);
        assert_eq!(other.rounded(), Double::from(-e * e * e * e));
    }
}
