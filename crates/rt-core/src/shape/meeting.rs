//! Where a ray meets a plane, exactly, and the record that a flat shape makes of it.
//!
//! The plane through `anchor` across `normal` is met at `t = N / D` with `N = normal . (anchor - origin)` and
//! `D = normal . direction`. The normal need not have unit length, so a given one enters as the exact numbers it is.
//! Differences are kept as exact sums of two `f64`; `N` and `D` are sums in double-double with a bound on their error.
//! Where that is too large they are exact sums. Rays that leave a middle range of numbers are scaled by powers of two
//! first, so neither 1e-150 nor 1e150 loses a digit.

use super::flat::{U, cross, power_of, prescaled};
use crate::double::{Double, fast_two_sum, two_difference, two_sum};
use crate::expansion::Expansion;
use crate::kernel::{Dekker, Four, Lanes, Product, Real, Task, Vector, run};
use crate::math::exp2i;
use crate::scaled::times_power;
use crate::{Hit, Ray, Surface};
use glam::{DVec2, DVec3};

/// A plane as the refinement needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExactPlane {
    /// A point of the plane.
    pub(super) anchor: DVec3,
    /// The normal, of a length near 1, within 2^-104 of each component.
    pub(super) normal: [Double; 3],
    /// The world axis, 0 to 2, that the normal lies along exactly.
    pub(super) axis: Option<u8>,
    /// The distance of the plane from the anchor along the normal, in lengths of the normal.
    pub(super) offset: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting<R = f64> {
    /// The parameter, correctly rounded.
    pub(super) t: R,
    /// The point minus the anchor, in units of `2^power`.
    pub(super) local: [Double<R>; 3],
    /// The unit of `local`.
    pub(super) power: i32,
    /// A bound on the error of each coordinate of `local`, in the same unit.
    pub(super) error: R,
}

impl Meeting {
    /// The point minus the anchor, each coordinate rounded once.
    #[inline(always)]
    pub(super) fn local(&self) -> DVec3 {
        self.locally().into()
    }

    /// The world point, each coordinate rounded once.
    #[inline(always)]
    pub(super) fn point(&self, anchor: DVec3) -> DVec3 {
        self.place(anchor).into()
    }

    /// The lengths of `local` along the two texture axes of a plane, which are world axes when its normal is one.
    #[inline(always)]
    pub(super) fn along<P: Product>(&self, axes: &[DVec3; 2], normal: Option<u8>) -> DVec2 {
        DVec2::from_array(self.lengths::<P>(axes, normal))
    }

    /// The error radius of a world point made by [`point`](Meeting::point).
    #[inline(always)]
    pub(super) fn error_radius(&self, point: DVec3) -> f64 {
        self.radius(point.into())
    }
}

impl<R: Real> Meeting<R> {
    /// [`local`](Meeting::local), for any lanes.
    #[inline(always)]
    pub(super) fn locally(&self) -> Vector<R> {
        let scale = self.t.all(exp2i(self.power));
        let [x, y, z] = self.local;
        Vector { x: x.to_f64(), y: y.to_f64(), z: z.to_f64() } * scale
    }

    /// [`point`](Meeting::point), for any lanes.
    #[inline(always)]
    pub(super) fn place(&self, anchor: DVec3) -> Vector<R> {
        let scale = self.t.all(exp2i(self.power));
        let [x, y, z] = self.local;
        Vector {
            x: rounded_sum(x, scale, anchor.x),
            y: rounded_sum(y, scale, anchor.y),
            z: rounded_sum(z, scale, anchor.z),
        }
    }

    /// [`along`](Meeting::along), for any lanes.
    #[inline(always)]
    pub(super) fn lengths<P: Product>(&self, axes: &[DVec3; 2], normal: Option<u8>) -> [R; 2] {
        let local = self.locally();
        match normal {
            Some(0) => [local.y, local.z],
            Some(1) => [local.x, local.z],
            Some(_) => [local.x, local.y],
            None => [self.length::<P>(axes[0]), self.length::<P>(axes[1])],
        }
    }

    #[inline(always)]
    fn length<P: Product>(&self, axis: DVec3) -> R {
        let axis = exactly(Vector::all(self.t, axis));
        let length = dot::<P, R>(&self.local, &axis, self.t.all(0.0)).0.to_f64();
        length * self.t.all(exp2i(self.power))
    }

