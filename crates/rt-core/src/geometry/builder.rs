//! Builds the tree: the surface area heuristic in bins, split after split until a node has eight children.
//!
//! Source: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies" (doi:10.1109/RT.2007.4342588).
//! The tree decides time only, never an answer.

mod twig;

use super::store::Run;
use super::tree::{Child, Node, Tree};
use crate::kernel::vec_on_large_pages;
use alloc::vec::Vec;

/// The deepest split by the heuristic; below it, ranges are halved.
const MOST_DEPTH_OF_HEURISTIC: usize = 40;
/// No path from the root has more nodes: 25 halvings of [`Child::CAPACITY`] shapes, and room.
pub(super) const MOST_DEPTH: usize = MOST_DEPTH_OF_HEURISTIC + 32;
const BINS: usize = 16;
/// Of few items, as empty bins take time to make.
const FEW_BINS: usize = 8;
/// The most items for which [`bins_for`], 4 + n / 8, is at most that.
const MOST_WITH_FEW_BINS: usize = 8 * (FEW_BINS - 4) + 7;
/// Up to this many shapes, testing all boxes is faster than going down a tree (measured: docs/performance.md).
pub(super) const MOST_WITHOUT_TREE: usize = 32;

/// Up to this many shapes, a part of the tree is found by weighing all ways to put it together; with more of them it is no better
/// (counted: docs/performance.md).
const MOST_IN_TWIG: usize = 32;

/// A shape to be put into the tree: its box in kernel coordinates.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Item {
    pub min: [f32; 3],
    pub object: u32,
    pub max: [f32; 3],
    pub kind: u32,
}

/// A box in `f32`. The fourth lane is not used: it lets the compiler use whole registers.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: [f32; 4],
    max: [f32; 4],
}

#[inline(always)]
fn lesser(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    core::array::from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
}

#[inline(always)]
fn greater(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    core::array::from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
}

impl Bounds {
    const EMPTY: Bounds = Bounds { min: [f32::INFINITY; 4], max: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    fn of(item: &Item) -> Bounds {
        let ([a, b, c], [d, e, f]) = (item.min, item.max);
        Bounds { min: [a, b, c, 0.0], max: [d, e, f, 0.0] }
    }

    #[inline(always)]
    fn add(&mut self, other: &Bounds) {
        self.min = lesser(self.min, other.min);
        self.max = greater(self.max, other.max);
    }

    /// Twice the centre.
    #[inline(always)]
    fn middle(&self) -> [f32; 4] {
        core::array::from_fn(|i| self.min[i] + self.max[i])
    }

    /// Half the surface; 0 when empty.
    #[inline(always)]
    fn half_area(&self) -> f32 {
        let [x, y, z, _]: [f32; 4] = core::array::from_fn(|i| self.max[i] - self.min[i]);
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }
}

/// A part of the items that will be one child.
#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    count: usize,
    depth: usize,
    bounds: Bounds,
}

/// The most shapes that share a leaf when a node has no lane left for each: a test of so many costs less than
/// another node.
fn most_in_leaf(kind: u32) -> usize {
    // Kind 5 is the torus, whose test costs as much as several nodes.
    if kind == 5 { 1 } else { 2 }
}

/// Whether these make a leaf.
fn fit_in_leaf(items: &[Item]) -> bool {
    let kind = items[0].kind;
    items.len() <= most_in_leaf(kind) && items.iter().all(|item| item.kind == kind)
}

