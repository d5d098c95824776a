//! The sphere `|p - center| = radius`.
//!
//! A ray is first moved to its closest approach to the centre, so that nothing is lost from afar, and the
//! discriminant is a difference of lengths there (Haines et al., "Precision Improvements for Ray/Sphere
//! Intersection", Ray Tracing Gems, 2019, chapter 7, doi:10.1007/978-1-4842-4427-2_7).

use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::frame::turns;
use crate::kernel::{self, Product, Task};
use crate::math::{exp2i, exponent, sqrt};
use crate::scaled::{
    CLEAR, Candidate, Rough, ScaledRay, admit, admit_exit, checked_length, checked_point, error_radius,
    largest, moderate, range_guard,
};
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Side, Similarity, Surface};
use glam::{DVec2, DVec3};

/// A sphere: its surface, hit from outside and from inside.
///
/// The only part is 0; root 0 is where the line enters, root 1 where it leaves. The normal points outward. `u` is
/// the angle about the y axis from x towards -z, in turns in `[0, 1)`; `v` is 0 at the south pole (-y) and 1 at the
/// north pole. The shape's own axes are the world's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
    /// 2^-50 of the radius, or NaN where squares would leave the range of the exponents.
    doubt: f64,
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
        Ok(Sphere { center, radius, doubt: radius * exp2i(-50) + range_guard(radius) })
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

    /// Entrance and exit as `f64` finds them.
    #[inline(always)]
    fn rough(&self, ray: &Ray) -> Rough {
        rough(self.radius, self.doubt, ray.origin - self.center, ray.direction)
    }

    /// The same where doubt may have come from the range of the exponents. Powers of two change no digit, so this
    /// finds what `f64` without limits would have found.
    #[cold]
    fn rescaled(&self, ray: &Ray) -> Rough {
        let unit = exponent(self.radius);
        let Some(scaled) = ScaledRay::new(ray, self.center, unit) else { return Rough::Miss };
        let radius = self.radius * exp2i(-unit);
        match rough(radius, radius * exp2i(-50), scaled.relative.high(), scaled.direction) {
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

    /// [`Primitive::hit`] where `f64` is in doubt.
    #[cold]
    fn hit_in_doubt(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let rough = self.rescaled(ray);
        self.crossing(&rough, ray, within, 0).or_else(|| self.crossing(&rough, ray, within, 1))
    }
}

/// A line and a sphere about zero in `f64`: certain, or in doubt.
///
/// The distance of the line from the centre is `|w x d| / |d|` (Lagrange's identity), so the crossings are at
/// `(-w.d -+ sqrt(D)) / |d|^2` with `D = r^2 |d|^2 - |w x d|^2`.
///
/// With u = 2^-53, `w x d` errs by less than `2.9 u |w| |d| + u |w x d|`, the rounding of `w` included; hence `D`, where
/// its sign could be in doubt at all (`|w x d|` about `r |d|` or below the error), by less than
/// `(5.8 u r |w| + 11 u r^2 + 9 u^2 |w|^2) |d|^2`, less than `(8 u S r + 128 u^2 S^2) |d|^2` for S = |w| + 2 r, with the
/// sum of the sizes of the coordinates for |w|. Where `D` is more than `CLEAR` = 2^20 times that, the parameters err
/// by less than 2^-21 of half the chord from the root, and `w.d / |d|^2`, which errs by `9 u |w| / |d|`, by less still:
/// 2^-19 of half the chord is a margin. `doubt` is 8 u r = 2^-50 r.
#[inline(always)]
fn rough(radius: f64, doubt: f64, w: DVec3, d: DVec3) -> Rough {
    let square = d.dot(d);
    let moment = w.cross(d);
    let depth = radius * radius * square - moment.dot(moment);
    let far = w.x.abs() + w.y.abs() + w.z.abs() + 2.0 * radius;
    let doubt = far * (doubt + far * exp2i(-99)) * square;
    if depth < -doubt && moderate(square) {
        return Rough::Miss;
    }
    if !(depth > CLEAR * doubt && moderate(square)) {
        return Rough::Doubt;
    }
    let inverse = 1.0 / square;
    let (middle, half) = (-(w.dot(d) * inverse), sqrt(depth) * inverse);
    let margin = half * exp2i(-19);
    Rough::Span([
        Candidate { t: middle - half, margin, part: 0, root: 0 },
        Candidate { t: middle + half, margin, part: 0, root: 1 },
    ])
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

struct FindSurface<'a> {
    ray: &'a ScaledRay,
    radius: f64,
    root: usize,
}

/// What double-double arithmetic finds out about a hit, in the scale of the ray.
struct Refined {
    t: Double,
    local: DoubleVector,
    /// Half the chord, for the error radius.
    half: f64,
}

impl Task for FindSurface<'_> {
    type Output = Refined;
    #[inline(always)]
    fn run<P: Product>(self) -> Refined {
        let (ray, radius) = (self.ray, self.radius);
        let d = ray.direction;
        let square = d.dot(d);
        let step = -(ray.relative.high().dot(d) / square);
        let start = ray.relative + DoubleVector::product::<P>(d, step);
        let m = start.high();
        let b = m.dot(d);
        let depth = b * b + square * (radius * radius - m.dot(m));
        // A chord shorter than 2^-6 of the diameter, or a far ray, takes the longer way.
        if !(depth > exp2i(-12) * (radius * radius) * square && m.dot(m) < 4.0) {
            return self.carefully::<P>();
        }
        let half = sqrt(depth);
        let s = (if self.root & 1 == 0 { -half - b } else { half - b }) / square;
        // One Newton step on |p|^2 = r^2 from a point known to 106 bits. `s` errs by less than 2^-43 (u r^2 / half,
        // times 2^4 for the roundings), the step by the square of that over the chord, 2^-80.
        let p = start + DoubleVector::product::<P>(d, s);
        let excess = p.length_squared::<P>() - Double::product::<P>(radius, radius);
        let change = -(excess.high / (2.0 * p.high().dot(d)));
        let t = Double::sum(step, s) + change;
        Refined { t, local: p + DoubleVector::product::<P>(d, change), half }
    }
}

