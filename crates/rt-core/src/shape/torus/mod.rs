//! The torus: all points at distance `minor` from a circle of radius `major`.

mod exact;
mod extrema;
mod filter;
mod frame;
pub(crate) mod leaving;
mod line;
mod record;
pub(crate) mod together;

use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{self, Product, Task};
use crate::math::{exp2i, exponent, sqrt};
use crate::poly::Roots;
use crate::scaled::{
    ScaledRay, admit, checked_length, checked_point, largest, passes_outside, range_guard, times_power,
};
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use filter::{Filter, Ring, RoughLine, Verdict};
use frame::Frame;
use glam::DVec3;
use leaving::Leave;
use line::Line;
use record::{Direct, Near};

/// A torus of any tilt: a ring (`minor < major`), a horn (equal) or a spindle (`minor > major`, all of whose sheets
/// are hit).
///
/// In its own axes, with `rho` the distance from the axis: `(rho - major)^2 + z^2 = minor^2`, or for the inner sheet
/// of a spindle `(rho + major)^2 + z^2 = minor^2`. The normal points away from the nearest point of the generating
/// circle's centre line, on the inner sheet away from the farthest.
///
/// Texture coordinates: `u` is the angle about the axis from the first of the torus' own axes, `v` the angle about
/// the tube from its outermost circle towards the axis' head, both in turns: the point is
/// `((major + minor cos v) cos u, (major + minor cos v) sin u, minor sin v)` on all sheets. The own axes: the third
/// is the axis; the first is the coordinate axis most nearly perpendicular to it (the first of equals), made
/// perpendicular; the second completes a right-handed frame. For the axis `z` they are the world's.
// What every hit needs comes first, in few lines of the cache.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Torus {
    center: DVec3,
    /// At least `R + r` in the world's unit, and 2^-50 of it, or NaN where squares would leave the range of the exponents.
    outer: f64,
    doubt: f64,
    /// The power of two of the larger radius: what is called scaled and what follows is in units of two to it.
    scale: i32,
    /// `R + r`.
    reach: f64,
    minor_scaled: f64,
    /// The third of the own axes, rounded.
    axis: DVec3,
    /// `R^2 + r^2`.
    squares: Double,
    /// `2 R^2`.
    twice: Double,
    /// `(R - r)^2`, or NaN for a spindle, whose inner sheet is where others have their hole.
    hole: f64,
    /// `(R + r)^2`.
    rim: f64,
    major_scaled: f64,
    /// `R^2 - r^2`.
    difference: Double,
    /// The radii in the world's unit.
    major: f64,
    minor: f64,
    /// The own axes.
    frame: [DoubleVector; 3],
}

impl Torus {
    /// A torus about `center`, its circle of radius `major` perpendicular to `axis` (of any length but zero; it is
    /// normalised to double-double accuracy), its tube of radius `minor`.
    ///
    /// # Errors
    /// [`Error::NotFinite`] and [`Error::ZeroLength`] for centre and axis, [`Error::NotPositive`] for a radius that is
    /// not, [`Error::OutOfRange`] for one beyond 1e-150 to 1e150 by more than some powers of ten.
    pub fn new(
        center: impl Into<DVec3>,
        axis: impl Into<DVec3>,
        major: f64,
        minor: f64,
    ) -> Result<Self, Error> {
        let axis = axis.into();
        if !axis.is_finite() {
            return Err(Error::NotFinite { what: "torus axis", value: axis });
        }
        if axis == DVec3::ZERO {
            return Err(Error::ZeroLength { what: "torus axis", value: axis });
        }
        Torus::framed(center.into(), kernel::run(Frame { axis, hint: None }), major, minor)
    }

