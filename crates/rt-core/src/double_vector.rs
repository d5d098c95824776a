//! Vectors of double-double numbers.

use crate::double::{Double, two_difference, two_sum};
use crate::kernel::Product;
use crate::math::sqrt;
use core::ops::{Add, Sub};
use glam::DVec3;

/// Three double-double coordinates: about 106 bits each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DoubleVector {
    pub x: Double,
    pub y: Double,
    pub z: Double,
}

/// The square as a product and what is left of it, but for the square of the low part.
#[inline(always)]
fn squared<P: Product>(a: Double) -> (f64, f64) {
    let (p, e) = P::two_product(a.high, a.high);
    (p, e + 2.0 * (a.high * a.low))
}

impl DoubleVector {
    /// The exact value of a vector.
    #[inline(always)]
    pub fn from(v: DVec3) -> Self {
        DoubleVector { x: Double::from(v.x), y: Double::from(v.y), z: Double::from(v.z) }
    }

    /// The exact difference of two points.
    #[inline(always)]
    pub fn difference(a: DVec3, b: DVec3) -> Self {
        DoubleVector {
            x: Double::difference(a.x, b.x),
            y: Double::difference(a.y, b.y),
            z: Double::difference(a.z, b.z),
        }
    }

    /// `v * s`, exactly.
    #[inline(always)]
    pub fn product<P: Product>(v: DVec3, s: f64) -> Self {
        DoubleVector {
            x: Double::product::<P>(v.x, s),
            y: Double::product::<P>(v.y, s),
            z: Double::product::<P>(v.z, s),
        }
    }

    /// `self + t * d`, within a few 2^-106 of the largest of the terms.
    #[inline(always)]
    pub fn advanced<P: Product>(&self, d: DVec3, t: Double) -> Self {
        let along = |x: Double, d: f64| {
            let (p, e) = P::two_product(d, t.high);
            let (s, f) = two_sum(x.high, p);
            Double::sum(s, f + (x.low + (e + d * t.low)))
        };
        DoubleVector { x: along(self.x, d.x), y: along(self.y, d.y), z: along(self.z, d.z) }
    }

    /// `self + t * d` for a step far smaller than `self`.
    #[inline(always)]
    pub fn nudged(self, d: DVec3, t: f64) -> Self {
        let along = |x: Double, d: f64| Double::sum(x.high, x.low + d * t);
        DoubleVector { x: along(self.x, d.x), y: along(self.y, d.y), z: along(self.z, d.z) }
    }

    /// `|self|^2 - r^2` for a place near the sphere: within 2^-102 of `r^2`, or a unit in the last place.
    #[inline(always)]
    pub fn excess<P: Product>(self, r: f64) -> f64 {
        let (xx, x_low) = P::two_product(self.x.high, self.x.high);
        let (yy, y_low) = P::two_product(self.y.high, self.y.high);
        let (zz, z_low) = P::two_product(self.z.high, self.z.high);
        let (rr, r_low) = P::two_product(r, r);
        let (s, s_low) = two_sum(xx, yy);
        let (u, u_low) = two_difference(zz, rr);
        let (v, v_low) = two_sum(s, u);
        let cross = self.x.high * self.x.low + self.y.high * self.y.low + self.z.high * self.z.low;
        v + (v_low + ((s_low + u_low) + ((x_low + y_low) + (z_low - r_low)) + 2.0 * cross))
    }

    /// The scalar product, and less work than [`dot`](Self::dot): the high parts without error, their errors and the low
    /// parts added up in `f64` (Ogita, Rump, Oishi 2005, doi:10.1137/030601818). Errs by less than 2^-99 of the sizes of
    /// the terms together: eight additions of parts that are below 8 u of those, and the products of low parts.
    #[inline(always)]
    pub fn inner<P: Product>(&self, b: &DoubleVector) -> Double {
        let term = |a: Double, b: Double| {
            let (p, e) = P::two_product(a.high, b.high);
            (p, e + (a.high * b.low + a.low * b.high))
        };
        let ((x, x_low), (y, y_low), (z, z_low)) = (term(self.x, b.x), term(self.y, b.y), term(self.z, b.z));
        let (s, e) = two_sum(x, y);
        let (s, f) = two_sum(s, z);
        Double::sum(s, ((x_low + y_low) + z_low) + (e + f))
    }

    /// `self - b s`: each coordinate within 2^-103 of the larger of the two terms, besides the errors of what is given.
    #[inline(always)]
    pub fn less<P: Product>(&self, b: &DoubleVector, s: Double) -> DoubleVector {
        let along = |a: Double, b: Double| {
            let (p, e) = P::two_product(b.high, s.high);
            let (d, f) = two_difference(a.high, p);
            Double::sum(d, (f - e) + (a.low - (b.high * s.low + b.low * s.high)))
        };
        DoubleVector { x: along(self.x, b.x), y: along(self.y, b.y), z: along(self.z, b.z) }
    }

