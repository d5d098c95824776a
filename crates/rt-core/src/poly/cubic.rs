//! Degree three.

use super::{Roots, quartic};
use crate::Interval;
use crate::kernel::{Product, Task, run};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2 + c[3] x^3`.
pub fn cubic(c: [f64; 4], within: Interval) -> Roots<3> {
    if !c.iter().all(|c| c.is_finite()) {
        return Roots::default();
    }
    run(Solve { c }).within(within)
}

struct Solve {
    c: [f64; 4],
}

impl Task for Solve {
    type Output = Roots<4>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        let [c0, c1, c2, c3] = self.c;
        quartic::all_roots::<P>(&[c0, c1, c2, c3, 0.0])
    }
}
