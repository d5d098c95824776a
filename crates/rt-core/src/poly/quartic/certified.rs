//! The default method.

use super::super::{Roots, bracket};
use super::{discs, factors, split};
use crate::Interval;
use crate::double::Double;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2 + c[3] x^3 + c[4] x^4`.
pub fn quartic(c: [f64; 5], within: Interval) -> Roots<4> {
    if !c.iter().all(|c| c.is_finite()) {
        return Roots::default();
    }
    run(Quartic { c }).within(within)
}

/// The real roots of a quartic whose coefficients are given in double-double, in double-double.
pub fn double(c: [Double; 5]) -> Roots<4, Double> {
    if !c.iter().all(|c| c.high.is_finite() && c.low.is_finite()) {
        return Roots::default();
    }
    run(Careful { c })
}

struct Quartic {
    c: [f64; 5],
}

impl Task for Quartic {
    type Output = Roots<4>;
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        match quick::<P>(&self.c) {
            Some(roots) => roots,
            None => careful::<P>(&self.c),
        }
    }
}

#[inline(never)]
fn careful<P: Product>(c: &[f64; 5]) -> Roots<4> {
    bracket::solve::<P, 4>(&c.map(Double::from)).rounded()
}

/// The `f64` way, with a certificate.
#[inline(always)]
fn quick<P: Product>(c: &[f64; 5]) -> Option<Roots<4>> {
    let e = c.map(exponent);
    // Normal numbers (the constant and the leading term not zero) within 2^+-300 of the leading one.
    let usual = |k: usize| c[k] == 0.0 && k != 0 || (e[k] - e[4]).abs() < 300;
    if c[4] == 0.0 || e[4].abs() > 700 || !(usual(0) && usual(1) && usual(2) && usual(3)) {
        return None;
    }
    // x = y 2^k so that the monic coefficients are at most about 1: floor of the greatest root's logarithm.
    let ratio = |i: usize, k: i32| if c[i] == 0.0 { -400 } else { (e[i] - e[4]).div_euclid(k) };
    let k = ratio(3, 1).max(ratio(2, 2)).max(ratio(1, 3)).max(ratio(0, 4));
    let s = exp2i(k);
    let lead = exp2i(-e[4]);
    let i1 = exp2i(-e[4] - k);
    let i2 = i1 * exp2i(-k);
    let i3 = i2 * exp2i(-k);
    let y = [c[0] * i3 * exp2i(-k), c[1] * i3, c[2] * i2, c[3] * i1, c[4] * lead];
    let inverse = 1.0 / y[4];
    let split = split::split(y[0] * inverse, y[1] * inverse, y[2] * inverse, y[3] * inverse);
    let roots = split.and_then(|split| discs::roots::<P>(&y, &split)).or_else(|| factors::roots::<P>(&y))?;
    Some(roots.scaled(s))
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
