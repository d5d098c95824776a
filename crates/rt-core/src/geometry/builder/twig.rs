//! The lower end of the tree: of all ways to put a few shapes into nodes of eight, by the splits of the surface area
//! heuristic, the one of least cost.
//!
//! Source: Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs"
//! (doi:10.1145/3105762.3105773), section 4.1.

use super::{Item, MOST_IN_TWIG, Part, fit_in_leaf, split};
use crate::geometry::store::Run;
use crate::geometry::tree::{Child, Node};
use alloc::vec::Vec;

/// What a shape in a leaf costs, in visits of a node. By trial (docs/performance.md): a leaf of one sphere is told from
/// beams by the ball in its box, two are not.
pub(super) const SHAPE: f32 = 1.5;
/// What the memory of a node costs, in visits of a node as large as a shape's share of the whole's area. By trial: all nodes
/// together take about 50 bytes a shape.
pub(super) const MEMORY: f32 = 1.2;

/// A part of the shapes, as a node of a tree of two children a node.
#[derive(Clone, Copy)]
struct Fork {
    part: Part,
    /// Its halves, unless it is a single shape.
    halves: [u8; 2],
    /// Whether it is a leaf where it has one lane.
    leaf: bool,
    /// The least cost of it in up to 1 to 8 lanes of a node.
    cost: [f32; 8],
    /// How many of these lanes the first half gets then; none where one lane less does.
    lanes: [u8; 8],
}

/// Adds the nodes of at most [`MOST_IN_TWIG`] items, which begin at `offset` among all.
pub(super) fn build(items: &mut [Item], offset: usize, whole: Part, nodes: &mut Vec<Node>) {
    let whole = Part { start: 0, ..whole };
    let empty = Fork { part: whole, halves: [0; 2], leaf: false, cost: [0.0; 8], lanes: [0; 8] };
    let mut twig = Twig {
        forks: [empty; 2 * MOST_IN_TWIG],
        count: 0,
        memory: MEMORY * whole.bounds.half_area() / whole.count as f32,
    };
    let root = twig.weigh(items, whole);
    twig.emit(root, items, offset, nodes);
}

/// Few shapes, and all forks of their halves.
struct Twig {
    forks: [Fork; 2 * MOST_IN_TWIG],
    count: usize,
    /// What the memory of a node costs, in half areas.
    memory: f32,
}

impl Twig {
    /// Divides a part, down to single shapes, and weighs what can be made of it. Its place.
    fn weigh(&mut self, items: &mut [Item], part: Part) -> usize {
        let place = self.count;
        self.count += 1;
        let area = part.bounds.half_area();
        let members = &mut items[part.start..part.start + part.count];
        let as_leaf = if fit_in_leaf(members) { area * (SHAPE * part.count as f32) } else { f32::INFINITY };
        let mut fork = Fork { part, halves: [0; 2], leaf: true, cost: [as_leaf; 8], lanes: [0; 8] };
        if part.count > 1 {
            let (first, second) = split(members, part);
            let (first, second) = (self.weigh(items, first), self.weigh(items, second));
            fork.halves = [first as u8, second as u8];
            let (a, b) = (&self.forks[first], &self.forks[second]);
            let (most_a, most_b) = (a.part.count.min(7), b.part.count.min(7));
            // At least two lanes, one each; no more than there are shapes.
            let most = part.count.min(8);
            for lanes in 2..=most {
                let mut best = (f32::INFINITY, 0);
                for k in lanes.saturating_sub(most_b).max(1)..=most_a.min(lanes - 1) {
                    let cost = a.cost[k - 1] + b.cost[lanes - k - 1];
                    best = if cost < best.0 { (cost, k) } else { best };
                }
                (fork.cost[lanes - 1], fork.lanes[lanes - 1]) = (best.0, best.1 as u8);
            }
            let as_node = fork.cost[most - 1] + area + self.memory;
            fork.leaf = as_leaf <= as_node;
            fork.cost[0] = if fork.leaf { as_leaf } else { as_node };
            // As a node of its own it has eight lanes.
            fork.lanes[0] = fork.lanes[most - 1];
            for lanes in 2..=8 {
                if lanes > most || fork.cost[lanes - 1] >= fork.cost[lanes - 2] {
                    (fork.cost[lanes - 1], fork.lanes[lanes - 1]) = (fork.cost[lanes - 2], 0);
                }
            }
        }
        self.forks[place] = fork;
        place
    }

    /// Adds the node of a part, and those below.
    fn emit(&self, place: usize, items: &[Item], offset: usize, nodes: &mut Vec<Node>) {
        let index = nodes.len();
        nodes.push(Node::EMPTY);
        let mut children = [0; 8];
        let mut count = 0;
        let fork = &self.forks[place];
        let [first, second] = fork.halves.map(usize::from);
        let lanes = usize::from(fork.lanes[0]);
        self.gather(first, lanes, &mut children, &mut count);
        self.gather(second, 8 - lanes, &mut children, &mut count);
        for (lane, &child) in children[..count].iter().enumerate() {
            let Fork { part, leaf, .. } = self.forks[child];
            let ([a, b, c, _], [d, e, f, _]) = (part.bounds.min, part.bounds.max);
            nodes[index].boxes.set(lane, [a, b, c], [d, e, f]);
            nodes[index].children[lane] = if leaf {
                Child::leaf(Run {
                    kind: items[part.start].kind,
                    first: offset + part.start,
                    count: part.count,
                })
            } else {
                Child::node(nodes.len())
            };
            if !leaf {
                self.emit(child, items, offset, nodes);
            }
        }
    }

    /// The parts of this one that get up to so many lanes.
    fn gather(&self, place: usize, mut lanes: usize, children: &mut [usize; 8], count: &mut usize) {
        let fork = &self.forks[place];
        while lanes > 1 && fork.lanes[lanes - 1] == 0 {
            lanes -= 1;
        }
        if lanes <= 1 {
            children[*count] = place;
            *count += 1;
            return;
        }
        let [first, second] = fork.halves.map(usize::from);
        let of_first = usize::from(fork.lanes[lanes - 1]);
        self.gather(first, of_first, children, count);
        self.gather(second, lanes - of_first, children, count);
    }
}
