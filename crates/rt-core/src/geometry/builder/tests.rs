use super::*;
use crate::testing::Random;

fn cost(items: &[Item]) -> f64 {
    let mut all = Bounds::EMPTY;
    items.iter().for_each(|item| all.add(&Bounds::of(item)));
    f64::from(all.half_area()) * items.len() as f64
}

/// Small boxes anywhere.
fn boxes(random: &mut Random, count: usize, kinds: u32) -> Vec<Item> {
    (0..count as u32)
        .map(|object| {
            let (at, half) = (random.in_cube(), random.in_cube().abs() * random.magnitude(-2.0, 0.0));
            let of = |p: glam::DVec3| core::array::from_fn(|k| p[k] as f32);
            Item { min: of(at - half), max: of(at + half), object, kind: random.below(kinds) }
        })
        .collect()
}

/// Three and four items are divided as costs least of all ways.
#[test]
fn few_are_divided_at_least_cost() {
    let mut random = Random::new(2);
    for case in 0..400 {
        let mut items = boxes(&mut random, 3 + case % 2, 1);
        let least = (1..(1 << items.len()) - 1)
            .map(|chosen: u32| {
                let (first, second): (Vec<Item>, Vec<Item>) =
                    items.iter().partition(|item| chosen >> item.object & 1 == 1);
                cost(&first) + cost(&second)
            })
            .fold(f64::INFINITY, f64::min);
        let (middle, first, second) =
            if items.len() == 3 { divide_few::<3>(&mut items) } else { divide_few::<4>(&mut items) };
        let found = cost(&items[..middle]) + cost(&items[middle..]);
        assert!(found <= least * (1.0 + 1e-5), "{found} {least}");
        let sum = f64::from(first.half_area()) * middle as f64
            + f64::from(second.half_area()) * (items.len() - middle) as f64;
        assert!((sum - found).abs() <= found * 1e-6);
    }
}

/// The cost of a node and all below by the measure of the twigs, and the items in its leaves.
fn weigh(nodes: &[Node], node: usize, items: &[Item], memory: f64, seen: &mut Vec<usize>) -> f64 {
    let (mut all, mut sum) = (Bounds::EMPTY, 0.0);
    for (lane, &child) in nodes[node].children.iter().enumerate() {
        if child == Child::NOTHING {
            continue;
        }
        let ([a, b, c], [d, e, f]) = nodes[node].boxes.corners(lane);
        let bounds = Bounds { min: [a, b, c, 0.0], max: [d, e, f, 0.0] };
        all.add(&bounds);
        if let Some(next) = child.as_node() {
            sum += weigh(nodes, next, items, memory, seen);
            continue;
        }
        let run = child.run();
        let mut inside = Bounds::EMPTY;
        for item in &items[run.first..run.first + run.count] {
            assert_eq!(item.kind, run.kind);
            inside.add(&Bounds::of(item));
            seen.push(item.object as usize);
        }
        assert_eq!((inside.min, inside.max), (bounds.min, bounds.max));
        sum += f64::from(bounds.half_area()) * f64::from(twig::SHAPE) * run.count as f64;
    }
    sum + f64::from(all.half_area()) + memory
}

/// A twig holds every item once, in leaves of one kind; it costs no more than the tree of the same halves whose nodes
/// are filled by always dividing the widest part, and less for most.
#[test]
fn twigs_of_least_cost() {
    let mut random = Random::new(3);
    let (mut less, mut all) = (0, 0);
    for case in 0..300 {
        let mut items = boxes(&mut random, 2 + case % (MOST_IN_TWIG - 1), 1 + case as u32 % 2);
        let mut bounds = Bounds::EMPTY;
        items.iter().for_each(|item| bounds.add(&Bounds::of(item)));
        let whole = Part { start: 0, count: items.len(), depth: 0, bounds };
        let memory = f64::from(twig::MEMORY * bounds.half_area()) / items.len() as f64;
        let mut other = items.clone();
        let (mut nodes, mut greedy) = (Vec::new(), Vec::new());
        twig::build(&mut items, 0, whole, &mut nodes);
        widest_first(&mut other, whole, &mut greedy);
        let mut seen = Vec::new();
        let cost = weigh(&nodes, 0, &items, memory, &mut seen);
        let most = weigh(&greedy, 0, &other, memory, &mut Vec::new());
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..items.len()));
        assert!(cost <= most * (1.0 + 1e-5), "{cost} {most}");
        all += 1;
        less += u32::from(cost < most * 0.99);
    }
    assert!(less * 2 > all, "{less} of {all}");
}

