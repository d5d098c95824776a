//! Rays in a shape's own scale: exact powers of two that keep every product in range.

use crate::Error;
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{Four, Lanes, Real, Vector};
use crate::math::{exp2i, exponent};
use crate::{Hit, Interval, Ray};
use glam::DVec3;

/// `x * 2^k`, rounded once unless the result is subnormal, for any `|k| <= 3000`.
#[inline]
pub(crate) fn times_power(x: f64, k: i32) -> f64 {
    let k = k.clamp(-3000, 3000);
    if k.abs() <= 1000 {
        return x * exp2i(k);
    }
    let step = if k > 0 { 1000 } else { -1000 };
    times_power(x * exp2i(step), k - step)
}

/// A ray relative to a shape's anchor, in units of a power of two: `relative + t * direction`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScaledRay {
    /// The origin minus the anchor, exactly, in units of `2^exponent` of the shape.
    pub relative: DoubleVector,
    /// The direction, its largest component in `[1, 2)`.
    pub direction: DVec3,
    /// `t` in the units of the given ray is `2^power` times the `t` here.
    pub power: i32,
}

impl ScaledRay {
    /// `None` for a ray that is not valid, or that starts more than 2^900 units away: no `f64` ray aims that well.
    ///
    /// `unit` is the exponent of the shape's size, in `-600..=600`.
    #[inline(always)]
    pub fn new(ray: &Ray, anchor: DVec3, unit: i32) -> Option<ScaledRay> {
        let mut direction = ray.direction;
        let mut shift = exponent(largest(direction));
        if shift < -1000 {
            // Subnormal components: first into the range where the exponent can be read.
            direction *= exp2i(200);
            shift = exponent(largest(direction));
            if shift == -1023 {
                return None;
            }
            direction *= exp2i(-shift);
            shift -= 200;
        } else if shift < 1024 {
            // In two steps, since 2^-1023 is not a normal number.
            let half = shift / 2;
            direction = direction * exp2i(-half) * exp2i(half - shift);
        } else {
            return None;
        }
        // Components below 2^-160 of the largest turn the ray by less than any margin that f64 can express; without
        // them all products stay in the range where they are exact.
        let negligible = exp2i(-160);
        let keep = |x: f64| if x.abs() < negligible { 0.0 } else { x };
        let direction = DVec3::new(keep(direction.x), keep(direction.y), keep(direction.z));
        let relative = DoubleVector::difference(ray.origin, anchor).scale_exact(exp2i(-unit));
        // False for NaN too.
        if !(largest(relative.high()) < exp2i(900)) || !relative.high().is_finite() {
            return None;
        }
        Some(ScaledRay { relative, direction, power: unit - shift })
    }

    /// A parameter here in the units of the given ray.
    #[inline(always)]
    pub fn unscale(&self, t: Double) -> Double {
        if self.power == 0 {
            return t;
        }
        Double { high: times_power(t.high, self.power), low: times_power(t.low, self.power) }
    }
}

/// Four rays as [`ScaledRay`] has them.
pub(crate) struct ScaledFour<L: Lanes> {
    pub relative: DoubleVector<Four<L>>,
    pub direction: Vector<Four<L>>,
    /// Two to the power of [`ScaledRay::power`].
    pub power: Four<L>,
    /// In which lanes that is so: not those of rays that are not valid, start far away, or have directions of extreme length.
    pub sound: u32,
}

impl<L: Lanes> ScaledFour<L> {
    #[inline(always)]
    pub fn new(lanes: L, rays: [&Ray; 4], anchor: DVec3, unit: i32) -> Self {
        let one = Four::new(lanes, [1.0; 4]);
        Self::about(lanes, rays, Vector::all(one, anchor), one.all(exp2i(-unit)))
    }

