//! What cylinder and cone share: a surface of revolution whose radius is linear along its axis, in double-double.
//!
//! With `z` the height above the base along the unit axis `a` and `w`, `d` the ray's origin (relative to the base)
//! and direction, `p(s) = w + s d` is on the side where `|p - (a.p) a|^2 = R(z)^2`, `R(z) = R0 + k z`:
//!
//! ```text
//! A s^2 + 2 B s + C = 0,  A = |d'|^2 - e1^2,  B = w'.d' - e0 e1,  C = |w'|^2 - e0^2,  e0 = R(a.w),  e1 = k a.d
//! B^2 - A C = |e0 d' - e1 w'|^2 - (a . (d x w))^2          (' = the part perpendicular to the axis)
//! ```
//!
//! The right-hand side (Lagrange's identity) is a difference of two lengths squared, taken where the ray passes
//! closest to the axis between the caps: there all quantities are of the size of the shape, however far away the
//! ray starts. A root where the quadratic falls is an entrance, one where it rises an exit, whatever the sign of
//! `A`. The solid is convex: what the line has in common with it is what the spans between entrance and exit and
//! between the planes of the caps have in common, so that caps, rim and side can never disagree.

mod line;
mod rough;
mod surface;
#[cfg(test)]
mod tests;

use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::frame::frame;
use crate::kernel::{self, Product, Task};
use crate::math::{exp2i, exponent, sqrt};
use crate::scaled::{
    Candidate, ScaledRay, admit, admit_exit, checked_length, checked_point, largest, range_guard,
};
use crate::{Aabb, Departure, Error, Hit, Interval, Ray, Side};
use glam::DVec3;
use line::{FindLine, Line};
use rough::{Glance, Numbers, Rough, Span};

/// The part number of the side.
pub(super) const SIDE: u32 = 0;
/// The part number of the base cap.
pub(super) const BASE: u32 = 1;
/// The part number of the top cap.
pub(super) const TOP: u32 = 2;

/// A frustum of a cone, checked and with its constants in units of `2^unit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frustum {
    pub base: DVec3,
    pub top: DVec3,
    pub base_radius: f64,
    pub top_radius: f64,
    pub closed: bool,
    /// The exponent of the largest of height and radii.
    pub unit: i32,
    /// The unit vector from base to top.
    pub axis: DoubleVector,
    /// The height, scaled.
    pub height: Double,
    /// The growth of the radius per height.
    pub slope: Double,
    /// The outward normal of the side is `radial * (away from the axis) + axial * axis`.
    radial: Double,
    axial: Double,
    first: DVec3,
    second: DVec3,
    /// The same in `f64` and unscaled.
    numbers: Numbers,
}

struct Measure {
    base: DVec3,
    top: DVec3,
    radii: [f64; 2],
}

impl Task for Measure {
    type Output = [Double; 7];
    #[inline(always)]
    fn run<P: Product>(self) -> [Double; 7] {
        let along = DoubleVector::difference(self.top, self.base);
        // The difference by its own exponent: it may be far below the radii.
        let own = exponent(largest(along.high()));
        let along = along.scale_exact(exp2i(-own));
        let length = along.length_squared::<P>().sqrt::<P>();
        // Quotients, not products with a reciprocal: an axis along a coordinate axis stays exact.
        let axis = DoubleVector {
            x: along.x.div::<P>(length),
            y: along.y.div::<P>(length),
            z: along.z.div::<P>(length),
        };
        let growth = Double::difference(self.radii[1], self.radii[0]).scale_exact(exp2i(-own));
        let slope = growth.div::<P>(length);
        // The slope may be huge or tiny: divide by the larger of the two.
        let (radial, axial) = if slope.abs().high <= 1.0 {
            let c = Double::ONE.div::<P>((Double::ONE + slope.square::<P>()).sqrt::<P>());
            (c, -slope.mul::<P>(c))
        } else {
            let inverse = length.div::<P>(growth.abs());
            let c = Double::ONE.div::<P>((Double::ONE + inverse.square::<P>()).sqrt::<P>());
            (inverse.mul::<P>(c), if growth.high > 0.0 { -c } else { c })
        };
        [axis.x, axis.y, axis.z, length.scale_exact(exp2i(own)), slope, radial, axial]
    }
}

