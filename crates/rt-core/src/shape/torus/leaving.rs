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
use super::together::in_own_scale;
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{Four, Lanes, Product, Real, Task, Vector};
use crate::math::exp2i;
use crate::scaled::{ScaledFour, ScaledRay};
use crate::{Departure, Hit, Interval, Ray, Side};

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
    // On a spindle the normal may belong to the inner sheet.
    if from.side != Side::Outside || torus.minor >= torus.major {
        return false;
    }
    let start = from.local * exp2i(-torus.scale);
    let (major, minor) = (torus.major_scaled, torus.minor_scaled);
    let axis = torus.axis.into();
    Fate::new(major, minor, axis, ray.direction.into(), start.into(), from.normal.into()).never != 0
}

/// See [`never_returns`]. Any number well above the error makes it certain.
const MARGIN: f64 = exp2i(-30);

/// What `f64` can say of rays that leave rings outward.
struct Fate<R> {
    /// In which lanes they certainly never come back, and in which they are certainly back after this distance.
    never: u32,
    back: u32,
    after: R,
}

impl<R: Real> Fate<R> {
    #[inline(always)]
    fn new(
        major: R,
        minor: R,
        axis: Vector<R>,
        direction: Vector<R>,
        start: Vector<R>,
        normal: Vector<R>,
    ) -> Self {
        let (zero, one, two, three, four) =
            (major.all(0.0), major.all(1.0), major.all(2.0), major.all(3.0), major.all(4.0));
        let margin = major.all(MARGIN);
        let unit = direction * (one / direction.dot(direction).sqrt());
        let away = normal.dot(unit);
        let leaves = margin.less(away);
        let (height, slope) = (start.dot(axis), unit.dot(axis));
        let across = start - axis * height;
        let rho = across.dot(across).sqrt();
        let along = start.dot(unit);
        let b = major * (rho - major * (one - slope * slope));
        let first = b + along * along;
        let never = leaves & (margin.less(b) | (margin.less(along) & margin.less(first)));
        if never == R::EVERY {
            return Fate { never, back: 0, after: zero };
        }
        // h' = 3 y^2 + 8 a y + 4 (b + a^2) vanishes last at 2 / 3 (sqrt(4 a^2 - 3 (b + a^2)) - 2 a).
        let discriminant = four * along * along - three * first;
        let root = R::if_less(zero, discriminant, discriminant, zero).sqrt();
        let y = major.all(2.0 / 3.0) * (root - two * along);
        let constant = major.all(8.0) * major * rho * minor * away;
        let least = ((y + four * along) * y + four * first) * y + constant;
        let clear = leaves & margin.less(constant);
        let never = never | (clear & (y.less(zero) | margin.less(least)));
        // h is positive at the start and negative there.
        let back = clear & zero.less(y) & least.less(-margin);
        Fate { never, back, after: y }
    }
}

