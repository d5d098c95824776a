//! A ray against eight boxes: the conservative slab test.
//!
//! Box tests run in *kernel coordinates*, in which the scene lies in [-1, 1]: see `geometry::frame`, which makes the
//! rays. A box test may only cull: it never rejects a box that the exact ray passes through.
//!
//! Per axis, the parameters at which the ray enters and leaves the slab are `(x - o) / d`. The origin is known as
//! `o +- e` with `e >= 2^-98`, the direction `d` is exact, `max |d_i|` lies in [1, 2). In `f32`, with v = 2^-24:
//! - The reciprocal is rounded to `f32` after it was made smaller (entry) or larger (exit) in magnitude by the factor
//!   1 -+ 2^-22 = 1 -+ 4 v. That outweighs its own rounding, and those of the difference and of the product, 3 v
//!   together. It works in the wrong direction only where the parameter is negative, hence behind the start: there
//!   the entry counts as 0 anyway, and an exit keeps its sign.
//! - With fused multiply-add, the test is `x * r - c` with `c = o * r` moved outward by `e * |r|` and rounded outward:
//!   exact but for one rounding. Without, it is `(x - o') * r` with `o' = o -+ e` rounded outward.
//! - Results below the normal range err by 2^-150 at most, far less than `e * |r| >= 2^-99` moved them.
//! - An axis with `|d_i| < 2^-100` is treated as `2^-100`. Within the scene a parameter is at most about 2, so this
//!   moves the ray by less than 2^-98, which `e` covers: the slab rejects if `o +- e` lies outside, else its exit is
//!   at least `e * 2^100 >= 4`, beyond the scene.
//! - A NaN (infinities cancel) is passed over by `max` and `min`: the box is kept.

use super::Lanes;
use glam::DVec3;

/// Eight boxes: the rows are min x, min y, min z, max x, max y, max z.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Boxes {
    rows: [[f32; 8]; 6],
}

impl Boxes {
    /// Eight boxes that no ray meets.
    pub const EMPTY: Boxes = Boxes {
        rows: [
            [f32::INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::NEG_INFINITY; 8],
        ],
    };

    /// Sets the box in this lane; nothing for a lane beyond the seventh.
    pub fn set(&mut self, lane: usize, min: [f32; 3], max: [f32; 3]) {
        for (row, value) in self.rows.iter_mut().zip(min.into_iter().chain(max)) {
            if let Some(place) = row.get_mut(lane) {
                *place = value;
            }
        }
    }

    /// One of the six rows.
    #[inline(always)]
    pub fn row(&self, row: Row) -> &[f32; 8] {
        // SAFETY: a `Row` is below 6 by construction.
        unsafe { self.rows.get_unchecked(row.0 as usize) }
    }
}

/// The index of a row of [`Boxes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row(u8);

impl Row {
    /// The row of least coordinates on this axis, 0 to 2 (taken modulo 3).
    #[inline(always)]
    pub const fn min(axis: usize) -> Row {
        Row((axis % 3) as u8)
    }

    /// The row of greatest coordinates on this axis, 0 to 2 (taken modulo 3).
    #[inline(always)]
    pub const fn max(axis: usize) -> Row {
        Row((axis % 3) as u8 + 3)
    }
}

/// The greatest `f32` that is at most `x`.
#[inline(always)]
pub fn round_down(x: f64) -> f32 {
    let y = x as f32;
    if y as f64 > x { y.next_down() } else { y }
}

/// The least `f32` that is at least `x`; NaN for NaN.
#[inline(always)]
pub fn round_up(x: f64) -> f32 {
    let y = x as f32;
    if (y as f64) < x { y.next_up() } else { y }
}

/// A ray ready for the slab test.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay<L: Lanes> {
    near: [Row; 3],
    far: [Row; 3],
    near_factor: [L::F; 3],
    near_offset: [L::F; 3],
    far_factor: [L::F; 3],
    far_offset: [L::F; 3],
}

impl<L: Lanes> SlabRay<L> {
    /// The ray that starts within `error` of `origin`.
    #[inline(always)]
    pub fn new(lanes: L, origin: DVec3, error: DVec3, direction: DVec3) -> Self {
        let zero = lanes.splat(0.0);
        let mut ray = SlabRay {
            near: [Row(0); 3],
            far: [Row(0); 3],
            near_factor: [zero; 3],
            near_offset: [zero; 3],
            far_factor: [zero; 3],
            far_offset: [zero; 3],
        };
        const LEAST: f64 = crate::math::exp2i(-100);
        const SLACK: f64 = crate::math::exp2i(-22);
        let (origin, error, direction) = (origin.to_array(), error.to_array(), direction.to_array());
        for axis in 0..3 {
            let (o, e, d) = (origin[axis], error[axis], direction[axis]);
            let d = if d.abs() < LEAST { LEAST.copysign(d) } else { d };
            let forward = d > 0.0;
            let inverse = 1.0 / d;
            let (near, far) = ((inverse * (1.0 - SLACK)) as f32, (inverse * (1.0 + SLACK)) as f32);
            // Forward, the origin counts as further on for the entry and as further back for the exit.
            let (near_origin, far_origin) = if forward { (o + e, o - e) } else { (o - e, o + e) };
            let (near_offset, far_offset) = if L::FUSED {
                // An offset is subtracted: a greater one makes the parameter smaller. These products and the sums
                // above round in f64 by less than 2^-51 (|o| + e) |r|, which the error radius has room for: it is
                // at least 4 * 2^-53 |o|, twice the error of o.
                (round_up(near_origin * near as f64), round_down(far_origin * far as f64))
            } else if forward {
                (round_up(near_origin), round_down(far_origin))
            } else {
                (round_down(near_origin), round_up(far_origin))
            };
            ray.near[axis] = if forward { Row::min(axis) } else { Row::max(axis) };
            ray.far[axis] = if forward { Row::max(axis) } else { Row::min(axis) };
            ray.near_factor[axis] = lanes.splat(near);
            ray.far_factor[axis] = lanes.splat(far);
            ray.near_offset[axis] = lanes.splat(near_offset);
            ray.far_offset[axis] = lanes.splat(far_offset);
        }
        ray
    }

    /// The boxes that the ray may meet between 0 and `limit`, one bit each, and where it enters them (at least +0).
    #[inline(always)]
    pub fn test(&self, lanes: L, boxes: &Boxes, limit: L::F) -> (u32, L::F) {
        let mut entry = lanes.splat(0.0);
        let mut exit = limit;
        for axis in 0..3 {
            let near = lanes.load(boxes.row(self.near[axis]));
            let far = lanes.load(boxes.row(self.far[axis]));
            let (near, far) = if L::FUSED {
                (
                    lanes.mul_sub(near, self.near_factor[axis], self.near_offset[axis]),
                    lanes.mul_sub(far, self.far_factor[axis], self.far_offset[axis]),
                )
            } else {
                (
                    lanes.mul(lanes.sub(near, self.near_offset[axis]), self.near_factor[axis]),
                    lanes.mul(lanes.sub(far, self.far_offset[axis]), self.far_factor[axis]),
                )
            };
            entry = lanes.max(near, entry);
            exit = lanes.min(far, exit);
        }
        (lanes.le(entry, exit), entry)
    }
}
