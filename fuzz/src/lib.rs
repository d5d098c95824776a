//! What the fuzz targets share.

use libfuzzer_sys::arbitrary::{self, Arbitrary};
use rt_core::glam::DVec3;
use rt_core::testing::{Effort, check_primitive};
use rt_core::{Hit, Interval, Primitive, Ray};

/// A number of any bits, or one of a plain size, which meets other plain numbers far more often.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub enum Number {
    Bits(u64),
    Plain(i16),
    Sum(i8, i8, i8),
}

impl Number {
    pub fn value(self) -> f64 {
        match self {
            Number::Bits(bits) => f64::from_bits(bits),
            Number::Plain(n) => f64::from(n) / 256.0,
            // A small number and a very small one: nearly equal, never quite.
            Number::Sum(a, b, k) => {
                f64::from(a) / 4.0
                    + f64::from(b) * f64::from_bits(((1023 - 52 + i64::from(k / 4)) as u64) << 52)
            }
        }
    }
}

#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Vector([Number; 3]);

impl Vector {
    pub fn value(self) -> DVec3 {
        DVec3::from_array(self.0.map(Number::value))
    }
}

/// A shape's numbers, a ray, an interval and a seed for more rays.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Case {
    pub points: [Vector; 3],
    pub lengths: [Number; 2],
    pub origin: Vector,
    pub direction: Vector,
    pub min: Number,
    pub max: Option<Number>,
    pub seed: u64,
}

impl Case {
    pub fn ray(&self) -> Ray {
        Ray::new(self.origin.value(), self.direction.value())
    }

    pub fn within(&self) -> Interval {
        Interval::new(self.min.value(), self.max.map_or(f64::INFINITY, Number::value))
    }

    /// Checks one ray of any bits, then the whole contract with some hard rays.
    pub fn check<S: Primitive, E>(&self, shape: Result<S, E>, closed: bool) {
        let Ok(shape) = shape else { return };
        check_ray(&shape, &self.ray(), self.within());
        let effort = Effort::new(self.seed, 4);
        let effort = if closed { effort.closed() } else { effort };
        if let Err(failure) = check_primitive(&shape, &effort) {
            panic!("{shape:?}: {failure}");
        }
    }
}

/// All crossings lie inside the interval and ascend, the nearest is the first, and each has a unit normal.
pub fn check_ray(shape: &dyn Primitive, ray: &Ray, within: Interval) {
    let mut hits = Vec::new();
    shape.crossings(ray, within, &mut |hit| hits.push(hit));
    assert!(hits.len() <= 8, "{} crossings", hits.len());
    assert!(hits.is_empty() || ray.is_valid());
    assert!(hits.iter().all(|hit| within.contains(hit.t())));
    assert!(hits.windows(2).all(|pair| pair[0].t() <= pair[1].t()));
    assert_eq!(shape.hit(ray, within).map(|hit| hit.t()), hits.first().map(|hit| hit.t()));
    for hit in hits {
        // A hit is not reported again by an interval that starts or ends with it.
        for rest in [within.until(hit.t()), within.after(hit.t())] {
            let again = |other: Hit| (other.part(), other.root()) == (hit.part(), hit.root());
            let found = shape.hit(ray, rest);
            assert!(!found.is_some_and(again), "{shape:?} {ray:?} {rest:?} {hit:?} {found:?}");
        }
        let surface = shape.surface(ray, hit);
        assert!(surface.t.is_finite(), "{surface:?}");
        assert!((surface.normal.length() - 1.0).abs() < 1e-15, "{surface:?}");
    }
}