    /// The same with an anchor in each lane, and two to the power of minus the unit.
    #[inline(always)]
    pub fn about(lanes: L, rays: [&Ray; 4], anchor: Vector<Four<L>>, per_unit: Four<L>) -> Self {
        let [a, b, c, d] = rays;
        let direction = Vector::new(lanes, [&a.direction, &b.direction, &c.direction, &d.direction]);
        let one = direction.x.all(1.0);
        let binade = direction.largest().binade();
        // Powers of two: exact.
        let direction = direction * (one / binade);
        let (zero, negligible) = (one.all(0.0), one.all(exp2i(-160)));
        let direction = Vector {
            x: Four::if_less(direction.x.abs(), negligible, zero, direction.x),
            y: Four::if_less(direction.y.abs(), negligible, zero, direction.y),
            z: Four::if_less(direction.z.abs(), negligible, zero, direction.z),
        };
        let origin = Vector::new(lanes, [&a.origin, &b.origin, &c.origin, &d.origin]);
        let relative = DoubleVector::difference(origin, anchor).scale_exact(per_unit);
        // Zero times a number is zero, unless the number is infinite or NaN.
        let (o, d) = (relative.leading(), direction);
        let nothing = (o.x + o.y + o.z) * zero + (d.x + d.y + d.z) * zero;
        let sound = one.all(exp2i(-300)).less(binade)
            & binade.less(one.all(exp2i(300)))
            & o.largest().less(one.all(exp2i(900)))
            & nothing.less(one);
        ScaledFour { relative, direction, power: one / per_unit / binade, sound }
    }
}

/// The largest absolute value of the components.
#[inline(always)]
pub(crate) fn largest(v: DVec3) -> f64 {
    // `>`, which is one instruction, where `>=` is two.
    let v = v.abs();
    let m = if v.x > v.y { v.x } else { v.y };
    if m > v.z { m } else { v.z }
}

/// Lengths and coordinates up to this are accepted: the promised 1e150 and a margin.
const LARGEST: f64 = exp2i(520);
/// Positive lengths down to this are accepted: the promised 1e-150 and a margin.
const SMALLEST: f64 = exp2i(-520);

/// Checks a length that must be positive, finite and in range.
pub(crate) fn checked_length(what: &'static str, value: f64) -> Result<f64, Error> {
    if !(value > 0.0 && value.is_finite()) {
        return Err(Error::NotPositive { what, value });
    }
    if !(SMALLEST..=LARGEST).contains(&value) {
        return Err(Error::OutOfRange { what, value });
    }
    Ok(value)
}

/// Checks a point: finite and in range.
pub(crate) fn checked_point(what: &'static str, value: DVec3) -> Result<DVec3, Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite { what, value });
    }
    if largest(value) > LARGEST {
        return Err(Error::OutOfRange { what, value: largest(value) });
    }
    Ok(value)
}

/// The crossing at the exact parameter `t`, if that lies inside the interval and rounds to a number inside it: the first
/// follows from the second, since the ends are numbers themselves.
#[inline(always)]
pub(crate) fn admit(within: Interval, t: Double, part: u32, root: u32) -> Option<Hit> {
    within.admit(t.high, part, root)
}

/// The exit of a ray that starts on the shape and runs inside: a crossing at or before the start is the start's
/// own rounding and counts as the next number after the start.
#[inline]
pub(crate) fn admit_exit(within: Interval, t: f64, part: u32, root: u32) -> Option<Hit> {
    let t = if t > 0.0 { t } else { 0.0 };
    within.admit(if t > within.min { t } else { within.min.next_up() }, part, root)
}

/// The error radius of a point that was rounded once from a place known to `along`.
///
/// The rounding errs by at most u = 2^-53 of each coordinate, hence u `|point|` in all (and 2^-1074 where that
/// is subnormal).
#[inline(always)]
pub(crate) fn error_radius(point: DVec3, along: f64) -> f64 {
    radius_about(point.into(), along)
}

/// [`error_radius`], for any lanes.
#[inline(always)]
pub(crate) fn radius_about<R: Real>(point: Vector<R>, along: R) -> R {
    // sqrt(3) < 1.75, and an ulp of slack.
    point.largest() * along.all(1.75 * exp2i(-53)) + along.all(f64::from_bits(4)) + along
}

