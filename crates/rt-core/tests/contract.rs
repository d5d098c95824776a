//! The contract of the library's own shapes: what any shape must keep, and what exact ones can.
//!
//! `RT_HARD_RAYS` sets how many hard rays of each of five kinds are cast at each shape in each of four places (default
//! 1000), `RT_HARD_SEED` which ones: a long run can be made of several. `RT_PROPERTY_CASES` sets the number of cases of
//! each property.
#![cfg(feature = "testing")]

use proptest::prelude::*;
use rt_core::glam::DVec3;
use rt_core::testing::{Effort, HardRays, Random, check_crossings, check_primitive, oracle};
use rt_core::{Error, Hit, Interval, Primitive, Ray, Shape, Side, Similarity, Surface};

const U: f64 = f64::EPSILON / 2.0;

/// The numbers of a shape, so that a test can change them before it is built.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spec {
    Sphere { center: DVec3, radius: f64 },
    Plane { point: DVec3, normal: DVec3 },
    Disk { center: DVec3, normal: DVec3, radius: f64 },
    Cuboid { min: DVec3, max: DVec3 },
    Cylinder { base: DVec3, top: DVec3, radius: f64, closed: bool },
    Cone { base: DVec3, base_radius: f64, top: DVec3, top_radius: f64, closed: bool },
    Torus { center: DVec3, axis: DVec3, major: f64, minor: f64 },
    Triangle { a: DVec3, b: DVec3, c: DVec3 },
}
use Spec::*;

impl Spec {
    fn build(&self) -> Result<Shape, Error> {
        Ok(match *self {
            Sphere { center, radius } => rt_core::shape::Sphere::new(center, radius)?.into(),
            Plane { point, normal } => rt_core::shape::Plane::new(point, normal)?.into(),
            Disk { center, normal, radius } => rt_core::shape::Disk::new(center, normal, radius)?.into(),
            Cuboid { min, max } => rt_core::shape::Cuboid::new(min, max)?.into(),
            Cylinder { base, top, radius, closed: true } => {
                rt_core::shape::Cylinder::new(base, top, radius)?.into()
            }
            Cylinder { base, top, radius, closed: false } => {
                rt_core::shape::Cylinder::open(base, top, radius)?.into()
            }
            Cone { base, base_radius, top, top_radius, closed: true } => {
                rt_core::shape::Cone::new(base, base_radius, top, top_radius)?.into()
            }
            Cone { base, base_radius, top, top_radius, closed: false } => {
                rt_core::shape::Cone::open(base, base_radius, top, top_radius)?.into()
            }
            Torus { center, axis, major, minor } => {
                rt_core::shape::Torus::new(center, axis, major, minor)?.into()
            }
            Triangle { a, b, c } => rt_core::shape::Triangle::new(a, b, c)?.into(),
        })
    }

    /// The same shape with every point mapped by `point`, every direction by `turn`, every length times `scale`.
    fn map(&self, point: impl Fn(DVec3) -> DVec3, turn: impl Fn(DVec3) -> DVec3, scale: f64) -> Spec {
        match *self {
            Sphere { center, radius } => Sphere { center: point(center), radius: radius * scale },
            Plane { point: p, normal } => Plane { point: point(p), normal: turn(normal) },
            Disk { center, normal, radius } => {
                Disk { center: point(center), normal: turn(normal), radius: radius * scale }
            }
            Cuboid { min, max } => {
                let (a, b) = (point(min), point(max));
                Cuboid { min: a.min(b), max: a.max(b) }
            }
            Cylinder { base, top, radius, closed } => {
                Cylinder { base: point(base), top: point(top), radius: radius * scale, closed }
            }
            Cone { base, base_radius, top, top_radius, closed } => Cone {
                base: point(base),
                base_radius: base_radius * scale,
                top: point(top),
                top_radius: top_radius * scale,
                closed,
            },
            Torus { center, axis, major, minor } => {
                Torus { center: point(center), axis: turn(axis), major: major * scale, minor: minor * scale }
            }
            Triangle { a, b, c } => Triangle { a: point(a), b: point(b), c: point(c) },
        }
    }

    fn closed(&self) -> bool {
        match *self {
            Sphere { .. } | Cuboid { .. } | Torus { .. } => true,
            Cylinder { closed, .. } | Cone { closed, .. } => closed,
            Plane { .. } | Disk { .. } | Triangle { .. } => false,
        }
    }

    fn convex(&self) -> bool {
        match *self {
            Torus { .. } => false,
            Cylinder { closed, .. } | Cone { closed, .. } => closed,
            _ => true,
        }
    }

    /// The distance of a point, relative to the anchor, from the part of the surface that was hit.
    fn distance(&self, surface: &Surface) -> f64 {
        let l = surface.local;
        let n = surface.normal;
        // A cap has the axis for a normal; a side never quite.
        let capped = |axis: DVec3| n.dot(axis.normalize()).abs() > 1.0 - 1e-12;
        let cap = |axis: DVec3| oracle::plane(l, axis).abs().min(oracle::plane(l - axis, axis).abs());
        match *self {
            Sphere { radius, .. } => oracle::sphere(l, radius),
            Plane { normal, .. } | Disk { normal, .. } => oracle::plane(l, normal),
            Cuboid { min, max } => {
                let size = max - min;
                (0..3).map(|i| l[i].abs().min((l[i] - size[i]).abs())).fold(f64::INFINITY, f64::min)
            }
            Cylinder { base, top, closed: true, .. } | Cone { base, top, closed: true, .. }
                if capped(top - base) =>
            {
                cap(top - base)
            }
            Cylinder { base, top, radius, .. } => oracle::cylinder(l, top - base, radius),
            Cone { base, base_radius, top, top_radius, .. } => {
                oracle::cone(l, top - base, base_radius, top_radius)
            }
            Torus { axis, major, minor, .. } => oracle::torus(l, axis, major, minor),
            Triangle { a, b, c } => oracle::plane(l, (b - a).cross(c - a)),
        }
    }
}

