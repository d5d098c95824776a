//! Sixteen rays down the tree together, as a beam: for rays that go side by side, as a camera's do.
//!
//! Inner boxes are tested once for all rays, leaves with each ray. Source of the idea: Reshetov, Soupikov, Hurley
//! 2005, "Multi-level ray tracing algorithm" (doi:10.1145/1073204.1073329).

use super::Geometry;
use super::frame::{PACKET, Side};
use super::query::Query;
use super::store::Store;
use super::traverse::{STACK, entry, unpack};
use super::tree::Child;
use crate::Ray;
use crate::kernel::{Beam, BeamShape, EightRays, Lanes, Room, at_least};
use crate::math::exp2i;

/// Fewer rays are not worth a beam.
const FEWEST: u32 = 4;

/// A beam visits as many boxes as cross it. Up to this many times those that cross a ray, it still costs less than its
/// sixteen rays one by one: it decides time only.
const MOST_SPREAD: f64 = 64.0;

/// The rays of a packet and their queries.
pub(super) struct Packet<'a, Q> {
    pub rays: &'a [Ray],
    /// Places without a ray repeat another.
    pub side: Side,
    pub queries: [Q; PACKET],
    /// The rays that take part, one bit each.
    pub active: u32,
}

/// The beam of a packet's rays.
pub(super) struct Bundle {
    pub shape: BeamShape,
    /// The largest |coordinate| of the origins.
    far: f32,
    /// Where each ray begins, in depth of the beam, and how fast it gets deeper.
    start: [[f32; 8]; 2],
    depth: [[f32; 8]; 2],
}

/// The sums and products of a ray's depth err by less than 2^-22 of their parts.
const STEP: f32 = 1.0 / 1_048_576.0;

impl Bundle {
    /// An upper bound of the depth at which a ray ends.
    #[inline(always)]
    fn end(&self, i: usize, limit: f32) -> f32 {
        let along = limit * self.depth[i / 8 % 2][i % 8];
        let (more, less) = (along * (1.0 + STEP), along * (1.0 - STEP));
        (if more > less { more } else { less }) + (self.start[i / 8 % 2][i % 8] + (self.far + 1.0) * STEP)
    }

    /// The same for eight rays.
    #[inline(always)]
    fn ends<L: Lanes>(&self, lanes: L, half: usize, limit: &[f32; 8]) -> [f32; 8] {
        let along = lanes.mul(lanes.load(limit), lanes.load(&self.depth[half % 2]));
        let along =
            lanes.max(lanes.mul(along, lanes.splat(1.0 + STEP)), lanes.mul(along, lanes.splat(1.0 - STEP)));
        let start = lanes.add(lanes.load(&self.start[half % 2]), lanes.splat((self.far + 1.0) * STEP));
        lanes.store(lanes.add(along, start))
    }
}

/// Least and greatest of sixteen.
#[inline(always)]
fn span<L: Lanes>(lanes: L, a: L::F, b: L::F) -> [f32; 2] {
    [lanes.least(lanes.min(a, b)), lanes.greatest(lanes.max(a, b))]
}

/// The beam that holds the rays, if they go side by side closely enough. `box_size` is that of a typical shape.
///
/// In `f32`. With m the largest |coordinate| of an origin and v = 2^-24: a slope is the quotient of two rounded numbers,
/// made in two steps, and errs by 4.1 v of itself. A position is `o - s (z - plane)` with origins that err by v m, and
/// |z - plane| <= 2 m: it errs by less than 2 v m + 15 v |s| m, less than 2^-20 m (1 + |s|).
#[inline(always)]
fn bundle<L: Lanes>(lanes: L, side: &Side, box_size: f64) -> Option<Bundle> {
    let [x, y, z] = side.direction[0].map(|d| d[0].abs());
    let axis = if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    };
    let sign = 1.0_f32.copysign(side.direction[0][axis][0]);
    let signs = lanes.splat(sign);
    let [low, high] = [&side.direction[0][axis], &side.direction[1][axis]];
    let depth = [lanes.mul(lanes.load(low), signs), lanes.mul(lanes.load(high), signs)];
    // Not for slopes beyond 4, nor for rays without a place.
    if !(lanes.least(lanes.min(depth[0], depth[1])) >= 0.5 && side.error < 1.0) {
        return None;
    }
    let inverse = [lanes.inverse(depth[0]), lanes.inverse(depth[1])];
    let origin = [lanes.load(&side.origin[0][axis]), lanes.load(&side.origin[1][axis])];
    let [least, most] = span(lanes, origin[0], origin[1]);
    let plane = if sign > 0.0 { least } else { most };
    let planes = lanes.splat(plane);
    let start = [
        lanes.mul(lanes.sub(origin[0], planes), signs),
        lanes.mul(lanes.sub(origin[1], planes), signs),
    ];
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let mut far = larger(least.abs(), most.abs());
    let (mut position, mut slope) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
    let mut spread = 1.0;
    for i in 0..2 {
        let k = (axis + 1 + i) % 3;
        let origin = [lanes.load(&side.origin[0][k]), lanes.load(&side.origin[1][k])];
        let direction = [lanes.load(&side.direction[0][k]), lanes.load(&side.direction[1][k])];
        let slopes = [lanes.mul(direction[0], inverse[0]), lanes.mul(direction[1], inverse[1])];
        let [a, b] = span(
            lanes,
            lanes.sub(origin[0], lanes.mul(slopes[0], start[0])),
            lanes.sub(origin[1], lanes.mul(slopes[1], start[1])),
        );
        let [c, d] = span(lanes, slopes[0], slopes[1]);
        let [least, most] = span(lanes, origin[0], origin[1]);
        far = larger(far, larger(least.abs(), most.abs()));
        position[i] = [f64::from(a), f64::from(b)];
        slope[i] = [f64::from(c), f64::from(d)];
        // Where the beam is half a scene deep.
        spread *= 1.0 + f64::from((b - a) + (d - c) * 0.5) / box_size;
    }
    let shape = BeamShape {
        axis,
        sign: f64::from(sign),
        plane: f64::from(plane),
        position,
        slope,
        error: side.error + f64::from(far) * exp2i(-20),
    };
    let [a, b, c, d] =
        [lanes.store(start[0]), lanes.store(start[1]), lanes.store(depth[0]), lanes.store(depth[1])];
    (spread <= MOST_SPREAD).then_some(Bundle { shape, far, start: [a, b], depth: [c, d] })
}

