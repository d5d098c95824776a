//! Some rays down the tree together, as a beam: for rays that go side by side, as a camera's do.
//!
//! Inner boxes are tested once for all rays, leaves with each ray. Source of the idea: Reshetov, Soupikov, Hurley
//! 2005, "Multi-level ray tracing algorithm" (doi:10.1145/1073204.1073329).

use super::frame::{GROUPS, PACKET, Side};
use super::query::Query;
use super::rings::{Rings, Settle, Together, settle};
use super::store::Store;
use super::tile::Tile;
use super::traverse::{STACK, entry, unpack};
use super::tree::{Child, Node};
use super::{CACHE, Geometry};
use crate::Ray;
use crate::kernel::{Beam, BeamShape, EightRays, Lanes, Room, at_least};
use crate::math::exp2i;
use core::ops::Range;

/// Fewer rays are not worth a beam.
const FEWEST: u32 = 4;

/// A beam visits as many boxes as cross it. Up to this many times those that cross a ray, it still costs less than its
/// rays one by one: it decides time only.
const MOST_SPREAD: f64 = 64.0;

/// The rays of a packet and their queries.
pub(super) struct Packet<'a, Q> {
    pub rays: &'a [Ray],
    /// Which of the rays they are.
    pub tile: Tile,
    /// Places without a ray repeat another.
    pub side: Side,
    pub queries: [Q; PACKET],
    /// The rays that take part, one bit each.
    pub active: u32,
    /// The tori that they may meet.
    pub rings: Rings,
}

/// The bits of these groups' rays.
fn mask_of(groups: &Range<usize>) -> u32 {
    let below = |group: usize| ((1_u64 << (8 * group)) - 1) as u32;
    below(groups.end) & !below(groups.start)
}

/// The greatest of all.
#[inline(always)]
fn greatest<L: Lanes>(lanes: L, all: &[[f32; 8]; GROUPS]) -> f32 {
    let mut most = lanes.load(&all[0]);
    for group in &all[1..] {
        most = lanes.max(most, lanes.load(group));
    }
    lanes.greatest(most)
}

/// The beam of a packet's rays.
pub(super) struct Bundle {
    pub shape: BeamShape,
    /// The largest |coordinate| of the origins.
    far: f32,
    /// Where each ray begins, in depth of the beam, and how fast it gets deeper.
    start: [[f32; 8]; GROUPS],
    depth: [[f32; 8]; GROUPS],
    /// The rays it holds, by eight.
    groups: Range<usize>,
}

/// The sums and products of a ray's depth err by less than 2^-22 of their parts.
const STEP: f32 = 1.0 / 1_048_576.0;

impl Bundle {
    /// Upper bounds of the depths at which the rays of a group end.
    #[inline(always)]
    fn ends<L: Lanes>(&self, lanes: L, group: usize, limit: &[f32; 8]) -> [f32; 8] {
        let along = lanes.mul(lanes.load(limit), lanes.load(&self.depth[group % GROUPS]));
        let along =
            lanes.max(lanes.mul(along, lanes.splat(1.0 + STEP)), lanes.mul(along, lanes.splat(1.0 - STEP)));
        let start = lanes.add(lanes.load(&self.start[group % GROUPS]), lanes.splat((self.far + 1.0) * STEP));
        lanes.store(lanes.add(along, start))
    }
}

/// Least and greatest so far, in each lane.
#[derive(Clone, Copy)]
struct Span<L: Lanes>(L::F, L::F);

impl<L: Lanes> Span<L> {
    #[inline(always)]
    fn new(lanes: L) -> Self {
        Span(lanes.splat(f32::INFINITY), lanes.splat(f32::NEG_INFINITY))
    }

    #[inline(always)]
    fn add(&mut self, lanes: L, x: L::F) {
        (self.0, self.1) = (lanes.min(self.0, x), lanes.max(self.1, x));
    }

    #[inline(always)]
    fn ends(&self, lanes: L) -> [f32; 2] {
        [lanes.least(self.0), lanes.greatest(self.1)]
    }
}