/// How many cases each property tries: `RT_PROPERTY_CASES`, or 384.
fn cases() -> u32 {
    std::env::var("RT_PROPERTY_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(384)
}

/// Multiples of 2^-20 up to `most`: sums and differences of a few are exact.
fn grid(most: f64) -> impl Strategy<Value = f64> {
    let steps = (most * 1_048_576.0) as i32;
    (-steps..=steps).prop_map(|n| f64::from(n) / 1_048_576.0)
}

fn vector(most: f64) -> impl Strategy<Value = DVec3> {
    (grid(most), grid(most), grid(most)).prop_map(DVec3::from)
}

/// Directions, one in four along an axis.
fn direction() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        3 => vector(1.0).prop_filter("too short", |v| v.length() > 0.1),
        1 => (0..3_usize, prop::bool::ANY).prop_map(|(i, back)| if back { -DVec3::AXES[i] } else { DVec3::AXES[i] }),
    ]
}

fn length() -> impl Strategy<Value = f64> {
    (10_000..2_000_000_i32).prop_map(|n| f64::from(n) / 1_048_576.0)
}

fn solid() -> impl Strategy<Value = Spec> {
    let p = || vector(4.0);
    prop_oneof![
        (p(), length()).prop_map(|(center, radius)| Sphere { center, radius }),
        (p(), length(), length(), length())
            .prop_map(|(min, x, y, z)| Cuboid { min, max: min + DVec3::new(x, y, z) }),
        (p(), direction(), length(), prop::bool::ANY).prop_map(|(base, axis, radius, closed)| Cylinder {
            base,
            top: base + axis,
            radius,
            closed
        }),
        (p(), direction(), length(), prop_oneof![Just(0.0), length()], prop::bool::ANY).prop_map(
            |(base, axis, base_radius, top_radius, closed)| Cone {
                base,
                base_radius,
                top: base + axis,
                top_radius,
                closed
            }
        ),
        (p(), direction(), length(), length()).prop_map(|(center, axis, major, minor)| Torus {
            center,
            axis,
            major,
            minor
        }),
    ]
}

fn flat() -> impl Strategy<Value = Spec> {
    let p = || vector(4.0);
    prop_oneof![
        (p(), direction()).prop_map(|(point, normal)| Plane { point, normal }),
        (p(), direction(), length()).prop_map(|(center, normal, radius)| Disk { center, normal, radius }),
        (p(), vector(2.0), vector(2.0)).prop_map(|(a, e, f)| Triangle { a, b: a + e, c: a + f }),
    ]
}

fn spec() -> impl Strategy<Value = Spec> {
    prop_oneof![2 => solid(), 1 => flat()].prop_filter("degenerate", |s| s.build().is_ok())
}

/// A shape and a ray at something near it.
fn aimed(spec: impl Strategy<Value = Spec>) -> impl Strategy<Value = (Spec, Ray)> {
    (spec, vector(16.0), vector(1.0)).prop_map(|(spec, away, off)| {
        let shape = spec.build().expect("filtered");
        let target = shape.bounds().map_or(DVec3::ZERO, |b| grid_point(b.center())) + off;
        (spec, Ray::new(target + away, if away == DVec3::ZERO { DVec3::X } else { -away }))
    })
}

/// The nearest point whose coordinates are multiples of 2^-20.
fn grid_point(p: DVec3) -> DVec3 {
    (p * 1_048_576.0).round() / 1_048_576.0
}

fn crossings(shape: &Shape, ray: &Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    shape.crossings(ray, Interval::LINE, &mut |hit| hits.push(hit));
    hits
}

fn parameters(shape: &Shape, ray: &Ray) -> Vec<f64> {
    crossings(shape, ray).into_iter().map(|hit| shape.surface(ray, hit).t).collect()
}

/// Whether two lists of parameters are the same to `ulps` units of `scale`.
fn same(a: &[f64], b: &[f64], scale: f64, ulps: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= ulps * 2.0 * U * scale)
}

