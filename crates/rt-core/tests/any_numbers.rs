//! Any numbers at all as shapes, rays, intervals and coefficients: what the fuzz targets check, without a fuzzer.
//!
//! `RT_ANY_NUMBERS` sets the number of cases of each kind (default 2000), `RT_ANY_SEED` where the sequence starts.
#![cfg(feature = "testing")]

use rt_core::glam::DVec3;
use rt_core::poly::quartic;
use rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus, Triangle};
use rt_core::testing::{Effort, Random, check_crossings, check_primitive};
use rt_core::{Error, Geometry, Interval, Primitive, Ray, Shape};

/// A number of plain size, one of another size, or the sum of a small and a very small one: nearly equal, never quite.
///
/// Sizes differ by no more than 1e12: of shapes whose own lengths, or whose distance from the ray's start, are more
/// than 2^80 apart, double-double arithmetic cannot tell. Any bits at all are cast by `check_primitive`.
fn number(random: &mut Random) -> f64 {
    let plain = |random: &mut Random| f64::from(random.below(65) as i32 - 32) / 8.0;
    match random.below(8) {
        0 => random.sign() * random.magnitude(-6.0, 6.0),
        1..=3 => plain(random) + plain(random) * random.magnitude(-17.0, -12.0),
        _ => plain(random),
    }
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(number(random), number(random), number(random))
}

fn shape(random: &mut Random, kind: u32) -> Result<Shape, Error> {
    let [a, b, c] = [vector(random), vector(random), vector(random)];
    let [l, m] = [number(random), number(random)];
    Ok(match kind {
        0 => Sphere::new(a, l)?.into(),
        1 => Plane::new(a, b)?.into(),
        2 => Cuboid::new(a.min(b), a.max(b))?.into(),
        3 => Cylinder::new(a, b, l)?.into(),
        4 => Cylinder::open(a, b, l)?.into(),
        5 => Cone::new(a, l, b, m)?.into(),
        6 => Cone::open(a, l, b, m)?.into(),
        7 => Torus::new(a, b, l, m)?.into(),
        8 => Disk::new(a, b, l)?.into(),
        _ => Triangle::new(a, b, c)?.into(),
    })
}

fn closed(shape: &Shape) -> bool {
    match shape {
        Shape::Sphere(_) | Shape::Cuboid(_) | Shape::Torus(_) => true,
        Shape::Cylinder(cylinder) => cylinder.is_closed(),
        Shape::Cone(cone) => cone.is_closed(),
        _ => false,
    }
}

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

/// A random number generator for each of the cases, so that one alone can be run again.
fn cases() -> impl Iterator<Item = (u64, Random)> {
    let first = setting("RT_ANY_SEED", 0);
    (first..first + setting("RT_ANY_NUMBERS", 2000)).map(|seed| (seed, Random::new(seed << 8)))
}

/// All crossings lie inside the interval and ascend, the nearest is the first, none is reported again by an interval
/// that starts or ends with it, and each has a unit normal.
fn check_ray(shape: &Shape, ray: &Ray, within: Interval) -> Result<(), String> {
    let mut hits = Vec::new();
    shape.crossings(ray, within, &mut |hit| hits.push(hit));
    let nearest = shape.hit(ray, within);
    let fail = |what: &str| Err(format!("{what}: {shape:?} {ray:?} {within:?} {hits:?} {nearest:?}"));
    if !hits.is_empty() && !ray.is_valid() {
        return fail("an invalid ray hits");
    }
    if hits.len() > 4
        || !hits.iter().all(|hit| within.contains(hit.t()))
        || !hits.is_sorted_by(|a, b| a.t() <= b.t())
    {
        return fail("crossings");
    }
    if nearest.map(|hit| hit.t()) != hits.first().map(|hit| hit.t()) {
        return fail("nearest");
    }
    for hit in &hits {
        for rest in [within.until(hit.t()), within.after(hit.t())] {
            if shape.hit(ray, rest).is_some_and(|next| (next.part(), next.root()) == (hit.part(), hit.root()))
            {
                return fail("a hit twice");
            }
        }
        let surface = shape.surface(ray, *hit);
        if !surface.t.is_finite() || (surface.normal.length() - 1.0).abs() > 1e-15 {
            return fail(&format!("{surface:?}"));
        }
    }
    Ok(())
}

