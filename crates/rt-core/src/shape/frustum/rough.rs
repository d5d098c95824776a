//! A line against a frustum in `f64`, with bounds of all errors: certain, or in doubt.
//!
//! With `z = a.w` and `g = a.d` the height and its growth along the unit axis `a`, `w'` and `d'` the parts of `w` and `d`
//! across it, and `n = a x d` (as long as `d'`), the crossings are the roots of `A t^2 + 2 B t + C`,
//!
//! ```text
//! A = |n|^2 - e1^2,  B = w'.d' - e0 e1,  D = B^2 - A C = |e0 d' - e1 w'|^2 - (n.w)^2,  e0 = R0 + k z,  e1 = k g,
//! ```
//!
//! `k` the slope of the radius. Lagrange's form of D grows with the distance of the origin, not with its square.
//!
//! Errors. Let u = 2^-53, K = |d| / |d'|, S = |w|, the height and the larger radius R together. `z`, `g`, `d'`, `w'`, `e0` and
//! `e1` err by less than 5 u |w|, 4 u |d|, 7 u |d|, 9 u |w| (4 u |w| across the axis), `(8 |k| + 1) u S` and 6 u |k| |d|; `n` by
//! `(2.9 K + 1) u |n|`, hence `|n|^2` by `(5.8 K + 5) u` of itself and `n.w` by `(2.9 K + 5) u |w| |n|`, at most 8 u |w| |d|
//! (taken as `n.w'`, by `(2.9 K + 8) u |w| |n|`).
//!
//! Outside the cylinder of radius R. With `E = u S (19 + 3 K^2) > (5.8 K + 16) u S`, `|n|^2 R^2 - (n.w)^2` errs by less than
//! `(R E + E^2 / 4) |n|^2`, as long as that decides anything: `2 R E |n|^2` for `E < 4 R`.
//!
//! Cylinders: that number is D, and B / A errs by `(14 K + 18) u |w| / |n|`, less than 2.1 E / |n| (`along_cylinder` mends
//! what that is for large K). Where D is more than 2^10 times its bound, `sqrt(D) / A` errs by 2^-12 of itself and `B / A`
//! by 2.1 2^-11 of that.
//!
//! Cones: the vector in D errs by `(10 + 34 |k|) u S |d|` with its own roundings. With V its length, at most
//! `(1 + 2 |k|) S |d|`, D errs by less than `Q (2 V + Q)`, `Q = 20 (1 + |k|)^2 u S |d|`, as long as that decides anything. B errs
//! by less than Q, A by less than `Q |d| / S` and, of `|n|^2 + e1^2`, by less than `15 K (1 + |k|) u`. Where D is more than
//! `2^11 V Q`, `sqrt(D)` is more than 2^11 Q, and errs by 2^-11 of itself: so do B and A t, as long as |t d| is at most S, which
//! it is between the caps.
//!
//! All this is below 2^-8 of half the chord, `sqrt(D) / |A|`: a margin; and below 2^-16 where D is 2^10 times as large
//! in comparison. Measured on rays that graze at depths of 1e-4 to 1e-12: a parameter is off by at most 5 u S over the
//! cosine between ray and normal on cylinders and cones, and by less than 2^-30 S.

use super::{BASE, SIDE, TOP};
use crate::kernel::Pair;
use crate::math::{exp2i, sqrt};
use crate::scaled::{Candidate, moderate};
use crate::shape::flat::U;
use crate::{Hit, Interval};
use glam::DVec3;

/// How many times the bound of its error a cylinder's discriminant must be before a crossing found in `f64` is taken.
const CLEAR: f64 = exp2i(10);
/// And how many times V Q that of a cone, squared.
const CLEAR_SQUARED: f64 = exp2i(22);
/// How many sizes away a line that is nearly parallel to the side may start for its crossings to be found from there. No bound
/// depends on it; from 2e7 radii away the quotients alone were seen to be 90 u of the distance off, over the cosine.
const NEAR: f64 = 64.0;
/// And how much steeper than 1 the sum of 1 and the slope of such a side may be.
const STEEP: f64 = 5.0;
/// What makes the margin small.
const CLEARER: f64 = exp2i(10);

