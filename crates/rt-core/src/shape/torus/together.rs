//! Hits of several rays with several tori, eight pairs at a time: the filter's steps in lanes, which round as it does, so
//! that each answer is that of [`Primitive::hit`](crate::Primitive::hit), bit for bit.
//!
//! First the lines: of those that pass the boxes of tori half pass the tubes. The others wait until eight are there.

use super::Torus;
use super::filter::{Extremum, FAR, Ring, RoughLine};
use crate::double_vector::DoubleVector;
use crate::kernel::{Dekker, Four, Lanes, Real, Twice, Vector};
use crate::math::exp2i;
use crate::scaled::ScaledFour;
use crate::{Hit, Interval, Primitive, Ray};

/// The pairs that are looked at together.
pub(crate) const PAIRS: usize = 8;

/// So many numbers.
type Eight<L> = Twice<Four<L>>;

/// A ray, what is asked about it, and a torus that it may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'a> {
    pub torus: &'a Torus,
    pub ray: &'a Ray,
    pub within: Interval,
}

/// At most seven wait, and eight come.
const ROOM: usize = 2 * PAIRS;

/// What is known of a line that waits.
const NUMBERS: usize = 15;

/// Lines that do not clearly miss their torus.
#[derive(Clone, Debug)]
pub(crate) struct Waiting {
    numbers: [[f64; ROOM]; NUMBERS],
    /// Which pairs they are.
    names: [u64; ROOM],
    count: usize,
}

/// What was found out about pairs, by their place among those that were asked about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// Which pairs they are.
    pub names: [u64; PAIRS],
    /// Those that meet, one bit each; others miss.
    pub meet: u32,
    /// Those that only [`Primitive::hit`] can tell.
    pub doubt: u32,
    /// Where those that meet do.
    pub t: [f64; PAIRS],
}

impl Found {
    /// Nothing but doubt.
    #[inline(always)]
    pub fn doubt(names: [u64; PAIRS], doubt: u32) -> Self {
        Found { names, meet: 0, doubt, t: [0.0; PAIRS] }
    }

    /// The first crossing of a pair that meets.
    #[inline(always)]
    pub fn hit(&self, place: usize) -> Hit {
        Hit::inside(self.t[place], 0, 0)
    }
}

/// A number of each of eight pairs. By a macro: copies would be written in other pieces than they are read in, and a function
/// that is handed on need not be compiled for the instruction set.
macro_rules! each {
    ($lanes:ident, $pairs:ident, |$pair:ident| $number:expr) => {
        each!($lanes, $pairs, $pair, $number, [0 1 2 3], [4 5 6 7])
    };
    ($lanes:ident, $pairs:ident, $pair:ident, $number:expr, [$($low:literal)*], [$($high:literal)*]) => {
        Twice(
            Four::new($lanes, [$({ let $pair = &$pairs[$low]; $number }),*]),
            Four::new($lanes, [$({ let $pair = &$pairs[$high]; $number }),*]),
        )
    };
}

impl Waiting {
    pub const NONE: Waiting = Waiting { numbers: [[0.0; ROOM]; NUMBERS], names: [0; ROOM], count: 0 };