/// The least cosine of the angle between the line and the normals, and the least gap between parameters: rays for which
/// the last bit decides the count are not for properties that compare two of them.
fn clear(shape: &Shape, ray: &Ray) -> bool {
    let hits = crossings(shape, ray);
    let d = ray.direction.normalize();
    let steep = hits.iter().all(|h| shape.surface(ray, *h).normal.dot(d).abs() > 1e-6);
    steep && hits.windows(2).all(|w| (w[1].t() - w[0].t()).abs() > 1e-9)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases()) })]

    #[test]
    fn every_shape_keeps_the_contract(spec in spec(), seed in any::<u64>()) {
        let effort = Effort::new(seed, 6);
        let effort = if spec.closed() { effort.closed() } else { effort };
        let result = check_primitive(&spec.build().unwrap(), &effort);
        prop_assert!(result.is_ok(), "{spec:?}: {}", result.unwrap_err());
    }

    /// P1, P2: the surface equation holds for `local`, within one unit in the last place of its size.
    #[test]
    fn hits_lie_on_the_surface((spec, ray) in aimed(spec())) {
        let shape = spec.build().unwrap();
        for hit in crossings(&shape, &ray) {
            let surface = shape.surface(&ray, hit);
            let size = shape.bounds().map_or(0.0, |b| (b.max - b.min).max_element()).max(surface.local.length());
            let off = spec.distance(&surface);
            prop_assert!(off.abs() <= 4.0 * U * size, "{off:e} off, {surface:?}");
        }
    }

    /// Where a ray meets a surface clearly, the error radius is some roundings, not more.
    #[test]
    fn error_radii_are_small((spec, ray) in aimed(spec())) {
        let shape = spec.build().unwrap();
        for hit in crossings(&shape, &ray).into_iter().filter(|_| clear(&shape, &ray)) {
            let surface = shape.surface(&ray, hit);
            let size = shape.bounds().map_or(0.0, |b| (b.max - b.min).max_element());
            let reach = size + surface.point.abs().max_element() + surface.local.abs().max_element();
            prop_assert!(surface.error <= 16.0 * U * reach, "{:e} of {reach}", surface.error);
            prop_assert!(surface.error >= 0.5 * U * surface.point.abs().max_element());
        }
    }

    /// A box is no larger than its shape but for some roundings.
    #[test]
    fn boxes_are_tight(spec in spec()) {
        let Some(bounds) = spec.build().unwrap().bounds() else { return Ok(()) };
        let disc = |center: DVec3, axis: DVec3, radius: f64| {
            let a = axis.normalize();
            let reach = (DVec3::ONE - a * a).max(DVec3::ZERO).map(f64::sqrt) * radius;
            [center - reach, center + reach]
        };
        let ends: Vec<DVec3> = match spec {
            Sphere { center, radius } => vec![center - radius, center + radius],
            Plane { .. } => return Ok(()),
            Disk { center, normal, radius } => disc(center, normal, radius).to_vec(),
            Cuboid { min, max } => vec![min, max],
            Cylinder { base, top, radius, .. } => {
                [disc(base, top - base, radius), disc(top, top - base, radius)].concat()
            }
            Cone { base, base_radius, top, top_radius, .. } => {
                [disc(base, top - base, base_radius), disc(top, top - base, top_radius)].concat()
            }
            Torus { center, axis, major, minor } => {
                let [min, max] = disc(center, axis, major);
                vec![min - minor, max + minor]
            }
            Triangle { a, b, c } => vec![a, b, c],
        };
        let least = ends.iter().fold(DVec3::INFINITY, |least, end| least.min(*end));
        let most = ends.iter().fold(DVec3::NEG_INFINITY, |most, end| most.max(*end));
        let room = 64.0 * U * ((most - least).max_element() + most.abs().max(least.abs()).max_element());
        prop_assert!((bounds.min - least).abs().max_element() <= room, "{bounds:?} {least}");
        prop_assert!((bounds.max - most).abs().max_element() <= room, "{bounds:?} {most}");
    }

    /// P2: the normal is the gradient of the signed distance, outward; of a flat face, its own.
    #[test]
    fn normals_are_gradients((spec, ray) in aimed(spec())) {
        let shape = spec.build().unwrap();
        for hit in crossings(&shape, &ray) {
            let surface = shape.surface(&ray, hit);
            let (l, n) = (surface.local, surface.normal);
            let side = |e: &dyn Fn(DVec3) -> f64| {
                // Differences over 2^-26: the third derivative of a curve of radius 0.01 adds less than 1e-10, and a
                // place nearer than that to an apex has no gradient.
                let h = 1.0 / f64::from(1 << 26);
                let slope = |axis: DVec3| {
                    let (p, q) = (l + axis * h, l - axis * h);
                    (e(p) - e(q)) / (p - q).dot(axis)
                };
                DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z))
            };
            let expected = match (spec, hit.part()) {
                (Sphere { radius, .. }, _) => side(&|p| oracle::sphere(p, radius)),
                (Cylinder { base, top, radius, .. }, 0) => side(&|p| oracle::cylinder(p, top - base, radius)),
                (Cone { base, base_radius, top, top_radius, .. }, 0) => {
                    let wall = |p| oracle::cone(p, top - base, base_radius, top_radius);
                    let axis = (top - base).normalize();
                    if (l - axis * l.dot(axis)).length() < 1e-3 { continue }
                    side(&wall)
                }
                (Cylinder { base, top, .. } | Cone { base, top, .. }, part) => {
                    (top - base).normalize() * if part == 1 { -1.0 } else { 1.0 }
                }
                (Torus { axis, major, minor, .. }, _) => {
                    let a = axis.normalize();
                    if (l - a * l.dot(a)).length() < 1e-3 { continue }
                    side(&|p| oracle::torus(p, axis, major, minor))
                }
                (Cuboid { min, max }, _) => {
                    prop_assert!(n.dot(l - (max - min) * 0.5) > 0.0, "inward: {surface:?}");
                    let face = n.abs();
                    prop_assert_eq!((face.max_element(), face.element_sum()), (1.0, 1.0));
                    continue;
                }
                (Plane { normal, .. } | Disk { normal, .. }, _) => normal.normalize(),
                (Triangle { a, b, c }, _) => (b - a).cross(c - a).normalize(),
            };
            prop_assert!((n - expected).length() < 1e-6, "{n:?} and {expected:?} at {surface:?}");
        }
    }

    /// P1: as many crossings as the signed distance along the line has changes of sign, and at the same places.
    #[test]
    fn crossings_are_where_the_distance_changes_sign(spec in spec(), seed in any::<u64>()) {
        let shape = spec.build().unwrap();
        let mut rays = HardRays::new(seed, shape.bounds());
        let mut known = None;
        for _ in 0..6 {
            let mut aims = vec![rays.aimed(), rays.at_feature()];
            if let Some((point, normal)) = known {
                aims.extend([rays.grazing(point, normal), rays.starting_at(point)]);
            }
            for ray in aims {
                let found = check_crossings(&shape, &ray);
                prop_assert!(found.is_ok(), "{}", found.unwrap_err());
                let hit = shape.hit(&ray, Interval::FORWARD);
                known = hit.map(|hit| shape.surface(&ray, hit)).map(|s| (s.point, s.normal)).or(known);
            }
        }
    }

    /// P6: lengths and the direction times powers of two, the parameter times their quotient, bit for bit, over all
    /// sizes from 1e-135 to 1e135.
    #[test]
    fn scaling_is_exact((spec, ray) in aimed(spec()), power in -450..450_i32, speed in -450..450_i32) {
        let (scale, speed) = (libm::exp2(f64::from(power)), libm::exp2(f64::from(speed)));
        let shape = spec.build().unwrap();
        let larger = spec.map(|p| p * scale, |d| d, scale).build().unwrap();
        let far = Ray::new(ray.origin * scale, ray.direction * speed);
        let a: Vec<f64> = crossings(&shape, &ray).iter().map(|h| h.t() * scale / speed).collect();
        let b: Vec<f64> = crossings(&larger, &far).iter().map(Hit::t).collect();
        prop_assert_eq!(a, b);
        let a: Vec<f64> = parameters(&shape, &ray).iter().map(|t| t * scale / speed).collect();
        prop_assert_eq!(a, parameters(&larger, &far));
    }

    /// P6 of rays that leave the shape from any of its crossings, to either side, but for the last bits.
    #[test]
    fn scaling_of_departures((spec, ray) in aimed(spec()), way in direction(), power in -400..400_i32, speed in -400..400_i32) {
        let (scale, speed) = (libm::exp2(f64::from(power)), libm::exp2(f64::from(speed)));
        let shape = spec.build().unwrap();
        let larger = spec.map(|p| p * scale, |d| d, scale).build().unwrap();
        let far = Ray::new(ray.origin * scale, ray.direction);
        let onward = |shape: &Shape, ray: &Ray, hit: Hit, side: Side, speed: f64, unit: f64| {
            let from = shape.surface(ray, hit).departure(0, hit, side);
            let (ray, within) = from.ray(way * speed);
            let mut all = Vec::new();
            shape.crossings_leaving(&ray, within, &from, &mut |hit| all.push(hit));
            let next = shape.hit_leaving(&ray, within, &from);
            let place = |hit: Hit| (shape.surface(&ray, hit).t * unit, (hit.part(), hit.root()));
            next.into_iter().chain(all).map(place).unzip::<f64, (u32, u32), Vec<_>, Vec<_>>()
        };
        for (a, b) in crossings(&shape, &ray).into_iter().zip(crossings(&larger, &far)) {
            for side in [Side::Outside, Side::Inside] {
                let (a, parts) = onward(&shape, &ray, a, side, 1.0, scale / speed);
                let (b, same) = onward(&larger, &far, b, side, speed, 1.0);
                prop_assert_eq!(parts, same);
                // The parameter of an exit along the surface may be any within its promise.
                for (a, b) in a.into_iter().zip(b) {
                    prop_assert!((a - b).abs() <= 1e-12 * (a.abs() + scale / speed), "{} {}", a, b);
                }
            }
        }
    }

    /// P7: a mirror across a coordinate plane changes no bit; neither does another order of the axes for a cuboid, and
    /// for other shapes it changes what one rounding can.
    #[test]
    fn mirrors_and_orders((spec, ray) in aimed(spec()), k in 0..3_usize) {
        let shape = spec.build().unwrap();
        let signs = DVec3::select(DVec3::AXES[k].cmpne(DVec3::ZERO), DVec3::NEG_ONE, DVec3::ONE);
        let flip = |v: DVec3| v * signs;
        let turned = |v: DVec3| DVec3::new(v.y, v.z, v.x);
        let image = spec.map(flip, flip, 1.0).build().unwrap();
        let mirrored = Ray::new(flip(ray.origin), flip(ray.direction));
        prop_assert_eq!(parameters(&shape, &ray), parameters(&image, &mirrored));
        let hit = |shape: &Shape, ray: &Ray| shape.hit(ray, Interval::FORWARD).map(|h| h.t());
        prop_assert_eq!(hit(&shape, &ray), hit(&image, &mirrored));
        let other = spec.map(turned, turned, 1.0).build().unwrap();
        let there = Ray::new(turned(ray.origin), turned(ray.direction));
        let (a, b) = (parameters(&shape, &ray), parameters(&other, &there));
        if matches!(spec, Cuboid { .. }) {
            prop_assert_eq!(hit(&shape, &ray), hit(&other, &there));
            prop_assert_eq!(a, b);
        } else {
            let scale = a.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
            prop_assert!(same(&a, &b, scale, 1.0) || !clear(&shape, &ray), "{a:?} {b:?}");
        }
    }

    /// P8: moved together by exact steps, ray and shape meet at the same parameter.
    #[test]
    fn moving_both((spec, ray) in aimed(spec()), x in -1000..1000_i32, y in -1000..1000_i32) {
        let offset = DVec3::new(f64::from(x), f64::from(y), 1024.0);
        let shape = spec.build().unwrap();
        let moved = spec.map(|p| p + offset, |d| d, 1.0).build().unwrap();
        let (a, b) = (parameters(&shape, &ray), parameters(&moved, &Ray::new(ray.origin + offset, ray.direction)));
        let scale = a.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        prop_assert!(same(&a, &b, scale, 1.0) || !clear(&shape, &ray), "{a:?} {b:?}");
    }

    /// P8: turned together, ray and shape meet at the same parameter, as far as rounded coordinates allow.
    #[test]
    fn turning_both((spec, ray) in aimed(spec()), axis in direction(), degrees in -180.0..180.0_f64) {
        let shape = spec.build().unwrap();
        let turn = Similarity::IDENTITY.rotated(axis, degrees).unwrap();
        let (turned, there) = (shape.transformed(&turn), Ray::new(turn.point(ray.origin), turn.direction(ray.direction)));
        let (a, b) = (parameters(&shape, &ray), parameters(&turned.unwrap(), &there));
        let d = ray.direction.length();
        // Every coordinate, of the ray and of the shape, is rounded a few times: each at most 48 long here. Slivers of
        // triangles turn by more.
        let sliver = matches!(spec, Triangle { a, b, c } if (b - a).cross(c - a).length() < 0.1);
        if !clear(&shape, &ray) || sliver { return Ok(()) }
        prop_assert!(a.len() == b.len(), "{a:?} {b:?}");
        for (hit, (a, b)) in crossings(&shape, &ray).iter().zip(a.iter().zip(&b)) {
            let cosine = shape.surface(&ray, *hit).normal.dot(ray.direction).abs() / d;
            prop_assert!((a - b).abs() * d * cosine <= 64.0 * U * 48.0 * (1.0 + a.abs()), "{a} {b}");
        }
    }

    /// P13: the length of the direction does not matter, beyond the rounding of its components.
    #[test]
    fn any_length_of_the_direction((spec, ray) in aimed(spec()), length in 1.0..2.0_f64, power in -450..450_i32) {
        let shape = spec.build().unwrap();
        let factor = length * libm::exp2(f64::from(power));
        let other = Ray::new(ray.origin, ray.direction * factor);
        if !clear(&shape, &ray) { return Ok(()) }
        let (a, b) = (crossings(&shape, &ray), crossings(&shape, &other));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.into_iter().zip(b) {
            let (a, b) = (shape.surface(&ray, a), shape.surface(&other, b));
            let way = ray.direction * a.t;
            let cosine = a.normal.dot(ray.direction).abs() / ray.direction.length();
            let reach = way.length() + ray.origin.length();
            prop_assert!((a.point - b.point).length() * cosine <= 8.0 * U * reach, "{:?} {:?}", a, b);
        }
    }

    /// P9: from the other end the same line meets the same places.
    #[test]
    fn reversed((spec, ray) in aimed(spec())) {
        let shape = spec.build().unwrap();
        let back = Ray::new(ray.origin + ray.direction * 2.0, -ray.direction);
        let a = parameters(&shape, &ray);
        let mut b: Vec<f64> = parameters(&shape, &back).iter().map(|t| 2.0 - t).collect();
        b.reverse();
        let scale = a.iter().fold(2.0_f64, |m, t| m.max(t.abs()));
        prop_assert!(same(&a, &b, scale, 2.0) || !clear(&shape, &ray), "{a:?} {b:?}");
    }

    /// P10: a cylinder or cone told from its other end is the same.
    #[test]
    fn either_end((spec, ray) in aimed(solid())) {
        let other = match spec {
            Cylinder { base, top, radius, closed } => Cylinder { base: top, top: base, radius, closed },
            Cone { base, base_radius, top, top_radius, closed } if top_radius > 0.0 => {
                Cone { base: top, base_radius: top_radius, top: base, top_radius: base_radius, closed }
            }
            _ => return Ok(()),
        };
        let (Ok(shape), Ok(other)) = (spec.build(), other.build()) else { return Ok(()) };
        let (a, b) = (parameters(&shape, &ray), parameters(&other, &ray));
        let scale = a.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        prop_assert!(same(&a, &b, scale, 1.0) || !clear(&shape, &ray), "{a:?} {b:?}");
    }

    /// P11: a triangle does not care which corner comes first.
    #[test]
    fn any_corner_first(a in vector(4.0), e in vector(2.0), f in vector(2.0), away in vector(16.0),
                        w in 0.0..=1.0_f64, on_edge in prop::bool::ANY) {
        let (b, c) = (a + e, a + f);
        let orders = [[a, b, c], [b, c, a], [c, a, b], [a, c, b]];
        let shapes = orders.map(|[a, b, c]| Triangle { a, b, c }.build());
        let [Ok(p), Ok(q), Ok(r), Ok(s)] = shapes else { return Ok(()) };
        let target = a + e * w + f * if on_edge { 0.0 } else { 1.0 - w };
        let ray = Ray::new(target + away, -away);
        let hits = [p, q, r, s].map(|shape| parameters(&shape, &ray));
        for other in &hits[1..] {
            prop_assert_eq!(&hits[0], other);
        }
    }

    /// P11: no ray at the diagonal of a square made of two triangles slips through.
    #[test]
    fn watertight(a in vector(4.0), e in direction(), f in direction(), g in direction(),
                  away in vector(64.0), w in 0.0..=1.0_f64, power in -30..24_i32) {
        let scale = libm::exp2(f64::from(power));
        let (b, c, d) = (a + e, a + f, a + g);
        let target = a + e * w;
        let ray = Ray::new(target + away * scale, -away);
        let left = Triangle { a, b, c }.build();
        let right = Triangle { a: b, b: a, c: d }.build();
        let (Ok(left), Ok(right)) = (left, right) else { return Ok(()) };
        // On which sides of the plane through the ray and the edge the third corners lie decides whether both
        // triangles together cover a neighbourhood of the edge, as the ray sees it.
        let plane = ray.direction.cross(e);
        let (l, r) = (plane.dot(c - a), plane.dot(d - a));
        let inside = w > 1e-3 && w < 1.0 - 1e-3;
        if inside && l * r < 0.0 && l.abs() > 1e-3 * away.length() && r.abs() > 1e-3 * away.length() {
            let line = Interval::LINE;
            prop_assert!(left.hit(&ray, line).is_some() || right.hit(&ray, line).is_some());
        }
    }

    /// P11: nor does a ray at the common corner of a fan.
    #[test]
    fn watertight_at_a_corner(corner in vector(4.0), heights in prop::array::uniform6(grid(0.25)), away in vector(0.5),
                              far in 1..64_i32, power in -30..24_i32) {
        let ring = [(4.0, 0.0), (2.0, 3.5), (-2.0, 3.25), (-4.0, 0.5), (-2.0, -3.5), (2.0, -3.0)];
        let rim: Vec<DVec3> = ring.iter().zip(heights).map(|((x, y), z)| corner + DVec3::new(*x, *y, z)).collect();
        let away = (away + DVec3::Z * 4.0) * f64::from(far);
        let ray = Ray::new(corner + away, -away * libm::exp2(f64::from(power)));
        let hits = (0..6).filter(|&i| {
            let (b, c) = (rim[i], rim[(i + 1) % 6]);
            let shape = Triangle { a: corner, b, c }.build().unwrap();
            shape.hit(&ray, Interval::LINE).is_some()
        });
        prop_assert!(hits.count() > 0);
    }

    /// P14: a cone with equal radii is a cylinder.
    #[test]
    fn cone_without_slope((spec, ray) in aimed(solid())) {
        let Cylinder { base, top, radius, closed } = spec else { return Ok(()) };
        let cone = Cone { base, base_radius: radius, top, top_radius: radius, closed };
        let (cylinder, cone) = (spec.build().unwrap(), cone.build().unwrap());
        let (a, b) = (parameters(&cylinder, &ray), parameters(&cone, &ray));
        let scale = a.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        prop_assert!(same(&a, &b, scale, 1.0) || !clear(&cylinder, &ray), "{a:?} {b:?}");
    }

    /// P14: a torus whose major radius vanishes is a sphere, twice.
    #[test]
    fn torus_without_hole(center in vector(4.0), axis in direction(), radius in length(), away in vector(16.0),
                          off in vector(1.0)) {
        let ray = Ray::new(center + off + away, -away);
        if !ray.is_valid() { return Ok(()) }
        let major = radius * 1e-12;
        let (Ok(torus), Ok(sphere)) =
            (Torus { center, axis, major, minor: radius }.build(), Sphere { center, radius }.build())
        else { return Ok(()) };
        let reach = ray.direction.length();
        if let (Some(a), Some(b)) = (torus.hit(&ray, Interval::LINE), sphere.hit(&ray, Interval::LINE)) {
            let cosine = sphere.surface(&ray, b).normal.dot(ray.direction).abs() / reach;
            prop_assert!((a.t() - b.t()).abs() * reach * cosine <= 8.0 * major || cosine < 1e-4);
        }
    }

    /// P15: a ray that leaves a convex shape outward does not come back; one that goes in comes out.
    #[test]
    fn leaving((spec, ray) in aimed(spec()), way in direction()) {
        let shape = spec.build().unwrap();
        for hit in crossings(&shape, &ray) {
            let surface = shape.surface(&ray, hit);
            let outward = if surface.normal.dot(way) < 0.0 { -way } else { way };
            for side in [Side::Outside, Side::Inside] {
                let way = outward * side.sign();
                let from = surface.departure(0, hit, side);
                let (start, within) = from.ray(way);
                let next = shape.hit_leaving(&start, within, &from);
                let flat = !spec.closed();
                if spec.convex() && (flat || side == Side::Outside) {
                    prop_assert_eq!(next, None);
                }
                if spec.convex() && !flat && side == Side::Inside {
                    prop_assert!(next.is_some(), "no exit from {surface:?}");
                }
                let mut all = Vec::new();
                shape.crossings_leaving(&start, within, &from, &mut |hit| all.push(hit));
                prop_assert_eq!(all.first().copied(), next);
                // The sheets of a spindle torus enclose each other.
                let spindle = matches!(spec, Torus { major, minor, .. } if minor >= major);
                if spec.closed() && !spindle {
                    prop_assert_eq!(all.len() % 2, usize::from(side == Side::Inside), "{:?} {:?}", side, all);
                }
            }
        }
    }
}

