//! What the instruction sets have in common.

use super::*;
use crate::Ray;
use crate::math::exp2i;
use crate::testing::Random;
use alloc::format;
use alloc::vec::Vec;
use glam::DVec3;

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
            exact.push(u64::from(lanes.all_le([(a, b), (c, b), (a, a)])));
            // Where neither has a sign these are the greater and the lesser; of two with signs, either.
            let (p, q) = (lanes.store(a), lanes.store(b));
            let (most, least) =
                (lanes.store(lanes.positive_max(a, b)), lanes.store(lanes.positive_min(a, b)));
            let size = lanes.max(a, lanes.splat(0.0));
            let (less, size) = (lanes.positive_lt(size, b), lanes.store(size));
            for i in 0..8 {
                let (p, q) = (p[i], q[i]);
                let negative = p.is_sign_negative() && q.is_sign_negative();
                let right = |found: f32, wanted: f32| found == wanted || negative && [p, q].contains(&found);
                assert!(right(most[i], p.max(q)) && right(least[i], p.min(q)), "{p} {q}");
                assert!(less >> i & 1 == u32::from(size[i] < q) || size[i] == q, "{p} {q}");
            }
            let words = core::array::from_fn(|i| (numbers[i].to_bits() >> 32) as u32);
            exact.push(u64::from(lanes.large(words)));
            nearly
                .extend(lanes.store(lanes.mul_add(a, b, c)).into_iter().chain(lanes.store(lanes.inverse(a))));
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
                lanes.copy_sign4(a, b),
                lanes.max4(a, b),
                lanes.binade4(lanes.abs4(b)),
                lanes.neg4(a),
                lanes.sqrt4(b),
                lanes.if_less4(a, b, c, a),
                lanes.if_at_most4(a, b, c, b),
                lanes.if_at_most4(a, a, c, b),
            ] {
                exact.extend(lanes.store4(x).map(bits));
                exact.extend(lanes.round4(x).map(|x| bits(x.into())));
            }
            exact.extend([lanes.le4(a, b), lanes.lt4(a, b), lanes.signs4(a)].map(u64::from));
            // Where the products are exact, and the numbers have such whole parts.
            let tame = |x: f64| if (1e-100..1e100).contains(&x.abs()) { x } else { 1.0 / 3.0 };
            let (a, b) = (four(0).map(tame), four(6).map(tame));
            let (p, e) = lanes.two_product4(lanes.load4(a), lanes.load4(b));
            exact.extend(lanes.store4(p).into_iter().chain(lanes.store4(e)).map(bits));
            let small = a.map(|x| x.abs() % 2_147_483_648.0);
            exact.extend(lanes.whole4(lanes.load4(small)).map(u64::from));
            assert_eq!(lanes.whole4(lanes.load4(small)), small.map(|x| x as u32));
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

/// The lanes of each mask come first, in their order.
struct Packed([f64; 4]);

impl Vectorized for Packed {
    type Output = ();
    fn run<L: Lanes>(self, lanes: L) {
        for mask in 0..16_u32 {
            let chosen: Vec<f64> =
                (0..4).filter(|lane| mask >> lane & 1 == 1).map(|lane| self.0[lane]).collect();
            let packed = lanes.store4(lanes.pack4(lanes.load4(self.0), mask));
            assert_eq!(packed[..chosen.len()], chosen, "{mask}");
        }
    }
}

#[test]
fn packed_lanes() {
    let numbers = [1.0, -2.5, f64::INFINITY, 1e-310];
    vectorize(Packed(numbers));
    Packed(numbers).run(PortableLanes);
}

/// What arithmetic over [`Real`] gives of four pairs of numbers, with comparisons in bits.
#[inline(always)]
fn of_all_operations<R: Real>(a: R, b: R) -> ([R; 12], [u32; 2]) {
    let (p, e) = R::two_product::<Dekker>(a, b);
    let numbers = [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.abs().sqrt(),
        p,
        e,
        R::remainder::<Dekker>(p, a, b),
        R::if_less(a, b, a, b),
        R::if_at_most(b, a, a.all(3.0), b),
        a.abs().third_of_bits(5),
    ];
    (numbers, [a.less(b), a.at_most(b)])
}

