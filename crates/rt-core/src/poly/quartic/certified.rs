//! The default method.

use super::super::{Roots, bracket};
use crate::Interval;
use crate::double::Double;
use crate::kernel::{Product, Task, run};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2 + c[3] x^3 + c[4] x^4`.
pub fn quartic(c: [f64; 5], within: Interval) -> Roots<4> {
    if !c.iter().all(|c| c.is_finite()) {
        return Roots::default();
    }
    run(Careful { c: c.map(Double::from) }).rounded().within(within)
}

/// The real roots of a quartic whose coefficients are given in double-double, in double-double.
pub fn double(c: [Double; 5]) -> Roots<4, Double> {
    if !c.iter().all(|c| c.high.is_finite() && c.low.is_finite()) {
        return Roots::default();
    }
    run(Careful { c })
}

struct Careful {
    c: [Double; 5],
}

impl Task for Careful {
    type Output = Roots<4, Double>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        bracket::solve::<P, 4>(&self.c)
    }
}