/// Builds the tree over the items and puts them in the order of its leaves.
pub(super) fn build(items: &mut [Item]) -> Tree {
    let mut bounds = Bounds::EMPTY;
    for item in items.iter() {
        bounds.add(&Bounds::of(item));
    }
    if items.is_empty() {
        return Tree::default();
    }
    let size = |item: &Item| (0..3).map(|k| f64::from(item.max[k] - item.min[k])).sum::<f64>() / 3.0;
    let box_size = items.iter().map(size).sum::<f64>() / items.len() as f64;
    if items.len() <= MOST_WITHOUT_TREE {
        let mut nodes = rows(items);
        number_by_kind(items, &mut nodes);
        return Tree { roots: nodes.len(), nodes, box_size };
    }
    // Nodes hold about four shapes each; untouched room costs nothing but addresses.
    let mut nodes = vec_on_large_pages(items.len() / 3 + 1);
    let whole = Part { start: 0, count: items.len(), depth: 0, bounds };
    build_node(items, 0, whole, &mut nodes);
    number_by_kind(items, &mut nodes);
    // What is left over of a large array was never touched, and is memory in name only.
    if nodes.len() > 4096 {
        return Tree { nodes, roots: 1, box_size };
    }
    let mut exact = vec_on_large_pages(nodes.len());
    exact.append(&mut nodes);
    Tree { nodes: exact, roots: 1, box_size }
}

/// All items side by side, eight a node.
fn rows(items: &[Item]) -> Vec<Node> {
    let row = |(row, items): (usize, &[Item])| {
        let mut node = Node::EMPTY;
        for (lane, item) in items.iter().enumerate() {
            node.boxes.set(lane, item.min, item.max);
            node.children[lane] = Child::leaf(Run { kind: item.kind, first: 8 * row + lane, count: 1 });
        }
        node
    };
    items.chunks(8).enumerate().map(row).collect()
}

/// Adds the node of `whole`, whose items are `items`, which begin at `offset` among all.
fn build_node(items: &mut [Item], offset: usize, whole: Part, nodes: &mut Vec<Node>) {
    if items.len() <= MOST_IN_TWIG {
        return twig::build(items, offset, whole, nodes);
    }
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let mut parts = [Part { start: 0, ..whole }; 8];
    let mut count = 1;
    // The widest of the parts that need a node of their own is divided first.
    while count < 8 {
        let wide = |&i: &usize| parts[i].count > 8;
        let by_area =
            |&i: &usize, &j: &usize| parts[i].bounds.half_area().total_cmp(&parts[j].bounds.half_area());
        let Some(chosen) = (0..count).filter(wide).max_by(by_area) else { break };
        let part = parts[chosen];
        (parts[chosen], parts[count]) = split(&mut items[part.start..part.start + part.count], part);
        count += 1;
    }
    let parts = &mut parts[..count];
    parts.sort_unstable_by_key(|part| part.start);

    let mut inner = [false; 8];
    for (lane, part) in parts.iter().enumerate() {
        let ([a, b, c, _], [d, e, f, _]) = (part.bounds.min, part.bounds.max);
        nodes[index].boxes.set(lane, [a, b, c], [d, e, f]);
        let members = &items[part.start..part.start + part.count];
        let kind = members[0].kind;
        if fit_in_leaf(members) {
            let run = Run { kind, first: offset + part.start, count: part.count };
            nodes[index].children[lane] = Child::leaf(run);
        } else {
            inner[lane] = true;
        }
    }

    #[cfg(feature = "rayon")]
    if items.len() >= 8192 {
        return build_children_in_parallel(items, offset, parts, &inner, index, nodes);
    }
    for (lane, part) in parts.iter().enumerate() {
        if inner[lane] {
            nodes[index].children[lane] = Child::node(nodes.len());
            let members = &mut items[part.start..part.start + part.count];
            build_node(members, offset + part.start, *part, nodes);
        }
    }
}

/// The children of a large node, each on its own; the nodes come out in the same order as one by one.
#[cfg(feature = "rayon")]
fn build_children_in_parallel(
    items: &mut [Item],
    offset: usize,
    parts: &[Part],
    inner: &[bool; 8],
    index: usize,
    nodes: &mut Vec<Node>,
) {
    use rayon::prelude::*;
    let mut rest = items;
    let mut tasks = Vec::new();
    for (lane, part) in parts.iter().enumerate() {
        let (members, after) = rest.split_at_mut(part.count);
        rest = after;
        if inner[lane] {
            tasks.push((lane, *part, members));
        }
    }
    let built: Vec<(usize, Vec<Node>)> = tasks
        .into_par_iter()
        .map(|(lane, part, members)| {
            let mut nodes = Vec::with_capacity(members.len() / 4 + 1);
            build_node(members, offset + part.start, part, &mut nodes);
            (lane, nodes)
        })
        .collect();
    for (lane, mut subtree) in built {
        let shift = nodes.len();
        nodes[index].children[lane] = Child::node(shift);
        for child in subtree.iter_mut().flat_map(|node| &mut node.children) {
            if let Some(index) = child.as_node() {
                *child = Child::node(index + shift);
            }
        }
        nodes.append(&mut subtree);
    }
}

