//! The fast half of a hit: all in `f64`, with error bounds that tell when it cannot decide.
//!
//! The same steps as in the module `exact`. What is known of a value of `f` is its sign whenever it exceeds the error
//! bound, and then no rounding can have changed the count; anything else is handed to double-double arithmetic.

use super::Torus;
use super::exact;
use super::extrema::outermost;
use super::line::Line;
use super::record::HIT_ERROR;
use crate::double::{Double, two_sum};
use crate::double_vector::DoubleVector;
use crate::kernel::{Product, Real, Task, Vector};
use crate::math::exp2i;
use crate::scaled::{ScaledRay, largest};
use crate::{Hit, Interval};

/// What `f64` arithmetic can say about the crossings of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// These, ascending, and no more.
    Certain(Hits),
    /// A sign, a parameter or an end of the interval is within rounding.
    Doubt,
}

/// At most four hits, ascending.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hits {
    list: [Option<Hit>; 4],
}

impl Hits {
    pub const NONE: Hits = Hits { list: [None; 4] };

    /// The hits there are.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = Hit> + '_ {
        self.list.iter().flatten().copied()
    }
}

/// Searches the first crossing inside the interval, or all of them.
pub(super) struct Filter<'a> {
    pub torus: &'a Torus,
    pub ray: &'a ScaledRay,
    pub within: Interval,
    pub all: bool,
}

/// What this needs of a torus; or of one in each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring<R> {
    pub reach: R,
    pub minor: R,
    pub axis: Vector<R>,
    pub squares: R,
    pub twice: R,
    pub hole: R,
    pub rim: R,
}

impl Ring<f64> {
    #[inline(always)]
    pub fn of(torus: &Torus) -> Self {
        Ring {
            reach: torus.reach,
            minor: torus.minor_scaled,
            axis: torus.axis.into(),
            squares: torus.squares.high,
            twice: torus.twice.high,
            hole: torus.hole,
            rim: torus.rim,
        }
    }
}

/// A line about its closest approach: the same quantities as in [`Line`](super::line::Line).
#[derive(Clone, Copy, Debug)]
pub(super) struct RoughLine<R = f64> {
    /// The parameter of the closest approach is the sum of the two.
    pub first: R,
    pub rest: R,
    pub square: R,
    /// The length of the direction, and one over it.
    pub length: R,
    pub inverse: R,
    pub k: R,
    pub z: R,
    pub slope: R,
    pub p: R,
    pub q: R,
}

/// The value of `f`, a quarter of its derivative, and a bound on the error of the value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value<R> {
    pub value: R,
    pub slope: R,
    pub error: R,
}

/// From further away the sums below lose more than they are allowed to.
pub(super) const FAR: f64 = exp2i(40);
/// One rounding, relative.
const U: f64 = exp2i(-53);

/// A coordinate of the place that is `first` directions away.
#[inline(always)]
fn advance<P: Product, R: Real>(x: Double<R>, d: R, first: R) -> R {
    let (p, e) = R::two_product::<P>(first, d);
    let (s, f) = two_sum(x.high, p);
    s + (f + (e + x.low))
}

impl<R: Real> RoughLine<R> {
    /// The line, and in which lanes it does not clearly pass outside the sphere about the torus; `None` where it does in all.
    ///
    /// `|m|` errs by at most 4 u of `R + r` for a line that passes within it: the sum is exact up to its last
    /// rounding, and the little that is left to go after the first step is known to 4 u.
    #[inline(always)]
    pub fn new<P: Product>(
        ring: &Ring<R>,
        relative: &DoubleVector<R>,
        direction: Vector<R>,
    ) -> Option<(Self, u32)> {
        let (d, far) = (direction, relative.leading());
        let one = ring.reach.all(1.0);
        let length_squared = d.dot(d);
        let inverse_squared = one / length_squared;
        let first = -far.dot(d) * inverse_squared;
        let near = Vector {
            x: advance::<P, R>(relative.x, d.x, first),
            y: advance::<P, R>(relative.y, d.y, first),
            z: advance::<P, R>(relative.z, d.z, first),
        };
        // Only the component across the line counts; along it the point may be off by what the scalar product and
        // the division err, 8 u of the distance, and some.
        let reach = ring.reach + far.largest() * one.all(16.0 * U);
        let outside = (reach * reach * one.all(1.0 + 16.0 * U)).less(near.dot(near));
        if outside == R::EVERY {
            return None;
        }
        let rest = -near.dot(d) * inverse_squared;
        let m = near + d * rest;
        let square = m.dot(m);
        let outside = outside | (ring.reach * ring.reach * one.all(1.0 + 32.0 * U)).less(square);
        if outside == R::EVERY {
            return None;
        }
        let length = length_squared.sqrt();
        let inverse = one / length;
        let k = square - ring.squares;
        let z = m.dot(ring.axis);
        let slope = d.dot(ring.axis) * inverse;
        let twice = ring.twice;
        let p = k + twice * slope * slope;
        let q = twice * z * slope;
        let line = RoughLine { first, rest, square, length, inverse, k, z, slope, p, q };
        Some((line, R::EVERY & !outside))
    }

