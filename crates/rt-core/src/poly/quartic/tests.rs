//! What must not become slow unseen: the first ways, in `f64`, answer nearly all polynomials whose roots are apart.

use super::super::{cubic, quadratic};
use super::{discs, split};
use crate::kernel::{Product, Task, run};
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
