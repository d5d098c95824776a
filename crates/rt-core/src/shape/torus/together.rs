//! Hits of several rays with several tori, four pairs at a time: the filter's steps in lanes, which round as it does, so
//! that each answer is that of [`Primitive::hit`](crate::Primitive::hit), bit for bit.
//!
//! First the lines: of those that pass the boxes of tori half pass the tubes. The others wait until four are there.

use super::Torus;
use super::filter::{Extremum, FAR, Ring, RoughLine};
use crate::double_vector::DoubleVector;
use crate::kernel::{Dekker, Four, Lanes, Real, Vector};
use crate::math::exp2i;
use crate::scaled::ScaledFour;
use crate::{Hit, Interval, Primitive, Ray};

/// A ray, what is asked about it, and a torus that it may meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'a> {
    pub torus: &'a Torus,
    pub ray: &'a Ray,
    pub within: Interval,
}

/// At most three wait, and four come.
const ROOM: usize = 8;

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
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    /// Which pairs they are.
    pub names: [u64; 4],
    /// Those that meet, one bit each; others miss.
    pub meet: u32,
    /// Those that only [`Primitive::hit`] can tell.
    pub doubt: u32,
    /// Where those that meet do.
    pub t: [f64; 4],
}

impl Found {
    /// The first crossing of a pair that meets.
    #[inline(always)]
    pub fn hit(&self, place: usize) -> Hit {
        Hit::inside(self.t[place], 0, 0)
    }
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

    /// Takes four pairs, of which `members` are meant, one bit each; at most three may wait. Returns those that only
    /// [`Primitive::hit`] can tell about.
    #[inline(always)]
    pub fn add<L: Lanes>(&mut self, lanes: L, pairs: [Pair; 4], names: [u64; 4], members: u32) -> u32 {
        let [a, b, c, d] = pairs;
        let [ta, tb, tc, td] = [a.torus, b.torus, c.torus, d.torus];
        let center = Vector::new(lanes, [&ta.center, &tb.center, &tc.center, &td.center]);
        let per_unit =
            Four::new(lanes, [exp2i(-ta.scale), exp2i(-tb.scale), exp2i(-tc.scale), exp2i(-td.scale)]);
        let ScaledFour { relative, direction, power, sound } =
            ScaledFour::about(lanes, [a.ray, b.ray, c.ray, d.ray], center, per_unit);
        let reach = Four::new(lanes, [ta.reach, tb.reach, tc.reach, td.reach]);
        let ring = Ring {
            reach,
            minor: Four::new(lanes, [ta.minor_scaled, tb.minor_scaled, tc.minor_scaled, td.minor_scaled]),
            axis: Vector::new(lanes, [&ta.axis, &tb.axis, &tc.axis, &td.axis]),
            squares: Four::new(lanes, [ta.squares.high, tb.squares.high, tc.squares.high, td.squares.high]),
            twice: Four::new(lanes, [ta.twice.high, tb.twice.high, tc.twice.high, td.twice.high]),
            hole: Four::new(lanes, [ta.hole, tb.hole, tc.hole, td.hole]),
            rim: reach * reach,
        };
        let sound = sound & far_enough(&relative);
        let doubt = members & !sound;
        // The lanes bring their own products.
        let Some((line, inside)) = RoughLine::new::<Dekker>(&ring, &relative, direction) else {
            return doubt;
        };
        let min = Four::new(lanes, [a.within.min, b.within.min, c.within.min, d.within.min]);
        let max = Four::new(lanes, [a.within.max, b.within.max, c.within.max, d.within.max]);
        let end = line.end(&ring);
        let error = line.error_of_parameters(end);
        let one = reach.all(1.0);
        let (from, to) = line.stretch(&ring, end, (min, max), one / power, reach.all(2.0) * error);
        let passes = to.less(from) | line.passes_the_tube(&ring, from, to);
        let mut left = members & sound & inside & !passes;
        if left == 0 {
            return doubt;
        }
        let numbers = [
            line.first.to_array(),
            line.rest.to_array(),
            line.inverse.to_array(),
            line.k.to_array(),
            line.z.to_array(),
            line.slope.to_array(),
            line.p.to_array(),
            line.q.to_array(),
            end.to_array(),
            power.to_array(),
            min.to_array(),
            max.to_array(),
            ring.reach.to_array(),
            ring.minor.to_array(),
            ring.twice.to_array(),
        ];
        while left != 0 {
            let lane = left.trailing_zeros() as usize & 3;
            left &= left - 1;
            let place = self.count & (ROOM - 1);
            for k in 0..NUMBERS {
                self.numbers[k][place] = numbers[k][lane];
            }
            self.names[place] = names[lane];
            self.count += 1;
        }
        doubt
    }

