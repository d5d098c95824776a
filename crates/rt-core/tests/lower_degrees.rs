//! Quadratics and cubics against exact arithmetic: the number of roots and every multiplicity by the sign of the
//! discriminant, the place of every simple root by counting the roots on both sides of it, all in expansions. Quartics
//! with roots of very different size against the careful solver.
//!
//! `RT_LOWER_DEGREES` sets the number of cases of each degree (default 20,000), `RT_ANY_SEED` where the sequence starts.
#![cfg(feature = "testing")]
// Exact products by fused multiply-add, whatever the library uses.
#![allow(clippy::disallowed_methods)]

use rt_core::Interval;
use rt_core::double::{Double, two_sum};
use rt_core::kernel::{Fused, Level, level, set_level};
use rt_core::poly::{Root, cubic, quadratic, quartic};
use rt_core::testing::Random;

/// An exact sum: parts that do not overlap, in ascending order, none of them zero (Shewchuk 1997).
#[derive(Clone, Default)]
struct Exact(Vec<f64>);

impl Exact {
    fn plus(mut self, b: f64) -> Self {
        let mut sum = b;
        let mut kept = 0;
        for i in 0..self.0.len() {
            let (s, e) = two_sum(sum, self.0[i]);
            sum = s;
            if e != 0.0 {
                self.0[kept] = e;
                kept += 1;
            }
        }
        self.0.truncate(kept);
        if sum != 0.0 {
            self.0.push(sum);
        }
        self
    }

    fn times(&self, b: f64) -> Self {
        self.0.iter().fold(Exact::default(), |sum, &part| {
            let p = part * b;
            sum.plus(part.mul_add(b, -p)).plus(p)
        })
    }

    fn plus_all(self, b: &Exact) -> Self {
        b.0.iter().fold(self, |sum, &part| sum.plus(part))
    }

    fn sign(&self) -> i32 {
        self.0.last().map_or(0, |&part| if part > 0.0 { 1 } else { -1 })
    }
}

/// The product of numbers.
fn product(factors: &[f64]) -> Exact {
    factors.iter().fold(Exact(vec![1.0]), |product, &b| product.times(b))
}

/// The multiplicities of the real roots in ascending order, by the discriminant.
fn multiplicities(c: &[f64]) -> Vec<u32> {
    match *c {
        [c0, c1, 0.0] => multiplicities_linear(c0, c1),
        [c0, c1, c2] => {
            let d = product(&[c1, c1]).plus_all(&product(&[-4.0, c0, c2]));
            match d.sign() {
                1 => vec![1, 1],
                0 => vec![2],
                _ => vec![],
            }
        }
        [c0, c1, c2, 0.0] => multiplicities(&[c0, c1, c2]),
        [d, c, b, a] => {
            let discriminant = product(&[18.0, a, b, c, d])
                .plus_all(&product(&[-4.0, b, b, b, d]))
                .plus_all(&product(&[b, b, c, c]))
                .plus_all(&product(&[-4.0, a, c, c, c]))
                .plus_all(&product(&[-27.0, a, a, d, d]));
            match discriminant.sign() {
                1 => vec![1, 1, 1],
                -1 => vec![1],
                _ => {
                    // The inflection lies between the double root and the other, where the value has the sign of the
                    // leading coefficient if the double root comes last: 27 a^2 p(-b / 3a) = 2 b^3 - 9 a b c + 27 a^2 d.
                    let there = product(&[2.0, b, b, b])
                        .plus_all(&product(&[-9.0, a, b, c]))
                        .plus_all(&product(&[27.0, a, a, d]));
                    match there.sign() * if a > 0.0 { 1 } else { -1 } {
                        0 => vec![3],
                        1 => vec![1, 2],
                        _ => vec![2, 1],
                    }
                }
            }
        }
        _ => vec![],
    }
}

fn multiplicities_linear(c0: f64, c1: f64) -> Vec<u32> {
    let _ = c0;
    if c1 == 0.0 { vec![] } else { vec![1] }
}

