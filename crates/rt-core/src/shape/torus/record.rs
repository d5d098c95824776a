//! The full record of a hit: parameter, point, normal and angles from the refined crossing.

use super::Torus;
use super::exact::{self, Crossings};
use super::line::Line;
use super::together::in_own_scale;
use crate::double::{Double, two_difference, two_sum};
use crate::double_vector::DoubleVector;
use crate::kernel::{Dekker, Four, Lanes, Product, Real, Task, Vector, run};
use crate::math::{exp2i, sqrt};
use crate::scaled::{ScaledFour, ScaledRay, largest, radius_about, times_power};
use crate::shape::SurfaceEach;
use crate::surface::Coordinates;
use crate::{Hit, Primitive, Ray, Surface};
use glam::DVec2;

/// From the hit's own point: two Newton steps at most on the distance from the tube, in its square,
///
/// ```text
/// g = (rho - R)^2 + z^2 - r^2,   g' / 2 = q = (rho - R) rho' + z z',   |g'' / 2| <= |d|^2 (1 + R / rho)
/// ```
///
/// By the line for spindles and wherever they may not be enough.
pub(super) struct Direct<'a>(pub Near<'a>);

/// See [`Primitive::surface`](crate::Primitive::surface). `None` where only the whole search can tell which crossing
/// is meant.
#[derive(Clone, Copy)]
pub(super) struct Near<'a> {
    pub torus: &'a Torus,
    pub ray: &'a ScaledRay,
    pub hit: Hit,
}

/// The same with all crossings separated anew.
pub(super) struct Thorough<'a>(pub Near<'a>);

/// `hit` gives the distance along the ray to this part of the torus' size, or exactly (the module `filter`).
pub(super) const HIT_ERROR: f64 = exp2i(-38);

impl Task for Direct<'_> {
    type Output = Surface;

    #[inline(always)]
    fn run<P: Product>(self) -> Surface {
        // Nothing between the numbers and the record: an `Option` of one would be written and copied.
        match self.quickly::<P>() {
            Some(surface) => surface,
            None => by_the_line(self.0),
        }
    }
}

/// A record that takes more than the hit's own point.
#[cold]
#[inline(never)]
fn by_the_line(near: Near<'_>) -> Surface {
    run(near).unwrap_or_else(|| run(Thorough(near)))
}

impl Direct<'_> {
    /// Why that is enough: the place is known to 2^-104 of the distance S >= 1 that the ray comes from, its height `z` to
    /// 2^-98, `rho` to 2^-99, hence `g` to 2^-95 r S, which moves the crossing by 2^-96 r S / q. A step `s` leaves at most
    /// `2 M s^2 / q`, where M bounds the second derivative as far as `q` halves, and what the rounding of q, below
    /// 2^-48 r |d|, does to it, `2^-48 s r |d| / q`. Each must be below 2^-70 of the parameter, of the size and of the tube.
    ///
    /// Why it is the crossing that is meant: as far as `q` keeps its sign, `g` has one zero at most. By Kantorovich's
    /// theorem there is one within `2 s`, for `M s < q / 2`; that of the hit lies within [`HIT_ERROR`] and
    /// the rounding of the parameter.
    #[inline(always)]
    fn quickly<P: Product>(&self) -> Option<Surface> {
        let Direct(Near { torus, ray, hit }) = self;
        let tube = Tube::of(torus);
        let d = ray.direction.into();
        let mut t = Double::from(times_power(hit.t(), -ray.power));
        for _ in 0..2 {
            let step = Step::new::<P>(&tube, &ray.relative, d, t, u32::from(hit.root().is_multiple_of(2)));
            if step.sound == 0 {
                return None;
            }
            t = step.t;
            if step.enough != 0 {
                return Some(torus.finish(ray.unscale(t).to_f64(), step.place(&tube, d)));
            }
        }
        None
    }
}