impl FindSurface<'_> {
    /// From the roots in double-double.
    #[inline(always)]
    fn carefully<P: Product>(self) -> Refined {
        let (ray, radius) = (self.ray, self.radius);
        let chord = FindChord { ray, radius }.run::<P>();
        let s = chord.at[self.root & 1];
        let mut local = chord.start + DoubleVector::from(ray.direction).mul::<P>(s);
        if chord.depth.high <= 0.0 {
            // The rounded ray misses: take the place on the surface that is next to its closest approach.
            let length = local.length_squared::<P>().sqrt::<P>();
            local = local.mul::<P>(Double::from(radius).div::<P>(length));
        }
        let half = sqrt(if chord.depth.high > 0.0 { chord.depth.high } else { 0.0 });
        Refined { t: chord.shift + s, local, half }
    }
}

impl Primitive for Sphere {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.rough(ray) {
            Rough::Miss => None,
            Rough::Doubt => self.hit_in_doubt(ray, within),
            clear => self.crossing(&clear, ray, within, 0).or_else(|| self.crossing(&clear, ray, within, 1)),
        }
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
        let unit = exponent(self.radius);
        let radius = self.radius * exp2i(-unit);
        let Some(scaled) = ScaledRay::new(ray, self.center, unit) else {
            return Surface::new(hit.t(), self.center, DVec3::ZERO, DVec3::Y, self.radius);
        };
        let found = kernel::run(FindSurface { ray: &scaled, radius, root: hit.root() as usize });
        let local = found.local.scale_exact(exp2i(unit));
        let point = local.plus_f64(self.center);
        let n = found.local.high() / radius;
        let v = 0.5 + libm::atan2(n.y, sqrt(n.x * n.x + n.z * n.z)) * core::f64::consts::FRAC_1_PI;
        Surface::new(
            scaled.unscale(found.t).high,
            point,
            local.high(),
            n,
            error_radius(point, self.radius, found.half),
        )
        .with_uv(DVec2::new(turns(n.x, -n.z), v))
    }

    fn bounds(&self) -> Option<Aabb> {
        // Two steps: one for the rounding of the sum, one for that of a point beside it.
        let r = DVec3::splat(self.radius);
        Some(Aabb { min: (self.center - r).map(down), max: (self.center + r).map(up) })
    }

    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        if from.side == Side::Outside || !ray.is_valid() {
            return None;
        }
        let (scaled, chord) = self.scaled(ray)?;
        admit_exit(within, scaled.unscale(chord.shift + chord.at[1]).high, 0, 1)
    }

    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        if let Some(exit) = self.hit_leaving(ray, within, from) {
            each(exit);
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