    /// Where the line leaves the sphere about the torus, and a little more.
    #[inline(always)]
    pub fn end(&self, ring: &Ring<R>) -> R {
        let s = ring.reach;
        let zero = s.all(0.0);
        let square = s * s - self.square;
        (R::if_less(zero, square, square, zero) + s.all(64.0 * U) * s * s).sqrt()
    }

    /// What the parameters err: the sum's roundings, the first step's product with the exact rest, and the
    /// distance, of which a little more is asked for.
    #[inline(always)]
    pub fn error_of_parameters(&self, end: R) -> R {
        end.all(4.0 * U) * (self.first.abs() + self.rest.abs() + end * self.inverse)
    }

    /// `f` and its derivative at `x`, and how far the value may be off.
    ///
    /// The errors of `k` and `z`, with `S = R + r`, `|m|^2 + x^2 <= S^2` wherever it matters and `|m . u| <= 4 u |m|`:
    /// that of `|m|^2` 11 u S^2, of `R^2 + r^2` and the differences 4 u S^2, of `x^2` u S^2, of the neglected
    /// `2 x m . u` 8 u S^2, hence 24 u S^2; that of `m . a` 9 u S, of `x (u . a)` 9 u S, with the sum less than
    /// 16 u S since the two are perpendicular parts. `f` errs by these times its derivatives by `k` and `z` and by
    /// its own roundings; the rounded place of an extremum matters by less than u S^4 / 16.
    #[inline(always)]
    pub fn value(&self, ring: &Ring<R>, x: R) -> Value<R> {
        let k = self.k + x * x;
        let z = self.z + x * self.slope;
        let r = ring.minor;
        let twice = ring.twice;
        let gap = (r - z) * (r + z);
        let s = ring.reach;
        let (two, four) = (s.all(2.0), s.all(4.0));
        let square = k * k;
        let error_k = s.all(24.0 * U) * s * s;
        let error_z = s.all(16.0 * U) * s;
        Value {
            value: square - two * twice * gap,
            slope: k * x + twice * z * self.slope,
            error: two * k.abs() * error_k
                + four * twice * (z.abs() + error_z) * error_z
                + s.all(4.0 * U) * (square + two * twice * gap.abs())
                + s.all(0.0625 * U) * s * s * s * s,
        }
    }

    /// The stretch of the line, in distances from the closest approach, on which a hit inside the interval must lie: inside
    /// the sphere about the torus (which is `end` away), the slab that holds the tube and the interval.
    ///
    /// The slab is taken thicker by what `z` errs, 16 u S, and by the rounding of the numerators, the interval longer by
    /// what a parameter errs, `error`, and twice what a hit may be off. A line along the slab gives infinities, or NaN,
    /// which bounds nothing.
    #[inline(always)]
    pub fn stretch(&self, ring: &Ring<R>, end: R, (min, max): (R, R), per_unit: R, error: R) -> (R, R) {
        let s = ring.reach;
        let height = ring.minor + s.all(32.0 * U) * s;
        let per_height = s.all(1.0) / self.slope;
        let (enter, leave) = ((-height - self.z) * per_height, (height - self.z) * per_height);
        let (enter, leave) = (R::if_less(leave, enter, leave, enter), R::if_less(leave, enter, enter, leave));
        let margin = s.all(2.0 * HIT_ERROR) * s + error * self.length;
        (
            later(self.place(min, per_unit) - margin, later(enter, -end)),
            sooner(self.place(max, per_unit) + margin, sooner(leave, end)),
        )
    }

    /// The distance from the closest approach of the place at this parameter, in the units of the given ray.
    #[inline(always)]
    fn place(&self, t: R, per_unit: R) -> R {
        ((t * per_unit - self.first) - self.rest) * self.length
    }

    /// In which lanes a stretch of the line is certainly nearer to the axis than the tube, or farther away.
    ///
    /// The square of the distance from the axis, `|m|^2 + x^2 - z^2`, is convex along the line: greatest at an end, and
    /// least at the first where it grows there, at the last where it falls there. `|m|^2` errs by 11 u S^2, `x^2`, at most
    /// S^2, by 8 u of itself, `z^2` by 32 u S^2; and half its derivative by 20 u S, which counts along 2 S.
    #[inline(always)]
    pub fn passes_the_tube(&self, ring: &Ring<R>, from: R, to: R) -> u32 {
        let ((first, growth), (last, last_growth)) = (self.axis_distance(from), self.axis_distance(to));
        let most = later(first, last);
        let (zero, slack) = (from.all(0.0), from.all(128.0 * U) * ring.reach * ring.reach);
        let rim = ring.rim + slack;
        most.less(ring.hole - slack)
            | (zero.less(growth) & rim.less(first))
            | (last_growth.less(zero) & rim.less(last))
    }