    fn framed(center: DVec3, frame: [DoubleVector; 3], major: f64, minor: f64) -> Result<Self, Error> {
        let center = checked_point("center", center)?;
        let major = checked_length("major", major)?;
        let minor = checked_length("minor", minor)?;
        let scale = exponent(major.max(minor));
        let (major_scaled, minor_scaled) = (major * exp2i(-scale), minor * exp2i(-scale));
        let (inner, reach) = (major_scaled - minor_scaled, major_scaled + minor_scaled);
        let outer = (major + minor).next_up();
        let (squares, difference, twice) = kernel::run(Squares { major: major_scaled, minor: minor_scaled });
        Ok(Torus {
            center,
            major,
            minor,
            frame,
            axis: frame[2].high(),
            outer,
            doubt: outer * exp2i(-50) + range_guard(outer),
            scale,
            major_scaled,
            minor_scaled,
            reach,
            hole: if inner > 0.0 { inner * inner } else { f64::NAN },
            rim: reach * reach,
            squares,
            difference,
            twice,
        })
    }

    /// The centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The axis, of length one as near as `f64` can say.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// The radius of the generating circle.
    pub fn major(&self) -> f64 {
        self.major
    }

    /// The radius of the tube.
    pub fn minor(&self) -> f64 {
        self.minor
    }

    // Not called: its answer would be written in other pieces than it is read in.
    #[inline(always)]
    fn scaled(&self, ray: &Ray) -> Option<ScaledRay> {
        ScaledRay::new(ray, self.center, self.scale)
    }

    /// The torus scaled, turned and moved, its own axes with it.
    ///
    /// # Errors
    /// As [`Torus::new`], when the result is not a legal torus.
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        let frame = if by.rotation() == glam::DMat3::IDENTITY {
            self.frame
        } else {
            kernel::run(Frame {
                axis: by.direction(self.axis),
                hint: Some(by.direction(self.frame[0].high())),
            })
        };
        Torus::framed(by.point(self.center), frame, self.major * by.scale(), self.minor * by.scale())
    }
}

/// `R^2 + r^2`, `R^2 - r^2` and `2 R^2`.
struct Squares {
    major: f64,
    minor: f64,
}

impl Task for Squares {
    type Output = (Double, Double, Double);

    #[inline(always)]
    fn run<P: Product>(self) -> (Double, Double, Double) {
        let square = Double::product::<P>(self.major, self.major);
        let sum = square + Double::product::<P>(self.minor, self.minor);
        // Both factors are exact: nothing is lost however alike the radii are.
        let difference =
            Double::difference(self.major, self.minor).mul::<P>(Double::sum(self.major, self.minor));
        (sum, difference, square.scale_exact(2.0))
    }
}

struct Approach<'a> {
    torus: &'a Torus,
    ray: &'a ScaledRay,
}

impl Task for Approach<'_> {
    type Output = Option<RoughLine>;

    #[inline(always)]
    fn run<P: Product>(self) -> Option<RoughLine> {
        let Approach { torus, ray } = self;
        let line = RoughLine::new::<P>(&Ring::of(torus), &ray.relative, ray.direction.into());
        line.map(|(line, _)| line)
    }
}

/// All crossings of the line in double-double, those inside the interval through `each` until that says stop.
struct Walk<'a, F> {
    torus: &'a Torus,
    ray: &'a ScaledRay,
    within: Interval,
    each: F,
}

impl<F: FnMut(Hit) -> bool> Task for Walk<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<P: Product>(mut self) {
        let line = Line::of::<P>(self.torus, self.ray);
        let crossings = exact::crossings::<P>(self.torus, &line);
        for (index, x) in crossings.as_slice().iter().enumerate() {
            let t = self.ray.unscale(line.parameter_at::<P>(*x));
            if let Some(hit) = admit(self.within, t, 0, index as u32)
                && !(self.each)(hit)
            {
                return;
            }
        }
    }
}

