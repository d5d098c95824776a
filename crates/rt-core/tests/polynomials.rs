//! Polynomials: planted roots, nearly repeated roots, exact discriminants, scaling, mirroring and negating bit for bit, and the
//! same bits without fused products.
// Made-up input only, and conditions in the words of the theorem.
#![allow(clippy::disallowed_methods, clippy::if_same_then_else, clippy::manual_is_multiple_of)]

use proptest::prelude::*;
use rt_core::Interval;
use rt_core::double::Double;
use rt_core::kernel::{Level, level, set_level};
use rt_core::poly::{Method, Root, Roots, cubic, quadratic, quartic, roots};

/// The roots as bits, so that nothing but the same number is equal (zero has one sign).
fn bits<const N: usize>(roots: &Roots<N>) -> Vec<(u64, u32)> {
    roots.iter().map(|root| (root.x.to_bits(), root.multiplicity)).collect()
}

fn solve(c: [f64; 5]) -> Roots<4> {
    quartic(c, Interval::LINE)
}

/// The product of `x - a` over small whole numbers: exact in `f64`.
fn planted(at: &[i32]) -> [f64; 5] {
    let mut c = [1.0, 0.0, 0.0, 0.0, 0.0];
    for (degree, &a) in at.iter().enumerate() {
        for k in (0..=degree + 1).rev() {
            let above = if k > 0 { c[k - 1] } else { 0.0 };
            let here = if k <= degree { c[k] } else { 0.0 };
            c[k] = above - f64::from(a) * here;
        }
    }
    c
}

/// Sorted, each once with its multiplicity.
fn gathered(at: &[i32]) -> Vec<(f64, u32)> {
    let mut at = at.to_vec();
    at.sort_unstable();
    at.chunk_by(|a, b| a == b).map(|same| (f64::from(same[0]), same.len() as u32)).collect()
}

fn found<const N: usize>(roots: &Roots<N>) -> Vec<(f64, u32)> {
    roots.iter().map(|root| (root.x, root.multiplicity)).collect()
}

/// A coefficient: a simple number, any number of moderate size, or zero.
fn coefficient() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2.0..2.0f64,
        2 => (-16i32..=16).prop_map(|n| f64::from(n) / 4.0),
        1 => ((-1.0..1.0f64), -60i32..60).prop_map(|(m, e)| m * 2f64.powi(e)),
    ]
}

/// Coefficients with two to four nearly equal roots, rounded.
fn cluster() -> impl Strategy<Value = [f64; 5]> {
    (-4.0..4.0f64, -4.0..4.0f64, -4.0..4.0f64, prop::collection::vec(-32i64..=32, 4), 2usize..=4).prop_map(
        |(center, a, b, ulps, count)| {
            let near = |n: i64| f64::from_bits((center.to_bits() as i64 + n) as u64);
            let at = [near(ulps[0]), near(ulps[1]), if count > 2 { near(ulps[2]) } else { a }];
            let at = [at[0], at[1], at[2], if count > 3 { near(ulps[3]) } else { b }];
            let mut c = [1.0, 0.0, 0.0, 0.0, 0.0];
            for (degree, a) in at.iter().enumerate() {
                for k in (0..=degree + 1).rev() {
                    let above = if k > 0 { c[k - 1] } else { 0.0 };
                    c[k] = above - a * if k <= degree { c[k] } else { 0.0 };
                }
            }
            c
        },
    )
}

fn any_quartic() -> impl Strategy<Value = [f64; 5]> {
    prop_oneof![prop::array::uniform5(coefficient()), cluster()]
}

/// Coefficients of a cubic (and of a quadratic without the last): any, or with two or three roots within 32 units in the
/// last place of each other, rounded.
fn any_lower() -> impl Strategy<Value = [f64; 4]> {
    let near = (-4.0..4.0f64, -4.0..4.0f64, prop::array::uniform3(-32i64..=32), any::<bool>()).prop_map(
        |(center, far, ulps, triple)| {
            let [a, b, d] = ulps.map(|n| f64::from_bits((center.to_bits() as i64 + n) as u64));
            let d = if triple { d } else { far };
            [-(a * b * d), a * b + a * d + b * d, -(a + b + d), 1.0]
        },
    );
    let pair = (-4.0..4.0f64, prop::array::uniform2(-32i64..=32)).prop_map(|(center, ulps)| {
        let [a, b] = ulps.map(|n| f64::from_bits((center.to_bits() as i64 + n) as u64));
        [a * b, -(a + b), 1.0, 0.5]
    });
    prop_oneof![prop::array::uniform4(coefficient()), near, pair]
}