    /// Forgets all.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The number of lines that wait.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Takes eight pairs, of which `members` are meant, one bit each; fewer may wait. Returns those that only
    /// [`Primitive::hit`] can tell about.
    #[inline(always)]
    pub fn add<L: Lanes>(
        &mut self,
        lanes: L,
        pairs: &[Pair; PAIRS],
        names: &[u64; PAIRS],
        members: u32,
    ) -> u32 {
        let center = Vector {
            x: each!(lanes, pairs, |p| p.torus.center.x),
            y: each!(lanes, pairs, |p| p.torus.center.y),
            z: each!(lanes, pairs, |p| p.torus.center.z),
        };
        let per_unit = each!(lanes, pairs, |p| exp2i(-p.torus.scale));
        let [a, b, c, d, e, f, g, h] = pairs;
        let low = Vector { x: center.x.0, y: center.y.0, z: center.z.0 };
        let high = Vector { x: center.x.1, y: center.y.1, z: center.z.1 };
        let low = ScaledFour::about(lanes, [a.ray, b.ray, c.ray, d.ray], low, per_unit.0);
        let high = ScaledFour::about(lanes, [e.ray, f.ray, g.ray, h.ray], high, per_unit.1);
        let relative = DoubleVector::both(low.relative, high.relative);
        let direction = Vector::both(low.direction, high.direction);
        let power = Twice(low.power, high.power);
        let sound = (low.sound | high.sound << 4) & near_enough(&relative);

        let reach = each!(lanes, pairs, |p| p.torus.reach);
        let ring = Ring {
            reach,
            minor: each!(lanes, pairs, |p| p.torus.minor_scaled),
            axis: Vector {
                x: each!(lanes, pairs, |p| p.torus.axis.x),
                y: each!(lanes, pairs, |p| p.torus.axis.y),
                z: each!(lanes, pairs, |p| p.torus.axis.z),
            },
            squares: each!(lanes, pairs, |p| p.torus.squares.high),
            twice: each!(lanes, pairs, |p| p.torus.twice.high),
            hole: each!(lanes, pairs, |p| p.torus.hole),
            rim: reach * reach,
        };
        let doubt = members & !sound;
        let (min, max) = (each!(lanes, pairs, |p| p.within.min), each!(lanes, pairs, |p| p.within.max));
        let Some((line, end, left)) = lines(&ring, &relative, direction, power, (min, max), members & sound)
        else {
            return doubt;
        };
        let first = self.count & (PAIRS - 1);
        let second = first + (left & 15).count_ones() as usize;
        let numbers = [
            line.first,
            line.rest,
            line.inverse,
            line.k,
            line.z,
            line.slope,
            line.p,
            line.q,
            end,
            power,
            min,
            max,
            ring.reach,
            ring.minor,
            ring.twice,
        ];
        for (row, Twice(low, high)) in self.numbers.iter_mut().zip(numbers) {
            row[first..first + 4].copy_from_slice(&low.packed(left & 15).to_array());
            row[second..second + 4].copy_from_slice(&high.packed(left >> 4).to_array());
        }
        let mut place = first;
        for (lane, &name) in names.iter().enumerate() {
            self.names[place & (ROOM - 1)] = name;
            place += (left >> lane & 1) as usize;
        }
        self.count = place;
        doubt
    }

    /// What is so of the last eight that wait, or of all if there are fewer; they do not wait any more. Where each meets, if
    /// that is asked for; whether, in any case.
    #[inline(always)]
    pub fn take<L: Lanes>(&mut self, lanes: L, places: bool) -> Found {
        let members = self.count.min(PAIRS);
        self.count -= members;
        let first = self.count & (PAIRS - 1);
        let all = (1_u32 << members) - 1;
        let mut names = [0; PAIRS];
        names.copy_from_slice(&self.names[first..first + PAIRS]);

        let one = row(lanes, &self.numbers[0], first).all(1.0);
        let none = one.all(0.0);
        let ring = Ring {
            reach: row(lanes, &self.numbers[12], first),
            minor: row(lanes, &self.numbers[13], first),
            twice: row(lanes, &self.numbers[14], first),
            // What is asked about a line that waits does not need these.
            axis: Vector { x: none, y: none, z: none },
            squares: none,
            hole: none,
            rim: none,
        };
        let line = RoughLine {
            first: row(lanes, &self.numbers[0], first),
            rest: row(lanes, &self.numbers[1], first),
            inverse: row(lanes, &self.numbers[2], first),
            k: row(lanes, &self.numbers[3], first),
            z: row(lanes, &self.numbers[4], first),
            slope: row(lanes, &self.numbers[5], first),
            p: row(lanes, &self.numbers[6], first),
            q: row(lanes, &self.numbers[7], first),
            square: none,
            length: none,
        };
        let end = row(lanes, &self.numbers[8], first);
        let power = row(lanes, &self.numbers[9], first);
        let min = row(lanes, &self.numbers[10], first);
        let max = row(lanes, &self.numbers[11], first);

        let (meet, doubt, t) = crossings(&ring, &line, end, power, (min, max), all, places);
        let mut t_of_each = [0.0; PAIRS];
        if let Some(Twice(low, high)) = t {
            t_of_each[..4].copy_from_slice(&low.to_array());
            t_of_each[4..].copy_from_slice(&high.to_array());
        }
        Found { names, meet, doubt, t: t_of_each }
    }
}

/// Four rays, each in the scale of a torus of its own; the centres, and two to the power of minus each scale.
#[inline(always)]
pub(super) fn in_own_scale<L: Lanes>(
    lanes: L,
    [a, b, c, d]: [&Torus; 4],
    rays: [&Ray; 4],
) -> (ScaledFour<L>, Vector<Four<L>>, Four<L>) {
    let center = Vector::new(lanes, [&a.center, &b.center, &c.center, &d.center]);
    let per_unit = Four::new(lanes, [exp2i(-a.scale), exp2i(-b.scale), exp2i(-c.scale), exp2i(-d.scale)]);
    (ScaledFour::about(lanes, rays, center, per_unit), center, per_unit)
}