    /// `self s + b t`, each coordinate rounded once, all but.
    #[inline(always)]
    pub fn blend<P: Product>(&self, s: Double, b: &DoubleVector, t: Double) -> DVec3 {
        let along = |a: Double, b: Double| {
            let (p, e) = P::two_product(a.high, s.high);
            let (q, f) = P::two_product(b.high, t.high);
            let (sum, g) = two_sum(p, q);
            sum + (((e + f) + g) + ((a.high * s.low + a.low * s.high) + (b.high * t.low + b.low * t.high)))
        };
        DVec3::new(along(self.x, b.x), along(self.y, b.y), along(self.z, b.z))
    }

    /// `|self|^2 - r^2`: within 2^-100 of `|self|^2 + r^2`.
    #[inline(always)]
    pub fn excess_over<P: Product>(&self, r: Double) -> f64 {
        let ((x, x_low), (y, y_low), (z, z_low), (r, r_low)) =
            (squared::<P>(self.x), squared::<P>(self.y), squared::<P>(self.z), squared::<P>(r));
        let (s, s_low) = two_sum(x, y);
        let (u, u_low) = two_difference(z, r);
        let (v, v_low) = two_sum(s, u);
        v + (v_low + ((s_low + u_low) + ((x_low + y_low) + (z_low - r_low))))
    }

    /// The product with a power of two: exact.
    #[inline(always)]
    pub fn scale_exact(self, power: f64) -> Self {
        DoubleVector {
            x: self.x.scale_exact(power),
            y: self.y.scale_exact(power),
            z: self.z.scale_exact(power),
        }
    }

