//! The sphere `|p - center| = radius`.
//!
//! From up to six radii the crossings are those of the quadratic formula; from beyond, its discriminant is taken from the moment of
//! the line, so that nothing is lost. Where that is not certain, the ray is moved to its closest approach to the centre, and the
//! discriminant is a difference of lengths there (Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray
//! Tracing Gems, 2019, chapter 7, doi:10.1007/978-1-4842-4427-2_7); and what is still in doubt is left to double-double.

use super::SurfaceEach;
use super::paired::Paired;
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{self, Dekker, Four, Lanes, Pair, Product, Real, Task, Vector};
use crate::math::{exp2i, exponent, rarely, sqrt};
use crate::scaled::{
    CLEAR, Candidate, Rough, ScaledRay, admit, admit_exit, checked_length, checked_point, error_radius,
    is_plain, largest, moderate, plain_lanes, radius_about, range_guard, times_power, uncertainty,
};
use crate::surface::Coordinates;
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Side, Similarity, Surface};
use glam::DVec3;

/// A sphere: its surface, hit from outside and from inside.
///
/// The only part is 0; root 0 is where the line enters, root 1 where it leaves. The normal points outward. `u` is
/// the angle about the y axis from x towards -z, in turns in `[0, 1)`; `v` is 0 at the south pole (-y) and 1 at the
/// north pole. The shape's own axes are the world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
    /// The square of the radius, or NaN where squares would leave the range of the exponents.
    square: f64,
}

impl Sphere {
    /// The sphere about `center` with `radius`, both in world units.
    ///
    /// # Errors
    /// [`Error::NotFinite`] or [`Error::OutOfRange`] for a centre that is not finite or has a coordinate beyond
    /// 1e150, [`Error::NotPositive`] or [`Error::OutOfRange`] for the radius.
    pub fn new(center: impl Into<DVec3>, radius: f64) -> Result<Self, Error> {
        let center = checked_point("center", center.into())?;
        let radius = checked_length("radius", radius)?;
        Ok(Sphere { center, radius, square: radius * radius + range_guard(radius) })
    }

