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

/// The ways short of the careful solver: plain `f64` with a certificate, then both factors in double-double.
#[inline(always)]
pub(in super::super) fn quick<P: Product>(c: &[f64; 5]) -> Option<Roots<4>> {
    let (y, exponent, spread) = balanced(c)?;
    let monic = |y: &[f64; 5]| {
        let inverse = 1.0 / y[4];
        split::split(y[0] * inverse, y[1] * inverse, y[2] * inverse, y[3] * inverse)
    };
    let mut roots = monic(&y).and_then(|f| discs::roots::<P>(&y, &f));
    if roots.is_none() && spread {
        // Roots of very different size: the small ones are the great ones of the reversed polynomial.
        let reversed = monic(&[y[4], y[3], y[2], y[1], y[0]]);
        roots = reversed.and_then(|f| discs::roots::<P>(&y, &f.map(|f| f.reversed())));
    }
    let roots = roots.or_else(|| factors::roots::<P>(&y))?;
    Some(roots.scaled(exp2i(exponent)))
}

/// The coefficients for `x = y 2^k`, divided by a power of two, so that the leading one is at least 1 and less than 2
/// and the greatest root about 1; `k`; and whether the roots may differ much in size. `None` if some product in the
/// evaluation at a root could leave the range in which products are exact.
#[inline(always)]
fn balanced(c: &[f64; 5]) -> Option<([f64; 5], i32, bool)> {
    /// Below every difference of exponents.
    const NOTHING: i32 = -3000;
    let e = c.map(|c| if c == 0.0 { NOTHING } else { exponent(c) });
    let [e0, e1, e2, e3, e4] = e;
    let normal = |e: i32| e == NOTHING || e > -1023;
    if e4 == NOTHING || !e.iter().all(|&e| normal(e)) {
        return None;
    }
    // The exponent of the greatest root, about.
    let k = (e3 - e4).max((e2 - e4) >> 1).max((e1 - e4).div_euclid(3)).max((e0 - e4) >> 2);
    // That of the least root but zero, about: x^4 must stay above 2^-968, the low parts included.
    let least = if e0 != NOTHING {
        let of = |e: i32, k: i32| if e == NOTHING { i32::MAX } else { (e0 - e).div_euclid(k) };
        of(e1, 1).min(of(e2, 2)).min(of(e3, 3)).min(of(e4, 4))
    } else if e1 != NOTHING {
        let of = |e: i32, k: i32| if e == NOTHING { i32::MAX } else { (e1 - e).div_euclid(k) };
        of(e2, 1).min(of(e3, 2)).min(of(e4, 3))
    } else {
        return None;
    };
    if !(k.abs() < 300 && least - k > -200) {
        return None;
    }
    let mut y = [0.0; 5];
    for i in 0..5 {
        if e[i] != NOTHING {
            let shift = e[i] - e4 - k * (4 - i as i32);
            // The mantissa with the new exponent; the least one is that of c0, 4 * 200 below.
            let mantissa = c[i].to_bits() & !(0x7ff << 52);
            y[i] = f64::from_bits(mantissa | (((shift + 1023).max(0) as u64) << 52));
        }
    }
    Some((y, k, k - least > 4))
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
#[doc(hidden)]
pub fn tier(c: [f64; 5]) -> usize {
    struct T([f64; 5]);
    impl Task for T {
        type Output = usize;
        #[inline(always)]
        fn run<P: Product>(self) -> usize {
            tier_of::<P>(&self.0)
        }
    }
    run(T(c))
}
fn tier_of<P: Product>(c: &[f64; 5]) -> usize {
    let Some((y, _, spread)) = balanced(c) else { return 3 };
    let monic = |y: &[f64; 5]| {
        let inverse = 1.0 / y[4];
        split::split(y[0] * inverse, y[1] * inverse, y[2] * inverse, y[3] * inverse)
    };
    if monic(&y).and_then(|s| discs::roots::<P>(&y, &s)).is_some() {
        return 0;
    }
    if spread
        && monic(&[y[4], y[3], y[2], y[1], y[0]])
            .and_then(|f| discs::roots::<P>(&y, &f.map(|f| f.reversed())))
            .is_some()
    {
        return 0;
    }
    if factors::roots::<P>(&y).is_some() { 1 } else { 2 }
}