/// Eight numbers as twice four are what each is by itself.
#[test]
fn twice_as_many_are_each() {
    let mut random = Random::new(2);
    for _ in 0..100 {
        let a: [f64; 8] = core::array::from_fn(|_| random.magnitude(-8.0, 8.0) * random.sign());
        let mut b: [f64; 8] = core::array::from_fn(|_| random.magnitude(-8.0, 8.0) * random.sign());
        b[3] = a[3];
        let lanes = PortableLanes;
        let four = |n: &[f64]| Four::new(lanes, [n[0], n[1], n[2], n[3]]);
        let (eight, masks) =
            of_all_operations(Twice(four(&a[..4]), four(&a[4..])), Twice(four(&b[..4]), four(&b[4..])));
        for i in 0..8 {
            let (one, one_masks) = of_all_operations(a[i], b[i]);
            for (Twice(low, high), one) in eight.into_iter().zip(one) {
                let number = if i < 4 { low.to_array()[i] } else { high.to_array()[i - 4] };
                assert_eq!(bits(number), bits(one));
            }
            assert_eq!(masks.map(|mask| mask >> i & 1), one_masks);
        }
        assert_eq!(<Twice<Four<PortableLanes>>>::EVERY, 255);
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
            let lesser = |a: f64, b: f64| if a < b { a } else { b };
            same(p.min(q), lesser(a, c), lesser(b, d));
            assert_eq!(p.is_nan(q), [a, b, c, d].into_iter().any(f64::is_nan));
            assert_eq!(p.is_below(q), a < c && b < d);
            if !a.is_nan() && !b.is_nan() {
                assert_eq!(p.signs(), a.is_sign_negative() as i32 | (b.is_sign_negative() as i32) << 1);
            }
        }
        let pairs = Pairs([[a, b], [b, a]]);
        assert_eq!(lanes(pairs.get(1)), [bits(b), bits(a)]);
        assert_eq!(lanes(Pair::splat(a)), [bits(a), bits(a)]);
    }
}

/// Whatever the lanes, the same crossings are told as of each pair of planes by itself; NaN is only known to be there.
#[test]
fn slabs_are_three_pairs_of_planes() {
    fn told<S: SlabLanes>(planes: &Planes, ray: &Ray) -> (bool, usize, [u64; 2], usize, usize) {
        let slabs = S::new(planes, ray);
        let (entry, leave) = slabs.ends();
        // Signs of zeros may differ.
        let ends = [bits(entry + 0.0), bits(leave + 0.0)];
        let entered = if entry > 0.0 { slabs.entered(16) } else { 0 };
        let left = if leave > 0.0 { slabs.left(16) } else { 0 };
        (slabs.are_doubtful(), slabs.back(), ends, entered, left)
    }
    let numbers = [0.0, -0.0, 1.5, -3.7, 1e-310, -1.5e-308, f64::INFINITY, f64::NAN];
    let mut random = Random::new(5);
    let [mut doubts, mut ties] = [0; 2];
    for _ in 0..40_000 {
        let (low, high) = (random.in_cube() - 1.0, random.in_cube() + 1.0);
        let mut ray = Ray::new(random.in_cube() * 4.0, random.in_cube());
        for axis in 0..3 {
            match random.below(12) {
                0 => ray.direction[axis] = numbers[random.below(8) as usize],
                1 => ray.origin[axis] = numbers[random.below(8) as usize],
                2 => ray.origin[axis] = [low, high][random.below(2) as usize][axis],
                // To a corner.
                3 => ray.direction = low - ray.origin,
                _ => {}
            }
        }
        let planes = Planes([[low.x, low.x, low.y, low.z], [high.x, high.x, high.y, high.z]]);
        let (mut is_nan, mut subnormal, mut back) = (false, false, 0);
        let mut all = [[0.0; 2]; 3];
        let pairs = [3, 4, 8];
        for k in 0..3 {
            let (o, d) = (ray.origin[k], ray.direction[k]);
            let [a, b] = [low[k], high[k]].map(|plane| (o - plane) * (-1.0 / d));
            is_nan |= a.is_nan() || b.is_nan();
            subnormal |= d.is_subnormal();
            back |= usize::from(d.is_sign_negative()) << k;
            all[k] = [a.min(b), a.max(b)];
        }
        let entry = all[0][0].max(all[1][0]).max(all[2][0]);
        let leave = all[0][1].min(all[1][1]).min(all[2][1]);
        let steps = |t: f64| t.to_bits() as i64;
        let which = |is: &dyn Fn([f64; 2]) -> bool| -> usize {
            all.into_iter().zip(pairs).map(|(t, pair)| pair * usize::from(is(t))).sum::<usize>()
        };
        let entered = which(&|[near, _]| near > 0.0 && steps(entry) - steps(near) < 16);
        let left = which(&|[_, far]| leave > 0.0 && steps(far) - steps(leave) < 16);
        let (entered, left) = (entered * usize::from(entry > 0.0), left * usize::from(leave > 0.0));
        let right = (subnormal, back, [bits(entry + 0.0), bits(leave + 0.0)], entered, left);
        let check = |told: (bool, usize, [u64; 2], usize, usize)| {
            if is_nan {
                assert!(told.0, "{planes:?} {ray:?}");
            } else {
                assert_eq!(told, right, "{planes:?} {ray:?}");
            }
        };
        check(told::<PairedSlabs>(&planes, &ray));
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        if level() >= Level::Avx2 {
            check(told::<WideSlabs>(&planes, &ray));
        }
        doubts += u32::from(is_nan || subnormal);
        ties += u32::from(!is_nan && ![0, 3, 4, 8].contains(&entered));
    }
    assert!(doubts > 1000 && ties > 300, "{doubts} {ties}");
}