/// The Taylor coefficients at `x`.
fn taylor(c: &[f64], x: (f64, f64)) -> Vec<Exact> {
    let mut t: Vec<Exact> = c.iter().map(|&c| Exact::default().plus(c)).collect();
    for first in 0..c.len() {
        for k in (first..c.len() - 1).rev() {
            let above = t[k + 1].times(x.0).plus_all(&t[k + 1].times(x.1));
            t[k] = t[k].clone().plus_all(&above);
        }
    }
    t
}

/// How many roots, counted as often as they are multiple, lie to the right of `x`, and whether `x` is one: by Descartes' rule, which is exact
/// if all roots are real; by the sign if there is only one.
fn right_of(c: &[f64], x: (f64, f64), real: bool) -> (u32, bool) {
    let signs: Vec<i32> = taylor(c, x).iter().map(Exact::sign).collect();
    let here = signs[0] == 0;
    let lead = *signs.iter().rev().find(|&&s| s != 0).unwrap_or(&0);
    if !real {
        return (u32::from(signs[0] * lead < 0), here);
    }
    let signs: Vec<i32> = signs.into_iter().filter(|&s| s != 0).collect();
    (signs.windows(2).filter(|pair| pair[0] != pair[1]).count() as u32, here)
}

/// The sign of the value at `x` in double-double, or zero in doubt.
fn quick_sign(c: &[f64], x: (f64, f64)) -> i32 {
    let y = Double::sum(x.0, x.1);
    let (mut value, mut size) = (Double::ZERO, 0.0);
    for &c in c.iter().rev() {
        value = value.mul::<Fused>(y) + c;
        size = size * y.high.abs() + c.abs();
    }
    // Three steps of 10 u^2 of the sum of the magnitudes at most: 2^-95 is ample.
    if value.high.abs() <= size * 2f64.powi(-95) { 0 } else { value.high.signum() as i32 }
}

/// The greatest error of a simple root that is promised, in units in the last place.
const PROMISED: f64 = 0.51;

fn judge(c: &[f64], roots: &[Root]) -> Result<(), String> {
    let expected = multiplicities(c);
    if roots.iter().map(|root| root.multiplicity).ne(expected.iter().copied()) {
        return Err(format!("multiplicities {expected:?}, found {roots:?}"));
    }
    if !roots.windows(2).all(|pair| pair[0].x <= pair[1].x) {
        return Err(format!("out of order: {roots:?}"));
    }
    // The ends of each promise: if they are apart and the sign changes from one to the other, each root is where it should.
    let unit = |x: f64| PROMISED * (x.abs().next_up() - x.abs());
    let ends = |x: f64| [(x, -unit(x)), (x, unit(x))];
    let apart = roots.windows(2).all(|pair| pair[0].x + unit(pair[0].x) < pair[1].x - unit(pair[1].x));
    let degree: u32 = expected.iter().sum();
    let real = c.iter().rposition(|&c| c != 0.0).unwrap_or(0) == degree as usize;
    let mut before = 0;
    for root in roots {
        let [low, high] = ends(root.x);
        before += root.multiplicity;
        if root.x == 0.0 {
            if c[0] != 0.0 {
                return Err(format!("zero is no root: {roots:?}"));
            }
            continue;
        }
        if apart && root.multiplicity == 1 && quick_sign(c, low) * quick_sign(c, high) < 0 {
            continue;
        }
        // All before it and itself are to the left of the upper end, itself and all after it right of the lower one.
        let ((a, here_a), (b, here_b)) = (right_of(c, low, real), right_of(c, high, real));
        let after = degree - before;
        let enough = a + u32::from(here_a) * root.multiplicity >= after + root.multiplicity;
        if !(enough && (b <= after || here_b)) {
            return Err(format!("{:?} is not within {PROMISED} units of a root: {roots:?}", root.x));
        }
    }
    Ok(())
}

/// A number with `bits` binary digits at most, between 1/4 and 4 in size.
fn number(random: &mut Random, bits: u32) -> f64 {
    let x = random.sign() * random.uniform(1.0, 2.0) * f64::from(1 << random.below(3)) * 0.25;
    f64::from_bits(x.to_bits() & !((1u64 << (53 - bits)) - 1))
}