/// The sign of `b^2 - 4 a c` in whole numbers.
fn discriminant2(a: i64, b: i64, c: i64) -> i128 {
    i128::from(b) * i128::from(b) - 4 * i128::from(a) * i128::from(c)
}

/// The discriminant of `a x^3 + b x^2 + c x + d`.
fn discriminant3(a: i64, b: i64, c: i64, d: i64) -> i128 {
    let [a, b, c, d] = [a, b, c, d].map(i128::from);
    18 * a * b * c * d - 4 * b * b * b * d + b * b * c * c - 4 * a * c * c * c - 27 * a * a * d * d
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn planted_roots_are_found_with_their_multiplicity(at in prop::collection::vec(-40i32..=40, 4)) {
        prop_assert_eq!(found(&solve(planted(&at))), gathered(&at));
        let c = planted(&at[..3]);
        prop_assert_eq!(found(&cubic([c[0], c[1], c[2], c[3]], Interval::LINE)), gathered(&at[..3]));
        let c = planted(&at[..2]);
        prop_assert_eq!(found(&quadratic([c[0], c[1], c[2]], Interval::LINE)), gathered(&at[..2]));
    }

    #[test]
    fn the_number_of_roots_follows_the_exact_discriminant(
        c in prop::array::uniform4(-1_000_000i64..1_000_000), lead in 1i64..1000, near in -2i64..=2,
    ) {
        // 4 a c within a few units of b^2: as near to a double root as whole numbers get.
        let (a, b) = (lead, 2 * lead * c[1]);
        let c0 = lead * c[1] * c[1] + near;
        let count = match discriminant2(a, b, c0) { d if d > 0 => vec![1, 1], 0 => vec![2], _ => vec![] };
        let roots = quadratic([c0 as f64, b as f64, a as f64], Interval::LINE);
        prop_assert_eq!(roots.iter().map(|root| root.multiplicity).collect::<Vec<_>>(), count);

        // (x - p)^2 (x - q) + a little.
        let (p, q) = (c[2] % 10_000, c[3] % 10_000);
        let k = [-p * p * q + near, p * p + 2 * p * q, -2 * p - q, 1];
        let d = discriminant3(k[3], k[2], k[1], k[0]);
        let roots = cubic(k.map(|c| c as f64), Interval::LINE);
        let expected = if d > 0 { 3 } else if d < 0 { 1 } else if p == q { 1 } else { 2 };
        prop_assert_eq!(roots.len(), expected, "{:?}", k);
    }

    #[test]
    fn an_even_number_of_roots_in_order(c in any_quartic()) {
        let roots = solve(c);
        prop_assert!(roots.iter().all(|root| root.x.is_finite()));
        prop_assert!(roots.windows(2).all(|pair| pair[0].x <= pair[1].x));
        let count: u32 = roots.iter().map(|root| root.multiplicity).sum();
        prop_assert!(c[4] == 0.0 || count % 2 == 0 && count <= 4, "{:?}", roots);
    }

    #[test]
    fn scaling_by_powers_of_two_is_exact(c in any_quartic(), value in -300i32..300, place in -40i32..40) {
        let scaled = std::array::from_fn(|k| c[k] * 2f64.powi(value - place * k as i32));
        let back: Vec<_> =
            solve(scaled).iter().map(|root| ((root.x * 2f64.powi(-place)).to_bits(), root.multiplicity)).collect();
        prop_assert_eq!(bits(&solve(c)), back);
    }

    #[test]
    fn mirroring_mirrors_and_negating_changes_nothing(c in any_quartic()) {
        let roots = solve(c);
        let mirrored = solve([c[0], -c[1], c[2], -c[3], c[4]]);
        let back: Vec<_> =
            mirrored.iter().rev().map(|root| ((0.0 - root.x).to_bits(), root.multiplicity)).collect();
        prop_assert_eq!(bits(&roots), back);
        prop_assert_eq!(bits(&roots), bits(&solve(c.map(|c| -c))));
    }

    #[test]
    fn reversing_inverts(c in any_quartic()) {
        prop_assume!(c[0] != 0.0 && c[4] != 0.0);
        let roots = solve(c);
        let mut inverse: Vec<_> =
            solve([c[4], c[3], c[2], c[1], c[0]]).iter().map(|root| (1.0 / root.x, root.multiplicity)).collect();
        inverse.sort_by(|a, b| a.0.total_cmp(&b.0));
        prop_assert_eq!(roots.len(), inverse.len());
        for (root, (x, multiplicity)) in roots.iter().zip(inverse) {
            // Both are rounded, and so is the reciprocal: three units of 2^-52 at most.
            prop_assert!((root.x - x).abs() <= 3.0 * f64::EPSILON * x.abs(), "{} {}", root.x, x);
            prop_assert_eq!(root.multiplicity, multiplicity);
        }
    }

    #[test]
    fn lower_degrees_scale_mirror_negate_and_invert(
        c in any_lower(), value in -100i32..100, place in -20i32..20,
    ) {
        let cubic = |c: [f64; 4]| cubic(c, Interval::LINE);
        let quadratic = |c: [f64; 4]| quadratic([c[0], c[1], c[2]], Interval::LINE);
        let scaled: [f64; 4] = std::array::from_fn(|k| c[k] * 2f64.powi(value - place * k as i32));
        let mirrored = [c[0], -c[1], c[2], -c[3]];
        let negative = c.map(|c| -c);
        let back = |roots: &[Root], by: f64| -> Vec<(u64, u32)> {
            roots.iter().map(|root| ((root.x * by + 0.0).to_bits(), root.multiplicity)).collect()
        };
        let reversed = |mut list: Vec<(u64, u32)>| {
            list.reverse();
            list
        };
        prop_assert_eq!(cubic(scaled).len(), cubic(c).len());
        prop_assert_eq!(quadratic(scaled).len(), quadratic(c).len());
        // A root below the normal numbers has lost the digits that the other still has: no scaling is exact there.
        let normal = |roots: &[Root]| roots.iter().all(|root| root.x == 0.0 || root.x.is_normal());
        if normal(&cubic(scaled)) && normal(&cubic(c)) {
            prop_assert_eq!(back(&cubic(scaled), 2f64.powi(-place)), bits(&cubic(c)));
        }
        if normal(&quadratic(scaled)) && normal(&quadratic(c)) {
            prop_assert_eq!(back(&quadratic(scaled), 2f64.powi(-place)), bits(&quadratic(c)));
        }
        prop_assert_eq!(reversed(back(&cubic(mirrored), -1.0)), bits(&cubic(c)));
        prop_assert_eq!(reversed(back(&quadratic(mirrored), -1.0)), bits(&quadratic(c)));
        prop_assert_eq!(bits(&cubic(negative)), bits(&cubic(c)));
        prop_assert_eq!(bits(&quadratic(negative)), bits(&quadratic(c)));

        // The reversed polynomial has the reciprocal roots; all are rounded.
        let inverse = |roots: &[Root], there: &[Root]| {
            let mut list: Vec<_> = there.iter().map(|root| (1.0 / root.x, root.multiplicity)).collect();
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            roots.len() == list.len()
                && roots.iter().zip(list).all(|(root, (x, multiplicity))| {
                    (root.x - x).abs() <= 3.0 * f64::EPSILON * x.abs() && root.multiplicity == multiplicity
                })
        };
        if c[0] != 0.0 && c[3] != 0.0 {
            let there = cubic([c[3], c[2], c[1], c[0]]);
            prop_assert!(inverse(&cubic(c), &there), "{:?} {:?}", cubic(c), there);
        }
        if c[0] != 0.0 && c[2] != 0.0 {
            let there = quadratic([c[2], c[1], c[0], 0.0]);
            prop_assert!(inverse(&quadratic(c), &there), "{:?} {:?}", quadratic(c), there);
        }
    }

    #[test]
    fn the_same_roots_at_every_degree(c in any_lower()) {
        // By the quick way, by the way of the quartic (a root zero more), and by the careful solver.
        let ours = cubic(c, Interval::LINE);
        prop_assert_eq!(bits(&solve([c[0], c[1], c[2], c[3], 0.0])), bits(&ours));
        let careful = quartic::double([c[0], c[1], c[2], c[3], 0.0].map(Double::from));
        prop_assert_eq!(careful.len(), ours.len());
        for (a, b) in careful.iter().zip(ours.iter()) {
            // One unit in the last place at most: both are within 0.51 of the same number.
            prop_assert!((a.x.to_f64() - b.x).abs() <= f64::EPSILON * b.x.abs(), "{:?} {:?}", a, b);
            prop_assert_eq!(a.multiplicity, b.multiplicity);
        }
        let ours = quadratic([c[0], c[1], c[2]], Interval::LINE);
        prop_assert_eq!(bits(&cubic([c[0], c[1], c[2], 0.0], Interval::LINE)), bits(&ours));
        let with_zero = solve([0.0, c[0], c[1], c[2], 0.0]);
        let others: Vec<_> = bits(&with_zero).into_iter().filter(|root| f64::from_bits(root.0) != 0.0).collect();
        let expected: Vec<_> = bits(&ours).into_iter().filter(|root| f64::from_bits(root.0) != 0.0).collect();
        prop_assert_eq!(others, expected);
    }

    #[test]
    fn the_interval_selects(c in any_quartic(), min in -2.0..2.0f64, length in 0.0..3.0f64) {
        let within = Interval::new(min, min + length);
        let kept: Vec<_> = found(&solve(c)).into_iter().filter(|root| within.contains(root.0)).collect();
        prop_assert_eq!(found(&quartic(c, within)), kept);
    }
}