/// The beam that holds the rays, if they go side by side closely enough. `box_size` is that of a typical shape.
///
/// In `f32`. With m the largest |coordinate| of an origin and v = 2^-24: a slope is the quotient of two rounded numbers,
/// made in two steps, and errs by 4.1 v of itself. A position is `o - s (z - plane)` with origins that err by v m, and
/// |z - plane| <= 2 m: it errs by less than 2 v m + 15 v |s| m, less than 2^-20 m (1 + |s|).
#[inline(always)]
fn bundle<L: Lanes>(lanes: L, side: &Side, groups: Range<usize>, box_size: f64) -> Option<Bundle> {
    let first = groups.start % GROUPS;
    let [x, y, z] = [0, 1, 2].map(|k| side.direction[first][k][0].abs());
    let axis = if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    };
    let sign = 1.0_f32.copysign(side.direction[first][axis][0]);
    let signs = lanes.splat(sign);
    let (mut depth, mut start) = ([[0.0; 8]; GROUPS], [[0.0; 8]; GROUPS]);
    let mut inverse = [lanes.splat(0.0); GROUPS];
    let (mut depths, mut planes) = (Span::new(lanes), Span::new(lanes));
    for (origin, direction) in side.origin.iter().zip(&side.direction).skip(first).take(groups.len()) {
        depths.add(lanes, lanes.mul(lanes.load(&direction[axis]), signs));
        planes.add(lanes, lanes.load(&origin[axis]));
    }
    // Not for slopes beyond 4, nor for rays without a place.
    if !(depths.ends(lanes)[0] >= 0.5 && side.error < 1.0) {
        return None;
    }
    let [least, most] = planes.ends(lanes);
    let plane = if sign > 0.0 { least } else { most };
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let mut far = larger(least.abs(), most.abs());
    for group in groups.clone() {
        let group = group % GROUPS;
        let along = lanes.mul(lanes.load(&side.direction[group][axis]), signs);
        let begin = lanes.sub(lanes.load(&side.origin[group][axis]), lanes.splat(plane));
        inverse[group] = lanes.inverse(along);
        depth[group] = lanes.store(along);
        start[group] = lanes.store(lanes.mul(begin, signs));
    }
    let (mut position, mut slope) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
    let mut spread = 1.0;
    for i in 0..2 {
        let k = (axis + 1 + i) % 3;
        let (mut origins, mut slopes, mut positions) = (Span::new(lanes), Span::new(lanes), Span::new(lanes));
        for group in groups.clone() {
            let group = group % GROUPS;
            let origin = lanes.load(&side.origin[group][k]);
            let slope = lanes.mul(lanes.load(&side.direction[group][k]), inverse[group]);
            origins.add(lanes, origin);
            slopes.add(lanes, slope);
            positions.add(lanes, lanes.sub(origin, lanes.mul(slope, lanes.load(&start[group]))));
        }
        let ([a, b], [c, d]) = (positions.ends(lanes), slopes.ends(lanes));
        let [least, most] = origins.ends(lanes);
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
    (spread <= MOST_SPREAD).then_some(Bundle { shape, far, start, depth, groups })
}

