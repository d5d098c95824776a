//! Kernel coordinates: where box tests take place.
//!
//! A point `x` of the world is `(x - C) * 2^-m` in kernel coordinates, with all bounded shapes in [-1, 1]; `C` is the
//! median of the shapes' centres, so that a few huge shapes do not take the digits of the others. A ray
//! keeps its parameter but for an exact factor and a shift: `t' = t * 2^(e - m) - start`, where `2^e` scales the
//! direction to `max |d_i|` in [1, 2). Single rays have a shorter way where they are moderate: `geometry::course`.

use super::course::Moderate;
use super::tile::Tile;
use crate::kernel::{Four, Lanes, Real, at_least, at_most, outward_step};
use crate::math::{exp2i, exponent};
use crate::scaled::largest;
use crate::{Aabb, Interval, Ray};
use alloc::vec::Vec;
use glam::DVec3;

/// The unit roundoff of `f64`.
const U: f64 = exp2i(-53);

/// The absolute part of a [`Window`] for an origin at zero, in kernel coordinates.
pub(super) const WINDOW: f64 = exp2i(-24);

/// Origins farther away than this, in kernel coordinates, are not followed: they are known to less than 2^-13 of the scene.
const FARTHEST: f64 = exp2i(40);

/// The map from the world to kernel coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    center: DVec3,
    exponent: i32,
    /// Whether any shape is bounded.
    inhabited: bool,
    /// The same for rays of which nothing is extreme, if nothing about the frame is.
    pub moderate: Option<Moderate>,
}

/// A ray in kernel coordinates, begun where it enters the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRay {
    /// The start, known within `error` in each coordinate.
    pub origin: DVec3,
    pub error: f64,
    /// How far the slabs of boxes are moved outward for it.
    pub step: f64,
    /// Exact, the largest coordinate in [1, 2).
    pub direction: DVec3,
    /// One by each coordinate of it, within a rounding; infinite where that is beyond the range.
    pub inverse: DVec3,
    pub factor: f64,
    /// Less the start, and more by three times what is absolute of a window, in kernel coordinates.
    pub shift: f64,
}

impl LocalRay {
    /// An upper bound of the parameter in kernel coordinates of whatever belongs to `t` or lies in the [`Window`] beyond.
    ///
    /// With `a` the absolute part of the window: `a` for the error of a raw parameter, `a` for the window, and what the window
    /// has beyond that, 2^-30 of |t|. Every box lies within far + 1 of the origin, as one coordinate of the direction is at
    /// least 1. Up to four times as far, 2^-30 of |t| is 2^-28 (far + 1) = a / 16 at most; beyond, no box is left.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f32 {
        at_least(t * self.factor + self.shift)
    }
}

/// When the parameters of two objects are too close for their order to be certain.
///
/// A raw `t` is promised within 2^-30 of the local scale: of the distance from the ray's origin to the far side of the
/// shape, in lengths of the direction (most are within 4 u of it; the worst are rays that graze a sphere just so
/// that `f64` can still tell a hit). For shapes inside the scene's box this scale is at most 6 (|o'| + 1), with
/// |o'| the largest coordinate of the origin in kernel coordinates, as all coordinates there are at most 1: the
/// distance is at most sqrt(3) (|o'| + 1), the size of the shape at most 2 sqrt(3). Two such errors are less than
/// 2^-26 (|o'| + 1): `absolute` is four times that. The relative part, 2^-30, is for shapes without bounds, whose
/// scale is unknown here. A window too wide costs time only: those inside are ordered by their refined parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub absolute: f64,
}

impl Window {
    /// The parameters below this are too close to `t`, or less than it.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f64 {
        const RELATIVE: f64 = exp2i(-30);
        (t + (t.abs() * RELATIVE + self.absolute)).next_up()
    }
}

/// The windows of all rays from one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Windows {
    exponent: i32,
    /// The window of a direction of the scene's size; `None` where all are empty.
    far: Option<f64>,
}

