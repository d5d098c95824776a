//! The careful solver: real roots between critical points, in double-double, exactly where that is not enough.
//!
//! Between two neighbouring critical points (the roots of the derivative, found in the same way) a polynomial is
//! monotone, so its signs there tell how many roots there are, and each lies in a bracket. A sign is taken from
//! double-double arithmetic when the value exceeds the bound of its error; otherwise an exact test settles whether
//! the critical point is a multiple root, and if not, the polynomial is developed about the point, by exact expansions,
//! which resolves what is smaller by another factor 2^-100.
//!
//! The roots are refined by Newton's method kept inside the bracket by bisection.

use super::Roots;
use super::exact::{multiple_root, shifted};
use super::scaled::{Polynomial, Value, ldexp};
use crate::double::Double;
use crate::kernel::Product;
use crate::math::{exp2i, exponent, sqrt};

/// All real roots of the polynomial with these coefficients (ascending powers, finite).
pub(super) fn solve<P: Product, const N: usize>(c: &[Double]) -> Roots<N, Double> {
    if c.iter().all(|c| c.high == 0.0) {
        return Roots::everything();
    }
    let mut p = Polynomial::new(c);
    let mut zeros = 0;
    while p.vanishes_at_zero() {
        p = p.deflated();
        zeros += 1;
    }
    let nonzero = monotone_roots::<P>(&p, true);
    let mut roots = Roots::default();
    for root in nonzero.iter() {
        // A root that underflows keeps its place: the least root has the sign of -c0/c1, nearly, and the others are far.
        if zeros > 0 && (root.x.high > 0.0 || root.x.high == 0.0 && p.falls_through_zero()) {
            roots.push(Double::ZERO, zeros);
            zeros = 0;
        }
        roots.push(root.x, root.multiplicity);
    }
    if zeros > 0 {
        roots.push(Double::ZERO, zeros);
    }
    roots
}

/// A place where the sign is known.
#[derive(Clone, Copy)]
struct Knot {
    x: Double,
    sign: i32,
    /// The distance at which a parabola through this critical point vanishes, or infinity.
    reach: f64,
}

/// Where roots are told apart into small and large ones: no `f64` is within 2^-54 of it, relative, so that a root
/// belongs to the same side in both ways of computing it.
const PARTING: Double = Double { high: exp2i(-900), low: exp2i(-954) };

/// The roots of a polynomial of degree up to four. `exact`: decide multiple roots by the exact test.
///
/// Below 2^-960 a double-double loses its low part, and below 2^-1074 everything: when there may be such roots, the
/// small ones are found in the variable `x 2^1600`. The least root there can be, a ratio of two `f64`, is
/// above 2^-2100.
fn monotone_roots<P: Product>(p: &Polynomial, exact: bool) -> Roots<4, Double> {
    let mut roots = Roots::default();
    if p.degree() == 0 {
        return roots;
    }
    if p.least_exponent() < -960 {
        return small_and_large::<P>(p, exact);
    }
    let [left, right] = ends::<P>(p);
    between::<P>(p, &critical::<P>(p), left, right, exact, &mut roots);
    roots
}

fn small_and_large<P: Product>(p: &Polynomial, exact: bool) -> Roots<4, Double> {
    let mut roots = Roots::default();
    let at = |x: Double| Knot { x, sign: sign_of(p.at::<P>(x).value), reach: f64::INFINITY };
    let [left, right] = ends::<P>(p);
    let large = right.x.high > PARTING.high;
    let critical = if large { critical::<P>(p) } else { Roots::default() };
    if large {
        between::<P>(p, &critical, left, at(-PARTING), exact, &mut roots);
    }
    let end = PARTING.scale_exact(exp2i(800)).scale_exact(exp2i(800));
    let small = monotone_roots::<P>(&p.in_units(-1600), exact);
    for root in small.iter().filter(|root| (root.x - end).high < 0.0 && (root.x + end).high > 0.0) {
        roots.push(reduced(root.x), root.multiplicity);
    }
    if large {
        between::<P>(p, &critical, at(PARTING), right, exact, &mut roots);
    }
    roots
}

/// `y 2^-1600`; its high part is the nearest `f64` even where that is subnormal.
fn reduced(y: Double) -> Double {
    let y = y.scale_exact(exp2i(-700));
    let high = y.high * exp2i(-900);
    let low = ((y.high - high * exp2i(900)) + y.low) * exp2i(-900);
    Double::sum(high, low)
}

/// Places beyond all roots, or the greatest numbers.
fn ends<P: Product>(p: &Polynomial) -> [Knot; 2] {
    let bound = p.bound_exponent();
    let end = if bound > 1023 { f64::MAX } else { ldexp(1.0, bound) };
    [-1, 1].map(|side| {
        let x = Double::from(end.copysign(f64::from(side)));
        let sign = if bound <= 1023 { p.sign_at_infinity(side) } else { sign_of(p.at::<P>(x).value) };
        Knot { x, sign, reach: f64::INFINITY }
    })
}