    /// The error radius of a world point made by [`place`](Meeting::place).
    ///
    /// Each coordinate of the point is within half a unit in the last place, `u |p_i|`, and moving the start of a
    /// ray by the radius rounds once more by as much; `1 + 16 u` pays for the roundings of this sum. The error of
    /// `local` itself comes on top, once for each coordinate.
    #[inline(always)]
    pub(super) fn radius(&self, point: Vector<R>) -> R {
        let one = self.t;
        one.all(2.0 * U * (1.0 + 16.0 * U)) * (point.x.abs() + point.y.abs() + point.z.abs())
            + one.all(3.0) * self.error * one.all(exp2i(self.power))
            + one.all(f64::from_bits(8))
    }
}

/// `x scale + a`, rounded once.
#[inline(always)]
fn rounded_sum<R: Real>(x: Double<R>, scale: R, a: f64) -> R {
    let (s, e) = two_sum(x.high * scale, scale.all(a));
    s + (e + x.low * scale)
}

/// A vector as the exact numbers it is.
#[inline(always)]
fn exactly<R: Real>(v: Vector<R>) -> [Double<R>; 3] {
    let low = v.x.all(0.0);
    [Double { high: v.x, low }, Double { high: v.y, low }, Double { high: v.z, low }]
}

/// A flat piece of a surface: what [`surface`] needs to make the full record of a hit.
pub(super) trait Piece {
    /// Its plane.
    fn plane(&self) -> ExactPlane;
    /// The prescaled normal without any rounding, for the rays that need it.
    fn exact_normal(&self) -> [Expansion; 3];
    /// The record, from the place in the plane.
    fn record<P: Product>(&self, at: &Meeting) -> Surface;
    /// The record for a ray that runs parallel to the plane: only for a ray that the piece gave no hit for.
    fn parallel(&self, ray: &Ray, hit: Hit) -> Surface;
}

/// The record of a hit of a piece.
#[inline(always)]
pub(super) fn surface(piece: &impl Piece, ray: &Ray, hit: Hit) -> Surface {
    run(Record { piece, ray, hit })
}

/// The meeting of a valid ray with the plane of a piece; `None` when they are parallel.
pub(super) fn meet(piece: &impl Piece, ray: &Ray) -> Option<Meeting> {
    run(Meet { piece, ray })
}

/// The record by double-double numbers, without scaling; in doubt by [`surface_exactly`].
struct Record<'a, S> {
    piece: &'a S,
    ray: &'a Ray,
    hit: Hit,
}

impl<S: Piece> Task for Record<'_, S> {
    type Output = Surface;
    #[inline(always)]
    fn run<P: Product>(self) -> Surface {
        let plane = self.piece.plane();
        let w = difference(plane.anchor.into(), self.ray.origin.into());
        match certain::<P>(&plane, plane.offset, &w, self.ray.direction) {
            Some(Place { t, local, error }) => {
                self.piece.record::<P>(&Meeting { t: t.high, local, power: 0, error })
            }
            None => surface_exactly(self.piece, self.ray, self.hit),
        }
    }
}

#[cold]
#[inline(never)]
fn surface_exactly<S: Piece>(piece: &S, ray: &Ray, hit: Hit) -> Surface {
    struct Record<'a, S>(&'a S, Meeting);
    impl<S: Piece> Task for Record<'_, S> {
        type Output = Surface;
        #[inline(always)]
        fn run<P: Product>(self) -> Surface {
            self.0.record::<P>(&self.1)
        }
    }
    match meet(piece, ray) {
        Some(at) => run(Record(piece, at)),
        None => piece.parallel(ray, hit),
    }
}

/// A place in a plane.
struct Place<R = f64> {
    t: Double<R>,
    local: [Double<R>; 3],
    /// A bound on the error of each coordinate of `local`.
    error: R,
}

/// [`place`] for one ray, where it is certain.
#[inline(always)]
fn certain<P: Product>(plane: &ExactPlane, offset: f64, w: &[Double; 3], d: DVec3) -> Option<Place> {
    let (place, sound) = place::<P, f64>(plane, offset, w, d.into());
    (sound != 0).then_some(place)
}

