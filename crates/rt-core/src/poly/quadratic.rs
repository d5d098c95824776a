//! Degree two.

use super::{Roots, Simple, quartic};
use crate::Interval;
use crate::double::two_sum;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent, sqrt};
use core::hint::select_unpredictable;

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
    run(Solve { c: &c, within })
}

struct Solve<'a> {
    c: &'a [f64; 3],
    within: Interval,
}

impl Task for Solve<'_> {
    type Output = Roots<2>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        match quick::<P>(self.c) {
            Some(roots) => roots.inside(self.within),
            None => general::<P>(self.c, self.within),
        }
    }
}

#[inline(never)]
fn general<P: Product>(&[c0, c1, c2]: &[f64; 3], within: Interval) -> Roots<2> {
    if !(c0.is_finite() && c1.is_finite() && c2.is_finite()) {
        return Roots::default();
    }
    quartic::all_roots::<P>(&[c0, c1, c2, 0.0, 0.0]).within(within)
}

/// The `f64` way: the discriminant from exact products, and what each operation rounds off carried to the end.
#[inline(always)]
pub(super) fn quick<P: Product>(c: &[f64; 3]) -> Option<Simple<2>> {
    // All exponents within 200 of 0 (a linear term of zero is fine): every product is exact.
    let usual = |c: f64| (exponent(c) + 200) as u32 <= 400;
    let [c0, c1, c2] = *c;
    if !(usual(c0) && usual(c2) && (usual(c1) || c1 == 0.0)) {
        return None;
    }
    // Plus zero if it is zero.
    let h = 0.0 - 0.5 * c1;
    let (square, square_low) = P::two_product(h, h);
    let (product, product_low) = P::two_product(c0, c2);
    // Both parts together are within 2^-103 of the products.
    let (d, d_low) = two_sum(square, -product);
    let d_low = d_low + (square_low - product_low);
    let size = square + product.abs();
    if d + d_low < -exp2i(-100) * size {
        return Some(Simple::None);
    }
    // Then the discriminant is known to 2^-63, its root to 2^-64; otherwise the general way decides.
    if !(d > exp2i(-40) * size) {
        return None;
    }
    let s = sqrt(d);
    let (p, pe) = P::two_product(s, s);
    let s_low = ((d - p) - pe + d_low) * (0.5 / s);
    // q = h + s or h - s, of the sign of h (by its bit: no branch): the roots are q / c2 and c0 / q.
    let sign = h.to_bits() & (1 << 63);
    let [s, s_low] = [s, s_low].map(|s| f64::from_bits(s.to_bits() ^ sign));
    let (q, e) = two_sum(h, s);
    let q_low = e + s_low;
    let (i, j) = (1.0 / c2, 1.0 / q);
    let (x, y) = (q * i, c0 * j);
    let (p, pe) = P::two_product(x, c2);
    let x = x + ((q - p) - pe + q_low) * i;
    let (p, pe) = P::two_product(y, q);
    let y = y + ((c0 - p) - pe - y * q_low) * j;
    // Which is the greater depends on two signs: no branch.
    Some(Simple::All([select_unpredictable(x < y, x, y), select_unpredictable(x < y, y, x)]))
}