    /// The centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The same sphere scaled, turned and moved.
    ///
    /// # Errors
    /// As [`Sphere::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        Sphere::new(by.point(self.center), self.radius * by.scale())
    }

    fn scaled(&self, ray: &Ray) -> Option<(ScaledRay, Chord)> {
        let unit = exponent(self.radius);
        let scaled = ScaledRay::new(ray, self.center, unit)?;
        let chord = kernel::run(FindChord { ray: &scaled, radius: self.radius * exp2i(-unit) });
        Some((scaled, chord))
    }

    /// The record of a place that is known to `error`.
    #[inline(always)]
    fn record(&self, t: f64, local: DoubleVector, error: f64) -> Surface {
        let point = local.plus_f64(self.center);
        Surface::new(t, point, local.high(), local.high() / self.radius, error_radius(point, error))
            .with_coordinates(Coordinates::Globe)
    }

    /// [`Primitive::surface`] where the short way is not certain.
    #[cold]
    #[inline(never)]
    fn surface_carefully(&self, ray: &Ray, hit: Hit) -> Surface {
        let unit = exponent(self.radius);
        let radius = self.radius * exp2i(-unit);
        let Some(scaled) = ScaledRay::new(ray, self.center, unit) else {
            return Surface::new(hit.t(), self.center, DVec3::ZERO, DVec3::Y, self.radius);
        };
        let found = kernel::run(FindRescaled { ray: &scaled, radius, hit });
        let scale = exp2i(unit);
        self.record(scaled.unscale(found.t).high, found.local.scale_exact(scale), found.error * scale)
    }

    /// The ray, seen from the centre.
    #[inline(always)]
    fn paired(&self, ray: &Ray) -> Paired {
        Paired::new(ray, [Pair::new(self.center.x, self.center.y), Pair::new(self.center.z, 0.0)])
    }

    /// Entrance and exit as `f64` finds them.
    #[inline(always)]
    fn rough(&self, ray: &Ray) -> Rough {
        rough(self.radius, self.square, ray.origin - self.center, ray.direction)
    }

    /// The same where doubt may have come from the range of the exponents. Powers of two change no digit, so this
    /// finds what `f64` without limits would have found.
    #[cold]
    fn rescaled(&self, ray: &Ray) -> Rough {
        let unit = exponent(self.radius);
        let Some(scaled) = ScaledRay::new(ray, self.center, unit) else { return Rough::Miss };
        let radius = self.radius * exp2i(-unit);
        match rough(radius, radius * radius, scaled.relative.high(), scaled.direction) {
            Rough::Span(span) => Rough::Span(span.map(|c| c.unscale(scaled.power))),
            other => other,
        }
    }

    /// The crossing of this root in double-double.
    #[cold]
    fn exact(&self, ray: &Ray, within: Interval, root: u32) -> Option<Hit> {
        let (scaled, chord) = self.scaled(ray)?;
        if !(chord.depth.high > 0.0) {
            return None;
        }
        admit(within, scaled.unscale(chord.shift + chord.at[(root & 1) as usize]), 0, root)
    }

    /// The crossing of this root, if it lies in the interval.
    #[inline(always)]
    fn crossing(&self, rough: &Rough, ray: &Ray, within: Interval, root: u32) -> Option<Hit> {
        match rough {
            Rough::Miss => None,
            Rough::Doubt => self.exact(ray, within, root),
            Rough::Span(span) => span[(root & 1) as usize].decide(within, || self.exact(ray, within, root)),
        }
    }

    /// The exit of a ray from the inside that the discriminant does not tell.
    #[cold]
    #[inline(never)]
    fn exit_in_doubt(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        if let Rough::Span([_, leave]) = self.rough(ray) {
            return admit_exit(within, leave.t, 0, 1);
        }
        if !ray.is_valid() {
            return None;
        }
        let (scaled, chord) = self.scaled(ray)?;
        admit_exit(within, scaled.unscale(chord.shift + chord.at[1]).high, 0, 1)
    }

    /// [`Primitive::hit`] for lines that nearly touch, and where a crossing is behind the interval or beside its end.
    #[inline(never)]
    fn hit_closely(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.rough(ray) {
            Rough::Miss => None,
            Rough::Doubt => self.hit_in_doubt(ray, within),
            clear => self.crossing(&clear, ray, within, 0).or_else(|| self.crossing(&clear, ray, within, 1)),
        }
    }

    /// The same where `f64` leaves a doubt.
    #[cold]
    #[inline(never)]
    fn hit_in_doubt(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let rough = self.rescaled(ray);
        self.crossing(&rough, ray, within, 0).or_else(|| self.crossing(&rough, ray, within, 1))
    }
}

/// A line about its closest approach to the centre of a sphere, in `f64`.
///
/// With `t0 = -w.d / |d|^2` and `l = w + t0 d`, the crossings are at `t0 -+ sqrt(D / |d|^2)`, `D = r^2 - |l|^2`.
///
/// With u = 2^-53, `t0` errs by less than `9 u |w| / |d|`, which moves `l` along the line: that matters in its square only.
/// Across the line `l` errs by the roundings of `w`, of the product and of the sum, each less than u |w| in a
/// coordinate: by less than 5.2 u |w|. Hence `D`, where its sign could be in doubt at all (|l| about r or below the
/// error), by less than `10.4 u r |w| + 4 u r^2 + 200 u^2 |w|^2`, less than `16 u S r + 512 u^2 S^2` for S = |w| + 2 r, with the
/// sum of the sizes of the coordinates for |w|. Where `D` is more than `CLEAR` = 2^14 times that, the parameters err by less
/// than 2^-15 of half the chord from the root, and by less still from `t0`: 2^-13 of half the chord is a margin.
struct Approach {
    /// `t0`.
    middle: f64,
    /// `D`.
    depth: f64,
    /// `1 / |d|^2`.
    inverse: f64,
    /// The bound on the error of `D`: NaN or infinite where a number may have left the range of the exponents.
    doubt: f64,
}

impl Approach {
    /// `near`: the square of the radius, or NaN, so that nothing is certain.
    #[inline(always)]
    fn new(radius: f64, near: f64, w: DVec3, d: DVec3) -> Approach {
        let square = d.dot(d);
        let inverse = 1.0 / square;
        let middle = -(w.dot(d) * inverse);
        let l = w + d * middle;
        let far = w.x.abs() + w.y.abs() + w.z.abs() + 2.0 * radius;
        // Where `w.d` overflows, so does the square of `far`.
        let doubt = if moderate(square) { far * (radius * exp2i(-49) + far * exp2i(-97)) } else { f64::NAN };
        Approach { middle, depth: near - l.dot(l), inverse, doubt }
    }

