//! The tree of boxes: eight children a node.

use super::store::Run;
use crate::kernel::{Boxes, Lanes};
use alloc::vec::Vec;

/// Eight boxes and what they hold: four cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub boxes: Boxes,
    pub children: [Child; 8],
}

impl Node {
    pub const EMPTY: Node = Node { boxes: Boxes::EMPTY, children: [Child::NOTHING; 8] };

    /// The children that are leaves, one bit each.
    #[inline(always)]
    pub fn leaves<L: Lanes>(&self, lanes: L) -> u32 {
        lanes.large(self.children.map(|child| child.0))
    }
}

/// What a box holds: a node, or a few shapes of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// The bits of a run's first index.
    const FIRST_BITS: u32 = 25;
    /// The most shapes in a leaf.
    pub const MOST_SHAPES: usize = 4;
    /// The most shapes in a tree.
    pub const CAPACITY: usize = 1 << Self::FIRST_BITS;
    /// A run of a kind that does not exist.
    pub const NOTHING: Child = Child(u32::MAX);

    /// The node with this index, which must be less than 2^28.
    pub fn node(index: usize) -> Child {
        debug_assert!(index < 1 << 28);
        Child(index as u32)
    }

    /// A run of 1 to 4 shapes of one kind.
    pub fn leaf(run: Run) -> Child {
        debug_assert!(run.first < Self::CAPACITY && (1..=Self::MOST_SHAPES).contains(&run.count));
        let count = (run.count - 1) as u32;
        Child(Self::LEAF | run.kind << 27 | count << Self::FIRST_BITS | run.first as u32)
    }

    /// Not a child, but the place of one that is a leaf: told from a node, as a leaf is.
    #[inline(always)]
    pub fn place(node: usize, lane: usize) -> Child {
        Child(Self::LEAF | (node as u32) << 3 | lane as u32 & 7)
    }

    /// Node and lane of a [`place`](Child::place).
    #[inline(always)]
    pub fn as_place(self) -> (usize, usize) {
        ((self.0 & !Self::LEAF) as usize >> 3, self.0 as usize & 7)
    }

    /// The index of the node, if it is one.
    #[inline(always)]
    pub fn as_node(self) -> Option<usize> {
        (self.0 & Self::LEAF == 0).then_some(self.0 as usize)
    }

    /// The shapes, if it is a leaf.
    #[inline(always)]
    pub fn run(self) -> Run {
        Run {
            kind: self.0 >> 27 & 15,
            first: (self.0 & (Self::CAPACITY as u32 - 1)) as usize,
            count: (self.0 >> Self::FIRST_BITS & 3) as usize + 1,
        }
    }
}

/// The tree: the first nodes are its roots, one of them, all when the scene is small, or none when there is no bounded
/// shape.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub nodes: Vec<Node>,
    pub roots: usize,
    /// The mean edge of the shapes' boxes, in kernel coordinates.
    pub box_size: f64,
}

impl Tree {
    /// The bytes of memory in use.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }
}