/// The numbers of a frustum, rounded to `f64`, all in one unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbers {
    pub axis: DVec3,
    pub height: f64,
    pub base_radius: f64,
    pub slope: f64,
    /// The larger radius.
    pub reach: f64,
    /// At least height and larger radius together; NaN where their squares would leave the range of the exponents.
    pub size: f64,
}

/// What `f64` arithmetic can say about a line and a frustum.
pub(super) enum Rough {
    /// No crossing, certainly.
    Miss,
    /// Where the line is inside the side.
    Chord(Chord),
    /// It takes more digits to tell, or a wider range of the exponents.
    Doubt,
}

/// The same, where only some lines need more to be done.
pub(super) enum Glance {
    /// Nothing more.
    Told(Rough),
    /// The numbers for [`along_cylinder`](Numbers::along_cylinder).
    AlongCylinder([f64; 4]),
    /// [`along_axis`](Numbers::along_axis).
    AlongAxis,
    /// The numbers for [`along_side`](Numbers::along_side).
    AlongSide([f64; 4]),
}

/// Where a line is inside the side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    enter: f64,
    leave: f64,
    /// Each end errs by less.
    margins: [f64; 2],
    /// Whether there are such ends on the frustum's nappe; else the line begins or ends inside.
    starts: bool,
    ends: bool,
    /// The height at `t = 0`, and its growth.
    z: f64,
    z_growth: f64,
    /// Between the caps.
    height: f64,
    /// At least 16 u S.
    error: f64,
}

impl Numbers {
    /// The same frustum in another unit of length, in which its squares are in range; `height` is its height there.
    pub fn scaled(&self, power: f64, height: f64) -> Numbers {
        let reach = self.reach * power;
        Numbers { height, base_radius: self.base_radius * power, reach, size: height + reach, ..*self }
    }

    /// Whether nothing that [`chord`](Numbers::chord) computes leaves the range of the exponents, unless S is more than
    /// 2^53 R: then no crossing is certain in any unit.
    pub fn in_range(&self, d: DVec3) -> bool {
        let n = self.axis.cross(d);
        self.size > 0.0 && moderate(self.reach * self.reach * n.dot(n)) && moderate(d.dot(d))
    }

    /// Where a line is inside the side. `SLOPED` is false when both radii are the same: then the slope is not looked at.
    ///
    /// `w` is the origin minus the base; `d` the direction.
    #[inline(always)]
    pub fn chord<const SLOPED: bool>(&self, w: DVec3, d: DVec3) -> Rough {
        match self.glance::<SLOPED>(w, d) {
            Glance::Told(rough) => rough,
            Glance::AlongCylinder(numbers) => self.along_cylinder(w, d, numbers),
            Glance::AlongAxis => self.along_axis(w, d),
            Glance::AlongSide(numbers) => self.along_side(w, d, numbers),
        }
    }

