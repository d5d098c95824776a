//! Several rays against one box or ball, and a beam that holds them against eight.

use super::{Boxes, Lanes, Row};

/// Eight rays side by side against one box or one ball.
#[derive(Clone, Copy, Debug)]
pub struct EightRays {
    origin: [[f32; 8]; 3],
    direction: [[f32; 8]; 3],
    inverse: [[f32; 8]; 3],
    /// `1 / |d|^2`.
    inverse_square: [f32; 8],
}

impl EightRays {
    /// No rays in particular.
    pub const EMPTY: EightRays = EightRays {
        origin: [[0.0; 8]; 3],
        direction: [[1.0; 8]; 3],
        inverse: [[1.0; 8]; 3],
        inverse_square: [1.0; 8],
    };

    /// The rays with these origins and directions, rounded to nearest, by axis. The largest coordinate of a direction is
    /// in [1, 2].
    #[inline(always)]
    pub fn new<L: Lanes>(lanes: L, origin: &[[f32; 8]; 3], direction: &[[f32; 8]; 3]) -> Self {
        let [x, y, z] = direction;
        let [x, y, z] = [lanes.load(x), lanes.load(y), lanes.load(z)];
        let square = lanes.add(lanes.add(lanes.mul(x, x), lanes.mul(y, y)), lanes.mul(z, z));
        let inverse = [lanes.inverse(x), lanes.inverse(y), lanes.inverse(z)];
        let [a, b, c] = inverse;
        EightRays {
            origin: *origin,
            direction: *direction,
            inverse: [lanes.store(a), lanes.store(b), lanes.store(c)],
            inverse_square: lanes.store(lanes.inverse(square)),
        }
    }

    /// The rays that may meet the box, grown by `pad`, between 0 and their limit.
    ///
    /// Per axis, `((x -+ pad) - o) * r` with `o` and `d` rounded to nearest; `pad` is at least 2^-22 of the largest
    /// |coordinate| of the origins and the scene (1), plus the error radius, so that it outweighs the roundings of `o` and
    /// of the difference (3 * 2^-24). Those of `d`, `r = 1 / d` and the product, 3 * 2^-24 of the parameter, are outweighed
    /// by a factor of 1 -+ 2^-22 on entry and exit. Either end of a slab may come first: rays of all signs go side by
    /// side.
    #[inline(always)]
    pub fn test<L: Lanes>(&self, lanes: L, min: [f32; 3], max: [f32; 3], pad: f32, limit: &[f32; 8]) -> u32 {
        const SLACK: f32 = 1.0 / 4_194_304.0;
        let mut entry = lanes.splat(0.0);
        let mut exit = lanes.splat(f32::INFINITY);
        for axis in 0..3 {
            let origin = lanes.load(&self.origin[axis]);
            let inverse = lanes.load(&self.inverse[axis]);
            let a = lanes.mul(lanes.sub(lanes.splat(min[axis] - pad), origin), inverse);
            let b = lanes.mul(lanes.sub(lanes.splat(max[axis] + pad), origin), inverse);
            entry = lanes.positive_max(lanes.min(a, b), entry);
            exit = lanes.positive_min(lanes.max(a, b), exit);
        }
        let entry = lanes.mul(entry, lanes.splat(1.0 - SLACK));
        let exit = lanes.min(lanes.mul(exit, lanes.splat(1.0 + SLACK)), lanes.load(limit));
        lanes.le(entry, exit)
    }

    /// The rays that may meet the ball that touches all sides of the box, grown by `pad`, between 0 and their limit.
    ///
    /// With `w` from the origin to the centre and `t = w.d / |d|^2`, the ray is nearest to the centre at `w - t d`. With
    /// m the largest |coordinate| of the origins, 1 that of the scene, and v = 2^-24: `w` errs by 2 v (1 + m) in a coordinate,
    /// of which the centre's share is what rounding did to the box; it is at most 1.8 (1 + m) long. `t |d|` errs by 8 v |w| and
    /// the error of `w`; both and the roundings of `d`, of the product and of the difference move the nearest place by
    /// less than 40 v (1 + m) in all. `pad` is at least 64 v (1 + m) = 2^-18 (1 + m), plus the error radius; squares err by
    /// 6 v of themselves. The parameters inside are within the radius of `t`, as |d| >= 1, and err by less than a pad.
    #[inline(always)]
    pub fn test_ball<L: Lanes>(
        &self,
        lanes: L,
        min: [f32; 3],
        max: [f32; 3],
        pad: f32,
        limit: &[f32; 8],
    ) -> u32 {
        const SLACK: f32 = 1.0 / 1_048_576.0;
        let edge = [max[0] - min[0], max[1] - min[1], max[2] - min[2]];
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let radius = larger(larger(edge[0], edge[1]), edge[2]) * 0.5 + pad;
        let (mut w, mut along) = ([lanes.splat(0.0); 3], lanes.splat(0.0));
        for (k, w) in w.iter_mut().enumerate() {
            let center = lanes.splat((min[k] + max[k]) * 0.5);
            *w = lanes.sub(center, lanes.load(&self.origin[k]));
            along = lanes.add(along, lanes.mul(*w, lanes.load(&self.direction[k])));
        }
        let t = lanes.mul(along, lanes.load(&self.inverse_square));
        let mut square = lanes.splat(0.0);
        for (w, direction) in w.iter().zip(&self.direction) {
            let l = lanes.sub(*w, lanes.mul(t, lanes.load(direction)));
            square = lanes.add(square, lanes.mul(l, l));
        }
        let reach = lanes.splat(radius + pad);
        lanes.all_le([
            (square, lanes.splat(radius * radius * (1.0 + SLACK))),
            (lanes.sub(t, reach), lanes.load(limit)),
            (lanes.splat(0.0), lanes.add(t, reach)),
        ])
    }
}

