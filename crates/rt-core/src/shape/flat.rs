//! What the flat shapes share: the parameter of a plane in plain `f64` with a bound on its error, and normals, axes and
//! bounds.

use super::paired::Paired;
use crate::double::Double;
use crate::expansion::Expansion;
use crate::kernel::{Pair, Pairs, Product, Task, run};
use crate::math::{exp2i, exponent};
use crate::scaled::{largest, times_power};
use crate::{Aabb, Error, Hit, Interval, Ray};
use glam::DVec3;

/// The unit roundoff of `f64`, 2^-53.
pub(super) const U: f64 = exp2i(-53);

/// An error bound below this may be swamped by underflow: products that underflow err by 2^-1075 each, and no bound here
/// covers more than a hundred of them.
pub(super) const LEAST_CERTAIN: f64 = exp2i(-1022) * exp2i(-38);

/// A plane as the two inner products of a ray with its normal read it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facing {
    /// The coordinates x and y of a point; z and zero, or NaN for a normal that is left to exact arithmetic.
    anchor: Pairs<2>,
    /// A sixteenth of the normal, against it and along it: -x and -y; -z and x; y and z.
    normal: Pairs<3>,
}

impl PartialEq for Facing {
    fn eq(&self, other: &Facing) -> bool {
        self.anchor() == other.anchor() && self.normal == other.normal
    }
}

impl Facing {
    /// The plane through `anchor` across `n`, whose components are below 2, each within u.
    pub(super) fn new(anchor: DVec3, n: DVec3) -> Facing {
        // Products with components of this size may lose all digits to underflow, and so may their sixteenths.
        let tiny = |x: f64| x != 0.0 && x.abs() < exp2i(-896);
        let zero = if tiny(n.x) || tiny(n.y) || tiny(n.z) { f64::NAN } else { 0.0 };
        let n = n * 0.0625;
        Facing {
            anchor: Pairs([[anchor.x, anchor.y], [anchor.z, zero]]),
            normal: Pairs([[-n.x, -n.y], [-n.z, n.x], [n.y, n.z]]),
        }
    }

    /// The plane through another point.
    pub(super) fn at(&self, anchor: DVec3) -> Facing {
        let Pairs([_, [_, zero]]) = self.anchor;
        Facing { anchor: Pairs([[anchor.x, anchor.y], [anchor.z, zero]]), ..*self }
    }

    /// The point.
    #[inline(always)]
    pub(super) fn anchor(&self) -> DVec3 {
        let Pairs([[x, y], [z, _]]) = self.anchor;
        DVec3::new(x, y, z)
    }

    /// The terms of both inner products, of the origin seen from the anchor and of the direction.
    #[inline(always)]
    fn terms(&self, ray: &Paired) -> [Pair; 3] {
        let n = &self.normal;
        let (a, b, c) = (ray.first * n.get(0), ray.second * n.get(1), ray.rest * n.get(2));
        [a.lows(c), a.highs(c), b]
    }
}

/// Numerator and denominator of the parameter at which a ray meets a plane, in plain `f64`, and how far to trust them.
#[derive(Clone, Copy)]
pub(super) struct Rough {
    /// The ray, its origin seen from the anchor.
    ray: Paired,
    /// Minus the sixteenth normal times the origin, and that normal times the direction.
    products: Pair,
    /// The sums of the sizes of two of the three terms of both, and 2^-960.
    sizes: Pair,
    /// The parameter.
    pub(super) t: f64,
}

impl Rough {
    /// With N and M the sums of the sizes of the terms of `n . v` and `n . d`, v the origin seen from the anchor, the numerator
    /// errs by less than 5 u N (normal, difference, product, two additions), the denominator by 4 u M; 2^-960 is far more than
    /// 2^36 times what products lose to underflow. None overflows, with the sixteenth of a normal.
    ///
    /// Two terms are enough: the third is the sum without them, so N is at most twice their sizes and that of the sum.
    #[inline(always)]
    pub(super) fn new(plane: &Facing, ray: &Ray) -> Rough {
        let ray = Paired::new(ray, [plane.anchor.get(0), plane.anchor.get(1)]);
        let [first, second, third] = plane.terms(&ray);
        let products = (first + second) + third;
        let sizes = (first.abs() + third.abs()) + Pair::splat(exp2i(-960));
        Rough { ray, products, sizes, t: products.low() / products.high() }
    }