fn critical<P: Product>(p: &Polynomial) -> Roots<4, Double> {
    if p.degree() > 1 { monotone_roots::<P>(&p.derivative(), false) } else { Roots::default() }
}

/// Appends the roots between two places, neither of them a root, given the critical points.
fn between<P: Product>(
    p: &Polynomial,
    critical: &Roots<4, Double>,
    left: Knot,
    right: Knot,
    exact: bool,
    roots: &mut Roots<4, Double>,
) {
    let mut from = left;
    for c in critical.iter().filter(|c| c.x > left.x && c.x < right.x) {
        let knot = match plain_knot::<P>(p, c.x) {
            Some(knot) => knot,
            None => {
                let multiple = multiple_root::<P>(p, c.x);
                let knot = if multiple.is_none() { developed_knot::<P>(p, c.x) } else { None };
                let multiple =
                    multiple.or(if knot.is_none() && !exact { Some(c.multiplicity + 1) } else { None });
                if let Some(multiplicity) = multiple {
                    roots.push(c.x, multiplicity);
                    // Past a root of even order the sign is the one before, past one of odd order the other.
                    let sign = if multiplicity % 2 == 0 { from.sign } else { -from.sign };
                    from = Knot { x: c.x, sign, reach: 0.0 };
                    continue;
                }
                // Not a multiple root, and too near to one to say on which side: as if on neither.
                knot.unwrap_or(Knot { x: c.x, sign: from.sign, reach: 0.0 })
            }
        };
        if from.sign * knot.sign < 0 {
            let root = refine::<P>(p, from, knot);
            roots.push(root, 1);
        }
        from = knot;
    }
    if from.sign * right.sign < 0 {
        let root = refine::<P>(p, from, right);
        roots.push(root, 1);
    }
}

fn sign_of(value: Double) -> i32 {
    if value.high > 0.0 {
        1
    } else if value.high < 0.0 {
        -1
    } else {
        0
    }
}

/// The sign at a critical point, if double-double tells it.
#[inline(always)]
fn plain_knot<P: Product>(p: &Polynomial, x: Double) -> Option<Knot> {
    let v = p.at::<P>(x);
    if v.value.high.abs() <= v.error {
        return None;
    }
    let reach = sqrt((v.value.high / v.curvature).abs());
    Some(Knot { x, sign: sign_of(v.value), reach: ldexp(reach, v.exponent) })
}

/// The sign at a critical point, from the polynomial developed about it: about the rounded point the value, the slope and
/// the curvature are exact to double-double each.
fn developed_knot<P: Product>(p: &Polynomial, x: Double) -> Option<Knot> {
    let about = shifted::<P>(p, x.high);
    let mut y = Double::from(x.low);
    let v = about.at::<P>(y);
    let step = ldexp(-0.5 * v.slope / v.curvature, v.exponent);
    if step.abs() <= x.high.abs() * exp2i(-50) {
        y = y + step;
    }
    let v = about.at::<P>(y);
    let knot = Knot { x, sign: sign_of(v.value), reach: 0.0 };
    if v.value.high.abs() > v.error { Some(knot) } else { None }
}

/// The root between two places of opposite sign, to about 2^-60 of its size.
fn refine<P: Product>(p: &Polynomial, from: Knot, to: Knot) -> Double {
    let (mut low, mut high) = (from.x, to.x);
    // Start where the parabola of the nearer end vanishes, or between equal ones: mirrored questions go mirrored ways.
    let mut x = if from.reach < to.reach {
        low + from.reach
    } else if to.reach < from.reach {
        high - to.reach
    } else {
        middle(low, high)
    };
    // About a point of a cluster double-double does not resolve the root: then the polynomial is developed there.
    let mut origin = 0.0;
    let mut local = *p;
    let mut last = f64::INFINITY;
    // Newton's method squares the error: from 2^-1 to 2^-64 in six steps, and usually takes 3 to 6. Far from two nearly
    // equal roots it only halves the distance, so after six steps in a row the bracket is halved instead: in the
    // order of the representable numbers, of which there are 2^64 and 2^53 low parts to each, or at least shortened by a
    // third where the mean is taken. Twice 7 (64 + 53) steps are more than enough.
    let mut in_a_row = 0;
    for _ in 0..1638 {
        if !(x > low && x < high) {
            x = middle(low, high);
        }
        let at: Value = local.at::<P>(x - origin);
        let slope = at.slope.abs();
        let step = ldexp(-at.value.to_f64() / at.slope, at.exponent);
        let root = x + step;
        let tolerance = root.high.abs().min(x.high.abs()) * exp2i(-62);
        let noise = ldexp(at.error / slope, at.exponent);
        let doubtful = at.value.high.abs() <= at.error;
        if !doubtful {
            if sign_of(at.value) == from.sign {
                low = x;
            } else {
                high = x;
            }
        }
        // What Newton's method leaves: the curvature's share of the square of the step.
        let left = (step * ldexp(step, -at.exponent) * (at.curvature / at.slope)).abs();
        // The step itself is known to a few units of 2^-53 of its own size.
        let left = left.max(step.abs() * exp2i(-50));
        if left <= tolerance && noise <= tolerance && step.is_finite() {
            // Once more: what is left then is the noise, far below what rounding to `f64` shows, and polynomials that are
            // the same but for their scale round alike.
            let at = local.at::<P>(root - origin);
            let root = root + ldexp(-at.value.to_f64() / at.slope, at.exponent);
            return if root < low {
                low
            } else if root > high {
                high
            } else {
                root
            };
        }
        if doubtful || (noise > tolerance && step.abs() <= x.high.abs() * exp2i(-40)) {
            if origin == x.high {
                // Developed about this very place already: x is as near as can be told.
                return x;
            }
            origin = x.high;
            local = shifted::<P>(p, origin);
            continue;
        }
        if (high - low).high <= tolerance {
            return x;
        }
        let short = step.abs() <= 0.5 * last;
        last = if short { step.abs() } else { f64::INFINITY };
        if short && in_a_row < 6 && root > low && root < high {
            in_a_row += 1;
            x = root;
        } else {
            in_a_row = 0;
            x = middle(low, high);
        }
    }
    x
}