    #[inline(always)]
    fn misses(&self) -> bool {
        self.depth < -self.doubt
    }

    /// Where the line is inside, if that is certain.
    #[inline(always)]
    fn chord(&self) -> Option<Span> {
        (self.depth > CLEAR * self.doubt).then(|| {
            let half = sqrt(self.depth * self.inverse);
            Span { enter: self.middle - half, leave: self.middle + half, margin: half * exp2i(-13) }
        })
    }
}

/// Where a line is inside a sphere: both ends are known within `margin`.
#[derive(Clone, Copy, Debug)]
struct Span {
    enter: f64,
    leave: f64,
    margin: f64,
}

impl Span {
    /// The first crossing in the interval, or that there is none; `None` where that is not certain.
    #[inline(always)]
    fn first(&self, within: Interval) -> Option<Option<Hit>> {
        let Span { enter, leave, margin } = *self;
        let inside = |t: f64| t - within.min > margin && within.max - t > margin;
        let beyond = |t: f64| t - within.max > margin;
        if inside(enter) {
            Some(Some(Hit::inside(enter, 0, 0)))
        } else if within.min - enter > margin && inside(leave) {
            Some(Some(Hit::inside(leave, 0, 1)))
        } else if within.min - leave > margin
            || beyond(enter)
            || (within.min - enter > margin && beyond(leave))
        {
            Some(None)
        } else {
            None
        }
    }

    fn candidates(&self) -> [Candidate; 2] {
        let Span { enter, leave, margin } = *self;
        [(enter, 0), (leave, 1)].map(|(t, root)| Candidate { t, margin, part: 0, root })
    }
}

/// What the discriminant tells of a line and a sphere about zero.
enum Line {
    Miss,
    Chord(Span),
    Doubt,
}

/// The sign of the discriminant `D = (w.d)^2 - |d|^2 (|w|^2 - r^2)`, where that is certain, and the crossings.
///
/// With `T = |d|^2 (|w|^2 + r^2)` and u = 2^-53, D errs by less than 14 u T (3 u of `|d|^2`, 3 u of `|w|^2`, 2 u of each
/// coordinate of `w`, 8 u of the square, three operations): 2^-35 T is more than 2^14 times that.
///
/// Half the chord, h, errs by the error of D over `2 |d|^2 h`: 7 u (|w|^2 + r^2) / h. From up to six radii that is
/// less than 33 u S over the cosine `h / r`, for S = |w| + 2 r. From farther away D is taken as `r^2 |d|^2 - |w x d|^2`
/// (Lagrange's identity), which errs by less than 2 u T where the line crosses or nearly does (see [`passes_outside`](crate::scaled::passes_outside);
/// r < |w| / 6), and by less than `(5.8 r |w| + 10 r^2) u |d|^2`: h by 3 u S over the cosine. `w.d / |d|^2` errs by less
/// than 9 u |w| / |d|, which is less than 2^-32 of half the chord.
#[inline(always)]
fn line(near: f64, ray: &Paired) -> Line {
    let squares = ray.squares();
    let (far, square, along) = (squares.low(), squares.high(), ray.along());
    let depth = if far > 36.0 * near {
        rarely();
        let (x_y, z) = ray.moment();
        let x_y = x_y * x_y;
        near * square - (z * z + x_y.low() + x_y.high())
    } else {
        along * along - square * (far - near)
    };
    // NaN with `near`: then both comparisons are false.
    let safe = exp2i(-35) * (square * (far + near));
    // With the guard of the radius this keeps all products in the range of the exponents but those of a huge `w`, and
    // those make T or the roots infinite or NaN.
    if moderate(square) {
        if depth > safe {
            let inverse = 1.0 / square;
            let (middle, half) = (along * inverse, sqrt(depth) * inverse);
            return Line::Chord(Span {
                enter: -middle - half,
                leave: half - middle,
                margin: half * exp2i(-13),
            });
        }
        if depth < -safe {
            return Line::Miss;
        }
    }
    Line::Doubt
}