    /// Whether the relative error of `t` is less than 2^-14: numerator and denominator are more than 2^-34 of two terms, so
    /// more than `1 / (2^35 + 1)` of N and M, and their quotient errs by less than `(5 + 4) 2^-18`, which is 2^-14.8, of itself
    /// and by second orders. See [`new`](Rough::new).
    ///
    /// NaN is not sound. A ray with an infinite coordinate may pass, but then its parameter is infinite, zero or NaN: no hit may be made of
    /// those.
    #[inline(always)]
    pub(super) fn is_sound(&self) -> bool {
        (self.sizes * Pair::splat(exp2i(-34))).is_below(self.products.abs())
    }

    /// The cross product of the origin seen from the anchor and the direction.
    #[inline(always)]
    pub(super) fn moment(&self) -> DVec3 {
        let (x_y, z) = self.ray.moment();
        DVec3::new(x_y.low(), x_y.high(), z)
    }

    /// A sixteenth of the product of normal and direction.
    #[inline(always)]
    pub(super) fn slope(&self) -> f64 {
        self.products.high()
    }

    /// The largest coordinates, in size, of the origin seen from the anchor and of the direction.
    #[inline(always)]
    pub(super) fn largest(&self) -> (f64, f64) {
        let Paired { first, second, rest } = self.ray;
        let largest = first.lows(rest).abs().max(first.highs(rest).abs()).max(second.abs());
        (largest.low(), largest.high())
    }

    /// The square of the distance between the place and the anchor, rounded five times.
    #[inline(always)]
    pub(super) fn distance_squared(&self) -> f64 {
        let Paired { first, second, rest } = self.ray;
        let x = first.low() + second.high() * self.t;
        let rest = Pair::new(first.high(), second.low()) + rest * Pair::splat(self.t);
        let squares = rest * rest;
        squares.low() + squares.high() + x * x
    }

    /// A bound on the error of a sound `t`, and on ten roundings of it.
    ///
    /// The relative errors of numerator, denominator and quotient make `5 u N / |n . v| + 4 u M / |n . d| + u` to first order.
    /// What underflows in `t` errs by 2^-1074.
    #[inline(always)]
    pub(super) fn slack(&self) -> f64 {
        let lost = (self.sizes + self.sizes) / self.products.abs() + Pair::splat(1.0);
        self.t.abs() * ((6.0 * U) * lost.low() + (5.0 * U) * lost.high()) + exp2i(-1000)
    }

    /// Whether the interval ends exactly at the parameter: then it was made from that hit, and does not contain it.
    #[inline(always)]
    pub(super) fn ends(&self, within: Interval) -> bool {
        self.is_sound() && (self.t == within.min || self.t == within.max)
    }

    /// Whether the parameter is so far from both ends of the interval that it is certain whether that contains it.
    #[inline(always)]
    pub(super) fn is_clear(&self, within: Interval) -> bool {
        is_apart(self.t, within.min) & is_apart(self.t, within.max)
    }

    /// The hit at a sound parameter in an interval that begins at zero or later, or that there is none, where that is certain
    /// at a glance: both have the same way, since neighbouring rays may differ. Numbers of one sign are ordered like their bits,
    /// and [`APART`] is more than the error; one that may have underflown is not certain to be beyond zero. Rays that are not valid
    /// are behind, or uncertain.
    #[inline(always)]
    pub(super) fn glance(&self, within: Interval) -> Option<Option<Hit>> {
        const INFINITE: i64 = f64::INFINITY.to_bits() as i64;
        let [t, min, max] = [self.t, within.min, within.max].map(|x| x.to_bits() as i64);
        let size = t & i64::MAX;
        if (min >= 0) & (size - APART > min) & (size + APART < max) & (max <= INFINITE) {
            return Some(Hit::only(self.t, t >= 0));
        }
        if (t < 0) & (min >= 0) & !within.max.is_nan() { Some(None) } else { None }
    }