impl SurfaceEach for Torus {
    #[inline(always)]
    fn surface_each<L: Lanes>(
        lanes: L,
        tori: [&Self; 4],
        rays: [&Ray; 4],
        hits: [Hit; 4],
        surfaces: [&mut Surface; 4],
    ) {
        let [a, b, c, d] = tori;
        let (scaled, center, per_unit) = in_own_scale(lanes, tori, rays);
        let ScaledFour { relative, direction, power, sound } = scaled;
        let tube = Tube {
            axis: DoubleVector::new(lanes, [&a.frame[2], &b.frame[2], &c.frame[2], &d.frame[2]]),
            major: Four::new(lanes, [a.major_scaled, b.major_scaled, c.major_scaled, d.major_scaled]),
            minor: Four::new(lanes, [a.minor_scaled, b.minor_scaled, c.minor_scaled, d.minor_scaled]),
        };
        let first = leading_of_four(lanes, [&a.frame[0], &b.frame[0], &c.frame[0], &d.frame[0]]);
        let second = leading_of_four(lanes, [&a.frame[1], &b.frame[1], &c.frame[1], &d.frame[1]]);
        let t = Four::new(lanes, [hits[0].t(), hits[1].t(), hits[2].t(), hits[3].t()]) / power;
        let even = (hits[0].root() & 1)
            | (hits[1].root() & 1) << 1
            | (hits[2].root() & 1) << 2
            | (hits[3].root() & 1) << 3;
        // The lanes bring their own products.
        let start = Double { high: t, low: t.all(0.0) };
        let step = Step::new::<Dekker>(&tube, &relative, direction, start, 15 & !even);
        let place = step.place(&tube, direction);
        let done = Finished::new(&place, center, first, second, t.all(1.0) / per_unit);
        let sound = sound & step.sound & step.enough;
        let t = (step.t.high * power + step.t.low * power).to_array();
        let (point, local, own) = (done.point.to_array(), done.local.to_array(), done.own.to_array());
        let (object_point, normal) = (done.object_point.to_array(), place.normal.to_array());
        let (out, error) = (place.out.to_array(), done.error.to_array());
        for (i, surface) in surfaces.into_iter().enumerate() {
            if sound >> i & 1 == 0 {
                *surface = tori[i].surface(rays[i], hits[i]);
                continue;
            }
            let ring = Coordinates::Ring(DVec2::new(own[i].x, own[i].y), DVec2::new(out[i], own[i].z));
            surface.set(t[i], point[i], local[i], object_point[i], normal[i], ring, error[i]);
        }
    }
}

#[inline(always)]
fn leading_of_four<L: Lanes>(lanes: L, [a, b, c, d]: [&DoubleVector; 4]) -> Vector<Four<L>> {
    Vector {
        x: Four::new(lanes, [a.x.high, b.x.high, c.x.high, d.x.high]),
        y: Four::new(lanes, [a.y.high, b.y.high, c.y.high, d.y.high]),
        z: Four::new(lanes, [a.z.high, b.z.high, c.z.high, d.z.high]),
    }
}

/// What a step needs of a torus.
struct Tube<R> {
    axis: DoubleVector<R>,
    major: R,
    minor: R,
}

impl Tube<f64> {
    #[inline(always)]
    fn of(torus: &Torus) -> Self {
        Tube { axis: torus.frame[2], major: torus.major_scaled, minor: torus.minor_scaled }
    }
}

/// A step of Newton's method on the distance from the tube.
struct Step<R> {
    /// The parameter after it.
    t: Double<R>,
    /// Where it began: the place, its distance from the axis, and how it lies to the generating circle.
    start: DoubleVector<R>,
    away: DoubleVector<R>,
    rho: Double<R>,
    out: Double<R>,
    z: Double<R>,
    /// How fast the line goes away from the axis and along it.
    outward: R,
    along: R,
    step: R,
    /// In which lanes it leads to the crossing that is meant, and where nothing is left to do.
    sound: u32,
    enough: u32,
}

impl<R: Real> Step<R> {
    /// `even` says in which lanes the index of the crossing is even.
    #[inline(always)]
    fn new<P: Product>(
        tube: &Tube<R>,
        relative: &DoubleVector<R>,
        d: Vector<R>,
        t: Double<R>,
        even: u32,
    ) -> Self {
        let (axis, major, minor) = (&tube.axis, tube.major, tube.minor);
        let (one, two) = (minor.all(1.0), minor.all(2.0));
        let square = d.dot(d);
        let far = relative.leading().largest() + one;
        let along = axis.leading().dot(d);
        let p = relative.advanced::<P>(d, t);
        let z = axis.inner::<P>(&p);
        let away = p.less::<P>(axis, z);
        let rho = away.length::<P>();
        let out = rho - major;
        let inverse = one / rho.high;
        let outward = away.leading().dot(d) * inverse;
        let q = out.high * outward + z.high * along;
        let per_excess = one.all(-0.5) / q;
        let step = excess::<P, R>(out, z, minor) * per_excess;
        let (q, size) = (q.abs(), step.abs());
        // A crossing with an even index leads inward.
        let inward = one.all(0.0).less(per_excess);
        let bend = square * (one + two * major * inverse);
        let way = t.high.abs();
        let reach = two * size + one.all(HIT_ERROR) + one.all(4.0 * f64::EPSILON) * (way + far);
        let least = R::if_less(way, minor, way, minor);
        let sound = minor.at_most(major)
            & one.all(exp2i(-4)).less(rho.high)
            & !(inward ^ even)
            & (two * bend * reach).less(q)
            & (one.all(exp2i(-26)) * minor * far).less(q * least);
        let limit = one.all(exp2i(-70)) * least * q;
        let enough = (two * bend * size * size).less(limit)
            & (one.all(exp2i(-48)) * minor * square * size).less(limit);
        let t = Double::sum(t.high, t.low + step);
        Step { t, start: p, away, rho, out, z, outward, along, step, sound, enough }
    }

