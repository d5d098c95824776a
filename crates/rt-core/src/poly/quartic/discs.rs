//! Simple roots from approximate factors, certified by inclusion discs.
//!
//! With approximations `z_i` to the four roots and Weierstrass's corrections `W_i = p(z_i) / (c4 prod (z_i - z_j))`, the
//! discs about `z_i` of radius `4 |W_i|` contain all roots, and a union of `k` discs apart from the others contains
//! `k` (Smith 1970, doi:10.1145/321574.321579). So a disc about a real place, apart from the others,
//! holds one root, which is real because the conjugate would be in it too; and a disc that misses the real axis holds none.
//!
//! `z_i - W_i` is the next approximation. If `e_j` are the errors, `W_i = e_i prod (1 + e_j / (z_i - z_j))`: the new
//! error is `|e_i|` times the sum of `4 |W_j| / |z_i - z_j|`, nearly.

use super::super::Roots;
use super::split::Factor;
use crate::kernel::Product;
use crate::math::{exp2i, sqrt};
use core::hint::select_unpredictable;

/// What is left of the error before the last rounding, relative: less than 2^-7 units in the last place, so that both
/// are within 0.51.
pub(in super::super) const LEFT: f64 = exp2i(-60);

/// The real roots of `c` from its approximate factors, correctly rounded or nearly so, and certainly all of them; or
/// `None` in doubt.
#[inline(always)]
pub(super) fn roots<P: Product>(c: &[f64; 5], factors: &[Factor; 2]) -> Option<Roots<4>> {
    let d = factors.map(|f| 0.25 * f.linear * f.linear - f.constant);
    match (d[0] > 0.0, d[1] > 0.0) {
        (true, true) => {
            let (x, y) = (real(&factors[0], d[0]), real(&factors[1], d[1]));
            four::<P>(c, [x[0], x[1], y[0], y[1]])
        }
        (true, false) => two::<P>(c, real(&factors[0], d[0]), &Pair::new(&factors[1], d[1])),
        (false, true) => two::<P>(c, real(&factors[1], d[1]), &Pair::new(&factors[0], d[0])),
        (false, false) => none(c, &Pair::new(&factors[0], d[0]), &Pair::new(&factors[1], d[1])),
    }
}

/// The roots of a factor with discriminant `d > 0`.
#[inline(always)]
pub(in super::super) fn real(f: &Factor, d: f64) -> [f64; 2] {
    let h = -0.5 * f.linear;
    let s = sqrt(d);
    let q = select_unpredictable(h >= 0.0, h + s, h - s);
    // Plus zero: the root 0 has no sign.
    [q, f.constant / q + 0.0]
}

/// `p(x)` by compensated Horner (Graillat, Langlois and Louvet 2005): within u |p| + 2^-100 of the sum of the magnitudes of
/// the terms, which comes second.
#[inline(always)]
pub(in super::super) fn compensated<P: Product, const M: usize, const N: usize>(
    c: &[f64; M],
    x: &[f64; N],
) -> ([f64; N], [f64; N]) {
    let mut s = [c[M - 1]; N];
    let mut e = [0.0; N];
    let mut size = [c[M - 1].abs(); N];
    for k in (0..M - 1).rev() {
        for i in 0..N {
            let (p, pe) = P::two_product(s[i], x[i]);
            let t = p + c[k];
            let b = t - p;
            let te = (p - (t - b)) + (c[k] - b);
            s[i] = t;
            e[i] = e[i] * x[i] + (pe + te);
            size[i] = size[i] * x[i].abs() + c[k].abs();
        }
    }
    for i in 0..N {
        s[i] += e[i];
    }
    (s, size)
}

