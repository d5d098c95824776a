//! Degree two.

use super::{Roots, quartic};
use crate::Interval;
use crate::kernel::{Product, Task, run};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2`.
///
/// Exact coefficients, special cases and promises as for [`quartic()`](super::quartic()): the exact number of roots, multiple roots
/// decided exactly, simple ones within 0.51 units in the last place. By the quadratic formula in double-double, and where that leaves a doubt by the
/// careful solver between critical points.
///
/// ```
/// let roots = rt_core::poly::quadratic([-2.0, 0.0, 1.0], rt_core::Interval::FORWARD);
/// assert_eq!((roots.len(), roots[0].x), (1, 2f64.sqrt()));
/// ```
pub fn quadratic(c: [f64; 3], within: Interval) -> Roots<2> {
    if !c.iter().all(|c| c.is_finite()) {
        return Roots::default();
    }
    run(Solve { c }).within(within)
}

struct Solve {
    c: [f64; 3],
}

impl Task for Solve {
    type Output = Roots<4>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        let [c0, c1, c2] = self.c;
        quartic::all_roots::<P>(&[c0, c1, c2, 0.0, 0.0])
    }
}