    /// The place that it leads to.
    #[inline(always)]
    fn place(&self, tube: &Tube<R>, d: Vector<R>) -> Place<R> {
        let (minor, step) = (tube.minor, self.step);
        let axis = tube.axis.leading();
        let across = d - axis * self.along;
        let across = Vector {
            x: near(self.away.x, across.x, step),
            y: near(self.away.y, across.y, step),
            z: near(self.away.z, across.z, step),
        };
        let out = near(self.out, self.outward, step);
        let z = near(self.z, self.along, step);
        let rho = near(self.rho, self.outward, step);
        let normal = across * (out / (rho * minor)) + axis * (z / minor);
        let local = self.start.nudged(d, step);
        // Three parts as above, each times |d| < 2^2.
        let error = minor.all(exp2i(-66)) * minor;
        Place { local, normal, out, z, inner: false, error }
    }
}

/// `a` a little further on.
#[inline(always)]
fn near<R: Real>(a: Double<R>, d: R, step: R) -> R {
    a.high + (a.low + d * step)
}

/// A place on the torus, in its units.
struct Place<R = f64> {
    local: DoubleVector<R>,
    normal: Vector<R>,
    /// The way to it from the generating circle: along the radius and along the axis.
    out: R,
    z: R,
    /// Whether it is on the inner sheet of a spindle.
    inner: bool,
    /// How far the true crossing can be.
    error: R,
}

/// What a record says of a place, in the units of the world.
struct Finished<R> {
    point: Vector<R>,
    local: Vector<R>,
    error: R,
    /// The place in the torus' own axes and units.
    own: Vector<R>,
    object_point: Vector<R>,
}

impl<R: Real> Finished<R> {
    /// `first` and `second` are the first two of the own axes.
    #[inline(always)]
    fn new(place: &Place<R>, center: Vector<R>, first: Vector<R>, second: Vector<R>, unit: R) -> Self {
        let flat = place.local.leading();
        let own = Vector { x: flat.dot(first), y: flat.dot(second), z: place.z };
        let world = place.local.scale_exact(unit);
        let point = world.plus(center);
        Finished {
            point,
            local: world.leading(),
            error: radius_about(point, unit * place.error),
            own,
            object_point: own * unit,
        }
    }
}

/// `out^2 + z^2 - r^2`.
#[inline(always)]
fn excess<P: Product, R: Real>(out: Double<R>, z: Double<R>, r: R) -> R {
    let (x, x_low) = R::two_product::<P>(out.high, out.high);
    let (y, y_low) = R::two_product::<P>(z.high, z.high);
    let (r, r_low) = R::two_product::<P>(r, r);
    let (s, s_low) = two_difference(x, r);
    let (v, v_low) = two_sum(s, y);
    let cross = out.high * out.low + z.high * z.low;
    v + (v_low + (s_low + ((x_low + y_low) - r_low) + r.all(2.0) * cross))
}

