//! A geometry finds what a loop over its shapes finds, bit for bit: nearest, occluded and crossings, in random
//! scenes of all shapes, with ties, far from the origin, at any scale, with every instruction set.
// Made-up input and tolerances only: none of these numbers must be the same on every machine.
#![allow(clippy::disallowed_methods, clippy::type_complexity)]

use proptest::prelude::*;
use rt_core::glam::DVec3;
use rt_core::kernel::{Level, set_level};
use rt_core::shape::*;
use rt_core::{Found, Geometry, Interval, Primitive, Ray, Screen, Shape, Side, Similarity};
use std::ops::ControlFlow;

/// Coordinates from a coarse grid, so that faces coincide and rays meet edges, and from anywhere.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-4_i32..=4).prop_map(|i| f64::from(i) * 0.25), -1.0..1.0]
}

fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn size() -> impl Strategy<Value = f64> {
    prop_oneof![(1_i32..=4).prop_map(|i| f64::from(i) * 0.125), 0.001..0.5, 1.0..4.0]
}

/// A point in the unit cube: three low-discrepancy numbers (multiples of the inverse of the plastic number and of its powers).
fn unit(i: u32) -> DVec3 {
    DVec3::new(0.8191725133961645, 0.6710436067037893, 0.5497004779019703) * f64::from(i) % 1.0
}

/// A direction, often along an axis.
fn direction() -> impl Strategy<Value = DVec3> {
    prop_oneof![
        (0_usize..3, any::<bool>()).prop_map(|(k, s)| DVec3::AXES[k] * if s { 1.0 } else { -1.0 }),
        (-1.0..1.0, -1.0..1.0, -1.0..1.0)
            .prop_map(|(x, y, z)| DVec3::new(x, y, z))
            .prop_filter("a direction", |d| d.length_squared() > 1e-3),
    ]
}

/// The recipe of a shape: made only after the scene was scaled and moved, as sums of these numbers round.
#[derive(Clone, Debug)]
struct Recipe {
    kind: u32,
    a: DVec3,
    b: DVec3,
    c: DVec3,
    axis: DVec3,
    r: f64,
    s: f64,
}

fn recipe() -> impl Strategy<Value = Recipe> {
    (0_u32..9, point(), point(), point(), direction(), size(), size())
        .prop_map(|(kind, a, b, c, axis, r, s)| Recipe { kind, a, b, c, axis, r, s })
}

impl Recipe {
    fn shape(&self, scale: f64, offset: DVec3) -> Option<Shape> {
        let at = |p: DVec3| p * scale + offset;
        let (r, s) = (self.r * scale, self.s * scale);
        let (a, b, c) = (at(self.a), at(self.b), at(self.c));
        Some(match self.kind {
            0 => Sphere::new(a, r).ok()?.into(),
            1 => Plane::new(a, self.axis).ok()?.into(),
            2 => {
                let cuboid = Cuboid::new(a.min(b), a.max(b)).ok()?;
                if r > s {
                    return Some(cuboid.into());
                }
                // Turned about its corner.
                let turn = Similarity::IDENTITY.rotated(self.axis, 40.0).ok()?;
                let back = a.min(b) - turn.point(a.min(b));
                cuboid.transformed(&turn.translated(back).ok()?).ok()?.into()
            }
            3 => Cylinder::new(a, b, r).ok()?.into(),
            4 => Cone::new(a, r, b, s).ok()?.into(),
            5 => Torus::new(a, self.axis, r.max(s), r.min(s)).ok()?.into(),
            6 => Disk::new(a, self.axis, r).ok()?.into(),
            7 => Triangle::new(a, b, c).ok()?.into(),
            _ => {
                let custom: std::sync::Arc<dyn Primitive> = std::sync::Arc::new(Sphere::new(b, s).ok()?);
                custom.into()
            }
        })
    }
}

#[derive(Clone, Debug)]
struct Scene {
    recipes: Vec<Recipe>,
    /// Indices of recipes that are added again: ties.
    again: Vec<prop::sample::Index>,
    scale: f64,
    offset: DVec3,
}