/// A line and a sphere about zero in `f64`: certain, or in doubt.
fn rough(radius: f64, near: f64, w: DVec3, d: DVec3) -> Rough {
    match line(near, &Paired::of(w, d)) {
        Line::Miss => return Rough::Miss,
        Line::Chord(chord) => return Rough::Span(chord.candidates()),
        Line::Doubt => {}
    }
    let line = Approach::new(radius, near, w, d);
    match line.chord() {
        Some(chord) => Rough::Span(chord.candidates()),
        None if line.misses() => Rough::Miss,
        None => Rough::Doubt,
    }
}

/// A line and a sphere about zero in double-double: `start + (t - shift) * direction`.
struct Chord {
    shift: Double,
    start: DoubleVector,
    /// The square of half the chord times the direction's squared length: positive where the line crosses.
    depth: Double,
    /// The crossings, after `shift`.
    at: [Double; 2],
}

struct FindChord<'a> {
    ray: &'a ScaledRay,
    radius: f64,
}

impl Task for FindChord<'_> {
    type Output = Chord;
    #[inline(always)]
    fn run<P: Product>(self) -> Chord {
        let d = self.ray.direction;
        let square = d.dot(d);
        let far = self.ray.relative;
        let step = -(far.high().dot(d) / square);
        let mut shift = Double::from(step);
        let mut start = far + DoubleVector::product::<P>(d, step);
        // The first step errs by a few u of the distance: from beyond 2^30 a second one brings the rest down.
        if largest(far.high()) > exp2i(30) {
            let step = -(start.high().dot(d) / square);
            shift = shift + step;
            start = start + DoubleVector::product::<P>(d, step);
        }
        let a = DoubleVector::from(d).dot_f64::<P>(d);
        let b = start.dot_f64::<P>(d);
        let c = Double::product::<P>(self.radius, self.radius) - start.length_squared::<P>();
        let depth = b.square::<P>() + a.mul::<P>(c);
        let half = depth.sqrt::<P>();
        Chord { shift, start, depth, at: [(-b - half).div::<P>(a), (half - b).div::<P>(a)] }
    }
}

/// What double-double arithmetic finds out about a hit, in the scale of the ray.
struct Refined {
    t: Double,
    local: DoubleVector,
    /// How far the true crossing can be from `local`.
    error: f64,
}

/// A Newton step on `|p|^2 = r^2`.
struct Step<R> {
    /// The place before the step.
    place: DoubleVector<R>,
    /// The step.
    change: R,
    /// The parameter after it.
    t: Double<R>,
    /// Where the chord is long enough, and the place on the right half of it, one bit for each lane.
    sound: u32,
    /// Where no other step is needed.
    small: u32,
}

impl<R: Real> Step<R> {
    /// From the parameter `t`; `side` is -1 where the line enters and 1 where it leaves. See [`newton`].
    #[inline(always)]
    fn new<P: Product>(relative: &DoubleVector<R>, d: Vector<R>, radius: R, t: Double<R>, side: R) -> Self {
        let square = d.dot(d);
        let far = relative.leading().largest() + radius;
        let place = relative.advanced::<P>(d, t);
        // Half the derivative; its length is half the chord times the direction's square.
        let slope = side * place.leading().dot(d);
        let least = radius.all(exp2i(-60)) * (far * far) * square;
        let change = -side * (place.excess::<P>(radius) / (radius.all(2.0) * slope));
        Step {
            place,
            change,
            t: Double::sum(t.high, t.low + change),
            sound: least.less(slope * slope) & radius.all(0.0).at_most(slope),
            small: (change.abs() * square).at_most(radius.all(exp2i(-36)) * slope),
        }
    }
}

/// By how many radii a place that [`newton`] finds can be off.
const OFF: f64 = exp2i(-71);

/// One or two Newton steps on `|p|^2 = r^2` from the hit's parameter; `None` where they may not be enough.
///
/// With S the distance that the ray comes from and the radius, the place `p` is known to 2^-104 S and its residual,
/// itself within 2^-102 of r^2, to 2^-102 r S in all, which moves the crossing by 2^-103 r S over half the chord, h: by
/// less than 2^-73 r while h is above 2^-30 S. A step of size s, from the side of the root, leaves `s^2 / (2 h)`: less than
/// 2^-73 h for `s <= 2^-36 h`.
#[inline(always)]
fn newton<P: Product>(relative: &DoubleVector, d: DVec3, radius: f64, t: f64, root: u32) -> Option<Refined> {
    let mut t = Double::from(t);
    for _ in 0..2 {
        let step = Step::new::<P>(relative, d.into(), radius, t, side_of(root));
        if step.sound == 0 {
            return None;
        }
        t = step.t;
        if step.small != 0 {
            return Some(Refined { t, local: step.place.nudged(d, step.change), error: OFF * radius });
        }
    }
    None
}

