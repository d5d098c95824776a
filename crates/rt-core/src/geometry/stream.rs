//! Several rays in flight: for rays that have nothing in common, in scenes larger than the cache. While one ray waits
//! for memory, others compute.

use super::Geometry;
use super::frame::LocalRay;
use super::query::Query;
use super::traverse::{STACK, descend, unpack};
use super::tree::Child;
use crate::Ray;
use crate::kernel::{Lanes, Room, SlabRay};

/// A ray on its way down the tree.
struct Flight<'a, L: Lanes, Q> {
    ray: &'a Ray,
    number: usize,
    local: LocalRay,
    slab: SlabRay<L>,
    query: Q,
    limit: f32,
    child: Child,
    room: Room<STACK>,
}

impl<'a, L: Lanes, Q: Query> Flight<'a, L, Q> {
    #[inline(always)]
    fn new(lanes: L, (number, ray, local, query): (usize, &'a Ray, LocalRay, Q)) -> Self {
        Flight {
            ray,
            number,
            slab: SlabRay::new(lanes, local.origin, local.error, local.inverse),
            limit: local.limit(query.end()),
            local,
            query,
            child: Child::node(0),
            room: Room::default(),
        }
    }

    /// Visits one node or leaf and asks for the memory of the next; false at the end.
    #[inline(always)]
    fn advance(&mut self, lanes: L, geometry: &Geometry) -> bool {
        let mut stack = self.room.enter();
        let next = match self.child.as_node() {
            Some(index) => {
                let tree = &geometry.tree;
                // Not by `and_then`: a closure that is not inlined is compiled without the instruction set.
                match tree.nodes.get(index) {
                    Some(node) => descend(lanes, tree, node, &self.slab, self.limit, &mut stack),
                    None => None,
                }
            }
            None => {
                if geometry.store.visit(self.child.run(), self.ray, &mut self.query).is_break() {
                    return false;
                }
                self.limit = self.local.limit(self.query.end());
                None
            }
        };
        self.child = match next {
            Some(next) => next,
            None => loop {
                let Some(top) = stack.pop() else {
                    return false;
                };
                let (at, child) = unpack(top);
                if at <= self.limit {
                    break child;
                }
            },
        };
        stack.leave();
        match self.child.as_node() {
            Some(index) => {
                if let Some(node) = geometry.tree.nodes.get(index) {
                    lanes.prefetch(node);
                }
            }
            None => geometry.store.prefetch(lanes, self.child.run()),
        }
        true
    }
}

/// Takes rays from `next` and down the tree, `N` at a time, and hands each query to `done` with the ray's number.
#[inline(always)]
pub(super) fn interleave<'a, const N: usize, L: Lanes, Q: Query>(
    lanes: L,
    geometry: &Geometry,
    mut next: impl FnMut() -> Option<(usize, &'a Ray, LocalRay, Q)>,
    mut done: impl FnMut(usize, Q),
) {
    let mut flights = [const { None::<Flight<L, Q>> }; N];
    // Not by closures handed on: see `SlabRay::new`.
    for slot in &mut flights {
        match next() {
            Some(start) => *slot = Some(Flight::new(lanes, start)),
            None => break,
        }
    }
    let mut busy = true;
    while busy {
        busy = false;
        for slot in &mut flights {
            if let Some(flight) = slot {
                busy = true;
                if !flight.advance(lanes, geometry) {
                    if let Some(Flight { number, query, .. }) = slot.take() {
                        done(number, query);
                    }
                    if let Some(start) = next() {
                        *slot = Some(Flight::new(lanes, start));
                    }
                }
            }
        }
    }
}
