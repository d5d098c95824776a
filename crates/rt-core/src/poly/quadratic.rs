//! Degree two.

use super::{Roots, bracket};
use crate::Interval;
use crate::double::Double;
use crate::kernel::{Product, Task, run};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2`.
pub fn quadratic(c: [f64; 3], within: Interval) -> Roots<2> {
    if !c.iter().all(|c| c.is_finite()) {
        return Roots::default();
    }
    run(Careful { c }).rounded().within(within)
}

struct Careful {
    c: [f64; 3],
}

impl Task for Careful {
    type Output = Roots<2, Double>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        bracket::solve::<P, 2>(&self.c.map(Double::from))
    }
}
