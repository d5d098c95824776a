//! Nearly equal roots: both quadratic factors in double-double.
//!
//! Two roots that nearly meet share a factor (see [`split`](super::split)), and the factors are well conditioned even
//! when the roots are not. One or two steps of Newton's method on the four unknown coefficients, with residuals in
//! double-double, bring them to about 2^-95; the signs of the discriminants then decide, and the roots follow from the
//! quadratic formula in double-double. A bound of every error is carried along: what it does not settle is left to
//! the careful solver. When all roots lie near one place the polynomial is first developed about their mean.

use super::super::Roots;
use super::super::exact::multiple_root;
use super::super::scaled::Polynomial;
use super::discs::LEFT;
use super::split::{Factor, split};
use crate::double::{Double, two_sum};
use crate::kernel::Product;
use crate::math::exp2i;

/// Relative error of a sum of a few double-double products, with room to spare: each is within 10 u^2.
const NOISE: f64 = exp2i(-99);

/// The real roots of `c`, `1 <= |c4| < 2`, or `None` in doubt.
#[inline(never)]
pub(super) fn roots<P: Product>(c: &[f64; 5]) -> Option<Roots<4>> {
    let inverse = 1.0 / c[4];
    let monic = |c: [f64; 4]| split(c[0] * inverse, c[1] * inverse, c[2] * inverse, c[3] * inverse);
    let t = 0.25 * c[3] * inverse;
    if c[0] == 0.0 {
        // A cubic: the factor with the root 0 is x (c4 x + n).
        let [f, g] = monic([c[0], c[1], c[2], c[3]])?;
        let (f, g) = if g.constant == 0.0 { (f, g) } else { (g, f) };
        let [c1, c2, c3, c4] = [c[1], c[2], c[3], c[4]].map(Double::from);
        let second = [0.0, c[4], c[4] * g.linear];
        let mut roots = refined::<P>(&[c1, c2, c3, c4, Double::ZERO], &[0.0; 4], 0.0, &f, &second, c)?;
        roots.insert(0.0, 1);
        return Some(roots);
    }
    let (origin, d, error) = if (c[2] * inverse - 6.0 * t * t).abs() < t * t {
        developed::<P>(c, -t)
    } else {
        (0.0, c.map(Double::from), [0.0; 4])
    };
    let [f, g] = monic([d[0].high, d[1].high, d[2].high, d[3].high])?;
    refined::<P>(&d, &error, origin, &f, &[c[4], c[4] * g.linear, c[4] * g.constant], c)
}

/// A place near `s`, the coefficients in powers of `x` less that place, and bounds of their errors (the leading one is
/// exact).
///
/// The place has 24 bits, so `3 s^2` and `6 s^2` are exact, `s^3` and `s^4` are sums of two numbers, and every term of the
/// coefficients is a sum of at most four: the cancellation among them costs nothing.
#[inline(always)]
fn developed<P: Product>(c: &[f64; 5], s: f64) -> (f64, [Double; 5], [f64; 4]) {
    let s = f64::from_bits(s.to_bits() & !((1 << 29) - 1));
    let s2 = s * s;
    let (s3, s3e) = P::two_product(s2, s);
    let (s4, s4e) = P::two_product(s2, s2);
    let [c0, c1, c2, c3, c4] = *c;
    let d3 = total([P::two_product(4.0 * c4, s), (c3, 0.0)]);
    let d2 = total([P::two_product(c4, 6.0 * s2), P::two_product(c3, 3.0 * s), (c2, 0.0)]);
    let d1 = total([
        P::two_product(4.0 * c4, s3),
        P::two_product(4.0 * c4, s3e),
        P::two_product(c3, 3.0 * s2),
        P::two_product(c2, 2.0 * s),
        (c1, 0.0),
    ]);
    let d0 = total([
        P::two_product(c4, s4),
        P::two_product(c4, s4e),
        P::two_product(c3, s3),
        P::two_product(c3, s3e),
        P::two_product(c2, s2),
        P::two_product(c1, s),
        (c0, 0.0),
    ]);
    let (origin, s) = (s, s.abs());
    // Each total is exact but for 2^-100 of itself and, after four passes, 2^-190 of its terms.
    let size = [
        (((c4.abs() * s + c3.abs()) * s + c2.abs()) * s + c1.abs()) * s + c0.abs(),
        ((4.0 * c4.abs() * s + 3.0 * c3.abs()) * s + 2.0 * c2.abs()) * s + c1.abs(),
        (6.0 * c4.abs() * s + 3.0 * c3.abs()) * s + c2.abs(),
        4.0 * c4.abs() * s + c3.abs(),
    ];
    let error = |d: Double, size: f64| d.high.abs() * NOISE + size * exp2i(-190);
    let errors = [error(d0, size[0]), error(d1, size[1]), error(d2, size[2]), error(d3, size[3])];
    (origin, [d0, d1, d2, d3, Double::from(c4)], errors)
}

