//! What the instruction sets have in common.

use super::*;
use crate::testing::Random;
use alloc::vec::Vec;

/// The bits of a number; those of a NaN mean nothing.
fn bits(x: f64) -> u64 {
    if x.is_nan() { 0 } else { x.to_bits() }
}

/// All operations of lanes that are the same bits everywhere, and the two that are not, apart.
struct Everything(Vec<[f64; 12]>);

impl Vectorized for Everything {
    type Output = (Vec<u64>, Vec<f32>);
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let (mut exact, mut nearly) = (Vec::new(), Vec::new());
        for numbers in self.0 {
            let eight = |first: usize| core::array::from_fn(|i| numbers[(first + i) % 12] as f32);
            let (a, b, c) = (lanes.load(&eight(0)), lanes.load(&eight(3)), lanes.splat(numbers[5] as f32));
            for x in [
                a,
                c,
                lanes.add(a, b),
                lanes.sub(a, b),
                lanes.mul(a, b),
                lanes.max(a, b),
                lanes.min(a, b),
                lanes.splat(lanes.least(a) + 0.0),
                lanes.splat(lanes.greatest(b) + 0.0),
            ] {
                exact.extend(lanes.store(x).map(|x| bits(x.into())));
            }
            exact.push(u64::from(lanes.le(a, b)));
            nearly
                .extend(lanes.store(lanes.mul_sub(a, b, c)).into_iter().chain(lanes.store(lanes.inverse(a))));
            let four = |first: usize| core::array::from_fn(|i| numbers[(first + i) % 12]);
            let (a, b, c) = (lanes.load4(four(0)), lanes.load4(four(6)), lanes.splat4(numbers[3]));
            for x in [
                a,
                c,
                lanes.add4(a, b),
                lanes.sub4(a, b),
                lanes.mul4(a, b),
                lanes.div4(a, b),
                lanes.abs4(a),
                lanes.max4(a, b),
                lanes.binade4(lanes.abs4(b)),
            ] {
                exact.extend(lanes.store4(x).map(bits));
                exact.extend(lanes.round4(x).map(|x| bits(x.into())));
            }
            exact.extend([lanes.le4(a, b), lanes.lt4(a, b)].map(u64::from));
        }
        (exact, nearly)
    }
}

#[test]
fn lanes_agree() {
    let mut random = Random::new(1);
    let numbers: Vec<[f64; 12]> = (0..500)
        .map(|_| {
            core::array::from_fn(|i| match random.below(12) {
                0 => 0.0 * random.sign(),
                1 => f64::from(i as u32 % 3) * random.sign(),
                _ => random.magnitude(-8.0, 8.0) * random.sign(),
            })
        })
        .collect();
    let wide = vectorize(Everything(numbers.clone()));
    let portable = Everything(numbers).run(PortableLanes);
    let differs = wide.0.iter().zip(&portable.0).position(|(a, b)| a != b);
    assert_eq!((differs, wide.0.len()), (None, portable.0.len()));
    for (a, b) in wide.1.into_iter().zip(portable.1) {
        // A difference of a product that cancels may round to very different numbers.
        let same = (a - b).abs() <= 1e-6 * a.abs().max(b.abs()) || (a - b).abs() < 1e-6 || a.abs() > 1e8;
        assert!(same, "{a} {b}");
    }
}

/// Each lane of a pair is what a number by itself gives, to the bit; comparisons with NaN are false.
#[test]
fn pairs_are_two_numbers() {
    let numbers = [0.0, -0.0, 1.5, -3.7, 1e-310, 1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    let all = || numbers.iter().flat_map(|&a| numbers.iter().map(move |&b| (a, b)));
    let lanes = |pair: Pair| [pair.low(), pair.high()].map(bits);
    for (a, b) in all() {
        for (c, d) in all() {
            let (p, q) = (Pair::new(a, b), Pair::new(c, d));
            let same = |pair: Pair, low: f64, high: f64| assert_eq!(lanes(pair), [bits(low), bits(high)]);
            same(p + q, a + c, b + d);
            same(p - q, a - c, b - d);
            same(p * q, a * c, b * d);
            same(p / q, a / c, b / d);
            same(p.lows(q), a, c);
            same(p.highs(q), b, d);
            same(p.abs(), a.abs(), b.abs());
            let greater = |a: f64, b: f64| if a > b { a } else { b };
            same(p.max(q), greater(a, c), greater(b, d));
            assert_eq!(p.is_below(q), a < c && b < d);
            if !a.is_nan() && !b.is_nan() {
                assert_eq!(p.signs(), a.is_sign_negative() as i32 | (b.is_sign_negative() as i32) << 1);
            }
        }
        let pairs = Pairs([[a, b], [b, a]]);
        assert_eq!(lanes(pairs.get(1)), [bits(b), bits(a)]);
    }
}

/// Once detected, the quick question and the full one have the same answer.
#[test]
fn the_level_is_known_everywhere() {
    let best = level();
    assert_eq!(level::is_avx2(), best >= Level::Avx2);
    assert!(set_level(best) == best && level() == best);
}

#[test]
fn rows_of_boxes() {
    for axis in 0..3 {
        assert_ne!(Row::min(axis), Row::max(axis));
        assert_eq!((Row::min(axis), Row::max(axis)), (Row::min(axis + 3), Row::max(axis + 3)));
        assert_ne!(Row::max(axis), Row::max((axis + 1) % 3));
        assert_ne!(Row::min(axis), Row::max((axis + 1) % 3));
    }
}