/// A place that halves the bracket: the mean of the ends when they are near each other, otherwise of their exponents.
fn middle(low: Double, high: Double) -> Double {
    let (a, b) = (low.high, high.high);
    let near = exponent(b - a) < exponent(if a.abs() > b.abs() { a } else { b });
    if near {
        return (low.scale_exact(0.5)) + high.scale_exact(0.5);
    }
    // The order of the bits of `f64` is that of their absolute values; zero has one sign.
    let key = |x: f64| if x < 0.0 { -((-x).to_bits() as i64) } else { (x + 0.0).to_bits() as i64 };
    let mean = (i128::from(key(a)) + i128::from(key(b))) / 2;
    let mean = mean as i64;
    Double::from(if mean < 0 { -f64::from_bits(mean.unsigned_abs()) } else { f64::from_bits(mean as u64) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// The middle of a bracket lies in it, that of the mirrored one is mirrored, and halving towards any place ends at two
    /// neighbouring numbers after as many steps as there are binary digits in a number, exponent and all.
    #[test]
    fn middles() {
        let mut random = Random::new(1);
        for case in 0..2000 {
            let number = |random: &mut Random| match case % 4 {
                0 => random.sign() * random.magnitude(-300.0, 300.0),
                1 => random.uniform(-1.0, 1.0),
                2 => 1.0 + random.magnitude(-15.0, -1.0),
                _ => random.sign() * random.magnitude(-320.0, -290.0),
            };
            let [a, b, c] = [(); 3].map(|()| number(&mut random));
            let (mut low, mut high) = (a.min(b).min(c), a.max(b).max(c));
            let target = a.max(b).min(a.min(b).max(c));
            let mut steps = 0;
            while low.next_up() < high && low < high {
                let m = middle(Double::from(low), Double::from(high));
                let mirrored = middle(Double::from(-high), Double::from(-low));
                assert_eq!((m.high, m.low), (-mirrored.high, -mirrored.low), "{low:e} {high:e}");
                let m = m.high;
                assert!(m >= low && m <= high, "{low:e} {high:e} {m:e}");
                if m == low || m == high {
                    break;
                }
                if m <= target {
                    low = m
                } else {
                    high = m
                }
                steps += 1;
            }
            assert!(low.next_up().next_up() >= high, "{low:e} {high:e}");
            assert!(steps <= 68, "{steps} {a:e} {b:e} {c:e}");
        }
    }

    /// Small numbers in their own unit become `f64`, to the nearest where that is subnormal.
    #[test]
    fn reduced_numbers() {
        let mut random = Random::new(2);
        for _ in 0..2000 {
            let k = random.below(170) as i32 - 120;
            let high = random.sign() * random.uniform(1.0, 2.0) * exp2i(500 + k);
            let low = high * exp2i(-54) * random.uniform(-1.0, 1.0);
            let found = reduced(Double::sum(high, low));
            // Once more with a subnormal sum in mind: the number over the least step, to the nearest.
            let steps = high * exp2i(-526) + low * exp2i(-526);
            let (whole, unit) = if steps.abs() < exp2i(52) {
                (libm::rint(steps), f64::from_bits(1))
            } else {
                (high * exp2i(-600), exp2i(-1000))
            };
            let expected = whole * unit;
            assert!(
                (found.high - expected).abs()
                    <= if steps.abs() < exp2i(52) { 0.0 } else { expected.abs() * exp2i(-52) },
                "{found:?} {expected:e} {steps}"
            );
        }
    }
}