    /// What is so of the last four that wait, or of all if there are fewer; they do not wait any more. Where each meets, if that
    /// is asked for; whether, in any case.
    #[inline(always)]
    pub fn take<L: Lanes>(&mut self, lanes: L, places: bool) -> Found {
        let members = self.count.min(4);
        let first = self.count - members;
        self.count = first;
        let first = first & (ROOM / 2 - 1);
        let one = row(lanes, &self.numbers[0], first).all(1.0);
        let none = one.all(0.0);
        let reach = row(lanes, &self.numbers[12], first);
        let ring = Ring {
            reach,
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
        let (end, power, min, max) = (
            row(lanes, &self.numbers[8], first),
            row(lanes, &self.numbers[9], first),
            row(lanes, &self.numbers[10], first),
            row(lanes, &self.numbers[11], first),
        );
        let all = (1_u32 << members) - 1;
        let names = [self.names[first], self.names[first + 1], self.names[first + 2], self.names[first + 3]];

        let ([x, y, z], triple) = line.extrema();
        let (x, mut certain) = line.extremum(&ring, x);
        let (mut y, mut z) = (Extremum { x: y, ..x }, Extremum { x: z, ..x });
        if triple != 0 {
            let (middle, middle_certain) = line.extremum(&ring, y.x);
            let (last, last_certain) = line.extremum(&ring, z.x);
            certain &= (middle_certain & last_certain) | !triple;
            (y, z) = (middle, last);
        }
        let (x_inside, z_inside) = (x.value.less(none), z.value.less(none));
        // Between two minima that are inside it may be, too; a single extremum is all three.
        let y_inside = y.value.less(none);
        let meet = all & certain & (x_inside | z_inside);
        let doubt = all & !certain;
        if meet == 0 {
            return Found { names, doubt, ..Found::default() };
        }
        if !places {
            // A crossing lies between places of different sign; its parameter between theirs, also when all are rounded.
            let (t_start, t_end) = (line.parameter_at(-end) * power, line.parameter_at(end) * power);
            let (t_x, t_y, t_z) = (
                line.parameter_at(x.x) * power,
                line.parameter_at(y.x) * power,
                line.parameter_at(z.x) * power,
            );
            let sure = (x_inside & min.less(t_start) & t_x.less(max))
                | (z_inside & min.less(t_z) & t_end.less(max))
                | (x_inside & !y_inside & min.less(t_x) & t_y.less(max))
                | (z_inside & !y_inside & min.less(t_y) & t_z.less(max));
            return Found { names, meet: meet & sure, doubt: doubt | (meet & !sure), t: [0.0; 4] };
        }
        // The first crossing: before the first extremum, or, if that is outside, between the others.
        let (start, nan) = (-end, one.all(f64::NAN));
        let low = Extremum {
            x: Four::if_less(x.value, none, start, y.x),
            value: Four::if_less(x.value, none, nan, y.value),
            bend: Four::if_less(x.value, none, nan, y.bend),
        };
        let high = Extremum {
            x: Four::if_less(x.value, none, x.x, z.x),
            value: Four::if_less(x.value, none, x.value, z.value),
            bend: Four::if_less(x.value, none, x.bend, z.bend),
        };
        let idle = Four::new(lanes, IDLE[(!meet & 15) as usize]);
        let t = line.parameter_at(line.crossing(&ring, low, high, none, idle)) * power;
        let (after, before) = (min.less(t), t.less(max));
        // A crossing before the interval is not the one that is asked for; one behind it is the first nevertheless.
        Found { names, meet: meet & after & before, doubt: doubt | (meet & !after), t: t.to_array() }
    }
}

/// Four numbers of a row.
#[inline(always)]
fn row<L: Lanes>(lanes: L, numbers: &[f64; ROOM], first: usize) -> Four<L> {
    Four::new(lanes, [numbers[first], numbers[first + 1], numbers[first + 2], numbers[first + 3]])
}

/// One in the lanes of a mask.
const IDLE: [[f64; 4]; 16] = {
    let mut all = [[0.0; 4]; 16];
    let mut mask = 0;
    while mask < 16 {
        let mut lane = 0;
        while lane < 4 {
            all[mask][lane] = (mask >> lane & 1) as f64;
            lane += 1;
        }
        mask += 1;
    }
    all
};

/// In which lanes the torus is near enough for the filter.
#[inline(always)]
fn far_enough<L: Lanes>(relative: &DoubleVector<Four<L>>) -> u32 {
    let far = relative.leading().largest();
    far.at_most(far.all(FAR))
}

/// [`Primitive::hit`], where the lanes cannot tell.
#[cold]
#[inline(never)]
pub(crate) fn alone(pair: Pair) -> Option<Hit> {
    pair.torus.hit(pair.ray, pair.within)
}