fn scene(most: usize) -> impl Strategy<Value = Scene> {
    (
        prop::collection::vec(recipe(), 1..most),
        prop::collection::vec(any::<prop::sample::Index>(), 0..4),
        prop_oneof![
            Just(1.0),
            (-30_i32..=30).prop_map(|e| 2_f64.powi(e)),
            (-9.0..9.0).prop_map(|e| 10_f64.powf(e))
        ],
        prop_oneof![Just(0.0), Just(1e3), Just(1e6), Just(1e9)],
        direction(),
    )
        .prop_map(|(recipes, again, scale, distance, axis)| Scene {
            recipes,
            again,
            scale,
            offset: axis * distance,
        })
}

impl Scene {
    fn shapes(&self) -> Vec<Shape> {
        let all = self.recipes.iter().chain(self.again.iter().map(|i| i.get(&self.recipes)));
        all.filter_map(|recipe| recipe.shape(self.scale, self.offset)).collect()
    }

    fn geometries(&self) -> (Geometry, Geometry) {
        let mut builder = Geometry::builder();
        for shape in self.shapes() {
            builder.push(shape);
        }
        (builder.clone().build(), builder.accelerated(false).build())
    }
}

/// What a loop over the shapes finds, told without a geometry: the least refined parameter; of equal ones those that
/// leave a solid before those that enter one, then the earlier.
fn first_of(shapes: &[Shape], ray: &Ray, within: Interval) -> Option<Found> {
    let mut best: Option<((f64, bool), Found)> = None;
    for (object, shape) in (0..).zip(shapes) {
        if let Some(hit) = shape.hit(ray, within) {
            let surface = shape.surface(ray, hit);
            let rank = (surface.t, !(ray.direction.dot(surface.normal) > 0.0));
            if best.is_none_or(|(least, _)| rank < least) {
                best = Some((rank, Found { object, hit }));
            }
        }
    }
    best.map(|(_, found)| found)
}

#[derive(Clone, Debug)]
struct Cast {
    from: DVec3,
    to: DVec3,
    stretch: f64,
    min: f64,
    max: f64,
}

fn cast() -> impl Strategy<Value = Cast> {
    let from = prop_oneof![
        point(),
        point().prop_map(|p| p * 10.0),
        (direction(), 0.0..9.0).prop_map(|(d, e)| d * 10_f64.powf(e))
    ];
    let to = prop_oneof![3 => point(), 1 => point().prop_map(|p| p * 3.0)];
    let stretch = prop_oneof![Just(1.0), (-60_i32..60).prop_map(|e| 2_f64.powi(e)), 0.1..10.0];
    let min = prop_oneof![4 => Just(0.0), 1 => Just(f64::NEG_INFINITY), 1 => -2.0..2.0];
    let max = prop_oneof![4 => Just(f64::INFINITY), 1 => 0.0..4.0];
    (from, to, stretch, min, max).prop_map(|(from, to, stretch, min, max)| Cast {
        from,
        to,
        stretch,
        min,
        max,
    })
}

impl Cast {
    fn ray(&self, scene: &Scene) -> (Ray, Interval) {
        let (from, to) = (self.from * scene.scale + scene.offset, self.to * scene.scale + scene.offset);
        let ray = Ray::new(from, (to - from) * self.stretch);
        (ray, Interval::new(self.min / self.stretch, self.max / self.stretch))
    }
}

fn all_crossings(geometry: &Geometry, ray: &Ray, within: Interval) -> Vec<Found> {
    let mut all = Vec::new();
    geometry.crossings(ray, within, None, &mut |found| {
        all.push(found);
        ControlFlow::Continue(())
    });
    // Stable: the order among those of one object is kept.
    all.sort_by_key(|found| found.object);
    all
}