/// Four real roots.
#[inline(always)]
fn four<P: Product>(c: &[f64; 5], mut x: [f64; 4]) -> Option<Roots<4>> {
    // Corrections at least square the relative error while the discs are apart: 1e-2 is below 2^-60 after four.
    for _ in 0..5 {
        let (p, size) = compensated::<P, 5, 4>(c, &x);
        let [d01, d02, d03, d12, d13, d23] =
            [x[0] - x[1], x[0] - x[2], x[0] - x[3], x[1] - x[2], x[1] - x[3], x[2] - x[3]];
        let g = [d01 * d02 * d03, -d01 * d12 * d13, d02 * d12 * d23, -d03 * d13 * d23];
        let mut w = [0.0; 4];
        let mut noise = [0.0; 4];
        let mut radius = [0.0; 4];
        for i in 0..4 {
            let inverse = 1.0 / (g[i] * c[4]);
            w[i] = p[i] * inverse;
            noise[i] = (size[i] * inverse).abs() * exp2i(-100);
            // A little more than 4, for the roundings.
            radius[i] = 4.01 * (w[i].abs() + noise[i]);
        }
        let i = [
            1.0 / d01.abs(),
            1.0 / d02.abs(),
            1.0 / d03.abs(),
            1.0 / d12.abs(),
            1.0 / d13.abs(),
            1.0 / d23.abs(),
        ];
        // The sum of the others' radii over their distances.
        let of = |j: [usize; 3], k: [usize; 3]| {
            radius[j[0]] * i[k[0]] + radius[j[1]] * i[k[1]] + radius[j[2]] * i[k[2]]
        };
        let share = [
            of([1, 2, 3], [0, 1, 2]),
            of([0, 2, 3], [0, 3, 4]),
            of([0, 1, 3], [1, 3, 5]),
            of([0, 1, 2], [2, 4, 5]),
        ];
        let mut apart = true;
        let mut done = true;
        for i in 0..4 {
            // Each radius at most an eighth of each distance: the discs are apart.
            apart &= share[i] < 0.125;
            let next = x[i] - w[i];
            done &= w[i].abs() * (1.2 * share[i] + exp2i(-48)) + noise[i] <= LEFT * next.abs();
            x[i] = next;
        }
        if apart && done {
            let mut roots = Roots::default();
            x.iter().for_each(|&x| roots.insert(x, 1));
            return Some(roots);
        }
        if !(share.iter().sum::<f64>() < 1e3) {
            return None;
        }
    }
    None
}

/// Two real roots and a pair.
#[inline(always)]
fn two<P: Product>(c: &[f64; 5], mut x: [f64; 2], z: &Pair) -> Option<Roots<4>> {
    let r = z.residual(c);
    for _ in 0..4 {
        let (p, size) = compensated::<P, 5, 2>(c, &x);
        let gap = x[0] - x[1];
        // |z - x_i|^2
        let far = [z.distance2(x[0]), z.distance2(x[1])];
        let g = [c[4] * gap * far[0], -c[4] * gap * far[1]];
        let radius_z = 4.01 * r / (2.0 * z.im * sqrt(far[0] * far[1]) * c[4].abs());
        let mut w = [0.0; 2];
        let mut noise = [0.0; 2];
        let mut radius = [0.0; 2];
        for i in 0..2 {
            let inverse = 1.0 / g[i];
            w[i] = p[i] * inverse;
            noise[i] = (size[i] * inverse).abs() * exp2i(-100);
            radius[i] = 4.01 * (w[i].abs() + noise[i]);
        }
        // The disc of the pair misses the axis by 3/4 of its height, and those on the axis, of a quarter of the distance
        // to it at most.
        let mut apart = radius_z + z.blur() < 0.25 * z.im;
        let mut done = true;
        let mut sum = 0.0;
        for i in 0..2 {
            let distance = sqrt(far[i]);
            let share = radius[1 - i] / gap.abs() + 2.0 * radius_z / distance;
            sum += share;
            apart &= share < 0.125 && radius[i] < 0.25 * distance;
            let next = x[i] - w[i];
            done &= w[i].abs() * (1.2 * share + exp2i(-48)) + noise[i] <= LEFT * next.abs();
            x[i] = next;
        }
        if apart && done {
            let mut roots = Roots::default();
            x.iter().for_each(|&x| roots.insert(x, 1));
            return Some(roots);
        }
        if !(sum < 1e3) || !(radius_z < 0.25 * z.im) {
            return None;
        }
    }
    None
}

