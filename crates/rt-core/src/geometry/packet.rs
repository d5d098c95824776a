//! Sixteen rays down the tree together, as a beam: for rays that go side by side, as a camera's do.
//!
//! Inner boxes are tested once for all rays, leaves with each ray. Source of the idea: Reshetov, Soupikov, Hurley
//! 2005, "Multi-level ray tracing algorithm" (doi:10.1145/1073204.1073329).

use super::Geometry;
use super::frame::LocalRay;
use super::query::Query;
use super::traverse::{STACK, entry, unpack};
use super::tree::Child;
use crate::Ray;
use crate::kernel::{Beam, BeamShape, EightRays, Lanes, Stack, at_least};

/// The rays of a packet.
pub(super) const PACKET: usize = 16;

/// Fewer rays are not worth a beam.
const FEWEST: u32 = 4;

/// A beam visits as many boxes as cross it. Up to this many times those that cross a ray, it still costs less than its
/// sixteen rays one by one: it decides time only.
const MOST_SPREAD: f64 = 64.0;

/// The rays of a packet in kernel coordinates, by axis. Places without a ray repeat another.
pub(super) struct Places {
    origin: [[f64; PACKET]; 3],
    direction: [[f64; PACKET]; 3],
    /// The largest error radius of all.
    error: f64,
}

/// The rays of a packet and their queries.
pub(super) struct Packet<'a, Q> {
    pub rays: &'a [Ray],
    pub locals: [LocalRay; PACKET],
    pub queries: [Q; PACKET],
    /// The rays that take part, one bit each.
    pub active: u32,
}

/// Least and greatest, in halves, so that the compiler uses whole registers.
#[inline(always)]
fn span(values: &[f64; PACKET]) -> [f64; 2] {
    let (mut least, mut most) = (*values, *values);
    let mut half = PACKET / 2;
    while half > 0 {
        for i in 0..half {
            least[i] = if least[i] < least[i + half] { least[i] } else { least[i + half] };
            most[i] = if most[i] > most[i + half] { most[i] } else { most[i + half] };
        }
        half /= 2;
    }
    [least[0], most[0]]
}

/// The greatest.
#[inline(always)]
fn greatest(values: &[f32; PACKET]) -> f32 {
    let mut most = *values;
    let mut half = PACKET / 2;
    while half > 0 {
        for i in 0..half {
            most[i] = if most[i] > most[i + half] { most[i] } else { most[i + half] };
        }
        half /= 2;
    }
    most[0]
}

