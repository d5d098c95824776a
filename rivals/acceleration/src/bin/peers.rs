//! The same rays through the trees of other crates: `peers sphere|torus N [passes] [primary|random]`.
//!
//! Every tree asks the same exact shapes, those of `rt-core`, so that the trees are compared and nothing else. obvhs:
//! CWBVH, its fast preset. bvh: nearest boxes first, until one begins behind the hit. parry3d-f64: its `Bvh`, binned.

use rivals_acceleration::*;
use rt_core::{Aabb, Interval, Primitive, Ray, Shape};

fn hit(shape: &Shape, ray: &Ray) -> Option<f64> {
    shape.hit(ray, Interval::FORWARD).map(|hit| hit.t())
}

fn bounds(shape: &Shape) -> Aabb {
    shape.bounds().expect("a bounded shape")
}

/// Times one tree and judges its answers.
fn run(
    name: &str,
    passes: usize,
    rays: &[Ray],
    scene: &rt_core::Geometry,
    mut nearest: impl FnMut(&Ray) -> Option<f64>,
) {
    let mut answers = vec![f64::NAN; rays.len()];
    measure(&format!("{name} single"), passes, rays.len(), || {
        for (ray, answer) in rays.iter().zip(&mut answers) {
            *answer = nearest(ray).unwrap_or(f64::NAN);
        }
        answers.iter().filter(|t| !t.is_nan()).count()
    });
    judge(name, scene, rays, &answers);
}

struct ObvhsBox(obvhs::aabb::Aabb);

impl obvhs::Boundable for ObvhsBox {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        self.0
    }
}

struct BvhShape {
    bounds: bvh::aabb::Aabb<f64, 3>,
    index: usize,
    node: usize,
}

impl bvh::aabb::Bounded<f64, 3> for BvhShape {
    fn aabb(&self) -> bvh::aabb::Aabb<f64, 3> {
        self.bounds
    }
}

impl bvh::bounding_hierarchy::BHShape<f64, 3> for BvhShape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }
    fn bh_node_index(&self) -> usize {
        self.node
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let kind = arguments.next().unwrap_or("sphere".into());
    let n: usize = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(10_000);
    let passes: usize = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(1);
    let only = arguments.next().unwrap_or_default();
    let truth = scene(&kind, n).build();
    let shapes = truth.shapes();
    let built = |name: &str, start: f64| {
        println!("{:34} {:7.1} ms", format!("{name} build"), (cpu_seconds() - start) * 1e3);
    };

    let start = cpu_seconds();
    let boxes: Vec<ObvhsBox> = shapes
        .iter()
        .map(|shape| {
            let Aabb { min, max } = bounds(shape);
            let down = min.to_array().map(|x| (x as f32).next_down());
            let up = max.to_array().map(|x| (x as f32).next_up());
            ObvhsBox(obvhs::aabb::Aabb::new(down.into(), up.into()))
        })
        .collect();
    let wide = obvhs::cwbvh::builder::build_cwbvh(
        &boxes,
        obvhs::BvhBuildParams::fast_build(),
        &mut std::time::Duration::default(),
    );
    built("obvhs", start);

    let start = cpu_seconds();
    let mut members: Vec<BvhShape> = shapes
        .iter()
        .enumerate()
        .map(|(index, shape)| {
            let Aabb { min, max } = bounds(shape);
            let bounds = bvh::aabb::Aabb::with_bounds(min.to_array().into(), max.to_array().into());
            BvhShape { bounds, index, node: 0 }
        })
        .collect();
    let binary = bvh::bvh::Bvh::build(&mut members);
    built("bvh", start);

    let start = cpu_seconds();
    let leaves: Vec<parry3d_f64::bounding_volume::Aabb> = shapes
        .iter()
        .map(|shape| {
            let Aabb { min, max } = bounds(shape);
            parry3d_f64::bounding_volume::Aabb::new(min.to_array().into(), max.to_array().into())
        })
        .collect();
    let binned = parry3d_f64::partitioning::Bvh::from_leaves(
        parry3d_f64::partitioning::BvhBuildStrategy::Binned,
        &leaves,
    );
    built("parry3d-f64", start);

    for (name, rays) in [("primary", primary(1024)), ("random", random(1 << 20))] {
        if !name.starts_with(&only) {
            continue;
        }
        run("obvhs", passes, &rays, &truth, |ray| {
            let line = obvhs::ray::Ray::new_inf(
                ray.origin.as_vec3().to_array().into(),
                ray.direction.as_vec3().to_array().into(),
            );
            let mut best = f64::INFINITY;
            let mut record = obvhs::ray::RayHit::none();
            wide.ray_traverse(line, &mut record, |_, place| {
                let shape = &shapes[wide.primitive_indices[place] as usize];
                let t = hit(shape, ray).unwrap_or(f64::INFINITY);
                best = best.min(t);
                t as f32
            });
            best.is_finite().then_some(best)
        });
        run("bvh", passes, &rays, &truth, |ray| {
            let line = bvh::ray::Ray::new(ray.origin.to_array().into(), ray.direction.to_array().into());
            // The crate makes the direction a unit vector: distances are not our parameters.
            let length = ray.direction.length();
            let mut best = f64::INFINITY;
            for member in binary.nearest_traverse_iterator(&line, &members) {
                if let Some((entry, _)) = line.intersection_slice_for_aabb(&member.bounds)
                    && entry > best * length * (1.0 + 1e-12)
                {
                    continue;
                }
                best = best.min(hit(&shapes[member.index], ray).unwrap_or(f64::INFINITY));
            }
            best.is_finite().then_some(best)
        });
        run("parry3d-f64", passes, &rays, &truth, |ray| {
            let line =
                parry3d_f64::query::Ray::new(ray.origin.to_array().into(), ray.direction.to_array().into());
            binned.cast_ray(&line, f64::MAX, |index, _| hit(&shapes[index as usize], ray)).map(|(_, t)| t)
        });
    }
}