    /// The product with a number.
    #[inline(always)]
    pub fn mul<P: Product>(self, s: Double) -> Self {
        DoubleVector { x: self.x.mul::<P>(s), y: self.y.mul::<P>(s), z: self.z.mul::<P>(s) }
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot<P: Product>(self, b: DoubleVector) -> Double {
        self.x.mul::<P>(b.x) + self.y.mul::<P>(b.y) + self.z.mul::<P>(b.z)
    }

    /// The scalar product with a vector of `f64`.
    #[inline(always)]
    pub fn dot_f64<P: Product>(self, b: DVec3) -> Double {
        self.x.scale::<P>(b.x) + self.y.scale::<P>(b.y) + self.z.scale::<P>(b.z)
    }

    /// The square of the length.
    #[inline(always)]
    pub fn length_squared<P: Product>(self) -> Double {
        self.x.square::<P>() + self.y.square::<P>() + self.z.square::<P>()
    }

    /// The length: right to 2^-101 of itself.
    #[inline(always)]
    pub fn length<P: Product>(&self) -> Double {
        let ((x, x_low), (y, y_low), (z, z_low)) =
            (squared::<P>(self.x), squared::<P>(self.y), squared::<P>(self.z));
        let (s, s_low) = two_sum(x, y);
        let (s, z_s) = two_sum(s, z);
        let low = (s_low + z_s) + ((x_low + y_low) + z_low);
        let root = sqrt(s);
        Double::sum(root, (P::remainder(s, root, root) + low) * (0.5 / root))
    }

    /// The leading parts: the nearest `f64` of each coordinate.
    #[inline(always)]
    pub fn high(self) -> DVec3 {
        DVec3::new(self.x.high, self.y.high, self.z.high)
    }

    /// `self + v`, rounded once: within half a unit in the last place and a little.
    #[inline(always)]
    pub fn plus_f64(self, v: DVec3) -> DVec3 {
        DVec3::new((self.x + v.x).high, (self.y + v.y).high, (self.z + v.z).high)
    }
}

impl Add for DoubleVector {
    type Output = DoubleVector;
    #[inline(always)]
    fn add(self, b: DoubleVector) -> DoubleVector {
        DoubleVector { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl Sub for DoubleVector {
    type Output = DoubleVector;
    #[inline(always)]
    fn sub(self, b: DoubleVector) -> DoubleVector {
        DoubleVector { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expansion::Expansion;
    use crate::kernel::{Dekker, Task, run};
    use crate::math::exp2i;
    use crate::testing::Random;

    /// Numbers of all 106 bits, of both signs and sizes from 1/1000 to 1000.
    fn double(random: &mut Random) -> Double {
        let high = random.sign() * random.magnitude(-3.0, 3.0);
        Double::sum(high, high * exp2i(-54) * random.uniform(-1.0, 1.0))
    }

    fn vector(random: &mut Random) -> DoubleVector {
        DoubleVector { x: double(random), y: double(random), z: double(random) }
    }

    fn coordinates(v: &DoubleVector) -> [Double; 3] {
        [v.x, v.y, v.z]
    }

    /// How far a number is from the exact sum of products, and the sum of the sizes of these.
    fn error(found: Double, products: &[(Double, Double)]) -> (f64, f64) {
        let mut exact = Expansion::ZERO;
        let mut size = 0.0;
        for &(a, b) in products {
            exact.add_double_product::<Dekker>(a, b);
            size += (a.high * b.high).abs();
        }
        exact.add(-found.high);
        exact.add(-found.low);
        (exact.rounded().high.abs(), size)
    }

    struct Bounds(Random);

    impl Task for &mut Bounds {
        type Output = ();
        fn run<P: Product>(self) {
            let random = &mut self.0;
            for case in 0..4000 {
                let (mut a, b) = (vector(random), vector(random));
                let (mut s, t) = (double(random), double(random));
                if case % 2 == 1 {
                    // The terms all but cancel.
                    s = a.x.div::<P>(b.x);
                    a.z = -(a.x.mul::<P>(b.x) + a.y.mul::<P>(b.y)).div::<P>(b.z);
                    a.z.low += a.z.high * random.uniform(-1.0, 1.0) * exp2i(-53 - (case / 2) % 50);
                    a.z = Double::sum(a.z.high, a.z.low);
                }
                let terms = [(a.x, b.x), (a.y, b.y), (a.z, b.z)];
                let (off, size) = error(a.inner::<P>(&b), &terms);
                assert!(off <= exp2i(-99) * size, "inner {a:?} {b:?}");
                let (off, size) = error(a.dot::<P>(b), &terms);
                assert!(off <= exp2i(-101) * size, "dot {a:?} {b:?}");

                let less = coordinates(&a.less::<P>(&b, s));
                let blend = a.blend::<P>(s, &b, t).to_array();
                let (d, step) = (b.high(), exp2i(-30) * t.high);
                let advanced = coordinates(&a.advanced::<P>(d, s));
                let nudged = coordinates(&a.nudged(d, step));
                let moved = a.plus_f64(d).to_array();
                for (k, (a, b)) in coordinates(&a).into_iter().zip(coordinates(&b)).enumerate() {
                    let (off, size) = error(less[k], &[(a, Double::ONE), (-b, s)]);
                    assert!(off <= exp2i(-103) * size, "{a:?} less {b:?} {s:?}");
                    let (off, size) = error(Double::from(blend[k]), &[(a, s), (b, t)]);
                    assert!(off <= exp2i(-53) * blend[k].abs() + exp2i(-101) * size, "blend {a:?} {b:?}");
                    let (d, one) = (Double::from(d.to_array()[k]), Double::ONE);
                    let (off, size) = error(advanced[k], &[(a, one), (d, s)]);
                    assert!(off <= exp2i(-103) * size, "{a:?} advanced {d:?} {s:?}");
                    let (off, size) = error(nudged[k], &[(a, one), (d, Double::from(step))]);
                    assert!(
                        off <= exp2i(-105) * size + exp2i(-52) * (d.high * step).abs(),
                        "{a:?} nudged {d:?} {step}"
                    );
                    let (off, size) = error(Double::from(moved[k]), &[(a, one), (d, one)]);
                    assert!(off <= exp2i(-53) * moved[k].abs() + exp2i(-104) * size, "{a:?} plus {d:?}");
                }

                let length = a.length::<P>();
                let squares = [(a.x, a.x), (a.y, a.y), (a.z, a.z)];
                let [x, y, z] = squares;
                let (off, _) = error(Double::ZERO, &[x, y, z, (-length, length)]);
                assert!(off <= exp2i(-100) * length.high * length.high, "length of {a:?}");
                let (off, size) = error(a.length_squared::<P>(), &squares);
                assert!(off <= exp2i(-102) * size, "square of {a:?}");
                // Near the surface of a ball, nearer with each case, and anywhere.
                let r = if case % 3 == 0 { t } else { length };
                let r = Double::sum(r.high, r.low + r.high * random.uniform(-1.0, 1.0) * exp2i(-(case % 64)));
                let excess = a.excess_over::<P>(r);
                let (off, size) = error(Double::from(excess), &[x, y, z, (-r, r)]);
                assert!(off <= exp2i(-53) * excess.abs() + exp2i(-100) * size, "excess of {a:?} over {r:?}");
                let excess = a.excess::<P>(r.high);
                let (off, size) =
                    error(Double::from(excess), &[x, y, z, (Double::from(-r.high), Double::from(r.high))]);
                assert!(
                    off <= exp2i(-52) * excess.abs() + exp2i(-101) * size,
                    "excess of {a:?} over {}",
                    r.high
                );
            }
        }
    }

    /// What the operations promise, against exact sums.
    #[test]
    fn as_right_as_promised() {
        run(&mut Bounds(Random::new(1)));
        (&mut Bounds(Random::new(2))).run::<Dekker>();
    }
}
