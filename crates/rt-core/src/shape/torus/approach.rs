//! A ray seen from the torus: its closest approach to the centre, in double-double, at the torus' own scale.
//!
//! About the closest approach `m` a ray is `m + x u` with `|u| = 1` and `m . u = 0`, and the torus is the zero set of
//!
//! ```text
//! f(x) = k^2 - 4 R^2 (r - z) (r + z),    k = |m|^2 - R^2 - r^2 + x^2,    z = m . a + x (u . a)
//! f(x) = x^4 + 2 P x^2 + 4 Q x + const,  P = |m|^2 - R^2 - r^2 + 2 R^2 (u . a)^2,    Q = 2 R^2 (m . a) (u . a)
//! ```
//!
//! a quartic without a cubic term. Evaluated as the first line stands it loses nothing on a thin tube: there `k` and
//! `z` are both of the order of `r`, so that an error of `u` in either moves the zero by `u` and not by `u R / r`.

use super::Torus;
use crate::Ray;
use crate::double::Double;
use crate::kernel::Product;
use crate::math::{exp2i, exponent};
use glam::DVec3;

/// Three double-double coordinates.
pub(super) type Vector = [Double; 3];

/// Components below this, with the torus and the direction scaled to about 1, are taken as zero. A product of two
/// that remain is then inside the range in which products are exact (`|ab| >= 2^-968`), low parts included. What is
/// lost would show at distances beyond 2^200 sizes only.
const NEGLIGIBLE: f64 = exp2i(-320);

/// Origins further away than this many sizes hit nothing: beyond, products overflow the exact range (`2^995`).
const TOO_FAR: f64 = exp2i(900);

/// A ray in the torus' frame and scale. All lengths are in units of `2^scale` of the torus.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    /// The direction times a power of two: its largest component is in `[1, 2)`.
    pub direction: DVec3,
    /// The length of `direction`.
    pub length: Double,
    /// The parameter of the closest approach, counted in `direction`s.
    pub parameter: Double,
    /// The closest approach relative to the torus' centre, in world axes.
    pub point: Vector,
    /// `|m|^2 - R^2 - r^2`.
    pub k: Double,
    /// `m . a`.
    pub z: Double,
    /// `u . a`.
    pub slope: Double,
    /// A parameter times two to this power counts in the ray's own directions.
    pub exponent: i32,
}

/// The scalar product of a double-double vector and a plain one.
#[inline(always)]
pub(super) fn dot<P: Product>(a: &Vector, b: DVec3) -> Double {
    a[0].scale::<P>(b.x) + a[1].scale::<P>(b.y) + a[2].scale::<P>(b.z)
}

/// The scalar product of two double-double vectors.
#[inline(always)]
pub(super) fn dot_double<P: Product>(a: &Vector, b: &Vector) -> Double {
    a[0].mul::<P>(b[0]) + a[1].mul::<P>(b[1]) + a[2].mul::<P>(b[2])
}

/// `x` times two to the power `n`, in two steps so that neither factor leaves the range of normal numbers.
#[inline(always)]
pub(super) fn scaled(x: f64, n: i32) -> f64 {
    let half = n / 2;
    x * exp2i(half.clamp(-1022, 1023)) * exp2i((n - half).clamp(-1022, 1023))
}

#[inline(always)]
fn flush(x: f64) -> f64 {
    if x.abs() < NEGLIGIBLE { 0.0 } else { x }
}

impl Approach {
    /// Moves the ray's origin to its closest approach; `None` for a ray that hits nothing whatever the shape.
    #[inline(always)]
    pub fn new<P: Product>(torus: &Torus, ray: &Ray) -> Option<Approach> {
        if !ray.is_valid() {
            return None;
        }
        let power = exponent(ray.direction.abs().max_element());
        let turn = |x| flush(scaled(x, -power));
        let d = DVec3::new(turn(ray.direction.x), turn(ray.direction.y), turn(ray.direction.z));
        let shift = |o: f64, c: f64| {
            let w = Double::difference(o, c).scale_exact(torus.unit);
            if w.high.abs() < NEGLIGIBLE { Double::ZERO } else { Double { high: w.high, low: flush(w.low) } }
        };
        let w = [
            shift(ray.origin.x, torus.center.x),
            shift(ray.origin.y, torus.center.y),
            shift(ray.origin.z, torus.center.z),
        ];
        let far = DVec3::new(w[0].high, w[1].high, w[2].high);
        if !(far.abs().max_element() < TOO_FAR) {
            return None;
        }
        Some(Approach::moved::<P>(torus, w, d, torus.scale - power))
    }

    /// The closest approach of the ray from `w` (relative to the centre) along `d`, both at the torus' scale.
    #[inline(always)]
    pub fn moved<P: Product>(torus: &Torus, w: Vector, d: DVec3, exponent: i32) -> Approach {
        let square =
            Double::product::<P>(d.x, d.x) + Double::product::<P>(d.y, d.y) + Double::product::<P>(d.z, d.z);
        // First the whole way with one rounded factor and an exact sum, then the little that is left: so nothing of
        // the point's digits is lost, however far away the ray starts.
        let first = -(w[0].high * d.x + w[1].high * d.y + w[2].high * d.z) / square.high;
        let advance = |w: Double, d: f64| {
            let (p, e) = P::two_product(first, d);
            Double::sum(w.high, p) + Double::sum(w.low, e)
        };
        let near = [advance(w[0], d.x), advance(w[1], d.y), advance(w[2], d.z)];
        let rest = -dot::<P>(&near, d).div::<P>(square);
        let point =
            [near[0] + rest.scale::<P>(d.x), near[1] + rest.scale::<P>(d.y), near[2] + rest.scale::<P>(d.z)];
        let length = square.sqrt::<P>();
        Approach {
            direction: d,
            length,
            parameter: rest + first,
            k: dot_double::<P>(&point, &point) - torus.squares,
            z: dot_double::<P>(&point, &torus.frame[2]),
            slope: dot::<P>(&torus.frame[2], d).div::<P>(length),
            point,
            exponent,
        }
    }

    /// The ray's own parameter of the point at distance `x` from the closest approach, at the torus' scale.
    #[inline(always)]
    pub fn scaled_parameter<P: Product>(&self, x: Double) -> Double {
        self.parameter + x.div::<P>(self.length)
    }

    /// The ray's own parameter of the point at distance `x` from the closest approach, correctly rounded.
    #[inline(always)]
    pub fn t<P: Product>(&self, x: Double) -> f64 {
        scaled(self.scaled_parameter::<P>(x).to_f64(), self.exponent)
    }

    /// The point at distance `x` from the closest approach.
    #[inline(always)]
    pub fn at<P: Product>(&self, x: Double) -> Vector {
        let s = x.div::<P>(self.length);
        [
            self.point[0] + s.scale::<P>(self.direction.x),
            self.point[1] + s.scale::<P>(self.direction.y),
            self.point[2] + s.scale::<P>(self.direction.z),
        ]
    }
}