impl Torus {
    /// The first crossing inside the interval, by another way of solving the quartic: for comparisons.
    ///
    /// `solver` gets the coefficients in ascending powers of `x^4 + 2 P x^2 + 4 Q x + c`, `x` being the distance from
    /// the ray's closest approach to the centre in units of a power of two near the torus' size, and the interval
    /// in which to look; every function of [`poly::quartic`](mod@crate::poly::quartic) fits. The coefficients are
    /// rounded and what is returned is what the solver finds: nothing is certified.
    ///
    /// ```
    /// use rt_core::{Interval, Ray, poly::quartic, shape::Torus};
    /// let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0, 0.5)?;
    /// let ray = Ray::new([9.0, 0.5, 0.1], [-1.0, 0.0, 0.0]);
    /// let hit = torus.hit_with(&ray, Interval::FORWARD, quartic::ferrari).unwrap();
    /// assert!((hit.t() - 6.57).abs() < 0.01);
    /// # Ok::<(), rt_core::Error>(())
    /// ```
    pub fn hit_with(
        &self,
        ray: &Ray,
        within: Interval,
        solver: impl FnOnce([f64; 5], Interval) -> Roots<4>,
    ) -> Option<Hit> {
        let ray = self.scaled(ray)?;
        let line = kernel::run(Approach { torus: self, ray: &ray })?;
        let roots = solver(line.coefficients(self), Interval::LINE);
        let mut index = 0;
        for root in roots.iter() {
            let t = times_power(line.parameter_at(root.x), ray.power);
            if root.multiplicity % 2 == 1
                && let Some(hit) = within.admit(t, 0, index)
            {
                return Some(hit);
            }
            index += root.multiplicity;
        }
        None
    }

    /// [`Primitive::hit`] for a line near the torus.
    #[inline(never)]
    fn hit_inside(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let ray = self.scaled(ray)?;
        match kernel::run(Filter { torus: self, ray: &ray, within, all: false }) {
            Verdict::Certain(hits) => hits.iter().next(),
            Verdict::Doubt => self.first_exact(&ray, within),
        }
    }

    #[cold]
    fn first_exact(&self, ray: &ScaledRay, within: Interval) -> Option<Hit> {
        let mut first = None;
        let each = |hit| {
            first = Some(hit);
            false
        };
        kernel::run(Walk { torus: self, ray, within, each });
        first
    }
}

impl Primitive for Torus {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        if passes_outside(self.outer, self.doubt, ray.origin - self.center, ray.direction) {
            return None;
        }
        self.hit_inside(ray, within)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        let Some(ray) = self.scaled(ray) else { return };
        match kernel::run(Filter { torus: self, ray: &ray, within, all: true }) {
            Verdict::Certain(hits) => hits.iter().for_each(each),
            Verdict::Doubt => {
                let each = |hit| {
                    each(hit);
                    true
                };
                kernel::run(Walk { torus: self, ray: &ray, within, each });
            }
        }
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let Some(scaled) = self.scaled(ray) else {
            // No ray that hits comes here.
            let point = ray.at(hit.t());
            return Surface::new(hit.t(), point, point - self.center, self.axis, largest(point));
        };
        kernel::run(Direct(Near { torus: self, ray: &scaled, hit }))
    }

    /// Along each coordinate axis the circle reaches `major` times the sine of the angle to the axis; the tube adds
    /// `minor`.
    fn bounds(&self) -> Option<Aabb> {
        // Each step below is off by at most half a unit of its result: reach by 3 (square root of a sum of two
        // squares), the sum by 1, the corner by half a unit of itself, and the point that `surface` reports by
        // another half. 8 units of the size and 2 of the corner cover all of it.
        const UNIT: f64 = f64::EPSILON;
        let [first, second] = [self.frame[0].high(), self.frame[1].high()];
        let reach = |i: usize| {
            let (a, b) = (first.to_array()[i], second.to_array()[i]);
            (self.major * sqrt(a * a + b * b) + self.minor) + 8.0 * UNIT * (self.major + self.minor)
        };
        let reach = DVec3::new(reach(0), reach(1), reach(2));
        let grown = reach + (self.center.abs() + reach) * (2.0 * UNIT);
        Some(Aabb::new(self.center - grown, self.center + grown))
    }

    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        let ray = self.scaled(ray)?;
        if leaving::never_returns(self, &ray, from) {
            return None;
        }
        let mut first = None;
        let each = |hit| {
            first = Some(hit);
            false
        };
        kernel::run(Leave { torus: self, ray: &ray, within, from, first: true, each });
        first
    }

    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        let Some(ray) = self.scaled(ray) else { return };
        if leaving::never_returns(self, &ray, from) {
            return;
        }
        let each = |hit| {
            each(hit);
            true
        };
        kernel::run(Leave { torus: self, ray: &ray, within, from, first: false, each });
    }
}

#[cfg(test)]
mod tests;