/// A number with `most` binary digits at most.
fn short(random: &mut Random, most: u32) -> f64 {
    let bits = 1 + random.below(most);
    number(random, bits)
}

fn nudged(x: f64, ulps: i64) -> f64 {
    if x == 0.0 { x } else { f64::from_bits((x.to_bits() as i64 + ulps) as u64) }
}

fn ulps(random: &mut Random, most: u32) -> i64 {
    i64::from(random.below(2 * most + 1)) - i64::from(most)
}

/// A number near `x`: the very same, a few units off, or by a power of two from 1 to 2^-60 of it.
fn near(random: &mut Random, x: f64) -> f64 {
    match random.below(4) {
        0 => x,
        1 => nudged(x, ulps(random, 32)),
        _ => {
            let k = random.below(61) as i32;
            x + x * random.sign() * random.uniform(1.0, 2.0) * 2f64.powi(-k)
        }
    }
}

/// A quadratic, moderate in size.
fn any_quadratic(random: &mut Random) -> [f64; 3] {
    let mut c = match random.below(8) {
        // Any.
        0 => [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)],
        // Of any roots near each other or not, rounded.
        1 | 2 => {
            let a = number(random, 53);
            let b = near(random, a);
            let lead = if random.once_in(2) { 1.0 } else { number(random, 53) };
            [lead * (a * b), -lead * (a + b), lead]
        }
        // The discriminant as small as the coefficients allow, or a little larger.
        3 | 4 => {
            let (a, b) = (number(random, 53), number(random, 53));
            let c = near(random, b * b / (4.0 * a));
            [nudged(c, ulps(random, 2)), b, a]
        }
        // Squares and their neighbours, and products of few digits.
        5 => {
            let (p, q) = (number(random, 26), number(random, 26));
            let mut c = [p * p, -2.0 * p * q, q * q];
            if random.once_in(2) {
                let k = random.below(3) as usize;
                c[k] = nudged(c[k], ulps(random, 2));
            }
            c
        }
        6 => {
            let [a, b, p, q] = [(); 4].map(|()| short(random, 26));
            [a * p, a * q + b * p, b * q]
        }
        // Of any size.
        _ => [(); 3].map(|()| number(random, 53) * 2f64.powi(random.below(121) as i32 - 60)),
    };
    if random.once_in(16) {
        c[random.below(3) as usize] = 0.0 * random.sign();
    }
    c
}

/// A cubic, moderate in size.
fn any_cubic(random: &mut Random) -> [f64; 4] {
    let of = |lead: f64, [a, b, d]: [f64; 3]| {
        [-lead * (a * b * d), lead * (a * b + a * d + b * d), -lead * (a + b + d), lead]
    };
    let lead = if random.once_in(2) { 1.0 } else { number(random, 53) };
    let mut c = match random.below(8) {
        0 => [(); 4].map(|()| random.uniform(-2.0, 2.0)),
        1 | 2 => {
            let a = number(random, 53);
            let b = near(random, a);
            let d = if random.once_in(3) { near(random, b) } else { number(random, 53) };
            of(lead, [a, b, d])
        }
        // A quadratic of any kind times a factor.
        3 | 4 => {
            let (p, [c0, c1, c2]) = (number(random, 53), any_quadratic(random));
            [-p * c0, c0 - p * c1, c1 - p * c2, c2]
        }
        // Few digits: double and triple roots, exactly, and their neighbours.
        5 | 6 => {
            let a = short(random, 17);
            let b = if random.once_in(3) { short(random, 17) } else { a };
            let d = if random.once_in(3) { a } else { short(random, 17) };
            let mut c = of(1.0, [a, b, d]);
            if random.once_in(2) {
                let k = random.below(4) as usize;
                c[k] = nudged(c[k], ulps(random, 2));
            }
            c
        }
        _ => [(); 4].map(|()| number(random, 53) * 2f64.powi(random.below(61) as i32 - 30)),
    };
    if random.once_in(16) {
        c[random.below(4) as usize] = 0.0 * random.sign();
    }
    c
}