impl<Q: Query> Packet<'_, Q> {
    /// The rays by axis, if there are enough.
    #[inline(always)]
    pub fn places(&self) -> Option<Places> {
        if self.active.count_ones() < FEWEST {
            return None;
        }
        let any = self.active.trailing_zeros() as usize & (PACKET - 1);
        let mut places = Places { origin: [[0.0; PACKET]; 3], direction: [[0.0; PACKET]; 3], error: 0.0 };
        for i in 0..PACKET {
            let local = &self.locals[if self.active >> i & 1 == 1 { i } else { any }];
            for axis in 0..3 {
                places.origin[axis][i] = local.origin[axis];
                places.direction[axis][i] = local.direction[axis];
            }
            let error = local.error.x + local.error.y + local.error.z;
            places.error = if error > places.error { error } else { places.error };
        }
        Some(places)
    }

    /// Shows each ray's query the shapes that the ray may hit.
    #[inline(always)]
    pub fn traverse<L: Lanes>(&mut self, lanes: L, geometry: &Geometry, places: &Places, shape: &BeamShape) {
        let beam = Beam::new(lanes, shape);
        let rays = [0, 8].map(|first| EightRays::new(&places.origin, &places.direction, first));
        // The end of each ray, and that of the beam at the same place.
        let mut limits = [[f32::NEG_INFINITY; 8]; 2];
        let mut depths = [f32::NEG_INFINITY; PACKET];
        for i in 0..PACKET {
            if self.active >> i & 1 == 1 {
                (limits[i / 8][i % 8], depths[i]) = self.ends(i, shape);
            }
        }
        let [least, most] = places.origin.iter().map(span).fold([0.0, 0.0], |[a, b]: [f64; 2], [c, d]| {
            [if c < a { c } else { a }, if d > b { d } else { b }]
        });
        let far = if most > -least { most } else { -least };
        let pad = at_least((far + 1.0) * crate::math::exp2i(-21) + shape.error);
        let mut end = greatest(&depths);

        let mut stack = Stack::<STACK>::default();
        let mut index = 0;
        'node: loop {
            if let Some(node) = geometry.tree.nodes.get(index) {
                let (mut mask, at) = beam.test(lanes, &node.boxes, lanes.splat(end));
                let at = lanes.store(at);
                let base = stack.len();
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
                    index = next;
                    continue 'node;
                }
                let (node, lane) = child.as_place();
                let Some(node) = geometry.tree.nodes.get(node) else { continue };
                let (min, max) = node.boxes.corners(lane);
                let low = rays[0].test(lanes, min, max, pad, &limits[0]);
                let high = rays[1].test(lanes, min, max, pad, &limits[1]);
                let mut mask = (low | high << 8) & self.active;
                let mut changed = false;
                while mask != 0 {
                    let i = mask.trailing_zeros() as usize & (PACKET - 1);
                    mask &= mask - 1;
                    let Some(ray) = self.rays.get(i) else { continue };
                    let before = self.queries[i].limit();
                    let flow = geometry.store.visit(node.children[lane].run(), ray, &mut self.queries[i]);
                    if flow.is_break() {
                        self.active &= !(1 << i);
                        (limits[i / 8][i % 8], depths[i]) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
                        changed = true;
                    } else if self.queries[i].limit() != before {
                        (limits[i / 8][i % 8], depths[i]) = self.ends(i, shape);
                        changed = true;
                    }
                }
                if changed {
                    if self.active == 0 {
                        return;
                    }
                    end = greatest(&depths);
                }
            }
            return;
        }
    }

    /// Where the query of a ray ends: along the ray, and in depth of the beam.
    #[inline(always)]
    fn ends(&self, i: usize, shape: &BeamShape) -> (f32, f32) {
        let local = &self.locals[i];
        let limit = local.limit(self.queries[i].limit());
        let start = (local.origin[shape.axis] - shape.plane) * shape.sign;
        let depth = start + f64::from(limit) * (local.direction[shape.axis] * shape.sign);
        (limit, at_least(depth + shape.error))
    }
}

impl Places {
    /// The beam that holds the rays, if they go side by side closely enough. `box_size` is that of a typical shape.
    #[inline(always)]
    pub fn beam(&self, box_size: f64) -> Option<BeamShape> {
        let size = self.direction.map(|d| d[0].abs());
        let axis = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        let sign = 1.0_f64.copysign(self.direction[axis][0]);
        let depth = self.direction[axis].map(|d| d * sign);
        // Not for slopes beyond 4, nor for rays without a place.
        if !(span(&depth)[0] >= 0.5 && self.error < 1.0) {
            return None;
        }
        let inverse = depth.map(|d| 1.0 / d);
        let [least, most] = span(&self.origin[axis]);
        let plane = if sign > 0.0 { least } else { most };
        let (mut position, mut slope) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        let mut spread = 1.0;
        for i in 0..2 {
            let k = (axis + 1 + i) % 3;
            let slopes: [f64; PACKET] = core::array::from_fn(|j| self.direction[k][j] * inverse[j]);
            let positions: [f64; PACKET] = core::array::from_fn(|j| {
                self.origin[k][j] - slopes[j] * ((self.origin[axis][j] - plane) * sign)
            });
            (position[i], slope[i]) = (span(&positions), span(&slopes));
            // Where the beam is half a scene deep.
            let ([a, b], [c, d]) = (position[i], slope[i]);
            spread *= 1.0 + ((b - a) + (d - c) * 0.5) / box_size;
        }
        // These quotients and products round by a few u of numbers below 4 * 16 (rays begin within 8 of the scene):
        // 2^-40 is ample, and far below the resolution of f32.
        let error = self.error + crate::math::exp2i(-40);
        (spread <= MOST_SPREAD).then_some(BeamShape { axis, sign, plane, position, slope, error })
    }
}