/// No real root: two discs off the axis.
#[inline(always)]
fn none(c: &[f64; 5], z: &Pair, y: &Pair) -> Option<Roots<4>> {
    let lead = 2.0 * c[4].abs();
    // |f(z)| for the factor f of the other pair: (z - y) (z - conj y).
    let value = |z: &Pair, y: &Pair| {
        let re = z.re - y.re;
        let (a, b) = (re * re + (z.im - y.im) * (z.im - y.im), re * re + (z.im + y.im) * (z.im + y.im));
        sqrt(a * b)
    };
    let between = value(z, y);
    let clear =
        |z: &Pair| 4.01 * z.residual(c) <= 0.25 * z.im * (lead * z.im * between) && z.blur() < 0.25 * z.im;
    if clear(z) && clear(y) { Some(Roots::default()) } else { None }
}

/// A pair of conjugate complex roots.
struct Pair {
    linear: f64,
    constant: f64,
    re: f64,
    im: f64,
    modulus: f64,
}

impl Pair {
    /// The roots of a factor with discriminant `d <= 0`.
    #[inline(always)]
    fn new(f: &Factor, d: f64) -> Self {
        let constant = f.constant.max(0.0);
        Pair {
            linear: f.linear,
            constant: f.constant,
            re: -0.5 * f.linear,
            // Plus zero if it is zero: then no disc is small enough.
            im: sqrt(0.0 - d),
            modulus: sqrt(constant),
        }
    }

    /// How far the roots of the factor may be from `re + i im`: the discriminant is rounded to 2^-52 of the constant
    /// term, and a square root passes on half of that over itself.
    #[inline(always)]
    fn blur(&self) -> f64 {
        exp2i(-50) * self.constant.abs() / self.im
    }

    #[inline(always)]
    fn distance2(&self, x: f64) -> f64 {
        (x - self.re) * (x - self.re) + self.im * self.im
    }

    /// A bound of `|p(z)|`, from the remainder of the division by the factor. Its roundings are below 2^-46 of the sum of the
    /// magnitudes: 8 operations a step, and up to k + 1 copies of the k-th term.
    #[inline(always)]
    fn residual(&self, c: &[f64; 5]) -> f64 {
        let (a, b) = (self.linear, self.constant);
        let c3 = c[3] - a * c[4];
        let c2 = c[2] - a * c3 - b * c[4];
        let r1 = c[1] - a * c2 - b * c3;
        let r0 = c[0] - b * c2;
        let m = self.modulus;
        let size = (((c[4].abs() * m + c[3].abs()) * m + c[2].abs()) * m + c[1].abs()) * m + c[0].abs();
        r1.abs() * m + r0.abs() + exp2i(-46) * size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// The residual is no less than the value at the root of the factor, nor than what roundings may hide of it.
    #[test]
    fn a_residual_bounds_the_value() {
        let mut random = Random::new(1);
        for case in 0..2000 {
            let mut c: [f64; 5] = core::array::from_fn(|_| random.uniform(-2.0, 2.0));
            let (re, im) = (random.uniform(-3.0, 3.0), random.uniform(0.1, 3.0));
            let f = Factor { linear: -2.0 * re, constant: re * re + im * im };
            if case % 2 == 0 {
                // A root but for roundings.
                let [c0, c1, c2, ..] = c;
                c = [
                    c0 * f.constant,
                    c1 * f.constant + c0 * f.linear,
                    c2 * f.constant + c1 * f.linear + c0,
                    c2 * f.linear + c1,
                    c2,
                ];
            }
            let pair = Pair::new(&f, -im * im);
            let (mut value, mut size) = ([0.0, 0.0], 0.0);
            for &c in c.iter().rev() {
                value = [value[0] * re - value[1] * im + c, value[0] * im + value[1] * re];
                size = size * sqrt(re * re + im * im) + c.abs();
            }
            let value = sqrt(value[0] * value[0] + value[1] * value[1]);
            let residual = pair.residual(&c);
            assert!(residual >= value * (1.0 - 1e-12) && residual >= 0.99 * exp2i(-46) * size);
            // The imaginary part of the value is that of the linear term alone.
            let most = value * (1.0 + 2.0 * pair.modulus / im);
            assert!(residual <= 1.01 * most + 1.5 * exp2i(-46) * size, "{residual} {value} {size}");
        }
    }

    type Found = Option<Roots<4>>;

    struct Two<'a>(&'a [f64; 5], [f64; 2], &'a Factor);

    impl crate::kernel::Task for Two<'_> {
        type Output = Found;
        fn run<P: Product>(self) -> Found {
            let f = self.2;
            two::<P>(self.0, self.1, &Pair::new(f, 0.25 * f.linear * f.linear - f.constant))
        }
    }