/// Whether rays that leave tori are blocked by them within their intervals, one bit each, and which of them it takes
/// [`hit_leaving`](crate::Primitive::hit_leaving) to tell.
///
/// A ray that is back after a distance `y` has crossed before, and not sooner than the slope, less than 2^10, takes `h`
/// from its first value to zero, 2^-40. The parameter of the first crossing, which rounding changes by far less than half of
/// it, is then inside an interval from zero to twice that of `y`.
#[inline(always)]
pub(crate) fn return_each<L: Lanes>(
    lanes: L,
    tori: [&Torus; 4],
    rays: [&Ray; 4],
    within: [Interval; 4],
    from: [&Departure; 4],
) -> (u32, u32) {
    let [a, b, c, d] = tori;
    let (ScaledFour { direction, power, sound, .. }, _, per_unit) = in_own_scale(lanes, tori, rays);
    let major = Four::new(lanes, [a.major_scaled, b.major_scaled, c.major_scaled, d.major_scaled]);
    let minor = Four::new(lanes, [a.minor_scaled, b.minor_scaled, c.minor_scaled, d.minor_scaled]);
    let axis = Vector::new(lanes, [&a.axis, &b.axis, &c.axis, &d.axis]);
    let start = Vector::new(lanes, [&from[0].local, &from[1].local, &from[2].local, &from[3].local]);
    let normal = Vector::new(lanes, [&from[0].normal, &from[1].normal, &from[2].normal, &from[3].normal]);
    let fate = Fate::new(major, minor, axis, direction, start * per_unit, normal);
    let mut outward = 0;
    for (lane, from) in from.into_iter().enumerate() {
        outward |= u32::from(from.side == Side::Outside) << lane;
    }
    let rings = sound & outward & minor.less(major);
    let min = Four::new(lanes, [within[0].min, within[1].min, within[2].min, within[3].min]);
    let max = Four::new(lanes, [within[0].max, within[1].max, within[2].max, within[3].max]);
    let (zero, two) = (major.all(0.0), major.all(2.0));
    let t = fate.after / direction.length() * power;
    let back = rings & fate.back & min.at_most(zero) & (two * t).less(max);
    (back, 15 & !back & !(rings & fate.never))
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
    use crate::Primitive;
    use crate::kernel::run;
    use crate::testing::Random;
    use alloc::vec::Vec;

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

    struct Returns<'a>(&'a [(Torus, Ray, Interval, Departure)]);

    impl crate::kernel::Vectorized for Returns<'_> {
        type Output = (Vec<bool>, usize);
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let (mut answers, mut doubts) = (Vec::new(), 0);
            for four in self.0.chunks_exact(4) {
                let [a, b, c, d] = four else { continue };
                let (back, doubt) = return_each(
                    lanes,
                    [&a.0, &b.0, &c.0, &d.0],
                    [&a.1, &b.1, &c.1, &d.1],
                    [a.2, b.2, c.2, d.2],
                    [&a.3, &b.3, &c.3, &d.3],
                );
                for (lane, (torus, ray, within, from)) in four.iter().enumerate() {
                    doubts += (doubt >> lane & 1) as usize;
                    answers.push(if doubt >> lane & 1 == 1 {
                        torus.hit_leaving(ray, *within, from).is_some()
                    } else {
                        back >> lane & 1 == 1
                    });
                }
            }
            (answers, doubts)
        }
    }

    /// Whether four rays are back is what each finds by itself, in all lanes; few take more than the lanes can tell.
    #[test]
    fn rays_return_as_each_does() {
        let mut random = crate::testing::Random::new(3);
        let mut rays = Vec::new();
        while rays.len() < 20_000 {
            let size = if random.once_in(5) { random.magnitude(-140.0, 140.0) } else { 1.0 };
            let minor = if random.once_in(8) { random.uniform(0.9, 3.0) } else { random.uniform(0.05, 0.9) };
            let torus = Torus::new(random.in_cube() * size, random.direction(), size, size * minor).unwrap();
            let target = torus.center() + random.in_cube() * size;
            let along = random.direction();
            let ray = Ray::new(target - along * (4.0 * size), along);
            let Some(hit) = torus.hit(&ray, Interval::FORWARD) else { continue };
            let surface = torus.surface(&ray, hit);
            let side = if random.once_in(6) { Side::Inside } else { Side::Outside };
            let from = surface.departure(0, hit, side);
            // Some along the surface.
            let onward = if random.once_in(3) {
                let flat = surface.normal.cross(random.direction()).normalize();
                flat + surface.normal * (random.magnitude(-12.0, 0.0) * random.sign())
            } else {
                surface.normal * side.sign() + random.direction()
            };
            let (onward, mut within) = from.ray(onward * random.magnitude(-2.0, 2.0));
            if random.once_in(2) {
                within.max = random.uniform(0.0, 6.0) * size / onward.direction.length();
            }
            rays.push((torus, onward, within, from));
        }
        let (wide, doubts) = crate::kernel::vectorize(Returns(&rays));
        let (portable, _) = crate::kernel::Vectorized::run(Returns(&rays), crate::kernel::PortableLanes);
        let mut back = 0;
        for (i, (torus, ray, within, from)) in rays.iter().enumerate() {
            let expected = torus.hit_leaving(ray, *within, from).is_some();
            assert!(wide[i] == expected && portable[i] == expected, "{torus:?} {ray:?} {within:?} {from:?}");
            back += usize::from(expected);
        }
        assert!(back > 2000 && doubts < rays.len() / 2, "{back} {doubts}");
    }
}