/// All rays of a packet at once: what they pass, at each depth along an axis they share, is an interval on either
/// other axis.
///
/// With `z` the depth from a common plane, every ray is at `x = c + s z` with `c` and `s` in known intervals (both other
/// axes alike). Over a box's range of depth, the least and the greatest `x` lie at its ends, which one the sign of the
/// slope tells.
#[derive(Clone, Copy, Debug)]
pub struct Beam<L: Lanes> {
    near: Row,
    far: Row,
    sign: L::F,
    near_offset: L::F,
    far_offset: L::F,
    sides: [BeamSide<L>; 2],
}

#[derive(Clone, Copy, Debug)]
struct BeamSide<L: Lanes> {
    min: Row,
    max: Row,
    low: L::F,
    low_slope: L::F,
    low_at_near: bool,
    high: L::F,
    high_slope: L::F,
    high_at_near: bool,
}

impl<L: Lanes> BeamSide<L> {
    /// Least and greatest position between these depths.
    #[inline(always)]
    fn ends(&self, lanes: L, near: L::F, far: L::F) -> (L::F, L::F) {
        let low_depth = if self.low_at_near { near } else { far };
        let high_depth = if self.high_at_near { near } else { far };
        (
            lanes.mul_add(self.low_slope, low_depth, self.low),
            lanes.mul_add(self.high_slope, high_depth, self.high),
        )
    }
}

/// The numbers of a [`Beam`], as `f64`.
#[derive(Clone, Copy, Debug)]
pub struct BeamShape {
    /// The axis of depth, 0 to 2.
    pub axis: usize,
    /// +1 or -1: the sign of the direction there.
    pub sign: f64,
    /// The depth's zero on that axis.
    pub plane: f64,
    /// For the next axis and the one after: least and greatest position at depth zero.
    pub position: [[f64; 2]; 2],
    /// The same for the change of position with depth.
    pub slope: [[f64; 2]; 2],
    /// The error radius of all these positions.
    pub error: f64,
}

impl<L: Lanes> Beam<L> {
    /// The beam, moved outward by all that the test can lose: the depths round by 2^-23 of the largest depth `z` (the
    /// scene ends at 1), their products with slopes by 2^-24 more, and the sums by 2^-24 of `|c| + |s| z`. Altogether
    /// less than 2^-22 (|s| z + |c|) in position; slopes, which may err by 5 * 2^-24 of themselves already, are moved outward
    /// by 2^-21.
    #[inline(always)]
    pub fn new(lanes: L, shape: &BeamShape) -> Self {
        const SLACK: f64 = crate::math::exp2i(-22);
        const SLOPE_SLACK: f64 = crate::math::exp2i(-21);
        let depth = shape.plane.abs() + 1.0;
        let side = |i: usize| {
            let axis = shape.axis + 1 + i;
            let ([low, high], [low_slope, high_slope]) = (shape.position[i], shape.slope[i]);
            let most = |a: f64, b: f64| if a.abs() > b.abs() { a.abs() } else { b.abs() };
            let slope = most(low_slope, high_slope);
            let pad = (slope * depth + most(low, high)) * (2.0 * SLACK) + shape.error * (1.0 + slope);
            BeamSide {
                min: Row::min(axis),
                max: Row::max(axis),
                low: lanes.splat((low - pad) as f32),
                low_slope: lanes.splat((low_slope - slope * SLOPE_SLACK) as f32),
                low_at_near: low_slope - slope * SLOPE_SLACK >= 0.0,
                high: lanes.splat((high + pad) as f32),
                high_slope: lanes.splat((high_slope + slope * SLOPE_SLACK) as f32),
                high_at_near: high_slope + slope * SLOPE_SLACK < 0.0,
            }
        };
        let plane = shape.plane * shape.sign;
        let pad = depth * SLACK + shape.error;
        let forward = shape.sign > 0.0;
        Beam {
            near: if forward { Row::min(shape.axis) } else { Row::max(shape.axis) },
            far: if forward { Row::max(shape.axis) } else { Row::min(shape.axis) },
            sign: lanes.splat(shape.sign as f32),
            near_offset: lanes.splat((-plane - pad) as f32),
            far_offset: lanes.splat((pad - plane) as f32),
            sides: [side(0), side(1)],
        }
    }

    /// The boxes that the beam may meet between the depths 0 and `limit`, one bit each, and their least depths (at
    /// least +0).
    #[inline(always)]
    pub fn test(&self, lanes: L, boxes: &Boxes, limit: L::F) -> (u32, L::F) {
        let near = lanes.mul_add(lanes.load(boxes.row(self.near)), self.sign, self.near_offset);
        let far = lanes.mul_add(lanes.load(boxes.row(self.far)), self.sign, self.far_offset);
        let near = lanes.positive_max(near, lanes.splat(0.0));
        let far = lanes.positive_min(far, limit);
        let [a, b] = &self.sides;
        let ((a_low, a_high), (b_low, b_high)) = (a.ends(lanes, near, far), b.ends(lanes, near, far));
        let mask = lanes.all_le([
            (near, far),
            (a_low, lanes.load(boxes.row(a.max))),
            (lanes.load(boxes.row(a.min)), a_high),
            (b_low, lanes.load(boxes.row(b.max))),
            (lanes.load(boxes.row(b.min)), b_high),
        ]);
        (mask, near)
    }
}
