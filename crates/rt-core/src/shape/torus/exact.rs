//! All crossings of a line with the torus, separated and refined in double-double.
//!
//! The signs of `f` at its extrema decide how many crossings there are and between which extrema each lies. An error
//! `e` of an extremum changes the value there by the order of `e^2` only, so the signs are those of the exact ray
//! wherever double-double can tell. A tangency (the sign cannot be told from zero) counts as none.

use super::Torus;
use super::extrema::outermost;
use super::line::Line;
use crate::double::Double;
use crate::kernel::Product;
use crate::math::{exp2i, sqrt};

/// At most four crossings, ascending: distances from the closest approach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossings {
    x: [Double; 4],
    count: usize,
}

impl Crossings {
    /// No crossing.
    pub const NONE: Crossings = Crossings { x: [Double::ZERO; 4], count: 0 };

    /// Appends a crossing; a quartic has no fifth.
    #[inline(always)]
    pub fn push(&mut self, x: Double) {
        if let Some(slot) = self.x.get_mut(self.count) {
            *slot = x;
            self.count += 1;
        }
    }

    /// The distances, ascending.
    #[inline(always)]
    pub fn as_slice(&self) -> &[Double] {
        self.x.get(..self.count).unwrap_or(&[])
    }
}

/// An end of a stretch on which the function is monotonic.
#[derive(Clone, Copy, Debug)]
struct Node {
    x: Double,
    value: f64,
    inside: bool,
    extremum: bool,
}

/// The rounding of `k` and `z` in units of their scale, `(R + r)^2` and `R + r`: some twenty roundings of 2^-104.
pub(super) const ROUNDING: f64 = exp2i(-99);

/// How large a value of `f` at `x` double-double arithmetic can return for an exact zero: the roundings of `k` and
/// `z` times the derivatives of `f` by them, and those of the last difference. In the form that `f` is evaluated in there,
/// which digits of `k` beyond `f64` may decide.
#[inline(always)]
pub(super) fn uncertainty<P: Product>(torus: &Torus, line: &Line, x: Double) -> f64 {
    let square = 4.0 * torus.major_scaled * torus.major_scaled;
    let k = (line.k + x.square::<P>()).high;
    if let Some(core) = &line.core
        && k < -0.25 * square
    {
        return ROUNDING * core.magnitude::<P>(x, 0.5 * square);
    }
    let x = x.high;
    let z = line.z.high + x * line.slope.high;
    let gap = (torus.minor_scaled - z) * (torus.minor_scaled + z);
    let reach = torus.reach;
    ROUNDING * (2.0 * k.abs() * reach * reach + square * (2.0 * z.abs() * reach + gap.abs()) + k * k)
}

/// The extrema of `f` in ascending order; one or three of them.
#[inline(always)]
fn extrema<P: Product>(line: &Line) -> ([Double; 3], usize) {
    let (p, q) = line.extremal::<P>();
    let mut c = Double::from(outermost(p.high, q.high));
    // Two steps turn 50 correct bits into all that double-double has.
    for _ in 0..2 {
        let square = c.square::<P>();
        let value = (square + p).mul::<P>(c) + q;
        let step = value.high / (3.0 * square.high + p.high);
        if step.is_finite() {
            c = c - step;
        }
    }
    let discriminant = -(c.square::<P>().scale::<P>(3.0) + p.scale_exact(4.0));
    if discriminant.high < 0.0 {
        return ([c, Double::ZERO, Double::ZERO], 1);
    }
    let root = discriminant.sqrt::<P>();
    let (a, b) = ((-c - root).scale_exact(0.5), (-c + root).scale_exact(0.5));
    if c.high < 0.0 { ([c, a, b], 3) } else { ([a, b, c], 3) }
}

/// All crossings of the line.
#[inline(always)]
pub(super) fn crossings<P: Product>(torus: &Torus, line: &Line) -> Crossings {
    let mut found = Crossings::NONE;
    let (extrema, count) = extrema::<P>(line);
    // f is positive at both ends: the distance from the centre exceeds R + r.
    let end = Double::from(2.0 * torus.reach);
    let mut low = Node { x: -end, value: 1.0, inside: false, extremum: false };
    for i in 0..=count {
        let high = match extrema.get(i) {
            Some(&x) if i < count => {
                let value = line.value::<P>(x).0.high;
                // Touching from within counts as within, touching from without as without.
                let inside = if value.abs() <= uncertainty::<P>(torus, line, x) {
                    i == 1 && low.inside
                } else {
                    value < 0.0
                };
                Node { x, value, inside, extremum: true }
            }
            _ => Node { x: end, value: 1.0, inside: false, extremum: false },
        };
        if low.inside != high.inside {
            found.push(refine::<P>(line, &low, &high));
        }
        low = high;
    }
    found
}

/// The one crossing between two neighbouring nodes of different sign.
#[inline(always)]
fn refine<P: Product>(line: &Line, low: &Node, high: &Node) -> Double {
    let (mut a, mut b) = (low.x, high.x);
    let middle = |a: Double, b: Double| (a + b).scale_exact(0.5);
    // Where the parabola at an extremum is zero.
    let reach = |node: &Node| {
        let reach = sqrt(-node.value / (4.0 * line.bend(node.x.high)));
        if node.extremum && reach.is_finite() { reach } else { f64::INFINITY }
    };
    let (from_low, from_high) = (reach(low), reach(high));
    let mut x = if from_low <= from_high { a + from_low } else { b - from_high };
    if !(x > a && x < b) {
        x = middle(a, b);
    }
    // Halving alone comes to an end after 106 steps, Newton's method after a handful.
    for _ in 0..110 {
        let (value, slope) = line.value::<P>(x);
        if value.high == 0.0 {
            break;
        }
        if (value.high < 0.0) == low.inside {
            a = x;
        } else {
            b = x;
        }
        let step = value.div::<P>(slope).scale_exact(0.25);
        let next = x - step;
        if next > a && next < b {
            x = next;
            if finished(line, x, slope.high, step.high) {
                break;
            }
        } else {
            let next = middle(a, b);
            if !(next > a && next < b) {
                break;
            }
            x = next;
        }
    }
    x
}