impl Task for Near<'_> {
    type Output = Option<Surface>;

    #[inline(always)]
    fn run<P: Product>(self) -> Option<Surface> {
        let line = Line::of::<P>(self.torus, self.ray);
        let t = Double::from(times_power(self.hit.t(), -self.ray.power));
        let mut x = line.distance::<P>(t);
        if x.high.abs() > 2.0 * self.torus.reach || x.high.is_nan() {
            return None;
        }
        let (value, slope) = line.value::<P>(x);
        // A crossing with an even index leads inward: f falls.
        if (slope.high < 0.0) != self.hit.root().is_multiple_of(2) {
            return None;
        }
        // Smale's alpha theorem (Blum, Cucker, Shub, Smale, Complexity and Real Computation, 1998, chapter 8): with
        // gamma the greatest of |f^(j) / (j! f')|^(1 / (j - 1)) at x, Newton's method finds a zero within twice its first
        // step if that is less than 0.15 / gamma, and two zeros within 0.05 / gamma of x would be nearer to each other
        // than the 0.16 / gamma that zeros there keep apart. The hit is within HIT_ERROR and the rounding of t of its
        // crossing, so that is the zero found. Each power of gamma times the reach is compared with that of 0.05; the third
        // derivative over 3! is 4 |x|, at most 32, and where that passes, so does the fourth over 4!, which is 1.
        let around = x.high.abs() * 4.0 * f64::EPSILON + (t.high * line.length.high).abs() * f64::EPSILON;
        let reach = 2.0 * (value.high / (4.0 * slope.high)).abs() + HIT_ERROR + around;
        let derivative = 4.0 * slope.high.abs();
        let second = (4.0 * line.bend(x.high)).abs() * reach;
        if !(second < 0.05 * derivative && 32.0 * reach * reach < 0.0025 * derivative) {
            return None;
        }
        let mut step = value.div::<P>(slope).scale_exact(0.25);
        x = x - step;
        let mut slope = slope.high;
        // Each step more than doubles the correct bits, of which there are 30 or more at first.
        for _ in 0..3 {
            // What is left must vanish beside a rounding of t, of the size and of the tube.
            let least = (t.high * line.length.high).abs().min(self.torus.minor_scaled);
            if exact::left(&line, x, slope, step.high) <= exp2i(-70) * least {
                break;
            }
            let (value, steepness) = line.value::<P>(x);
            step = value.div::<P>(steepness).scale_exact(0.25);
            slope = steepness.high;
            x = x - step;
        }
        Some(self.torus.record::<P>(self.ray, &line, x))
    }
}

impl Task for Thorough<'_> {
    type Output = Surface;

    #[inline(always)]
    fn run<P: Product>(self) -> Surface {
        let Thorough(Near { torus, ray, hit }) = self;
        let line = Line::of::<P>(torus, ray);
        let crossings = exact::crossings::<P>(torus, &line);
        let t = Double::from(times_power(hit.t(), -ray.power));
        let x = line.distance::<P>(t);
        // A ray that left this torus was followed from its exact start; its origin differs from that by a few units
        // in the last place of the world's coordinates. That changes f by at most its gradient, less than
        // 32 (R + r)^3, times as much, and a value of so little has a zero of f, which is monic and of degree four,
        // within the fourth root.
        let moved = largest(torus.center) * exp2i(-torus.scale) + largest(ray.relative.high()) + torus.reach;
        let change = 32.0 * torus.reach * torus.reach * torus.reach * moved * exp2i(-50);
        match chosen(&crossings, x.high, sqrt(sqrt(change)), hit.root()) {
            Some(x) => torus.record::<P>(ray, &line, x),
            // That zero is not real: the moved ray passes a place that the exact one grazes.
            None => {
                let mut surface = torus.record::<P>(ray, &line, x);
                surface.normal = surface.normal.normalize();
                surface.shading_normal = surface.normal;
                surface
            }
        }
    }
}

/// The crossing that the hit names: of those in the same sense (both inward or both outward) the one nearest to its
/// place, unless that is too far, and of equally near ones that of its index. Only rays that leave this torus make a
/// difference: they were counted along the line from the departure's point, not along the line of the moved ray.
#[inline(always)]
fn chosen(crossings: &Crossings, place: f64, too_far: f64, root: u32) -> Option<Double> {
    let mut best: Option<(f64, Double)> = None;
    for (index, x) in crossings.as_slice().iter().enumerate() {
        let miss = (x.high - place).abs();
        if index as u32 % 2 != root % 2 || miss > too_far {
            continue;
        }
        if best.is_none_or(|(least, _)| miss < least || (miss == least && index as u32 == root)) {
            best = Some((miss, *x));
        }
    }
    best.map(|(_, x)| x)
}