/// -1 for the root where a line enters, 1 for that where it leaves.
#[inline(always)]
fn side_of(root: u32) -> f64 {
    if root & 1 == 0 { -1.0 } else { 1.0 }
}

struct FindSurface<'a> {
    sphere: &'a Sphere,
    ray: &'a Ray,
    hit: Hit,
}

impl Task for FindSurface<'_> {
    type Output = Surface;
    #[inline(always)]
    fn run<P: Product>(self) -> Surface {
        let FindSurface { sphere, ray, hit } = self;
        let relative = DoubleVector::difference(ray.origin, sphere.center);
        // False for a NaN in `square`: a radius near the ends of the range.
        if sphere.square > 0.0
            && largest(relative.high()) < exp2i(30) * sphere.radius
            && is_plain(ray.direction)
            && let Some(found) = newton::<P>(&relative, ray.direction, sphere.radius, hit.t(), hit.root())
        {
            return sphere.record(found.t.high, found.local, found.error);
        }
        sphere.surface_carefully(ray, hit)
    }
}

struct FindRescaled<'a> {
    ray: &'a ScaledRay,
    radius: f64,
    hit: Hit,
}

impl Task for FindRescaled<'_> {
    type Output = Refined;
    #[inline(always)]
    fn run<P: Product>(self) -> Refined {
        let FindRescaled { ray, radius, hit } = self;
        let far = largest(ray.relative.high());
        if far < exp2i(30) * radius {
            let t = times_power(hit.t(), -ray.power);
            if let Some(found) = newton::<P>(&ray.relative, ray.direction, radius, t, hit.root()) {
                return found;
            }
        }
        // From the roots in double-double.
        let chord = FindChord { ray, radius }.run::<P>();
        let s = chord.at[(hit.root() & 1) as usize];
        let mut local = chord.start + DoubleVector::from(ray.direction).mul::<P>(s);
        if chord.depth.high <= 0.0 {
            // The rounded ray misses: take the place on the surface that is next to its closest approach.
            let length = local.length_squared::<P>().sqrt::<P>();
            local = local.mul::<P>(Double::from(radius).div::<P>(length));
        }
        let half = sqrt(chord.depth.high.max(0.0));
        Refined { t: chord.shift + s, local, error: uncertainty(half) }
    }
}

impl Primitive for Sphere {
    #[inline(always)]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match line(self.square, &self.paired(ray)) {
            Line::Miss => return None,
            Line::Chord(chord) => {
                if let Some(hit) = chord.first(within) {
                    return hit;
                }
            }
            Line::Doubt => {}
        }
        self.hit_closely(ray, within)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        let rough = match self.rough(ray) {
            Rough::Doubt => self.rescaled(ray),
            clear => clear,
        };
        for root in 0..2 {
            if let Some(hit) = self.crossing(&rough, ray, within, root) {
                each(hit);
            }
        }
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        kernel::run(FindSurface { sphere: self, ray, hit })
    }

    fn bounds(&self) -> Option<Aabb> {
        // Two steps: one for the rounding of the sum, one for that of a point beside it.
        // The point itself is promised within an ulp of the radius, also where the centre and the radius cancel.
        let r = DVec3::splat(self.radius * (1.0 + exp2i(-52)));
        Some(Aabb { min: (self.center - r).map(down), max: (self.center + r).map(up) })
    }

    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        if from.side == Side::Outside {
            return None;
        }
        // Not the exact root: the surface record refines it, as it does that of any hit.
        if let Line::Chord(chord) = line(self.square, &self.paired(ray)) {
            return admit_exit(within, chord.leave, 0, 1);
        }
        self.exit_in_doubt(ray, within)
    }

    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        if let Some(exit) = self.hit_leaving(ray, within, from) {
            each(exit);
        }
    }
}