/// P20: numbers of any bits, as shapes, rays and intervals, never panic; a ray that is not valid hits nothing.
#[test]
fn no_bits_make_it_panic() {
    let mut random = Random::new(20);
    let mut built = [0; 10];
    for round in 0..40_000 {
        // A few of the numbers, so that some are shapes.
        let any =
            |r: &mut Random| if r.once_in(4) { r.any_f64() } else { r.sign() * r.magnitude(-160.0, 160.0) };
        let mut v = || DVec3::new(any(&mut random), any(&mut random), any(&mut random));
        let ([p, q, s, origin, direction], ends) = ([v(), v(), v(), v(), v()], v());
        let (l, m) = (any(&mut random), any(&mut random));
        let spec = match round % 10 {
            0 => Sphere { center: p, radius: l },
            1 => Plane { point: p, normal: q },
            2 => Disk { center: p, normal: q, radius: l },
            3 => Cuboid { min: p.min(q), max: p.max(q) },
            4 => Cylinder { base: p, top: q, radius: l, closed: true },
            5 => Cylinder { base: p, top: q, radius: l, closed: false },
            6 => Cone { base: p, base_radius: l, top: q, top_radius: m, closed: true },
            7 => Cone { base: p, base_radius: l, top: q, top_radius: m, closed: false },
            8 => Torus { center: p, axis: q, major: l, minor: m },
            _ => Triangle { a: p, b: q, c: s },
        };
        let Ok(shape) = spec.build() else { continue };
        built[round % 10] += 1;
        for ray in [Ray::new(origin, direction), Ray::new(origin, p - origin)] {
            for within in [Interval::LINE, Interval::new(ends.x, ends.y)] {
                let mut hits = Vec::new();
                shape.crossings(&ray, within, &mut |hit| hits.push(hit));
                assert!(hits.is_empty() || ray.is_valid(), "{spec:?} {ray:?}");
                hits.extend(shape.hit(&ray, within));
                for hit in hits {
                    assert!(within.contains(hit.t()), "{spec:?} {ray:?}");
                    let surface = shape.surface(&ray, hit);
                    for side in [Side::Inside, Side::Outside] {
                        shape.hit_leaving(&ray, within, &surface.departure(0, hit, side));
                    }
                }
            }
        }
    }
    assert!(built.iter().all(|&count| count > 100), "{built:?}");
}