impl<Q: Query + Together> Packet<'_, Q> {
    /// Shows each ray's query the shapes that the ray may hit, if there are enough rays, and they go side by side closely
    /// enough, all or one half. Returns those for which that was so, one bit each.
    #[inline(always)]
    pub fn search<L: Lanes>(&mut self, lanes: L, geometry: &Geometry) -> u32 {
        let active = self.active;
        // Halves of halves, down to one group.
        let mut rest = [const { 0..0 }; GROUPS];
        rest[0] = 0..GROUPS;
        let mut left = 1;
        let mut done = 0;
        while left > 0 {
            left -= 1;
            let groups = rest[left].clone();
            let members = active & mask_of(&groups);
            if members.count_ones() < FEWEST {
                continue;
            }
            let (start, middle, end) = (groups.start, (groups.start + groups.end) / 2, groups.end);
            match bundle(lanes, &self.side, groups, geometry.tree.box_size) {
                Some(bundle) => {
                    done |= members;
                    self.active = members;
                    self.traverse(lanes, geometry, &bundle);
                }
                None if start < middle => {
                    rest[left] = middle..end;
                    rest[left + 1] = start..middle;
                    left += 2;
                }
                None => {}
            }
        }
        done
    }

    /// Shows each ray's query the shapes that the ray may hit.
    #[inline(always)]
    fn traverse<L: Lanes>(&mut self, lanes: L, geometry: &Geometry, bundle: &Bundle) {
        let beam = Beam::new(lanes, &bundle.shape);
        self.rings.clear();
        let mut ends = Ends::new(lanes, &self.side, bundle);
        let fetch = geometry.tree.bytes() > CACHE;
        let mut room = Room::<STACK>::default();
        let mut stack = room.enter();
        let mut indices = 0..geometry.tree.roots;
        'node: loop {
            let base = stack.len();
            for index in indices {
                let Some(node) = geometry.tree.nodes.get(index) else { continue };
                let (mut mask, at) = beam.test(lanes, &node.boxes, lanes.splat(ends.most));
                let mut leaves = 0;
                if !Q::NEAREST_FIRST {
                    leaves = mask & node.leaves(lanes);
                    mask &= !leaves;
                }
                let at = lanes.store(at);
                while mask != 0 {
                    let i = mask.trailing_zeros() as usize & 7;
                    mask &= mask - 1;
                    // A leaf is remembered by its place in the node, for its box.
                    let child = node.children[i];
                    let place = match child.as_node() {
                        Some(next) => {
                            if fetch && let Some(node) = geometry.tree.nodes.get(next) {
                                lanes.prefetch(node);
                            }
                            child
                        }
                        None => {
                            if fetch {
                                geometry.store.prefetch(lanes, child.run());
                            }
                            Child::place(index, i)
                        }
                    };
                    if Q::NEAREST_FIRST {
                        stack.insert_descending(base, entry(at[i], place));
                    } else {
                        stack.push(entry(at[i], place));
                    }
                }
                while leaves != 0 {
                    let i = leaves.trailing_zeros() as usize & 7;
                    leaves &= leaves - 1;
                    self.visit(lanes, geometry, bundle, &mut ends, node, i);
                    if self.active == 0 {
                        return;
                    }
                }
            }
            while let Some(top) = stack.pop() {
                let (at, child) = unpack(top);
                if !(at <= ends.most) {
                    continue;
                }
                if let Some(next) = child.as_node() {
                    indices = next..next + 1;
                    continue 'node;
                }
                let (node, lane) = child.as_place();
                let Some(node) = geometry.tree.nodes.get(node) else { continue };
                self.visit(lanes, geometry, bundle, &mut ends, node, lane);
                if self.active == 0 {
                    return;
                }
            }
            self.settle(lanes, geometry, bundle, &mut ends, true);
            return;
        }
    }

    /// Shows the queries the shapes of a leaf whose rays may hit them.
    #[inline(always)]
    fn visit<L: Lanes>(
        &mut self,
        lanes: L,
        geometry: &Geometry,
        bundle: &Bundle,
        ends: &mut Ends,
        node: &Node,
        lane: usize,
    ) {
        let (min, max) = node.boxes.corners(lane);
        let run = node.children[lane & 7].run();
        let ball = run.kind == Store::BALL && run.count == 1;
        let mut mask = 0;
        for group in bundle.groups.clone() {
            let group = group % GROUPS;
            let (rays, limits) = (&ends.rays[group], &ends.limits[group]);
            let met = if ball {
                rays.test_ball(lanes, min, max, ends.ball_pad, limits)
            } else {
                rays.test(lanes, min, max, ends.pad, limits)
            };
            mask |= met << (8 * group);
        }
        mask &= self.active;
        if run.kind == Store::RING {
            for index in run.first..run.first + run.count {
                self.rings.add(index, mask);
                if self.rings.are_many() {
                    self.settle(lanes, geometry, bundle, ends, false);
                    mask &= self.active;
                }
            }
            return;
        }
        while mask != 0 {
            let i = mask.trailing_zeros() as usize & (PACKET - 1);
            mask &= mask - 1;
            let Some(ray) = self.rays.get(self.tile.place(i)) else { continue };
            let before = self.queries[i].end();
            let flow = geometry.store.visit(run, ray, &mut self.queries[i]);
            if flow.is_break() {
                self.active &= !(1 << i);
                ends.set(i, f32::NEG_INFINITY);
            } else if self.queries[i].end() != before {
                ends.set(i, self.side.limit_of(i, self.queries[i].end()));
            }
        }
        ends.follow(lanes, bundle);
    }
}

