//! One ray down the tree, nearest boxes first.

use super::builder::{MOST_DEPTH, MOST_WITHOUT_TREE};
use super::course::Course;
use super::query::Query;
use super::store::Store;
use super::tree::{Child, Node, Tree};
use crate::Ray;
use crate::kernel::{Lanes, Room, SlabRay, Stack};
use core::ops::ControlFlow;

/// Each level leaves at most seven children behind.
pub(super) const STACK: usize = 7 * MOST_DEPTH + 8;
const _: () = assert!(MOST_WITHOUT_TREE <= STACK);

/// Where the ray enters a box, and what it holds, in one number that sorts by the former (not negative, so its bits
/// are in order).
#[inline(always)]
pub(super) fn entry(at: f32, child: Child) -> u64 {
    (at.to_bits() as u64) << 32 | child.0 as u64
}

/// The reverse of [`entry`].
#[inline(always)]
pub(super) fn unpack(entry: u64) -> (f32, Child) {
    (f32::from_bits((entry >> 32) as u32), Child(entry as u32))
}

/// Puts the boxes of a node that the ray meets on the stack, the nearest on top, and takes that.
#[inline(always)]
pub(super) fn descend<L: Lanes>(
    lanes: L,
    tree: &Tree,
    node: &Node,
    slab: &SlabRay<L>,
    limit: f32,
    stack: &mut Stack<STACK>,
) -> Option<Child> {
    let fetch = |child: Child| {
        if let Some(node) = tree.nodes.get(child.0 as usize) {
            lanes.prefetch(node);
        }
    };
    let (mut mask, at) = slab.test(lanes, &node.boxes, lanes.splat(limit));
    if mask == 0 {
        return None;
    }
    let first = mask.trailing_zeros() as usize & 7;
    mask &= mask - 1;
    if mask == 0 {
        return Some(node.children[first]);
    }
    let at = lanes.store(at);
    let (mut near, second) = (entry(at[first], node.children[first]), mask.trailing_zeros() as usize & 7);
    let mut far = entry(at[second], node.children[second]);
    if far < near {
        (near, far) = (far, near);
    }
    fetch(node.children[first]);
    fetch(node.children[second]);
    mask &= mask - 1;
    let base = stack.len();
    stack.push(far);
    while mask != 0 {
        let i = mask.trailing_zeros() as usize & 7;
        mask &= mask - 1;
        let mut next = entry(at[i], node.children[i]);
        fetch(node.children[i]);
        if next < near {
            (near, next) = (next, near);
        }
        stack.insert_descending(base, next);
    }
    Some(unpack(near).1)
}

/// Shows the query the shapes of the tree that the ray may hit, until it breaks.
#[inline(always)]
pub(super) fn traverse<L: Lanes, Q: Query>(
    lanes: L,
    tree: &Tree,
    store: &Store,
    ray: &Ray,
    course: &Course<L>,
    query: &mut Q,
) -> ControlFlow<()> {
    let slab = &course.slab;
    let mut end = query.end();
    let mut limit = course.limit(end);
    let mut room = Room::<STACK>::default();
    let mut stack = room.enter();
    let mut next = None;
    if tree.roots == 1 {
        next = Some(Child::node(0));
    } else {
        for node in tree.nodes.iter().take(tree.roots) {
            let (mut mask, at) = slab.test(lanes, &node.boxes, lanes.splat(limit));
            if mask == 0 {
                continue;
            }
            let at = lanes.store(at);
            while mask != 0 {
                let i = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                stack.insert_descending(0, entry(at[i], node.children[i]));
            }
        }
    }
    let mut child = match next {
        Some(child) => child,
        None => match stack.pop() {
            Some(top) => unpack(top).1,
            None => return ControlFlow::Continue(()),
        },
    };
    loop {
        match child.as_node() {
            Some(index) => {
                if let Some(node) = tree.nodes.get(index)
                    && let Some(next) = descend(lanes, tree, node, slab, limit, &mut stack)
                {
                    child = next;
                    continue;
                }
            }
            None => {
                store.visit(child.run(), ray, query)?;
                if query.end() != end {
                    end = query.end();
                    limit = course.limit(end);
                }
            }
        }
        child = loop {
            let Some(top) = stack.pop() else {
                return ControlFlow::Continue(());
            };
            let (at, child) = unpack(top);
            if at <= limit {
                break child;
            }
        };
    }
}