/// Where a ray meets a plane, in double-double, and in which lanes that is certain: not unless the parameter is right to
/// 2^-70 of itself and `local` to 2^-60 of its largest coordinate, nor when a range is left that excludes under- and
/// overflow.
///
/// `w` is the anchor seen from the origin of the ray, exactly.
#[inline(always)]
fn place<P: Product, R: Real>(
    plane: &ExactPlane,
    offset: f64,
    w: &[Double<R>; 3],
    d: Vector<R>,
) -> (Place<R>, u32) {
    let zero = d.x.all(0.0);
    let exact = exactly(d);
    let (numerator, n_size, denominator, d_size) = match plane.axis {
        Some(k) => {
            let k = if k < 2 { usize::from(k) } else { 2 };
            (w[k], w[k].high.abs(), exact[k], exact[k].high.abs())
        }
        None => {
            let [x, y, z] = plane.normal;
            let normal = [Double::all(zero, x), Double::all(zero, y), Double::all(zero, z)];
            let (numerator, n_size) = dot::<P, R>(&normal, w, zero.all(offset));
            let (denominator, d_size) = dot::<P, R>(&normal, &exact, zero);
            (numerator, n_size, denominator, d_size)
        }
    };
    let inverse = zero.all(1.0) / denominator.high;
    let t = numerator.div_with::<P>(denominator, inverse);
    let mut local = [along::<P, R>(t, d.x, w[0]), along::<P, R>(t, d.y, w[1]), along::<P, R>(t, d.z, w[2])];
    let nothing = Double { high: zero, low: zero };
    match plane.axis {
        Some(0) => local[0] = nothing,
        Some(1) => local[1] = nothing,
        Some(_) => local[2] = nothing,
        None => {}
    }
    let reach = Vector { x: w[0].high, y: w[1].high, z: w[2].high }.largest();
    let speed = d.largest();
    // The sums err by 2^-99 of the sizes of their terms, the quotient by 2^-101 of itself. Of a coordinate of local,
    // the low part adds four roundings of at most 4 u (|t d| + |w|): 2^-102 of that.
    let size = t.high.abs();
    let slack = zero.all(exp2i(-98)) * ((n_size + d_size * size) * inverse.abs());
    let error = slack * speed + zero.all(exp2i(-100)) * (size * speed + reach);
    let least = Vector { x: local[0].high, y: local[1].high, z: local[2].high }.largest();
    // In these ranges |t| lies between 2^-654 and 2^654: no product of large parts overflows, and what the others
    // lose to underflow is 2^-1074, nothing against 2^-100 of the numerator. NaN makes a comparison false.
    let sound = slack.less(zero.all(exp2i(-70)) * size)
        & error.less(zero.all(exp2i(-60)) * least)
        & zero.all(exp2i(-400)).less(numerator.high.abs())
        & zero.all(exp2i(-400)).less(denominator.high.abs())
        & reach.less(zero.all(exp2i(250)))
        & speed.less(zero.all(exp2i(250)));
    (Place { t, local, error }, sound)
}

/// `t d - w`.
#[inline(always)]
fn along<P: Product, R: Real>(t: Double<R>, d: R, w: Double<R>) -> Double<R> {
    let (p, e) = R::two_product::<P>(t.high, d);
    let (s, f) = two_difference(p, w.high);
    let (high, low) = fast_two_sum(s, ((e + t.low * d) + f) - w.low);
    Double { high, low }
}

/// Where four rays meet the plane of a piece, and in which lanes that is certain.
#[inline(always)]
pub(super) fn four<L: Lanes>(piece: &impl Piece, lanes: L, rays: [&Ray; 4]) -> (Meeting<Four<L>>, u32) {
    let plane = piece.plane();
    let d = Vector::new(lanes, rays.map(|ray| &ray.direction));
    let w = difference(Vector::all(d.x, plane.anchor), Vector::new(lanes, rays.map(|ray| &ray.origin)));
    // The lanes bring their own products.
    let (Place { t, local, error }, sound) = place::<Dekker, Four<L>>(&plane, plane.offset, &w, d);
    (Meeting { t: t.high, local, power: 0, error }, sound)
}

