//! What must not become slow unseen: the first ways, in `f64`, answer nearly all polynomials whose roots are apart.

use super::super::{cubic, quadratic};
use super::split::Factor;
use super::{discs, factors, split};
use crate::kernel::counted::counted;
use crate::kernel::{Product, Task, run};
use crate::math::exp2i;
use crate::testing::Random;
use proptest::prelude::*;

/// Real roots and complex pairs.
type Case<'a> = (&'a [f64], &'a [(f64, f64)]);

/// Roots, and complex pairs as their quadratics, multiplied out.
fn expanded(roots: &[f64], pairs: &[(f64, f64)], lead: f64) -> [f64; 5] {
    let mut c = [lead, 0.0, 0.0, 0.0, 0.0];
    let mut times = |factor: [f64; 3]| {
        let mut product = [0.0; 5];
        for (i, c) in c.iter().enumerate() {
            for (j, f) in factor.iter().enumerate() {
                if let Some(place) = product.get_mut(i + j) {
                    *place += c * f;
                }
            }
        }
        c = product;
    };
    roots.iter().for_each(|root| times([-root, 1.0, 0.0]));
    pairs.iter().for_each(|(re, im)| times([re * re + im * im, -2.0 * re, 1.0]));
    c
}

/// How many real roots the first way finds, if it answers.
struct First([f64; 5]);

impl Task for First {
    type Output = Option<usize>;
    fn run<P: Product>(self) -> Option<usize> {
        let [c0, c1, c2, c3, c4] = self.0;
        let count = |list: crate::poly::Roots<4>| list.len();
        if c4 != 0.0 {
            let factors = split::split(c0 / c4, c1 / c4, c2 / c4, c3 / c4)?;
            discs::roots::<P>(&self.0, &factors).map(count)
        } else if c3 != 0.0 {
            cubic::quick::<P>([c0, c1, c2, c3]).map(|r| count(r.inside(&crate::Interval::LINE)))
        } else {
            quadratic::quick::<P>([c0, c1, c2]).map(|r| count(r.inside(&crate::Interval::LINE)))
        }
    }
}