    /// The hit of a ray that certainly meets the shape.
    ///
    /// Not at zero, see [`is_sound`](Rough::is_sound); an infinite parameter is inside of no interval for certain.
    #[inline(always)]
    pub(super) fn hit(self, within: Interval) -> Verdict {
        if self.is_sound() & self.is_clear(within) & (self.t != 0.0) {
            Ok(self.admit(within, true))
        } else {
            Err(Doubt { ended: self.ends(within) })
        }
    }

    /// The hit, if the shape is met, without a branch between hit and miss, since neighbouring rays may differ.
    #[inline(always)]
    pub(super) fn admit(self, within: Interval, meets: bool) -> Option<Hit> {
        let hit = meets & (self.t > within.min) & (self.t < within.max);
        if hit { Some(Hit::inside(self.t, 0, 0)) } else { None }
    }
}

/// What a ray and a plane are at a glance: numerator and denominator as in [`Rough`], to the bit, and where they meet, without
/// the place itself.
///
/// The square of its distance from the anchor, `|v + t d|^2`, is a polynomial in t, whose coefficients need not wait for
/// the division: what does wait is few.
#[derive(Clone, Copy)]
pub(super) struct Glance {
    /// As in [`Rough`].
    products: Pair,
    /// The squares of v, the origin seen from the anchor, and of the direction d.
    squares: Pair,
    /// `v . d`.
    along: f64,
    /// The parameter.
    pub(super) t: f64,
}

impl Glance {
    /// A place whose distance from the anchor exceeds a radius is told by `|rho^2 - r^2| > CLEAR_OF_ORIGIN |v|^2 + CLEAR r^2`, rho
    /// its distance, in `f64`, for a [close](Glance::is_close) t and a radius of 2^-200 to 2^200.
    ///
    /// With e the error of t, 2^-37.8 of itself, the place errs by `e |t d| + u |v| <= 2^-37.7 (|v| + rho)`, since `|t d|` is at
    /// most `|v| + rho`; so rho^2 by 2^-36.7 rho (|v| + rho), and second orders. No coefficient and no step of the polynomial rounds
    /// more than 7 times, which is 8 u (|v| + |t d|)^2 at most, or 16 u (4 |v|^2 + rho^2), and 3 u r^2.
    ///
    /// Up to rho = 2 r that is less than 2^-35.7 |v| r + 2^-34.7 r^2 + 2^-46.9 |v|^2; the first part, by the means of its factors, less
    /// than `2^-39.4 |v|^2 + 2^-34 r^2`. Beyond, it is less than `2^-39 |v|^2 + rho^2 / 2`, while `rho^2 - r^2` is more than
    /// `3/4 rho^2`: no such place seems inside.
    ///
    /// Nothing overflows before the bound does, but `t d`, far outside.
    pub(super) const CLEAR_OF_ORIGIN: f64 = exp2i(-39);
    /// See [`CLEAR_OF_ORIGIN`](Glance::CLEAR_OF_ORIGIN).
    pub(super) const CLEAR: f64 = exp2i(-33);

    #[inline(always)]
    pub(super) fn new(plane: &Facing, ray: &Ray) -> Glance {
        let ray = Paired::new(ray, [plane.anchor.get(0), plane.anchor.get(1)]);
        let [first, second, third] = plane.terms(&ray);
        let products = (first + second) + third;
        Glance { products, squares: ray.squares(), along: ray.along(), t: products.low() / products.high() }
    }

    /// Whether the relative error of `t` is less than 2^-37.8.
    ///
    /// The sixteenth normal is shorter than `sqrt(3) / 8`, so `n . v` errs by less than `5 u sqrt(3) / 8 |v|`, see
    /// [`Rough::new`], and `n . d` by `4 u sqrt(3) / 8 |d|`. With both more than 2^-14 of these lengths, that is 2^-38.04 of
    /// the quotient, whose rounding is 2^-41 of it even where it is subnormal and [`is_within`](Glance::is_within) is certain. 2^-900
    /// is far more than squares and products lose to underflow.
    #[inline(always)]
    pub(super) fn is_close(&self) -> bool {
        let least = self.squares * Pair::new(exp2i(-28), exp2i(-28)) + Pair::new(exp2i(-900), exp2i(-900));
        least.is_below(self.products * self.products)
    }

