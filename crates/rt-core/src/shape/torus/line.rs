//! A ray seen from the torus: its closest approach to the centre, in double-double, at the torus' own scale.
//!
//! About the closest approach `m` a ray is `m + x u` with `|u| = 1` and `m . u = 0`, and the torus is the zero set of
//!
//! ```text
//! f(x) = k^2 - 4 R^2 (r - z) (r + z),    k = |m|^2 - R^2 - r^2 + x^2,    z = m . a + x (u . a)
//! f(x) = x^4 + 2 P x^2 + 4 Q x + const,  P = |m|^2 - R^2 - r^2 + 2 R^2 (u . a)^2,    Q = 2 R^2 (m . a) (u . a)
//! ```
//!
//! a quartic without a cubic term. Evaluated as the first line stands it loses nothing on a thin tube: there `k` is
//! of the order of `R r` and `z` of the order of `r`, so that a rounding of either moves the zero by a rounding of
//! `R` and not by `R / r` of them. Near the axis, where a horn or a spindle meets itself, the same is written
//!
//! ```text
//! f(x) = K^2 - 4 R^2 rho^2,    K = |m|^2 + R^2 - r^2 + x^2,    rho^2 = |m'|^2 + 2 x m' . u' + x^2 |u'|^2
//! ```
//!
//! with `m'` and `u'` the parts across the axis: there it is the difference of two small numbers.

use super::Torus;
use super::exact::ROUNDING;
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::Product;
use crate::scaled::{ScaledRay, largest};
use glam::DVec3;

/// A line about its closest approach to the torus' centre, in double-double. Lengths are in units of the torus.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// The direction as given, its largest component in `[1, 2)`.
    pub direction: DVec3,
    /// The length of `direction`.
    pub length: Double,
    /// The parameter of the closest approach, counted in `direction`s from the ray's origin.
    pub parameter: Double,
    /// The closest approach `m`.
    pub point: DoubleVector,
    /// `|m|^2 - R^2 - r^2`.
    pub k: Double,
    /// `m . a`.
    pub z: Double,
    /// `u . a`.
    pub slope: Double,
    /// `2 R^2`.
    twice: Double,
    minor: f64,
    /// What the second form needs, where the line comes so near to the centre that it is the better one.
    pub core: Option<Core>,
}

/// The line across the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core {
    /// `|m|^2 + R^2 - r^2`.
    pub k: Double,
    /// `|m'|^2`.
    square: Double,
    /// `m' . u'`.
    product: Double,
    /// `|u'|^2`.
    slope: Double,
}

impl Core {
    #[inline(always)]
    fn new<P: Product>(
        torus: &Torus,
        point: DoubleVector,
        direction: DVec3,
        slope: Double,
        length: Double,
    ) -> Core {
        let axis = torus.frame[2];
        let unit = DoubleVector::from(direction).mul::<P>(Double::ONE.div::<P>(length));
        let along = unit - axis.mul::<P>(slope);
        let across = point - axis.mul::<P>(point.dot::<P>(axis));
        Core {
            k: point.length_squared::<P>() + torus.difference,
            square: across.length_squared::<P>(),
            product: across.dot::<P>(along),
            slope: along.length_squared::<P>(),
        }
    }

    /// `rho^2` at `x`.
    #[inline(always)]
    fn rho_squared<P: Product>(&self, x: Double) -> Double {
        (x.mul::<P>(self.slope) + self.product.scale_exact(2.0)).mul::<P>(x) + self.square
    }

    /// How far double-double arithmetic may be off in `f` at `x`, in units of its rounding.
    #[inline(always)]
    pub fn magnitude<P: Product>(&self, x: Double, twice: f64) -> f64 {
        // The difference of two like numbers: small where the sheets of a spindle meet.
        let k = (self.k + x.square::<P>()).high;
        let x = x.high;
        let rho = (x * self.slope.high + 2.0 * self.product.high) * x + self.square.high;
        let parts = x * x * self.slope.high + 2.0 * (x * self.product.high).abs() + self.square.high;
        let scale = x * x + self.square.high + self.k.high.abs();
        2.0 * k.abs() * scale + k * k + ROUNDING * scale * scale + 2.0 * twice * (rho.abs() + parts)
    }
}

impl Line {
    /// The line through `origin` (relative to the centre) along `direction`, both at the torus' scale.
    #[inline(always)]
    pub fn new<P: Product>(torus: &Torus, origin: DoubleVector, direction: DVec3) -> Line {
        let d = direction;
        let square = DoubleVector::from(d).dot_f64::<P>(d);
        // First the whole way with a rounded factor but an exact sum, then what little is left: nothing of the
        // point's digits is lost, however far away the ray starts.
        let mut point = origin;
        let mut parameter = Double::ZERO;
        let steps = if largest(origin.high()) > FAR { 3 } else { 1 };
        for _ in 0..steps {
            let step = -(point.high().dot(d) / square.high);
            point = point + DoubleVector::product::<P>(d, step);
            parameter = parameter + step;
        }
        let rest = -point.dot_f64::<P>(d).div::<P>(square);
        point = point + DoubleVector::from(d).mul::<P>(rest);
        let length = square.sqrt::<P>();
        let axis = torus.frame[2];
        let k = point.length_squared::<P>() - torus.squares;
        let z = point.dot::<P>(axis);
        let slope = axis.dot_f64::<P>(d).div::<P>(length);
        let twice = torus.twice;
        let mut core = None;
        // Somewhere on the line |K| < |k|.
        if k.high < -0.5 * twice.high {
            core = Some(Core::new::<P>(torus, point, d, slope, length));
        }
        Line {
            direction,
            length,
            parameter: parameter + rest,
            point,
            k,
            z,
            slope,
            twice,
            minor: torus.minor_scaled,
            core,
        }
    }