    /// `(x - z) (x - conj z)`.
    fn pair(re: f64, im: f64) -> Factor {
        Factor { linear: -2.0 * re, constant: re * re + im * im }
    }

    fn product(f: &Factor, g: &Factor, lead: f64) -> [f64; 5] {
        [
            f.constant * g.constant,
            f.linear * g.constant + g.linear * f.constant,
            f.constant + g.constant + f.linear * g.linear,
            f.linear + g.linear,
            1.0,
        ]
        .map(|c| c * lead)
    }

    /// The absolute value of a complex number.
    fn size(re: f64, im: f64) -> f64 {
        sqrt(re * re + im * im)
    }

    /// A pair is not told from the axis and from the real roots farther off than Smith's theorem allows with a disc of four times
    /// the correction, and is told as near as that with the correction that the bound of the value gives.
    #[test]
    fn a_pair_beside_two_roots() {
        let mut random = Random::new(2);
        let mut count = [[0; 2]; 2];
        for case in 0..20_000 {
            let im = random.magnitude(-3.0, 0.5);
            // The real roots far from the pair or near it, where they count.
            let (re, reach) = if case % 2 == 0 {
                (im * random.uniform(-1.0, 1.0), im * random.magnitude(2.5, 3.5))
            } else {
                (random.uniform(-1.0, 1.0), im * random.magnitude(-1.0, 0.5))
            };
            let x = [re + reach * random.uniform(0.5, 1.0), re - reach * random.uniform(0.5, 1.0)];
            let lead = random.uniform(1.0, 2.0) * random.sign();
            let (f, g) = (pair(re, im), Factor { linear: -(x[0] + x[1]), constant: x[0] * x[1] });
            let c = product(&f, &g, lead);
            // Off by a share of the height.
            let off = im * random.magnitude(-2.5, -0.5);
            let turn = random.uniform(0.0, core::f64::consts::TAU);
            let (a, b) = (re + off * libm::cos(turn), im + off * libm::sin(turn));
            let found = crate::kernel::run(Two(&c, x, &pair(a, b)));
            // Weierstrass's correction of the pair: p over the products of the differences; z - x cancels.
            let value = off * size(a - re, b + im);
            let correction = value / (2.0 * b);
            let far = [size(a - x[0], b), size(a - x[1], b)];
            // The discs about the real roots, which are roundings wide, do not count.
            let share =
                [4.01 * correction / (0.25 * b), 2.0 * 4.01 * correction / (0.125 * far[0].min(far[1]))];
            let worst = share[0].max(share[1]);
            let which = usize::from(share[1] > share[0]);
            // Both parts of the remainder count with their sizes; and roots that are known to half a unit in the last place are
            // certain to 2^-60 where the share of that which the pair may change is below 2^-7: a twentieth of an eighth.
            let more = 1.0 + 2.0 * size(a, b) / b;
            if more * share[0] < 0.9 && more * share[1] < 0.045 {
                count[which][0] += 1;
                let found = found.unwrap_or_else(|| panic!("{share:?} {c:?} {a} {b} {x:?} {re} {im}"));
                assert!(found.len() == 2, "{c:?}");
            } else if worst > 1.1 {
                count[which][1] += 1;
                assert!(found.is_none(), "{share:?} {c:?} {a} {b}");
            }
        }
        assert!(count[0].iter().chain(&count[1][1..]).all(|&count| count > 1000), "{count:?}");
    }

