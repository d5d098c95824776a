//! A polynomial whose coefficients carry their own exponents, and its value in double-double.
//!
//! With `x = y 2^e`, `1 <= |y| < 2`, the terms are `c_k 2^(ek) y^k`. A common power of two brings the largest of the
//! scaled coefficients to about 1, so that no product overflows, whatever the coefficients. What then lies below
//! 2^-400 is dropped: it is far below the resolution of any comparison made here, and the exact tests take a dropped
//! term as a proof that the sum is not zero.

use crate::double::Double;
use crate::kernel::Product;
use crate::math::{exp2i, exponent};

/// `x 2^power` for any power; below the normal range it may be rounded more than once.
#[inline]
pub(super) fn ldexp(x: f64, power: i32) -> f64 {
    let part = (power / 3).clamp(-1022, 1023);
    let rest = (power - 2 * part).clamp(-1022, 1023);
    x * exp2i(part) * exp2i(part) * exp2i(rest)
}

/// A number with its exponent taken out: `mantissa 2^exponent`, `1 <= |mantissa| < 2`, or zero.
#[derive(Clone, Copy, Debug)]
struct Term {
    mantissa: Double,
    exponent: i32,
}

impl Term {
    const ZERO: Term = Term { mantissa: Double::ZERO, exponent: 0 };

    fn new(value: Double, power: i32) -> Self {
        if value.high == 0.0 {
            return Term::ZERO;
        }
        let e = exponent(value.high);
        if e < -900 {
            // Subnormal, or near it: lifted first, exactly.
            let lifted = value.scale_exact(exp2i(600));
            let e = exponent(lifted.high);
            return Term { mantissa: lifted.scale_exact(exp2i(-e)), exponent: e - 600 + power };
        }
        let half = exp2i(-(e / 2));
        let rest = exp2i(-(e - e / 2));
        Term { mantissa: value.scale_exact(half).scale_exact(rest), exponent: e + power }
    }
}

/// A polynomial of degree at most four with double-double coefficients of any exponent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial {
    terms: [Term; 5],
    degree: usize,
}

/// The value of a polynomial and of its derivatives about `x = y 2^exponent`, all in terms of `y`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    /// The value, up to a common power of two.
    pub value: Double,
    /// A bound on its error.
    pub error: f64,
    /// The first derivative.
    pub slope: f64,
    /// Half the second derivative.
    pub curvature: f64,
    /// The exponent of `y`.
    pub exponent: i32,
}

/// The terms at `x = y 2^exponent`, scaled to about one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    /// The scaled coefficients of `y`.
    pub c: [Double; 5],
    /// Where: `1 <= |y| < 2`, or zero.
    pub y: Double,
    /// The exponent of `y`.
    pub exponent: i32,
    /// Whether a term was too small to keep.
    pub dropped: bool,
}

impl Polynomial {
    /// The polynomial with these coefficients, ascending powers; leading zeros lower the degree. `c` must be finite.
    pub fn new(c: &[Double]) -> Self {
        let mut terms = [Term::ZERO; 5];
        let mut degree = 0;
        for (i, (term, &c)) in terms.iter_mut().zip(c).enumerate() {
            *term = Term::new(c, 0);
            if c.high != 0.0 {
                degree = i;
            }
        }
        Polynomial { terms, degree }
    }

