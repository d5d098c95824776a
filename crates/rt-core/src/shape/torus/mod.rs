//! The torus: all points at distance `minor` from a circle of radius `major`.

mod approach;
mod frame;
mod isolate;
mod record;

use crate::double::Double;
use crate::kernel::{self, Product, Task};
use crate::math::{exp2i, exponent};
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use approach::{Approach, Vector};
use frame::Frame;
use glam::DVec3;
use isolate::Quartic;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    center: DVec3,
    major: f64,
    minor: f64,
    frame: [Vector; 3],
    /// The power of two of the larger radius; `unit` is two to its negative.
    scale: i32,
    unit: f64,
    major_scaled: f64,
    minor_scaled: f64,
    /// `R^2 + r^2` at the torus' scale.
    squares: Double,
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

    fn framed(center: DVec3, frame: [Vector; 3], major: f64, minor: f64) -> Result<Self, Error> {
        if !center.is_finite() {
            return Err(Error::NotFinite { what: "torus center", value: center });
        }
        for (what, value) in [("torus major radius", major), ("torus minor radius", minor)] {
            if !(value > 0.0 && value < f64::INFINITY) {
                return Err(Error::NotPositive { what, value });
            }
            if !(exp2i(-540)..exp2i(540)).contains(&value) {
                return Err(Error::OutOfRange { what, value });
            }
        }
        let scale = exponent(major.max(minor));
        let unit = exp2i(-scale);
        let (major_scaled, minor_scaled) = (major * unit, minor * unit);
        let squares = kernel::run(Squares { major: major_scaled, minor: minor_scaled });
        Ok(Torus { center, major, minor, frame, scale, unit, major_scaled, minor_scaled, squares })
    }

    /// The centre.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The axis, of length one as near as `f64` can say.
    pub fn axis(&self) -> DVec3 {
        self.own_axis(2)
    }

    /// The radius of the generating circle.
    pub fn major(&self) -> f64 {
        self.major
    }

    /// The radius of the tube.
    pub fn minor(&self) -> f64 {
        self.minor
    }

    fn own_axis(&self, i: usize) -> DVec3 {
        let [x, y, z] = self.frame[i];
        DVec3::new(x.high, y.high, z.high)
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
                axis: by.direction(self.own_axis(2)),
                hint: Some(by.direction(self.own_axis(0))),
            })
        };
        Torus::framed(by.point(self.center), frame, self.major * by.scale(), self.minor * by.scale())
    }
}

struct Squares {
    major: f64,
    minor: f64,
}

impl Task for Squares {
    type Output = Double;
    #[inline(always)]
    fn run<P: Product>(self) -> Double {
        Double::product::<P>(self.major, self.major) + Double::product::<P>(self.minor, self.minor)
    }
}

/// All crossings of the line, each through `each` until that says stop.
struct Walk<'a, F> {
    torus: &'a Torus,
    ray: &'a Ray,
    within: Interval,
    each: F,
}

impl<F: FnMut(Hit) -> bool> Task for Walk<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run<P: Product>(mut self) {
        let Some(line) = Approach::new::<P>(self.torus, self.ray) else { return };
        let crossings = Quartic::new::<P>(self.torus, &line).crossings::<P>();
        for (index, x) in crossings.as_slice().iter().enumerate() {
            if let Some(hit) = self.within.admit(line.t::<P>(*x), 0, index as u32)
                && !(self.each)(hit)
            {
                return;
            }
        }
    }
}

impl Primitive for Torus {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let mut first = None;
        kernel::run(Walk {
            torus: self,
            ray,
            within,
            each: |hit| {
                first = Some(hit);
                false
            },
        });
        first
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        kernel::run(Walk {
            torus: self,
            ray,
            within,
            each: |hit| {
                each(hit);
                true
            },
        });
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        kernel::run(record::Record { torus: self, ray, hit })
    }

    /// Along each coordinate axis the circle reaches `major` times the sine of the angle to the axis; the tube adds
    /// `minor`.
    fn bounds(&self) -> Option<Aabb> {
        // Each step below is off by at most half a unit of its result: reach by 3 (square root of a sum of two
        // squares), the sum by 1, the corner by half a unit of itself, and the point that `surface` reports by
        // another half. 8 units of the size and 2 of the corner cover all of it.
        const UNIT: f64 = f64::EPSILON;
        let [first, second] = [self.own_axis(0), self.own_axis(1)];
        let reach = |i: usize| {
            let (a, b) = (first.to_array()[i], second.to_array()[i]);
            (self.major * crate::math::sqrt(a * a + b * b) + self.minor)
                + 8.0 * UNIT * (self.major + self.minor)
        };
        let reach = DVec3::new(reach(0), reach(1), reach(2));
        let grown = reach + (self.center.abs() + reach) * (2.0 * UNIT);
        Some(Aabb::new(self.center - grown, self.center + grown))
    }
}