/// Whether Newton's step leaves no more than 2^-105 of an error.
#[inline(always)]
fn finished(line: &Line, x: Double, slope: f64, step: f64) -> bool {
    left(line, x, slope, step) <= 0.5 * f64::EPSILON * f64::EPSILON
}

/// The error that Newton's step leaves: from the series of `f` about `x`, the new place,
/// `(step^2 f'' / 2 + step^3 f''' / 3 + 3 step^4) / f'`. `slope` is a quarter of the derivative.
#[inline(always)]
pub(super) fn left(line: &Line, x: Double, slope: f64, step: f64) -> f64 {
    let step = step.abs();
    let bend = line.bend(x.high).abs() + step * (2.0 * x.high.abs() + 0.75 * step);
    (step * step * bend / slope).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;
    use crate::kernel::{Task, run};
    use crate::testing::Random;
    use glam::DVec3;

    /// Newton's step from beside a crossing: what it is said to leave and what it leaves, and the share of the step in
    /// the distance to an inflection.
    struct Step<'a>(&'a Torus, &'a crate::scaled::ScaledRay, f64);

    impl Task for Step<'_> {
        type Output = Option<[f64; 3]>;
        fn run<P: Product>(self) -> Self::Output {
            let Step(torus, ray, off) = self;
            let line = Line::of::<P>(torus, ray);
            let &zero = crossings::<P>(torus, &line).as_slice().first()?;
            let x = zero + off;
            let (value, slope) = line.value::<P>(x);
            let step = value.div::<P>(slope).scale_exact(0.25);
            let next = x - step;
            let share = (step.high * line.bend(x.high) / slope.high).abs();
            Some([left(&line, next, slope.high, step.high), (next - zero).high.abs(), share])
        }
    }

    #[test]
    fn what_a_step_leaves() {
        let mut random = Random::new(1);
        let mut count = 0;
        for _ in 0..4000 {
            let torus =
                Torus::new(random.in_cube(), random.direction(), 1.0, random.uniform(0.05, 0.9)).unwrap();
            let target = torus.center + random.in_cube();
            let along = random.direction();
            let ray = torus.scaled(&Ray::new(target - along * 3.0, along)).unwrap();
            let off = random.magnitude(-10.0, -3.0) * random.sign();
            let Some([said, there, share]) = run(Step(&torus, &ray, off)) else { continue };
            if share < 0.01 {
                count += 1;
                assert!((said / there - 1.0).abs() < 0.03, "{torus:?} {ray:?} {off}: {said} {there}");
            }
        }
        assert!(count > 1000, "{count}");
    }

    struct Moved<'a>(&'a Line, Double, [f64; 2]);

    impl Task for Moved<'_> {
        type Output = f64;
        fn run<P: Product>(self) -> f64 {
            let Moved(line, x, [k, z]) = self;
            let mut moved = *line;
            (moved.k, moved.z) = (line.k + k, line.z + z);
            (moved.value::<P>(x).0 - line.value::<P>(x).0).to_f64()
        }
    }

    struct Lines<'a>(&'a Torus, &'a crate::scaled::ScaledRay);

    impl Task for Lines<'_> {
        type Output = Line;
        fn run<P: Product>(self) -> Line {
            Line::of::<P>(self.0, self.1)
        }
    }

    /// What is uncertain of `f` is what changes of `k` and `z` by a rounding of their scales change, whatever their signs, and a
    /// rounding of the terms: no less, and no more.
    #[test]
    fn what_is_uncertain() {
        let mut random = Random::new(2);
        let mut count = 0;
        let share = exp2i(-40);
        for case in 0..4000 {
            let minor = if case % 2 == 0 { random.uniform(0.3, 2.0) } else { random.magnitude(-4.0, 0.0) };
            let torus = Torus::new(DVec3::ZERO, random.direction(), 1.0, minor).unwrap();
            let along = random.direction();
            let target = random.in_cube() * torus.reach;
            let ray = torus.scaled(&Ray::new(target - along * 3.0, along)).unwrap();
            let line = run(Lines(&torus, &ray));
            let x = random.uniform(-1.0, 1.0) * torus.reach;
            let square = 4.0 * torus.major_scaled * torus.major_scaled;
            let k = line.k.high + x * x;
            if line.core.is_some() && k < -0.2 * square {
                continue;
            }
            count += 1;
            let reach = torus.reach;
            let [worst_k, worst_z] = [[share * reach * reach, 0.0], [0.0, share * reach]].map(|by| {
                let there = |side: f64| run(Moved(&line, Double::from(x), by.map(|by| side * by))).abs();
                there(1.0).max(there(-1.0)) / share
            });
            let z = line.z.high + x * line.slope.high;
            let terms = k * k + square * (torus.minor_scaled * torus.minor_scaled - z * z).abs();
            let found = uncertainty::<crate::kernel::Dekker>(&torus, &line, Double::from(x)) / ROUNDING;
            let expected = worst_k + worst_z + terms;
            assert!((found / expected - 1.0).abs() < 1e-6, "{torus:?} {ray:?} {x}: {found} {expected}");
        }
        assert!(count > 2000, "{count}");
    }
}