    /// The same up to where lines close to the axis or to the side go their own ways.
    #[inline(always)]
    pub fn glance<const SLOPED: bool>(&self, w: DVec3, d: DVec3) -> Glance {
        let Numbers { axis, height, base_radius, slope, reach, size } = *self;
        let (z, z_growth) = (axis.dot(w), axis.dot(d));
        let n = axis.cross(d);
        let away = w - axis * z;
        // A cylinder is asked about lines close to its axis too, along which w may be long: n's own error must not grow
        // with it.
        let (square, moment) = (n.dot(n), n.dot(if SLOPED { w } else { away }));
        let far = w.x.abs() + w.y.abs() + w.z.abs() + size;
        let scale = reach * reach * square;
        let inside = scale - moment * moment;
        // R E |n|^2.
        let doubt = reach * far * (square * (22.0 * U) + z_growth * z_growth * (3.0 * U));
        // Then the squares of all discriminants are in range.
        if !moderate(scale) {
            return Glance::Told(Rough::Doubt);
        }
        if inside < -2.0 * doubt && doubt < 4.0 * scale {
            return Glance::Told(Rough::Miss);
        }
        let error = far * (16.0 * U);
        if !SLOPED {
            if !(inside > (2.0 * CLEAR) * doubt) {
                return Glance::Told(Rough::Doubt);
            }
            let inverse = 1.0 / square;
            let middle = -away.dot(d - axis * z_growth) * inverse;
            let half = sqrt(inside) * inverse;
            let clearer = inside > (2.0 * CLEAR * CLEARER) * doubt;
            let margin = half * if clearer { exp2i(-16) } else { exp2i(-8) };
            let (enter, leave) = (middle - half, middle + half);
            if z_growth * z_growth > 64.0 * square {
                return Glance::AlongCylinder([enter, leave, margin, sqrt(inside)]);
            }
            let margins = [margin; 2];
            let (starts, ends) = (true, true);
            let chord = Chord { enter, leave, margins, starts, ends, z, z_growth, height, error };
            return Glance::Told(Rough::Chord(chord));
        }
        if z_growth * z_growth > 8.0 * square {
            return Glance::AlongAxis;
        }
        let (e0, e1) = (base_radius + slope * z, slope * z_growth);
        let across = d - axis * z_growth;
        let vector = across * e0 - away * e1;
        let length = vector.dot(vector);
        let depth = length - moment * moment;
        let steep = 1.0 + slope.abs();
        let doubt = (steep * steep * (20.0 * U)) * far * (d.x.abs() + d.y.abs() + d.z.abs());
        // Squares instead of roots: D^2 against `(2^11 V Q)^2`.
        let (depths, doubts) = (depth * depth, doubt * doubt);
        let least = CLEAR_SQUARED * (doubts * length);
        if !(depth > 0.0 && depths > least) {
            // `(2 V + Q)^2 <= 8 V^2 + 2 Q^2`.
            let misses = depth < 0.0 && depths > doubts * (8.0 * length + 2.0 * doubts);
            return Glance::Told(if misses { Rough::Miss } else { Rough::Doubt });
        }
        let margin = if depths > (CLEARER * CLEARER) * least { exp2i(-16) } else { exp2i(-8) };
        let root = sqrt(depth);
        let b = away.dot(across) - e0 * e1;
        let (a, sum) = (square - e1 * e1, square + e1 * e1);
        if !(a.abs() > 0.25 * sum) {
            return if far < NEAR * size && steep < STEEP && a.abs() > exp2i(-14) * sum {
                Glance::AlongSide([a, b, root, margin])
            } else {
                Glance::AlongAxis
            };
        }
        let inverse = 1.0 / a;
        let (enter, leave) = (-(b + root) * inverse, (root - b) * inverse);
        let half = root * inverse.abs();
        let margin = half * margin;
        // On a line steeper than the side, one of the crossings is on the other nappe.
        let (starts, ends) = (a > 0.0 || e1 > 0.0, a > 0.0 || e1 < 0.0);
        let margins = [margin; 2];
        Glance::Told(Rough::Chord(Chord { enter, leave, margins, starts, ends, z, z_growth, height, error }))
    }
}

impl Numbers {
    /// [`chord`](Numbers::chord) for a cylinder and a line at less than 7 degrees from its axis, for which K > 8, of its parameters, their
    /// margin and `sqrt(D)`.
    ///
    /// B / A errs by the rounding of d', 3 u |d|, times `|w'| / |d'|^2`: in length along the ray by 3 u K^2 |w'|, which is 3 K
    /// times u S over the cosine, 1 / K, where the ray begins far from the axis: up to K = 8, 24 of the 64 that are promised. A step of Newton's method, whose slope is
    /// `-+2 sqrt(D)`, gives the digits of the place itself.
    #[inline(always)]
    pub fn along_cylinder(&self, w: DVec3, d: DVec3, [enter, leave, margin, root]: [f64; 4]) -> Rough {
        let half = 0.5 / root;
        let rest = |t: f64| {
            let p = w + d * t;
            let away = p - self.axis * self.axis.dot(p);
            (away.dot(away) - self.base_radius * self.base_radius) * half
        };
        let far = w.x.abs() + w.y.abs() + w.z.abs() + self.size;
        Rough::Chord(Chord {
            enter: enter + rest(enter),
            leave: leave - rest(leave),
            margins: [margin; 2],
            starts: true,
            ends: true,
            z: self.axis.dot(w),
            z_growth: self.axis.dot(d),
            height: self.height,
            error: far * (16.0 * U),
        })
    }