/// Four numbers at least a fifth apart, in any order.
fn apart() -> impl Strategy<Value = [f64; 4]> {
    ([0.2..1.0, 0.2..1.0, 0.2..1.0, 0.2..1.0], -2.0..1.0_f64).prop_map(|(steps, first)| {
        let mut x = first;
        steps.map(|step: f64| {
            x += step;
            x
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn first_ways_answer(x in apart(), re in [-1.0..1.0_f64, -1.0..1.0], im in [0.3..1.0_f64, 1.1..2.0],
                         lead in prop_oneof![Just(1.0), -8.0..-0.1_f64, 0.1..8.0]) {
        let pairs = [(re[0], im[0]), (re[1], im[1])];
        let cases: [Case<'_>; 7] = [
            (&x, &[]), (&x[1..3], &pairs[..1]), (&[], &pairs), (&x[..3], &[]), (&x[1..2], &pairs[..1]),
            (&x[..2], &[]), (&[], &pairs[..1]),
        ];
        for (roots, pairs) in cases {
            let c = expanded(roots, pairs, lead);
            prop_assert_eq!(run(First(c)), Some(roots.len()), "{:?}", c);
        }
    }
}

type Found = Option<crate::poly::Roots<4>>;

/// What the discs certify.
struct Discs<'a>(&'a [f64; 5], &'a [Factor; 2]);

impl Task for Discs<'_> {
    type Output = Found;
    fn run<P: Product>(self) -> Found {
        discs::roots::<P>(self.0, self.1)
    }
}

/// What both factors in double-double tell.
struct Factors<'a>(&'a [f64; 5]);

impl Task for Factors<'_> {
    type Output = Found;
    fn run<P: Product>(self) -> Found {
        factors::roots::<P>(self.0)
    }
}

/// Whether these are the roots of the polynomial, simple ones within 0.51 units in the last place: by the careful
/// solver.
pub(super) fn are_the_roots(c: &[f64; 5], found: &crate::poly::Roots<4>) -> bool {
    let truth = super::double(c.map(crate::double::Double::from));
    truth.len() == found.len()
        && truth.iter().zip(found.iter()).all(|(truth, root)| {
            let unit = root.x.abs().next_up() - root.x.abs();
            (truth.x - root.x).high.abs() <= 0.51 * unit
        })
}

/// Four roots or pairs, those that shall be near each other within `near`: and the factors, each off by `off` of its size.
pub(super) fn two_factors(random: &mut Random, near: f64, off: f64) -> ([f64; 5], [Factor; 2]) {
    let size = if random.once_in(2) { 1.0 } else { random.magnitude(-1.5, 0.0) };
    let of = |random: &mut Random, around: f64, size: f64| {
        let re = around + random.uniform(-1.0, 1.0) * size;
        let half = size * if random.once_in(3) { near } else { random.uniform(0.0, 1.0) };
        let square = half * half * random.sign();
        Factor { linear: -2.0 * re, constant: re * re - square }
    };
    let f = of(random, 0.0, 1.0);
    let beside = of(random, -0.5 * f.linear, near);
    let g = if random.once_in(2) { beside } else { of(random, 0.0, size) };
    let lead = if random.once_in(2) { 1.0 } else { random.uniform(1.0, 2.0) };
    let c = [
        f.constant * g.constant,
        f.linear * g.constant + g.linear * f.constant,
        f.constant + g.constant + f.linear * g.linear,
        f.linear + g.linear,
        1.0,
    ];
    let mut moved = |f: Factor| Factor {
        linear: f.linear + off * random.uniform(-1.0, 1.0),
        constant: f.constant * (1.0 + off * random.uniform(-1.0, 1.0)),
    };
    (c.map(|c| c * lead), [moved(f), moved(g)])
}

/// Whether the factors, multiplied out, are the monic polynomial but for this share of the terms of each coefficient.
pub(super) fn multiply_back(c: &[f64; 5], f: &[Factor], share: f64) -> bool {
    let mut product = [1.0, 0.0, 0.0, 0.0, 0.0];
    let mut size = product;
    for f in f {
        let times = |c: &[f64; 5], b: f64, a: f64| -> [f64; 5] {
            core::array::from_fn(|k| {
                let at = |i: usize| k.checked_sub(i).map_or(0.0, |k| c[k]);
                b * at(0) + a * at(1) + at(2)
            })
        };
        product = times(&product, f.constant, f.linear);
        size = times(&size, f.constant.abs(), f.linear.abs());
    }
    (0..5).all(|k| (product[k] - c[k] / c[4]).abs() <= share * size[k])
}

/// The first guess is what its name says, whatever the roots: two factors, whose product differs by little.
#[test]
fn splits_multiply_back() {
    let mut random = Random::new(5);
    let mut count = 0;
    for case in 0..6000 {
        let (mut c, _) = two_factors(&mut random, 1.0, 0.0);
        if case % 3 == 0 {
            // Roots in pairs about zero, or the product of two alike.
            (c[1], c[3]) = (0.0, 0.0);
        }
        if let Some(f) = split::split(c[0] / c[4], c[1] / c[4], c[2] / c[4], c[3] / c[4]) {
            count += 1;
            assert!(multiply_back(&c, &f, exp2i(-24)), "{c:?} {f:?}");
        }
    }
    assert!(count > 5990, "{count}");
}

/// Whatever factors the discs are given, what they certify is true.
#[test]
fn discs_certify_only_the_truth() {
    let mut random = Random::new(3);
    let mut count = [0; 5];
    for _ in 0..40_000 {
        let (near, off) = (random.magnitude(-4.0, 0.0), random.magnitude(-16.0, 0.0));
        let (c, approximate) = two_factors(&mut random, near, off);
        if let Some(roots) = run(Discs(&c, &approximate)) {
            assert!(are_the_roots(&c, &roots), "{c:?} {approximate:?}: {roots:?}");
            count[roots.len()] += 1;
        }
    }
    assert!([0, 2, 4].iter().all(|&n| count[n] > 3000), "{count:?}");
}

/// What must not become slow unseen, and must be true: nearly equal roots, wherever they are, are told by both factors
/// in double-double.
#[test]
fn factors_tell_nearly_equal_roots() {
    let mut random = Random::new(4);
    let mut count = [0; 3];
    for case in 0..3000 {
        let near = random.magnitude(-9.0, -2.0);
        let (mut c, [f, g]) = two_factors(&mut random, near, 0.0);
        if case % 3 == 1 {
            // All near one place, far from zero.
            let s = random.sign() * random.uniform(2.0, 4.0);
            let moved = |f: Factor| {
                [f.constant * near * near - s * near * f.linear + s * s, near * f.linear - 2.0 * s]
            };
            let ([b, a], [d, e]) = (moved(f), moved(g));
            c = [b * d, a * d + e * b, b + d + a * e, a + e, 1.0];
        } else if case % 3 == 2 {
            c = [0.0, f.constant * g.linear, f.constant + f.linear * g.linear, f.linear + g.linear, 1.0];
        }
        if let Some(roots) = run(Factors(&c)) {
            count[case % 3] += 1;
            assert!(are_the_roots(&c, &roots), "{c:?}: {roots:?}");
        }
    }
    assert!(count.iter().all(|&n| n > 990), "{count:?}");
}

/// What must not become slow unseen: factors off by 1e-8 are as good as any, where roots are apart.
#[test]
fn discs_answer_from_afar() {
    let mut random = Random::new(6);
    for case in 0..3000 {
        let mut moved = |x: f64| x * (1.0 + 1e-8 * random.uniform(-1.0, 1.0));
        let [a, b, c, d] = [-1.5, -0.25, 0.5, 2.0].map(|x| x + 0.1 * libm::sin(f64::from(case) * (x + 3.0)));
        let real = |a: f64, b: f64| [a * b, -(a + b)];
        let pair = |re: f64, im: f64| [re * re + im * im, -2.0 * re];
        let (f, g) = match case % 4 {
            0 => (real(a, c), real(b, d)),
            1 => (real(a, b), pair(c, d)),
            2 => (pair(a, 0.5 * d), real(c, d)),
            _ => (pair(a, d), pair(c, 1.0)),
        };
        let whole = [f[0] * g[0], f[1] * g[0] + g[1] * f[0], f[0] + g[0] + f[1] * g[1], f[1] + g[1], 1.0];
        let factors =
            [f, g].map(|[constant, linear]| Factor { constant: moved(constant), linear: moved(linear) });
        let roots = run(Discs(&whole, &factors)).expect("roots that are apart");
        assert!(are_the_roots(&whole, &roots), "{whole:?} {roots:?}");
    }
}

struct All([f64; 5]);

impl Task for All {
    type Output = usize;
    fn run<P: Product>(self) -> usize {
        super::all_roots::<P>(&self.0).len()
    }
}

/// What must not become slow unseen: how many exact products a quartic takes by its kind, in the mean, as measured and no
/// more than a step of a few hundred above.
#[test]
fn products_a_quartic() {
    let mut random = Random::new(7);
    let measured = [16.0, 43.9, 225.0, 33.4, 41.2, 17.2, 138.1, 488.5];
    let mut found = [0.0; 8];
    for case in 0..8000 {
        let kind = case % 8;
        let near = random.magnitude(-9.0, -2.0);
        let mut root = |i: u32| random.sign() * (f64::from(i) + random.uniform(0.5, 1.0));
        let [a, b, c, d] = [root(0), root(1), root(2), root(3)];
        let tiny = random.magnitude(-12.0, -6.0);
        let list: [f64; 4] = match kind {
            // Apart; two, three or four near each other; two and two; of very different size; a double and a triple root.
            0 => [a, b, c, d],
            1 => [a, a + near, c, d],
            2 => [a, a + near, a - 2.0 * near, d],
            3 => [a, a + near, a - 2.0 * near, a + 4.0 * near],
            4 => [a, a + near, c, c - near],
            5 => [a, b * tiny, c * tiny * tiny, d],
            6 => [0.5, 0.5, c, d],
            _ => [0.25, 0.25, 0.25, d],
        };
        let (_, products) = counted(All(expanded(&list, &[], 1.0)));
        found[kind] += products as f64 / 1000.0;
    }
    assert!(found.iter().zip(measured).all(|(found, measured)| *found <= 1.003 * measured), "{found:?}");
}

/// The same for the careful solver alone, to less than a step more for every other polynomial.
#[test]
fn products_of_the_careful_solver() {
    struct Careful([f64; 5]);
    impl Task for Careful {
        type Output = usize;
        fn run<P: Product>(self) -> usize {
            crate::poly::bracket::solve::<P, 4>(&self.0.map(crate::double::Double::from)).len()
        }
    }
    let mut random = Random::new(8);
    let measured = [403.1, 358.4, 353.2, 381.1, 352.2, 366.0, 448.1, 338.7];
    let mut found = [0.0; 8];
    for case in 0..4000 {
        let kind = case % 8;
        let near = random.magnitude(-9.0, -2.0);
        let tiny = random.magnitude(-40.0, -3.0);
        let mut root = |i: u32| random.sign() * (f64::from(i) + random.uniform(0.5, 1.0));
        let [a, b, c, d] = [root(0), root(1), root(2), root(3)];
        let list = match kind {
            0 => [a, b, c, d],
            1 => [a, a + near, c, d],
            2 => [a, a + near, a - 2.0 * near, d],
            3 => [a, b * tiny, c * tiny * tiny, d],
            // Far out and in; exact double and triple roots; and double roots but for the last digits.
            4 => [a * 1e200, b, c * 1e-60, d * 1e-90],
            5 => [0.5, 0.5, c, d],
            6 => [0.25, 0.25, 0.25, d],
            _ => [a, a * (1.0 + 1e-12), c, d],
        };
        let (_, products) = counted(Careful(expanded(&list, &[], 1.0)));
        found[kind] += products as f64 / 500.0;
    }
    assert!(found.iter().zip(measured).all(|(found, measured)| *found <= 1.003 * measured), "{found:?}");
}

/// And of cubics.
#[test]
fn products_a_cubic() {
    let mut random = Random::new(9);
    let measured = [9.01, 31.37, 132.9, 21.62, 3.01, 68.3];
    let mut found = [0.0; 6];
    for case in 0..6000 {
        let kind = case % 6;
        let near = random.magnitude(-9.0, -2.0);
        let tiny = random.magnitude(-12.0, -6.0);
        let mut root = |i: u32| random.sign() * (f64::from(i) + random.uniform(0.5, 1.0));
        let [a, b, c] = [root(0), root(1), root(2)];
        let (list, pairs) = match kind {
            // Apart; two or three near each other; of very different size; one with a pair; an exact double root.
            0 => ([a, b, c], None),
            1 => ([a, a + near, c], None),
            2 => ([a, a + near, a - 2.0 * near], None),
            3 => ([a, b * tiny, c * tiny * tiny], None),
            4 => ([a, b, c], Some([(b, c)])),
            _ => ([0.5, 0.5, c], None),
        };
        let c = match &pairs {
            None => expanded(&list, &[], 1.0),
            Some(pairs) => expanded(&list[..1], pairs, 1.0),
        };
        let (_, products) = counted(All(c));
        found[kind] += products as f64 / 1000.0;
    }
    assert!(found.iter().zip(measured).all(|(found, measured)| *found <= 1.003 * measured), "{found:?}");
}

/// A cubic's lonely root and the factor of the others, to what plain arithmetic can tell: of like and of much smaller size,
/// real and complex.
#[test]
fn cubics_fall_into_factors() {
    let mut random = Random::new(7);
    for case in 0..6000 {
        let lonely = random.uniform(0.5, 2.0) * random.sign();
        // The others, nearer to each other than the lonely one is to them.
        let (middle, gap) = if case % 2 == 0 {
            let middle = -lonely * random.uniform(0.8, 3.0);
            (middle, 0.3 * middle.abs() * random.uniform(0.2, 1.0))
        } else {
            let size = random.magnitude(-7.0, -1.0);
            (size * random.sign(), size * random.uniform(0.2, 1.0))
        };
        // In any unit.
        let unit = exp2i(random.below(60) as i32 - 30);
        let (lonely, middle, gap) = (lonely * unit, middle * unit, gap * unit);
        let square = gap * gap * if case % 4 < 2 { 1.0 } else { -1.0 };
        let (linear, constant) = (-2.0 * middle, middle * middle - square);
        let (a, b, d) = (linear - lonely, constant - lonely * linear, -lonely * constant);
        let (x, rest) = split::cubic(d, b, a);
        let off = [
            x / lonely - 1.0,
            (rest.constant - constant) / (middle * middle + gap * gap),
            (rest.linear - linear) / (middle.abs() + gap),
        ];
        assert!(
            off.iter().all(|off| off.abs() < 1e-12),
            "{lonely} {linear} {constant}: {x} {rest:?} {off:?}"
        );
    }
}