#[test]
fn the_same_bits_without_fused_products() {
    let best = level();
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    for case in 0..20_000 {
        let mut c: [f64; 5] = std::array::from_fn(|_| next());
        if case % 3 == 0 {
            // Two nearly equal roots.
            let (a, d) = (next(), next() * 1e-9);
            let pair = [a * (a + d), -2.0 * a - d, 1.0];
            let other = [next(), next(), 1.0];
            c = [0.0; 5];
            (0..9).for_each(|i| c[i / 3 + i % 3] += pair[i / 3] * other[i % 3]);
        }
        let all = || {
            let cubic = cubic([c[0], c[1], c[2], c[3]], Interval::LINE);
            let quadratic = quadratic([c[0], c[1], c[2]], Interval::LINE);
            (bits(&solve(c)), bits(&cubic), bits(&quadratic))
        };
        set_level(Level::Portable);
        let portable = all();
        set_level(best);
        assert_eq!(portable, all(), "{c:?}");
    }
}

/// The other methods, on what they are good for: roots at least a quarter apart, complex pairs off the axis, any
/// leading coefficient; with the linear term or the constant of the reduced quartic zero, too.
#[test]
fn other_methods_find_simple_roots() {
    let lists: [&[f64]; 8] = [
        &[-1.5, -0.25, 0.5, 2.0],
        &[-2.0, -1.0, 1.0, 2.0],
        &[0.5, 1.0, 1.5, 2.0],
        &[-3.0, 0.0, 1.0, 2.0],
        &[0.25, 2.5],
        &[-1.0, 1.0],
        &[-0.75, -0.25],
        &[],
    ];
    let pairs = [(0.5, 0.75), (-0.25, 1.5), (0.0, 0.5), (1.5, 0.25)];
    for list in lists {
        for (k, lead) in [1.0, -2.5, 0.75, 3.0].into_iter().enumerate() {
            let mut c = vec![lead];
            let mut times = |factor: &[f64]| {
                let mut product = vec![0.0; c.len() + factor.len() - 1];
                for (i, a) in c.iter().enumerate() {
                    factor.iter().enumerate().for_each(|(j, b)| product[i + j] += a * b);
                }
                c = product;
            };
            list.iter().for_each(|root| times(&[-root, 1.0]));
            for i in 0..(4 - list.len()) / 2 {
                let (re, im): (f64, f64) = pairs[(k + i) % 4];
                times(&[re * re + im * im, -2.0 * re, 1.0]);
            }
            let c: [f64; 5] = c.try_into().unwrap();
            for method in [Method::Certified, Method::Ferrari, Method::GraphicsGems] {
                let found = roots(c, Interval::LINE, method);
                assert_eq!(found.len(), list.len(), "{method:?} {c:?}: {found:?}");
                for (root, x) in found.iter().zip(list) {
                    assert!(
                        (root.x - x).abs() < 1e-6 && root.multiplicity == 1,
                        "{method:?} {c:?}: {found:?}"
                    );
                }
            }
        }
    }
    // What is below 1e-9 counts as zero: tangent roots that are none, one for two.
    let gems = |c| found(&roots(c, Interval::LINE, Method::GraphicsGems));
    let near = |list: Vec<(f64, u32)>, expected: &[f64]| {
        assert!(
            list.len() == expected.len() && list.iter().zip(expected).all(|(a, b)| (a.0 - b).abs() < 1e-6),
            "{list:?}"
        );
    };
    near(gems([1.0 + 1e-12, 0.0, -2.0, 0.0, 1.0]), &[-1.0, 1.0]);
    near(gems([1.0 - 1e-12, 0.0, -2.0, 0.0, 1.0]), &[-1.0, 1.0]);
    near(gems([1.0, 0.0, -2.0, 0.0, 1.0]), &[-1.0, 1.0]);
}