impl SurfaceEach for Sphere {
    #[inline(always)]
    fn surface_each<L: Lanes>(
        lanes: L,
        spheres: [&Self; 4],
        rays: [&Ray; 4],
        hits: [Hit; 4],
        surfaces: [&mut Surface; 4],
    ) {
        let radius = Four::new(lanes, spheres.map(|sphere| sphere.radius));
        let square = Four::new(lanes, spheres.map(|sphere| sphere.square));
        let center = Vector::new(lanes, spheres.map(|sphere| &sphere.center));
        let d = Vector::new(lanes, rays.map(|ray| &ray.direction));
        let relative = DoubleVector::difference(Vector::new(lanes, rays.map(|ray| &ray.origin)), center);
        let high = Four::new(lanes, hits.map(|hit| hit.t()));
        let side = Four::new(lanes, hits.map(|hit| side_of(hit.root())));
        // The lanes bring their own products.
        let step = Step::new::<Dekker>(&relative, d, radius, Double { high, low: high.all(0.0) }, side);
        let sound = step.sound
            & step.small
            & high.all(0.0).less(square)
            & relative.leading().largest().less(high.all(exp2i(30)) * radius)
            & plain_lanes(d);
        let local = step.place.nudged(d, step.change);
        let (point, local) = (local.plus(center), local.leading());
        let normal = local / radius;
        let error = radius_about(point, high.all(OFF) * radius).to_array();
        let (t, point) = (step.t.high.to_array(), point.to_array());
        let (local, normal) = (local.to_array(), normal.to_array());
        for (i, surface) in surfaces.into_iter().enumerate() {
            if sound >> i & 1 == 0 {
                *surface = spheres[i].surface(rays[i], hits[i]);
                continue;
            }
            surface.set(t[i], point[i], local[i], local[i], normal[i], Coordinates::Globe, error[i]);
        }
    }
}

/// Two numbers down.
fn down(x: f64) -> f64 {
    x.next_down().next_down()
}