    /// The square of the distance from the axis, and half its derivative.
    #[inline(always)]
    fn axis_distance(&self, x: R) -> (R, R) {
        let z = self.z + x * self.slope;
        (self.square + x * x - z * z, x - z * self.slope)
    }

    /// An eighth of the second derivative.
    #[inline(always)]
    pub fn bend(&self, x: R) -> R {
        x.all(0.5) * (x.all(3.0) * x * x + self.p)
    }

    /// The extrema: one, three times, or three, ascending; and in which lanes three.
    #[inline(always)]
    pub fn extrema(&self) -> ([R; 3], u32) {
        let c = outermost(self.p, self.q);
        let zero = c.all(0.0);
        let discriminant = c.all(-3.0) * c * c - c.all(4.0) * self.p;
        // Where rounding may have made it negative, two equal extrema do no harm.
        let least = c.all(exp2i(-20)) * -(c * c);
        let single = discriminant.less(least);
        if single == R::EVERY {
            return ([c, c, c], 0);
        }
        let root = R::if_less(zero, discriminant, discriminant, zero).sqrt();
        let (a, b) = (c.all(-0.5) * (c + root), c.all(-0.5) * (c - root));
        let negative = [c, a, b];
        let positive = [a, b, c];
        let mut all = negative;
        for i in 0..3 {
            let x = R::if_less(c, zero, negative[i], positive[i]);
            all[i] = R::if_less(discriminant, least, c, x);
        }
        (all, R::EVERY & !single)
    }

    /// The extremum at `x`, and in which lanes its sign is certain, and that a crossing beside it will be found well enough.
    ///
    /// The slope at a crossing next to this extremum is at least that of the parabola, 4 sqrt(value bend), or a
    /// quarter of it where the crossing is on the far side of an inflection; the crossing errs by the error
    /// over the slope, of which a quarter of what `surface` relies on is allowed. All this depends on the ray
    /// alone, never on the interval, and so does what is reported.
    #[inline(always)]
    pub fn extremum(&self, ring: &Ring<R>, x: R) -> (Extremum<R>, u32) {
        let Value { value, error, .. } = self.value(ring, x);
        let bend = x.all(4.0) * self.bend(x);
        let certain = error.less(value.abs())
            & (x.all(64.0) * error * error).at_most(x.all(HIT_ERROR * HIT_ERROR) * (value * bend).abs());
        (Extremum { x, value, bend }, certain)
    }

    /// The parameter at the distance `x` from the closest approach: no less for a greater `x`.
    #[inline(always)]
    pub fn parameter_at(&self, x: R) -> R {
        self.first + (self.rest + x * self.inverse)
    }

    /// The crossing between two extrema (or ends, whose values are NaN) of different sign. `inside` is one where it is the
    /// lower one that is inside, zero where it is the other; `idle` is one in the lanes that are not meant, zero in the others.
    #[inline(always)]
    pub fn crossing(&self, ring: &Ring<R>, low: Extremum<R>, high: Extremum<R>, inside: R, idle: R) -> R {
        let (zero, one, half) = (inside.all(0.0), inside.all(1.0), inside.all(0.5));
        let (from_low, from_high) = (low.reach(), high.reach());
        // From the nearer zero of the two parabolas; from the only one where one is NaN.
        let from_high_end = R::if_at_most(from_low, from_high, low.x + from_low, high.x - from_high);
        let start = R::if_at_most(from_high, from_high, from_high_end, low.x + from_low);
        let (mut a, mut b) = (low.x, high.x);
        let middle = half * (a + b);
        let mut x = R::if_less(a, start, R::if_less(start, b, start, middle), middle);
        // One in the lanes that are done.
        let mut done = idle;
        // Halving alone comes to an end after 53 steps and a few, Newton's method after four or five.
        for _ in 0..60 {
            #[cfg(test)]
            crate::kernel::counted::step();
            let Value { value, slope, error } = self.value(ring, x);
            let here = R::if_less(value, zero, one, zero);
            let unlike = (here - inside).abs();
            a = R::if_less(unlike, half, x, a);
            b = R::if_less(unlike, half, b, x);
            let step = x.all(0.25) * value / slope;
            let next = x - step;
            // By the series of f about the new place, whose fourth derivative is 24, the value there is
            // s^2 f'' / 2 + s^3 f''' / 3 + 3 s^4; a twentieth of the value's own error is enough.
            let size = step.abs();
            let left =
                x.all(4.0) * self.bend(next).abs() + size * (x.all(8.0) * next.abs() + x.all(3.0) * size);
            let enough = R::if_at_most(x.all(20.0) * (size * size * left), error, one, zero);
            // Beyond the ends: the last place, if that is good enough, or the middle.
            let (otherwise, otherwise_done) = (
                R::if_at_most(value.abs(), error, x, half * (a + b)),
                R::if_at_most(value.abs(), error, one, zero),
            );
            let within = R::if_less(a, next, R::if_less(next, b, one, zero), zero);
            let moved = R::if_less(zero, within, next, otherwise);
            let finished = R::if_less(zero, within, enough, otherwise_done);
            x = R::if_less(zero, done, x, moved);
            done = R::if_less(zero, done, one, finished);
            if zero.less(done) == R::EVERY {
                break;
            }
        }
        x
    }
}

