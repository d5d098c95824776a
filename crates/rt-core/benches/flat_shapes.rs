//! `hit` and `surface` of plane, disk, cuboid and triangle beside the textbook formulas in plain `f64`, on the same rays.
//!
//! Every set of rays is checked first: where the textbook is certain (random rays from nearby), both must agree.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use rt_core::glam::DVec3;
use rt_core::shape::{Cuboid, Disk, Plane, Triangle};
use rt_core::testing::Random;
use rt_core::{Interval, Primitive, Ray};
use std::hint::black_box;
use std::time::Duration;

/// As many rays as fit the first cache.
const RAYS: usize = 256;

fn textbook_plane(point: DVec3, normal: DVec3, ray: &Ray, within: Interval) -> Option<f64> {
    let t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
    within.contains(t).then_some(t)
}

fn textbook_disk(center: DVec3, normal: DVec3, radius: f64, ray: &Ray, within: Interval) -> Option<f64> {
    let t = textbook_plane(center, normal, ray, within)?;
    ((ray.at(t) - center).length_squared() <= radius * radius).then_some(t)
}

fn textbook_cuboid(min: DVec3, max: DVec3, ray: &Ray, within: Interval) -> Option<f64> {
    let inverse = 1.0 / ray.direction;
    let (a, b) = ((min - ray.origin) * inverse, (max - ray.origin) * inverse);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    if near > far {
        return None;
    }
    let t = if near > within.min { near } else { far };
    within.contains(t).then_some(t)
}

/// Möller and Trumbore 1997 (doi:10.1080/10867651.1997.10487468).
fn textbook_triangle(a: DVec3, e1: DVec3, e2: DVec3, ray: &Ray, within: Interval) -> Option<f64> {
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) * inverse;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    if v < 0.0 || u + v > 1.0 {
        return None;
    }
    let t = e2.dot(q) * inverse;
    within.contains(t).then_some(t)
}

/// Rays at points near the origin: `spread` 1 mostly hits a shape of size 1, 3 mostly misses.
fn rays(seed: u64, distance: f64, spread: f64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    (0..RAYS)
        .map(|_| {
            let origin = random.direction() * distance;
            Ray::new(origin, (random.in_cube() * spread - origin).normalize())
        })
        .collect()
}

fn sets() -> Vec<(&'static str, Vec<Ray>)> {
    let inside = rays(4, 0.1, 4.0);
    vec![
        ("random", rays(1, 5.0, 1.0)),
        ("far", rays(2, 1e6, 1.0)),
        ("missing", rays(3, 5.0, 4.0)),
        ("inside", inside),
    ]
}

fn compare(
    c: &mut Criterion,
    name: &str,
    shape: impl Primitive,
    textbook: impl Fn(&Ray, Interval) -> Option<f64>,
) {
    let within = Interval::FORWARD;
    let mut group = c.benchmark_group(name);
    for (set, rays) in sets() {
        if set != "far" {
            for ray in &rays {
                let (ours, theirs) = (shape.hit(ray, within).map(|h| h.t()), textbook(ray, within));
                assert_eq!(ours.is_some(), theirs.is_some(), "{name} {ray:?}");
                let close = |(a, b): (f64, f64)| (a - b).abs() <= 1e-9 * b.abs();
                assert!(ours.zip(theirs).is_none_or(close), "{name} {ours:?} {theirs:?} {ray:?}");
            }
        }
        group.bench_function(BenchmarkId::new("hit", set), |b| {
            b.iter(|| {
                rays.iter().filter_map(|ray| shape.hit(black_box(ray), within)).map(|h| h.t()).sum::<f64>()
            });
        });
        group.bench_function(BenchmarkId::new("textbook", set), |b| {
            b.iter(|| rays.iter().filter_map(|ray| textbook(black_box(ray), within)).sum::<f64>());
        });
    }
    let hits: Vec<_> =
        rays(1, 5.0, 1.0).into_iter().filter_map(|r| Some((r, shape.hit(&r, within)?))).collect();
    group.bench_function(BenchmarkId::new("surface", hits.len()), |b| {
        b.iter(|| hits.iter().map(|(ray, hit)| shape.surface(black_box(ray), *hit).t).sum::<f64>());
    });
    group.finish();
}

fn flat_shapes(c: &mut Criterion) {
    let normal = DVec3::new(0.3, 1.0, -0.2).normalize();
    let point = DVec3::new(0.1, -0.2, 0.05);
    compare(c, "plane", Plane::new(point, normal).expect("a plane"), |r, i| {
        textbook_plane(point, normal, r, i)
    });
    let disk = Disk::new(point, normal, 1.0).expect("a disk");
    compare(c, "disk", disk, |r, i| textbook_disk(point, normal, 1.0, r, i));
    let (min, max) = (DVec3::new(-0.9, -0.6, -0.7), DVec3::new(0.8, 0.9, 0.6));
    compare(c, "cuboid", Cuboid::new(min, max).expect("a cuboid"), |r, i| textbook_cuboid(min, max, r, i));
    let (p, q, s) = (DVec3::new(-1.0, -0.5, 0.1), DVec3::new(1.2, -0.4, 0.3), DVec3::new(0.1, 1.3, -0.2));
    let triangle = Triangle::new(p, q, s).expect("a triangle");
    compare(c, "triangle", triangle, |r, i| textbook_triangle(p, q - p, s - p, r, i));
}

/// Short runs, so that all benches together take minutes: ratios within one run settle in a second.
fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
}

criterion_group! { name = benches; config = short(); targets = flat_shapes }
criterion_main!(benches);