/// Two numbers up.
fn up(x: f64) -> f64 {
    x.next_up().next_up()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first crossing in an interval, by where its ends lie: sure wherever the margin lets it be.
    #[test]
    fn the_first_of_two_crossings() {
        let span = Span { enter: 1.0, leave: 3.0, margin: 0.25 };
        let (first, second) = (Some(Some((1.0, 0))), Some(Some((3.0, 1))));
        for (min, max, expected) in [
            (0.0, 9.0, first),
            (0.0, 2.0, first),
            (2.0, 9.0, second),
            (2.0, 2.5, Some(None)),
            (-1.0, 0.5, Some(None)),
            (4.0, 5.0, Some(None)),
            // An end within the margin of a crossing that matters.
            (0.875, 9.0, None),
            (1.125, 9.0, None),
            (0.0, 1.125, None),
            (0.0, 0.875, None),
            (2.0, 2.875, None),
            (2.0, 3.125, None),
            (3.125, 9.0, None),
            // Or of one that does not.
            (0.0, 3.0, first),
        ] {
            let found = span.first(Interval::new(min, max)).map(|hit| hit.map(|hit| (hit.t(), hit.root())));
            assert_eq!(found, expected, "{min} {max}");
        }
    }

    use crate::testing::Random;

    /// A sphere about zero, its slack, and a ray from some sizes away that passes it by this share of the radius.
    fn passing(random: &mut Random, depth: f64, distance: f64) -> (Sphere, Ray) {
        let sphere = Sphere::new(DVec3::ZERO, random.uniform(0.5, 2.0)).unwrap();
        let along = random.direction();
        let across = along.cross(random.direction()).normalize();
        let target = across * (sphere.radius * (1.0 - depth));
        (sphere, Ray::new(target - along * (distance * sphere.radius), along * random.magnitude(-2.0, 2.0)))
    }

    /// Whatever plain numbers decide of a line next to the edge is true, and they decide all but the nearest.
    #[test]
    fn what_is_decided_plainly_is_true() {
        let mut random = Random::new(1);
        let mut count = [[0; 3]; 3];
        for case in 0..40_000 {
            let depth = random.sign() * random.magnitude(-17.5, -8.0);
            let distance = if case % 2 == 0 { random.uniform(-1.5, 1.5) } else { random.magnitude(0.0, 5.0) };
            let (sphere, ray) = passing(&mut random, depth, distance);
            let (w, d) = (ray.origin, ray.direction);
            let (scaled, chord) = sphere.scaled(&ray).unwrap();
            let crosses = chord.depth.high > 0.0;
            let exact = chord.at.map(|at| scaled.unscale(chord.shift + at).high);
            // How clear it is, in roundings of the sizes.
            let clear = depth.abs() / (distance.abs() + 2.0);
            let check = |at: [f64; 2], margin: f64| {
                assert!(crosses, "{sphere:?} {ray:?}");
                for (at, exact) in at.iter().zip(exact) {
                    assert!((at - exact).abs() <= margin, "{sphere:?} {ray:?}: {at} {exact} {margin:e}");
                }
                let half = 0.5 * (exact[1] - exact[0]);
                assert!(margin <= exp2i(-12) * half, "{margin} {half}");
            };
            let decided = match line(sphere.square, &Paired::of(w, d)) {
                Line::Chord(span) => {
                    check([span.enter, span.leave], span.margin);
                    true
                }
                Line::Miss => {
                    assert!(!crosses, "{sphere:?} {ray:?}");
                    true
                }
                Line::Doubt => false,
            };
            count[0][usize::from(decided)] += 1;
            // The square of the distance counts there, which is why lines from afar are not decided so early.
            assert!(decided || clear / (distance.abs() + 2.0) < exp2i(-33), "{clear:e} {distance}");
            let approach = Approach::new(sphere.radius, sphere.square, w, d);
            let decided = match approach.chord() {
                Some(span) => {
                    check([span.enter, span.leave], span.margin);
                    true
                }
                None if approach.misses() => {
                    assert!(!crosses, "{sphere:?} {ray:?}");
                    true
                }
                None => false,
            };
            count[1][usize::from(decided)] += 1;
            assert!(
                decided || clear < if depth > 0.0 { exp2i(-33) } else { exp2i(-47) },
                "{clear:e} {depth:e}"
            );
            let outside = crate::scaled::passes_outside(sphere.radius, exp2i(-50) * sphere.radius, w, d);
            assert!(!outside || !crosses, "{sphere:?} {ray:?}");
            count[2][usize::from(outside)] += 1;
            assert!(outside || depth > 0.0 || clear < exp2i(-46), "{clear:e} {depth:e}");
        }
        assert!(count.iter().all(|count| count[0].min(count[1]) > 3000), "{count:?}");
    }

    struct First(DoubleVector, DVec3, f64, f64, u32);

    impl Task for First {
        type Output = Option<Refined>;
        fn run<P: Product>(self) -> Self::Output {
            newton::<P>(&self.0, self.1, self.2, self.3, self.4)
        }
    }

    /// Newton's steps answer where the chord is longer than 2^-30 of the distance, as the closed form does; and not where it is
    /// shorter, nor for a hit on the wrong side.
    #[test]
    fn newton_answers_until_the_chord_is_short() {
        let mut random = Random::new(2);
        let mut count = [0; 2];
        for case in 0..4000 {
            let depth = random.magnitude(-19.0, -0.5);
            let distance = if case % 2 == 0 { random.uniform(0.0, 3.0) } else { random.magnitude(0.0, 4.0) };
            let (sphere, ray) = passing(&mut random, depth, distance);
            let (scaled, chord) = sphere.scaled(&ray).unwrap();
            if chord.depth.high <= 0.0 {
                continue;
            }
            let size = largest(ray.origin) + sphere.radius;
            for root in 0..2 {
                let at = scaled.unscale(chord.shift + chord.at[root]);
                let relative = DoubleVector::from(ray.origin);
                let find = |root| kernel::run(First(relative, ray.direction, sphere.radius, at.high, root));
                let found = find(root as u32);
                if let Some(found) = &found {
                    let off = (found.t - at).high.abs() * ray.direction.length();
                    assert!(off <= exp2i(-70) * sphere.radius, "{sphere:?} {ray:?} {off:e}");
                    assert!(
                        found.error >= exp2i(-72) * sphere.radius && found.error < exp2i(-60) * sphere.radius
                    );
                }
                let chord = (chord.at[1] - chord.at[0]).high * exp2i(scaled.power) * ray.direction.length();
                if chord > exp2i(-28) * size {
                    count[0] += 1;
                    assert!(found.is_some(), "{sphere:?} {ray:?} {chord:e}");
                    assert!(find(1 - root as u32).is_none());
                } else if chord < exp2i(-31) * size {
                    count[1] += 1;
                    assert!(found.is_none(), "{sphere:?} {ray:?} {chord:e}");
                }
            }
        }
        assert!(count[0] > 3000 && count[1] > 100, "{count:?}");
    }
}
