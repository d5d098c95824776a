//! Time per ray of a geometry: `cargo bench --bench geometry`. The answers are checked first.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rt::rt_core::glam::DVec3;
use rt::rt_core::shape::Sphere;
use rt::rt_core::{Geometry, GeometryBuilder, Interval, Ray};
use std::hint::black_box;
use std::time::Duration;

/// SplitMix64: 24-bit uniform numbers.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f64 / 16_777_216.0
    }
    fn point(&mut self) -> DVec3 {
        let (x, y, z) = (self.uniform(), self.uniform(), self.uniform());
        DVec3::new(x, y, z)
    }
}

/// About one sphere is crossed on a unit of length, however many there are.
fn spheres(n: usize) -> GeometryBuilder {
    let mut random = Random(1);
    let radius = (0.294 / n as f64).sqrt();
    let mut builder = Geometry::builder();
    for _ in 0..n {
        let center = random.point();
        builder.push(Sphere::new(center, radius * (0.5 + random.uniform())).expect("a sphere"));
    }
    builder
}

fn rays(side_by_side: bool, n: usize) -> Vec<Ray> {
    let mut random = Random(2);
    (0..n * n)
        .map(|i| {
            if side_by_side {
                let (x, y) = ((i % n) as f64 / n as f64 - 0.5, (i / n) as f64 / n as f64 - 0.5);
                Ray::new([0.5, 0.5, -1.5], [x, y, 1.5])
            } else {
                Ray::new(random.point(), random.point() - 0.5)
            }
        })
        .collect()
}

fn geometry(criterion: &mut Criterion) {
    for n in [100, 10_000] {
        let (fast, plain) = (spheres(n).build(), spheres(n).accelerated(false).build());
        for (name, rays) in [("camera", rays(true, 128)), ("random", rays(false, 128))] {
            let within = vec![Interval::FORWARD; rays.len()];
            let mut found = vec![None; rays.len()];
            fast.nearest_many(&rays, &within, &mut found);
            for (ray, found) in rays.iter().zip(&found).step_by(37) {
                assert_eq!(plain.nearest(ray, Interval::FORWARD), *found);
                assert_eq!(fast.nearest(ray, Interval::FORWARD), *found);
            }
            let mut group = criterion.benchmark_group(format!("{n} spheres, {name} rays"));
            group.throughput(Throughput::Elements(rays.len() as u64));
            group.bench_function("nearest", |bencher| {
                bencher.iter(|| {
                    rays.iter()
                        .filter(|ray| fast.nearest(black_box(ray), Interval::FORWARD).is_some())
                        .count()
                })
            });
            group.bench_function("nearest_many", |bencher| {
                bencher.iter(|| fast.nearest_many(black_box(&rays), &within, &mut found))
            });
            group.bench_function("occluded", |bencher| {
                bencher.iter(|| {
                    rays.iter().filter(|ray| fast.occluded(black_box(ray), Interval::FORWARD)).count()
                })
            });
            group.finish();
        }
    }
}

/// Short runs, so that all benches together take minutes: ratios within one run settle in a second.
fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
}

criterion_group! { name = benches; config = short(); targets = geometry }
criterion_main!(benches);