impl Windows {
    /// The window of the ray with this direction.
    #[inline(always)]
    pub fn of(&self, direction: DVec3) -> Window {
        let direction_exponent = exponent(largest(direction));
        let power = direction_exponent - self.exponent;
        match self.far {
            Some(far) if is_middling(direction_exponent) && is_middling(power) => {
                Window { absolute: far * exp2i(-power) }
            }
            _ => Window { absolute: 0.0 },
        }
    }

    /// The windows of four rays, by the largest coordinates of their directions.
    #[inline(always)]
    pub fn of_four<L: Lanes>(&self, largest: Four<L>) -> [Window; 4] {
        let zero = largest.all(0.0);
        let Some(far) = self.far else { return [Window { absolute: 0.0 }; 4] };
        let (least, most) = (zero.all(exp2i(-MIDDLING)), zero.all(exp2i(MIDDLING)));
        // Powers of two: all of this is exact. What is not middling is left out at the end.
        let binade = largest.binade();
        let power = zero.all(exp2i(self.exponent)) / binade;
        let far = Four::if_at_most(least, power, zero.all(far) * power, zero);
        let far = Four::if_at_most(power, most, far, zero);
        let far = Four::if_at_most(least, binade, far, zero);
        let far = Four::if_at_most(binade, most, far, zero);
        far.to_array().map(|absolute| Window { absolute })
    }
}

/// Two to this power, and to its opposite, are far from the limits of `f64`: one by a number 2^-100 times as large has a place.
const MIDDLING: i32 = 900;

/// Whether two to this power is.
#[inline(always)]
fn is_middling(power: i32) -> bool {
    (-MIDDLING..=MIDDLING).contains(&power)
}

/// Whether box tests can hold this: finite, in order, and far from the limits of `f64`.
pub(super) fn is_regular(bounds: &Aabb) -> bool {
    const MOST: f64 = exp2i(960);
    bounds.min.cmple(bounds.max).all()
        && bounds.min.cmpgt(DVec3::splat(-MOST)).all()
        && bounds.max.cmplt(DVec3::splat(MOST)).all()
}

impl Frame {
    /// The frame for so many boxes, of which some may be none; all others are regular.
    pub fn around(count: usize, boxes: impl Iterator<Item = Option<Aabb>> + Clone) -> Frame {
        // A sample is enough, and any point will do.
        let sample: Vec<DVec3> =
            boxes.clone().step_by(count.div_ceil(1024).max(1)).flatten().map(|b| b.center()).collect();
        let median = |axis: usize| {
            let mut centers: Vec<f64> = sample.iter().map(|center| center[axis]).collect();
            let middle = centers.len() / 2;
            if centers.is_empty() { 0.0 } else { *centers.select_nth_unstable_by(middle, f64::total_cmp).1 }
        };
        let center = DVec3::new(median(0), median(1), median(2));
        let mut inhabited = false;
        let reach = boxes.flatten().fold(DVec3::ZERO, |reach, b| {
            inhabited = true;
            reach.max((b.min - center).abs()).max((b.max - center).abs())
        });
        if !inhabited {
            return Frame::default();
        }
        // A spare factor of 2 leaves room for the rounding of these differences.
        let exponent = (exponent(reach.max_element()) + 2).clamp(-962, 964);
        Frame { center, exponent, inhabited, moderate: Moderate::new(center, exponent) }
    }

    /// The box in kernel coordinates, rounded outward: by twice what a rounding to `f32` can lose, which leaves much for the
    /// half unit of the subtraction. Below the normal numbers of `f32` a coordinate may be off by 2^-150, far less than
    /// the steps of rays spare.
    #[inline]
    pub fn outward(&self, bounds: &Aabb) -> ([f32; 3], [f32; 3]) {
        let power = exp2i(-self.exponent);
        let (min, max) = ((bounds.min - self.center) * power, (bounds.max - self.center) * power);
        (
            [at_most(min.x), at_most(min.y), at_most(min.z)],
            [at_least(max.x), at_least(max.y), at_least(max.z)],
        )
    }

    /// The window of ties of a valid ray.
    #[inline(always)]
    pub fn window(&self, ray: &Ray) -> Window {
        self.windows(ray.origin).of(ray.direction)
    }