    /// [`chord`](Numbers::chord) for a cone and a line nearly parallel to its side, from not far away.
    ///
    /// The coefficients are small there, and their errors are not. One crossing is `q / A`, `q = -B -+ sqrt(D)`, the other `C / q`: q
    /// and C err by 2^-11 of sqrt(D) and of `sqrt(D) S / |d|`, or 2^-21 of both. With |k| below 4 and K below 3, hence |k|
    /// above 1/3, A errs by less than 6 Q |d| / S, which is 2^-38 of `|n|^2 + e1^2` and 2^-24 of A. So each parameter errs by
    /// 2^-10 or 2^-20 of itself and of S / |d|: four times the `margin` of half a chord is more.
    ///
    /// A step of Newton's method, whose slope is `-+2 sqrt(D)`, gives them the digits of the quadratic at the place itself.
    /// Measured: 6 u S over the cosine between ray and normal.
    #[inline(always)]
    pub fn along_side(&self, w: DVec3, d: DVec3, [a, b, root, margin]: [f64; 4]) -> Rough {
        let Numbers { axis, height, base_radius, slope, size, .. } = *self;
        let (z, z_growth) = (axis.dot(w), axis.dot(d));
        // The quadratic, in parts of its slope.
        let half = 0.5 / root;
        let rest = |p: DVec3| {
            let z = axis.dot(p);
            let (away, radius) = (p - axis * z, base_radius + slope * z);
            (away.dot(away) - radius * radius) * half
        };
        let q = if b > 0.0 { -(b + root) } else { root - b };
        let (large, small) = (q / a, 2.0 * rest(w) * root / q);
        let (enter, leave) = if b > 0.0 { (large, small) } else { (small, large) };
        let far = w.x.abs() + w.y.abs() + w.z.abs() + size;
        let reach = far / (d.x.abs() + d.y.abs() + d.z.abs());
        let e1 = slope * z_growth;
        Rough::Chord(Chord {
            enter: enter + rest(w + d * enter),
            leave: leave - rest(w + d * leave),
            margins: [enter, leave].map(|t| (4.0 * margin) * (reach + t.abs())),
            starts: a > 0.0 || e1 > 0.0,
            ends: a > 0.0 || e1 < 0.0,
            z,
            z_growth,
            height,
            error: far * (16.0 * U),
        })
    }

    /// [`chord`](Numbers::chord) for a cone and a line at less than 20 degrees from its axis or nearly parallel to its side,
    /// whose crossings would lose digits there: about the closest approach to the axis.
    ///
    /// That is at `t0 = -w'.d' / |d'|^2`, at a distance |m|, where the radius is `e0`. Since `m.d' = 0`, the crossings
    /// are at `t0 + (e0 e1 -+ sqrt(D)) / A`, `D = |d'|^2 (e0^2 - |m|^2) + e1^2 |m|^2`. `w'` and `d'` err by less than
    /// 10 u |w| and 8 u |d|, so at `t0`, at most |w| / |d'|, `m` errs by less than (14 + 8 K) u S across the ray's plane;
    /// the height at `t0` by less than (7 + 8 K) u S. All this is below `E = 32 u S K^2`. `e0` errs by less than
    /// `F = (1 + |k|) (E + 32 u |e0| K^2)`. With `q = |e0| + 2 R` an upper bound of `|e0| + |m|` (lines that pass farther away
    /// are gone), D errs by less than `4 (|d'|^2 + e1^2) (q + F) F`, including all roundings.
    ///
    /// Where D is more than 2^14 times that, `F < q / 2^16`, and the parameters err by less than 2^-15 from the root and
    /// twice 2^-16 from the rest, of half the chord: its 2^-13 is a margin. Where D is 2^20 times that, so is 2^-19.
    #[inline(always)]
    pub fn along_axis(&self, w: DVec3, d: DVec3) -> Rough {
        let Numbers { axis, height, base_radius, slope, reach, size } = *self;
        let (z, z_growth) = (axis.dot(w), axis.dot(d));
        let (across, away) = (d - axis * z_growth, w - axis * z);
        let square = across.dot(across);
        let inverse = 1.0 / square;
        let t0 = -(away.dot(across) * inverse);
        let m = away + across * t0;
        let mm = m.dot(m);
        let far = w.x.abs() + w.y.abs() + w.z.abs() + size;
        let spread = (1.0 + z_growth * z_growth * inverse) * (32.0 * U);
        let error = far * spread;
        let edge = reach + 2.0 * error;
        if mm > edge * edge {
            return Rough::Miss;
        }
        let (e0, e1) = (base_radius + slope * (z + t0 * z_growth), slope * z_growth);
        let size = square + e1 * e1;
        let errors = (1.0 + slope.abs()) * (error + e0.abs() * spread);
        let depth = square * (e0 * e0 - mm) + e1 * e1 * mm;
        let doubt = 4.0 * size * (e0.abs() + 2.0 * reach + errors) * errors;
        if depth < -doubt {
            return Rough::Miss;
        }
        let a = square - e1 * e1;
        // The sign of A errs with K u (1 + |k|) at most, far less than 2^-10; nearer to zero one root runs away and its
        // error grows.
        if !(depth > crate::scaled::CLEAR * doubt && a.abs() > exp2i(-10) * size) {
            return Rough::Doubt;
        }
        let root = sqrt(depth);
        let middle = e0 * e1;
        // The root that is larger in size first, the other from the product of both.
        let q = if middle > 0.0 { middle + root } else { middle - root };
        let r = 1.0 / (a * q);
        let (large, small) = (q * q * r, (mm - e0 * e0) * a * r);
        let (enter, leave) = if middle > 0.0 { (small, large) } else { (large, small) };
        let relative = if depth > exp2i(20) * doubt { exp2i(-19) } else { exp2i(-13) };
        Rough::Chord(Chord {
            enter: t0 + enter,
            leave: t0 + leave,
            margins: [root / a.abs() * relative; 2],
            starts: a > 0.0 || e1 > 0.0,
            ends: a > 0.0 || e1 < 0.0,
            z,
            z_growth,
            height,
            error: 4.0 * error,
        })
    }
}

