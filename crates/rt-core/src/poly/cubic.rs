//! Degree three.

use super::quartic::discs::{LEFT, compensated};
use super::{Roots, Simple, quartic};
use crate::Interval;
use crate::kernel::{Product, Solver, solve};
use crate::math::{exp2i, exponent, sqrt};

/// The real roots inside `within` of `c[0] + c[1] x + c[2] x^2 + c[3] x^3`.
///
/// Exact coefficients, special cases and promises as for [`quartic()`](super::quartic()): the exact number of roots, multiple roots
/// decided exactly, simple ones within 0.51 units in the last place. By a closed form in `f64` whose
/// discriminant has a certain sign, corrected with a bound of what is left; as the quartic divided by `x` where that
/// does not do, and where that leaves a doubt by the careful solver between critical points.
///
/// ```
/// let roots = rt_core::poly::cubic([-2.0, 2.0, -1.0, 1.0], rt_core::Interval::FORWARD);
/// assert_eq!((roots.len(), roots[0].x), (1, 1.0));
/// ```
pub fn cubic(c: [f64; 4], within: Interval) -> Roots<3> {
    solve::<Cubic>([c[0], c[1], c[2], c[3], 0.0], within)
}

struct Cubic;

impl Solver for Cubic {
    type Output = Roots<3>;
    #[inline(always)]
    fn solve<P: Product>([c0, c1, c2, c3, _]: [f64; 5], within: Interval) -> Roots<3> {
        match quick::<P>([c0, c1, c2, c3]) {
            Some(roots) => roots.inside(&within),
            None => general::<P>(c0, c1, c2, c3, within),
        }
    }
}

#[cold]
#[inline(never)]
fn general<P: Product>(c0: f64, c1: f64, c2: f64, c3: f64, within: Interval) -> Roots<3> {
    if !(c0.is_finite() && c1.is_finite() && c2.is_finite() && c3.is_finite()) {
        return Roots::default();
    }
    quartic::all_roots::<P>(&[c0, c1, c2, c3, 0.0]).within(within)
}

/// The `f64` way for coefficients of moderate size: closed form and certificate.
#[inline(always)]
pub(super) fn quick<P: Product>(c: [f64; 4]) -> Option<Simple<3>> {
    // Exponents from -64 to 63, or zero in the middle: less the least exponent, the upper four bits are zero.
    let beyond = |c: f64| c.to_bits().wrapping_sub(exp2i(-64).to_bits()) & (15 << 59);
    let ends = beyond(c[0]) | beyond(c[3]);
    let nothing = |c: f64| c == 0.0;
    if ends | beyond(c[1]) | beyond(c[2]) != 0
        && !(ends == 0 && (beyond(c[1]) == 0 || nothing(c[1])) && (beyond(c[2]) == 0 || nothing(c[2])))
    {
        return None;
    }
    formula::<P>(&c)
}

/// The roots if the outer coefficients are normal numbers, brought to about 1 by exact scaling: with the very bits of the
/// quick way. `None` in doubt. The coefficients may stand for others within 2^-116 of the magnitudes of the terms: that is
/// far below every bound.
#[inline(never)]
pub(super) fn balanced<P: Product>(c: &[f64; 4]) -> Option<Roots<4>> {
    let e = c.map(exponent);
    // x = y 2^k with k a third of the difference of the outer exponents, and the leading coefficient brought to about 1.
    let k = (e[0] - e[3]).div_euclid(3);
    let mut y = [0.0; 4];
    for (i, y) in y.iter_mut().enumerate() {
        if c[i] != 0.0 {
            let shift = e[i] - e[3] - k * (3 - i as i32);
            // 128 is the most that the quick way admits, less the third and the rounding of the outer ones.
            if e[i] == -1023 || shift.abs() > 132 {
                return None;
            }
            *y = f64::from_bits(c[i].to_bits() & !(0x7ff << 52) | exp2i(shift).to_bits());
        }
    }
    // Half of k and again: k itself may be beyond the exponents of `f64`.
    let roots = formula::<P>(&y)?.inside(&Interval::LINE);
    let roots = roots.scaled(exp2i(k >> 1)).scaled(exp2i(k - (k >> 1)));
    if roots.iter().all(|root| root.x.is_normal()) { Some(roots) } else { None }
}

