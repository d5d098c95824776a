//! The first hit of a shape and its full record: ours beside parry3d-f64 and the textbook formula.
//!
//! `cargo run --release -p rivals-shapes`: for each family of rays the least time of a ray over interleaved passes in
//! nanoseconds, and ours in units of the others'. The answers are checked first: where parry or the formula disagree
//! about a hit, or are off by more than 1e-6 of the size, they are counted as wrong. parry finds the first hit in
//! front of the origin with its normal; its cylinder and cone stand on the y axis, and so do ours here.

use parry3d_f64::math::Pose;
use parry3d_f64::query::{Ray as ParryRay, RayCast};
use parry3d_f64::shape as parry;
use rt_core;
use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Triangle};
use rt_core::{Interval, Primitive, Ray};
use std::hint::black_box;
use std::time::Instant;

#[path = "../../../benches/shapes/families.rs"]
#[allow(dead_code)]
mod families;
use families::{
    Random, TextbookFrustum, aimed, grazing, inside, missing, on_side, textbook_cuboid, textbook_disk,
    textbook_plane, textbook_sphere, textbook_triangle,
};

/// Enough that the least time is not disturbed.
const PASSES: usize = 60;

/// The time of one pass in nanoseconds an item.
///
/// Every solver is treated alike, as a renderer would: it is called and not inlined, so that nothing stays in registers
/// from ray to ray; the numbers of its shape, the ray and the interval come from outside, and are not known when it is
/// compiled.
fn time<S, T, R>(shape: &S, items: &[T], within: Interval, solve: impl Fn(&S, &T, Interval) -> R) -> f64 {
    #[inline(never)]
    fn call<S, T, R>(solve: &impl Fn(&S, &T, Interval) -> R, shape: &S, item: &T, within: Interval) -> R {
        solve(shape, item, within)
    }
    let (shape, within) = (black_box(shape), black_box(within));
    let start = Instant::now();
    for item in items {
        black_box(call(&solve, shape, black_box(item), within));
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

/// What answers a ray beside ours: a shape of parry's, where it has one, and the numbers of the textbook's formula.
struct Rivals<R, N> {
    parry: Option<R>,
    textbook: N,
}

fn row<S: Primitive, R: RayCast, N>(
    name: &str,
    shape: &S,
    Rivals { parry, textbook }: &Rivals<R, N>,
    formula: impl Fn(&N, &Ray, Interval) -> Option<f64>,
    rays: &[Ray],
) {
    let theirs = |ray: &Ray| ParryRay::new(ray.origin.to_array().into(), ray.direction.to_array().into());
    let parry_rays: Vec<_> = rays.iter().map(theirs).collect();
    let cast = |rival: &R, ray: &ParryRay, within: Interval| rival.cast_local_ray(ray, within.max, false);
    // Where a scene has the shape: at the origin, but parry does not know that.
    let cast_placed = |(rival, place): &(&R, Pose), ray: &ParryRay, within: Interval| {
        rival.cast_ray(place, ray, within.max, false)
    };
    let forward = Interval::FORWARD;
    let hits: Vec<_> = rays.iter().filter_map(|r| Some((*r, shape.hit(r, forward)?))).collect();
    let mut best = [f64::INFINITY; 5];
    for _ in 0..PASSES {
        let mut keep = |k: usize, time: f64| best[k] = best[k].min(time);
        keep(0, time(shape, rays, forward, |s, r, within| s.hit(r, within)));
        keep(1, time(textbook, rays, forward, &formula));
        if let Some(rival) = parry {
            // It knows no infinite end.
            let within = forward.until(f64::MAX);
            keep(2, time(rival, &parry_rays, within, cast));
            keep(3, time(&(rival, Pose::identity()), &parry_rays, within, cast_placed));
        }
        if !hits.is_empty() {
            keep(4, time(shape, &hits, forward, |s, (r, h), _| s.surface(r, *h)));
        }
    }
    let [hit, plain, own, placed, surface] = best;
    let count = wrong(rays, shape, |r| formula(textbook, r, forward));
    print!("{name:18} hit {hit:6.1}  textbook {plain:6.1} ({:4.2}, {count:4} wrong)", hit / plain);
    match parry {
        Some(rival) => {
            let count = wrong(rays, shape, |r| cast(rival, &theirs(r), forward.until(f64::MAX)));
            print!("  parry {own:6.1} ({:4.2}, {count:4} wrong)", hit / own);
            print!("  placed {placed:6.1} ({:4.2})", hit / placed);
        }
        None => print!("{:55}", ""),
    }
    if hits.is_empty() { println!() } else { println!("  surface {surface:6.1}") }
}

/// The five families about a centre; `touch` gives a point of the surface and the normal there.
fn rows<S: Primitive, R: RayCast, N>(
    name: &str,
    (shape, rivals): (&S, Rivals<R, N>),
    formula: impl Fn(&N, &Ray, Interval) -> Option<f64> + Copy,
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
        row(&format!("{name}/{family}"), shape, &rivals, formula, &rays);
    }
}

fn main() {
    let center = DVec3::ZERO;

    let radius = 1.3;
    let sphere = Sphere::new(center, radius).unwrap();
    let rivals = Rivals { parry: Some(parry::Ball::new(radius)), textbook: (center, radius) };
    let on_sphere = |random: &mut Random| {
        let normal = random.direction();
        (normal * 1.3, normal)
    };
    let formula = |&(c, r): &(DVec3, f64), ray: &Ray, within| textbook_sphere(c, r, ray, within);
    rows("sphere", (&sphere, rivals), formula, (1.3, 0.9), on_sphere);

    let normal = DVec3::new(0.3, 0.8, -0.2).normalize();
    let plane = Plane::new(center, normal).unwrap();
    let rivals =
        Rivals { parry: Some(parry::HalfSpace::new(normal.to_array().into())), textbook: (center, normal) };
    // Within 1e-3 of parallel to the plane.
    let nearly_on_plane = |random: &mut Random| {
        let tilt = normal.cross(random.direction()) * 1e-3;
        (random.direction().cross(normal), (normal + tilt).normalize())
    };
    let formula = |&(p, n): &(DVec3, DVec3), ray: &Ray, within| textbook_plane(p, n, ray, within);
    rows("plane", (&plane, rivals), formula, (1.0, 0.9), nearly_on_plane);

    let disk = Disk::new(center, normal, radius).unwrap();
    let rivals = Rivals { parry: None::<parry::Ball>, textbook: (center, normal, radius) };
    let on_rim = |random: &mut Random| {
        let away = normal.cross(random.direction()).normalize();
        (away * 1.3, away)
    };
    let formula = |&(c, n, r): &(DVec3, DVec3, f64), ray: &Ray, within| textbook_disk(c, n, r, ray, within);
    rows("disk", (&disk, rivals), formula, (1.3, 0.9), on_rim);

    let half = DVec3::new(0.8, 1.1, 0.6);
    let cuboid = Cuboid::new(-half, half).unwrap();
    let rivals = Rivals { parry: Some(parry::Cuboid::new(half.to_array().into())), textbook: (-half, half) };
    let on_face =
        |random: &mut Random| (DVec3::new(0.8, 0.5 * random.signed(), 0.3 * random.signed()), DVec3::X);
    let formula = |&(min, max): &(DVec3, DVec3), ray: &Ray, within| textbook_cuboid(min, max, ray, within);
    rows("cuboid", (&cuboid, rivals), formula, (1.49, 0.4), on_face);

    let corners = [[1.0, 0.1, 0.3], [-0.9, 0.2, 0.6], [0.1, -0.5, -1.2]];
    let [a, b, c] = corners;
    let triangle = Triangle::new(a, b, c).unwrap();
    let vertices = corners.map(DVec3::from);
    let rivals =
        Rivals { parry: Some(parry::Triangle::new(a.into(), b.into(), c.into())), textbook: vertices };
    let on_edge = |random: &mut Random| {
        let s = 0.5 + 0.4 * random.signed();
        let [a, b, c] = vertices;
        (a + (b - a) * s, (b - a).cross(c - a).cross(b - a).normalize() * -1.0)
    };
    let formula = |&corners: &[DVec3; 3], ray: &Ray, within| textbook_triangle(corners, ray, within);
    rows("triangle", (&triangle, rivals), formula, (1.3, 0.4), on_edge);

    let (base, top) = (DVec3::new(0.0, -1.1, 0.0), DVec3::new(0.0, 1.1, 0.0));
    let cylinder = Cylinder::new(base, top, 0.8).unwrap();
    let plain = TextbookFrustum::new(base, 0.8, top, 0.8);
    let rivals = Rivals { parry: Some(parry::Cylinder::new(1.1, 0.8)), textbook: &plain };
    let formula = |plain: &&TextbookFrustum, ray: &Ray, within| plain.hit::<false>(ray, within);
    rows("cylinder", (&cylinder, rivals), formula, (1.36, 0.5), |r| on_side(&plain, r));

    let cone = Cone::new(base, 1.1, top, 0.0).unwrap();
    let plain = TextbookFrustum::new(base, 1.1, top, 0.0);
    let rivals = Rivals { parry: Some(parry::Cone::new(1.1, 1.1)), textbook: &plain };
    let formula = |plain: &&TextbookFrustum, ray: &Ray, within| plain.hit::<true>(ray, within);
    rows("cone", (&cone, rivals), formula, (1.56, 0.2), |r| on_side(&plain, r));
}
