//! Several rays in flight: for rays that have nothing in common, in scenes larger than the cache. While one ray waits
//! for memory, others compute.

use super::Geometry;
use super::course::Course;
use super::query::Query;
use super::traverse::{STACK, descend, unpack};
use super::tree::Child;
use crate::kernel::{Lanes, Room};
use crate::{Interval, Ray};

/// A ray on its way down the tree.
struct Flight<'a, L: Lanes, Q> {
    ray: &'a Ray,
    number: usize,
    course: Course<L>,
    query: Q,
    limit: f32,
    child: Child,
    room: Room<STACK>,
}

impl<'a, L: Lanes, Q: Query> Flight<'a, L, Q> {
    #[inline(always)]
    fn new(number: usize, ray: &'a Ray, course: Course<L>, query: Q) -> Self {
        let (limit, child, room) = (course.limit(query.end()), Child::node(0), Room::default());
        Flight { ray, number, course, query, limit, child, room }
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
                    Some(node) => descend(lanes, tree, node, &self.course.slab, self.limit, &mut stack),
                    None => None,
                }
            }
            None => {
                if geometry.store.visit(self.child.run(), self.ray, &mut self.query).is_break() {
                    return false;
                }
                self.limit = self.course.limit(self.query.end());
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

/// Takes legal rays from `next` and down the tree, `N` at a time, and hands each query to `done` with the ray's number.
///
/// Nothing in either closure may be of the instruction set's: they need not be inlined here, and are then compiled without it.
#[inline(always)]
pub(super) fn interleave<'a, const N: usize, L: Lanes, Q: Query>(
    lanes: L,
    geometry: &Geometry,
    mut next: impl FnMut() -> Option<(usize, &'a Ray, Interval, Q)>,
    mut done: impl FnMut(usize, Q),
) {
    let mut flights = [const { None::<Flight<L, Q>> }; N];
    let (mut are_left, mut busy) = (true, true);
    while busy {
        busy = false;
        for slot in &mut flights {
            if let Some(flight) = slot {
                if flight.advance(lanes, geometry) {
                    busy = true;
                    continue;
                }
                if let Some(Flight { number, query, .. }) = slot.take() {
                    done(number, query);
                }
            }
            while are_left {
                let Some((number, ray, within, query)) = next() else {
                    are_left = false;
                    break;
                };
                let frame = &geometry.frame;
                if let Some(legal) = frame.legal(lanes, ray, within)
                    && let Some(course) = frame.course(lanes, ray, within, legal)
                {
                    *slot = Some(Flight::new(number, ray, course, query));
                    busy = true;
                    break;
                }
                done(number, query);
            }
        }
    }
}