/// `a . b + c`, and the sum of the sizes of its terms, `S`: products and sums of high parts without error, their
/// errors and the low parts added up in `f64` (Ogita, Rump, Oishi 2005, Accurate Sum and Dot Product,
/// doi:10.1137/030601818). Errs by less than 2^-99 S: at most ten additions of parts that are below 8 u S together,
/// 80 u^2 S; products of the low parts, what is left out of them and the rounding of a normal, 8 u^2 S.
#[inline(always)]
pub(super) fn dot<P: Product, R: Real>(a: &[Double<R>; 3], b: &[Double<R>; 3], c: R) -> (Double<R>, R) {
    let (x, x_low) = term::<P, R>(a[0], b[0]);
    let (y, y_low) = term::<P, R>(a[1], b[1]);
    let (z, z_low) = term::<P, R>(a[2], b[2]);
    let (s, e) = two_sum(x, y);
    let (s, f) = two_sum(s, z);
    let (s, g) = two_sum(s, c);
    let (high, low) = fast_two_sum(s, ((x_low + y_low) + z_low) + ((e + f) + g));
    (Double { high, low }, x.abs() + y.abs() + z.abs() + c.abs())
}

/// The product of the high parts, and all else but the product of the low ones.
#[inline(always)]
fn term<P: Product, R: Real>(a: Double<R>, b: Double<R>) -> (R, R) {
    let (p, e) = R::two_product::<P>(a.high, b.high);
    (p, e + (a.high * b.low + a.low * b.high))
}

struct Meet<'a, S> {
    piece: &'a S,
    ray: &'a Ray,
}

impl<S: Piece> Task for Meet<'_, S> {
    type Output = Option<Meeting>;
    #[inline(always)]
    fn run<P: Product>(self) -> Option<Meeting> {
        let plane = self.piece.plane();
        let (direction, direction_power) = prescaled(self.ray.direction);
        let (w, power) = exact_difference(plane.anchor, self.ray.origin);
        let offset = plane.offset * exp2i(-power);
        let place = match certain::<P>(&plane, offset, &w, direction) {
            Some(place) => place,
            None => place_exactly::<P>(&self.piece.exact_normal(), &plane, offset, &w, direction)?,
        };
        Some(Meeting {
            t: times_power(place.t.to_f64(), power - direction_power),
            local: place.local,
            power,
            error: place.error,
        })
    }
}

/// Where a ray meets a plane, for `w` and `d` whose largest components are in `[1, 2)`, from exact sums.
#[cold]
#[inline(never)]
fn place_exactly<P: Product>(
    normal: &[Expansion; 3],
    plane: &ExactPlane,
    offset: f64,
    w: &[Double; 3],
    d: DVec3,
) -> Option<Place> {
    let d = d.to_array();
    let (mut numerator, mut denominator) = (Expansion::ZERO, Expansion::ZERO);
    numerator.add(offset);
    for i in 0..3 {
        numerator.add_expansion_product::<P>(&normal[i], w[i]);
        denominator.add_expansion_product::<P>(&normal[i], Double::from(d[i]));
    }
    let denominator = denominator.rounded();
    if denominator.high == 0.0 {
        return None;
    }
    let t = numerator.rounded().div::<P>(denominator);
    let mut local = [0, 1, 2].map(|i| t.scale::<P>(d[i]) - w[i]);
    // The quotient errs by 2^-102 of itself, the product and the difference by 2^-103 of their operands.
    let mut error = exp2i(-99) * (2.0 + 2.0 * t.high.abs());
    let largest = local.iter().fold(0.0_f64, |m, x| m.max(x.high.abs()));
    // A place near the anchor met from afar: without the difference of large numbers.
    if plane.offset == 0.0 && largest < exp2i(-40) * t.high.abs() {
        local = near_anchor::<P>(&plane.normal, w, d, denominator);
        error = exp2i(-99) * largest;
    }
    if let Some(k) = plane.axis {
        local[k as usize % 3] = Double::ZERO;
    }
    Some(Place { t, local, error })
}

/// `t d - w = n x (d x w) / (n . d)`, with an exact inner product: for places much nearer to the anchor than the
/// origin is. Errs by 2^-100 of itself over the cosine between normal and direction.
fn near_anchor<P: Product>(
    n: &[Double; 3],
    w: &[Double; 3],
    d: [f64; 3],
    denominator: Double,
) -> [Double; 3] {
    let m = cross::<P>(&d.map(Double::from), w).map(|m| m.rounded());
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| (n[j].mul::<P>(m[k]) - n[k].mul::<P>(m[j])).div::<P>(denominator))
}

