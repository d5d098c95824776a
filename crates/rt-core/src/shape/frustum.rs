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

use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::frame::{frame, turns};
use crate::kernel::{self, Product, Task};
use crate::math::{exp2i, exponent, sqrt};
use crate::scaled::{ScaledRay, admit, admit_exit, checked_length, checked_point, largest};
use crate::shape::sphere::error_radius;
use crate::{Aabb, Departure, Error, Hit, Interval, Ray, Side, Surface};
use glam::{DVec2, DVec3};

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
        let axis = along.mul::<P>(Double::ONE.div::<P>(length));
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
    /// `names`: of the radii, for the error; a radius may be zero where the caller checked that not both are.
    pub fn new(
        base: DVec3,
        radii: [f64; 2],
        top: DVec3,
        names: [&'static str; 2],
        closed: bool,
    ) -> Result<Self, Error> {
        let base = checked_point("base", base)?;
        let top = checked_point("top", top)?;
        for (name, radius) in names.into_iter().zip(radii) {
            if radius != 0.0 {
                checked_length(name, radius)?;
            }
        }
        if base == top {
            return Err(Error::Coincident { what: "base and top", value: base });
        }
        // Not below 2^-522, so that the scaled difference below is exact.
        checked_length("distance from base to top", largest(top - base))?;
        let [x, y, z, height, slope, radial, axial] = kernel::run(Measure { base, top, radii });
        let axis = DoubleVector { x, y, z };
        let (first, second) = frame(axis.high());
        let unit = exponent(largest(DVec3::new(height.high, radii[0], radii[1])));
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
        })
    }

    /// The ray about its closest approach, in double-double.
    fn line(&self, ray: &Ray) -> Option<(ScaledRay, Line)> {
        let scaled = ScaledRay::new(ray, self.base, self.unit)?;
        let line = kernel::run(FindLine { frustum: self, ray: &scaled });
        Some((scaled, line))
    }

    /// Calls `each` with the crossings within the interval in ascending order, until it returns true.
    pub fn exact(&self, ray: &Ray, within: Interval, mut each: impl FnMut(Hit) -> bool) {
        let Some((scaled, line)) = self.line(ray) else { return };
        for found in line.span(self.closed).into_iter().flatten() {
            let t = scaled.unscale(line.shift + found.at);
            if let Some(hit) = admit(within, t, found.part, found.root) {
                if each(hit) {
                    return;
                }
            }
        }
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

    /// See [`Primitive::surface`](crate::Primitive::surface).
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let Some(scaled) = ScaledRay::new(ray, self.base, self.unit) else {
            return Surface::new(hit.t(), self.base, DVec3::ZERO, self.axis.high(), 0.0);
        };
        let found = kernel::run(FindSurface { frustum: self, ray: &scaled, hit });
        let scale = exp2i(self.unit);
        let local = found.local.scale_exact(scale);
        let point = local.plus_f64(self.base);
        let at = found.local.high();
        let (x, y) = (at.dot(self.first), at.dot(self.second));
        let v = match hit.part() {
            BASE => 0.0,
            TOP => 1.0,
            _ => (found.z / self.height.high).clamp(0.0, 1.0),
        };
        Surface::new(
            scaled.unscale(found.t).high,
            point,
            local.high(),
            found.normal,
            error_radius(point, scale, found.half),
        )
        .with_uv(DVec2::new(turns(x, y), v))
        .with_object_point(DVec3::new(x, y, found.z) * scale)
    }

    /// A box around both rims and hence around all.
    pub fn bounds(&self) -> Aabb {
        let a = self.axis.high();
        // The reach of a circle of radius 1 along each coordinate axis is the sine of that axis' angle with `a`;
        // five roundings err by less than 6 u = 2^-50.4 of it, and the steps below cover the sums.
        let reach =
            DVec3::new(sqrt(a.y * a.y + a.z * a.z), sqrt(a.z * a.z + a.x * a.x), sqrt(a.x * a.x + a.y * a.y))
                * (1.0 + exp2i(-50));
        let disc = |center: DVec3, radius: f64| Aabb {
            min: (center - reach * radius).map(|x| x.next_down().next_down()),
            max: (center + reach * radius).map(|x| x.next_up().next_up()),
        };
        disc(self.base, self.base_radius).union(&disc(self.top, self.top_radius))
    }
}

/// A crossing, in the scale of the ray, after its shift.
#[derive(Clone, Copy)]
struct Crossing {
    at: Double,
    part: u32,
    root: u32,
}

