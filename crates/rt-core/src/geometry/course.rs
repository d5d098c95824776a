//! A ray made ready for the tree: on a short way where its numbers are moderate, else by [`Frame::enter`]. Which way it takes
//! decides time only.
//!
//! A single ray waits for all of this before its first node, so what counts is the longest chain of operations, which is the
//! division, a product, a rounding and the copy to all lanes. Hence bounds for all rays where those of each would be longer in coming,
//! comparisons of all axes at once, and directions as they are, not scaled.

use super::frame::{Frame, LocalRay, WINDOW};
use super::is_legal;
use crate::kernel::{Lanes, SlabRay, at_least, outward_step};
use crate::math::{exp2i, rarely};
use crate::scaled::largest;
use crate::{Interval, Ray};
use glam::DVec3;

/// Starts up to here along each axis, in kernel coordinates, are near: that is four to eight times as far as the scene reaches, as
/// cameras mostly are, and makes the step 19 roundings of `f32`, which is little beside a box. Only time depends on it.
const NEAR: f64 = 2.0;

/// Intervals may begin before the start, as far as the ray comes by this along any axis, in kernel coordinates: those of rays that go
/// on through a surface begin by its error radius before it. As large as the window of a ray from the centre, for little more step.
const BEFORE: f64 = WINDOW;

/// The step of boxes for all of them: see [`Frame::enter`] for the error, that of a parameter and of the start itself.
const STEP: f64 = outward_step(2.0 * (NEAR + 1.0) * WINDOW + BEFORE + exp2i(-48), NEAR);

/// Coordinates of directions up to this are moderate, and from one by this, or zero: their inverses, products and parameters are
/// then far from the limits of `f32`, and one of [`AXIAL`] stands for that of zero.
const MOST: f64 = exp2i(60);

/// The inverse of a coordinate that is zero: a ray comes at most `(NEAR + 2) / 2^-60` lengths to the far side of the scene, and by this
/// moves 2^-38 aside, less than the step has to spare.
const AXIAL: f64 = exp2i(100);

/// The largest coordinate of a unit vector is at least this power of two, and of one that is nearly so at most four times this.
const UNIT: f64 = 0.5;

/// What [`LocalRay::limit`] adds for the window, three times its absolute part, where a direction's largest coordinate is in [1, 2);
/// else it is divided by the power of two in that coordinate.
const SHIFT: f64 = 3.0 * (NEAR + 1.0) * WINDOW;

/// The largest exponent of a moderate frame: its scale is far from the limits of `f64`.
const MOST_EXPONENT: i32 = 800;

/// A frame whose numbers are moderate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moderate {
    /// As four numbers, the last zero.
    center: [f64; 4],
    /// From the world to kernel coordinates.
    scale: f64,
}

impl Moderate {
    /// The frame about this centre, scaled by two to the opposite of `exponent`.
    pub fn new(center: DVec3, exponent: i32) -> Option<Self> {
        (exponent.abs() <= MOST_EXPONENT)
            .then(|| Moderate { center: [center.x, center.y, center.z, 0.0], scale: exp2i(-exponent) })
    }

    /// The start of a ray, the last lane zero.
    #[inline(always)]
    fn origin<L: Lanes>(&self, lanes: L, ray: &Ray) -> L::D {
        let o = lanes.load4([ray.origin.x, ray.origin.y, ray.origin.z, 0.0]);
        lanes.mul4(lanes.sub4(o, lanes.load4(self.center)), lanes.splat4(self.scale))
    }
}

/// The direction of a ray, the last lane one.
#[inline(always)]
fn direction<L: Lanes>(lanes: L, ray: &Ray) -> L::D {
    lanes.load4([ray.direction.x, ray.direction.y, ray.direction.z, 1.0])
}