    /// As [`new`](Self::new), with the coefficient of `x^k` times `2^(-k exponent)`: from `y` back to `x = y 2^exponent`.
    pub fn stretched(c: &[Double; 5], exponent: i32, degree: usize) -> Self {
        let mut terms = [Term::ZERO; 5];
        for (k, (term, &c)) in terms.iter_mut().zip(c).enumerate() {
            *term = Term::new(c, -(exponent * k as i32));
        }
        Polynomial { terms, degree }
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Whether the constant term is zero.
    pub fn vanishes_at_zero(&self) -> bool {
        self.terms[0].mantissa.high == 0.0
    }

    /// Divided by `x`.
    pub fn deflated(&self) -> Self {
        let t = &self.terms;
        Polynomial { terms: [t[1], t[2], t[3], t[4], Term::ZERO], degree: self.degree.saturating_sub(1) }
    }

    /// The derivative, exactly: the multiples by 2, 3 and 4 of a double-double with 106 bits are rounded to 2^-105 at
    /// most, those of a `f64` are exact.
    pub fn derivative(&self) -> Self {
        let mut terms = [Term::ZERO; 5];
        for k in 1..=self.degree {
            let c = self.terms[k];
            let m = match k {
                1 => c.mantissa,
                2 => c.mantissa.scale_exact(2.0),
                3 => c.mantissa.scale_exact(2.0) + c.mantissa,
                _ => c.mantissa.scale_exact(4.0),
            };
            terms[k - 1] = Term::new(m, c.exponent);
        }
        Polynomial { terms, degree: self.degree.saturating_sub(1) }
    }

    /// The sign far to the right (`side` = 1) or to the left (`side` = -1).
    pub fn sign_at_infinity(&self, side: i32) -> i32 {
        let lead = if self.terms[self.degree].mantissa.high > 0.0 { 1 } else { -1 };
        if side < 0 && self.degree % 2 == 1 { -lead } else { lead }
    }

    /// A power of two beyond every root, as its exponent: Fujiwara's bound `2 max |c_(n-k) / c_n|^(1/k)`, where a ratio
    /// is below 2 to the power of the difference of the exponents plus 1.
    pub fn bound_exponent(&self) -> i32 {
        let lead = self.terms[self.degree].exponent;
        let mut bound = -1100;
        for k in 1..=self.degree {
            let term = self.terms[self.degree - k];
            if term.mantissa.high != 0.0 {
                let ratio = term.exponent - lead + 1;
                bound = bound.max(ratio.div_euclid(k as i32) + 1);
            }
        }
        bound + 1
    }

    /// An exponent below that of every root but zero: the bound of the reversed polynomial. Zero if there is no such
    /// root.
    pub fn least_exponent(&self) -> i32 {
        let mut nonzero = self.terms.iter().enumerate().filter(|(_, t)| t.mantissa.high != 0.0);
        let Some((first, constant)) = nonzero.next() else { return 0 };
        let of =
            |(k, t): (usize, &Term)| (constant.exponent - t.exponent - 1).div_euclid((k - first) as i32) - 1;
        nonzero.map(of).min().unwrap_or(0)
    }

    /// In the variable `y`, `x = y 2^exponent`.
    pub fn in_units(&self, exponent: i32) -> Self {
        let mut stretched = *self;
        for (k, term) in stretched.terms.iter_mut().enumerate() {
            term.exponent += exponent * k as i32;
        }
        stretched
    }

    /// Whether the values at zero and the slope there have opposite signs: then the least root is positive, if it is by
    /// far the least.
    pub fn falls_through_zero(&self) -> bool {
        (self.terms[0].mantissa.high > 0.0) != (self.terms[1].mantissa.high > 0.0)
    }

    /// The exponent below which the constant term is the greatest: where to look about `x = 0`.
    fn balance(&self) -> i32 {
        let constant = self.terms[0].exponent;
        let of = |(k, t): (usize, &Term)| {
            if t.mantissa.high == 0.0 { None } else { Some((constant - t.exponent).div_euclid(k as i32)) }
        };
        if self.vanishes_at_zero() {
            0
        } else {
            self.terms.iter().enumerate().skip(1).filter_map(of).min().unwrap_or(0)
        }
    }

    /// The terms as seen at `x`.
    #[inline]
    pub fn local(&self, x: Double) -> Local {
        let (y, e) = if x.high == 0.0 {
            (Double::ZERO, self.balance())
        } else {
            let t = Term::new(x, 0);
            (t.mantissa, t.exponent)
        };
        let mut power = i32::MIN;
        for (k, t) in self.terms.iter().enumerate() {
            if t.mantissa.high != 0.0 {
                power = power.max(t.exponent + e * k as i32);
            }
        }
        let mut c = [Double::ZERO; 5];
        let mut dropped = false;
        for (k, (c, t)) in c.iter_mut().zip(&self.terms).enumerate() {
            if t.mantissa.high != 0.0 {
                let shift = t.exponent + e * k as i32 - power;
                if shift >= -400 {
                    *c = t.mantissa.scale_exact(exp2i(shift));
                } else {
                    dropped = true;
                }
            }
        }
        Local { c, y, exponent: e, dropped }
    }

    /// Value, slope and curvature at `x`.
    #[inline]
    pub fn at<P: Product>(&self, x: Double) -> Value {
        self.local(x).value::<P>()
    }
}

impl Local {
    /// Value, slope and curvature by Horner's rule.
    ///
    /// Each of the four steps rounds a product (5 u^2) and a sum (3 u^2, of its terms), u = 2^-53: with the error of the
    /// coefficients, below 40 u^2 of the sum of the magnitudes of the terms. A low part more, and the bound's own
    /// rounding, stay within 2^-100.
    #[inline(always)]
    pub fn value<P: Product>(&self) -> Value {
        const ERROR: f64 = exp2i(-100);
        let (c, y) = (&self.c, self.y);
        let mut value = c[4];
        let mut slope = Double::ZERO;
        let mut curvature = 0.0;
        let mut size = c[4].high.abs();
        for k in (0..4).rev() {
            curvature = curvature * y.high + slope.high;
            slope = slope.mul::<P>(y) + value;
            value = value.mul::<P>(y) + c[k];
            size = size * y.high.abs() + c[k].high.abs();
        }
        Value { value, error: size * ERROR, slope: slope.to_f64(), curvature, exponent: self.exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn powers_of_two_of_any_size() {
        for power in [-1074, -1073, -1022, -700, -3, -2, -1, 0, 1, 2, 3, 4, 5, 700, 1023] {
            let expected = if power < -1022 { f64::from_bits(1 << (power + 1074)) } else { exp2i(power) };
            assert_eq!(ldexp(1.0, power), expected, "{power}");
            assert_eq!(ldexp(-1.0, power), -expected, "{power}");
        }
        assert_eq!(ldexp(f64::from_bits(1), 2097), exp2i(1023));
        assert_eq!((ldexp(1.0, 2000), ldexp(1.0, -2000)), (f64::INFINITY, 0.0));
    }

    use crate::kernel::{Dekker, Task, run};
    use crate::testing::Random;

    /// A polynomial with roots of these sizes, ascending, and its coefficients.
    fn with_roots(random: &mut Random, exponents: &[i32], lead: i32) -> (Polynomial, [f64; 5], Vec<f64>) {
        let roots: Vec<f64> =
            exponents.iter().map(|&e| random.sign() * random.uniform(1.0, 2.0) * exp2i(e)).collect();
        let mut c = [exp2i(lead) * random.uniform(1.0, 2.0), 0.0, 0.0, 0.0, 0.0];
        for root in &roots {
            c = core::array::from_fn(|k| if k == 0 { -root * c[0] } else { c[k - 1] - root * c[k] });
        }
        (Polynomial::new(&c.map(Double::from)), c, roots)
    }

    /// All roots lie between the bounds, which are not much too wide.
    #[test]
    fn bounds_of_roots() {
        let mut random = Random::new(1);
        for case in 0..4000 {
            let degree = 1 + case % 4;
            let mut e = random.below(200) as i32 - 100;
            let exponents: Vec<i32> = (0..degree)
                .map(|_| {
                    e += random.below(if case % 8 < 4 { 2 } else { 40 }) as i32;
                    e
                })
                .collect();
            let lead = random.below(100) as i32 - 50;
            let (p, c, roots) = with_roots(&mut random, &exponents, lead);
            assert_eq!(p.degree(), degree);
            // A root's own exponent, and one more to be beyond it.
            let (least, most) = (exponents[0], exponents[degree - 1] + 1);
            let found = p.bound_exponent();
            assert!((most..=most + 6).contains(&found), "{roots:?} {found}");
            let found = p.least_exponent();
            assert!((least - 6..=least).contains(&found), "{roots:?} {found}");
            // The same of multiples and in other units, and of the polynomial times x.
            let units = p.in_units(-30);
            assert_eq!(
                (units.bound_exponent(), units.least_exponent()),
                (p.bound_exponent() + 30, p.least_exponent() + 30)
            );
            if degree < 4 {
                let shifted = Polynomial::new(&[0.0, c[0], c[1], c[2], c[3]].map(Double::from));
                assert!(shifted.vanishes_at_zero() && !p.vanishes_at_zero());
                assert_eq!(shifted.bound_exponent(), p.bound_exponent());
                assert_eq!(shifted.least_exponent(), p.least_exponent());
                let back = shifted.deflated();
                assert_eq!((back.degree(), back.least_exponent()), (degree, p.least_exponent()));
            }
            // Where the sign at the ends leads.
            for side in [-1, 1] {
                let far = f64::from(side) * exp2i(p.bound_exponent() + 2);
                let value = c[..=degree].iter().rev().fold(0.0, |v, c| v * far + c);
                assert_eq!(p.sign_at_infinity(side), if value > 0.0 { 1 } else { -1 }, "{c:?}");
            }
            // Whether the least root is positive, where it is by far the least.
            if degree > 1 && exponents[0] < exponents[1] - 4 {
                assert_eq!(p.falls_through_zero(), roots[0] > 0.0, "{roots:?}");
            }
        }
    }

    struct At<'a>(&'a Polynomial, Double);

    impl Task for At<'_> {
        type Output = (Value, Local);
        fn run<P: Product>(self) -> Self::Output {
            (self.0.at::<P>(self.1), self.0.local(self.1))
        }
    }

