//! The first hit of a shape and its full record: ours beside parry3d-f64 and the textbook formula.
//!
//! `cargo run --release -p rivals-shapes`: for each family of rays the least time of a ray over interleaved passes in
//! nanoseconds, and ours in units of the others'. The answers are checked first: where parry or the formula disagree
//! about a hit, or are off by more than 1e-6 of the size, they are counted as wrong. parry finds the first hit in
//! front of the origin with its normal; its cylinder and cone stand on the y axis, and so do ours here.

use parry3d_f64::query::{Ray as ParryRay, RayCast};
use parry3d_f64::shape as parry;
use rt_core;
use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cuboid, Cylinder, Sphere, Triangle};
use rt_core::{Interval, Primitive, Ray};
use std::hint::black_box;
use std::time::Instant;

#[path = "../../../benches/shapes/families.rs"]
#[allow(dead_code)]
mod families;
use families::{Random, TextbookFrustum, aimed, grazing, inside, missing, on_side, textbook_sphere};

/// Enough that the least time is not disturbed.
const PASSES: usize = 60;

/// The time of one pass in nanoseconds a ray.
fn time<T, R>(items: &[T], each: impl Fn(&T) -> R) -> f64 {
    let start = Instant::now();
    for item in items {
        black_box(each(black_box(item)));
    }
    start.elapsed().as_secs_f64() * 1e9 / items.len() as f64
}

/// How many answers are missing, invented or off.
fn wrong<'a>(rays: &'a [Ray], ours: &impl Primitive, theirs: impl Fn(&'a Ray) -> Option<f64>) -> usize {
    let is_wrong = |ray: &'a Ray| match (ours.hit(ray, Interval::FORWARD), theirs(ray)) {
        (None, None) => false,
        (Some(hit), Some(t)) => {
            let exact = ours.surface(ray, hit).t;
            assert!((exact - hit.t()).abs() <= 1e-9 * (1.0 + exact), "{ray:?} {hit:?} {exact}");
            (t - exact).abs() * ray.direction.length() > 1e-6
        }
        _ => true,
    };
    rays.iter().filter(|ray| is_wrong(ray)).count()
}

fn row<S: Primitive, F: Fn(&Ray, Interval) -> Option<f64>>(
    name: &str,
    shape: &S,
    rival: &impl RayCast,
    textbook: &Option<F>,
    rays: &[Ray],
) {
    let theirs = |ray: &Ray| {
        let ray = ParryRay::new(ray.origin.to_array().into(), ray.direction.to_array().into());
        rival.cast_local_ray(&ray, f64::MAX, false)
    };
    let hits: Vec<_> = rays.iter().filter_map(|r| Some((*r, shape.hit(r, Interval::FORWARD)?))).collect();
    let mut best = [f64::INFINITY; 4];
    for _ in 0..PASSES {
        let mut keep = |k: usize, time: f64| best[k] = best[k].min(time);
        keep(0, time(rays, |r| shape.hit(r, Interval::FORWARD)));
        keep(1, time(rays, theirs));
        if let Some(formula) = textbook {
            keep(2, time(rays, |r| formula(r, Interval::FORWARD)));
        }
        if !hits.is_empty() {
            keep(3, time(&hits, |(r, h)| shape.surface(r, *h)));
        }
    }
    let [hit, parry, formula, surface] = best;
    print!(
        "{name:18} hit {hit:6.1}  parry {parry:7.1} ({:4.2}, {:4} wrong)",
        hit / parry,
        wrong(rays, shape, theirs)
    );
    if let Some(f) = textbook {
        let count = wrong(rays, shape, |r| f(r, Interval::FORWARD));
        print!("  textbook {formula:6.1} ({:4.2}, {count:4} wrong)", hit / formula);
    }
    if hits.is_empty() { println!() } else { println!("  surface {surface:6.1}") }
}

/// The five families about a centre; `touch` gives a point of the surface and the normal there.
fn rows<S: Primitive, F: Fn(&Ray, Interval) -> Option<f64>>(
    name: &str,
    (shape, rival, textbook): (&S, &impl RayCast, &Option<F>),
    (radius, inner): (f64, f64),
    touch: impl Fn(&mut Random) -> (DVec3, DVec3),
) {
    if std::env::args().nth(1).is_some_and(|only| only != name) {
        return;
    }
    let center = DVec3::ZERO;
    for (family, rays) in [
        ("random", aimed(center, radius, 4.0, 1.0)),
        ("far", aimed(center, radius, 1e4, 1.0)),
        ("grazing", grazing(radius, 1e-8, touch)),
        ("miss", missing(center, radius)),
        ("inside", inside(center, radius, inner)),
    ] {
        row(&format!("{name}/{family}"), shape, rival, textbook, &rays);
    }
}

type NoFormula = Option<fn(&Ray, Interval) -> Option<f64>>;

fn main() {
    let sphere = Sphere::new([0.0; 3], 1.3).unwrap();
    let on_sphere = |random: &mut Random| {
        let normal = random.direction();
        (normal * 1.3, normal)
    };
    let formula = Some(|ray: &Ray, within| textbook_sphere(DVec3::ZERO, 1.3, ray, within));
    rows("sphere", (&sphere, &parry::Ball::new(1.3), &formula), (1.3, 0.9), on_sphere);

    let (base, top) = (DVec3::new(0.0, -1.1, 0.0), DVec3::new(0.0, 1.1, 0.0));
    let cylinder = Cylinder::new(base, top, 0.8).unwrap();
    let plain = TextbookFrustum::new(base, 0.8, top, 0.8);
    let formula = Some(|ray: &Ray, within| plain.hit::<false>(ray, within));
    let rival = parry::Cylinder::new(1.1, 0.8);
    rows("cylinder", (&cylinder, &rival, &formula), (1.36, 0.5), |r| on_side(&plain, r));

    let cone = Cone::new(base, 1.1, top, 0.0).unwrap();
    let plain = TextbookFrustum::new(base, 1.1, top, 0.0);
    let formula = Some(|ray: &Ray, within| plain.hit::<true>(ray, within));
    let rival = parry::Cone::new(1.1, 1.1);
    rows("cone", (&cone, &rival, &formula), (1.56, 0.2), |r| on_side(&plain, r));

    let half = DVec3::new(0.8, 1.1, 0.6);
    let cuboid = Cuboid::new(-half, half).unwrap();
    let rival = parry::Cuboid::new(half.to_array().into());
    let none: NoFormula = None;
    let on_face =
        |random: &mut Random| (DVec3::new(0.8, 0.5 * random.signed(), 0.3 * random.signed()), DVec3::X);
    rows("cuboid", (&cuboid, &rival, &none), (1.49, 0.4), on_face);

    let corners = [[1.0, 0.1, 0.3], [-0.9, 0.2, 0.6], [0.1, -0.5, -1.2]];
    let [a, b, c] = corners;
    let triangle = Triangle::new(a, b, c).unwrap();
    let rival = parry::Triangle::new(a.into(), b.into(), c.into());
    let on_edge = |random: &mut Random| {
        let s = 0.5 + 0.4 * random.signed();
        let [a, b, c] = corners.map(DVec3::from);
        (a + (b - a) * s, (b - a).cross(c - a).cross(b - a).normalize() * -1.0)
    };
    rows("triangle", (&triangle, &rival, &none), (1.3, 0.4), on_edge);
}