/// What four rays find of one torus.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Told {
    /// The rays that meet it, one bit each; others miss.
    pub meet: u32,
    /// Those that only [`Primitive::hit`] can tell.
    pub doubt: u32,
    /// Where those that meet do, if that was asked for.
    pub t: [f64; 4],
}

/// Whether and, if that is asked for, where four rays meet one torus; `members` are meant, one bit each.
#[inline(always)]
pub(crate) fn with_one<L: Lanes>(
    lanes: L,
    torus: &Torus,
    rays: [&Ray; 4],
    within: [Interval; 4],
    members: u32,
    places: bool,
) -> Told {
    let ScaledFour { relative, direction, power, sound } =
        ScaledFour::new(lanes, rays, torus.center, torus.scale);
    let sound = sound & near_enough(&relative);
    let reach = power.all(torus.reach);
    let ring = Ring {
        reach,
        minor: power.all(torus.minor_scaled),
        axis: Vector::all(power, torus.axis),
        squares: power.all(torus.squares.high),
        twice: power.all(torus.twice.high),
        hole: power.all(torus.hole),
        rim: reach * reach,
    };
    let [a, b, c, d] = within;
    let min = Four::new(lanes, [a.min, b.min, c.min, d.min]);
    let max = Four::new(lanes, [a.max, b.max, c.max, d.max]);
    let mut told = Told { doubt: members & !sound, ..Told::default() };
    let Some((line, end, left)) = lines(&ring, &relative, direction, power, (min, max), members & sound)
    else {
        return told;
    };
    if left == 0 {
        return told;
    }
    let (meet, doubt, t) = crossings(&ring, &line, end, power, (min, max), left, places);
    (told.meet, told.doubt) = (meet, told.doubt | doubt);
    if let Some(t) = t {
        told.t = t.to_array();
    }
    told
}

/// The lines, how far each is inside the torus' ball, and those of `members` that do not clearly miss it, one bit each; none
/// where all miss the ball.
#[inline(always)]
fn lines<R: Real>(
    ring: &Ring<R>,
    relative: &DoubleVector<R>,
    direction: Vector<R>,
    power: R,
    within: (R, R),
    members: u32,
) -> Option<(RoughLine<R>, R, u32)> {
    // The lanes bring their own products.
    let (line, inside) = RoughLine::new::<Dekker>(ring, relative, direction)?;
    let end = line.end(ring);
    let error = line.error_of_parameters(end);
    let one = power.all(1.0);
    let (from, to) = line.stretch(ring, end, within, one / power, ring.reach.all(2.0) * error);
    let passes = to.less(from) | line.passes_the_tube(ring, from, to);
    Some((line, end, members & inside & !passes))
}