/// How far a place found from a discriminant in double-double can be from the true one, in units of the shape's
/// size.
///
/// It errs by the error of the discriminant, at most 2^-99, over twice its root `half`; where the discriminant
/// itself is below its error, by the root of that.
#[inline(always)]
pub(crate) fn uncertainty(half: f64) -> f64 {
    let along = exp2i(-100) / half;
    if along < exp2i(-49) { along } else { exp2i(-49) }
}

/// Whether a direction needs no scaling: its square is moderate, and no component is one of those that
/// [`ScaledRay::new`] leaves out.
#[inline(always)]
pub(crate) fn is_plain(d: DVec3) -> bool {
    let least = largest(d) * exp2i(-160);
    let kept = |x: f64| (x.abs() >= least) | (x == 0.0);
    moderate(d.dot(d)) & kept(d.x) & kept(d.y) & kept(d.z)
}

/// [`is_plain`], for the directions in the lanes: one bit for each.
#[inline(always)]
pub(crate) fn plain_lanes<R: Real>(d: Vector<R>) -> u32 {
    let (zero, least, square) = (d.x.all(0.0), d.largest() * d.x.all(exp2i(-160)), d.dot(d));
    let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
    let moderate = zero.all(exp2i(-400)).at_most(square) & square.less(zero.all(exp2i(400)));
    let kept_x = least.at_most(x) | x.at_most(zero);
    let kept_y = least.at_most(y) | y.at_most(zero);
    let kept_z = least.at_most(z) | z.at_most(zero);
    moderate & kept_x & kept_y & kept_z
}

/// The discriminant must exceed this many times the bound of its error before a crossing found in `f64` is taken.
///
/// Any number well above 1 makes the decision certain. A parameter is then wrong by at most 2^-15 of half the chord,
/// and a ray that grazes a sphere at a depth of 2^-33 radii from a few sizes away is still clear.
pub(crate) const CLEAR: f64 = exp2i(14);

/// A crossing found in `f64`: its parameter is wrong by less than `margin`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub t: f64,
    pub margin: f64,
    pub part: u32,
    pub root: u32,
}

impl Candidate {
    /// The hit, or `None`, where that is certain; otherwise `exact` decides.
    #[inline(always)]
    pub fn decide(&self, within: Interval, exact: impl FnOnce() -> Option<Hit>) -> Option<Hit> {
        self.certainly(within).unwrap_or_else(exact)
    }

    /// The hit, or none, where that is certain.
    #[inline(always)]
    pub fn certainly(&self, within: Interval) -> Option<Option<Hit>> {
        let Candidate { t, margin, .. } = *self;
        if t - within.min > margin && within.max - t > margin {
            Some(Some(Hit::inside(t, self.part, self.root)))
        } else if within.min - t > margin || t - within.max > margin || t == within.min || t == within.max {
            // An end with these very bits is where this crossing was reported before: it is not reported twice.
            Some(None)
        } else {
            None
        }
    }

    /// The same crossing in a unit of the parameter that is `2^-power` times as large.
    pub fn unscale(self, power: i32) -> Candidate {
        Candidate { t: times_power(self.t, power), margin: times_power(self.margin, power), ..self }
    }
}

/// What `f64` arithmetic can say about a line and a convex shape.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Rough {
    /// No crossing, certainly.
    Miss,
    /// These two crossings, certainly.
    Span([Candidate; 2]),
    /// It takes more digits to tell.
    Doubt,
}