/// Where a crossing of the side is.
#[derive(Clone, Copy, PartialEq)]
enum Zone {
    Below,
    Between,
    Above,
}

impl Chord {
    #[inline(always)]
    fn on_side(&self, t: f64, root: u32) -> Candidate {
        Candidate { t, margin: self.margins[root as usize & 1], part: SIDE, root }
    }

    #[inline(always)]
    fn crossing(&self, zone: Zone, t: f64, root: u32) -> Candidate {
        if zone == Zone::Between {
            return self.on_side(t, root);
        }
        let (height, part) = if zone == Zone::Below { (0.0, BASE) } else { (self.height, TOP) };
        let steepness = 1.0 / self.z_growth;
        // The crossing is inside the side, so |t d| is less than S: the difference of heights errs by 6 u S, `z_growth` by
        // 4 u |d|, the quotient by 3 u of itself, in all by less than 16 u S of height.
        Candidate { t: (height - self.z) * steepness, margin: self.error * steepness.abs(), part, root: 0 }
    }

    /// Where both crossings of the side are, if they have anything of the line between the caps; `None` where it takes more
    /// digits to tell.
    #[inline(always)]
    fn zones(&self) -> Option<Option<[Zone; 2]>> {
        // Over the middle between the caps: the height errs by 5 u S through z, 4 u S through its growth, and roundings.
        let half = 0.5 * self.height;
        let [first, last] = self.margins;
        let over =
            Pair::splat(self.z - half) + Pair::new(self.enter, self.leave) * Pair::splat(self.z_growth);
        let growth = self.z_growth.abs();
        let doubt = Pair::new(growth * first + self.error, growth * last + self.error);
        let size = over.abs();
        // Ends that are not on the frustum's nappe are beyond a cap.
        let real = i32::from(self.starts) | i32::from(self.ends) << 1;
        let between = doubt.below(Pair::splat(half) - size) & real;
        if between == 3 {
            return Some(Some([Zone::Between; 2]));
        }
        let out = doubt.below(size - Pair::splat(half)) | (3 & !real);
        if between | out != 3 {
            return None;
        }
        let below = [
            if self.starts { over.signs() & 1 != 0 } else { !(self.z_growth < 0.0) },
            if self.ends { over.signs() & 2 != 0 } else { !(self.z_growth > 0.0) },
        ];
        if between == 0 {
            if below[0] == below[1] {
                return Some(None);
            }
            // Both caps, each height in doubt by `error`: the nearer one as reported must not lie behind the farther one as it
            // is, lest an interval that ends there still holds that.
            if !(self.height > 2.0 * self.error) {
                return None;
            }
        }
        let zone = |end: usize| match between >> end & 1 {
            1 => Zone::Between,
            _ if below[end] => Zone::Below,
            _ => Zone::Above,
        };
        Some(Some([zone(0), zone(1)]))
    }