/// Once detected, the quick question and the full one have the same answer.
#[test]
fn the_level_is_known_everywhere() {
    let best = level();
    assert_eq!(level::is_avx2(), best >= Level::Avx2);
    // Whatever is set is what is asked, and no more than there is. Other tests meanwhile find the same bits.
    assert!(set_level(Level::Portable) == Level::Portable && !level::is_avx2());
    assert!(set_level(best) == best && level() == best);
}

/// Bounds are rounded outward, and not by much.
#[test]
fn bounds_are_rounded_outward() {
    let mut random = Random::new(6);
    for case in 0..4000 {
        let x = random.sign() * random.magnitude(-30.0, 30.0);
        // Of half the cases a number of `f32` itself.
        let x = if case % 2 == 0 { x } else { f64::from(x as f32) };
        let least = at_most(x);
        assert!(f64::from(least) <= x && f64::from(least) >= x - x.abs() * exp2i(-21), "{x:e} {least:e}");
        let most = at_least(x);
        assert!(f64::from(most) >= x && f64::from(most) <= x + x.abs() * exp2i(-21), "{x:e} {most:e}");
    }
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

/// Eight rays, with the largest component of each direction in `[1, 2)`.
struct Eight {
    origin: [[f32; 8]; 3],
    direction: [[f32; 8]; 3],
    /// What is asked: a box, how much it grows, and where the rays end.
    min: [f32; 3],
    max: [f32; 3],
    pad: f32,
    limit: [f32; 8],
}

impl Vectorized for &Eight {
    type Output = [u32; 2];
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let rays = EightRays::new(lanes, &self.origin, &self.direction);
        [
            rays.test(lanes, self.min, self.max, self.pad, &self.limit),
            rays.test_ball(lanes, self.min, self.max, self.pad, &self.limit),
        ]
    }
}

impl Eight {
    fn ray(&self, i: usize) -> (DVec3, DVec3) {
        let of = |list: &[[f32; 8]; 3]| DVec3::from_array(list.map(|row| f64::from(row[i])));
        (of(&self.origin), of(&self.direction))
    }

    /// Where the line is in the box grown by this.
    fn slab(&self, i: usize, grown: f64) -> [f64; 2] {
        let (o, d) = self.ray(i);
        (0..3).fold([f64::NEG_INFINITY, f64::INFINITY], |[enter, leave], k| {
            let ends = [f64::from(self.min[k]) - grown, f64::from(self.max[k]) + grown];
            let [a, b] = ends.map(|x| (x - o[k]) / d[k]);
            [enter.max(a.min(b)), leave.min(a.max(b))]
        })
    }
}

