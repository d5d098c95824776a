//! The fast half of a hit: all in `f64`, with error bounds that tell when it cannot decide.
//!
//! The same steps as in the module `exact`. What is known of a value of `f` is its sign whenever it exceeds the error
//! bound, and then no rounding can have changed the count; anything else is handed to double-double arithmetic.

use super::Torus;
use super::extrema::outermost;
use crate::double::two_sum;
use crate::kernel::{Product, Task};
use crate::math::{exp2i, sqrt};
use crate::scaled::{ScaledRay, largest};
use crate::{Hit, Interval};
use glam::DVec3;

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

/// A line about its closest approach: the same quantities as in [`Line`](super::line::Line).
#[derive(Clone, Copy, Debug)]
pub(super) struct RoughLine {
    /// The parameter of the closest approach is the sum of the two.
    pub first: f64,
    pub rest: f64,
    pub square: f64,
    /// One over the length of the direction.
    pub inverse: f64,
    pub k: f64,
    pub z: f64,
    pub slope: f64,
    pub p: f64,
    pub q: f64,
}

/// The value of `f`, a quarter of its derivative, and a bound on the error of the value.
#[derive(Clone, Copy, Debug)]
struct Value {
    value: f64,
    slope: f64,
    error: f64,
}

/// From further away the sums below lose more than they are allowed to.
const FAR: f64 = exp2i(40);
/// One rounding, relative.
const U: f64 = exp2i(-53);

impl RoughLine {
    /// `None` when the line clearly passes outside the sphere about the torus.
    ///
    /// `|m|` errs by at most 4 u of `R + r` for a line that passes within it: the sum is exact up to its last
    /// rounding, and the little that is left to go after the first step is known to 4 u.
    #[inline(always)]
    pub fn new<P: Product>(torus: &Torus, ray: &ScaledRay) -> Option<RoughLine> {
        let (d, w) = (ray.direction, ray.relative);
        let far = w.high();
        let length_squared = d.dot(d);
        let inverse_squared = 1.0 / length_squared;
        let first = -far.dot(d) * inverse_squared;
        let advance = |high: f64, low: f64, d: f64| {
            let (p, e) = P::two_product(first, d);
            let (s, f) = two_sum(high, p);
            s + (f + (e + low))
        };
        let near = DVec3::new(
            advance(w.x.high, w.x.low, d.x),
            advance(w.y.high, w.y.low, d.y),
            advance(w.z.high, w.z.low, d.z),
        );
        // Only the component across the line counts; along it the point may be off by what the scalar product and
        // the division err, 8 u of the distance, and some.
        let reach = torus.reach + largest(far) * (16.0 * U);
        if near.length_squared() > reach * reach * (1.0 + 16.0 * U) {
            return None;
        }
        let rest = -near.dot(d) * inverse_squared;
        let m = near + d * rest;
        let square = m.length_squared();
        if square > torus.reach * torus.reach * (1.0 + 32.0 * U) {
            return None;
        }
        let inverse = 1.0 / sqrt(length_squared);
        let k = square - torus.squares.high;
        let z = m.dot(torus.axis);
        let slope = d.dot(torus.axis) * inverse;
        let twice = torus.twice.high;
        Some(RoughLine {
            first,
            rest,
            square,
            inverse,
            k,
            z,
            slope,
            p: k + twice * slope * slope,
            q: twice * z * slope,
        })
    }

    /// `f` and its derivative at `x`, and how far the value may be off.
    ///
    /// The errors of `k` and `z`, with `S = R + r`, `|m|^2 + x^2 <= S^2` wherever it matters and `|m . u| <= 4 u |m|`:
    /// that of `|m|^2` 11 u S^2, of `R^2 + r^2` and the differences 4 u S^2, of `x^2` u S^2, of the neglected
    /// `2 x m . u` 8 u S^2, hence 24 u S^2; that of `m . a` 9 u S, of `x (u . a)` 9 u S, with the sum less than
    /// 16 u S since the two are perpendicular parts. `f` errs by these times its derivatives by `k` and `z` and by
    /// its own roundings; the rounded place of an extremum matters by less than u S^4 / 16.
    #[inline(always)]
    fn value(&self, torus: &Torus, x: f64) -> Value {
        let k = self.k + x * x;
        let z = self.z + x * self.slope;
        let r = torus.minor_scaled;
        let twice = torus.twice.high;
        let gap = (r - z) * (r + z);
        let s = torus.reach;
        let square = k * k;
        let error_k = 24.0 * U * s * s;
        let error_z = 16.0 * U * s;
        Value {
            value: square - 2.0 * twice * gap,
            slope: k * x + twice * z * self.slope,
            error: 2.0 * k.abs() * error_k
                + 4.0 * twice * (z.abs() + error_z) * error_z
                + 4.0 * U * (square + 2.0 * twice * gap.abs())
                + 0.0625 * U * s * s * s * s,
        }
    }

