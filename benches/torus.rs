//! What a ray against a torus costs: first hits, all crossings, the record, and rays that leave it.
//!
//! Every set of rays is checked before it is timed: each hit must lie on the torus, and with the textbook formula
//! must agree about hit and miss wherever that formula can be trusted.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rt::rt_core::glam::DVec3;
use rt::rt_core::poly::quartic;
use rt::rt_core::shape::Torus;
use rt::rt_core::{Hit, Interval, Primitive, Ray, Side};
use std::hint::black_box;
use std::time::Duration;

const MAJOR: f64 = 1.3;
const MINOR: f64 = 0.4;
const RAYS: usize = 1024;

/// A small generator of numbers in `[0, 1)`, the same on every run (xorshift64, Marsaglia 2003).
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.number(), self.number(), self.number()) * 2.0 - 1.0;
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

/// Rays of one kind, all but the misses aimed at the surface.
fn rays(kind: &str) -> Vec<Ray> {
    let mut random = Random(88_172_645_463_325_252);
    let ray = |_| {
        let (u, v) = (random.direction(), random.direction());
        let radial = DVec3::new(u.x, u.y, 0.0).normalize();
        let normal = (radial * v.x + DVec3::Z * v.y).normalize();
        let (point, direction) = (radial * MAJOR + normal * MINOR, random.direction());
        let tangent = (direction - normal * direction.dot(normal)).normalize();
        match kind {
            "far" => Ray::new(point - direction * 1e4, direction),
            "grazing" => Ray::new(point - normal * 1e-8 - tangent * 5.0, tangent),
            "equatorial" => {
                let direction = DVec3::new(direction.x, direction.y, 0.0).normalize();
                let across = DVec3::new(-direction.y, direction.x, 0.0);
                let offset = (random.number() * 2.0 - 1.0) * (MAJOR + MINOR);
                Ray::new(across * offset - direction * 5.0, direction)
            }
            "miss by bounds" => {
                let closest = random.direction() * 3.0;
                let across = closest.cross(direction).normalize();
                Ray::new(closest - across * 5.0, across)
            }
            "inside" => Ray::new(radial * MAJOR + normal * (0.5 * MINOR), direction),
            _ => Ray::new(point - direction * 5.0, direction),
        }
    };
    (0..RAYS).map(ray).collect()
}

/// The textbook: the quartic of the ray as it is, its coefficients expanded.
fn naive(ray: &Ray) -> [f64; 5] {
    let (o, d) = (ray.origin, ray.direction);
    let (a, b, four) = (d.dot(d), o.dot(d), 4.0 * MAJOR * MAJOR);
    let k = o.dot(o) + MAJOR * MAJOR - MINOR * MINOR;
    [
        k * k - four * (o.x * o.x + o.y * o.y),
        4.0 * b * k - 2.0 * four * (o.x * d.x + o.y * d.y),
        2.0 * a * k + 4.0 * b * b - four * (d.x * d.x + d.y * d.y),
        4.0 * a * b,
        a * a,
    ]
}

fn check(kind: &str, torus: &Torus, rays: &[Ray], hits: &[Option<Hit>]) {
    for (ray, hit) in rays.iter().zip(hits) {
        if let Some(hit) = hit {
            let p = torus.surface(ray, *hit).local;
            let out = (p.x * p.x + p.y * p.y).sqrt() - MAJOR;
            let tube = (out * out + p.z * p.z).sqrt();
            assert!((tube - MINOR).abs() <= 8.0 * f64::EPSILON, "{kind}: off by {}", tube - MINOR);
        }
        if matches!(kind, "random" | "inside") {
            let textbook = quartic(naive(ray), Interval::FORWARD);
            assert_eq!(textbook.is_empty(), hit.is_none(), "{kind}: {ray:?}");
        }
    }
    let count = hits.iter().flatten().count();
    assert!(if kind == "miss by bounds" { count == 0 } else { count > RAYS / 2 }, "{kind}: {count} hits");
}

fn torus(c: &mut Criterion) {
    let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], MAJOR, MINOR).expect("a legal torus");
    for kind in ["random", "far", "grazing", "equatorial", "inside", "miss by bounds"] {
        let rays = rays(kind);
        let hits: Vec<Option<Hit>> = rays.iter().map(|ray| torus.hit(ray, Interval::FORWARD)).collect();
        check(kind, &torus, &rays, &hits);
        let mut group = c.benchmark_group(format!("torus/{kind}"));
        group.throughput(Throughput::Elements(RAYS as u64));
        group.bench_function("hit", |b| {
            b.iter(|| {
                for ray in &rays {
                    black_box(torus.hit(black_box(ray), Interval::FORWARD));
                }
            })
        });
        group.bench_function("textbook coefficients and Ferrari", |b| {
            b.iter(|| {
                for ray in &rays {
                    black_box(quartic::ferrari(naive(black_box(ray)), Interval::FORWARD));
                }
            })
        });
        group.bench_function("closest approach and Ferrari", |b| {
            b.iter(|| {
                for ray in &rays {
                    black_box(torus.hit_with(black_box(ray), Interval::FORWARD, quartic::ferrari));
                }
            })
        });
        if kind == "miss by bounds" {
            continue;
        }
        let found: Vec<(&Ray, Hit)> =
            rays.iter().zip(&hits).filter_map(|(ray, hit)| Some((ray, (*hit)?))).collect();
        group.bench_function("all crossings", |b| {
            b.iter(|| {
                for ray in &rays {
                    torus.crossings(black_box(ray), Interval::FORWARD, &mut |hit| {
                        black_box(hit);
                    });
                }
            })
        });
        group.bench_function("surface", |b| {
            b.iter(|| {
                for (ray, hit) in &found {
                    black_box(torus.surface(black_box(ray), *hit));
                }
            })
        });
        let leaving: Vec<_> = found
            .iter()
            .map(|(ray, hit)| {
                let surface = torus.surface(ray, *hit);
                let side = Side::of_arrival(ray.direction, surface.normal);
                let mirrored = ray.direction - surface.normal * (2.0 * ray.direction.dot(surface.normal));
                (surface.departure(0, *hit, side), mirrored)
            })
            .collect();
        group.bench_function("mirrored ray leaving", |b| {
            b.iter(|| {
                for (from, direction) in &leaving {
                    let (ray, within) = from.ray(*direction);
                    black_box(torus.hit_leaving(black_box(&ray), within, from));
                }
            })
        });
        group.finish();
    }
}

/// Short runs, so that all benches together take minutes: ratios within one run settle in a second.
fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
}

criterion_group! { name = benches; config = short(); targets = torus }
criterion_main!(benches);
