//! The default method: as little precision as each polynomial needs, and a certificate at every stage.
//!
//! 1. In `f64`: two quadratic [factors](split), their roots corrected with a compensated residual, and inclusion
//!    [discs](discs) that prove how many roots are real and how near each answer is. All but nearly multiple roots end here.
//! 2. In double-double: both [factors] refined until the signs of their discriminants are certain; a discriminant that is
//!    zero as far as can be told is put to the exact test for a double root.
//! 3. What is left, clusters of three or four roots and roots of wildly different size, goes to the careful solver between
//!    critical points, with exact expansions.

use super::super::{Roots, bracket};
use super::split::Factor;
use super::{discs, factors, split};
use crate::Interval;
use crate::double::Double;
use crate::kernel::{Product, Solver, Task, run, solve};
use crate::math::{exp2i, exponent};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2 + c[3] x^3 + c[4] x^4`.
///
/// The coefficients are exact numbers of any size; leading zeros lower the degree. With a NaN or infinite coefficient there are
/// no roots; the zero polynomial lists none and says so with [`Roots::all`]; a root beyond the range of `f64` is left
/// out, one below it is rounded to zero or a subnormal number. Roots are ascending and compared with the interval after
/// rounding. A double root is listed once with multiplicity 2; two different roots that round to one number are
/// listed twice.
///
/// Promised: the exact number of roots, multiple roots decided exactly; simple roots within 0.51 units in the last place,
/// that is 1.02 u of their value, u = 2^-53. Measured against 512-bit isolation on 51,000 hard quartics (`tests/truth_quartics.rs`
/// runs a part): no wrong count, largest error 1.0 u. Not decided exactly, only to about 2^-200 of the magnitude of the terms:
/// on which side of a tangent a polynomial without a multiple root lies. Scaling by powers of two
/// is exact as long as nothing leaves the range of normal numbers; the bits do not depend on the machine.
///
/// Sources: Ferrari's method; Smith 1970 (doi:10.1145/321574.321579) for the discs; Graillat, Langlois and Louvet 2005 for the compensated
/// residual; Gauss's lemma and Shewchuk 1997 (doi:10.1007/PL00009321) for the exact test.
///
/// ```
/// use rt_core::{Interval, poly};
///
/// // (x - 1)^2 (x^2 - 2), and the same with the double root pulled apart by the least amount.
/// let roots = poly::quartic([-2.0, 4.0, -1.0, -2.0, 1.0], Interval::LINE);
/// assert_eq!(roots.iter().map(|root| root.multiplicity).collect::<Vec<_>>(), [1, 2, 1]);
/// let roots = poly::quartic([-2.0, 4.0, -1.0_f64.next_up(), -2.0, 1.0], Interval::LINE);
/// assert_eq!(roots.len() % 2, 0);
/// ```
pub fn quartic(c: [f64; 5], within: Interval) -> Roots<4> {
    if !c.iter().all(|c| c.is_finite()) {
        return Roots::default();
    }
    solve::<Quartic>(c, within)
}

/// The real roots of a quartic whose coefficients (ascending powers) are given in double-double, in double-double.
///
/// For coefficients that are themselves computed, such as those of a ray and a torus. Every root is found between critical
/// points and good to about 2^-60 of its size or, in a cluster, of the size of the cluster's place; a multiple root is what the given
/// numbers cannot tell from one, about 2^-200 of the magnitude of the terms. With a NaN or infinite coefficient there are
/// no roots. Slower than [`quartic`] by a factor of ten.
pub fn double(c: [Double; 5]) -> Roots<4, Double> {
    if !c.iter().all(|c| c.high.is_finite() && c.low.is_finite()) {
        return Roots::default();
    }
    run(Careful { c })
}

struct Quartic;

impl Solver for Quartic {
    type Output = Roots<4>;
    #[inline(always)]
    fn solve<P: Product>(c: [f64; 5], within: Interval) -> Roots<4> {
        all_roots::<P>(&c).inside(within)
    }
}

/// All real roots of a polynomial of any degree up to four, finite coefficients.
#[inline(always)]
pub(in super::super) fn all_roots<P: Product>(c: &[f64; 5]) -> Roots<4> {
    if !(c[0] != 0.0 && c[4] != 0.0) {
        return lower::<P>(c).unwrap_or_else(|| doubtful::<P>(c, false));
    }
    // A polynomial and its mirror image go the same way: what is rounded, is rounded alike.
    let odd = if c[3] != 0.0 { c[3] } else { c[1] };
    let turned = odd != 0.0 && (odd > 0.0) != (c[4] > 0.0);
    let side = if turned { -1.0 } else { 1.0 };
    let c = [c[0], c[1] * side, c[2], c[3] * side, c[4]];
    let roots = quick::<P>(&c).unwrap_or_else(|| doubtful::<P>(&c, true));
    if turned { roots.mirrored() } else { roots }
}