    /// An eighth of the second derivative.
    #[inline(always)]
    fn bend(&self, x: f64) -> f64 {
        0.5 * (3.0 * x * x + self.p)
    }

    /// The parameter at the distance `x` from the closest approach.
    #[inline(always)]
    pub fn parameter_at(&self, x: f64) -> f64 {
        self.first + (self.rest + x * self.inverse)
    }
}

/// An end of a stretch on which `f` is monotonic.
#[derive(Clone, Copy, Debug)]
struct Node {
    x: f64,
    value: f64,
    inside: bool,
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
        let Some(line) = RoughLine::new::<P>(torus, ray) else { return MISS };
        let unit = exp2i(ray.power);
        let s = torus.reach;
        // Where the line is inside the sphere about the torus, and a little more.
        let end = sqrt((s * s - line.square).max(0.0) + 64.0 * U * s * s);
        // The slab that holds the tube.
        if line.z.abs() - line.slope.abs() * end > torus.minor_scaled + 32.0 * U * s {
            return MISS;
        }
        // What the parameters err: the sum's roundings, the first step's product with the exact rest, and the
        // distance, of which a little more is asked below.
        let error_t = 4.0 * U * (line.first.abs() + line.rest.abs() + end * line.inverse);
        let (from, to) = (line.parameter_at(-end), line.parameter_at(end));
        if (to + error_t) * unit <= within.min || (from - error_t) * unit >= within.max {
            return MISS;
        }

        let c = outermost(line.p, line.q);
        let discriminant = -3.0 * c * c - 4.0 * line.p;
        // Where rounding may have made it negative, two equal extrema do no harm.
        let (extrema, count) = if discriminant < exp2i(-20) * -(c * c) {
            ([c, 0.0, 0.0], 1)
        } else {
            let root = sqrt(discriminant.max(0.0));
            let (a, b) = (-0.5 * (c + root), -0.5 * (c - root));
            (if c < 0.0 { [c, a, b] } else { [a, b, c] }, 3)
        };

        // All signs first: the count must be certain.
        let outside = |x: f64| Node { x, value: f64::NAN, inside: false };
        let mut nodes = [outside(-end), outside(end), outside(end), outside(end), outside(end)];
        for (node, &x) in nodes[1..].iter_mut().zip(extrema.iter().take(count)) {
            let Value { value, error, .. } = line.value(torus, x);
            if !(value.abs() > error) {
                return Verdict::Doubt;
            }
            *node = Node { x, value, inside: value < 0.0 };
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
            if (line.parameter_at(high.x) + error_t) * unit <= within.min {
                continue;
            }
            let Some((x, slack)) = refine(torus, &line, &low, &high) else { return Verdict::Doubt };
            let t = line.parameter_at(x) * unit;
            let error = (error_t + slack * line.inverse) * unit;
            if (t - within.min).abs() <= error || (t - within.max).abs() <= error {
                return Verdict::Doubt;
            }
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

/// The crossing between two nodes of different sign and how far it may be off; `None` if that is more than
/// [`HIT_ERROR`](super::record::HIT_ERROR).
#[inline(always)]
fn refine(torus: &Torus, line: &RoughLine, low: &Node, high: &Node) -> Option<(f64, f64)> {
    let (mut a, mut b) = (low.x, high.x);
    // Where the parabola at an extremum is zero; NaN for the ends, which are none.
    let reach = |node: &Node| sqrt(-node.value / (4.0 * line.bend(node.x)));
    let (from_low, from_high) = (reach(low), reach(high));
    let mut x = if from_high.is_nan() || from_low <= from_high { a + from_low } else { b - from_high };
    if !(x > a && x < b) {
        x = 0.5 * (a + b);
    }
    // Halving alone comes to an end after 53 steps and a few, Newton's method after four or five.
    for _ in 0..60 {
        let Value { value, slope, error } = line.value(torus, x);
        if (value < 0.0) == low.inside {
            a = x;
        } else {
            b = x;
        }
        let step = 0.25 * value / slope;
        let next = x - step;
        if next > a && next < b {
            x = next;
            // The step leaves an error of step^2 f'' / (2 f'), by the series of f, and that of the value.
            let left = (step * step * line.bend(x) / slope).abs();
            let known = 0.25 * error / slope.abs();
            if left <= 0.25 * known {
                let slack = 2.0 * known;
                return if slack <= super::record::HIT_ERROR { Some((x, slack)) } else { None };
            }
        } else if value == 0.0 || step.abs() <= 2.0 * U * x.abs() {
            let slack = 0.5 * error / slope.abs() + step.abs();
            return if slack <= super::record::HIT_ERROR { Some((x, slack)) } else { None };
        } else {
            x = 0.5 * (a + b);
        }
    }
    None
}