impl RoughLine {
    /// The coefficients of the quartic, ascending, and rounded.
    pub fn coefficients(&self, torus: &Torus) -> [f64; 5] {
        [self.value(&Ring::of(torus), 0.0).value, 4.0 * self.q, 2.0 * self.p, 0.0, 1.0]
    }
}

/// The greater of two; the second where one is NaN.
#[inline(always)]
fn later<R: Real>(a: R, b: R) -> R {
    R::if_less(b, a, a, b)
}

/// The lesser of two; the second where one is NaN.
#[inline(always)]
fn sooner<R: Real>(a: R, b: R) -> R {
    R::if_less(a, b, a, b)
}

/// An extremum of `f`, or an end of the line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extremum<R> {
    pub x: R,
    /// NaN at the ends of the line, which are no extrema.
    pub value: R,
    /// Half the second derivative.
    pub bend: R,
}

impl<R: Real> Extremum<R> {
    #[inline(always)]
    pub fn end(x: R) -> Self {
        Extremum { x, value: x.all(f64::NAN), bend: x.all(f64::NAN) }
    }

    /// Where the parabola at the extremum is zero, as a distance from it; NaN for an end.
    #[inline(always)]
    fn reach(&self) -> R {
        (-self.value / self.bend).sqrt()
    }
}

/// An end of a stretch on which `f` is monotonic.
#[derive(Clone, Copy, Debug)]
struct Node {
    at: Extremum<f64>,
    /// What `x` lacks, where the node is known to double-double accuracy.
    low: f64,
    inside: bool,
    sharp: bool,
}

impl Node {
    #[inline(always)]
    fn end(x: f64) -> Node {
        Node { at: Extremum::end(x), low: 0.0, inside: false, sharp: false }
    }
}

/// The extremum near `x` in double-double; `None` where its sign is still in doubt, or another extremum is so near
/// that `f64` cannot keep them apart.
#[inline(always)]
fn sharpened<P: Product>(torus: &Torus, line: &Line, x: f64) -> Option<Node> {
    let mut c = Double::from(x);
    let (p, q) = line.extremal::<P>();
    let bend = 2.0 * (3.0 * x * x + p.high);
    // The slope's roundings, 2^-47 of S^3, displace the extremum in f64 by twice that over the bend. Down to this bend
    // that is at most 2^-36 S; Newton's step squares it, times 12 S over the bend, to 2^-58 S, and the value errs by
    // the bend times the square of that: 2^-120.
    if bend.abs() < exp2i(-10) * torus.reach * torus.reach {
        return None;
    }
    let square = c.square::<P>();
    let slope = (square + p).mul::<P>(c) + q;
    c = c - slope.high / (0.5 * bend);
    let value = line.value::<P>(c).0.high;
    // Twice, so that where this is certain of a sign, so is the module `exact` at its own rounding of the place.
    if value.abs() <= 2.0 * exact::uncertainty::<P>(torus, line, c) || value.is_nan() {
        return None;
    }
    let at = Extremum { x: c.high, value, bend };
    Some(Node { at, low: c.low, inside: value < 0.0, sharp: true })
}

