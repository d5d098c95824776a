//! A ray against eight boxes: the conservative slab test.
//!
//! Box tests run in *kernel coordinates*, in which the scene lies in [-1, 1]: see `geometry::frame`, which makes the
//! rays. A box test may only cull: it never rejects a box that the exact ray passes through.
//!
//! Per axis, the parameters at which the ray enters and leaves the slab are `(x - o) / d`. The origin is known as
//! `o +- e` with `e >= 2^-97`, the direction `d` is exact, `max |d_i|` lies in [1, 2). In `f32`, with v = 2^-24:
//! - The reciprocal is rounded to `f32` after it was made smaller (entry) or larger (exit) in magnitude by the factor
//!   1 -+ 2^-22 = 1 -+ 4 v. That outweighs its own rounding, and those of the difference and of the product, 3 v
//!   together. It works in the wrong direction only where the parameter is negative, hence behind the start: there
//!   the entry counts as 0 anyway, and an exit keeps its sign.
//! - The origin is moved outward by `e + 4 v (|o| + e)`, to `o'`. Without fused multiply-add the test is `(x - o') * r`
//!   with `o'` rounded to nearest. With, it is `x * r + c`, where `c = -o' * r` is made of the reciprocal before it was
//!   rounded, and rounded itself: by both, 2 v `|o' r|` at most, half of the step outward. The sum is rounded once. What
//!   is lost in `f64` is far less.
//! - Results below the normal range err by 2^-150 at most, far less than `e * |r| >= 2^-98` moved them.
//! - An axis with `|d_i| < 2^-100` is treated as `2^-100`. Within the scene a parameter is at most about 2, so this
//!   moves the ray by less than 2^-98, which `e` covers with as much to spare: the slab rejects if `o +- e` lies
//!   outside, else its exit is at least `2^-98 * 2^100 = 4`, beyond the scene.
//! - Hence, with fused multiply-add, a positive entry is less than the true one (by v of itself or more), and an exit that
//!   is truly at least 0 is positive and greater than the true one: where the true ones are in order, these are not equal.
//! - There is no NaN: origins (at most about 8, see `geometry::frame`), `r` (at most 2^100) and their products are finite,
//!   and no `r` is 0. Rays that nothing is known of have a large error, not an infinite one. Empty boxes are infinite, and
//!   so are their entries.

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

    /// The corners of the box in this lane, taken modulo 8.
    #[inline(always)]
    pub fn corners(&self, lane: usize) -> ([f32; 3], [f32; 3]) {
        let lane = lane & 7;
        let [a, b, c, d, e, f] = &self.rows;
        ([a[lane], b[lane], c[lane]], [d[lane], e[lane], f[lane]])
    }

    /// One of the six rows.
    #[inline(always)]
    pub fn row(&self, row: Row) -> &[f32; 8] {
        // SAFETY: a `Row` is the place of one of the six rows by construction, and `f32` may lie at any multiple of four.
        unsafe { &*self.rows.as_ptr().byte_add(row.0) }
    }
}

/// The place of a row of [`Boxes`], in bytes from the first: nothing is left to compute for each node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row(usize);

impl Row {
    /// The row of least coordinates on this axis, 0 to 2 (taken modulo 3).
    #[inline(always)]
    pub const fn min(axis: usize) -> Row {
        Row(axis % 3 * size_of::<[f32; 8]>())
    }