    /// The same of two pairs and no root.
    #[test]
    fn two_pairs() {
        let mut random = Random::new(3);
        let mut count = [[0; 2]; 2];
        for case in 0..20_000 {
            let (re, im) = (
                [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)],
                [random.magnitude(-2.0, 0.5), random.magnitude(-2.0, 0.5)],
            );
            let lead = random.uniform(1.0, 2.0) * random.sign();
            let c = product(&pair(re[0], im[0]), &pair(re[1], im[1]), lead);
            let which = case % 2;
            let off = im[which] * random.magnitude(-2.5, -0.5);
            let turn = random.uniform(0.0, core::f64::consts::TAU);
            let (mut a, mut b) = (re, im);
            (a[which], b[which]) = (re[which] + off * libm::cos(turn), im[which] + off * libm::sin(turn));
            let places = [pair(a[0], b[0]), pair(a[1], b[1])];
            let d = places.map(|f| 0.25 * f.linear * f.linear - f.constant);
            let found = none(&c, &Pair::new(&places[0], d[0]), &Pair::new(&places[1], d[1]));
            // p over the product of the differences, at either place.
            let correction = |i: usize| {
                let j = 1 - i;
                let value = size(a[i] - re[i], b[i] - im[i])
                    * size(a[i] - re[i], b[i] + im[i])
                    * size(a[i] - re[j], b[i] - im[j])
                    * size(a[i] - re[j], b[i] + im[j]);
                value / (2.0 * b[i] * size(a[i] - a[j], b[i] - b[j]) * size(a[i] - a[j], b[i] + b[j]))
            };
            let share = [0, 1].map(|i| 4.01 * correction(i) / (0.25 * b[i]));
            let worst = share[0].max(share[1]);
            let bounds = [0, 1].map(|i| share[i] * (1.0 + 2.0 * size(a[i], b[i]) / b[i]));
            if bounds[0].max(bounds[1]) < 0.9 {
                count[which][0] += 1;
                assert!(found.is_some_and(|found| found.is_empty()), "{share:?} {c:?} {a:?} {b:?}");
            } else if worst > 1.1 {
                count[which][1] += 1;
                assert!(found.is_none(), "{share:?} {c:?} {a:?} {b:?}");
            }
        }
        assert!(count.iter().flatten().all(|&count| count > 1000), "{count:?}");
    }

    /// A pair so near to the axis that its height is lost in the roundings of its factor is not told from real roots.
    #[test]
    fn a_pair_next_to_the_axis() {
        let mut random = Random::new(4);
        let mut count = [0; 2];
        for case in 0..4000 {
            let (re, height) = (random.uniform(0.5, 1.0) * random.sign(), random.magnitude(-9.0, -5.0));
            // As its factor has it, exactly.
            let f = Factor { linear: -2.0 * re, constant: (re * re) * (1.0 + height * height) };
            let d = re * re - f.constant;
            let z = Pair::new(&f, d);
            let other = pair(3.0, 2.0);
            let y = Pair::new(&other, -4.0);
            let clear = z.im * z.im > exp2i(-36) * f.constant;
            let lost = z.im * z.im < exp2i(-48) * f.constant;
            let c = product(&f, &other, 1.0);
            let found = if case % 2 == 0 { none(&c, &z, &y) } else { none(&c, &y, &z) };
            assert!(!lost || found.is_none(), "{re} {height:e}");
            assert!(!clear || found.is_some(), "{re} {height:e}");
            count[0] += u32::from(lost);
            count[1] += u32::from(clear);
            // The roots of the factor are as far from its numbers as one rounding of the discriminant puts them.
            assert!((z.blur() * z.im / (exp2i(-50) * f.constant) - 1.0).abs() < 1e-9 || z.im == 0.0);
        }
        assert!(count.iter().all(|&count| count > 300), "{count:?}");
    }
}