fn listed(roots: &[Root], factor: f64) -> Vec<(u64, u32)> {
    let mut list: Vec<_> = roots.iter().map(|root| (root.x * factor + 0.0, root.multiplicity)).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list.into_iter().map(|(x, multiplicity)| (x.to_bits(), multiplicity)).collect()
}

/// All that is promised about one polynomial. `range`: the greatest exponents of the scaled one.
fn check<const N: usize>(
    random: &mut Random,
    c: [f64; N],
    solve: impl Fn([f64; N], Interval) -> Vec<Root>,
    best: Level,
) -> Result<(), String> {
    let roots = solve(c, Interval::LINE);
    if c.iter().all(|&c| c == 0.0) {
        return if roots.is_empty() { Ok(()) } else { Err("roots of zero".into()) };
    }
    judge(&c, &roots)?;
    let same = |what: &str, other: Vec<Root>, factor: f64| {
        if listed(&roots, 1.0) == listed(&other, factor) {
            Ok(())
        } else {
            Err(format!("{what}: {roots:?}, {other:?}"))
        }
    };
    set_level(Level::Portable);
    let portable = solve(c, Interval::LINE);
    set_level(best);
    same("without fused products", portable, 1.0)?;
    let mirrored = std::array::from_fn(|k| if k % 2 == 1 { -c[k] } else { c[k] });
    same("mirrored", solve(mirrored, Interval::LINE), -1.0)?;
    same("negated", solve(c.map(|c| -c), Interval::LINE), 1.0)?;
    // Sizes up to the ends of the range, as long as no coefficient and no root leaves it: the moderate ones are within
    // 2^130 of 1.
    let place = random.below(401) as i32 - 200;
    let value = random.below(601) as i32 - 300 - place / 2;
    let scaled = std::array::from_fn(|k| c[k] * 2f64.powi(value + place * k as i32));
    if scaled.iter().zip(&c).all(|(s, &c): (&f64, &f64)| s.is_normal() || c == 0.0) {
        same("scaled", solve(scaled, Interval::LINE), 2f64.powi(place))?;
    }
    // Ends at roots, or anywhere.
    let mut end = || {
        let at = roots.get(random.below(3) as usize).map_or(random.uniform(-2.0, 2.0), |root| root.x);
        nudged(at, ulps(random, 1))
    };
    let within = Interval::new(end(), end());
    let kept: Vec<Root> = roots.iter().filter(|root| within.contains(root.x)).copied().collect();
    if solve(c, within) != kept {
        return Err(format!("{within:?}: {:?} of {roots:?}", solve(c, within)));
    }
    Ok(())
}

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

#[test]
fn quadratics_and_cubics_keep_every_promise() {
    let best = level();
    let first = setting("RT_ANY_SEED", 0);
    let (mut failures, mut examples) = (0, vec![]);
    let count = setting("RT_LOWER_DEGREES", 20_000);
    for seed in first..first + count {
        let mut random = Random::new(seed << 8);
        let c = any_quadratic(&mut random);
        let quadratic = check(&mut random, c, |c, within| quadratic(c, within).to_vec(), best);
        let found = quadratic.map_err(|error| format!("{c:?} {error}"));
        let c = any_cubic(&mut random);
        let cubic = check(&mut random, c, |c, within| cubic(c, within).to_vec(), best);
        for result in [found, cubic.map_err(|error| format!("{c:?} {error}"))] {
            if let Err(error) = result {
                failures += 1;
                examples.push(error);
                examples.truncate(10);
            }
        }
    }
    println!("{count} quadratics and {count} cubics, {failures} findings");
    assert_eq!(failures, 0, "{examples:#?}");
}