/// Of `all` lines, one bit each: those that meet the torus, those that may, and where the former do, if `places` are asked for.
#[inline(always)]
fn crossings<R: Real>(
    ring: &Ring<R>,
    line: &RoughLine<R>,
    end: R,
    power: R,
    (min, max): (R, R),
    all: u32,
    places: bool,
) -> (u32, u32, Option<R>) {
    let one = power.all(1.0);
    let none = one.all(0.0);
    let ([x, y, z], triple) = line.extrema();
    let (x, mut certain) = line.extremum(ring, x);
    let (mut y, mut z) = (Extremum { x: y, ..x }, Extremum { x: z, ..x });
    if triple & all != 0 {
        let (middle, middle_certain) = line.extremum(ring, y.x);
        let (last, last_certain) = line.extremum(ring, z.x);
        certain &= (middle_certain & last_certain) | !triple;
        (y, z) = (middle, last);
    }
    // A single extremum is all three. Where the maximum between two minima is inside, so are they.
    let (x_inside, y_inside, z_inside) = (x.value.less(none), y.value.less(none), z.value.less(none));
    let meet = all & certain & (x_inside | z_inside);
    let doubt = all & !certain;
    if meet == 0 {
        return (0, doubt, None);
    }
    if !places {
        // A crossing lies between places of different sign; its parameter between theirs, also when all are rounded.
        let (t_start, t_end) = (line.parameter_at(-end) * power, line.parameter_at(end) * power);
        let (t_x, t_y, t_z) =
            (line.parameter_at(x.x) * power, line.parameter_at(y.x) * power, line.parameter_at(z.x) * power);
        let sure = (x_inside & min.less(t_start) & t_x.less(max))
            | (z_inside & min.less(t_z) & t_end.less(max))
            | (x_inside & !y_inside & min.less(t_x) & t_y.less(max))
            | (z_inside & !y_inside & min.less(t_y) & t_z.less(max));
        return (meet & sure, doubt | (meet & !sure), None);
    }
    // The first crossing: before the first extremum, or, if that is outside, between the others.
    let (start, nan) = (-end, one.all(f64::NAN));
    let low = Extremum {
        x: R::if_less(x.value, none, start, y.x),
        value: R::if_less(x.value, none, nan, y.value),
        bend: R::if_less(x.value, none, nan, y.bend),
    };
    let high = Extremum {
        x: R::if_less(x.value, none, x.x, z.x),
        value: R::if_less(x.value, none, x.value, z.value),
        bend: R::if_less(x.value, none, x.bend, z.bend),
    };
    let idle = one.ones(!meet);
    let t = line.parameter_at(line.crossing(ring, low, high, none, idle)) * power;
    let (after, before) = (min.less(t), t.less(max));
    // A crossing before the interval is not the one that is asked for; one behind it is the first nevertheless.
    (meet & after & before, doubt | (meet & !after), Some(t))
}

/// Eight numbers of a row.
#[inline(always)]
fn row<L: Lanes>(lanes: L, numbers: &[f64; ROOM], first: usize) -> Eight<L> {
    let n = &numbers[first..first + PAIRS];
    Twice(Four::new(lanes, [n[0], n[1], n[2], n[3]]), Four::new(lanes, [n[4], n[5], n[6], n[7]]))
}

/// In which lanes the torus is near enough for the filter.
#[inline(always)]
fn near_enough<R: Real>(relative: &DoubleVector<R>) -> u32 {
    let far = relative.leading().largest();
    far.at_most(far.all(FAR))
}