fn shapes(kind: u32) {
    for (seed, mut random) in cases() {
        let Ok(shape) = shape(&mut random, kind) else { continue };
        // The sheets of such a spindle are nearer to each other than a point is known: unsupported. A line through the
        // pinch of a horn meets it or misses it by its last bits, and so does the way back.
        if matches!(&shape, Shape::Torus(torus) if torus.major() < 1e-12 * torus.minor()
            || (torus.major() - torus.minor()).abs() < 1e-12 * torus.minor())
        {
            continue;
        }
        // Nor are walls supported that are thinner than two error radii, such as those of a tube thinner than this.
        if matches!(&shape, Shape::Cylinder(tube) if tube.radius() < 1e-12 * (tube.top() - tube.base()).length())
        {
            continue;
        }
        let within = if random.once_in(2) {
            Interval::LINE
        } else {
            Interval::new(number(&mut random), number(&mut random))
        };
        let ray = Ray::new(vector(&mut random), vector(&mut random));
        check_ray(&shape, &ray, within).unwrap_or_else(|found| panic!("seed {seed}: {found}"));
        check_crossings(&shape, &ray).unwrap_or_else(|found| panic!("seed {seed}: {found}"));
        let effort = Effort::new(seed, 3);
        let effort = if closed(&shape) { effort.closed() } else { effort };
        check_primitive(&shape, &effort).unwrap_or_else(|found| panic!("seed {seed}: {shape:?}: {found}"));
    }
}

macro_rules! shapes {
    ($($name:ident: $kind:expr;)*) => {
        $(#[test]
        fn $name() {
            shapes($kind);
        })*
    };
}

shapes! {
    any_sphere: 0;
    any_plane: 1;
    any_cuboid: 2;
    any_cylinder: 3;
    any_open_cylinder: 4;
    any_cone: 5;
    any_open_cone: 6;
    any_torus: 7;
    any_disk: 8;
    any_triangle: 9;
}

/// The roots ascend and are finite, and the mirrored polynomial has the mirrored roots, bit for bit.
#[test]
fn any_quartic() {
    for (seed, mut random) in cases() {
        let any = seed % 4 == 0;
        let c = [(); 5].map(|()| if any { random.any_f64() } else { number(&mut random) });
        // What coefficients that are not finite give is documented; here they would make every comparison false.
        if !c.iter().all(|c| c.is_finite()) {
            continue;
        }
        let found = quartic(c, Interval::LINE);
        let count: u32 = found.iter().map(|root| root.multiplicity).sum();
        assert!(count <= 4 && found.iter().all(|root| root.x.is_finite()), "seed {seed}: {c:?} {found:?}");
        assert!(found.is_sorted_by(|a, b| a.x <= b.x), "seed {seed}: {c:?} {found:?}");
        assert_eq!(found.all(), c == [0.0; 5], "seed {seed}");
        let mirrored = quartic([c[0], -c[1], c[2], -c[3], c[4]], Interval::LINE);
        let back: Vec<(f64, u32)> = mirrored.iter().rev().map(|root| (-root.x, root.multiplicity)).collect();
        let there: Vec<(f64, u32)> = found.iter().map(|root| (root.x, root.multiplicity)).collect();
        assert_eq!(there, back, "seed {seed}: {c:?}");
    }
}

/// The acceleration structure gives the answers of the plain loop, bit for bit.
#[test]
fn accelerated_and_plain() {
    for (seed, mut random) in cases().step_by(16) {
        let (mut fast, mut plain) =
            (Geometry::builder().accelerated(true), Geometry::builder().accelerated(false));
        for _ in 0..random.below(60) {
            let kind = random.below(10);
            if let Ok(shape) = shape(&mut random, kind) {
                fast.push(shape.clone());
                plain.push(shape);
            }
        }
        let (fast, plain) = (fast.build(), plain.build());
        for _ in 0..16 {
            let ray = Ray::new(vector(&mut random), vector(&mut random));
            let within = Interval::FORWARD;
            let (a, b) = (fast.nearest(&ray, within), plain.nearest(&ray, within));
            assert_eq!(a, b, "seed {seed}: {ray:?}");
            assert_eq!(fast.occluded(&ray, within), b.is_some(), "seed {seed}: {ray:?}");
        }
    }
}