    /// The windows of ties of valid rays from this point.
    #[inline(always)]
    pub fn windows(&self, origin: DVec3) -> Windows {
        let far = largest((origin - self.center) * exp2i(-self.exponent));
        let far = if self.inhabited && far < FARTHEST { Some((far + 1.0) * WINDOW) } else { None };
        Windows { exponent: self.exponent, far }
    }

    /// The ray in kernel coordinates; none when it misses the box of the scene.
    ///
    /// The ray must be valid and the interval not empty.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray, within: Interval) -> Option<LocalRay> {
        if !self.inhabited {
            return None;
        }
        let inverse = 1.0 / ray.direction;
        let direction_exponent = exponent(largest(ray.direction));
        let power = direction_exponent - self.exponent;
        // Not for directions that are not normal numbers or whose reciprocal is none, nor for parameters that would overflow.
        if !(is_middling(direction_exponent) && is_middling(power)) {
            return Some(LocalRay::EVERYWHERE);
        }
        let origin = (ray.origin - self.center) * exp2i(-self.exponent);
        let direction = ray.direction * exp2i(-direction_exponent);
        let inverse = inverse * exp2i(direction_exponent);
        let factor = exp2i(power);
        let far = largest(origin);
        if !(far < FARTHEST) {
            return Some(LocalRay::EVERYWHERE);
        }
        let absolute = (far + 1.0) * WINDOW;
        // A raw `t` may exceed the interval's end by its error where the true one does not: the ray begins before it.
        if within.min == 0.0 && far <= 8.0 {
            // By `absolute`, which is less than 2 `absolute` in a coordinate: the error takes it. The origin itself, rounded once, is
            // known to 8 u = 2^-50.
            let error = absolute * 2.0 + exp2i(-48);
            let step = outward_step(error, far);
            return Some(LocalRay { origin, error, step, direction, inverse, factor, shift: 3.0 * absolute });
        }
        let mut start = within.min * factor - absolute;
        if !(start.abs() * 2.0 + far <= 8.0) {
            // Begin where the ray enters the box of the scene, which is [-1, 1] with room for all roundings: the
            // origin's (u |o'|), that of the difference and the quotient (2 u (|o'| + 2)), at most 2^-11 together.
            let room = 1.0 + exp2i(-10);
            let mut exit = f64::INFINITY;
            for axis in 0..3 {
                let (o, d) = (origin[axis], direction[axis]);
                if d.abs() >= exp2i(-100) {
                    let plane = room.copysign(d);
                    let (a, b) = ((-plane - o) / d, (plane - o) / d);
                    start = if a > start { a } else { start };
                    exit = if b < exit { b } else { exit };
                } else if o.abs() > room {
                    return None;
                }
            }
            if start > exit {
                return None;
            }
        }
        // Each coordinate runs by less than 2 |start|.
        let reach = far + 2.0 * start.abs();
        let error = reach * (8.0 * U) + exp2i(-97);
        let origin = origin + direction * start;
        let local = LocalRay {
            origin,
            error,
            step: outward_step(error, largest(origin)),
            direction,
            inverse,
            factor,
            shift: 3.0 * absolute - start,
        };
        Some(local)
    }
}

/// The rays that go side by side, by eight.
pub(super) const GROUPS: usize = 4;
/// The rays that go side by side.
pub(super) const PACKET: usize = 8 * GROUPS;

/// Rays in kernel coordinates, by axis, in `f32`: for culling.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// Eight each. Known within `error` and the rounding to nearest.
    pub origin: [[[f32; 8]; 3]; GROUPS],
    /// Rounded to nearest.
    pub direction: [[[f32; 8]; 3]; GROUPS],
    /// Where each ray's interval ends: an upper bound.
    pub limit: [[f32; 8]; GROUPS],
    /// As in [`LocalRay`].
    pub factor: [f64; PACKET],
    pub shift: [f64; PACKET],
    /// An error radius for all.
    pub error: f64,
}