/// The number of roots by the sign of the discriminant, a first approximation by radicals or by the cosine, and one or
/// two corrections with a bound of what they leave.
///
/// The outer coefficients are not zero, and the sixth power of a root times the leading coefficient stays in the range.
#[inline(always)]
fn formula<P: Product>(c: &[f64; 4]) -> Option<Simple<3>> {
    const THIRD: f64 = 1.0 / 3.0;
    let [c0, c1, c2, c3] = *c;
    // u = c3 x: u^3 + c2 u^2 + b u + d; u = v - t: v^3 + 3 q v + n.
    let (t, b, d) = (c2 * THIRD, c1 * c3, c0 * c3 * c3);
    let t2 = t * t;
    let q = b * THIRD - t2;
    let n = d - t * (b - 2.0 * t2);
    // v = y or -y: y^3 + 3 q y = 2 h, h not negative. For n = 0 the sign changes with that of the polynomial as well.
    let h = 0.5 * n.abs();
    let sign = 1f64.copysign(if n == 0.0 { t } else { -n });
    let discriminant = h * h + q * q * q;
    // The roundings of q stay below 6 u of the magnitudes of its terms, those of h below 10 u, u = 2^-53: those of the
    // discriminant are below 24 u of these.
    let q_size = b.abs() * THIRD + t2;
    let h_size = 0.5 * (d.abs() + t.abs() * (b.abs() + 2.0 * t2));
    let doubt = exp2i(-48) * (h_size * h_size + q_size * q_size * q_size);
    let inverse = 1.0 / c3;
    let back = |y: f64| (sign * y - t) * inverse;
    if discriminant > doubt {
        // Cardano: a - b with a^3 - b^3 = 2 h and a b = q, without its cancellation.
        let cube = h + sqrt(discriminant);
        let r = inverse_cube_root(cube);
        let (a, b) = (cube * r * r, q * r);
        let y = polished(2.0 * h / (a * a + q + b * b), q, h);
        one::<P>(c, back(y), sign * c3, y, q, q_size)
    } else if discriminant < -doubt {
        // Viete: 2 sqrt(-q) cos(acos(z) / 3), the cosine by its best polynomial of degree 4, within 6e-6.
        let root = sqrt(-q);
        let z = h * root * (1.0 / (q * q));
        let cosine = COSINE[0] + z * (COSINE[1] + z * (COSINE[2] + z * (COSINE[3] + z * COSINE[4])));
        let y = polished(2.0 * root * cosine, q, h);
        // What division by v - y leaves is v^2 + y v + y^2 + 3 q.
        let half = 0.5 * y;
        let root = sqrt(-3.0 * (q + half * half));
        three::<P>(c, [back(y), back(root - half), back(-root - half)])
    } else {
        None
    }
}

/// `cos(acos(z) / 3)` for `0 <= z <= 1`.
const COSINE: [f64; 5] = [0.866_030_43, 0.166_411_72, -0.045_921_93, 0.017_512_19, -0.004_035_4];

/// The root of `y^3 + 3 q y - 2 h` near `y` by Halley's method, of third order: from 6e-6 to the roundings.
#[inline(always)]
fn polished(y: f64, q: f64, h: f64) -> f64 {
    let y2 = y * y;
    let f = (y2 + 3.0 * q) * y - 2.0 * h;
    let slope = 3.0 * (y2 + q);
    y - f * slope / (slope * slope - 3.0 * y * f)
}