/// Inverses that are infinite, or next to it, by [`AXIAL`] instead: see also `kernel::boxes`.
#[inline(always)]
fn bounded<L: Lanes>(lanes: L, inverse: L::D) -> L::D {
    let most = lanes.splat4(AXIAL);
    lanes.max4(lanes.min4(inverse, most), lanes.neg4(most))
}

/// A ray ready for the tree.
#[derive(Clone, Copy)]
pub(super) struct Course<L: Lanes> {
    pub slab: SlabRay<L>,
    factor: f64,
    shift: f64,
}

impl<L: Lanes> Course<L> {
    #[inline(always)]
    fn of(lanes: L, ray: &LocalRay) -> Self {
        let LocalRay { origin, direction, inverse, .. } = *ray;
        let inverse = bounded(lanes, lanes.load4([inverse.x, inverse.y, inverse.z, 1.0]));
        let signs = lanes.load4([direction.x, direction.y, direction.z, 1.0]);
        let origin = lanes.load4([origin.x, origin.y, origin.z, 0.0]);
        Course {
            slab: SlabRay::new(lanes, origin, ray.step, signs, inverse),
            factor: ray.factor,
            shift: ray.shift,
        }
    }

    /// An upper bound of the parameter of whatever belongs to `t` or lies in the window of ties beyond: see [`LocalRay::limit`].
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f32 {
        at_least(t * self.factor + self.shift)
    }
}

/// A ray that is valid and asks about an interval that is not empty.
#[derive(Clone, Copy, Debug)]
pub(super) struct Legal {
    is_moderate: bool,
    /// Whether the largest coordinate of its direction is from [`UNIT`] to four times that.
    is_unit: bool,
    /// Whether a coordinate of its direction is zero.
    is_axial: bool,
}

impl Frame {
    /// Whether the ray can hit anything in the interval.
    #[inline(always)]
    pub fn legal<L: Lanes>(&self, lanes: L, ray: &Ray, within: Interval) -> Option<Legal> {
        if let Some(moderate) = &self.moderate {
            // Where anything is NaN, so is a comparison false, but that for zero.
            let size = lanes.abs4(direction(lanes, ray));
            let zero = lanes.le4(size, lanes.splat4(0.0));
            let some = lanes.le4(lanes.splat4(1.0 / MOST), size);
            let before = lanes.mul4(size, lanes.splat4(within.min * -moderate.scale));
            let fine = lanes.le4(lanes.abs4(moderate.origin(lanes, ray)), lanes.splat4(NEAR))
                & (zero | some)
                & lanes.le4(size, lanes.splat4(MOST))
                & lanes.le4(before, lanes.splat4(BEFORE));
            if fine == 15 && some & 7 != 0 && within.min <= 0.0 && 0.0 < within.max {
                let is_unit = lanes.le4(lanes.splat4(UNIT), size) & 7 != 0
                    && lanes.le4(size, lanes.splat4(4.0 * UNIT)) == 15;
                return Some(Legal { is_moderate: true, is_unit, is_axial: zero != 0 });
            }
        }
        is_legal(ray, within).then_some(Legal { is_moderate: false, is_unit: false, is_axial: false })
    }

    /// The ray ready for the tree; none where it certainly misses all boxes.
    #[inline(always)]
    pub fn course<L: Lanes>(&self, lanes: L, ray: &Ray, within: Interval, legal: Legal) -> Option<Course<L>> {
        if legal.is_moderate
            && let Some(moderate) = &self.moderate
        {
            let signs = direction(lanes, ray);
            let mut inverse = lanes.div4(lanes.splat4(1.0), signs);
            if legal.is_axial {
                rarely();
                inverse = bounded(lanes, inverse);
            }
            let mut shift = SHIFT / UNIT;
            if !legal.is_unit {
                rarely();
                shift = SHIFT / (0.5 * largest(ray.direction));
            }
            let slab = SlabRay::new(lanes, moderate.origin(lanes, ray), STEP, signs, inverse);
            return Some(Course { slab, factor: moderate.scale, shift });
        }
        let local = self.enter_otherwise(ray, within)?;
        Some(Course::of(lanes, &local))
    }

