//! Degree three.

use super::quartic::discs::{LEFT, compensated, real};
use super::quartic::split::{Factor, isolated_root};
use super::{Roots, Simple, quartic};
use crate::Interval;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent, sqrt};
use core::hint::select_unpredictable;

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2 + c[3] x^3`.
///
/// Exact coefficients, special cases and promises as for [`quartic()`](super::quartic()): the exact number of roots, multiple roots
/// decided exactly, simple ones within 0.51 units in the last place. By a closed form in `f64`
/// with a certificate, as the quartic divided by `x` where that does not hold, and where that leaves a doubt by the
/// careful solver between critical points.
///
/// ```
/// let roots = rt_core::poly::cubic([-2.0, 2.0, -1.0, 1.0], rt_core::Interval::FORWARD);
/// assert_eq!((roots.len(), roots[0].x), (1, 1.0));
/// ```
pub fn cubic(c: [f64; 4], within: Interval) -> Roots<3> {
    run(Solve { c: &c, within })
}

struct Solve<'a> {
    c: &'a [f64; 4],
    within: Interval,
}

impl Task for Solve<'_> {
    type Output = Roots<3>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        match quick::<P>(self.c) {
            Some(roots) => roots.inside(self.within),
            None => general::<P>(self.c, self.within),
        }
    }
}

#[inline(never)]
fn general<P: Product>(&[c0, c1, c2, c3]: &[f64; 4], within: Interval) -> Roots<3> {
    if !(c0.is_finite() && c1.is_finite() && c2.is_finite() && c3.is_finite()) {
        return Roots::default();
    }
    quartic::all_roots::<P>(&[c0, c1, c2, c3, 0.0]).within(within)
}

/// The `f64` way: the root farthest from the others, the quadratic that is left, and the certificate by inclusion
/// discs (as for the quartic), of radius `3 |W|` for degree three.
#[inline(always)]
pub(super) fn quick<P: Product>(c: &[f64; 4]) -> Option<Simple<3>> {
    // Exponents within 80 of 0: the sixth power of a ratio, the largest product, stays below 2^1000.
    let usual = |c: f64| (exponent(c) + 80) as u32 <= 160;
    if !(usual(c[0]) && usual(c[3]) && (usual(c[1]) || c[1] == 0.0) && (usual(c[2]) || c[2] == 0.0)) {
        return None;
    }
    let inverse = 1.0 / c[3];
    let [d, b, a] = [c[0] * inverse, c[1] * inverse, c[2] * inverse];
    // x = y - a/3 gives y^3 + m y + n.
    let t = a * (1.0 / 3.0);
    let t2 = t * t;
    let x = isolated_root(b - 3.0 * t2, d - t * (b - 2.0 * t2)) - t;
    // Division by x - x1 from the end where it is stable; both are computed, as the choice cannot be foreseen.
    let inverse = 1.0 / x;
    let constant = -d * inverse;
    let linear = a + x;
    let below = (x * x * x).abs() > d.abs();
    let rest = Factor {
        linear: select_unpredictable(below, (constant - b) * inverse, linear),
        constant: select_unpredictable(below, constant, b + linear * x),
    };
    let discriminant = 0.25 * rest.linear * rest.linear - rest.constant;
    if discriminant > 0.0 {
        let y = real(&rest, discriminant);
        three::<P>(c, [x, y[0], y[1]])
    } else {
        one::<P>(c, x, &rest, discriminant)
    }
}

/// Three real roots.
#[inline(always)]
fn three<P: Product>(c: &[f64; 4], mut x: [f64; 3]) -> Option<Simple<3>> {
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let less = |a: f64, b: f64| if a < b { a } else { b };
    // Corrections at least square the relative error while the discs are apart: 1e-2 is below 2^-58 after four.
    for _ in 0..5 {
        let (p, size) = compensated::<P, 4, 3>(c, &x);
        let [d01, d02, d12] = [x[0] - x[1], x[0] - x[2], x[1] - x[2]];
        let g = [c[3] * d01 * d02, -c[3] * d01 * d12, c[3] * d02 * d12];
        let gap = [less(d01.abs(), d02.abs()), less(d01.abs(), d12.abs()), less(d02.abs(), d12.abs())];
        let mut w = [0.0; 3];
        let mut noise = [0.0; 3];
        for i in 0..3 {
            let inverse = 1.0 / g[i];
            w[i] = p[i] * inverse;
            noise[i] = (size[i] * inverse).abs() * exp2i(-100);
        }
        // A little more than 3, for the roundings.
        let reach = [w[0].abs() + noise[0], w[1].abs() + noise[1], w[2].abs() + noise[2]];
        let widest = 3.01 * greater(greater(reach[0], reach[1]), reach[2]);
        let mut apart = true;
        let mut done = true;
        for i in 0..3 {
            apart &= widest < 0.125 * gap[i];
            let next = x[i] - w[i];
            // |W| times the others' errors over their distances, multiplied by the distance.
            let left = w[i].abs() * (2.4 * widest + exp2i(-48) * gap[i]);
            done &= left <= (LEFT * next.abs() - noise[i]) * gap[i];
            x[i] = next;
        }
        if apart && done {
            let (a, b) = (less(x[0], x[1]), greater(x[0], x[1]));
            let (b, c) = (less(b, x[2]), greater(b, x[2]));
            return Some(Simple::All([less(a, b), greater(a, b), c]));
        }
        if !(x[0] + x[1] + x[2]).is_finite() {
            return None;
        }
    }
    None
}

/// A real root and a pair of complex ones, those of `rest`.
#[inline(always)]
fn one<P: Product>(c: &[f64; 4], mut x: f64, rest: &Factor, discriminant: f64) -> Option<Simple<3>> {
    let (a, b) = (rest.linear, rest.constant);
    let (re, im2) = (-0.5 * a, -discriminant);
    // The remainder of the division by the pair's factor bounds |p(z)|; its roundings are below 2^-46 of the terms.
    let c2 = c[2] - a * c[3];
    let (r1, r0) = (c[1] - a * c2 - b * c[3], c[0] - b * c2);
    let m = sqrt(b.abs());
    let size = ((c[3].abs() * m + c[2].abs()) * m + c[1].abs()) * m + c[0].abs();
    let residual = 3.01 * (r1.abs() * m + r0.abs() + exp2i(-46) * size);
    let im = sqrt(im2);
    for _ in 0..4 {
        let ([p], [size]) = compensated::<P, 4, 1>(c, &[x]);
        let far2 = (x - re) * (x - re) + im2;
        let inverse = 1.0 / (c[3] * far2);
        let w = p * inverse;
        let noise = (size * inverse).abs() * exp2i(-100);
        // The disc of the pair, 3 |W| = 3 |p(z)| / (2 |c3| im far) with far >= im, and the rounding of the
        // discriminant, 2^-50 b / im, must stay below im / 8; so must the root's own disc.
        let clear = residual <= 0.25 * im2 * im * c[3].abs()
            && exp2i(-50) * b.abs() <= 0.125 * im2
            && 3.01 * (w.abs() + noise) <= 0.125 * im;
        if !clear {
            return None;
        }
        let next = x - w;
        // The pair's two errors over their distance: 2 * 3 |p(z)| / (2 |c3| im far^2), times im.
        let share = residual * inverse.abs();
        if w.abs() * (1.2 * share + exp2i(-48) * im) <= (LEFT * next.abs() - noise) * im {
            return Some(Simple::One(next));
        }
        x = next;
    }
    None
}
