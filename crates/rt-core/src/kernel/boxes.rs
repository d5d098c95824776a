//! A ray against eight boxes: the conservative slab test.
//!
//! Box tests run in *kernel coordinates*, in which the scene lies in [-1, 1]: see `geometry::frame`, which makes the
//! rays. A box test may only cull: it never rejects a box that the exact ray passes through.
//!
//! Per axis, the parameters at which the ray enters and leaves the slab are `(x - o) / d`. The origin is known as
//! `o +- e` with `e >= 2^-97`, `max |d_i|` lies in [1, 2), and `1 / d` is known within a rounding of `f64`. In `f32`, with
//! v = 2^-24, the test is `x * r + c`:
//! - The reciprocal `r` is rounded to `f32` after it was made smaller (entry) or larger (exit) in magnitude by the factor
//!   1 -+ 2^-22 = 1 -+ 4 v. That works in the wrong direction only where the parameter is negative, hence behind the start: there
//!   the entry counts as 0 anyway, and an exit keeps its sign.
//! - The origin is moved outward by `e + 4 v (|o| + e)`, to `o'`, and `c = -o' * r` is made of the reciprocal before it was
//!   rounded, and rounded itself.
//! - The roundings of `r` and, without fused multiply-add, of the product err by v each of `|x r|`, which is at most
//!   `|(x - o') r| + |o' r|`, that of `c` by v of `|o' r|`, that of the sum by v of itself: altogether by 3 v of the parameter,
//!   which the factor 1 -+ 4 v outweighs, and 3 v `|o' r|`, which the step outward does. What is lost in `f64` is far less.
//! - Results below the normal range err by 2^-150 at most, far less than `e * |r| >= 2^-98` moved them.
//! - An axis with `|d_i| < 2^-100` is treated as `2^-100`: no reciprocal is more than 2^100. Within the scene a parameter is at
//!   most about 2, so this moves the ray by less than 2^-98, which `e` covers with as much to spare: the slab rejects if
//!   `o +- e` lies outside, else its exit is at least `2^-98 * 2^100 = 4`, beyond the scene.
//! - Hence a positive entry is less than the true one (by v of itself or nearly so), and an exit that is truly at least 0 is
//!   positive and greater than the true one: where the true ones are in order, these are not equal.
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

    /// Both, the first that a ray meets first: `back` is 1 for one that goes back along the axis, else 0.
    #[inline(always)]
    const fn ends(axis: usize, back: u32) -> (Row, Row) {
        let step = (back & 1) as usize * (3 * size_of::<[f32; 8]>());
        (Row(Row::min(axis).0 + step), Row(Row::max(axis).0 - step))
    }
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

/// An `f32` that is at most `x` and not much less, as [`at_least`].
#[inline(always)]
pub fn at_most(x: f64) -> f32 {
    (x - x.abs() * STEP) as f32
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
    /// The ray that starts within `error` of `origin`, by one over its direction.
    ///
    /// The axes in lanes, without branches: rounded to nearest after a step outward of 2^-22, twice what that can lose.
    #[inline(always)]
    pub fn new(lanes: L, origin: DVec3, error: f64, inverse: DVec3) -> Self {
        const MOST: f64 = crate::math::exp2i(100);
        const SLACK: f64 = crate::math::exp2i(-22);
        let origin = lanes.load4([origin.x, origin.y, origin.z, 0.0]);
        let inverse = lanes.load4([inverse.x, inverse.y, inverse.z, 1.0]);
        let inverse = lanes.max4(lanes.min4(inverse, lanes.splat4(MOST)), lanes.splat4(-MOST));
        let back = lanes.lt4(inverse, lanes.splat4(0.0));
        let error = lanes.splat4(error + error * TWO_STEPS);
        let outward = lanes.add4(lanes.mul4(lanes.abs4(origin), lanes.splat4(TWO_STEPS)), error);
        // Parameters at which the origin's coordinates, and the steps outward, are zero: of the entry further on, of the exit
        // further back.
        let (zero, outward) = (lanes.mul4(origin, inverse), lanes.mul4(outward, lanes.abs4(inverse)));
        let (less, more) = (lanes.splat4(1.0 - SLACK), lanes.splat4(1.0 + SLACK));
        let near = lanes.round4(lanes.mul4(inverse, less));
        let far = lanes.round4(lanes.mul4(inverse, more));
        let near_offset = lanes.round4(lanes.mul4(lanes.add4(zero, outward), lanes.splat4(SLACK - 1.0)));
        let far_offset = lanes.round4(lanes.mul4(lanes.sub4(outward, zero), more));
        let (x, y, z) = (Row::ends(0, back & 1), Row::ends(1, back >> 1 & 1), Row::ends(2, back >> 2 & 1));
        // No closure makes a register, or anything: one that is not inlined is compiled without the instruction set.
        SlabRay {
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
            near_factor: [lanes.splat(near[0]), lanes.splat(near[1]), lanes.splat(near[2])],
            near_offset: [
                lanes.splat(near_offset[0]),
                lanes.splat(near_offset[1]),
                lanes.splat(near_offset[2]),
            ],
            far_factor: [lanes.splat(far[0]), lanes.splat(far[1]), lanes.splat(far[2])],
            far_offset: [lanes.splat(far_offset[0]), lanes.splat(far_offset[1]), lanes.splat(far_offset[2])],
        }
    }

    /// Where the ray enters and leaves the slabs of the boxes on an axis. Not a closure: see [`new`](SlabRay::new).
    #[inline(always)]
    fn slab(&self, lanes: L, boxes: &Boxes, axis: usize) -> (L::F, L::F) {
        (
            lanes.mul_add(
                lanes.load(boxes.row(self.near[axis])),
                self.near_factor[axis],
                self.near_offset[axis],
            ),
            lanes.mul_add(
                lanes.load(boxes.row(self.far[axis])),
                self.far_factor[axis],
                self.far_offset[axis],
            ),
        )
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