/// A ray against the side and the planes of the caps: `start + (t - shift) * direction`.
struct Line {
    shift: Double,
    start: DoubleVector,
    /// The height at the start and its growth.
    z: Double,
    z_growth: Double,
    height: Double,
    /// The growth of the radius along the ray: its sign says on which nappe the ray ends.
    e1: Double,
    /// The leading coefficient: negative where the ray runs steeper than the side.
    a: Double,
    /// The discriminant: positive where the line crosses the double cone.
    depth: Double,
    /// Entrance and exit of the side.
    side: [Double; 2],
}

struct FindLine<'a> {
    frustum: &'a Frustum,
    ray: &'a ScaledRay,
}

const INFINITE: Double = Double::from(f64::INFINITY);

impl Task for FindLine<'_> {
    type Output = Line;
    #[inline(always)]
    fn run<P: Product>(self) -> Line {
        let f = self.frustum;
        let d = self.ray.direction;
        let far = self.ray.relative;
        let step = f.approach(far.high(), d);
        let mut shift = Double::from(step);
        let mut start = far + DoubleVector::product::<P>(d, step);
        // The first step errs by a few u of the distance: from beyond 2^30 a second one brings the rest down.
        if largest(far.high()) > exp2i(30) {
            let step = f.approach(start.high(), d);
            shift = shift + step;
            start = start + DoubleVector::product::<P>(d, step);
        }

        let z = f.axis.dot::<P>(start);
        let z_growth = f.axis.dot_f64::<P>(d);
        let across = DoubleVector::from(d) - f.axis.mul::<P>(z_growth);
        let away = start - f.axis.mul::<P>(z);
        let e0 = f.slope.mul::<P>(z) + f.base_radius * exp2i(-f.unit);
        let e1 = f.slope.mul::<P>(z_growth);
        let a = across.length_squared::<P>() - e1.square::<P>();
        let b = away.dot::<P>(across) - e0.mul::<P>(e1);
        let c = away.length_squared::<P>() - e0.square::<P>();
        let x = across.mul::<P>(e0) - away.mul::<P>(e1);
        let y = f.axis.dot::<P>(start.cross_f64::<P>(d));
        let depth = x.length_squared::<P>() - y.square::<P>();
        let root = depth.sqrt::<P>();
        // The larger root in size has no cancellation; the product of both is c / a.
        let side = if b.high > 0.0 {
            let q = -b - root;
            [quotient::<P>(q, a), c.div::<P>(q)]
        } else {
            let q = root - b;
            if q.high == 0.0 { [Double::ZERO; 2] } else { [c.div::<P>(q), quotient::<P>(q, a)] }
        };
        Line { shift, start, z, z_growth, height: f.height, e1, a, depth, side }
    }
}

/// `q / a`, infinite for zero `a`.
#[inline(always)]
fn quotient<P: Product>(q: Double, a: Double) -> Double {
    let rough = q.high / a.high;
    if rough.is_finite() { q.div::<P>(a) } else { Double::from(rough) }
}

impl Frustum {
    /// Roughly where a line passes closest to the axis between the caps. Any finite answer is allowed: it only
    /// decides how well conditioned the rest is.
    #[inline(always)]
    fn approach(&self, w: DVec3, d: DVec3) -> f64 {
        let a = self.axis.high();
        let (z, z_growth) = (a.dot(w), a.dot(d));
        let across = d - a * z_growth;
        let away = w - a * z;
        let mut t = -(away.dot(across) / across.dot(across));
        let (base, top) = (-(z / z_growth), (self.height.high - z) / z_growth);
        let (first, last) = if base < top { (base, top) } else { (top, base) };
        // NaN (no motion across, or along the axis) fails every comparison.
        if !(t > first) && first.is_finite() {
            t = first;
        }
        if t > last {
            t = last;
        }
        if t.is_finite() { t } else { 0.0 }
    }
}

impl Line {
    fn cap(&self, part: u32) -> Double {
        let rise = if part == TOP { self.height - self.z } else { -self.z };
        kernel::run(Quotient(rise, self.z_growth))
    }

    /// The entrance and exit between the planes of the caps; `None` where the line runs beside them.
    fn slab(&self) -> Option<[Crossing; 2]> {
        if self.z_growth.high == 0.0 {
            let between = self.z.high > 0.0 && self.z < self.height;
            let end = |at| Crossing { at, part: BASE, root: 0 };
            return if between { Some([end(-INFINITE), end(INFINITE)]) } else { None };
        }
        let base = Crossing { at: self.cap(BASE), part: BASE, root: 0 };
        let top = Crossing { at: self.cap(TOP), part: TOP, root: 0 };
        Some(if self.z_growth.high > 0.0 { [base, top] } else { [top, base] })
    }