/// A seeded run of hard rays for each shape, at several sizes and places.
fn hard_rays(name: &str, spec: Spec) {
    let setting = |name: &str| std::env::var(name).ok().map(|n| n.parse::<u32>().expect(name));
    let count = setting("RT_HARD_RAYS").unwrap_or(1000);
    let first = setting("RT_HARD_SEED").unwrap_or(0);
    let places = [(1.0, 0.0), (1.0, 1e6), (1e-9, 0.0), (1e9, 1e12)];
    for (i, (scale, offset)) in (0..).zip(places) {
        let spec = spec.map(|p| p * scale + DVec3::new(offset, -offset, 0.5 * offset), |d| d, scale);
        let shape = spec.build().unwrap();
        let effort = Effort::new(u64::from(first) * 4 + i, count);
        let effort = if spec.closed() { effort.closed() } else { effort };
        check_primitive(&shape, &effort).unwrap_or_else(|failure| panic!("{spec:?}: {failure}"));
    }
    println!("{name}: seeds from {}, {} rays of each of 5 kinds", u64::from(first) * 4, 4 * u64::from(count));
}

macro_rules! hard_rays {
    ($($name:ident: $spec:expr;)*) => {
        mod hard {
            use super::*;
            $(#[test]
            fn $name() {
                hard_rays(stringify!($name), $spec);
            })*
        }
    };
}

