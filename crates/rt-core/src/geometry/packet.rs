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
/// sixteen rays one by one (measured: from 10^2 to 10^6 spheres; ../rivals/acceleration).
const MOST_SPREAD: f64 = 64.0;

/// The rays of a packet in kernel coordinates.
pub(super) struct Packet<'a, Q> {
    pub rays: &'a [Ray],
    pub locals: [LocalRay; PACKET],
    pub queries: [Q; PACKET],
    /// The rays that take part, one bit each.
    pub active: u32,
}

/// Least and greatest.
fn span(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| {
        [if x < least { x } else { least }, if x > most { x } else { most }]
    })
}

impl<Q: Query> Packet<'_, Q> {
    fn active(&self) -> impl Iterator<Item = usize> + use<Q> {
        let mut mask = self.active;
        core::iter::from_fn(move || {
            let i = mask.trailing_zeros() as usize;
            mask &= mask.wrapping_sub(1);
            (i < PACKET).then_some(i)
        })
    }

    /// The beam that holds the rays, if they go side by side closely enough. `box_size` is that of a typical shape.
    #[inline(always)]
    pub fn beam(&self, box_size: f64) -> Option<BeamShape> {
        if self.active.count_ones() < FEWEST {
            return None;
        }
        let first = &self.locals[self.active().next()?];
        let size = first.direction.abs();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let sign = 1.0_f64.copysign(first.direction[axis]);
        let locals = || self.active().map(|i| &self.locals[i]);
        // Not for slopes beyond 4, nor for rays without a place.
        if !locals().all(|l| l.direction[axis] * sign >= 0.5 && l.origin.is_finite() && l.error.is_finite()) {
            return None;
        }
        let [least, most] = span(locals().map(|l| l.origin[axis]));
        let plane = if sign > 0.0 { least } else { most };
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let slope_of = |l: &LocalRay, k: usize| l.direction[k] / (l.direction[axis] * sign);
        let slope = others.map(|k| span(locals().map(|l| slope_of(l, k))));
        let position = others.map(|k| {
            span(locals().map(|l| l.origin[k] - slope_of(l, k) * ((l.origin[axis] - plane) * sign)))
        });
        // Where the beam is half a scene deep.
        let spread = |i: usize| {
            let ([a, b], [c, d]) = (position[i], slope[i]);
            1.0 + ((b - a) + (d - c) * 0.5) / box_size
        };
        // These quotients and products round by a few u of numbers below 4 * 16: the error radius of 2^-40 of them is
        // ample, and far below the resolution of f32.
        let error = locals().fold(0.0, |most: f64, l| most.max(l.error.max_element()));
        let error = error + crate::math::exp2i(-40);
        (spread(0) * spread(1) <= MOST_SPREAD).then_some(BeamShape {
            axis,
            sign,
            plane,
            position,
            slope,
            error,
        })
    }

    /// Shows each ray's query the shapes that the ray may hit.
    #[inline(always)]
    pub fn traverse<L: Lanes>(&mut self, lanes: L, geometry: &Geometry, shape: &BeamShape) {
        let beam = Beam::new(lanes, shape);
        let mut rays = [EightRays::default(); 2];
        // The end of each ray, and that of the beam at the same place.
        let mut limits = [[f32::NEG_INFINITY; 8]; 2];
        let mut depths = [f32::NEG_INFINITY; PACKET];
        let mut far = 0.0_f64;
        for i in self.active() {
            let local = &self.locals[i];
            rays[i / 8].set(i % 8, local.origin, local.direction);
            far = far.max(local.origin.abs().max_element());
            (limits[i / 8][i % 8], depths[i]) = self.ends(i, shape);
        }
        let pad = at_least((far + 1.0) * crate::math::exp2i(-21) + shape.error);
        let mut end = depths.iter().fold(f32::NEG_INFINITY, |a, &b| if b > a { b } else { a });

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
                    end = depths.iter().fold(f32::NEG_INFINITY, |a, &b| if b > a { b } else { a });
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