impl Side {
    pub const EMPTY: Side = Side {
        origin: [[[0.0; 8]; 3]; GROUPS],
        direction: [[[0.0; 8]; 3]; GROUPS],
        limit: [[0.0; 8]; GROUPS],
        factor: [0.0; PACKET],
        shift: [0.0; PACKET],
        error: 0.0,
    };

    /// Puts a ray into its place.
    pub fn set(&mut self, place: usize, ray: &LocalRay, end: f64) {
        let (group, lane) = (place / 8 % GROUPS, place % 8);
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        for axis in 0..3 {
            self.origin[group][axis][lane] = o[axis] as f32;
            self.direction[group][axis][lane] = d[axis] as f32;
        }
        self.limit[group][lane] = ray.limit(end);
        self.factor[place % PACKET] = ray.factor;
        self.shift[place % PACKET] = ray.shift;
        let error = 3.0 * ray.error;
        self.error = if error > self.error { error } else { self.error };
    }

    /// Makes one place repeat another, but for its end, which comes before its start.
    pub fn repeat(&mut self, place: usize, other: usize) {
        let (group, lane) = (place / 8 % GROUPS, place % 8);
        for axis in 0..3 {
            self.origin[group][axis][lane] = self.origin[other / 8 % GROUPS][axis][other % 8];
            self.direction[group][axis][lane] = self.direction[other / 8 % GROUPS][axis][other % 8];
        }
        self.limit[group][lane] = f32::NEG_INFINITY;
    }

    /// [`LocalRay::limit`] of this ray.
    #[inline(always)]
    pub fn limit_of(&self, place: usize, t: f64) -> f32 {
        let place = place % PACKET;
        at_least(t * self.factor[place] + self.shift[place])
    }

    /// Ends this ray at `t`.
    #[inline(always)]
    pub fn cut(&mut self, place: usize, t: f64) {
        self.limit[place / 8 % GROUPS][place % 8] = self.limit_of(place, t);
    }
}

