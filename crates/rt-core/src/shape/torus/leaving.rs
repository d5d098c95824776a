//! A ray that starts on the torus: its start is a known crossing, divided out exactly.
//!
//! The start is put back onto the surface in double-double: the tube's angle from the departure's normal, the angle
//! about the axis from its point. With `y` the distance from there `f = y h(y)`,
//!
//! ```text
//! h(y) = y^3 + 4 s y^2 + (6 s^2 + 2 P) y + f',    f' = +-8 R rho r (n . u)
//! ```
//!
//! where `s` is the start's distance from the closest approach and `f'` the slope there, from the normal. Which side
//! the ray starts on is not computed but given: the sign of `f` just after the start is that of the side, and what
//! the rounded slope says is outvoted by it. A grazing exit may then fall upon the start itself.

use super::Torus;
use super::exact::{Crossings, uncertainty};
use super::line::Line;
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{Product, Task};
use crate::math::{exp2i, sqrt};
use crate::scaled::ScaledRay;
use crate::{Departure, Hit, Interval, Side};

/// Whether `f64` is certain that a ray which starts outside never comes back to the torus: most do not.
///
/// With `p` the start and `a = p . u`, the cubic of the module's head is
///
/// ```text
/// h(y) = y^3 + 4 a y^2 + 4 (b + a^2) y + f',    b = R (rho - R (1 - (u . axis)^2))
/// ```
///
/// (`|p|^2 + R^2 - r^2 = 2 R rho` on the surface). `f' > 0` where the ray leaves along the normal. Then `h` has no
/// positive zero if the quadratic in front has none, `b > 0`, or no negative coefficient, `a > 0` and `b + a^2 > 0`, or
/// if its least value after the start is positive.
///
/// All numbers here are below 2^8 in units of the torus, of which they lose less than 2^-40 by the roundings of the
/// start, the normal and the sums; the place of the least value errs by less than the root of that, its value by
/// the square of this once more. `MARGIN` is a thousand times as much.
#[inline]
pub(super) fn never_returns(torus: &Torus, ray: &ScaledRay, from: &Departure) -> bool {
    const MARGIN: f64 = exp2i(-30);
    // On a spindle the normal may belong to the inner sheet.
    if from.side != Side::Outside || torus.minor >= torus.major {
        return false;
    }
    let unit = ray.direction * (1.0 / sqrt(ray.direction.dot(ray.direction)));
    let away = from.normal.dot(unit);
    if !(away > MARGIN) {
        return false;
    }
    let (major, start) = (torus.major_scaled, from.local * exp2i(-torus.scale));
    let (height, slope) = (start.dot(torus.axis), unit.dot(torus.axis));
    let across = start - torus.axis * height;
    let rho = sqrt(across.dot(across));
    let along = start.dot(unit);
    let b = major * (rho - major * (1.0 - slope * slope));
    if b > MARGIN {
        return true;
    }
    let first = b + along * along;
    if along > MARGIN && first > MARGIN {
        return true;
    }
    // h' = 3 y^2 + 8 a y + 4 (b + a^2) vanishes last at 2 / 3 (sqrt(4 a^2 - 3 (b + a^2)) - 2 a).
    let discriminant = 4.0 * along * along - 3.0 * first;
    let y = (2.0 / 3.0) * (sqrt(discriminant.max(0.0)) - 2.0 * along);
    let constant = 8.0 * major * rho * torus.minor_scaled * away;
    let least = ((y + 4.0 * along) * y + 4.0 * first) * y + constant;
    constant > MARGIN && (y < 0.0 || least > MARGIN)
}

/// The crossings of a ray that leaves this torus, the start not counted, each through `each` until that says stop.
pub(super) struct Leave<'a, F> {
    pub torus: &'a Torus,
    pub ray: &'a ScaledRay,
    pub within: Interval,
    pub from: &'a Departure,
    pub first: bool,
    pub each: F,
}

/// The cubic `h` and what it was made from.
struct Cubic {
    second: Double,
    first: Double,
    constant: Double,
}

impl Cubic {
    #[inline(always)]
    fn value<P: Product>(&self, y: Double) -> (Double, Double) {
        let a = y + self.second;
        let b = a.mul::<P>(y) + self.first;
        (b.mul::<P>(y) + self.constant, (a + y).mul::<P>(y) + b)
    }

    #[inline(always)]
    fn rough(&self, y: f64) -> (f64, f64) {
        let a = y + self.second.high;
        let b = a * y + self.first.high;
        (b * y + self.constant.high, (a + y) * y + b)
    }

    /// The extrema, ascending; none where there are none or one horizontal inflection.
    #[inline(always)]
    fn extrema<P: Product>(&self) -> Option<[Double; 2]> {
        // 3 y^2 + 2 b y + c = 0
        let (b, c) = (self.second, self.first);
        let discriminant = b.square::<P>() - c.scale::<P>(3.0);
        if discriminant.high <= 0.0 {
            return None;
        }
        let root = discriminant.sqrt::<P>();
        let sum = if b.high > 0.0 { -b - root } else { root - b };
        let third = Double::ONE.div::<P>(Double::from(3.0));
        // The other from the product of the two, c / 3, so that it keeps its sign however small it is.
        let (x, y) = (sum.mul::<P>(third), c.div::<P>(sum));
        Some(if x < y { [x, y] } else { [y, x] })
    }
}