    /// Whether the interval contains a close parameter, where that is certain at a glance: in front of the origin, or behind,
    /// by the signs, while the interval is not. Positive numbers are ordered like their bits, with negative ones below all; one
    /// that may have underflown is not certain to be beyond those.
    #[inline(always)]
    pub(super) fn is_within(&self, within: Interval) -> Option<bool> {
        let [t, min, max] = [self.t, within.min, within.max].map(|x| x.to_bits() as i64);
        if self.products.signs().count_ones() & 1 == 1 {
            return if min >= 0 { Some(false) } else { None };
        }
        let numbers = !(within.min.is_nan() | within.max.is_nan());
        if numbers & (t > APART) & (t - APART > min) & (t + APART < max) { Some(true) } else { None }
    }

    /// How much more the square of the distance of the place is than this.
    #[inline(always)]
    pub(super) fn excess(&self, square: f64) -> f64 {
        (self.squares.low() - square) + self.t * ((self.along + self.along) + self.t * self.squares.high())
    }

    /// How much of the bound of its error the origin makes: infinite from 2^500 on.
    #[inline(always)]
    pub(super) fn doubt(&self) -> f64 {
        self.squares.low() * exp2i(24) * (Glance::CLEAR_OF_ORIGIN * exp2i(-24))
    }
}

/// Whether two numbers differ by more than 2^-13 of the larger one, by the order of their bits: numbers of one sign are
/// ordered like them, those of different signs are far apart. 2^40 units in the last place are between 2^-13 and 2^-12 of a
/// normal number, and 2^-1034 among subnormal ones.
#[inline(always)]
fn is_apart(a: f64, b: f64) -> bool {
    const LEAST: u64 = APART as u64;
    a.to_bits().wrapping_sub(b.to_bits()).wrapping_add(LEAST) > 2 * LEAST
}

/// See [`is_apart`].
const APART: i64 = 1 << 40;

/// The hit or none, where plain `f64` can tell.
pub(super) type Verdict = Result<Option<Hit>, Doubt>;

/// Plain `f64` cannot tell.
pub(super) struct Doubt {
    /// The place is certain, and the interval ends at the parameter that `f64` gives: it was made from that hit, and
    /// does not contain it.
    pub(super) ended: bool,
}

/// A ray seen from an anchor, in units of powers of two.
pub(super) struct Relative {
    /// The origin minus the anchor, rounded once, and the direction; the largest of its components, or the size that
    /// was asked for, is in `[1, 2)`.
    pub(super) ray: Ray,
    /// A length here times this is one there.
    pub(super) unit: f64,
    /// A parameter there is `2^power` times the one here.
    power: i32,
}

impl Relative {
    /// For a shape of this size, or of none.
    pub(super) fn new(anchor: DVec3, ray: &Ray, size: f64) -> Relative {
        let w = ray.origin - anchor;
        let reach = largest(w);
        let length = power_of(DVec3::splat(if reach > size { reach } else { size }));
        let (direction, speed) = prescaled(ray.direction);
        let unit = exp2i(-length);
        Relative { ray: Ray::new(w * unit, direction), unit, power: length - speed }
    }

    /// An interval of the given ray.
    pub(super) fn interval(&self, within: Interval) -> Interval {
        Interval::new(times_power(within.min, -self.power), times_power(within.max, -self.power))
    }

    /// A hit of the given ray.
    pub(super) fn hit(&self, hit: Hit, within: Interval) -> Option<Hit> {
        within.admit(times_power(hit.t(), self.power), hit.part(), hit.root())
    }
}

/// The vector itself when it is finite and has a length.
pub(super) fn checked_direction(what: &'static str, value: DVec3) -> Result<DVec3, Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite { what, value });
    }
    if value == DVec3::ZERO { Err(Error::ZeroLength { what, value }) } else { Ok(value) }
}

/// The vector times `2^-power`, with the largest component in `[1, 2)`, and that power; zero stays as it is.
#[inline(always)]
pub(super) fn prescaled(v: DVec3) -> (DVec3, i32) {
    let power = power_of(v);
    (v * exp2i(-power), power)
}