impl Frame {
    /// [`enter`](Frame::enter) for a packet, where that is simple: all rays legal, and near the scene. Whether it was.
    /// Places without a ray repeat the last.
    #[inline(always)]
    pub fn enter_together<L: Lanes>(
        &self,
        lanes: L,
        rays: &[Ray],
        within: &[Interval],
        tile: &Tile,
        side: &mut Side,
    ) -> bool {
        let last = tile.count.wrapping_sub(1);
        if last >= PACKET || !self.inhabited {
            return false;
        }
        let center = [self.center.x, self.center.y, self.center.z];
        let scale = lanes.splat4(exp2i(-self.exponent));
        let (small, large) = (lanes.splat4(exp2i(-MIDDLING)), lanes.splat4(exp2i(MIDDLING)));
        let (zero, one, unit) = (lanes.splat4(0.0), lanes.splat4(1.0), lanes.splat4(WINDOW));
        let mut fine = 15;
        for four in 0..PACKET / 4 {
            let (group, lane) = (four / 2, four % 2 * 4);
            let place = |i: usize| tile.place((4 * four + i).min(last));
            let places = [place(0), place(1), place(2), place(3)];
            let [a, b, c, e] = places.map(|place| &rays[place]);
            let world = [
                lanes.load4([a.origin.x, b.origin.x, c.origin.x, e.origin.x]),
                lanes.load4([a.origin.y, b.origin.y, c.origin.y, e.origin.y]),
                lanes.load4([a.origin.z, b.origin.z, c.origin.z, e.origin.z]),
            ];
            let d = [
                lanes.load4([a.direction.x, b.direction.x, c.direction.x, e.direction.x]),
                lanes.load4([a.direction.y, b.direction.y, c.direction.y, e.direction.y]),
                lanes.load4([a.direction.z, b.direction.z, c.direction.z, e.direction.z]),
            ];
            let [a, b, c, e] = places.map(|place| &within[place]);
            let (min, max) =
                (lanes.load4([a.min, b.min, c.min, e.min]), lanes.load4([a.max, b.max, c.max, e.max]));
            // Zero times a number is zero, unless the number is infinite or NaN.
            let mut nothing = zero;
            let (mut largest, mut far) = (zero, zero);
            let mut o = world;
            for k in 0..3 {
                nothing = lanes.add4(nothing, lanes.mul4(lanes.add4(world[k], d[k]), zero));
                o[k] = lanes.mul4(lanes.sub4(world[k], lanes.splat4(center[k])), scale);
                largest = lanes.max4(lanes.abs4(d[k]), largest);
                far = lanes.max4(lanes.abs4(o[k]), far);
            }
            let power = lanes.binade4(largest);
            let shrink = lanes.div4(one, power);
            let factor = lanes.mul4(power, scale);
            let absolute = lanes.mul4(lanes.add4(far, one), unit);
            let start = lanes.sub4(lanes.mul4(min, factor), absolute);
            let reach = lanes.add4(lanes.add4(lanes.abs4(start), lanes.abs4(start)), far);
            fine &= lanes.le4(nothing, zero)
                & lanes.le4(small, power)
                & lanes.le4(power, large)
                & lanes.le4(small, factor)
                & lanes.le4(factor, large)
                & lanes.le4(reach, lanes.splat4(8.0))
                & lanes.lt4(min, max);
            let shift = lanes.sub4(lanes.mul4(absolute, lanes.splat4(3.0)), start);
            // As `at_least`.
            let limit = lanes.add4(lanes.mul4(max, factor), shift);
            let limit = lanes.add4(limit, lanes.mul4(lanes.abs4(limit), lanes.splat4(exp2i(-23))));
            for k in 0..3 {
                let d = lanes.mul4(d[k], shrink);
                let o = lanes.add4(o[k], lanes.mul4(d, start));
                side.origin[group][k][lane..lane + 4].copy_from_slice(&lanes.round4(o));
                side.direction[group][k][lane..lane + 4].copy_from_slice(&lanes.round4(d));
            }
            side.limit[group][lane..lane + 4].copy_from_slice(&lanes.round4(limit));
            let place = 4 * four..4 * four + 4;
            side.factor[place.clone()].copy_from_slice(&lanes.store4(factor));
            side.shift[place].copy_from_slice(&lanes.store4(shift));
        }
        // At most 8 and 2 * 4 in each coordinate.
        side.error = 3.0 * (16.0 * (8.0 * U) + exp2i(-97));
        for place in last + 1..PACKET {
            side.limit[place / 8][place % 8] = f32::NEG_INFINITY;
        }
        fine == 15
    }
}