/// The reciprocal cube root of a positive normal number, to 2.2e-6.
#[inline(always)]
fn inverse_cube_root(x: f64) -> f64 {
    // Minus a third of the bits is minus a third of the logarithm, read linearly between powers of two; the constant is
    // four thirds of the bias, less the mean error of that reading. What is missing is a function of x r^3, from 0.9 to
    // 1.106, by its best polynomial.
    let r = f64::from_bits(0x553e_f000_0000_0000 - x.to_bits() / 3);
    let z = x * (r * r * r);
    r * ((1.729_460_8 - 1.297_972 * z) + z * z * (0.740_896_5 - 0.172_387_3 * z))
}

/// Three real roots.
#[inline(always)]
fn three<P: Product>(c: &[f64; 4], mut x: [f64; 3]) -> Option<Simple<3>> {
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let less = |a: f64, b: f64| if a < b { a } else { b };
    // Corrections at least square the relative error while the discs are apart: 1e-2 is below 2^-60 after four.
    for _ in 0..5 {
        let (p, size) = compensated::<P, 4, 3>(c, &x);
        let [d01, d02, d12] = [x[0] - x[1], x[0] - x[2], x[1] - x[2]];
        let g = [c[3] * d01 * d02, -c[3] * d01 * d12, c[3] * d02 * d12];
        let gap = [less(d01.abs(), d02.abs()), less(d01.abs(), d12.abs()), less(d02.abs(), d12.abs())];
        let mut w = [0.0; 3];
        let mut noise = [0.0; 3];
        for i in 0..3 {
            let inverse = 1.0 / g[i];
            w[i] = p[i] * inverse;
            noise[i] = (size[i] * inverse).abs() * exp2i(-100);
        }
        // A little more than 3, for the roundings.
        let reach = [w[0].abs() + noise[0], w[1].abs() + noise[1], w[2].abs() + noise[2]];
        let widest = 3.01 * greater(greater(reach[0], reach[1]), reach[2]);
        let mut apart = true;
        let mut done = true;
        for i in 0..3 {
            apart &= widest < 0.125 * gap[i];
            let next = x[i] - w[i];
            // |W| times the others' errors over their distances, multiplied by the distance.
            let left = w[i].abs() * (2.4 * widest + exp2i(-48) * gap[i]);
            done &= left <= (LEFT * next.abs() - noise[i]) * gap[i];
            x[i] = next;
        }
        if apart && done {
            let (a, b) = (less(x[0], x[1]), greater(x[0], x[1]));
            let (b, c) = (less(b, x[2]), greater(b, x[2]));
            return Some(Simple::All([less(a, b), greater(a, b), c]));
        }
        if !(x[0] + x[1] + x[2]).is_finite() {
            return None;
        }
    }
    None
}