    /// The row of greatest coordinates on this axis, 0 to 2 (taken modulo 3).
    #[inline(always)]
    pub const fn max(axis: usize) -> Row {
        Row((axis % 3 + 3) * size_of::<[f32; 8]>())
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

/// What a rounding to `f32` can lose, twice.
const STEP: f64 = crate::math::exp2i(-23);

/// The same, four times.
const TWO_STEPS: f64 = crate::math::exp2i(-22);

/// An `f32` that is at least `x` and not much more, without branches; for `x` above the subnormal numbers.
#[inline(always)]
pub fn at_least(x: f64) -> f32 {
    (x + x.abs() * STEP) as f32
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

/// What a [`SlabRay`] knows of an axis: its rows of least and greatest coordinates on the way, and factor and offset for each.
#[inline(always)]
fn axis<L: Lanes>(i: usize, o: f64, e: f64, d: f64) -> (Row, Row, f32, f32, f32, f32) {
    const LEAST: f64 = crate::math::exp2i(-100);
    const SLACK: f64 = crate::math::exp2i(-22);
    // Forward, the origin counts as further on for the entry and as further back for the exit.
    let outward = (e + (o.abs() + e) * TWO_STEPS).copysign(d);
    let (first, last) = (-(o + outward), outward - o);
    let d = (if d.abs() < LEAST { LEAST } else { d.abs() }).copysign(d);
    let inverse = 1.0 / d;
    let (near, far) = ((inverse * (1.0 - SLACK)) as f32, (inverse * (1.0 + SLACK)) as f32);
    let (near_offset, far_offset) = if L::FUSED {
        // Nothing waits for the division but one product.
        (first * (1.0 - SLACK) * inverse, last * (1.0 + SLACK) * inverse)
    } else {
        (first, last)
    };
    let (near_row, far_row) = if d > 0.0 { (Row::min(i), Row::max(i)) } else { (Row::max(i), Row::min(i)) };
    (near_row, far_row, near, near_offset as f32, far, far_offset as f32)
}

impl<L: Lanes> SlabRay<L> {
    /// The ray that starts within `error` of `origin`.
    ///
    /// Without branches: rounded to nearest after a step outward of 2^-22, twice what that can lose.
    #[inline(always)]
    pub fn new(lanes: L, origin: DVec3, error: DVec3, direction: DVec3) -> Self {
        let (o, e) = (origin, error);
        // No closure makes a register, or anything: one that is not inlined is compiled without the instruction set.
        let x = axis::<L>(0, o.x, e.x, direction.x);
        let y = axis::<L>(1, o.y, e.y, direction.y);
        let z = axis::<L>(2, o.z, e.z, direction.z);
        SlabRay {
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
            near_factor: [lanes.splat(x.2), lanes.splat(y.2), lanes.splat(z.2)],
            near_offset: [lanes.splat(x.3), lanes.splat(y.3), lanes.splat(z.3)],
            far_factor: [lanes.splat(x.4), lanes.splat(y.4), lanes.splat(z.4)],
            far_offset: [lanes.splat(x.5), lanes.splat(y.5), lanes.splat(z.5)],
        }
    }

    /// Where the ray enters and leaves the slabs of the boxes on an axis. Not a closure: see [`new`](SlabRay::new).
    #[inline(always)]
    fn slab(&self, lanes: L, boxes: &Boxes, axis: usize) -> (L::F, L::F) {
        let near = lanes.load(boxes.row(self.near[axis]));
        let far = lanes.load(boxes.row(self.far[axis]));
        if L::FUSED {
            (
                lanes.mul_add(near, self.near_factor[axis], self.near_offset[axis]),
                lanes.mul_add(far, self.far_factor[axis], self.far_offset[axis]),
            )
        } else {
            (
                lanes.mul(lanes.add(near, self.near_offset[axis]), self.near_factor[axis]),
                lanes.mul(lanes.add(far, self.far_offset[axis]), self.far_factor[axis]),
            )
        }
    }

    /// The boxes that the ray may meet between 0 and `limit`, one bit each, and where it enters them (at least +0).
    #[inline(always)]
    pub fn test(&self, lanes: L, boxes: &Boxes, limit: L::F) -> (u32, L::F) {
        let x = self.slab(lanes, boxes, 0);
        let y = self.slab(lanes, boxes, 1);
        let z = self.slab(lanes, boxes, 2);
        // A negative entry or exit need not be the right one.
        let entry =
            lanes.positive_max(lanes.positive_max(x.0, y.0), lanes.positive_max(z.0, lanes.splat(0.0)));
        let exit = lanes.positive_min(lanes.positive_min(x.1, y.1), lanes.positive_min(z.1, limit));
        (lanes.positive_lt(entry, exit), entry)
    }
}