impl LocalRay {
    /// Stands for a ray that kernel coordinates cannot hold: it meets every box, as all are within 1 of zero.
    pub const EVERYWHERE: LocalRay = LocalRay {
        origin: DVec3::ZERO,
        error: exp2i(100),
        step: outward_step(exp2i(100), 0.0),
        direction: DVec3::ONE,
        inverse: DVec3::ONE,
        factor: 1.0,
        shift: f64::INFINITY,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_ends_a_little_after_its_hit() {
        for absolute in [0.0, 1e-9] {
            let window = Window { absolute };
            for t in [0.0, 1e-300, 1e-5, 0.7, 1.0, 3e8, -2.0, -1e-7] {
                let (limit, most) = (window.limit(t), t.abs() * exp2i(-29) + 2.0 * absolute);
                assert!(limit > t && limit - t <= most.max(f64::from_bits(1)), "{t} {limit}");
                assert!(limit - t >= t.abs() * exp2i(-31) + 0.5 * absolute, "{t} {limit}");
            }
        }
    }

    /// Directions next to the greatest and least numbers, and parameters there, meet every box; others are followed.
    #[test]
    fn directions_of_extreme_length() {
        for (size, speed, followed) in [
            (1.0, 1.0, true),
            (1.0, exp2i(900), true),
            (1.0, exp2i(901), false),
            (1.0, exp2i(1023), false),
            (1e100, exp2i(1023) * 1.5, false),
            (1.0, exp2i(-900), false),
            (exp2i(-10), exp2i(-900), true),
            (exp2i(-10), exp2i(-901), false),
            (exp2i(-10), f64::from_bits(1), false),
            (exp2i(-300), exp2i(610), false),
            (exp2i(300), exp2i(-610), false),
        ] {
            let bounds = Aabb::new(DVec3::splat(-size), DVec3::splat(size));
            let frame = Frame::around(1, [Some(bounds)].into_iter());
            let ray = Ray::new([0.0, 0.0, -3.0 * size], DVec3::new(0.0, 0.25, 1.0) * speed);
            let (local, window) = (frame.enter(&ray, Interval::FORWARD).unwrap(), frame.window(&ray));
            assert_eq!(local.shift.is_finite(), followed, "{size:e} {speed:e}");
            assert_eq!(window.absolute > 0.0, followed);
            let largest = Four::new(crate::kernel::PortableLanes, [1.0, largest(ray.direction), 0.0, speed]);
            let four = frame.windows(ray.origin).of_four(largest).map(|window| window.absolute);
            assert_eq!((four[1], four[2], four[3]), (window.absolute, 0.0, window.absolute));
            assert!(!followed || local.direction == DVec3::new(0.0, 0.25, 1.0));
            assert!(!followed || local.inverse == DVec3::new(f64::INFINITY, 4.0, 1.0));
        }
    }

    /// What a packet keeps of each ray: its place, its end, and an error that holds for all.
    #[test]
    fn a_packet_keeps_its_rays() {
        let mut side = Side::EMPTY;
        let of = |i: usize, error: f64| LocalRay {
            origin: DVec3::new(0.5, -0.25, 0.125) * (1 + i) as f64,
            error,
            step: 2.0 * error,
            direction: DVec3::new(1.0, -0.5, 1.5) / (1 + i) as f64,
            inverse: DVec3::new(1.0, -2.0, 0.5) * (1 + i) as f64,
            factor: (2 + i) as f64,
            shift: 0.25 * i as f64,
        };
        for i in 0..PACKET {
            side.set(i, &of(i, if i == 9 { 2e-5 } else { 1e-7 }), i as f64);
        }
        assert!((side.error - 6e-5).abs() < 1e-15, "{}", side.error);
        for i in 0..PACKET {
            let ray = of(i, 0.0);
            for k in 0..3 {
                assert_eq!(side.origin[i / 8][k][i % 8], ray.origin[k] as f32);
                assert_eq!(side.direction[i / 8][k][i % 8], ray.direction[k] as f32);
            }
            assert_eq!(side.limit[i / 8][i % 8], ray.limit(i as f64));
            assert_eq!(side.limit_of(i, 0.75), ray.limit(0.75));
            let true_end = 0.75 * ray.factor + ray.shift;
            assert!((true_end..true_end * (1.0 + 1e-6)).contains(&f64::from(ray.limit(0.75))));
        }
        side.cut(11, 0.5);
        assert_eq!(side.limit[1][3], of(11, 0.0).limit(0.5));
        assert_eq!(side.limit[1][4], of(12, 0.0).limit(12.0));
        side.repeat(30, 11);
        for k in 0..3 {
            assert_eq!(side.origin[3][k][6], side.origin[1][k][3]);
            assert_eq!(side.direction[3][k][6], side.direction[1][k][3]);
            assert_ne!(side.origin[3][k][5], side.origin[1][k][3]);
        }
        assert_eq!(side.limit[3][6], f32::NEG_INFINITY);
    }

    /// A ray that meets the box of the scene begins before it does, not long before, and its places and parameters are those
    /// of the world; one that passes it is none.
    #[test]
    fn rays_begin_where_they_enter() {
        use crate::testing::Random;
        let mut random = Random::new(1);
        let (mut none, mut some) = (0, 0);
        for case in 0..4000 {
            let (corner, size) = (random.in_cube() * 3.0, random.magnitude(-2.0, 2.0));
            let bounds = Aabb::new(corner, corner + DVec3::new(size, size * 0.9, size * 0.3));
            let frame = Frame::around(1, [Some(bounds)].into_iter());
            let unit = exp2i(frame.exponent);
            let (center, distance) = (bounds.center(), unit * random.magnitude(0.5, 11.9));
            assert!(largest(bounds.max - center) <= unit);
            let origin = center + random.direction() * distance;
            let inside = random.in_cube();
            // At a place in the scene's box, or beside it: how far outside, in units of the scene, along one axis.
            let beyond = if case % 3 == 0 { 1.0 + random.magnitude(-2.5, 0.0) } else { 0.99 };
            let axis = case % 7 % 3;
            let mut target = inside.to_array();
            target[axis] = beyond * random.sign();
            let target = center + DVec3::from_array(target) * unit;
            let mut direction = (target - origin) * random.magnitude(-3.0, 3.0);
            if case % 3 == 0 {
                // Across that axis nothing changes: the line stays beside the box.
                direction =
                    DVec3::from_array(core::array::from_fn(|k| if k == axis { 0.0 } else { direction[k] }));
            }
            let origin = if case % 3 == 0 {
                DVec3::from_array(core::array::from_fn(|k| if k == axis { target[k] } else { origin[k] }))
            } else {
                origin
            };
            let ray = Ray::new(origin, direction);
            // From zero, and from elsewhere.
            let least = if case % 2 == 0 { 0.0 } else { f64::MIN_POSITIVE };
            let (local, window) =
                (frame.enter(&ray, Interval::new(least, f64::INFINITY)), frame.window(&ray));
            if beyond > 1.0 + exp2i(-9) {
                none += u32::from(local.is_none());
                continue;
            }
            let Some(local) = local else { panic!("{ray:?} {bounds:?}") };
            some += 1;
            let far = largest(origin - center) / unit;
            let t = (target - origin).dot(direction) / direction.length_squared();
            // The parameter of the target, in kernel coordinates from where the ray begins.
            let absolute = (far + 1.0) * WINDOW;
            let along = t * local.factor + local.shift - 3.0 * absolute;
            let off = local.origin + local.direction * along - (target - center) / unit;
            assert!(largest(off) <= local.error + exp2i(-49) * far, "{off} {ray:?}");
            // It may also begin earlier by what a parameter may err.
            let at_zero = local.shift == 3.0 * absolute;
            assert_eq!(at_zero, least == 0.0 && far <= 8.0, "{ray:?}");
            assert!(local.error >= if at_zero { 2.0 * absolute } else { 0.0 });
            assert!(local.error <= if at_zero { 2.1 * absolute } else { exp2i(-47) * (far + 1.0) });
            for k in 0..3 {
                let product = local.inverse[k] * local.direction[k];
                assert!((product - 1.0).abs() < 1e-15 || local.direction[k] == 0.0);
            }
            let limit = f64::from(local.limit(t));
            assert!(limit >= 0.0 && limit - along <= 4.0 * (far + 1.0) * WINDOW + exp2i(-20) * along.abs());
            let window_end = along + (window.limit(t) - t) * local.factor;
            assert!(limit >= window_end + 0.9 * absolute, "{limit} {window_end}");
            // Begun in the box: nowhere else than where it enters, if it does not start inside.
            if far > 8.0 {
                let most = largest(local.origin);
                assert!((1.0..1.0 + exp2i(-9)).contains(&most), "{most} {ray:?}");
            }
            let absolute = (far + 1.0) * WINDOW / local.factor;
            assert!((window.absolute / absolute - 1.0).abs() < 1e-9);
        }
        assert!(none > 1000 && some > 2600, "{none} {some}");
    }

    #[test]
    fn what_box_tests_can_hold() {
        let of =
            |min: f64, max: f64| Aabb { min: DVec3::new(0.0, min, -1.0), max: DVec3::new(0.0, max, 1.0) };
        for (min, max, regular) in [
            (0.0, 1.0, true),
            (2.0, 2.0, true),
            (-1e280, 1e280, true),
            (1.0, 0.0, false),
            (f64::NAN, 1.0, false),
            (0.0, f64::NAN, false),
            (f64::NEG_INFINITY, 0.0, false),
            (0.0, f64::INFINITY, false),
            (-1e300, 0.0, false),
            (0.0, 1e300, false),
        ] {
            assert_eq!(is_regular(&of(min, max)), regular, "{min} {max}");
        }
    }
}