/// Zero roots taken out, and lower degrees: what the cubic's own quick way leaves is a quartic divided by `x`.
#[inline(never)]
fn lower<P: Product>(c: &[f64; 5]) -> Option<Roots<4>> {
    let zeros = c.iter().take_while(|&&c| c == 0.0).count();
    let degree = c.iter().rposition(|&c| c != 0.0)?;
    let mut d = [0.0; 5];
    d.iter_mut().zip(c.iter().skip(zeros)).for_each(|(d, &c)| *d = c);
    let with_zeros = |roots: Roots<4>| {
        let mut all = Roots::default();
        roots.iter().filter(|root| root.x != 0.0).for_each(|root| all.insert(root.x, root.multiplicity));
        if zeros > 0 {
            all.insert(0.0, zeros as u32);
        }
        all
    };
    match degree - zeros {
        0 => Some(with_zeros(Roots::default())),
        1 => {
            let x = -d[0] / d[1];
            // Too small for any digits, or too large to be listed.
            if !x.is_normal() {
                return None;
            }
            let mut roots = Roots::default();
            roots.push(x, 1);
            Some(with_zeros(roots))
        }
        2 => super::super::quadratic::balanced::<P>(&[d[0], d[1], d[2]], true).map(with_zeros),
        3 => {
            let roots = super::super::cubic::balanced::<P>(&[d[0], d[1], d[2], d[3]]);
            roots.or_else(|| quick::<P>(&[0.0, d[0], d[1], d[2], d[3]])).map(with_zeros)
        }
        _ => None,
    }
}

#[inline(never)]
fn doubtful<P: Product>(c: &[f64; 5], whole: bool) -> Roots<4> {
    if whole && let Some(roots) = torn::<P>(c) {
        return roots;
    }
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
    let mut roots = if spread > GAP { parted(&y).and_then(|f| discs::roots::<P>(&y, &f)) } else { None };
    if roots.is_none() {
        roots = monic(&y).and_then(|f| discs::roots::<P>(&y, &f));
    }
    if roots.is_none() && spread > 4 && y[0] != 0.0 {
        // Roots of very different size: the small ones are the great ones of the reversed polynomial.
        roots = reversed(&y, spread).and_then(|f| discs::roots::<P>(&y, &f));
    }
    let roots = roots.or_else(|| factors::roots::<P>(&y))?;
    Some(roots.scaled(exp2i(exponent)))
}

/// Roots that are apart by more than this power of two are taken apart before anything is computed: what is left of the
/// others' influence, 2^-30 or so, goes with the first corrections.
const GAP: i32 = 30;

/// Where the roots fall apart into small and large ones: the place in the coefficients, and the power of two between them.
///
/// With the exponents `e` the small ones, those of `c[0] + .. + c[j] x^j`, are not much beyond the greatest of
/// `(e[i] - e[j]) / (j - i)`, and the large ones, those of `c[j] + .. + c[n] x^(n - j)`, not much below the least of
/// `(e[j] - e[k]) / (k - j)` (Newton's polygon).
#[inline(always)]
fn widest_gap<const N: usize>(c: &[f64; N]) -> (usize, i32) {
    let e = c.map(exponent);
    let mut widest = (0, 0);
    for j in 1..N - 1 {
        let small = (0..j).map(|i| (e[i] - e[j]).div_euclid((j - i) as i32) + 1).max().unwrap_or(0);
        let large = (j + 1..N).map(|k| (e[j] - e[k]).div_euclid((k - j) as i32)).min().unwrap_or(0);
        if c[j] != 0.0 && large - small > widest.1 {
            widest = (j, large - small);
        }
    }
    widest
}