impl Task for Filter<'_> {
    type Output = Verdict;

    #[inline(always)]
    fn run<P: Product>(self) -> Verdict {
        let Filter { torus, ray, within, all } = self;
        const MISS: Verdict = Verdict::Certain(Hits::NONE);
        if largest(ray.relative.high()) > FAR || ray.power.abs() > 1000 {
            return Verdict::Doubt;
        }
        let ring = Ring::of(torus);
        let Some((line, _)) = RoughLine::new::<P>(&ring, &ray.relative, ray.direction.into()) else {
            return MISS;
        };
        let unit = exp2i(ray.power);
        let end = line.end(&ring);
        let error_t = line.error_of_parameters(end);
        let ends = (within.min, within.max);
        let (from, to) = line.stretch(&ring, end, ends, exp2i(-ray.power), 2.0 * error_t);
        if from > to || line.passes_the_tube(&ring, from, to) != 0 {
            return MISS;
        }

        let (extrema, triple) = line.extrema();
        let count = if triple != 0 { 3 } else { 1 };
        // All signs first: the count must be certain.
        let mut nodes = [Node::end(-end), Node::end(end), Node::end(end), Node::end(end), Node::end(end)];
        let mut precise = None;
        for (node, &x) in nodes[1..].iter_mut().zip(extrema.iter().take(count)) {
            let (at, certain) = line.extremum(&ring, x);
            *node = if certain != 0 {
                Node { at, low: 0.0, inside: at.value < 0.0, sharp: false }
            } else {
                let precise = precise.get_or_insert_with(|| Line::of::<P>(torus, ray));
                match sharpened::<P>(torus, precise, x) {
                    Some(node) => node,
                    None => return Verdict::Doubt,
                }
            };
        }

        let mut hits = Hits::NONE;
        let mut root = 0;
        for pair in nodes.windows(2).take(count + 1) {
            let &[low, high] = pair else { break };
            if low.inside == high.inside {
                continue;
            }
            let index = root;
            root += 1;
            // Clearly before the interval: not worth finding.
            if (line.parameter_at(high.at.x) + error_t) * unit <= within.min {
                continue;
            }
            let t = line.parameter_at(refine(&ring, &line, &low, &high)) * unit;
            if let Some(hit) = within.admit(t, 0, index) {
                if let Some(slot) = hits.list.get_mut(index as usize) {
                    *slot = Some(hit);
                }
                if !all {
                    break;
                }
            } else if t >= within.max {
                break;
            }
        }
        Verdict::Certain(hits)
    }
}

/// The crossing between two nodes of different sign.
#[inline(always)]
fn refine(ring: &Ring<f64>, line: &RoughLine, low: &Node, high: &Node) -> f64 {
    if low.sharp | high.sharp {
        let (from_low, from_high) = (low.at.reach(), high.at.reach());
        let rising = from_high.is_nan() || from_low <= from_high;
        let (near, offset) = if rising { (low, from_low) } else { (high, -from_high) };
        if near.sharp {
            let far = if rising { high.at.x - low.at.x } else { low.at.x - high.at.x };
            return near.at.x + (near.low + beside(near, offset, far));
        }
    }
    line.crossing(ring, low.at, high.at, if low.inside { 1.0 } else { 0.0 }, 0.0)
}

