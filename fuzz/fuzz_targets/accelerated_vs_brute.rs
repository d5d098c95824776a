//! The acceleration structure gives the answers of the plain loop, bit for bit.
#![no_main]

use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus, Triangle};
use rt_core::{Error, Geometry, Interval, Ray, Shape};
use rt_fuzz::{Number, Vector};

#[derive(Arbitrary, Debug)]
struct Case {
    shapes: Vec<(u8, [Vector; 3], [Number; 2])>,
    rays: Vec<(Vector, Vector, Option<Number>)>,
}

fn shape(kind: u8, points: [Vector; 3], lengths: [Number; 2]) -> Result<Shape, Error> {
    let [a, b, c] = points.map(Vector::value);
    let [l, m] = lengths.map(Number::value);
    Ok(match kind % 8 {
        0 => Sphere::new(a, l)?.into(),
        1 => Plane::new(a, b)?.into(),
        2 => Cuboid::new(a.min(b), a.max(b))?.into(),
        3 => Cylinder::new(a, b, l)?.into(),
        4 => Cone::open(a, l, b, m)?.into(),
        5 => Torus::new(a, b, l, m)?.into(),
        6 => Disk::new(a, b, l)?.into(),
        _ => Triangle::new(a, b, c)?.into(),
    })
}

fuzz_target!(|case: Case| {
    let (mut fast, mut plain) =
        (Geometry::builder().accelerated(true), Geometry::builder().accelerated(false));
    for shape in case
        .shapes
        .into_iter()
        .take(200)
        .filter_map(|(kind, points, lengths)| shape(kind, points, lengths).ok())
    {
        fast.push(shape.clone());
        plain.push(shape);
    }
    let (fast, plain) = (fast.build(), plain.build());
    for (origin, direction, max) in case.rays.into_iter().take(50) {
        let ray = Ray::new(origin.value(), direction.value());
        let within = Interval::FORWARD.until(max.map_or(f64::INFINITY, Number::value));
        let (a, b) = (fast.nearest(&ray, within), plain.nearest(&ray, within));
        assert_eq!(a, b, "{ray:?}");
        assert_eq!(fast.occluded(&ray, within), b.is_some());
        if let Some(found) = b {
            // Printed, since a plane met beyond 1e300 has no finite record and NaN is not equal to itself.
            let record = |geometry: &Geometry| format!("{:?}", geometry.surface(&ray, found));
            assert_eq!(record(&fast), record(&plain));
        }
    }
});