/// What meets a box or a ball before its end is told, and little else: rays that pass at a few pads from its edges, and end
/// or begin as near to it.
#[test]
fn eight_rays_meet_boxes_and_balls() {
    let mut random = Random::new(4);
    let mut counts = [[0; 3]; 2];
    for case in 0..3000 {
        let center = random.in_cube() * 0.7;
        let radius = random.magnitude(-3.0, -0.6);
        let flat = |k: usize| if case % 3 == k { random_edge(case) } else { 1.0 };
        let half = DVec3::new(flat(0), flat(1), flat(2)) * radius;
        let single = |v: DVec3| v.to_array().map(|x| x as f32);
        let mut eight = Eight {
            origin: [[0.0; 8]; 3],
            direction: [[0.0; 8]; 3],
            min: single(center - half),
            max: single(center + half),
            pad: 0.0,
            limit: [0.0; 8],
        };
        let mut far = 0.0_f64;
        for i in 0..8 {
            let d = random.direction();
            let across = d.cross(random.direction()).normalize();
            // Next to the ball's edge, or anywhere in it.
            let off = match random.below(4) {
                0 => radius * random.uniform(0.0, 1.0),
                _ => radius + exp2i(-18) * random.uniform(-6.0, 12.0),
            };
            let back = if random.once_in(3) {
                (radius + exp2i(-18) * random.uniform(-8.0, 8.0)) * random.sign()
            } else {
                random.uniform(-1.0, 3.0)
            };
            let o = center + across * off - d * back;
            let d = d * exp2i(-crate::math::exponent(d.abs().max_element()));
            for k in 0..3 {
                eight.origin[k][i] = o[k] as f32;
                eight.direction[k][i] = d[k] as f32;
            }
            far = far.max(o.abs().max_element());
            let length = d.length();
            eight.limit[i] = match random.below(4) {
                0 => f32::INFINITY,
                1 => (back / length) as f32,
                2 => ((back + exp2i(-18) * random.uniform(-8.0, 8.0)) / length - radius) as f32,
                _ => random.uniform(0.0, 3.0) as f32,
            };
        }
        let pad = exp2i(-18) * (1.0 + far);
        eight.pad = pad as f32;
        let answers = vectorize(&eight);
        assert_eq!(answers, (&eight).run(PortableLanes));
        let edge = |k: usize| f64::from(eight.max[k] - eight.min[k]);
        let ball = edge(0).max(edge(1)).max(edge(2)) * 0.5;
        let middle = DVec3::from_array(core::array::from_fn(|k| {
            0.5 * (f64::from(eight.min[k]) + f64::from(eight.max[k]))
        }));
        for i in 0..8 {
            let (o, d) = eight.ray(i);
            let limit = f64::from(eight.limit[i]);
            // Without any pad it must be told, and with two it may not.
            let [enter, leave] = eight.slab(i, 0.0);
            let must = enter.max(0.0) <= leave.min(limit);
            let [enter, leave] = eight.slab(i, 1.01 * pad);
            let may = enter.max(0.0) <= leave.min(limit) * (1.0 + 1e-6);
            check(&mut counts[0], answers[0] >> i & 1 == 1, must, may, &format!("box {case} {i}"));

            let t = (middle - o).dot(d) / d.length_squared();
            let passes = (middle - o - d * t).length();
            let reach = |radius: f64| {
                let half = (radius * radius - passes * passes).max(0.0).sqrt() / d.length();
                [t - half, t + half]
            };
            let [enter, leave] = reach(ball);
            let must = passes <= ball && enter.max(0.0) <= leave.min(limit);
            let room = ball + 2.1 * pad;
            let may = passes <= ball + 1.2 * pad + 1e-6 * ball && t + room >= 0.0 && t - room <= limit;
            check(&mut counts[1], answers[1] >> i & 1 == 1, must, may, &format!("ball {case} {i}"));
        }
    }
    // Told and rightly so, not told and rightly so; where neither is certain either would do.
    assert!(counts.iter().all(|[told, untold, _]| told.min(untold) > &5000), "{counts:?}");
}

/// The thickness of a box of which every third is thin.
fn random_edge(case: usize) -> f64 {
    [0.01, 0.3, 1.0][case / 3 % 3]
}

fn check(counts: &mut [u32; 3], told: bool, must: bool, may: bool, what: &str) {
    assert!(told || !must, "{what}: is not told");
    assert!(may || !told, "{what}: told in vain");
    counts[if must {
        0
    } else if may {
        2
    } else {
        1
    }] += 1;
}