/// Each ray and its neighbours, of which there are enough for packets.
fn compare_batches(geometry: &Geometry, rays: &[(Ray, Interval)]) -> Result<(), TestCaseError> {
    let mut all = Vec::new();
    let mut within = Vec::new();
    for (ray, interval) in rays {
        all.push(*ray);
        within.push(*interval);
    }
    for (ray, interval) in rays.iter().take(4) {
        let side = ray.direction.any_orthogonal_vector() * 0.003;
        for i in 0..37 {
            all.push(Ray::new(ray.origin, ray.direction + side * f64::from(i)));
            within.push(*interval);
        }
    }
    let mut found = vec![None; all.len()];
    let mut occluded = vec![false; all.len()];
    geometry.nearest_many(&all, &within, &mut found);
    geometry.occluded_many(&all, &within, &mut occluded);
    for (i, ray) in all.iter().enumerate() {
        prop_assert_eq!(found[i], geometry.nearest(ray, within[i]), "{:?} {:?}", ray, within[i]);
        prop_assert_eq!(occluded[i], found[i].is_some());
    }
    Ok(())
}

/// Rays that begin at a point, and rays that end there.
fn compare_cubes(fast: &Geometry, plain: &Geometry, rays: &[(Ray, Interval)]) -> Result<(), TestCaseError> {
    let screens: Vec<Screen> = (0..plain.shapes().len())
        .map(|object| [Screen::Opaque, Screen::Sheer, Screen::Sheer, Screen::Absent][object % 4])
        .collect();
    let path = |blocked: &dyn Fn(&mut dyn FnMut(Found)) -> bool| {
        let mut crossed = Vec::new();
        let blocked = blocked(&mut |found| crossed.push(found));
        crossed.sort_by_key(|found| found.object);
        if blocked { None } else { Some(crossed) }
    };
    for (first, _) in rays.iter().take(3) {
        let Some(cube) = fast.cube_about(first.origin) else { continue };
        for (ray, within) in rays {
            let ray = Ray::new(first.origin, ray.direction);
            let found = plain.nearest(&ray, *within);
            prop_assert_eq!(fast.nearest_from(&cube, &ray, *within), found, "{:?} {:?}", ray, within);
            let mut many = [None; 3];
            fast.nearest_from_many(&cube, &[ray, *first, ray], &[*within; 2], &mut many);
            // As many as there are intervals.
            prop_assert_eq!(many, [found, plain.nearest(first, *within), None]);
            let Some(found) = found else { continue };
            let surface = plain.surface(&ray, found);
            for side in [Side::Outside, Side::Inside] {
                let from = surface.departure(found.object, found.hit, side);
                let start = from.ray(DVec3::ZERO).0.origin;
                let (back, within) = (Ray::new(start, first.origin - start), Interval::new(0.0, 1.0));
                for screens in [&screens[..], &[]] {
                    let truth = path(&|each| plain.blocked(&back, within, Some(&from), screens, each));
                    prop_assert_eq!(
                        &path(&|each| fast.blocked(&back, within, Some(&from), screens, each)),
                        &truth
                    );
                    prop_assert_eq!(&path(&|each| fast.blocked_towards(&cube, &from, screens, each)), &truth);
                }
                let occluded = plain.occluded_leaving(&back, within, &from);
                prop_assert_eq!(fast.blocked_towards(&cube, &from, &[], &mut |_| ()), occluded);
            }
        }
    }
    Ok(())
}