    /// Not in place, so that the short way keeps its numbers in registers.
    #[inline(never)]
    fn enter_otherwise(&self, ray: &Ray, within: Interval) -> Option<LocalRay> {
        self.enter(ray, within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use crate::kernel::{Boxes, PortableLanes, Vectorized, vectorize};
    use crate::math::exponent;
    use crate::testing::Random;

    /// Whether a ray meets a box, on the way that it takes or on the long one, and whether it took the short one.
    struct Meets<'a>(&'a Frame, &'a Ray, Interval, &'a Aabb, bool);

    impl Vectorized for Meets<'_> {
        type Output = (bool, bool);
        #[inline(always)]
        fn run<L: Lanes>(self, lanes: L) -> (bool, bool) {
            let Meets(frame, ray, within, bounds, short) = self;
            let legal = frame.legal(lanes, ray, within).unwrap();
            let mut boxes = Boxes::EMPTY;
            let (min, max) = frame.outward(bounds);
            boxes.set(5, min, max);
            let taken = Legal { is_moderate: legal.is_moderate && short, ..legal };
            let Some(course) = frame.course(lanes, ray, within, taken) else {
                return (false, taken.is_moderate);
            };
            let limit = lanes.splat(course.limit(within.max));
            (course.slab.test(lanes, &boxes, limit).0 == 1 << 5, taken.is_moderate)
        }
    }

    /// A box without extent on the ray is met on both ways, up to a parameter that is its own, and one beside it or behind by some
    /// steps is not.
    #[test]
    fn places_on_the_ray_are_met() {
        let mut random = Random::new(7);
        let (mut short, mut long) = (0, 0);
        for case in 0..6000_usize {
            let unit = exp2i(random.uniform(-700.0, 700.0) as i32 * (case % 2) as i32);
            let center = random.in_cube() * unit * random.magnitude(-2.0, 3.0);
            let bounds = Aabb::new(center - DVec3::splat(unit), center + DVec3::splat(unit));
            let frame = Frame::around(1, [Some(bounds)].into_iter());
            let place = center + random.in_cube() * unit;
            let origin = center + random.in_cube() * unit * random.magnitude(-1.0, 1.2);
            let mut way = place - origin;
            // Of some one or two coordinates are zero, or little more.
            let (mut place, mut origin) = (place, origin);
            for axis in 0..3 {
                if case % 5 == 1 && (case / 5 + axis) % 3 != 0 && axis != case / 15 % 3 {
                    let tiny =
                        random.magnitude(-26.0, -14.0) * unit * f64::from(u32::from(random.once_in(2)));
                    way[axis] = tiny * random.sign();
                    place[axis] = origin[axis] + way[axis];
                    let inside = (place[axis] - center[axis]).clamp(-unit, unit);
                    (origin[axis], place[axis]) = (center[axis] + inside - way[axis], center[axis] + inside);
                }
            }
            let way = way;
            let distance = (way / unit).length();
            let length = exp2i(-exponent(distance) - exponent(unit)) * random.magnitude(-16.0, 16.0);
            let ray = Ray::new(origin, way * length);
            // Some are a little behind the start.
            let back = if case % 3 == 0 { random.magnitude(-12.0, -7.6) / distance } else { 0.0 };
            let (place, t) =
                if back > 0.0 { (origin - way * back, -back / length) } else { (place, 1.0 / length) };
            // A few roundings of the place, of its parameter and of the direction.
            let scale = unit.max(center.abs().max_element()).max(origin.abs().max_element());
            let slack = DVec3::splat(scale * exp2i(-50));
            let here = Aabb::new(place - slack, place + slack);
            let until = if back > 0.0 {
                Interval::new(t * 1.25, 1.0)
            } else {
                Interval::new(0.0, t * (1.0 + exp2i(-40)))
            };
            // Beside it: by more than all that is moved outward, and the corners of the box.
            let off = unit * 16.0 * (3.0 + (origin - center).abs().max_element() / unit) * exp2i(-22);
            let across = (way / unit).cross(random.direction()).normalize() * 8.0 * off;
            let beside = Aabb::new(here.min + across, here.max + across);
            let before = Interval::new(0.0, t * (1.0 - 64.0 * off / (distance * unit)));
            for is_short in [true, false] {
                let meets = |within, bounds| Meets(&frame, &ray, within, bounds, is_short);
                let (met, taken) = vectorize(meets(until, &here));
                assert!(met, "{case} {ray:?} {here:?}");
                assert!(meets(until, &here).run(PortableLanes).0, "{case} {ray:?} {here:?}");
                if slack.x < off * exp2i(-4) {
                    assert!(!vectorize(meets(Interval::FORWARD, &beside)).0, "{case} {ray:?} {beside:?}");
                    let nearer = back == 0.0 && before.max > 0.0 && vectorize(meets(before, &here)).0;
                    assert!(!nearer, "{case} {ray:?} {here:?} {before:?}");
                }
                *(if taken { &mut short } else { &mut long }) += 1;
            }
        }
        assert!(short > 4000 && long > 6000, "{short} {long}");
    }

