//! Degree two.

use super::quartic::factors;
use super::{Roots, Simple, quartic};
use crate::Interval;
use crate::double::two_sum;
use crate::kernel::{Product, Solver, solve};
use crate::math::{exp2i, exponent, sqrt};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2`.
///
/// Exact coefficients, special cases and promises as for [`quartic()`](super::quartic()): the exact number of roots, multiple roots
/// decided exactly, simple ones within 0.51 units in the last place. By the quadratic formula, its products exact and
/// its roundings carried along; in double-double where the roots are nearly equal or very different, and where that
/// leaves a doubt by the careful solver between critical points.
///
/// ```
/// let roots = rt_core::poly::quadratic([-2.0, 0.0, 1.0], rt_core::Interval::FORWARD);
/// assert_eq!((roots.len(), roots[0].x), (1, 2f64.sqrt()));
/// ```
pub fn quadratic(c: [f64; 3], within: Interval) -> Roots<2> {
    solve::<Quadratic>([c[0], c[1], c[2], 0.0, 0.0], within)
}

struct Quadratic;

impl Solver for Quadratic {
    type Output = Roots<2>;
    #[inline(always)]
    fn solve<P: Product>([c0, c1, c2, ..]: [f64; 5], within: Interval) -> Roots<2> {
        match quick::<P>([c0, c1, c2]) {
            Some(roots) => roots.inside(&within),
            None => general::<P>(c0, c1, c2, within),
        }
    }
}

#[cold]
#[inline(never)]
fn general<P: Product>(c0: f64, c1: f64, c2: f64, within: Interval) -> Roots<2> {
    if !(c0.is_finite() && c1.is_finite() && c2.is_finite()) {
        return Roots::default();
    }
    quartic::all_roots::<P>(&[c0, c1, c2, 0.0, 0.0]).within(within)
}

/// The roots if the outer coefficients are normal numbers, brought to about 1 by exact scaling: then by the formula, with
/// the very bits of the quick way, or, if the coefficients are `exact`, in double-double. `None` in doubt.
///
/// Without being exact they may stand for others within 2^-116 of the magnitudes of the terms: unequal products of two
/// numbers differ by 2^-106 at least.
#[inline(never)]
pub(super) fn balanced<P: Product>(c: &[f64; 3], exact: bool) -> Option<Roots<4>> {
    let [e0, e1, e2] = c.map(exponent);
    // x = y 2^k with k half the difference of the outer exponents, and the leading coefficient brought to about 1.
    let k = (e0 - e2) >> 1;
    let middle = e1 - e2 - k;
    if !(e0 > -1023 && e2 > -1023 && middle <= 400) {
        return None;
    }
    let with = |c: f64, e: i32| f64::from_bits(c.to_bits() & !(0x7ff << 52) | exp2i(e).to_bits());
    // Below 2^-400 the linear term is lost in the last rounding of either root.
    let c1 = if middle < -400 { 0.0 } else { with(c[1], middle) };
    let c = [with(c[0], e0 - e2 - 2 * k), c1, with(c[2], 0)];
    let roots = match quick::<P>(c) {
        Some(roots) => roots.inside(&Interval::LINE),
        None if exact => factors::quadratic::<P>(c[0], c[1], c[2])?,
        None => return None,
    };
    // Half of k and again: k itself may be beyond the exponents of `f64`.
    let roots = roots.scaled(exp2i(k >> 1)).scaled(exp2i(k - (k >> 1)));
    if roots.iter().all(|root| root.x.is_normal()) { Some(roots) } else { None }
}

/// The quadratic formula in `f64`, the discriminant from exact products and what each operation rounds off carried to
/// the end. `None` where the roots are nearly equal or very different, or the coefficients of extreme size.
///
/// What it leaves, for `c2 x^2 - 2 m x + c0` with `p = -c0 c2`, `d = m^2 + p`, `S = m^2 + |p|`, in units of `f64`'s
/// u = 2^-53: `d_low` is the difference between the rounded and the exact `d` to 2^-104 S, and below 2^-52 S; `s_low`,
/// the first term of the root of `d + d_low`, is within 2^-50 of itself, and the second term is below
/// `(2^-51 S)^2 / 8 s^3`. So `s + s_low` is within `2^-102 S / s + 2^-105 S^2 / s^3` of the exact root. The smaller
/// numerator, `|p|` over the greater one, is above `|p| / (2 sqrt S)`. Where `d` is above 2^-26 of `|p|` (half of the
/// sum or nearly, when it is that small) and `|p|` above 2^-39 of the sum, the error is below 2^-60 of either numerator:
/// 1/128 of a unit in the last place.
#[inline(always)]
pub(super) fn quick<P: Product>([c0, c1, c2]: [f64; 3]) -> Option<Simple<2>> {
    // c2 x^2 - 2 m x + c0
    let m = -0.5 * c1;
    let (square, square_low) = P::two_product(m, m);
    let (product, product_low) = P::two_product(-c0, c2);
    let d = square + product;
    // Rounding keeps order: if the rounded square is less than the rounded product, so it is before.
    if d < 0.0 {
        return Some(Simple::None);
    }
    // Differences of bits are those of logarithms, within 1.
    let between = |from: f64, to: f64, least: i32, most: i32| {
        let (from, to) = (from.to_bits() as i64, to.to_bits() as i64);
        ((to - from).wrapping_sub(i64::from(least) << 52) as u64) < (((most - least) as u64) << 52)
    };
    // The sizes keep all products and what they round off within the range; a linear term too small for that is lost
    // in the last rounding anyway.
    let usual = between(product.abs(), d, -25, 37)
        && between(1.0, product.abs(), -200, 200)
        && between(1.0, c2.abs(), -200, 200);
    if !usual {
        return None;
    }
    // What the sum rounds off.
    let (greater, less) = if square > product { (square, product) } else { (product, square) };
    let d_low = (less - (d - greater)) + (square_low + product_low);
    let s = sqrt(d);
    // s / 2d is 1 / 2s, without waiting for the square root.
    let s_low = (P::remainder(d, s, s) + d_low) * (s * (0.5 / d));
    let i = 1.0 / c2;
    let (q, q_low) = two_sum(m, s);
    let (r, r_low) = two_sum(m, -s);
    let (x, y) = (q * i, r * i);
    let x = x + (P::remainder(q, x, c2) + (q_low + s_low)) * i;
    let y = y + (P::remainder(r, y, c2) + (r_low - s_low)) * i;
    Some(Simple::All(if x < y { [x, y] } else { [y, x] }))
}