fn compare(scene: &Scene, casts: &[Cast]) -> Result<(), TestCaseError> {
    let (fast, plain) = scene.geometries();
    let shapes = scene.shapes();
    prop_assert_eq!((plain.shapes().len(), fast.shapes().len()), (shapes.len(), shapes.len()));
    let rays: Vec<(Ray, Interval)> = casts.iter().map(|cast| cast.ray(scene)).collect();
    for level in [Level::Portable, Level::Avx2] {
        set_level(level);
        compare_batches(&fast, &rays)?;
        compare_cubes(&fast, &plain, &rays)?;
        let (mut leaving, mut leaving_within, mut departures) = (Vec::new(), Vec::new(), Vec::new());
        for (ray, within) in &rays {
            let found = plain.nearest(ray, *within);
            prop_assert_eq!(found, first_of(&shapes, ray, *within));
            prop_assert_eq!(fast.nearest(ray, *within), found, "nearest {:?} {:?}", ray, within);
            prop_assert_eq!(fast.occluded(ray, *within), plain.occluded(ray, *within));
            prop_assert_eq!(fast.occluded(ray, *within), found.is_some());
            prop_assert_eq!(all_crossings(&fast, ray, *within), all_crossings(&plain, ray, *within));
            if let Some(found) = found {
                let surface = plain.surface(ray, found);
                for side in [Side::Outside, Side::Inside] {
                    let from = surface.departure(found.object, found.hit, side);
                    let (onward, within) = from.ray(ray.direction);
                    let next = plain.nearest_leaving(&onward, within, &from);
                    prop_assert_eq!(fast.nearest_leaving(&onward, within, &from), next);
                    prop_assert_eq!(fast.occluded_leaving(&onward, within, &from), next.is_some());
                    leaving.push(onward);
                    leaving_within.push(within);
                    departures.push(from);
                    let (onward, within) = from.through(ray.direction);
                    let next = plain.nearest_leaving(&onward, within, &from);
                    prop_assert_eq!(fast.nearest_leaving(&onward, within, &from), next);
                }
            }
        }
        let mut occluded = vec![false; leaving.len()];
        fast.occluded_leaving_many(&leaving, &leaving_within, &departures, &mut occluded);
        for (i, from) in departures.iter().enumerate() {
            prop_assert_eq!(occluded[i], plain.occluded_leaving(&leaving[i], leaving_within[i], from));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    #[test]
    fn small_scenes(scene in scene(12), casts in prop::collection::vec(cast(), 40)) {
        compare(&scene, &casts)?;
    }

    #[test]
    fn larger_scenes(scene in scene(300), casts in prop::collection::vec(cast(), 40)) {
        compare(&scene, &casts)?;
    }
}

/// Shadow rays of points here and there to one lamp, put in an order of their own, are blocked as each by itself.
#[cfg(feature = "testing")]
#[test]
fn rays_that_meet_in_a_lamp_are_blocked_as_one_by_one() {
    let mut random = rt_core::testing::Random::new(7);
    let mut plain = Geometry::builder().accelerated(false);
    for number in 0..3000 {
        let (at, size) = (random.in_cube() * 10.0, random.uniform(0.05, 0.4));
        plain.push(match number % 3 {
            0 => Shape::from(Torus::new(at, random.direction(), size, size * 0.3).unwrap()),
            1 => Cuboid::new(at, at + DVec3::splat(size)).unwrap().into(),
            _ => Sphere::new(at, size).unwrap().into(),
        });
    }
    let fast = plain.clone().accelerated(true).build();
    let plain = plain.build();
    for lamp in [[3.0, 4.0, 1.0], [40.0, 60.0, -50.0], [1e4, -3e4, 2e4]].map(DVec3::from_array) {
        let (mut rays, mut within, mut from) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..3000 {
            let ray = Ray::new(random.in_cube() * 12.0, random.direction());
            let Some(found) = fast.nearest(&ray, Interval::FORWARD) else { continue };
            let departure = fast.surface(&ray, found).departure(found.object, found.hit, Side::Outside);
            let start = departure.ray(DVec3::ZERO).0.origin;
            rays.push(Ray::new(start, lamp - start));
            within.push(Interval::new(0.0, 1.0));
            from.push(departure);
        }
        // No ray at all.
        rays[5].direction = DVec3::ZERO;
        within[6] = Interval::new(1.0, 0.0);
        for level in [Level::Portable, Level::Avx2] {
            set_level(level);
            let mut occluded = vec![false; rays.len()];
            fast.occluded_leaving_many(&rays, &within, &from, &mut occluded);
            let blocked = occluded.iter().filter(|&&blocked| blocked).count();
            assert!((rays.len() / 10..rays.len() * 9 / 10).contains(&blocked), "{blocked} of {}", rays.len());
            for (i, occluded) in occluded.iter().enumerate() {
                assert_eq!(*occluded, fast.occluded_leaving(&rays[i], within[i], &from[i]), "{i}");
                if i % 16 == 0 {
                    assert_eq!(*occluded, plain.occluded_leaving(&rays[i], within[i], &from[i]), "{i}");
                }
            }
        }
    }
}

#[test]
fn shapes_are_counted_as_they_are_added() {
    let mut builder = Geometry::builder();
    for i in 0..5 {
        assert_eq!(builder.push(Sphere::new([f64::from(i), 0.0, 0.0], 0.25).unwrap()), i);
    }
    let geometry = builder.add(Sphere::new([5.0, 0.0, 0.0], 0.25).unwrap()).build();
    for i in 0..6 {
        let ray = Ray::new([f64::from(i), 0.0, -3.0], [0.0, 0.0, 1.0]);
        assert_eq!(geometry.nearest(&ray, Interval::FORWARD).map(|found| found.object), Some(i));
    }
}

/// The memory is that of what is made for the shapes: about 150 bytes for each sphere, in any number, and none for a plane.
#[test]
fn memory_in_use() {
    let spheres = |count: u32| {
        let mut builder = Geometry::builder();
        for i in 0..count {
            let i = f64::from(i);
            builder.push(Sphere::new([i % 37.0, i * 0.618 % 29.0, i * 0.382 % 31.0], 0.25).unwrap());
        }
        builder.build().memory()
    };
    let [few, many] = [spheres(1000), spheres(10_000)];
    assert!((50_000..400_000).contains(&few), "{few}");
    assert!((8 * few..12 * few).contains(&many), "{few} {many}");
    assert!(Geometry::builder().build().memory() < 1000);
}

/// Rays without company in a scene larger than the cache, where they are interleaved: each finds what it finds alone.
#[test]
fn interleaved_rays() {
    let mut builder = Geometry::builder();
    for i in 0..100_000 {
        builder.push(Sphere::new(unit(i), 0.002 + 0.005 * unit(i + 9).x).unwrap());
    }
    let geometry = builder.build();
    let rays: Vec<Ray> = (0..400)
        .map(|i| {
            let (from, to) = (unit(7 * i + 3) * 3.0 - 1.0, unit(11 * i + 5));
            Ray::new(from, to - from)
        })
        .collect();
    let within: Vec<Interval> =
        (0..rays.len()).map(|i| Interval::new(0.0, [f64::INFINITY, 0.5][i % 2])).collect();
    let (mut found, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
    geometry.nearest_many(&rays, &within, &mut found);
    geometry.occluded_many(&rays, &within, &mut occluded);
    for (i, ray) in rays.iter().enumerate() {
        let hits = geometry.shapes().iter().filter_map(|shape| shape.hit(ray, within[i]));
        let nearest = hits.map(|hit| hit.t()).min_by(f64::total_cmp);
        assert_eq!(found[i].map(|found| found.hit.t()), nearest, "{ray:?}");
        assert_eq!(found[i], geometry.nearest(ray, within[i]), "{ray:?}");
        assert_eq!(occluded[i], nearest.is_some(), "{ray:?}");
    }
    let hits = found.iter().flatten().count();
    assert!(hits > 100 && hits < 350, "{hits}");
}

/// Rays in the rows of a picture, of any width, are answered as one by one: pinhole and parallel, with a wall beside the
/// tree, intervals of their own, and some that are no rays.
#[test]
fn pictures_row_by_row() {
    let mut builder = Geometry::builder();
    for i in 0..2000 {
        builder.push(Sphere::new(unit(i), 0.005 + 0.02 * unit(i + 9).x).unwrap());
        builder.push(Torus::new(unit(3 * i + 1), unit(i) - 0.5, 0.02, 0.004).unwrap());
    }
    builder.push(Plane::new([0.0, 0.0, 0.9], [0.1, 0.0, 1.0]).unwrap());
    let geometry = builder.build();
    for (width, height, parallel) in
        [(64, 40, false), (37, 9, true), (101, 23, false), (16, 70, true), (9, 50, false)]
    {
        let (mut rays, mut within) = (Vec::new(), Vec::new());
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let at = DVec3::new(f64::from(x) / f64::from(width), f64::from(y) / f64::from(height), 0.0);
            let number = rays.len();
            rays.push(match number % 397 {
                396 => Ray::new([f64::NAN, 0.0, 0.0], [0.0, 0.0, 1.0]),
                _ if parallel => Ray::new(at - DVec3::Z, [0.0, 0.0, 2.0]),
                _ => Ray::new([0.5, 0.5, -2.0], at - DVec3::new(0.5, 0.5, -2.0)),
            });
            within.push(Interval::new(0.0, [f64::INFINITY, 1.3][number / 1000 % 2]));
        }
        let (mut found, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
        geometry.nearest_many(&rays, &within, &mut found);
        geometry.occluded_many(&rays, &within, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(found[i], geometry.nearest(ray, within[i]), "{width} {i}");
            assert_eq!(occluded[i], geometry.occluded(ray, within[i]), "{width} {i}");
        }
        let hits = found.iter().flatten().count();
        assert!(hits > rays.len() / 2, "{hits} of {}", rays.len());
        // As many as the shortest slice has.
        let few = rays.len() / 3;
        let mut some = vec![None; few];
        geometry.nearest_many(&rays, &within, &mut some);
        assert!(some == found[..few]);
    }
}

/// Packets lose no sphere that a ray just touches: near the limit of `f32` and of `f64`, from near and from far.
#[test]
fn packets_of_rays_that_graze_spheres() {
    for (scale, offset) in [(1.0, 0.0), (1e-3, 1e3), (1e6, 1e9), (2_f64.powi(-80), 0.0)] {
        let mut builder = Geometry::builder();
        for i in 0..600 {
            let radius = scale * 0.03 * (0.2 + f64::from(i % 7) / 7.0);
            builder.push(Sphere::new(unit(i) * scale + offset, radius).unwrap());
        }
        let geometry = builder.build();
        for (far, count) in [(-0.3, 32), (0.0, 32), (1.5, 32), (50.0, 21), (1e4, 16)] {
            for i in 0..40 {
                let Shape::Sphere(sphere) = &geometry.shapes()[i * 14] else { unreachable!() };
                let (center, side) = (sphere.center(), (unit(i as u32 + 7) - 0.5).normalize());
                let origin = center + (DVec3::new(0.3, -1.0, 0.2) * (0.5 + far)) * scale;
                let across = (center - origin).cross(side).normalize();
                let rays: Vec<Ray> = (0..count)
                    .map(|k| {
                        let step = 2_f64.powi(-(k % 16) * 3 - 4) * if k < 16 { 1.0 } else { -1.0 };
                        let target = center + across * (sphere.radius() * (1.0 + step));
                        Ray::new(origin, (target - origin) / scale)
                    })
                    .collect();
                let within = vec![Interval::FORWARD; rays.len()];
                let (mut found, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
                for level in [Level::Portable, Level::Avx2] {
                    set_level(level);
                    geometry.nearest_many(&rays, &within, &mut found);
                    geometry.occluded_many(&rays, &within, &mut occluded);
                    for (i, ray) in rays.iter().enumerate() {
                        let shapes = geometry.shapes().iter();
                        let hit = shapes.filter_map(|shape| shape.hit(ray, within[i]));
                        let nearest = hit.min_by(|a, b| a.t().total_cmp(&b.t()));
                        assert_eq!(found[i].map(|found| found.hit.t()), nearest.map(|hit| hit.t()));
                        assert_eq!(found[i], geometry.nearest(ray, within[i]));
                        assert_eq!(occluded[i], found[i].is_some());
                    }
                }
            }
        }
    }
}

/// Packets of a camera's rays of which some are none, or come from far away: one by one and together they find the same.
#[test]
fn packets_with_rays_that_are_none() {
    let mut builder = Geometry::builder();
    for i in 0..200 {
        let x = f64::from(i);
        let center = DVec3::new((x * 0.7).sin(), (x * 1.3).cos(), (x * 2.9).sin());
        builder.push(Sphere::new(center, 0.05 + 0.1 * (x * 0.37).sin().abs()).unwrap());
    }
    let geometry = builder.build();
    for kind in 0..6 {
        for every in [2, 3, 7, 31] {
            let mut rays = Vec::new();
            let mut within = vec![Interval::FORWARD; 320];
            for i in 0..320 {
                // The camera turns, so that one packet's rays are not the next one's.
                let (x, y, turn) = (f64::from(i % 8) * 0.02, f64::from(i / 8 % 4) * 0.02, f64::from(i / 32));
                let origin = DVec3::new(3.0 * turn.cos(), 0.3, 3.0 * turn.sin());
                let right = DVec3::new(-turn.sin(), 0.0, turn.cos());
                let mut ray = Ray::new(origin, -origin + right * x + DVec3::Y * y);
                if i % every == every / 2 {
                    match kind {
                        0 => ray.direction = DVec3::ZERO,
                        1 => ray.origin.x = f64::NAN,
                        2 => within[i as usize] = Interval::new(2.0, 1.0),
                        3 => ray.origin -= ray.direction * 1e6,
                        4 => ray.direction *= 1e-305,
                        _ => within[i as usize] = Interval::new(f64::NEG_INFINITY, f64::INFINITY),
                    }
                }
                rays.push(ray);
            }
            let (mut found, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
            for level in [Level::Portable, Level::Avx2] {
                set_level(level);
                geometry.nearest_many(&rays, &within, &mut found);
                geometry.occluded_many(&rays, &within, &mut occluded);
                for (i, ray) in rays.iter().enumerate() {
                    assert_eq!(found[i], geometry.nearest(ray, within[i]), "{kind} {every} {i}");
                    assert_eq!(occluded[i], found[i].is_some(), "{kind} {every} {i}");
                }
                assert!(found.iter().flatten().count() > 40, "{kind} {every}");
            }
        }
    }
}

/// Rays of any bits, legal or not, find the same and never panic.
#[test]
fn any_bits() {
    let mut builder = Geometry::builder();
    for i in 0..40 {
        let x = f64::from(i);
        builder.push(Sphere::new([x, x * 0.5, -x], 0.75).unwrap());
    }
    let (fast, plain) = (builder.clone().build(), builder.accelerated(false).build());
    let odd = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        5e-324,
        1e-310,
        1e-200,
        1e200,
        f64::MAX,
    ];
    let pick = |i: usize| odd[i % odd.len()];
    for i in 0..odd.len().pow(3) {
        for j in 0..odd.len() {
            let (a, b, c) = (i, i / odd.len(), i / odd.len() / odd.len());
            let ray = Ray::new([pick(a), pick(b + j), pick(c)], [pick(c + j), pick(a + j), pick(b)]);
            for within in [
                Interval::FORWARD,
                Interval::LINE,
                Interval::new(pick(a), pick(j)),
                Interval::new(1.0, pick(b)),
            ] {
                assert_eq!(fast.nearest(&ray, within), plain.nearest(&ray, within), "{ray:?} {within:?}");
                assert_eq!(fast.occluded(&ray, within), plain.occluded(&ray, within), "{ray:?} {within:?}");
            }
        }
    }
}

/// A packet whose rays all end near the camera but one: that one goes on, whichever it is.
#[test]
fn one_ray_of_a_packet_goes_on() {
    const RAYS: usize = 32;
    let ball = |i: usize, x: f64, z: f64| Sphere::new([x * i as f64, 0.0, z], 0.04).unwrap();
    // Far away and beside: there are enough shapes for a tree.
    let others = || (0..RAYS).map(|i| ball(i, 0.1, -20.0)).chain((0..RAYS).map(|i| ball(i, 0.1, 20.0)));
    let rays: Vec<Ray> = (0..RAYS)
        .map(|i| Ray::new([0.1 * i as f64, 0.0, 0.0], [0.0, 1e-4 * i as f64 / 64.0, -1.0]))
        .collect();
    let within = vec![Interval::FORWARD; RAYS];
    for one in 0..RAYS {
        let mut builder = Geometry::builder();
        for shape in (0..RAYS).filter(|&i| i != one).map(|i| ball(i, 0.1, -10.0)).chain(others()) {
            builder.push(shape);
        }
        let geometry = builder.build();
        let mut found = vec![None; RAYS];
        geometry.nearest_many(&rays, &within, &mut found);
        for (i, found) in found.iter().enumerate() {
            let t = found.expect("each ray meets a ball").hit.t();
            assert!((t > 15.0) == (i == one), "ray {i} without the ball of {one}: {t}");
        }
    }
}

/// A sphere met from 250 radii away by a ray whose direction is half the greatest number long: accelerated as plainly.
#[test]
fn the_longest_directions() {
    let shapes: [Shape; 2] = [
        rt_core::shape::Sphere::new([-73.0, -40.0, 1.2e60], 3.6e152).unwrap().into(),
        rt_core::shape::Plane::new([99.0, 121.0, 121.0], [1.0, 1.0, 1.0]).unwrap().into(),
    ];
    let build = |accelerated: bool| {
        let mut builder = Geometry::builder().accelerated(accelerated);
        shapes.iter().for_each(|shape| _ = builder.push(shape.clone()));
        builder.build()
    };
    for (x, y, z) in [(105.6, 8.8e52, 9.2e307), (0.0, 0.0, 4.4e307), (1e305, 0.0, f64::MAX)] {
        let ray = Ray::new([24.75, 3.9e-13, -9.08e154], [x, y, z]);
        let [fast, plain] =
            [true, false].map(|accelerated| build(accelerated).nearest(&ray, Interval::FORWARD));
        assert_eq!(fast, plain);
        assert_eq!(plain.map(|found| found.object), Some(0));
    }
}

/// Cones and cylinders whose radius is anything up to 1e60 times their height, or the other way round: both crossings of a ray
/// may be one as far as can be told, but then it is no crossing beside the shape. Accelerated as plainly.
#[cfg(feature = "testing")]
#[test]
fn flat_cones_and_needles() {
    let check = |shape: Shape, ray: Ray| {
        let build = |accelerated: bool| {
            let mut builder = Geometry::builder().accelerated(accelerated);
            builder.push(shape.clone());
            builder.build()
        };
        let [fast, plain] =
            [true, false].map(|accelerated| build(accelerated).nearest(&ray, Interval::FORWARD));
        assert_eq!(fast, plain, "{shape:?} {ray:?}");
    };
    // Ten radii from the axis.
    let (base, top) =
        ([51.29296875, -93.88671875, -113.66015625], [51.29296875, -93.88671875, -173.27734375]);
    let cone = Cone::open(base, 1.2884779604201031e35, top, 106.49609375).unwrap();
    let origin = [-1.7296495718327678e36, -7.115392158729815e35, -1.0417835958088987e36];
    check(cone.into(), Ray::new(origin, [0.0, 0.0, 60.10546875]));
    let mut random = rt_core::testing::Random::new(1);
    for case in 0..60_000 {
        let mut point = || random.in_cube() * 128.0;
        let (a, b, near) = (point(), point(), point());
        let b = if case % 2 == 0 { a + DVec3::AXES[case / 2 % 3] * b.x } else { b };
        let exponent = random.uniform(9.0, 60.0);
        let large = random.magnitude(exponent, exponent + 1.0);
        let (l, m) = if case % 4 < 2 { (near.x.abs(), large) } else { (large, near.x.abs()) };
        let far = random.magnitude(0.0, exponent);
        let shape: Shape = match case % 5 {
            0 => Cone::new(a, l, b, m).unwrap().into(),
            1 => Cylinder::new(a, b, large).unwrap().into(),
            2 => Cylinder::open(a, a + (b - a) * far, near.x.abs()).unwrap().into(),
            _ => Cone::open(a, l, b, m).unwrap().into(),
        };
        let origin = if case % 3 == 0 { near } else { random.in_cube() * far * 128.0 };
        let direction = match case % 7 {
            0 => a - origin,
            1 | 2 => DVec3::AXES[case % 3] * random.sign(),
            _ => random.in_cube() * 128.0,
        };
        check(shape, Ray::new(origin, direction));
    }
}