/// Whether a line certainly passes outside a sphere about zero: in plain `f64`, without scaling.
///
/// The distance of the line from zero is `|w x d| / |d|`. With u = 2^-53, `w x d` errs by less than
/// `2.9 u |w| |d| + u |w x d|`, the rounding of `w` included; hence its square, where it could be in doubt whether that exceeds
/// `r^2 |d|^2`, by less than `(5.8 u r |w| + 11 u r^2 + 9 u^2 |w|^2) |d|^2`, less than `(8 u S r + 128 u^2 S^2) |d|^2` for
/// S = |w| + 2 r, with the sum of the sizes of the coordinates for |w|. `doubt` is 8 u r = 2^-50 r, or NaN by
/// [`range_guard`].
#[inline(always)]
pub(crate) fn passes_outside(radius: f64, doubt: f64, w: DVec3, d: DVec3) -> bool {
    let square = d.dot(d);
    let moment = w.cross(d);
    let far = w.x.abs() + w.y.abs() + w.z.abs() + 2.0 * radius;
    let doubt = far * (doubt + far * exp2i(-99));
    moment.dot(moment) > (radius * radius + doubt) * square && moderate(square)
}

/// Whether a sum of squares is far from under- and overflow: in `2^-400..2^400`. False for NaN.
#[inline(always)]
pub(crate) fn moderate(square: f64) -> bool {
    // One comparison: the bits of positive numbers are ordered like the numbers.
    const LEAST: u64 = exp2i(-400).to_bits();
    square.to_bits().wrapping_sub(LEAST) < exp2i(400).to_bits() - LEAST
}