/// Single shapes in nodes that are filled by dividing the widest part.
fn widest_first(items: &mut [Item], whole: Part, nodes: &mut Vec<Node>) {
    let index = nodes.len();
    nodes.push(Node::EMPTY);
    let mut parts = vec![whole];
    while parts.len() < 8 {
        let wide = (0..parts.len()).filter(|&i| parts[i].count > 1);
        let by_area =
            |&i: &usize, &j: &usize| parts[i].bounds.half_area().total_cmp(&parts[j].bounds.half_area());
        let Some(chosen) = wide.max_by(by_area) else { break };
        let part = parts[chosen];
        let (first, second) = split(&mut items[part.start..part.start + part.count], part);
        parts[chosen] = first;
        parts.push(second);
    }
    for (lane, part) in parts.into_iter().enumerate() {
        let ([a, b, c, _], [d, e, f, _]) = (part.bounds.min, part.bounds.max);
        nodes[index].boxes.set(lane, [a, b, c], [d, e, f]);
        nodes[index].children[lane] = if part.count == 1 {
            Child::leaf(Run { kind: items[part.start].kind, first: part.start, count: 1 })
        } else {
            Child::node(nodes.len())
        };
        if part.count > 1 {
            widest_first(items, part, nodes);
        }
    }
}

/// The chosen plane costs no more than any of those between the bins of any axis, by the surface area heuristic: for
/// boxes of all sizes, in clusters or not.
#[test]
fn the_plane_of_least_cost() {
    let mut random = Random::new(1);
    for case in 0..300 {
        let size = random.magnitude(-3.0, 0.0);
        let clusters: [_; 3] = core::array::from_fn(|_| random.in_cube() * [3.0, 1.0][case % 2]);
        let flat = [1.0, 1.0, [1.0, 0.01][case / 2 % 2]];
        let items: Vec<Item> = (0..20 + case as u32)
            .map(|object| {
                let at = clusters[random.below(3) as usize] + random.in_cube() * random.uniform(0.0, 0.3);
                let half = random.in_cube().abs() * size * random.magnitude(-1.0, 0.0);
                let of = |p: glam::DVec3| core::array::from_fn(|k| p[k] as f32 * flat[k]);
                Item { min: of(at - half), max: of(at + half), object, kind: 0 }
            })
            .collect();
        let plane = best_plane::<BINS>(&items).unwrap();
        let split = |plane: &Plane<BINS>| {
            let (left, right): (Vec<Item>, Vec<Item>) = items.iter().partition(|item| plane.is_left(item));
            (cost(&left) + cost(&right), left.len())
        };
        let (found, left) = split(&plane);
        assert!(left > 0 && left < items.len());
        for axis in (0..3).filter(|&axis| plane.binning.factor[axis] > 0.0) {
            for bin in 1..bins_for(items.len()) {
                let (other, left) = split(&Plane { axis, bin, ..plane });
                // Up to the roundings of the areas.
                assert!(left == 0 || left == items.len() || found <= other * (1.0 + 1e-5), "{found} {other}");
            }
        }
        for (sum, is_left) in [(&plane.left, true), (&plane.right, false)] {
            let mut all = Bounds::EMPTY;
            items.iter().filter(|i| plane.is_left(i) == is_left).for_each(|i| all.add(&Bounds::of(i)));
            assert_eq!((sum.min, sum.max), (all.min, all.max));
        }
    }
}