/// The sum of numbers given as pairs, as if in four times the precision (Ogita, Rump and Oishi 2005, SumK,
/// doi:10.1137/030601818).
#[inline(always)]
fn total<const N: usize>(pairs: [(f64, f64); N]) -> Double {
    let mut high = pairs.map(|p| p.0);
    let mut low = pairs.map(|p| p.1);
    for _ in 0..3 {
        for i in 1..N {
            (low[i], low[i - 1]) = two_sum(low[i], low[i - 1]);
        }
        (high[0], low[N - 1]) = two_sum(high[0], low[N - 1]);
        for i in 1..N {
            (high[i], high[i - 1]) = two_sum(high[i], high[i - 1]);
        }
    }
    let mut rest = low[0];
    for &l in &low[1..] {
        rest += l;
    }
    for &h in &high[..N - 1] {
        rest += h;
    }
    Double::sum(high[N - 1], rest)
}

/// The roots of `c`, whose coefficients have these errors, from the factors `f` and `second` (descending powers). `whole` is
/// the given polynomial, of which `c` is the development about `origin`, perhaps divided by `x`.
#[inline(always)]
fn refined<P: Product>(
    c: &[Double; 5],
    error: &[f64; 4],
    origin: f64,
    f: &Factor,
    second: &[f64; 3],
    whole: &[f64; 5],
) -> Option<Roots<4>> {
    // (x^2 + a x + b) (l x^2 + m x + n)
    let (mut a, mut b) = (Double::from(f.linear), Double::from(f.constant));
    let [l, m, n] = *second;
    let (mut m, mut n) = (Double::from(m), Double::from(n));
    for _ in 0..4 {
        let am = a.mul::<P>(m);
        let an = a.mul::<P>(n);
        let bm = b.mul::<P>(m);
        let bn = b.mul::<P>(n);
        let al = a.scale::<P>(l);
        let bl = b.scale::<P>(l);
        let r3 = (c[3] - al - m).to_f64();
        let r2 = (c[2] - bl - am - n).to_f64();
        let r1 = (c[1] - an - bm).to_f64();
        let r0 = (c[0] - bn).to_f64();
        let (ah, bh) = (a.high, b.high);
        let (u, v) = (m.high - al.high, n.high - bl.high);
        // Eliminating dm = r3 - l da and dn leaves two equations for da and db; their determinant is the resultant.
        let k2 = r2 - ah * r3;
        let e1 = r1 - ah * k2 - bh * r3;
        let e0 = r0 - bh * k2;
        let w = v - ah * u;
        let determinant = v * w + bh * u * u;
        // The determinant must be known to a few bits at least: 2^-40 leaves twelve.
        if !(determinant.abs() > exp2i(-40) * (v * v + (ah * u * v).abs() + (bh * u * u).abs())) {
            return None;
        }
        let inverse = 1.0 / determinant;
        let da = (v * e1 - u * e0) * inverse;
        let db = (w * e0 + bh * u * e1) * inverse;
        let dm = r3 - l * da;
        let dn = k2 + (ah * l - m.high) * da - l * db;
        a = a + da;
        b = b + db;
        m = m + dm;
        n = n + dn;
        // What the residuals do not show: roundings, the coefficients' own errors, the products of two corrections.
        let n3 = error[3] + NOISE * (al.high.abs() + m.high.abs());
        let n2 = error[2] + NOISE * (bl.high.abs() + am.high.abs() + n.high.abs()) + (da * dm).abs();
        let n1 = error[1] + NOISE * (an.high.abs() + bm.high.abs()) + (da * dn).abs() + (db * dm).abs();
        let n0 = error[0] + NOISE * bn.high.abs() + (db * dn).abs();
        // And the corrections are solved for in plain arithmetic: the determinant's relative error is below
        // 2^-50 times its cancellation.
        let blur = exp2i(-48) * (v * v + (ah * u * v).abs() + (bh * u * u).abs()) * inverse.abs();
        let q2 = n2 + ah.abs() * n3;
        let q1 = n1 + ah.abs() * q2 + bh.abs() * n3 + blur * (r1.abs() + (ah * k2).abs() + (bh * r3).abs());
        let q0 = n0 + bh.abs() * q2 + blur * (r0.abs() + (bh * k2).abs());
        let i = 2.0 * inverse.abs();
        let ea = i * (v.abs() * q1 + u.abs() * q0);
        let eb = i * ((v.abs() + (ah * u).abs()) * q0 + (bh * u).abs() * q1);
        let em = n3 + l.abs() * ea + exp2i(-50) * dm.abs();
        let en = 2.0 * (q2 + ((ah * l).abs() + m.high.abs()) * ea + l.abs() * eb) + exp2i(-50) * dn.abs();
        let mut found = Roots::<4, Double>::default();
        let known = factor::<P>(1.0, a, b, ea, eb, origin, whole, &mut found)
            && if l == 0.0 {
                linear::<P>(m, n, em, en, &mut found)
            } else {
                factor::<P>(l, m, n, em, en, origin, whole, &mut found)
            };
        if known {
            let mut roots = Roots::default();
            for root in found.iter() {
                roots.insert((root.x + origin).to_f64(), root.multiplicity);
            }
            return Some(roots);
        }
        // Newton's method squares the error: when the products of corrections no longer count, no step will help.
        if (da * dm).abs() <= NOISE * c[2].high.abs() && (db * dn).abs() <= NOISE * c[0].high.abs() {
            return None;
        }
    }
    None
}