/// The approximate factors of a quartic whose roots are of very different size; `None` if they are not.
#[inline(never)]
fn parted(c: &[f64; 5]) -> Option<[Factor; 2]> {
    let [c0, c1, c2, c3, c4] = *c;
    let factor = |c0: f64, c1: f64, c2: f64| Factor { linear: c1 / c2, constant: c0 / c2 };
    let of = |x: f64, y: f64| Factor { linear: -(x + y), constant: x * y };
    match widest_gap(c) {
        (1, GAP..) => {
            let (x, rest) = parted_cubic(&[c1, c2, c3, c4]);
            Some([of(x, -c0 / c1), rest])
        }
        (2, GAP..) => Some([factor(c2, c3, c4), factor(c0, c1, c2)]),
        (3, GAP..) => {
            let (x, rest) = parted_cubic(&[c0, c1, c2, c3]);
            Some([of(x, -c3 / c4), rest])
        }
        _ => None,
    }
}

/// The roots of a quartic that falls into two polynomials which do not feel each other: each is the product of the other's
/// nearest coefficient and a power series in which a step is below 2^-118. `None` in doubt.
#[inline(never)]
fn torn<P: Product>(c: &[f64; 5]) -> Option<Roots<4>> {
    use super::super::{cubic, quadratic};
    let linear = |c0: f64, c1: f64| {
        let x = -c0 / c1;
        let mut roots = Roots::default();
        roots.push(x, 1);
        if x.is_normal() { Some(roots) } else { None }
    };
    let [c0, c1, c2, c3, c4] = *c;
    if c.iter().any(|&c| c != 0.0 && !c.is_normal()) {
        return None;
    }
    let (one, other): (Roots<4>, Roots<4>) = match widest_gap(c) {
        (1, 120..) => (linear(c0, c1)?, cubic::balanced::<P>(&[c1, c2, c3, c4])?),
        (2, 120..) => {
            (quadratic::balanced::<P>(&[c0, c1, c2], false)?, quadratic::balanced::<P>(&[c2, c3, c4], false)?)
        }
        (3, 120..) => (linear(c3, c4)?, cubic::balanced::<P>(&[c0, c1, c2, c3])?),
        _ => return None,
    };
    let mut roots = one;
    other.iter().for_each(|root| roots.insert(root.x, root.multiplicity));
    Some(roots)
}

/// An approximate root and the factor of the others, of a cubic.
#[inline(always)]
fn parted_cubic(c: &[f64; 4]) -> (f64, Factor) {
    let [c0, c1, c2, c3] = *c;
    match widest_gap(c) {
        (1, GAP..) => (-c0 / c1, Factor { linear: c2 / c3, constant: c1 / c3 }),
        (2, GAP..) => (-c2 / c3, Factor { linear: c1 / c2, constant: c0 / c2 }),
        _ => split::cubic(c0 / c3, c1 / c3, c2 / c3),
    }
}

/// The factors by way of the reversed polynomial, whose greatest root is about `2^spread`.
#[inline(never)]
fn reversed(y: &[f64; 5], spread: i32) -> Option<[split::Factor; 2]> {
    let s = exp2i(-spread);
    let inverse = 1.0 / y[0];
    let f = split::split(
        y[4] * inverse * s * s * s * s,
        y[3] * inverse * s * s * s,
        y[2] * inverse * s * s,
        y[1] * inverse * s,
    )?;
    Some(f.map(|f| f.reversed(exp2i(spread))))
}