/// `a - b` as exact sums of two `f64`.
#[inline(always)]
fn difference<R: Real>(a: Vector<R>, b: Vector<R>) -> [Double<R>; 3] {
    [Double::difference(a.x, b.x), Double::difference(a.y, b.y), Double::difference(a.z, b.z)]
}

/// `a - b` as exact sums of two `f64`, in units of the returned power of two, in which the largest is in `[1, 2)`.
#[inline(always)]
pub(super) fn exact_difference(a: DVec3, b: DVec3) -> ([Double; 3], i32) {
    let w = difference(a.into(), b.into());
    let power = power_of(DVec3::new(w[0].high, w[1].high, w[2].high));
    let scale = exp2i(-power);
    (w.map(|x| x.scale_exact(scale)), power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scaled::largest;
    use crate::shape::flat::doubles;
    use crate::testing::Random;

    struct Somewhere<'a>(&'a ExactPlane, &'a Ray);

    impl Task for Somewhere<'_> {
        type Output = Option<Place>;
        fn run<P: Product>(self) -> Option<Place> {
            let Somewhere(plane, ray) = self;
            certain::<P>(
                plane,
                plane.offset,
                &difference(plane.anchor.into(), ray.origin.into()),
                ray.direction,
            )
        }
    }

    /// Double-double without scaling finds the places of all plain rays, within a bound that covers its roundings and is not
    /// much more than those over the cosine.
    #[test]
    fn places_of_plain_rays() {
        let mut random = Random::new(1);
        for case in 0..2000 {
            let (anchor, n) = (random.in_cube(), random.direction());
            let axis = (case % 2 == 0).then_some((case / 2 % 3) as u8);
            let n = axis.map_or(n, |k| DVec3::AXES[usize::from(k)]);
            let plane = ExactPlane { anchor, normal: doubles(n), axis, offset: 0.0 };
            let origin = random.in_cube() * 10.0;
            let mut direction = random.direction() * random.magnitude(-3.0, 3.0);
            if case % 4 > 1 {
                // At the anchor, nearly: there the place may have too few digits.
                direction = anchor + random.in_cube() * random.magnitude(-40.0, -5.0) - origin;
            }
            let ray = Ray::new(origin, direction);
            let Some(Place { t, local, error }) = run(Somewhere(&plane, &ray)) else {
                assert!(case % 4 > 1, "{plane:?} {ray:?}");
                continue;
            };
            assert!(error < exp2i(-60) * largest(DVec3::from_array(local.map(|x| x.high))), "{error:e}");
            let reach = largest(anchor - origin);
            let ways = t.high.abs() * largest(ray.direction) + reach;
            let cosine = ray.direction.normalize().dot(n).abs();
            assert!(error >= exp2i(-100) * ways, "{error:e}");
            assert!(error <= exp2i(-95) * ways / cosine, "{error:e} {ways} {cosine}");
            let off = local
                .iter()
                .zip(n.to_array())
                .fold(Double::ZERO, |sum, (&x, n)| sum + x.mul::<crate::kernel::Dekker>(Double::from(n)));
            assert!(off.high.abs() <= 3.0 * error, "{off:?} {error:e}");
        }
    }

    struct Dot([Double; 3], [Double; 3], f64);

    impl Task for Dot {
        type Output = (Double, f64);
        fn run<P: Product>(self) -> Self::Output {
            dot::<P, f64>(&self.0, &self.1, self.2)
        }
    }

    /// A product that cancels is right to 2^-99 of the sizes of its terms, which come with it.
    #[test]
    fn products_that_cancel() {
        let mut random = Random::new(2);
        for _ in 0..1000 {
            let (a, b) = (random.in_cube(), random.in_cube());
            let (rough, size) = run(Dot(doubles(a), doubles(b), 0.0));
            let terms = (a * b).abs().element_sum();
            assert!((size / terms - 1.0).abs() < 1e-15, "{size} {terms}");
            let (rest, size) = run(Dot(doubles(a), doubles(b), -rough.high));
            assert!((size / (terms + rough.high.abs()) - 1.0).abs() < 1e-15, "{size} {terms}");
            assert!((rest - rough.low).high.abs() <= exp2i(-99) * size, "{a} {b}");
        }
    }

    struct Exactly<'a>(&'a ExactPlane, [Double; 3], DVec3);

    impl Task for Exactly<'_> {
        type Output = Option<Place>;
        fn run<P: Product>(self) -> Option<Place> {
            let Exactly(plane, w, d) = self;
            let normal = plane.normal.map(|n| {
                let mut sum = Expansion::ZERO;
                sum.add(n.low);
                sum.add(n.high);
                sum
            });
            place_exactly::<P>(&normal, plane, plane.offset, &w, d)
        }
    }

    /// What exact sums find lies on the ray and in the plane, within its bound: far or near, with the plane through the anchor
    /// or beside it, where the ray aims at the anchor and where it does not.
    #[test]
    fn places_by_exact_sums() {
        let mut random = Random::new(3);
        let (mut near, mut count) = (0, 0);
        for case in 0..4000 {
            let n = random.direction();
            let offset = [0.0, random.magnitude(-30.0, -1.0) * random.sign()][case % 2];
            let plane = ExactPlane { anchor: DVec3::ZERO, normal: doubles(n), axis: None, offset };
            // The direction has components of a few digits, so that a place beside the anchor is known exactly: w is the
            // way back, and a little.
            let grid = |v: DVec3| (v * exp2i(20)).round() * exp2i(-20);
            let d = grid(random.direction() * 1.4);
            let aim = random.in_cube() * if case % 4 < 2 { 1.0 } else { random.magnitude(-25.0, -8.0) };
            let way = grid(DVec3::splat(random.uniform(1.0, 1.4))).x;
            let (back, aim) = (d * way, aim.to_array());
            let w = core::array::from_fn(|k| Double::from(back[k]) - aim[k]);
            let Some(Place { t, local, error }) = run(Exactly(&plane, w, d)) else { continue };
            count += 1;
            let cosine = d.dot(n).abs() / d.length();
            // Of the ray: local = t d - w.
            let dekker = |t: Double, d: f64| t.scale::<crate::kernel::Dekker>(d);
            for k in 0..3 {
                let off = (local[k] - (dekker(t, d[k]) - w[k])).high.abs();
                assert!(off <= 2.0 * error + exp2i(-97) * t.high.abs(), "{case} {k} {off:e} {error:e}");
            }
            let sum = (0..3).fold(Double::from(-offset), |sum, k| sum + dekker(local[k], n[k]));
            assert!(sum.high.abs() <= 3.0 * error, "{case}: {sum:?} {error:e}");
            let least = largest(DVec3::from_array(local.map(|x| x.high)));
            assert!(error >= exp2i(-103) * least && error <= exp2i(-96) * (1.0 + t.high.abs()), "{error:e}");
            if offset == 0.0 && least < exp2i(-45) * t.high.abs() {
                near += 1;
                assert!(error <= exp2i(-98) * least, "{error:e} {least:e}");
            }
            assert!(cosine > 0.0);
        }
        assert!(count > 3900 && near > 300, "{count} {near}");
    }

    /// The error radius holds two roundings of each coordinate of the point, and what the place may err along each axis.
    #[test]
    fn an_error_radius_holds_its_parts() {
        let mut random = Random::new(4);
        for case in 0..1000 {
            let point =
                random.in_cube() * random.magnitude(-9.0, 9.0) * if case % 5 == 0 { 0.0 } else { 1.0 };
            let error = random.magnitude(-30.0, 3.0) * if case % 3 == 0 { 0.0 } else { 1.0 };
            let power = random.below(40) as i32 - 20;
            let at = Meeting { t: 0.0, local: [Double::ZERO; 3], power, error };
            let found = at.error_radius(point);
            let roundings = 2.0 * U * point.abs().element_sum();
            let least = roundings + 3.0 * error * exp2i(power);
            assert!(
                found >= least && found <= least * (1.0 + 1e-14) + f64::from_bits(9),
                "{point} {error} {power}"
            );
        }
        let at = Meeting { t: 0.0, local: [Double::ZERO; 3], power: 0, error: 0.0 };
        assert!(at.error_radius(DVec3::ZERO) > 0.0 && at.error_radius(DVec3::ZERO) < 1e-320);
    }
}