    /// The line of a ray.
    #[inline(always)]
    pub fn of<P: Product>(torus: &Torus, ray: &ScaledRay) -> Line {
        Line::new::<P>(torus, ray.relative, ray.direction)
    }

    /// `f(x)` and a quarter of its derivative.
    #[inline(always)]
    pub fn value<P: Product>(&self, x: Double) -> (Double, Double) {
        let square = x.square::<P>();
        let k = self.k + square;
        if let Some(core) = &self.core
            && k.high < -0.5 * self.twice.high
        {
            let k = core.k + square;
            let value = k.square::<P>() - self.twice.mul::<P>(core.rho_squared::<P>(x)).scale_exact(2.0);
            let across = x.mul::<P>(core.slope) + core.product;
            return (value, k.mul::<P>(x) - self.twice.mul::<P>(across));
        }
        let z = self.z + x.mul::<P>(self.slope);
        let gap = (-z + self.minor).mul::<P>(z + self.minor);
        let value = k.square::<P>() - self.twice.mul::<P>(gap).scale_exact(2.0);
        let slope = k.mul::<P>(x) + self.twice.mul::<P>(z.mul::<P>(self.slope));
        (value, slope)
    }

    /// `P` and `Q` of the cubic `x^3 + P x + Q` whose zeros are the extrema of `f`.
    #[inline(always)]
    pub fn extremal<P: Product>(&self) -> (Double, Double) {
        let twice = self.twice;
        match &self.core {
            Some(core) => (core.k - twice.mul::<P>(core.slope), -twice.mul::<P>(core.product)),
            None => (
                self.k + twice.mul::<P>(self.slope.square::<P>()),
                twice.mul::<P>(self.z.mul::<P>(self.slope)),
            ),
        }
    }

    /// A quarter of the derivative, rounded.
    #[inline(always)]
    pub fn slope_at(&self, x: f64) -> f64 {
        let z = self.z.high + x * self.slope.high;
        (self.k.high + x * x) * x + self.twice.high * z * self.slope.high
    }

    /// An eighth of the second derivative, `(3 x^2 + P) / 2`, rounded.
    #[inline(always)]
    pub fn bend(&self, x: f64) -> f64 {
        0.5 * (3.0 * x * x + (self.k.high + self.twice.high * self.slope.high * self.slope.high))
    }

    /// The parameter at distance `x` from the closest approach.
    #[inline(always)]
    pub fn parameter_at<P: Product>(&self, x: Double) -> Double {
        self.parameter + x.div::<P>(self.length)
    }

    /// The distance from the closest approach of the point at this parameter.
    #[inline(always)]
    pub fn distance<P: Product>(&self, parameter: Double) -> Double {
        (parameter - self.parameter).mul::<P>(self.length)
    }

    /// The parameter at distance `x` from the closest approach, and the point there, relative to the centre.
    #[inline(always)]
    pub fn at<P: Product>(&self, x: Double) -> (Double, DoubleVector) {
        let further = x.div::<P>(self.length);
        (self.parameter + further, self.point + DoubleVector::from(self.direction).mul::<P>(further))
    }
}

/// From beyond this many sizes one step leaves more than 2^-10 sizes to go, and its square would show.
const FAR: f64 = crate::math::exp2i(40);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Task, run};
    use crate::testing::Random;

    struct Near<'a>(&'a Torus, DVec3, DVec3, f64);

    impl Task for Near<'_> {
        type Output = Option<(Core, f64)>;
        fn run<P: Product>(self) -> Self::Output {
            let Near(torus, origin, direction, x) = self;
            let core = Line::new::<P>(torus, DoubleVector::from(origin), direction).core?;
            Some((core, core.rho_squared::<P>(Double::from(x)).high))
        }
    }

    /// The sizes of the terms of `f` are at least as large together as the terms: `K^2` and `4 R^2 rho^2`, each of which is
    /// a sum itself.
    #[test]
    fn a_magnitude_is_that_of_all_terms() {
        let mut random = Random::new(1);
        let mut count = 0;
        for _ in 0..2000 {
            let torus = Torus::new(DVec3::ZERO, random.direction(), 1.0, random.uniform(0.5, 1.5)).unwrap();
            let x = random.uniform(-0.2, 0.2);
            let near = Near(&torus, random.in_cube() * random.magnitude(-6.0, 0.0), random.direction(), x);
            let Some((core, rho_squared)) = run(near) else { continue };
            count += 1;
            let (k, twice) = (core.k.high + x * x, torus.twice.high);
            let least = k * k + 2.0 * twice * 2.0 * rho_squared;
            let most = 8.0 * torus.reach * torus.reach * torus.reach * torus.reach;
            let magnitude = core.magnitude::<crate::kernel::Dekker>(Double::from(x), twice);
            assert!((0.999 * least..most).contains(&magnitude), "{torus:?} {x}: {least} {magnitude} {most}");
        }
        assert!(count > 500, "{count}");
    }
}