impl<Q: Query> Packet<'_, Q> {
    /// The beam of the rays, if there are enough, and go side by side closely enough.
    #[inline(always)]
    pub fn bundle<L: Lanes>(&self, lanes: L, box_size: f64) -> Option<Bundle> {
        if self.active.count_ones() < FEWEST { None } else { bundle(lanes, &self.side, box_size) }
    }

    /// Shows each ray's query the shapes that the ray may hit.
    #[inline(always)]
    pub fn traverse<L: Lanes>(&mut self, lanes: L, geometry: &Geometry, bundle: &Bundle) {
        let beam = Beam::new(lanes, &bundle.shape);
        let Side { origin, direction, .. } = &self.side;
        let rays = [
            EightRays::new(lanes, &origin[0], &direction[0]),
            EightRays::new(lanes, &origin[1], &direction[1]),
        ];
        // The end of each ray, and that of the beam at the same place.
        let mut limits = self.side.limit;
        let mut depths = [bundle.ends(lanes, 0, &limits[0]), bundle.ends(lanes, 1, &limits[1])];
        let pad = at_least((f64::from(bundle.far) + 1.0) * exp2i(-21) + self.side.error);
        let ball_pad = at_least((f64::from(bundle.far) + 1.0) * exp2i(-18) + self.side.error);
        let mut end = lanes.greatest(lanes.max(lanes.load(&depths[0]), lanes.load(&depths[1])));

        let mut room = Room::<STACK>::default();
        let mut stack = room.enter();
        let mut indices = 0..geometry.tree.roots;
        'node: loop {
            let base = stack.len();
            for index in indices {
                let Some(node) = geometry.tree.nodes.get(index) else { continue };
                let (mut mask, at) = beam.test(lanes, &node.boxes, lanes.splat(end));
                let at = lanes.store(at);
                while mask != 0 {
                    let i = mask.trailing_zeros() as usize & 7;
                    mask &= mask - 1;
                    // A leaf is remembered by its place in the node, for its box.
                    let child = node.children[i];
                    let place = if child.as_node().is_some() { child } else { Child::place(index, i) };
                    stack.insert_descending(base, entry(at[i], place));
                }
            }
            while let Some(top) = stack.pop() {
                let (at, child) = unpack(top);
                if !(at <= end) {
                    continue;
                }
                if let Some(next) = child.as_node() {
                    indices = next..next + 1;
                    continue 'node;
                }
                let (node, lane) = child.as_place();
                let Some(node) = geometry.tree.nodes.get(node) else { continue };
                let (min, max) = node.boxes.corners(lane);
                let run = node.children[lane].run();
                let (low, high) = if run.kind == Store::BALL && run.count == 1 {
                    (
                        rays[0].test_ball(lanes, min, max, ball_pad, &limits[0]),
                        rays[1].test_ball(lanes, min, max, ball_pad, &limits[1]),
                    )
                } else {
                    (
                        rays[0].test(lanes, min, max, pad, &limits[0]),
                        rays[1].test(lanes, min, max, pad, &limits[1]),
                    )
                };
                let mut mask = (low | high << 8) & self.active;
                let mut changed = false;
                while mask != 0 {
                    let i = mask.trailing_zeros() as usize & (PACKET - 1);
                    mask &= mask - 1;
                    let Some(ray) = self.rays.get(i) else { continue };
                    let before = self.queries[i].limit();
                    let flow = geometry.store.visit(run, ray, &mut self.queries[i]);
                    if flow.is_break() {
                        self.active &= !(1 << i);
                        (limits[i / 8][i % 8], depths[i / 8][i % 8]) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
                        changed = true;
                    } else if self.queries[i].limit() != before {
                        let limit = self.side.limit_of(i, self.queries[i].limit());
                        (limits[i / 8][i % 8], depths[i / 8][i % 8]) = (limit, bundle.end(i, limit));
                        changed = true;
                    }
                }
                if changed {
                    if self.active == 0 {
                        return;
                    }
                    end = lanes.greatest(lanes.max(lanes.load(&depths[0]), lanes.load(&depths[1])));
                }
            }
            return;
        }
    }
}