    /// Values of any size are exact but for their bound, which is that of the sizes of the terms; and so are the derivatives
    /// but for roundings.
    #[test]
    fn values_and_derivatives() {
        let mut random = Random::new(2);
        for case in 0..4000 {
            let degree = 1 + case % 4;
            let e = random.below(400) as i32 - 200;
            let (lead, exponents) = (random.below(100) as i32 - 50, [e, e + 1, e + 2, e + 3]);
            let (p, c, roots) = with_roots(&mut random, &exponents[..degree], lead);
            // At a root, next to one, anywhere, and at zero.
            let x = match case / 4 % 4 {
                0 => Double::from(roots[0]),
                1 => Double::from(roots[0]) + roots[0] * random.magnitude(-30.0, -1.0),
                2 => Double::from(random.sign() * random.uniform(1.0, 8.0) * exp2i(e)),
                _ => Double::ZERO,
            };
            let (v, local) = run(At(&p, x));
            assert!(!local.dropped);
            let scale = |x: Double, k: i32| x.scale_exact(exp2i(k / 2)).scale_exact(exp2i(k - k / 2));
            // The same terms, once more by their definition: with the common power of two that the largest has.
            let exponent = if x.high == 0.0 { v.exponent } else { crate::math::exponent(x.high) };
            assert_eq!(v.exponent, exponent);
            let y = scale(x, -exponent);
            let power =
                (0..=degree).map(|k| crate::math::exponent(c[k]) + exponent * k as i32).max().unwrap();
            let terms: [Double; 5] = core::array::from_fn(|k| {
                if k > degree { Double::ZERO } else { scale(Double::from(c[k]), exponent * k as i32 - power) }
            });
            let mut exact = crate::expansion::Expansion::ZERO;
            let (mut powers, mut size, mut slope, mut bend) = ([Double::ONE; 5], 0.0, 0.0, 0.0);
            for k in 0..5 {
                if k > 0 {
                    powers[k] = powers[k - 1].mul::<Dekker>(y);
                }
                exact.add_double_product::<Dekker>(powers[k], terms[k]);
                size += (powers[k].high * terms[k].high).abs();
                let n = k as f64;
                if k > 0 {
                    slope += n * terms[k].high * powers[k - 1].high;
                }
                if k > 1 {
                    bend += 0.5 * n * (n - 1.0) * terms[k].high * powers[k - 2].high;
                }
            }
            let off = (exact.rounded() - v.value).high.abs();
            // The powers of y here are rounded, too.
            assert!(off <= v.error + exp2i(-101) * size, "{c:?} {x:?}: {off:e} {:e}", v.error);
            assert!((v.error / (exp2i(-100) * size) - 1.0).abs() < 1e-9, "{:e} {size:e}", v.error);
            let sizes = size * 16.0 / if y.high == 0.0 { 1e-9 } else { 1.0 };
            assert!((v.slope - slope).abs() <= 1e-14 * sizes && (v.curvature - bend).abs() <= 1e-14 * sizes);
        }
    }

    /// The derivative of a polynomial has the slopes of it.
    #[test]
    fn derivatives() {
        let mut random = Random::new(3);
        for case in 0..1000 {
            let degree = 1 + case % 4;
            let (p, c, _) = with_roots(&mut random, &[0, 1, 1, 2][..degree], 0);
            let d = p.derivative();
            assert_eq!(d.degree(), degree - 1);
            let x = random.uniform(-4.0, 4.0);
            let (v, local) = run(At(&d, Double::from(x)));
            let expected = (1..=degree).rev().fold(0.0, |sum, k| sum * x + k as f64 * c[k]);
            let size = (1..=degree).rev().fold(0.0, |sum, k| sum * x.abs() + k as f64 * c[k].abs());
            // Up to the common power of two.
            let k = (0..degree).find(|&k| local.c[k].high != 0.0).unwrap();
            let unit = (k + 1) as f64 * c[k + 1] / local.c[k].high * exp2i(local.exponent * k as i32);
            assert!((v.value.to_f64() * unit - expected).abs() <= 1e-14 * size, "{c:?} {x}");
        }
    }
}