/// The only real root, near `x`: `c3 x` is `v - t`, `v` is `y` with the sign of `lead`, `c3` is `lead` with a sign, and
/// `3 (y^2 + q)` is the slope there, in terms of `v`.
///
/// If `w` is Newton's correction in these terms and `e` the error, `e = w + e^2 y / (y^2 + q) - e^3 / (3 (y^2 + q))`
/// (the development ends there). If both terms are below `w / 200` for `e = w`, a solution lies near `w`, and there is
/// but one root. The slope's own error is below 20 u of the magnitudes.
#[inline(always)]
fn one<P: Product>(
    c: &[f64; 4],
    mut x: f64,
    lead: f64,
    mut y: f64,
    q: f64,
    q_size: f64,
) -> Option<Simple<3>> {
    for _ in 0..3 {
        let ([p], [size]) = compensated::<P, 4, 1>(c, &[x]);
        let inverse = 1.0 / (y * y + q);
        let w = p * (c[3] * (1.0 / 3.0) * inverse);
        let noise = (size * c[3] * inverse).abs() * exp2i(-100);
        let step = (w * lead).abs();
        let share = 1.1 * inverse * (step * (y + step) + exp2i(-47) * (y * y + q_size));
        let next = x - w;
        if !(share < exp2i(-8)) {
            return None;
        }
        if w.abs() * share <= LEFT * next.abs() - noise {
            return Some(Simple::One(next));
        }
        y -= w * lead;
        x = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::quadratic;
    use super::*;
    use crate::double::Double;
    use crate::kernel::{Task, run};
    use crate::testing::Random;

    /// `(x - r) ((x - re)^2 + s) lead`; for negative `s` of three real roots.
    fn cubic(r: f64, re: f64, s: f64, lead: f64) -> [f64; 4] {
        let (b, c) = (-2.0 * re, re * re + s);
        [-r * c * lead, (c - r * b) * lead, (b - r) * lead, lead]
    }

    /// Whether the list is right, to 0.51 units in the last place: by the careful solver.
    fn are_the_roots(c: &[f64; 4], found: &[crate::poly::Root]) -> bool {
        let truth = quartic::double([c[0], c[1], c[2], c[3], 0.0].map(Double::from));
        truth.len() == found.len()
            && truth.iter().zip(found).all(|(truth, root)| {
                (truth.x - root.x).high.abs() <= 0.51 * (root.x.abs().next_up() - root.x.abs())
            })
    }

    /// The only root from a place near it: `off` of its size away, in the terms of the formula.
    struct One([f64; 4], f64, f64);

    impl Task for One {
        type Output = Option<Roots<3>>;
        fn run<P: Product>(self) -> Self::Output {
            let One(c, r, off) = self;
            let (t, b) = (c[2] / 3.0, c[1] * c[3]);
            let v = (c[3] * r + t) * (1.0 + off);
            let (q, q_size) = (b / 3.0 - t * t, b.abs() / 3.0 + t * t);
            let found = one::<P>(&c, (v - t) / c[3], c[3].copysign(v * c[3]), v.abs(), q, q_size)?;
            Some(found.inside(&Interval::LINE))
        }
    }

    struct Quick([f64; 4]);

    impl Task for Quick {
        type Output = Option<Roots<3>>;
        fn run<P: Product>(self) -> Self::Output {
            Some(quick::<P>(self.0)?.inside(&Interval::LINE))
        }
    }

    /// What is certified is true, however far off the first approximation; and from near it is certified.
    #[test]
    fn one_root_is_certified_from_afar() {
        let mut random = Random::new(1);
        let mut count = [0; 2];
        for _ in 0..20_000 {
            // The real root farther from the middle of all three than the others from it: then it is the greatest in these terms.
            let (re, height) = (random.uniform(-1.0, 1.0), random.magnitude(-2.0, 0.0));
            let r = re + random.sign() * random.uniform(0.5, 3.0);
            let size = random.magnitude(-3.0, 3.0);
            let c = cubic(r * size, re * size, height * height * size * size, random.magnitude(-2.0, 2.0));
            // Up to a third: then the slope has the sign of that at the root, which is at least twice as far out as the extrema.
            let off = random.magnitude(-16.0, -0.5) * random.sign();
            let found = run(One(c, r * size, off));
            if let Some(found) = &found {
                assert!(are_the_roots(&c, found), "{c:?} {off:?}: {found:?}");
            }
            if off.abs() < 1e-4 {
                count[usize::from(found.is_some())] += 1;
            }
        }
        assert!(count[0] == 0 && count[1] > 15_000, "{count:?}");
    }

    /// What must not become slow unseen: the quick way answers until roots are nearer than this.
    #[test]
    fn nearly_equal_roots_are_told_quickly() {
        let mut random = Random::new(2);
        let mut count = [[0; 2]; 2];
        for _ in 0..20_000 {
            let r = random.uniform(0.5, 2.0) * random.sign();
            let apart = random.magnitude(-9.0, -1.0);
            let s = -apart * apart * 0.25 * random.sign();
            let c = cubic(r, r + random.sign(), s, random.magnitude(-2.0, 2.0));
            let found = run(Quick(c));
            if apart > 1e-4 {
                count[usize::from(s > 0.0)][usize::from(found.is_some())] += 1;
            }
            if let Some(found) = &found {
                assert!(are_the_roots(&c, found), "{c:?}: {found:?}");
            }
        }
        assert!(count.iter().all(|&[left, told]| left == 0 && told > 3000), "{count:?}");
    }

    struct Balanced([f64; 4]);

    impl Task for Balanced {
        type Output = Option<Roots<4>>;
        fn run<P: Product>(self) -> Self::Output {
            balanced::<P>(&self.0)
        }
    }

    struct BalancedQuadratic([f64; 3]);

    impl Task for BalancedQuadratic {
        type Output = Option<Roots<4>>;
        fn run<P: Product>(self) -> Self::Output {
            super::super::quadratic::balanced::<P>(&self.0, false)
        }
    }

    /// Of any size, roots have the very bits that the quick way gives those of ordinary size.
    #[test]
    fn balanced_as_quick() {
        let mut random = Random::new(3);
        let listed = |roots: &[crate::poly::Root], k: i32| {
            roots.iter().map(|root| (root.x * exp2i(k), root.multiplicity)).collect::<alloc::vec::Vec<_>>()
        };
        let mut answered = 0;
        for _ in 0..4000 {
            let r = random.uniform(0.5, 2.0) * random.sign();
            let c = cubic(r, random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0), random.uniform(0.5, 2.0));
            let (place, value) = (random.below(400) as i32 - 200, random.below(300) as i32 - 150);
            let at = |k: usize| exp2i(value - place * k as i32);
            let scaled = [c[0] * at(0), c[1] * at(1), c[2] * at(2), c[3] * at(3)];
            if let Some(quick) = run(Quick(c)) {
                let found = run(Balanced(scaled)).expect("as quickly as of ordinary size");
                assert_eq!(listed(&found, -place), listed(&quick, 0), "{c:?} {place} {value}");
                answered += 1;
            }
            let c = [c[0], c[1], c[2]];
            let quick = quadratic(c, Interval::LINE);
            if let Some(found) = run(BalancedQuadratic([scaled[0], scaled[1], scaled[2]])) {
                assert_eq!(listed(&found, -place), listed(&quick, 0), "{c:?} {place} {value}");
            } else {
                assert!((c[1] * c[1] - 4.0 * c[0] * c[2]).abs() < 1e-6 || c[0] * c[2] == 0.0, "{c:?}");
            }
        }
        assert!(answered > 3900, "{answered}");
    }

    /// The quick way is for coefficients with exponents from -64 to 63, or zeros in the middle.
    #[test]
    fn what_the_quick_way_takes() {
        let (least, most) = (exp2i(-64), exp2i(64));
        for (x, taken) in [
            (1.0, true),
            (least, true),
            (least.next_down(), false),
            (most.next_down(), true),
            (most, false),
            (1e300, false),
            (1e-300, false),
            (f64::NAN, false),
        ] {
            for k in 0..4 {
                for sign in [1.0, -1.0] {
                    // Of like size, so that all roots are about 1.
                    let mut c =
                        [1.0, 3.5, -2.25, 1.5].map(|c| if taken { c * x.clamp(1e-18, 1e18) } else { c });
                    if taken {
                        c = c.map(|c| if c.abs() >= most { c * exp2i(-4) } else { c });
                        c = c.map(|c| if c.abs() < least { c * exp2i(4) } else { c });
                    }
                    c[k] = sign * x;
                    assert!(taken || run(Quick(c)).is_none(), "{c:?}");
                }
            }
        }
        for c in [
            [1.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, -3.5, 1.0],
            [1.0, -3.5, 0.0, 1.0],
            [least, least, least, -least],
        ] {
            assert!(run(Quick(c)).is_some(), "{c:?}");
        }
        for c in [[0.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 0.0]] {
            assert!(run(Quick(c)).is_none(), "{c:?}");
        }
    }
}
