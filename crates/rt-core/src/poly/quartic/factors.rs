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
    let ((d0, e0), (d1, e1), (d2, e2), (d3, e3)) = (d0, d1, d2, d3);
    (s, [d0, d1, d2, d3, Double::from(c4)], [e0, e1, e2, e3])
}

/// The sum of numbers given as pairs, as if in four times the precision (Ogita, Rump and Oishi 2005, SumK,
/// doi:10.1137/030601818), and a bound of its error: 2^-100 of itself and, after four passes, 2^-190 of its terms.
#[inline(always)]
fn total<const N: usize>(pairs: [(f64, f64); N]) -> (Double, f64) {
    let mut high = pairs.map(|p| p.0);
    let size = sizes(high);
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
    let sum = Double::sum(high[N - 1], rest);
    (sum, sum.high.abs() * NOISE + size * exp2i(-190))
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
        let cancelled = sizes([v * v, ah * u * v, bh * u * u]);
        if !(determinant.abs() > exp2i(-40) * cancelled) {
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
        let noise = [al, m, bl, am, n, an, bm, bn].map(|x| NOISE * x.high);
        let [of_al, of_m, of_bl, of_am, of_n, of_an, of_bm, of_bn] = noise;
        let n3 = sizes([error[3], of_al, of_m]);
        let n2 = sizes([error[2], of_bl, of_am, of_n, da * dm]);
        // And the corrections are solved for in plain arithmetic: the determinant's relative error is below
        // 2^-50 times its cancellation.
        let blur = exp2i(-48) * cancelled * inverse;
        let n1 = sizes([error[1], of_an, of_bm, da * dn, db * dm, blur * sizes([r1, ah * k2, bh * r3])]);
        let n0 = sizes([error[0], of_bn, db * dn, blur * sizes([r0, bh * k2])]);
        let [ea, eb, em, en] = amplified([n0, n1, n2, n3], [ah, bh, l, m.high], [u, v], inverse);
        let (em, en) = (em + exp2i(-50) * dm.abs(), en + exp2i(-50) * dn.abs());
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

/// The sum of the absolute values: how far apart numbers may be that differ by so many parts.
#[inline(always)]
fn sizes<const N: usize>(parts: [f64; N]) -> f64 {
    parts.iter().fold(0.0, |sum, part| sum + part.abs())
}

/// How much `a`, `b`, `m` and `n` change at most when the coefficients of the product `(x^2 + a x + b) (l x^2 + m x + n)`
/// change by up to `n0` to `n3`, and room for plain arithmetic: by the equations of [`refined`], with `u = m - l a`,
/// `v = n - l b` and the inverse of their determinant.
#[inline(always)]
fn amplified([n0, n1, n2, n3]: [f64; 4], f: [f64; 4], [u, v]: [f64; 2], inverse: f64) -> [f64; 4] {
    let [[a, b, l, m], [u, v, _, _]] = [f, [u, v, 0.0, 0.0]].map(|f| f.map(f64::abs));
    let q2 = n2 + a * n3;
    let q1 = n1 + a * q2 + b * n3;
    let q0 = n0 + b * q2;
    let i = 2.0 * inverse.abs();
    let ea = i * (v * q1 + u * q0);
    let eb = i * ((v + a * u) * q0 + b * u * q1);
    [ea, eb, n3 + l * ea, 2.0 * (q2 + (a * l + m) * ea + l * eb)]
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
    let ed = sizes([h.high * em, em * em, l * en, NOISE * square.high, NOISE * product.high]);
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
    let eq = sizes([0.5 * em, ed / s.high, NOISE * q.high]);
    let (x, y) = (if l == 1.0 { q } else { q.div::<P>(Double::from(l)) }, n.div::<P>(q));
    let ex = eq / l.abs();
    let ey = sizes([en / q.high, y.high * eq / q.high, NOISE * y.high]);
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
    let error = sizes([en / m.high, x.high * em / m.high, NOISE * x.high]);
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
    found.iter().for_each(|root| roots.insert(root.x.to_f64(), root.multiplicity));
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

    /// The four numbers of two factors change by no more than is said when the product's coefficients do, whatever their
    /// signs and whichever of them; and not by much less, in the mean.
    #[test]
    fn changes_are_amplified_so_much() {
        let mut random = Random::new(2);
        let mut mean = [[0.0; 4]; 4];
        for case in 0..4000 {
            let size = |random: &mut Random| random.sign() * random.magnitude(-3.0, 3.0);
            let [a, b, m, n] = [(); 4].map(|()| size(&mut random));
            let l = if case % 2 == 0 { 1.0 } else { random.magnitude(-3.0, 3.0) };
            // The columns: what each of the four changes in the coefficients 0 to 3 of the product.
            let columns = [[n, m, l, 0.0], [0.0, n, m, l], [b, a, 1.0, 0.0], [0.0, b, a, 1.0]];
            let [of_b, of_a, of_n, of_m] = columns;
            let (u, v) = (m - l * a, n - l * b);
            let determinant = v * (v - a * u) + b * u * u;
            if determinant.abs() < 1e-3 * (v * v + (a * u * v).abs() + (b * u * u).abs()) {
                continue;
            }
            let inverse = 1.0 / determinant;
            for (single, mean) in mean.iter_mut().enumerate() {
                // One coefficient changes much more than the others.
                let change: [f64; 4] = core::array::from_fn(|k| if k == single { 1.0 } else { 1e-9 });
                let said = amplified(change, [a, b, l, m], [u, v], inverse);
                let system = [of_a, of_b, of_m, of_n];
                let alone: [f64; 4] = core::array::from_fn(|k| if k == single { 1.0 } else { 0.0 });
                let truth = solved(system, alone);
                for k in 0..4 {
                    let room = if k == 2 { 0.999 } else { 1.998 };
                    assert!(said[k] >= room * truth[k].abs(), "{single} {k} {said:?} {truth:?}");
                    // What would be nothing but for the other changes says nothing.
                    mean[k] += libm::log2(said[k] / (truth[k].abs() + 1e-3 * said[k]));
                }
            }
        }
        let found = mean.map(|row| row.map(|sum| sum / 4000.0));
        // By row the coefficient that changes most, by column a, b, m and n: as measured. Halves would show.
        let measured = [
            [0.979, 1.136, 0.988, 3.723],
            [0.978, 0.978, 1.000, 4.885],
            [2.386, 4.250, 2.386, 7.003],
            [1.815, 4.566, 3.717, 6.872],
        ];
        let near = |(found, measured): (&f64, &f64)| (found - measured).abs() < 0.02;
        assert!(found.iter().flatten().zip(measured.iter().flatten()).all(near), "{found:?}");
    }

    /// The solution of four linear equations, by columns, with pivots.
    fn solved(columns: [[f64; 4]; 4], right: [f64; 4]) -> [f64; 4] {
        let mut rows: [[f64; 5]; 4] =
            core::array::from_fn(|i| core::array::from_fn(|k| if k < 4 { columns[k][i] } else { right[i] }));
        for k in 0..4 {
            let pivot = (k..4).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs())).unwrap();
            rows.swap(k, pivot);
            for i in 0..4 {
                if i != k {
                    let share = rows[i][k] / rows[k][k];
                    let row = rows[k];
                    rows[i].iter_mut().zip(row).for_each(|(x, y)| *x -= share * y);
                }
            }
        }
        core::array::from_fn(|k| rows[k][4] / rows[k][k])
    }

    struct Total([(f64, f64); 5]);

    impl Task for Total {
        type Output = ((Double, f64), Double, f64);
        fn run<P: Product>(self) -> Self::Output {
            let mut truth = crate::expansion::Expansion::ZERO;
            let mut size = 0.0;
            for (high, low) in self.0 {
                truth.add(low);
                truth.add(high);
                size += high.abs();
            }
            let found = total(self.0);
            truth.add(-found.0.high);
            truth.add(-found.0.low);
            (found, truth.rounded(), size)
        }
    }

    /// Sums that cancel, down to nothing and to any share of their terms, are within their bound, which is no wider than
    /// derived.
    #[test]
    fn totals_and_their_errors() {
        let mut random = Random::new(3);
        for _ in 0..4000 {
            let number = |random: &mut Random, size: f64| {
                let high = random.sign() * random.uniform(0.5, 1.0) * size;
                (high, high * exp2i(-54) * random.uniform(-1.0, 1.0))
            };
            let size = random.magnitude(-20.0, 20.0);
            let (second, third) = (size * random.magnitude(-20.0, 0.0), size * random.magnitude(-60.0, 0.0));
            let [a, b] = [number(&mut random, size), number(&mut random, second)];
            // Against the first: all of it, or all but its last bits.
            let against = if random.once_in(2) { (-a.0, -a.1) } else { (-a.0, a.1) };
            let last = if random.once_in(3) { (0.0, 0.0) } else { number(&mut random, third) };
            let rest = if random.once_in(2) { (-b.0, -b.1) } else { (b.0, b.1) };
            let mut pairs = [a, b, against, rest, last];
            pairs.rotate_left(random.below(5) as usize);
            let ((sum, error), off, size) = run(Total(pairs));
            assert!(off.high.abs() <= error, "{pairs:?} {sum:?} {off:?} {error:e}");
            let bound = exp2i(-99) * sum.high.abs() + exp2i(-190) * size;
            assert!((0.99 * bound..=1.01 * bound).contains(&error), "{error:e} {bound:e}");
        }
    }

    struct Roots2<'a>([Double; 3], [f64; 2], &'a mut Roots<4, Double>);

    impl Task for Roots2<'_> {
        type Output = bool;
        fn run<P: Product>(self) -> bool {
            let Roots2([n, m, l], [em, en], found) = self;
            factor::<P>(l.high, m, n, em, en, 0.0, &[1.0, 0.0, 0.0, 0.0, 1.0], found)
        }
    }

    /// The roots of a factor that is known within errors: what is said is true of all such factors, and it is said where it
    /// is true of them all with little room.
    #[test]
    fn factors_within_errors() {
        let mut random = Random::new(4);
        let mut count = [[0; 2]; 3];
        for case in 0..20_000 {
            // Near a double root, or not; the errors of a size that may matter there, one or the other or both.
            let apart = random.magnitude(-12.0, 0.0);
            let square = apart * apart * if case % 2 == 0 { 1.0 } else { -1.0 };
            let x = random.sign() * random.uniform(0.5, 2.0);
            let l = if case % 3 == 0 { 1.0 } else { random.uniform(1.0, 2.0) * random.magnitude(-2.0, 2.0) };
            let m = Double::from(-2.0 * x).scale::<crate::kernel::Dekker>(l);
            let n =
                (Double::product::<crate::kernel::Dekker>(x, x) - square).scale::<crate::kernel::Dekker>(l);
            let size = if random.once_in(2) {
                apart * apart * random.magnitude(-1.0, 1.0)
            } else {
                apart * random.magnitude(-20.0, -15.0)
            };
            let kind = random.below(3);
            let em = if kind != 1 { size * m.high.abs() } else { 0.0 };
            let en = if kind != 0 { size * n.high.abs() } else { 0.0 };
            let mut found = Roots::<4, Double>::default();
            let known = run(Roots2([n, m, Double::from(l)], [em, en], &mut found));
            // Discriminant and roots of the worst factors.
            let d = |sm: f64, sn: f64| {
                let h = (m + sm * em).scale_exact(-0.5);
                h.square::<crate::kernel::Dekker>() - (n + sn * en).scale::<crate::kernel::Dekker>(l)
            };
            let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
            let [least, most] =
                signs.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], &(sm, sn)| {
                    let d = d(sm, sn).high;
                    [least.min(d), most.max(d)]
                });
            let root = |sm: f64, sn: f64, side: f64| {
                let s = d(sm, sn).sqrt::<crate::kernel::Dekker>();
                let h = (m + sm * em).scale_exact(-0.5);
                (if side > 0.0 { h + s } else { h - s }).div::<crate::kernel::Dekker>(Double::from(l))
            };
            let off = |x: Double, side: f64| {
                signs.iter().fold(0.0_f64, |off, &(sm, sn)| {
                    off.max((root(sm, sn, side) - x).high.abs() / x.high.abs())
                })
            };
            if known {
                match found.len() {
                    0 => assert!(most < 0.0, "{m:?} {n:?} {l} {em:e} {en:e}"),
                    2 => {
                        assert!(least > 0.0, "{m:?} {n:?} {l} {em:e} {en:e}");
                        let (x, y) = (found[0].x, found[1].x);
                        let (x, y) = if x < y { (x, y) } else { (y, x) };
                        for (x, side) in [(x, -1.0), (y, 1.0)] {
                            assert!(
                                off(x, side) <= LEFT,
                                "{m:?} {n:?} {l} {em:e} {en:e}: {:e}",
                                off(x, side) / LEFT
                            );
                        }
                    }
                    _ => panic!("{found:?}"),
                }
                count[found.len()][0] += 1;
            } else {
                // A sixth of the discriminant, or of what may be left of a root, is at stake.
                let d = d(0.0, 0.0).high;
                assert!(
                    d > 0.0 || most > -0.4 * (most - least) - 1e-28 * m.high * m.high,
                    "{d:e} {least:e} {most:e}"
                );
                if least > 0.5 * (most - least) + 1e-28 * m.high * m.high {
                    let worst = [-1.0, 1.0]
                        .into_iter()
                        .map(|side| off(root(0.0, 0.0, side), side))
                        .fold(0.0, f64::max);
                    assert!(
                        worst > LEFT / 6.0 || d < 1e-10 * m.high * m.high,
                        "{m:?} {n:?} {l} {em:e} {en:e}: {:e}",
                        worst / LEFT
                    );
                    count[1][1] += 1;
                }
                count[1][0] += 1;
            }
        }
        assert!(count[0][0] > 6000 && count[1][1] > 4000 && count[2][0] > 1400, "{count:?}");
    }
}
