//! Properties of sphere, cylinder and cone.
// Made-up input and tolerances only: none of these numbers must be the same on every machine.
#![allow(clippy::disallowed_methods)]

use proptest::prelude::*;
use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cylinder, Sphere};
use rt_core::{Hit, Interval, Primitive, Ray, Shape, Side, Surface};

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    [-size..size, -size..size, -size..size].prop_map(DVec3::from)
}

/// A direction whose length is not special.
fn direction() -> impl Strategy<Value = DVec3> {
    vector(2.0).prop_filter("has a length", |d| d.length() > 1e-3)
}

/// One of the three, closed or open, about the origin and of size about 1; often thin, flat, or with an apex.
fn shape() -> impl Strategy<Value = Shape> {
    let length = prop_oneof![4 => 0.1..2.0, 1 => 1e-6..1e-3];
    let radius = prop_oneof![4 => 0.1..1.5, 1 => 1e-6..1e-3];
    let top = prop_oneof![2 => 0.0..1.5, 1 => Just(0.0)];
    (vector(1.0), direction(), length, radius, top, 0..5_i32).prop_map(
        |(at, axis, length, radius, top, kind)| {
            let end = at + axis.normalize() * length;
            match kind {
                0 => Sphere::new(at, radius).unwrap().into(),
                1 => Cylinder::new(at, end, radius).unwrap().into(),
                2 => Cylinder::open(at, end, radius).unwrap().into(),
                3 => Cone::new(at, radius, end, top).unwrap().into(),
                _ => Cone::open(at, radius, end, top).unwrap().into(),
            }
        },
    )
}

/// Aimed at or near the shapes above, from near and far.
fn ray() -> impl Strategy<Value = Ray> {
    let far = prop_oneof![3 => 0.0..4.0, 1 => 1e3..1e6];
    (vector(1.5), direction(), far).prop_map(|(target, d, far)| Ray::new(target - d.normalize() * far, d))
}

fn crossings(shape: &impl Primitive, ray: &Ray, within: Interval) -> Vec<Hit> {
    let mut all = Vec::new();
    shape.crossings(ray, within, &mut |hit| all.push(hit));
    all
}

/// The bits of what a picture depends on.
fn bits(s: &Surface) -> ([u64; 7], [u64; 2]) {
    let v = [s.t, s.local.x, s.local.y, s.local.z, s.normal.x, s.normal.y, s.normal.z];
    (v.map(f64::to_bits), [s.uv().x.to_bits(), s.uv().y.to_bits()])
}