impl Frustum {
    /// Checks and measures.
    ///
    /// `names`: of the radii, for the error; the smaller radius, known to be zero or more, may be as small as it likes.
    pub fn new(
        base: DVec3,
        radii: [f64; 2],
        top: DVec3,
        names: [&'static str; 2],
        closed: bool,
    ) -> Result<Self, Error> {
        let base = checked_point("base", base)?;
        let top = checked_point("top", top)?;
        let larger = if radii[0] >= radii[1] { 0 } else { 1 };
        checked_length(names[larger], radii[larger])?;
        if base == top {
            return Err(Error::Coincident { what: "base and top", value: base });
        }
        // Not below 2^-522, so that the scaled difference below is exact.
        checked_length("distance from base to top", largest(top - base))?;
        let [x, y, z, height, slope, radial, axial] = kernel::run(Measure { base, top, radii });
        let axis = DoubleVector { x, y, z };
        let (first, second) = frame(axis.high());
        let unit = exponent(largest(DVec3::new(height.high, radii[0], radii[1])));
        let reach = if radii[0] > radii[1] { radii[0] } else { radii[1] };
        let numbers = Numbers {
            axis: axis.high(),
            height: height.high,
            base_radius: radii[0],
            slope: slope.high,
            reach,
            size: height.high + reach + range_guard(height.high) + range_guard(reach),
        };
        let height = height.scale_exact(exp2i(-unit));
        Ok(Frustum {
            base,
            top,
            base_radius: radii[0],
            top_radius: radii[1],
            closed,
            unit,
            axis,
            height,
            slope,
            radial,
            axial,
            first,
            second,
            numbers,
        })
    }

    /// The ray about its closest approach, in double-double.
    fn line(&self, ray: &Ray) -> Option<(ScaledRay, Line)> {
        let scaled = ScaledRay::new(ray, self.base, self.unit)?;
        let line = kernel::run(FindLine { frustum: self, ray: &scaled });
        Some((scaled, line))
    }

    /// The crossings of the line as `f64` finds them; `None` in doubt.
    #[inline(always)]
    fn rough<const SLOPED: bool>(&self, ray: &Ray) -> Option<Span> {
        match self.numbers.chord::<SLOPED>(ray.origin - self.base, ray.direction) {
            Rough::Miss => Some(Span::Miss),
            Rough::Doubt => None,
            Rough::Chord(chord) => chord.span(),
        }
    }

    /// The same where doubt may have come from the range of the exponents. Powers of two change no digit, so this
    /// finds what `f64` without limits would have found.
    #[cold]
    #[inline(never)]
    fn rescaled<const SLOPED: bool>(&self, ray: &Ray) -> Option<Span> {
        if self.numbers.in_range(ray.direction) {
            return None;
        }
        let Some(scaled) = ScaledRay::new(ray, self.base, self.unit) else { return Some(Span::Miss) };
        let numbers = self.numbers.scaled(exp2i(-self.unit), self.height.high);
        match numbers.chord::<SLOPED>(scaled.relative.high(), scaled.direction) {
            Rough::Miss => Some(Span::Miss),
            Rough::Doubt => None,
            Rough::Chord(chord) => match chord.span()? {
                Span::Miss => Some(Span::Miss),
                Span::Crossings(found) => Some(Span::Crossings(found.map(|c| c.unscale(scaled.power)))),
            },
        }
    }

    /// The crossings that lie in the interval, in double-double.
    #[cold]
    #[inline(never)]
    fn exact(&self, ray: &Ray, within: Interval) -> [Option<Hit>; 2] {
        let Some((scaled, line)) = self.line(ray) else { return [None; 2] };
        // Where the radius is larger than the height by more than double-double has digits, both crossings are roundings of the
        // one with the plane of the caps, and the order that they happen to have says nothing of how far out that is. No
        // point of the solid is farther from the axis than the larger radius; a place errs by 2^-49 of that in `f64`. Where
        // the height is the larger one, a place errs by that of the height, which says nothing, and the order is known.
        let radius = self.numbers.reach * exp2i(-self.unit) * (1.0 + exp2i(-30));
        let farthest = if self.numbers.reach > self.numbers.height { radius } else { f64::INFINITY };
        let axis = self.axis.high();
        line.span(self.closed).map(|found| {
            let found = found?;
            let place = line.start.high() + scaled.direction * found.at.high;
            if (place - axis * axis.dot(place)).length_squared() > farthest * farthest {
                return None;
            }
            admit(within, scaled.unscale(line.shift + found.at), found.part, found.root)
        })
    }

    /// The crossing of this index, 0 or 1, if it lies in the interval.
    #[inline(always)]
    fn crossing(&self, candidate: &Candidate, ray: &Ray, within: Interval, index: usize) -> Option<Hit> {
        if !self.closed && candidate.part != SIDE {
            return None;
        }
        candidate.decide(within, || self.exact(ray, within)[index & 1])
    }

    /// The crossings in the interval.
    #[inline(always)]
    fn both(&self, span: Option<Span>, ray: &Ray, within: Interval) -> [Option<Hit>; 2] {
        match span {
            None => self.exact(ray, within),
            Some(Span::Miss) => [None; 2],
            Some(Span::Crossings(found)) => {
                [0, 1].map(|index| self.crossing(&found[index], ray, within, index))
            }
        }
    }

    /// See [`Primitive::hit`](crate::Primitive::hit). `SLOPED`: the radii differ.
    #[inline(always)]
    pub fn hit<const SLOPED: bool>(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.numbers.glance::<SLOPED>(ray.origin - self.base, ray.direction) {
            Glance::Told(rough) => self.hit_of::<SLOPED>(rough, ray, within),
            Glance::AlongCylinder([enter, leave, margin, root]) => {
                self.hit_along_cylinder(ray, within, enter, leave, margin, root)
            }
            Glance::AlongAxis => self.hit_along_axis(ray, within),
            Glance::AlongSide([a, b, root, margin]) => self.hit_along_side(ray, within, a, b, root, margin),
        }
    }

    /// The same on a line close to the axis of a cylinder, which the way of others need not hold registers for; its numbers
    /// travel in registers.
    #[inline(never)]
    fn hit_along_cylinder(
        &self,
        ray: &Ray,
        within: Interval,
        enter: f64,
        leave: f64,
        margin: f64,
        root: f64,
    ) -> Option<Hit> {
        let numbers = [enter, leave, margin, root];
        let rough = self.numbers.along_cylinder(ray.origin - self.base, ray.direction, numbers);
        self.hit_of::<false>(rough, ray, within)
    }

    /// The same on a line close to the axis of a cone.
    #[inline(never)]
    fn hit_along_axis(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        self.hit_of::<true>(self.numbers.along_axis(ray.origin - self.base, ray.direction), ray, within)
    }

    /// The same on a line nearly parallel to the side of a cone.
    #[inline(never)]
    fn hit_along_side(
        &self,
        ray: &Ray,
        within: Interval,
        a: f64,
        b: f64,
        root: f64,
        margin: f64,
    ) -> Option<Hit> {
        let rough = self.numbers.along_side(ray.origin - self.base, ray.direction, [a, b, root, margin]);
        self.hit_of::<true>(rough, ray, within)
    }

    /// The first crossing of what `f64` says of a line.
    #[inline(always)]
    fn hit_of<const SLOPED: bool>(&self, rough: Rough, ray: &Ray, within: Interval) -> Option<Hit> {
        match rough {
            Rough::Miss => None,
            Rough::Doubt => self.hit_in_doubt::<SLOPED>(ray, within),
            Rough::Chord(chord) => match chord.hit(self.closed, within) {
                Some(hit) => hit,
                None => self.hit_closely::<SLOPED>(ray, within),
            },
        }
    }

    /// The same where a crossing is close to a rim or to an end of the interval.
    #[inline(never)]
    fn hit_closely<const SLOPED: bool>(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.rough::<SLOPED>(ray) {
            Some(Span::Miss) => None,
            Some(Span::Crossings([first, last])) => {
                self.crossing(&first, ray, within, 0).or_else(|| self.crossing(&last, ray, within, 1))
            }
            None => self.hit_in_doubt::<SLOPED>(ray, within),
        }
    }

    /// The same where `f64` is in doubt.
    #[cold]
    #[inline(never)]
    fn hit_in_doubt<const SLOPED: bool>(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let [first, last] = self.both(self.rescaled::<SLOPED>(ray), ray, within);
        first.or(last)
    }

    /// See [`Primitive::crossings`](crate::Primitive::crossings).
    pub fn crossings<const SLOPED: bool>(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        let span = self.rough::<SLOPED>(ray).or_else(|| self.rescaled::<SLOPED>(ray));
        self.both(span, ray, within).into_iter().flatten().for_each(each);
    }

    /// See [`Primitive::hit_leaving`](crate::Primitive::hit_leaving): the solid is convex, so there is nothing to
    /// hit outside, and inside there is the exit, which is known to exist.
    pub fn leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        if from.side == Side::Outside {
            return None;
        }
        let (scaled, line) = self.line(ray)?;
        let exit = line.exit(self.closed, from.part)?;
        admit_exit(within, scaled.unscale(line.shift + exit.at).high, exit.part, exit.root)
    }

    /// A box around both rims and hence around all.
    pub fn bounds(&self) -> Aabb {
        let a = self.axis.high();
        // The reach of a circle of radius 1 along each coordinate axis is the sine of that axis' angle with `a`;
        // five roundings err by less than 6 u = 2^-50.4 of it, and the steps below cover the sums.
        let reach =
            DVec3::new(sqrt(a.y * a.y + a.z * a.z), sqrt(a.z * a.z + a.x * a.x), sqrt(a.x * a.x + a.y * a.y))
                * (1.0 + exp2i(-50));
        // A point is promised within an ulp of the size, along each axis, however thin the solid is along it.
        let ulp = DVec3::splat((self.numbers.height + self.numbers.reach) * exp2i(-52));
        let disc = |center: DVec3, radius: f64| Aabb {
            min: (center - (reach * radius + ulp)).map(|x| x.next_down().next_down()),
            max: (center + (reach * radius + ulp)).map(|x| x.next_up().next_up()),
        };
        disc(self.base, self.base_radius).union(&disc(self.top, self.top_radius))
    }
}