/// The coefficients for `x = y 2^k`, divided by a power of two, so that the leading one is at least 1 and less than 2
/// and the greatest root about 1; `k`; and the logarithm of the ratio of the
/// greatest root to the least but zero. `None` if some product in the
/// evaluation at a root could leave the range in which products are exact.
#[inline(always)]
fn balanced(c: &[f64; 5]) -> Option<([f64; 5], i32, i32)> {
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
    Some((y, k, k - least))
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

#[cfg(test)]
mod tests {
    use super::super::tests::multiply_back;
    use super::*;
    use crate::testing::Random;

    /// Both first guesses for roots of different size are what their names say: factors of the polynomial.
    #[test]
    fn roots_of_different_size_fall_into_factors() {
        let mut random = Random::new(1);
        let mut seen = [0; 6];
        for case in 0..6000 {
            // Roots in groups; between the groups a factor of 2^70 or, for the reversed polynomial, of 2^10.
            let apart = case % 6;
            let gap = if apart == 0 { 10 } else { 70 };
            let mut power = 0;
            let roots: [f64; 4] = core::array::from_fn(|i| {
                let parted = match apart {
                    0 => i == 1,
                    1 => i == 1 || i == 2,
                    2 => i == 2 || i == 3,
                    n => i == n - 2,
                };
                power += i32::from(parted) * gap;
                random.sign() * random.uniform(0.3, 1.0) * f64::from(1 + i as u32) * exp2i(power)
            });
            let mut c = [1.0, 0.0, 0.0, 0.0, 0.0];
            for root in roots {
                c = core::array::from_fn(|k| if k == 0 { -root * c[0] } else { c[k - 1] - root * c[k] });
            }
            let (y, _, spread) = balanced(&c).unwrap();
            if apart > 0 {
                let factors = parted(&y).unwrap();
                assert!(multiply_back(&y, &factors, exp2i(-29)), "{c:?} {factors:?}");
                seen[apart] += 1;
            } else if let Some(factors) = reversed(&y, spread) {
                seen[0] += 1;
                assert!(multiply_back(&y, &factors, exp2i(-16)), "{c:?} {factors:?}");
            }
        }
        assert!(seen[0] > 990 && seen[1..] == [1000; 5], "{seen:?}");
    }

    /// Balanced, the leading coefficient is about 1 and so is the greatest root; the exponents of the greatest and the least
    /// root are told, whether or not zero is a root too; and each mantissa stays.
    #[test]
    fn balanced_coefficients() {
        let mut random = Random::new(3);
        for case in 0..4000 {
            let mut power = random.below(100) as i32 - 50;
            let mut roots: [f64; 4] = core::array::from_fn(|_| {
                power += random.below(if case % 2 == 0 { 30 } else { 2 }) as i32;
                random.sign() * random.uniform(1.0, 2.0) * exp2i(power)
            });
            let none = case % 4 == 1;
            if none {
                roots[0] = 0.0;
            }
            let lead = random.uniform(1.0, 2.0) * exp2i(random.below(100) as i32 - 50);
            let mut c = [lead, 0.0, 0.0, 0.0, 0.0];
            for root in roots {
                c = core::array::from_fn(|k| if k == 0 { -root * c[0] } else { c[k - 1] - root * c[k] });
            }
            let (y, k, spread) = balanced(&c).unwrap();
            let greatest = exponent(roots[3]);
            let least = exponent(roots[usize::from(none)]);
            assert!((greatest - 3..=greatest + 4).contains(&k), "{c:?} {k} {greatest}");
            assert!((k - least - 3..=k - least + 4).contains(&spread), "{c:?} {k} {spread} {least}");
            assert!((1.0..2.0).contains(&y[4].abs()));
            for (i, (y, c)) in y.into_iter().zip(c).enumerate() {
                assert_eq!(y == 0.0, c == 0.0);
                if c != 0.0 {
                    assert_eq!(y, c * exp2i(k * i as i32 - 4 * k) * exp2i(-exponent(lead)), "{c:?} {i}");
                }
            }
        }
        // Zero as a double root, a leading zero, numbers that are not normal, and roots beyond the range of products.
        for c in [
            [0.0, 0.0, 1.0, 2.0, 3.0],
            [1.0, 2.0, 3.0, 4.0, 0.0],
            [1.0, 1e-310, 0.0, 0.0, 1.0],
            [exp2i(-900), 1.0, 1.0, 1.0, 1.0],
            [1.0, 0.0, 0.0, exp2i(310), 1.0],
        ] {
            assert!(balanced(&c).is_none(), "{c:?}");
        }
    }

    struct Quick([f64; 5]);

    impl Task for Quick {
        type Output = Option<Roots<4>>;
        fn run<P: Product>(self) -> Self::Output {
            quick::<P>(&self.0)
        }
    }

    /// What must not become slow unseen: nothing but clusters of three or four roots goes to the careful solver.
    #[test]
    fn quick_ways_answer() {
        let (mut random, mut count) = (Random::new(2), [0; 3]);
        for case in 0..12_000 {
            let near = random.magnitude(-11.0, -1.0);
            let mut roots: [f64; 4] =
                core::array::from_fn(|i| random.sign() * (i as f64 + random.uniform(0.5, 1.0)));
            match case % 3 {
                0 => roots[1] = roots[0] + near,
                1 => roots.iter_mut().skip(2).for_each(|x| *x *= near),
                _ => {}
            }
            let mut c = [random.uniform(1.0, 2.0), 0.0, 0.0, 0.0, 0.0];
            for root in roots {
                c = core::array::from_fn(|k| if k == 0 { -root * c[0] } else { c[k - 1] - root * c[k] });
            }
            count[case % 3] += u32::from(run(Quick(c)).is_some());
        }
        assert!(count.iter().all(|&count| count > 3900), "{count:?}");
    }
}