const AXIS: DVec3 = DVec3::new(0.3, 1.0, -0.2);

hard_rays! {
    sphere: Sphere { center: DVec3::new(0.5, 0.25, 0.0), radius: 1.25 };
    plane: Plane { point: DVec3::new(0.5, 0.25, 0.0), normal: AXIS };
    floor: Plane { point: DVec3::ZERO, normal: DVec3::Y };
    disk: Disk { center: DVec3::new(0.5, 0.25, 0.0), normal: AXIS, radius: 1.25 };
    cuboid: Cuboid { min: DVec3::new(-0.5, 0.25, -3.0), max: DVec3::new(1.0, 1.5, 2.0) };
    tile: Cuboid { min: DVec3::new(-0.5, 0.25, -3.0), max: DVec3::new(1.0, 0.25, 2.0) };
    cylinder: Cylinder { base: DVec3::ZERO, top: AXIS, radius: 0.75, closed: true };
    open_cylinder: Cylinder { base: DVec3::ZERO, top: AXIS, radius: 0.75, closed: false };
    cone: Cone { base: DVec3::ZERO, base_radius: 1.0, top: AXIS, top_radius: 0.0, closed: true };
    frustum: Cone { base: DVec3::ZERO, base_radius: 1.0, top: AXIS, top_radius: 0.25, closed: true };
    torus: Torus { center: DVec3::ZERO, axis: AXIS, major: 1.0, minor: 0.25 };
    spindle: Torus { center: DVec3::ZERO, axis: AXIS, major: 1.0, minor: 1.5 };
    triangle: Triangle { a: DVec3::ZERO, b: DVec3::new(2.0, 0.5, 0.0), c: DVec3::new(0.0, 1.0, 1.0) };
}

