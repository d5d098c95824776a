//! A ray against eight boxes: the conservative slab test.
//!
//! Box tests run in *kernel coordinates*, in which the scene lies in [-1, 1]: see `geometry::frame`, which makes the
//! rays. A box test may only cull: it never rejects a box that the exact ray passes through.
//!
//! Per axis, the parameters at which the ray enters and leaves the slab of a box are `(x - o) / d`. Both ends are moved outward
//! by a `step`: for `d > 0`, `o'` is `o + step` at the entry and `o - step` at the exit. In `f32`, with v = 2^-24, the test is
//! `x * r + c`, `r` being `1 / d` and `c` being `-o' / d`, each made in `f64` and rounded to nearest. What is given to it has |r| from
//! 2^-60 to 2^100, and no NaN: see `geometry::course`. Errors are told as distances along the axis, that is, divided by |1 / d|:
//! - The roundings of `r` and, without fused multiply-add, of the product: v |x| each, and |x| <= 1.
//! - That of `c`: v |o'|.
//! - That of the sum: v |x - o'|, at most v (1 + |o'|).
//! - What is lost in `f64` before: less than v / 2^20 of the same.
//! - Altogether less than v (3 + 2 |o'|) (1 + 2^-20). The step is the error radius of `o`, e, and 4 v (1 + |o| + e): more by at
//!   least v / 2 (1 + |o|). Results below the normal range err by 2^-150 at most: |r| is at least 2^-60, so that is far less.
//! - Hence an entry is less than the true one, and an exit that is truly at least 0 is positive and greater than the true one: where
//!   the true ones are in order, these are not equal. A negative entry counts as 0.
//! - An axis along which the ray moves by less than 2^-100 of what it does along another is treated as if it did by that much. Up to
//!   the far side of the scene it comes at most 10 along any axis, so this moves it by less than 2^-96, which the step has to spare:
//!   the slab rejects if `o'` lies outside, else its exit is at least what is spared times 2^100, beyond the scene. So is one along which
//!   a ray of the short way does not move, by an inverse of 2^100: see `geometry::course`.
//! - There is no NaN: origins (at most about 8, see `geometry::frame`), `r` (at most 2^100) and their products are finite,
//!   and no `r` is 0. Rays that nothing is known of have a large step, not an infinite one. Empty boxes are infinite, and
//!   so are their entries.

use super::Lanes;

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

/// The step by which slabs are moved outward for a ray whose start is known to `error` and lies within `far` of the scene's
/// centre along each axis, in kernel coordinates.
pub const fn outward_step(error: f64, far: f64) -> f64 {
    const FOUR_ROUNDINGS: f64 = crate::math::exp2i(-22);
    error + (1.0 + far + error) * FOUR_ROUNDINGS
}

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
    factor: [L::F; 3],
    near_offset: [L::F; 3],
    far_offset: [L::F; 3],
}

impl<L: Lanes> SlabRay<L> {
    /// The ray by its start and one over its direction, by axis, of a size from 2^-60 to 2^100, and how far slabs are moved: see
    /// [`outward_step`]. The signs of the inverse are also given by themselves, by any numbers that have them: they are wanted first.
    ///
    /// From the inverse to the test there are a product, a rounding and the copy to all lanes: a ray waits for all of that before
    /// its first node.
    #[inline(always)]
    pub fn new(lanes: L, origin: L::D, step: f64, signs: L::D, inverse: L::D) -> Self {
        let back = lanes.signs4(signs);
        let step = lanes.copy_sign4(lanes.splat4(step), signs);
        let near = lanes.neg4(lanes.add4(origin, step));
        let far = lanes.sub4(step, origin);
        let factor = lanes.round4(inverse);
        let near_offset = lanes.round4(lanes.mul4(near, inverse));
        let far_offset = lanes.round4(lanes.mul4(far, inverse));
        let (x, y, z) = (Row::ends(0, back & 1), Row::ends(1, back >> 1 & 1), Row::ends(2, back >> 2 & 1));
        // No closure makes a register, or anything: one that is not inlined is compiled without the instruction set.
        SlabRay {
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
            factor: [lanes.splat(factor[0]), lanes.splat(factor[1]), lanes.splat(factor[2])],
            near_offset: [
                lanes.splat(near_offset[0]),
                lanes.splat(near_offset[1]),
                lanes.splat(near_offset[2]),
            ],
            far_offset: [lanes.splat(far_offset[0]), lanes.splat(far_offset[1]), lanes.splat(far_offset[2])],
        }
    }

    /// Where the ray enters and leaves the slabs of the boxes on an axis. Not a closure: see [`new`](SlabRay::new).
    #[inline(always)]
    fn slab(&self, lanes: L, boxes: &Boxes, axis: usize) -> (L::F, L::F) {
        (
            lanes.mul_add(lanes.load(boxes.row(self.near[axis])), self.factor[axis], self.near_offset[axis]),
            lanes.mul_add(lanes.load(boxes.row(self.far[axis])), self.factor[axis], self.far_offset[axis]),
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