/// Adds the roots of `l x^2 + m x + n` if their number and their digits are certain.
#[inline(always)]
#[allow(clippy::too_many_arguments)] // one factor: three coefficients, two errors and where it belongs
fn factor<P: Product>(
    l: f64,
    m: Double,
    n: Double,
    em: f64,
    en: f64,
    origin: f64,
    whole: &[f64; 5],
    found: &mut Roots<4, Double>,
) -> bool {
    let h = m.scale_exact(-0.5);
    let square = h.square::<P>();
    let product = n.scale::<P>(l);
    let d = square - product;
    let ed = h.high.abs() * em + em * em + l.abs() * en + NOISE * (square.high + product.high.abs());
    if d.high < -ed {
        return true;
    }
    let sharp = |z: Double, e: f64| e <= LEFT * (z.high + origin).abs();
    if !(d.high > ed) {
        // A double root, if anything: only the exact test can say so.
        let x = if l == 1.0 { h } else { h.div::<P>(Double::from(l)) };
        let place = x + origin;
        if em <= exp2i(-60) * (place.high * l).abs()
            && multiple_root::<P>(&Polynomial::new(&whole.map(Double::from)), place) == Some(2)
        {
            found.push(x, 2);
            return true;
        }
        return false;
    }
    let s = d.sqrt::<P>();
    let q = if h.high >= 0.0 { h + s } else { h - s };
    let eq = 0.5 * em + ed / s.high + NOISE * q.high.abs();
    let (x, y) = (if l == 1.0 { q } else { q.div::<P>(Double::from(l)) }, n.div::<P>(q));
    let ex = eq / l.abs();
    let ey = (en + y.high.abs() * eq) / q.high.abs() + NOISE * y.high.abs();
    if !(sharp(x, ex) && sharp(y, ey)) {
        return false;
    }
    found.push(x, 1);
    found.push(y, 1);
    true
}