/// Zero, or NaN for a length whose square is near under- or overflow: added to a bound of errors, it leaves every
/// decision in doubt, until the ray is rescaled.
#[inline]
pub(crate) fn range_guard(length: f64) -> f64 {
    if length > exp2i(-200) && length < exp2i(200) { 0.0 } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ordinary directions need no scaling, those with components that count as zero or of extreme size do.
    #[test]
    fn which_directions_are_plain() {
        for (x, y, z, expected) in [
            (1.0, -0.5, 1e-3, true),
            (0.0, 1.0, -0.0, true),
            (3.0, 3e-48, 0.0, true),
            (1.0, exp2i(-160), 1.0, true),
            (1.0, exp2i(-161), 1.0, false),
            (-1e-49, 0.5, 0.0, false),
            (1e50, 1e40, 1e30, true),
            (1e61, 0.0, 0.0, false),
            (1e-61, 0.0, 0.0, false),
            (f64::NAN, 1.0, 1.0, false),
            (1.0, f64::INFINITY, 1.0, false),
        ] {
            assert_eq!(is_plain(DVec3::new(x, y, z)), expected, "{x} {y} {z}");
        }
    }

    /// Squares of what is let pass are far from the limits; the guard is open between its ends only.
    #[test]
    fn lengths_whose_squares_are_in_range() {
        let (least, most) = (exp2i(-200), exp2i(200));
        for (length, passes) in [
            (1.0, true),
            (least.next_up(), true),
            (most.next_down(), true),
            (least, false),
            (most, false),
            (0.0, false),
            (f64::INFINITY, false),
            (f64::NAN, false),
        ] {
            assert_eq!(range_guard(length) == 0.0, passes, "{length:e}");
            assert_eq!(range_guard(length).is_nan(), !passes, "{length:e}");
        }
        let (least, most) = (exp2i(-400), exp2i(400));
        for (square, in_range) in [
            (1.0, true),
            (least, true),
            (least.next_down(), false),
            (most, false),
            (most.next_down(), true),
            (-1.0, false),
        ] {
            assert_eq!(moderate(square), in_range, "{square:e}");
        }
    }

    /// An error radius holds one rounding of each coordinate, of the smallest numbers too, and what the place errs.
    #[test]
    fn an_error_radius_is_that_of_one_rounding() {
        let far = DVec3::new(-3.0, 1.0, 7.0);
        for scale in [1e-3, 1.0, 1e9] {
            let rounding = error_radius(far * scale, 0.0);
            let least = 3.0_f64.sqrt() * exp2i(-53) * largest(far * scale);
            assert!((least..1.02 * least).contains(&rounding), "{rounding:e} {least:e}");
            assert_eq!(error_radius(far * scale, 0.5), 0.5 + rounding);
        }
        assert!(error_radius(DVec3::ZERO, 0.0) < 1e-300);
        assert!(error_radius(DVec3::splat(1e-320), 0.0) >= f64::from_bits(3));
    }

    /// In another unit a crossing has its margin in that unit too.
    #[test]
    fn a_crossing_in_another_unit() {
        let candidate = Candidate { t: 3.0, margin: 0.25, part: 2, root: 1 };
        let Candidate { t, margin, part, root } = candidate.unscale(4);
        assert_eq!((t, margin, part, root), (48.0, 4.0, 2, 1));
        let Candidate { t, margin, .. } = candidate.unscale(-2);
        assert_eq!((t, margin), (0.75, 0.0625));
    }

    #[test]
    fn what_constructors_accept() {
        for (value, accepted) in [
            (LARGEST, true),
            (LARGEST.next_up(), false),
            (SMALLEST, true),
            (SMALLEST.next_down(), false),
            (0.0, false),
            (-1.0, false),
            (f64::NAN, false),
            (f64::INFINITY, false),
        ] {
            assert_eq!(checked_length("length", value).is_ok(), accepted, "{value}");
        }
        for (value, accepted) in [(LARGEST, true), (-LARGEST, true), (LARGEST.next_up(), false), (0.0, true)]
        {
            for axis in DVec3::AXES {
                assert_eq!(checked_point("point", axis * value).is_ok(), accepted, "{value} {axis}");
            }
        }
        assert!(checked_point("point", DVec3::new(0.0, f64::NAN, 0.0)).is_err());
    }

    /// The digits behind the rounded parameter decide at the very ends of an interval, unless the number is the end itself,
    /// which an open interval does not contain.
    #[test]
    fn exact_parameters_at_the_ends() {
        let within = Interval::new(1.0, 2.0);
        for (high, low, inside) in [
            (1.5, 0.0, true),
            (1.0, -1e-17, false),
            (1.0, 1e-17, false),
            (2.0, -1e-17, false),
            (2.0, 1e-17, false),
            (1.0_f64.next_up(), -1e-17, true),
            (2.0_f64.next_down(), 1e-17, true),
            (0.5, 0.0, false),
            (2.5, 0.0, false),
        ] {
            assert_eq!(admit(within, Double { high, low }, 0, 0).is_some(), inside, "{high} {low}");
        }
    }

    /// Half the chord may be lost in the error of its square, 2^-99: then a place errs by no more than the root of that.
    #[test]
    fn uncertain_places() {
        for k in 0..120 {
            let half = exp2i(-k);
            let (found, least) = (uncertainty(half), exp2i(-99) / (2.0 * half));
            let expected = least.min(exp2i(-49));
            assert!((expected..=2.0 * expected).contains(&found), "{k}");
        }
        assert_eq!(uncertainty(0.0), exp2i(-49));
        // A rounded point, and what it is known to: moved by one rounding of each coordinate it is within.
        for point in [DVec3::new(3.0, -1e-9, 7.5), DVec3::ZERO, DVec3::splat(1e-320), DVec3::splat(-2.5e60)] {
            for along in [0.0, 1e-20, 4.0] {
                let found = error_radius(point, along);
                let moved = point.map(|x| 0.5 * (x.next_up() - x)).length();
                assert!(
                    found >= moved + along
                        && found <= 4.0 * moved + along * (1.0 + 1e-15) + f64::from_bits(9)
                );
            }
        }
    }

    /// The exit of a ray from inside is in the interval, whatever rounding did to its place: after the start at least.
    #[test]
    fn exits_after_the_start() {
        let within = Interval::new(0.0, 9.0);
        for (t, expected) in
            [(2.5, Some(2.5)), (0.0, Some(f64::from_bits(1))), (-3.0, Some(f64::from_bits(1))), (9.5, None)]
        {
            assert_eq!(
                admit_exit(within, t, 1, 2).map(|hit| (hit.t(), hit.part(), hit.root())),
                expected.map(|t| (t, 1, 2))
            );
        }
        assert_eq!(admit_exit(within.after(1.0), 0.5, 0, 0).map(|hit| hit.t()), Some(1.0_f64.next_up()));
    }
}