/// How far from a sharp extremum the crossing is that lies between it and the place `far` away, where the sign differs:
/// from the parabola's guess to the zero of the Taylor series `value + bend y^2 + 4 x y^3 + y^4`, which knows it to a few
/// roundings of itself.
#[inline(always)]
fn beside(node: &Node, guess: f64, far: f64) -> f64 {
    let (mut near, mut beyond) = (0.0, far);
    let between = |y: f64, near: f64, beyond: f64| (y - near) * (y - beyond) < 0.0;
    let mut y = if between(guess, near, beyond) { guess } else { 0.5 * far };
    // The guess is off by a part of the order of y, and each step squares that, unless an inflection lies between. Then
    // Newton's method may first run far beyond and come back by a quarter of the way a step, as for y^4: 120 such steps are
    // 2^-49 of the way. A step of 2^-30 y leaves the square of that.
    for _ in 0..120 {
        #[cfg(test)]
        crate::kernel::counted::step();
        let cubic = 4.0 * node.at.x + y;
        let value = node.at.value + y * y * (node.at.bend + y * cubic);
        let slope = y * (2.0 * node.at.bend + y * (3.0 * cubic + y));
        if (value < 0.0) == node.inside {
            near = y;
        } else {
            beyond = y;
        }
        let step = value / slope;
        let next = y - step;
        if between(next, near, beyond) {
            y = next;
        } else if step.abs() <= exp2i(-30) * y.abs() {
            break;
        } else {
            y = 0.5 * (near + beyond);
            continue;
        }
        if step.abs() <= exp2i(-30) * y.abs() {
            break;
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;
    use crate::kernel::run;
    use crate::testing::Random;
    use alloc::vec::Vec;
    use glam::DVec3;

    fn rough_line<P: Product>(torus: &Torus, ray: &ScaledRay) -> Option<RoughLine> {
        let line = RoughLine::new::<P>(&Ring::of(torus), &ray.relative, ray.direction.into());
        line.map(|(line, _)| line)
    }

    /// What the rough line says of a place, and the precise one.
    struct Both<'a>(&'a Torus, &'a ScaledRay, f64);

    impl Task for Both<'_> {
        type Output = Option<(RoughLine, Line, [f64; 3])>;
        fn run<P: Product>(self) -> Self::Output {
            let Both(torus, ray, x) = self;
            let line = Line::of::<P>(torus, ray);
            let at = |x: f64| line.value::<P>(Double::from(x));
            // (f(x + h) - 2 f(x) + f(x - h)) / h^2 is f'' + 2 h^2.
            let h = exp2i(-6);
            let second =
                ((at(x + h).0 + at(x - h).0) - at(x).0.scale_exact(2.0)).to_f64() / (h * h) - 2.0 * h * h;
            Some((rough_line::<P>(torus, ray)?, line, [at(x).0.to_f64(), at(x).1.to_f64(), second]))
        }
    }

    /// Values are within their errors, which are no more than two hundred roundings; slopes and curvatures are those of the
    /// same function.
    #[test]
    fn rough_and_precise_lines_agree() {
        let mut random = Random::new(1);
        let mut count = 0;
        for _ in 0..4000 {
            let torus =
                Torus::new(random.in_cube(), random.direction(), 1.0, random.uniform(0.05, 1.5)).unwrap();
            let target = torus.center + random.in_cube();
            let along = random.direction();
            let ray = torus.scaled(&Ray::new(target - along * 3.0, along));
            let (ray, s) = (ray.unwrap(), torus.reach);
            let x = random.uniform(-1.0, 1.0) * s;
            let Some((rough, line, [value, slope, second])) = run(Both(&torus, &ray, x)) else { continue };
            count += 1;
            let at = rough.value(&Ring::of(&torus), x);
            assert!((at.value - value).abs() <= at.error, "{torus:?} {ray:?} {x}");
            assert!(at.error < 1000.0 * U * s * s * s * s, "{torus:?} {ray:?} {x}: {}", at.error);
            assert!((at.slope - slope).abs() < 1e-13 * s * s * s);
            assert!((rough.bend(x) - 0.125 * second).abs() < 1e-12 * s * s, "{torus:?} {ray:?} {x}");
            assert!((line.slope_at(x) - slope).abs() < 1e-13 * s * s * s, "{torus:?} {ray:?} {x}");
            assert!((line.bend(x) - 0.125 * second).abs() < 1e-12 * s * s, "{torus:?} {ray:?} {x}");
        }
        assert!(count > 1000, "{count}");
    }

    /// The error of a value is what it changes by with the errors of `k` and `z` that are derived above, whatever their signs,
    /// its own roundings, and what the rounded place of an extremum matters: no less, and no more.
    #[test]
    fn what_values_err() {
        let mut random = Random::new(4);
        let mut count = 0;
        for case in 0..4000 {
            let minor = if case % 2 == 0 { random.uniform(0.3, 2.0) } else { random.magnitude(-4.0, 0.0) };
            let torus = Torus::new(random.in_cube(), random.direction(), 1.0, minor).unwrap();
            let s = torus.reach;
            let along = random.direction();
            let target = torus.center + random.in_cube() * s;
            let ray = torus.scaled(&Ray::new(target - along * 3.0, along)).unwrap();
            let x = random.uniform(-1.0, 1.0) * s;
            let Some((rough, ..)) = run(Both(&torus, &ray, x)) else { continue };
            count += 1;
            let value = |k: f64, z: f64| {
                let (k, z) = (rough.k + x * x + k, rough.z + x * rough.slope + z);
                k * k
                    - 4.0
                        * (torus.major_scaled * torus.major_scaled)
                        * (minor * exp2i(-torus.scale) - z)
                        * (minor * exp2i(-torus.scale) + z)
            };
            // Millions of times as large, which `f64` shows.
            let share = exp2i(22);
            let (of_k, of_z) = (24.0 * U * s * s * share, 16.0 * U * s * share);
            let worst = |k: f64, z: f64| {
                (value(k, z) - value(0.0, 0.0)).abs().max((value(-k, -z) - value(0.0, 0.0)).abs()) / share
            };
            let (k, z) = (rough.k + x * x, rough.z + x * rough.slope);
            let gap = torus.minor_scaled * torus.minor_scaled - z * z;
            let terms = k * k + 4.0 * torus.major_scaled * torus.major_scaled * gap.abs();
            let expected = worst(of_k, 0.0) + worst(0.0, of_z) + 4.0 * U * terms + 0.0625 * U * s * s * s * s;
            let found = rough.value(&Ring::of(&torus), x).error;
            assert!((found / expected - 1.0).abs() < 1e-4, "{torus:?} {ray:?} {x}: {found:e} {expected:e}");
        }
        assert!(count > 1000, "{count}");
    }

    struct Sharp<'a>(&'a Torus, &'a ScaledRay, f64);

    impl Task for Sharp<'_> {
        type Output = Option<(Node, f64, f64)>;
        fn run<P: Product>(self) -> Self::Output {
            let Sharp(torus, ray, off) = self;
            let rough = rough_line::<P>(torus, ray)?;
            let line = Line::of::<P>(torus, ray);
            let node = sharpened::<P>(torus, &line, outermost(rough.p, rough.q) + off)?;
            let at = Double::sum(node.at.x, node.low);
            let (value, slope) = line.value::<P>(at);
            Some((node, value.to_f64(), slope.to_f64()))
        }
    }

    /// A sharp node is where the slope vanishes, to twice the precision of where it was looked for.
    #[test]
    fn sharp_nodes_are_extrema() {
        let mut random = Random::new(2);
        let mut count = 0;
        for _ in 0..2000 {
            let torus =
                Torus::new(random.in_cube(), random.direction(), 1.0, random.uniform(0.1, 0.9)).unwrap();
            let target = torus.center + random.in_cube();
            let along = random.direction();
            let ray = torus.scaled(&Ray::new(target - along * 3.0, along)).unwrap();
            let off = random.uniform(-1.0, 1.0) * exp2i(-36);
            let Some((node, value, slope)) = run(Sharp(&torus, &ray, off)) else { continue };
            count += 1;
            let s = torus.reach;
            assert!(slope.abs() <= exp2i(-55) * s * s * s, "{torus:?} {ray:?} {slope:e}");
            assert!((value - node.at.value).abs() <= exp2i(-90) * s * s * s * s, "{value:e} {node:?}");
            assert!(node.inside == (node.at.value < 0.0) && node.sharp);
        }
        assert!(count > 1000, "{count}");
    }

    /// Lines through the hole or past the rim, within the slab of the tube, are told at once; what is told so is true.
    #[test]
    fn lines_that_pass_the_tube() {
        struct Passes<'a>(&'a Torus, &'a ScaledRay);
        impl Task for Passes<'_> {
            type Output = Option<(bool, usize)>;
            fn run<P: Product>(self) -> Self::Output {
                let rough = rough_line::<P>(self.0, self.1)?;
                let line = Line::of::<P>(self.0, self.1);
                let s = self.0.reach;
                let ring = Ring::of(self.0);
                let ends = (f64::NEG_INFINITY, f64::INFINITY);
                let (from, to) = rough.stretch(&ring, s, ends, 1.0, 0.0);
                let passes = rough.passes_the_tube(&ring, from, to) != 0;
                Some((passes, exact::crossings::<P>(self.0, &line).as_slice().len()))
            }
        }
        let mut random = Random::new(3);
        let mut count = [0; 3];
        for case in 0..4000 {
            let torus = Torus::new(random.in_cube(), random.direction(), 1.0, 0.25).unwrap();
            let [x, y, z] = torus.frame.map(|axis| axis.high());
            // At a distance from the axis: within the hole, next to its edge, in the tube, or any.
            let rho = match case % 4 {
                0 => random.uniform(0.0, 0.5),
                1 => 0.75 + random.sign() * random.magnitude(-17.0, -2.0),
                2 => 1.25 + random.sign() * random.magnitude(-17.0, -2.0),
                _ => random.uniform(0.0, 1.25),
            };
            let turn = random.uniform(0.0, core::f64::consts::TAU);
            let place = torus.center + (x * libm::cos(turn) + y * libm::sin(turn)) * rho;
            let along = z + if case % 4 == 0 { random.in_cube() * 0.3 } else { DVec3::ZERO };
            let ray = torus.scaled(&Ray::new(place - along * 3.0, along)).unwrap();
            let Some((passes, crossings)) = run(Passes(&torus, &ray)) else { continue };
            assert!(!passes || crossings == 0, "{torus:?} {ray:?}");
            match case % 4 {
                0 => count[usize::from(passes)] += 1,
                // Along the axis, as near to the edge of the hole as can be told.
                1 if rho < 0.75 - 1e-12 => assert!(passes, "{torus:?} {rho}"),
                _ => count[2] += u32::from(passes),
            }
        }
        assert!(count[0] == 0 && count[1] == 1000 && count[2] > 250, "{count:?}");
        // Slanted lines past the rim, outside it all the way through the slab and yet near to the centre.
        let mut beside = 0;
        for case in 0..4000 {
            let torus = Torus::new(random.in_cube(), random.direction(), 1.0, 0.25).unwrap();
            let [x, y, z] = torus.frame.map(|axis| axis.high());
            let turn = random.uniform(0.0, core::f64::consts::TAU);
            let (out, sideways) =
                (x * libm::cos(turn) + y * libm::sin(turn), y * libm::cos(turn) - x * libm::sin(turn));
            let (inward, aside) = (random.uniform(0.0, 2.0), random.uniform(-1.0, 1.0));
            // Through the upper side of the slab and nearest to the axis there or, on the way up again, at the lower one; just
            // outside the rim or far from it.
            let end = if case % 2 == 0 { 0.25 } else { -0.25 };
            let gap = random.magnitude(-15.0, -0.5);
            let along =
                (z - out * inward * if end > 0.0 { 1.0 } else { -1.0 } + sideways * aside).normalize();
            let place = torus.center + out * (1.25 + gap) + z * end;
            let scaled = torus.scaled(&Ray::new(place - along * 3.0, along)).unwrap();
            let other = place - along * (2.0 * end / along.dot(z));
            let rho = |p: DVec3| (p - torus.center - z * (p - torus.center).dot(z)).length();
            // Nearest to the axis inside the slab it may be anywhere.
            let inside = (place - torus.center).dot(along - z * along.dot(z)) * end > 0.0;
            let Some((passes, crossings)) = run(Passes(&torus, &scaled)) else { continue };
            assert!(!passes || crossings == 0);
            if gap > 1e-13 && rho(other) > rho(place) && !inside {
                beside += 1;
                assert!(passes, "{torus:?} {gap} {case}");
            }
        }
        assert!(beside > 500, "{beside}");
    }

    /// The stretch holds every crossing inside the interval, and is what sphere, slab and interval have in common, but for
    /// the error of a hit.
    #[test]
    fn stretches_hold_what_is_asked_for() {
        struct Stretch<'a>(&'a Torus, &'a ScaledRay, Interval);
        impl Task for Stretch<'_> {
            type Output = Option<((f64, f64), RoughLine, [f64; 2], Vec<f64>)>;
            fn run<P: Product>(self) -> Self::Output {
                let Stretch(torus, ray, within) = self;
                let rough = rough_line::<P>(torus, ray)?;
                let line = Line::of::<P>(torus, ray);
                let per_unit = exp2i(-ray.power);
                let stretch =
                    rough.stretch(&Ring::of(torus), torus.reach, (within.min, within.max), per_unit, 0.0);
                let ends =
                    [within.min, within.max].map(|t| line.distance::<P>(Double::from(t * per_unit)).to_f64());
                let crossings = exact::crossings::<P>(torus, &line);
                Some((stretch, rough, ends, crossings.as_slice().iter().map(|x| x.to_f64()).collect()))
            }
        }
        let mut random = Random::new(5);
        let mut count = [0; 4];
        for _ in 0..4000 {
            let size = random.magnitude(-3.0, 3.0);
            let minor = random.uniform(0.05, 0.6) * size;
            let torus = Torus::new(random.in_cube(), random.direction(), size, minor).unwrap();
            let target = torus.center + random.in_cube() * size;
            let along = random.direction() * random.magnitude(-1.0, 1.0);
            let ray = Ray::new(target - along.normalize() * (3.0 * size), along);
            let scaled = torus.scaled(&ray).unwrap();
            let speed = size / along.length();
            let min = random.uniform(0.0, 4.0) * speed;
            let within = Interval::new(min, min + random.uniform(0.0, 4.0) * speed);
            let Some(((from, to), rough, [min, max], crossings)) = run(Stretch(&torus, &scaled, within))
            else {
                continue;
            };
            let s = torus.reach;
            // The slab, from the line's height at its closest approach.
            let heights = [-1.0, 1.0].map(|side| (side * torus.minor_scaled - rough.z) / rough.slope);
            let (enter, leave) = (heights[0].min(heights[1]), heights[0].max(heights[1]));
            let (first, last) = (min.max(enter).max(-s), max.min(leave).min(s));
            // The slab is thicker by 32 u S, which a slanted line makes longer.
            let room = 2.01 * HIT_ERROR * s + 64.0 * U * s / rough.slope.abs();
            assert!(from <= first + 1e-3 * room && from >= first - room, "{torus:?} {ray:?} {within:?}");
            assert!(to >= last - 1e-3 * room && to <= last + room, "{torus:?} {ray:?} {within:?}");
            for x in crossings {
                assert!(x < min || x > max || (x >= from && x <= to), "{torus:?} {ray:?} {within:?} {x}");
            }
            let which =
                |x: f64, ends: [f64; 2]| ends.iter().position(|&end| (x - end).abs() <= room).unwrap_or(2);
            count[which(from, [min, enter])] += 1;
            if which(to, [max, leave]) == 0 {
                count[2] += 1;
            } else {
                count[3] += 1;
            }
        }
        assert!(count[0] > 300 && count[1] > 300 && count[2] > 300 && count[3] > 300, "{count:?}");
    }
}