fn is_closed(shape: &Shape) -> bool {
    match shape {
        Shape::Cylinder(c) => c.is_closed(),
        Shape::Cone(c) => c.is_closed(),
        _ => true,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn crossings_are_consistent(shape in shape(), ray in ray()) {
        let all = crossings(&shape, &ray, Interval::LINE);
        prop_assert!(all.len() <= 2 && (!is_closed(&shape) || all.len() != 1), "{:?}", all);
        prop_assert!(all.windows(2).all(|w| w[0].t() <= w[1].t()));
        prop_assert_eq!(shape.hit(&ray, Interval::LINE), all.first().copied());
        let forward = crossings(&shape, &ray, Interval::FORWARD);
        prop_assert_eq!(shape.hit(&ray, Interval::FORWARD), forward.first().copied());
        if let [first, second] = all[..] && first.t() < second.t() {
            prop_assert_eq!(shape.hit(&ray, Interval::LINE.after(first.t())), Some(second));
            prop_assert_eq!(shape.hit(&ray, Interval::LINE.until(first.t())), None);
        }
        let bounds = shape.bounds().unwrap();
        for hit in all {
            let s = shape.surface(&ray, hit);
            prop_assert!(bounds.contains(s.point), "{:?} {:?}", bounds, s.point);
            prop_assert!((s.normal.length() - 1.0).abs() < 1e-15);
            prop_assert!((0.0..1.0).contains(&s.uv().x) && (0.0..=1.0).contains(&s.uv().y));
            prop_assert!((s.t - hit.t()).abs() <= 1e-9 * (s.t.abs() + 1.0));
            prop_assert!(s.error > 0.0 && s.error < 1e-14, "{}", s.error);
        }
    }

    #[test]
    fn points_lie_on_the_surface(shape in shape(), ray in ray()) {
        for hit in crossings(&shape, &ray, Interval::LINE) {
            let s = shape.surface(&ray, hit);
            let (base, top, radii) = match &shape {
                Shape::Sphere(sphere) => {
                    prop_assert!((s.local.length() / sphere.radius() - 1.0).abs() < 4e-16);
                    prop_assert!((s.normal - s.local / sphere.radius()).length() < 4e-16);
                    continue;
                }
                Shape::Cylinder(c) => (c.base(), c.top(), [c.radius(); 2]),
                Shape::Cone(c) => (c.base(), c.top(), [c.base_radius(), c.top_radius()]),
                _ => unreachable!(),
            };
            let height = (top - base).length();
            let axis = (top - base) / height;
            let z = s.local.dot(axis);
            let size = height + radii[0] + radii[1];
            match hit.part() {
                0 => {
                    let slope = (radii[1] - radii[0]) / height;
                    let cosine = 1.0 / (1.0 + slope * slope).sqrt();
                    let away = (s.local - axis * z).length() - (radii[0] + slope * z);
                    prop_assert!((away * cosine).abs() < 1e-15 * size, "{}", away);
                    // Turning outward the side's inclination stays.
                    prop_assert!((s.normal.dot(axis) + slope * cosine).abs() < 1e-14);
                    prop_assert!(z > -1e-15 * size && z < height + 1e-15 * size);
                }
                part => {
                    let (level, outward) = if part == 1 { (0.0, -axis) } else { (height, axis) };
                    prop_assert!((z - level).abs() < 1e-15 * size);
                    prop_assert!((s.normal - outward).length() < 1e-15);
                }
            }
            let own = s.object_point;
            if !matches!(shape, Shape::Sphere(_)) {
                prop_assert!((own.z - z).abs() < 1e-15 * size);
                let angle = own.y.atan2(own.x) / std::f64::consts::TAU;
                prop_assert!((angle - s.uv().x - (angle - s.uv().x).round()).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn powers_of_two_change_no_bit(shape in shape(), ray in ray(), size in -450..450, speed in -450..450) {
        let (size, speed) = (2.0_f64.powi(size), 2.0_f64.powi(speed));
        let scaled: Shape = match &shape {
            Shape::Sphere(s) => Sphere::new(s.center() * size, s.radius() * size).unwrap().into(),
            Shape::Cylinder(c) if c.is_closed() => {
                Cylinder::new(c.base() * size, c.top() * size, c.radius() * size).unwrap().into()
            }
            Shape::Cylinder(c) => Cylinder::open(c.base() * size, c.top() * size, c.radius() * size).unwrap().into(),
            Shape::Cone(c) => {
                let (base, top) = (c.base() * size, c.top() * size);
                let (r, q) = (c.base_radius() * size, c.top_radius() * size);
                if c.is_closed() { Cone::new(base, r, top, q) } else { Cone::open(base, r, top, q) }.unwrap().into()
            }
            _ => unreachable!(),
        };
        let scaled_ray = Ray::new(ray.origin * size, ray.direction * speed);
        let (a, b) = (crossings(&shape, &ray, Interval::LINE), crossings(&scaled, &scaled_ray, Interval::LINE));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.into_iter().zip(b) {
            prop_assert_eq!((a.part(), a.root()), (b.part(), b.root()));
            prop_assert_eq!(a.t() * size / speed, b.t());
            let (s, q) = (shape.surface(&ray, a), scaled.surface(&scaled_ray, b));
            prop_assert_eq!(s.t * size / speed, q.t);
            prop_assert_eq!(s.local * size, q.local);
            prop_assert_eq!(s.point * size, q.point);
            prop_assert_eq!((s.normal, s.uv()), (q.normal, q.uv()));
        }
    }

    #[test]
    fn a_reversed_ray_crosses_at_the_same_places(shape in shape(), ray in ray()) {
        let back = Ray::new(ray.origin, -ray.direction);
        let there = crossings(&shape, &ray, Interval::LINE);
        let mut again = crossings(&shape, &back, Interval::LINE);
        again.reverse();
        prop_assert_eq!(there.len(), again.len());
        for (a, b) in there.into_iter().zip(again) {
            let (s, q) = (shape.surface(&ray, a), shape.surface(&back, b));
            prop_assert!((s.t + q.t).abs() <= f64::EPSILON * s.t.abs().max(1e-12), "{} {}", s.t, q.t);
            prop_assert!((s.local - q.local).length() < 1e-15);
        }
    }

    #[test]
    fn base_and_top_can_be_swapped(at in vector(1.0), axis in direction(), r in 0.1..1.0, q in 0.0..1.0, ray in ray()) {
        let one = Cone::new(at, r, at + axis, q).unwrap();
        let other = Cone::new(at + axis, q, at, r).unwrap();
        let (a, b) = (crossings(&one, &ray, Interval::LINE), crossings(&other, &ray, Interval::LINE));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.into_iter().zip(b) {
            prop_assert_eq!([0, 2, 1][a.part() as usize], b.part());
            let (s, q) = (one.surface(&ray, a), other.surface(&ray, b));
            prop_assert!((s.t - q.t).abs() <= f64::EPSILON * s.t.abs().max(1e-12));
            prop_assert!((s.normal - q.normal).length() < 1e-15);
        }
    }

    #[test]
    fn a_cone_of_equal_radii_is_a_cylinder(at in vector(1.0), axis in direction(), r in 0.1..1.0, ray in ray()) {
        let cone = Cone::new(at, r, at + axis, r).unwrap();
        let cylinder = Cylinder::new(at, at + axis, r).unwrap();
        let (a, b) = (crossings(&cone, &ray, Interval::LINE), crossings(&cylinder, &ray, Interval::LINE));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.into_iter().zip(b) {
            prop_assert_eq!((a.part(), a.root()), (b.part(), b.root()));
            prop_assert_eq!(bits(&cone.surface(&ray, a)), bits(&cylinder.surface(&ray, b)));
        }
    }

    /// Every spawned ray: outside nothing, inside exactly the exit, on a place of the surface; grazing ones too.
    #[test]
    fn leaving(shape in shape(), ray in ray(), way in direction(), graze in prop_oneof![Just(1.0), 1e-18..1e-6]) {
        for hit in crossings(&shape, &ray, Interval::LINE) {
            let s = shape.surface(&ray, hit);
            // Along the surface but for `graze`, inward.
            let across = way.dot(s.normal);
            let inward = way - s.normal * (across + graze);
            let outside = s.departure(0, hit, Side::Outside);
            for (ray, within) in [outside.ray(-inward), outside.through(-inward)] {
                prop_assert_eq!(shape.hit_leaving(&ray, within, &outside), None);
            }
            let inside = s.departure(0, hit, Side::Inside);
            for (ray, within) in [inside.ray(inward), inside.through(inward)] {
                let exit = shape.hit_leaving(&ray, within, &inside);
                prop_assert!(exit.is_some() || !is_closed(&shape));
                let mut all = Vec::new();
                shape.crossings_leaving(&ray, within, &inside, &mut |hit| all.push(hit));
                prop_assert_eq!(all.len(), exit.iter().count());
                let Some(exit) = exit else { continue };
                prop_assert!(within.contains(exit.t()));
                let end = shape.surface(&ray, exit);
                prop_assert!(end.t.is_finite() && end.local.is_finite() && end.normal.is_finite());
                prop_assert!((end.normal.length() - 1.0).abs() < 1e-15);
                prop_assert!(shape.bounds().unwrap().contains(end.point - (end.point - s.point) * 1e-9));
                if graze == 1.0 && inward.dot(s.normal) < -0.1 * inward.length() && exit.t() > 1e-3 {
                    prop_assert!(end.normal.dot(ray.direction) > -1e-9, "{:?} {:?}", s, end);
                    // Halfway the ray is inside: it meets nothing in between.
                    let half = Interval::new(exit.t() * 0.01, exit.t() * 0.99);
                    prop_assert_eq!(shape.hit(&ray, half), None);
                }
            }
        }
    }

    #[test]
    fn no_bits_make_it_panic(numbers in prop::array::uniform14(any::<u64>()), kind in 0..5_i32) {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = numbers.map(f64::from_bits);
        let (p, q) = (DVec3::new(a, b, c), DVec3::new(d, e, f));
        let shape: Result<Shape, _> = match kind {
            0 => Sphere::new(p, g).map(Into::into),
            1 => Cylinder::new(p, q, g).map(Into::into),
            2 => Cylinder::open(p, q, g).map(Into::into),
            3 => Cone::new(p, g, q, h).map(Into::into),
            _ => Cone::open(p, g, q, h).map(Into::into),
        };
        let fixed = [
            shape.ok(),
            Some(Sphere::new(DVec3::ONE, 1.0).unwrap().into()),
            Some(Cone::new(DVec3::ZERO, 1.0, DVec3::ONE, 0.0).unwrap().into()),
            Some(Cylinder::open(DVec3::ZERO, DVec3::ONE, 0.5).unwrap().into()),
        ];
        let ray = Ray::new([i, j, k], [l, m, n]);
        for shape in fixed.into_iter().flatten() {
            for within in [Interval::LINE, Interval::FORWARD, Interval::new(g, h)] {
                if let Some(hit) = shape.hit(&ray, within) {
                    prop_assert!(ray.is_valid() && within.contains(hit.t()));
                    shape.surface(&ray, hit);
                }
                shape.crossings(&ray, within, &mut |_| {});
            }
            for root in 0..4 {
                let hit = Interval::LINE.admit(1.0, root, root).unwrap();
                let s = shape.surface(&ray, hit);
                for side in [Side::Inside, Side::Outside] {
                    shape.hit_leaving(&ray, Interval::new(g, h), &s.departure(0, hit, side));
                }
            }
        }
    }

    /// Plates thinner than `f64` can tell from where the ray starts: their caps are told apart all the same, and an
    /// interval that ends at the nearer one does not hold the other.
    #[test]
    fn plates_met_from_afar(axis in direction(), thickness in -11.5..-5.0_f64, radii in [0.5..2.0_f64, 0.5..2.0],
                            away in direction(), far in 0.0..7.0_f64, aside in vector(0.1)) {
        let axis = axis.normalize() * 10_f64.powf(thickness);
        let away = away.normalize() * 10_f64.powf(far);
        let ray = Ray::new(away + aside, -away);
        let shapes: [Shape; 2] = [
            Cylinder::new(DVec3::ZERO, axis, radii[0]).unwrap().into(),
            Cone::new(DVec3::ZERO, radii[0], axis, radii[1]).unwrap().into(),
        ];
        for shape in &shapes {
            let hits = crossings(shape, &ray, Interval::FORWARD);
            prop_assert!(hits.is_sorted_by(|a, b| a.t() <= b.t()), "{hits:?}");
            let first = shape.hit(&ray, Interval::FORWARD);
            prop_assert_eq!(first, hits.first().copied());
            if let Some(hit) = first {
                prop_assert_eq!(shape.hit(&ray, Interval::FORWARD.until(hit.t())), None, "{:?}", hits);
            }
        }
    }
}

#[test]
fn rays_along_the_axis() {
    let cylinder = Cylinder::new([0.0; 3], [1.0, 2.0, 2.0], 0.5).unwrap();
    let cone = Cone::new([0.0; 3], 0.5, [1.0, 2.0, 2.0], 0.0).unwrap();
    let ray = Ray::new([-1.0, -2.0, -2.0], [1.0, 2.0, 2.0]);
    for shape in [Shape::from(cylinder), Shape::from(cone)] {
        let all = crossings(&shape, &ray, Interval::LINE);
        assert_eq!(all.iter().map(|h| h.t()).collect::<Vec<_>>(), [1.0, 2.0], "{shape:?}");
    }
    assert!(
        crossings(&Cylinder::open([0.0; 3], [1.0, 2.0, 2.0], 0.5).unwrap(), &ray, Interval::LINE).is_empty()
    );
    // Beside the axis: through both caps, and past the cylinder.
    let beside = |x: f64| Ray::new([-1.0 + 2.0 * x, -2.0 - x, -2.0], [1.0, 2.0, 2.0]);
    assert_eq!(crossings(&cylinder, &beside(0.22), Interval::LINE).len(), 2);
    assert!(crossings(&cylinder, &beside(0.23), Interval::LINE).is_empty());
}

#[test]
fn tangents_are_no_hits_and_their_neighbours_are_told_apart() {
    let sphere = Sphere::new([0.0; 3], 1.0).unwrap();
    let cylinder = Cylinder::new([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], 1.0).unwrap();
    for shape in [Shape::from(sphere), Shape::from(cylinder)] {
        for distance in [4.0, 4e8] {
            let ray = |x: f64| Ray::new([x, -distance, 0.0], [0.0, 3.0, 0.0]);
            assert!(shape.hit(&ray(1.0), Interval::LINE).is_none());
            assert!(shape.hit(&ray(1.0_f64.next_up()), Interval::LINE).is_none());
            let all = crossings(&shape, &ray(1.0_f64.next_down()), Interval::LINE);
            assert_eq!(all.len(), 2, "{shape:?} {distance}");
            let [near, far] = [0, 1].map(|i| shape.surface(&ray(1.0_f64.next_down()), all[i]));
            // Half the chord is the root of 2^-52 and a little less.
            assert!((far.local.y - near.local.y - 2.0_f64.powi(-25)).abs() < 1e-15);
        }
    }
}

#[test]
fn same_bits_without_fused_products() {
    use rt_core::kernel::{Level, set_level};
    let cone = Cone::new([0.1, -0.2, 0.3], 1.3, [1.1, 0.9, 3.2], 0.4).unwrap();
    let rays: Vec<Ray> = (0..500)
        .map(|i| {
            let x = f64::from(i) * 0.37;
            let origin = DVec3::new(5.0 * libm::sin(x), 5.0 * libm::cos(x), x % 3.0);
            Ray::new(origin, DVec3::new(0.5, 0.3, 1.8) - origin + DVec3::splat(0.8 * libm::sin(x * 7.0)))
        })
        .collect();
    let answers = || -> Vec<_> {
        rays.iter()
            .flat_map(|r| crossings(&cone, r, Interval::LINE).into_iter().map(|h| bits(&cone.surface(r, h))))
            .collect()
    };
    set_level(Level::Portable);
    let portable = answers();
    set_level(Level::Avx2);
    assert!(portable.len() > 300);
    assert_eq!(portable, answers());
}

/// The top of a sphere whose centre and radius cancel is at height zero to an ulp of the radius, not to one of zero.
#[test]
fn bounds_where_centre_and_radius_cancel() {
    let sphere = Sphere::new([-1.375, -1.0, -75453.89482251913], 1.0).unwrap();
    let top = DVec3::new(-1.375, 0.0, -75453.89482251913);
    let bounds = sphere.bounds().unwrap();
    assert!(bounds.max.y >= f64::EPSILON, "{bounds:?}");
    let ray = Ray::new(top + DVec3::new(0.0, 5.0, 0.0), [1e-16, -1.0, 1e-16]);
    let surface = sphere.surface(&ray, sphere.hit(&ray, Interval::FORWARD).unwrap());
    assert!(bounds.contains(surface.point), "{surface:?}");
}

/// However thin a cone or cylinder is along an axis, its box holds what is promised to an ulp of its size.
#[test]
fn bounds_of_a_needle() {
    let needle = Cylinder::new([0.0, 0.0, 0.0], [1e40, 0.0, 0.0], 1.0).unwrap();
    let bounds = needle.bounds().unwrap();
    assert!(bounds.max.y >= 1e40 * f64::EPSILON && bounds.min.z <= -1e40 * f64::EPSILON, "{bounds:?}");
}

/// A ray that starts exactly at the apex: there is no direction away from the axis, and what double-double leaves of one
/// is noise.
#[test]
fn a_start_at_the_apex() {
    let apex = DVec3::splat(115.44921875);
    let base = DVec3::new(-0.1, 28.75 + 1e-13, 115.44921875);
    for (i, k) in (0..200).zip(1..) {
        let base = base * f64::from(k) * 0.01;
        let cone = Cone::open(base, 115.44921875, apex, 0.0).unwrap();
        let x = f64::from(i);
        let ray = Ray::new(apex, [libm::sin(x), libm::cos(x) * 1e-3, libm::sin(2.0 * x) - 0.2]);
        for hit in crossings(&cone, &ray, Interval::LINE) {
            let surface = cone.surface(&ray, hit);
            assert!((surface.normal.length() - 1.0).abs() < 1e-15, "{surface:?}");
        }
    }
}

/// A crossing 2^-71 of the size from the axis: what double-double leaves along the axis of the direction away from it
/// is no longer nothing.
#[test]
fn a_normal_next_to_the_apex() {
    let base = DVec3::new(-117.3046875, -0.25 - f64::EPSILON, 9.536743164895167e-7);
    let cone = Cone::new(base, 0.16796875, DVec3::ZERO, 0.0).unwrap();
    let ray = Ray::new(DVec3::ZERO, [0.0, 9.536761353956535e-7, 0.0038773757987676793]);
    let hits = crossings(&cone, &ray, Interval::LINE);
    assert!(!hits.is_empty());
    for hit in hits {
        let surface = cone.surface(&ray, hit);
        assert!((surface.normal.length() - 1.0).abs() < 1e-15, "{surface:?}");
    }
}

/// A direction whose square is far from that of the sphere: half the chord in parameters, squared, would underflow.
#[test]
fn a_small_sphere_and_a_long_direction() {
    let center = [-1.0287412279618176e-36, 4.173004945419121e-37, 1.608039537726426e-36];
    let sphere = Sphere::new(center, 1.7720577338645984e-36).unwrap();
    let origin = [2.468540715115978e-37, -1.7439560720402531e-37, 1.4802045270745023e-36];
    let ray = Ray::new(origin, [1.2657124462983445e128, -6.758383742847422e129, 2.285150965188732e130]);
    let mut all = Vec::new();
    sphere.crossings(&ray, Interval::LINE, &mut |hit| all.push(hit));
    assert_eq!((all.len(), sphere.hit(&ray, Interval::LINE)), (2, all.first().copied()));
}

/// The apex itself, met from 1e8 away: it is known to 2^-104 of that distance, and a direction away from the axis to less.
#[test]
fn a_normal_at_the_apex_from_afar() {
    let (base, top) = (
        DVec3::new(0.0, 0.0, -0.6672687530517578),
        DVec3::new(-0.6484127044677734, -0.4108142852783203, -1.3779716491699219),
    );
    let ray = Ray::new(
        [-35855369.106630094, 4982469.417781291, -94854850.51443622],
        [35855368.45821739, -4982469.828595576, 94854849.13646457],
    );
    for cone in [
        Cone::open(base, 0.21379756927490234, top, 0.0).unwrap(),
        Cone::new(base, 0.21379756927490234, top, 0.0).unwrap(),
    ] {
        for hit in crossings(&cone, &ray, Interval::LINE) {
            let surface = cone.surface(&ray, hit);
            assert!((surface.normal.length_squared() - 1.0).abs() < 2e-15, "{surface:?}");
        }
    }
}

/// Next to the axis a line meets the side at a small angle: the parameter still errs by no more than a few roundings of the
/// distances over the cosine of that angle. The first is the hardest of 2 10^7 rays.
#[test]
fn lines_close_to_the_axis_of_a_cylinder() {
    let off = |cylinder: &Cylinder, ray: &Ray| {
        let hit = cylinder.hit(ray, Interval::FORWARD).filter(|hit| hit.part() == 0)?;
        let surface = cylinder.surface(ray, hit);
        let size = (cylinder.top() - cylinder.base()).length() + cylinder.radius();
        let reach = (ray.origin - cylinder.base()).length() + (ray.direction * surface.t).length() + size;
        Some((hit.t() - surface.t).abs() * ray.direction.dot(surface.normal).abs() / (reach * f64::EPSILON))
    };
    let top = [3e-10, 1e-9, -2.0000000000000003e-10];
    let cylinder = Cylinder::new([0.0; 3], top, 7.500000000000001e-10).unwrap();
    let origin = [-3.5687425122266336e-10, 5.998793198331908e-11, -6.618092733993177e-10];
    let direction = [0.28237485470300644, 0.940672724189146, -0.188146946044951];
    let worst = off(&cylinder, &Ray::new(origin, direction)).unwrap();
    assert!(worst < 8.0, "{worst}");
    let mut state = 1_u64;
    let mut number = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    };
    let mut count = 0;
    for case in 0..20_000 {
        let mut vector = || DVec3::new(number(), number(), number());
        let (base, axis, out) = (vector(), vector().normalize(), vector());
        let out = (out - axis * axis.dot(out)).normalize();
        let slope = 2.0_f64.powi(-(case % 20));
        let cylinder = Cylinder::open(base, base + axis * 3.0, 0.75).unwrap();
        let place = base + axis * (1.5 + number()) + out * 0.75;
        // Through a point of the side, at a small angle, from a little before it.
        let direction = axis + (out * number() + axis.cross(out) * number()) * slope;
        let ray = Ray::new(place - direction * number().abs(), direction);
        let Some(off) = off(&cylinder, &ray) else { continue };
        count += 1;
        assert!(off < 8.0, "{cylinder:?} {ray:?}: {off}");
    }
    assert!(count > 5000, "{count}");
}