/// A product of two quadratics of very different size, or coefficients of any size.
fn any_quartic(random: &mut Random) -> [f64; 5] {
    let most = [20, 60, 200][random.below(3) as usize];
    let power = |random: &mut Random| 2f64.powi(random.below(2 * most + 1) as i32 - most as i32);
    if random.once_in(4) {
        return [(); 5].map(|()| number(random, 53) * power(random));
    }
    let mut c = [0.0; 5];
    let [f, g] = [(); 2].map(|()| {
        let s = power(random);
        let [c0, c1, c2] = any_quadratic(random);
        [c0 * s * s, c1 * s, c2]
    });
    (0..9).for_each(|i| c[i / 3 + i % 3] += f[i / 3] * g[i % 3]);
    c
}

#[test]
fn quartics_of_any_size_have_the_careful_solvers_roots() {
    let best = level();
    let first = setting("RT_ANY_SEED", 0);
    for seed in first..first + setting("RT_LOWER_DEGREES", 20_000) / 4 {
        let mut random = Random::new(seed << 8);
        let c = any_quartic(&mut random);
        if !c.iter().all(|&c| c == 0.0 || c.is_normal()) {
            continue;
        }
        let roots = quartic(c, Interval::LINE);
        let careful = quartic::double(c.map(Double::from));
        assert_eq!(roots.len(), careful.len(), "{c:?} {roots:?} {careful:?}");
        for (a, b) in roots.iter().zip(careful.iter()) {
            // One unit in the last place at most: both are within 0.51 of the same number.
            assert!((a.x - b.x.to_f64()).abs() <= f64::EPSILON * a.x.abs(), "{c:?} {a:?} {b:?}");
            assert_eq!(a.multiplicity, b.multiplicity, "{c:?}");
        }
        let mirrored = quartic([c[0], -c[1], c[2], -c[3], c[4]], Interval::LINE);
        assert_eq!(listed(&roots, 1.0), listed(&mirrored, -1.0), "{c:?}");
        set_level(Level::Portable);
        let portable = quartic(c, Interval::LINE);
        set_level(best);
        assert_eq!(listed(&roots, 1.0), listed(&portable, 1.0), "{c:?}");
    }
}

/// `(d x - n)^3 (e x - f)` and squares of `a x^2 + b x + c`, with whole numbers whose products are exact: decided exactly,
/// whether the roots are rational, irrational or none.
#[test]
fn fractions_and_squares_are_decided_exactly() {
    let mut random = Random::new(1);
    let mut whole = |most: u32| random.sign() * f64::from(1 + random.below(most));
    let mut count = [0; 3];
    let found =
        |c| quartic(c, Interval::LINE).iter().map(|root| (root.x, root.multiplicity)).collect::<Vec<_>>();
    for case in 0..4000 {
        let (d, n, e, f) = (whole(4000).abs(), whole(4000), whole(100).abs(), whole(100));
        let cube = [-n * n * n, 3.0 * n * n * d, -3.0 * n * d * d, d * d * d];
        let c = std::array::from_fn(|k| {
            let at = |k: usize| cube.get(k).copied().unwrap_or(0.0);
            e * k.checked_sub(1).map_or(0.0, at) - f * at(k)
        });
        let mut expected = vec![(n / d, 3), (f / e, 1)];
        expected.sort_by(|a, b| a.0.total_cmp(&b.0));
        if n * e != f * d {
            assert_eq!(found(c), expected, "{c:?}");
        }

        let most = [3, 4_000_000][case % 2];
        let (a, b, c) = (whole(most), whole(most), whole(most));
        let square = [c * c, 2.0 * b * c, b * b + 2.0 * a * c, 2.0 * a * b, a * a];
        let roots = quartic(square, Interval::LINE);
        let sign = b * b - 4.0 * a * c;
        let ordinary: Vec<_> = quadratic([c, b, a], Interval::LINE).iter().map(|root| root.x).collect();
        assert_eq!(roots.iter().map(|root| root.x).collect::<Vec<_>>(), ordinary, "{square:?} {roots:?}");
        let multiplicity = if sign == 0.0 { 4 } else { 2 };
        assert!(roots.iter().all(|root| root.multiplicity == multiplicity), "{square:?} {roots:?}");
        count[(sign.partial_cmp(&0.0).unwrap() as i32 + 1) as usize] += 1;
    }
    assert!(count.iter().all(|&count| count > 20), "{count:?}");
}