/// Splits a part with at least two items; they are put in the order of the halves.
fn split(items: &mut [Item], part: Part) -> (Part, Part) {
    let halves = match items.len() {
        _ if part.depth >= MOST_DEPTH_OF_HEURISTIC => None,
        0..=2 => None,
        3 => Some(divide_few::<3>(items)),
        4 => Some(divide_few::<4>(items)),
        5..=MOST_WITH_FEW_BINS => divide::<FEW_BINS>(items),
        _ => divide::<BINS>(items),
    };
    let (middle, left, right) = match halves {
        Some(halves) => halves,
        None => {
            let middle = items.len() / 2;
            let bounds = |items: &[Item]| {
                items.iter().fold(Bounds::EMPTY, |mut all, item| {
                    all.add(&Bounds::of(item));
                    all
                })
            };
            (middle, bounds(&items[..middle]), bounds(&items[middle..]))
        }
    };
    let depth = part.depth + 1;
    (
        Part { start: part.start, count: middle, depth, bounds: left },
        Part { start: part.start + middle, count: part.count - middle, depth, bounds: right },
    )
}

/// Puts the items in order by the plane of least cost, if there is any. Where the second half begins, and the boxes of both.
fn divide<const BINS: usize>(items: &mut [Item]) -> Option<(usize, Bounds, Bounds)> {
    let plane = best_plane::<BINS>(items)?;
    let mut middle = 0;
    // Without a branch on what cannot be predicted: those on the right change places among each other.
    for i in 0..items.len() {
        let left = plane.is_left(&items[i]);
        items.swap(i, middle);
        middle += usize::from(left);
    }
    Some((middle, plane.left, plane.right))
}

/// Divides three or four items as costs least of all ways, planes or not. As [`divide`].
fn divide_few<const N: usize>(items: &mut [Item]) -> (usize, Bounds, Bounds) {
    let mut bounds = [Bounds::EMPTY; N];
    for (bounds, item) in bounds.iter_mut().zip(items.iter()) {
        *bounds = Bounds::of(item);
    }
    let both = |a: &Bounds, b: &Bounds| {
        let mut both = *a;
        both.add(b);
        both
    };
    let mut best = (f32::INFINITY, 0, 1, Bounds::EMPTY, Bounds::EMPTY);
    // One by itself.
    for alone in 0..N {
        let mut others = Bounds::EMPTY;
        for other in (0..N).filter(|&other| other != alone) {
            others.add(&bounds[other]);
        }
        let cost = bounds[alone].half_area() + others.half_area() * (N - 1) as f32;
        if cost < best.0 {
            best = (cost, alone, 1, bounds[alone], others);
        }
    }
    // The first with another, in pairs.
    if N == 4 {
        for with in 1..4 {
            let [a, b] = [[2, 3], [1, 3], [1, 2]][with - 1];
            let (pair, others) = (both(&bounds[0], &bounds[with]), both(&bounds[a], &bounds[b]));
            let cost = (pair.half_area() + others.half_area()) * 2.0;
            if cost < best.0 {
                best = (cost, with, 2, pair, others);
            }
        }
    }
    let (_, chosen, middle, first, second) = best;
    items.swap(middle - 1, chosen);
    (middle, first, second)
}

/// How centres fall into bins on each axis.
#[derive(Clone, Copy)]
struct Binning<const BINS: usize> {
    origin: [f32; 4],
    factor: [f32; 4],
}