    /// Entrance and exit of the nappe that has the frustum; `None` where the line misses the side.
    ///
    /// Where `a` is negative the line runs steeper than the side: on the wanted nappe it only enters when it runs
    /// towards larger radii, and only leaves when it runs towards smaller ones. Then it always crosses (the
    /// discriminant is at least zero: through the apex it is zero); else only where the discriminant is positive.
    fn nappe(&self) -> Option<[Crossing; 2]> {
        if !(self.depth.high > 0.0 || self.a.high < 0.0) {
            return None;
        }
        let steep = self.a.high < 0.0;
        let enter = if steep && self.e1.high < 0.0 { -INFINITE } else { self.side[0] };
        let leave = if steep && self.e1.high > 0.0 { INFINITE } else { self.side[1] };
        Some([Crossing { at: enter, part: SIDE, root: 0 }, Crossing { at: leave, part: SIDE, root: 1 }])
    }

    /// The crossings of the whole line, ascending.
    fn span(&self, closed: bool) -> [Option<Crossing>; 2] {
        let (Some([first, last]), Some([enter, leave])) = (self.slab(), self.nappe()) else {
            return [None; 2];
        };
        let from = if enter.at > first.at { enter } else { first };
        let to = if leave.at < last.at { leave } else { last };
        if !(from.at < to.at) {
            return [None; 2];
        }
        [from, to].map(|c| if closed || c.part == SIDE { Some(c) } else { None })
    }

    /// The exit of a line that is known to run inside from `part` on.
    fn exit(&self, closed: bool, part: u32) -> Option<Crossing> {
        let side = Crossing { at: self.side[1], part: SIDE, root: 1 };
        let leave = match self.nappe() {
            Some([_, leave]) => leave,
            // By rounding the line passes just outside: it leaves where it is.
            None => Crossing { at: -INFINITE, ..side },
        };
        let last = match self.slab() {
            Some([_, last]) => last,
            // Likewise, along a cap.
            None => Crossing { at: -INFINITE, part: if part == SIDE { BASE } else { part }, root: 0 },
        };
        let exit = if leave.at < last.at { leave } else { last };
        if closed || exit.part == SIDE { Some(exit) } else { None }
    }
}

struct Quotient(Double, Double);

impl Task for Quotient {
    type Output = Double;
    #[inline(always)]
    fn run<P: Product>(self) -> Double {
        quotient::<P>(self.0, self.1)
    }
}

struct FindSurface<'a> {
    frustum: &'a Frustum,
    ray: &'a ScaledRay,
    hit: Hit,
}

struct Refined {
    t: Double,
    local: DoubleVector,
    normal: DVec3,
    z: f64,
    half: f64,
}

impl Task for FindSurface<'_> {
    type Output = Refined;
    #[inline(always)]
    fn run<P: Product>(self) -> Refined {
        let FindSurface { frustum: f, ray, hit } = self;
        let line = FindLine { frustum: f, ray }.run::<P>();
        let at = match hit.part() {
            BASE => quotient::<P>(-line.z, line.z_growth),
            TOP => quotient::<P>(line.height - line.z, line.z_growth),
            _ => line.side[(hit.root() & 1) as usize],
        };
        // A hit of another ray, or one that rounding invented: the closest approach is the nearest to it.
        let at = if at.high.is_finite() { at } else { Double::ZERO };
        let mut local = line.start + DoubleVector::from(ray.direction).mul::<P>(at);
        let t = line.shift + at;
        if hit.part() == BASE || hit.part() == TOP {
            let axis = f.axis.high();
            let (normal, z) = if hit.part() == BASE { (-axis, 0.0) } else { (axis, f.height.high) };
            return Refined { t, local, normal, z, half: line.z_growth.high.abs() };
        }
        let z = f.axis.dot::<P>(local);
        let along = f.axis.mul::<P>(z);
        let away = local - along;
        let distance = away.length_squared::<P>().sqrt::<P>();
        let outward = if distance.high > 0.0 {
            away.mul::<P>(Double::ONE.div::<P>(distance))
        } else {
            // On the axis, at the apex: there is no direction away from it.
            DoubleVector::default()
        };
        if line.depth.high <= 0.0 && line.a.high >= 0.0 {
            // The rounded ray misses: take the place on the surface beside it.
            let radius = f.slope.mul::<P>(z) + f.base_radius * exp2i(-f.unit);
            local = along + outward.mul::<P>(radius);
        }
        let mut normal = (outward.mul::<P>(f.radial) + f.axis.mul::<P>(f.axial)).high();
        if distance.high <= 0.0 {
            normal = if f.axial.high < 0.0 { -f.axis.high() } else { f.axis.high() };
        }
        let half = if line.depth.high > 0.0 { sqrt(line.depth.high) } else { 0.0 };
        Refined { t, local, normal, z: z.high, half }
    }
}