/// Needles: at the tip the walls are nearer to each other than a place is known.
#[test]
fn needles() {
    for seed in 0..40 {
        let base = DVec3::new(73.5390625, 0.0, 0.0);
        let needle = rt_core::shape::Cone::new(base, 9.536743164085997e-7, DVec3::ZERO, 0.0).unwrap();
        check_primitive(&needle, &Effort::new(seed, 500).closed())
            .unwrap_or_else(|failure| panic!("{seed}: {failure}"));
    }
}

/// A turned box keeps the contract of any closed convex shape.
#[test]
fn turned_cuboids() {
    for degrees in [90.0, 33.0, 1e-9] {
        let turn = Similarity::IDENTITY.rotated([1.0, 2.0, -0.5], degrees).unwrap();
        let turn = turn.translated([1e4, -3.0, 0.5]).unwrap();
        let cuboid = rt_core::shape::Cuboid::new([-1.0, -2.0, -0.5], [1.0, 2.0, 0.5]).unwrap();
        let shape: Shape = cuboid.transformed(&turn).unwrap().into();
        check_primitive(&shape, &Effort::new(7, 1000).closed()).unwrap_or_else(|failure| panic!("{failure}"));
        // From next to the least numbers to the greatest, the length of the direction changes the parameter alone, if not to
        // the last bit.
        let ray = Ray::new([1e4 + 5.0, -2.5, 0.25], [-1.0, 0.0625, 0.125]);
        let hits = crossings(&shape, &ray);
        assert_eq!(hits.len(), 2);
        for power in [-1018, -1000, -950, -900, -500, 500, 950, 1000, 1010] {
            let unit = libm::scalbn(1.0, power);
            let faster = Ray::new(ray.origin, ray.direction * unit);
            let (a, b) = (crossings(&shape, &faster), shape.hit(&faster, Interval::FORWARD));
            assert_eq!((a.len(), b.map(|b| b.t())), (2, a.first().map(|a| a.t())), "{power}");
            for (a, hit) in a.iter().zip(&hits) {
                assert_eq!(a.part(), hit.part(), "{power}");
                assert!((a.t() * unit / hit.t() - 1.0).abs() < 1e-15, "{power}");
            }
        }
    }
}

/// The box of a turned cuboid holds its corners, to the last bit, and a point rounded beside each.
#[test]
fn boxes_of_turned_cuboids() {
    let mut random = Random::new(3);
    // The sum of two numbers and of a product, each with its error.
    let add = |(sum, rest): (f64, f64), x: f64| {
        let s = sum + x;
        let b = s - sum;
        (s, rest + ((sum - (s - b)) + (x - b)))
    };
    for _ in 0..400 {
        let size = DVec3::new(random.uniform(0.1, 2.0), random.uniform(0.1, 2.0), random.uniform(0.1, 2.0));
        let turn = Similarity::IDENTITY.rotated(random.direction(), random.uniform(-180.0, 180.0)).unwrap();
        let turn = turn.translated(random.in_cube() * random.magnitude(-1.0, 3.0)).unwrap();
        let cuboid = rt_core::shape::Cuboid::new(-size, size).unwrap().transformed(&turn).unwrap();
        let (bounds, axes, corner) = (cuboid.bounds().unwrap(), cuboid.axes(), cuboid.corner());
        for k in 0..3 {
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..8 {
                let mut at = (corner[k], 0.0);
                for (j, axis) in axes.iter().enumerate().filter(|(j, _)| i >> j & 1 == 1) {
                    let product = axis[k] * cuboid.size()[j];
                    at = add(at, product);
                    at.1 += libm::fma(axis[k], cuboid.size()[j], -product);
                }
                // Negative where the corner lies inside.
                assert!(
                    (bounds.min[k] - at.0) - at.1 <= 0.0 && (at.0 - bounds.max[k]) + at.1 <= 0.0,
                    "{cuboid:?}"
                );
                (least, most) = (least.min(at.0 + at.1), most.max(at.0 + at.1));
            }
            assert!(bounds.min[k] < least && bounds.max[k] > most, "{cuboid:?} {k}");
            let slack = 1e-15 * (corner[k].abs() + 8.0);
            assert!(
                bounds.min[k] > least - 4.0 * slack && bounds.max[k] < most + 4.0 * slack,
                "{cuboid:?} {k}"
            );
        }
    }
}