/// Adds the root of `m x + n` if its digits are certain.
#[inline(always)]
fn linear<P: Product>(m: Double, n: Double, em: f64, en: f64, found: &mut Roots<4, Double>) -> bool {
    let x = -n.div::<P>(m);
    let error = (en + x.high.abs() * em) / m.high.abs() + NOISE * x.high.abs();
    found.push(x, 1);
    error <= LEFT * x.high.abs()
}

/// The real roots of `n + m x + l x^2`, all coefficients within 2^+-200 of 1 or `m` zero; `None` in doubt.
#[inline(always)]
pub(in super::super) fn quadratic<P: Product>(n: f64, m: f64, l: f64) -> Option<Roots<4>> {
    let mut found = Roots::<4, Double>::default();
    // The sign of the discriminant is exact outside the bound, and the error of the factor's coefficients zero.
    let whole = [n, m, l, 0.0, 0.0];
    if !factor::<P>(l, Double::from(m), Double::from(n), 0.0, 0.0, 0.0, &whole, &mut found) {
        return None;
    }
    let mut roots = Roots::default();
    found.iter().for_each(|root| roots.insert(root.x.to_f64() + 0.0, root.multiplicity));
    Some(roots)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{are_the_roots, two_factors};
    use super::*;
    use crate::kernel::{Task, run};
    use crate::testing::Random;

    /// A polynomial of which only neighbours are known.
    struct Neighbour<'a>(&'a [f64; 5], &'a [Double; 5], &'a [f64; 4]);

    impl Task for Neighbour<'_> {
        type Output = Option<Roots<4>>;
        fn run<P: Product>(self) -> Self::Output {
            let Neighbour(whole, c, error) = self;
            let inverse = 1.0 / whole[4];
            let [f, g] =
                split(c[0].high * inverse, c[1].high * inverse, c[2].high * inverse, c[3].high * inverse)?;
            let second = [whole[4], whole[4] * g.linear, whole[4] * g.constant];
            refined::<P>(c, error, 0.0, &f, &second, whole)
        }
    }

    /// Coefficients that err by as much as is said lead to no wrong answer, and to one where their errors are small.
    #[test]
    fn errors_of_the_coefficients_count() {
        let mut random = Random::new(1);
        let mut count = [0; 5];
        for _ in 0..20_000 {
            let near = random.magnitude(-8.0, -1.0);
            let (c, _) = two_factors(&mut random, near, 0.0);
            // So large that the discriminant of a factor may change its sign, or any.
            let size = if random.once_in(2) {
                near * near * random.magnitude(-2.0, 1.0)
            } else {
                random.magnitude(-26.0, -8.0)
            };
            let single = random.below(8) as usize;
            let error: [f64; 4] =
                core::array::from_fn(|k| if single > 3 || single == k { size * c[k].abs() } else { 0.0 });
            let moved: [Double; 5] = core::array::from_fn(|k| {
                let off = error.get(k).map_or(0.0, |error| error * random.sign() * random.uniform(0.8, 1.0));
                Double::from(c[k]) + off
            });
            if let Some(roots) = run(Neighbour(&c, &moved, &error)) {
                count[roots.len()] += 1;
                assert!(are_the_roots(&c, &roots), "{c:?} {error:?}: {roots:?}");
            } else {
                count[1] += u32::from(size < 1e-24);
            }
        }
        let [none, left, two, _, four] = count;
        assert!(none > 2500 && two > 800 && four > 240 && left < 350, "{count:?}");
    }
}
