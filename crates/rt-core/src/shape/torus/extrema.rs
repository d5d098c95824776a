//! The extrema of the depressed quartic: the real zeros of `x^3 + P x + Q`.

use crate::kernel::Real;

/// The zero of greatest absolute value of `x^3 + p x + q`, to about 2^-38 of itself, to a rounding or two of it where
/// there are three.
///
/// By symmetry the greatest zero of `y^3 + p y = |q|`. Where all three zeros are real, that is where
/// `|q| = 2 c w^3` with `w^2 = -p / 3` and `c <= 1`, it is `2 w cos(acos(c) / 3)` (Viète 1615), here from the best
/// polynomial of degree four, 1e-5 from it. Otherwise a guess within a third. Newton's method does the rest: each
/// step squares the relative error or better, 5e-6 twice, 0.3 four times.
#[inline(always)]
pub(super) fn outermost<R: Real>(p: R, q: R) -> R {
    let (zero, two) = (q.all(0.0), q.all(2.0));
    let size = q.abs();
    let w = R::if_less(p, zero, p * q.all(-1.0 / 3.0), zero).sqrt();
    let full = two * w * w * w;
    // The lanes with three zeros; what others need is computed only if there are others.
    let triple = size.at_most(full);
    let mut y = zero;
    if triple != 0 {
        let c = R::if_less(zero, full, size / full, zero);
        let cosine = q.all(1.732_060_864_045_381_9)
            + c * (q.all(0.332_823_443_575_192_6)
                + c * (q.all(-0.091_843_866_261_527_45)
                    + c * (q.all(0.035_024_377_150_418_12) - c * q.all(0.008_070_797_433_308_624))));
        y = w * cosine;
    }
    if triple != R::EVERY {
        let root = rough_cube_root(size);
        // p < 0: hyperbolic cosine, with v = cbrt(2 c): y = w (v + 1 / v). p >= 0: exact for p = 0 and for large p.
        let numerator = R::if_less(p, zero, w * w, size);
        let denominator = R::if_less(p, zero, root, p + root * root);
        let quotient = numerator / denominator;
        let single = R::if_less(p, zero, root + quotient, quotient);
        y = R::if_at_most(size, full, y, single);
    }
    y = step(p, size, y);
    y = step(p, size, y);
    if triple != R::EVERY {
        let further = step(p, size, y);
        let further = step(p, size, further);
        y = R::if_at_most(size, full, y, further);
    }
    // NaN where both are zero: all extrema fall together at the origin, and the step was 0 / 0.
    y = R::if_at_most(y, y, y, zero);
    R::if_less(zero, q, -y, y)
}

/// A step of Newton's method for `y^3 + p y = size`.
#[inline(always)]
fn step<R: Real>(p: R, size: R, y: R) -> R {
    let square = y * y;
    (y.all(2.0) * square * y + size) / (y.all(3.0) * square + p)
}

/// The cube root of a positive normal number to 6 %: a third of the exponent and mantissa, taken as a logarithm.
#[inline(always)]
fn rough_cube_root<R: Real>(x: R) -> R {
    // Two thirds of the bits of 1, less what balances the error of the linear logarithm.
    const OFFSET: u64 = 0x2a9f_7893_782d_a1ce;
    x.third_of_bits(OFFSET)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_cubics_with_known_zeros() {
        // (x - a)(x - b)(x + a + b) = x^3 - (a^2 + a b + b^2) x + a b (a + b).
        for i in -50..=50 {
            for j in -50..=50 {
                let (a, b) = (f64::from(i) * 0.04, f64::from(j) * 0.04);
                let (p, q) = (-(a * a + a * b + b * b), a * b * (a + b));
                let x = outermost(p, q);
                let largest = a.abs().max(b.abs()).max((a + b).abs());
                assert!((x.abs() - largest).abs() <= 1e-15 * largest, "{a} {b}: {x}");
            }
        }
    }

    #[test]
    fn one_zero() {
        // (x - a)(x^2 + a x + b) = x^3 + (b - a^2) x - a b, with 4 b > a^2.
        for i in 1..=100 {
            for j in 0..=1000 {
                let a = f64::from(i) * 0.04;
                let b = a * a * (0.2501 + 0.02 * f64::from(j) + f64::from(j * j));
                for a in [a, -a] {
                    let x = outermost(b - a * a, -a * b);
                    let (x, a) = (x / a, a / a);
                    assert!((x - a).abs() <= 2e-12, "{i} {j}: {x}");
                }
            }
        }
    }
}