    /// What is extreme is not moderate; what is not legal is neither.
    #[test]
    fn what_is_moderate() {
        let bounds = Aabb::new(DVec3::splat(-1.0), DVec3::splat(1.0));
        let frame = Frame::around(1, [Some(bounds)].into_iter());
        let is = |o: [f64; 3], d: [f64; 3], min: f64, max: f64| {
            let legal = frame.legal(PortableLanes, &Ray::new(o, d), Interval::new(min, max));
            legal.map(|legal| legal.is_moderate)
        };
        let (o, d, inf) = ([0.5, -1.0, 2.0], [0.6, -0.5, 0.7], f64::INFINITY);
        assert_eq!(is(o, d, 0.0, inf), Some(true));
        assert_eq!(is(o, d, 0.0, 1e-300), Some(true));
        assert_eq!(is(o, d, 1e-300, 1.0), Some(false));
        assert_eq!(is(o, d, -1.0, 1.0), Some(false));
        assert_eq!(is(o, d, -1e-15, 1.0), Some(true));
        assert_eq!(is(o, d, -inf, 1.0), Some(false));
        assert_eq!(is(o, d, -1e-15, 0.0), Some(false));
        assert_eq!(is(o, d, 0.0, 0.0), None);
        assert_eq!(is(o, d, 0.0, f64::NAN), None);
        assert_eq!(is([0.5, -1.0, 20.0], d, 0.0, inf), Some(false));
        for bad in [f64::NAN, inf, -inf] {
            for axis in 0..3 {
                let (mut p, mut q) = (o, d);
                (p[axis], q[axis]) = (bad, bad);
                assert_eq!((is(p, d, 0.0, inf), is(o, q, 0.0, inf)), (None, None));
            }
        }
        for (odd, expected) in [
            (0.0, true),
            (-0.0, true),
            (exp2i(-60), true),
            (exp2i(-61), false),
            (exp2i(60), true),
            (exp2i(61), false),
        ] {
            assert_eq!(is(o, [0.6, odd, 0.7], 0.0, inf), Some(expected), "{odd}");
        }
        assert_eq!(is(o, [0.4, 0.4, -0.4], 0.0, inf), Some(true));
        assert_eq!(is(o, [0.0, -exp2i(-60), 0.0], 0.0, inf), Some(true));
        assert_eq!(is(o, [0.0, exp2i(-61), 0.0], 0.0, inf), Some(false));
        assert_eq!(is(o, [0.0; 3], 0.0, inf), None);
        assert_eq!(is(o, [0.0, -0.0, 0.0], 0.0, inf), None);
    }
}