#[test]
fn special_coefficients() {
    for method in [Method::Certified, Method::Ferrari, Method::GraphicsGems] {
        let solve = |c| roots(c, Interval::LINE, method);
        assert!(solve([0.0; 5]).all() && solve([0.0; 5]).is_empty());
        assert!(!solve([1.0, 0.0, 0.0, 0.0, 0.0]).all());
        assert!(solve([1.0, 0.0, 0.0, 0.0, 0.0]).is_empty());
        assert_eq!(found(&solve([-3.0, 2.0, 0.0, 0.0, 0.0])), [(1.5, 1)]);
        assert_eq!(found(&solve([-4.0, 0.0, 1.0, 0.0, 0.0])), [(-2.0, 1), (2.0, 1)]);
        assert_eq!(found(&solve([0.0, 0.0, -2.0, 1.0, 0.0])), [(0.0, 2), (2.0, 1)]);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..5 {
                let mut c = [1.0; 5];
                c[place] = bad;
                assert!(solve(c).is_empty() && !solve(c).all(), "{c:?}");
            }
        }
    }
    assert_eq!(found(&solve([0.0, 0.0, 0.0, 0.0, 3.0])), [(0.0, 4)]);
}

#[test]
fn multiple_roots_are_decided_exactly() {
    // (7 x - 3)^2 (x^2 - 2), and the same one unit in the last place away.
    let c = [-18.0, 84.0, -89.0, -42.0, 49.0];
    let third = 3.0 / 7.0;
    let root2 = 2f64.sqrt();
    assert_eq!(found(&solve(c)), [(-root2, 1), (third, 2), (root2, 1)]);
    let above = solve([c[0].next_up(), c[1], c[2], c[3], c[4]]);
    let below = solve([c[0].next_down(), c[1], c[2], c[3], c[4]]);
    assert_eq!((above.len(), below.len()), (4, 2));
    // Squares of quadratics: with irrational roots, and with none.
    assert_eq!(found(&solve([4.0, 0.0, -4.0, 0.0, 1.0])), [(-root2, 2), (root2, 2)]);
    assert!(solve([5.0625, 0.0, 4.5, 0.0, 1.0]).is_empty());
    // (2 x - 1)^3 (x + 5), (3 x + 2)^4
    assert_eq!(found(&solve([-5.0, 29.0, -54.0, 28.0, 8.0])), [(-5.0, 1), (0.5, 3)]);
    assert_eq!(found(&solve([16.0, 96.0, 216.0, 216.0, 81.0])), [(-2.0 / 3.0, 4)]);
}

