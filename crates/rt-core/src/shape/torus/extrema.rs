//! The extrema of the depressed quartic: the real zeros of `x^3 + P x + Q`.

use crate::math::sqrt;

/// The zero of greatest absolute value of `x^3 + p x + q`, to about 2^-38 of itself, to a rounding or two of it where
/// there are three.
///
/// By symmetry the greatest zero of `y^3 + p y = |q|`. Where all three zeros are real, that is where
/// `|q| = 2 c w^3` with `w^2 = -p / 3` and `c <= 1`, it is `2 w cos(acos(c) / 3)` (Viète 1615), here from the best
/// polynomial of degree four, 1e-5 from it. Otherwise a guess within a third. Newton's method does the rest: each
/// step squares the relative error or better, 5e-6 twice, 0.3 four times.
#[inline(always)]
pub(super) fn outermost(p: f64, q: f64) -> f64 {
    let size = q.abs();
    let w = sqrt(if p < 0.0 { p * (-1.0 / 3.0) } else { 0.0 });
    let full = 2.0 * w * w * w;
    let (mut y, steps) = if size <= full {
        let c = if full > 0.0 { size / full } else { 0.0 };
        let cosine = 1.732_060_864_045_381_9
            + c * (0.332_823_443_575_192_6
                + c * (-0.091_843_866_261_527_45
                    + c * (0.035_024_377_150_418_12 - c * 0.008_070_797_433_308_624)));
        (w * cosine, 2)
    } else {
        let root = rough_cube_root(size);
        // p < 0: hyperbolic cosine, with v = cbrt(2 c): y = w (v + 1 / v). p >= 0: exact for p = 0 and for large p.
        (if p < 0.0 { root + w * w / root } else { size / (p + root * root) }, 4)
    };
    for _ in 0..steps {
        let square = y * y;
        y = (2.0 * square * y + size) / (3.0 * square + p);
    }
    // Both zero: all extrema fall together at the origin, and the step was 0 / 0.
    if y.is_nan() {
        y = 0.0;
    }
    if q > 0.0 { -y } else { y }
}

/// The cube root of a positive normal number to 6 %: a third of the exponent and mantissa, taken as a logarithm.
#[inline(always)]
fn rough_cube_root(x: f64) -> f64 {
    // Two thirds of the bits of 1, less what balances the error of the linear logarithm.
    const OFFSET: u64 = 0x2a9f_7893_782d_a1ce;
    f64::from_bits(x.to_bits() / 3 + OFFSET)
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