impl Torus {
    /// The record of the point at distance `x` from the closest approach.
    #[inline(always)]
    fn record<P: Product>(&self, ray: &ScaledRay, line: &Line, x: Double) -> Surface {
        let (parameter, local) = line.at::<P>(x);
        let axis = self.frame[2];
        let z = line.z + x.mul::<P>(line.slope);
        let across = local - axis.mul::<P>(z);
        let rho = across.length_squared::<P>().sqrt::<P>();
        // How far the point is from the surface as seen from the near and from the far side of the generating
        // circle, in squares: on the inner sheet of a spindle the second vanishes.
        let inner = self.minor > self.major && {
            let height = z.square::<P>() - Double::product::<P>(self.minor_scaled, self.minor_scaled);
            let near = (rho - self.major_scaled).square::<P>() + height;
            let far = (rho + self.major_scaled).square::<P>() + height;
            far.high.abs() < near.high.abs()
        };
        // From the circle to the point: `out` along the radius, `z` along the axis. No digit is lost in what follows.
        let out = if inner { rho + self.major_scaled } else { rho - self.major_scaled };
        // Near the axis, where the sheets of a spindle meet in a point, `across` is a small difference and no longer
        // certain to be across: in f64 less than a unit beyond this distance, nearer the length is mended. Likewise where the
        // place is not known to an eighth of a rounding of the tube: on tubes thinner than 2^-50 of the ring, or from afar.
        let uncertainty = exact::uncertainty::<P>(self, line, x);
        let error = place_error(uncertainty, line.slope_at(x.high));
        let pinched = rho.high < exp2i(-20) || error > exp2i(-56) * self.minor_scaled;
        let normal = if rho.high > 0.0 {
            let normal = across.high() * (out.high / (rho.high * self.minor_scaled))
                + self.axis * (z.high / self.minor_scaled);
            if pinched { normal.normalize() } else { normal }
        } else {
            // On the axis, where the sheets meet in a point.
            self.axis * if z.high < 0.0 { -1.0 } else { 1.0 }
        };
        let t = ray.unscale(parameter).to_f64();
        self.finish(t, Place { local, normal: normal.into(), out: out.high, z: z.high, inner, error })
    }

    /// The record of a place.
    #[inline(always)]
    fn finish(&self, t: f64, place: Place) -> Surface {
        let [first, second] = [self.frame[0].high().into(), self.frame[1].high().into()];
        let done = Finished::new(&place, self.center.into(), first, second, exp2i(self.scale));
        let own = done.own;
        // On the inner sheet the tube is seen across the axis: half a turn further about it, and its outside lies
        // towards the axis.
        let uv = if place.inner {
            Coordinates::Ring(DVec2::new(-own.x, -own.y), DVec2::new(-place.out, own.z))
        } else {
            Coordinates::Ring(DVec2::new(own.x, own.y), DVec2::new(place.out, own.z))
        };
        Surface::new(t, done.point.into(), done.local.into(), place.normal.into(), done.error)
            .with_coordinates(uv)
            .with_object_point(done.object_point.into())
    }
}