impl<Q: Query + Together> Packet<'_, Q> {
    /// Tells the queries of the tori that wait; of `all`, or of those that make eights.
    #[inline(always)]
    fn settle<L: Lanes>(
        &mut self,
        lanes: L,
        geometry: &Geometry,
        bundle: &Bundle,
        ends: &mut Ends,
        all: bool,
    ) {
        let store = &geometry.store;
        let (mut met, over) = settle(Settle {
            rings: &mut self.rings,
            store,
            rays: self.rays,
            tile: self.tile,
            queries: &mut self.queries,
            all,
        });
        if met == 0 {
            return;
        }
        self.active &= !over;
        while met != 0 {
            let i = met.trailing_zeros() as usize & (PACKET - 1);
            met &= met - 1;
            if over >> i & 1 == 1 {
                ends.set(i, f32::NEG_INFINITY);
            } else {
                ends.set(i, self.side.limit_of(i, self.queries[i].end()));
            }
        }
        ends.follow(lanes, bundle);
    }
}

/// The rays of a packet on their way, and where they end.
struct Ends {
    rays: [EightRays; GROUPS],
    /// The end of each ray.
    limits: [[f32; 8]; GROUPS],
    /// A depth of the beam at which all have ended.
    most: f32,
    /// The rays that end there, one bit each: while one of them does, no other end matters to the beam.
    last: u32,
    /// By how much boxes and balls are grown.
    pad: f32,
    ball_pad: f32,
}

impl Ends {
    #[inline(always)]
    fn new<L: Lanes>(lanes: L, side: &Side, bundle: &Bundle) -> Self {
        let far = f64::from(bundle.far);
        let mut ends = Ends {
            rays: [EightRays::EMPTY; GROUPS],
            limits: [[f32::NEG_INFINITY; 8]; GROUPS],
            most: 0.0,
            last: 0,
            pad: at_least((far + 1.0) * exp2i(-21) + side.error),
            ball_pad: at_least((far + 1.0) * exp2i(-18) + side.error),
        };
        for group in bundle.groups.clone() {
            let group = group % GROUPS;
            ends.rays[group] = EightRays::new(lanes, &side.origin[group], &side.direction[group]);
            ends.limits[group] = side.limit[group];
        }
        ends.follow(lanes, bundle);
        ends
    }

    /// Ends a ray; some time later, [`follow`](Ends::follow) does so with the beam.
    #[inline(always)]
    fn set(&mut self, place: usize, limit: f32) {
        self.limits[place / 8 % GROUPS][place % 8] = limit;
        self.last &= !(1 << (place % PACKET));
    }

    /// Ends the beam with its last rays.
    #[inline(always)]
    fn follow<L: Lanes>(&mut self, lanes: L, bundle: &Bundle) {
        if self.last != 0 {
            return;
        }
        let mut depths = [[f32::NEG_INFINITY; 8]; GROUPS];
        for group in bundle.groups.clone() {
            let group = group % GROUPS;
            depths[group] = bundle.ends(lanes, group, &self.limits[group]);
        }
        self.most = greatest(lanes, &depths);
        for (group, depths) in depths.iter().enumerate() {
            self.last |= lanes.le(lanes.splat(self.most), lanes.load(depths)) << (8 * group);
        }
    }
}

#[cfg(test)]
mod tests;