/// [`Primitive::hit`], where the lanes cannot tell.
#[cold]
#[inline(never)]
pub(crate) fn alone(pair: Pair) -> Option<Hit> {
    pair.torus.hit(pair.ray, pair.within)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{PortableLanes, Vectorized, vectorize};
    use crate::testing::Random;
    use alloc::vec::Vec;
    use glam::DVec3;

    /// What is found out about all pairs: whether and where each meets, in their order; and how many were in doubt.
    struct Everything<'a>(&'a [Pair<'a>], bool);

    impl Vectorized for Everything<'_> {
        type Output = (Vec<Option<Hit>>, usize);
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let Everything(pairs, places) = self;
            let mut answers = alloc::vec![None; pairs.len()];
            let mut doubts = 0;
            let mut waiting = Waiting::NONE;
            let mut note = |found: &Found| {
                for lane in 0..PAIRS {
                    let name = found.names[lane] as usize;
                    if found.meet >> lane & 1 == 1 {
                        answers[name] = Some(found.hit(lane));
                    } else if found.doubt >> lane & 1 == 1 {
                        answers[name] = alone(pairs[name]);
                        doubts += 1;
                    }
                }
            };
            for first in (0..pairs.len()).step_by(PAIRS) {
                let count = (pairs.len() - first).min(PAIRS);
                let names: [u64; PAIRS] = core::array::from_fn(|i| (first + i.min(count - 1)) as u64);
                let eight = names.map(|name| pairs[name as usize]);
                let doubt = waiting.add(lanes, &eight, &names, (1 << count) - 1);
                note(&Found::doubt(names, doubt));
                while waiting.count() >= PAIRS {
                    note(&waiting.take(lanes, places));
                }
            }
            while waiting.count() > 0 {
                note(&waiting.take(lanes, places));
            }
            (answers, doubts)
        }
    }

    /// Tori of all kinds and rays that cross or graze them, from near and far, at all scales, and all kinds of intervals.
    fn pairs(random: &mut Random) -> Vec<(Torus, Ray, Interval)> {
        let make = |case: usize| {
            let size = if case.is_multiple_of(5) {
                random.magnitude(-140.0, 140.0)
            } else {
                random.magnitude(-1.0, 1.0)
            };
            let minor = match case % 7 {
                0 => random.magnitude(-4.0, -1.0),
                1 => random.uniform(0.95, 3.0),
                _ => random.uniform(0.1, 0.9),
            };
            let center = random.in_cube() * size * random.magnitude(-1.0, 3.0);
            let torus = Torus::new(center, random.direction(), size, size * minor).unwrap();
            let [x, y, z] = torus.frame.map(|axis| axis.high());
            let (u, v) = (random.uniform(0.0, 7.0), random.uniform(0.0, 7.0));
            let out = x * libm::cos(u) + y * libm::sin(u);
            let normal = out * libm::cos(v) + z * libm::sin(v);
            let (target, along) = match case % 3 {
                0 => (random.in_cube() * 1.5, random.direction()),
                1 => (out + normal * minor * random.uniform(0.5, 1.5), random.direction()),
                _ => {
                    let along = normal.cross(random.direction()).normalize();
                    (out + normal * (minor * (1.0 + random.sign() * random.magnitude(-16.0, -1.0))), along)
                }
            };
            let distance = random.magnitude(-2.0, if case.is_multiple_of(11) { 14.0 } else { 2.0 });
            let along = along * random.magnitude(-3.0, 3.0);
            let origin = center + (target - along.normalize() * distance) * size;
            let ray = match case % 97 {
                0 => Ray::new(origin, DVec3::ZERO),
                1 => Ray::new(origin, along * f64::NAN),
                2 => Ray::new(DVec3::new(f64::INFINITY, 0.0, 0.0), along),
                3 => Ray::new(origin, along * exp2i(900)),
                _ => Ray::new(origin, along),
            };
            let speed = size / along.length();
            let within = match case % 6 {
                0 => Interval::LINE,
                1 => Interval::new(distance * speed, f64::INFINITY),
                2 => Interval::new(0.0, (distance + random.uniform(-2.0, 2.0)) * speed),
                3 if case % 4 == 1 => Interval::new(f64::NAN, f64::INFINITY),
                _ => Interval::FORWARD,
            };
            (torus, ray, within)
        };
        (0..30_000).map(make).collect()
    }

    /// Together they meet where and as each does by itself, in all lanes; few take more than the lanes can tell.
    #[test]
    fn pairs_meet_as_each_does() {
        let given = pairs(&mut Random::new(1));
        let pairs: Vec<Pair> =
            given.iter().map(|(torus, ray, within)| Pair { torus, ray, within: *within }).collect();
        let expected: Vec<Option<Hit>> =
            pairs.iter().map(|pair| pair.torus.hit(pair.ray, pair.within)).collect();
        let hits = expected.iter().flatten().count();
        assert!(hits > 10_000 && hits < 25_000, "{hits}");
        for places in [true, false] {
            let (wide, wide_doubts) = vectorize(Everything(&pairs, places));
            let (portable, doubts) = Everything(&pairs, places).run(PortableLanes);
            assert_eq!(wide_doubts, doubts);
            assert!(doubts < pairs.len() / 2, "{doubts}");
            for (i, expected) in expected.iter().enumerate() {
                let say = || alloc::format!("{:?} {:?} {expected:?}", pairs[i], wide[i]);
                if places {
                    let bits = |hit: &Option<Hit>| hit.map(|hit| (hit.t().to_bits(), hit.part(), hit.root()));
                    assert_eq!(bits(&wide[i]), bits(expected), "{}", say());
                    assert_eq!(bits(&portable[i]), bits(expected), "{}", say());
                } else {
                    assert_eq!(wide[i].is_some(), expected.is_some(), "{}", say());
                    assert_eq!(portable[i].is_some(), expected.is_some(), "{}", say());
                }
            }
        }
    }

    /// What must not become slow unseen: of plain rings hit from outside, hardly any takes more than the lanes.
    #[test]
    fn lanes_can_tell() {
        let mut random = Random::new(2);
        let given: Vec<(Torus, Ray)> = (0..4000)
            .map(|_| {
                let torus = Torus::new(random.in_cube(), random.direction(), 1.0, 0.25).unwrap();
                let target = torus.center + random.in_cube();
                let along = random.direction();
                (torus, Ray::new(target - along * 5.0, along))
            })
            .collect();
        let pairs: Vec<Pair> =
            given.iter().map(|(torus, ray)| Pair { torus, ray, within: Interval::FORWARD }).collect();
        for places in [true, false] {
            let (answers, doubts) = vectorize(Everything(&pairs, places));
            assert!(doubts < 20 && answers.iter().flatten().count() > 1000, "{doubts}");
        }
    }
}