impl<const BINS: usize> Binning<BINS> {
    #[inline(always)]
    fn bins(&self, bounds: &Bounds) -> [usize; 3] {
        let middle = bounds.middle();
        let place: [f32; 4] = core::array::from_fn(|i| (middle[i] - self.origin[i]) * self.factor[i]);
        [place[0] as usize % BINS, place[1] as usize % BINS, place[2] as usize % BINS]
    }
}

/// A plane between bins, and the boxes of both sides.
struct Plane<const BINS: usize> {
    binning: Binning<BINS>,
    axis: usize,
    /// The first bin on the right.
    bin: usize,
    left: Bounds,
    right: Bounds,
}

impl<const BINS: usize> Plane<BINS> {
    #[inline(always)]
    fn is_left(&self, item: &Item) -> bool {
        let k = self.axis;
        let middle = item.min[k] + item.max[k];
        ((middle - self.binning.origin[k]) * self.binning.factor[k]) as usize % BINS < self.bin
    }
}

/// Few bins for few items.
fn bins_for(items: usize) -> usize {
    (4 + items / 8).min(BINS)
}

/// The plane of least cost, if the centres differ.
fn best_plane<const BINS: usize>(items: &[Item]) -> Option<Plane<BINS>> {
    let mut centers = Bounds::EMPTY;
    for item in items {
        let middle = Bounds::of(item).middle();
        centers.add(&Bounds { min: middle, max: middle });
    }
    let count = bins_for(items.len()).min(BINS);
    // The greatest centre falls below `count`: the factor is less than count / extent by more than it can be off
    // by rounding (three roundings of 2^-24).
    let factor: [f32; 4] = core::array::from_fn(|i| {
        let extent = centers.max[i] - centers.min[i];
        let factor = count as f32 * (1.0 - 1e-6) / extent;
        if extent > 0.0 && factor.is_finite() { factor } else { 0.0 }
    });
    let binning = Binning { origin: centers.min, factor };
    let mut boxes = [[Bounds::EMPTY; 3]; BINS];
    let mut counts = [[0_u32; 4]; BINS];
    for item in items {
        let bounds = Bounds::of(item);
        for (axis, bin) in binning.bins(&bounds).into_iter().enumerate() {
            boxes[bin][axis].add(&bounds);
            counts[bin][axis] += 1;
        }
    }
    let total = items.len() as u32;
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if factor[axis] == 0.0 {
            continue;
        }
        let mut cost_right = [0.0; BINS];
        let (mut all, mut number) = (Bounds::EMPTY, 0);
        for bin in (1..count).rev() {
            all.add(&boxes[bin][axis]);
            number += counts[bin][axis];
            cost_right[bin] = all.half_area() * number as f32;
        }
        (all, number) = (Bounds::EMPTY, 0);
        for bin in 1..count {
            all.add(&boxes[bin - 1][axis]);
            number += counts[bin - 1][axis];
            let cost = all.half_area() * number as f32 + cost_right[bin];
            if number > 0 && number < total && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, bin));
            }
        }
    }
    let (_, axis, bin) = best?;
    let side = |range: core::ops::Range<usize>| {
        range.fold(Bounds::EMPTY, |mut all, bin| {
            all.add(&boxes[bin][axis]);
            all
        })
    };
    Some(Plane { binning, axis, bin, left: side(0..bin), right: side(bin..count) })
}

/// Leaves name places among all items; from here on, places among those of their kind.
fn number_by_kind(items: &[Item], nodes: &mut [Node]) {
    if items.iter().all(|item| item.kind == items[0].kind) {
        return;
    }
    let mut counts = [0_usize; 16];
    let ranks: Vec<usize> = items
        .iter()
        .map(|item| {
            let count = &mut counts[item.kind as usize & 15];
            *count += 1;
            *count - 1
        })
        .collect();
    for child in nodes.iter_mut().flat_map(|node| &mut node.children) {
        if *child != Child::NOTHING && child.as_node().is_none() {
            let run = child.run();
            *child = Child::leaf(Run { first: ranks[run.first], ..run });
        }
    }
}

#[cfg(test)]
mod tests;