/// The start on the surface, and how `f` relates to the sides of the sheet it is on.
struct Start {
    point: DoubleVector,
    /// `f'` at the start over the length of the direction.
    slope: Double,
    /// Whether `f` is positive on the side that the normal points to: false on the inner sheet of a spindle.
    outer: bool,
    /// Whether it is where the sheets of a spindle meet on the axis: `f` has no first derivative there, so its sign next
    /// to the start is that of the second, whatever the side of the one sheet's normal.
    pole: bool,
}

impl Start {
    #[inline(always)]
    fn new<P: Product>(torus: &Torus, ray: &ScaledRay, from: &Departure) -> Start {
        let axis = torus.frame[2];
        let normal = DoubleVector::from(from.normal);
        let local = DoubleVector::from(from.local).scale_exact(exp2i(-torus.scale));
        let across = |v: DoubleVector| v - axis.mul::<P>(v.dot::<P>(axis));
        let mut radial = across(local);
        let mut rho = radial.length_squared::<P>().sqrt::<P>();
        // The axis is known to 2^-103: of a place on it this much less than the size may be left.
        let pole = rho.high < exp2i(-90);
        if pole {
            radial = across(normal);
            rho = radial.length_squared::<P>().sqrt::<P>();
            if rho.high < exp2i(-90) {
                (radial, rho) = (torus.frame[0], Double::ONE);
            }
        }
        let radial = radial.mul::<P>(Double::ONE.div::<P>(rho));
        // The normal within the plane of the point and the axis, of length one.
        let (out, up) = (normal.dot::<P>(radial), normal.dot::<P>(axis));
        let length = (out.square::<P>() + up.square::<P>()).sqrt::<P>();
        let (out, up) = (out.div::<P>(length), up.div::<P>(length));
        let (major, minor) = (torus.major_scaled, torus.minor_scaled);
        let reach = out.scale::<P>(minor);
        let (near, far) = ((reach - rho + major).abs(), (reach - rho - major).abs());
        let outer = near <= far;
        let rho = if pole {
            Double::ZERO
        } else if outer {
            reach + major
        } else {
            reach - major
        };
        let along =
            out.mul::<P>(radial.dot_f64::<P>(ray.direction)) + up.mul::<P>(axis.dot_f64::<P>(ray.direction));
        let slope = rho.mul::<P>(along).scale::<P>(major).scale::<P>(minor).scale_exact(8.0);
        Start {
            point: radial.mul::<P>(rho) + axis.mul::<P>(up.scale::<P>(minor)),
            slope: if outer { slope } else { -slope },
            outer,
            pole,
        }
    }
}

impl<F: FnMut(Hit) -> bool> Task for Leave<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<P: Product>(mut self) {
        let (torus, ray) = (self.torus, self.ray);
        let start = Start::new::<P>(torus, ray, self.from);
        let line = Line::new::<P>(torus, start.point, ray.direction);
        let s = line.distance::<P>(Double::ZERO);
        let square = s.square::<P>();
        let cubic = Cubic {
            second: s.scale_exact(4.0),
            first: square.scale::<P>(6.0) + line.extremal::<P>().0.scale_exact(2.0),
            constant: start.slope.div::<P>(line.length),
        };
        // Inside means f < 0.
        let inside_at_start =
            if start.pole { cubic.first.high < 0.0 } else { (self.from.side == Side::Inside) == start.outer };
        let extrema = cubic.extrema::<P>();
        let mut found = Crossings::NONE;
        // The crossings before the start, then the start itself.
        let mut index = 1;
        let mut inside_before = false;
        let mut low = Node { y: Double::ZERO, inside: inside_at_start };
        for &y in extrema.iter().flatten() {
            let value = cubic.value::<P>(y).0;
            let unknown = uncertainty::<P>(torus, &line, s + y);
            let tangent = (value.high * y.high).abs() <= unknown;
            if y.high < 0.0 {
                let inside = if tangent { inside_before } else { value.high > 0.0 };
                index += u32::from(inside != inside_before);
                inside_before = inside;
            } else if y.high > 0.0 {
                let inside = if tangent { low.inside } else { value.high < 0.0 };
                let high = Node { y, inside };
                if inside != low.inside {
                    found.push(refine::<P>(&cubic, &low, &high));
                }
                low = high;
            }
        }
        index += u32::from(inside_before == inside_at_start);
        if low.inside && (!self.first || found.as_slice().is_empty()) {
            let end = Double::from(2.0 * torus.reach) - s;
            found.push(refine::<P>(&cubic, &low, &Node { y: end, inside: false }));
        }
        // The start's own parameter on the given ray, whose origin is the start moved and rounded.
        let square = DoubleVector::from(ray.direction).dot_f64::<P>(ray.direction);
        let begin = (start.point - ray.relative).dot_f64::<P>(ray.direction).div::<P>(square);
        for &y in found.as_slice() {
            let t = ray.unscale(begin + y.div::<P>(line.length));
            let root = index;
            index += 1;
            let hit = if t.high <= self.within.min && self.within.min <= 0.0 {
                // Behind the moved origin, but in front of the start.
                self.within.admit(0.0_f64.next_up(), 0, root)
            } else {
                crate::scaled::admit(self.within, t, 0, root)
            };
            if let Some(hit) = hit
                && !(self.each)(hit)
            {
                return;
            }
        }
    }
}

