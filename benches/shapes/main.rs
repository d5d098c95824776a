//! What a hit costs: our shapes beside the textbook formula in plain `f64`, over several families of rays.
//!
//! Every group first checks that both agree on hit and miss, and on the parameter, wherever the textbook formula can
//! be trusted. One measured pass is 1024 rays; divide by that for the time of a ray.
// Making and measuring rays only: these numbers never reach a picture.
#![allow(clippy::disallowed_methods)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use families::{RAYS, Random, TextbookFrustum, aimed, grazing, inside, missing, on_side, textbook_sphere};
use rt::rt_core;
use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cylinder, Sphere};
use rt_core::{Interval, Primitive, Ray};
use std::hint::black_box;
use std::time::Duration;

// Others measure with it too.
#[allow(dead_code)]
mod families;

/// One row of times: checks, then measures both.
fn family(
    c: &mut Criterion,
    name: &str,
    shape: &impl Primitive,
    rays: &[Ray],
    trusted: bool,
    textbook: impl Fn(&Ray, Interval) -> Option<f64>,
) {
    for ray in rays {
        let (ours, other) = (shape.hit(ray, Interval::FORWARD), textbook(ray, Interval::FORWARD));
        if let Some(hit) = ours {
            let surface = shape.surface(ray, hit);
            assert!(
                (surface.t - hit.t()).abs() <= 1e-9 * (1.0 + surface.t),
                "{name}: {ray:?} {hit:?} {surface:?}"
            );
        }
        if trusted {
            match (ours, other) {
                (None, None) => {}
                (Some(hit), Some(t)) if (hit.t() - t).abs() < 1e-6 * (1.0 + t) => {}
                both => panic!("{name}: {ray:?} {both:?}"),
            }
        }
    }
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(RAYS as u64));
    group.bench_function("hit", |b| {
        b.iter(|| {
            for ray in rays {
                black_box(shape.hit(black_box(ray), Interval::FORWARD));
            }
        })
    });
    group.bench_function("textbook", |b| {
        b.iter(|| {
            for ray in rays {
                black_box(textbook(black_box(ray), Interval::FORWARD));
            }
        })
    });
    let hits: Vec<_> = rays.iter().filter_map(|r| Some((*r, shape.hit(r, Interval::FORWARD)?))).collect();
    if !hits.is_empty() {
        let hits: Vec<_> = hits.iter().cycle().take(RAYS).copied().collect();
        group.bench_function("surface", |b| {
            b.iter(|| {
                for (ray, hit) in &hits {
                    black_box(shape.surface(black_box(ray), *hit));
                }
            })
        });
    }
    group.finish();
}

fn families(
    c: &mut Criterion,
    kind: &str,
    shape: &impl Primitive,
    (center, radius, inner): (DVec3, f64, f64),
    touch: impl Fn(&mut Random) -> (DVec3, DVec3),
    textbook: impl Fn(&Ray, Interval) -> Option<f64>,
) {
    for (name, rays, trusted) in [
        ("random", aimed(center, radius, 4.0, 1.0), true),
        ("far", aimed(center, radius, 1e4, 1.0), false),
        ("grazing", grazing(radius, 1e-8, touch), false),
        ("miss", missing(center, radius), true),
        ("inside", inside(center, radius, inner), true),
    ] {
        family(c, &format!("{kind}/{name}"), shape, &rays, trusted, &textbook);
    }
}

fn sphere(c: &mut Criterion) {
    let (center, radius) = (DVec3::new(0.3, -1.2, 2.7), 1.3);
    let shape = Sphere::new(center, radius).unwrap();
    let touch = |random: &mut Random| {
        let normal = random.direction();
        (center + normal * radius, normal)
    };
    families(c, "sphere", &shape, (center, radius, 0.9), touch, |ray, within| {
        textbook_sphere(center, radius, ray, within)
    });
}

fn cylinder(c: &mut Criterion) {
    let (base, top, radius) = (DVec3::new(0.3, -1.2, 2.7), DVec3::new(1.1, 0.9, 3.2), 0.8);
    let plain = TextbookFrustum::new(base, radius, top, radius);
    let bounding = (top - base).length().hypot(2.0 * radius) / 2.0;
    families(
        c,
        "cylinder",
        &Cylinder::new(base, top, radius).unwrap(),
        ((base + top) / 2.0, bounding, 0.5),
        |random| on_side(&plain, random),
        |ray, within| plain.hit::<false>(ray, within),
    );
}

fn cone(c: &mut Criterion) {
    let (base, top) = (DVec3::new(0.3, -1.2, 2.7), DVec3::new(1.1, 0.9, 3.2));
    let plain = TextbookFrustum::new(base, 1.1, top, 0.4);
    let bounding = (top - base).length().hypot(2.0 * 1.1) / 2.0;
    families(
        c,
        "cone",
        &Cone::new(base, 1.1, top, 0.4).unwrap(),
        ((base + top) / 2.0, bounding, 0.3),
        |random| on_side(&plain, random),
        |ray, within| plain.hit::<true>(ray, within),
    );
}

/// Short runs, so that all benches together take minutes: ratios within one run settle in a second.
fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
}

criterion_group! { name = benches; config = short(); targets = sphere, cylinder, cone }
criterion_main!(benches);
