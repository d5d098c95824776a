//! What the fuzz targets share.

use libfuzzer_sys::arbitrary::{self, Arbitrary};
use rt_core::glam::DVec3;
use rt_core::testing::{Effort, check_crossings, check_primitive};
use rt_core::{Hit, Interval, Primitive, Ray, Shape};

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

    /// The same with sizes from 2^-20 to 2^20: the range that lengths of one shape and one ray may span.
    fn plain(self) -> f64 {
        match self {
            Number::Bits(bits) if bits << 1 == 0 => f64::from_bits(bits),
            Number::Bits(bits) => {
                let exponent = 1023 - 20 + (bits >> 52 & 0x7ff) % 41;
                f64::from_bits(bits & 0x800f_ffff_ffff_ffff | exponent << 52)
            }
            other => other.value(),
        }
    }
}

#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Vector([Number; 3]);

impl Vector {
    pub fn value(self) -> DVec3 {
        DVec3::from_array(self.0.map(Number::value))
    }

    fn plain(self, scale: f64) -> DVec3 {
        DVec3::from_array(self.0.map(Number::plain)) * scale
    }
}

/// A shape's numbers, a ray, an interval and a seed for more rays.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Case {
    points: [Vector; 3],
    lengths: [Number; 2],
    origin: Vector,
    direction: Vector,
    min: Number,
    max: Option<Number>,
    /// The exponents of the unit of length and of the ray's speed.
    unit: i16,
    speed: i16,
    seed: u64,
}

fn power(exponent: i16) -> f64 {
    // 1e-135 to 1e135: with the numbers' own sizes, the promised 1e-150 to 1e150.
    f64::from_bits((1023 + i64::from(exponent % 450)) as u64 * (1 << 52))
}

impl Case {
    pub fn ray(&self) -> Ray {
        Ray::new(self.origin.value(), self.direction.value())
    }

    pub fn within(&self) -> Interval {
        Interval::new(self.min.value(), self.max.map_or(f64::INFINITY, Number::value))
    }

    /// Makes a shape from numbers of any bits, for one ray of any bits; then one from numbers whose sizes a scene may
    /// have together, for the oracle and the whole contract with some hard rays.
    pub fn check<S: Into<Shape>, E>(
        &self,
        make: impl Fn([DVec3; 3], [f64; 2]) -> Result<S, E>,
        closed: bool,
    ) {
        if let Ok(shape) = make(self.points.map(Vector::value), self.lengths.map(Number::value)) {
            let hits = cast(&shape.into(), &self.ray(), self.within());
            assert!(hits.is_empty() || self.ray().is_valid());
        }
        let (unit, speed) = (power(self.unit), power(self.speed));
        let points = self.points.map(|point| point.plain(unit));
        let Ok(shape) = make(points, self.lengths.map(|length| length.plain() * unit)) else { return };
        let shape = shape.into();
        let ray = Ray::new(self.origin.plain(unit), self.direction.plain(speed));
        check_ray(&shape, &ray, Interval::LINE);
        if let Err(failure) = check_crossings(&shape, &ray) {
            panic!("{failure}");
        }
        let effort = Effort::new(self.seed, 4);
        let effort = if closed { effort.closed() } else { effort };
        if let Err(failure) = check_primitive(&shape, &effort) {
            panic!("{shape:?}: {failure}");
        }
    }
}

/// All crossings lie inside the interval and ascend, and the nearest is the first.
fn cast(shape: &Shape, ray: &Ray, within: Interval) -> Vec<Hit> {
    let mut hits = Vec::new();
    shape.crossings(ray, within, &mut |hit| hits.push(hit));
    assert!(hits.len() <= 4, "{} crossings", hits.len());
    assert!(hits.iter().all(|hit| within.contains(hit.t())));
    assert!(hits.windows(2).all(|pair| pair[0].t() <= pair[1].t()), "{shape:?} {ray:?} {hits:?}");
    let nearest = shape.hit(ray, within);
    assert_eq!(nearest.map(|hit| hit.t()), hits.first().map(|hit| hit.t()), "{shape:?} {ray:?} {within:?}");
    hits
}

/// Moreover no hit is reported again by an interval that starts or ends with it, and each has a unit normal.
fn check_ray(shape: &Shape, ray: &Ray, within: Interval) {
    for hit in cast(shape, ray, within) {
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