/// How far the place on the ray can be from the true crossing: the error of `f`, its [uncertainty](exact::uncertainty),
/// over its derivative, four times `slope`; where that is small, near a double crossing, by the order of the
/// uncertainty's root instead.
#[inline(always)]
fn place_error(uncertainty: f64, slope: f64) -> f64 {
    let along = uncertainty / (4.0 * slope.abs());
    along.min(sqrt(uncertainty))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    struct Quickly<'a>(Direct<'a>);

    impl Task for Quickly<'_> {
        type Output = Option<Surface>;
        fn run<P: Product>(self) -> Option<Surface> {
            self.0.quickly::<P>()
        }
    }

    /// What must not become slow unseen: the hit's own point answers nearly all hits of plain rings, and as the line does.
    #[test]
    fn first_way_answers() {
        use crate::testing::Random;
        use crate::{Interval, Primitive, Ray, kernel};
        let mut random = Random::new(1);
        let mut count = [0_u32; 2];
        for case in 0..4000 {
            let minor = if case % 4 == 0 { random.magnitude(-4.0, 0.0) } else { random.uniform(0.1, 1.0) };
            let major = if case % 8 == 1 { minor } else { 1.0 };
            let torus = Torus::new(random.in_cube(), random.direction(), major, minor).unwrap();
            let target = torus.center + random.direction() * major + random.in_cube() * minor;
            let direction = random.direction() * random.magnitude(-3.0, 3.0);
            let ray = Ray::new(target - direction.normalize() * random.magnitude(0.5, 4.0), direction);
            let mut hits = [None; 4];
            let mut slots = hits.iter_mut();
            torus.crossings(&ray, Interval::LINE, &mut |hit| {
                if let Some(slot) = slots.next() {
                    *slot = Some(hit);
                }
            });
            for hit in hits.into_iter().flatten() {
                let scaled = torus.scaled(&ray).unwrap();
                let near = || Near { torus: &torus, ray: &scaled, hit };
                count[0] += 1;
                let Some(found) = kernel::run(Quickly(Direct(near()))) else { continue };
                count[1] += 1;
                let line = kernel::run(Thorough(near()));
                assert_eq!(found.t, line.t, "{torus:?} {ray:?} {hit:?}");
                // The same number but where the middle of two is near.
                let ulp = 2.0 * f64::EPSILON;
                assert!((found.local - line.local).length() <= 0.1 * ulp * torus.reach);
                assert!((found.point - line.point).length() <= ulp * largest(found.point));
                assert!((found.normal - line.normal).length() <= 3.0 * ulp);
                assert!((found.normal.length() - 1.0).abs() <= 2.0 * ulp);
                assert!((found.uv() - line.uv()).length() <= 1e-14 / minor);
                assert!((found.error / line.error - 1.0).abs() <= 1e-3, "{} {}", found.error, line.error);
            }
        }
        let [all, found] = count.map(f64::from);
        assert!(found > 0.93 * all && all > 4000.0, "{count:?}");
    }

    struct Together<'a>(&'a [(Torus, Ray, Hit)]);

    impl crate::kernel::Vectorized for Together<'_> {
        type Output = alloc::vec::Vec<Surface>;
        fn run<L: Lanes>(self, lanes: L) -> Self::Output {
            let nowhere = Surface::new(0.0, DVec3::ZERO, DVec3::ZERO, DVec3::Y, 0.0);
            let mut surfaces = alloc::vec![nowhere; self.0.len()];
            for (four, surfaces) in self.0.chunks_exact(4).zip(surfaces.chunks_exact_mut(4)) {
                let ([a, b, c, d], [sa, sb, sc, sd]) = (four, surfaces) else { continue };
                let (tori, rays) = ([&a.0, &b.0, &c.0, &d.0], [&a.1, &b.1, &c.1, &d.1]);
                Torus::surface_each(lanes, tori, rays, [a.2, b.2, c.2, d.2], [sa, sb, sc, sd]);
            }
            surfaces
        }
    }

    /// Records of four hits are those one by one, all bits, in all lanes, also where some are in doubt.
    #[test]
    fn four_are_each() {
        use crate::testing::Random;
        use crate::{Interval, kernel};
        let mut random = Random::new(7);
        let mut hits = alloc::vec::Vec::new();
        while hits.len() < 8000 {
            let size = if random.once_in(6) { random.magnitude(-140.0, 140.0) } else { 1.0 };
            let minor =
                if random.once_in(4) { random.magnitude(-5.0, 0.5) } else { random.uniform(0.1, 0.9) };
            let torus = Torus::new(random.in_cube() * size, random.direction(), size, minor * size).unwrap();
            let target = torus.center + random.in_cube() * size;
            let along = random.direction() * random.magnitude(-3.0, 3.0);
            let ray = Ray::new(target - along.normalize() * (random.magnitude(-1.0, 5.0) * size), along);
            torus.crossings(&ray, Interval::LINE, &mut |hit| hits.push((torus, ray, hit)));
        }
        hits.truncate(8000);
        let wide = kernel::vectorize(Together(&hits));
        let portable = kernel::Vectorized::run(Together(&hits), kernel::PortableLanes);
        for (i, (torus, ray, hit)) in hits.iter().enumerate() {
            let bits = |s: &Surface| alloc::format!("{s:?}");
            let expected = bits(&torus.surface(ray, *hit));
            assert_eq!(bits(&wide[i]), expected, "{torus:?} {ray:?} {hit:?}");
            assert_eq!(bits(&portable[i]), expected, "{torus:?} {ray:?} {hit:?}");
        }
    }

    /// Of the crossings in the same sense the nearest, not too far; of equally near ones that of the index.
    #[test]
    fn which_crossing_a_hit_names() {
        let mut crossings = Crossings::NONE;
        [-3.0, -1.0, 1.0, 2.5].into_iter().for_each(|x| crossings.push(Double::from(x)));
        for (place, too_far, root, expected) in [
            (-2.9, 1.0, 0, Some(-3.0)),
            (1.1, 1.0, 2, Some(1.0)),
            (1.1, 9.0, 0, Some(1.0)),
            (-2.0, 9.0, 2, Some(-3.0)),
            (1.1, 9.0, 1, Some(2.5)),
            (-0.9, 1.0, 3, Some(-1.0)),
            (-0.9, 1.0, 0, None),
            (-1.0, 2.0, 0, Some(-3.0)),
            (-1.0, 2.0, 2, Some(1.0)),
            (0.75, 2.0, 1, Some(-1.0)),
            (0.75, 2.0, 3, Some(2.5)),
            (9.0, 1.0, 3, None),
        ] {
            let found = chosen(&crossings, place, too_far, root).map(|x| x.high);
            assert_eq!(found, expected, "{place} {too_far} {root}");
        }
    }

    struct Crossed<'a>(&'a Torus, &'a ScaledRay);

    impl Task for Crossed<'_> {
        type Output = (Line, Crossings);
        fn run<P: Product>(self) -> Self::Output {
            let line = Line::of::<P>(self.0, self.1);
            (line, exact::crossings::<P>(self.0, &line))
        }
    }

    struct At<'a>(&'a Line, f64);

    impl Task for At<'_> {
        type Output = (f64, f64);
        fn run<P: Product>(self) -> Self::Output {
            let (value, slope) = self.0.value::<P>(Double::from(self.1));
            (value.to_f64(), slope.to_f64())
        }
    }

    struct Parameter<'a>(&'a Line, Double);

    impl Task for Parameter<'_> {
        type Output = Double;
        fn run<P: Product>(self) -> Double {
            self.0.parameter_at::<P>(self.1)
        }
    }

    /// A torus, a line through it and its crossings, of which two next to each other are this far apart, about.
    fn crossed(
        random: &mut crate::testing::Random,
        apart: f64,
        distance: f64,
    ) -> (Torus, ScaledRay, Line, Crossings) {
        let minor = random.uniform(0.2, 0.8);
        let torus = Torus::new(DVec3::ZERO, random.direction(), 1.0, minor).unwrap();
        let [x, y, z] = torus.frame.map(|axis| axis.high());
        let (u, v) = (random.uniform(0.0, 6.0), random.uniform(-1.2, 1.2));
        let out = x * libm::cos(u) + y * libm::sin(u);
        let normal = out * libm::cos(v) + z * libm::sin(v);
        // The tube is round across, and bent outward there lengthwise: a depth of h makes a chord of 2 sqrt(2 h r).
        let along = (out * libm::sin(v) - z * libm::cos(v)) + out.cross(z) * random.uniform(-0.3, 0.3);
        let along = along.normalize();
        let start = torus.scaled(&crate::Ray::new(out + normal * minor - along * distance, along)).unwrap();
        // The square of the chord grows with the depth evenly, nearly: by the method of secants, in double-double.
        let at = |depth: f64| {
            let mut ray = start;
            ray.relative.x = ray.relative.x - normal.x * depth;
            ray.relative.y = ray.relative.y - normal.y * depth;
            ray.relative.z = ray.relative.z - normal.z * depth;
            let (line, crossings) = crate::kernel::run(Crossed(&torus, &ray));
            let chord = match crossings.as_slice() {
                [first, second, ..] => (*second - *first).high,
                _ => 0.0,
            };
            (ray, line, crossings, chord * chord)
        };
        let (mut near, mut far, mut chord) = (1e-3, 2e-3, 0.1);
        while near != far {
            // By a tenth at most, so that no guess passes outside.
            chord = f64::max(apart, 0.1 * chord);
            let (a, b) = (at(near).3, at(far).3);
            let next = near + (chord * chord - a) * (far - near) / (b - a);
            let done = (a - apart * apart).abs() < 1e-3 * apart * apart;
            (near, far) = if done || !next.is_finite() { (near, near) } else { (next, near) };
        }
        let (ray, line, crossings, _) = at(near);
        (torus, ray, line, crossings)
    }

    /// A place errs by how far the crossing moves when `f` changes by its uncertainty, and where two crossings meet by no more
    /// than the root of that.
    #[test]
    fn a_place_errs_by_the_way_of_a_crossing() {
        let mut random = crate::testing::Random::new(1);
        let mut count = 0;
        for _ in 0..2000 {
            let apart = random.magnitude(-1.0, -0.3);
            let (_, _, line, crossings) = crossed(&mut random, apart, 3.0);
            for x in crossings.as_slice() {
                let slope = line.slope_at(x.high);
                let uncertainty = random.magnitude(-12.0, -9.0);
                let along = place_error(uncertainty, slope);
                for side in [-1.0, 1.0] {
                    let there = crate::kernel::run(At(&line, x.high + side * along)).0.abs();
                    // The curvature's share of it is small.
                    if (2.0 * line.bend(x.high) * along / slope).abs() < 1e-3 {
                        count += 1;
                        assert!((there / uncertainty - 1.0).abs() < 0.01, "{there:e} {uncertainty:e}");
                    }
                }
                for (slope, share) in [(0.0, 1.0), (1e-30, 1.0), (0.25, 1e-6), (-0.5, 0.5e-6)] {
                    let most = place_error(1e-12, slope);
                    assert!((most / (1e-6 * share) - 1.0).abs() < 1e-9, "{most:e} {slope}");
                }
            }
        }
        assert!(count > 2000, "{count}");
    }

    /// A hit as far off as it may be is refined alone where its crossing is the only one for twenty such errors, and not where
    /// another is nearer; then the record is that of all crossings separated anew.
    #[test]
    fn hits_are_refined_alone_where_it_is_safe() {
        let mut random = crate::testing::Random::new(2);
        let mut count = [0; 3];
        for case in 0..8000 {
            let distance = if case % 2 == 0 { 3.0 } else { random.magnitude(1.0, 6.0) };
            // What the hit may err: its promise, and the rounding of its parameter.
            let error = HIT_ERROR + f64::EPSILON * distance;
            let apart = error * random.magnitude(0.5, 3.5);
            let (torus, ray, line, crossings) = crossed(&mut random, apart, distance);
            let &[first, second] = crossings.as_slice() else { continue };
            let apart = (second - first).high;
            let index = case / 2 % 2;
            let x = [first, second][index] + HIT_ERROR * random.uniform(-1.0, 1.0);
            let t = times_power(crate::kernel::run(Parameter(&line, x)).high, ray.power);
            let hit = crate::Interval::LINE.admit(t, 0, index as u32).unwrap();
            let near = crate::kernel::run(Near { torus: &torus, ray: &ray, hit });
            let thorough = crate::kernel::run(Thorough(Near { torus: &torus, ray: &ray, hit }));
            if let Some(near) = near {
                assert_eq!(near.t, thorough.t, "{torus:?} {hit:?}");
                assert!((near.point - thorough.point).length() < 1e-15, "{torus:?} {hit:?}");
                count[0] += 1;
                assert!(apart > 18.0 * error, "{} {distance}", apart / error);
            } else {
                count[1] += 1;
                assert!(apart < 140.0 * error, "{} {distance}", apart / error);
            }
            count[2] += u32::from(apart > 100.0 * error);
        }
        assert!(count.iter().all(|&count| count > 1000), "{count:?}");
    }

    /// A hit without a crossing near it, as one may be that a moved ray passes: the record is that of its own place.
    #[test]
    fn a_hit_without_a_crossing() {
        let torus = Torus::new(DVec3::ZERO, DVec3::Z, 2.0, 0.5).unwrap();
        // Just over the tube, and through it on the other side.
        let along = DVec3::new(1.0, 0.0, -0.05).normalize();
        let top = DVec3::new(-2.0, 0.0, 0.0) + DVec3::new(0.05, 0.0, 1.0).normalize() * (0.5 + 1e-9);
        let ray = crate::Ray::new(top - along, along);
        let scaled = torus.scaled(&ray).unwrap();
        let (_, crossings) = crate::kernel::run(Crossed(&torus, &scaled));
        assert_eq!(crossings.as_slice().len(), 2);
        for root in 0..2 {
            let hit = crate::Interval::LINE.admit(1.0, 0, root).unwrap();
            let surface = crate::kernel::run(Thorough(Near { torus: &torus, ray: &scaled, hit }));
            assert!((surface.point - top).length() < 1e-14, "{surface:?}");
            assert!((surface.normal.length() - 1.0).abs() < 1e-15);
            // Where there is one, it is meant, however far off the hit is by a moved start.
            let hit = crate::Interval::LINE.admit(4.0, 0, root).unwrap();
            let far = crate::kernel::run(Thorough(Near { torus: &torus, ray: &scaled, hit }));
            assert!((far.t - 4.0).abs() < 1e-12, "{far:?}");
        }
    }
}
