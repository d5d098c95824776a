//! Kernel coordinates: where box tests take place.
//!
//! A point `x` of the world is `(x - C) * 2^-m` in kernel coordinates, with all bounded shapes in [-1, 1]; `C` is the
//! median of the shapes' centres, so that a few huge shapes do not take the digits of the others. A ray
//! keeps its parameter but for an exact factor and a shift: `t' = t * 2^(e - m) - start`, where `2^e` scales the
//! direction to `max |d_i|` in [1, 2).

use crate::kernel::{at_least, round_down, round_up};
use crate::math::{exp2i, exponent};
use crate::{Aabb, Interval, Ray};
use alloc::vec::Vec;
use glam::DVec3;

/// The unit roundoff of `f64`.
const U: f64 = exp2i(-53);

/// The map from the world to kernel coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    center: DVec3,
    exponent: i32,
    /// Whether any shape is bounded.
    inhabited: bool,
}

/// A ray in kernel coordinates, begun where it enters the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRay {
    /// The start, known within `error` in each coordinate.
    pub origin: DVec3,
    pub error: DVec3,
    /// Exact, the largest coordinate in [1, 2).
    pub direction: DVec3,
    factor: f64,
    shift: f64,
}

impl LocalRay {
    /// An upper bound of the parameter in kernel coordinates that belongs to `t`.
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
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Window {
    absolute: f64,
}

impl Window {
    /// The parameters below this are too close to `t`, or less than it.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f64 {
        const RELATIVE: f64 = exp2i(-30);
        (t + (t.abs() * RELATIVE + self.absolute)).next_up()
    }
}

/// Whether box tests can hold this: finite, in order, and far from the limits of `f64`.
pub(super) fn is_regular(bounds: &Aabb) -> bool {
    const MOST: f64 = exp2i(960);
    bounds.min.cmple(bounds.max).all()
        && bounds.min.cmpgt(DVec3::splat(-MOST)).all()
        && bounds.max.cmplt(DVec3::splat(MOST)).all()
}

impl Frame {
    /// The frame for these boxes, all of them regular.
    pub fn around(boxes: &[Aabb]) -> Frame {
        if boxes.is_empty() {
            return Frame::default();
        }
        // A sample is enough, and any point will do.
        let step = boxes.len().div_ceil(1024);
        let median = |axis: usize| {
            let mut centers: Vec<f64> = boxes.iter().step_by(step).map(|b| b.center()[axis]).collect();
            let middle = centers.len() / 2;
            *centers.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        let center = DVec3::new(median(0), median(1), median(2));
        let reach = boxes
            .iter()
            .fold(DVec3::ZERO, |reach, b| reach.max((b.min - center).abs()).max((b.max - center).abs()));
        // A spare factor of 2 leaves room for the rounding of these differences.
        let exponent = (exponent(reach.max_element()) + 2).clamp(-962, 964);
        Frame { center, exponent, inhabited: true }
    }

    /// The box in kernel coordinates, rounded outward. Half a unit for the subtraction is outweighed by a whole
    /// unit; an underflow of the product is less than 2^-1074, and rays carry an error of 2^-97 at least.
    pub fn outward(&self, bounds: &Aabb) -> ([f32; 3], [f32; 3]) {
        let power = exp2i(-self.exponent);
        let (min, max) = (bounds.min - self.center, bounds.max - self.center);
        (
            min.to_array().map(|x| round_down(x.next_down() * power)),
            max.to_array().map(|x| round_up(x.next_up() * power)),
        )
    }

    /// The window of ties that [`enter`](Frame::enter) gives for this ray, which must be valid.
    #[inline(always)]
    pub fn window(&self, ray: &Ray) -> Window {
        let none = Window { absolute: 0.0 };
        let direction_exponent = exponent(ray.direction.abs().max_element());
        let power = direction_exponent - self.exponent;
        if !self.inhabited || direction_exponent < -1000 || !(-1000..=1000).contains(&power) {
            return none;
        }
        let far = ((ray.origin - self.center) * exp2i(-self.exponent)).abs().max_element();
        if far < exp2i(60) { Window { absolute: (far + 1.0) * exp2i(-24) * exp2i(-power) } } else { none }
    }

    /// The ray in kernel coordinates and the window of its ties; no ray when it misses the box of the scene.
    ///
    /// The ray must be valid and the interval not empty.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray, within: Interval) -> (Option<LocalRay>, Window) {
        if !self.inhabited {
            return (None, Window { absolute: 0.0 });
        }
        let direction_exponent = exponent(ray.direction.abs().max_element());
        let power = direction_exponent - self.exponent;
        // Not for directions that are not normal numbers, or whose parameters would overflow.
        if direction_exponent < -1000 || !(-1000..=1000).contains(&power) {
            return (Some(LocalRay::EVERYWHERE), Window { absolute: 0.0 });
        }
        let scale = exp2i(-self.exponent);
        let origin = (ray.origin - self.center) * scale;
        let direction = ray.direction * exp2i(-direction_exponent);
        let factor = exp2i(power);
        let far = origin.abs().max_element();
        // Beyond, the error would exceed the scene and squares of it would near the limits.
        if !(far < exp2i(60)) {
            return (Some(LocalRay::EVERYWHERE), Window { absolute: 0.0 });
        }
        let absolute = (far + 1.0) * exp2i(-24);
        let window = Window { absolute: absolute * exp2i(-power) };
        // A raw `t` may exceed the interval's end by its error where the true one does not.
        let mut start = within.min * factor - absolute;
        if !(start.abs() * 2.0 + far <= 8.0) {
            // Begin where the ray enters the box of the scene, which is [-1, 1] with room for all roundings: the
            // origin's (u |o'|), that of the difference and the quotient (2 u (|o'| + 2)), and margin.
            let room = 1.0 + exp2i(-10) + 8.0 * U * far;
            let mut exit = f64::INFINITY;
            for axis in 0..3 {
                let (o, d) = (origin[axis], direction[axis]);
                if d.abs() >= exp2i(-100) {
                    let plane = room.copysign(d);
                    let (a, b) = ((-plane - o) / d, (plane - o) / d);
                    start = if a > start { a } else { start };
                    exit = if b < exit { b } else { exit };
                } else if o.abs() > room {
                    return (None, window);
                }
            }
            if start > exit {
                return (None, window);
            }
        }
        let run = direction * start;
        let local = LocalRay {
            origin: origin + run,
            error: (origin.abs() + run.abs()) * (8.0 * U) + exp2i(-97),
            direction,
            factor,
            shift: absolute - start,
        };
        (Some(local), window)
    }
}

impl LocalRay {
    /// Stands for a ray that kernel coordinates cannot hold: it meets every box.
    pub const EVERYWHERE: LocalRay = LocalRay {
        origin: DVec3::ZERO,
        error: DVec3::INFINITY,
        direction: DVec3::ONE,
        factor: 1.0,
        shift: f64::INFINITY,
    };
}
