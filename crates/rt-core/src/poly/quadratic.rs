//! Degree two.

use super::quartic::discs::compensated;
use super::{Roots, quartic};
use crate::Interval;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent, sqrt};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2`.
///
/// Exact coefficients, special cases and promises as for [`quartic()`](super::quartic()): the exact number of roots, multiple roots
/// decided exactly, simple ones within 0.51 units in the last place. By the quadratic formula
/// with an exact discriminant, in double-double where that is nearly zero, and where that leaves a doubt by the
/// careful solver between critical points.
///
/// ```
/// let roots = rt_core::poly::quadratic([-2.0, 0.0, 1.0], rt_core::Interval::FORWARD);
/// assert_eq!((roots.len(), roots[0].x), (1, 2f64.sqrt()));
/// ```
pub fn quadratic(c: [f64; 3], within: Interval) -> Roots<2> {
    run(Solve { c }).inside(within)
}

struct Solve {
    c: [f64; 3],
}

impl Task for Solve {
    type Output = Roots<2>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        match quick::<P>(&self.c) {
            Some(roots) => roots,
            None => general::<P>(&self.c),
        }
    }
}

#[inline(never)]
fn general<P: Product>(&[c0, c1, c2]: &[f64; 3]) -> Roots<2> {
    if !(c0.is_finite() && c1.is_finite() && c2.is_finite()) {
        return Roots::default();
    }
    quartic::all_roots::<P>(&[c0, c1, c2, 0.0, 0.0]).within(Interval::LINE)
}

/// The `f64` way: the discriminant from exact products, and one Newton step with a compensated residual.
#[inline(always)]
pub(super) fn quick<P: Product>(c: &[f64; 3]) -> Option<Roots<2>> {
    // All exponents within 200 of 0 (a linear term of zero is fine): every product is exact.
    let usual = |c: f64| (exponent(c) + 200) as u32 <= 400;
    let [c0, c1, c2] = *c;
    if !(usual(c0) && usual(c2) && (usual(c1) || c1 == 0.0)) {
        return None;
    }
    let h = -0.5 * c1;
    let (p, pe) = P::two_product(h, h);
    let (q, qe) = P::two_product(c0, c2);
    // Within 2 u of itself and 2^-103 of the products.
    let d = (p - q) + (pe - qe);
    let size = p + q.abs();
    if d < -exp2i(-100) * size {
        return Some(Roots::default());
    }
    // Then the roots are good to a few u before the step and the slope there to 2 u; otherwise the general way
    // decides.
    if !(d > exp2i(-40) * size) {
        return None;
    }
    let s = sqrt(d);
    // The slope 2 c2 x + c1 is 2 (q - h) at q / c2 and the opposite at the other root.
    let (q, slope) = if h >= 0.0 { (h + s, 2.0 * s) } else { (h - s, -2.0 * s) };
    let x = [q / c2, c0 / q];
    let (p, _) = compensated::<P, 3, 2>(c, &x);
    let inverse = 1.0 / slope;
    let (x, y) = (x[0] - p[0] * inverse, x[1] + p[1] * inverse);
    let mut roots = Roots::default();
    roots.push(if x < y { x } else { y }, 1);
    roots.push(if x < y { y } else { x }, 1);
    Some(roots)
}