#[test]
fn roots_below_the_normal_numbers_keep_their_order_and_number() {
    let power = |k: i32| 2f64.powi(k / 2) * 2f64.powi(k - k / 2);
    // A root that underflows beside a double root zero: the one on its right, the other on its left.
    assert_eq!(found(&solve([0.0, 0.0, -1e-200, 1e200, 0.0])), [(0.0, 2), (0.0, 1)]);
    assert_eq!(found(&solve([0.0, 0.0, 1e-200, 1e200, 0.0])), [(0.0, 1), (0.0, 2)]);
    // 2^1016 (5 x - 3 2^-1043)^2: a double root among the subnormal numbers, and its neighbours.
    for (near, count) in [(-1.0, 2), (0.0, 1), (1.0, 0)] {
        let c = [(9.0 + near) * power(-1070), -30.0 * power(-27), 25.0 * power(1016)];
        let roots = quadratic(c, Interval::LINE);
        assert_eq!(roots.len(), count, "{roots:?}");
        if count == 1 {
            assert_eq!(found(&roots), [(0.6 * power(-1043), 2)]);
        }
        // Another root far away, of the greatest size; the term is far below the difference.
        let roots = cubic([c[0], c[1], c[2], power(-2) * near], Interval::LINE);
        let far = near * -25.0 * power(1018);
        let expected = if near == 0.0 { count } else { count + 1 };
        assert_eq!(roots.len(), expected, "{roots:?}");
        assert!(near == 0.0 || roots.iter().any(|root| root.x == far), "{roots:?}");
    }
    // A critical point that underflows to zero, from below.
    let c = [1.2e-315, 0.0, 5.4e-312, 2.3e232, 7e-9];
    let cube_root = -(1.2e-315f64 * 1e300 / 2.3e232).cbrt() * 1e-100;
    let roots = solve(c);
    assert!(roots.len() == 2 && (roots[1].x / cube_root - 1.0).abs() < 1e-6, "{roots:?}");
    // The least root there can be but zero, and the least that is not rounded to it.
    assert_eq!(found(&solve([-f64::from_bits(1), f64::MAX, 0.0, 0.0, 0.0])), [(0.0, 1)]);
    assert_eq!(found(&quadratic([-f64::from_bits(3), 2.0, 0.0], Interval::LINE)), [(f64::from_bits(2), 1)]);
}