/// An end of a stretch on which `h` is monotonic.
#[derive(Clone, Copy)]
struct Node {
    y: Double,
    inside: bool,
}

/// The zero of `h` between two nodes; where `h` itself has the same sign at both, as rounding can make it at the
/// start, the halving ends at the start.
#[inline(always)]
fn refine<P: Product>(cubic: &Cubic, low: &Node, high: &Node) -> Double {
    let (mut a, mut b) = (low.y.high, high.y.high);
    let mut y = 0.5 * (a + b);
    // Roughly first. Halving alone takes 53 steps and a few.
    for _ in 0..64 {
        #[cfg(test)]
        crate::kernel::counted::step();
        let (value, slope) = cubic.rough(y);
        if (value < 0.0) == low.inside {
            a = y;
        } else {
            b = y;
        }
        let step = value / slope;
        let next = y - step;
        y = if next > a && next < b { next } else { 0.5 * (a + b) };
        if step.abs() <= exp2i(-40) * y.abs() {
            break;
        }
    }
    let (mut a, mut b) = (low.y, high.y);
    let mut y = Double::from(y);
    if !(y > a && y < b) {
        y = (a + b).scale_exact(0.5);
    }
    // Halving alone takes 106 steps and a few.
    for _ in 0..110 {
        let (value, slope) = cubic.value::<P>(y);
        if value.high == 0.0 {
            break;
        }
        if (value.high < 0.0) == low.inside {
            a = y;
        } else {
            b = y;
        }
        let step = value.div::<P>(slope);
        let next = y - step;
        if next > a && next < b {
            y = next;
            // 2^-52 of the place: the next step would be below its square.
            if step.high.abs() <= f64::EPSILON * y.high.abs() {
                break;
            }
        } else {
            let next = (a + b).scale_exact(0.5);
            if !(next > a && next < b) {
                break;
            }
            y = next;
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::run;
    use crate::testing::Random;

    struct Value<'a>(&'a Cubic, f64);

    impl Task for Value<'_> {
        type Output = (f64, f64);
        fn run<P: Product>(self) -> (f64, f64) {
            let (value, slope) = self.0.value::<P>(Double::from(self.1));
            (value.to_f64(), slope.to_f64())
        }
    }

    #[test]
    fn rough_values_are_those_of_the_cubic() {
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let c = [(); 3].map(|()| random.uniform(-4.0, 4.0));
            let [second, first, constant] = c.map(Double::from);
            let cubic = Cubic { second, first, constant };
            let [second, first, constant] = c;
            let y = random.uniform(-4.0, 4.0);
            let ((a, b), (value, slope)) = (cubic.rough(y), run(Value(&cubic, y)));
            assert!((a - value).abs() < 1e-13 && (b - slope).abs() < 1e-13, "{y}");
            assert!((value - (((y + second) * y + first) * y + constant)).abs() < 1e-13);
            assert!((slope - ((3.0 * y + 2.0 * second) * y + first)).abs() < 1e-13);
        }
    }

    struct Extrema<'a>(&'a Cubic);

    impl Task for Extrema<'_> {
        type Output = Option<[(Double, f64); 2]>;
        fn run<P: Product>(self) -> Self::Output {
            Some(self.0.extrema::<P>()?.map(|y| (y, self.0.value::<P>(y).1.to_f64())))
        }
    }

    /// Extrema are where the slope vanishes, to twice the precision, also next to zero.
    #[test]
    fn extrema_of_a_cubic() {
        let mut random = Random::new(2);
        let mut count = 0;
        for _ in 0..2000 {
            let second = random.uniform(-4.0, 4.0);
            let first = random.sign() * random.magnitude(-20.0, 0.5);
            let cubic = Cubic {
                second: Double::from(second),
                first: Double::from(first),
                constant: Double::from(random.uniform(-1.0, 1.0)),
            };
            let Some([(x, at_x), (y, at_y)]) = run(Extrema(&cubic)) else {
                assert!(second * second <= 3.0 * first);
                continue;
            };
            count += 1;
            assert!(x.high < y.high && (x.high * y.high).is_sign_negative() == first.is_sign_negative());
            for (x, slope) in [(x, at_x), (y, at_y)] {
                // Relative to the terms of the slope, which is why a small one must be known to all its digits.
                let size = 3.0 * x.high * x.high + 2.0 * (second * x.high).abs() + first.abs();
                assert!(slope.abs() <= exp2i(-90) * size, "{second} {first}: {x:?} {slope:e} {size}");
            }
        }
        assert!(count > 1000, "{count}");
    }
}