    /// The first crossing with the solid in the interval; `None` where it takes more digits to tell.
    #[inline(always)]
    pub fn hit(&self, closed: bool, within: Interval) -> Option<Option<Hit>> {
        let Some([first, last]) = self.zones()? else { return Some(None) };
        if first == Zone::Between || closed {
            let hit = self.crossing(first, self.enter, 0).certainly(within)?;
            if hit.is_some() {
                return Some(hit);
            }
        }
        if last == Zone::Between || closed {
            self.crossing(last, self.leave, 1).certainly(within)
        } else {
            Some(None)
        }
    }

    /// The crossings with the solid; `None` where it takes more digits to tell.
    #[inline(always)]
    pub fn span(&self) -> Option<Span> {
        Some(match self.zones()? {
            None => Span::Miss,
            Some([first, last]) => {
                Span::Crossings([self.crossing(first, self.enter, 0), self.crossing(last, self.leave, 1)])
            }
        })
    }
}

/// What a line has in common with the solid.
pub(super) enum Span {
    Miss,
    Crossings([Candidate; 2]),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::frustum::Frustum;
    use crate::testing::Random;
    use crate::{Interval, Ray};

    /// Lines nearly parallel to the side that graze it: told in `f64` from nearby, within the margins and as well as other
    /// lines.
    #[test]
    fn along_the_side() {
        let mut random = Random::new(1);
        let (mut told, mut worst) = ([0; 2], 0.0_f64);
        for case in 0..40_000 {
            let axis = random.direction();
            let h = random.uniform(0.3, 3.0);
            let r0 = h * random.uniform(0.4, 3.0);
            let r1 = r0 * random.uniform(0.0, 0.15);
            let base = random.in_cube();
            let Ok(f) = Frustum::new(base, [r0, r1], base + axis * h, ["", ""], true) else { continue };
            let slope = (r1 - r0) / h;
            let away = axis.cross(random.direction()).normalize();
            let z = random.uniform(0.05, 0.95);
            let point = base + axis * (h * z) + away * (r0 + (r1 - r0) * z);
            let normal = (away - axis * slope).normalize();
            let along = (axis + away * slope).normalize();
            let tilt = random.sign() * random.magnitude(-3.0, -0.3);
            let way = (along + normal.cross(along) * tilt).normalize() * random.uniform(0.5, 2.0);
            let depth = normal * (random.sign() * random.magnitude(-11.0, -1.0));
            let distance = if case % 2 == 0 { 3.0 } else { random.magnitude(-1.0, 2.0) };
            let ray = Ray::new(point + depth - way * distance, way);
            let span = f.rough::<true>(&ray);
            told[usize::from(span.is_some())] += 1;
            let Some(span) = span else { continue };
            let exact = f.exact(&ray, Interval::LINE);
            match span {
                Span::Miss => assert!(exact == [None; 2], "{f:?} {ray:?}"),
                Span::Crossings(found) => {
                    for (found, exact) in found.iter().zip(exact) {
                        let exact = exact.expect("a crossing");
                        assert_eq!(found.part, exact.part());
                        let error = (found.t - exact.t()).abs();
                        assert!(error <= found.margin, "{f:?} {ray:?} {error} {}", found.margin);
                        if found.part == SIDE {
                            let p = ray.at(exact.t()) - f.base;
                            let d = ray.direction;
                            let up = f.axis.high();
                            let n = (p - up * up.dot(p)).normalize() - up * slope;
                            let cosine = (n.normalize().dot(d) / d.length()).abs();
                            let s = (ray.origin - f.base).length() + h + r0;
                            worst = worst.max(error * d.length() * cosine / (U * s));
                        }
                    }
                }
            }
        }
        assert!(worst < 12.0 && told[0] < told[1], "{worst} {told:?}");
    }
}