/// The power of two that [`prescaled`] divides by.
#[inline(always)]
pub(super) fn power_of(v: DVec3) -> i32 {
    let largest = largest(v);
    if largest == 0.0 { 0 } else { exponent(largest).clamp(-1022, 1022) }
}

/// The unit vector along a prescaled one, each component correctly rounded but for a few in 2^40.
pub(super) fn unit(v: [Double; 3]) -> DVec3 {
    struct Unit([Double; 3]);
    impl Task for Unit {
        type Output = DVec3;
        #[inline(always)]
        fn run<P: Product>(self) -> DVec3 {
            let [x, y, z] = self.0;
            let length = (x.square::<P>() + y.square::<P>() + z.square::<P>()).sqrt::<P>();
            DVec3::new(x.div::<P>(length).to_f64(), y.div::<P>(length).to_f64(), z.div::<P>(length).to_f64())
        }
    }
    run(Unit(v))
}

/// A vector of exact `f64`.
#[inline(always)]
pub(super) fn doubles(v: DVec3) -> [Double; 3] {
    [Double::from(v.x), Double::from(v.y), Double::from(v.z)]
}

/// The index of the component of largest size; the first of equals.
#[inline(always)]
pub(super) fn dominant(v: DVec3) -> usize {
    let a = v.abs();
    if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    }
}

/// Two unit vectors in the plane across a prescaled normal: the two world axes in which the normal is not largest, in
/// the order x, y, z; the first projected onto the plane, the second the perpendicular on the side of its world axis.
pub(super) fn plane_axes(normal: DVec3) -> (DVec3, DVec3) {
    let k = dominant(normal);
    let (i, j) = [(1, 2), (0, 2), (0, 1)][k];
    let n = normal.to_array();
    // The vector (0 along j, n_k along i, -n_i along k) would be perpendicular too, but it is not the projection.
    // Projection of the axis i, times |n|^2: e_i |n|^2 - n_i n.
    let square = normal.length_squared();
    let mut first = [0.0; 3];
    first[i] = square - n[i] * n[i];
    first[j] = -n[i] * n[j];
    first[k] = -n[i] * n[k];
    let first = unit(doubles(DVec3::from_array(first)));
    // The side: the component along j of n x first has the sign of the volume (n, first, e_j).
    let across = normal.cross(first);
    let across = if across.to_array()[j] < 0.0 { -across } else { across };
    (first, unit(doubles(across)))
}

/// The exact cross product.
#[inline(always)]
pub(crate) fn cross<P: Product>(a: &[Double; 3], b: &[Double; 3]) -> [Expansion; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| {
        let mut sum = Expansion::ZERO;
        sum.add_double_product::<P>(a[j], b[k]);
        sum.add_double_product::<P>(-a[k], b[j]);
        sum
    })
}

/// A vector of `f64` as exact expansions.
pub(super) fn expansions(v: DVec3) -> [Expansion; 3] {
    v.to_array().map(|x| {
        let mut e = Expansion::ZERO;
        e.add(x);
        e
    })
}

/// The world axis that a vector lies along exactly.
pub(super) fn world_axis(v: DVec3) -> Option<u8> {
    let k = dominant(v);
    let v = v.to_array();
    (0..3).all(|i| i == k || v[i] == 0.0).then_some(k as u8)
}

/// The vector with each coordinate moved into its range. Unlike glam's `clamp` it compiles to plain minima and maxima.
#[inline(always)]
pub(super) fn clamped(v: DVec3, least: DVec3, most: DVec3) -> DVec3 {
    let clamp = |x: f64, least: f64, most: f64| {
        let x = if x < least { least } else { x };
        if x > most { most } else { x }
    };
    DVec3::new(clamp(v.x, least.x, most.x), clamp(v.y, least.y, most.y), clamp(v.z, least.z, most.z))
}