#[test]
fn roots_of_very_different_size_are_found_within_the_steps_allowed() {
    // Far from the roots +-2.7e-152 Newton's method only halves the distance to them: 500 times from 1.
    let c = [7.291118977622381e-304, 1.52990923101e-312, -1.0, -1.0000000000000004, -0.2500000000000002];
    let small = 2.700207210127101e-152;
    assert_eq!(found(&solve(c)), [(-2.0, 1), (-1.9999999999999982, 1), (-small, 1), (small, 1)]);
    let mirrored = [c[0], -c[1], c[2], -c[3], c[4]];
    assert_eq!(found(&solve(mirrored)), [(-small, 1), (small, 1), (1.9999999999999982, 1), (2.0, 1)]);
}

/// The discriminant of a factor in plain arithmetic is zero: no disc about such a pair proves anything.
#[test]
fn a_pair_of_height_zero_is_left_to_more_precision() {
    let c = [-0.009618162346411439, -0.11512561014324009, -0.31203359955835624, 0.3615040884019865, 1.0];
    assert_eq!(solve(c).len(), 4);
    let c =
        [226.42603417056844, -240.75935028086758, 94.09491878510843, -15.999999999999996, 0.9999999999999998];
    assert_eq!(solve(c).len(), 0);
}

#[test]
fn two_factors_with_one_constant_mirror_bit_for_bit() {
    // Symmetric about -1/2; one root lies within 2^-58 of the middle of two numbers.
    mirrors([3.9723362078004277e-13, 0.0, -0.25, -0.5000000000000002, -0.2500000000000002]);
}

/// The critical points on both sides of the middle root are alike, which left the solver's first place to their order.
#[test]
fn a_root_between_like_extrema_mirrors_bit_for_bit() {
    mirrors([7.56e-322, 1.3202428078720961e-192, 1.3202428078732969e-192, -2.7499999999999996, 0.0]);
}

fn mirrors(c: [f64; 5]) {
    let mirrored = solve([c[0], -c[1], c[2], -c[3], c[4]]);
    let back: Vec<_> = mirrored.iter().rev().map(|root| (-root.x, root.multiplicity)).collect();
    assert_eq!(found(&solve(c)), back);
}

/// Roots within 2^-25 of a unit from the middle of two numbers, and of very different size.
#[test]
fn what_is_mirrored_or_scaled_is_rounded_alike() {
    let c = [
        -0.25000000000000006,
        -0.2500000000000002,
        3.8518598887803834e-34,
        -0.2500000000000002,
        -0.2500000000000002,
    ];
    let mirrored = found(&solve([c[0], -c[1], c[2], -c[3], c[4]]));
    let back: Vec<_> = mirrored.iter().rev().map(|&(x, m)| (-x, m)).collect();
    assert_eq!(found(&solve(c)), back);
    let c = [
        -1.204646741732223e-58,
        -1.904334371905195e-70,
        2.088097429759528e-53,
        -1.2988239387597226e56,
        1.9856475293153764e-84,
    ];
    let scaled = found(&solve(std::array::from_fn(|k| c[k] * 2f64.powi(-5 - k as i32))));
    let back: Vec<_> = scaled.iter().map(|&(x, m)| (0.5 * x, m)).collect();
    assert_eq!(found(&solve(c)), back);
}