/// A sphere that breaks one promise, now and then.
#[derive(Debug)]
struct Broken {
    sphere: Shape,
    fault: Fault,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    Panic,
    InvalidRay,
    InvalidRayCrossed,
    OutsideInterval,
    SplitInterval,
    HitAgain,
    TooEarly,
    TooLate,
    Odd,
    Unsorted,
    Missed,
    Moody,
    Length,
    NotFinite,
    Normal,
    ShadingNormal,
    OffTheRay,
    Bounds,
    WayBack,
}

impl Broken {
    /// Hits at negative `x`, so that half of the rays see the fault.
    fn struck(&self, ray: &Ray, hit: Hit) -> bool {
        self.sphere.surface(ray, hit).point.x < 0.0
    }
}

impl Primitive for Broken {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        if self.fault == Fault::InvalidRay && !ray.is_valid() {
            return Interval::LINE.admit(1.0, 0, 0);
        }
        let Some(hit) = self.sphere.hit(ray, within) else {
            // A little of what is outside.
            let wider = within.until(within.max * 1.01);
            return match self.fault {
                // A little of what is behind the end.
                Fault::TooEarly if within.max > 0.0 => {
                    self.sphere.hit(ray, within.until(within.max * (1.0 + 1e-9)))
                }
                Fault::OutsideInterval => self.sphere.hit(ray, wider),
                _ => None,
            };
        };
        match self.fault {
            Fault::Panic if !ray.origin.x.is_normal() => panic!("on purpose"),
            Fault::SplitInterval if within.min > 0.0 => None,
            Fault::HitAgain => within.admit(hit.t().next_down(), 0, 0),
            // Once more from an interval that begins a little behind it, though not from one that begins at it.
            Fault::TooLate if within.min > 0.0 => {
                let before = self.sphere.hit(ray, Interval::FORWARD);
                let again = |t: f64| t < within.min && t > within.min * (1.0 - 1e-12);
                before.filter(|before| again(before.t())).or(Some(hit))
            }
            Fault::Missed if self.struck(ray, hit) => None,
            Fault::Moody if within.max == f64::INFINITY => {
                static CALLS: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
                let call = CALLS.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                Interval::LINE.admit(hit.t(), 0, call % 2)
            }
            Fault::Length if ray.direction.length_squared() > 2.0 => {
                Interval::LINE.admit(hit.t().next_up(), 0, hit.root())
            }
            _ => Some(hit),
        }
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        let mut hits = Vec::new();
        self.sphere.crossings(ray, within, &mut |hit| hits.push(hit));
        if self.fault == Fault::InvalidRayCrossed && !ray.is_valid() {
            hits.extend(Interval::LINE.admit(1.0, 0, 0));
        }
        if self.fault == Fault::Odd && hits.len() == 2 {
            hits.pop();
        }
        if self.fault == Fault::Unsorted {
            hits.reverse();
        }
        hits.into_iter().for_each(each);
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let mut surface = self.sphere.surface(ray, hit);
        if !self.struck(ray, hit) {
            return surface;
        }
        match self.fault {
            Fault::NotFinite => surface.local.y = f64::INFINITY,
            Fault::Normal => surface.normal *= 1.0 + 1e-14,
            Fault::ShadingNormal => surface.shading_normal *= 1.0 - 1e-14,
            Fault::OffTheRay => surface.error *= 1e-3,
            _ => {}
        }
        if self.fault == Fault::OffTheRay {
            surface.point += ray.direction.any_orthonormal_vector() * 1e-9;
        }
        surface
    }

    fn bounds(&self) -> Option<rt_core::Aabb> {
        let mut bounds = self.sphere.bounds()?;
        if self.fault == Fault::Bounds {
            bounds.min.x += 0.01;
        }
        Some(bounds)
    }

    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &rt_core::Departure) -> Option<Hit> {
        if self.fault == Fault::WayBack {
            let point = from.ray(ray.direction).0.origin;
            return Interval::LINE.admit(if point.x < 0.0 { 1e-3 } else { return None }, 1, 0);
        }
        self.sphere.hit_leaving(ray, within, from)
    }
}

/// `check_primitive` finds each fault, and finds none where there is none.
#[test]
fn broken_shapes_are_found() {
    use Fault::*;
    let expected = [
        (Panic, "no panic"),
        (InvalidRay, "no panic"),
        (InvalidRayCrossed, "no panic"),
        (OutsideInterval, "an interval that"),
        (SplitInterval, "a split interval"),
        (HitAgain, "an interval that"),
        (TooEarly, "an interval that ends before the first hit"),
        (TooLate, "an interval that starts after a hit"),
        (Odd, "a closed shape"),
        (Unsorted, "crossings ascend"),
        (Missed, "the first hit is the first crossing"),
        (Moody, "the same question"),
        (Length, "twice the direction"),
        (NotFinite, "a surface record is finite"),
        (Normal, "a normal has unit length"),
        (ShadingNormal, "a normal has unit length"),
        (OffTheRay, "the point is on the ray"),
        (Bounds, "the bounds contain"),
        (WayBack, "nothing lies on the way back"),
    ];
    let check = |fault: Fault, closed: bool| {
        let sphere = rt_core::shape::Sphere::new([0.5, -0.25, 0.0], 1.25).unwrap().into();
        let effort = Effort::new(5, 300);
        check_primitive(&Broken { sphere, fault }, &if closed { effort.closed() } else { effort })
    };
    assert_eq!(check(None, true), Ok(()));
    assert_eq!(check(Odd, false).map_err(|f| f.promise), Ok(()), "odd, but not said to be closed");
    for (fault, promise) in expected {
        let failure = check(fault, true).expect_err(&format!("{fault:?}"));
        assert!(failure.promise.starts_with(promise), "{fault:?}: {failure}");
        assert!(failure.to_string().starts_with("broken: "));
    }
}