/// The box from `anchor + least` to `anchor + greatest`, each end rounded away from the box.
pub(super) fn outward(anchor: DVec3, least: DVec3, greatest: DVec3) -> Aabb {
    // One rounding of the sum and one of the point that is tested against the box.
    let down = |x: f64| x.next_down().next_down();
    let up = |x: f64| x.next_up().next_up();
    let (a, b) = (anchor + least, anchor + greatest);
    Aabb { min: DVec3::new(down(a.x), down(a.y), down(a.z)), max: DVec3::new(up(b.x), up(b.y), up(b.z)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn numbers_apart() {
        let (near, far) = (1.0 + exp2i(-14), 1.0 + exp2i(-11));
        for x in [1.0, -1.0, exp2i(-1000), -exp2i(1000), 1.999] {
            for (factor, expected) in [(near, false), (far, true), (1.0 / near, false), (1.0 / far, true)] {
                assert_eq!(is_apart(x, x * factor), expected, "{x} {factor}");
                assert_eq!(is_apart(x * factor, x), expected, "{x} {factor}");
            }
            for other in [-x, 0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY] {
                assert!(is_apart(x, other) && is_apart(other, x), "{x} {other}");
            }
        }
        for x in [f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            assert!(!is_apart(x, x) && !is_apart(x, x.next_down()), "{x}");
        }
        assert!(is_apart(0.0, exp2i(-1022)) && !is_apart(0.0, f64::from_bits(5)));
    }

    #[test]
    fn hits_in_an_interval() {
        let facing = Facing::new(DVec3::ZERO, DVec3::Z);
        let told = |direction: [f64; 3], min, max| {
            let rough = Rough::new(&facing, &Ray::new([0.0, 0.0, -1.0], direction));
            rough.hit(Interval::new(min, max)).map(|hit| hit.is_some()).map_err(|doubt| doubt.ended)
        };
        for (min, max, expected) in [
            (0.0, 2.0, Ok(true)),
            (-5.0, 0.5, Ok(false)),
            (1.5, 9.0, Ok(false)),
            (1.0 - exp2i(-20), 2.0, Err(false)),
            (0.0, 1.0 + exp2i(-20), Err(false)),
            (1.0, 2.0, Err(true)),
            (0.0, 1.0, Err(true)),
            (f64::NEG_INFINITY, f64::INFINITY, Ok(true)),
            (1.5, 0.5, Ok(false)),
            (f64::NAN, 2.0, Ok(false)),
            (0.0, f64::NAN, Ok(false)),
        ] {
            assert_eq!(told([0.0, 0.0, 1.0], min, max), expected, "{min} {max}");
            assert_eq!(told([0.0, 1.0, 0.0], min, max), Err(false));
            assert_eq!(told([f64::NAN, 0.0, 1.0], min, max), Err(false));
        }
        let normal = DVec3::new(exp2i(-950), 0.0, 1.0);
        let left = Rough::new(&Facing::new(DVec3::ZERO, normal), &Ray::new([0.0, 0.0, -1.0], DVec3::Z));
        assert!(!left.is_sound());
    }

    /// What must not become slow unseen, and must be true: nearly all plain rays are sound and close, the errors are what
    /// they promise, and the slack is not larger than the roundings can be by more than two hundred times.
    #[test]
    fn how_far_to_trust_a_parameter() {
        let mut random = Random::new(1);
        let mut count = [0_u32; 2];
        for case in 0..8000 {
            let (anchor, n) = (random.in_cube(), random.direction());
            let mut ray = Ray::new(random.in_cube() * 4.0, random.direction());
            if case % 2 == 1 {
                // Nearly in the plane.
                let along = n.cross(random.direction());
                ray.origin = anchor + along + n * random.magnitude(-11.0, -1.0);
                ray.direction = n.cross(random.direction()) + n * random.magnitude(-6.0, -1.0);
            }
            let facing = Facing::new(anchor, n);
            let (rough, glance) = (Rough::new(&facing, &ray), Glance::new(&facing, &ray));
            let dot = |a: [Double; 3], b: [Double; 3]| {
                a.into_iter().zip(b).fold(Double::ZERO, |sum, (a, b)| sum + a.mul::<crate::kernel::Dekker>(b))
            };
            let w = [0, 1, 2].map(|k| Double::difference(anchor[k], ray.origin[k]));
            let slope = dot(doubles(n), doubles(ray.direction));
            let t = dot(doubles(n), w).div::<crate::kernel::Dekker>(slope);
            let error = (t - rough.t).high.abs();
            if case % 2 == 0 {
                count[0] += u32::from(!rough.is_sound());
                count[1] += u32::from(!glance.is_close());
            }
            if !rough.is_sound() {
                continue;
            }
            assert!(error <= rough.slack() && error <= exp2i(-14) * t.high.abs(), "{anchor} {n} {ray:?}");
            assert!(glance.t == rough.t && glance.products.signs() == rough.products.signs());
            let relative = error / t.high.abs();
            assert!(!glance.is_close() || relative <= exp2i(-37) / 1.74, "{anchor} {n} {ray:?} {relative}");
            let place = ray.origin - anchor + ray.direction * rough.t;
            let (square, rounded) = (place.length_squared(), rough.distance_squared());
            assert!((square - rounded).abs() < 1e-13 * (1.0 + rough.t * rough.t), "{square} {rounded}");
            let (excess, far) = (glance.excess(1.0), w.map(|x| x.high).iter().map(|x| x.abs()).sum::<f64>());
            let reach = far + rough.t.abs() * ray.direction.length();
            assert!((square - 1.0 - excess).abs() <= 12.0 * U * (reach * reach + 1.0), "{square} {excess}");
        }
        assert!(count[0] == 0 && count[1] < 40, "{count:?}");
    }

    /// The axes of a plane are unit vectors in it and across each other: the first is the projection of its world axis, the
    /// second on the side of its own.
    #[test]
    fn axes_in_the_plane() {
        let mut random = Random::new(5);
        for _ in 0..1000 {
            let n = random.direction();
            let (first, second) = plane_axes(n);
            let k = dominant(n);
            let (i, j) = [(1, 2), (0, 2), (0, 1)][k];
            let projected = (DVec3::AXES[i] - n * n[i]).normalize();
            assert!((first - projected).length() < 1e-15, "{n} {first}");
            assert!(second.dot(n).abs() < 1e-15 && second.dot(first).abs() < 1e-15, "{n} {second}");
            assert!((second.length() - 1.0).abs() < 1e-15 && second[j] > 0.0, "{n} {second}");
        }
    }

    /// A ray is read from its pairs as it is from its vectors: moment about the anchor and largest coordinates, to the bit.
    #[test]
    fn what_is_read_of_a_ray() {
        let mut random = Random::new(3);
        for _ in 0..2000 {
            let (anchor, n) = (random.in_cube(), random.direction());
            let facing = Facing::new(anchor, n);
            let origin = random.in_cube() * random.magnitude(-2.0, 2.0);
            let ray = Ray::new(origin, random.in_cube() * random.magnitude(-2.0, 2.0));
            let rough = Rough::new(&facing, &ray);
            let (w, d) = (ray.origin - anchor, ray.direction);
            assert_eq!(rough.moment(), w.cross(d), "{anchor} {ray:?}");
            assert_eq!(rough.largest(), (largest(w), largest(d)), "{anchor} {ray:?}");
            assert!((16.0 * rough.slope() - n.dot(d)).abs() <= 4.0 * U * d.length(), "{n} {ray:?}");
            let moved = facing.at(origin);
            assert!(facing.anchor() == anchor && moved.anchor() == origin);
            assert!(moved != facing && moved.at(anchor) == facing && facing != Facing::new(anchor, -n));
        }
    }

    /// Normals with a component whose products may underflow are left to exact arithmetic, wherever the plane is moved.
    #[test]
    fn tiny_components_of_a_normal() {
        for k in 0..3 {
            for (size, sound) in [(exp2i(-890), true), (exp2i(-900), false), (f64::from_bits(1), false)] {
                let mut n = DVec3::AXES[(k + 1) % 3];
                let ray = Ray::new(n * -3.0, n);
                n[k] = -size;
                let facing = Facing::new(DVec3::ZERO, n);
                for facing in [facing, facing.at(DVec3::ONE)] {
                    assert_eq!(Rough::new(&facing, &ray).is_sound(), sound, "{n}");
                }
            }
        }
    }
}
