//! All crossings of a line with the torus, separated and refined in double-double.
//!
//! The extrema of `f` are the zeros of the cubic `x^3 + P x + Q`; their signs alone decide how many crossings there
//! are and between which extrema each lies. An error `e` of an extremum changes the value there by `e^2` only, so the
//! signs are those of the exact ray wherever double-double can tell.

use super::Torus;
use super::approach::Approach;
use crate::double::Double;
use crate::kernel::Product;
use crate::math::sqrt;

/// At most four crossings, ascending.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossings {
    x: [Double; 4],
    count: usize,
}

impl Crossings {
    /// No crossing.
    pub const NONE: Crossings = Crossings { x: [Double::ZERO; 4], count: 0 };

    fn push(&mut self, x: Double) {
        if let Some(slot) = self.x.get_mut(self.count) {
            *slot = x;
            self.count += 1;
        }
    }

    /// The distances from the closest approach, ascending.
    pub fn as_slice(&self) -> &[Double] {
        self.x.get(..self.count).unwrap_or(&[])
    }
}

/// The quartic of one line: see the module `approach`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quartic {
    k: Double,
    z: Double,
    slope: Double,
    major: f64,
    minor: f64,
    /// `2 R^2`.
    twice: Double,
    /// `P`, the coefficient of the cubic of the extrema.
    p: Double,
    /// `Q`, its constant.
    q: Double,
}

impl Quartic {
    #[inline(always)]
    pub fn new<P: Product>(torus: &Torus, line: &Approach) -> Quartic {
        let twice = Double::product::<P>(torus.major_scaled, torus.major_scaled).scale_exact(2.0);
        Quartic {
            k: line.k,
            z: line.z,
            slope: line.slope,
            major: torus.major_scaled,
            minor: torus.minor_scaled,
            twice,
            p: line.k + twice.mul::<P>(line.slope.square::<P>()),
            q: twice.mul::<P>(line.z.mul::<P>(line.slope)),
        }
    }

    /// `f(x)` and a quarter of its derivative.
    #[inline(always)]
    pub fn value<P: Product>(&self, x: Double) -> (Double, Double) {
        let k = self.k + x.square::<P>();
        let z = self.z + x.mul::<P>(self.slope);
        let gap = (Double::from(self.minor) - z).mul::<P>(Double::from(self.minor) + z);
        let value = k.square::<P>() - self.twice.mul::<P>(gap).scale_exact(2.0);
        let slope = k.mul::<P>(x) + self.twice.mul::<P>(z.mul::<P>(self.slope));
        (value, slope)
    }

    /// A quarter of half the second derivative, `(3 x^2 + P) / 2`, roughly.
    #[inline(always)]
    pub fn bend(&self, x: f64) -> f64 {
        0.5 * (3.0 * x * x + self.p.high)
    }

    /// The extremum of greatest distance from zero, rounded.
    #[inline(always)]
    fn outer_extremum_rounded(&self) -> f64 {
        let (p, q) = (self.p.high, self.q.high.abs());
        // y^3 + p y - q with q >= 0 is convex and positive at this bound, so that Newton's steps descend to its
        // greatest zero and end when rounding stops the descent.
        let mut y = 2.0 * sqrt(p.abs()).max(libm::cbrt(q));
        loop {
            let next = y - ((y * y + p) * y - q) / (3.0 * y * y + p);
            if !(next < y && next > 0.0) {
                break;
            }
            y = next;
        }
        if self.q.high > 0.0 { -y } else { y }
    }

    /// The extrema in ascending order; one or three of them.
    #[inline(always)]
    fn extrema<P: Product>(&self) -> ([Double; 3], usize) {
        let mut c = Double::from(self.outer_extremum_rounded());
        // Two steps double the 50 correct digits to all that double-double has.
        for _ in 0..2 {
            let square = c.square::<P>();
            let value = (square + self.p).mul::<P>(c) + self.q;
            let step = value.high / (3.0 * square.high + self.p.high);
            if step.is_finite() {
                c = c - step;
            }
        }
        let discriminant = -(c.square::<P>().scale::<P>(3.0) + self.p.scale_exact(4.0));
        if discriminant.high < 0.0 {
            return ([c, Double::ZERO, Double::ZERO], 1);
        }
        let root = discriminant.sqrt::<P>();
        let (a, b) = ((-c - root).scale_exact(0.5), (-c + root).scale_exact(0.5));
        if c.high < 0.0 { ([c, a, b], 3) } else { ([a, b, c], 3) }
    }

    /// All crossings of the line.
    #[inline(always)]
    pub fn crossings<P: Product>(&self) -> Crossings {
        let mut found = Crossings::NONE;
        let (extrema, count) = self.extrema::<P>();
        // f is positive here: the distance to the centre exceeds R + r.
        let end = 2.0 * (self.major + self.minor);
        let mut low = Node { x: Double::from(-end), value: 1.0, inside: false, extremum: false };
        for x in extrema.into_iter().take(count) {
            let high = Node::new(x, self.value::<P>(x).0.high);
            self.between::<P>(&low, &high, &mut found);
            low = high;
        }
        let high = Node { x: Double::from(end), value: 1.0, inside: false, extremum: false };
        self.between::<P>(&low, &high, &mut found);
        found
    }

    #[inline(always)]
    fn between<P: Product>(&self, low: &Node, high: &Node, found: &mut Crossings) {
        if low.inside != high.inside {
            found.push(self.refine::<P>(low, high));
        }
    }

    /// The one crossing between two neighbouring nodes of different sign.
    fn refine<P: Product>(&self, low: &Node, high: &Node) -> Double {
        let (mut a, mut b) = (low.x, high.x);
        let middle = |a: Double, b: Double| (a + b).scale_exact(0.5);
        // The parabola at the extremum whose zero is nearer.
        let guess = |node: &Node, sign: f64| {
            let reach = sqrt(-node.value / (4.0 * self.bend(node.x.high)));
            if node.extremum && reach.is_finite() { Some((reach, node.x + sign * reach)) } else { None }
        };
        let mut x = match (guess(low, 1.0), guess(high, -1.0)) {
            (Some((i, x)), Some((j, y))) => {
                if i < j {
                    x
                } else {
                    y
                }
            }
            (Some((_, x)), None) | (None, Some((_, x))) => x,
            (None, None) => middle(a, b),
        };
        if !(x > a && x < b) {
            x = middle(a, b);
        }
        // Bisection alone ends after 106 halvings; Newton's steps after a handful.
        for _ in 0..110 {
            let (value, slope) = self.value::<P>(x);
            if value.high == 0.0 {
                break;
            }
            if (value.high < 0.0) == low.inside {
                a = x
            } else {
                b = x
            }
            let step = value.div::<P>(slope).scale_exact(0.25);
            let next = x - step;
            if next > a && next < b {
                x = next;
                // The error that the step leaves is step^2 f'' / (2 f'); 2^-104 is what double-double resolves.
                let left = step.high * step.high * self.bend(x.high) / slope.high;
                if left.abs() <= 0.5 * f64::EPSILON * f64::EPSILON {
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
}

/// An end of a stretch on which `f` is monotonic.
#[derive(Clone, Copy, Debug)]
struct Node {
    x: Double,
    value: f64,
    inside: bool,
    extremum: bool,
}

impl Node {
    #[inline(always)]
    fn new(x: Double, value: f64) -> Node {
        Node { x, value, inside: value < 0.0, extremum: true }
    }
}
